//! The Magnus force on a spinning body in a flow.

use tumble_math::lane::Lane;

use crate::forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
use crate::math::Real;

/// The sideways force on a body that spins in a stream: `F = S w x u`, with `u` the velocity
/// relative to the [`Wind`](crate::Wind).
///
/// Always across the motion, so in still air it does no work. A body that moves at constant speed
/// with `w` across its way goes round with the angular velocity `S w/M`.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// // Topspin: the ball flies along x, and what is on top moves forward.
/// let ball = RigidBody::new(Shape::sphere(0.03)).mass(0.06).gravity_scale(0.0);
/// let ball = ball
///     .linear_velocity(Vec3::X * 30.0)
///     .angular_velocity(Vec3::Z * -200.0)
///     .build()?
///     .spawn(&mut world);
/// world.insert_one(ball, Magnus { coefficient: 1e-5 })?;
/// Simulation::new(Settings::default())?.step(&mut world);
/// assert!(world.get::<&Velocity>(ball)?.linear.y < 0.0); // it dips
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Magnus {
    /// `S` \[kg\]. For a sphere of radius r in a fluid of density rho, theory without friction
    /// gives `8/3 pi rho r^3`; balls in air have less.
    pub coefficient: Real,
}

impl SimdForceLaw<1> for Magnus {
    fn numbers(&self) -> [Real; 1] {
        [self.coefficient]
    }

    #[inline(always)]
    fn wrench<L: Lane>([coefficient]: [L; 1], body: &SimdBody<L>) -> SimdWrench<L> {
        SimdWrench::force(body.angular_velocity.cross(body.linear_velocity - body.wind) * coefficient)
    }
}
