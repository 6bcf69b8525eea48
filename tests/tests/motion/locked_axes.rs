//! Promise: a body with locked axes does not move along or about them, answers along them as a
//! fixed body does and along the others as it would anyway; about two free axes it turns without a
//! trend of the energy; on any threads, in a batch and with the accounts closed.
//!
//! Why: 2.5-D games and characters that do not tip. It fails if a lock is soft, if what a lock
//! holds is taken from the other axes, or if inertia about free axes is the inverse of the wrong
//! part.

use hecs::{Entity, World};
use tumble::math::{Quat, Vec3};
use tumble::prelude::*;
use tumble::{Axes, Batch, BodyOrder, Ledger, LockedAxes, Spring, Totals, Trial, Work};
use tumble_benches::pool;
use tumble_tests::touching::{collider, cube, ground, pose, spawn, surfaced, velocity};
use tumble_tests::{Draw, by_precision, dquat, dvec3, hash, real, run};

fn narrow(v: glam::DVec3) -> Vec3 {
    Vec3::new(real(v.x), real(v.y), real(v.z))
}

fn narrow_quat(q: glam::DQuat) -> Quat {
    Quat::from_xyzw(real(q.x), real(q.y), real(q.z), real(q.w))
}

/// Of the six axes each with even odds, but at least one.
fn some_axes(draw: &mut Draw) -> Axes {
    loop {
        let axes = Axes::EACH.into_iter().filter(|_| draw.often(0.5)).fold(Axes::NONE, Axes::with);
        if axes != Axes::NONE {
            return axes;
        }
    }
}

fn locked(axes: Axes) -> [glam::DVec3; 2] {
    let one = |axis: usize| f64::from(u8::from(axes.contains(Axes::EACH[axis])));
    [glam::DVec3::new(one(0), one(1), one(2)), glam::DVec3::new(one(3), one(4), one(5))]
}

/// Free bodies of any aspect under gravity: nothing along locked axes, a free fall along the
/// others, and about the free ones the angular momentum that they began with, and the energy.
#[test]
fn what_is_free_moves_on() {
    for case in 0..200 {
        let mut draw = Draw::new(2350, case);
        let axes = some_axes(&mut draw);
        let [along, about] = locked(axes);
        let size = draw.log_between(0.01, 10.0);
        let half = [(); 3].map(|()| size * draw.log_between(0.05, 1.0));
        let velocity_0 = draw.direction() * draw.between(0.0, 5.0);
        let spin = draw.direction() * draw.log_between(0.1, 20.0);
        let position = draw.direction() * draw.between(0.0, 10.0);
        let body = RigidBody::new(Shape::cuboid(half))
            .without_collider()
            .mass(draw.log_between(1e-3, 1e3))
            .position(narrow(position))
            .orientation(narrow_quat(draw.orientation()))
            .linear_velocity(narrow(velocity_0))
            .angular_velocity(narrow(spin));
        let mut world = World::new();
        let it = body.build().unwrap().spawn_with(&mut world, (LockedAxes(axes),));
        let mut simulation =
            Simulation::new(Settings::default().with_dt(1.0 / real(draw.log_between(60.0, 240.0)))).unwrap();
        let angular_0 = dvec3(world.get::<&Momentum>(it).unwrap().angular);
        let started = pose(&world, it);
        run(&mut simulation, &mut world, 1);
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        let turning = |world: &World| {
            let momentum = dvec3(world.get::<&Momentum>(it).unwrap().angular);
            0.5 * momentum.dot(dvec3(velocity(world, it).angular))
        };
        for _ in 0..119 {
            run(&mut simulation, &mut world, 1);
            let energy = turning(&world);
            (least, most) = (least.min(energy), most.max(energy));
            let moves = velocity(&world, it);
            assert_eq!(moves.linear * narrow(along), Vec3::ZERO, "case {case}: {axes:?}");
            let held = dvec3(moves.angular) * about;
            let limit = by_precision(1e-4, 1e-10) * dvec3(moves.angular).length();
            assert!(held.length() <= limit, "case {case}: {axes:?}: {:?}", moves.angular);
        }
        let now = pose(&world, it);
        assert_eq!((now.position - started.position) * narrow(along), Vec3::ZERO, "case {case}: {axes:?}");
        let t = 120.0 * f64::from(simulation.settings().dt);
        let free = glam::DVec3::ONE - along;
        let fallen = (velocity_0 * t - glam::DVec3::Y * (0.5 * 9.81 * t * t)) * free;
        let gone = dvec3(now.position) - position;
        // Kick and drift of a contact substep come one after the other.
        let of_substep = 9.81 * t * f64::from(simulation.settings().contact_substep());
        assert!((gone - fallen).length() < of_substep + 1e-4 * (1.0 + gone.length()), "case {case}: {gone} {fallen}");
        if about == glam::DVec3::ZERO {
            continue;
        }
        let kept = (dvec3(world.get::<&Momentum>(it).unwrap().angular) - angular_0) * (glam::DVec3::ONE - about);
        assert!(kept.length() < by_precision(1e-4, 1e-10) * angular_0.length(), "case {case}: {axes:?}: {kept}");
        assert!(most - least <= 1e-3 * most, "case {case}: {axes:?}: {least} to {most} J");
    }
}

/// About one free axis: the angle is that of the moment of inertia about it, under a torque.
#[test]
fn one_free_axis_is_a_hinge() {
    for case in 0..60 {
        let mut draw = Draw::new(2351, case);
        let axis = (draw.between(0.0, 3.0) as usize).min(2);
        let free = [Axes::ANGULAR_X, Axes::ANGULAR_Y, Axes::ANGULAR_Z][axis];
        let others = Axes::EACH.into_iter().filter(|it| *it != free).fold(Axes::NONE, Axes::with);
        let half = [(); 3].map(|()| draw.log_between(0.05, 1.0));
        let (mass, orientation) = (draw.log_between(0.1, 10.0), draw.orientation());
        let body =
            RigidBody::new(Shape::cuboid(half)).without_collider().mass(mass).orientation(narrow_quat(orientation));
        let mut world = World::new();
        let it = body.build().unwrap().spawn_with(&mut world, (LockedAxes(others),));
        let unit = [glam::DVec3::X, glam::DVec3::Y, glam::DVec3::Z][axis];
        let local = orientation.conjugate() * unit;
        let [x, y, z] = half.map(|it| it * it);
        let moment = mass / 3.0 * glam::DVec3::new(y + z, z + x, x + y).dot(local * local);
        let acceleration = draw.log_between(0.1, 2.0);
        let torque = draw.direction().reject_from(unit) * 10.0 * moment + unit * moment * acceleration;
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        let dt = f64::from(simulation.settings().dt);
        for _ in 0..60 {
            world.get::<&mut Wrench>(it).unwrap().torque = narrow(torque);
            run(&mut simulation, &mut world, 1);
        }
        let t = 60.0 * dt;
        let turned = dquat(pose(&world, it).orientation) * orientation.conjugate();
        let angle = 0.5 * acceleration * t * (t + f64::from(simulation.settings().contact_substep()));
        let expected = glam::DQuat::from_axis_angle(unit, angle);
        assert!(turned.angle_between(expected) < 1e-3 * angle, "case {case}: {turned} {expected}");
    }
}

/// A ball without friction hits a locked body at any angle, of any mass: the body answers along its
/// free axes only, `J = (1 + e) v / (1/m + n F n/M)`.
#[test]
fn a_blow_goes_into_free_axes() {
    for case in 0..200 {
        let mut draw = Draw::new(2352, case);
        let along = [Axes::LINEAR_X, Axes::LINEAR_Y, Axes::LINEAR_Z].into_iter().filter(|_| draw.often(0.5));
        let axes = along.fold(Axes::ANGULAR, Axes::with);
        let [translations, _] = locked(axes);
        let (restitution, speed) = (draw.between(0.0, 1.0), draw.between(2.0, 10.0));
        let (mass, other) = (draw.log_between(1e-2, 1e2), draw.log_between(1e-2, 1e2));
        // What is nearly along a locked axis is a wedge, which turns the line of centres at once.
        let mut normal = draw.direction();
        while translations != glam::DVec3::ONE && (normal * (glam::DVec3::ONE - translations)).length() < 0.5 {
            normal = draw.direction();
        }
        let response = 1.0 / mass + normal.dot(normal * (glam::DVec3::ONE - translations)) / other;
        let mut world = World::new();
        let ball =
            |position: glam::DVec3, mass: f64| RigidBody::new(Shape::sphere(0.5)).mass(mass).position(narrow(position));
        let surface = || surfaced(collider(&Shape::sphere(0.5)), Material::new(0.0, real(restitution)));
        let moving = ball(normal * -1.2, mass).linear_velocity(narrow(normal * speed));
        let moving = spawn(&mut world, moving, surface());
        let held = spawn(&mut world, ball(glam::DVec3::ZERO, other), surface());
        world.insert_one(held, LockedAxes(axes)).unwrap();
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(1.0 / 2000.0);
        let mut simulation = Simulation::new(settings).unwrap();
        run(&mut simulation, &mut world, 300);
        let given = (1.0 + restitution) * speed / response;
        let went = dvec3(velocity(&world, moving).linear);
        let wanted = normal * (speed - given / mass);
        assert!((went - wanted).length() < 0.02 * speed, "case {case}: {axes:?}: {went} {wanted}");
        let answered = dvec3(velocity(&world, held).linear);
        let wanted = normal * (glam::DVec3::ONE - translations) * (given / other);
        assert!((answered - wanted).length() < 0.02 * (wanted.length() + speed), "case {case}: {answered} {wanted}");
        assert_eq!(velocity(&world, held).linear * narrow(translations), Vec3::ZERO, "case {case}");
    }
}

/// Something of any mass hits a body along its locked axis: it is stopped, or bounces, as by a
/// fixed body, and moves nothing.
#[test]
fn a_locked_axis_is_a_wall() {
    for case in 0..100 {
        let mut draw = Draw::new(2353, case);
        let (heavy, speed) = (draw.log_between(1e-3, 1e6), draw.log_between(0.1, 20.0));
        let material = Material::new(real(draw.between(0.0, 1.0)), real(draw.between(0.0, 1.0)));
        let (aside, spin) = (draw.between(-0.4, 0.4), draw.direction() * draw.between(0.0, 2.0) * speed);
        let after = |lock: Option<LockedAxes>| {
            let mut world = World::new();
            let (body, surface) = (RigidBody::new(cube(0.5)), surfaced(collider(&cube(0.5)), material));
            let wall = match lock {
                Some(lock) => body.mass(1.0).build().unwrap().spawn_with(&mut world, (surface, lock)),
                None => spawn(&mut world, body.fixed(), surface),
            };
            let shape = Shape::sphere(0.3);
            let ram = RigidBody::new(shape.clone()).mass(heavy).position(Vec3::new(real(aside), 0.0, -1.2));
            let ram = ram.linear_velocity(Vec3::Z * real(speed)).angular_velocity(narrow(spin));
            let ram = spawn(&mut world, ram, surfaced(collider(&shape), material));
            let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
            run(&mut simulation, &mut world, (0.6 / speed * 60.0) as u32 + 3);
            (velocity(&world, ram), pose(&world, wall))
        };
        let [(by_lock, held), (by_wall, _)] = [Some(LockedAxes(Axes::LINEAR | Axes::ANGULAR)), None].map(after);
        assert_eq!(held, Pose::default(), "case {case}");
        let of_linear = dvec3(by_lock.linear - by_wall.linear).length();
        let of_angular = 0.3 * dvec3(by_lock.angular - by_wall.angular).length();
        assert!(of_linear + of_angular < 0.01 * speed, "case {case}: {heavy} kg: {by_lock:?} {by_wall:?}");
    }
}

/// Boxes and balls of a size \[m\] in a plane, to fall into a heap.
fn heap(draw: &mut Draw) -> (World, Vec<Entity>, f64) {
    let mut world = World::new();
    ground(&mut world, Material::new(0.6, 0.0), Quat::IDENTITY);
    let size = draw.log_between(0.02, 2.0);
    let mut bodies = Vec::new();
    for row in 0..6 {
        for column in 0..5 {
            let half = [(); 3].map(|()| real(size * draw.between(0.3, 0.5)));
            let shape =
                if draw.often(0.3) { Shape::sphere(f64::from(half[0])) } else { Shape::cuboid(half.map(f64::from)) };
            let [x, y] = [1.5 * size * (f64::from(column) - 2.0), 1.5 * size * f64::from(row) + size];
            let place = Vec3::new(real(x), real(y), 0.0);
            let tilt = Quat::from_rotation_z(real(draw.between(-3.0, 3.0)));
            let body = RigidBody::new(shape.clone()).density(500.0).position(place).orientation(tilt);
            let surface = surfaced(collider(&shape), Material::new(0.6, 0.0));
            bodies.push(body.build().unwrap().spawn_with(&mut world, (surface, LockedAxes::PLANE_XY)));
        }
    }
    (world, bodies, size)
}

/// They stay in it to the bit, come to rest and do not sink.
#[test]
fn a_heap_stays_in_its_plane() {
    for case in 0..6 {
        let (mut world, bodies, size) = heap(&mut Draw::new(2354, case));
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        run(&mut simulation, &mut world, 600);
        // A ball rolls on. One that leaves the heap late moves what it lay on.
        let fastest_box = |world: &World| {
            let is_box = |body: &&Entity| {
                let inertia = world.get::<&Inertia>(**body).unwrap();
                inertia.moments().min_element() < inertia.moments().max_element()
            };
            let speed = |body: &Entity| dvec3(velocity(world, *body).linear).length();
            bodies.iter().filter(is_box).map(speed).fold(0.0, f64::max)
        };
        let slow = 0.02 * (9.81 * size).sqrt();
        let mut seconds = 10;
        while fastest_box(&world) >= slow {
            assert!(seconds < 20, "case {case}: {} m/s after {seconds} s", fastest_box(&world));
            run(&mut simulation, &mut world, 60);
            seconds += 1;
        }
        for body in &bodies {
            let now = pose(&world, *body);
            assert_eq!(now.position.z, 0.0, "case {case}");
            assert_eq!([now.orientation.x, now.orientation.y], [0.0; 2], "case {case}");
            assert!(now.position.y > 0.0, "case {case}: {now:?}");
        }
        let h = f64::from(simulation.settings().contact_substep());
        let mass = |body| world.get::<&Mass>(body).map_or(f64::INFINITY, |mass| f64::from(mass.kilograms()));
        for contact in simulation.contacts() {
            let lighter = contact.bodies.map(mass).into_iter().fold(f64::INFINITY, f64::min);
            for point in contact.points() {
                // Load over stiffness, an eighth of a period in a substep: a corner of two equal
                // boxes moves an eighth of the mass of one.
                let stiffness = (std::f64::consts::TAU / (8.0 * h)).powi(2) * lighter / 8.0;
                let (depth, load) = (-f64::from(point.separation), f64::from(point.impulse) / h);
                assert!(depth < load / stiffness + 1e-3 * size, "case {case}: {depth} m deep under {load} N");
            }
        }
    }
}

/// Bodies of a heap that are locked along and about any axes, wedged and hanging: no energy comes
/// of it.
#[test]
fn no_lock_makes_energy() {
    for case in 0..60 {
        let mut draw = Draw::new(2357, case);
        let (mut world, bodies, size) = heap(&mut draw);
        for body in &bodies {
            world.insert_one(*body, LockedAxes(some_axes(&mut draw))).unwrap();
        }
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        let energy = |world: &World| Totals::of(world, &Settings::default(), &BodyOrder::of(world)).energy();
        let start = energy(&world);
        for step in 0..240 {
            run(&mut simulation, &mut world, 1);
            let now = energy(&world);
            assert!(now < 1.01 * start, "case {case}: {start} J, {now} J in step {step}, size {size}");
        }
    }
}

/// A character on a slope, pushed at its head: it slides where friction does not hold it, and does
/// not tip; without the lock it does.
#[test]
fn a_character_does_not_tip() {
    for (lock, tips) in [(LockedAxes::ROTATIONS, false), (LockedAxes(Axes::NONE), true)] {
        let slope: f64 = 0.3;
        let mut world = World::new();
        ground(&mut world, Material::new(0.5, 0.0), Quat::from_rotation_z(real(slope)));
        let shape = Shape::Capsule { radius: 0.3, half_height: 0.6 };
        let height = 0.6 + 0.3 / slope.cos();
        let body = RigidBody::new(shape.clone()).mass(70.0).position(Vec3::Y * real(height));
        let surface = surfaced(collider(&shape), Material::new(0.5, 0.0));
        let it = body.build().unwrap().spawn_with(&mut world, (surface, lock));
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        run(&mut simulation, &mut world, 120);
        let upright = f64::from((pose(&world, it).orientation * Vec3::Y).y);
        assert_eq!(upright < 0.99, tips, "{upright}");
        if !tips {
            let gone = dvec3(pose(&world, it).position) - glam::DVec3::Y * height;
            assert!(gone.length() < 0.005, "friction holds: {gone}");
            world.get::<&mut Momentum>(it).unwrap().linear += Vec3::X * 70.0;
            run(&mut simulation, &mut world, 120);
            // What goes into the slope is stopped, with the friction of that, and the rest slides.
            let start = slope.cos() - 0.5 * slope.sin();
            let way = 0.5 * start * start / (9.81 * (slope.sin() + 0.5 * slope.cos()));
            let slid = dvec3(pose(&world, it).position) - glam::DVec3::Y * height;
            assert!((slid.length() - way).abs() < 0.1 * way, "{slid} of {way} m");
            assert!((slid.y - slid.x * slope.tan()).abs() < 1e-3, "{slid}");
            assert_eq!(pose(&world, it).orientation, Quat::IDENTITY);
        }
    }
}

/// Springs pull at locked bodies too, and the accounts of all are closed.
#[test]
fn works_add_up() {
    for case in 0..20 {
        let mut draw = Draw::new(2355, case);
        let (mut world, bodies, _) = heap(&mut draw);
        for body in &bodies {
            world.insert_one(*body, LockedAxes(some_axes(&mut draw))).unwrap();
        }
        for pair in bodies.chunks_exact(2).take(5) {
            world.spawn((Spring::between(pair[0], pair[1]).with_stiffness(100.0),));
        }
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        let mut ledger = Ledger::attach(&mut world, &simulation);
        let mut most = 0.0_f64;
        for _ in 0..60 {
            run(&mut simulation, &mut world, 1);
            let entry = ledger.record(&world, &simulation);
            let Work { gravity, contacts, .. } = entry.work;
            // Springs do as much as contacts take back at once.
            most = most.max(entry.kinetic().abs()).max(gravity.abs()).max(contacts.abs());
            assert!(entry.between_steps.abs() < by_precision(1e-4, 1e-10) * most, "case {case}: {entry:?}");
        }
        assert!(most > 0.0);
    }
}

/// A heap of them: the same bits on any threads.
#[test]
fn threads_do_not_matter() {
    let run_on = |threads: usize| {
        pool(threads).install(|| {
            let (mut world, ..) = heap(&mut Draw::new(2356, 0));
            let mut simulation = Simulation::new(Settings::default()).unwrap();
            run(&mut simulation, &mut world, 120);
            hash(&world)
        })
    };
    assert_eq!(run_on(1), run_on(3));
}

/// Worlds that are solved together, some with locked bodies and some without: the bits that each
/// has alone.
#[test]
fn a_batch_does_not_matter() {
    let world_of = |case: u64| {
        let (mut world, bodies, _) = heap(&mut Draw::new(2358, case));
        if case % 2 == 1 {
            bodies.iter().for_each(|body| drop(world.remove_one::<LockedAxes>(*body)));
        }
        world
    };
    let simulation = || Simulation::new(Settings::default()).unwrap();
    let alone = |case: u64| {
        let (mut world, mut simulation) = (world_of(case), simulation());
        run(&mut simulation, &mut world, 60);
        hash(&world)
    };
    let mut batch: Batch = (0..6).map(|case| Trial { world: world_of(case), simulation: simulation() }).collect();
    batch.step_many(60);
    for (case, trial) in (0..).zip(batch.trials()) {
        assert_eq!(hash(&trial.world), alone(case), "case {case}");
    }
}
