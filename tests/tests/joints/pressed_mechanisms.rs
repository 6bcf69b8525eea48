//! Promise: bodies on joints that a kinematic body presses against the ground, and bodies that a
//! hand presses against it, are not shot out, and not thrown when the joint goes. A row that is too
//! long for the gap that it lies in stays there.
//!
//! Why: lifts, doors, crushers and the mouse of an editor do this. It fails if contacts that
//! contradict each other are solved as if they did not, or if the impulses that they had are the
//! beginning of the next step when what they held against is gone.

use glam::{DQuat, DVec3};
use tumble::math::Quat;
use tumble::{Joint, Material, RigidBody, Shape};
use tumble_tests::touching::{collider, ground, surfaced};
use tumble_tests::{Draw, cases};

use crate::direct_contacts::cuboid;
use crate::jointed::*;

const KINDS: [fn(hecs::Entity, hecs::Entity) -> Joint; 4] = [Joint::ball, Joint::hinge, Joint::universal, Joint::fixed];

/// A size \[m\] at random, and a world with ground, of 30 to 240 steps a second.
fn rig_on_ground(draw: &mut Draw) -> (f64, Rig) {
    let size = draw.log_between(0.05, 5.0);
    let mut rig = Rig::new(down(), 1.0 / draw.log_between(30.0, 240.0), 1 << draw.between(1.0, 4.99) as u32);
    ground(&mut rig.world, Material::default(), Quat::IDENTITY);
    (size, rig)
}

/// Two boxes on a joint, on the ground, and a slab that comes down on them. Overlap is pushed out
/// at 3 m/s at most, and a lever makes twice that of it.
#[test]
fn what_is_pressed_is_not_shot_out() {
    for case in 0..u64::from(cases(160)) {
        let mut draw = Draw::new(0x9E55, case);
        let (size, mut rig) = rig_on_ground(&mut draw);
        let halves = [0, 1].map(|_| [0; 3].map(|_| draw.between(0.1, 0.5) * size)).map(DVec3::from);
        let boxes = [0, 1].map(|i| {
            let half = halves[i];
            let at = DVec3::new(if i == 0 { -half.x } else { 1.02 * half.x }, half.y, 0.0);
            let turn = DQuat::from_rotation_y(if i == 0 { 0.0 } else { draw.between(-0.3, 0.3) });
            cuboid(&mut rig, half, 4000.0 * half.element_product(), at, turn, Material::default())
        });
        let at = DVec3::Y * halves[0].y.min(halves[1].y);
        rig.join_at(KINDS[case as usize % 4](boxes[0], boxes[1]), at, draw.direction());
        let top = 2.0 * halves[0].y.max(halves[1].y);
        let speed = (G * size).sqrt() * draw.log_between(0.05, 1.0);
        let slab = Shape::cuboid([5.0 * size, 0.1 * size, 5.0 * size]);
        let press = RigidBody::new(slab.clone()).kinematic().position(real(DVec3::Y * (top + 0.2 * size)));
        let press = press.linear_velocity(real(DVec3::Y * -speed)).build().unwrap();
        press.spawn_with(&mut rig.world, (surfaced(collider(&slab), Material::default()),));
        // Until it is halfway down.
        let end = (0.5 * top + 0.1 * size) / speed;
        let mut fastest = 0.0_f64;
        while rig.simulation.time() < end {
            rig.step();
            fastest = boxes.iter().map(|body| rig.velocity(*body).length()).fold(fastest, f64::max);
        }
        let most = 2.0 * (3.0 + speed + (G * size).sqrt());
        println!("case {case}: {:.3} of the most", fastest / most);
        assert!(fastest < most, "case {case}, {size} m at {speed} m/s: {fastest} m/s");
    }
}

/// A box that a hand takes by a point of it and presses down, until the joint is despawned.
#[test]
fn what_a_hand_presses_down_is_not_thrown_when_it_lets_go() {
    for case in 0..u64::from(cases(120)) {
        let mut draw = Draw::new(0x9E56, case);
        let (size, mut rig) = rig_on_ground(&mut draw);
        let half = DVec3::from([0; 3].map(|_| draw.between(0.2, 0.5) * size));
        let body = cuboid(
            &mut rig,
            half,
            draw.log_between(0.1, 100.0),
            DVec3::Y * half.y,
            DQuat::IDENTITY,
            Material::default(),
        );
        let at = DVec3::Y * half.y + draw.direction() * (draw.between(0.0, 1.0) * half.min_element());
        let speed = draw.log_between(0.02, 0.3) * size;
        let hand = RigidBody::new(Shape::Point).kinematic().position(real(at)).linear_velocity(real(DVec3::Y * -speed));
        let hand = rig.spawn(hand);
        let joint = rig.join_at(KINDS[case as usize % 4](hand, body), at, draw.direction());
        let fastest = |rig: &mut Rig, time: f64| {
            let (end, mut fastest) = (rig.simulation.time() + time, 0.0_f64);
            while rig.simulation.time() < end {
                rig.step();
                fastest = fastest.max(rig.velocity(body).length());
            }
            fastest
        };
        let held = fastest(&mut rig, 1.5);
        rig.world.despawn(joint).unwrap();
        let thrown = fastest(&mut rig, 0.3);
        let most = 1.5 * (held + 3.0);
        println!("case {case}: {:.3} of the most", thrown / most);
        assert!(thrown < most, "case {case}, {size} m, held at {held} m/s: {thrown} m/s");
    }
}

/// Boxes on joints, at rest on the ground between two walls that are closer than they are long.
#[test]
fn rows_too_long_for_their_gap_do_not_jump() {
    for case in 0..u64::from(cases(100)) {
        let mut draw = Draw::new(0x9E57, case);
        let (size, mut rig) = rig_on_ground(&mut draw);
        let count = 2 + case as usize % 3;
        let half = DVec3::new(0.4, draw.between(0.15, 0.4), 0.3) * size;
        let length = 2.0 * half.x * count as f64;
        let (mut boxes, mut weight) = (Vec::new(), 0.0);
        for number in 0..count {
            let mass = draw.log_between(1.0, 100.0);
            let left = 2.0 * half.x * number as f64 - 0.5 * length;
            let at = DVec3::new(left + half.x, half.y, 0.0);
            let next = cuboid(&mut rig, half, mass, at, DQuat::IDENTITY, Material::default());
            if let Some(last) = boxes.last() {
                let kind = KINDS[draw.between(0.0, 3.99) as usize];
                rig.join_at(kind(*last, next), DVec3::new(left, half.y, 0.0), DVec3::Z);
            }
            boxes.push(next);
            weight += mass * G;
        }
        let overlap = draw.log_between(1e-3, 0.05) * size;
        for side in [-1.0, 1.0] {
            let shape = Shape::cuboid(DVec3::new(0.5, 3.0, 3.0) * size);
            let at = DVec3::X * side * (0.5 * (length - overlap) + 0.5 * size);
            let wall = RigidBody::new(shape.clone()).fixed().position(real(at)).build().unwrap();
            wall.spawn_with(&mut rig.world, (surfaced(collider(&shape), Material::default()),));
        }
        // What overlaps at the start is pushed out meanwhile.
        rig.run_to(1.0);
        let (mut before, mut most) = (rig.energy(), 0.0_f64);
        while rig.simulation.time() < 5.0 {
            rig.step();
            let energy = rig.energy();
            most = most.max((energy - before) / (weight * size));
            before = energy;
        }
        println!("case {case}: {most:e}");
        assert!(most < 0.05, "case {case}, {size} m, overlap {overlap} m: {most}");
    }
}
