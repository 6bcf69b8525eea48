//! Promise: inertia tensors obey the laws they come from, for any body, and no input panics.
//!
//! Invariants under rotation, the parallel-axis theorem there and back, and the eigen-solver on
//! equal, nearly equal and very different moments. Bodies of particles and shapes:
//! `particles_and_shapes.rs`.

use crate::strategies::{EPS, anything, length, rotation, vector};
use glam::{DMat3, DQuat, DVec3};
use proptest::prelude::*;
use tumble_math::{
    Amount, InertiaError, InertiaTensor, MassProperties, PrincipalInertia, Shape, angular_acceleration,
    torque_for_angular_acceleration,
};
use tumble_tests::largest;

/// `R A R^T` relative to the norm of A. Normalising leaves 1.75 eps in each component of the
/// quaternion, an element of R is then off by up to 10 eps, R as a whole by about as much, and it
/// enters twice; the two products add 5.
const TURN: f64 = 25.0 * EPS;

/// A quadratic form `n^T A n` of a vector made unit, relative to the norm of A.
const FORM: f64 = 8.0 * EPS;

/// Eigenvalues of a matrix by Jacobi, relative to the largest: some ten rotations of two roundings
/// each.
const JACOBI: f64 = 10.0 * EPS;

/// Moments of real bodies: second moments of mass along three axes, from 1e-6 (flat, thin) to 1.
fn moments() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-6.0..0.0_f64).prop_map(|exponents| {
        let [x, y, z] = exponents.map(|exponent| 10.0_f64.powf(exponent));
        DVec3::new(y + z, x + z, x + y)
    })
}

proptest! {
    #[test]
    fn turning_a_body_changes_no_moment(
        moments in moments(),
        axes in rotation(),
        turn in rotation(),
        axis in vector(1.0),
    ) {
        let body = InertiaTensor::from_principal(moments, axes).unwrap();
        let turned = body.rotated(turn).unwrap();
        let scale = moments.max_element();
        prop_assert_eq!(turned.matrix(), turned.matrix().transpose());
        prop_assert!((turned.moment_about(turn * axis) - body.moment_about(axis)).abs() <= (TURN + 2.0 * FORM) * scale);
        let back = turned.rotated(turn.conjugate()).unwrap();
        prop_assert!(largest(back.matrix() - body.matrix()) <= 2.0 * TURN * scale);
        let trace = |m: DMat3| m.x_axis.x + m.y_axis.y + m.z_axis.z;
        prop_assert!((trace(turned.matrix()) - trace(body.matrix())).abs() <= 3.0 * TURN * scale);
    }

    #[test]
    fn principal_axes(moments in moments(), axes in rotation()) {
        let body = InertiaTensor::from_principal(moments, axes).unwrap();
        check_principal(body, moments)?;
    }

    #[test]
    fn equal_and_nearly_equal_moments(
        apart in prop::array::uniform3(-17.0..-1.0_f64),
        equal in 0..3_usize,
        axes in rotation(),
    ) {
        let mut moments = DVec3::ONE + DVec3::from(apart.map(|exponent| 10.0_f64.powf(exponent)));
        moments[equal] = moments[(equal + 1) % 3];
        let body = InertiaTensor::from_principal(moments, axes).unwrap();
        check_principal(body, moments)?;
    }

    #[test]
    fn a_diagonal_tensor_is_its_own_answer(moments in moments()) {
        let body = InertiaTensor::new(DMat3::from_diagonal(moments)).unwrap();
        prop_assert_eq!(body.principal(), PrincipalInertia { moments, axes: DQuat::IDENTITY });
        prop_assert_eq!(body.inverse(), DMat3::from_diagonal(1.0 / moments));
    }

    #[test]
    fn the_inverse(moments in moments(), axes in rotation(), w in vector(3.0)) {
        let body = InertiaTensor::from_principal(moments, axes).unwrap();
        let condition = moments.max_element() / moments.min_element();
        prop_assert_eq!(body.inverse(), body.inverse().transpose());
        prop_assert!(largest(body.matrix() * body.inverse() - DMat3::IDENTITY) <= 16.0 * EPS * condition);
        // Euler's equation and its inverse, and the energy as half of w . L.
        let torque = torque_for_angular_acceleration(&body, w, DVec3::new(1.0, -2.0, 0.5));
        let a = angular_acceleration(&body, w, torque);
        prop_assert!((a - DVec3::new(1.0, -2.0, 0.5)).length() <= 32.0 * EPS * condition * (1.0 + w.length_squared()));
        let energy = 0.5 * w.dot(body.angular_momentum(w));
        prop_assert!((body.kinetic_energy(w) - energy).abs() <= 4.0 * EPS * energy);
    }

    #[test]
    fn world_angular_momentum(moments in moments(), axes in rotation(), orientation in rotation(), w in vector(1.0)) {
        let body = InertiaTensor::from_principal(moments, axes).unwrap();
        let world = body.rotated(orientation).unwrap();
        let momentum = body.principal().angular_momentum_world(orientation, w);
        // The body turned twice on one side; found, and turned by a product of quaternions, on the
        // other. |w| is at most 1.8.
        let tolerance = (4.0 * TURN + JACOBI) * 1.8;
        prop_assert!((momentum - world.angular_momentum(w)).length() <= tolerance * moments.max_element());
    }

    #[test]
    fn at_the_edge_of_rounding(exponent in -17.0..-12.0_f64, ratio in 0.0..1.0_f64, axes in rotation()) {
        // A rod with a little thickness: refused where rounding hides its smallest moment, and
        // sound where it is accepted.
        let thin = 10.0_f64.powf(exponent);
        if let Ok(rod) = InertiaTensor::from_principal([thin, 1.0, 1.0 - ratio * thin], axes) {
            prop_assert!(rod.principal().moments.min_element() > 0.0);
            let inverse = rod.inverse();
            prop_assert!(inverse.is_finite());
            prop_assert!(inverse.x_axis.x > 0.0 && inverse.y_axis.y > 0.0 && inverse.z_axis.z > 0.0);
            prop_assert!(rod.moment_about(axes * DVec3::X) < 1e-10);
        } else {
            prop_assert!(thin < 1e-14, "{}", thin);
        }
    }

    #[test]
    fn parallel_axes_there_and_back(
        moments in moments(),
        axes in rotation(),
        mass in 0.01..10.0_f64,
        offset in vector(2.0),
    ) {
        let center = InertiaTensor::from_principal(moments, axes).unwrap();
        let away = center.shifted_from_center(mass, offset).unwrap();
        let scale = largest(away.matrix());
        // About the axis through the offset nothing is added, across it m d^2.
        prop_assert!((away.moment_about(offset) - center.moment_about(offset)).abs() <= 2.0 * FORM * scale);
        let across = offset.any_orthogonal_vector();
        let steiner = center.moment_about(across) + mass * offset.length_squared();
        prop_assert!((away.moment_about(across) - steiner).abs() <= 2.0 * FORM * scale);
        // Back, either sign of the offset. What was lost in the sum is lost: the smallest moment
        // must exceed it.
        prop_assume!(moments.min_element() > 64.0 * EPS * scale);
        let back = away.shifted_to_center(mass, -offset).unwrap();
        prop_assert!(largest(back.matrix() - center.matrix()) <= 8.0 * EPS * scale);
    }

    #[test]
    fn about_any_axis(turn in rotation(), radius in length(), half_height in length(), mass in 0.1..10.0_f64) {
        // A cylinder along any axis: t E + (a - t) n n^T is the cylinder along y, turned.
        let upright = Shape::cylinder(radius, half_height).mass_properties(Amount::Mass(mass)).unwrap();
        let (t, a) = (upright.tensor_about_center().x_axis.x, upright.tensor_about_center().y_axis.y);
        let turned = upright.transformed([0.0; 3], turn).unwrap();
        let inertia = InertiaTensor::axisymmetric(a, t, turn * DVec3::Y * 3.0).unwrap();
        prop_assert!(largest(inertia.matrix() - turned.tensor_about_center()) <= TURN * a.max(t));
    }

    #[test]
    fn a_cuboid_about_its_long_diagonal(half in prop::array::uniform3(length()), mass in 0.1..10.0_f64) {
        // Seed 001: m/6 (W^2 D^2 + D^2 L^2 + W^2 L^2)/(W^2 + D^2 + L^2) with the full edges.
        let body = Shape::cuboid(half).mass_properties(Amount::Mass(mass)).unwrap();
        let [w, d, l] = half.map(|x| 4.0 * x * x);
        let expected = mass / 6.0 * (w * d + d * l + w * l) / (w + d + l);
        let actual = body.inertia().unwrap().moment_about(half);
        prop_assert!((actual / expected - 1.0).abs() <= 16.0 * EPS);
    }

    #[test]
    fn any_matrix_is_judged_without_a_panic(
        elements in prop::array::uniform9(anything()),
        symmetric: bool,
        tolerance in anything(),
    ) {
        let mut m = DMat3::from_cols_array(&elements);
        if symmetric {
            m = DMat3::from_cols(
                m.x_axis,
                DVec3::new(m.x_axis.y, m.y_axis.y, m.y_axis.z),
                DVec3::new(m.x_axis.z, m.y_axis.z, m.z_axis.z),
            );
        }
        if let Ok(inertia) = InertiaTensor::within_tolerance(m, tolerance) {
            prop_assert!(inertia.inverse().is_finite());
            prop_assert!(inertia.principal().moments.min_element() > 0.0);
            prop_assert!(inertia.principal().axes.is_finite());
        }
    }
}

/// Moments as given, axes that put the tensor together again, and the frame nearest the body's.
fn check_principal(body: InertiaTensor, moments: DVec3) -> Result<(), TestCaseError> {
    let scale = moments.max_element();
    let principal = body.principal();
    let sorted = |v: DVec3| {
        let mut v = v.to_array();
        v.sort_by(f64::total_cmp);
        DVec3::from(v)
    };
    // The tensor was rounded when it was put together, and no eigenvalue moves further than the
    // norm of that (Weyl).
    prop_assert!((sorted(principal.moments) - sorted(moments)).abs().max_element() <= (TURN + JACOBI) * scale);
    prop_assert!(largest(principal.matrix() - body.matrix()) <= (TURN + JACOBI) * scale);
    prop_assert!((principal.axes.length() - 1.0).abs() <= 2.0 * EPS && principal.axes.w >= 0.0);
    // The nearest of the 24 frames is the one with the largest w; no quarter or third of a turn may
    // better it.
    let (half, root) = (0.5, 0.5_f64.sqrt());
    for turn in [
        [root, 0.0, 0.0, root],
        [0.0, root, 0.0, root],
        [0.0, 0.0, root, root],
        [half, half, half, half],
        [half, -half, half, half],
        [half, half, -half, half],
        [-half, half, half, half],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [root, root, 0.0, 0.0],
        [root, -root, 0.0, 0.0],
        [root, 0.0, root, 0.0],
        [root, 0.0, -root, 0.0],
        [0.0, root, root, 0.0],
        [0.0, root, -root, 0.0],
    ] {
        let turn = DQuat::from_array(turn);
        for turn in [turn, turn.conjugate()] {
            prop_assert!((principal.axes * turn).w.abs() <= principal.axes.w + 4.0 * EPS, "{}", turn);
        }
    }
    Ok(())
}

#[test]
fn impossible_inertias_say_why() {
    let diagonal = |x, y, z| InertiaTensor::new(DMat3::from_diagonal(DVec3::new(x, y, z)));
    assert!(matches!(diagonal(0.0, 1.0, 1.0), Err(InertiaError::NotPositive { .. })), "zero moments are refused");
    assert!(matches!(diagonal(-1.0, 1.0, 1.0), Err(InertiaError::NotPositive { .. })));
    assert!(matches!(diagonal(1.0, f64::NAN, 1.0), Err(InertiaError::NotFinite { row: 1, column: 1, .. })));
    assert!(matches!(diagonal(1e-310, 1e-310, 1e-310), Err(InertiaError::OutOfRange { .. })));
    assert!(matches!(diagonal(1e308, 1e308, 1e308), Err(InertiaError::OutOfRange { .. })));
    let error = diagonal(1.0, 2.0, 4.0).unwrap_err();
    assert_eq!(error, InertiaError::TriangleInequality { principal: DVec3::new(1.0, 2.0, 4.0) });
    assert!(error.to_string().contains("(1.0, 2.0, 4.0)"), "{error}");

    // The tolerance is what it says: a millionth of the largest moment.
    assert!(diagonal(1.0, 2.0, 3.0 * (1.0 + 0.9e-6)).is_ok());
    assert!(diagonal(1.0, 2.0, 3.0 * (1.0 + 1.1e-6)).is_err());

    let mut lopsided = DMat3::from_diagonal(DVec3::new(2.0, 3.0, 4.0));
    lopsided.z_axis.x = 0.5; // row 0, column 2
    let error = InertiaTensor::new(lopsided).unwrap_err();
    assert_eq!(error, InertiaError::NotSymmetric { row: 0, column: 2, upper: 0.5, lower: 0.0 });

    // Within the tolerance the two halves are averaged.
    lopsided.z_axis.x = 3e-6;
    let mean = InertiaTensor::new(lopsided).unwrap().matrix();
    assert_eq!((mean.z_axis.x, mean.x_axis.z), (1.5e-6, 1.5e-6));

    let body = diagonal(2.0, 3.0, 4.0).unwrap();
    assert!(matches!(body.rotated(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0)), Err(InertiaError::Orientation { .. })));
    assert!(matches!(InertiaTensor::axisymmetric(1.0, 2.0, DVec3::ZERO), Err(InertiaError::Axis { .. })));
    assert!(matches!(body.shifted_from_center(f64::NAN, DVec3::X), Err(InertiaError::Mass { .. })));
    assert!(matches!(body.shifted_from_center(1.0, DVec3::X * 1e200), Err(InertiaError::Offset { .. })));
    assert!(matches!(body.shifted_to_center(100.0, DVec3::X), Err(InertiaError::NotPositive { .. })));
    assert!(body.moment_about(DVec3::ZERO).is_nan());
}

/// A flat plate, `I3 = I1 + I2`, that has been through f32 is still a body; a thin rod turned any
/// way is still none.
#[test]
fn single_precision_plates_pass_and_rods_do_not() {
    for n in 0..1000 {
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.1 * f64::from(n), 1.3 * f64::from(n), 0.7);
        let plate = InertiaTensor::from_principal([1.0 / 3.0, 0.7, 1.0 / 3.0 + 0.7], turn).unwrap();
        assert!(InertiaTensor::new(plate.matrix().as_mat3().as_dmat3()).is_ok());

        let rod = MassProperties::thin_rod(0.7, 3.0).unwrap().transformed(DVec3::ONE, turn).unwrap();
        assert!(matches!(rod.inertia(), Err(InertiaError::NotPositive { .. })), "{turn}");
        // Nor as a matrix that somebody wrote down.
        assert!(InertiaTensor::new(rod.tensor_about_center()).is_err(), "{turn}");
        // Turned by next to nothing, its own moment is nothing but rounding, however small the
        // element.
        let tilt = DQuat::from_rotation_z(10.0_f64.powf(-0.02 * f64::from(n)));
        let rod = MassProperties::thin_rod(0.7, 3.0).unwrap().transformed(DVec3::ZERO, tilt).unwrap();
        assert!(matches!(rod.inertia(), Err(InertiaError::NotPositive { .. })), "{tilt}");
    }
}
