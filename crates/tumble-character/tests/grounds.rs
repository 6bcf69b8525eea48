//! Promise: on floors that are made of many pieces a character goes as on one, it stands on what
//! is thinner than itself, and it leaves a ledge without a hop.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]
#![allow(
    clippy::useless_conversion,
    clippy::unnecessary_cast,
    reason = "Real is f32 in one build and f64 in the other"
)]

mod shared;

use shared::{RATES, Stage};
use tumble::hecs::Entity;
use tumble::prelude::*;
use tumble_character::CharacterSettings;

/// The least and the most distance in a step, and whether it was on ground in all.
fn strides(stage: &mut Stage, hero: Entity, seconds: Real) -> (Real, Real, bool) {
    let mut last = stage.position(hero);
    let (mut least, mut most, mut grounded) = (Real::MAX, 0.0, true);
    for seen in stage.play(hero, seconds) {
        let stride = Vec3::new(seen.position.x - last.x, 0.0, seen.position.z - last.z).length();
        (least, most) = (least.min(stride), Real::max(most, stride));
        grounded &= seen.state.is_grounded();
        last = seen.position;
    }
    (least, most, grounded)
}

#[test]
fn speed_does_not_dip_on_tiles_and_meshes() {
    for rate in RATES {
        for kind in 0..3 {
            let mut stage = Stage::new(rate);
            match kind {
                // Boxes side by side.
                0 => {
                    for i in -20..20 {
                        for j in -20..20 {
                            let center = Vec3::new(i as Real * 0.5, -0.25, j as Real * 0.5);
                            stage.block(center, Vec3::new(0.25, 0.25, 0.25));
                        }
                    }
                }
                1 => {
                    let (vertices, triangles) = grid(41, 0.5, |_, _| 0.0);
                    stage.mesh(&vertices, &triangles);
                }
                _ => {
                    let collider = tumble::Collider::height_field(vec![0.0; 41 * 41], 41, [0.5, 0.5]).unwrap();
                    stage.world.spawn((Pose::default(), collider));
                }
            }
            let hero = stage.hero(Vec3::new(-6.0, 0.0, -5.0));
            stage.steer(hero, Vec3::new(4.0, 0.0, 2.7));
            stage.play(hero, 0.5);
            let (least, most, grounded) = strides(&mut stage, hero, 2.0);
            let wanted = Vec3::new(4.0, 0.0, 2.7).length() * stage.dt();
            let error = (least - wanted).abs().max((most - wanted).abs());
            assert!(grounded && error < 1e-3 * wanted + 2e-6, "{rate} Hz, kind {kind}: {least} to {most} for {wanted}");
        }
    }
}

/// A square grid of triangles about the origin.
fn grid(count: u32, spacing: Real, height: impl Fn(Real, Real) -> Real) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let at = |i: u32| (i as Real - (count - 1) as Real * 0.5) * spacing;
    let vertices = (0..count * count).map(|k| {
        let (x, z) = (at(k % count), at(k / count));
        Vec3::new(x, height(x, z), z)
    });
    let quad = |k: u32| {
        let (a, b, c, d) = (k, k + 1, k + count, k + count + 1);
        [[a, c, b], [b, c, d]]
    };
    let cells = (0..count * (count - 1)).filter(|k| k % count < count - 1);
    (vertices.collect(), cells.flat_map(quad).collect())
}

#[test]
fn it_walks_over_hills_without_leaving_them() {
    let hills = |x: Real, z: Real| 0.8 * (0.7 * x).sin() * (0.6 * z).cos();
    for rate in RATES {
        for kind in 0..2 {
            let mut stage = Stage::new(rate);
            let (vertices, triangles) = grid(81, 0.5, hills);
            if kind == 0 {
                stage.mesh(&vertices, &triangles);
            } else {
                let heights: Vec<f64> = vertices.iter().map(|it| f64::from(it.y)).collect();
                let collider = tumble::Collider::height_field(heights, 81, [0.5, 0.5]).unwrap();
                stage.world.spawn((Pose::default(), collider));
            }
            let hero = stage.hero(Vec3::new(-9.0, 1.2, -8.0));
            stage.play(hero, 1.0);
            stage.steer(hero, Vec3::new(3.0, 0.0, 2.5));
            stage.play(hero, 0.5);
            let (least, most, grounded) = strides(&mut stage, hero, 4.0);
            let wanted = Vec3::new(3.0, 0.0, 2.5).length() * stage.dt();
            assert!(grounded, "{rate} Hz, kind {kind}");
            let error = (least / wanted - 1.0).abs().max((most / wanted - 1.0).abs());
            assert!(error < 0.02, "{rate} Hz, kind {kind}: {least} to {most} for {wanted}");
        }
    }
}

#[test]
fn it_stands_still_on_seams_edges_beams_and_balls() {
    for kind in 0..4 {
        let mut stage = Stage::new(60);
        match kind {
            0 => {
                stage.block(Vec3::new(-1.0, -0.5, 0.0), Vec3::new(1.0, 0.5, 1.0));
                stage.block(Vec3::new(1.0, -0.5, 0.0), Vec3::new(1.0, 0.5, 1.0));
            }
            // The edge of a ledge, a tenth of a metre inside the radius.
            1 => drop(stage.block(Vec3::new(-1.1, -0.5, 0.0), Vec3::new(1.0, 0.5, 1.0))),
            // A beam.
            2 => drop(stage.block(Vec3::new(0.0, -0.5, 0.0), Vec3::new(0.03, 0.5, 3.0))),
            _ => {
                let ball = RigidBody::new(Shape::sphere(0.5)).fixed().position(Vec3::Y * -0.5);
                ball.build().unwrap().spawn(&mut stage.world);
            }
        }
        let hero = stage.hero(Vec3::Y * 0.3);
        stage.play(hero, 1.0);
        let before = stage.position(hero);
        let seen = stage.play(hero, 5.0);
        let most = seen.iter().map(|it| (it.position - before).length()).fold(0.0, Real::max);
        assert!(seen.iter().all(|it| it.state.is_grounded()), "kind {kind}: {:?}", seen.last());
        assert!(most < 1e-4, "kind {kind}: moves {most}");
    }
}

/// Over the edge the round foot goes down as on an arc, and then it falls from rest.
#[test]
fn it_leaves_a_ledge_without_a_hop() {
    for rate in RATES {
        for speed in [1.0, 3.0, 8.0] {
            let mut stage = Stage::with_ground(rate);
            stage.block(Vec3::new(-10.0, 2.0, 0.0), Vec3::new(10.0, 2.0, 3.0));
            let hero = stage.hero(Vec3::new(-3.0, 4.0, 0.0));
            stage.play(hero, 0.2);
            stage.steer(hero, Vec3::X * speed);
            let seen = stage.play(hero, 3.0 / speed + 2.0);
            let highest = seen.iter().map(|it| it.position.y).fold(0.0, Real::max);
            assert!(highest < 4.002, "{rate} Hz, {speed} m/s: {highest}");
            let falls = seen.windows(2).all(|it| it[1].position.y <= it[0].position.y + 1e-3);
            assert!(falls, "{rate} Hz, {speed} m/s: goes up");
            // A free fall from the ledge takes 0.903 s, of which the arc takes a part.
            let aloft = seen.iter().filter(|it| !it.state.is_grounded()).count() as Real * stage.dt();
            assert!((0.75..1.15).contains(&aloft), "{rate} Hz, {speed} m/s: {aloft} s");
            assert!(seen.last().unwrap().position.y.abs() < 0.01);
        }
    }
}

/// As large and as small as games have them, and far from the origin.
#[test]
fn every_scale_walks() {
    for (height, far) in [(0.05, 0.0), (0.3, 100.0), (1.8, 3000.0), (20.0, 10_000.0)] {
        let mut stage = Stage::new(60);
        let place = Vec3::new(far, 0.0, -far);
        let half = Vec3::new(height * 20.0, height, height * 20.0);
        stage.block(place - Vec3::Y * height, half);
        stage.block(
            place + Vec3::new(height * 12.0, height * 0.05, 0.0),
            Vec3::new(height * 10.0, height * 0.05, half.z),
        );
        let settings = CharacterSettings::of_height(height);
        let hero = stage.character(settings, place);
        stage.play(hero, 0.3);
        let speed = Real::sqrt(height) * 2.0;
        stage.steer(hero, Vec3::X * speed);
        let seconds = height * 6.0 / speed;
        stage.play(hero, seconds);
        let end = stage.position(hero) - place;
        let slack = 0.02 * height;
        assert!((end.y - 0.1 * height).abs() < slack, "{height} m: {end}");
        assert!(end.x > height * 5.0, "{height} m: {end}");
        assert!(stage.seen(hero).state.is_grounded());
    }
}
