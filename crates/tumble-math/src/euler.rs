//! Euler angles that stay exact next to gimbal lock.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DQuat, EulerRot};

/// The three angles \[rad\] of a rotation in the order `order`, so that
/// `DQuat::from_euler(order, first, second, third)` is `q` again, up to sign, within rounding. `q`
/// need not be of unit length.
///
/// The first and third angle are in `(-pi, pi]`; the second is in `[-pi/2, pi/2]` for three
/// different axes and in `[0, pi]` where the first and the third axis are the same. `EulerRot::XYZ`
/// and its like turn about the body's moving axes (intrinsic), `EulerRot::XYZEx` and its like about
/// fixed axes (extrinsic).
///
/// *Gimbal lock*: with the second angle at the end of its range (within 2e-15 rad) the first and
/// the third turn about the same line, so only their sum or difference means anything; the third is
/// then set to zero. Close to the lock each of the two has a large error, but their sum or
/// difference, and so the rotation itself, is exact. That is why this function exists:
/// `DQuat::to_euler` takes each angle apart from the other and is wrong by more than 1e-7 as an
/// orientation at 1e-10 rad from the lock, and by more than 1e-3 at 1e-14.
///
/// A quaternion that is not finite gives NaN.
///
/// Method: half angles straight from the quaternion. E. Bernardes, S. Viollet, "Quaternion to Euler
/// angles conversion: a direct, general and computationally efficient method", PLoS ONE 17 (2022)
/// e0276302.
///
/// ```
/// use glam::{DQuat, EulerRot};
/// use std::f64::consts::FRAC_PI_2;
/// use tumble_math::to_euler;
///
/// // Nose straight up: yaw and roll are one turn.
/// let locked = DQuat::from_euler(EulerRot::ZYX, 0.3, FRAC_PI_2, 0.1);
/// let (yaw, pitch, roll) = to_euler(locked, EulerRot::ZYX);
/// assert!((yaw - 0.2).abs() < 1e-15 && (pitch - FRAC_PI_2).abs() < 1e-15 && roll == 0.0);
/// ```
#[must_use]
pub fn to_euler(q: DQuat, order: EulerRot) -> (f64, f64, f64) {
    let ([first, middle, last], frame) = axes(order);
    // The derivation is for fixed axes; a turn about moving axes is one about fixed axes in the
    // reverse order.
    let (i, j, last) = match frame {
        Frame::Fixed => (first, middle, last),
        Frame::Moving => (last, middle, first),
    };
    let repeated = i == last;
    let k = 3 - i - j;
    let parity = if (i + 1) % 3 == j { 1.0 } else { -1.0 };
    let v = [q.x, q.y, q.z];
    let (qi, qj, qk) = (v[i], v[j], v[k] * parity);
    let (a, b, c, d) = if repeated { (q.w, qi, qj, qk) } else { (q.w - qj, qi + qk, qj + q.w, qk - qi) };

    let (cosine, sine) = (a.hypot(b), c.hypot(d));
    let mut second = 2.0 * sine.atan2(cosine);
    // A pair that is all rounding has no direction; its half angle is chosen so that the third
    // angle becomes zero.
    let rounding = 4.0 * f64::EPSILON * cosine.max(sine);
    let keep = if frame == Frame::Moving { 1.0 } else { -1.0 };
    let (half_sum, half_difference) = if sine <= rounding {
        let half_sum = b.atan2(a);
        (half_sum, keep * half_sum)
    } else if cosine <= rounding {
        let half_difference = d.atan2(c);
        (keep * half_difference, half_difference)
    } else {
        (b.atan2(a), d.atan2(c))
    };
    let (turn_i, mut turn_last) = (half_sum - half_difference, half_sum + half_difference);
    if !repeated {
        second -= FRAC_PI_2;
        turn_last *= parity;
    }
    let (turn_i, turn_last) = (wrapped(turn_i), wrapped(turn_last));
    match frame {
        Frame::Fixed => (turn_i, second, turn_last),
        Frame::Moving => (turn_last, second, turn_i),
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Frame {
    Fixed,
    Moving,
}

/// The axes (x = 0) in the order in which the angles are given.
fn axes(order: EulerRot) -> ([usize; 3], Frame) {
    use Frame::{Fixed, Moving};
    const X: usize = 0;
    const Y: usize = 1;
    const Z: usize = 2;
    match order {
        EulerRot::ZYX => ([Z, Y, X], Moving),
        EulerRot::ZXY => ([Z, X, Y], Moving),
        EulerRot::YXZ => ([Y, X, Z], Moving),
        EulerRot::YZX => ([Y, Z, X], Moving),
        EulerRot::XYZ => ([X, Y, Z], Moving),
        EulerRot::XZY => ([X, Z, Y], Moving),
        EulerRot::ZYZ => ([Z, Y, Z], Moving),
        EulerRot::ZXZ => ([Z, X, Z], Moving),
        EulerRot::YXY => ([Y, X, Y], Moving),
        EulerRot::YZY => ([Y, Z, Y], Moving),
        EulerRot::XYX => ([X, Y, X], Moving),
        EulerRot::XZX => ([X, Z, X], Moving),
        EulerRot::ZYXEx => ([Z, Y, X], Fixed),
        EulerRot::ZXYEx => ([Z, X, Y], Fixed),
        EulerRot::YXZEx => ([Y, X, Z], Fixed),
        EulerRot::YZXEx => ([Y, Z, X], Fixed),
        EulerRot::XYZEx => ([X, Y, Z], Fixed),
        EulerRot::XZYEx => ([X, Z, Y], Fixed),
        EulerRot::ZYZEx => ([Z, Y, Z], Fixed),
        EulerRot::ZXZEx => ([Z, X, Z], Fixed),
        EulerRot::YXYEx => ([Y, X, Y], Fixed),
        EulerRot::YZYEx => ([Y, Z, Y], Fixed),
        EulerRot::XYXEx => ([X, Y, X], Fixed),
        EulerRot::XZXEx => ([X, Z, X], Fixed),
    }
}

/// The same angle in `(-pi, pi]`, from `[-2 pi, 2 pi]`.
fn wrapped(angle: f64) -> f64 {
    if angle > PI {
        angle - TAU
    } else if angle <= -PI {
        angle + TAU
    } else {
        angle
    }
}
