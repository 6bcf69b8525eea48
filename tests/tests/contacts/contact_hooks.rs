//! Promise: a surface that moves on its body carries what lies on it, by friction alone; a hook
//! sees every contact before it is solved and what it changes or refuses holds, on any thread and
//! in a batch; pairs that ignore each other pass; the impact of a contact event is that of the
//! blow.
//!
//! Why: conveyor belts, one-way platforms, ice that one character feels and the sound of a blow are
//! asked for on the first day. It fails if a belt's velocity has the wrong sign or frame, if what a
//! hook refuses is stopped by another net, or if the speed of a blow is that after it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{Batch, ContactEvent, ContactProposal, IgnoreContacts, Impact, Trial};
use tumble_benches::pool;
use tumble_tests::touching::{collider, cube, fall_to_ground, ground, pose, spawn, surfaced, velocity};
use tumble_tests::{Draw, dvec3, hash, real, run, vec3};

const G: f64 = 9.81;

/// A box of any size on a belt of any direction, on ground that is turned about the upright, or the
/// belt is the box's own: it slips for `v / (mu g)` and then goes along. Fast belts slip longer.
#[test]
fn a_belt_carries_what_lies_on_it() {
    for case in 0..60 {
        let mut draw = Draw::new(2340, case);
        let half = draw.log_between(0.02, 2.0);
        let friction = draw.between(0.1, 1.0);
        let speed = draw.log_between(0.05, 1.0) * (G * half).sqrt();
        let angle = draw.between(-3.0, 3.0);
        let along = Vec3::new(real(angle.cos()), 0.0, real(angle.sin()));
        let turned = Quat::from_rotation_y(real(draw.between(-3.0, 3.0)));
        let of_box = draw.often(0.3);
        let belt = Material { surface_velocity: along * real(speed), ..Material::new(real(friction), 0.0) };
        let plain = Material::new(real(friction), 0.0);
        let mut world = World::new();
        ground(&mut world, if of_box { plain } else { belt }, turned);
        let shape = Shape::cuboid([half, 0.1 * half, half]);
        let body = RigidBody::new(shape.clone()).mass(draw.log_between(1e-2, 1e3)).position(Vec3::Y * real(0.1 * half));
        let it = spawn(&mut world, body, surfaced(collider(&shape), if of_box { belt } else { plain }));
        // The box's own belt throws the ground back, and itself forward.
        let expected = if of_box { -(along * real(speed)) } else { turned * along * real(speed) };
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        let slips = speed / (friction * G);
        let dt = f64::from(simulation.settings().dt);
        let half_way = (0.5 * slips / dt) as u32;
        run(&mut simulation, &mut world, half_way);
        let reached = dvec3(velocity(&world, it).linear).length();
        let wanted = friction * G * f64::from(half_way) * dt;
        assert!((reached - wanted).abs() < 0.05 * wanted + 0.02 * speed, "case {case}: {reached} of {wanted}");
        run(&mut simulation, &mut world, half_way + 120);
        let off = dvec3(velocity(&world, it).linear - expected).length();
        assert!(off < 0.01 * speed, "case {case}: {:?} for {expected:?}", velocity(&world, it).linear);
    }
}

/// A ball on a belt rolls: its contact point goes with the belt, and by angular momentum about that
/// its centre has two sevenths of the speed of the belt.
#[test]
fn a_ball_on_a_belt_rolls_at_two_sevenths() {
    let belt = Material { surface_velocity: Vec3::X * 3.0, ..Material::new(0.8, 0.0) };
    let mut world = World::new();
    ground(&mut world, belt, Quat::IDENTITY);
    let shape = Shape::sphere(0.25);
    let ball = spawn(&mut world, RigidBody::new(shape.clone()).mass(2.0).position(Vec3::Y * 0.25), collider(&shape));
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    run(&mut simulation, &mut world, 120);
    let Velocity { linear, angular } = velocity(&world, ball);
    assert!((linear.x - 6.0 / 7.0).abs() < 5e-3, "{linear}");
    assert!((linear.x + 0.25 * angular.z - 3.0).abs() < 5e-3, "{linear} {angular}");
}

/// Bodies that fall on a platform from above, or fly up through it, from slow to fast and thin to
/// thick: those that come from below pass, all come to rest on it, and a second platform that
/// refuses nothing holds them.
#[test]
fn a_platform_is_open_from_below() {
    for case in 0..40 {
        let mut draw = Draw::new(2341, case);
        let (thick, radius) = (draw.log_between(0.001, 0.3), draw.log_between(0.03, 0.3));
        let slab = Shape::cuboid([20.0, thick, 20.0]);
        let mut world = World::new();
        let platform = spawn(&mut world, RigidBody::new(slab.clone()).fixed(), collider(&slab));
        let shape = if draw.often(0.5) { Shape::sphere(radius) } else { cube(radius) };
        let begin = -(thick + 2.0 * radius + draw.between(0.1, 1.0));
        let rise = draw.between(2.0 * (thick + 2.0 * radius), 8.0);
        let speed = (2.0 * G * (rise - begin)).sqrt();
        let body = RigidBody::new(shape.clone()).mass(1.0).position(Vec3::Y * real(begin));
        let it = spawn(&mut world, body.linear_velocity(Vec3::Y * real(speed)), collider(&shape));
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        simulation.set_contact_hook(move |contact: &mut ContactProposal| {
            let Some(up) = contact.normal_from(platform) else { return };
            if !contact.touched && (up.y < 0.7 || contact.closing_speed == 0.0) {
                contact.refuse();
            }
        });
        run(&mut simulation, &mut world, 400);
        let height = f64::from(pose(&world, it).position.y);
        assert!((height - thick - radius).abs() < 0.02 * radius, "case {case}: {height} for {}", thick + radius);
        // Without its hook the platform holds from both sides.
        simulation.clear_contact_hook();
        world.get::<&mut Pose>(it).unwrap().position.y = real(begin);
        world.get::<&mut Momentum>(it).unwrap().linear = Vec3::Y * real(speed);
        run(&mut simulation, &mut world, 20);
        assert!(pose(&world, it).position.y < 0.0, "case {case}");
    }
}

fn sliding(friction: Real) -> (World, Entity) {
    let mut world = World::new();
    ground(&mut world, Material::new(friction, 0.0), Quat::IDENTITY);
    let body = RigidBody::new(cube(0.5)).mass(1.0).position(Vec3::Y * 0.5).linear_velocity(Vec3::X * 2.0);
    let it = spawn(&mut world, body, surfaced(collider(&cube(0.5)), Material::new(friction, 0.0)));
    (world, it)
}

/// What a hook sets is what a material would have set, to the bit, on any number of threads and in
/// a batch; what is no number leaves all as it was.
#[test]
fn a_hook_sets_what_materials_set() {
    let after = |friction: Real, set: Option<Real>, threads: usize| {
        let (mut world, _) = sliding(friction);
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        if let Some(set) = set {
            simulation.set_contact_hook(move |contact: &mut ContactProposal| {
                (contact.static_friction, contact.dynamic_friction) = (set, set);
                (contact.restitution, contact.rolling_resistance) = (0.0, -1.0);
                contact.surface_velocity.x = if set.is_nan() { set } else { 0.0 };
            });
        }
        pool(threads).install(|| run(&mut simulation, &mut world, 40));
        (hash(&world), world)
    };
    let (icy, _) = after(0.1, None, 1);
    assert_eq!(after(0.7, Some(0.1), 1).0, icy);
    assert_eq!(after(0.7, Some(0.1), 2).0, icy);
    assert_ne!(after(0.7, Some(0.7), 1).0, icy);
    assert_eq!(after(0.7, Some(Real::NAN), 1).0, after(0.7, None, 1).0);
    let mut trials = Vec::new();
    for _ in 0..3 {
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        simulation.set_contact_hook(|contact: &mut ContactProposal| {
            (contact.static_friction, contact.dynamic_friction) = (0.1, 0.1);
        });
        trials.push(Trial { world: sliding(0.7).0, simulation });
    }
    let mut batch: Batch = trials.into_iter().collect();
    batch.step_many(40);
    assert!(batch.trials().iter().all(|trial| hash(&trial.world) == icy));
}

/// It sees each contact once a substep, with the bodies in order and the normal from the first.
#[test]
fn a_hook_sees_every_contact() {
    let (mut world, it) = sliding(0.5);
    let mut simulation = Simulation::new(Settings::default().with_substeps(3)).unwrap();
    let seen = Arc::new(AtomicU64::new(0));
    let count = Arc::clone(&seen);
    simulation.set_contact_hook(move |contact: &mut ContactProposal| {
        let sees = contact.bodies[1] == it && contact.normal.y == 1.0 && contact.other(it) == Some(contact.bodies[0]);
        let sees = sees && contact.normal_from(it) == Some(-Vec3::Y) && contact.point().y.abs() < 0.01;
        count.fetch_add(if sees { 1 } else { 1000 }, Ordering::Relaxed);
    });
    simulation.step(&mut world);
    assert_eq!(seen.load(Ordering::Relaxed), 3);
}

/// Pairs that ignore each other pass, from when their component is spawned until it is despawned;
/// others do not, and no entity of the pair need exist.
#[test]
fn pairs_that_ignore_each_other_pass() {
    let mut world = World::new();
    let floor = ground(&mut world, Material::default(), Quat::IDENTITY);
    let [a, b] = [0.0, 3.0].map(|x| {
        let body = RigidBody::new(cube(0.5)).mass(1.0).position(Vec3::new(x, 0.5, 0.0));
        spawn(&mut world, body, collider(&cube(0.5)))
    });
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    let ignored = world.spawn((IgnoreContacts::between(a, floor),));
    world.spawn((IgnoreContacts::between(b, b),));
    world.spawn((IgnoreContacts::between(Entity::DANGLING, floor),));
    run(&mut simulation, &mut world, 10);
    assert!(pose(&world, a).position.y < 0.4 && (pose(&world, b).position.y - 0.5).abs() < 1e-3);
    assert_eq!(simulation.contacts().count(), 1);
    world.despawn(ignored).unwrap();
    run(&mut simulation, &mut world, 240);
    // It is pushed out again.
    assert!((pose(&world, a).position.y - 0.5).abs() < 0.01, "{}", pose(&world, a).position.y);
}

/// The impact with which a contact begins, as far as `steps`.
fn impact(simulation: &mut Simulation, world: &mut World, steps: u32) -> Impact {
    for _ in 0..steps {
        simulation.step(world);
        for event in simulation.contact_events() {
            if let ContactEvent::Begin(_, impact) = event {
                return impact;
            }
        }
    }
    panic!("nothing met")
}

/// Two balls of random masses, restitutions and speeds, alone: the speed is theirs, and the impulse
/// the change of momentum, at most that of a full bounce.
#[test]
fn an_impact_is_that_of_the_blow() {
    for case in 0..100 {
        let mut draw = Draw::new(2342, case);
        let size = draw.log_between(0.02, 5.0);
        let masses = [(); 2].map(|()| draw.log_between(1e-2, 1e2));
        let speed = draw.log_between(2.0, 50.0);
        let restitution = if draw.often(0.3) { 0.0 } else { draw.between(0.0, 1.0) };
        let along = draw.direction();
        let mut world = World::new();
        let at = draw.vector(3.0);
        let place = [at - along * (size * 1.01), at + along * (size * 1.01)];
        let balls = [1.0, -1.0].map(|sign| {
            let which = usize::from(sign < 0.0);
            let body = RigidBody::new(Shape::sphere(size)).mass(masses[which]).position(vec3(place[which]));
            let body = body.linear_velocity(vec3(along * (0.5 * sign * speed))).id(BodyId(which as u64));
            spawn(&mut world, body, surfaced(collider(&Shape::sphere(size)), Material::new(0.3, real(restitution))))
        });
        // What bounces in a substep before the last is in no event.
        let substeps = if restitution > 0.0 { 1 } else { 1 + (case % 3) as u32 };
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_substeps(substeps);
        let mut simulation = Simulation::new(settings).unwrap();
        let impact = impact(&mut simulation, &mut world, 120);
        let [found, impulse] = [impact.speed, impact.impulse].map(f64::from);
        assert!((found - speed).abs() < 1e-3 * speed, "case {case}: {found} of {speed}");
        // Nothing else acts: the impulse is what the first one's momentum has lost. A blow in the
        // last substep may go on in the next step.
        let left = dvec3(world.get::<&Momentum>(balls[0]).unwrap().linear).dot(along);
        let wanted = 0.5 * masses[0] * speed - left;
        let stop = masses[0] * masses[1] / (masses[0] + masses[1]) * speed;
        assert!((impulse - wanted).abs() < 0.01 * wanted, "case {case}: {impulse} of {wanted}");
        assert!(impulse > 0.5 * stop && impulse < 1.01 * stop * (1.0 + restitution), "case {case}: {impulse}");
        assert!(dvec3(impact.normal).dot(along) > 0.999, "case {case}: {:?}", impact.normal);
        // Between the two when they met, who may have gone on in the substep.
        let off = (dvec3(impact.point) - at).length();
        assert!(off < 0.02 * size + speed / 60.0, "case {case}: {off}");
    }
}

/// What is laid down has no impact to speak of, and what falls has the speed of its fall.
#[test]
fn an_impact_of_a_fall_has_its_speed() {
    for case in 0..30 {
        let mut draw = Draw::new(2343, case);
        let (half, height) = (draw.log_between(0.02, 1.0), draw.log_between(0.1, 10.0));
        let mut world = World::new();
        fall_to_ground(&mut world, &cube(half), Material::default(), 1.0, [half + height, 0.0]);
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        let impact = impact(&mut simulation, &mut world, 200);
        let (speed, wanted) = (f64::from(impact.speed), (2.0 * G * height).sqrt());
        // Gravity acts within the step in which they meet.
        let step = G / 60.0;
        assert!((speed - wanted).abs() < 1.1 * step, "case {case}: {speed} of {wanted}");
        let impulse = f64::from(impact.impulse);
        assert!((impulse - wanted).abs() < 0.05 * wanted + 2.0 * step, "case {case}: {impulse} of {wanted}");
    }
}
