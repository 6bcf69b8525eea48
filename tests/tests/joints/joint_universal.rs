//! Promise: the two angles of a joint with two free rotations are those of `R_i(alpha) R_j(beta)`,
//! for each pair of axes, in what is read, limited, driven and rubbed: it comes to rest where a
//! bound or the balance of torques holds it, and a motor of one angle turns that one alone.
//!
//! Why: the second angle is about an axis of the second body, the first about one of the first. It
//! fails if either is taken from the wrong body, if both are swapped, if the second has the wrong
//! sign in one of the three pairs, or where an angle passes a right angle.

use std::f64::consts::PI;

use crate::jointed::*;
use glam::{DQuat, DVec3};
use hecs::Entity;
use tumble::math::Real;
use tumble::{Axes, Damping, Drive, Drives, Inertia, Joint, JointFriction, Limit, Limits, Momentum};
use tumble_tests::references::real_quat;
use tumble_tests::{Draw, attitude_error, by_precision, dquat, dvec3};

/// The first and the second free rotation.
const PAIRS: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];

fn rotation(axis: usize) -> Axes {
    Axes::EACH[3 + axis]
}

fn universal(a: Entity, b: Entity, [i, j]: [usize; 2]) -> Joint {
    Joint::free_along(a, b, rotation(i) | rotation(j))
}

/// Of the second frame against the first.
fn bent([i, j]: [usize; 2], [alpha, beta]: [f64; 2]) -> DQuat {
    DQuat::from_axis_angle(DVec3::AXES[i], alpha) * DQuat::from_axis_angle(DVec3::AXES[j], beta)
}

/// A body on a joint of a pair to another one.
struct Cross {
    rig: Rig,
    it: Entity,
    joint: Entity,
    pair: [usize; 2],
}

impl Cross {
    /// On a fixed one, with frames turned at random, off the joint by an arm along the body's axes.
    fn new(draw: &mut Draw, gravity: DVec3, pair: [usize; 2], angles: [f64; 2], arm: DVec3) -> Self {
        let mut rig = Rig::new(gravity, 1.0 / 60.0, 8);
        let [of_base, first, second] = [(); 3].map(|()| draw.orientation());
        let base = rig.spawn(turned_to(body(1.0, DVec3::ONE, ORIGIN), of_base).fixed());
        let orientation = of_base * first * bent(pair, angles) * second.conjugate();
        let it = rig.spawn(turned_to(body(2.0, DVec3::new(0.3, 0.4, 0.5), orientation * arm), orientation));
        let joint = universal(base, it, pair).with_frames(frame(ORIGIN, first), frame(-arm, second));
        let joint = rig.join(joint);
        Self { rig, it, joint, pair }
    }

    /// Orientations of both frames.
    fn frames(&self) -> [DQuat; 2] {
        let joint = *self.rig.world.get::<&Joint>(self.joint).unwrap();
        [0, 1].map(|end| self.rig.orientation(joint.bodies[end]) * dquat(joint.frames[end].orientation))
    }

    /// The axes about which both angles turn, in the world.
    fn axes(&self) -> [DVec3; 2] {
        let [first, second] = self.frames();
        [first * DVec3::AXES[self.pair[0]], second * DVec3::AXES[self.pair[1]]]
    }

    /// Both angles, by where each body has the other's axis.
    fn angles(&self) -> [f64; 2] {
        let [i, j] = self.pair.map(|axis| DVec3::AXES[axis]);
        let ([first, second], [a, b], third) = (self.frames(), self.axes(), i.cross(j));
        let of_second = first.conjugate() * b;
        let of_first = second.conjugate() * a;
        [of_second.dot(third).atan2(of_second.dot(j)), of_first.dot(third).atan2(of_first.dot(i))]
    }

    /// As they are read from the joint.
    fn read(&self) -> [f64; 2] {
        let load = self.rig.load(self.joint);
        self.pair.map(|axis| f64::from(load.values[3 + axis]))
    }

    /// Has both angles change at these rates [rad/s], about the origin.
    fn turn(&mut self, rates: [f64; 2]) {
        let [a, b] = self.axes();
        let angular = a * rates[0] + b * rates[1];
        let (place, q) = (self.rig.position(self.it), self.rig.orientation(self.it));
        let spin = q * (DVec3::new(0.3, 0.4, 0.5) * (q.conjugate() * angular));
        let momentum = Momentum { linear: real(angular.cross(place) * 2.0), angular: real(spin) };
        *self.rig.world.get::<&mut Momentum>(self.it).unwrap() = momentum;
    }

    /// Of the weight about the origin [N m].
    fn weight_torque(&self) -> DVec3 {
        let gravity = dvec3(self.rig.simulation.settings().gravity);
        self.rig.position(self.it).cross(gravity * 2.0)
    }
}

fn turned_to(body: tumble::RigidBody, orientation: DQuat) -> tumble::RigidBody {
    body.orientation(real_quat(orientation))
}

/// The shorter way from one angle to another.
fn apart(a: f64, b: f64) -> f64 {
    (a - b + PI).rem_euclid(2.0 * PI) - PI
}

/// Bent by any two angles and turning about both axes: the angles that are read turn the first
/// frame into the second, are those of the axes, and change at the speeds that are read.
#[test]
fn angles_and_speeds_are_those_of_two_rotations() {
    let (mut fastest, mut widest) = (0.0_f64, [0.0_f64; 2]);
    for case in 0..90 {
        let mut draw = Draw::new(0x901, case);
        let pair = PAIRS[case as usize % 3];
        let start = [0, 1].map(|_| draw.between(-3.1, 3.1));
        let arm = draw.vector(0.5);
        let mut cross = Cross::new(&mut draw, DVec3::ZERO, pair, start, arm);
        cross.rig.step();
        for (read, drawn) in cross.read().into_iter().zip(start) {
            assert!(apart(read, drawn).abs() < by_precision(2e-6, 1e-12), "{pair:?}: {read} of {drawn}");
        }
        let rates = [0, 1].map(|_| draw.between(-3.0, 3.0));
        cross.turn(rates);
        let mut before = cross.rig.load(cross.joint);
        for step in 0..60 {
            cross.rig.step();
            let (read, [first, second]) = (cross.read(), cross.frames());
            let off = attitude_error(first * bent(pair, read), second);
            assert!(off < by_precision(2e-6, 1e-8), "{pair:?}, step {step}: {read:?} off by {off:e}");
            for (read, seen) in read.into_iter().zip(cross.angles()) {
                assert!(apart(read, seen).abs() < by_precision(2e-6, 1e-8), "{pair:?}: {read} of {seen}");
            }
            let load = cross.rig.load(cross.joint);
            let [a, b] = cross.axes();
            let speeds = pair.map(|axis| f64::from(load.speeds[3 + axis]));
            let turning = cross.rig.angular_velocity(cross.it);
            let off = (a * speeds[0] + b * speeds[1] - turning).length();
            assert!(off < by_precision(1e-5, 1e-7) * (1.0 + turning.length()), "{pair:?}: {off:e} of {turning}");
            // By the trapezium over a step, to its square; in the first one the speeds were others.
            for axis in pair.map(|axis| 3 + axis).into_iter().filter(|_| step > 0) {
                let moved = apart(load.values[axis].into(), before.values[axis].into());
                let mean = 0.5 * f64::from(load.speeds[axis] + before.speeds[axis]);
                assert!((moved * 60.0 - mean).abs() < 2e-2 * (1.0 + turning.length_squared()), "{moved} {mean}");
            }
            fastest = speeds.iter().fold(fastest, |most, speed| most.max(speed.abs()));
            widest = [0, 1].map(|angle| widest[angle].max(read[angle].abs()));
            before = load;
        }
    }
    assert!(fastest > 3.0 && widest[0] > 3.1 && widest[1] > 3.1, "{fastest} {widest:?}");
}

/// Two ranges around zero, narrower than half a turn.
fn ranges(draw: &mut Draw) -> [[f64; 2]; 2] {
    [(); 2].map(|()| [-draw.between(0.1, 1.4), draw.between(0.1, 1.4)])
}

fn limits(pair: [usize; 2], ranges: [[f64; 2]; 2]) -> Limits {
    let of = |range: [f64; 2]| Limit::new(range[0] as Real, range[1] as Real);
    Limits::along(rotation(pair[0]), of(ranges[0])).and_along(rotation(pair[1]), of(ranges[1]))
}

/// Thrown about: no angle comes past its range, and no energy is made; all bounds are reached.
#[test]
fn both_angles_stay_within_their_ranges() {
    let (mut reached, mut past, mut gain) = ([[[0; 2]; 2]; 3], 0.0_f64, 0.0_f64);
    for case in 0..90 {
        let mut draw = Draw::new(0x902, case);
        let number = case as usize % 3;
        let (pair, ranges, arm) = (PAIRS[number], ranges(&mut draw), draw.direction() * 0.5);
        let gravity = draw.direction() * draw.between(0.0, 20.0);
        let mut cross = Cross::new(&mut draw, gravity, pair, [0.0; 2], arm);
        cross.rig.world.insert_one(cross.joint, limits(pair, ranges)).unwrap();
        cross.turn([draw.between(-4.0, 4.0), draw.between(-4.0, 4.0)]);
        let start = cross.rig.energy();
        for _ in 0..180 {
            cross.rig.step();
            gain = gain.max((cross.rig.energy() - start) / (2.0 * 20.0));
            for (angle, value) in cross.angles().into_iter().enumerate() {
                let [low, high] = ranges[angle];
                past = past.max(low - value).max(value - high);
                for (bound, place) in [low, high].into_iter().enumerate() {
                    reached[number][angle][bound] += usize::from((value - place).abs() < 1e-4);
                }
            }
        }
    }
    println!("past by {past:.1e}, energy gained {gain:.1e}, steps on bounds {reached:?}");
    assert!(past < by_precision(2e-5, 1e-6), "{past:e}");
    assert!(gain < 1e-3, "{gain:e}");
    assert!(reached.iter().flatten().flatten().all(|steps| *steps > 50), "{reached:?}");
}

/// Damped till it rests: each angle is on a bound that pushes it back, or the weight has no torque
/// about its axis; and the joint carries the weight.
#[test]
fn it_rests_on_bounds_or_where_torques_balance() {
    let mut held = [[[0; 3]; 2]; 3];
    for case in 0..60 {
        let mut draw = Draw::new(0x903, case);
        let number = case as usize % 3;
        let (pair, ranges, arm) = (PAIRS[number], ranges(&mut draw), draw.direction() * 0.5);
        let gravity = draw.direction() * G;
        let mut cross = Cross::new(&mut draw, gravity, pair, [0.0; 2], arm);
        cross.rig.world.insert_one(cross.joint, limits(pair, ranges)).unwrap();
        cross.rig.world.insert_one(cross.it, Damping { linear: 3.0, angular: 3.0 }).unwrap();
        cross.rig.run_to(12.0);
        cross.rig.world.remove_one::<Damping>(cross.it).unwrap();
        cross.rig.run_to(12.2);
        let load = cross.rig.load(cross.joint);
        let (torque, weight, most) = (dvec3(load.torque), cross.weight_torque(), 2.0 * G * 0.5);
        let off = (torque + weight).length() / most;
        assert!(off < by_precision(1e-3, 1e-5), "{pair:?}, case {case}: {torque} of {weight}, {off:e}");
        for (angle, (value, axis)) in cross.angles().into_iter().zip(cross.axes()).enumerate() {
            let [low, high] = ranges[angle].map(|bound| (value - bound).abs() < by_precision(2e-5, 1e-6));
            let about = torque.dot(axis) / most;
            let (slot, is_right) = match (low, high) {
                (true, _) => (0, about > -1e-3),
                (_, true) => (1, about < 1e-3),
                _ => (2, about.abs() < 1e-3 && ranges[angle][0] < value && value < ranges[angle][1]),
            };
            held[number][angle][slot] += 1;
            assert!(is_right, "{pair:?}, angle {angle}, case {case}: {value} in {:?}, torque {about}", ranges[angle]);
        }
    }
    println!("on the lower bound, the upper, and between: {held:?}");
    assert!(held.iter().flatten().all(|of| of[0] > 0 && of[1] > 0 && of.iter().sum::<i32>() == 20), "{held:?}");
}

/// Two springs of unequal stiffness hold the weight: each gives by the torque about its own axis.
#[test]
fn servos_sag_about_their_own_axes() {
    for case in 0..30 {
        let mut draw = Draw::new(0x904, case);
        let (pair, arm) = (PAIRS[case as usize % 3], draw.direction() * 0.5);
        let gravity = draw.direction() * G;
        let start = [0, 1].map(|_| draw.between(-2.5, 2.5));
        let mut cross = Cross::new(&mut draw, gravity, pair, start, arm);
        let stiffness = [0, 1].map(|_| draw.log_between(60.0, 600.0));
        let target = start.map(|angle| angle + draw.between(-0.4, 0.4));
        let drives = [0, 1].map(|angle| {
            let servo = Drive::position(rotation(pair[angle]), target[angle] as Real);
            servo.with_stiffness(stiffness[angle] as Real, 10.0)
        });
        cross.rig.world.insert_one(cross.joint, Drives(drives.to_vec())).unwrap();
        cross.rig.run_to(12.0);
        let weight = cross.weight_torque();
        for (angle, (value, axis)) in cross.angles().into_iter().zip(cross.axes()).enumerate() {
            let expected = target[angle] + weight.dot(axis) / stiffness[angle];
            let off = apart(value, expected).abs();
            assert!(off < by_precision(1e-5, 1e-8), "{pair:?}, angle {angle}: {value} of {expected}");
        }
    }
}

/// A rigid servo of each angle takes it there; then motors turn each at its own speed for two
/// seconds, through right angles and half turns: to the second order in the substep what is a
/// sphere, and else to what gyroscopic torques change the speed by in half a substep.
#[test]
fn servos_and_motors_move_each_angle_alone() {
    for case in 0..30 {
        let mut draw = Draw::new(0x905, case);
        let is_sphere = case % 2 == 0;
        let (pair, arm) = (PAIRS[case as usize % 3], draw.direction() * if is_sphere { 0.0 } else { 0.5 });
        let gravity = draw.direction() * G;
        let mut cross = Cross::new(&mut draw, gravity, pair, [0.0; 2], arm);
        if is_sphere {
            cross.rig.world.insert_one(cross.it, Inertia::new(DVec3::splat(0.4)).unwrap()).unwrap();
        }
        let target = [0, 1].map(|_| draw.between(-3.0, 3.0));
        let servo = |angle: usize| Drive::position(rotation(pair[angle]), target[angle] as Real);
        cross.rig.world.insert_one(cross.joint, Drives(vec![servo(0), servo(1)])).unwrap();
        cross.rig.run_to(1.0);
        let start = cross.angles();
        for (value, target) in start.into_iter().zip(target) {
            assert!((value - target).abs() < by_precision(2e-5, 1e-6), "{pair:?}: {value} of {target}");
        }
        let rates = [0, 1].map(|_| draw.between(-2.0, 2.0));
        let motor = |angle: usize| Drive::velocity(rotation(pair[angle]), rates[angle] as Real);
        cross.rig.world.insert_one(cross.joint, Drives(vec![motor(0), motor(1)])).unwrap();
        cross.rig.run_to(3.0);
        let turn = rates[0].hypot(rates[1]) * f64::from(cross.rig.simulation.settings().contact_substep());
        let order = if is_sphere { turn * turn } else { 0.5 * turn };
        let most = order * rates[0].hypot(rates[1]) * 2.0 + by_precision(2e-5, 0.0);
        for (angle, value) in cross.angles().into_iter().enumerate() {
            let off = apart(value, start[angle] + 2.0 * rates[angle]).abs();
            assert!(off < most, "{pair:?}, angle {angle}: off by {off:e} of {most:e} at {rates:?}");
        }
    }
}

/// Turning about one axis, which is a principal one, at any angle of the other if that is the
/// first: it slows by that axis's friction over the moment, and then stands.
#[test]
fn friction_slows_the_angle_it_is_of() {
    let moments = DVec3::new(0.3, 0.4, 0.5);
    for (pair, angle, way) in PAIRS.into_iter().flat_map(|pair| [(pair, 0, 3.0), (pair, 1, 3.0), (pair, 1, -3.0)]) {
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
        let ground = rig.ground();
        let start = if angle == 0 { [0.0; 2] } else { [0.7, 0.0] };
        let it = rig.spawn(turned_to(body(2.0, moments, ORIGIN), bent(pair, start)));
        let joint = rig.join(universal(ground, it, pair));
        let mut cross = Cross { rig, it, joint, pair };
        cross.turn([way * f64::from(1 - angle), way * f64::from(angle)]);
        let torques = [0.5, 0.8];
        let mut friction = JointFriction::default();
        [0, 1].into_iter().for_each(|angle| friction.max[3 + pair[angle]] = torques[angle] as Real);
        cross.rig.world.insert_one(joint, friction).unwrap();
        let angle = angle as usize;
        let slows = torques[angle] / moments[pair[angle]];
        for step in 1..240 {
            cross.rig.step();
            let speed = cross.rig.angular_velocity(it).dot(cross.axes()[angle]);
            let expected = (way.abs() - slows * f64::from(step) / 60.0).max(0.0) * way.signum();
            assert!((speed - expected).abs() < 2e-4, "{pair:?}, angle {angle}: {speed} of {expected}");
        }
        let other = cross.angles()[1 - angle];
        assert!((other - start[1 - angle]).abs() < 1e-5, "{pair:?}, angle {angle}: the other is {other}");
    }
}
