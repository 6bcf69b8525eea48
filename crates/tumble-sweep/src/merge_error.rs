//! Errors of putting the shards of a sweep together.

use std::io;
use std::path::PathBuf;

use tumble_import::printable;

use crate::file_error::{SweepFileError, shown};
use crate::shard::Shard;

/// Why shards cannot be put together. `Display` is a sentence that names the file or the shard.
///
/// ```
/// use tumble_sweep::{Merge, MergeError};
///
/// let error = Merge::open("whole.csv".as_ref(), &[]).unwrap_err();
/// assert!(matches!(error, MergeError::NoShards));
/// assert_eq!(error.to_string(), "there is no shard");
/// ```
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// A file cannot be used.
    #[error(transparent)]
    File(#[from] SweepFileError),
    /// None was named.
    #[error("there is no shard")]
    NoShards,
    /// A file has all worlds.
    #[error("{path}: is a whole sweep already, not a shard", path = shown(.path))]
    Whole {
        /// The file.
        path: PathBuf,
    },
    /// Two files are of different sweeps.
    #[error(
        "{path}: is of another sweep than {first}: {}",
        printable(.difference),
        path = shown(.path),
        first = shown(.first)
    )]
    Another {
        /// The file.
        path: PathBuf,
        /// The first of the files.
        first: PathBuf,
        /// What differs.
        difference: String,
    },
    /// A file is of a sweep in more or fewer parts than another.
    #[error("{path}: is shard {shard}, and others are of {count}", path = shown(.path))]
    OtherCount {
        /// The file.
        path: PathBuf,
        /// What it is.
        shard: Shard,
        /// How many parts others have.
        count: u64,
    },
    /// Two files are the same shard.
    #[error("{path}: is shard {shard}, which is there twice", path = shown(.path))]
    Twice {
        /// One of them.
        path: PathBuf,
        /// Which.
        shard: Shard,
    },
    /// No file is this shard.
    #[error("shard {index}/{count} is missing")]
    Missing {
        /// Which, from 1.
        index: u64,
        /// Of how many.
        count: u64,
    },
    /// A shard would be replaced by the whole.
    #[error("{path}: is a shard itself, it cannot be the whole", path = shown(.path))]
    IsShard {
        /// The file.
        path: PathBuf,
    },
    /// The sweep of a shard is not finished.
    #[error("{path}: has {has} of its {all} worlds, its sweep is not finished", path = shown(.path))]
    Unfinished {
        /// The file.
        path: PathBuf,
        /// Worlds with a row.
        has: u64,
        /// Worlds of the shard.
        all: u64,
    },
    /// The system does not let the whole be opened.
    #[error("{path}: cannot be written: {error}", path = shown(.path))]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// The system refuses what is written.
    #[error("{path}: writing failed: {error}", path = shown(.path))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

tumble_math::debug_as_display!(MergeError);
