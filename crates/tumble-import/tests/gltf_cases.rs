//! Scenes that others wrote for KHR_physics_rigid_bodies and OMI_physics_body, against an
//! independent reading of them.
//!
//! They carry no licence, so they are not part of this repository. `TUMBLE_GLTF_CASES` names their
//! folder; the default is `shared/cases/gltf` beside the repository. Where there is none, the tests
//! say so and pass.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helper functions too")]

mod cases;

use cases::{cases, expected};
use glam::{DQuat, DVec3};
use serde_json::Value;
use tumble_import::gltf::{Geometry, MotionKind, Physics, PhysicsNode, SurfaceMaterial};

/// The figures have nine digits, the files are written in f32.
const TOLERANCE: f64 = 2e-7;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&numbers(value))
}

fn close(found: DVec3, expected: &Value, what: &str) {
    let expected = vector(expected);
    let bound = TOLERANCE * (1.0 + expected.length());
    assert!((found - expected).length() <= bound, "{what}: {found}, not {expected}");
}

/// Up to the sign, which means nothing.
fn same_rotation(found: DQuat, expected: &Value, what: &str) {
    let expected = DQuat::from_slice(&numbers(expected));
    let error = (found - expected).length().min((found + expected).length());
    assert!(error <= TOLERANCE, "{what}: {found}, not {expected}");
}

fn check_motion(node: &PhysicsNode, body: &Value, what: &str) {
    let (Some(motion), Some(expected)) = (node.motion, body.get("motion")) else {
        assert_eq!(node.motion.is_some(), body.get("motion").is_some(), "{what}");
        return;
    };
    let kinematic = expected.get("isKinematic").and_then(Value::as_bool).unwrap_or(false);
    assert_eq!(motion.kind == MotionKind::Kinematic, kinematic, "{what}");
    let infinite = |value: f64| if value == 0.0 { f64::INFINITY } else { value };
    assert_eq!(motion.mass, expected.get("mass").and_then(Value::as_f64).map(infinite), "{what}");
    let moments = expected.get("inertiaDiagonal").map(|moments| vector(moments).to_array().map(infinite));
    assert_eq!(motion.inertia_diagonal.map(|moments| moments.to_array()), moments, "{what}");
    assert_eq!(motion.gravity_factor, expected.get("gravityFactor").and_then(Value::as_f64).unwrap_or(1.0), "{what}");
    close(node.linear_velocity(), &body["world_linear_velocity"], what);
    close(node.angular_velocity(), &body["world_angular_velocity"], what);
    // Where the file is silent the reading has the origin, and we what follows from the shape.
    assert_eq!(node.center_of_mass().is_some(), expected.get("centerOfMass").is_some(), "{what}");
    if let Some(center) = node.center_of_mass() {
        close(center, &body["world_com"], what);
    }
}

fn check_geometry(found: Option<&Geometry>, expected: &Value, what: &str) {
    let Some(found) = found else { panic!("{what}: has no geometry") };
    let Some(shape) = expected.get("shape_def") else {
        let hull = expected.get("convexHull").and_then(Value::as_bool).unwrap_or(false);
        assert!(matches!(found, Geometry::Mesh { convex_hull, .. } if *convex_hull == hull), "{what}: {found:?}");
        return;
    };
    let kind = shape["type"].as_str().unwrap();
    let number = |key: &str, default: f64| shape[kind].get(key).map_or(default, |value| value.as_f64().unwrap());
    let expected = match kind {
        "box" => Geometry::Box { size: shape[kind].get("size").map_or(DVec3::ONE, vector) },
        "sphere" => Geometry::Sphere { radius: number("radius", 0.5) },
        "capsule" => Geometry::Capsule {
            height: number("height", 0.5),
            radius_bottom: number("radiusBottom", 0.25),
            radius_top: number("radiusTop", 0.25),
        },
        "cylinder" => Geometry::Cylinder {
            height: number("height", 0.5),
            radius_bottom: number("radiusBottom", 0.25),
            radius_top: number("radiusTop", 0.25),
        },
        other => panic!("{what}: a shape of type {other}"),
    };
    assert_eq!(*found, expected, "{what}");
}

fn check_material(found: Option<&SurfaceMaterial>, expected: Option<&Value>, what: &str) {
    assert_eq!(found.is_some(), expected.is_some(), "{what}");
    let (Some(found), Some(expected)) = (found, expected) else { return };
    let number = |key: &str, default: f64| expected.get(key).map_or(default, |value| value.as_f64().unwrap());
    assert_eq!(found.static_friction, number("staticFriction", 0.6), "{what}");
    assert_eq!(found.dynamic_friction, number("dynamicFriction", 0.6), "{what}");
    assert_eq!(found.restitution, number("restitution", 0.0), "{what}");
}

fn check_node(node: &PhysicsNode, body: &Value, case: &Value, what: &str) {
    assert_eq!(node.index as u64, body["node"].as_u64().unwrap(), "{what}");
    assert_eq!(node.name.as_deref(), body["name"].as_str(), "{what}");
    assert_eq!(node.body.map(|body| body as u64), body["owning_body_node"].as_u64(), "{what}");
    close(node.position, &body["world_position"], what);
    close(node.scale, &body["world_scale"], what);
    same_rotation(node.rotation, &body["world_rotation_xyzw"], what);
    check_motion(node, body, what);
    let entry = |table: &str, index: &Value| index.as_u64().map(|index| case[table][index as usize].clone());
    assert_eq!(node.collider.is_some(), body.get("collider").is_some(), "{what}");
    if let (Some(collider), Some(expected)) = (&node.collider, body.get("collider")) {
        check_geometry(collider.geometry.as_ref(), &expected["geometry"], what);
        check_material(collider.material.as_ref(), entry("materials", &expected["material"]).as_ref(), what);
        let systems = entry("filters", &expected["filter"]).map(|filter| filter["collisionSystems"].clone());
        let found = collider.filter.as_ref().map(|filter| Value::from(filter.collision_systems.clone()));
        assert_eq!(found, systems, "{what}");
    }
    assert_eq!(node.trigger.is_some(), body.get("trigger").is_some(), "{what}");
    if let (Some(trigger), Some(expected)) = (&node.trigger, body.get("trigger")) {
        check_geometry(trigger.geometry.as_ref(), expected, what);
    }
    assert_eq!(node.joint.is_some(), body.get("joint").is_some(), "{what}");
    if let (Some(joint), Some(expected)) = (&node.joint, body.get("joint")) {
        assert_eq!(joint.connected_node as u64, expected["connectedNode"].as_u64().unwrap(), "{what}");
        let described = entry("joints", &expected["joint"]).unwrap();
        let count = |key: &str| described.get(key).map_or(0, |list| list.as_array().unwrap().len());
        assert_eq!((joint.joint.limits.len(), joint.joint.drives.len()), (count("limits"), count("drives")), "{what}");
    }
}

/// Poses, velocities, masses, colliders, materials, filters, triggers and joints of every node, in
/// the world's frame.
#[test]
fn every_scene_is_read_as_the_independent_reading_has_it() {
    let Some(folder) = cases() else { return };
    let mut nodes = 0;
    for (path, case) in expected(&folder) {
        let physics = Physics::open(&path).unwrap();
        let Some(bodies) = case.get("bodies").and_then(Value::as_array) else { continue };
        assert_eq!(physics.nodes.len(), bodies.len(), "{}", path.display());
        for (node, body) in physics.nodes.iter().zip(bodies) {
            check_node(node, body, &case, &format!("{} nodes[{}]", path.display(), node.index));
            nodes += 1;
        }
    }
    assert!(nodes > 100, "{nodes}");
}

/// OMI's own examples, whose figures stand in the files.
#[test]
fn omi_examples_are_read() {
    let Some(folder) = cases() else { return };
    let read = |name: &str| Physics::open(&folder.join("omi").join(name)).unwrap();
    let mut count = 0;
    for entry in std::fs::read_dir(folder.join("omi")).unwrap() {
        let path = entry.unwrap().path();
        assert!(!Physics::open(&path).unwrap().nodes.is_empty(), "{}", path.display());
        count += 1;
    }
    assert_eq!(count, 12);
    let velocity = read("dynamic_with_velocity.gltf").nodes[0].clone();
    assert_eq!(
        (velocity.linear_velocity(), velocity.angular_velocity()),
        (DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0))
    );
}
