//! Errors of trajectory recording.

use std::io;

/// Why a frame was not recorded.
///
/// ```
/// use tumble_record::TrajectoryError;
///
/// let error = TrajectoryError::TooLarge { bodies: 1_000_000, frames: 1000, bytes: 32 << 30 };
/// assert!(error.to_string().starts_with("1000000 bodies in 1000 frames are 32.0 GiB"));
/// ```
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// The writer failed.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// A binary glTF holds 4 GiB, and the run has more; found with the first frame.
    #[error(
        "{bodies} bodies in {frames} frames are {gigabytes:.1} GiB, a .glb holds 4: record fewer steps (--every), or a .csv",
        gigabytes = *bytes as f64 / f64::from(1_u32 << 30)
    )]
    TooLarge {
        /// How many.
        bodies: u64,
        /// Recorded steps.
        frames: u64,
        /// Size of the whole file, or of what it has at least.
        bytes: u64,
    },
}

/// As it is displayed, so that a `main` that returns it ends with a sentence.
impl std::fmt::Debug for TrajectoryError {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, formatter)
    }
}
