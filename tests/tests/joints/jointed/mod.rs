//! Mechanisms for the tests of joints: bodies, joints, and what is measured of them.

#![allow(dead_code, reason = "each test uses a part of it")]

use glam::{DMat3, DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{
    Axes, BodyId, BodyOrder, Drive, Drives, InertiaTensor, Joint, JointLoad, Pose, RigidBody, Settings, Shape,
    Simulation, Totals, Velocity,
};
use tumble_tests::references::{real_quat, real_vec3};
use tumble_tests::{dquat, dvec3};

/// Standard gravity of these tests [m/s^2], along -y unless said.
pub(crate) const G: f64 = 9.81;

/// A world with its simulation.
pub(crate) struct Rig {
    pub(crate) world: World,
    pub(crate) simulation: Simulation,
}

impl Rig {
    /// With gravity, and steps of `dt` \[s\] in a number of substeps.
    pub(crate) fn new(gravity: DVec3, dt: f64, substeps: u32) -> Self {
        let settings = Settings::default().with_gravity(real_vec3(gravity)).with_dt(dt as Real);
        let simulation = Simulation::new(settings.with_contact_substeps(substeps)).unwrap();
        Self { world: World::new(), simulation }
    }

    pub(crate) fn spawn(&mut self, body: RigidBody) -> Entity {
        body.build().unwrap().spawn(&mut self.world)
    }

    /// A body that does not move, at the origin.
    pub(crate) fn ground(&mut self) -> Entity {
        self.spawn(RigidBody::new(Shape::Point).fixed())
    }

    /// Spawns a joint that tells its load.
    pub(crate) fn join(&mut self, joint: Joint) -> Entity {
        self.world.spawn((joint, JointLoad::default()))
    }

    /// A joint with both frames at a point, x along an axis.
    pub(crate) fn join_at(&mut self, joint: Joint, point: DVec3, axis: DVec3) -> Entity {
        let joint = joint.at(&self.world, real_vec3(point), real_vec3(axis)).unwrap();
        self.join(joint)
    }

    pub(crate) fn step(&mut self) {
        self.simulation.step(&mut self.world);
    }

    /// Steps on to a time \[s\].
    pub(crate) fn run_to(&mut self, time: f64) {
        let half = 0.5 * f64::from(self.simulation.settings().dt);
        while self.simulation.time() + half < time {
            self.step();
        }
    }

    pub(crate) fn position(&self, body: Entity) -> DVec3 {
        dvec3(self.world.get::<&Pose>(body).unwrap().position)
    }

    pub(crate) fn orientation(&self, body: Entity) -> DQuat {
        dquat(self.world.get::<&Pose>(body).unwrap().orientation)
    }

    pub(crate) fn velocity(&self, body: Entity) -> DVec3 {
        dvec3(self.world.get::<&Velocity>(body).unwrap().linear)
    }

    pub(crate) fn angular_velocity(&self, body: Entity) -> DVec3 {
        dvec3(self.world.get::<&Velocity>(body).unwrap().angular)
    }

    pub(crate) fn load(&self, joint: Entity) -> JointLoad {
        *self.world.get::<&JointLoad>(joint).unwrap()
    }

    pub(crate) fn totals(&self) -> Totals {
        Totals::of(&self.world, self.simulation.settings(), &BodyOrder::of(&self.world))
    }

    pub(crate) fn energy(&self) -> f64 {
        self.totals().energy()
    }

    /// From the first anchor of a joint to the second, along its locked axes \[m\].
    pub(crate) fn gap(&self, joint: &Joint) -> DVec3 {
        let [a, b] = [0, 1].map(|end| {
            let (body, frame) = (joint.bodies[end], &joint.frames[end]);
            self.position(body) + self.orientation(body) * dvec3(frame.position)
        });
        let axes = DMat3::from_quat(self.orientation(joint.bodies[0]) * dquat(joint.frames[0].orientation));
        let free = [Axes::LINEAR_X, Axes::LINEAR_Y, Axes::LINEAR_Z].map(|axis| joint.free.contains(axis));
        let gap = axes.transpose() * (b - a);
        DVec3::from_array([0, 1, 2].map(|i| if free[i] { 0.0 } else { gap[i] }))
    }

    /// The largest of all joints \[m\].
    pub(crate) fn largest_gap(&self) -> f64 {
        let gaps = self.world.query::<&Joint>().iter().map(|joint| self.gap(joint).length()).collect::<Vec<_>>();
        gaps.into_iter().fold(0.0, f64::max)
    }
}

/// Gravity along -y.
pub(crate) fn down() -> DVec3 {
    DVec3::NEG_Y * G
}

/// A body with these principal moments along its own axes.
pub(crate) fn body(mass: f64, moments: DVec3, position: DVec3) -> RigidBody {
    let inertia = InertiaTensor::from_principal(moments, DQuat::IDENTITY).unwrap();
    RigidBody::new(Shape::Point).mass(mass).inertia(inertia).position(real_vec3(position))
}

/// A thin rod along its x, with a hundredth of the moment about it.
pub(crate) fn rod(mass: f64, length: f64, position: DVec3) -> RigidBody {
    let across = mass * length * length / 12.0;
    body(mass, DVec3::new(0.01 * across, across, across), position)
}

/// A rod of 1 m on a hinge about z at the origin, along x, with drives; and the joint.
pub(crate) fn driven_rod(world: &mut World, mass: f64, drives: Vec<Drive>) -> (Entity, Entity) {
    let ground = RigidBody::new(Shape::Point).fixed().build().unwrap().spawn(world);
    let rod = rod(mass, 1.0, DVec3::X * 0.5).id(BodyId(1)).build().unwrap().spawn(world);
    let hinge = Joint::hinge(ground, rod).at(world, real(ORIGIN), real(DVec3::Z)).unwrap();
    (rod, world.spawn((hinge, Drives(drives), JointLoad::default())))
}

/// The same turned, and with the velocity of turning about a point.
pub(crate) fn turning_about(body: RigidBody, position: DVec3, pivot: DVec3, angular: DVec3) -> RigidBody {
    body.linear_velocity(real_vec3(angular.cross(position - pivot))).angular_velocity(real_vec3(angular))
}

pub(crate) fn turned(body: RigidBody, axis: DVec3, angle: f64) -> RigidBody {
    body.orientation(real_quat(DQuat::from_axis_angle(axis, angle)))
}

/// A frame of a joint on a body.
pub(crate) fn frame(position: DVec3, orientation: DQuat) -> Pose {
    Pose { position: real_vec3(position), orientation: real_quat(orientation) }
}

/// Of the world.
pub(crate) const ORIGIN: DVec3 = DVec3::ZERO;

/// The angle of a direction in the plane of x and y, from straight down \[rad\].
pub(crate) fn angle_from_down(direction: DVec3) -> f64 {
    direction.x.atan2(-direction.y)
}

/// A vector of the build.
pub(crate) fn real(v: DVec3) -> Vec3 {
    real_vec3(v)
}
