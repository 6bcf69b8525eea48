//! What characters do to dynamic bodies: pushes, landings, and their weight.

use tumble::hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{InverseInertia, Mass, Momentum, Pose, Wrench};

/// A push of a character against a dynamic body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    pub(crate) entity: Entity,
    /// Where \[m\].
    pub(crate) point: Vec3,
    /// From the character to the body.
    pub(crate) direction: Vec3,
    /// The body is pushed until this point of it is as fast as this along the direction \[m/s\].
    pub(crate) speed: Real,
    /// The most \[N s\].
    pub(crate) most: Real,
    /// What the character weighs that gives off its speed, if it does \[kg\].
    pub(crate) mass: Option<Real>,
}

/// A force for the length of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weight {
    pub(crate) entity: Entity,
    pub(crate) point: Vec3,
    /// \[N\]
    pub(crate) force: Vec3,
}

impl Push {
    /// Adds it to the momentum that the body has by now.
    pub(crate) fn apply(&self, world: &World) {
        let Ok(body) = world.entity(self.entity) else { return };
        let (Some(pose), Some(mass)) = (body.get::<&Pose>(), body.get::<&Mass>()) else { return };
        let Some(mut momentum) = body.get::<&mut Momentum>() else { return };
        let arm = self.point - pose.position;
        let lever = arm.cross(self.direction);
        let inverse_mass = 1.0 / mass.kilograms();
        let inertia = body.get::<&InverseInertia>().map(|it| it.to_mat3());
        let spin = inertia.map_or(Vec3::ZERO, |inverse| inverse * momentum.angular);
        let velocity = momentum.linear * inverse_mass + spin.cross(arm);
        let mobility = inverse_mass + inertia.map_or(0.0, |inverse| lever.dot(inverse * lever).max(0.0));
        let mobility = mobility + self.mass.map_or(0.0, |mass| 1.0 / mass.max(Real::MIN_POSITIVE));
        let impulse = ((self.speed - velocity.dot(self.direction)) / mobility).clamp(0.0, self.most);
        if impulse.is_finite() {
            momentum.apply_impulse_at(self.direction * impulse, self.point, pose.position);
        }
    }
}

impl Weight {
    pub(crate) fn apply(&self, world: &World) {
        let Ok(body) = world.entity(self.entity) else { return };
        let (Some(pose), Some(mut wrench)) = (body.get::<&Pose>(), body.get::<&mut Wrench>()) else { return };
        if self.force.is_finite() {
            wrench.add_force_at(self.force, self.point, pose.position);
        }
    }
}
