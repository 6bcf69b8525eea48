//! Sweeps of [`tumble`]: a scene with fields that differ from world to world, run and written to a
//! file.
//!
//! A [`SweepPlan`] names a scene and what varies in it, each [`SweepParameter`] by a
//! [`Distribution`]. [`Sweep::row`] runs one world to a [`Row`]; worlds depend on nothing but the
//! plan and their index, so they may be run in any order, on any threads and machines. A
//! [`SweepFile`] takes the rows in order and goes on where it ended, a [`SeriesFile`] has the
//! states on the way, and a [`SweepIdentity`] says what the rows depend on. Machines share a sweep
//! by [`Shard`]s, which [`Merge`] puts together; [`SweepReader`] reads a file.
//!
//! ```
//! use tumble_sweep::{Sweep, SweepPlan};
//!
//! let plan = SweepPlan {
//!     scene: "t-handle".into(),
//!     vary: vec!["bodies.0.angular_velocity.1=0..5".parse()?],
//!     worlds: Some(3),
//!     seed: 7,
//!     ..SweepPlan::default()
//! };
//! let sweep = Sweep::new(plan)?;
//! let mut table = sweep.columns().join(",") + "\n";
//! for world in 0..sweep.worlds() {
//!     table += &sweep.row(world, &|| false).expect("nothing stops it").text;
//! }
//! assert!(table.starts_with("world,bodies.0.angular_velocity.1,outcome,steps_taken,time,"));
//! assert_eq!(table.lines().count(), 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod distribution;
mod distribution_error;
mod error;
mod file_error;
mod identity;
mod merge;
mod merge_error;
mod observation;
mod parameter;
mod reader;
mod row;
mod run_status;
mod series;
mod series_file;
mod shard;
mod sweep;
mod sweep_file;
mod sweep_plan;

pub use distribution::Distribution;
pub use distribution_error::DistributionError;
pub use error::SweepError;
pub use file_error::SweepFileError;
pub use identity::SweepIdentity;
pub use merge::Merge;
pub use merge_error::MergeError;
pub use parameter::{ParameterError, SweepParameter};
pub use reader::SweepReader;
pub use row::Row;
pub use run_status::RunStatus;
pub use series_file::{SeriesFile, SeriesFileError};
pub use shard::{Shard, ShardError};
pub use sweep::Sweep;
pub use sweep_file::SweepFile;
pub use sweep_plan::{MAX_WORLDS, SweepPlan};
