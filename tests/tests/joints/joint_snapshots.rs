//! Promise: a run with joints that break goes on to the bit, with the same events and loads, from
//! any step that it is rewound to or restored at from a file, in the same world or another one,
//! whatever broke in between and whichever joints came and went. Hashes see what is broken.
//!
//! Why: a joint that broke in steps that are taken back holds again, and one that had broken does
//! not. It fails if a restore leaves joints as they are, mends or breaks all, or takes one for
//! another that had its number.

use hecs::{Entity, World};
use tumble::{
    BodyId, BodyOrder, Breakable, Joint, JointEvent, JointLoad, Rollback, Settings, Simulation, Snapshot,
    SnapshotError, state_hash,
};
use tumble_tests::{Draw, hash};

use crate::mechanisms::{Class, Options, add_options, mechanism};

const STEPS: u64 = 80;

/// A mechanism of which some joints break when it falls into them.
struct Case {
    world: World,
    joints: Vec<Entity>,
    simulation: Simulation,
}

/// How joints are known, and in which order they are spawned.
#[derive(Clone, Copy, PartialEq)]
enum Identity {
    Entities,
    Ids { reversed: bool },
}

fn case(number: u64, identity: Identity) -> Case {
    let mut draw = Draw::new(0x5A, number);
    let size = draw.log_between(0.05, 2.0);
    let mass_ratio = draw.log_between(1.0, 100.0);
    let class = Class { bodies: 14, size, mass_ratio, speed: 6.0 * size, loops: 0.2, is_fixed: true, ..Class::PLAIN };
    let plan = mechanism(class, &mut draw);
    let mut world = World::new();
    let mut order: Vec<usize> = (0..plan.joints.len()).collect();
    if identity == (Identity::Ids { reversed: true }) {
        order.reverse();
    }
    let bodies: Vec<usize> = (0..plan.bodies.len()).collect();
    let (_, joints) = plan.spawn(&mut world, &bodies, &order);
    let mass = mass_ratio.sqrt();
    add_options(&mut world, &joints, Options { has_springs: true, breaks: true, size, mass }, number);
    for (index, joint) in joints.iter().enumerate() {
        if draw.often(0.5) {
            let max_force = (mass * draw.log_between(30.0, 1000.0)) as _;
            let max_torque = (mass * size * draw.log_between(30.0, 1000.0)) as _;
            world.insert_one(*joint, Breakable { max_force, max_torque, is_broken: false }).unwrap();
        }
        if identity != Identity::Entities {
            // Ids of joints may be those of bodies.
            world.insert_one(*joint, BodyId(index as u64)).unwrap();
        }
    }
    let dt = draw.log_between(1.0 / 240.0, 1.0 / 30.0) as _;
    Case { world, joints, simulation: Simulation::new(Settings::default().with_dt(dt)).unwrap() }
}

/// All that a step leaves, joints by their number.
#[derive(Clone, Debug, PartialEq)]
struct Moment {
    hash: u64,
    events: Vec<(usize, bool)>,
    loads: Vec<JointLoad>,
    broken: Vec<Option<bool>>,
}

impl Case {
    fn broken(&self) -> Vec<Option<bool>> {
        let is_broken = |joint: &Entity| self.world.get::<&Breakable>(*joint).map(|it| it.is_broken).ok();
        self.joints.iter().map(is_broken).collect()
    }

    fn step(&mut self) -> Moment {
        self.simulation.step(&mut self.world);
        let number = |joint: Entity| self.joints.iter().position(|it| *it == joint).unwrap();
        let events = self.simulation.joint_events().map(|event| match event {
            JointEvent::Broke(joint) => (number(joint), true),
            JointEvent::EndIsGone(joint) => (number(joint), false),
            _ => unreachable!(),
        });
        let events = events.collect();
        let loads = self.joints.iter().map(|joint| *self.world.get::<&JointLoad>(*joint).unwrap()).collect();
        Moment { hash: hash(&self.world), events, loads, broken: self.broken() }
    }
}

/// How many joints are broken.
fn count(broken: &[Option<bool>]) -> usize {
    broken.iter().filter(|it| **it == Some(true)).count()
}

#[test]
fn rewinds_across_breaks_are_exact() {
    let (mut mended, mut kept_broken) = (0, 0);
    for number in 0..12 {
        let (mut case, mut draw) = (case(number, Identity::Entities), Draw::new(0x5B, number));
        let mut rollback = Rollback::new(STEPS as usize);
        let (mut moments, mut rewinds) = (Vec::<Moment>::new(), 0);
        while case.simulation.steps() < STEPS {
            let step = case.simulation.steps();
            rollback.save(&case.world, &case.simulation).unwrap();
            let moment = case.step();
            match moments.get(step as usize) {
                Some(known) => assert_eq!(moment, *known, "case {number}, step {step}"),
                None => moments.push(moment),
            }
            if rewinds < 12 && draw.often(0.25) {
                rewinds += 1;
                let to = draw.between(0.0, case.simulation.steps() as f64) as u64;
                let before = case.broken();
                let spawned = rollback.rewind_to_step(to, &mut case.world, &mut case.simulation).unwrap();
                assert!(spawned.is_empty());
                let (then, at) = (case.broken(), to.checked_sub(1).map(|last| &moments[last as usize]));
                mended += usize::from(then != before);
                kept_broken += usize::from(count(&then) > 0);
                match at {
                    Some(at) => assert_eq!((&then, hash(&case.world)), (&at.broken, at.hash)),
                    None => assert_eq!(count(&then), 0),
                }
            }
        }
    }
    println!("{mended} rewinds mended joints, {kept_broken} had some that stayed broken");
    assert!(mended > 20 && kept_broken > 20);
}

#[test]
fn files_continue_in_other_worlds() {
    let mut with_broken = 0;
    for number in 0..8 {
        for (identity, other) in [
            (Identity::Entities, Identity::Entities),
            (Identity::Ids { reversed: false }, Identity::Ids { reversed: true }),
        ] {
            let mut run = case(number, identity);
            (0..STEPS / 2).for_each(|_| drop(run.step()));
            let file = run.simulation.snapshot(&run.world).unwrap().to_bytes();
            let read = Snapshot::from_bytes(&file).unwrap();
            assert_eq!(read.state_hash(), hash(&run.world));
            assert_eq!(read.to_bytes(), file);

            let mut elsewhere = case(number, other);
            elsewhere.simulation.restore(&read, &mut elsewhere.world).unwrap();
            assert_eq!(hash(&elsewhere.world), hash(&run.world));
            with_broken += usize::from(count(&run.broken()) > 0);
            for step in STEPS / 2..STEPS {
                assert_eq!(elsewhere.step(), run.step(), "case {number}, step {step}");
            }
        }
    }
    println!("{with_broken} files with broken joints");
    assert!(with_broken > 8);
}

/// Joints that are broken come and go, as in a game that despawns them on their events, and others
/// take their numbers: none of it disturbs a rewind to steps where they did nothing either.
#[test]
fn joints_that_come_and_go_disturb_no_rewind() {
    let mut taken_away = 0;
    for number in 0..8 {
        let [mut run, mut plain] = [0; 2].map(|_| case(number, Identity::Entities));
        let ends = *run.world.get::<&Joint>(run.joints[0]).unwrap();
        let torn = Breakable { is_broken: true, ..Breakable::at_force(1.0) };
        let extra = [0; 4].map(|_| run.world.spawn((ends, torn)));
        (0..STEPS / 2).for_each(|_| drop((run.step(), plain.step())));
        let saves = [&run, &plain].map(|it| it.simulation.snapshot(&it.world).unwrap());
        let broken_then = run.joints.iter().zip(run.broken()).find(|(_, broken)| *broken == Some(true));
        let broken_then = broken_then.map(|(joint, _)| *joint);
        (0..10).for_each(|_| drop((run.step(), plain.step())));

        extra.into_iter().for_each(|joint| run.world.despawn(joint).unwrap());
        let newcomer = run.world.spawn((ends, Breakable::at_force(1.0)));
        assert!(extra.iter().any(|joint| joint.id() == newcomer.id()));
        run.simulation.restore(&saves[0], &mut run.world).unwrap();
        plain.simulation.restore(&saves[1], &mut plain.world).unwrap();
        assert!(!run.world.get::<&Breakable>(newcomer).unwrap().is_broken, "taken for one that had its number");
        run.world.despawn(newcomer).unwrap();
        if let Some(joint) = broken_then {
            taken_away += 1;
            run.world.remove_one::<Joint>(joint).unwrap();
        }
        for step in STEPS / 2..STEPS {
            let [a, b] = [run.step(), plain.step()];
            assert_eq!((a.events, a.loads), (b.events, b.loads), "case {number}, step {step}");
            let [a, b] = [&run, &plain].map(|it| Snapshot::capture(&it.world).unwrap());
            assert_eq!(a.first_difference(&b), None, "case {number}, step {step}");
        }
    }
    println!("{taken_away} joints taken away");
    assert!(taken_away > 2);
}

#[test]
fn hashes_see_what_is_broken_between_their_bodies() {
    let mut case = case(0, Identity::Ids { reversed: false });
    let breakable: Vec<_> =
        case.joints.iter().copied().filter(|it| case.world.get::<&Breakable>(*it).is_ok()).collect();
    let mut hashes = vec![hash(&case.world)];
    for joint in &breakable {
        case.world.get::<&mut Breakable>(*joint).unwrap().is_broken = true;
        hashes.push(hash(&case.world));
        assert_eq!(Snapshot::capture(&case.world).unwrap().state_hash(), hash(&case.world));
        case.world.get::<&mut Breakable>(*joint).unwrap().is_broken = false;
    }
    hashes.sort_unstable();
    hashes.dedup();
    assert_eq!(hashes.len(), breakable.len() + 1);

    // A joint between other bodies does not matter to those of a list.
    let class = Class { bodies: 3, first_id: 900, ..Class::PLAIN };
    let alone = BodyOrder::of(&case.world);
    let before = state_hash(&case.world, &alone);
    let (_, others) = mechanism(class, &mut Draw::new(1, 1)).spawn(&mut case.world, &[0, 1, 2], &[0, 1]);
    let torn = Breakable { is_broken: true, ..Breakable::at_force(1.0) };
    case.world.insert_one(others[0], torn).unwrap();
    assert_eq!(state_hash(&case.world, &alone), before);
    assert_ne!(hash(&case.world), before);
}

#[test]
fn two_breakable_joints_with_one_id_are_refused() {
    let mut case = case(0, Identity::Ids { reversed: false });
    for joint in [case.joints[1], case.joints[2]] {
        case.world.insert(joint, (BodyId(77), Breakable::at_force(1.0))).unwrap();
    }
    let error = case.simulation.snapshot(&case.world).unwrap_err();
    assert_eq!(error, SnapshotError::DuplicateJoint { id: BodyId(77) });
}
