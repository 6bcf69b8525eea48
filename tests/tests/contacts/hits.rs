//! Promise: bodies that fly into each other leave as the closed form has it, with an event for
//! every hit and without more energy; what falls lands on the ground and not in it. From a
//! centimetre to ten metres, from 1 to 400 m/s, wherever in a step they meet.
//!
//! Why: a blow is found from where bodies are when a step begins, and at 10 m/s they are elsewhere
//! when they meet. It fails if a contact of balls has the normal of the begin of the step, if a
//! blow that is over before the step ends has no event, or its event has a part of the impulse, if
//! angular momentum is given back with energy out of nothing, or if contacts look less far ahead
//! than bodies go.

use glam::DVec3;
use hecs::{Entity, World};
use tumble::prelude::*;
use tumble::{BodyOrder, ContactEvent, Integrator, Material, Totals};
use tumble_tests::touching::{closed_box, collider, fall_to_ground, pose, spawn, surfaced, velocity};
use tumble_tests::{Draw, dvec3, quat, real, vec3};

fn weightless(steps_a_second: f64) -> Simulation {
    tumble_tests::weightless(Integrator::default(), real(1.0 / steps_a_second))
}

fn shape(draw: &mut Draw, size: f64) -> Shape {
    let [a, b, c] = [(); 3].map(|()| size * draw.log_between(0.3, 1.0));
    match draw.between(0.0, 4.0) as u32 {
        0 => Shape::sphere(size),
        1 => Shape::cuboid([a, b, c]),
        2 => Shape::Capsule { radius: a, half_height: b },
        _ => Shape::Cylinder { radius: a, half_height: b },
    }
}

/// By how much the velocities of two smooth balls after an oblique hit differ from the closed form,
/// over their speed before it; the same of their places, over the way that they go in a step; and
/// by how much the energy has grown.
fn miss_of_balls(is_fixed: bool, draw: &mut Draw) -> [f64; 3] {
    let size = draw.log_between(0.01, 10.0);
    let radii = [size, size * draw.log_between(0.3, 1.0)];
    let masses = [1.0, draw.log_between(0.1, 10.0)];
    let steps_a_second = draw.log_between(30.0, 240.0);
    // In radii a step, and faster than what does not bounce.
    let speed = (size * steps_a_second * draw.log_between(0.2, 20.0)).max(4.0);
    let restitution = draw.between(0.3, 1.0);
    let surface = Material::new(0.0, real(restitution));
    let axis = draw.orientation();
    let (offset, sum) = (draw.between(0.0, 0.8), radii[0] + radii[1]);
    let normal = axis * DVec3::new((1.0 - offset * offset).sqrt(), -offset, 0.0);
    let way = axis * DVec3::X;
    let far = speed / steps_a_second * draw.between(1.0, 3.0);
    let share = if is_fixed { 1.0 } else { draw.between(0.0, 1.0) };

    let mut world = World::new();
    let drift = [way * (speed * share), way * (speed * (share - 1.0))];
    let starts = [normal * -sum - drift[0] * (far / speed), -drift[1] * (far / speed)];
    let bodies: [Entity; 2] = [0, 1].map(|i: usize| {
        let ball = Shape::sphere(radii[i]);
        let body = RigidBody::new(ball.clone()).position(vec3(starts[i]));
        let body = if i == 1 && is_fixed { body.fixed() } else { body.mass(masses[i]).linear_velocity(vec3(drift[i])) };
        spawn(&mut world, body, surfaced(collider(&ball), surface))
    });
    let mut simulation = weightless(steps_a_second);
    simulation.step_many(&mut world, (far / speed * steps_a_second) as u32 + 3);

    let mass = if is_fixed { masses[0] } else { masses[0] * masses[1] / (masses[0] + masses[1]) };
    let impulse = normal * (mass * (1.0 + restitution) * speed * normal.dot(way));
    let expected = [drift[0] - impulse / masses[0], drift[1] + impulse / masses[1]];
    let moving = if is_fixed { 0..1 } else { 0..2 };
    let velocity = |i: usize| if moving.contains(&i) { dvec3(velocity(&world, bodies[i]).linear) } else { DVec3::ZERO };
    let after = [velocity(0), velocity(1)];
    let greatest = |misses: [DVec3; 2]| moving.clone().map(|i| misses[i].length()).fold(0.0, f64::max);
    let miss = greatest([0, 1].map(|i| after[i] - expected[i])) / speed;
    let met = far / speed;
    let places = [0, 1].map(|i| {
        let expected = starts[i] + drift[i] * met + expected[i] * (simulation.time() - met);
        dvec3(pose(&world, bodies[i]).position) - expected
    });
    let energy = |of: [DVec3; 2]| moving.clone().map(|i| masses[i] * of[i].length_squared()).sum::<f64>();
    [miss, greatest(places) * steps_a_second / speed, energy(after) / energy(drift) - 1.0]
}

/// The misses of velocities and of places, each sorted, and the greatest gain of energy.
fn misses_of_balls(is_fixed: bool) -> ([Vec<f64>; 2], f64) {
    let found: Vec<[f64; 3]> = (0..2000).map(|case| miss_of_balls(is_fixed, &mut Draw::new(2340, case))).collect();
    let sorted = [0, 1].map(|which| {
        let mut all: Vec<f64> = found.iter().map(|it| it[which]).collect();
        all.sort_by(f64::total_cmp);
        all
    });
    (sorted, found.iter().map(|it| it[2]).fold(0.0, f64::max))
}

#[test]
fn balls_leave_a_fixed_ball_as_the_closed_form_has_it() {
    let ([velocities, _], gain) = misses_of_balls(true);
    assert!(velocities[1900] < 1e-5, "one of twenty misses by {}", velocities[1900]);
    assert!(velocities[1999] < 0.02, "one misses by {}", velocities[1999]);
    assert!(gain < 1e-3, "energy grows by {gain}");
}

/// Where they are too: impulses act when substeps begin and end, and balls go on from where they
/// met.
#[test]
fn two_free_balls_leave_each_other_as_the_closed_form_has_it() {
    let ([velocities, places], gain) = misses_of_balls(false);
    assert!(velocities[1999] < 2e-5, "one misses by {}", velocities[1999]);
    assert!(places[1999] < 5e-5, "one is off by {}", places[1999]);
    assert!(gain < 1e-3, "energy grows by {gain}");
}

/// Of bodies that hit others, how many changed their velocities without an event.
fn unheard(draw: &mut Draw) -> bool {
    let sizes = [draw.log_between(0.1, 1.0), draw.log_between(0.01, 0.1)];
    let [target, shot] = sizes.map(|size| shape(draw, size));
    let surface = Material::new(real(draw.between(0.0, 1.0)), if draw.often(0.5) { 0.0 } else { 0.4 });
    let mut world = World::new();
    let body = RigidBody::new(target.clone()).orientation(quat(draw.orientation()));
    let body = if draw.often(0.5) { body.fixed() } else { body.mass(50.0) };
    spawn(&mut world, body, surfaced(collider(&target), surface));
    let (speed, steps_a_second) = (draw.log_between(3.0, 400.0), draw.log_between(30.0, 240.0));
    let way = draw.direction();
    let place = draw.vector(0.3) - way * (3.0 + speed * draw.between(1.0, 2.0) / steps_a_second);
    let body = RigidBody::new(shot.clone()).mass(0.1).position(vec3(place)).linear_velocity(vec3(way * speed));
    let body = spawn(&mut world, body, surfaced(collider(&shot), surface));
    let mut simulation = weightless(steps_a_second);
    let (mut begun, mut ended) = (0, 0);
    for _ in 0..(8.0 / speed * steps_a_second) as u32 + 6 {
        simulation.step(&mut world);
        for event in simulation.contact_events() {
            match event {
                ContactEvent::Begin(_, impact) => {
                    begun += 1;
                    let is_unit = (dvec3(impact.normal).length() - 1.0).abs() < 1e-3;
                    assert!(is_unit && impact.impulse.is_finite(), "{impact:?}");
                }
                ContactEvent::End(_) => ended += 1,
            }
        }
        assert!(ended <= begun && begun <= ended + 1, "{begun} begins, {ended} ends");
    }
    let changed = (dvec3(velocity(&world, body).linear) - way * speed).length();
    changed > 0.01 * speed && begun == 0
}

#[test]
fn every_hit_has_an_event() {
    let unheard: Vec<u64> = (0..2000).filter(|case| unheard(&mut Draw::new(2341, *case))).collect();
    assert!(unheard.is_empty(), "{} without: {unheard:?}", unheard.len());
}

/// The most that the energy of some bodies in a closed room becomes, over what it was.
fn growth(draw: &mut Draw) -> f64 {
    let surface = match draw.between(0.0, 3.0) as u32 {
        0 => Material::new(0.0, 1.0),
        1 => Material::new(0.5, 0.5),
        _ => Material::new(0.5, 0.0),
    };
    let mut world = World::new();
    closed_box(&mut world, 0.2, surface);
    let speed = draw.log_between(3.0, 100.0);
    for place in [DVec3::ZERO, DVec3::X * 0.6, DVec3::X * -0.6] {
        let (it, size) = (draw.direction() * speed, draw.between(0.1, 0.2));
        let shape = shape(draw, size);
        let body = RigidBody::new(shape.clone()).mass(1.0).position(vec3(place)).linear_velocity(vec3(it));
        spawn(&mut world, body, surfaced(collider(&shape), surface));
    }
    let mut simulation = weightless(draw.log_between(30.0, 240.0));
    let order = BodyOrder::of(&world);
    let energy = |world: &World| Totals::of(world, &Settings::default(), &order).kinetic();
    let before = energy(&world);
    let mut most: f64 = 0.0;
    for _ in 0..120 {
        simulation.step(&mut world);
        let now = energy(&world) / before;
        assert!(now.is_finite());
        most = most.max(now);
    }
    most
}

/// Bodies that stop each other on bent ways get back the angular momentum that they lost there, as
/// far as they have the energy for it.
#[test]
fn what_flies_in_a_closed_room_gains_no_energy() {
    for case in 0..300 {
        let growth = growth(&mut Draw::new(2342, case));
        assert!(growth < 1.0 + 1e-4, "in room {case} energy becomes {growth} times what it was");
    }
}

#[test]
fn what_falls_lands_on_the_ground() {
    for case in 0..300 {
        let mut draw = Draw::new(2343, case);
        let (size, steps_a_second) = (draw.log_between(0.01, 10.0), draw.log_between(30.0, 240.0));
        let (shape, half) = match draw.between(0.0, 3.0) as u32 {
            0 => (Shape::sphere(size), size),
            1 => (Shape::cuboid([size, 0.4 * size, 0.8 * size]), 0.4 * size),
            _ => (Shape::Cylinder { radius: 0.7 * size, half_height: size }, size),
        };
        let surface = Material::new(0.5, real(draw.between(0.0, 0.6)));
        // Up to its own size a step.
        let speed = size * steps_a_second * draw.log_between(0.02, 1.0);
        let height = half + draw.between(0.5, 3.0) * speed / steps_a_second;
        let mut world = World::new();
        let mass = draw.log_between(0.1, 100.0);
        let body = fall_to_ground(&mut world, &shape, surface, mass, [height, speed]);
        let settings = Settings::default().with_dt(real(1.0 / steps_a_second));
        let mut simulation = Simulation::new(settings).unwrap();
        for _ in 0..12 {
            simulation.step(&mut world);
            let depth = half - f64::from(pose(&world, body).position.y);
            // What gravity does in a step comes on top of what the step begins with.
            let fall = 0.5 * 9.81 / (steps_a_second * steps_a_second);
            assert!(depth < 0.01 * half + fall, "case {case} is {depth} m deep, of {half} m");
        }
    }
}

#[test]
fn the_event_of_a_landing_has_all_of_its_impulse() {
    for case in 0..300 {
        let mut draw = Draw::new(2344, case);
        let (size, steps_a_second) = (draw.log_between(0.01, 10.0), draw.log_between(30.0, 240.0));
        // Up to its own size a step, and at least an impact.
        let speed = (size * steps_a_second * draw.log_between(0.02, 1.0)).max(2.0);
        let height = size + draw.between(0.5, 3.0) * speed / steps_a_second;
        let mut world = World::new();
        let (mass, shape) = (draw.log_between(0.1, 100.0), Shape::sphere(size));
        fall_to_ground(&mut world, &shape, Material::new(0.5, 0.0), mass, [height, speed]);
        let mut simulation = weightless(steps_a_second);
        let mut landings = Vec::new();
        for _ in 0..6 {
            simulation.step(&mut world);
            landings.extend(simulation.contact_events());
        }
        let [ContactEvent::Begin(_, impact)] = landings[..] else { panic!("case {case}: {landings:?}") };
        let found = [f64::from(impact.speed) / speed, f64::from(impact.impulse) / (mass * speed)];
        assert!(found.iter().all(|it| (it - 1.0).abs() < 1e-3), "case {case}: {found:?}");
    }
}
