//! What a joint carries, and where it stands.

use crate::math::{Real, Vec3};

/// What a [`Joint`](crate::Joint) carries and where it stands, written by every step of a
/// [`Simulation`](crate::Simulation) where it is a component of the joint's entity.
///
/// In the step in which a joint breaks it is what broke it. While a joint does nothing, as it is
/// broken or a body of it is gone, all is zero, values and speeds too.
///
/// ```
/// use tumble::{Joint, JointLoad, prelude::*};
///
/// let mut world = tumble::hecs::World::new();
/// let hook = RigidBody::new(Shape::Point).fixed().build()?.spawn(&mut world);
/// let lamp = RigidBody::new(Shape::sphere(0.1))
///     .mass(2.0)
///     .position(Vec3::Y * -1.0)
///     .build()?
///     .spawn(&mut world);
/// let joint = Joint::ball(hook, lamp).at_point(&world, Vec3::ZERO)?;
/// let joint = world.spawn((joint, JointLoad::default()));
/// Simulation::new(Settings::default())?.step(&mut world);
/// // The hook carries the lamp.
/// assert!((world.get::<&JointLoad>(joint)?.force.y - 2.0 * 9.81).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct JointLoad {
    /// Force of the joint on its second body \[N\], world frame: the mean over the step. On the
    /// first body it is the opposite.
    pub force: Vec3,
    /// Torque of the joint on its second body about that body's anchor [N m], world frame: the mean
    /// over the step.
    pub torque: Vec3,
    /// Where the second frame is against the first, along the axes of the first: translation \[m\],
    /// then the vector of the rotation \[rad\]; of a universal joint its two angles, and the cosine
    /// between their axes. Zero along locked axes but for the joint's error.
    pub values: [Real; 6],
    /// How fast the second frame moves against the first, along the axes of the first \[m/s\]
    /// \[rad/s\]; the second angle of a universal joint about its axis of the second.
    pub speeds: [Real; 6],
}
