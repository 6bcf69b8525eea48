//! Promise: a body gets the same bits whether its archetype has more than a body needs or not, and
//! whatever its neighbours need: one that turns far in a step, or whose orientation was set to
//! something else than a rotation.
//!
//! Why: bodies that have nothing but what a body needs have a kernel of their own, with rare cases
//! taken out of it, and the map that turns them takes as many sweeps as a body needs. It fails if
//! the two kernels differ in an operation, if sweeps for a fast neighbour reach a slow body, or if
//! a tile that is done over was written before, or its wrenches were.

use glam::DVec3;
use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{
    Damping, GravityScale, Integrator, InverseInertia, Momentum, Pose, PreviousPose, PrincipalAxes, RigidBody,
    Settings, Shape, Simulation, Velocity, Wrench,
};
use tumble_tests::{Draw, quat, vec3};

/// All tiles of all widths, and what they leave over.
const BODIES: u64 = 32 + 16 + 8 + 4 + 3;

const STEPS: u32 = 30;

fn simulation(integrator: Integrator) -> Simulation {
    Simulation::new(Settings::default().with_integrator(integrator)).unwrap()
}

/// A box of a centimetre to a hundred metres, up to 500 times as long as thick, that turns as fast
/// as is asked for [rad/s].
fn spawn(world: &mut World, draw: &mut Draw, speed: f64) -> Entity {
    let size = draw.log_between(0.01, 100.0);
    let edges = DVec3::new(1.0, 1.0 / draw.log_between(1.0, 500.0), 1.0 / draw.log_between(1.0, 500.0)) * size;
    let edges = [edges, DVec3::new(edges.y, edges.z, edges.x), DVec3::new(edges.z, edges.x, edges.y)];
    let mass = draw.log_between(0.1, 1000.0);
    let body = RigidBody::new(Shape::cuboid(edges[draw.between(0.0, 2.99) as usize])).without_collider().mass(mass);
    let body = body.position(vec3(draw.vector(1000.0))).orientation(quat(draw.orientation()));
    let body = body.linear_velocity(vec3(draw.vector(10.0))).angular_velocity(vec3(draw.direction() * speed));
    body.build().unwrap().spawn(world)
}

/// Bits of all that a step writes.
fn bits(world: &World, body: Entity) -> Vec<u64> {
    let (pose, momentum) = (*world.get::<&Pose>(body).unwrap(), *world.get::<&Momentum>(body).unwrap());
    let (velocity, wrench) = (*world.get::<&Velocity>(body).unwrap(), *world.get::<&Wrench>(body).unwrap());
    let inverse = *world.get::<&InverseInertia>(body).unwrap();
    let vectors = [
        pose.position,
        momentum.linear,
        momentum.angular,
        velocity.linear,
        velocity.angular,
        wrench.force,
        wrench.torque,
        inverse.diagonal,
        inverse.off_diagonal,
    ];
    let numbers = vectors.iter().flat_map(Vec3::to_array).chain(pose.orientation.to_array());
    numbers.map(|number| f64::from(number).to_bits()).collect()
}

/// Pushes some of the bodies now and then.
fn push(world: &World, bodies: &[Entity], step: u32) {
    for (i, &body) in bodies.iter().enumerate() {
        if (i as u32 * 7 + step).is_multiple_of(40) {
            let force = Vec3::new(1.0, -2.0, 3.0);
            *world.get::<&mut Wrench>(body).unwrap() = Wrench { force, torque: force * 1e-3 };
        }
    }
}

/// The bits of all bodies after each of some steps.
fn run(world: &mut World, bodies: &[Entity], integrator: Integrator) -> Vec<Vec<u64>> {
    let mut simulation = simulation(integrator);
    let mut all = Vec::new();
    for step in 0..STEPS {
        push(world, bodies, step);
        simulation.step(world);
        all.extend(bodies.iter().map(|&body| bits(world, body)));
    }
    all
}

/// Plain bodies beside the same with a component that changes nothing, which the general kernel
/// takes: some slow, some of many turns a step.
#[test]
fn the_bits_of_plain_bodies_are_those_of_others() {
    for (case, integrator) in Integrator::ALL.into_iter().enumerate() {
        for slow_only in [true, false] {
            let made = || {
                let mut world = World::new();
                let mut draw = Draw::new(0x9_1a1e, 2 * case as u64 + u64::from(slow_only));
                let speed = |draw: &mut Draw| draw.log_between(0.01, if slow_only { 8.0 } else { 3000.0 });
                let body = |_| {
                    let speed = speed(&mut draw);
                    spawn(&mut world, &mut draw, speed)
                };
                let bodies: Vec<_> = (0..BODIES).map(body).collect();
                (world, bodies)
            };
            let (mut plain, bodies) = made();
            assert_eq!(plain.query_mut::<hecs::With<(), hecs::Or<&PrincipalAxes, &Damping>>>().into_iter().count(), 0);
            let expected = run(&mut plain, &bodies, integrator);
            let (mut remembering, bodies) = made();
            bodies.iter().for_each(|&body| remembering.insert_one(body, PreviousPose::default()).unwrap());
            assert!(run(&mut remembering, &bodies, integrator) == expected, "{integrator}, PreviousPose");
            let (mut scaled, bodies) = made();
            bodies.iter().for_each(|&body| scaled.insert_one(body, GravityScale(1.0)).unwrap());
            assert!(run(&mut scaled, &bodies, integrator) == expected, "{integrator}, GravityScale");
        }
    }
}

/// Slow bodies beside slow ones, and beside ones that need more: of every third the spin or the
/// orientation is another.
#[test]
fn the_bits_of_slow_bodies_are_their_own() {
    for (case, integrator) in Integrator::ALL.into_iter().enumerate() {
        for is_plain in [true, false] {
            let run = |neighbours_are_fast: bool| {
                let mut world = World::new();
                let mut draw = Draw::new(0xfa57, case as u64);
                let mut bodies = Vec::new();
                for i in 0..BODIES {
                    let [speed, factor] = [draw.log_between(0.01, 8.0), draw.log_between(2.0, 3000.0)];
                    let body = spawn(&mut world, &mut draw, speed);
                    if !is_plain {
                        world.insert_one(body, PreviousPose::default()).unwrap();
                    }
                    let is_neighbour = i % 3 == 1;
                    if is_neighbour && neighbours_are_fast {
                        if i % 4 == 3 {
                            let pose = &mut *world.get::<&mut Pose>(body).unwrap();
                            pose.orientation *= factor as Real;
                        } else {
                            let momentum = &mut *world.get::<&mut Momentum>(body).unwrap();
                            momentum.angular *= factor as Real;
                        }
                    }
                    if !is_neighbour {
                        bodies.push(body);
                    }
                }
                run(&mut world, &bodies, integrator)
            };
            assert!(run(false) == run(true), "{integrator}, plain: {is_plain}");
        }
    }
}
