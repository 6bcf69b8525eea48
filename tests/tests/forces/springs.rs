//! Promise: a spring between two bodies swings at its true frequency up to 0.45 swings a substep
//! and never faster; however stiff it is and however many hang together, energy stays bounded for
//! ten thousand steps; damping takes energy and never gives any; momentum and angular momentum of
//! the whole are kept to rounding; a spring whose body is not there does nothing.
//!
//! Why: springs that explode are the first thing that people meet in other engines, and a spring
//! that is stable because it is soft in secret is the second. It fails if the share of a body's
//! mass is forgotten, a damper sees a stale velocity, the impulses on both ends are not on one
//! line, or an entity's number is taken for the entity.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use hecs::{Entity, World};
use tumble::Integrator::{self, MoserVeselov, SemiImplicitEuler};
use tumble::math::{Real, Vec3};
use tumble::{BodyOrder, Momentum, Pose, RigidBody, Shape, Simulation, Spring, Totals};
use tumble_tests::{EPSILON, by_precision, dvec3, hash, run, seconds, weightless};

use crate::nets;
use nets::{Attached, Net, Turning, net};

/// A power of two, so that all that is multiplied with it keeps its bits.
const DT: Real = 1.0 / 128.0;

fn ball(mass: f64, position: Vec3) -> RigidBody {
    RigidBody::new(Shape::sphere(0.1)).without_collider().mass(mass).position(position)
}

fn spawn(world: &mut World, body: RigidBody) -> Entity {
    body.build().unwrap().spawn(world)
}

fn position(world: &World, body: Entity) -> DVec3 {
    dvec3(world.get::<&Pose>(body).unwrap().position)
}

fn totals(world: &World, simulation: &Simulation) -> Totals {
    Totals::of(world, simulation.settings(), &BodyOrder::of(world))
}

fn kinetic(world: &World, simulation: &Simulation) -> f64 {
    totals(world, simulation).kinetic()
}

/// 1 and 3 kg: a reduced mass of 3/4 kg.
const REDUCED: f64 = 0.75;

fn stiffness_for(swings_a_step: f64) -> Real {
    (REDUCED * (TAU * swings_a_step / seconds(DT)).powi(2)) as Real
}

/// The angle \[rad\] through which the swing of two bodies from rest really turns in a step, found
/// from where they are after each of `steps`, near `angle`; and the largest distance from that
/// swing, over the amplitude.
fn measured_angle(integrator: Integrator, stiffness: Real, rest_length: Real, angle: f64, steps: u32) -> (f64, f64) {
    let mut world = World::new();
    let along = Vec3::new(0.36, 0.48, 0.8);
    let amplitude = 0.125;
    let a = spawn(&mut world, ball(1.0, -along * (0.75 * (rest_length + amplitude))));
    let b = spawn(&mut world, ball(3.0, along * (0.25 * (rest_length + amplitude))));
    world.spawn((Spring::between(a, b).with_stiffness(stiffness).with_rest_length(rest_length),));
    let mut simulation = weightless(integrator, DT);
    let stretch = |world: &World| (position(world, b) - position(world, a)).dot(dvec3(along).normalize());
    let start = stretch(&world) - seconds(rest_length);
    let stretches: Vec<f64> = (0..steps)
        .map(|_| {
            simulation.step(&mut world);
            (stretch(&world) - seconds(rest_length)) / start
        })
        .collect();
    // The first-order method takes its kick whole, and so goes through the swing half a step later.
    let late = if integrator == SemiImplicitEuler { 0.5 } else { 0.0 };
    let swing = |angle: f64, n: f64| ((n + late) * angle).cos() / (late * angle).cos();
    let mut found = angle;
    for _ in 0..20 {
        let (mut up, mut down) = (0.0, 0.0);
        for (i, stretch) in stretches.iter().enumerate() {
            let n = (i + 1) as f64;
            let slope = (swing(found + 1e-7, n) - swing(found - 1e-7, n)) / 2e-7;
            up += (stretch - swing(found, n)) * slope;
            down += slope * slope;
        }
        found += up / down;
    }
    let off = |(i, stretch): (usize, &f64)| (stretch - swing(found, (i + 1) as f64)).abs();
    (found, stretches.iter().enumerate().map(off).fold(0.0, f64::max))
}

/// The frequency is right to some roundings of the stiffness that is computed for it, up to 0.45
/// swings a step, under every method, with rest length and without.
#[test]
fn two_bodies_swing_at_their_frequency() {
    for integrator in Integrator::ALL {
        for swings_a_step in [0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.449] {
            for rest_length in [0.0, 2.0] {
                let stiffness = stiffness_for(swings_a_step);
                let exact = (f64::from(stiffness) / REDUCED).sqrt() * seconds(DT);
                let (found, off) = measured_angle(integrator, stiffness, rest_length, exact, 200);
                let error = (found / exact - 1.0).abs();
                println!(
                    "{integrator}, {swings_a_step}, {rest_length}: frequency off by {error:.1e}, swing by {off:.1e}"
                );
                // 8 roundings of the stiffness are tan(a/2)/a in the angle; the series ends at
                // 2e-13. 200 random roundings, 24 amplitudes away, turn the swing by 1/200 of them.
                let of_stiffness = (8.0 * EPSILON + 2e-13) * (exact / 2.0).tan() / exact;
                let of_places = 24.0 * EPSILON / (exact * 200.0_f64.sqrt() * exact.sin());
                assert!(error <= of_stiffness + of_places, "{integrator}, {swings_a_step}, {rest_length}: {error:e}");
                assert!(off <= 24.0 * 200.0 * EPSILON / exact.sin(), "{integrator}, {swings_a_step}: {off:e}");
            }
        }
    }
}

/// Past 0.45 swings a step a spring swings at that, however stiff: at 0.5, where the splitting
/// would explode, and at a thousand and a million million times as much.
#[test]
fn stiffer_springs_swing_at_the_limit() {
    for integrator in Integrator::ALL {
        for stiffer in [1.0, 1e3, 1e12] {
            let stiffness = stiffness_for(0.5) * stiffer as Real;
            let (found, off) = measured_angle(integrator, stiffness, 1.0, 0.9 * PI, 200);
            let error = (found / (0.9 * PI) - 1.0).abs();
            println!("{integrator}, {stiffer:e} times 0.5: {:.6} swings a step, off by {off:.1e}", found / TAU);
            assert!(error <= 32.0 * EPSILON + 1e-12, "{integrator}, {stiffer:e}: {error:e}");
            // The line between the bodies is not quite that of the swing after some roundings.
            assert!(off <= by_precision(2e-3, 1e-11), "{integrator}, {stiffer:e}: {off:e}");
        }
    }
}

/// Two bodies with a damper: `e^(-t/tau) cos`, to the order of the method; kicks are of second
/// order, of first under `SemiImplicitEuler`.
#[test]
fn a_damper_damps_as_it_says() {
    let (stiffness, damping): (Real, Real) = (75.0, 3.0);
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let (a, b) = (spawn(&mut world, ball(1.0, Vec3::ZERO)), spawn(&mut world, ball(3.0, Vec3::X * 1.5)));
        world.spawn((Spring::between(a, b).with_stiffness(stiffness).with_rest_length(1.0).with_damping(damping),));
        let mut simulation = weightless(integrator, DT);
        // 2 a second of decay, and w^2 = 100 - 4.
        let (decay, rate) = (2.0, 96.0_f64.sqrt());
        for step in 1..=128 {
            simulation.step(&mut world);
            let time = f64::from(step) * seconds(DT);
            let swing = (-decay * time).exp() * ((rate * time).cos() + decay / rate * (rate * time).sin());
            let found = (position(&world, b) - position(&world, a)).length() - 1.0;
            // The next term of the series a step, at 10 rad/s.
            let x = 10.0 * seconds(DT);
            let a_step = if integrator == SemiImplicitEuler { x * x / 2.0 } else { x * x * x / 6.0 };
            let bound = f64::from(step) * (0.5 * a_step + 2.0 * EPSILON);
            assert!((found - 0.5 * swing).abs() <= bound, "{integrator}, {step}: {found} for {}", 0.5 * swing);
        }
    }
}

const NETS: [Net; 6] = [Net::Pair, Net::Chain, Net::Star, Net::Grid, Net::Random(1), Net::Random(2)];

/// The energy that the springs of a net have as they act, with the stiffness that is stable.
fn acting_energy(world: &World) -> f64 {
    let mut springs_of = std::collections::HashMap::<Entity, f64>::new();
    for spring in world.query::<&Spring>().iter() {
        spring.bodies.iter().for_each(|body| *springs_of.entry(*body).or_default() += 1.0);
    }
    let of = |spring: &Spring| {
        let inverse_mass: f64 = spring
            .bodies
            .iter()
            .map(|&body| springs_of[&body] / f64::from(world.get::<&tumble::Mass>(body).unwrap().kilograms()))
            .sum();
        let h = seconds(DT);
        let angle = ((f64::from(spring.stiffness) * inverse_mass).sqrt() * h).min(0.9 * PI);
        let acting = 4.0 * (angle / 2.0).sin().powi(2) / (inverse_mass * h * h);
        let [a, b] = spring.bodies.map(|body| position(world, body));
        0.5 * acting * ((b - a).length() - f64::from(spring.rest_length)).powi(2)
    };
    world.query::<&Spring>().iter().map(of).sum()
}

/// Ten thousand steps of points and of springs between their centres. In the linear theory of kick
/// and drift with `z = w^2 dt^2 <= 4 sin^2(0.45 pi)`, the sum of kinetic energy and `1 - z/4` of
/// the springs' is kept, so at most `1/(1 - z/4) = 41` times the energy of the start is anywhere.
/// What turns is not linear; twice that is for it.
#[test]
fn no_net_explodes() {
    for integrator in Integrator::ALL {
        for kind in NETS {
            for stiffness in [1e3, 1e6, 1e9, 1e18] {
                let mut world = net(kind, stiffness, 0.0, Attached::Centers, Turning::No);
                let mut simulation = weightless(integrator, DT);
                let start = acting_energy(&world) + kinetic(&world, &simulation);
                let mut most = 0.0_f64;
                for _ in 0..100 {
                    simulation.step_many(&mut world, 100);
                    most = most.max(kinetic(&world, &simulation) + acting_energy(&world));
                }
                println!("{integrator}, {kind:?}, {stiffness:e}: {:.3} of {start:.2e} J", most / start);
                assert!(most <= 82.0 * start, "{integrator}, {kind:?}, {stiffness:e}: {most:e} of {start:e} J");
            }
        }
    }
}

/// The same with springs that are attached off the centres of bodies that turn.
#[test]
fn no_turning_net_explodes() {
    for kind in NETS {
        for stiffness in [1e2, 1e3, 1e6, 1e18] {
            let mut world = net(kind, stiffness, 0.0, Attached::Anywhere, Turning::Yes);
            let mut simulation = weightless(MoserVeselov, DT);
            let start = kinetic(&world, &simulation);
            let (mut most, mut last) = (0.0_f64, 0.0);
            for _ in 0..100 {
                simulation.step_many(&mut world, 100);
                last = kinetic(&world, &simulation);
                most = most.max(last);
            }
            println!("{kind:?}, {stiffness:e}: {:.3}, at the end {:.3} of {start:.2e} J", most / start, last / start);
            assert!(most <= 100.0 * start, "{kind:?}, {stiffness:e}: {most:e} of {start:e} J");
        }
    }
}

/// Dampers without springs: in no step does kinetic energy grow by more than roundings of it,
/// however strong they are, off the centres of turning bodies too.
#[test]
fn damping_gives_no_energy() {
    for kind in NETS {
        for damping in [1e-2, 1.0, 1e2, 1e4, 1e12, 1e30] {
            for (integrator, attached, turning) in [
                (MoserVeselov, Attached::Anywhere, Turning::Yes),
                (MoserVeselov, Attached::Centers, Turning::No),
                (SemiImplicitEuler, Attached::Centers, Turning::No),
                (Integrator::RungeKutta4, Attached::Centers, Turning::No),
            ] {
                let mut world = net(kind, 0.0, damping, attached, turning);
                let mut simulation = weightless(integrator, DT);
                let start = kinetic(&world, &simulation);
                let mut before = start;
                for step in 0..300 {
                    simulation.step(&mut world);
                    let now = kinetic(&world, &simulation);
                    // The impulses of up to twenty springs on a body, each rounded, cancel to what
                    // is left.
                    let rounding = 64.0 * EPSILON * start;
                    assert!(
                        now <= before + rounding,
                        "{kind:?}, {damping:e}, {step}: {:e} of {before:e}",
                        now - before
                    );
                    before = now;
                }
                if damping >= 1.0 {
                    assert!(before < 0.99 * start, "{kind:?}, {damping:e}: {before:e} of {start:e}");
                }
            }
        }
    }
}

/// Stiff and damped at once, and for long.
#[test]
fn stiff_and_damped_nets_come_to_rest() {
    for integrator in Integrator::ALL {
        for kind in NETS {
            for (stiffness, damping) in [(1e3, 10.0), (1e6, 1e2), (1e6, 1e6), (1e18, 1e3), (1e18, 1e18)] {
                let mut world = net(kind, stiffness, damping, Attached::Centers, Turning::No);
                let mut simulation = weightless(integrator, DT);
                let start = acting_energy(&world) + kinetic(&world, &simulation);
                for step in 0..100 {
                    simulation.step_many(&mut world, 20);
                    let now = kinetic(&world, &simulation);
                    assert!(
                        now <= 41.0 * start,
                        "{integrator}, {kind:?}, {stiffness:e}, {damping:e}, {step}: {now:e} of {start:e}"
                    );
                }
            }
        }
    }
}

/// Every impulse has its opposite on the same line. Over 1000 steps each body's momenta are rounded
/// in each kick, at random.
#[test]
fn momentum_and_angular_momentum_are_kept() {
    for kind in NETS {
        for (stiffness, damping) in [(1e3, 0.0), (1e6, 0.0), (1e3, 5.0)] {
            let mut world = net(kind, stiffness, damping, Attached::Anywhere, Turning::Yes);
            let mut simulation = weightless(MoserVeselov, DT);
            let start = totals(&world, &simulation);
            let mut scale = 0.0_f64;
            for _ in 0..100 {
                run(&mut simulation, &mut world, 10);
                let momenta: f64 = world.query::<&Momentum>().iter().map(|m| dvec3(m.linear).length()).sum();
                scale = scale.max(momenta);
            }
            let end = totals(&world, &simulation);
            let reach = world.query::<&Pose>().iter().map(|p| dvec3(p.position).length()).fold(1.0, f64::max);
            let rounding = 2000.0_f64.sqrt() * EPSILON * scale;
            let linear = (end.linear_momentum - start.linear_momentum).length();
            let angular = (end.angular_momentum - start.angular_momentum).length();
            println!(
                "{kind:?}, {stiffness:e}, {damping}: {linear:.1e}, {angular:.1e} of {scale:.1e}, reach {reach:.1}"
            );
            assert!(linear <= rounding, "{kind:?}: {linear:e} of {rounding:e}");
            assert!(angular <= 2.0 * reach * rounding, "{kind:?}: {angular:e} of {:e}", reach * rounding);
        }
    }
    // Of two bodies that start at rest, to the bit.
    let mut world = net(Net::Pair, 1e4, 3.0, Attached::Anywhere, Turning::No);
    world.query_mut::<&mut Momentum>().into_iter().for_each(|momentum| *momentum = Momentum::default());
    for _ in 0..100 {
        weightless(MoserVeselov, DT).step(&mut world);
        let momenta: Vec<Vec3> = world.query::<&Momentum>().iter().map(|momentum| momentum.linear).collect();
        assert!(momenta[0] == -momenta[1] && momenta[0] != Vec3::ZERO, "{momenta:?}");
    }
}

/// A spring to a body that does not move is one with the whole of the other's mass.
#[test]
fn a_spring_to_a_fixed_body() {
    for integrator in [MoserVeselov, Integrator::RungeKutta4] {
        let mut world = World::new();
        let wall =
            spawn(&mut world, RigidBody::new(Shape::sphere(1.0)).without_collider().fixed().position(Vec3::Y * 3.0));
        let ball = spawn(&mut world, ball(2.0, Vec3::new(4.0, 3.0, 0.0)));
        world.spawn((Spring::between(wall, ball)
            .attached_at(Vec3::X, Vec3::ZERO)
            .with_rest_length(2.0)
            .with_stiffness(800.0),));
        let mut simulation = weightless(integrator, DT);
        for step in 1..=500 {
            simulation.step(&mut world);
            let exact = DVec3::new(3.0 + (20.0 * f64::from(step) * seconds(DT)).cos(), 3.0, 0.0);
            let error = (position(&world, ball) - exact).length();
            assert!(error <= (8.0 + 8.0 * f64::from(step)) * EPSILON, "{integrator}, {step}: off by {error:e}");
        }
        assert_eq!(position(&world, wall), DVec3::Y * 3.0);
    }
}

/// Seen from a kinematic body, a ball that goes along swings as before a wall: the spring sees it
/// where it is at the time of each kick, taken step by step, many at once, or in substeps.
#[test]
fn a_spring_to_a_kinematic_body() {
    let along = Vec3::new(0.5, 2.0, 0.0);
    let swing = |step: &dyn Fn(&mut Simulation, &mut World), substeps: u32| {
        let mut world = World::new();
        let cart =
            spawn(&mut world, RigidBody::new(Shape::sphere(1.0)).without_collider().kinematic().linear_velocity(along));
        let ball = spawn(&mut world, ball(2.0, Vec3::X * 3.0).linear_velocity(along));
        world.spawn((Spring::between(cart, ball).with_rest_length(2.0).with_stiffness(800.0),));
        let mut simulation = weightless(MoserVeselov, DT);
        simulation.set_settings(simulation.settings().with_substeps(substeps)).unwrap();
        step(&mut simulation, &mut world);
        (position(&world, ball) - position(&world, cart), hash(&world))
    };
    let by_step = swing(&|simulation, world| run(simulation, world, 64), 1);
    let at_once = swing(&|simulation, world| simulation.step_many(world, 64), 1);
    let in_substeps = swing(&|simulation, world| run(simulation, world, 64), 4);
    let exact = DVec3::X * (2.0 + (20.0 * 64.0 * seconds(DT)).cos());
    println!("steps {}, at once {}, substeps {}, exact {exact}", by_step.0, at_once.0, in_substeps.0);
    assert_eq!(by_step, at_once);
    for (found, _) in [by_step, at_once, in_substeps] {
        assert!((found - exact).length() <= 1000.0 * EPSILON, "{found} for {exact}");
    }
}

/// A spring does nothing, and nothing panics: while a body of its is gone, also when another entity
/// has got its number; to itself; to what is no body.
#[test]
fn a_spring_without_its_bodies_does_nothing() {
    let scene = |spoil: &dyn Fn(&mut World, [Entity; 3]) -> Option<Spring>| {
        let mut world = World::new();
        let bodies = [0.0, 1.0, 2.5].map(|x| spawn(&mut world, ball(1.0 + f64::from(x), Vec3::X * x)));
        let spring = spoil(&mut world, bodies);
        if let Some(spring) = spring {
            world.spawn((spring.with_stiffness(1e3).with_rest_length(0.3).with_damping(1.0),));
        }
        run(&mut weightless(MoserVeselov, DT), &mut world, 20);
        hash(&world)
    };
    let despawned = |world: &mut World, [_, b, _]: [Entity; 3]| world.despawn(b).unwrap();
    let replaced = |world: &mut World, bodies: [Entity; 3]| {
        despawned(world, bodies);
        let other = spawn(world, ball(5.0, Vec3::Y));
        assert!(other.id() == bodies[1].id() && other != bodies[1]);
    };
    let alone = scene(&|_, _| None);
    assert_ne!(scene(&|_, [a, b, _]| Some(Spring::between(a, b))), alone, "the spring of this test does something");
    assert_eq!(scene(&|_, [a, _, _]| Some(Spring::between(a, a).attached_at(Vec3::X, Vec3::Y))), alone);
    assert_eq!(scene(&|_, [a, _, _]| Some(Spring::between(a, Entity::DANGLING))), alone);
    assert_eq!(scene(&|world, [a, _, _]| Some(Spring::between(a, world.spawn(("no body",))))), alone);
    let gone = |spring: fn([Entity; 3]) -> Option<Spring>| {
        scene(&move |world, bodies| {
            despawned(world, bodies);
            spring(bodies)
        })
    };
    assert_eq!(gone(|[a, b, _]| Some(Spring::between(a, b))), gone(|_| None));
    let another = |spring: fn([Entity; 3]) -> Option<Spring>| {
        scene(&move |world, bodies| {
            replaced(world, bodies);
            spring(bodies)
        })
    };
    assert_eq!(another(|[a, b, _]| Some(Spring::between(b, a))), another(|_| None));
    assert_eq!(another(|[_, b, c]| Some(Spring::between(c, b))), another(|_| None));
}

/// The potential that `Totals::of` has: the impulse of a step from rest is minus its gradient, by
/// differences over what the poses really differ by.
#[test]
fn the_force_is_the_slope_of_the_energy() {
    let mut world = net(Net::Random(3), 10.0, 0.0, Attached::Anywhere, Turning::No);
    world.query_mut::<&mut Momentum>().into_iter().for_each(|momentum| *momentum = Momentum::default());
    let bodies: Vec<Entity> = world.query::<(Entity, &Pose)>().iter().map(|(entity, _)| entity).collect();
    let poses = bodies.iter().map(|&body| *world.get::<&Pose>(body).unwrap()).collect::<Vec<_>>();
    // So short that the stiffness acts as it is, to (w h)^2/12.
    let h: Real = by_precision(1.0 / 4096.0, 1.0 / 1_048_576.0) as Real;
    let mut simulation = weightless(SemiImplicitEuler, h);
    simulation.step(&mut world);
    let wrenches = bodies.iter().map(|&body| *world.get::<&Momentum>(body).unwrap()).collect::<Vec<_>>();
    for ((&body, start), momentum) in bodies.iter().zip(&poses).zip(wrenches) {
        let (force, torque) = (dvec3(momentum.linear) / seconds(h), dvec3(momentum.angular) / seconds(h));
        for (b, pose) in bodies.iter().zip(&poses) {
            *world.get::<&mut Pose>(*b).unwrap() = *pose;
        }
        let energy_at = |pose: Pose| {
            *world.get::<&mut Pose>(body).unwrap() = pose;
            totals(&world, &simulation).force_potential
        };
        let d = by_precision(1e-2, 1e-4);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, -0.8, 0.0)] {
            let (there, back) = [d, -d].map(|d| nets::shifted(start, axis * d)).into();
            let slope = (energy_at(there) - energy_at(back)) / nets::shift(&back, &there).dot(axis);
            // The third derivative of the energy is some k/l, 100 N/m^2 here with a dozen springs,
            // times d^2/6.
            let allowed = 64.0 * d * d + by_precision(2e-4, 1e-8) * force.length();
            assert!((slope + force.dot(axis)).abs() <= allowed, "{slope} for {force} along {axis}");
            let (there, back) = [d, -d].map(|d| nets::turned(start, axis * d)).into();
            let slope = (energy_at(there) - energy_at(back)) / nets::turn(&back, &there).dot(axis);
            let allowed = 64.0 * d * d + by_precision(2e-4, 1e-8) * (1.0 + torque.length());
            assert!((slope + torque.dot(axis)).abs() <= allowed, "{slope} for torque {torque} about {axis}");
        }
    }
}

/// A million steps of two turning bodies on a spring that is attached off their centres, under
/// `MoserVeselov`: the line through the energy is level, to three of its own standard errors in
/// double precision. Taken every 997 steps, so that no period of the motion is sampled. In single
/// precision roundings walk: they are as large as all else.
#[test]
fn energy_has_no_trend() {
    let mut world = World::new();
    let body = |x: Real| {
        RigidBody::new(Shape::cuboid([0.3, 0.5, 0.8]))
            .without_collider()
            .mass(2.0 - f64::from(x))
            .position(Vec3::X * x)
            .angular_velocity(Vec3::new(1.0, 0.4 * x, 2.0))
    };
    let (a, b) = (spawn(&mut world, body(-1.0)), spawn(&mut world, body(1.0)));
    let hooks = (Vec3::new(0.3, 0.2, 0.0), Vec3::new(-0.2, 0.3, 0.1));
    world.spawn((Spring::between(a, b).attached_at(hooks.0, hooks.1).with_rest_length(1.2).with_stiffness(40.0),));
    let mut simulation = weightless(MoserVeselov, DT);
    let mut samples = Vec::new();
    for _ in 0..1003 {
        simulation.step_many(&mut world, 997);
        samples.push((simulation.time(), totals(&world, &simulation).energy()));
    }
    let line = nets::fit(&samples);
    let over_run = line.slope * simulation.time() / line.mean;
    println!(
        "slope {:.2e} +- {:.1e} J/s, spread {:.1e} of {:.3} J, over the run {over_run:.1e} of the energy",
        line.slope, line.error, line.spread, line.mean
    );
    if tumble_tests::DOUBLE {
        assert!(line.slope.abs() <= 3.0 * line.error, "{} +- {}", line.slope, line.error);
    }
    // A million steps, in each of which the state is rounded at random some ten times.
    assert!(
        over_run.abs() <= 3.0 * line.error * simulation.time() / line.mean + 1e7_f64.sqrt() * EPSILON,
        "{over_run:e}"
    );
    // It is off by the square of the step, (w h)^2/12 of what is in the swing, and no more than
    // that at any time.
    assert!(line.spread <= 2e-3 * line.mean, "{:e}", line.spread);
}
