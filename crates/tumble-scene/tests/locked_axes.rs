//! Promise: a body of a scene file has the locked axes that the file gives, `inspect` shows them,
//! and what cannot be locked is refused by its field.
//!
//! Why: a lock that is misread or has no effect shows only in a long run. It fails if names and
//! axes are out of step, or if a lock of a body with a joint is dropped.

use tumble::{Axes, LockedAxes};
use tumble_scene::{Audit, Scene};

const NAMES: [&str; 6] = ["linear_x", "linear_y", "linear_z", "angular_x", "angular_y", "angular_z"];

/// Why a scene is refused; nothing where it is not.
fn problem(text: &str) -> String {
    Scene::from_json(text, "scene.json").err().map(|error| error.to_string()).unwrap_or_default()
}

#[test]
fn each_axis_has_its_name() {
    for bits in 0..64_usize {
        let chosen = || (0..6).filter(|axis| bits & (1 << axis) != 0);
        let names: Vec<_> = chosen().map(|axis| format!("{:?}", NAMES[axis])).collect();
        let text = format!(r#"{{ "bodies": [ {{ "mass": 1, "locked_axes": [ {} ] }} ] }}"#, names.join(", "));
        let expected = chosen().map(|axis| Axes::EACH[axis]).fold(Axes::NONE, Axes::with);
        let mut world = hecs::World::new();
        Scene::from_json(&text, "scene.json").unwrap().spawn(&mut world).unwrap();
        let locked = world.query::<&LockedAxes>().iter().next().map_or(Axes::NONE, |locked| locked.0);
        assert_eq!(locked, expected, "{text}");
        let audit = Audit::from_json(&text, "scene.json").unwrap();
        assert_eq!(audit.bodies[0].locked_axes, chosen().map(|axis| NAMES[axis]).collect::<Vec<_>>());
    }
}

#[test]
fn what_cannot_be_locked_is_refused() {
    let of_body = |rest: &str| problem(&format!(r#"{{ "bodies": [ {{ "name": "it", {rest} }} ] }}"#));
    for (rest, words) in [
        (r#""mass": 1, "locked_axes": ["linear"]"#, "locked_axes[0]: must be one of linear_x"),
        (r#""mass": 1, "locked_axes": ["linear_x", "linear_x"]"#, "locked_axes[1]: is given twice"),
        (r#""fixed": true, "locked_axes": ["linear_x"]"#, "locked_axes: is for bodies"),
        (r#""kinematic": true, "locked_axes": ["linear_x"]"#, "locked_axes: is for bodies"),
    ] {
        let message = of_body(rest);
        assert!(message.contains(words) && message.contains("it"), "{message}");
    }
}

/// A pendulum on a ball joint that begins to swing in two planes: the lock leaves it one.
#[test]
fn a_body_with_a_joint_is_locked_too() {
    let text = r#"{ "bodies": [ { "name": "a", "fixed": true },
             { "name": "b", "mass": 1, "shape": { "cuboid": { "half_extents": [0.1, 0.1, 0.1] } }, "position": [1, 0, 0],
               "linear_velocity": [0, 1, 1], "locked_axes": ["linear_z", "angular_x", "angular_y"] } ],
             "joints": [ { "between": ["a", "b"], "ball": { "at": [0, 0, 0] } } ] }"#;
    let scene = Scene::from_json(text, "scene.json").unwrap();
    let mut simulation = tumble::Simulation::new(scene.settings).unwrap();
    let mut world = hecs::World::new();
    scene.spawn(&mut world).unwrap();
    simulation.step_many(&mut world, 60);
    let moved: Vec<_> = world.query::<(&tumble::Pose, &LockedAxes)>().iter().map(|(pose, _)| *pose).collect();
    assert!(moved[0].position.z == 0.0 && moved[0].position.x < 0.99, "{moved:?}");
}
