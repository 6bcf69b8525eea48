//! Promise: motors, servos, friction and springs of a mechanism of which a body touches something
//! do what they do where nothing touches it; when the joints of a world are gone, whichever way,
//! its bodies move as if there had never been any; loads tell the speeds that bodies have; works
//! of heavily loaded bodies are booked where they are done.
//!
//! Why: mechanisms in contact go another way through the solver, in passes between those of the
//! contacts. It fails if a pass gives again what the one before has given, or if a mechanism that
//! is no more is solved on.

use crate::jointed::*;
use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::Real;
use tumble::{
    Axes, BodyOrder, Breakable, Collider, Drive, Drives, Joint, JointFriction, Momentum, Pose, RigidBody, Settings,
    Shape, Simulation, Velocity, Work,
};
use tumble_tests::{Draw, by_precision, dvec3};

/// A rod on a hinge about z, and joined to it without effect a ball at rest on the ground.
struct Touched {
    rig: Rig,
    rod: Entity,
    joint: Entity,
    mass: f64,
    length: f64,
}

impl Touched {
    fn new(draw: &mut Draw, gravity_of_rod: f64) -> Self {
        let (mass, length) = (draw.log_between(1e-3, 1e4), draw.log_between(0.01, 10.0));
        let substeps = 1 + draw.between(0.0, 8.0) as u32;
        let mut rig = Rig::new(down(), 1.0 / draw.between(60.0, 240.0), substeps);
        let base = rig.ground();
        let middle = DVec3::X * 0.5 * length;
        let rod = rig.spawn(rod(mass, length, middle).gravity_scale(gravity_of_rod as Real));
        let joint = rig.join_at(Joint::hinge(base, rod), ORIGIN, DVec3::Z);
        let radius = 0.2 * length;
        let ball =
            RigidBody::new(Shape::sphere(radius)).mass(mass).position(real(DVec3::new(0.0, -4.0 * length, length)));
        let ball = rig.spawn(ball);
        rig.world.insert_one(ball, Collider::new(&Shape::sphere(radius)).unwrap()).unwrap();
        let at = RigidBody::new(Shape::Point).fixed().position(real(DVec3::NEG_Y * (4.0 * length + radius)));
        at.build().unwrap().spawn_with(&mut rig.world, (Collider::half_space(),));
        let tie = Joint::free(rod, ball).at_point(&rig.world, real(ORIGIN)).unwrap();
        rig.world.spawn((tie,));
        Self { rig, rod, joint, mass, length }
    }

    /// About the hinge [kg m^2].
    fn inertia(&self) -> f64 {
        self.mass * self.length * self.length / 3.0
    }

    fn speed(&self) -> f64 {
        self.rig.angular_velocity(self.rod).z
    }
}

#[test]
fn a_motor_and_friction_have_their_torque() {
    let mut worst = 0.0_f64;
    for case in 0..40 {
        let mut draw = Draw::new(0xc0, case);
        let mut it = Touched::new(&mut draw, 0.0);
        let (torque, drag) = (it.inertia() * draw.between(0.5, 20.0), draw.between(0.0, 0.8));
        let motor = Drive::velocity(Axes::ANGULAR_X, 1e3).with_max_force(torque as Real);
        let friction = JointFriction::along(Axes::ANGULAR_X, (drag * torque) as Real);
        it.rig.world.insert(it.joint, (Drives(vec![motor]), friction)).unwrap();
        it.rig.run_to(0.5);
        let expected = (1.0 - drag) * torque / it.inertia() * it.rig.simulation.time();
        // Passes between those of contacts are of second order in the angle of a substep.
        let h = f64::from(it.rig.simulation.settings().contact_substep());
        let bound = by_precision(2e-5, 1e-9) + 0.6 * (expected * h).powi(2);
        worst = worst.max((it.speed() / expected - 1.0).abs() / bound);
        // The motor goes: friction alone brings it to rest.
        let (from, begin) = (it.speed(), it.rig.simulation.time());
        it.rig.world.remove_one::<Drives>(it.joint).unwrap();
        it.rig.run_to(begin + 0.1);
        let slower = drag * torque / it.inertia() * (it.rig.simulation.time() - begin);
        worst = worst.max((it.speed() - (from - slower).max(0.0)).abs() / from / bound);
    }
    println!("off by {worst} of the bound");
    assert!(worst < 1.0, "{worst}");
}

#[test]
fn a_motor_holds_what_it_can_and_no_more() {
    for case in 0..40 {
        let mut draw = Draw::new(0xc1, case);
        let strength = if draw.often(0.5) { 0.99 } else { 1.01 };
        let mut it = Touched::new(&mut draw, 1.0);
        let torque = strength * it.mass * G * 0.5 * it.length;
        let motor = Drive::velocity(Axes::ANGULAR_X, 0.0).with_max_force(torque as Real);
        it.rig.world.insert_one(it.joint, Drives(vec![motor])).unwrap();
        it.rig.run_to(0.4);
        let (angle, most) = (it.rig.load(it.joint).values[3].abs(), 0.5 * 1.5 * G / it.length * 0.16);
        if strength > 1.0 {
            assert!(angle < 1e-4, "case {case}: {angle}");
        } else {
            // One in a hundred of the free fall, for as long as the lever hardly turns.
            assert!(f64::from(angle) > 0.008 * most.min(1.0), "case {case}: {angle} of {most}");
        }
    }
}

#[test]
fn a_servo_sags_by_load_over_stiffness() {
    let mut worst = 0.0_f64;
    for case in 0..30 {
        let mut draw = Draw::new(0xc2, case);
        let mut it = Touched::new(&mut draw, 1.0);
        let load = it.mass * G * 0.5 * it.length;
        let stiffness = load * draw.log_between(2.0, 1e3);
        let damping = 2.0 * (stiffness * it.inertia()).sqrt();
        let servo = Drive::position(Axes::ANGULAR_X, 0.0).with_stiffness(stiffness as Real, damping as Real);
        it.rig.world.insert_one(it.joint, Drives(vec![servo])).unwrap();
        it.rig.run_to(20.0 * (it.inertia() / stiffness).sqrt() + 0.5);
        let angle = f64::from(it.rig.load(it.joint).values[3]);
        worst = worst.max((stiffness * angle / (-load * angle.cos()) - 1.0).abs());
    }
    println!("sags by {worst:e} more or less than load over stiffness");
    assert!(worst < by_precision(2e-3, 1e-6), "{worst:e}");
}

/// The ways in which joints go.
#[derive(Clone, Copy, Debug)]
enum Going {
    Despawned,
    Removed,
    Broken,
    WithoutBody,
}

const WAYS: [Going; 4] = [Going::Despawned, Going::Removed, Going::Broken, Going::WithoutBody];

/// Takes all joints away.
fn take_away(world: &mut World, joints: &[Entity], bodies: &mut Vec<Entity>, going: Going) {
    for joint in joints {
        match going {
            Going::Despawned => world.despawn(*joint).unwrap(),
            Going::Removed => drop(world.remove_one::<Joint>(*joint).unwrap()),
            Going::Broken => {
                let broken = Breakable { is_broken: true, ..Breakable::at_force(1.0) };
                world.insert_one(*joint, broken).unwrap();
            }
            Going::WithoutBody => {}
        }
    }
    if matches!(going, Going::WithoutBody) {
        let odd: Vec<_> = bodies.iter().copied().skip(1).step_by(2).collect();
        bodies.retain(|body| !odd.contains(body));
        odd.into_iter().for_each(|body| world.despawn(body).unwrap());
    }
}

/// Spheres on the ground or high above it, in a chain, and others that fall beside them.
fn chain_and_spheres(draw: &mut Draw, height: f64) -> (World, Vec<Entity>, Vec<Entity>, Shape) {
    let mut world = World::new();
    tumble_tests::touching::ground(&mut world, tumble::Material::default(), tumble::math::Quat::IDENTITY);
    let (links, others) = (2 + draw.between(0.0, 6.0) as usize, 1 + draw.between(0.0, 4.0) as usize);
    let radius = draw.log_between(0.05, 1.0);
    let bodies: Vec<Entity> = (0..links + others)
        .map(|number| {
            let is_link = number < links;
            let above = if is_link { height } else { 0.02 + draw.between(0.0, 0.05) };
            let at = DVec3::new(3.0 * radius * number as f64, radius + above, if is_link { 0.0 } else { 9.0 });
            let body = RigidBody::new(Shape::sphere(radius)).mass(draw.log_between(0.1, 10.0)).position(real(at));
            let collider = Collider::new(&Shape::sphere(radius)).unwrap();
            body.build().unwrap().spawn_with(&mut world, (collider,))
        })
        .collect();
    let joints = (1..links)
        .map(|link| {
            let between = DVec3::new(3.0 * radius * (link as f64 - 0.5), radius + height, 0.0);
            let joint = Joint::ball(bodies[link - 1], bodies[link]).at_point(&world, real(between)).unwrap();
            world.spawn((joint, Breakable::at_force(Real::INFINITY)))
        })
        .collect();
    (world, bodies, joints, Shape::sphere(radius))
}

/// The same bodies in another world, as they move, without joints.
fn without_joints(world: &World, bodies: &[Entity], shape: &Shape) -> (World, Vec<Entity>) {
    let mut other = World::new();
    tumble_tests::touching::ground(&mut other, tumble::Material::default(), tumble::math::Quat::IDENTITY);
    let copies = bodies
        .iter()
        .map(|body| {
            let mass = world.get::<&tumble::Mass>(*body).unwrap().kilograms();
            let body_of = RigidBody::new(shape.clone()).mass(mass).build().unwrap();
            let copy = body_of.spawn_with(&mut other, (Collider::new(shape).unwrap(),));
            *other.get::<&mut Pose>(copy).unwrap() = *world.get::<&Pose>(*body).unwrap();
            *other.get::<&mut Momentum>(copy).unwrap() = *world.get::<&Momentum>(*body).unwrap();
            copy
        })
        .collect();
    (other, copies)
}

#[test]
fn bodies_of_joints_that_are_gone_move_without_them() {
    for case in 0..64 {
        let mut draw = Draw::new(0xc3, case);
        let going = WAYS[case as usize % 4];
        let is_touched = case / 4 % 2 == 0;
        let (mut world, mut bodies, joints, shape) = chain_and_spheres(&mut draw, if is_touched { 0.0 } else { 40.0 });
        let settings = Settings::default().with_dt(1.0 / 120.0);
        let mut simulation = Simulation::new(settings).unwrap();
        simulation.step_many(&mut world, 3);
        take_away(&mut world, &joints, &mut bodies, going);
        // What breaks has broken before the next step begins.
        let (mut other, copies) = without_joints(&world, &bodies, &shape);
        let mut of_other = Simulation::new(settings).unwrap();
        for _ in 0..60 {
            simulation.step(&mut world);
            of_other.step(&mut other);
        }
        for (body, copy) in bodies.iter().zip(&copies) {
            let [a, b] = [(&world, *body), (&other, *copy)].map(|(world, body)| {
                let pose = *world.get::<&Pose>(body).unwrap();
                (dvec3(pose.position), dvec3(world.get::<&Velocity>(body).unwrap().linear))
            });
            let (apart, faster) = ((a.0 - b.0).length(), (a.1 - b.1).length());
            // Without joints they lie on contacts that give way by up to 2.8e-4 m between bodies.
            assert!(apart < 4e-4 && faster < 2e-2, "case {case}, {going:?}: {apart:e} m, {faster:e} m/s");
        }
    }
}

#[test]
fn loads_tell_the_speeds_that_bodies_have() {
    let mut worst = 0.0_f64;
    for case in 0..16 {
        let mut draw = Draw::new(0xc4, case);
        let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
        tumble_tests::touching::ground(&mut rig.world, tumble::Material::new(0.5, 0.6), tumble::math::Quat::IDENTITY);
        let boxes: Vec<_> = (0..2)
            .map(|number| {
                let shape = Shape::cuboid([0.2, 0.1, 0.1]);
                let at = DVec3::new(0.45 * f64::from(number), 1.0, 0.0);
                let body = RigidBody::new(shape.clone()).mass(draw.between(1.0, 5.0)).position(real(at));
                let collider =
                    tumble_tests::touching::surfaced(Collider::new(&shape).unwrap(), tumble::Material::new(0.5, 0.6));
                body.build().unwrap().spawn_with(&mut rig.world, (collider,))
            })
            .collect();
        let joint = rig.join_at(Joint::hinge(boxes[0], boxes[1]), DVec3::new(0.225, 1.0, 0.0), DVec3::Z);
        rig.world.get::<&mut Momentum>(boxes[1]).unwrap().angular = real(DVec3::Z * draw.between(-0.2, 0.2));
        for _ in 0..120 {
            rig.step();
            let spin = rig.angular_velocity(boxes[1]) - rig.angular_velocity(boxes[0]);
            let axis = rig.orientation(boxes[0]) * DVec3::Z;
            let told = f64::from(rig.load(joint).speeds[3]);
            worst = worst.max((told - spin.dot(axis)).abs());
        }
    }
    println!("speeds are off by {worst:e} rad/s");
    assert!(worst < by_precision(1e-4, 1e-9), "{worst:e}");
}

/// A heavy weight on a chain of light links, of which the first leans on a wall.
#[test]
fn contacts_of_loaded_links_do_no_work_that_joints_do() {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let base = rig.ground();
    let wall = DQuat::from_rotation_z(-std::f64::consts::FRAC_PI_2);
    let wall_at = RigidBody::new(Shape::Point).fixed().position(real(DVec3::NEG_X * 0.05));
    let wall = wall_at.orientation(tumble_tests::references::real_quat(wall)).build().unwrap();
    wall.spawn_with(&mut rig.world, (Collider::half_space(),));
    let mut before = base;
    let mut bodies = Vec::new();
    for link in 0..6 {
        let mass = if link == 5 { 200.0 } else { 0.05 };
        let at = DVec3::new(0.0, -0.05 - 0.1 * f64::from(link), 0.0);
        let shape = Shape::sphere(0.04);
        let body = RigidBody::new(shape.clone()).without_collider().mass(mass).position(real(at)).build().unwrap();
        let body = body.spawn_with(&mut rig.world, (Work::default(),));
        if link == 0 {
            rig.world.insert_one(body, Collider::new(&shape).unwrap()).unwrap();
        }
        rig.join_at(Joint::ball(before, body), at + DVec3::Y * 0.05, DVec3::Y);
        bodies.push(body);
        before = body;
    }
    // Towards the wall, at half a metre a second.
    rig.world.get::<&mut Momentum>(bodies[5]).unwrap().linear = real(DVec3::NEG_X * 100.0);
    let order = BodyOrder::of(&rig.world);
    let kinetic = |rig: &Rig| {
        let totals = tumble::Totals::of(&rig.world, rig.simulation.settings(), &order);
        totals.linear_kinetic + totals.rotational_kinetic
    };
    let start = kinetic(&rig);
    let (mut least, mut most, mut unbooked) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..120 {
        rig.step();
        let works: Vec<Work> = bodies.iter().map(|body| *rig.world.get::<&Work>(*body).unwrap()).collect();
        let total: f64 = works.iter().map(Work::total).sum();
        let contacts: f64 = works.iter().map(|work| work.contacts).sum();
        unbooked = unbooked.max((total - (kinetic(&rig) - start)).abs());
        (least, most) = (least.min(contacts), most.max(contacts));
    }
    println!("contacts did {least} to {most} J of {start} J, unbooked are {unbooked:e} J");
    assert!(unbooked < by_precision(1e-3, 1e-6), "{unbooked:e}");
    // A contact adds nothing. What stops on the wall has the inertia that its load asks for: with 8
    // to 32 substeps contacts take 2 % of the energy.
    assert!(most < 1e-4 * start && least > -3e-2 * start, "{least} {most}");
}
