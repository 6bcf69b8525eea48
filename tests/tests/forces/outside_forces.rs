//! Promise: the derivative of a state array has the forces between bodies and the laws of a
//! simulation in it: a solver of the caller's that integrates it comes where the engine does.
//!
//! Why: an outside solver that silently leaves out a spring solves another problem. It fails if an
//! end, a sign, a body that the order does not list, or the time of a law is lost.

use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{
    BodyOrder, BodyState, ForceLaw, GravityMass, Integrator, Pose, RigidBody, STATE_SIZE, Shape, Simulation, Spring,
    SpringToPoint, Velocity, Wrench, array_to_derived_state, array_to_state, derivative_to_array, state_to_array,
    update_derived,
};
use tumble_tests::{by_precision, simulation};

/// Pushes in alternating directions, and turns.
struct Tide;

impl ForceLaw for Tide {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        let time = state.time as Real;
        Wrench { force: Vec3::new(3.0 * time, 0.0, -1.0), torque: Vec3::Y * (0.2 * time) }
    }
}

fn scene() -> World {
    let mut world = World::new();
    let wall = RigidBody::new(Shape::sphere(0.2))
        .without_collider()
        .fixed()
        .position(Vec3::new(0.0, 2.0, 0.0))
        .build()
        .unwrap();
    let mut bodies = vec![wall.spawn(&mut world)];
    for i in 0..4_u8 {
        let x = Real::from(i);
        let body = RigidBody::new(Shape::cuboid([0.2, 0.3, 0.25])).without_collider().mass(1.0 + 0.5 * f64::from(i));
        let body = body.position(Vec3::new(x, 0.3 * x * x, 0.2)).linear_velocity(Vec3::new(0.5, -x, 1.0));
        bodies.push(body.angular_velocity(Vec3::new(1.0, x, -0.5)).build().unwrap().spawn(&mut world));
    }
    for pair in [[0, 1], [1, 2], [3, 2], [4, 1]] {
        let [a, b] = pair.map(|i| bodies[i]);
        let spring = Spring::between(a, b).attached_at(Vec3::new(0.1, -0.05, 0.0), Vec3::new(0.0, 0.1, 0.15));
        world.spawn((spring.with_stiffness(40.0).with_rest_length(0.7).with_damping(0.3),));
    }
    for (i, body) in bodies[1..].iter().enumerate() {
        world.insert_one(*body, GravityMass { mu: 2.0 + i as Real, softening: 0.4 }).unwrap();
    }
    world.insert_one(bodies[0], GravityMass { mu: 3.0, softening: 0.2 }).unwrap();
    world
}

/// Runge and Kutta's method on whatever derivative it is given.
fn solve(state: &mut [Real], time: f64, steps: u32, rates: impl Fn(f64, &[Real], &mut [Real])) {
    let h = time / f64::from(steps);
    for step in 0..steps {
        let start = f64::from(step) * h;
        let mut sum = vec![0.0; state.len()];
        let mut at = state.to_vec();
        for (offset, weight) in [(0.5, 1.0), (0.5, 2.0), (1.0, 2.0), (0.0, 1.0)] {
            let stage = if weight == 1.0 && offset == 0.5 {
                0.0
            } else if offset == 0.0 {
                1.0
            } else {
                0.5
            };
            let mut rate = vec![0.0; state.len()];
            rates(start + stage * h, &at, &mut rate);
            for i in 0..state.len() {
                sum[i] += weight * f64::from(rate[i]);
                at[i] = state[i] + (offset * h * f64::from(rate[i])) as Real;
            }
        }
        for (number, sum) in state.iter_mut().zip(sum) {
            *number += (h / 6.0 * sum) as Real;
        }
    }
}

fn largest_difference(a: &[Real], b: &[Real]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max)
}

fn after_a_second(laws: bool) -> (Vec<Real>, Vec<Real>, Vec<Real>) {
    let mut world = scene();
    let order = BodyOrder::moving(&world);
    let mut inside: Simulation = simulation(Integrator::MoserVeselov, Vec3::new(0.0, -2.0, 0.0), 1.0 / 4096.0);
    if laws {
        inside.add_global_law(Tide);
    }
    let mut outside = vec![0.0; order.len() * STATE_SIZE];
    state_to_array(&world, &order, &mut outside).unwrap();
    let start = outside.clone();
    solve(&mut outside, 1.0, 256, |time, state, rates| {
        inside.derivative_to_array(&world, time, &order, state, rates).unwrap();
        if !laws {
            let mut same = vec![0.0; rates.len()];
            derivative_to_array(&world, inside.settings(), &order, state, &mut same).unwrap();
            assert_eq!(rates, same);
        }
    });
    inside.step_many(&mut world, 4096);
    let mut found = vec![0.0; outside.len()];
    state_to_array(&world, &order, &mut found).unwrap();
    (outside, found, start)
}

/// Springs, off the centres and damped, to a fixed body too, gravity among bodies, and a law that
/// knows the time.
#[test]
fn an_outside_solver_comes_where_the_engine_does() {
    for laws in [false, true] {
        let (outside, inside, start) = after_a_second(laws);
        let error = largest_difference(&outside, &inside);
        println!("laws {laws}: {error:.1e}, of {:.1}", largest_difference(&inside, &start));
        // The engine's kicks are of second order, at 10 rad/s off by (w h)^2/24 of what they go
        // through; in single precision 4096 steps are rounded.
        assert!(error <= by_precision(5e-3, 5e-5), "laws {laws}: {error:e}");
        assert!(largest_difference(&inside, &start) > 1.0, "nothing moved");
    }
    let (with, without) = (after_a_second(true).0, after_a_second(false).0);
    assert!(largest_difference(&with, &without) > 0.1, "the law does nothing");
}

/// A spring to a point under the derivative is as stiff as it was given, and the derived quantities
/// come with the state.
#[test]
fn derived_quantities_come_with_the_state() {
    let mut world = scene();
    let body = world.query::<(hecs::Entity, &tumble::Momentum)>().iter().map(|(entity, _)| entity).next().unwrap();
    world.insert_one(body, SpringToPoint { stiffness: 5.0, ..SpringToPoint::default() }).unwrap();
    let order = BodyOrder::moving(&world);
    let mut array = vec![0.0; order.len() * STATE_SIZE];
    state_to_array(&world, &order, &mut array).unwrap();
    for (i, number) in array.iter_mut().enumerate() {
        *number += 0.01 * i as Real;
    }
    let mut later = scene();
    later.insert_one(body, SpringToPoint { stiffness: 5.0, ..SpringToPoint::default() }).unwrap();
    array_to_derived_state(&mut world, &order, &array).unwrap();
    array_to_state(&mut later, &order, &array).unwrap();
    update_derived(&mut later);
    for &entity in order.entities() {
        assert_eq!(*world.get::<&Pose>(entity).unwrap(), *later.get::<&Pose>(entity).unwrap());
        let [a, b] = [&world, &later].map(|world| *world.get::<&Velocity>(entity).unwrap());
        assert!((a.linear - b.linear).length() + (a.angular - b.angular).length() <= 1e-5, "{a:?} {b:?}");
    }
}
