//! Softened inverse-square gravity towards a fixed point.

use tumble_math::lane::{Lane, Vec3 as LaneVec3};

use crate::forces::force_law::BodyState;
use crate::forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
use crate::math::{Real, Vec3, dvec3};

/// Gravity towards a point of the world: `F = -M mu r/(r^2 + e^2)^(3/2)`, `r` from the point to the
/// body, with the energy `-M mu/(r^2 + e^2)^(1/2)`.
///
/// Bodies that attract each other carry [`GravityMass`](crate::GravityMass) instead. The force acts
/// at the centre of mass: the torque of a field that is stronger on the near side is not in it.
///
/// Under `MoserVeselov` the energy of an orbit has no trend, and the ellipse turns by an angle that
/// falls with the square of the step: docs/forces.md has figures.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// // A circle: the square of the speed is mu over the distance.
/// let moon = RigidBody::new(Shape::Point)
///     .mass(1.0)
///     .position(Vec3::X * 2.0)
///     .linear_velocity(Vec3::Z)
///     .build()?;
/// let moon = moon.spawn(&mut world);
/// world.insert_one(moon, PointGravity { mu: 2.0, ..PointGravity::default() })?;
/// Simulation::new(Settings::default().with_gravity(Vec3::ZERO))?.step_many(&mut world, 60);
/// assert!((world.get::<&Pose>(moon)?.position.length() - 2.0).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct PointGravity {
    /// The point \[m\].
    pub center: Vec3,
    /// Gravitational constant times the mass there [m^3/s^2]; 3.986004418e14 for the earth.
    pub mu: Real,
    /// `e` \[m\], which keeps the force finite where the body passes through the point; 0 is
    /// Newton's law.
    pub softening: Real,
}

impl SimdForceLaw<5> for PointGravity {
    fn numbers(&self) -> [Real; 5] {
        [self.center.x, self.center.y, self.center.z, self.mu, self.softening]
    }

    #[inline(always)]
    fn wrench<L: Lane>([x, y, z, mu, softening]: [L; 5], body: &SimdBody<L>) -> SimdWrench<L> {
        let acceleration = attraction(LaneVec3::new(x, y, z) - body.position, mu, softening * softening);
        SimdWrench::force(acceleration * body.mass)
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }

    fn potential(&self, state: &BodyState<'_>) -> f64 {
        let distance = (dvec3(self.center) - dvec3(state.position)).length().hypot(f64::from(self.softening));
        if distance > 0.0 { -f64::from(state.mass) * f64::from(self.mu) / distance } else { 0.0 }
    }
}

/// The acceleration [m/s^2] towards a mass that is `away` \[m\]; none towards one at the same
/// place.
///
/// In this order of factors neither a planet's distance nor an atom's leaves the range of single
/// precision.
#[inline(always)]
pub(crate) fn attraction<L: Lane>(away: LaneVec3<L>, mu: L, softening_squared: L) -> LaneVec3<L> {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let squared = away.dot(away) + softening_squared;
    let inverse = L::select(zero.lt(squared), one / squared.sqrt(), zero);
    (away * inverse) * ((mu * inverse) * inverse)
}
