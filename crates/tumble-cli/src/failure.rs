//! Why the program did not end with 0.

use std::path::Path;

use tumble_scene::SceneError;
use tumble_sweep::{MergeError, SeriesFileError, SweepError, SweepFileError};

/// Each variant has an exit code of its own.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// A scene, an option or an output that cannot be used; found before the first step.
    #[error("{0}")]
    Input(String),
    /// Something went wrong after the first step.
    #[error("{0}")]
    Running(String),
    /// Ctrl-C; everything is finished and reported already.
    #[error("interrupted")]
    Interrupted,
    /// The window's program ended with this code and said why.
    #[error("the window ended with exit code {0}")]
    Window(u8),
}

impl Failure {
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Running(_) => 1,
            Self::Input(_) => 2,
            // 128 + SIGINT, as shells have it.
            Self::Interrupted => 130,
            Self::Window(code) => *code,
        }
    }

    /// An output that cannot be opened.
    pub(crate) fn opening(path: &Path, error: &std::io::Error) -> Self {
        Self::Input(format!("{}: cannot be written: {error}", path.display()))
    }

    /// An output that was open and failed.
    pub(crate) fn writing(path: &Path, error: &std::io::Error) -> Self {
        Self::Running(format!("{}: writing failed: {error}", path.display()))
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        Self::Input(error.to_string())
    }
}

/// Found when the file is opened; what goes wrong later is to be made a failure while running.
impl From<SweepFileError> for Failure {
    fn from(error: SweepFileError) -> Self {
        use std::io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull, WriteZero};
        match &error {
            // Not the fault of what was asked for: the file could be opened, and the disk is full.
            SweepFileError::Io { error: io, .. }
                if matches!(io.kind(), FileTooLarge | QuotaExceeded | StorageFull | WriteZero) =>
            {
                Self::Running(error.to_string())
            }
            _ => Self::Input(error.to_string()),
        }
    }
}

impl From<SeriesFileError> for Failure {
    fn from(error: SeriesFileError) -> Self {
        match error {
            SeriesFileError::Busy(error) => error.into(),
            SeriesFileError::Write { .. } => Self::Running(error.to_string()),
            _ => Self::Input(error.to_string()),
        }
    }
}

impl From<MergeError> for Failure {
    fn from(error: MergeError) -> Self {
        match error {
            MergeError::File(error) => error.into(),
            MergeError::Write { .. } => Self::Running(error.to_string()),
            _ => Self::Input(error.to_string()),
        }
    }
}
