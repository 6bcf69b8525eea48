//! Worlds with joints rebuilt in Rapier, with sleeping disabled, as a reference engine.

#![allow(
    clippy::unnecessary_cast,
    clippy::useless_conversion,
    reason = "Rapier is in single precision, Real in that of the build"
)]

use std::collections::HashMap;
use std::f32::consts::TAU;

use hecs::{Entity, World};
use rapier3d::prelude as rapier;
use tumble::math::{Quat, Vec3};
use tumble::{Axes, BodyId, Collider, Drives, Gain, Inertia, Joint, Limits, Mass, Pose, Settings};

use crate::jointed::{BONE, BONE_FRICTION};

/// With which of Rapier's joints a world is rebuilt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RapierJoints {
    /// Constraints between bodies.
    Impulse,
    /// Reduced coordinates, of trees only, of which no body but the first may be fixed.
    Multibody,
}

/// A world in Rapier, and which body of it stands for which of ours.
#[allow(missing_debug_implementations, reason = "Rapier's world has none")]
pub struct RapierWorld {
    world: rapier::PhysicsWorld,
    bodies: HashMap<Entity, rapier::RigidBodyHandle>,
}

impl RapierWorld {
    /// The bodies, joints, limits and drives of a world, of which the bodies are at rest; `None`
    /// where these joints cannot be made. What moves and has a collider has that of a bone, what is
    /// fixed that of the ground.
    pub fn new(ours: &World, settings: &Settings, joints: RapierJoints) -> Option<Self> {
        let mut world = rapier::PhysicsWorld::new();
        world.gravity = vector(settings.gravity);
        world.integration_parameters.dt = settings.dt as f32;
        world.integration_parameters.num_solver_iterations = settings.contact_substeps as usize;
        let mut bodies = HashMap::new();
        let mut query = ours.query::<(Entity, &BodyId, &Pose, Option<(&Mass, &Inertia)>, hecs::Satisfies<&Collider>)>();
        let mut of_world: Vec<_> = query.iter().collect();
        of_world.sort_by_key(|(_, id, ..)| **id);
        for (entity, _, pose, inertia, touches) in of_world {
            let body = match inertia {
                Some((mass, inertia)) => {
                    let [kilograms, moments] = [vector(Vec3::X * mass.kilograms()), vector(inertia.moments())];
                    let properties = rapier::MassProperties::new(rapier::Vector::ZERO, kilograms.x, moments);
                    rapier::RigidBodyBuilder::dynamic().can_sleep(false).additional_mass_properties(properties)
                }
                None => rapier::RigidBodyBuilder::fixed(),
            };
            let handle = world.insert_body(body.pose(frame(pose)));
            if touches {
                let [half_height, radius] = BONE.map(|length| length as f32);
                let collider = match inertia {
                    Some(_) => rapier::ColliderBuilder::capsule_y(half_height, radius).density(0.0),
                    None => rapier::ColliderBuilder::cuboid(1e3, 1.0, 1e3).translation(vector(-Vec3::Y)),
                };
                world.insert_collider(collider.friction(BONE_FRICTION as f32), Some(handle));
            }
            bodies.insert(entity, handle);
        }
        for (joint, drives, limits) in ours.query::<(&Joint, Option<&Drives>, Option<&Limits>)>().iter() {
            let [a, b] = joint.bodies.map(|body| bodies.get(&body).copied());
            let joint = generic_joint(joint, drives, limits);
            match joints {
                RapierJoints::Impulse => drop(world.impulse_joints.insert(a?, b?, joint, true)),
                RapierJoints::Multibody => drop(world.multibody_joints.insert(a?, b?, joint, true)?),
            }
        }
        Some(Self { world, bodies })
    }

    /// A step, in the pool of the caller.
    pub fn step(&mut self) {
        self.world.step();
    }

    /// Where the body is that stands for this one of ours.
    pub fn pose(&self, body: Entity) -> Option<Pose> {
        let body = &self.world.bodies[*self.bodies.get(&body)?];
        let [x, y, z] = body.translation().to_array().map(Into::into);
        let orientation = body.rotation().to_array().map(Into::into);
        Some(Pose { position: Vec3::new(x, y, z), orientation: Quat::from_array(orientation) })
    }

    /// The kinetic energy of all its bodies \[J\].
    pub fn kinetic_energy(&self) -> f64 {
        self.world.bodies.iter().map(|(_, body)| f64::from(body.kinetic_energy())).sum()
    }
}

/// What both engines call each axis.
const AXES: [(Axes, rapier::JointAxis); 6] = [
    (Axes::LINEAR_X, rapier::JointAxis::LinX),
    (Axes::LINEAR_Y, rapier::JointAxis::LinY),
    (Axes::LINEAR_Z, rapier::JointAxis::LinZ),
    (Axes::ANGULAR_X, rapier::JointAxis::AngX),
    (Axes::ANGULAR_Y, rapier::JointAxis::AngY),
    (Axes::ANGULAR_Z, rapier::JointAxis::AngZ),
];

fn generic_joint(joint: &Joint, drives: Option<&Drives>, limits: Option<&Limits>) -> rapier::GenericJoint {
    let [first, second] = joint.frames.each_ref().map(frame);
    let mut theirs = rapier::GenericJoint::default();
    theirs.set_local_frame1(first).set_local_frame2(second).set_contacts_enabled(false);
    for (number, (axis, their_axis)) in AXES.into_iter().enumerate() {
        if !joint.free.contains(axis) {
            theirs.lock_axes(their_axis.into());
        }
        if let Some(limit) = limits.and_then(|limits| limits.axes[number]) {
            theirs.set_limits(their_axis, [limit.min as f32, limit.max as f32]);
        }
        let drives = drives.into_iter().flat_map(|drives| &drives.0);
        for drive in drives.filter(|drive| drive.axes.contains(axis)) {
            let (Gain::Frequency { hertz, damping_ratio }, Some(position)) = (drive.gain, drive.position) else {
                continue;
            };
            let rate = TAU * hertz as f32;
            // Per kilogram, which is what a motor of Rapier's has unless it is said otherwise.
            theirs.set_motor_position(their_axis, position as f32, rate * rate, 2.0 * damping_ratio as f32 * rate);
        }
    }
    theirs
}

fn frame(pose: &Pose) -> rapier::Pose {
    let [x, y, z, w] = pose.orientation.to_array().map(|x| x as f32);
    rapier::Pose::from_parts(vector(pose.position), rapier::Rotation::from_xyzw(x, y, z, w))
}

fn vector(v: Vec3) -> rapier::Vector {
    let [x, y, z] = v.to_array().map(|x| x as f32);
    rapier::Vector::new(x, y, z)
}
