//! Axes of the world along and about which a body does not move.

use crate::joints::axes::Axes;

/// Axes of the world, through the centre of mass, along and about which a dynamic body does not
/// move. Along them and about them it answers to contacts as a fixed body does: a blow along a
/// locked axis is one against a wall.
///
/// Translations are those of the centre of mass. [`Momentum`](crate::Momentum) along a locked axis
/// is set to zero in every step; angular momentum is set to that of the angular velocity, which has
/// nothing about a locked axis. A body with locked axes is integrated in the substeps of contacts,
/// [`contact_substeps`](crate::Settings::contact_substeps), whatever the integrator: about one free
/// axis it turns exactly, about two with an error of second order and without a trend of the
/// energy.
///
/// The locked axes of a body with [`Joint`](crate::Joint)s are solved together with these. About
/// two free axes such a body turns with an error of first order. On a fixed or kinematic body it
/// does nothing.
///
/// ```
/// # use tumble::prelude::*;
/// # use tumble::LockedAxes;
/// # let mut world = hecs::World::new();
/// // A 2.5-D game: nothing leaves the plane z = 0, and boxes turn within it alone.
/// let shape = Shape::cuboid([0.5, 0.5, 0.5]);
/// let body = RigidBody::new(shape).mass(1.0).angular_velocity(Vec3::new(1.0, 2.0, 3.0));
/// let body =
///     body.linear_velocity(Vec3::ONE).build()?.spawn_with(&mut world, (LockedAxes::PLANE_XY,));
/// Simulation::new(Settings::default())?.step_many(&mut world, 60);
/// assert_eq!(world.get::<&Pose>(body)?.position.z, 0.0);
/// assert_eq!(world.get::<&Pose>(body)?.orientation.x, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("freeze rotation", "constraints", "lock rotation", "2d"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(transparent)]
pub struct LockedAxes(pub Axes);

impl LockedAxes {
    /// A body moves in the plane of x and y, and turns about z.
    pub const PLANE_XY: Self = Self(Axes::LINEAR_Z.with(Axes::ANGULAR_X).with(Axes::ANGULAR_Y));
    /// A body does not turn: a character that does not tip.
    pub const ROTATIONS: Self = Self(Axes::ANGULAR);
}
