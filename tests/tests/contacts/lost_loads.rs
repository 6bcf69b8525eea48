//! Promise: what carried a heavy body stays where it is when that is despawned, however light it is
//! and whatever is below.
//!
//! Why: players take things off piles. It fails if the impulses that held the load are the
//! beginning of the next step: a light body would be thrown at hundreds of metres a second.

use glam::DVec3;
use hecs::World;
use tumble::prelude::*;
use tumble_tests::touching::{collider, ground_or_cube, spawn, surfaced, velocity};
use tumble_tests::{Draw, cases, dvec3, run, settings_at_random, vec3};

/// Layers of one to three boxes side by side, a plank on each, and a load on top.
#[test]
fn what_carried_a_load_stays_when_that_is_gone() {
    for case in 0..u64::from(cases(60)) {
        let mut draw = Draw::new(0x105D, case);
        let size = draw.log_between(0.02, 5.0);
        let surface = Material::default().with_friction(0.6);
        let mut world = World::new();
        ground_or_cube(&mut draw, &mut world, 10.0 * size, surface);
        let mass = draw.log_between(0.01, 100.0);
        let (mut height, mut carriers) = (0.0, Vec::new());
        let put = |world: &mut World, half: DVec3, x: f64, mass: f64, height: f64| {
            let shape = Shape::cuboid(half.to_array());
            let body = RigidBody::new(shape.clone()).mass(mass).position(vec3(DVec3::new(x, height + half.y, 0.0)));
            spawn(world, body, surfaced(collider(&shape), surface))
        };
        let layers = 1 + draw.between(0.0, 2.99) as u32;
        for _ in 0..layers {
            let count = 1 + draw.between(0.0, 2.99) as u32;
            for i in 0..count {
                let x = (f64::from(i) - 0.5 * f64::from(count - 1)) * 1.1 * size;
                carriers.push(put(&mut world, DVec3::splat(0.5 * size), x, mass, height));
            }
            height += size;
            carriers.push(put(&mut world, DVec3::new(2.0, 0.1, 1.0) * size, 0.0, mass, height));
            height += 0.2 * size;
        }
        let heavy = mass * draw.log_between(10.0, 1e4);
        let load = put(&mut world, DVec3::new(1.5, 0.5, 0.8) * size, 0.0, heavy, height);
        let settings = settings_at_random(&mut draw, [4.0, 16.0]);
        let mut simulation = Simulation::new(settings).unwrap();
        run(&mut simulation, &mut world, 90);
        let speed = |world: &World| {
            carriers.iter().map(|body| dvec3(velocity(world, *body).linear).length()).fold(0.0, f64::max)
        };
        let before = speed(&world);
        world.despawn(load).unwrap();
        let mut fastest = 0.0_f64;
        for _ in 0..60 {
            simulation.step(&mut world);
            fastest = fastest.max(speed(&world));
        }
        // What the load pressed in comes out at no more than 3 m/s: of each layer the boxes and the
        // plank on them.
        let most = before + 3.0 * f64::from(2 * layers);
        println!("case {case}: {fastest} m/s, {before} before, {:e} times the mass", heavy / mass);
        assert!(fastest < most, "case {case}, {size} m, {} times the mass: {fastest} m/s", heavy / mass);
    }
}
