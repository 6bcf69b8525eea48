//! Promise: what a simulation tells of its contacts is what happened: who touches whom, where,
//! along which normal, with what force; and each touch begins once and ends once, in the order of
//! the bodies, whatever is spawned, despawned or rests at the edge of touching.
//!
//! Why: games make sounds, damage and logic of it. It fails if a normal has the wrong sign, a point
//! is not in the world, a resting body flickers, or a body that is gone leaves no end.

use std::collections::{BTreeMap, BTreeSet};

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::prelude::*;
use tumble::{BodyOrder, Collider, Contact, ContactEvent, Material};
use tumble_tests::touching::{collider, cube, spawn};
use tumble_tests::{by_precision, run};

use crate::pile;

const G: Real = 9.81;

fn ground(world: &mut World, id: Option<u64>) -> Entity {
    let ground = RigidBody::new(Shape::Point).fixed();
    let ground = id.map_or(ground.clone(), |id| ground.id(BodyId(id)));
    spawn(world, ground, Collider::half_space())
}

fn body(world: &mut World, body: RigidBody, shape: &Shape) -> Entity {
    spawn(world, body, collider(shape))
}

fn simulation() -> Simulation {
    Simulation::new(Settings::default()).unwrap()
}

/// A contact event without how hard it was.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reported {
    Begin([Entity; 2]),
    End([Entity; 2]),
}

impl Reported {
    fn bodies(self) -> [Entity; 2] {
        let (Self::Begin(bodies) | Self::End(bodies)) = self;
        bodies
    }
}

fn events(simulation: &Simulation) -> Vec<Reported> {
    let told = |event: ContactEvent| match event {
        ContactEvent::Begin(bodies, _) => Reported::Begin(bodies),
        ContactEvent::End(bodies) => Reported::End(bodies),
    };
    simulation.contact_events().map(told).collect()
}

/// A box on a box on ground: two contacts, each with the weight of what is on it, whichever of its
/// bodies comes first.
#[test]
fn a_stack_is_reported_as_it_stands() {
    // By identity: the ground first, last and in the middle; without one it is last.
    for ids in [[1, 2, 3], [3, 1, 2], [2, 1, 3], [2, 3, 1]] {
        let mut world = World::new();
        let ground = ground(&mut world, Some(ids[0]));
        let start = |mass: f64, y: Real, id| RigidBody::new(cube(0.5)).mass(mass).position(Vec3::Y * y).id(BodyId(id));
        let lower = body(&mut world, start(2.0, 0.5, ids[1]), &cube(0.5));
        let upper = body(&mut world, start(3.0, 1.5, ids[2]), &cube(0.5));
        let mut simulation = simulation();
        run(&mut simulation, &mut world, 200);
        let contacts: Vec<Contact> = simulation.contacts().collect();
        assert_eq!(contacts.len(), 2, "{ids:?}");
        let order = BodyOrder::of(&world);
        let place = |entity: Entity| order.entities().iter().position(|it| *it == entity).unwrap();
        let places: Vec<_> = contacts.iter().map(|contact| contact.bodies.map(place)).collect();
        assert!(places.is_sorted() && places.iter().all(|[a, b]| a < b), "{places:?}");
        for (below, above, load, height) in [(ground, lower, 5.0, 0.0), (lower, upper, 3.0, 1.0)] {
            let contact = contacts.iter().find(|it| it.bodies.contains(&below) && it.bodies.contains(&above)).unwrap();
            let up = if contact.bodies == [below, above] { 1.0 } else { -1.0 };
            assert!((contact.normal - Vec3::Y * up).length() < 1e-5, "{contact:?}");
            let force = contact.impulse() * up / simulation.settings().contact_substep();
            assert!((force - Vec3::Y * (load * G)).length() < 1e-3 * load * G, "{force}");
            assert!(contact.touches() && contact.points().len() == 4);
            for point in contact.points() {
                let Vec3 { x, y, z } = point.position;
                assert!((x.abs() - 0.5).abs() < 1e-3 && (z.abs() - 0.5).abs() < 1e-3, "{point:?}");
                assert!((y - height).abs() < 1e-2 && (-1e-3..0.0).contains(&point.separation), "{point:?}");
            }
        }
    }
}

/// Friction is what slows a sliding box: mu M g against the velocity.
#[test]
fn friction_is_reported() {
    let mut world = World::new();
    ground(&mut world, Some(9));
    let start =
        RigidBody::new(cube(0.5)).mass(2.0).position(Vec3::Y * 0.5).linear_velocity(Vec3::X * 6.0).id(BodyId(1));
    let sliding = body(&mut world, start, &cube(0.5));
    let mut simulation = simulation();
    run(&mut simulation, &mut world, 20);
    let contact = simulation.contacts().next().unwrap();
    // The box comes first, and friction is reported on the second.
    assert_eq!(contact.bodies[0], sliding);
    let friction = -contact.friction / simulation.settings().contact_substep();
    assert!((friction - Vec3::X * (-0.5 * 2.0 * G)).length() < 0.02 * G, "{friction}");
}

/// Two balls in free space: one hits the other along x.
#[test]
fn points_are_where_the_surfaces_meet() {
    let shape = Shape::sphere(0.25);
    let mut world = World::new();
    let at = |x: Real, speed: Real| {
        RigidBody::new(Shape::sphere(0.25)).mass(1.0).position(Vec3::new(x, 5.0, 7.0)).linear_velocity(Vec3::X * speed)
    };
    let [first, second] = [(0.0, 1.0), (0.505, 0.0)].map(|(x, speed)| body(&mut world, at(x, speed), &shape));
    let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    simulation.step(&mut world);
    let contact = simulation.contacts().next().unwrap();
    assert_eq!((contact.bodies, contact.points().len()), ([first, second], 1));
    assert!((contact.normal - Vec3::X).length() < 1e-5);
    let point = contact.points()[0];
    assert!((point.separation - 0.005).abs() < 1e-5);
    assert!((point.position - Vec3::new(0.2525, 5.0, 7.0)).length() < 0.003, "{point:?}");
}

/// A ball that bounces four times begins and ends to touch four times.
#[test]
fn a_bounce_begins_and_ends() {
    let surface = Material::new(0.5, 1.0);
    let mut world = World::new();
    let ground = ground(&mut world, None);
    let ball =
        body(&mut world, RigidBody::new(Shape::sphere(0.1)).mass(1.0).position(Vec3::Y * 1.1), &Shape::sphere(0.1));
    for entity in [ground, ball] {
        let mut collider = world.get::<&mut Collider>(entity).unwrap();
        *collider = collider.clone().with_material(surface).unwrap();
    }
    let mut simulation = simulation();
    let (mut told, mut bounces, mut before) = (Vec::new(), 0, -1.0);
    while simulation.steps() < 210 {
        simulation.step(&mut world);
        for e in events(&simulation) {
            println!("{} {e:?}", simulation.steps());
        }
        told.extend(events(&simulation));
        let speed = world.get::<&Velocity>(ball).unwrap().linear.y;
        bounces += u32::from(before < 0.0 && speed > 0.0);
        before = speed;
    }
    assert_eq!(bounces, 4);
    // The ground has no identity, so it comes after the ball only by its entity, which is the
    // first.
    let one = [Reported::Begin([ground, ball]), Reported::End([ground, ball])];
    assert_eq!(told, [one; 4].concat());
}

/// In a pile that settles, however lightly things lie on others, no pair ends to touch and begins
/// again at once; and what began and did not end are the touching pairs.
#[test]
fn a_pile_that_settles_does_not_flicker() {
    let mut world = pile::settling_scene(pile::SEED);
    let mut simulation = Simulation::new(pile::settings()).unwrap();
    let (mut touching, mut ended, mut late) = (BTreeSet::new(), BTreeMap::new(), 0);
    for step in 0..1500 {
        simulation.step(&mut world);
        let events = events(&simulation);
        assert!(events.is_sorted_by_key(|event| order_of(&world, event.bodies())), "{events:?}");
        for event in events {
            let changed = match event {
                Reported::Begin(bodies) => touching.insert(bodies),
                Reported::End(bodies) => touching.remove(&bodies),
            };
            assert!(changed, "{event:?} in step {step}");
            // What rocks may touch now here, now there, but takes its time.
            match event {
                Reported::Begin(bodies) => {
                    let before = ended.insert(bodies, None).flatten();
                    assert!(before.is_none_or(|end| step < 500 || step - end > 10), "{event:?} again in step {step}");
                    late += u32::from(step >= 500);
                }
                Reported::End(bodies) => {
                    ended.insert(bodies, Some(step));
                }
            }
        }
        let now = simulation.contacts().filter(Contact::touches).map(|contact| contact.bodies);
        assert_eq!(now.collect::<BTreeSet<_>>(), touching, "step {step}");
    }
    assert!(touching.len() > 80 && late < 50, "{} pairs, {late} late", touching.len());
}

/// By identity, then by entity.
fn order_of(world: &World, bodies: [Entity; 2]) -> [(bool, Option<u64>, u32); 2] {
    bodies.map(|body| {
        let id = world.get::<&BodyId>(body).ok().map(|id| id.0);
        (id.is_none(), id, body.id())
    })
}

/// The end of a touch is reported in the step after one of the bodies was despawned or lost its
/// collider, with the entity that it was.
#[test]
fn what_is_gone_has_ended() {
    for colliders_only in [false, true] {
        let mut world = World::new();
        let ground = ground(&mut world, Some(0));
        let [a, b, c] = [1, 2, 3].map(|id| {
            let at = Vec3::new(id as Real * 2.0, 0.5, 0.0);
            body(&mut world, RigidBody::new(cube(0.5)).mass(1.0).position(at).id(BodyId(id)), &cube(0.5))
        });
        let mut simulation = simulation();
        simulation.step(&mut world);
        assert_eq!(events(&simulation), [a, b, c].map(|it| Reported::Begin([ground, it])));
        simulation.step(&mut world);
        assert_eq!(events(&simulation), []);
        let leave = |world: &mut World, entity: Entity| {
            if colliders_only {
                world.remove_one::<Collider>(entity).unwrap();
            } else {
                world.despawn(entity).unwrap();
            }
        };
        leave(&mut world, b);
        // One that takes the number of its entity, far away.
        let far = RigidBody::new(cube(0.5)).mass(1.0).position(Vec3::Y * 50.0).id(BodyId(9));
        body(&mut world, far, &cube(0.5));
        simulation.step(&mut world);
        assert_eq!(events(&simulation), [Reported::End([ground, b])]);
        simulation.step(&mut world);
        assert_eq!(events(&simulation), []);
        leave(&mut world, a);
        simulation.step_many(&mut world, 2);
        assert_eq!(events(&simulation), [Reported::End([ground, a])], "of both steps");
        // With the ground everything loses its hold; the others fall.
        leave(&mut world, ground);
        simulation.step(&mut world);
        assert_eq!(events(&simulation), [Reported::End([ground, c])]);
    }
}

/// hecs gives the number of an entity that was despawned to the next one. Without a [`BodyId`] the
/// number is all that a body is called by, but it is another body.
#[test]
fn who_takes_the_place_of_another_is_not_taken_for_it() {
    let mut world = World::new();
    let ground = ground(&mut world, None);
    let box_of = |mass: f64| RigidBody::new(cube(0.5)).mass(mass).position(Vec3::Y * 0.5);
    let heavy = body(&mut world, box_of(100.0), &cube(0.5));
    let mut simulation = simulation();
    run(&mut simulation, &mut world, 60);
    world.despawn(heavy).unwrap();
    let light = body(&mut world, box_of(1.0), &cube(0.5));
    assert_eq!(light.id(), heavy.id());
    simulation.step(&mut world);
    let events = events(&simulation);
    assert_eq!(events.len(), 2, "{events:?}");
    assert!(events.contains(&Reported::End([ground, heavy])) && events.contains(&Reported::Begin([ground, light])));
    // It begins without the impulses of the other, which would throw it up.
    let up = world.get::<&Velocity>(light).unwrap().linear.y;
    assert!(up < 0.01, "{up}");
}

/// When the last collider goes, what it touched ends, and nothing is left of it.
#[test]
fn a_world_without_colliders_has_no_contacts() {
    for spring in [false, true] {
        let mut world = World::new();
        let ground = ground(&mut world, None);
        let lying = body(&mut world, RigidBody::new(cube(0.5)).mass(1.0).position(Vec3::Y * 0.5), &cube(0.5));
        if spring {
            // So that the world stays one where bodies act on each other.
            world.spawn((tumble::Spring::between(ground, lying).with_stiffness(1.0),));
        }
        let mut simulation = simulation();
        run(&mut simulation, &mut world, 5);
        assert_eq!(simulation.contacts().count(), 1);
        for entity in [ground, lying] {
            world.remove_one::<Collider>(entity).unwrap();
        }
        simulation.step(&mut world);
        assert_eq!(events(&simulation), [Reported::End([ground, lying])], "{spring}");
        assert_eq!(simulation.contacts().count(), 0);
        simulation.step(&mut world);
        assert_eq!(events(&simulation), [], "{spring}");
    }
}

/// Two pucks in free space that stop each other in the middle of a step: no impulse is left at its
/// end, and they are apart by what rounding makes of their places.
#[test]
fn a_hit_without_a_bounce_is_reported() {
    for (i, apart) in [0.001, 0.004, 0.01, 0.015].iter().cycle().take(40).enumerate() {
        let far = 50.0 + 0.37 * Real::from(i as u8);
        let surface = Material::new(0.0, 0.0);
        let shape = Shape::sphere(0.25);
        let mut world = World::new();
        let pair = [(far, 1.0), (far + 0.5 + apart, -1.0)].map(|(x, speed)| {
            let start = RigidBody::new(shape.clone()).mass(1.0);
            let collider = Collider::new(&shape).unwrap().with_material(surface).unwrap();
            // Along a diagonal, so that nothing rounds to zero.
            let along = Vec3::new(1.0, 2.0, 3.0).normalize();
            let start = start.position(along * x).linear_velocity(along * speed);
            start.build().unwrap().spawn_with(&mut world, (collider,))
        });
        let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
        let mut told = Vec::new();
        for _ in 0..10 {
            simulation.step(&mut world);
            told.extend(events(&simulation));
        }
        // What rounding makes of places fifty metres away, over a substep.
        assert!(world.get::<&Velocity>(pair[0]).unwrap().linear.length() < by_precision(1e-3, 1e-6) as Real);
        assert_eq!(told, [Reported::Begin(pair)], "{far} {apart}");
    }
}

/// A ball that bounces by less than a millimetre, again and again, touches all the time.
#[test]
fn what_trembles_touches() {
    let surface = Material::new(0.5, 0.95);
    let shape = Shape::sphere(0.1);
    let mut world = World::new();
    let ground = ground(&mut world, None);
    let start = RigidBody::new(shape.clone()).mass(1.0).position(Vec3::Y * 0.1).linear_velocity(Vec3::Y * -0.08);
    let ball = body(&mut world, start, &shape);
    for entity in [ground, ball] {
        let mut collider = world.get::<&mut Collider>(entity).unwrap();
        *collider = collider.clone().with_material(surface).unwrap();
    }
    let settings = Settings::default().with_dt(1.0 / 960.0).with_restitution_threshold(0.0);
    let mut simulation = Simulation::new(settings).unwrap();
    let (mut told, mut bounces, mut highest, mut before) = (Vec::new(), 0, 0.0, -1.0);
    for _ in 0..100 {
        simulation.step(&mut world);
        told.extend(events(&simulation));
        let (height, speed) =
            (world.get::<&Pose>(ball).unwrap().position.y - 0.1, world.get::<&Velocity>(ball).unwrap().linear.y);
        bounces += u32::from(before < 0.0 && speed > 0.0);
        (before, highest) = (speed, height.max(highest));
    }
    assert!(bounces >= 5 && (1e-4..1e-3).contains(&highest), "{bounces} bounces up to {highest} m");
    assert_eq!(told, [Reported::Begin([ground, ball])]);
}

/// With substeps of the settings an event is of the whole step.
#[test]
fn events_are_of_the_step() {
    let mut world = World::new();
    let ground = ground(&mut world, None);
    let falling = body(&mut world, RigidBody::new(cube(0.5)).mass(1.0).position(Vec3::Y * 0.6), &cube(0.5));
    let mut simulation = Simulation::new(Settings::default().with_dt(0.2).with_substeps(5)).unwrap();
    let mut told = Vec::new();
    for _ in 0..5 {
        simulation.step(&mut world);
        told.push(events(&simulation));
    }
    assert_eq!(told.concat(), [Reported::Begin([ground, falling])]);
    // It fell ten centimetres, in 0.14 s.
    assert_eq!(told[0].len(), 1);
}

#[test]
fn nothing_is_reported_before_a_step() {
    let mut world = World::new();
    ground(&mut world, None);
    body(&mut world, RigidBody::new(cube(0.5)).mass(1.0).position(Vec3::Y * 0.5), &cube(0.5));
    let simulation = simulation();
    assert_eq!((simulation.contacts().count(), events(&simulation).len()), (0, 0));
}
