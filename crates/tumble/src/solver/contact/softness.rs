//! Soft-constraint coefficients of contacts, from frequency, damping ratio and substep length.

use crate::math::Real;
use crate::simd::Tile;

/// How a contact pushes overlapping bodies apart: as a damped spring whose stiffness goes with the
/// mass it acts on.
///
/// With the angular frequency `w` and the damping ratio `z`, over a substep `h`: `a1 = 2 z + h w`,
/// `a2 = h w a1`, and the impulse that an implicit step of the oscillator gives is
/// `-(m (v + b) / K + i l)` with the velocity `v`, the impulse so far `l`, the bias `b = rate s` of
/// the overlap `s`, `m = a2/(1 + a2)`, `i = 1/(1 + a2)` and `rate = w/a1` (E. Catto, "Soft
/// Constraints", GDC 2011; "Solver2D", 2024).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Softness {
    /// Velocity out of an overlap of one metre [1/s].
    pub(crate) bias_rate: Real,
    pub(crate) mass_scale: Real,
    pub(crate) impulse_scale: Real,
}

/// Periods that a contact of two moving bodies has in a substep; one on a body that does not move
/// has twice as many. So contacts are as stiff as the substeps resolve, 30 Hz at the default of
/// four in 1/60 s: with stiffer ones, one pass over the contacts of a large pile does not come to
/// rest.
const PERIODS: f64 = 1.0 / 8.0;
/// Overdamped, so that bodies part without bouncing.
const DAMPING_RATIO: f64 = 10.0;
/// Of joints in passes: with more, or stiffer ones, one pass makes energy in loops on long arms.
const DAMPING_RATIO_OF_JOINTS: f64 = 1.0;

impl Softness {
    /// Between two moving bodies, for a substep of `h` \[s\].
    pub(crate) fn between_moving(h: f64) -> Self {
        Self::new(PERIODS / h, DAMPING_RATIO, h)
    }

    /// On a non-dynamic body. Stiffer, so that what is below in a stack gives way least.
    pub(crate) fn on_ground(h: f64) -> Self {
        Self::new(2.0 * PERIODS / h, 0.5 * DAMPING_RATIO, h)
    }

    /// Of joints in passes, between two moving bodies and on a non-dynamic one, for a substep of
    /// `h` \[s\].
    pub(crate) fn of_joints(h: f64) -> [Self; 2] {
        [1.0, 2.0].map(|times| Self::new(times * PERIODS / h, DAMPING_RATIO_OF_JOINTS, h))
    }

    /// Stiffness for each kilogram of effective mass [N/m/kg] in substeps of `h` \[s\], between
    /// dynamic bodies, and on a non-dynamic one.
    pub(crate) fn stiffness(h: f64) -> [Real; 2] {
        [1.0, 2.0].map(|times| crate::math::real((times * PERIODS / h * std::f64::consts::TAU).powi(2)))
    }

    fn new(hertz: f64, damping_ratio: f64, h: f64) -> Self {
        let omega = std::f64::consts::TAU * hertz;
        let a1 = 2.0 * damping_ratio + h * omega;
        let a2 = h * omega * a1;
        let impulse_scale = 1.0 / (1.0 + a2);
        Self {
            bias_rate: crate::math::real(omega / a1),
            mass_scale: crate::math::real(a2 * impulse_scale),
            impulse_scale: crate::math::real(impulse_scale),
        }
    }

    /// Bias of an overlap: how it acts on the velocity, capped at a speed that throws nothing up.
    #[inline(always)]
    pub(crate) fn bias<T: Tile>(&self, separation: T) -> T {
        let rate = T::splat(f64::from(self.mass_scale * self.bias_rate));
        (rate * separation).max(T::splat(-MAX_PUSH))
    }
}

/// Fastest that overlapping bodies are pushed apart \[m/s\].
pub(crate) const MAX_PUSH: f64 = 3.0;
