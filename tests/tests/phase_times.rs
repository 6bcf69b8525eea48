//! Promise: `PhaseTimes` tells where the time of steps went: to the systems always, to springs and
//! contacts where there are any, and never more than has passed.
//!
//! Why: who looks for what is slow looks there first. It fails when a part of the step is booked as
//! another, or twice.

use std::time::{Duration, Instant};

use hecs::World;
use tumble::PhaseTimes;
use tumble::prelude::*;

fn ball() -> RigidBody {
    RigidBody::new(Shape::sphere(0.5)).without_collider().mass(1.0)
}

/// Of a hundred steps of a world, and how long they took.
fn times_of(world: &mut World) -> (PhaseTimes, Duration) {
    let times = PhaseTimes::default();
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    let start = Instant::now();
    (0..100).for_each(|_| simulation.step_timed(world, &times));
    (times, start.elapsed())
}

fn sum(times: &PhaseTimes) -> Duration {
    times.accumulate_forces() + times.integrate() + times.update_derived() + times.pairs() + times.contacts()
}

#[test]
fn free_bodies_have_no_time_for_each_other() {
    let mut world = World::new();
    ball().build().unwrap().spawn(&mut world);
    let (times, passed) = times_of(&mut world);
    assert_eq!((times.pairs(), times.contacts()), (Duration::ZERO, Duration::ZERO));
    let systems = [times.accumulate_forces(), times.integrate(), times.update_derived()];
    assert!(systems.iter().all(|time| !time.is_zero()), "{systems:?}");
    assert!(sum(&times) <= passed, "{times:?} in {passed:?}");
}

#[test]
fn springs_and_contacts_have_times_of_their_own() {
    let mut tied = World::new();
    let [a, b] = [0.0, 2.0].map(|x| ball().position(Vec3::X * x).build().unwrap().spawn(&mut tied));
    tied.spawn((Spring::between(a, b),));
    let (times, passed) = times_of(&mut tied);
    assert!(!times.pairs().is_zero() && times.contacts().is_zero(), "{times:?}");
    assert!(!times.integrate().is_zero() && sum(&times) <= passed, "{times:?} in {passed:?}");

    let mut resting = World::new();
    let ground = RigidBody::new(Shape::Point).fixed().build().unwrap();
    ground.spawn_with(&mut resting, (Collider::half_space(),));
    let collider = Collider::new(&Shape::sphere(0.5)).unwrap();
    ball().position(Vec3::Y * 0.5).build().unwrap().spawn_with(&mut resting, (collider,));
    let (times, passed) = times_of(&mut resting);
    assert!(times.pairs().is_zero() && !times.contacts().is_zero(), "{times:?}");
    assert!(!times.integrate().is_zero() && sum(&times) <= passed, "{times:?} in {passed:?}");
}
