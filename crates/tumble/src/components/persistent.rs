//! Per-body gravity scale and damping.

use crate::math::Real;

/// How many times the simulation's gravity acts on a body; 1 for a body without this component, 0
/// for one that floats.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// let balloon = RigidBody::new(Shape::sphere(0.2)).mass(0.1).build()?.spawn(&mut world);
/// world.insert_one(balloon, GravityScale(-0.1))?; // rises
/// Simulation::new(Settings::default())?.step(&mut world);
/// assert!(world.get::<&Pose>(balloon)?.position.y > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("gravity_scale", "gravity factor"))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct GravityScale(pub Real);

/// Decay of the momenta at constant rates: `dP/dt = F - linear P`, `dL/dt = torque - angular L`.
///
/// The decay over a step is exact at any rate and step, never unstable; a rate that is not positive
/// does nothing.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// let puck =
///     RigidBody::new(Shape::sphere(0.1)).mass(1.0).gravity_scale(0.0).linear_velocity(Vec3::X);
/// let puck = puck.damping(Damping { linear: 2.0, angular: 0.0 }).build()?.spawn(&mut world);
/// Simulation::new(Settings::default())?.step_many(&mut world, 60); // a second
/// assert!((world.get::<&Velocity>(puck)?.linear.x - Real::exp(-2.0)).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("linear damping", "angular damping"))]
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(C)]
pub struct Damping {
    /// Rate at which linear momentum decays [1/s].
    pub linear: Real,
    /// Rate at which angular momentum decays [1/s].
    pub angular: Real,
}
