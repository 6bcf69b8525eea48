//! Thrusters fixed to the body, summed to one force and torque under a common throttle.

use tumble_math::lane::{Lane, Vec3 as LaneVec3};

use crate::forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
use crate::math::{Real, Vec3};

/// Nozzles that are fixed to the body and push along its axes: each with a force at a point, all
/// opened by one throttle.
///
/// `F = throttle R f` and `torque = throttle R (p x f)`, summed over the nozzles. It pushes until
/// it is removed or the throttle closed; no potential.
///
/// ```
/// # use tumble::{Thruster, math::Vec3};
/// // Two nozzles that only turn the body.
/// let pair = Thruster::new(Vec3::Z, Vec3::X * 0.5).and(-Vec3::Z, Vec3::X * -0.5);
/// assert_eq!((pair.force, pair.torque), (Vec3::ZERO, Vec3::NEG_Y));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thruster {
    /// Sum of the forces at full throttle \[N\], body frame.
    pub force: Vec3,
    /// Sum of their torques about the centre of mass at full throttle [N m], body frame.
    pub torque: Vec3,
    /// How far the valves are open; 1 is full.
    pub throttle: Real,
}

impl Default for Thruster {
    /// No nozzles yet; those that are [added](Thruster::and) are at full throttle.
    fn default() -> Self {
        Self { force: Vec3::ZERO, torque: Vec3::ZERO, throttle: 1.0 }
    }
}

impl Thruster {
    /// One nozzle at full throttle: its force \[N\] and where it acts \[m\], from the centre of
    /// mass along the body's axes.
    pub fn new(force_body: Vec3, point_body: Vec3) -> Self {
        Self::default().and(force_body, point_body)
    }

    /// The same with one more nozzle.
    #[must_use]
    pub fn and(self, force_body: Vec3, point_body: Vec3) -> Self {
        Self { force: self.force + force_body, torque: self.torque + point_body.cross(force_body), ..self }
    }
}

impl SimdForceLaw<6> for Thruster {
    fn numbers(&self) -> [Real; 6] {
        let (f, t) = (self.force * self.throttle, self.torque * self.throttle);
        [f.x, f.y, f.z, t.x, t.y, t.z]
    }

    #[inline(always)]
    fn wrench<L: Lane>([fx, fy, fz, tx, ty, tz]: [L; 6], body: &SimdBody<L>) -> SimdWrench<L> {
        SimdWrench {
            force: body.orientation.rotate(LaneVec3::new(fx, fy, fz)),
            torque: body.orientation.rotate(LaneVec3::new(tx, ty, tz)),
        }
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }
}
