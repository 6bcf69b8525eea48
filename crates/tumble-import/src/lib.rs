//! Files of others to neutral bodies: glTF 2.0 with physics, URDF robots, OBJ and STL meshes.
//!
//! There is no scene here and nothing that is run: an [`ImportedBody`] is the engine's description
//! of a body with its collider and its [`Appearance`], under the name that its file gives it, an
//! [`ImportedJoint`] that of a joint between two of them, an [`ImportedGear`] that of a gear
//! between two joints. [`gltf::GltfBodies`] and [`Robot`] read bodies, [`MeshFile`] reads
//! triangles. Files are taken to be hostile: every count, size and index is limited or checked
//! before it is used, and a mistake is a [`FileError`] of one line that names file and field.
//!
//! What `tumble-scene` shares with the importers is here too: these bodies, the surfaces that they
//! are seen by ([`Tessellation`]), the [checks](checked) of single values, and the way in which a
//! name from a file may be shown ([`printable`]).
//!
//! ```
//! use tumble_import::{InertiaRepairs, Robot};
//!
//! let text = r#"<robot name="brick"> <link name="base"> <inertial>
//!     <mass value="2"/> <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/>
//! </inertial> </link> </robot>"#;
//! let robot = Robot::from_text(text, "brick.urdf", InertiaRepairs::Refused)?;
//! let mut world = hecs::World::new();
//! for link in robot.links {
//!     let link = link.body.map_err(|problems| problems[0].to_string())?;
//!     link.body.spawn(&mut world);
//! }
//! assert_eq!(world.len(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bodies;
pub mod checked;
mod combine_rule;
mod error;
pub mod gltf;
mod inertia_repair;
mod limits;
mod mesh_file;
mod named_files;
mod read_file;
mod terminal;
mod tessellation;
mod urdf;

pub use bodies::appearance::{Appearance, Heights};
pub use bodies::imported_body::ImportedBody;
pub use bodies::imported_collider::{ColliderRole, ImportedCollider};
pub use bodies::imported_gear::ImportedGear;
pub use bodies::imported_joint::ImportedJoint;
pub use combine_rule::CombineName;
pub use error::{FieldError, FileError, Place, Scope};
pub use inertia_repair::InertiaRepairs;
pub use limits::{MAX_FILE_BYTES, MAX_HULL_POINTS, MAX_MESH, MAX_PARTS};
pub use mesh_file::{MeshFile, MeshFormat};
pub use named_files::{Reading, beside};
pub use read_file::{read_bytes, read_text};
pub use terminal::{one_line, printable, printable_json, printable_lines, shortest};
pub use tessellation::{POINT_RADIUS, Tessellation};
pub use urdf::{Robot, RobotLink};
