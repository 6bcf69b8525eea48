//! Promise: a solver that has solved the steps before gives the bits of one that begins with this
//! step, whatever changed in between: bodies, materials, locked axes, joints.
//!
//! Why: contacts and joints stay laid out in their blocks while the list of them is the same. It
//! fails where anything that a layout follows from is left out of that comparison, or where a block
//! is read before this step has written what is read.

use hecs::{Entity, World};
use tumble::math::Vec3;
use tumble::prelude::*;
use tumble::{Axes, Collider, JointSolver, LockedAxes, Material, Shape};
use tumble_tests::touching::{collider, ground, spawn};
use tumble_tests::{Draw, cases, hash, real, vec3};

const STREAM: u64 = 0x1a_70_07;

fn material(draw: &mut Draw) -> Material {
    let mut material = Material::new(real(draw.between(0.2, 0.9)), 0.0);
    if draw.often(0.2) {
        material = material.with_restitution(0.4);
    }
    if draw.often(0.2) {
        material = material.with_rolling_resistance(0.01);
    }
    if draw.often(0.2) {
        material = material.with_surface_velocity(Vec3::X);
    }
    material
}

/// A box or a ball that falls on the others.
fn fall(world: &mut World, draw: &mut Draw, id: u64) -> Entity {
    let half = real(draw.log_between(0.1, 0.5));
    let shape = if draw.often(0.5) { Shape::sphere(half) } else { Shape::cuboid([half; 3].map(f64::from)) };
    let at = draw.vector(1.0) + glam::DVec3::Y * draw.between(1.5, 3.0);
    let body = RigidBody::new(shape.clone()).mass(draw.log_between(0.5, 20.0)).position(vec3(at)).id(BodyId(id));
    let collider = collider(&shape).with_material(material(draw)).unwrap();
    spawn(world, body, collider)
}

/// Joins two bodies where they are by a ball.
fn join(world: &mut World, [a, b]: [Entity; 2]) {
    let [p, q] = [a, b].map(|body| *world.get::<&Pose>(body).unwrap());
    let middle = (p.position + q.position) * 0.5;
    let joint = Joint::ball(a, b).at_point(world, middle).unwrap();
    world.spawn((joint,));
}

/// Changes something now and then.
fn change(world: &mut World, draw: &mut Draw, bodies: &mut Vec<Entity>, step: u64) {
    let which = (draw.between(0.0, bodies.len() as f64) as usize).min(bodies.len() - 1);
    match draw.between(0.0, 40.0) as u32 {
        0 if bodies.len() > 4 => world.despawn(bodies.swap_remove(which)).unwrap(),
        1 => bodies.push(fall(world, draw, 1000 + step)),
        2 => {
            let now = material(draw);
            let known = Collider::clone(&world.get::<&Collider>(bodies[which]).unwrap());
            let changed = known.with_material(now).unwrap();
            world.insert_one(bodies[which], changed).unwrap();
        }
        3 => {
            world.insert_one(bodies[which], LockedAxes(Axes::LINEAR_X | Axes::ANGULAR_Z)).unwrap();
        }
        4 => drop(world.remove_one::<LockedAxes>(bodies[which])),
        5 if which > 0 => join(world, [bodies[which - 1], bodies[which]]),
        _ => {}
    }
}

#[test]
fn what_was_laid_out_before_changes_no_bit() {
    for case in 0..u64::from(cases(16)) {
        let draw = &mut Draw::new(STREAM, case);
        let mut world = World::new();
        ground(&mut world, Material::default(), tumble::math::Quat::IDENTITY);
        let count = draw.between(3.0, 40.0) as u64;
        let mut bodies: Vec<Entity> = (0..count).map(|id| fall(&mut world, draw, 1 + id)).collect();
        let joints = if case % 2 == 0 { JointSolver::Passes } else { JointSolver::Auto };
        let settings = Settings::default().with_joint_solver(joints);
        let mut simulation = Simulation::new(settings).unwrap();
        let mut kept = 0;
        for step in 0..120 {
            change(&mut world, draw, &mut bodies, step);
            let before = simulation.snapshot(&world).unwrap();
            let contacts = simulation.contacts().count();
            simulation.step(&mut world);
            let went_on = hash(&world);
            kept += u32::from(contacts > 0 && simulation.contacts().count() == contacts);
            let mut other = Simulation::new(settings).unwrap();
            other.restore(&before, &mut world).unwrap();
            other.step(&mut world);
            assert_eq!(hash(&world), went_on, "case {case}, step {step}");
        }
        assert!(kept > 10, "contacts are the same from step to step now and then, {kept}");
    }
}
