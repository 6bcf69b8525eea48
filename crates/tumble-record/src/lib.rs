//! What a run of [`tumble`] leaves: records, animations, summaries, plots, drawings and reports.
//!
//! [`TrajectoryWriter`] records the states of the bodies of a [`Scene`](tumble_scene::Scene) as
//! CSV, Parquet or animated glTF, so that the file can be read at any moment. [`Summary`] is what a
//! run reports, [`Drift`] how well it kept energy and momentum, [`Plot`] is a picture of series,
//! [`body_drawing`] one of a body, and [`ReportPage`] a page that shows all of it with a
//! [`Replay`]. [`PendingFile`] makes files appear whole or not at all.
//!
//! ```
//! use tumble_record::{Frame, TrajectoryWriter};
//! use tumble_scene::Scene;
//!
//! let scene = Scene::open("t-handle")?;
//! let mut simulation = tumble::Simulation::new(scene.settings)?;
//! let mut world = hecs::World::new();
//! let names = scene.spawn(&mut world)?;
//! let order = tumble::BodyOrder::of(&world);
//! let mut record = TrajectoryWriter::csv(std::io::Cursor::new(Vec::new()))?;
//! for step in 0..=10 {
//!     record.record(&Frame {
//!         step,
//!         time: simulation.time(),
//!         world: &world,
//!         order: &order,
//!         names: &names,
//!     })?;
//!     simulation.step(&mut world);
//! }
//! assert!(record.finish()?.into_inner().starts_with(b"step,time,body,"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// On docs.rs items say which feature they need.
#![cfg_attr(docsrs, feature(doc_cfg))]

mod body_drawing;
mod colors;
mod csv_cell;
mod drift;
mod energy_plots;
mod energy_scale;
mod ground_patches;
mod kept;
mod momentum_scale;
mod pending_file;
mod plot;
mod report_page;
mod summary;
mod svg;
mod trajectory;

pub use body_drawing::body_drawing;
pub use colors::{BODY_COLORS, FIXED_COLOR, GROUND_COLOR};
pub use csv_cell::csv_cell;
pub use drift::{Drift, NotFinite};
pub use energy_plots::{drift_plot, energy_plot};
pub use energy_scale::energy_scale;
pub use ground_patches::ground_patches;
pub use kept::Kept;
pub use momentum_scale::MomentumScale;
pub use pending_file::PendingFile;
pub use plot::axis::Scale;
pub use plot::{Plot, SeriesStyle};
pub use report_page::ReportPage;
pub use report_page::replay::Replay;
pub use summary::{Conserved, Summary};
pub use trajectory::error::TrajectoryError;
pub use trajectory::format::TrajectoryFormat;
pub use trajectory::frame::Frame;
pub use trajectory::glb::Animation;
pub use trajectory::glb::geometry::SurfaceSet;
pub use trajectory::{COLUMNS, STATE_COLUMNS, TrajectoryWriter, state_numbers};
