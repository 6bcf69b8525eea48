//! Yaw, pitch and roll angles of a rotation, and the rotation they describe.

use glam::{DQuat, EulerRot};

use crate::euler::to_euler;

/// Heading, elevation and bank of a vehicle whose body axes are x forward, y left or right, z up or
/// down: turned by `yaw` about z, then by `pitch` about the new y, then by `roll` about the new x
/// \[rad\] (`EulerRot::ZYX`).
///
/// ```
/// use tumble_math::YawPitchRoll;
/// let banked = YawPitchRoll { yaw: 0.3, pitch: -0.2, roll: 1.0 };
/// let found = YawPitchRoll::of(banked.rotation());
/// assert!(
///     (found.yaw - 0.3).abs() < 1e-15
///         && (found.pitch + 0.2).abs() < 1e-15
///         && (found.roll - 1.0).abs() < 1e-15
/// );
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct YawPitchRoll {
    /// About the body's z axis \[rad\].
    pub yaw: f64,
    /// About its y axis \[rad\].
    pub pitch: f64,
    /// About its x axis \[rad\].
    pub roll: f64,
}

impl YawPitchRoll {
    /// Of a rotation, which need not be of unit length: yaw and roll in `(-pi, pi]`, pitch in
    /// `[-pi/2, pi/2]`; with the nose straight up or down, roll is zero. As exact as [`to_euler`].
    #[must_use]
    pub fn of(rotation: DQuat) -> Self {
        let (yaw, pitch, roll) = to_euler(rotation, EulerRot::ZYX);
        Self { yaw, pitch, roll }
    }

    /// The rotation from body to world coordinates.
    #[must_use]
    pub fn rotation(&self) -> DQuat {
        DQuat::from_euler(EulerRot::ZYX, self.yaw, self.pitch, self.roll)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use std::f64::consts::FRAC_PI_2;

    /// Which is which: yaw turns the nose in the plane, pitch lifts or lowers it, roll leaves it.
    #[test]
    fn each_angle_does_what_its_name_says() {
        let turn = |yaw, pitch, roll| YawPitchRoll { yaw, pitch, roll }.rotation();
        assert!((turn(FRAC_PI_2, 0.0, 0.0) * DVec3::X).abs_diff_eq(DVec3::Y, 1e-15));
        assert!((turn(0.0, FRAC_PI_2, 0.0) * DVec3::X).abs_diff_eq(DVec3::NEG_Z, 1e-15));
        assert!((turn(0.0, 0.0, FRAC_PI_2) * DVec3::X).abs_diff_eq(DVec3::X, 1e-15));
        assert!((turn(0.0, 0.0, FRAC_PI_2) * DVec3::Y).abs_diff_eq(DVec3::Z, 1e-15));
        // In this order: a turn about the world's z by yaw comes last of all.
        let in_turn = DQuat::from_rotation_z(0.4) * DQuat::from_rotation_y(0.3) * DQuat::from_rotation_x(0.2);
        assert!(turn(0.4, 0.3, 0.2).dot(in_turn).abs() > 1.0 - 1e-15);
    }
}
