//! Quadratic drag along the body axes, relative to the wind.

use tumble_math::lane::{Lane, Vec3 as LaneVec3};

use crate::forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
use crate::math::{Real, Vec3};

/// Resistance that grows with the square of speed: `F = -|u| K u` with `u` the velocity relative to
/// the [`Wind`](crate::Wind), and `torque = -|w| C w`.
///
/// `K` and `C` are diagonal in the body's axes: a plate that meets the air with its face has more
/// in that direction than along it, and is carried sideways. With three equal numbers the drag is
/// the same in every attitude. For resistance in proportion to speed there is
/// [`Damping`](crate::Damping).
///
/// Under `MoserVeselov` and `SemiImplicitEuler` it never takes away more than the velocity there
/// is, so light things in a storm stay where they should.
///
/// A sphere alone that starts at speed `v` has `v/(1 + v K t/M)` after a time `t`. It has no
/// potential.
///
/// ```
/// # use tumble::Drag;
/// // Air of 1.2 kg/m^3, a ball 0.2 m across with a drag coefficient of 0.47.
/// let ball = Drag::isotropic(0.5 * 1.2 * 0.47 * 3.1416 * 0.1 * 0.1);
/// assert!((ball.linear.x - 0.00886).abs() < 1e-4);
/// ```
#[doc(alias = "air resistance")]
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Drag {
    /// Force over the square of speed along each axis of the body [kg/m]: half the density of the
    /// medium times coefficient times area.
    pub linear: Vec3,
    /// Torque over the square of angular speed about each axis of the body [kg m^2].
    pub angular: Vec3,
}

impl Drag {
    /// The same resistance in every direction [kg/m], none to turning.
    pub fn isotropic(linear: Real) -> Self {
        Self { linear: Vec3::splat(linear), angular: Vec3::ZERO }
    }
}

impl SimdForceLaw<6> for Drag {
    fn numbers(&self) -> [Real; 6] {
        let (k, c) = (self.linear, self.angular);
        [k.x, k.y, k.z, c.x, c.y, c.z]
    }

    #[inline(always)]
    fn wrench<L: Lane>([kx, ky, kz, cx, cy, cz]: [L; 6], body: &SimdBody<L>) -> SimdWrench<L> {
        let (u, w) = (body.linear_velocity - body.wind, body.angular_velocity);
        let mass = LaneVec3::splat(body.mass);
        SimdWrench {
            force: resistance(body, u, LaneVec3::new(kx, ky, kz), mass),
            torque: resistance(body, w, LaneVec3::new(cx, cy, cz), body.least_inertia()),
        }
    }
}

/// `-|u| K u`, with K along the body's axes; at the most what lets a kick take away
/// all of the velocity there.
#[inline(always)]
fn resistance<L: Lane>(body: &SimdBody<L>, u: LaneVec3<L>, k: LaneVec3<L>, inertia: LaneVec3<L>) -> LaneVec3<L> {
    let speed = u.dot(u).sqrt();
    let most = inertia * (L::splat(1.0) / (speed * body.kick));
    // `min` takes K where there is no limit: for a point, which does not turn.
    let k = LaneVec3::new(most.x.min(k.x), most.y.min(k.y), most.z.min(k.z));
    body.orientation.rotate(body.orientation.rotate_back(u).scale(k)) * -speed
}
