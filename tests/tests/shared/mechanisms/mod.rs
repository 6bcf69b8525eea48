//! Random mechanisms: trees with loops, of joints of every kind between bodies of many sizes.

#![allow(dead_code, reason = "each test uses a part of it")]

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    Axes, BodyId, BodyOrder, Breakable, Cone, Drive, Drives, Gain, Joint, JointFriction, JointLoad, Limit, Limits,
    Momentum, Pose, RigidBody, Settings, Shape, Simulation, Totals,
};
use tumble_tests::{Draw, EPSILON, dvec3};

/// What mechanisms are drawn from.
#[derive(Clone, Copy)]
pub(crate) struct Class {
    /// How many bodies.
    pub(crate) bodies: u64,
    /// The [`BodyId`] of the first; others count on.
    pub(crate) first_id: u64,
    /// How much heavier the heaviest body is than the lightest, at most.
    pub(crate) mass_ratio: f64,
    /// Half the length of bodies \[m\].
    pub(crate) size: f64,
    /// The longest edge over the shortest, at most.
    pub(crate) aspect: f64,
    /// Speeds \[m/s\] that bodies begin with; the joints take out what they forbid.
    pub(crate) speed: f64,
    /// Probability that a joint goes to a body that is there already by another way.
    pub(crate) loops: f64,
    /// Where the first body is \[m\].
    pub(crate) origin: DVec3,
    /// Whether the first body is fixed.
    pub(crate) is_fixed: bool,
}

impl Class {
    pub(crate) const PLAIN: Self = Self {
        bodies: 12,
        first_id: 10,
        mass_ratio: 10.0,
        size: 0.5,
        aspect: 5.0,
        speed: 2.0,
        loops: 0.0,
        origin: DVec3::ZERO,
        is_fixed: false,
    };
}

pub(crate) fn vector(v: DVec3) -> Vec3 {
    Vec3::new(v.x as Real, v.y as Real, v.z as Real)
}

fn quat(q: DQuat) -> Quat {
    let q = q.normalize();
    Quat::from_xyzw(q.x as Real, q.y as Real, q.z as Real, q.w as Real)
}

/// The free axes of every kind of joint with a constructor.
pub(crate) const KINDS: [fn(Entity, Entity) -> Joint; 7] =
    [Joint::ball, Joint::hinge, Joint::slider, Joint::cylinder, Joint::universal, Joint::planar, Joint::fixed];

/// A joint to come: the numbers of its bodies, its kind, a point \[m\] and an axis.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    pub(crate) bodies: [usize; 2],
    pub(crate) kind: usize,
    pub(crate) point: DVec3,
    pub(crate) axis: DVec3,
}

/// Bodies and joints of a mechanism.
pub(crate) struct Mechanism {
    pub(crate) bodies: Vec<RigidBody>,
    pub(crate) joints: Vec<Plan>,
}

/// A mechanism of a class.
pub(crate) fn mechanism(class: Class, draw: &mut Draw) -> Mechanism {
    let Class { mass_ratio, size, aspect, speed, origin, .. } = class;
    let (mut bodies, mut joints, mut places) = (Vec::new(), Vec::new(), Vec::<DVec3>::new());
    for number in 0..class.bodies as usize {
        let mut half = || size / draw.log_between(1.0, aspect);
        let edges = [half(), half(), half()];
        let parent = number.checked_sub(1).map(|last| (draw.between(0.0, 1.0) * (last + 1) as f64) as usize);
        let at = parent.map_or(origin, |parent| places[parent] + draw.direction() * size * 1.5);
        let mut body = RigidBody::new(Shape::cuboid(edges)).without_collider().mass(draw.log_between(1.0, mass_ratio));
        body =
            body.id(BodyId(class.first_id + number as u64)).position(vector(at)).orientation(quat(draw.orientation()));
        if number == 0 && class.is_fixed {
            body = body.fixed();
        } else {
            body = body.linear_velocity(vector(draw.vector(speed)));
            body = body.angular_velocity(vector(draw.vector(speed / size)));
        }
        let kind = |draw: &mut Draw| (draw.between(0.0, 1.0) * 6.999) as usize;
        if let Some(parent) = parent {
            let point = (places[parent] + at) * 0.5 + draw.vector(0.2 * size);
            joints.push(Plan { bodies: [parent, number], kind: kind(draw), point, axis: draw.direction() });
            if draw.often(class.loops) {
                let other = (draw.between(0.0, 1.0) * number as f64) as usize;
                joints.push(Plan { bodies: [other, number], kind: 0, point: at, axis: draw.direction() });
            }
        }
        places.push(at);
        bodies.push(body);
    }
    Mechanism { bodies, joints }
}

impl Mechanism {
    /// Spawns the bodies, and the joints between them, in these orders.
    pub(crate) fn spawn(&self, world: &mut World, bodies: &[usize], joints: &[usize]) -> (Vec<Entity>, Vec<Entity>) {
        let mut of_number = vec![Entity::DANGLING; self.bodies.len()];
        for &number in bodies {
            of_number[number] = self.bodies[number].clone().build().unwrap().spawn(world);
        }
        let mut made = vec![Entity::DANGLING; self.joints.len()];
        for &number in joints {
            let Plan { bodies: [a, b], kind, point, axis } = self.joints[number];
            let joint = KINDS[kind](of_number[a], of_number[b]);
            let joint = joint.at(world, vector(point), vector(axis)).unwrap();
            made[number] = world.spawn((joint, JointLoad::default()));
        }
        (of_number, made)
    }
}

/// What joints have beside their frames.
#[derive(Clone, Copy)]
pub(crate) struct Options {
    /// Whether there are drives and soft limits, which hold energy or make it.
    pub(crate) has_springs: bool,
    /// Whether some can break.
    pub(crate) breaks: bool,
    /// Half the length of bodies \[m\], and their mass \[kg\].
    pub(crate) size: f64,
    pub(crate) mass: f64,
}

/// Gives joints limits, drives and friction, to each by its number.
pub(crate) fn add_options(world: &mut World, joints: &[Entity], options: Options, case: u64) {
    for (number, joint) in joints.iter().enumerate() {
        let mut draw = Draw::new(0x0B + case, number as u64);
        let free = world.get::<&Joint>(*joint).unwrap().free;
        let mut limits = Limits::default();
        let mut friction = JointFriction::default();
        let mut drives = Vec::new();
        for (index, axis) in Axes::EACH.into_iter().enumerate().filter(|(_, axis)| free.contains(*axis)) {
            let scale = if index < 3 { options.size } else { 1.0 };
            let force = options.mass * 10.0 * if index < 3 { 1.0 } else { options.size };
            let bounds = [-draw.between(0.0, 0.8), draw.between(0.0, 0.8)].map(|bound| (bound * scale) as Real);
            if draw.often(0.5) {
                let hard = Limit::new(bounds[0], bounds[1]);
                let is_soft = draw.often(0.3) && options.has_springs;
                limits.axes[index] = Some(if is_soft { hard.with_frequency(8.0, 0.5) } else { hard });
            }
            if draw.often(0.4) {
                friction.max[index] = draw.log_between(1e-3 * force, force) as Real;
            }
            if draw.often(0.4) && options.has_springs {
                let most = draw.log_between(0.1 * force, 10.0 * force) as Real;
                let motor = Drive::velocity(axis, (draw.between(-2.0, 2.0) * scale) as Real).with_max_force(most);
                let servo = Drive::position(axis, (draw.between(-1.0, 1.0) * scale) as Real);
                let spring = servo.with_frequency(draw.log_between(0.1, 30.0) as Real, draw.between(0.0, 1.5) as Real);
                drives.push(if draw.often(0.5) { motor } else { spring });
            }
        }
        if free.contains(Axes::ANGULAR) && draw.often(0.5) {
            let half_angles = [draw.between(0.1, 1.5), draw.between(0.1, 1.5)].map(|angle| angle as Real);
            limits.cone = Some(Cone { half_angles, gain: Gain::Rigid });
        }
        world.insert(*joint, (limits, friction, Drives(drives))).unwrap();
        if options.breaks && draw.often(0.3) {
            let force = (options.mass * draw.log_between(10.0, 1000.0)) as Real;
            world.insert_one(*joint, Breakable::at_force(force)).unwrap();
        }
    }
}

/// Gravity along -y [m/s^2], and the length of a step \[s\].
pub(crate) fn simulation(gravity: f64, dt: f64) -> Simulation {
    let gravity = Vec3::Y * -(gravity as Real);
    Simulation::new(Settings::default().with_gravity(gravity).with_dt(dt as Real)).unwrap()
}

/// The totals of a world in which everything is finite.
pub(crate) fn totals(world: &World, simulation: &Simulation) -> Totals {
    let totals = Totals::of(world, simulation.settings(), &BodyOrder::of(world));
    assert_eq!(totals.non_finite, None);
    totals
}

/// The sum of all momenta there could be: what their rounding is measured by.
pub(crate) fn scale(world: &World) -> f64 {
    let of_body = |(pose, momentum): (&Pose, &Momentum)| {
        let (p, l) = (dvec3(momentum.linear).length(), dvec3(momentum.angular).length());
        p * (1.0 + dvec3(pose.position).length()) + l
    };
    world.query::<(&Pose, &Momentum)>().iter().map(of_body).sum()
}

/// Takes a step, in which joints take out what they forbid, and 240 more, in which momenta stay to
/// rounding. Returns the energy after the first and the most after any \[J\].
pub(crate) fn fly_free(world: &mut World, simulation: &mut Simulation, size: f64, case: u64) -> [f64; 2] {
    simulation.step(world);
    let (before, scale) = (totals(world, simulation), scale(world));
    let mut most = before.energy();
    for _ in 0..240 {
        simulation.step(world);
        most = most.max(totals(world, simulation).energy());
    }
    let after = totals(world, simulation);
    let turned = (after.angular_momentum - before.angular_momentum).length();
    let moved = (after.linear_momentum - before.linear_momentum).length();
    let rounding = 300.0 * EPSILON * scale * size.max(1.0);
    assert!(moved <= rounding && turned <= rounding, "case {case}: {moved:e} {turned:e} {rounding:e}");
    [before.energy(), most]
}
