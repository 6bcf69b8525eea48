//! Where one frame is in another.

use glam::{DQuat, DVec3};

/// A pose: takes coordinates of the inner frame to those of the outer one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub(crate) position: DVec3,
    pub(crate) orientation: DQuat,
}

impl Frame {
    pub(crate) const IDENTITY: Self = Self { position: DVec3::ZERO, orientation: DQuat::IDENTITY };

    /// A frame given in this one, seen from where this one is given.
    pub(crate) fn then(self, inner: Self) -> Self {
        Self {
            position: self.position + self.orientation * inner.position,
            // A chain of a million joints must not add up their roundings.
            orientation: (self.orientation * inner.orientation).normalize(),
        }
    }

    /// The outer frame, seen from this one.
    pub(crate) fn inverse(self) -> Self {
        let orientation = self.orientation.conjugate();
        Self { position: orientation * -self.position, orientation }
    }
}

/// Roll, pitch and yaw about the fixed axes x, y and z, in this order:
/// `R = R_z(yaw) R_y(pitch) R_x(roll)`.
pub(crate) fn from_roll_pitch_yaw([roll, pitch, yaw]: [f64; 3]) -> DQuat {
    let about = |axis: DVec3, angle: f64| {
        // Not the platform's sine, which differs from one to the next.
        let (sine, cosine) = libm::sincos(0.5 * angle);
        DQuat::from_vec4((axis * sine).extend(cosine))
    };
    about(DVec3::Z, yaw) * about(DVec3::Y, pitch) * about(DVec3::X, roll)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Rounding of a quarter turn.
    const TOLERANCE: f64 = 1e-15;

    #[test]
    fn roll_comes_first_and_axes_are_fixed() {
        let turn = from_roll_pitch_yaw([FRAC_PI_2, 0.0, FRAC_PI_2]);
        // y is rolled to z, which yaw leaves alone; about moving axes it would end at x.
        assert!((turn * DVec3::Y - DVec3::Z).length() < TOLERANCE);
        let turn = from_roll_pitch_yaw([0.0, FRAC_PI_2, FRAC_PI_2]);
        assert!((turn * DVec3::Z - DVec3::Y).length() < TOLERANCE);
    }

    #[test]
    fn frames_follow_each_other() {
        let shoulder = Frame { position: DVec3::X, orientation: from_roll_pitch_yaw([0.0, 0.0, FRAC_PI_2]) };
        let hand = shoulder.then(Frame { position: DVec3::new(2.0, 0.0, 0.0), ..Frame::IDENTITY });
        assert!((hand.position - DVec3::new(1.0, 2.0, 0.0)).length() < TOLERANCE);
        assert_eq!(Frame::IDENTITY.then(Frame::IDENTITY), Frame::IDENTITY);
    }
}
