//! Promise: the same bits on any number of threads, in any order of spawning, and after going back
//! in time with a copy of [`VehicleState`].

use tumble::hecs::World;
use tumble::prelude::*;
use tumble::{BodyOrder, Collider, Rollback, state_hash};
use tumble_vehicle::{VehicleInput, VehiclePlan, VehicleState, drive_vehicles};

use crate::course::Draw;

/// A dozen cars that run into each other on a hill, with what they do at a step.
fn world_of(order: &[u64]) -> World {
    let mut world = World::new();
    let mut draw = Draw::new(70, 0);
    let heights: Vec<f64> = (0..400).map(|_| draw.between(0.0, 0.8)).collect();
    let field = Collider::height_field(&heights, 20, [4.0, 4.0]).unwrap();
    RigidBody::new(Shape::Point).fixed().id(BodyId(1000)).collider(field).build().unwrap().spawn(&mut world);
    let slab = RigidBody::new(Shape::cuboid([3.0, 0.3, 3.0])).mass(900.0).position(Vec3::Y * 1.3);
    slab.id(BodyId(999)).build().unwrap().spawn(&mut world);
    for &id in order {
        let mut draw = Draw::new(71, id);
        let mut plan = VehiclePlan::car(4.0, 1000.0 + 100.0 * id as Real);
        plan.probe = draw.probe();
        let place = Vec3::new(9.0 * (id % 4) as Real - 13.0, 1.0, 9.0 * (id / 4) as Real - 9.0);
        let (body, vehicle) = plan.build(Pose::at(place)).unwrap();
        body.id(BodyId(id)).build().unwrap().spawn_with(&mut world, vehicle.components());
    }
    world
}

fn drive(world: &mut World, step: u64) {
    for (id, input) in world.query_mut::<(&BodyId, &mut VehicleInput)>() {
        let mut draw = Draw::new(72, id.0 * 1000 + step / 20);
        *input = VehicleInput {
            throttle: draw.real(-1.0, 1.0),
            brake: draw.real(-2.0, 1.0),
            hand_brake: draw.real(-4.0, 1.0),
            steering: draw.real(-1.0, 1.0),
        };
    }
}

/// The bits of all bodies and of all wheels, by id.
fn bits(world: &World) -> (u64, Vec<String>) {
    let mut found = world.query::<(&BodyId, &VehicleState)>();
    let mut wheels: Vec<(BodyId, VehicleState)> = found.iter().map(|(id, state)| (*id, *state)).collect();
    wheels.sort_by_key(|(id, _)| *id);
    // Entities differ between worlds; all else is numbers.
    let text = wheels.iter().map(|(_, state)| {
        let numbers = state.wheels().iter().map(|wheel| {
            let point = wheel.contact.map(|contact| contact.point);
            format!("{:?}{:?}{:?}{:?}{:?}", wheel.load, wheel.spin, wheel.lateral_force, wheel.spin_angle, point)
        });
        numbers.collect()
    });
    (state_hash(world, &BodyOrder::of(world)), text.collect())
}

#[test]
fn threads_and_the_order_of_spawning_change_nothing() {
    let play = |order: &[u64], threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut world = world_of(order);
            let mut simulation = Simulation::new(Settings::default()).unwrap();
            for step in 0..240 {
                drive(&mut world, step);
                drive_vehicles(&mut world, &simulation);
                simulation.step(&mut world);
            }
            bits(&world)
        })
    };
    let order: Vec<u64> = (0..12).collect();
    let expected = play(&order, 1);
    assert_eq!(play(&order, 4), expected);
    let backwards: Vec<u64> = order.iter().rev().copied().collect();
    assert_eq!(play(&backwards, 2), expected);
}

#[test]
fn a_rewind_with_a_copy_of_the_wheels_goes_on_in_the_same_bits() {
    let mut world = world_of(&(0..12).collect::<Vec<_>>());
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    let mut rollback = Rollback::new(64);
    let (mut kept, mut hashes) = (Vec::new(), Vec::new());
    let step = |world: &mut World, simulation: &mut Simulation| {
        drive(world, simulation.steps());
        drive_vehicles(world, simulation);
        simulation.step(world);
    };
    for _ in 0..150 {
        rollback.save(&world, &simulation).unwrap();
        let states: Vec<(tumble::hecs::Entity, VehicleState)> = world
            .query_mut::<(tumble::hecs::Entity, &VehicleState)>()
            .into_iter()
            .map(|(it, state)| (it, *state))
            .collect();
        kept.push(states);
        hashes.push(bits(&world));
        step(&mut world, &mut simulation);
    }
    for back in [1, 10, 60] {
        let from = simulation.steps() - back;
        rollback.rewind_to_step(from, &mut world, &mut simulation).unwrap();
        for (entity, state) in &kept[from as usize] {
            *world.get::<&mut VehicleState>(*entity).unwrap() = *state;
        }
        for at in from..150 {
            assert_eq!(bits(&world), hashes[at as usize], "{back} steps back, step {at}");
            rollback.save(&world, &simulation).unwrap();
            step(&mut world, &mut simulation);
        }
    }
}

/// `advance_with` takes the system as it is.
#[test]
fn frames_give_the_bits_of_steps() {
    let order: Vec<u64> = (0..4).collect();
    let (mut a, mut b) = (world_of(&order), world_of(&order));
    let mut stepped = Simulation::new(Settings::default().with_dt(0.015625)).unwrap();
    let mut framed = stepped.clone();
    for _ in 0..60 {
        drive_vehicles(&mut a, &stepped);
        stepped.step(&mut a);
    }
    for _ in 0..30 {
        framed.advance_with(&mut b, 0.03125, drive_vehicles);
    }
    assert_eq!(bits(&a), bits(&b));
}
