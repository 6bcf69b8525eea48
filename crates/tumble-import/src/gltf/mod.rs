//! glTF 2.0 with physics: the drafts KHR_physics_rigid_bodies and KHR_implicit_shapes, and
//! OMI_physics_body with its companions.
//!
//! [`Physics`] is what a file says, in the world's frame and with every default filled in;
//! [`GltfBodies`] is the bodies that it makes. Of colliders the engine's are made where
//! it has their like; filters are read and kept. Joints are between the bodies.
//!
//! ```
//! use tumble_import::gltf::Physics;
//!
//! let physics = Physics::from_json(
//!     r#"{ "asset": { "version": "2.0" }, "nodes": [
//!      { "rotation": [0, 0.7071068, 0, 0.7071068], "children": [1] },
//!      { "name": "ball", "extensions": { "KHR_physics_rigid_bodies": { "motion": { "mass": 2,
//!          "linearVelocity": [0, 0, 1] } } } } ] }"#,
//!     "ball.gltf",
//! )?;
//! let ball = &physics.nodes[0];
//! assert!((ball.linear_velocity().x - 1.0).abs() < 1e-6); // in the node's frame
//! # Ok::<(), tumble_import::FileError>(())
//! ```

pub(crate) mod bodies;
pub(crate) mod buffers;
pub(crate) mod collider;
pub(crate) mod container;
pub(crate) mod document;
pub(crate) mod geometry;
pub(crate) mod groups;
pub(crate) mod joint;
pub(crate) mod joint_axes;
pub(crate) mod joints;
pub(crate) mod motion;
pub(crate) mod moving;
pub(crate) mod physics;
pub(crate) mod solid;
pub(crate) mod tree;
pub(crate) mod triangles;
pub(crate) mod unsupported;
#[cfg(test)]
mod work_tests;

use std::path::{Path, PathBuf};

use tumble_math::TriangleMesh;

pub use crate::bodies::collider_geometry::{Geometry, MeshSource};
pub use crate::bodies::surface_material::{CollisionFilter, SurfaceMaterial};
pub use crate::gltf::bodies::GltfBody;
pub use crate::gltf::joint::{Joint, JointDrive, JointLimit};
pub use crate::gltf::motion::{Motion, MotionKind};
pub use crate::gltf::physics::{Collider, JointTo, Physics, PhysicsNode, Trigger};
pub use tumble::CombineRule;

use crate::bodies::imported_joint::ImportedJoint;
use crate::error::{FieldError, FileError, Place};
use crate::gltf::buffers::Buffers;
use crate::gltf::document::Document;
use crate::gltf::tree::Tree;
use crate::gltf::triangles::Triangles;
use crate::inertia_repair::InertiaRepairs;
use crate::limits::MAX_FILE_BYTES;
use crate::named_files::Reading;
use crate::read_file::read_bytes;
use crate::terminal::one_line;

/// What a file comes to, body by body.
///
/// ```
/// use tumble_import::InertiaRepairs;
/// use tumble_import::gltf::GltfBodies;
///
/// let text = r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "name": "ball", "extensions": { "KHR_physics_rigid_bodies": { "motion": { "mass": 2 } } }
///     } ] }"#;
/// let file = GltfBodies::from_bytes(text.as_bytes(), None, "ball.gltf", InertiaRepairs::Refused)?;
/// assert_eq!(file.bodies[0].name, "ball");
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug)]
pub struct GltfBodies {
    /// What the scene in the file is called, if it says so.
    pub name: Option<String>,
    /// The bodies, the impossible ones too.
    pub bodies: Vec<GltfBody>,
    /// What connects them.
    pub joints: Vec<ImportedJoint>,
    /// What is read and not simulated, or was decided: a line each.
    pub notices: Vec<String>,
    /// The files that were read.
    pub files: Vec<PathBuf>,
}

impl GltfBodies {
    /// Reads a `.gltf` or `.glb` file whole: its physics, and the meshes that its colliders need.
    ///
    /// # Errors
    /// [`FileError`], whose message names file, node and field.
    pub fn open(path: &Path, repairs: InertiaRepairs) -> Result<Self, FileError> {
        let mut reading = Reading::default();
        let bytes = reading.file(path)?;
        Self::read(&bytes, path.parent(), &path.to_string_lossy(), (reading, repairs))
    }

    /// As [`open`](Self::open), from bytes; `file` is what messages call them, and files that the
    /// document names are looked for in `directory`.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn from_bytes(
        bytes: &[u8],
        directory: Option<&Path>,
        file: &str,
        repairs: InertiaRepairs,
    ) -> Result<Self, FileError> {
        Self::read(bytes, directory, file, (Reading::default(), repairs))
    }

    fn read(
        bytes: &[u8],
        directory: Option<&Path>,
        file: &str,
        (mut reading, repairs): (Reading, InertiaRepairs),
    ) -> Result<Self, FileError> {
        let read = File::read(bytes, file)?;
        let mut triangles = read.triangles(directory, &mut reading);
        let (bodies, joints, told) = bodies::bodies((&read.physics, &read.tree), &mut triangles, repairs);
        let mut notices = [read.physics.notices.as_slice(), &told].concat();
        notices.extend(triangles.notices);
        if bodies.is_empty() {
            notices.push("no node of the scene has a motion or a collider: there are no bodies".to_owned());
        }
        let notices = notices.iter().map(|notice| one_line(notice)).collect();
        let scene = read.document.scenes.get(read.document.scene.unwrap_or(0));
        Ok(Self {
            name: scene.and_then(|scene| scene.name.clone()),
            bodies,
            joints,
            notices,
            files: reading.into_files(),
        })
    }
}

impl Physics {
    /// Reads the physics of a `.gltf` or `.glb` file. Buffers are not read.
    ///
    /// # Errors
    /// [`FileError`], whose message names file, node and field.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        let file = path.to_string_lossy();
        let bytes = read_bytes(path, MAX_FILE_BYTES)?;
        Self::from_bytes(&bytes, &file)
    }

    /// Reads the physics of a document in JSON text; `file` is what messages call it.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn from_json(text: &str, file: &str) -> Result<Self, FileError> {
        Self::from_bytes(text.as_bytes(), file)
    }

    /// Reads the physics of a document's bytes, binary or text; `file` is what messages call it.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn from_bytes(bytes: &[u8], file: &str) -> Result<Self, FileError> {
        Ok(File::read(bytes, file)?.physics)
    }
}

/// A document that has been read and checked, and what lies beside it.
struct File<'a> {
    document: Document,
    binary: Option<&'a [u8]>,
    tree: Tree,
    physics: Physics,
}

impl<'a> File<'a> {
    fn read(bytes: &'a [u8], file: &str) -> Result<Self, FileError> {
        let refused = |error| invalid(file, error);
        let container = container::open(bytes).map_err(|problem| refused(FieldError::new("", problem)))?;
        let document = parse(&container.json, file)?;
        unsupported::refuse(&document).map_err(refused)?;
        let tree = Tree::of(&document).map_err(refused)?;
        let mut physics = Physics::of(&document, &tree).map_err(refused)?;
        physics.notices = unsupported::notices(&document, &tree, &physics);
        Ok(Self { document, binary: container.binary, tree, physics })
    }

    /// Its meshes; files that it names are looked for in `directory`.
    fn triangles<'b>(&'b self, directory: Option<&'b Path>, reading: &'b mut Reading) -> Triangles<'b> {
        Triangles::new(&self.document, Buffers::new(&self.document, directory, self.binary, reading))
    }
}

/// All triangles of a file's scene, in the world's frame, physics or not, and what is not read.
pub(crate) fn mesh(path: &Path, reading: &mut Reading) -> Result<(TriangleMesh, Vec<String>), FileError> {
    let file = path.to_string_lossy();
    let bytes = reading.file(path)?;
    let read = File::read(&bytes, &file)?;
    let mut triangles = read.triangles(path.parent(), reading);
    let mesh = triangles.of_scene(&read.tree).map_err(|error| invalid(&file, error))?;
    Ok((mesh, triangles.notices.into_iter().collect()))
}

/// Most objects and most strings of a document. An empty object takes two bytes of a file and a
/// hundred times that of memory.
const MAX_OBJECTS: usize = 2_000_000;
const MAX_STRINGS: usize = 20_000_000;

fn parse(json: &str, file: &str) -> Result<Document, FileError> {
    let count = |wanted: u8| json.bytes().filter(|byte| *byte == wanted).count();
    for (what, most, found) in [("objects", MAX_OBJECTS, count(b'{')), ("strings", MAX_STRINGS, count(b'"') / 2)] {
        if found > most {
            return Err(invalid(file, FieldError::new("", format!("has more than {most} {what}"))));
        }
    }
    let mut deserializer = serde_json::Deserializer::from_str(json);
    let malformed = |field: String, problem: &serde_json::Error| FileError::Malformed {
        file: one_line(file),
        place: Place { body: None, field },
        problem: one_line(&problem.to_string()),
    };
    let parsed: Result<Document, _> = serde_path_to_error::deserialize(&mut deserializer);
    let document = parsed.map_err(|error| malformed(path(&error.path().to_string()), error.inner()))?;
    deserializer.end().map_err(|error| malformed(String::new(), &error))?;
    Ok(document)
}

/// The whole document has no path.
fn path(path: &str) -> String {
    if path == "." { String::new() } else { path.to_owned() }
}

fn invalid(file: &str, error: FieldError) -> FileError {
    error.in_file(file, None)
}
