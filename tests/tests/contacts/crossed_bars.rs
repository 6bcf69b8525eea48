//! Promise: bars that fall on each other come to rest where they cross: after sixty times a fall
//! by their length they have less than a thousandth of the energy of that fall, no contact is
//! deeper than a quarter of half their thickness and what a load of three presses a contact in, and
//! at no time is a contact listed twice.
//!
//! Why: where long bars cross at a small slope the normal that separates them most is that of two
//! edges, which alone has one point. On one point they rock, and from step to step it is another
//! pair of edges; what lay across two others was half through them after eight seconds. On rough
//! ground, contacts that were found along the way were there twice, and twice as stiff.

use hecs::{Entity, World};
use tumble::Material;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble_tests::touching::{collider, fixed_box, ground, spawn, surfaced};
use tumble_tests::{Draw, cases, quat, real};

const GRAVITY: f64 = 9.81;

/// How many contacts have the bodies, the normal and the points of another, to `near` \[m\].
fn listed_twice(simulation: &Simulation, near: Real) -> usize {
    let all: Vec<tumble::Contact> = simulation.contacts().collect();
    let is_same = |a: &tumble::Contact, b: &tumble::Contact| {
        let mut points = a.points().iter().zip(b.points());
        a.bodies == b.bodies
            && a.points().len() == b.points().len()
            && (a.normal - b.normal).length() < 1e-4
            && points.all(|(a, b)| (a.position - b.position).length() < near)
    };
    (1..all.len()).filter(|later| all[..*later].iter().any(|it| is_same(it, &all[*later]))).count()
}

/// Bumps of a tenth of half the length, in cells of three tenths of it.
fn rough_ground(world: &mut World, half: f64, material: Material, draw: &mut Draw) {
    let heights: Vec<f64> = (0..48 * 48).map(|_| draw.between(-0.1, 0.0) * half).collect();
    let field = Collider::height_field(&heights, 48, [0.3 * half; 2]).unwrap();
    spawn(world, RigidBody::new(Shape::Point).fixed(), surfaced(field, material));
}

/// Bars of 4 cm to 10 m, 3 to 60 times as long as thick, three of them above each other.
#[test]
fn bars_that_cross_come_to_rest() {
    let mut failures = Vec::new();
    for case in 0..u64::from(cases(120)) {
        let mut draw = Draw::new(0xBA25, case);
        let half = draw.log_between(0.02, 5.0);
        let thin = half / draw.log_between(3.0, 60.0);
        let wide = thin * if draw.often(0.5) { 1.0 } else { draw.log_between(1.0, 4.0) };
        let material = Material::new(real(draw.between(0.3, 0.9)), 0.0);
        let substeps = if draw.often(0.7) { 4 } else { 16 };
        let rate = draw.log_between(60.0, 240.0);
        let mut world = World::new();
        match case % 3 {
            0 => drop(ground(&mut world, material, Quat::IDENTITY)),
            1 => {
                let far = 8.0 * half;
                fixed_box(&mut world, [far; 3], (Vec3::NEG_Y * real(far), Quat::IDENTITY), material);
            }
            _ => rough_ground(&mut world, half, material, &mut draw),
        }
        let shape = Shape::cuboid([thin, half, wide]);
        let bars: Vec<Entity> = (0..3)
            .map(|i| {
                let at = Vec3::new(
                    real(draw.between(-0.3, 0.3) * half),
                    real((1.3 + 2.2 * f64::from(i)) * half),
                    real(draw.between(-0.3, 0.3) * half),
                );
                let body =
                    RigidBody::new(shape.clone()).density(500.0).position(at).orientation(quat(draw.orientation()));
                spawn(&mut world, body, surfaced(collider(&shape), material))
            })
            .collect();
        let settings = Settings::default().with_dt(real(1.0 / rate)).with_contact_substeps(substeps);
        let mut simulation = Simulation::new(settings).unwrap();
        let fall = (2.0 * half / GRAVITY).sqrt();
        let mut twice = 0;
        while simulation.time() < 60.0 * fall {
            simulation.step(&mut world);
            twice += listed_twice(&simulation, real(1e-4 * thin));
        }
        let weight = f64::from(world.get::<&Mass>(bars[0]).unwrap().kilograms()) * GRAVITY;
        let energy = simulation.totals(&world).kinetic() / (weight * half);
        let separations = simulation.contacts().flat_map(|contact| contact.points().to_vec());
        let deepest = separations.fold(0.0, |deepest: f64, point| deepest.max(-f64::from(point.separation)));
        // An eighth of a substep's rate, for each effective mass: a fourth of the mass at an end.
        let stiffness = (std::f64::consts::TAU * rate * f64::from(substeps) / 8.0).powi(2);
        let most = 0.25 * thin + 3.0 * 4.0 * GRAVITY / stiffness;
        let rests = energy < 1e-3 && deepest < most && twice == 0;
        if !rests {
            failures.push(format!(
                "case {case}: half {half:.3}, 1:{:.0}:{:.1}, {rate:.0} Hz, {substeps}: {energy:.4}, depth {:.2}, \
                 {twice} twice",
                half / thin,
                wide / thin,
                deepest / most
            ));
        }
    }
    assert!(failures.is_empty(), "{}:\n{}", failures.len(), failures.join("\n"));
}
