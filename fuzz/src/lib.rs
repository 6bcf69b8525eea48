//! What the targets do with their bytes: a file of that ending, opened in all the ways there are;
//! or a pair of shapes.

pub mod casts;
pub mod pairs;

use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;

use tumble::Simulation;
use tumble_record::body_drawing;
use tumble_scene::{Audit, MeshOptions, MeshRepairs, Scene};

/// Most bodies of a scene that is stepped.
const MAX_STEPPED: usize = 16;

/// A directory of this process, with what the seeds refer to.
fn directory() -> &'static tempfile::TempDir {
    static DIRECTORY: OnceLock<tempfile::TempDir> = OnceLock::new();
    DIRECTORY.get_or_init(|| {
        let directory = tempfile::tempdir().expect("there is room for a directory");
        let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../crates/tumble-scene/tests/gltf_scenes/tetrahedron data.bin");
        fs::copy(beside, directory.path().join("tetrahedron data.bin")).expect("the buffer of a seed can be copied");
        directory
    })
}

/// Spawns a scene; one of few bodies is stepped too, with its joints.
fn run(scene: Scene) {
    let (settings, count) = (scene.settings, scene.body_count());
    let mut world = hecs::World::new();
    if scene.spawn(&mut world).is_ok() && count <= MAX_STEPPED {
        let mut simulation = Simulation::new(settings).expect("the settings of a scene are checked");
        simulation.step_many(&mut world, 2);
    }
}

/// Opens the bytes as a file of this ending, audits, repairs and draws what is in it, and spawns
/// it. Whatever they are, there is to be a result or an error that names the file.
pub fn open(bytes: &[u8], ending: &str) {
    let path = directory().path().join(format!("input.{ending}"));
    fs::write(&path, bytes).expect("there is room for a file");
    let name = path.to_string_lossy();
    for repairs in [MeshRepairs::Refused, MeshRepairs::Made] {
        match Audit::open_with(&name, MeshOptions { density: 1.0, repairs }) {
            Ok(audit) => {
                for body in audit.bodies.iter().take(3) {
                    assert!(body_drawing(body).starts_with("<svg"));
                }
            }
            Err(error) => assert!(error.to_string().starts_with(&*name), "{error}"),
        }
    }
    match Scene::open(&name) {
        Ok(scene) => run(scene),
        Err(error) => assert!(error.to_string().starts_with(&*name), "{error}"),
    }
}
