//! Errors of the files of sweeps, and the lock on a file.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use tumble_import::printable;

/// Why a sweep's file cannot be used. `Display` is one line that names the file.
///
/// ```
/// use tumble_sweep::{SweepFileError, SweepReader};
///
/// let error = SweepReader::open("missing.csv".as_ref()).unwrap_err();
/// assert!(matches!(error, SweepFileError::Io { .. }));
/// assert!(error.to_string().starts_with("missing.csv: "));
/// ```
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum SweepFileError {
    /// The system refuses.
    #[error("{path}: {error}", path = shown(.path))]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// It is something else.
    #[error("{path}: is not the file of a sweep: {}", printable(.problem), path = shown(.path))]
    NotASweep {
        /// The file.
        path: PathBuf,
        /// Why not.
        problem: String,
    },
    /// It is the file of another sweep; what it has stays.
    #[error("{path}: is the file of another sweep: {}", printable(.difference), path = shown(.path))]
    Another {
        /// The file.
        path: PathBuf,
        /// What differs.
        difference: String,
    },
    /// A row before the last one is not what it must be.
    #[error("{path}: line {line} is damaged: {}", printable(.problem), path = shown(.path))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is wrong.
        problem: String,
    },
    /// Another program is writing to it.
    #[error("{path}: another tumble is writing to it", path = shown(.path))]
    Busy {
        /// The file.
        path: PathBuf,
    },
}

tumble_math::debug_as_display!(SweepFileError);

/// A path as a terminal may have it.
pub(crate) fn shown(path: &Path) -> String {
    printable(&path.to_string_lossy())
}

impl SweepFileError {
    pub(crate) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        |error| Self::Io { path, error }
    }
}

/// One program at a time has a sweep's file, until it closes it.
pub(crate) fn lock(path: &Path, file: &File) -> Result<(), SweepFileError> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(SweepFileError::Busy { path: path.to_owned() }),
        // A file system without locks is no reason not to write.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}
