//! Promise: the state of all bodies goes into a flat array of 13 numbers a body and back, and
//! `derivative_to_array` is the right-hand side that any ODE solver can integrate, to the same
//! motion as the engine's own integrators.
//!
//! Why: it is the interface of the course notes, for those who bring their own solver. It fails if
//! the order of the numbers, a frame or a force differs from the step's, or if a wrong length
//! panics or leaves the world half written.
//!
//! The solver is `Dop853` of the crate `ode_solvers`: Dormand and Prince's method of order eight.

use hecs::World;
use ode_solvers::{DVector, Dop853, OutputType, System};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    BodyOrder, Integrator, Momentum, Pose, STATE_SIZE, Settings, Simulation, StateArrayError, Wrench, array_to_state,
    derivative_to_array, state_hash, state_to_array,
};
use tumble_benches::mixed_moving_bodies;
use tumble_tests::{DOUBLE, EPSILON, FreeBody, attitude_error, by_precision, dquat, dvec3};

/// The equations of motion of all bodies of a world.
struct Bodies<'w> {
    world: &'w World,
    order: &'w BodyOrder,
    settings: Settings,
}

impl System<Real, DVector<Real>> for Bodies<'_> {
    fn system(&self, _time: Real, state: &DVector<Real>, rates: &mut DVector<Real>) {
        derivative_to_array(self.world, &self.settings, self.order, state.as_slice(), rates.as_mut_slice()).unwrap();
    }
}

fn array_of(world: &World, order: &BodyOrder) -> Vec<Real> {
    let mut array = vec![0.0; order.len() * STATE_SIZE];
    state_to_array(world, order, &mut array).unwrap();
    array
}

/// Advances the world by `time` with the outside solver.
fn solve(world: &mut World, order: &BodyOrder, settings: Settings, time: Real) {
    let start = DVector::from_vec(array_of(world, order));
    // In single precision the solver's estimate of its error, a sum with weights of up to 40, is
    // itself only good to 5e-6: a smaller tolerance makes it take ever smaller steps in vain.
    let tolerance = by_precision(1e-5, 1e-13) as Real;
    let bodies = Bodies { world, order, settings };
    let (safety, beta, least, most) = (0.9, 0.0, 0.333, 6.0);
    let mut solver = Dop853::from_param(
        bodies,
        0.0,
        time,
        time,
        start,
        tolerance,
        tolerance,
        safety,
        beta,
        least,
        most,
        time,
        0.0,
        100_000,
        1000,
        OutputType::Sparse,
    );
    solver.integrate().unwrap();
    let end = solver.y_out().last().unwrap().clone();
    array_to_state(world, order, end.as_slice()).unwrap();
}

/// The four bodies at once, thrown where their source throws them, after 2 s.
///
/// In double precision the solver's tolerance of 1e-13 in each of some hundred steps adds up to
/// 1e-11. In single precision it is 1e-5, and the time is half a second. The T-handle magnifies
/// errors most: an energy that is off by 1e-13 of itself moves the one flip in this time by
/// `34e-13/((1 - m) lambda)`, as `convergence.rs` derives, that is its attitude by 3e-7 rad;
/// before the flip, at half a second, by what has grown from it as `e^(lambda t)`, a hundredfold.
#[test]
fn an_outside_solver_finds_the_exact_motion() {
    let bodies = [FreeBody::van_zon_top(), FreeBody::drake_cylinder(), FreeBody::t_handle(), FreeBody::mujoco_box()];
    let mut world = World::new();
    let entities = bodies.each_ref().map(|body| body.spawn(&mut world));
    let order = BodyOrder::of(&world);
    let settings = Settings::default().with_gravity(Vec3::Z * -9.81);
    let time = by_precision(0.5, 2.0);
    solve(&mut world, &order, settings, time as Real);
    for (body, entity) in bodies.iter().zip(entities) {
        let pose = *world.get::<&Pose>(entity).unwrap();
        let error = attitude_error(dquat(pose.orientation), body.at(time).orientation);
        println!("{}: {error:.1e} rad", body.name);
        let allowed = if body.name == "t_handle" { by_precision(1e-3, 3e-7) } else { by_precision(1e-5, 1e-11) };
        assert!(error <= allowed, "{}: {error:e} rad", body.name);
        let (position, velocity) = body.translation.map_or_else(Default::default, |t| (t.position, t.linear_velocity));
        let exact = position + velocity * time + glam::DVec3::Z * (-9.81 * time * time / 2.0);
        // Of up to 30 m.
        let away = (dvec3(pose.position) - exact).length();
        assert!(away <= by_precision(1e-5, 1e-12) * 30.0, "{}: {away:e} m", body.name);
    }
}

/// Damped, pushed, heavier or lighter, with principal axes of their own: the derivative is that of
/// the motion which the engine's fourth-order integrator makes in small steps.
///
/// Differences are relative to the larger of the vector's lengths at start and end. A substep of a
/// millisecond leaves `(w dt)^4`, some 1e-9 in all at 10 rad/s; in single precision a thousand
/// additions leave `1000 EPSILON`.
#[test]
fn the_derivative_has_all_the_forces_of_a_step() {
    let spawn = || {
        let mut world = mixed_moving_bodies(200);
        for (i, wrench) in world.query_mut::<&mut Wrench>().into_iter().enumerate() {
            *wrench = Wrench { force: Vec3::new(1.0, i as Real * 0.1, -2.0), torque: Vec3::new(0.01, 0.0, -0.02) };
        }
        world
    };
    let (mut outside, mut inside) = (spawn(), spawn());
    let order = BodyOrder::of(&outside);
    let start = array_of(&outside, &order);
    let settings = Settings::default().with_dt(0.25).with_integrator(Integrator::RungeKutta4).with_substeps(256);
    solve(&mut outside, &order, settings, 0.25);
    Simulation::new(settings).unwrap().step(&mut inside);
    let (outside, inside) = (array_of(&outside, &order), array_of(&inside, &BodyOrder::of(&inside)));
    let mut worst = 0.0_f64;
    for body in 0..order.len() {
        for part in [0..3, 3..7, 7..10, 10..13] {
            let part = body * STATE_SIZE + part.start..body * STATE_SIZE + part.end;
            let length = |numbers: &[Real]| numbers.iter().map(|x| f64::from(x * x)).sum::<f64>().sqrt();
            let difference: Vec<Real> = part.clone().map(|i| outside[i] - inside[i]).collect();
            let error = length(&difference) / length(&start[part.clone()]).max(length(&inside[part.clone()])).max(1.0);
            worst = worst.max(error);
            assert!(
                error <= by_precision(1e-4, 2e-9),
                "numbers {part:?}: {difference:?} of {:?}",
                &inside[part.clone()]
            );
        }
    }
    println!("worst difference {worst:.1e}");
}

#[test]
fn the_array_is_in_the_order_of_the_course_notes() {
    let mut world = World::new();
    let body = FreeBody::drake_cylinder();
    let entity = body.spawn(&mut world);
    world.get::<&mut Pose>(entity).unwrap().orientation = Quat::from_xyzw(0.1, 0.5, 0.7, 0.5);
    let order = BodyOrder::of(&world);
    let (pose, momentum) = (*world.get::<&Pose>(entity).unwrap(), *world.get::<&Momentum>(entity).unwrap());
    let (x, q, p, l) = (pose.position, pose.orientation, momentum.linear, momentum.angular);
    let expected = [x.x, x.y, x.z, q.w, q.x, q.y, q.z, p.x, p.y, p.z, l.x, l.y, l.z];
    assert_eq!(array_of(&world, &order), expected);
}

/// There and back, nothing changes; but for orientations, which are normalised on the way back and
/// may be rounded by it.
#[test]
fn there_and_back_again() {
    let mut world = mixed_moving_bodies(200);
    let order = BodyOrder::of(&world);
    let array = array_of(&world, &order);
    let mut scattered = array.clone();
    for (i, number) in scattered.iter_mut().enumerate() {
        *number += i as Real;
    }
    array_to_state(&mut world, &order, &scattered).unwrap();
    assert_ne!(array_of(&world, &order), array);
    array_to_state(&mut world, &order, &array).unwrap();
    for (number, (a, b)) in array_of(&world, &order).iter().zip(&array).enumerate() {
        if (3..7).contains(&(number % STATE_SIZE)) {
            assert!((a - b).abs() <= 2.0 * Real::EPSILON, "{a} not {b}");
        } else {
            assert_eq!(a, b);
        }
    }
    // An orientation of another length is the same orientation.
    let mut longer = array.clone();
    longer[3..7].iter_mut().for_each(|number| *number *= 4.0);
    array_to_state(&mut world, &order, &longer).unwrap();
    let q = world.get::<&Pose>(order.entities()[0]).unwrap().orientation;
    assert!((q - Quat::from_xyzw(array[4], array[5], array[6], array[3])).length() <= 4.0 * Real::EPSILON);
}

/// Each wrong argument has its own error with its numbers, and the world is as it was.
#[test]
fn wrong_arrays_are_refused_and_change_nothing() {
    let mut world = World::new();
    let body = FreeBody::van_zon_top();
    body.spawn(&mut world);
    let last = body.spawn(&mut world);
    let order = BodyOrder::of(&world);
    let settings = Settings::default();
    let before = state_hash(&world, &order);
    let mut good = vec![1.0; 2 * STATE_SIZE];
    for found in [0, STATE_SIZE, 2 * STATE_SIZE - 1, 2 * STATE_SIZE + 1] {
        let mut bad = vec![1.0; found];
        let error = StateArrayError::Length { found, bodies: 2, expected: 2 * STATE_SIZE };
        assert_eq!(state_to_array(&world, &order, &mut bad), Err(error.clone()));
        assert_eq!(array_to_state(&mut world, &order, &bad), Err(error.clone()));
        assert_eq!(derivative_to_array(&world, &settings, &order, &bad, &mut good), Err(error.clone()));
        assert_eq!(derivative_to_array(&world, &settings, &order, &good.clone(), &mut bad), Err(error));
    }
    assert_eq!(state_hash(&world, &order), before);

    // The last one is no longer a moving body: the first is not written either.
    let momentum = world.remove_one::<Momentum>(last).unwrap();
    let error = Err(StateArrayError::NotMoving(last));
    assert_eq!(array_to_state(&mut world, &order, &good), error);
    assert_eq!(state_to_array(&world, &order, &mut good.clone()), error);
    world.insert_one(last, momentum).unwrap();
    assert_eq!(state_hash(&world, &order), before);
    world.despawn(last).unwrap();
    assert_eq!(array_to_state(&mut world, &order, &good), error);
    assert_eq!(derivative_to_array(&world, &settings, &order, &good.clone(), &mut good), error);
}

/// An empty order takes an empty array.
#[test]
fn no_bodies_no_numbers() {
    let mut world = World::new();
    let order = BodyOrder::of(&world);
    assert_eq!(state_to_array(&world, &order, &mut []), Ok(()));
    assert_eq!(array_to_state(&mut world, &order, &[]), Ok(()));
    assert_eq!(derivative_to_array(&world, &Settings::default(), &order, &[], &mut []), Ok(()));
}

/// The derivative itself, on a body whose numbers are easy: `dx/dt = P/M`, `dq/dt = 1/2 [0, w] q`,
/// `dP/dt = F`, `dL/dt = tau`.
#[test]
fn the_rates_of_one_body() {
    let mut world = World::new();
    let body = FreeBody::mujoco_box().rigid_body().linear_velocity(Vec3::new(1.0, 2.0, 3.0));
    let entity = body.damping(tumble::Damping { linear: 0.5, angular: 0.25 }).build().unwrap().spawn(&mut world);
    *world.get::<&mut Wrench>(entity).unwrap() = Wrench { force: Vec3::X, torque: Vec3::Y };
    let order = BodyOrder::of(&world);
    let (array, mut rates) = (array_of(&world, &order), [0.0; STATE_SIZE]);
    let settings = Settings::default().with_gravity(Vec3::Z * -8.0);
    derivative_to_array(&world, &settings, &order, &array, &mut rates).unwrap();
    let l = [1.0 * 13.0 / 300.0, 2.0 * 10.0 / 300.0, 3.0 * 5.0 / 300.0];
    let expected = [
        [1.0, 2.0, 3.0].as_slice(),
        &[0.0, 0.5, 1.0, 1.5],
        &[1.0 - 0.5, -0.5 * 2.0, -8.0 - 0.5 * 3.0],
        &[-0.25 * l[0], 1.0 - 0.25 * l[1], -0.25 * l[2]],
    ]
    .concat();
    for (rate, expected) in rates.iter().zip(expected) {
        // A few roundings each.
        assert!((f64::from(*rate) - expected).abs() <= 4.0 * EPSILON * expected.abs().max(1.0), "{rates:?}");
    }
    assert_eq!(DOUBLE, size_of_val(&rates) == STATE_SIZE * 8);
}
