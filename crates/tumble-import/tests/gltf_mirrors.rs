//! Promise: a scale in a glTF file, mirroring or uneven, changes no rotation and no velocity that
//! the file gives for the same node.
//!
//! Why: a matrix with a negative factor has several rotations in it. It would fail if the rotation
//! were taken from the matrix and not from the file.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]

use glam::DVec3;
use tumble_import::gltf::Physics;

fn close(found: DVec3, expected: [f64; 3]) {
    // A rounding of the file's velocities, turned.
    assert!((found - DVec3::from_array(expected)).length() < 1e-12, "{found}, not {expected:?}");
}

/// Scales turn nothing: what the file says of rotations and velocities is not found again from a
/// matrix that has other factors too.
#[test]
fn mirrors_do_not_turn_what_is_written() {
    for (scale, rotation, linear, angular) in [
        ([-1.0, -1.0, 1.0], [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]),
        ([-1.0, 1.0, 1.0], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -2.0]),
        ([2.0, -3.0, 0.5], [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]),
    ] {
        let text = format!(
            r#"{{ "asset": {{ "version": "2.0" }}, "nodes": [ {{ "scale": {scale:?}, "rotation": {rotation:?}, "extensions": {{
            "KHR_physics_rigid_bodies": {{ "motion": {{ "linearVelocity": [1, 0, 0], "angularVelocity": [0, 0, 2] }} }} }} }} ] }}"#
        );
        let node = &Physics::from_json(&text, "m.gltf").unwrap().nodes[0];
        close(node.linear_velocity(), linear);
        close(node.angular_velocity(), angular);
        close(node.scale, scale);
    }
}
