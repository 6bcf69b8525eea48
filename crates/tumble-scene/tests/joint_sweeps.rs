//! Promise: a world of a sweep over numbers of joints is the world of the scene with these numbers
//! written into it, joint by joint and to the bit; what no joint can have is refused by name.
//!
//! Why: a sweep over a stiffness that changes another joint's, or none, would show as a result of
//! the physics. It fails if a path leads to another number, if joints are made of other bodies than
//! the scene's, or if a varied one loses what does not vary.

use hecs::World;
use proptest::prelude::*;
use tumble::{Breakable, Drives, Joint, JointFriction, Limits};
use tumble_scene::{RunOverrides, SceneTemplate};

/// Paths of numbers, and the texts after which they stand in the scene.
const NUMBERS: [(&str, &str); 13] = [
    ("joints.elbow.hinge.at.1", "\"hinge\": { \"at\": [0.5, "),
    ("joints[0].hinge.axis[1]", "\"axis\": [0, "),
    ("joints.0.limits.angular_x.max", "\"angular_x\": [-3, "),
    ("joints.elbow.drives[0].max_force", "\"max_force\": "),
    ("joints.elbow.drives.1.position", "[\"angular_x\"], \"position\": "),
    ("joints.elbow.drives.1.stiffness", "\"stiffness\": "),
    ("joints.elbow.drives.1.damping", "\"damping\": "),
    ("joints.elbow.friction.angular_x", "\"friction\": { \"angular_x\": "),
    ("joints.elbow.break.torque", "\"torque\": "),
    ("joints[1].limits.cone.half_angles.1", "\"cone\": [1, "),
    ("joints.1.break.force", "\"force\": "),
    ("joints.rope.free.to.0", "\"to\": ["),
    ("joints.rope.limits.distance.max", "\"distance\": [0, "),
];

const SCENE: &str = r#"{
    "bodies": [ { "name": "a", "fixed": true }, { "name": "b", "mass": 1, "position": [1, 0, 0] },
        { "name": "c", "mass": 2, "position": [2, 0, 0] }, { "name": "d", "mass": 3, "position": [2, 1, 0] } ],
    "joints": [
        { "name": "elbow", "between": ["b", "c"], "hinge": { "at": [0.5, 0.25, 0], "axis": [0, 0, 1] },
          "limits": { "angular_x": [-3, 2] }, "friction": { "angular_x": 0.5 }, "break": { "torque": 30 },
          "drives": [ { "axes": ["angular_x"], "velocity": 1, "max_force": 4 },
                      { "axes": ["angular_x"], "position": 0.75, "stiffness": 9, "damping": 1.5 } ] },
        { "between": ["a", "b"], "ball": { "at": [0, 0, 0] }, "limits": { "cone": [1, 0.5] }, "break": { "force": 70 } },
        { "name": "rope", "between": ["d", "c"], "free": { "at": [2, 1, 0], "to": [2.5, 0, 0] },
          "limits": { "distance": [0, 1.25] } } ] }"#;

/// The scene with a number in the place of the one after a text.
fn written(scene: &str, after: &str, value: f64) -> String {
    assert_eq!(scene.matches(after).count(), 1, "{after}");
    let start = scene.find(after).unwrap() + after.len();
    let end = start + scene[start..].find([',', ' ', ']']).unwrap();
    format!("{}{value:?}{}", &scene[..start], &scene[end..])
}

fn template(directory: &tempfile::TempDir, scene: &str) -> SceneTemplate {
    let path = directory.path().join("scene.json");
    std::fs::write(&path, scene).unwrap();
    SceneTemplate::open(&path.to_string_lossy(), RunOverrides::default()).unwrap()
}

/// All joints with what they have, in the order in which they were spawned.
fn joints(world: &World) -> Vec<String> {
    type Options<'a> = (Option<&'a Limits>, Option<&'a Drives>, Option<&'a JointFriction>, Option<&'a Breakable>);
    let mut query = world.query::<(hecs::Entity, &Joint, Options<'_>)>();
    let mut all: Vec<_> =
        query.iter().map(|(entity, joint, options)| (entity, format!("{joint:?} {options:?}"))).collect();
    all.sort_by_key(|(entity, _)| *entity);
    all.into_iter().map(|(_, joint)| joint).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(150) })]
    #[test]
    fn varied_joints_are_those_of_the_scene_with_their_numbers(
        chosen in prop::sample::subsequence(NUMBERS.to_vec(), 1..=4),
        values in prop::collection::vec(0.01_f64..3.0, 4),
    ) {
        let directory = tempfile::tempdir().unwrap();
        let template_of = |scene: &str| template(&directory, scene);
        let plain = template_of(SCENE);
        let fields: Vec<_> = chosen.iter().map(|(path, _)| plain.field(path).unwrap()).collect();
        for field in &fields {
            prop_assert!(plain.check(field).is_ok());
        }
        let mut scene = SCENE.to_owned();
        for ((_, after), value) in chosen.iter().zip(&values) {
            scene = written(&scene, after, *value);
        }
        let varied = plain.varied(fields);
        let world = varied.build(&values[..chosen.len()]).unwrap();
        let expected = template_of(&scene).varied(Vec::new()).build(&[]).unwrap();
        prop_assert_eq!(joints(&world.trial.world), joints(&expected.trial.world));
        prop_assert_ne!(joints(&world.trial.world), joints(&template_of(SCENE).varied(Vec::new()).build(&[]).unwrap().trial.world));
        // The next world begins from the scene again.
        let other: Vec<f64> = values.iter().map(|value| 0.5 * value).collect();
        varied.build(&other[..chosen.len()]).unwrap();
        let again = varied.build(&values[..chosen.len()]).unwrap();
        prop_assert_eq!(joints(&again.trial.world), joints(&expected.trial.world));
    }
}

#[test]
fn what_no_joint_can_have_is_refused_by_name() {
    let directory = tempfile::tempdir().unwrap();
    for (path, value, problem) in [
        ("joints.elbow.drives.1.stiffness", -1.0, "joints[0].drives[1].stiffness"),
        ("joints.elbow.limits.angular_x.max", -3.5, "joints[0].limits.angular_x"),
        ("joints.1.limits.cone.half_angles.0", 4.0, "joints[1].limits.cone.half_angles"),
        ("joints.1.break.force", 0.0, "joints[1].break.force"),
        ("joints.elbow.friction.angular_y", 1.0, "joints[0].friction.angular_y: does nothing"),
        ("joints.elbow.drives.0.frequency", 1.0, "joints[0].drives[0].frequency: does nothing without a position"),
        ("joints.rope.free.at.0", f64::INFINITY, "joints[2].free.at"),
    ] {
        let plain = template(&directory, SCENE);
        let field = plain.field(path).unwrap();
        let error = plain.varied(vec![field]).build(&[value]).err().unwrap().to_string();
        assert!(error.contains(problem), "{path}: {error}");
    }
    let plain = template(&directory, SCENE);
    let error = plain.field("joints.knee.hinge.at.0").unwrap_err().to_string();
    assert!(error.contains("no joint is called \"knee\""), "{error}");
    let error = plain.check(&plain.field("joints.rope.drives.0.velocity").unwrap()).unwrap_err().to_string();
    assert!(error.contains("has no such number; there may be KIND.at.I"), "{error}");
}
