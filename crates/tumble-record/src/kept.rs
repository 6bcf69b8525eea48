//! Which sums over a world stay what they are, so that their drift is an error.

use hecs::{Component, World};
use tumble::{
    AngularVelocityServo, Breakable, Buoyancy, Collider, ConstantWrench, Damping, Drag, Drives, GravityMass, Joint,
    JointFriction, LockedAxes, Magnus, Momentum, PointGravity, Pose, Settings, Spring, SpringToPoint, Thruster,
    Velocity,
};

/// What nothing in a world changes.
///
/// ```
/// use tumble::prelude::*;
/// use tumble_record::Kept;
///
/// let mut world = hecs::World::new();
/// RigidBody::new(Shape::sphere(0.5)).mass(1.0).without_collider().build()?.spawn(&mut world);
/// let under_gravity = Kept::of(&world, &Settings::default());
/// assert_eq!(under_gravity, Kept { energy: true, momentum: false });
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    /// Kinetic energy and potentials together.
    pub energy: bool,
    /// Linear momentum, and angular momentum about the world's origin.
    pub momentum: bool,
}

impl Kept {
    /// By what there is in a world. Where bodies can touch, energy is not kept.
    #[must_use]
    pub fn of(world: &World, settings: &Settings) -> Self {
        Self { energy: !takes_energy(world), momentum: !is_pushed(world, settings) }
    }
}

fn has<T: Component>(world: &World) -> bool {
    world.query::<&T>().iter().next().is_some()
}

/// Whether something gives or takes energy that has no potential.
fn takes_energy(world: &World) -> bool {
    let is_damped = world.query::<&Spring>().iter().any(|spring| spring.damping != 0.0)
        || world.query::<&SpringToPoint>().iter().any(|spring| spring.damping != 0.0);
    let is_driven = has::<Drives>(world) || has::<JointFriction>(world) || has::<Breakable>(world);
    let has_kinematic = world.query::<(&Pose, &Velocity)>().without::<&Momentum>().iter().next().is_some();
    let is_carried = has_kinematic && (has::<Joint>(world) || has::<Spring>(world));
    is_damped || is_driven || is_carried || is_moved_alone(world) || has::<Collider>(world)
}

/// Whether a force without a potential and without a second body acts on a body.
fn is_moved_alone(world: &World) -> bool {
    let is_dragged = has::<Damping>(world) || has::<Drag>(world) || has::<Magnus>(world);
    is_dragged || has::<Thruster>(world) || has::<ConstantWrench>(world) || has::<AngularVelocityServo>(world)
}

/// Whether something from outside pushes a body, or holds it.
fn is_pushed(world: &World, settings: &Settings) -> bool {
    let is_held = world.query::<&Pose>().without::<&Momentum>().iter().next().is_some();
    let is_pulled = has::<SpringToPoint>(world) || has::<PointGravity>(world) || has::<Buoyancy>(world);
    let acts_between =
        has::<Collider>(world) || has::<Joint>(world) || has::<Spring>(world) || has::<GravityMass>(world);
    let has_gravity = settings.gravity != tumble::math::Vec3::ZERO;
    has_gravity || is_moved_alone(world) || is_pulled || has::<LockedAxes>(world) || (is_held && acts_between)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tumble_scene::Scene;

    /// In scenes that are known to keep them or not: by their gravity, springs, contacts, dampers.
    #[test]
    fn scenes_keep_what_nothing_changes() {
        for (name, energy, momentum) in [
            ("t-handle", true, true),
            ("solar-system", true, true),
            ("stress", true, false),
            ("drake-cylinder", true, false),
            ("raft", true, false),
            ("heavy-chain", true, false),
            ("foucault", false, false),
            ("windy-day", false, false),
            ("pyramid", false, false),
            ("crane", false, false),
            ("satellite", false, false),
        ] {
            let scene = Scene::open(name).unwrap();
            let (settings, mut world) = (scene.settings, World::new());
            scene.spawn(&mut world).unwrap();
            assert_eq!(Kept::of(&world, &settings), Kept { energy, momentum }, "{name}");
        }
    }
}
