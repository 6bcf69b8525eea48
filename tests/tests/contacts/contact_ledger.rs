//! Promise: what contacts take from bodies and give to them is booked as their work, and the works
//! of a body that touches something still add up to the change of its kinetic energy: sliding,
//! bouncing, rolling, in piles, under damping and force components.
//!
//! Why: a ledger with a hole where bodies touch says nothing about a scene with ground. It fails if
//! the work of the integrator that touched bodies do not take is left in the books, or a force is
//! booked over another way than it acted on.

use hecs::{Entity, World};
use tumble::math::Vec3;
use tumble::prelude::*;
use tumble::{BodyOrder, Collider, Material, Totals, Work};
use tumble_tests::{dvec3, run};

use crate::pile;

const G: f64 = 9.81;

fn on_ground(body: RigidBody, shape: &Shape, surface: Material) -> (World, Entity) {
    let mut world = World::new();
    let collider = |collider: Collider| collider.with_material(surface).unwrap();
    let ground = RigidBody::new(Shape::Point).fixed().build().unwrap();
    ground.spawn_with(&mut world, (collider(Collider::half_space()),));
    let body = body.build().unwrap().spawn_with(&mut world, (collider(Collider::new(shape).unwrap()),));
    (world, body)
}

fn kinetic(world: &World, body: Entity) -> f64 {
    Totals::of_body(world.entity(body).unwrap(), &Settings::default()).kinetic()
}

fn work(world: &World, body: Entity) -> Work {
    *world.get::<&Work>(body).unwrap()
}

/// A box slides to rest: all its energy is what friction took, but for what its weight did as it
/// sank into the ground by less than a millimetre.
#[test]
fn a_sliding_box_loses_its_energy_to_the_ground() {
    let shape = Shape::cuboid([0.25, 0.25, 0.25]);
    let start = RigidBody::new(shape.clone()).mass(2.0).position(Vec3::Y * 0.25).linear_velocity(Vec3::X * 5.0);
    let (mut world, sliding) = on_ground(start, &shape, Material::default());
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    Ledger::attach(&mut world, &simulation);
    let before = kinetic(&world, sliding);
    run(&mut simulation, &mut world, 120);
    let (work, after) = (work(&world, sliding), kinetic(&world, sliding));
    assert!(after < 1e-6 && (before - 25.0).abs() < 1e-5);
    assert!((work.contacts / -before - 1.0).abs() < 1e-3, "{work:?}");
    assert!((work.total() - (after - before)).abs() < 1e-9 * before, "{work:?}");
    assert!(work.gravity.abs() < 1e-3 * before && work.integrator.abs() < 1e-5 * before, "{work:?}");
    assert_eq!((work.applied, work.damping), (0.0, 0.0));
}

/// A ball that falls from a metre and bounces with 0.8: gravity did what its height says, and each
/// bounce took 1 - e^2 of the energy.
#[test]
fn a_bouncing_ball_loses_what_its_restitution_has_it_lose() {
    let shape = Shape::sphere(0.1);
    let start = RigidBody::new(shape.clone()).mass(1.5).position(Vec3::Y * 1.1);
    let (mut world, ball) = on_ground(start, &shape, Material::new(0.5, 0.8));
    let mut simulation = Simulation::new(Settings::default().with_dt(1e-3)).unwrap();
    Ledger::attach(&mut world, &simulation);
    // It touches the ground after 0.45 s, and again 0.72 s after that.
    run(&mut simulation, &mut world, 800);
    let (first, height) = (work(&world, ball), dvec3(world.get::<&Pose>(ball).unwrap().position).y);
    let fallen = 1.5 * G * (1.1 - height);
    assert!((first.gravity / fallen - 1.0).abs() < 1e-3, "{first:?} for {fallen}");
    let lost = 1.5 * G * (1.0 - 0.8 * 0.8);
    assert!((first.contacts / -lost - 1.0).abs() < 1e-2, "{first:?} for {lost}");
    assert!((first.total() - kinetic(&world, ball)).abs() < 1e-9, "{first:?}");
}

/// Applied forces, damping, a law and a force component on a body that lies: each is booked as what
/// it is.
#[test]
fn each_force_on_a_touching_body_has_its_own_work() {
    let shape = Shape::cuboid([0.5, 0.5, 0.5]);
    let damping = Damping { linear: 0.5, angular: 0.5 };
    let start = RigidBody::new(shape.clone()).mass(2.0).position(Vec3::Y * 0.5).linear_velocity(Vec3::X * 3.0);
    let (mut world, pushed) = on_ground(start.damping(damping), &shape, Material::new(0.0, 0.0));
    world.insert_one(pushed, ConstantWrench { force: Vec3::X * 2.0, ..ConstantWrench::default() }).unwrap();
    let mut simulation = Simulation::new(Settings::default().with_dt(1e-3)).unwrap();
    Ledger::attach(&mut world, &simulation);
    let before = kinetic(&world, pushed);
    for _ in 0..1000 {
        world.get::<&mut Wrench>(pushed).unwrap().add_force(Vec3::X * 1.0);
        simulation.step(&mut world);
    }
    let (work, way) = (work(&world, pushed), dvec3(world.get::<&Pose>(pushed).unwrap().position).x);
    assert!((work.applied / way - 1.0).abs() < 1e-3, "{work:?}, {way} m");
    assert!((work.of("ConstantWrench").unwrap() / (2.0 * way) - 1.0).abs() < 1e-3, "{work:?}, {way} m");
    // Contacts only hold up what sinks in by 0.1 mm. To their account comes the first-order
    // coupling of a force and a damping in a substep: half of h c F v a second, a millijoule.
    let change = kinetic(&world, pushed) - before;
    assert!((work.contacts + work.gravity).abs() < 2e-3 && work.gravity.abs() < 3e-3, "{work:?}");
    assert!((work.damping - (change - 3.0 * way)).abs() < 2e-2 && work.damping < -5.0, "{work:?}, {change}");
    assert!((work.total() - change).abs() < 1e-9);
}

/// Everything at once: of every body the works add up to the change of its kinetic energy.
#[test]
fn the_works_of_a_pile_add_up() {
    for substeps in [1, 3] {
        let mut world = pile::plain_scene();
        let mut simulation = Simulation::new(pile::settings().with_substeps(substeps)).unwrap();
        let bodies = BodyOrder::moving(&world).entities().to_vec();
        let before: Vec<f64> = bodies.iter().map(|body| kinetic(&world, *body)).collect();
        let mut ledger = Ledger::attach(&mut world, &simulation);
        run(&mut simulation, &mut world, 150);
        let lost_in_falling = simulation.time() * G * G * f64::from(simulation.settings().contact_substep()) / 2.0;
        let (mut passed, mut contacts, mut fallen) = (0.0, 0.0, 0.0);
        for (body, before) in bodies.iter().zip(before) {
            let (work, change) = (work(&world, *body), kinetic(&world, *body) - before);
            let size = work.gravity.abs() + work.contacts.abs() + before;
            assert!((work.total() - change).abs() < 1e-9 * size, "{work:?} for {change}");
            // Turning in free flight keeps energy but for rounding. What is near others and touches
            // nothing falls by the first-order steps of contacts, each of which loses M g^2 h^2/2.
            let mass = f64::from(world.get::<&tumble::Mass>(*body).unwrap().kilograms());
            assert!(work.integrator.abs() < mass * lost_in_falling + 1e-3 * size, "{work:?} of {mass} kg");
            passed += size;
            fallen += work.integrator.abs();
            contacts += work.contacts;
        }
        assert!(contacts < -0.1 * passed && fallen < 3e-3 * passed, "{contacts}, {fallen} of {passed}");
        let entry = ledger.record(&world, &simulation);
        assert!((entry.work.contacts - contacts).abs() < 1e-9 * passed);
    }
}

/// A ledger changes no bits.
#[test]
fn a_ledger_changes_nothing() {
    let after = |booked: bool| {
        let mut world = pile::plain_scene();
        let mut simulation = Simulation::new(pile::settings()).unwrap();
        if booked {
            Ledger::attach(&mut world, &simulation);
        }
        run(&mut simulation, &mut world, 100);
        tumble_tests::hash(&world)
    };
    assert_eq!(after(true), after(false));
}
