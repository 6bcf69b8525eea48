//! The velocity of the medium around a body, for drag and the Magnus force.

use crate::math::Vec3;

/// Velocity of the medium around a body [m/s], world frame: what [`Drag`](crate::Drag) and
/// [`Magnus`](crate::Magnus) take velocity relative to. A body without one is in still air.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// // A feather in a breeze is carried along.
/// let feather = RigidBody::new(Shape::sphere(0.01))
///     .mass(0.001)
///     .gravity_scale(0.0)
///     .build()?
///     .spawn(&mut world);
/// world.insert(feather, (Drag::isotropic(0.01), Wind(Vec3::X * 3.0)))?;
/// Simulation::new(Settings::default())?.step_many(&mut world, 60);
/// assert!(world.get::<&Velocity>(feather)?.linear.x > 2.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(transparent)]
pub struct Wind(pub Vec3);
