//! Promise: bodies on joints move as reference runs say: those of MSC ADAMS for one joint of every
//! kind, with distances and springs, of a double pendulum, and of tops on a ball joint; and a
//! pendulum keeps its energy as the IFToMM benchmark asks.
//!
//! Why: a closed form is of one degree of freedom mostly; these have fast spin, chaos and all kinds
//! of joints, and others have published how well they do. It fails if a row or a frame is wrong for
//! one kind of joint, or where gyroscopic terms and the joint's impulses are split at wrong times.

use crate::jointed::*;
use glam::{DQuat, DVec3};
use hecs::Entity;
use serde_json::Value;
use tumble::{Axes, Drive, Drives, Joint, Limits, RigidBody};
use tumble_tests::references::{Pinned, number, parse, quaternion, real_quat, vector};
use tumble_tests::{DOUBLE, by_precision};

fn mechanisms() -> Value {
    parse(include_str!("../../data/joints/mechanisms.json"))
}

fn rows(value: &Value) -> Vec<Vec<f64>> {
    let of_row = |row: &Value| row.as_array().unwrap().iter().map(number).collect();
    value.as_array().unwrap().iter().map(of_row).collect()
}

/// A joint of a kind between the ground and a body, with how its frames are turned in those of the
/// file, of which z is the axis of hinge, slider and sleeve.
fn of_kind(kind: &str, ground: Entity, it: Entity) -> (Joint, DQuat) {
    let turn = DQuat::from_rotation_arc(DVec3::X, DVec3::Z);
    let in_plane = Axes::LINEAR_X | Axes::LINEAR_Y | Axes::ANGULAR;
    match kind {
        "revolute" | "torsion_spring" => (Joint::hinge(ground, it), turn),
        "prismatic" => (Joint::slider(ground, it), turn),
        "cylindrical" => (Joint::cylinder(ground, it), turn),
        "universal" => (Joint::universal(ground, it), DQuat::IDENTITY),
        "spherical" => (Joint::ball(ground, it), DQuat::IDENTITY),
        // A link without mass that turns about z.
        "revolute_spherical" => (Joint::free_along(ground, it, in_plane), DQuat::IDENTITY),
        _ => (Joint::free(ground, it), DQuat::IDENTITY),
    }
}

/// Root mean square of the distance between a body on a joint of a kind and ADAMS's, in substeps of
/// 1/60 s, up to a time \[s\]; and half of what Chrono's own tests allow \[m\].
fn off_from_adams(kind: &str, substeps: u32, until: f64) -> (f64, f64) {
    let file = parse(include_str!("../../data/joints/adams.json"));
    let case = &file[kind];
    let rows = rows(&case["rows"]);
    let orientation = quaternion(&case["frame_q"]);
    let mut rig = Rig::new(DVec3::NEG_Z * number(&file["gravity"]), 1.0 / 60.0, substeps);
    let ground = rig.ground();
    let center = DVec3::new(rows[0][1], rows[0][2], rows[0][3]);
    let it = body(1.0, vector(&case["inertia"]), center).orientation(real_quat(orientation));
    let it = rig.spawn(it);
    let (joint, turn) = of_kind(kind, ground, it);
    let point = case.get("point").map_or(ORIGIN, vector);
    let anchor = orientation.conjugate() * (point - center);
    let joint = rig.join(joint.with_frames(frame(ORIGIN, orientation * turn), frame(anchor, turn)));
    match kind {
        "distance" | "revolute_spherical" => rig.world.insert_one(joint, Limits::rod(2.0)).unwrap(),
        "torsion_spring" => {
            let spring = Drive::position(Axes::ANGULAR_X, 0.0).with_stiffness(200.0, 10.0);
            rig.world.insert_one(joint, Drives::from(spring)).unwrap();
        }
        "spring" => {
            let spring = Drive::position(Axes::LINEAR, 0.0).with_stiffness(10.0, 0.5);
            rig.world.insert_one(joint, Drives::from(spring)).unwrap();
        }
        _ => {}
    }
    let (mut squares, mut count) = (0.0, 0.0);
    for row in rows.iter().filter(|row| row[0] <= until) {
        rig.run_to(row[0]);
        squares += (rig.position(it) - DVec3::new(row[1], row[2], row[3])).length_squared();
        count += 1.0;
    }
    let (error, allowed) = (f64::sqrt(squares / count), 0.5 * number(&case["chrono_tolerance"]));
    println!("{kind}, {substeps} substeps, {until} s: {error:.1e} m, allowed {allowed:.0e}");
    (error, allowed)
}

/// ADAMS is off by up to 8e-4 m itself.
#[test]
fn bodies_on_one_joint_move_as_in_adams() {
    let kinds = ["revolute", "spherical", "universal", "prismatic", "cylindrical"];
    for kind in kinds.into_iter().chain(["distance", "torsion_spring", "spring"]) {
        let (error, allowed) = off_from_adams(kind, 4, 5.0);
        assert!(error <= allowed, "{kind}: {error:e}");
    }
}

/// From 0.5 s on its body turns ever faster about a small moment, and the default substeps lose its
/// path: all five seconds take 128.
#[test]
fn a_body_on_a_turning_link_moves_as_in_adams() {
    for (substeps, until) in [(4, 0.5), (128, 5.0)] {
        let (error, allowed) = off_from_adams("revolute_spherical", substeps, until);
        assert!(error <= allowed, "{substeps}: {error:e}");
    }
    println!("{:?}", off_from_adams("revolute_spherical", 4, 5.0));
}

/// The largest distance of the tip from the reference in the first second \[m\].
fn double_rod(substeps: u32) -> f64 {
    let tips = rows(&mechanisms()["double_rod_pendulum"]["tips"]);
    let mut rig = Rig::new(down(), 1.0 / 60.0, substeps);
    let ground = rig.ground();
    let rods = [0.5, 1.5].map(|x| rig.spawn(rod(1.0, 1.0, DVec3::X * x)));
    rig.join_at(Joint::hinge(ground, rods[0]), ORIGIN, DVec3::Z);
    rig.join_at(Joint::hinge(rods[0], rods[1]), DVec3::X, DVec3::Z);
    let mut worst = 0.0_f64;
    for row in tips.iter().filter(|row| row[0] <= 1.0) {
        rig.run_to(row[0]);
        let tip = rig.position(rods[1]) + rig.orientation(rods[1]) * (DVec3::X * 0.5);
        worst = worst.max((tip - DVec3::new(row[1], row[2], 0.0)).length());
    }
    worst
}

#[test]
fn the_double_pendulum_has_its_tip_where_it_should() {
    let errors = [4, 8].map(double_rod);
    println!("tip off by {:.1e}, {:.1e} m at 4, 8 substeps", errors[0], errors[1]);
    assert!(errors[0] <= 3e-4, "{errors:?}");
    assert!(!DOUBLE || (errors[0] / errors[1] - 4.0).abs() <= 0.3, "{errors:?}");
}

/// The benchmark's link has no mass: a point of 1 kg with the least inertia that a load of 3 m g
/// leaves alone at this substep, and nothing about its joint.
#[test]
fn the_simple_pendulum_keeps_its_energy() {
    let file = mechanisms();
    let case = &file["simple_pendulum"];
    let mut rig = Rig::new(down(), 1.0 / 60.0, 16);
    let ground = rig.ground();
    let moment = 1e-4;
    let bob = rig.spawn(body(1.0, DVec3::splat(moment), DVec3::NEG_X));
    rig.join_at(Joint::hinge(ground, bob), ORIGIN, DVec3::Z);
    let (mut energy, mut place) = (0.0_f64, 0.0_f64);
    for row in rows(&case["samples"]) {
        while rig.simulation.time() + 1e-3 < row[0] {
            rig.step();
            energy = energy.max(rig.energy().abs());
        }
        place = place.max((rig.position(bob) - DVec3::new(row[1], row[2], 0.0)).length());
    }
    println!("energy off by {energy:.1e} J, place by {place:.1e} m");
    assert!(energy <= number(&case["energy_criterion"]), "{energy:e}");
    // The moment slows it by its half: 5e-5 of 44 m.
    assert!(place <= 4e-3, "{place:e}");
}

/// A top of `tops.json` on a ball joint.
fn top(name: &str, dt: f64, substeps: u32) -> (Rig, hecs::Entity, Pinned) {
    let pinned = Pinned::read(name);
    let mut rig = Rig::new(DVec3::NEG_Z * number(&pinned.file["gravity"]), dt, substeps);
    let ground = rig.ground();
    let mass = number(&pinned.file["mass"]);
    let (arm, orientation) = (pinned.center, pinned.orientation);
    // From the pivot to the centre of mass.
    let moments = pinned.inertia - mass * (DVec3::splat(arm.length_squared()) - arm * arm);
    let (center, angular) = (orientation * arm, orientation * pinned.angular_velocity);
    let it: RigidBody = turning_about(body(mass, moments, center), center, ORIGIN, angular);
    let it = rig.spawn(it.orientation(real_quat(orientation)));
    rig.join(Joint::ball(ground, it).with_frames(frame(ORIGIN, DQuat::IDENTITY), frame(-arm, DQuat::IDENTITY)));
    (rig, it, pinned)
}

/// At 150 rad/s, 37 mrad a substep; after two seconds the world's y component of the angular
/// velocity is that of EXUDYN and others.
#[test]
fn the_heavy_top_has_the_published_angular_velocity() {
    let errors = [4, 8].map(|substeps| {
        let (mut rig, it, pinned) = top("heavy_top", 1e-3, substeps);
        let mut gap = 0.0_f64;
        while rig.simulation.time() < 2.0 - 1e-4 {
            rig.step();
            gap = gap.max(rig.largest_gap());
        }
        let exact = vector(&pinned.file["checkpoints"][3]["angular_velocity_world"]);
        let error = (rig.angular_velocity(it) - exact).y.abs();
        println!("{substeps} substeps/ms: w_y(2) off by {error:.2e} rad/s, gaps {gap:.1e} m");
        assert!(gap <= by_precision(4e-6, 6e-9), "{gap:e}");
        error
    });
    assert!(errors[0] <= 1e-2, "{errors:?}");
    assert!(!DOUBLE || (errors[0] / errors[1] - 4.0).abs() <= 0.3, "{errors:?}");
}

/// Its centre goes round at the smaller root of the rate, at 30 degrees, for five seconds.
#[test]
fn lagranges_top_precesses_slowly() {
    let (mut rig, it, pinned) = top("lagrange_top", 1e-3, 1);
    let rate = number(&pinned.file["precession"]);
    let start = rig.position(it);
    let mut worst = 0.0_f64;
    for _ in 0..5000 {
        rig.step();
        let exact = DQuat::from_rotation_z(rate * rig.simulation.time()) * start;
        worst = worst.max((rig.position(it) - exact).length() / start.length());
    }
    println!("precession {rate:.4} rad/s: centre off by {worst:.1e} of its arm");
    assert!(worst <= 1.2e-3, "{worst:e}");
}
