//! Promise: what hangs on limits comes to rest where statics say, and the joints carry that: a rod
//! in a round or elliptic cone in any direction, where its weight has no torque along the bound; an
//! arm of ten links, each on a bound of its hinge, as the same arm welded to one body.
//!
//! Why: a direction in which a cone's equation and a plain angle agree is one of its axes only. It
//! fails if the way back into a cone is not square to its bound, if half angles are taken about the
//! wrong axes, or if a bound far up an arm carries what is not its own.

use crate::jointed::*;
use glam::{DQuat, DVec3};
use hecs::Entity;
use tumble::math::Real;
use tumble::{Axes, Cone, Damping, Gain, Joint, JointLoad, Limit, Limits, weld};
use tumble_tests::references::real_quat;
use tumble_tests::{Draw, by_precision, dvec3};

/// The x axis on the bound of a cone, by a parameter that goes round it, along the first frame's
/// axes: an ellipse in the projection from the opposite pole.
fn bound(half_angles: [f64; 2], round: f64) -> DVec3 {
    let [about_y, about_z] = half_angles.map(|angle| (0.5 * angle).tan());
    // A rotation about y moves x along z.
    let (y, z) = (about_z * round.cos(), about_y * round.sin());
    let square = y * y + z * z;
    DVec3::new(1.0 - square, 2.0 * y, 2.0 * z) / (1.0 + square)
}

/// One on the bound, more outside, and the parameter there.
fn out_of_cone(half_angles: [f64; 2], x: DVec3) -> (f64, f64) {
    let [about_y, about_z] = half_angles.map(|angle| (0.5 * angle).tan());
    let (y, z) = (x.y / (1.0 + x.x) / about_z, x.z / (1.0 + x.x) / about_y);
    (y.hypot(z), z.atan2(y))
}

/// The place near a parameter where the bound is lowest.
fn lowest(half_angles: [f64; 2], down: DVec3, near: f64) -> DVec3 {
    let (mut from, mut to) = (near - 0.2, near + 0.2);
    for _ in 0..100 {
        let thirds = [from + (to - from) / 3.0, to - (to - from) / 3.0];
        let [a, b] = thirds.map(|round| bound(half_angles, round).dot(down));
        if a < b { from = thirds[0] } else { to = thirds[1] }
    }
    bound(half_angles, 0.5 * (from + to))
}

/// A rod of 3 kg and 2 m that fell into a cone, damped till it rests and then left alone.
#[test]
fn a_rod_rests_in_a_cone_where_its_weight_is_lowest() {
    let (mut on_bound, mut inside, mut worst) = (0, 0, 0.0_f64);
    for case in 0..40 {
        let mut draw = Draw::new(0xA01, case);
        let first = draw.between(0.3, 1.4);
        let half_angles = [first, if case % 2 == 0 { first } else { first * draw.between(0.6, 1.6) }];
        let mut rig = Rig::new(draw.direction() * G, 1.0 / 60.0, 4);
        let ground = rig.ground();
        let (of_cone, twisted) = (draw.orientation(), DQuat::from_rotation_x(draw.between(-3.0, 3.0)));
        let start = of_cone * DQuat::from_rotation_y(draw.between(-0.2, 0.2)) * twisted;
        let arm = DVec3::X;
        let it = rig.spawn(rod(3.0, 2.0, start * arm).orientation(real_quat(start)));
        let joint = Joint::ball(ground, it).with_frames(frame(ORIGIN, of_cone), frame(-arm, DQuat::IDENTITY));
        let joint = rig.join(joint);
        let cone = Cone { half_angles: half_angles.map(|angle| angle as Real), gain: Gain::Rigid };
        rig.world.insert_one(joint, Limits { cone: Some(cone), ..Limits::default() }).unwrap();
        rig.world.insert_one(it, Damping { linear: 2.0, angular: 2.0 }).unwrap();
        rig.run_to(20.0);
        rig.world.remove_one::<Damping>(it).unwrap();
        rig.run_to(20.2);
        let gravity = dvec3(rig.simulation.settings().gravity);
        let down = of_cone.conjugate() * gravity.normalize();
        let x = of_cone.conjugate() * (rig.orientation(it) * DVec3::X);
        let (out, round) = out_of_cone(half_angles, x);
        let off = if out_of_cone(half_angles, down).0 < 1.0 {
            inside += 1;
            (x - down).length()
        } else {
            on_bound += 1;
            assert!((out - 1.0).abs() < by_precision(1e-5, 1e-6), "case {case}: {out}");
            (x - lowest(half_angles, down, round)).length()
        };
        worst = worst.max(off);
        assert!(off < by_precision(3e-6, 6e-8), "case {case}: off by {off:e}");
        let weight = rig.position(it).cross(gravity * 3.0);
        let unheld = (dvec3(rig.load(joint).torque) + weight).length() / (3.0 * G);
        assert!(unheld < by_precision(2e-6, 6e-8), "case {case}: {unheld:e} of the torque");
    }
    println!("{on_bound} on the bound, {inside} inside, off by {worst:.1e} rad at most");
    assert!(on_bound > 20 && inside > 5);
}

/// Ten links along a line that is bent at random, the last a hundred times as heavy as others.
struct Arm {
    /// Mass \[kg\], middle \[m\] and orientation.
    links: Vec<(f64, DVec3, DQuat)>,
    /// Where the hinges are, and about what.
    hinges: Vec<(DVec3, DVec3)>,
}

impl Arm {
    fn new(draw: &mut Draw) -> Self {
        let (mut links, mut hinges, mut end) = (Vec::new(), Vec::new(), ORIGIN);
        let ahead = draw.direction();
        for link in 0..10 {
            let along = (ahead + draw.vector(0.6)).normalize();
            let (mass, length) = (if link == 9 { 100.0 } else { draw.between(0.5, 2.0) }, draw.between(0.1, 0.3));
            hinges.push((end, draw.direction()));
            links.push((mass, end + along * 0.5 * length, DQuat::from_rotation_arc(DVec3::X, along)));
            end += along * length;
        }
        Self { links, hinges }
    }

    fn bodies(&self) -> impl Iterator<Item = tumble::RigidBody> + '_ {
        self.links.iter().map(|(mass, center, q)| rod(*mass, 0.2, *center).orientation(real_quat(*q)))
    }

    /// What a hinge has to carry: the weight of all links from there on, and its torque.
    fn carried(&self, hinge: usize) -> [DVec3; 2] {
        let of_link = |(mass, center, _): &(f64, DVec3, DQuat)| {
            let force = DVec3::Y * G * *mass;
            [force, (*center - self.hinges[hinge].0).cross(force)]
        };
        self.links[hinge..].iter().map(of_link).fold([ORIGIN; 2], |sum, it| [sum[0] + it[0], sum[1] + it[1]])
    }

    /// A range that begins or ends where a hinge is, as its load wants.
    fn limits(&self, hinge: usize) -> Limits {
        let pushes_up = self.carried(hinge)[1].dot(self.hinges[hinge].1) > 0.0;
        let limit = if pushes_up { Limit::new(0.0, 1.0) } else { Limit::new(-1.0, 0.0) };
        Limits::along(Axes::ANGULAR_X, limit)
    }

    /// A hinge on its limit.
    fn hang(&self, rig: &mut Rig, hinge: usize, ends: [Entity; 2]) -> Entity {
        let (point, axis) = self.hinges[hinge];
        let joint = rig.join_at(Joint::hinge(ends[0], ends[1]), point, axis);
        rig.world.insert_one(joint, self.limits(hinge)).unwrap();
        joint
    }
}

fn off(load: JointLoad, [force, torque]: [DVec3; 2]) -> [f64; 2] {
    [(dvec3(load.force) - force).length() / force.length(), (dvec3(load.torque) - torque).length() / torque.length()]
}

#[test]
fn an_arm_on_its_limits_carries_what_one_body_does() {
    for case in 0..12 {
        let arm = Arm::new(&mut Draw::new(0xA02, case));
        let mut links = Rig::new(down(), 1.0 / 60.0, 4);
        let mut before = links.ground();
        let (mut joints, mut bodies) = (Vec::new(), Vec::new());
        for (hinge, body) in arm.bodies().enumerate() {
            let this = links.spawn(body);
            joints.push(arm.hang(&mut links, hinge, [before, this]));
            bodies.push(this);
            before = this;
        }
        let mut whole = Rig::new(down(), 1.0 / 60.0, 4);
        let ground = whole.ground();
        let it = weld(&links.world, &bodies).unwrap().spawn(&mut whole.world);
        let root = arm.hang(&mut whole, 0, [ground, it]);
        let start = links.position(before);
        let mut moved = 0.0_f64;
        for rig in [&mut links, &mut whole] {
            rig.run_to(3.0);
        }
        let most = by_precision(5e-6, 1e-9);
        for _ in 0..60 {
            links.step();
            whole.step();
            moved = moved.max((links.position(before) - start).length());
            let of_whole = whole.load(root);
            let [force, torque] = off(links.load(joints[0]), [dvec3(of_whole.force), dvec3(of_whole.torque)]);
            assert!(force < most && torque < most, "case {case}: {force:e}, {torque:e} off the whole's");
            for (hinge, joint) in joints.iter().enumerate() {
                let [force, torque] = off(links.load(*joint), arm.carried(hinge));
                assert!(force < most && torque < most, "case {case}, hinge {hinge}: {force:e}, {torque:e}");
            }
        }
        assert!(moved < by_precision(2e-6, 1e-10), "case {case}: {moved:e} m");
    }
}
