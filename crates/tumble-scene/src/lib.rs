//! Scene files for [`tumble`] in, trajectories and summaries out.
//!
//! A scene is settings and bodies, written as JSON or RON after one model, or what [glTF](gltf) and URDF files say. [`Scene::open`] reads and checks
//! it whole before anything is spawned, and a mistake is a [`SceneError`] of one line that names
//! file, body and field. [`Audit`] shows the mass properties and forces of every body,
//! [`TrajectoryWriter`] records states, [`Sweep`] makes many worlds of one scene, [`Summary`] is what a run reports and [`MomentumScale`] what it measures drift by, [`ReportPage`] the same as a page to look at, and
//! [`PendingFile`] makes files appear whole or not at all.
//!
//! ```
//! use tumble_scene::Scene;
//!
//! let scene = Scene::open("t-handle")?;
//! let mut simulation = tumble::Simulation::new(scene.settings)?;
//! let mut world = hecs::World::new();
//! scene.spawn(&mut world)?;
//! simulation.step(&mut world);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// On docs.rs items say which feature they need.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod gltf;

mod audit;
mod audit_collider;
mod audit_mesh;
mod builtin;
mod collider;
mod collider_model;
mod contact_scenes;
mod convert;
mod csv_cell;
mod distribution;
mod error;
mod field_path;
mod force;
mod force_model;
mod force_path;
mod inertia_repair;
mod limits;
mod looks;
mod mesh_file;
mod mesh_shape;
mod model;
mod momentum_scale;
mod outcome;
mod output;
mod parse;
mod plates;
mod plot;
mod portrait;
mod read;
mod reading;
mod recover;
mod report_page;
mod scene;
mod scene_body;
mod shard;
mod stress;
mod summary;
mod svg;
mod sweep;
mod sweep_error;
mod sweep_file;
mod sweep_identity;
mod terminal;
mod tessellation;
mod trajectory;
mod urdf;
mod vary;

pub use audit::{Audit, AuditedBody};
pub use audit_collider::AuditedCollider;
pub use audit_mesh::{MeshOptions, MeshRepairs};
pub use builtin::builtin_names;
pub use collider::{ColliderRole, SceneCollider};
pub use csv_cell::csv_cell;
pub use distribution::Distribution;
pub use error::{Place, SceneError};
pub use force::{Force, HullShape};
pub use inertia_repair::InertiaRepairs;
pub use limits::{
    MAX_BODIES, MAX_FILE_BYTES, MAX_HEIGHTS, MAX_HULL_POINTS, MAX_MESH, MAX_PARTS, MAX_STEPS, TIME_STEPS, step_count,
    steps_of_duration, time_step,
};
pub use looks::{BODY_COLORS, FIXED_COLOR, GROUND_COLOR, Heights, Looks};
pub use momentum_scale::MomentumScale;
pub use outcome::Outcome;
pub use output::PendingFile;
pub use parse::Format;
pub use plates::plates;
pub use plot::{Mark, Plot, Scale};
pub use report_page::{Replay, ReportPage};
pub use scene::{DEFAULT_STEPS, Names, Scene};
pub use shard::Shard;
pub use summary::{Conserved, Summary};
pub use sweep::{MAX_WORLDS, RunLength, Sweep, SweepPlan, SweepWorld};
pub use sweep_error::SweepError;
pub use sweep_file::{SweepFile, SweepFileError, SweepReader, sweep_header};
pub use sweep_identity::SweepIdentity;
pub use terminal::{printable, printable_json, printable_lines};
pub use tessellation::Tessellation;
pub use trajectory::{
    Animation, COLUMNS, Frame, STATE_COLUMNS, SurfaceSet, TrajectoryError, TrajectoryFormat, TrajectoryWriter,
    state_numbers,
};
pub use vary::Vary;
