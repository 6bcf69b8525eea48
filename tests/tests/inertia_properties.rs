//! Promise: inertia tensors and mass properties obey the laws they come from, for any body, and no
//! input panics.
//!
//! Invariants under rotation, the parallel-axis theorem there and back, additivity, particles
//! against integrals, shapes cut up and put together, and the eigen-solver on equal, nearly equal
//! and very different moments.

use glam::{DMat3, DQuat, DVec3};
use proptest::prelude::*;
use tumble_math::{
    Amount, InertiaError, InertiaTensor, MassProperties, Part, PrincipalInertia, Shape, angular_acceleration,
    moment_about_axis, torque_for_angular_acceleration,
};

const EPS: f64 = f64::EPSILON;

/// `R A R^T` relative to the norm of A. Normalising leaves 1.75 eps in each component of the
/// quaternion, an element of R is then off by up to 10 eps, R as a whole by about as much, and it
/// enters twice; the two products add 5.
const TURN: f64 = 25.0 * EPS;

/// A quadratic form `n^T A n` of a vector made unit, relative to the norm of A.
const FORM: f64 = 8.0 * EPS;

/// Eigenvalues of a matrix by Jacobi, relative to the largest: some ten rotations of two roundings
/// each.
const JACOBI: f64 = 10.0 * EPS;

/// The largest absolute value of the elements; NaN if there is one.
fn largest(m: DMat3) -> f64 {
    if m.is_nan() { f64::NAN } else { m.to_cols_array().iter().fold(0.0, |largest: f64, x| largest.max(x.abs())) }
}

fn close(a: DMat3, b: DMat3, relative: f64) -> bool {
    largest(a - b) <= relative * largest(b)
}

fn same_body(a: &MassProperties, b: &MassProperties, relative: f64) -> bool {
    let size = (largest(b.tensor_about([0.0; 3])) / b.mass()).sqrt();
    (a.mass() - b.mass()).abs() <= relative * b.mass()
        && (a.center_of_mass() - b.center_of_mass()).length() <= relative * size.max(b.center_of_mass().length())
        && largest(a.tensor_about_center() - b.tensor_about_center()) <= relative * largest(b.tensor_about([0.0; 3]))
}

fn vector(range: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-range..range).prop_map(DVec3::from)
}

fn rotation() -> impl Strategy<Value = DQuat> {
    prop::array::uniform4(-1.0..1.0_f64)
        .prop_filter("a direction", |q| q.iter().map(|x| x * x).sum::<f64>() > 1e-3)
        .prop_map(|q| DQuat::from_array(q).normalize())
}

/// Moments of real bodies: second moments of mass along three axes, from 1e-6 (flat, thin) to 1.
fn moments() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-6.0..0.0_f64).prop_map(|exponents| {
        let [x, y, z] = exponents.map(|exponent| 10.0_f64.powf(exponent));
        DVec3::new(y + z, x + z, x + y)
    })
}

fn particles() -> impl Strategy<Value = Vec<(f64, DVec3)>> {
    prop::collection::vec((0.1..10.0_f64, vector(5.0)), 4..20)
}

fn length() -> impl Strategy<Value = f64> {
    0.1..3.0_f64
}

fn shape() -> impl Strategy<Value = Shape> {
    let lengths = || prop::array::uniform3(length());
    prop_oneof![
        length().prop_map(Shape::sphere),
        lengths().prop_map(Shape::cuboid),
        lengths().prop_map(|l| Shape::cylinder(l[0], l[1])),
        lengths().prop_map(|l| Shape::capsule(l[0], l[1])),
        lengths().prop_map(|l| Shape::cone(l[0], l[1])),
        lengths().prop_map(Shape::ellipsoid),
    ]
}

/// Any f64 at all, with the troublesome ones often.
fn anything() -> impl Strategy<Value = f64> {
    let troublesome =
        [0.0, -0.0, 1.0, -1.0, f64::NAN, f64::INFINITY, 1e300, -1e300, 1e-300, 1e-45, f64::MIN_POSITIVE, 5e-324];
    prop_oneof![any::<f64>(), prop::sample::select(troublesome.to_vec()), 0.5..2.0_f64]
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
    fn particles_are_the_definition(particles in particles(), point in vector(5.0), axis in vector(1.0)) {
        prop_assume!(axis.length() > 1e-3);
        let body = MassProperties::of_particles(particles.clone()).unwrap();
        let mass: f64 = particles.iter().map(|(mass, _)| mass).sum();
        let center = particles.iter().map(|(mass, position)| *position * *mass).sum::<DVec3>() / mass;
        // Twenty particles, one rounding each of a few products.
        let tolerance = 64.0 * EPS;
        prop_assert!((body.mass() - mass).abs() <= tolerance * mass);
        prop_assert!((body.center_of_mass() - center).length() <= tolerance * 10.0);
        let n = axis.normalize();
        let about_point = n.dot(body.tensor_about(point) * n);
        let expected = moment_about_axis(particles.clone(), point, axis);
        prop_assert!((about_point - expected).abs() <= tolerance * largest(body.tensor_about(point)));
        // Whatever the particles, what they make up is a body.
        prop_assert!(body.inertia().is_ok());
    }

    #[test]
    fn additive_in_any_grouping(particles in particles(), cut in 1..4_usize, far in vector(100.0), turn in rotation()) {
        let (left, right) = particles.split_at(cut);
        let whole = MassProperties::of_particles(particles.clone()).unwrap();
        let [left, right] = [left, right].map(|part| MassProperties::of_particles(part.to_vec()).unwrap());
        prop_assert!(same_body(&(left + right), &whole, 64.0 * EPS));
        prop_assert!(same_body(&(right + left), &whole, 64.0 * EPS));
        // Moved and turned first or last.
        let moved = |body: &MassProperties| body.transformed(far, turn).unwrap();
        prop_assert!(same_body(&(moved(&left) + moved(&right)), &moved(&whole), 64.0 * EPS));
        // And taken away again: the sum's rounding, on both, magnified by the ratio of what was
        // there to what is left.
        let again = whole.without(&right).unwrap();
        let magnified = 256.0 * EPS * whole.mass() / left.mass();
        prop_assert!((again.center_of_mass() - left.center_of_mass()).length() <= magnified * 10.0);
        let difference = again.tensor_about_center() - left.tensor_about_center();
        prop_assert!(largest(difference) <= magnified * largest(whole.tensor_about([0.0; 3])));
    }

    #[test]
    fn a_compound_is_the_sum_of_its_parts(
        parts in prop::collection::vec((shape(), vector(3.0), rotation(), 0.1..9.0_f64), 1..6),
    ) {
        let parts: Vec<Part> = parts
            .into_iter()
            .map(|(shape, position, orientation, mass)| {
                Part::new(shape, Amount::Mass(mass)).at(position).turned(orientation)
            })
            .collect();
        let sum = parts
            .iter()
            .map(|part| {
                let alone = part.shape.mass_properties(part.amount).unwrap();
                alone.transformed(part.position, part.orientation).unwrap()
            })
            .reduce(|a, b| a + b)
            .unwrap();
        let compound = Shape::compound(parts);
        prop_assert_eq!(compound.own_mass_properties().unwrap(), sum);
        let doubled = compound.mass_properties(Amount::Mass(2.0 * sum.mass())).unwrap();
        prop_assert!(same_body(&doubled, &sum.scaled_to_mass(2.0 * sum.mass()).unwrap(), 4.0 * EPS));
        prop_assert!(doubled.inertia().is_ok());
    }

    #[test]
    fn a_density_is_a_mass_over_a_volume(shape in shape(), density in 1.0..1e4_f64) {
        let body = shape.mass_properties(Amount::Density(density)).unwrap();
        prop_assert!((body.mass() / shape.volume().unwrap() / density - 1.0).abs() <= 4.0 * EPS);
        let same = shape.mass_properties(Amount::Mass(body.mass())).unwrap();
        prop_assert_eq!(body, same);
    }

    #[test]
    fn shapes_cut_up(half in prop::array::uniform3(length()), cut in 0.1..0.9_f64) {
        let amount = Amount::Density(700.0);
        let [a, h, b] = half;
        let tolerance = 32.0 * EPS;
        // A cone is a frustum and a smaller cone on top; mid-heights at -h + cut h and
        // h - (1 - cut) h.
        let (low, high) = (h * cut, h * (1.0 - cut));
        let top = Shape::cone(a * (1.0 - cut), high).mass_properties(amount).unwrap();
        let bottom = MassProperties::frustum(a, a * (1.0 - cut), low, amount).unwrap();
        let put_together = bottom.transformed([0.0, low - h, 0.0], DQuat::IDENTITY).unwrap()
            + top.transformed([0.0, h - high, 0.0], DQuat::IDENTITY).unwrap();
        prop_assert!(same_body(&put_together, &Shape::cone(a, h).mass_properties(amount).unwrap(), tolerance));
        // A frustum with equal radii is a cylinder, a capsule a cylinder and two hemispheres.
        let cylinder = Shape::cylinder(a, h).mass_properties(amount).unwrap();
        prop_assert!(same_body(&MassProperties::frustum(a, a, h, amount).unwrap(), &cylinder, tolerance));
        let cap = MassProperties::hemisphere(a, amount).unwrap();
        let upside_down = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
        let capsule = cylinder + cap.transformed([0.0, h, 0.0], DQuat::IDENTITY).unwrap()
            + cap.transformed([0.0, -h, 0.0], upside_down).unwrap();
        prop_assert!(same_body(&Shape::capsule(a, h).mass_properties(amount).unwrap(), &capsule, tolerance));
        // A tube is a cylinder without its core, a thick shell a ball without its core.
        // (Subtraction loses digits.)
        let core = Shape::cylinder(a * cut, h).mass_properties(amount).unwrap();
        let tube = MassProperties::tube(a, a * cut, h, amount).unwrap();
        prop_assert!(close(tube.tensor_about_center(), cylinder.without(&core).unwrap().tensor_about_center(), 1e-13));
        let ball = |r: f64| Shape::sphere(r).mass_properties(amount).unwrap();
        let shell = MassProperties::thick_shell(a, a * cut, amount).unwrap();
        let hollowed = ball(a).without(&ball(a * cut)).unwrap();
        prop_assert!(close(shell.tensor_about_center(), hollowed.tensor_about_center(), 1e-13));
        // A pyramid is two tetrahedra.
        let corner = |x: f64, z: f64| DVec3::new(x * a, -h, z * b);
        let pyramid = MassProperties::pyramid(a, b, h, amount).unwrap();
        let halves = [[(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)], [(1.0, 1.0), (-1.0, -1.0), (-1.0, 1.0)]].map(|base| {
            let [p, q, r] = base.map(|(x, z)| corner(x, z));
            MassProperties::tetrahedron([p, q, r, DVec3::Y * h], amount).unwrap()
        });
        prop_assert!(same_body(&(halves[0] + halves[1]), &pyramid, tolerance));
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
        if let Ok(inertia) = InertiaTensor::with_tolerance(m, tolerance) {
            prop_assert!(inertia.inverse().is_finite());
            prop_assert!(inertia.principal().moments.min_element() > 0.0);
            prop_assert!(inertia.principal().axes.is_finite());
        }
    }

    #[test]
    fn any_body_is_judged_without_a_panic(
        lengths in prop::array::uniform3(anything()),
        amount in anything(),
        kind in 0..16_usize,
        position in prop::array::uniform3(anything()),
        orientation in prop::array::uniform4(anything()),
        density: bool,
    ) {
        let [a, b, c] = lengths;
        let amount = if density { Amount::Density(amount) } else { Amount::Mass(amount) };
        let shape = |shape: Shape| {
            let part = Part::new(shape, amount).at(position).turned(DQuat::from_array(orientation));
            Shape::compound([part]).own_mass_properties()
        };
        let body = match kind {
            0 => shape(Shape::Point),
            1 => shape(Shape::sphere(a)),
            2 => shape(Shape::hollow_sphere(a)),
            3 => shape(Shape::cuboid(lengths)),
            4 => shape(Shape::cylinder(a, b)),
            5 => shape(Shape::capsule(a, b)),
            6 => shape(Shape::cone(a, b)),
            7 => shape(Shape::ellipsoid(lengths)),
            8 => MassProperties::hemisphere(a, amount),
            9 => MassProperties::frustum(a, b, c, amount),
            10 => MassProperties::pyramid(a, b, c, amount),
            11 => MassProperties::tetrahedron([position.into(), lengths.into(), DVec3::ZERO, DVec3::X], amount),
            12 => MassProperties::tube(a, b, c, amount),
            13 => MassProperties::thick_shell(a, b, amount),
            14 => MassProperties::thin_rod(a, b),
            _ => MassProperties::thin_disc(a, b),
        };
        match body {
            Ok(body) => {
                prop_assert!(body.mass() > 0.0 && body.center_of_mass().is_finite());
                prop_assert!(body.tensor_about_center().is_finite());
                prop_assert!((body + body).tensor_about_center().is_finite());
                let _ = body.inertia();
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
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

/// Walls down to an ulp of the radius: the closed forms go over into the thin shell and the thin
/// cylinder.
#[test]
fn thin_walls_cost_no_digits() {
    for wall in [1e-3, 1e-6, 1e-9, 1e-12, 4.0 * EPS] {
        let inner = 1.0 - wall;
        let thickness = 1.0 - inner; // what is left of it in f64, exactly
        let shell = MassProperties::thick_shell(1.0, inner, Amount::Density(1.0)).unwrap();
        // V = 4 pi t (1 - t + t^2/3), I = 2/3 m (1 - t + ...): series in the thickness t, next term
        // below.
        let t = thickness;
        let volume = 4.0 * std::f64::consts::PI * t * (1.0 - t + t * t / 3.0);
        assert!((shell.mass() / volume - 1.0).abs() <= 4.0 * EPS, "{wall}");
        let s4 = 5.0 - 10.0 * t + 10.0 * t * t - 5.0 * t.powi(3) + t.powi(4);
        let moment = 0.4 * shell.mass() * s4 / (3.0 - 3.0 * t + t * t);
        assert!((shell.tensor_about_center().x_axis.x / moment - 1.0).abs() <= 8.0 * EPS, "{wall}");

        let tube = MassProperties::tube(1.0, inner, 2.0, Amount::Density(1.0)).unwrap();
        let volume = 4.0 * std::f64::consts::PI * t * (2.0 - t);
        assert!((tube.mass() / volume - 1.0).abs() <= 4.0 * EPS);
        let axial = tube.mass() * (1.0 - t + 0.5 * t * t);
        assert!((tube.tensor_about_center().y_axis.y / axial - 1.0).abs() <= 4.0 * EPS);
    }
}

#[test]
fn bodies_that_cannot_be_say_where() {
    let sphere = |radius: f64| Part::new(Shape::sphere(radius), Amount::Mass(1.0));
    let inner = Part::new(Shape::compound([sphere(1.0), sphere(f64::NAN)]), Amount::Mass(1.0));
    let error = Shape::compound([sphere(1.0), inner]).own_mass_properties().unwrap_err();
    assert_eq!((error.part.as_slice(), error.field()), ([1, 1].as_slice(), "radius"));
    assert_eq!(error.path(), "parts[1].parts[1].radius");
    assert!(error.to_string().starts_with("parts[1].parts[1].radius must be"), "{error}");

    let message = |result: Result<MassProperties, tumble_math::ShapeError>| result.unwrap_err().to_string();
    assert!(message(Shape::Point.mass_properties(Amount::Density(1.0))).starts_with("density has no meaning"));
    assert!(message(Shape::hollow_sphere(1.0).mass_properties(Amount::Density(1.0))).starts_with("density"));
    assert!(message(Shape::sphere(1.0).mass_properties(Amount::Mass(0.0))).starts_with("mass must be positive"));
    assert!(message(Shape::sphere(1.0).mass_properties(Amount::Density(-1.0))).starts_with("density must be"));
    assert!(message(Shape::sphere(1.0).own_mass_properties()).starts_with("mass must be given"));
    assert!(message(Shape::compound([]).own_mass_properties()).starts_with("parts of a compound must not be empty"));
    let tilted = sphere(1.0).turned(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.5));
    assert!(message(Shape::compound([tilted]).own_mass_properties()).starts_with("parts[0].orientation must be"));
    let lost = sphere(1.0).at(DVec3::new(0.0, f64::INFINITY, 0.0));
    assert!(message(Shape::compound([lost]).own_mass_properties()).starts_with("parts[0].position"));

    let big = Shape::sphere(2.0).mass_properties(Amount::Density(1.0)).unwrap();
    let small = Shape::sphere(1.0).mass_properties(Amount::Density(1.0)).unwrap();
    assert!(small.without(&big).is_err(), "heavier than what it is taken from");
    let outside = small.transformed([5.0, 0.0, 0.0], DQuat::IDENTITY).unwrap();
    assert!(big.without(&outside).is_err(), "sticks out");
    assert!(MassProperties::of_particles([]).is_err());
    let error = MassProperties::of_particles([(1.0, DVec3::ZERO), (0.0, DVec3::X)]).unwrap_err();
    assert!(error.to_string().starts_with("particle 1: mass must be positive"), "{error}");
}

#[test]
fn deep_nesting_is_refused_not_overflowed() {
    let nested = |depth: usize| {
        (0..depth).fold(Shape::sphere(1.0), |shape, _| Shape::compound([Part::new(shape, Amount::Mass(1.0))]))
    };
    assert!(nested(Shape::MAX_DEPTH).own_mass_properties().is_ok() && nested(Shape::MAX_DEPTH).volume().is_some());
    let one_more = nested(Shape::MAX_DEPTH + 1);
    assert!(one_more.own_mass_properties().is_err() && one_more.volume().is_none());
    let deep = nested(1000);
    assert!(deep.own_mass_properties().is_err());
    assert!(deep.volume().is_none());
}
