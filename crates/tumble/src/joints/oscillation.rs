//! Oscillating positions of drives.

use tumble_math::lane::Lane;

use crate::math::Real;

/// A sine that is added to the position of a [`Drive`](crate::Drive): the target is
/// `position + amplitude sin(2 pi hertz t + phase)` at the time `t` of the
/// [simulation](crate::Simulation::time), constant over each step, as it is in its middle. Its
/// speed is added to the drive's velocity.
///
/// ```
/// use tumble::{Axes, Drive, Oscillation};
///
/// let gait = Oscillation { amplitude: 0.3, hertz: 2.0, phase: 0.0 };
/// let hip = Drive::position(Axes::ANGULAR_X, 0.1).with_stiffness(200.0, 5.0);
/// let hip = hip.with_oscillation(gait);
/// assert_eq!(hip.oscillation, Some(gait));
/// ```
#[doc(alias("sine", "gait", "wave"))]
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Oscillation {
    /// The furthest from the drive's position \[m\] \[rad\].
    pub amplitude: Real,
    /// Periods a second \[Hz\].
    pub hertz: Real,
    /// At the time zero \[rad\].
    pub phase: Real,
}

impl Oscillation {
    pub(crate) fn is_in_range(&self) -> bool {
        [self.amplitude, self.hertz, self.phase].into_iter().all(Real::is_finite)
    }

    /// How far from the position the target is at a time \[s\], and its speed.
    pub(crate) fn at(&self, time: f64) -> [f64; 2] {
        let [amplitude, hertz, phase] = [self.amplitude, self.hertz, self.phase].map(f64::from);
        let periods = hertz * time;
        let (sin, cos) = Lane::sin_cos(std::f64::consts::TAU * (periods - periods.floor()) + phase);
        [amplitude * sin, std::f64::consts::TAU * hertz * amplitude * cos]
    }
}
