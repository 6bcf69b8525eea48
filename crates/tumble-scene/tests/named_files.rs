//! A document reads what lies below its own directory, links included, and leaves out of a glTF
//! file what is impossible, by name.
//!
//! A scene of somebody else is opened to be inspected. It would fail if it could read what lies
//! elsewhere on the disk, if a file that is named a thousand times were read as often, or if one
//! bad body hid the others or went missing without a word.

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use tumble_import::{FileError, InertiaRepairs};
use tumble_scene::{Audit, MeshOptions, MeshRepairs, Scene, SceneError};

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// A directory with a scene's own in it: `scene`, and beside that what it is not to read.
fn place() -> (tempfile::TempDir, PathBuf) {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().join("scene");
    fs::create_dir_all(root.join("below")).unwrap();
    fs::create_dir(place.path().join("outside")).unwrap();
    fs::write(place.path().join("outside/secret.obj"), TETRAHEDRON).unwrap();
    fs::write(root.join("part.obj"), TETRAHEDRON).unwrap();
    fs::write(root.join("below/part.obj"), TETRAHEDRON).unwrap();
    (place, root)
}

fn scene(root: &Path, files: &[&str]) -> PathBuf {
    let body = |(index, file): (usize, &&str)| serde_json::json!({ "mass": 1, "shape": { "mesh": { "file": file, "scale": 1.0 + index as f64 } } });
    let bodies: Vec<_> = files.iter().enumerate().map(body).collect();
    let path = root.join("scene.json");
    fs::write(&path, serde_json::json!({ "bodies": bodies }).to_string()).unwrap();
    path
}

#[test]
fn meshes_lie_below_the_scene() {
    let (place, root) = place();
    assert!(Scene::load(&scene(&root, &["part.obj", "./part.obj", "below/part.obj", "./below/./part.obj"])).is_ok());
    let absolute = [place.path().join("outside/secret.obj"), root.join("part.obj")];
    let mut refused = vec!["../outside/secret.obj", "below/../../outside/secret.obj", "below/../part.obj"];
    refused.extend(absolute.iter().map(|path| path.to_str().unwrap()));
    for file in refused {
        let error = Scene::load(&scene(&root, &[file])).unwrap_err().to_string();
        assert!(error.contains("is not a path below the file's own directory"), "{file}: {error}");
    }
}

/// Links may be in what was unpacked or cloned: to a file, to a directory, through several.
#[cfg(unix)]
#[test]
fn links_lead_no_farther() {
    use std::os::unix::fs::symlink;
    let (place, root) = place();
    symlink("../part.obj", root.join("below/near.obj")).unwrap();
    symlink("../outside/secret.obj", root.join("far.obj")).unwrap();
    symlink("../outside", root.join("up")).unwrap();
    symlink("far.obj", root.join("twice.obj")).unwrap();
    assert!(Scene::load(&scene(&root, &["below/near.obj"])).is_ok());
    for file in ["far.obj", "up/secret.obj", "twice.obj"] {
        let error = Scene::load(&scene(&root, &[file])).unwrap_err().to_string();
        assert!(error.contains("is a link that leads out of the file's own directory"), "{file}: {error}");
    }
    // A buffer of a glTF file that is the scene, or that is a mesh of one.
    fs::write(place.path().join("outside/secret.bin"), [0; 36]).unwrap();
    symlink("../outside/secret.bin", root.join("link.bin")).unwrap();
    for uri in ["link.bin", "../outside/secret.bin", "%2e%2e/outside/secret.bin", "up/secret.bin"] {
        let gltf = serde_json::json!({ "asset": { "version": "2.0" },
            "nodes": [ { "mesh": 0, "extensions": { "KHR_physics_rigid_bodies": { "motion": {}, "collider": { "geometry": { "node": 0 } } } } } ],
            "meshes": [ { "primitives": [ { "attributes": { "POSITION": 0 } } ] } ],
            "accessors": [ { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" } ],
            "bufferViews": [ { "buffer": 0, "byteLength": 36 } ], "buffers": [ { "uri": uri, "byteLength": 36 } ] });
        fs::write(root.join("mesh.gltf"), gltf.to_string()).unwrap();
        for error in [Scene::load(&root.join("mesh.gltf")), Scene::load(&scene(&root, &["mesh.gltf"]))] {
            let error = error.unwrap_err().to_string();
            assert!(error.contains("the file's own directory"), "{uri}: {error}");
        }
    }
}

/// What was read is reported, for a program that is not to write over it; a file in twenty sizes
/// was read once.
#[test]
fn files_are_named_and_read_once() {
    let (_place, root) = place();
    let files: Vec<&str> = ["part.obj", "./part.obj", "below/part.obj"].into_iter().cycle().take(60).collect();
    let path = scene(&root, &files);
    let real = root.canonicalize().unwrap();
    let expected = [path.clone(), real.join("part.obj"), real.join("below/part.obj")];
    assert_eq!(Scene::load(&path).unwrap().files, expected);
    assert_eq!(Audit::open(path.to_str().unwrap()).unwrap().files, expected);
}

fn gltf(root: &Path, moments: &[[f64; 3]]) -> PathBuf {
    let node = |(index, moments): (usize, &[f64; 3])| {
        let motion = serde_json::json!({ "mass": 1 + index, "inertiaDiagonal": moments });
        serde_json::json!({ "name": format!("node {index}"), "extensions": { "KHR_physics_rigid_bodies": { "motion": motion } } })
    };
    let nodes: Vec<_> = moments.iter().enumerate().map(node).collect();
    let path = root.join("bodies.gltf");
    fs::write(&path, serde_json::json!({ "asset": { "version": "2.0" }, "nodes": nodes }).to_string()).unwrap();
    path
}

fn is_possible(moments: &[f64; 3]) -> bool {
    2.0 * moments.iter().copied().fold(0.0, f64::max) <= moments.iter().sum::<f64>() * (1.0 + 1e-7)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Of any bodies those that are possible are read, with their own ids, the others are named;
    /// repaired, all are there.
    #[test]
    fn impossible_bodies_are_left_out_or_repaired(
        moments in prop::collection::vec(prop::array::uniform3(0.1_f64..1.0), 1..12),
    ) {
        let place = tempfile::tempdir().unwrap();
        let path = gltf(place.path(), &moments);
        let possible: Vec<usize> = (0..moments.len()).filter(|&index| is_possible(&moments[index])).collect();
        match Scene::load(&path) {
            Err(error) => {
                prop_assert!(possible.is_empty());
                prop_assert!(error.to_string().contains("node \"node 0\"") && error.to_string().contains("--repair"), "{error}");
            }
            Ok(scene) => {
                prop_assert_eq!(scene.body_count(), possible.len());
                prop_assert_eq!(scene.left_out.len(), moments.len() - possible.len());
                for (index, _) in moments.iter().enumerate() {
                    let name = format!("\"node {index}\"");
                    let told = scene.notices.iter().any(|notice| notice.contains(&name) && notice.contains("left out"));
                    let error = scene.left_out.iter().any(|error| error.to_string().contains(&name));
                    prop_assert_eq!((told, error), (!possible.contains(&index), !possible.contains(&index)));
                }
                let mut world = hecs::World::new();
                let names = scene.spawn(&mut world).unwrap();
                let order = tumble::BodyOrder::of(&world);
                for (id, &index) in possible.iter().enumerate() {
                    prop_assert_eq!(names.of(id as u64), format!("node {index}"));
                    let body = world.entity(order.entities()[id]).unwrap();
                    prop_assert_eq!(*body.get::<&tumble::BodyId>().unwrap(), tumble::BodyId(id as u64));
                    // Whole numbers, exact in either precision.
                    prop_assert_eq!(body.get::<&tumble::Mass>().unwrap().kilograms() as usize, 1 + index);
                }
            }
        }
        let repaired = Scene::load_with(&path, InertiaRepairs::Made).unwrap();
        prop_assert_eq!(repaired.body_count(), moments.len());
        let options = MeshOptions { repairs: MeshRepairs::Made, ..MeshOptions::default() };
        let audit = Audit::open_with(path.to_str().unwrap(), options).unwrap();
        for (index, (body, given)) in audit.bodies.iter().zip(&moments).enumerate() {
            let told = audit.notices.iter().any(|notice| notice.contains(&format!("\"node {index}\"")) && notice.contains("repaired"));
            prop_assert_eq!(told, !possible.contains(&index));
            let (mut given, mut found) = (*given, body.principal.unwrap());
            given.sort_by(f64::total_cmp);
            found.sort_by(f64::total_cmp);
            let excess = (given[2] - given[1] - given[0]).max(0.0);
            // Those of single precision, in which the build may keep them.
            let expected = [given[0] + excess / 3.0, given[1] + excess / 3.0, given[2] - excess / 3.0];
            for (found, expected) in found.iter().zip(expected) {
                prop_assert!((found - expected).abs() < 1e-6, "{found} for {expected}");
            }
        }
    }
}

/// A robot's too, in the axes of its tensor.
#[test]
fn links_are_repaired_in_their_own_axes() {
    let (_place, root) = place();
    let path = root.join("robot.urdf");
    // Moments 0.1, 0.1 and 0.4 about axes turned by 45 degrees about z: the largest is in the plane
    // of x and y.
    let link = r#"<link name="wheel"><inertial><mass value="2"/><inertia ixx="0.25" ixy="0.15" ixz="0" iyy="0.25" iyz="0" izz="0.1"/></inertial></link>"#;
    fs::write(&path, format!(r#"<robot name="cart">{link}</robot>"#)).unwrap();
    assert!(matches!(Scene::load(&path), Err(SceneError::File(FileError::Link { .. }))));
    let scene = Scene::load_with(&path, InertiaRepairs::Made).unwrap();
    assert!(scene.notices.iter().any(|notice| notice.contains("\"wheel\"") && notice.contains("repaired")));
    let options = MeshOptions { repairs: MeshRepairs::Made, ..MeshOptions::default() };
    let tensor = Audit::open_with(path.to_str().unwrap(), options).unwrap().bodies[0].tensor.unwrap();
    // 1/6, 1/6 and 1/3 about the same axes.
    for (row, expected) in tensor.iter().zip([[0.25, 1.0 / 12.0, 0.0], [1.0 / 12.0, 0.25, 0.0], [0.0, 0.0, 1.0 / 6.0]])
    {
        for (found, expected) in row.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-14, "{tensor:?}");
        }
    }
}

/// What concerns the whole document refuses it: a buffer that is missing is no body's fault.
#[test]
fn a_missing_file_refuses_the_document() {
    let (_place, root) = place();
    let node = |mass: f64, geometry: serde_json::Value| {
        serde_json::json!({ "extensions": { "KHR_physics_rigid_bodies": {
        "motion": { "mass": mass }, "collider": { "geometry": geometry } } } })
    };
    let gltf = serde_json::json!({ "asset": { "version": "2.0" },
        "nodes": [ node(1.0, serde_json::json!({ "shape": 0 })), node(2.0, serde_json::json!({ "node": 2 })), { "mesh": 0 } ],
        "meshes": [ { "primitives": [ { "attributes": { "POSITION": 0 } } ] } ],
        "accessors": [ { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" } ],
        "bufferViews": [ { "buffer": 0, "byteLength": 36 } ], "buffers": [ { "uri": "missing.bin", "byteLength": 36 } ],
        "extensions": { "KHR_implicit_shapes": { "shapes": [ { "type": "box", "box": {} } ] } } });
    fs::write(root.join("a.gltf"), gltf.to_string()).unwrap();
    let error = Scene::load(&root.join("a.gltf")).unwrap_err().to_string();
    assert!(error.contains("missing.bin: cannot be read"), "{error}");
}

const MODELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");

#[test]
fn the_models_of_the_repository_are_read() {
    let files: Vec<_> = fs::read_dir(MODELS).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(files.len() >= 4);
    for file in files {
        let read = Scene::load_with(&file, InertiaRepairs::Made);
        assert!(read.is_ok_and(|scene| scene.body_count() > 0), "{}", file.display());
    }
}

/// What is struck wakes, and the other towers sleep on.
#[test]
fn the_towers_of_the_model_sleep() {
    let scene = Scene::load(&Path::new(MODELS).join("towers-asleep.json")).unwrap();
    let mut simulation = tumble::Simulation::new(scene.settings).unwrap();
    let (steps, mut world) = (scene.steps as u32, hecs::World::new());
    scene.spawn(&mut world).unwrap();
    simulation.step_many(&mut world, 60);
    assert_eq!(simulation.sleeping_bodies().count(), 30);
    let counts: Vec<_> = (60..steps)
        .map(|_| {
            simulation.step(&mut world);
            simulation.sleeping_bodies().count()
        })
        .collect();
    let least = counts.iter().copied().min().unwrap();
    assert!((15..30).contains(&least) && counts.last() == Some(&31), "{least} and {:?} at the end", counts.last());
}
