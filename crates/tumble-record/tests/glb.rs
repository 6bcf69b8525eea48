//! An animation has the numbers of the record, in a file that follows the specification, finished
//! or not.
//!
//! Viewers show whatever they are given, with a body turned the wrong way or a frame late, or
//! refuse the whole file over one wrong length. It would fail if a piece were written to another's
//! place, a quaternion took the long way round, or the counts in the document ran ahead of the
//! frames in the buffer.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]

mod gltf;

use std::io::Cursor;

use glam::{DQuat, DVec3};
use gltf::Gltf;
use hecs::World;
use proptest::prelude::*;
use tumble::math::Real;
use tumble::{BodyOrder, CenterOfMass, Pose, Simulation, Velocity};
use tumble_record::{Animation, Frame, TrajectoryError, TrajectoryWriter};
use tumble_scene::Scene;

/// What was recorded of a body that moves: the origin of its frame and its orientation.
type Motion = Vec<(DVec3, DQuat)>;

#[allow(clippy::useless_conversion, reason = "it is f64 already in one of the two builds")]
fn double(number: Real) -> f64 {
    f64::from(number)
}

/// Runs a scene with room for `capacity` frames and records `frames`, with checkpoints where
/// `at_checkpoint` says; the file at the last of them or, if there are none, at the end, with the
/// frames it is to have.
fn recorded(
    scene: Scene,
    [frames, capacity, every]: [u64; 3],
    at_checkpoint: impl Fn(u64) -> bool,
) -> (Vec<u8>, Vec<f64>, Vec<Motion>) {
    let mut simulation = Simulation::new(scene.settings).unwrap();
    let animation = Animation::of(&scene, (capacity - 1) * every, every).unwrap();
    assert_eq!(animation.frames, capacity);
    let mut world = World::new();
    let names = scene.spawn(&mut world).unwrap();
    let order = BodyOrder::of(&world);
    let moving: Vec<_> =
        order.entities().iter().copied().filter(|&entity| world.get::<&Velocity>(entity).is_ok()).collect();
    let mut bytes = Cursor::new(Vec::new());
    let (mut times, mut motions, mut readable) = (Vec::new(), vec![Motion::new(); moving.len()], None);
    let mut writer = TrajectoryWriter::glb(&mut bytes, animation);
    for frame in 0..frames {
        writer.record(&Frame::of(&simulation, &world, &order, &names)).unwrap();
        times.push(simulation.time());
        for (motion, &entity) in motions.iter_mut().zip(&moving) {
            let (pose, center) = (*world.get::<&Pose>(entity).unwrap(), world.get::<&CenterOfMass>(entity).ok());
            let origin = DVec3::from_array(pose.origin(center.as_deref()).to_array().map(double));
            motion.push((origin, DQuat::from_array(pose.orientation.to_array().map(double))));
        }
        if at_checkpoint(frame) {
            writer.checkpoint().unwrap();
            readable = Some(times.len());
        }
        for _ in 0..every {
            simulation.step(&mut world);
        }
    }
    if let Some(readable) = readable {
        // As if the program were killed: what comes after the last checkpoint is not in the file.
        drop(writer);
        times.truncate(readable);
        motions.iter_mut().for_each(|motion| motion.truncate(readable));
    } else {
        writer.finish().unwrap();
    }
    (bytes.into_inner(), times, motions)
}

fn assert_same(file: &[u8], times: &[f64], motions: &[Motion]) {
    let (got_times, tracks) = Gltf::read(file).animation();
    assert_eq!(tracks.len(), motions.len());
    if !motions.is_empty() {
        assert_eq!(got_times, times.iter().map(|&time| time as f32).collect::<Vec<_>>());
    }
    for (track, motion) in tracks.iter().zip(motions) {
        assert_eq!(track.translations.len(), motion.len());
        for ((translation, rotation), (origin, orientation)) in
            track.translations.iter().zip(&track.rotations).zip(motion)
        {
            let off = (DVec3::from_array(translation.map(f64::from)) - *origin).length();
            // Both rounded in single precision: half a unit in the last place of each of three
            // coordinates, and of the sums in the second.
            assert!(off <= 4e-7 * (1.0 + origin.length()), "{translation:?} {origin}");
            let cosine = DQuat::from_array(rotation.map(f64::from)).dot(*orientation).abs();
            assert!((cosine - 1.0).abs() < 3e-7, "{rotation:?} {orientation}");
        }
    }
}

const SCENE: &str = r#"{ "name": "a \"quoted\" name", "gravity": [0, -9.81, 0], "dt": 0.05, "bodies": [
    { "name": "brick", "shape": { "cuboid": { "half_extents": [0.1, 0.05, 0.03] } }, "mass": 2.0, "angular_velocity": [1, 9, 0.1] },
    { "name": "cone", "shape": { "cone": { "radius": 1, "half_height": 0.5 } }, "density": 10, "angular_velocity": [4, 0, 9] },
    { "name": "another brick", "shape": { "cuboid": { "half_extents": [0.3, 0.05, 0.03] } }, "mass": 2.0 },
    { "name": "floor", "fixed": true, "position": [0, -1, 0] },
    { "name": "belt", "kinematic": true, "linear_velocity": [0, 1, 0] } ] }"#;

fn scene() -> Scene {
    Scene::from_json(SCENE, "scene.json").unwrap()
}

#[test]
fn the_animation_is_what_happened() {
    let (file, times, motions) = recorded(scene(), [60, 60, 2], |_| false);
    assert_eq!((times.len(), motions.len()), (60, 4));
    assert_same(&file, &times, &motions);
    let gltf = Gltf::read(&file);
    let names: Vec<&str> =
        gltf.json["nodes"].as_array().unwrap().iter().map(|node| node["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["brick", "cone", "another brick", "floor", "belt"]);
    // The floor has no track.
    assert_eq!(gltf.animation().1.iter().map(|track| track.node).collect::<Vec<_>>(), [0, 1, 2, 4]);
    // Blocks are stretched from one surface, in colours of their own: three surfaces with two
    // accessors of vertices each, and indices.
    assert_eq!(gltf.json["accessors"].as_array().unwrap().len(), 1 + 2 * 4 + 3 * 3);
    let extras = &gltf.json["asset"]["extras"];
    assert_eq!((&extras["scene"], &extras["every"]), (&"a \"quoted\" name".into(), &2.into()));
    assert!((extras["dt"].as_f64().unwrap() - 0.05).abs() < 1e-8);
    assert!(gltf.json["asset"]["generator"].as_str().unwrap().starts_with("tumble "));
}

#[test]
fn every_checkpoint_is_a_whole_file_of_what_there_is() {
    for last in [0, 1, 17, 59] {
        let (file, times, motions) = recorded(scene(), [60, 100, 1], |frame| frame == last || frame == last / 2);
        assert_eq!(times.len() as u64, last + 1);
        assert_same(&file, &times, &motions);
    }
}

#[test]
fn a_run_that_ends_early_leaves_what_it_has() {
    let (file, times, motions) = recorded(scene(), [7, 1000, 1], |_| false);
    assert_eq!(times.len(), 7);
    assert_same(&file, &times, &motions);
}

#[test]
fn a_scene_without_bodies_or_without_motion_is_a_file_too() {
    for bodies in ["", r#"{ "fixed": true }"#] {
        let text = format!(r#"{{ "bodies": [{bodies}] }}"#);
        let (file, _, motions) = recorded(Scene::from_json(&text, "still.json").unwrap(), [5, 5, 1], |_| false);
        assert!(motions.is_empty());
        let gltf = Gltf::read(&file);
        assert_eq!(gltf.json.get("animations"), None);
    }
    let (file, times, motions) = recorded(scene(), [1, 1, 1], |_| false);
    assert_same(&file, &times, &motions);
}

#[test]
fn more_frames_than_memory_keeps_back_are_all_there() {
    // 31 bodies take 868 bytes a frame, so 16 MiB are full at 19329 frames.
    let (file, times, motions) = recorded(Scene::stress(31, 3).unwrap(), [20_000, 20_000, 1], |_| false);
    assert_eq!((times.len(), motions.len()), (20_000, 31));
    assert_same(&file, &times, &motions);
}

#[test]
fn what_is_not_finite_stays_where_it_was() {
    let mut world = World::new();
    let scene = scene();
    let animation = Animation::of(&scene, 2, 1).unwrap();
    let names = scene.spawn(&mut world).unwrap();
    let order = BodyOrder::of(&world);
    let mut writer = TrajectoryWriter::glb(Cursor::new(Vec::new()), animation);
    writer.record(&Frame { step: 0, time: 0.0, world: &world, order: &order, names: &names }).unwrap();
    world.query_mut::<&mut Pose>().into_iter().for_each(|pose| pose.position.x /= 0.0);
    writer.record(&Frame { step: 1, time: 0.5, world: &world, order: &order, names: &names }).unwrap();
    world.despawn(order.entities()[0]).unwrap();
    writer.record(&Frame { step: 2, time: 1.0, world: &world, order: &order, names: &names }).unwrap();
    // A time that single precision cannot tell from the last one is not a frame.
    writer.record(&Frame { step: 3, time: 1.0 + 1e-9, world: &world, order: &order, names: &names }).unwrap();
    let gltf = Gltf::read(writer.finish().unwrap().get_ref());
    let (times, tracks) = gltf.animation();
    assert_eq!(times, [0.0, 0.5, 1.0]);
    assert!(tracks.iter().all(|track| track.translations.windows(2).all(|pair| pair[0] == pair[1])));
}

#[test]
fn what_does_not_fit_is_refused_with_the_first_frame() {
    let scene = Scene::stress(1000, 0).unwrap();
    let animation = Animation::of(&scene, 1_000_000, 5).unwrap();
    let mut world = World::new();
    let names = scene.spawn(&mut world).unwrap();
    let mut writer = TrajectoryWriter::glb(Cursor::new(Vec::new()), animation);
    let order = BodyOrder::of(&world);
    let error = writer.record(&Frame { step: 0, time: 0.0, world: &world, order: &order, names: &names }).unwrap_err();
    assert!(
        matches!(error, TrajectoryError::TooLarge { bodies: 1000, frames: 200_001, bytes } if bytes > 5_600_000_000),
        "{error}"
    );
    assert!(error.to_string().contains("1000 bodies in 200001 frames are 5.2 GiB"), "{error}");
    assert!(error.to_string().contains("--every"), "{error}");
}

#[test]
fn points_are_seen_beside_what_is_far_away() {
    let text = r#"{ "bodies": [ { "mass": 1 }, { "mass": 1, "position": [3e12, 4e12, 0] } ] }"#;
    let (file, _, _) = recorded(Scene::from_json(text, "far.json").unwrap(), [2, 2, 1], |_| false);
    let gltf = Gltf::read(&file);
    // A two-hundredth of the distance, of an octahedron of 0.02 m.
    let scale = gltf.json["nodes"][0]["scale"][0].as_f64().unwrap();
    assert!((scale * 0.02 / 2.5e10 - 1.0).abs() < 1e-6, "{scale}");
}

fn shape() -> impl Strategy<Value = String> {
    let length = 0.01..20.0_f64;
    prop_oneof![
        Just(r#""point""#.to_owned()),
        length.clone().prop_map(|r| format!(r#"{{ "sphere": {{ "radius": {r} }} }}"#)),
        length.clone().prop_map(|r| format!(r#"{{ "hollow_sphere": {{ "radius": {r} }} }}"#)),
        [length.clone(), length.clone()].prop_map(|[r, h]| format!(r#"{{ "cone": {{ "radius": {r}, "half_height": {h} }} }}"#)),
        [length.clone(), length.clone()].prop_map(|[r, h]| format!(r#"{{ "capsule": {{ "radius": {r}, "half_height": {h} }} }}"#)),
        [length.clone(), length.clone(), length.clone()].prop_map(|r| format!(r#"{{ "ellipsoid": {{ "radii": {r:?} }} }}"#)),
        [length.clone(), length].prop_map(|[r, x]| format!(
            r#"{{ "compound": {{ "parts": [ {{ "shape": {{ "sphere": {{ "radius": {r} }} }}, "mass": 1 }},
                {{ "shape": {{ "cylinder": {{ "radius": {x}, "half_height": {r} }} }}, "mass": 2, "position": [{x}, 0, 1] }} ] }} }}"#
        )),
    ]
}

fn body() -> impl Strategy<Value = String> {
    let kind = prop_oneof![
        3 => Just(r#""mass": 1.5"#),
        1 => Just(r#""fixed": true"#),
        1 => Just(r#""kinematic": true, "linear_velocity": [1, 2, 3]"#),
    ];
    (shape(), kind, [-1e4..1e4_f64, -1.0..1.0, -1e-3..1e-3])
        .prop_map(|(shape, kind, position)| format!(r#"{{ "shape": {shape}, "position": {position:?}, {kind} }}"#))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_scene_is_a_valid_file_of_what_happened(
        bodies in prop::collection::vec(body(), 0..6),
        frames in 1..12_u64,
        unused in 0..3_u64,
        every in 1..4_u64,
        checkpoint in prop::option::of(0..12_u64),
    ) {
        let scene = Scene::from_json(&format!(r#"{{ "bodies": [{}] }}"#, bodies.join(",")), "any.json").unwrap();
        let at = |frame| checkpoint.is_some_and(|checkpoint| checkpoint.min(frames - 1) == frame);
        let (file, times, motions) = recorded(scene, [frames, frames + unused, every], at);
        assert_same(&file, &times, &motions);
    }
}

/// Infinite ground is a disc in a record, as wide as the scene, and a surface that is seen from
/// above only.
#[test]
fn a_record_has_a_plate_for_ground() {
    let text = r#"{ "bodies": [
        { "name": "ground", "shape": { "half_space": {} }, "fixed": true, "collider": {} },
        { "name": "box", "shape": { "cuboid": { "half_extents": [0.5, 0.25, 0.5] } }, "mass": 2, "position": [0, 1, 0],
          "collider": {} } ] }"#;
    let scene = Scene::from_json(text, "box.json").unwrap();
    let (settings, animation) = (scene.settings, Animation::of(&scene, 0, 1).unwrap());
    let mut world = World::new();
    let names = scene.spawn(&mut world).unwrap();
    let simulation = Simulation::new(settings).unwrap();
    let order = BodyOrder::of(&world);
    let frame = Frame::of(&simulation, &world, &order, &names);
    let mut writer = TrajectoryWriter::glb(Cursor::new(Vec::new()), animation);
    writer.record(&frame).unwrap();
    let bytes = writer.finish().unwrap().into_inner();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let document: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let ground = &document["nodes"][0];
    assert_eq!(ground["name"], "ground");
    let primitive = &document["meshes"][ground["mesh"].as_u64().unwrap() as usize]["primitives"][0];
    let positions = &document["accessors"][primitive["attributes"]["POSITION"].as_u64().unwrap() as usize];
    let half_width = positions["max"][0].as_f64().unwrap();
    // The box reaches 0.75 m from its middle, in a box with a diagonal of 2 x 0.75 x sqrt(3).
    assert!((half_width / (1.6 * 0.75 * 3.0_f64.sqrt()) - 1.0).abs() < 1e-6, "{half_width}");
    assert_eq!((positions["min"][1].as_f64(), positions["max"][1].as_f64()), (Some(0.0), Some(0.0)));
    assert_eq!(document["materials"][primitive["material"].as_u64().unwrap() as usize].get("doubleSided"), None);
}
