//! Promise: the locked axes of bodies with joints hold as those of others do, and the joints are
//! met and keep what they keep without: momentum along free axes, and energy.
//!
//! Why: a ragdoll of a 2.5-D game has both. It fails if a lock of a jointed body is dropped, is
//! soft under the load of its joints or against contacts, drifts, or takes from free axes.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::mechanisms;

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use mechanisms::{Class, Mechanism, mechanism, vector};
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{Axes, BodyOrder, Joint, LockedAxes, Totals};
use tumble_benches::pool;
use tumble_tests::touching::{collider, pose, surfaced, velocity};
use tumble_tests::{Draw, by_precision, cases, dquat, dvec3, hash, run};

fn real_quat(q: DQuat) -> Quat {
    Quat::from_xyzw(q.x as Real, q.y as Real, q.z as Real, q.w as Real).normalize()
}

fn simulation(gravity: DVec3, substeps: u32) -> Simulation {
    let settings = Settings::default().with_gravity(vector(gravity)).with_contact_substeps(substeps);
    Simulation::new(settings).unwrap()
}

fn energy(world: &World, simulation: &Simulation) -> f64 {
    Totals::of(world, simulation.settings(), &BodyOrder::of(world)).energy()
}

/// How far the anchors of each joint are apart \[m\].
fn largest_gap(world: &World) -> f64 {
    let gap = |joint: &Joint| {
        let [a, b] = [0, 1].map(|end| {
            let pose = pose(world, joint.bodies[end]);
            dvec3(pose.position) + dquat(pose.orientation) * dvec3(joint.frames[end].position)
        });
        (a - b).length()
    };
    world.query::<&Joint>().iter().map(gap).fold(0.0, f64::max)
}

/// A chain of eight boxes of a size \[m\], with the ends of its joints in the plane of x and y.
struct Chain {
    size: f64,
    mass_ratio: f64,
    is_fixed: bool,
    /// Ball joints between locked bodies, or hinges.
    is_locked: bool,
}

impl Chain {
    fn spawn(&self, draw: &mut Draw) -> (World, Vec<Entity>) {
        let size = self.size;
        let (mut world, mut bodies) = (World::new(), Vec::new());
        let mut at = DVec3::new(draw.between(-5.0, 5.0), draw.between(-5.0, 5.0), 0.0) * size;
        let mut angle = 0.0;
        for link in 0..8 {
            let half = [(); 3].map(|()| size * draw.log_between(0.1, 1.0));
            let turn =
                DQuat::from_rotation_z(draw.between(-3.0, 3.0)) * DQuat::from_rotation_x(draw.between(-3.0, 3.0));
            let mass = draw.log_between(1.0, self.mass_ratio);
            let [x, y, spin] = [(); 3].map(|()| draw.between(-1.0, 1.0) * (9.81 * size).sqrt());
            let body = RigidBody::new(Shape::cuboid(half))
                .without_collider()
                .mass(mass)
                .position(vector(at))
                .orientation(real_quat(turn));
            let moves = [DVec3::new(x, y, 0.0), DVec3::Z * spin / size].map(vector);
            let body = match link {
                0 if self.is_fixed => body.fixed(),
                _ => body.linear_velocity(moves[0]).angular_velocity(moves[1]),
            };
            let body = body.build().unwrap().spawn(&mut world);
            if self.is_locked {
                world.insert_one(body, LockedAxes::PLANE_XY).unwrap();
            }
            if let Some(before) = bodies.last() {
                let joint = if self.is_locked { Joint::ball(*before, body) } else { Joint::hinge(*before, body) };
                let between = at - DVec3::new(f64::cos(angle), f64::sin(angle), 0.0) * (0.5 * size);
                world.spawn((joint.at(&world, vector(between), Vec3::Z).unwrap(),));
            }
            bodies.push(body);
            angle = draw.between(-1.5, 1.5);
            at += DVec3::new(angle.cos(), angle.sin(), 0.0) * size;
        }
        (world, bodies)
    }
}

/// How many steps until the motion of a chain depends on its rounding.
fn until_rounding_grows(size: f64) -> u32 {
    (20.0 * size.sqrt()).ceil() as u32
}

/// The plane is that of hinges: both are the same motion, as long as rounding has not grown, but
/// where one is solved in shorter substeps or with more inertia of light links than the other.
#[test]
fn a_chain_in_its_plane_is_a_chain_of_hinges() {
    let mut all = Vec::new();
    for case in 0..40 {
        let of = |is_locked: bool| {
            let mut draw = Draw::new(2370, case);
            let (size, mass_ratio) = (draw.log_between(0.02, 5.0), draw.log_between(1.0, 100.0));
            let (mut world, bodies) = Chain { size, mass_ratio, is_fixed: true, is_locked }.spawn(&mut draw);
            let mut simulation = simulation(DVec3::NEG_Y * 9.81, 8);
            run(&mut simulation, &mut world, until_rounding_grows(size));
            let places: Vec<_> = bodies.iter().map(|body| pose(&world, *body)).collect();
            (places, size, largest_gap(&world))
        };
        let [(locked, size, gap), (hinged, ..)] = [true, false].map(of);
        for (a, b) in locked.iter().zip(&hinged) {
            let apart = (dvec3(a.position) - dvec3(b.position)).length() / size;
            let turned = 2.0 * (dquat(a.orientation) * dquat(b.orientation).conjugate()).xyz().length();
            assert!(apart + turned < 1e-2, "case {case}: {apart} of {size} m, {turned} rad");
            all.push(apart + turned);
            assert_eq!(a.position.z, 0.0, "case {case}");
        }
        assert!(gap < 3e-6 * size, "case {case}: {gap} m of {size}");
    }
    all.sort_unstable_by(f64::total_cmp);
    let median = all[all.len() / 2];
    assert!(median < by_precision(1e-4, 1e-9), "{median} in the median");
}

/// What is left of the energy after the first of some steps of a chain of hinges that flies.
fn hinged_energy(draw: &mut Draw, steps: u32) -> f64 {
    let (size, mass_ratio) = (draw.log_between(0.02, 5.0), draw.log_between(1.0, 100.0));
    let (mut world, _) = Chain { size, mass_ratio, is_fixed: false, is_locked: false }.spawn(draw);
    let mut simulation = simulation(DVec3::ZERO, 8);
    run(&mut simulation, &mut world, 1);
    let begun = energy(&world, &simulation);
    run(&mut simulation, &mut world, steps);
    energy(&world, &simulation) / begun
}

/// A chain that flies and is pushed out of its plane: the locks take that push alone.
#[test]
fn what_flies_in_its_plane_keeps_its_momentum() {
    for case in 0..40 {
        let mut draw = Draw::new(2371, case);
        let (size, mass_ratio) = (draw.log_between(0.02, 5.0), draw.log_between(1.0, 100.0));
        let (mut world, bodies) = Chain { size, mass_ratio, is_fixed: false, is_locked: true }.spawn(&mut draw);
        let mut simulation = simulation(DVec3::Z * 3.0, 8);
        for body in &bodies {
            world.get::<&mut Momentum>(*body).unwrap().linear.z += 1.0;
            world.get::<&mut Momentum>(*body).unwrap().angular.x += size as Real;
        }
        let sums = |world: &World| {
            let momentum = |(pose, momentum): (&Pose, &Momentum)| {
                let (p, l) = (dvec3(momentum.linear), dvec3(momentum.angular));
                p.with_z((dvec3(pose.position).cross(p) + l).z)
            };
            world.query::<(&Pose, &Momentum)>().iter().map(momentum).sum::<DVec3>()
        };
        let (begun, scale) = (sums(&world), mechanisms::scale(&world));
        run(&mut simulation, &mut world, 1);
        let started: Vec<_> = bodies.iter().map(|body| pose(&world, *body)).collect();
        let energy_begun = energy(&world, &simulation);
        let steps = until_rounding_grows(size);
        run(&mut simulation, &mut world, steps);
        // Light links under load are given more inertia, and lose energy by it: as much as without
        // locks.
        let left = energy(&world, &simulation) / energy_begun;
        let hinged = hinged_energy(&mut Draw::new(2371, case), steps);
        assert!((left - hinged).abs() < by_precision(1e-3, 1e-4), "case {case}: {left} and {hinged} of the energy");
        run(&mut simulation, &mut world, 240);
        let kept = (sums(&world) - begun).length();
        assert!(kept < by_precision(1e-5, 1e-12) * scale, "case {case}: {kept} of {scale}");
        for (body, start) in bodies.iter().zip(&started) {
            let (now, moves) = (pose(&world, *body), velocity(&world, *body));
            assert_eq!([now.position.z, moves.linear.z], [0.0; 2], "case {case}");
            let off = (dquat(now.orientation) * dquat(start.orientation).conjugate()).xyz().truncate().length();
            assert!(off < by_precision(1e-6, 1e-13), "case {case}: {off} rad out of the plane");
        }
        let gap = largest_gap(&world);
        assert!(gap < 3e-6 * size, "case {case}: {gap} m of {size}");
    }
}

/// Mechanisms of all joints, with loops, between bodies that are locked along and about any axes:
/// nothing along those, and no energy comes of it.
#[test]
fn locks_and_joints_of_all_kinds_make_no_energy() {
    for case in 0..u64::from(cases(60)) {
        let mut draw = Draw::new(2372, case);
        let class = Class { loops: 0.2, size: draw.log_between(0.02, 5.0), mass_ratio: 100.0, ..Class::PLAIN };
        let made: Mechanism = mechanism(Class { speed: (9.81 * class.size).sqrt(), ..class }, &mut draw);
        let mut world = World::new();
        let all = |count: usize| (0..count).collect::<Vec<_>>();
        let (bodies, _) = made.spawn(&mut world, &all(made.bodies.len()), &all(made.joints.len()));
        for body in &bodies {
            let axes = Axes::EACH.into_iter().filter(|_| draw.often(0.2)).fold(Axes::NONE, Axes::with);
            world.insert_one(*body, LockedAxes(axes)).unwrap();
        }
        let mut simulation = simulation(DVec3::ZERO, 8);
        run(&mut simulation, &mut world, 2);
        let started: Vec<_> = bodies.iter().map(|body| pose(&world, *body)).collect();
        let begun = energy(&world, &simulation);
        for step in 0..240 {
            run(&mut simulation, &mut world, 1);
            let now = mechanisms::totals(&world, &simulation).energy();
            assert!(now <= 1.02 * begun, "case {case}: {begun} J, {now} J in step {step}");
        }
        for (body, start) in bodies.iter().zip(&started) {
            let LockedAxes(axes) = *world.get::<&LockedAxes>(*body).unwrap();
            let (now, moves) = (pose(&world, *body), velocity(&world, *body));
            for (i, axis) in Axes::EACH.into_iter().enumerate().filter(|(_, axis)| axes.contains(*axis)) {
                if i < 3 {
                    assert_eq!(now.position[i], start.position[i], "case {case}: {axis:?}");
                    assert_eq!(moves.linear[i], 0.0, "case {case}: {axis:?}");
                } else {
                    let held = f64::from(moves.angular[i - 3]).abs();
                    let limit = by_precision(1e-4, 1e-10) * dvec3(moves.angular).length();
                    assert!(held <= limit, "case {case}: {axis:?}: {held} rad/s");
                }
            }
        }
    }
}

/// What is locked along and about all axes is a wall, also where a joint hangs on it.
#[test]
fn a_locked_axis_is_a_wall() {
    for case in 0..60 {
        let mut draw = Draw::new(2373, case);
        let (heavy, speed) = (draw.log_between(1e-3, 1e6), draw.log_between(0.1, 20.0));
        let material = Material::new(draw.between(0.0, 1.0) as Real, draw.between(0.0, 1.0) as Real);
        let (aside, spin) = (draw.between(-0.4, 0.4), draw.direction() * draw.between(0.0, 2.0) * speed);
        let after = |is_locked: bool| {
            let mut world = World::new();
            let cube = Shape::cuboid([0.5; 3]);
            let surface = surfaced(collider(&cube), material);
            let body = RigidBody::new(cube).without_collider().mass(1.0);
            let body = if is_locked { body } else { body.fixed() };
            let wall = body.build().unwrap().spawn_with(&mut world, (surface,));
            let hung = RigidBody::new(Shape::cuboid([0.2; 3])).without_collider().mass(2.0).position(Vec3::Y * -2.0);
            let hung = hung.build().unwrap().spawn(&mut world);
            world.spawn((Joint::ball(wall, hung).at(&world, Vec3::Y * -1.0, Vec3::X).unwrap(),));
            if is_locked {
                world.insert_one(wall, LockedAxes(Axes::LINEAR | Axes::ANGULAR)).unwrap();
            }
            let shape = Shape::sphere(0.3);
            let ram = RigidBody::new(shape.clone()).without_collider().mass(heavy).position(Vec3::new(
                aside as Real,
                0.0,
                -1.2,
            ));
            let ram = ram.linear_velocity(Vec3::Z * speed as Real).angular_velocity(vector(spin));
            let ram = ram.build().unwrap().spawn_with(&mut world, (surfaced(collider(&shape), material),));
            let mut simulation = simulation(DVec3::ZERO, 4);
            run(&mut simulation, &mut world, (0.6 / speed * 60.0) as u32 + 3);
            (velocity(&world, ram), pose(&world, wall))
        };
        let [(by_lock, held), (by_wall, _)] = [true, false].map(after);
        assert_eq!(held, Pose::default(), "case {case}");
        let of_linear = dvec3(by_lock.linear - by_wall.linear).length();
        let of_angular = 0.3 * dvec3(by_lock.angular - by_wall.angular).length();
        assert!(of_linear + of_angular < 0.01 * speed, "case {case}: {heavy} kg: {by_lock:?} {by_wall:?}");
    }
}

/// Chains that fall onto the ground in a plane.
fn fallen(case: u64) -> (World, Vec<Entity>, f64) {
    let mut draw = Draw::new(2374, case);
    let size = draw.log_between(0.05, 2.0);
    let (mut world, bodies) = Chain { size, mass_ratio: 10.0, is_fixed: false, is_locked: true }.spawn(&mut draw);
    for body in &bodies {
        let shape = Shape::cuboid([0.2 * size; 3]);
        world.insert_one(*body, surfaced(collider(&shape), Material::new(0.6, 0.0))).unwrap();
        world.get::<&mut Pose>(*body).unwrap().position.y += (12.0 * size) as Real;
    }
    tumble_tests::touching::ground(&mut world, Material::new(0.6, 0.0), Quat::IDENTITY);
    (world, bodies, size)
}

/// They stay in their plane to the bit, gain no energy, and lie on the ground.
#[test]
fn what_falls_in_its_plane_stays_in_it() {
    for case in 0..8 {
        let (mut world, bodies, size) = fallen(case);
        let mut simulation = simulation(DVec3::NEG_Y * 9.81, 8);
        let begun = energy(&world, &simulation);
        for step in 0..600 {
            run(&mut simulation, &mut world, 1);
            let now = energy(&world, &simulation);
            assert!(now < begun + 0.01 * begun.abs(), "case {case}: {begun} J, {now} J in step {step}");
        }
        for body in &bodies {
            let (now, moves) = (pose(&world, *body), velocity(&world, *body));
            assert_eq!([now.position.z, moves.linear.z], [0.0; 2], "case {case}");
            assert!(f64::from(now.position.y) > 0.0, "case {case}: {now:?}");
            // Of the speed of the fall.
            let left = dvec3(moves.linear).length() / (2.0 * 9.81 * 12.0 * size).sqrt();
            assert!(left < 0.02, "case {case}: {left} of the speed, {size} m");
        }
    }
}

#[test]
fn threads_do_not_matter() {
    let run_on = |threads: usize| {
        pool(threads).install(|| {
            let (mut world, ..) = fallen(0);
            run(&mut simulation(DVec3::NEG_Y * 9.81, 4), &mut world, 120);
            hash(&world)
        })
    };
    assert_eq!(run_on(1), run_on(3));
}
