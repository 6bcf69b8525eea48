//! The torque of the motor on a wheel, and its slope.

use crate::settings::Motor;

/// The torque of one wheel as a straight line of its spin: `at_rest - slope spin`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TorqueLine {
    /// [N m]
    pub(crate) at_rest: f64,
    /// [N m s/rad], not negative.
    pub(crate) slope: f64,
}

/// Part of the greatest spin over which the motor's torque ends.
const FADE: f64 = 0.1;

impl TorqueLine {
    /// The tangent at a spin, of the wheel's share of the motor.
    pub(crate) fn at(motor: &Motor, share: f64, throttle: f64, spin: f64) -> Self {
        let most = f64::from(if throttle < 0.0 { motor.max_reverse_spin } else { motor.max_spin });
        let (torque, power) = (f64::from(motor.torque), f64::from(motor.power));
        let ahead = spin * throttle.signum();
        let (curve, slope) = match power / ahead {
            limited if ahead > 0.0 && limited < torque => (limited, limited / ahead),
            _ => (torque, 0.0),
        };
        let rest = (most - ahead) / (FADE * most);
        let (curve, slope) = match rest {
            _ if rest >= 1.0 => (curve, slope),
            _ if rest <= 0.0 => (0.0, 0.0),
            _ => (curve * rest, slope * rest + curve / (FADE * most)),
        };
        let scale = share * throttle.abs();
        Self { at_rest: throttle.signum() * scale * (curve + slope * ahead), slope: scale * slope }
    }
}
