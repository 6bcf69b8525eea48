//! Scenes that others wrote for KHR_physics_rigid_bodies and OMI_physics_body become the bodies and
//! the motions that they are said to be.
//!
//! They carry no licence, so they are not part of this repository. `TUMBLE_GLTF_CASES` names their
//! folder; the default is `shared/cases/gltf` beside the repository. Where there is none, the tests
//! say so and pass.
#![cfg_attr(feature = "f64", allow(clippy::useless_conversion, reason = "Real is f64 in this build, f32 in the other"))]

use crate::cases::{cases, expected};
use glam::{DQuat, DVec3};
use hecs::World;
use serde_json::Value;
use tumble::{BodyId, Pose, Simulation};
use tumble_scene::Scene;

/// Every scene whose buffers are there becomes bodies; where one is missing the message names it.
#[test]
fn every_scene_becomes_bodies() {
    let Some(folder) = cases() else { return };
    let (mut whole, mut without_buffers) = (0, 0);
    for (path, case) in expected(&folder) {
        let name = path.display().to_string();
        let scene = match Scene::open(&path.to_string_lossy()) {
            Ok(scene) => scene,
            Err(error) => {
                let message = error.to_string();
                assert!(message.contains("buffers[0]: ") && message.contains(".bin"), "{message}");
                without_buffers += 1;
                continue;
            }
        };
        whole += 1;
        if let Some(count) = case.get("n_bodies").and_then(Value::as_u64) {
            assert_eq!(scene.body_count() as u64, count, "{name}");
        }
        let mut world = World::new();
        let dynamic = case.get("n_dynamic").and_then(Value::as_u64);
        scene.spawn(&mut world).unwrap();
        let moved = world.query::<&tumble::Velocity>().iter().count() as u64;
        assert!(dynamic.is_none_or(|dynamic| dynamic == moved), "{name}: {moved} bodies move, {dynamic:?} should");
    }
    println!("{whole} scenes, {without_buffers} without their buffers");
    assert!(whole >= 46, "{whole}");
}

/// The motions that the scenes of motion properties are made for: after a second, within the
/// rounding of f32 steps.
#[test]
fn motions_are_those_described() {
    let Some(folder) = cases() else { return };
    let half: f64 = 0.5;
    let turned = DQuat::from_xyzw(half.sin(), 0.0, 0.0, half.cos());
    for (number, id, position, orientation) in [
        ("00", 0, DVec3::ZERO, DQuat::IDENTITY),
        ("01", 0, DVec3::X, DQuat::IDENTITY),
        ("02", 0, DVec3::ZERO, turned),
        ("03", 0, DVec3::X, DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2)),
        ("05", 1, DVec3::new(0.0, 0.5, 0.0), DQuat::IDENTITY),
    ] {
        let name = format!("RigidBodies_MotionProperties/RigidBodies_MotionProperties_{number}.gltf");
        let scene = Scene::open(&folder.join(name).to_string_lossy()).unwrap();
        let mut simulation = Simulation::new(scene.settings.with_dt(1.0 / 64.0)).unwrap();
        let mut world = World::new();
        scene.spawn(&mut world).unwrap();
        simulation.step_many(&mut world, 64);
        let mut query = world.query::<(&BodyId, &Pose)>();
        let (_, pose) = query.iter().find(|(found, _)| found.0 == id).unwrap();
        let found = DVec3::from_array(pose.position.to_array().map(f64::from));
        assert!((found - position).length() < 1e-5, "{number}: {found}");
        let found = DQuat::from_array(pose.orientation.to_array().map(f64::from));
        assert!(
            found.dot(orientation).abs() > 1.0 - 1e-10_f64.max(f64::from(tumble::math::Real::EPSILON)),
            "{number}: {found}"
        );
    }
}

/// OMI's own examples as bodies, whose figures stand in the files.
#[test]
fn omi_examples_become_bodies() {
    let Some(folder) = cases() else { return };
    let open = |name: &str| Scene::open(&folder.join("omi").join(name).to_string_lossy());
    // One kilogram unless the file says otherwise, and the moments of a block of 1 by 2 by 3
    // metres.
    let mut world = World::new();
    open("dynamic_box.gltf").unwrap().spawn(&mut world).unwrap();
    let mut query = world.query::<(&tumble::Mass, &tumble::Inertia)>();
    let (mass, inertia) = query.iter().next().unwrap();
    assert_eq!(f64::from(mass.kilograms()), 1.0);
    let moments = DVec3::from_array(inertia.moments().to_array().map(f64::from));
    assert!((moments - DVec3::new(13.0, 10.0, 5.0) / 12.0).length() < 1e-7, "{moments}");
    drop(query);
    // A static body holds its collider: one body, which nothing moves.
    let scene = open("static_body_motion.gltf").unwrap();
    assert_eq!((scene.body_count(), scene.colliders().count()), (1, 1));
    let mut world = World::new();
    scene.spawn(&mut world).unwrap();
    assert_eq!(world.query::<&tumble::Velocity>().iter().count(), 0);
}
