//! Promise: any rotation goes from one notation to another and back without loss: quaternion, 3x3
//! matrix, 4x4 transform, axis and angle, scaled axis, Euler angles in all 24 orders.
//!
//! It matters because every loss here looks like physics later: a body that jumps when its Euler
//! angles pass gimbal lock, or that will not start to turn because tiny angles vanish.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DMat4, DQuat, DVec3, DVec4, EulerRot};
use proptest::prelude::*;
use tumble_math::{
    NotARotation, angle_between, change_of_basis, cross_product_matrix, from_scaled_axis, left_multiplication_matrix,
    orientation_rate, quat_from_matrix, right_multiplication_matrix, rotate_exactly, rotate_to_first_order,
    to_axis_angle, to_euler, to_scaled_axis,
};

const EPS: f64 = f64::EPSILON;

const ORDERS: [EulerRot; 24] = [
    EulerRot::ZYX,
    EulerRot::ZXY,
    EulerRot::YXZ,
    EulerRot::YZX,
    EulerRot::XYZ,
    EulerRot::XZY,
    EulerRot::ZYXEx,
    EulerRot::ZXYEx,
    EulerRot::YXZEx,
    EulerRot::YZXEx,
    EulerRot::XYZEx,
    EulerRot::XZYEx,
    EulerRot::ZYZ,
    EulerRot::ZXZ,
    EulerRot::YXY,
    EulerRot::YZY,
    EulerRot::XYX,
    EulerRot::XZX,
    EulerRot::ZYZEx,
    EulerRot::ZXZEx,
    EulerRot::YXYEx,
    EulerRot::YZYEx,
    EulerRot::XYXEx,
    EulerRot::XZXEx,
];

/// The first twelve orders have three different axes and lock at a quarter turn, the others at none
/// and at half a turn.
fn lock(index: usize) -> [f64; 2] {
    if index < 12 { [-FRAC_PI_2, FRAC_PI_2] } else { [0.0, PI] }
}

/// Distance of two quaternions as rotations.
fn distance(a: DQuat, b: DQuat) -> f64 {
    let sign = if a.dot(b) < 0.0 { -1.0 } else { 1.0 };
    (a - b * sign).length()
}

/// Angles of every size down to 1e-18, and as close as that to half a turn.
fn any_angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        0.0..PI,
        (-18.0..0.5_f64).prop_map(|exponent| 10.0_f64.powf(exponent).min(PI)),
        (-18.0..0.0_f64).prop_map(|exponent| PI - 10.0_f64.powf(exponent)),
    ]
}

fn any_direction() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0_f64, -PI..PI).prop_map(|(z, phi)| {
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * phi.cos(), r * phi.sin(), z).normalize()
    })
}

fn any_rotation() -> impl Strategy<Value = DQuat> {
    (any_direction(), any_angle()).prop_map(|(axis, angle)| DQuat::from_axis_angle(axis, angle))
}

proptest! {
    #[test]
    fn matrix_and_back(q in any_rotation()) {
        let back = quat_from_matrix(DMat3::from_quat(q)).unwrap();
        // Nine elements of a few roundings each.
        prop_assert!(distance(back, q) <= 6.0 * EPS);
        prop_assert!(back.w >= 0.0);
        prop_assert!((back.length() - 1.0).abs() <= 2.0 * EPS);
    }

    #[test]
    fn transform_and_back(q in any_rotation(), p in any_direction()) {
        let transform = DMat4::from_rotation_translation(q, p * 100.0);
        prop_assert_eq!(transform.w_axis.truncate(), p * 100.0);
        prop_assert!(distance(quat_from_matrix(DMat3::from_mat4(transform)).unwrap(), q) <= 6.0 * EPS);
    }

    #[test]
    fn axis_angle_and_back(axis in any_direction(), angle in any_angle()) {
        let q = DQuat::from_axis_angle(axis, angle);
        let (axis_back, angle_back) = to_axis_angle(q);
        // The angle to its own rounding when small, to that of pi when near half a turn.
        prop_assert!((angle_back - angle).abs() <= 4.0 * EPS * angle.max(1e-300));
        // Half a turn about n is half a turn about -n.
        let sense = if axis_back.dot(axis) < 0.0 { -1.0 } else { 1.0 };
        prop_assert!(sense > 0.0 || angle > PI - 4.0 * EPS);
        prop_assert!((axis_back * sense - axis).length() <= 4.0 * EPS);
        prop_assert_eq!(to_axis_angle(-q), (axis_back, angle_back));
    }

    #[test]
    fn scaled_axis_and_back(axis in any_direction(), angle in any_angle(), exponent in -300.0..0.0_f64) {
        // Closer to half a turn, rounding may carry the angle past pi, where it comes back about
        // the other end of the axis.
        let v = axis * angle.min(PI - 32.0 * EPS);
        // Direction made unit twice, 4 roundings each; the angle through sine and arc tangent, 12:
        // 20 halves of an eps.
        prop_assert!((to_scaled_axis(from_scaled_axis(v)) - v).length() <= 10.0 * EPS * v.length());
        // Down to where the square of the angle is no number any more.
        let tiny = axis * 10.0_f64.powf(exponent);
        let error = (to_scaled_axis(from_scaled_axis(tiny)) - tiny).abs().max_element();
        prop_assert!(error <= 10.0 * EPS * tiny.abs().max_element());
    }

    #[test]
    fn euler_angles_and_back(first in -PI..PI, third in -PI..PI, exponent in -18.0..0.2_f64, end in 0..2_usize) {
        for (index, order) in ORDERS.into_iter().enumerate() {
            let lock = lock(index);
            // From one end of the range inwards by 1e-18 to 1.6 rad.
            let inwards = 10.0_f64.powf(exponent).min(PI) * (1.0 - 2.0 * end as f64);
            let q = DQuat::from_euler(order, first, lock[end] + inwards, third);
            let (a, b, c) = to_euler(q, order);
            // A few roundings, and within 2e-15 of the lock what setting the third angle to zero
            // leaves out: 4 eps.
            prop_assert!(distance(DQuat::from_euler(order, a, b, c), q) <= 10.0 * EPS, "{:?}", order);
            prop_assert!(lock[0] <= b && b <= lock[1], "{:?} {}", order, b);
            prop_assert!(a.abs() <= PI && c.abs() <= PI);
        }
    }

    #[test]
    fn at_gimbal_lock_the_last_angle_is_zero(first in -3.0..3.0_f64, third in -3.0..3.0_f64) {
        for (index, order) in ORDERS.into_iter().enumerate() {
            for end in lock(index) {
                let q = DQuat::from_euler(order, first, end, third);
                let (a, b, c) = to_euler(q, order);
                prop_assert_eq!(c, 0.0, "{:?}", order);
                prop_assert!((b - end).abs() <= 4.0 * EPS);
                // Only the sum or the difference of the two turns is left.
                let left = [first + third, first - third].map(|sum| from_scaled_axis(DVec3::X * (sum - a)).w.abs());
                prop_assert!(left.into_iter().any(|cosine| cosine >= 1.0 - 4.0 * EPS), "{:?}", order);
            }
        }
    }

    #[test]
    fn multiplication_matrices(a in any_rotation(), b in any_rotation(), p in any_direction()) {
        let product = DVec4::from(a * b);
        prop_assert!((left_multiplication_matrix(a) * DVec4::from(b) - product).length() <= 4.0 * EPS);
        prop_assert!((right_multiplication_matrix(b) * DVec4::from(a) - product).length() <= 4.0 * EPS);
        // q [p, 0] q* as two matrices is the rotation matrix, bordered by a one.
        let sandwich = left_multiplication_matrix(a) * right_multiplication_matrix(a.conjugate());
        prop_assert!(sandwich.abs_diff_eq(DMat4::from_quat(a), 4.0 * EPS));
        prop_assert!((sandwich * p.extend(0.0) - (a * p).extend(0.0)).length() <= 8.0 * EPS);
    }

    #[test]
    fn change_of_basis_is_the_map_seen_from_elsewhere(
        q in any_rotation(),
        v in any_direction(),
        elements in prop::array::uniform9(-1.0..1.0_f64),
    ) {
        let m = DMat3::from_cols_array(&elements);
        let seen = change_of_basis(m, q);
        // An element of the rotation matrix is off by up to 10 eps, so R m R^T by 25 eps of the
        // norm of m, at most 3.
        prop_assert!((seen * (q * v) - q * (m * v)).length() <= 80.0 * EPS);
        let symmetric = change_of_basis(m + m.transpose(), q);
        prop_assert_eq!(symmetric, symmetric.transpose());
    }

    #[test]
    fn slerp_turns_at_a_constant_rate(
        q in any_rotation(),
        axis in any_direction(),
        angle in 0.0..3.1_f64,
        s in 0.0..1.0_f64,
    ) {
        let end = from_scaled_axis(axis * angle) * q;
        let expected = from_scaled_axis(axis * (angle * s)) * q;
        // Both ends are rounded; near half a turn that is magnified by 1/cos(angle/2), at most 48.
        let tolerance = 8.0 * EPS / (0.5 * angle).cos();
        prop_assert!(distance(q.slerp(end, s), expected) <= tolerance);
        prop_assert!(distance(q.slerp(-end, s), expected) <= tolerance, "the short way, whatever the sign");
    }

    #[test]
    fn angles_between_orientations(q in any_rotation(), axis in any_direction(), angle in any_angle()) {
        let other = q * DQuat::from_axis_angle(axis, angle);
        // Four roundings in each product, twice, and the angle's own.
        prop_assert!((angle_between(q, other) - angle).abs() <= 16.0 * EPS);
        prop_assert_eq!(angle_between(q, q), 0.0);
    }
}

#[test]
fn the_second_factor_turns_first() {
    let (first, second) = (DQuat::from_rotation_x(FRAC_PI_2), DQuat::from_rotation_z(FRAC_PI_2));
    // y goes to z about x, and z stays about z.
    assert!(((second * first) * DVec3::Y - DVec3::Z).length() <= 2.0 * EPS);
    assert!(((first * second) * DVec3::Y + DVec3::X).length() <= 2.0 * EPS);
}

/// Gimbal lock shown: two different pairs of yaw and roll are the same orientation, and glam's own
/// `to_euler` loses that orientation near it, which is why this project has one. If the last
/// assertion fails, glam has become exact and ours can go.
#[test]
fn gimbal_lock() {
    let up = |yaw: f64, roll: f64| DQuat::from_euler(EulerRot::ZYX, yaw, FRAC_PI_2, roll);
    assert!(distance(up(0.7, 0.2), up(0.9, 0.4)) <= 2.0 * EPS);

    let worst = |to_euler: fn(DQuat, EulerRot) -> (f64, f64, f64), from_lock: f64| {
        (0..1000).fold(0.0_f64, |worst, n| {
            let (yaw, roll) = ((0.006 * f64::from(n)) - 3.0, 2.9 - 0.0057 * f64::from(n));
            let q = DQuat::from_euler(EulerRot::ZYX, yaw, FRAC_PI_2 - from_lock, roll);
            let (a, b, c) = to_euler(q, EulerRot::ZYX);
            worst.max(distance(DQuat::from_euler(EulerRot::ZYX, a, b, c), q))
        })
    };
    for from_lock in [1e-14, 1e-10, 1e-6] {
        assert!(worst(to_euler, from_lock) <= 6.0 * EPS);
    }
    // Why there is one of our own. Where this fails, glam's has been mended and ours can go.
    assert!(worst(DQuat::to_euler, 1e-10) > 1e-7);
    assert!(worst(DQuat::to_euler, 1e-14) > 1e-3);
}

proptest! {
    /// Orientation updates: `[cos, sin w/|w|] q` is the scaled axis `w dt` put before q; its rate
    /// at the start is `1/2 [0, w] q`; the first-order update turns by `2 atan(|w| dt/2)` about the
    /// same axis.
    #[test]
    fn orientation_updates(q in any_rotation(), axis in any_direction(), speed in 0.0..20.0_f64, dt in 1e-3..0.1_f64) {
        let w = axis * speed;
        let exact = DQuat::from(rotate_exactly(q.into(), w.into(), dt));
        prop_assert!(distance(exact, from_scaled_axis(w * dt) * q) <= 8.0 * EPS);
        let first_order = DQuat::from(rotate_to_first_order(q.into(), w.into(), dt));
        let angle = 2.0 * (0.5 * speed * dt).atan();
        prop_assert!(distance(first_order, from_scaled_axis(axis * angle) * q) <= 8.0 * EPS);
        // A central difference over 1e-4 rad is off by the square of the half angle, 2.5e-9/6,
        // relative to the rate.
        let h = 1e-4 / speed.max(1.0);
        let ahead = DQuat::from(rotate_exactly(q.into(), w.into(), h));
        let behind = DQuat::from(rotate_exactly(q.into(), w.into(), -h));
        let rate = DQuat::from(orientation_rate(q.into(), w.into()));
        prop_assert!(((ahead - behind) * (0.5 / h) - rate).length() <= 1e-9 * speed.max(1.0));
    }
}

/// Angular velocities add as vectors: of two turns at once, what their order changes is of second
/// order in time.
#[test]
fn angular_velocities_add() {
    let (a, b) = (DVec3::new(0.3, -1.0, 2.0), DVec3::new(1.5, 0.4, -0.2));
    let error = |dt: f64| {
        let both = from_scaled_axis(b * dt) * from_scaled_axis(a * dt);
        angle_between(both, from_scaled_axis((a + b) * dt))
    };
    // |a x b| dt^2 / 2 to leading order.
    let expected = 0.5 * a.cross(b).length() * 1e-6;
    assert!((error(1e-3) / expected - 1.0).abs() < 1e-2, "the next order is 1e-3 of it");
    assert!((error(1e-3) / error(5e-4) - 4.0).abs() < 1e-2);
}

/// Seed 000: integrating `dR/dt = w* R` and `dq/dt = 1/2 w q` by Euler steps. Each step stretches
/// the matrix by `sqrt(1 + (w dt)^2)` and the quaternion by `sqrt(1 + (w dt)^2/4)`, a quarter of
/// it, and normalising repairs the quaternion altogether.
#[test]
fn a_quaternion_drifts_less_than_a_matrix() {
    let (w, dt) = (DVec3::new(1.0, 2.0, 2.0), 0.01);
    let (mut r, mut q, mut normalised) = (DMat3::IDENTITY, DQuat::IDENTITY, DQuat::IDENTITY);
    let rate = |q: DQuat| DQuat::from(orientation_rate(q.into(), w.into()));
    for _ in 0..1000 {
        r += cross_product_matrix(w) * r * dt;
        q = q + rate(q) * dt;
        normalised = (normalised + rate(normalised) * dt).normalize();
    }
    // The matrix stretches across the axis only: its determinant is the square of the stretch.
    let matrix_drift = 0.5 * r.determinant().ln();
    let quaternion_drift = q.length().ln();
    assert!((matrix_drift / (500.0 * 9e-4_f64.ln_1p()) - 1.0).abs() < 1e-12, "{matrix_drift}: 57 % too long");
    assert!((matrix_drift / quaternion_drift - 4.0).abs() < 5e-3, "{}", matrix_drift / quaternion_drift);
    assert!((normalised.length() - 1.0).abs() <= 2.0 * EPS);
    // Normalised, only the angle is off: n (theta - 2 atan(theta/2)) = n theta^3/12.
    let error = angle_between(normalised, from_scaled_axis(w * 10.0));
    assert!((error / (1000.0 * 0.03_f64.powi(3) / 12.0) - 1.0).abs() < 1e-3, "{error}");
}

#[test]
fn what_is_no_rotation_is_refused() {
    let mirror = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
    assert!(matches!(quat_from_matrix(mirror), Err(NotARotation::Reflection { determinant: -1.0 })));
    let stretched = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.001));
    assert!(matches!(quat_from_matrix(stretched), Err(NotARotation::NotOrthonormal { .. })));
    for bad in [DMat3::ZERO, DMat3::NAN, DMat3::IDENTITY * f64::INFINITY, DMat3::IDENTITY * 1e300] {
        assert!(quat_from_matrix(bad).is_err(), "{bad}");
    }
    // A rotation that has been through f32 passes, and comes back within its rounding.
    let q = DQuat::from_xyzw(0.1, -0.7, 0.2, 0.3).normalize();
    let rounded = DMat3::from_quat(q).as_mat3().as_dmat3();
    assert!(distance(quat_from_matrix(rounded).unwrap(), q) < 2.0 * f64::from(f32::EPSILON));
}

#[test]
fn nonsense_stays_quiet() {
    // No rotation to be read from these: the answer is "none", and nothing panics.
    for q in [DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), DQuat::NAN, DQuat::from_xyzw(f64::INFINITY, 0.0, 0.0, 1.0)] {
        assert_eq!(to_axis_angle(q), (DVec3::X, 0.0));
        assert_eq!(to_scaled_axis(q), DVec3::ZERO);
        let _ = to_euler(q, EulerRot::XYZ);
    }
    assert!(from_scaled_axis(DVec3::NAN).is_nan());
    assert_eq!(from_scaled_axis(DVec3::ZERO), DQuat::IDENTITY);
    assert!((from_scaled_axis(DVec3::X * 1e300).length() - 1.0).abs() <= 2.0 * EPS);
}
