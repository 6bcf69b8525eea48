//! Promise: the forces that a simulation tells of a body are those that change its momentum: of a
//! free body their sum is the rate of change that an outside solver is given, source by source what
//! the laws of physics say; at rest contacts hold up forces and torques of everything else, on
//! slopes, in stacks off their middle, and for boxes from a centimetre to ten metres.
//!
//! Why: who reads forces builds gauges, controllers and breakable things on them. It fails if a
//! source is left out or counted twice, if a contact acts on the wrong body or with the wrong sign,
//! or if the arms of its impulses are wrong.

use glam::DVec3;
use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3, dvec3};
use tumble::prelude::*;
use tumble::{BodyForces, BodyOrder, STATE_SIZE, state_to_array};
use tumble_tests::touching::{collider, ground, spawn};
use tumble_tests::{Draw, by_precision, run};

fn vector(v: DVec3) -> Vec3 {
    Vec3::new(v.x as Real, v.y as Real, v.z as Real)
}

fn forces(simulation: &Simulation, world: &World, body: Entity) -> BodyForces {
    simulation.forces(world, body).expect("a moving body")
}

struct Tide;

impl ForceLaw for Tide {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        Wrench { force: state.position * 0.7, torque: Vec3::Y * state.time as Real }
    }
}

/// Bodies of all sources that are not contacts.
#[test]
fn the_sum_is_the_rate_of_the_momentum() {
    for case in 0..200 {
        let (mut world, mut draw) = (World::new(), Draw::new(0xF04CE, case));
        let bodies: Vec<Entity> = (0..6)
            .map(|i| {
                let size = draw.log_between(0.05, 5.0);
                let body =
                    RigidBody::new(Shape::cuboid([size, 0.7 * size, 0.4 * size])).without_collider().id(BodyId(i));
                let body = body.mass(draw.log_between(0.01, 1e3)).position(vector(draw.vector(10.0)));
                let body = body.linear_velocity(vector(draw.vector(4.0)));
                body.angular_velocity(vector(draw.vector(3.0))).build().unwrap().spawn(&mut world)
            })
            .collect();
        for (i, body) in bodies.iter().enumerate() {
            if i % 2 == 0 {
                world.insert(*body, (Thruster::new(vector(draw.vector(5.0)), vector(draw.vector(1.0))),)).unwrap();
                world.insert(*body, (Damping { linear: 0.3, angular: 0.2 }, Wind(Vec3::X))).unwrap();
            } else {
                world.insert(*body, (GravityMass::new(20.0), GravityScale(0.5))).unwrap();
            }
            world.get::<&mut Wrench>(*body).unwrap().add_force_at(vector(draw.vector(3.0)), Vec3::X, Vec3::ZERO);
        }
        let spring = Spring::between(bodies[0], bodies[1]).with_stiffness(9.0).with_damping(0.5);
        world.spawn((spring.attached_at(Vec3::X * 0.1, Vec3::Y * 0.2),));
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        simulation.add_global_law(Tide);
        let order = BodyOrder::moving(&world);
        let (mut state, mut rates) = (vec![0.0; 6 * STATE_SIZE], vec![0.0; 6 * STATE_SIZE]);
        state_to_array(&world, &order, &mut state).unwrap();
        simulation.derivative_to_array(&world, simulation.time(), &order, &state, &mut rates).unwrap();
        for (body, rates) in order.entities().iter().zip(rates.chunks_exact(STATE_SIZE)) {
            let all = forces(&simulation, &world, *body);
            assert_eq!((all.laws.len(), all.contacts), (1, Wrench::default()));
            let total = all.total();
            let sizes = all.components().map(|(_, wrench)| wrench).chain(all.laws.iter().copied());
            let sizes = sizes.chain([all.gravity, all.applied, all.damping]);
            let most = sizes.map(|it| it.force.length() + it.torque.length()).fold(1.0, Real::max);
            for (rate, sum) in rates[7..].iter().zip([total.force, total.torque].iter().flat_map(Vec3::to_array)) {
                assert!((rate - sum).abs() <= most * by_precision(1e-5, 1e-13) as Real, "case {case}: {rate}, {sum}");
            }
        }
        // A spring acts on both ends in equal measure.
        let of = |body: &Entity| forces(&simulation, &world, *body).of_component("Spring").unwrap().force;
        let [one, other] = [of(&bodies[0]), of(&bodies[1])];
        assert!(one.length() > 0.0 && (one + other).length() <= one.length() * by_precision(1e-5, 1e-13) as Real);
    }
}

/// On slopes of up to 25 degrees.
#[test]
fn contacts_hold_what_rests() {
    for case in 0..40 {
        let (mut world, mut draw) = (World::new(), Draw::new(0x4E57, case));
        let size = draw.log_between(0.01, 10.0);
        let angle = draw.between(0.0, 25.0).to_radians();
        let slope = Quat::from_rotation_z(angle as Real);
        ground(&mut world, Material::new(0.9, 0.0), slope);
        let half = [size, size * draw.between(0.3, 1.0), size * draw.between(0.5, 2.0)];
        let shape = Shape::cuboid(half);
        let place = slope * (Vec3::Y * half[1] as Real);
        let body =
            RigidBody::new(shape.clone()).density(draw.log_between(10.0, 1e4)).position(place).orientation(slope);
        let held = collider(&shape).with_material(Material::new(0.9, 0.0)).unwrap();
        let body = spawn(&mut world, body, held);
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        run(&mut simulation, &mut world, 240);
        let all = forces(&simulation, &world, body);
        let weight = f64::from(all.gravity.force.length());
        let error = dvec3(all.gravity.force + all.contacts.force).length() / weight;
        let torque = dvec3(all.contacts.torque).length() / (weight * size);
        assert!(error < 5e-3 && torque < 5e-3, "case {case}: size {size:.3}, angle {angle:.2}: {error:e}, {torque:e}");
    }
}

/// Of two boxes, the upper one off the middle: the lower bears both, and the torque of the upper.
#[test]
fn contacts_act_on_both_bodies() {
    for case in 0..40 {
        let (mut world, mut draw) = (World::new(), Draw::new(0x2B0D, case));
        ground(&mut world, Material::default(), Quat::IDENTITY);
        let size = draw.log_between(0.05, 5.0);
        let (lower, upper) = (Shape::cuboid([2.0 * size, size, 2.0 * size]), Shape::cuboid([size; 3]));
        let off = Vec3::new(draw.between(-0.9, 0.9) as Real, 0.0, draw.between(-0.9, 0.9) as Real) * size as Real;
        let at = |height: f64| Vec3::Y * (height * size) as Real;
        let body = RigidBody::new(lower.clone()).density(700.0).position(at(1.0));
        let lower = spawn(&mut world, body, collider(&lower));
        let body = RigidBody::new(upper.clone()).density(draw.between(50.0, 900.0)).position(at(3.0) + off);
        let upper = spawn(&mut world, body, collider(&upper));
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        run(&mut simulation, &mut world, 240);
        let of = |body: Entity| forces(&simulation, &world, body);
        let (below, above) = (of(lower), of(upper));
        for (which, all) in [("lower", &below), ("upper", &above)] {
            let weight = f64::from(all.gravity.force.length());
            let error = dvec3(all.gravity.force + all.contacts.force).length() / weight;
            let torque = dvec3(all.contacts.torque).length() / (weight * size);
            assert!(error < 1e-2 && torque < 1e-2, "case {case}, {which}: {error:e}, {torque:e}");
        }
    }
}

/// Also where the other end has just been pushed, and where it has no `Velocity`.
#[test]
fn a_damper_sees_both_ends_as_they_are() {
    let mut world = World::new();
    let ball = |x: Real| RigidBody::new(Shape::sphere(0.1)).without_collider().mass(2.0).position(Vec3::X * x);
    let [a, b] = [0.0, 2.0].map(|x| ball(x).build().unwrap().spawn(&mut world));
    world.spawn((Spring::between(a, b).with_rest_length(2.0).with_stiffness(10.0).with_damping(3.0),));
    let simulation = Simulation::new(Settings::default()).unwrap();
    world.get::<&mut Momentum>(b).unwrap().apply_impulse(Vec3::X * 8.0);
    world.remove_one::<Velocity>(b).unwrap();
    let of = |body: Entity| forces(&simulation, &world, body).of_component("Spring").unwrap().force;
    assert_eq!([of(a), of(b)], [Vec3::X * 12.0, Vec3::X * -12.0]);
}

#[test]
fn what_forces_do_not_move_has_none() {
    let mut world = World::new();
    let fixed = ground(&mut world, Material::default(), Quat::IDENTITY);
    let kinematic =
        RigidBody::new(Shape::sphere(1.0)).without_collider().kinematic().build().unwrap().spawn(&mut world);
    let moving = |world: &mut World| {
        RigidBody::new(Shape::sphere(1.0)).without_collider().mass(1.0).build().unwrap().spawn(world)
    };
    let (gone, untouched) = (moving(&mut world), moving(&mut world));
    world.despawn(gone).unwrap();
    world.remove_one::<Wrench>(untouched).unwrap();
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    simulation.step(&mut world);
    assert!([fixed, kinematic, gone, untouched].into_iter().all(|body| simulation.forces(&world, body).is_none()));
}
