//! Scenes for [`tumble`]: what to simulate, from files or built in.
//!
//! A scene is settings and bodies with forces, written as JSON or RON after one model, or what glTF
//! and URDF files say, which [`tumble_import`] reads. [`Scene::open`] reads and checks it whole
//! before anything is spawned, and a mistake is a [`SceneError`] of one line that names file, body
//! and field. [`Audit`] shows the mass properties and forces of every body, and [`VariedScene`]
//! makes worlds of one scene that differ in some of its numbers.
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

mod alike;
mod audit;
mod bodies;
mod builtin;
mod convert;
mod error;
mod fields;
mod limits;
mod model;
mod scene;
mod values;
mod written;

pub use audit::collider::AuditedCollider;
pub use audit::joint::{
    AuditedBreak, AuditedDrive, AuditedFriction, AuditedGain, AuditedGear, AuditedJoint, AuditedLimit,
    AuditedOscillation,
};
pub use audit::mesh::{MeshOptions, MeshRepairs};
pub use audit::{Audit, AuditedBody, Up};
pub use bodies::force::{Force, HullShape};
pub use builtin::{builtin_names, builtin_scenes, nearest_builtin};
pub use error::SceneError;
pub use fields::field_path::FieldPath;
pub use fields::scene_template::{RunLength, RunOverrides, SceneTemplate};
pub use fields::varied_scene::{VariedScene, VariedWorld};
pub use limits::{MAX_BODIES, MAX_HEIGHTS, MAX_STEPS, TIME_STEPS, step_count, steps_of_duration, time_step};
pub use model::parse::Format;
pub use scene::body_names::BodyNames;
pub use scene::{DEFAULT_STEPS, Scene};
pub use written::{parse_count, parse_seconds};
