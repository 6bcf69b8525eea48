//! No text, however broken, makes the library panic, and every refusal is one readable line.
//!
//! A reader that panics takes the program down without saying which file was at fault. It would
//! fail by an index, an overflow or an `unwrap` on a path that no hand-written example takes.

use proptest::prelude::*;
use tumble_scene::{Audit, Scene, SceneError};

const JSON: &str = r#"{ "name": "mixed", "gravity": [0, -9.81, 0], "dt": 0.01, "steps": 10, "substeps": 2,
  "integrator": "runge-kutta4", "bodies": [
  { "name": "brick", "shape": { "cuboid": { "half_extents": [0.1, 0.05, 0.03] } }, "mass": 2.0,
    "inertia": { "principal": [1, 2, 2.5], "axes": [0, 0, 0.6, 0.8] }, "position": [1, 2, 3],
    "orientation": [0, 0.6, 0, 0.8], "linear_velocity": [1, 0, 0], "angular_velocity": [1, 2, 3],
    "forces": [ { "damping": { "linear": 0.1, "angular": 0.2 } }, { "gravity_scale": 0.5 }, { "wind": [1, 2, 3] },
      { "drag": { "linear": 0.1, "angular": [1, 2, 3] } }, { "magnus": { "coefficient": 0.5 } },
      { "thruster": { "force": [1, 2, 3], "point": [0.1, 0, 0], "throttle": 0.5 } }, { "thruster": { "force": [1, 0, 0] } },
      { "constant_wrench": { "force": [1, 0, 0], "torque": [0, 1, 0], "frame": "body" } },
      { "spring_to_point": { "anchor": [1, 2, 3], "attachment": [0, 1, 0], "rest_length": 1, "stiffness": 10, "damping": 1 } },
      { "spring": { "to": "floor", "attachment": [0, 1, 0], "attachment_to": [1, 0, 0], "stiffness": 10, "damping": 1 } },
      { "point_gravity": { "center": [0, 1, 0], "mu": 10, "softening": 0.1 } }, { "gravity_mass": { "mu": 1, "softening": 0.1 } },
      { "buoyancy": { "density": 100, "level": 2, "hull": { "sphere": { "radius": 0.5 } }, "center": [0, 0.1, 0] } },
      { "angular_velocity_servo": { "target": [0, 1, 0], "frame": "body", "max_torque": 5 } } ] },
  { "shape": { "compound": { "parts": [ { "shape": { "sphere": { "radius": 1 } }, "density": 10 },
    { "shape": { "convex_hull": { "points": [[0,0,0], [1,0,0], [0,1,0], [0,0,1]] } }, "density": 10 },
    { "shape": "point", "mass": 1, "position": [1, 0, 0], "orientation": [0, 0, 0, 1] } ] } }, "locked_axes": [ "linear_z", "angular_x" ] },
  { "name": "floor", "fixed": true, "shape": { "cone": { "radius": 1, "half_height": 2 } }, "forces": [ { "gravity_mass": { "mu": 5 } } ] },
  { "name": "belt", "kinematic": true, "angular_velocity": [0, 1, 0] },
  { "name": "tensor", "mass": 1, "inertia": { "tensor": [[2, 0.1, 0], [0.1, 2, 0], [0, 0, 2]] } } ],
  "joints": [
  { "name": "hatch", "between": ["brick", "floor"], "cylinder": { "at": [1, 2, 2], "axis": [0, 1, 0] }, "contacts": true,
    "limits": { "angular_x": [-0.5, 1], "linear_x": { "min": 0, "stiffness": 100, "damping": 2 } },
    "drives": [ { "axes": ["angular_x"], "velocity": 10, "max_force": 2 },
      { "axes": ["linear_x"], "position": 0.1, "velocity": 1, "stiffness": 50, "damping": 5, "mode": "acceleration" } ],
    "friction": { "angular_x": 0.5, "linear_x": 1 }, "break": { "force": 100, "torque": 20 } },
  { "between": ["brick", "tensor"], "free": { "at": [1, 2, 3], "to": [0, 0, 0] },
    "limits": { "distance": [1, 4], "cone": { "half_angles": [1.2, 0.7], "frequency": 5, "damping_ratio": 0.5 } },
    "drives": [ { "axes": ["angular"], "position": 0.5, "frequency": 2 } ] },
  { "between": ["tensor", "belt"], "ball": { "at": [0, 0, 1], "axis": [1, 0, 0] }, "limits": { "cone": 1, "angular_x": [-1, 1] } },
  { "name": "rail", "between": ["floor", "tensor"], "slider": { "at": [0, 0, 0], "axis": [1, 0, 0] } } ],
  "gears": [ { "joints": ["hatch", "rail"], "axes": ["angular_x", "linear_x"], "ratio": -0.1, "offset": 0.2 } ] }"#;

const RON: &str = r#"( name: "mixed", gravity: (0, -9.81, 0), dt: 0.01, steps: 10, integrator: "moser-veselov", bodies: [
  ( name: "brick", shape: cuboid(half_extents: (0.1, 0.05, 0.03)), mass: 2.0,
    inertia: (principal: [1, 2, 2.5], axes: (0, 0, 0.6, 0.8)), position: (1, 2, 3), orientation: [0, 0.6, 0, 0.8],
    forces: [ damping(linear: 0.1, angular: 0.2), gravity_scale(0.5), wind((1, 2, 3)), drag(linear: 0.5, angular: (1, 2, 3)),
      spring(to: "body-2", stiffness: 10), buoyancy(hull: cuboid(half_extents: (1, 1, 1))), gravity_mass(),
      constant_wrench(force: (1, 0, 0), frame: world) ] ),
  ( shape: compound(parts: [ (shape: capsule(radius: 1, half_height: 2), density: 10), (shape: point, mass: 1) ]) ),
  ( fixed: true, shape: ellipsoid(radii: (1, 2, 3)) ) ],
  gears: [ (joints: ("a", "b"), ratio: 2.5), (joints: ["b", "a"], axes: (linear_y, angular_y), ratio: 1, offset: 0.5) ],
  joints: [ ( name: "a", between: ("brick", "body-2"), universal: (at: (1, 2, 2), axis: (0, 1, 0)), limits: (angular_y: (-1, 1)),
      drives: [ (axes: [angular_x], position: 1, frequency: 3) ], friction: (angular_y: 1), break: (torque: 5) ),
    ( between: ["body-1", "body-2"], free: (at: (0, 0, 0)), limits: (cone: (1, 2), distance: (max: 3, frequency: 2)) ),
    ( name: "b", between: ("body-1", "brick"), planar: (at: (0, 1, 0), axis: (0, 1, 1)) ) ] )"#;

/// What slips of fingers and hostile minds put in the place of something else.
const NASTY: [&str; 22] = [
    "NaN",
    "-1",
    "0",
    "1e308",
    "-1e308",
    "1e-308",
    "1e999",
    "null",
    "[]",
    "{}",
    "()",
    "\"\"",
    "true",
    "inf",
    "1e38",
    "-0.0",
    "18446744073709551616",
    "\"\\u0000\"",
    "Some(1)",
    "[[[[",
    "\u{feff}",
    ",",
];

/// Replaces a stretch of a text, given as fractions of its length.
#[derive(Clone, Debug)]
struct Edit {
    at: f64,
    length: usize,
    with: String,
}

fn edit() -> impl Strategy<Value = Edit> {
    let nasty = prop::sample::select(NASTY.to_vec()).prop_map(str::to_owned);
    let with = prop_oneof![4 => nasty, 1 => "\\PC{0,6}", 1 => Just(String::new())];
    (0.0..1.0, 0_usize..12, with).prop_map(|(at, length, with)| Edit { at, length, with })
}

/// Half of the edits hit whole numbers and words, where most mistakes are made.
fn apply(text: &str, edits: &[Edit]) -> String {
    let mut characters: Vec<char> = text.chars().collect();
    for edit in edits {
        let mut start = (edit.at * characters.len() as f64) as usize;
        let mut end = (start + edit.length).min(characters.len());
        if edit.length % 2 == 0 {
            let word = |character: &char| character.is_alphanumeric() || "+-._\"".contains(*character);
            start -= characters[..start].iter().rev().take_while(|character| word(character)).count();
            end = start + characters[start..].iter().take_while(|character| word(character)).count();
        }
        characters.splice(start..end, edit.with.chars());
    }
    characters.into_iter().collect()
}

fn check(scene: Result<Scene, SceneError>) -> Result<(), TestCaseError> {
    match scene {
        Ok(scene) => {
            let mut simulation = tumble::Simulation::new(scene.settings).unwrap();
            let mut world = hecs::World::new();
            scene.spawn(&mut world).unwrap();
            simulation.step(&mut world);
            simulation.step(&mut world);
        }
        Err(error) => {
            let message = error.to_string();
            prop_assert!(message.starts_with("scene.x: "), "{message}");
            prop_assert!(!message.chars().any(char::is_control), "{message:?}");
            prop_assert!(message.len() < 10_000, "{message}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_json(edits in prop::collection::vec(edit(), 1..4)) {
        let text = apply(JSON, &edits);
        check(Scene::from_json(&text, "scene.x"))?;
        drop(Audit::from_json(&text, "scene.x"));
    }

    #[test]
    fn mutated_ron(edits in prop::collection::vec(edit(), 1..4)) {
        check(Scene::from_ron(&apply(RON, &edits), "scene.x"))?;
    }

    #[test]
    fn arbitrary_text(text in "\\PC{0,200}") {
        check(Scene::from_json(&text, "scene.x"))?;
        check(Scene::from_ron(&text, "scene.x"))?;
    }
}

proptest! {
    // Each case writes a file.
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300), ron: bool) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join(if ron { "scene.ron" } else { "scene.json" });
        std::fs::write(&path, &bytes).unwrap();
        if let Err(error) = Scene::load(&path) {
            prop_assert!(!error.to_string().contains('\n'));
        }
    }
}

/// A `.glb` of this text, with a chunk of the bytes that its buffer is to have.
fn glb(text: &str) -> Vec<u8> {
    let mut json = text.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let buffer = std::fs::read(format!("{SCENES}/tetrahedron data.bin")).unwrap();
    let chunk = |kind: &[u8], content: &[u8]| [&(content.len() as u32).to_le_bytes()[..], kind, content].concat();
    let chunks = [chunk(b"JSON", &json), chunk(b"BIN\0", &buffer)].concat();
    [&b"glTF\x02\0\0\0"[..], &(chunks.len() as u32 + 12).to_le_bytes(), &chunks].concat()
}

const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/gltf_scenes");

/// One file with its buffer in the text, one whose buffer is to be in a binary chunk, and one of
/// joints.
fn gltf_texts() -> [String; 3] {
    let read = |name: &str| std::fs::read_to_string(format!("{SCENES}/{name}")).unwrap();
    let omi = read("omi.gltf").replace(r#", "uri": "tetrahedron%20data.bin""#, "");
    [read("everything.gltf"), omi, read("joints.gltf")]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_gltf(edits in prop::collection::vec(edit(), 1..4)) {
        let [text, binary, joints] = gltf_texts().map(|text| apply(&text, &edits));
        check(Scene::from_gltf(text.as_bytes(), "scene.x"))?;
        check(Scene::from_gltf(&glb(&binary), "scene.x"))?;
        check(Scene::from_gltf(joints.as_bytes(), "scene.x"))?;
    }

    #[test]
    fn mutated_bytes_of_gltf(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut in any::<prop::sample::Index>(), whole: bool) {
        let [text, binary, joints] = gltf_texts();
        for mut bytes in [text.into_bytes(), glb(&binary), joints.into_bytes()] {
            for (at, byte) in &changes {
                let at = at.index(bytes.len());
                bytes[at] = *byte;
            }
            let length = if whole { bytes.len() } else { cut.index(bytes.len()) };
            check(Scene::from_gltf(&bytes[..length], "scene.x"))?;
        }
    }
}

#[test]
fn the_unmutated_scenes_are_good() {
    // Without this the tests above could pass on texts that are refused at the first letter.
    assert_eq!(Scene::from_json(JSON, "scene.x").unwrap().body_count(), 5);
    assert_eq!(Scene::from_ron(RON, "scene.x").unwrap().body_count(), 3);
    let [text, binary, joints] = gltf_texts();
    assert_eq!(Scene::from_gltf(text.as_bytes(), "scene.x").unwrap().body_count(), 17);
    assert_eq!(Scene::from_gltf(&glb(&binary), "scene.x").unwrap().body_count(), 4);
    assert_eq!(Scene::from_gltf(joints.as_bytes(), "scene.x").unwrap().body_count(), 7);
}
