//! Scene files for [`tumble`] in, trajectories and summaries out.
//!
//! A scene is settings and bodies, written as JSON or RON after one model, or what [glTF](tumble_import::gltf) and
//! URDF files say. [`Scene::open`] reads and checks it whole before anything is spawned, and a
//! mistake is a [`SceneError`] of one line that names file, body and field. [`Audit`] shows the
//! mass properties and forces of every body, [`TrajectoryWriter`] records states, [`Sweep`] makes
//! many worlds of one scene, [`Summary`] is what a run reports and [`MomentumScale`] what it
//! measures drift by, [`ReportPage`] the same as a page to look at, and [`PendingFile`] makes files
//! appear whole or not at all.
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

mod bodies;
mod error;
mod error_context;
mod limits;
mod pending_file;
mod record;
mod scene;
mod sweep;
mod values;

pub use bodies::force::{Force, HullShape};
pub use error::SceneError;
pub use limits::{MAX_BODIES, MAX_HEIGHTS, MAX_STEPS, TIME_STEPS, step_count, steps_of_duration, time_step};
pub use pending_file::PendingFile;
pub use record::colors::{BODY_COLORS, FIXED_COLOR, GROUND_COLOR};
pub use record::csv_cell::csv_cell;
pub use record::plot::axis::Scale;
pub use record::plot::{Plot, SeriesStyle};
pub use record::report_page::ReportPage;
pub use record::report_page::replay::Replay;
pub use record::run_status::RunStatus;
pub use record::summary::{Conserved, Summary};
pub use record::trajectory::error::TrajectoryError;
pub use record::trajectory::format::TrajectoryFormat;
pub use record::trajectory::frame::Frame;
pub use record::trajectory::glb::Animation;
pub use record::trajectory::glb::geometry::SurfaceSet;
pub use record::trajectory::{COLUMNS, STATE_COLUMNS, TrajectoryWriter, state_numbers};
pub use scene::audit::{Audit, AuditedBody};
pub use scene::audit_collider::AuditedCollider;
pub use scene::audit_mesh::{MeshOptions, MeshRepairs};
pub use scene::body_names::BodyNames;
pub use scene::builtin::builtin_names;
pub use scene::ground_patches::ground_patches;
pub use scene::momentum_scale::MomentumScale;
pub use scene::parse::Format;
pub use scene::{DEFAULT_STEPS, Scene};
pub use sweep::distribution::Distribution;
pub use sweep::shard::Shard;
pub use sweep::sweep_error::SweepError;
pub use sweep::sweep_file::{SweepFile, SweepFileError, SweepReader, sweep_header};
pub use sweep::sweep_identity::SweepIdentity;
pub use sweep::sweep_parameter::SweepParameter;
pub use sweep::{MAX_WORLDS, RunLength, Sweep, SweepPlan, SweepWorld};
