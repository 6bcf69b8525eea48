//! A body as forces move it, in double precision: the chassis, and what is under the wheels.

use tumble::glam::{DMat3, DVec3};
use tumble::hecs::{Entity, World};
use tumble::math::{dquat, dvec3};
use tumble::{CenterOfMass, GravityScale, Inertia, Mass, Momentum, Pose, PrincipalAxes, Velocity, Wrench};

/// A body at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rigid {
    pub(crate) position: DVec3,
    /// Velocity of the centre of mass [m/s].
    pub(crate) linear: DVec3,
    /// Angular velocity [rad/s].
    pub(crate) angular: DVec3,
    /// Zero of what forces do not move [1/kg].
    pub(crate) inverse_mass: f64,
    /// Zero of what forces do not turn [1/(kg m^2)].
    pub(crate) inverse_inertia: DMat3,
}

impl Rigid {
    /// `None` of what is not there, or has numbers that are not finite.
    pub(crate) fn of(world: &World, entity: Entity) -> Option<Self> {
        let pose = *world.get::<&Pose>(entity).ok()?;
        let fixed = Self {
            position: dvec3(pose.position),
            linear: DVec3::ZERO,
            angular: DVec3::ZERO,
            inverse_mass: 0.0,
            inverse_inertia: DMat3::ZERO,
        };
        let body = match (world.get::<&Momentum>(entity), world.get::<&Mass>(entity)) {
            (Ok(momentum), Ok(mass)) => {
                let inverse_mass = 1.0 / f64::from(mass.kilograms());
                let inverse_inertia = inverse_inertia(world, entity, &pose);
                let linear = dvec3(momentum.linear) * inverse_mass;
                let angular = inverse_inertia * dvec3(momentum.angular);
                Self { linear, angular, inverse_mass, inverse_inertia, ..fixed }
            }
            (Err(_), _) => match world.get::<&Velocity>(entity) {
                Ok(velocity) => Self { linear: dvec3(velocity.linear), angular: dvec3(velocity.angular), ..fixed },
                Err(_) => fixed,
            },
            _ => fixed,
        };
        (body.position.is_finite() && body.linear.is_finite() && body.angular.is_finite()).then_some(body)
    }

    pub(crate) fn is_dynamic(&self) -> bool {
        self.inverse_mass > 0.0
    }

    /// Velocity of its material at a point [m/s].
    pub(crate) fn at_point(&self, point: DVec3) -> DVec3 {
        self.linear + self.angular.cross(point - self.position)
    }

    /// The velocity along a direction at a point per impulse along it there [1/kg].
    pub(crate) fn give(&self, point: DVec3, direction: DVec3) -> f64 {
        let lever = (point - self.position).cross(direction);
        self.inverse_mass * direction.length_squared() + lever.dot(self.inverse_inertia * lever)
    }
}

fn inverse_inertia(world: &World, entity: Entity, pose: &Pose) -> DMat3 {
    let Ok(inertia) = world.get::<&Inertia>(entity) else { return DMat3::ZERO };
    let axes = world.get::<&PrincipalAxes>(entity).map_or(tumble::glam::DQuat::IDENTITY, |axes| dquat(axes.0));
    let to_world = DMat3::from_quat((dquat(pose.orientation) * axes).normalize());
    to_world * DMat3::from_diagonal(dvec3(inertia.inverse_moments())) * to_world.transpose()
}

/// A chassis: its motion, its axes, and what else acts on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chassis {
    pub(crate) body: Rigid,
    pub(crate) mass: f64,
    pub(crate) inertia: DMat3,
    /// Takes coordinates of the chassis to those of the world.
    pub(crate) axes: DMat3,
    /// The centre of mass in the chassis's own frame \[m\].
    pub(crate) center_of_mass: DVec3,
    /// What acts on it beside the wheels: gravity, and what the caller added.
    pub(crate) force: DVec3,
    pub(crate) torque: DVec3,
}

impl Chassis {
    /// `None` of what forces do not move, or does not turn.
    pub(crate) fn of(world: &World, entity: Entity, gravity: DVec3) -> Option<Self> {
        let body = Rigid::of(world, entity)?;
        let wrench = *world.get::<&Wrench>(entity).ok()?;
        let orientation = dquat(world.get::<&Pose>(entity).ok()?.orientation).normalize();
        let inertia = body.inverse_inertia.inverse();
        if !body.is_dynamic() || !inertia.is_finite() || !orientation.is_finite() {
            return None;
        }
        let mass = 1.0 / body.inverse_mass;
        let scale = world.get::<&GravityScale>(entity).map_or(1.0, |scale| f64::from(scale.0));
        let force = dvec3(wrench.force) + gravity * (mass * scale);
        let torque = dvec3(wrench.torque);
        let center_of_mass = world.get::<&CenterOfMass>(entity).map_or(DVec3::ZERO, |center| dvec3(center.0));
        (force.is_finite() && torque.is_finite()).then_some(Self {
            body,
            mass,
            inertia,
            axes: DMat3::from_quat(orientation),
            center_of_mass,
            force,
            torque,
        })
    }
}
