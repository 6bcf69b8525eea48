//! Unit vectors and quaternions from rounded or badly scaled input.

use glam::{DQuat, DVec3};

/// How far from one the length of a quaternion may be and still be taken as a rounded unit
/// quaternion. Three decimals is what people write by hand; further off is a mistake, not rounding.
pub(crate) const UNIT_TOLERANCE: f64 = 1e-3;

/// `v / |v|`, or `None` where `v` is zero or not finite. Scaled first, so that `|v|^2` neither
/// overflows (1e300) nor vanishes (1e-300).
pub(crate) fn unit_vector(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if !v.is_finite() || largest == 0.0 {
        return None;
    }
    let scaled = if largest < f64::MIN_POSITIVE {
        // A subnormal would overflow as a divisor of one: lift it by a power of two first.
        let lifted = v * 2f64.powi(100);
        lifted / lifted.abs().max_element()
    } else {
        v / largest
    };
    Some(scaled / scaled.length())
}

/// `q / |q|` if `|q|` is within [`UNIT_TOLERANCE`] of one, else the length `|q|` as the error.
pub(crate) fn unit_quaternion(q: DQuat) -> Result<DQuat, f64> {
    let length = q.length();
    if (length - 1.0).abs() <= UNIT_TOLERANCE { Ok(q * (1.0 / length)) } else { Err(length) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_survives_any_scale() {
        let expected = DVec3::new(1.0, -2.0, 2.0) / 3.0;
        for scale in [1.0, 1e300, 1e-300, 1e-320 / 1.0] {
            let v = DVec3::new(1.0, -2.0, 2.0) * scale;
            let error = (unit_vector(v).unwrap() - expected).length();
            // A subnormal holds few digits: 1e-320 is 2024 times the smallest number.
            let tolerance = if scale < 1e-310 { 1e-3 } else { 4.0 * f64::EPSILON };
            assert!(error <= tolerance, "{scale}: {error}");
        }
    }

    #[test]
    fn what_has_no_direction_is_none() {
        for v in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::new(1.0, f64::NAN, 0.0)] {
            assert_eq!(unit_vector(v), None);
        }
    }

    #[test]
    fn a_rounded_unit_quaternion_is_normalised_and_others_are_refused() {
        let q = unit_quaternion(DQuat::from_xyzw(0.0, 0.6, 0.0, 0.8005)).unwrap();
        assert!((q.length() - 1.0).abs() <= 2.0 * f64::EPSILON);
        assert_eq!(unit_quaternion(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0)), Err(0.0));
        assert!(unit_quaternion(DQuat::from_xyzw(0.0, 0.0, 0.0, 1.01)).is_err());
        assert!(unit_quaternion(DQuat::from_xyzw(0.0, f64::NAN, 0.0, 1.0)).is_err());
    }
}
