//! Promise: joints in passes keep momentum, make no energy and give way by their load over a
//! stiffness that the documentation says; with more substeps they come to what direct solution
//! does. Nets are in passes unless the settings say otherwise, and chains and trees never are.
//!
//! Why: a net that is solved directly takes 300 times as long. It fails if an impulse acts on one
//! body only or at two points, if errors are taken out with energy, if a load makes light links
//! explode, or if an exact joint is soft where it need not be.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::Real;
use tumble::{
    Axes, BodyId, Joint, JointSolver, Limit, Limits, LockedAxes, Mass, Material, Momentum, RigidBody, Settings, Shape,
    Simulation, Sleep, Snapshot, SnapshotError, Work,
};
use tumble_benches::{JointKind, chain, net};
use tumble_tests::touching::{collider, ground};
use tumble_tests::{Draw, EPSILON, by_precision, cases, dvec3, forged, hash, quat, run};

use crate::jointed::*;
use crate::mechanisms::{Class, mechanism};

impl Rig {
    fn solved(mut self, joints: JointSolver) -> Self {
        self.simulation = Simulation::new(self.simulation.settings().with_joint_solver(joints)).unwrap();
        self
    }
}

/// Steps of 1/10 to 1/240 s, with 1 to 16 substeps.
fn any_steps(draw: &mut Draw) -> (f64, u32) {
    (1.0 / draw.log_between(10.0, 240.0), 1 + draw.between(0.0, 16.0) as u32)
}

/// What hangs on one joint, of any kind, gives way by its load over the stiffness: `m w^2` of the
/// mass, with a quarter of a period a substep on the ground.
#[test]
fn what_hangs_gives_way_by_its_load_over_the_stiffness() {
    for case in 0..u64::from(cases(60)) {
        let mut draw = Draw::new(0x71, case);
        let (dt, substeps) = any_steps(&mut draw);
        let h = dt / f64::from(substeps);
        let (size, mass) = (draw.log_between(0.01, 100.0), draw.log_between(1e-3, 1e6));
        let mut rig = Rig::new(down(), dt, substeps).solved(JointSolver::Passes);
        let beam = rig.ground();
        let made = [Joint::ball, Joint::hinge, Joint::fixed][(case % 3) as usize];
        let shape = Shape::cuboid([0.4 * size, 0.5 * size, 0.3 * size]);
        let at = DVec3::NEG_Y * size;
        let body = rig.spawn(RigidBody::new(shape).without_collider().mass(mass).position(real(at)));
        let [first, second] = if draw.often(0.5) { [beam, body] } else { [body, beam] };
        let joint = rig.join_at(made(first, second), ORIGIN, DVec3::Z);
        rig.run_to(400.0 * dt);
        let expected = G * (2.0 * h / std::f64::consts::PI).powi(2);
        let sag = at.y - rig.position(body).y;
        let rounding = 10.0 * EPSILON * size;
        assert!((sag - expected).abs() < 0.02 * expected + rounding, "case {case}: {sag:e} m of {expected:e} m");
        let load = dvec3(rig.load(joint).force) * if first == beam { 1.0 } else { -1.0 };
        assert!((load - DVec3::Y * mass * G).length() < 2e-3 * mass * G, "case {case}: {load} N");
        let speed = rig.velocity(body).length();
        assert!(speed < 1e-3 * G * dt + rounding / h, "case {case}: {speed} m/s");
    }
}

/// A rod on a hinge swings about the axis that is free, whichever of its frame that is, and about
/// no other.
#[test]
fn hinges_are_free_about_any_axis_of_their_frames() {
    let [first, second, third] = [Axes::ANGULAR_X, Axes::ANGULAR_Y, Axes::ANGULAR_Z].map(|free| {
        let mut rig = Rig::new(down(), 1.0 / 120.0, 8).solved(JointSolver::Passes);
        let beam = rig.ground();
        let rod = rig.spawn(rod(1.0, 1.0, DVec3::X * 0.5).angular_velocity(real(DVec3::new(0.3, 2.0, 0.0))));
        let turn = match free {
            Axes::ANGULAR_X => DQuat::from_rotation_arc(DVec3::X, DVec3::Z),
            Axes::ANGULAR_Y => DQuat::from_rotation_arc(DVec3::Y, DVec3::Z),
            _ => DQuat::IDENTITY,
        };
        let mut joint = Joint::fixed(beam, rod);
        joint.free = free;
        joint.frames = [frame(ORIGIN, turn), frame(DVec3::NEG_X * 0.5, turn)];
        rig.join(joint);
        rig.run_to(1.0);
        (rig.position(rod), rig.angular_velocity(rod))
    });
    assert!((first.0 - DVec3::X * 0.5).length() > 0.1 && first.0.z.abs() < 1e-3, "{first:?}");
    assert!(first.1.z.abs() > 0.1 && first.1.truncate().length() < 0.05, "{first:?}");
    for other in [second, third] {
        assert!((other.0 - first.0).length() < 1e-3 && (other.1 - first.1).length() < 1e-2, "{other:?} {first:?}");
    }
}

/// A tree with loops, of balls, hinges and welds only. Returns its bodies.
fn pins(class: Class, draw: &mut Draw, rig: &mut Rig) -> (Vec<Entity>, Vec<Entity>) {
    let mut plan = mechanism(class, draw);
    plan.joints.iter_mut().for_each(|joint| joint.kind = [0, 1, 6][joint.kind % 3]);
    let all = |count: usize| (0..count).collect::<Vec<_>>();
    plan.spawn(&mut rig.world, &all(plan.bodies.len()), &all(plan.joints.len()))
}

/// A class of mechanisms for steps of `h` \[s\], slow enough to be seen turning.
fn any_class(draw: &mut Draw, h: f64) -> Class {
    let size = draw.log_between(0.01, 100.0);
    Class {
        bodies: 2 + draw.between(0.0, 30.0) as u64,
        mass_ratio: draw.log_between(1.0, 1e4),
        aspect: draw.log_between(1.0, 10.0),
        loops: draw.between(0.0, 0.5),
        size,
        speed: 0.1 * size / h * draw.log_between(0.01, 1.0),
        ..Class::PLAIN
    }
}

/// Random mechanisms that fly free, some of which lose a joint now and then.
#[test]
fn free_mechanisms_keep_their_momenta_and_gain_nothing() {
    for case in 0..u64::from(cases(300)) {
        let mut draw = Draw::new(0x72, case);
        let (dt, substeps) = any_steps(&mut draw);
        let class = any_class(&mut draw, dt / f64::from(substeps));
        let mut rig = Rig::new(DVec3::ZERO, dt, substeps).solved(JointSolver::Passes);
        let (_, mut joints) = pins(class, &mut draw, &mut rig);
        let is_losing = draw.often(0.3);
        let before = rig.totals();
        let mass: f64 = rig.world.query::<&Mass>().iter().map(|mass| f64::from(mass.kilograms())).sum();
        let (mut peak, mut moved, mut turned) = (0.0_f64, 0.0_f64, 0.0_f64);
        for step in 0..200 {
            if is_losing && step % 20 == 19 && !joints.is_empty() {
                let lost = joints.swap_remove((draw.between(0.0, 0.999) * joints.len() as f64) as usize);
                rig.world.despawn(lost).unwrap();
            }
            rig.step();
            let now = rig.totals();
            peak = peak.max(now.energy() / before.energy());
            moved = moved.max((now.linear_momentum - before.linear_momentum).length());
            turned = turned.max((now.angular_momentum - before.angular_momentum).length());
        }
        let scale = mass * class.speed;
        assert!(moved < 200.0 * EPSILON * scale, "case {case}: {moved:e} of {scale:e} kg m/s");
        // Moments that a load has raised round what is put back after the step.
        let most = by_precision(2e-3, 1e-10) * scale * class.size;
        assert!(turned < most, "case {case}: {turned:e} of {most:e} kg m^2/s");
        assert!(peak < 1.0 + 1e-3, "case {case}: {peak} times the energy");
    }
}

/// The state after a second.
fn end(mut world: World, joints: JointSolver) -> u64 {
    run(&mut Simulation::new(Settings::default().with_joint_solver(joints)).unwrap(), &mut world, 60);
    hash(&world)
}

/// By default nets are in passes, and what has a sparse matrix is exact.
#[test]
fn nets_are_in_passes_and_all_else_is_direct() {
    let of_net = end(net(40), JointSolver::Auto);
    assert_eq!(of_net, end(net(40), JointSolver::Passes));
    for made in [|| chain(1_000, JointKind::Ball), || chain(300, JointKind::Hinge), || net(8)] {
        let direct = end(made(), JointSolver::Direct);
        assert_eq!(end(made(), JointSolver::Auto), direct);
        assert_ne!(end(made(), JointSolver::Passes), direct);
    }
}

/// A limit anywhere makes a mechanism direct, whatever the settings say.
#[test]
fn mechanisms_with_limits_are_direct() {
    let made = || {
        let mut world = chain(20, JointKind::Hinge);
        let joint = world.query::<(Entity, &Joint)>().iter().map(|(entity, _)| entity).max().unwrap();
        world.insert_one(joint, Limits::along(Axes::ANGULAR_X, Limit::new(-0.1, 0.1))).unwrap();
        world
    };
    assert_eq!(end(made(), JointSolver::Passes), end(made(), JointSolver::Direct));
}

/// How far the balls of a small net are from where they are without errors, after half a second, of
/// how far they went.
fn distance_from_direct(substeps: u32) -> f64 {
    let [passes, direct, start] =
        [(JointSolver::Passes, 30), (JointSolver::Direct, 30), (JointSolver::Direct, 0)].map(|(joints, steps)| {
            let mut rig = Rig::new(down(), 1.0 / 60.0, substeps).solved(joints);
            rig.world = net(6);
            (0..steps).for_each(|_| rig.step());
            let mut balls: Vec<(BodyId, DVec3)> =
                rig.world.query::<(Entity, &BodyId)>().iter().map(|(ball, id)| (*id, rig.position(ball))).collect();
            balls.sort_by_key(|ball| ball.0);
            balls
        });
    let far = |balls: &[(BodyId, DVec3)]| {
        balls.iter().zip(&direct).map(|(ball, exact)| (ball.1 - exact.1).length()).fold(0.0, f64::max)
    };
    far(&passes) / far(&start)
}

#[test]
fn with_more_substeps_passes_come_to_the_direct_solution() {
    let errors = [4, 16, 64].map(distance_from_direct);
    assert!(errors[0] < 0.1 && errors[1] < 0.5 * errors[0] && errors[2] < 0.5 * errors[1], "{errors:?}");
    assert!(errors[2] < 0.01, "{errors:?}");
}

/// A chain of which the end is a thousand times as heavy as a link, swung: its tension turns links
/// faster than substeps resolve.
#[test]
fn a_swung_chain_with_a_heavy_end_holds() {
    for substeps in [4, 16] {
        let mut rig = Rig::new(down(), 1.0 / 60.0, substeps).solved(JointSolver::Passes);
        let mut above = rig.ground();
        for link in 0..20 {
            let mass = if link == 19 { 1000.0 } else { 1.0 };
            let at = DVec3::NEG_Y * (0.05 + 0.1 * f64::from(link));
            let push = DVec3::X * 0.25 * f64::from(link);
            let shape = Shape::cuboid([0.01, 0.05, 0.01]);
            let body = RigidBody::new(shape).without_collider().mass(mass).position(real(at));
            let body = rig.spawn(body.linear_velocity(real(push)));
            rig.join_at(Joint::ball(above, body), at + DVec3::Y * 0.05, DVec3::X);
            above = body;
        }
        // Joints give way by the load over their stiffness, the first by an eighth: twice as far
        // where the weight is let go, and somewhat more where it swings.
        let h = 1.0 / (60.0 * f64::from(substeps));
        let unit = 1000.0 * G * (4.0 * h / std::f64::consts::PI).powi(2);
        let stretched = unit * (0.25 + 18.0 * 2.0 + 1.001);
        let before = rig.energy();
        for _ in 0..3000 {
            rig.step();
            assert!(rig.energy() < before + 0.01 * before.abs(), "{substeps}: {} of {before} J", rig.energy());
            let length = rig.position(above).length();
            assert!(length < 2.0 + 2.5 * stretched, "{substeps}: {length} m, {stretched} at rest");
        }
    }
}

/// A net of balls with colliders falls on the ground and comes to rest there.
#[test]
fn a_net_lies_on_the_ground() {
    for case in 0..u64::from(cases(12)) {
        let mut draw = Draw::new(0x73, case);
        let size = draw.log_between(0.05, 10.0);
        let dt = 1.0 / draw.log_between(30.0, 240.0);
        let substeps = 4.max((dt * (G / size).sqrt() * 4.0).ceil() as u32);
        let mut rig = Rig::new(down(), dt, substeps).solved(JointSolver::Passes);
        ground(&mut rig.world, Material::default(), quat(DQuat::IDENTITY));
        let (side, radius) = (8, 0.3 * size);
        let mut balls = Vec::new();
        for number in 0..side * side {
            let (row, column) = (number / side, number % side);
            let at = DVec3::new(column as f64, 2.0 + 0.5 * row as f64, row as f64 * 0.8) * size;
            let shape = Shape::sphere(radius);
            let ball = RigidBody::new(shape.clone()).mass(draw.log_between(0.5, 2.0)).position(real(at));
            let ball = ball.build().unwrap().spawn_with(&mut rig.world, (collider(&shape),));
            for other in [(column > 0).then(|| number - 1), (row > 0).then(|| number - side)].into_iter().flatten() {
                let middle = (rig.position(balls[other]) + at) * 0.5;
                rig.join_at(Joint::ball(balls[other], ball), middle, DVec3::X);
            }
            balls.push(ball);
        }
        let before = rig.energy();
        let time = 20.0 * (size / G).sqrt() * 4.0;
        while rig.simulation.time() < time {
            rig.step();
            assert!(rig.energy() < before * (1.0 + 1e-3), "case {case}: {} of {before} J", rig.energy());
            let deepest = balls.iter().map(|ball| radius - rig.position(*ball).y).fold(0.0, f64::max);
            assert!(deepest < 0.3 * radius, "case {case}: {deepest} m of {radius} m");
        }
        let fastest = balls.iter().map(|ball| rig.velocity(*ball).length()).fold(0.0, f64::max);
        assert!(fastest < 0.05 * (G * size).sqrt(), "case {case}: {fastest} m/s");
        // The load of three of the heaviest on the lightest.
        let h = dt / f64::from(substeps);
        let most = 0.01 * size + 3.0 * 8.0 * G * (4.0 * h / std::f64::consts::PI).powi(2);
        assert!(rig.largest_gap() < most, "case {case}: {} of {most} m", rig.largest_gap());
    }
}

/// What joints and gravity did adds up to the change of the energy of motion, with loads that raise
/// inertia.
#[test]
fn works_add_up() {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4).solved(JointSolver::Passes);
    rig.world = net(6);
    let balls: Vec<Entity> = rig.world.query::<(Entity, &Momentum)>().iter().map(|(ball, _)| ball).collect();
    balls.iter().for_each(|ball| rig.world.insert_one(*ball, Work::default()).unwrap());
    let (mut joints, mut most) = (0.0_f64, 0.0_f64);
    for _ in 0..120 {
        rig.step();
        let works: Vec<Work> = balls.iter().map(|ball| *rig.world.get::<&Work>(*ball).unwrap()).collect();
        let done: f64 = works.iter().map(Work::total).sum();
        let energy = rig.totals().kinetic();
        most = most.max(energy);
        assert!((done - energy).abs() < by_precision(1e-3, 1e-8) * most, "{done} of {energy} J");
        assert_eq!(works.iter().map(|work| work.contacts).sum::<f64>(), 0.0);
        joints = works.iter().map(|work| work.joints).sum();
    }
    assert!(joints < -1e-2 * most, "joints did {joints} J of {most} J");
}

/// Balls one below the other.
fn hanging(count: u64, settings: Settings) -> (Rig, Vec<Entity>) {
    let mut rig = Rig { world: World::new(), simulation: Simulation::new(settings).unwrap() };
    let mut above = rig.spawn(RigidBody::new(Shape::Point).fixed().id(BodyId(1)));
    let balls = (0..count).map(|number| {
        let at = DVec3::NEG_Y * (0.5 + number as f64);
        let ball = RigidBody::new(Shape::sphere(0.1)).without_collider().mass(1.0).position(real(at));
        let ball = rig.spawn(ball.id(BodyId(2 + number)));
        rig.join_at(Joint::ball(above, ball), at + DVec3::Y * 0.5, DVec3::X);
        above = ball;
        ball
    });
    let balls = balls.collect();
    (rig, balls)
}

/// A mechanism in passes, at a time in gravity or on a body that does not move; its bodies.
fn in_passes(case: u64) -> (Rig, Vec<Entity>, Draw) {
    let mut draw = Draw::new(0x74, case);
    let (dt, substeps) = any_steps(&mut draw);
    let class = Class { is_fixed: draw.often(0.5), ..any_class(&mut draw, dt / f64::from(substeps)) };
    let gravity = if draw.often(0.5) { down() } else { DVec3::ZERO };
    let mut rig = Rig::new(gravity, dt, substeps).solved(JointSolver::Passes);
    let (bodies, _) = pins(class, &mut draw, &mut rig);
    (rig, bodies, draw)
}

/// Axes that are locked make a mechanism direct, and those that no longer are put it in passes
/// again. From the steps around that a snapshot goes on to the bit in another world.
#[test]
fn snapshots_go_on_where_locks_come_and_go() {
    for case in 0..u64::from(cases(24)) {
        let (mut rig, bodies, mut draw) = in_passes(case);
        let (first, last) = (draw.between(1.0, 20.0) as u32, draw.between(20.0, 40.0) as u32);
        let locks =
            bodies.iter().map(|_| draw.often(0.3).then(|| LockedAxes(locked_axes(&mut draw)))).collect::<Vec<_>>();
        let change = |world: &mut World, step: u32| {
            for (body, lock) in bodies.iter().zip(&locks) {
                match lock {
                    Some(lock) if step == first => world.insert_one(*body, *lock).unwrap(),
                    Some(_) if step == last => drop(world.remove_one::<LockedAxes>(*body)),
                    _ => {}
                }
            }
        };
        let mut others: Vec<(u32, Rig)> = Vec::new();
        for step in 0..60 {
            change(&mut rig.world, step);
            if step.abs_diff(first) < 3 || step.abs_diff(last) < 3 {
                let mut other = in_passes(case).0;
                (0..=step).for_each(|step| change(&mut other.world, step));
                let snapshot = rig.simulation.snapshot(&rig.world).unwrap();
                other.simulation.restore(&snapshot, &mut other.world).unwrap();
                others.push((step, other));
            }
            rig.step();
            for (since, other) in &mut others {
                if *since < step {
                    change(&mut other.world, step);
                }
                other.step();
                assert_eq!(hash(&other.world), hash(&rig.world), "case {case}, from step {since}, step {step}");
            }
        }
    }
}

/// Some of the axes along and about which a body moves.
fn locked_axes(draw: &mut Draw) -> Axes {
    Axes::EACH.into_iter().filter(|_| draw.often(0.4)).fold(Axes::NONE, |all, axis| all | axis)
}

/// What sleeps keeps its impulses: without them it would fall by half a free fall of a substep.
#[test]
fn what_wakes_hangs_as_before() {
    let settings = Settings::default().with_joint_solver(JointSolver::Passes).with_sleep(Sleep::default());
    let (mut rig, balls) = hanging(5, settings);
    rig.run_to(10.0);
    let (last, h) = (balls[4], f64::from(settings.contact_substep()));
    assert!(rig.simulation.is_asleep(last));
    let before: Vec<DVec3> = balls.iter().map(|ball| rig.position(*ball)).collect();
    let push = 1e-2 * G * h;
    rig.world.get::<&mut Momentum>(last).unwrap().apply_impulse(real(DVec3::X * push));
    rig.step();
    assert!(!rig.simulation.is_asleep(last));
    for (ball, before) in balls.iter().zip(before) {
        let moved = (rig.position(*ball) - before).length();
        assert!(moved < 0.1 * G * h * h, "{moved:e} m");
    }
}

#[test]
fn impossible_impulses_are_refused() {
    let (mut rig, _) = hanging(3, Settings::default().with_joint_solver(JointSolver::Passes));
    rig.run_to(0.5);
    let bytes = rig.simulation.snapshot(&rig.world).unwrap().to_bytes();
    assert!(Snapshot::from_bytes(&bytes).is_ok());
    let number = size_of::<Real>();
    let of_joint = 8 + 6 * number;
    let first = bytes.len() - 8 - 3 * of_joint;
    let refused = |place: usize, other: &[u8], joint: usize| {
        let error = Snapshot::from_bytes(&forged(&bytes, place, other)).unwrap_err();
        assert_eq!(error, SnapshotError::JointImpulse { joint });
    };
    for joint in 0..3 {
        let place = first + joint * of_joint;
        for row in 0..6 {
            refused(place + 8 + row * number, &Real::NAN.to_le_bytes(), joint);
        }
        // No such body, and twice the same.
        refused(place + 4, &4_u32.to_le_bytes(), joint);
        refused(place + 4, &bytes[place..place + 4], joint);
    }
    // After one of later bodies.
    refused(first, &3_u32.to_le_bytes(), 1);
}
