//! Promise: every event of joints is reported exactly once, however steps fall into frames.
//!
//! Why: a frame of several steps reported its last step only, and a rope that broke before it was
//! still drawn. It fails if a frame loses events, reports some twice, or in another order.

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::prelude::*;
use tumble::{Breakable, JointEvent};
use tumble_tests::Draw;

const STEPS: u64 = 60;

/// Pendulums that break sooner or later, and others of which the bob is taken away.
fn scene() -> (World, Vec<(u64, Entity)>) {
    let (mut world, mut draw) = (World::new(), Draw::new(2320, 0));
    let mut taken = Vec::new();
    let hook = RigidBody::new(Shape::Point).fixed().build().unwrap().spawn(&mut world);
    for i in 0..30_u8 {
        let x = Real::from(i);
        let bob =
            RigidBody::new(Shape::sphere(0.1)).without_collider().mass(1.0).position(Vec3::new(x + 1.0, 0.0, 0.0));
        let bob = bob.build().unwrap().spawn(&mut world);
        let joint = Joint::ball(hook, bob).at_point(&world, Vec3::X * x).unwrap();
        // Falling from the side it pulls at its joint up to three times its weight.
        let most = draw.between(1.0, 29.0) as Real;
        world.spawn((joint, Breakable::at_force(most)));
        if draw.often(0.3) {
            taken.push((draw.between(1.0, 20.0) as u64, bob));
        }
    }
    (world, taken)
}

/// Takes away what is to go before a step.
fn take_away(world: &mut World, taken: &[(u64, Entity)], step: u64) {
    taken.iter().filter(|(when, _)| *when == step).for_each(|(_, bob)| world.despawn(*bob).unwrap());
}

#[test]
fn every_event_comes_once_however_frames_fall() {
    let settings = Settings::default();
    let one_by_one: Vec<JointEvent> = {
        let ((mut world, taken), mut simulation) = (scene(), Simulation::new(settings).unwrap());
        let mut events = Vec::new();
        for step in 0..STEPS {
            take_away(&mut world, &taken, step);
            simulation.step(&mut world);
            events.extend(simulation.joint_events());
        }
        events
    };
    let broke = one_by_one.iter().filter(|event| matches!(event, JointEvent::Broke(_))).count();
    assert!(broke > 5 && one_by_one.len() > broke + 3, "{one_by_one:?}");
    for case in 0..8 {
        let ((mut world, taken), mut simulation) = (scene(), Simulation::new(settings).unwrap());
        let (mut draw, mut events, mut in_closure) = (Draw::new(2321, case), Vec::new(), Vec::new());
        while simulation.steps() < STEPS {
            let left = (STEPS - simulation.steps()) as f64 * f64::from(settings.dt);
            simulation.advance_with(&mut world, draw.between(0.0, 0.1).min(left + 1e-6), |world, simulation| {
                in_closure.extend(simulation.joint_events());
                take_away(world, &taken, simulation.steps());
            });
            events.extend(simulation.joint_events());
        }
        assert_eq!(events, one_by_one, "case {case}");
        // The closure gets those of each step before the next.
        assert_eq!(in_closure, one_by_one[..in_closure.len()], "case {case}");
    }
}
