//! Promise: every way to write a rotation agrees with 40-digit figures, both ways, tiny angles,
//! half turns and all branches included.
//!
//! Every figure of `tests/data/rotations_*.json` is compared at the tolerance stated in the file.
//! glam's own conversions are compared where this project relies on them, so an update of glam that
//! loses digits fails here. Worst errors are printed with `--nocapture`.

use std::f64::consts::{PI, TAU};

use crate::reference::{Check, list, matrix};
use glam::{DMat3, DMat4, DQuat, DVec4, EulerRot};
use tumble_math::{
    angle_between, from_scaled_axis, left_multiplication_matrix, quat_from_matrix, right_multiplication_matrix,
    to_axis_angle, to_euler, to_scaled_axis,
};
use tumble_tests::largest;
use tumble_tests::references::{number, parse, quaternion, vector};

/// Absolute errors: elements of rotations are at most one.
impl Check {
    /// As rotations, so up to sign.
    fn rotation(&mut self, what: &str, actual: DQuat, expected: DQuat) {
        let sign = if actual.dot(expected) < 0.0 { -1.0 } else { 1.0 };
        self.error(what, DVec4::from(actual * sign - expected).abs().max_element());
    }

    fn rotation_matrix(&mut self, what: &str, actual: DMat3, expected: DMat3) {
        self.error(what, largest(actual - expected));
    }
}

#[test]
fn axis_and_angle() {
    let file = parse(include_str!("../../data/rotations_axis_angle.json"));
    let mut check = Check::new("rotations_axis_angle", &file);
    assert_eq!(list(&file, "vectors").len(), 98);
    for record in list(&file, "vectors") {
        let (axis, angle) = (vector(&record["axis"]).normalize(), number(&record["angle"]));
        let (q, r) = (quaternion(&record["q_wxyz"]), matrix(&record["R"]));
        let what = format!("{axis} by {angle}");
        check.rotation(&what, DQuat::from_axis_angle(axis, angle), q);
        check.rotation(&what, from_scaled_axis(axis * angle), q);
        check.rotation_matrix(&what, DMat3::from_axis_angle(axis, angle), r);
        check.rotation_matrix(&what, DMat3::from_mat4(DMat4::from_axis_angle(axis, angle)), r);
        check.rotation_matrix(&what, DMat3::from_quat(q), r);
        let from_r = quat_from_matrix(r).unwrap();
        check.rotation(&what, from_r, q);
        assert!(from_r.w >= 0.0);

        // Back: the angle comes out in [0, pi], the axis turned round where the angle was beyond.
        let (folded, sense) = if angle > PI { (TAU - angle, -1.0) } else { (angle, 1.0) };
        for q in [q, -q] {
            let (axis_back, angle_back) = to_axis_angle(q);
            check.error(&what, (angle_back - folded).abs());
            check.vector(&what, to_scaled_axis(q), axis * sense * folded);
            if angle > 0.0 {
                check.vector(&what, axis_back, axis * sense);
                // Tiny angles keep all their digits: twice the rounding of the quaternion.
                let exact = folded > 1e-3 || angle > PI || (angle_back / folded - 1.0).abs() <= 4.0 * f64::EPSILON;
                assert!(exact, "{what}: {angle_back}");
            }
        }
    }
    check.report();
}

/// The order type for a sequence such as `zyx`, about moving axes and about fixed ones.
fn orders(sequence: &str) -> [EulerRot; 2] {
    match sequence {
        "xyz" => [EulerRot::XYZ, EulerRot::XYZEx],
        "xzy" => [EulerRot::XZY, EulerRot::XZYEx],
        "yxz" => [EulerRot::YXZ, EulerRot::YXZEx],
        "yzx" => [EulerRot::YZX, EulerRot::YZXEx],
        "zxy" => [EulerRot::ZXY, EulerRot::ZXYEx],
        "zyx" => [EulerRot::ZYX, EulerRot::ZYXEx],
        "xyx" => [EulerRot::XYX, EulerRot::XYXEx],
        "xzx" => [EulerRot::XZX, EulerRot::XZXEx],
        "yxy" => [EulerRot::YXY, EulerRot::YXYEx],
        "yzy" => [EulerRot::YZY, EulerRot::YZYEx],
        "zxz" => [EulerRot::ZXZ, EulerRot::ZXZEx],
        "zyz" => [EulerRot::ZYZ, EulerRot::ZYZEx],
        other => panic!("no such sequence: {other}"),
    }
}

#[test]
fn euler_angles() {
    let file = parse(include_str!("../../data/rotations_euler.json"));
    let mut check = Check::new("rotations_euler", &file);
    let mut back = Check::new("rotations_euler, angles back", &file);
    // Angles from a rounded quaternion: 1.1e-16 a component is up to 2/cos(71.25 deg) = 6.2 times
    // that in the first and third angle, beside their own rounding (4.4e-16 above 2 rad).
    back.tolerance = 2e-15;
    assert_eq!(list(&file, "vectors").len(), 36);
    for record in list(&file, "vectors") {
        let sequence = record["sequence"].as_str().unwrap();
        let angles = vector(&record["angles_deg"]) * (PI / 180.0);
        let expected = [quaternion(&record["q_intrinsic_wxyz"]), quaternion(&record["q_extrinsic_wxyz"])];
        check.rotation_matrix(sequence, DMat3::from_quat(expected[0]), matrix(&record["R_intrinsic"]));
        for (order, expected) in orders(sequence).into_iter().zip(expected) {
            let what = format!("{order:?} {angles}");
            check.rotation(&what, DQuat::from_euler(order, angles.x, angles.y, angles.z), expected);
            let r = DMat3::from_euler(order, angles.x, angles.y, angles.z);
            check.rotation_matrix(&what, r, DMat3::from_quat(expected));
            check.rotation(&what, quat_from_matrix(r).unwrap(), expected);
            back.vector(&what, to_euler(expected, order).into(), angles);
            back.vector(&what, to_euler(-expected, order).into(), angles);
        }
    }
    check.report();
    back.report();
}

#[test]
fn matrices_and_quaternions() {
    let file = parse(include_str!("../../data/rotations_matrix_quaternion.json"));
    let mut check = Check::new("rotations_matrix_quaternion", &file);
    let mut largest_component = [0; 4];
    for record in list(&file, "matrix_to_quaternion") {
        let name = record["name"].as_str().unwrap();
        let (q, r) = (quaternion(&record["q_wxyz"]), matrix(&record["R"]));
        let actual = quat_from_matrix(r).unwrap();
        check.rotation(name, actual, q);
        check.rotation_matrix(name, DMat3::from_quat(q), r);
        let components = actual.to_array().map(f64::abs);
        let branch = (0..4).max_by(|&a, &b| components[a].total_cmp(&components[b])).unwrap();
        largest_component[branch] += 1;
    }
    assert!(largest_component.iter().all(|&count| count > 0), "all four branches: {largest_component:?}");
    check.report();
}

#[test]
fn composition() {
    let file = parse(include_str!("../../data/rotations_matrix_quaternion.json"));
    let mut check = Check::new("rotations_matrix_quaternion, composition", &file);
    for (index, record) in list(&file, "composition").iter().enumerate() {
        let what = format!("record {index}");
        let (a, b, ab) = (quaternion(&record["a"]), quaternion(&record["b"]), quaternion(&record["ab"]));
        check.rotation(&what, a * b, ab);
        check.rotation(&what, DQuat::from_vec4(left_multiplication_matrix(a) * DVec4::from(b)), ab);
        check.rotation(&what, DQuat::from_vec4(right_multiplication_matrix(b) * DVec4::from(a)), ab);
        let (v, turned) = (vector(&record["v"]), vector(&record["ab_rotates_v"]));
        // First b, then a. Relative to the length of the vector.
        check.vector(&what, (a * (b * v)) / v.length(), turned / v.length());
        check.vector(&what, (ab * v) / v.length(), turned / v.length());
        check.error(&what, (angle_between(a, b) - number(&record["angle_between"])).abs());
    }
    check.report();
}

/// Drake's exact solution for a constant angular velocity, and an attitude of NASA's JEOD.
#[test]
fn rotations_of_other_programs() {
    let file = parse(include_str!("../../data/rotations_third_party.json"));
    let mut check = Check::new("rotations_third_party", &file);
    let [drake, jeod] = list(&file, "rotations").as_slice() else { panic!("two records") };
    let turn = vector(&drake["axis"]) * (number(&drake["rate"]) * number(&drake["t"]));
    check.rotation("Drake", from_scaled_axis(turn), quaternion(&drake["q_wxyz"]));

    // JEOD's matrix takes inertial to body coordinates; ours take body to inertial.
    let body_to_inertial = matrix(&jeod["T_inertial_to_body"]).transpose();
    check.rotation("JEOD", quat_from_matrix(body_to_inertial).unwrap(), quaternion(&jeod["q_body_to_inertial_wxyz"]));
    // JEOD's own quaternion is a left transformation one: the conjugate.
    let [scalar, vector_part] = [&jeod["jeod_left_quaternion_scalar"], &jeod["jeod_left_quaternion_vector"]];
    let left = DQuat::from_vec4(vector(vector_part).extend(number(scalar)));
    check.rotation("JEOD's own", left.conjugate(), quaternion(&jeod["q_body_to_inertial_wxyz"]));
    check.report();
}
