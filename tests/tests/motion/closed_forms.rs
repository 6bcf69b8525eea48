//! Promise: numbers that follow from a formula on paper are that number: turns of more than half a
//! radian in one step, products and sums of tensors, velocities of points, growth rates, works.
//!
//! Why: each of these was once changed by hand, a sign, an index, a unit, and no test noticed. It
//! fails if one of them is.

use glam::{DMat3, DQuat, DVec3};
use hecs::World;
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    Amount, BodyOrder, ConstantWrench, Damping, Drag, Frame, InertiaError, InertiaTensor, Integrator, InverseInertia,
    Ledger, MassProperties, Momentum, PrincipalInertia, RigidBody, STATE_SIZE, Settings, Shape, Simulation, Thruster,
    Velocity, derivative_to_array, state_to_array, update_derived,
};
use tumble_math::{FreeRotation, LARGEST_KAPPA, MAX_PARTS, angle_between, from_scaled_axis, rotate_freely};
use tumble_tests::{EPSILON, by_precision, dvec3};

/// About a principal axis a body turns uniformly, whatever its moments and however far in one step:
/// from a tenth of a radian over the limits at which a step is cut into parts to where it is turned
/// at once, at about 31 rad.
#[test]
fn a_long_step_about_a_principal_axis_turns_by_its_angle() {
    for moments in [DVec3::new(0.7, 0.5, 0.4), DVec3::new(20.0, 30.0, 45.0), DVec3::new(3.0, 3.0, 3.0)] {
        for axis in 0..3 {
            for angle in [0.1, 0.49, 0.6, 0.9, 1.3, 2.0, 3.0, 4.5, 7.0, 12.0, 20.0, 35.0, 50.0, 120.0] {
                for h in [0.01, 3.0] {
                    let spin = DVec3::AXES[axis] * (angle / h);
                    let inverse = moments.recip();
                    let step = FreeRotation::new(moments.into(), inverse.into(), None, h);
                    let momentum = moments * spin;
                    let found: DQuat = step.rotate(DQuat::IDENTITY.into(), momentum.into()).into();
                    let same: DQuat =
                        rotate_freely(DQuat::IDENTITY.into(), None, momentum.into(), moments.into(), h).into();
                    let exact = from_scaled_axis(spin * h);
                    // A part of half a radian is off by 0.5^7/1000 at the most, and there are two
                    // to a radian.
                    let allowed = 2e-5 * (1.0 + 2.0 * angle);
                    for turned in [found, same] {
                        let error = angle_between(turned, exact);
                        assert!(error <= allowed, "{moments}, axis {axis}, {angle} rad in {h} s: off by {error:e}");
                    }
                }
            }
        }
    }
    const { assert!(LARGEST_KAPPA < 1.0 && MAX_PARTS > 10.0) }
}

/// A symmetric top: it turns about its own axis as seen from a frame that precesses about the
/// angular momentum at `L/I`. One long step, with the axis of symmetry along each of the axes, and
/// moments that are no multiples of one.
#[test]
fn a_long_step_of_a_symmetric_top_is_its_precession() {
    let (across, along) = (2.7, 1.9);
    for axis in 0..3 {
        let mut moments = DVec3::splat(across);
        moments[axis] = along;
        let body_axis = DVec3::AXES[axis];
        let spin = DVec3::new(0.8, -0.5, 1.1);
        let momentum = moments * spin;
        for h in [0.2, 0.5, 0.9, 1.7] {
            let turned: DQuat = rotate_freely(DQuat::IDENTITY.into(), None, momentum.into(), moments.into(), h).into();
            let precession = from_scaled_axis(momentum * (h / across));
            let own = from_scaled_axis(body_axis * (spin[axis] * (1.0 - along / across) * h));
            let error = angle_between(turned, precession * own);
            assert!(error <= 2e-4, "axis {axis}, {h} s: off by {error:e} rad");
        }
    }
}

#[test]
fn the_inverse_inertia_times_each_axis_is_a_column() {
    let inverse = InverseInertia { diagonal: Vec3::new(2.0, 3.0, 5.0), off_diagonal: Vec3::new(0.125, 0.25, 0.5) };
    assert_eq!(inverse * Vec3::X, Vec3::new(2.0, 0.5, 0.25));
    assert_eq!(inverse * Vec3::Y, Vec3::new(0.5, 3.0, 0.125));
    assert_eq!(inverse * Vec3::Z, Vec3::new(0.25, 0.125, 5.0));
    let v = Vec3::new(-1.0, 2.0, 4.0);
    assert_eq!(inverse * v, inverse.to_mat3() * v);
}

#[test]
fn a_point_moves_with_its_arm_from_the_centre() {
    let velocity = Velocity { linear: Vec3::new(1.0, 2.0, 3.0), angular: Vec3::new(0.5, -1.0, 2.0) };
    let found = velocity.at_point(Vec3::new(2.0, 3.0, 5.0), Vec3::ONE);
    assert_eq!(found, Vec3::new(1.0 - 8.0, 2.0, 3.0 + 2.0));
}

#[test]
fn tensors_add_element_by_element() {
    let matrix =
        |d: [f64; 3], [yz, zx, xy]: [f64; 3]| DMat3::from_cols_array(&[d[0], xy, zx, xy, d[1], yz, zx, yz, d[2]]);
    let a = InertiaTensor::new(matrix([2.0, 3.0, 4.0], [0.5, -0.25, 0.125])).unwrap();
    let b = InertiaTensor::new(matrix([4.0, 2.0, 3.0], [0.25, 0.5, -0.5])).unwrap();
    assert_eq!((a + b).matrix(), matrix([6.0, 5.0, 7.0], [0.75, 0.25, -0.375]));
}

#[test]
fn growth_rates_of_a_spin() {
    let body = PrincipalInertia { moments: DVec3::new(1.0, 2.0, 2.5), axes: DQuat::IDENTITY };
    for (axis, expected) in [-0.3, 0.2, -0.375].into_iter().enumerate() {
        assert!((body.spin_instability(axis) - expected).abs() <= 4.0 * f64::EPSILON, "{axis}");
    }
    assert!(body.spin_instability(3).is_nan());
}

/// What a sign or a bound that is lost would let through.
#[test]
fn what_no_body_has_is_refused() {
    let skew = DMat3::from_cols_array(&[2.0, 0.3, 0.0, -0.3, 2.0, 0.0, 0.0, 0.0, 2.0]);
    assert!(matches!(InertiaTensor::new(skew), Err(InertiaError::NotSymmetric { row: 0, column: 1, .. })));
    // 0.6 apart, of a largest element of 2.
    assert!(InertiaTensor::within_tolerance(skew, 0.29).is_err());
    assert!(InertiaTensor::within_tolerance(skew, 0.31).is_ok());
    let ball = InertiaTensor::new(DMat3::IDENTITY).unwrap();
    assert!(matches!(ball.shifted_from_center(-0.1, DVec3::X), Err(InertiaError::Mass { mass: -0.1 })));
    assert!(ball.shifted_from_center(0.0, DVec3::X).is_ok());
    let shifted = ball.shifted_from_center(2.0, [0.0, 3.0, 0.0]).unwrap();
    assert_eq!(shifted.matrix(), DMat3::from_diagonal(DVec3::new(19.0, 1.0, 19.0)));
}

/// A cube of 8 kg without a cube of 1 kg whose centre is half a metre off: 7 kg, 1/14 m the other
/// way.
#[test]
fn a_block_with_a_hole() {
    let block = Shape::cuboid([1.0; 3]).mass_properties(Amount::Density(1.0)).unwrap();
    let hole = Shape::cuboid([0.5; 3]).mass_properties(Amount::Density(1.0)).unwrap();
    let hole = hole.centered_at([0.5, 0.0, 0.0]).unwrap();
    let left: MassProperties = block.without(&hole).unwrap();
    assert_eq!(left.mass(), 7.0);
    assert!((left.center_of_mass() - DVec3::new(-1.0 / 14.0, 0.0, 0.0)).length() <= 1e-16);
    let (along, across) = (16.0 / 3.0 - 1.0 / 6.0, 16.0 / 3.0 - 1.0 / 6.0 - 0.25 - 1.0 / 28.0);
    let expected = DMat3::from_diagonal(DVec3::new(along, across, across));
    assert!(left.tensor_about_center().abs_diff_eq(expected, 1e-14), "{}", left.tensor_about_center());
}

/// Force components push in the derivative as they do in a step: along the body's axes, at their
/// arms.
#[test]
fn components_are_in_the_derivative() {
    let mut world = World::new();
    let body = RigidBody::new(Shape::sphere(0.5)).without_collider().mass(2.0).build().unwrap().spawn(&mut world);
    let (force, torque) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.5, 0.25));
    let thruster = Thruster::new(Vec3::new(0.0, 4.0, 0.0), Vec3::new(0.5, 0.0, 0.0));
    world.insert(body, (ConstantWrench { force, torque, frame: Frame::World }, thruster)).unwrap();
    let order = BodyOrder::of(&world);
    let (mut state, mut rates) = ([0.0; STATE_SIZE], [0.0; STATE_SIZE]);
    state_to_array(&world, &order, &mut state).unwrap();
    let settings = Settings::default().with_gravity(Vec3::new(0.0, -8.0, 0.0));
    derivative_to_array(&world, &settings, &order, &state, &mut rates).unwrap();
    assert_eq!(rates[7..10], [1.0, 2.0 + 4.0 - 16.0, 3.0]);
    // The nozzle is half a metre along x and pushes along y.
    assert_eq!(rates[10..13], [-1.0, 0.5, 0.25 + 2.0]);
    // Damping takes from both momenta at its rates.
    world.insert_one(body, Damping { linear: 0.5, angular: 0.25 }).unwrap();
    state[7..13].copy_from_slice(&[2.0, -4.0, 8.0, 1.0, 2.0, -4.0]);
    derivative_to_array(&world, &settings, &order, &state, &mut rates).unwrap();
    assert_eq!(rates[7..10], [1.0 - 1.0, -10.0 + 2.0, 3.0 - 4.0]);
    assert_eq!(rates[10..13], [-1.0 - 0.25, 0.5 - 0.5, 2.25 + 1.0]);
}

/// The velocities that a step derives are `p/M` and `R I^-1 R^T L`, of a body with three moments
/// that is turned any way.
#[test]
fn derived_velocities_are_those_of_the_momenta() {
    let moments = DVec3::new(0.5, 0.7, 1.0);
    let orientation = DQuat::from_xyzw(0.3, -0.5, 0.7, 0.4).normalize();
    for (axis, momentum) in DVec3::AXES.into_iter().enumerate() {
        let mut world = World::new();
        let principal = PrincipalInertia { moments, axes: DQuat::IDENTITY };
        let q =
            Quat::from_xyzw(orientation.x as Real, orientation.y as Real, orientation.z as Real, orientation.w as Real);
        let body =
            RigidBody::new(Shape::sphere(0.5)).without_collider().mass(2.0).principal_inertia(principal).orientation(q);
        let body = body.build().unwrap().spawn(&mut world);
        let along = Vec3::new(momentum.x as Real, momentum.y as Real, momentum.z as Real);
        *world.get::<&mut Momentum>(body).unwrap() = Momentum { linear: along * 3.0, angular: along };
        update_derived(&mut world);
        let velocity = *world.get::<&Velocity>(body).unwrap();
        let expected = orientation * ((orientation.inverse() * momentum) / moments);
        let error = (dvec3(velocity.angular) - expected).length();
        assert!(error <= 16.0 * EPSILON, "axis {axis}: {} for {expected}", velocity.angular);
        assert_eq!(velocity.linear, along * 1.5);
    }
}

/// Resistance in proportion to the square of the spin, `I w' = -C w^2 - b I w`, has
/// `w = b w0 e/(b + k w0 (1 - e))` with `k = C/I` and `e = exp(-b t)`: drag and damping are booked
/// with what each of them takes.
#[test]
fn drag_and_damping_share_the_work_on_a_spin() {
    let (b, start, seconds) = (1.5_f64, 4.0_f64, 1.0_f64);
    let mut world = World::new();
    let moment = 3.0 * (0.04 + 0.09) / 3.0;
    let c = 0.25 * moment;
    let body = RigidBody::new(Shape::cuboid([0.2, 0.3, 0.4]))
        .without_collider()
        .mass(3.0)
        .angular_velocity(Vec3::Z * start as Real);
    let body = body.damping(Damping { linear: 0.0, angular: b as Real }).build().unwrap().spawn(&mut world);
    world.insert_one(body, Drag { linear: Vec3::ZERO, angular: Vec3::splat(c as Real) }).unwrap();
    let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(1.0 / 64.0);
    let mut simulation = Simulation::new(settings.with_integrator(Integrator::RungeKutta4)).unwrap();
    let mut ledger = Ledger::attach(&mut world, &simulation);
    simulation.step_many(&mut world, 64);
    let entry = ledger.record(&world, &simulation);
    let k = c / moment;
    let spin = |t: f64| b * start * (-b * t).exp() / (b + k * start * (1.0 - (-b * t).exp()));
    // Simpson's rule, exact to 1e-9 here.
    let parts = 200;
    let integral = |f: &dyn Fn(f64) -> f64| {
        let weight = |i: usize| if i == 0 || i == parts { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
        let part = seconds / parts as f64;
        (0..=parts).map(|i| weight(i) * f(i as f64 * part)).sum::<f64>() * part / 3.0
    };
    let by_drag = -integral(&|t| c * spin(t).powi(3));
    let by_damping = -integral(&|t| b * moment * spin(t).powi(2));
    let found = [entry.work.of("Drag").unwrap(), entry.work.damping];
    println!("{found:?} for {by_drag}, {by_damping}");
    // A step takes damping first, so what drag is given is less by half of that, `b h` = 0.023 of
    // it; both together are right.
    for (found, expected) in found.into_iter().zip([by_drag, by_damping]) {
        assert!((found / expected - 1.0).abs() <= 1.5 / 64.0 * 1.1, "{found} for {expected}");
    }
    let error = (found[0] + found[1]) / (by_drag + by_damping) - 1.0;
    assert!(error.abs() <= by_precision(1e-5, 1e-6), "{found:?} for {by_drag} and {by_damping}: {error:e}");
}

/// With damping alone the energy of the spin decays by `e^(-2 b t)`, that of the motion by
/// `e^(-2 a t)`, and all of it is damping's work, under every integrator.
#[test]
fn damping_does_the_work_that_decays() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let (linear, angular) = (0.5, 1.5);
        let body = RigidBody::new(Shape::cuboid([0.2, 0.3, 0.4])).without_collider().mass(3.0);
        let body = body.linear_velocity(Vec3::new(0.0, 0.0, 2.0)).angular_velocity(Vec3::Z * 4.0);
        body.damping(Damping { linear, angular }).build().unwrap().spawn(&mut world);
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(1.0 / 64.0).with_integrator(integrator);
        let mut simulation = Simulation::new(settings).unwrap();
        let mut ledger = Ledger::attach(&mut world, &simulation);
        simulation.step_many(&mut world, 64);
        let entry = ledger.record(&world, &simulation);
        // m (a^2 + b^2)/3 of half edges.
        let moment = 3.0 * (0.04 + 0.09) / 3.0;
        let spun = 0.5 * moment * 16.0 * ((-2.0 * f64::from(angular)).exp() - 1.0);
        let moved = 0.5 * 3.0 * 4.0 * ((-2.0 * f64::from(linear)).exp() - 1.0);
        let error = (entry.work.damping - (spun + moved)).abs();
        println!("{integrator}: {error:.1e} J of {:.3}", spun + moved);
        // 64 steps, each of whose two momenta and works is rounded a few times.
        assert!(error <= 64.0 * 8.0 * EPSILON * 8.0, "{integrator}: {} for {}", entry.work.damping, spun + moved);
        assert!((entry.work.total() - entry.work.damping).abs() <= 64.0 * 8.0 * EPSILON * 8.0);
    }
}
