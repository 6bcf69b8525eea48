//! Why the program did not end with 0.

use std::path::Path;

/// Each variant has an exit code of its own.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// A scene, an option or an output that cannot be used.
    #[error("{0}")]
    Input(String),
    /// There is no window, or something went wrong while it was open.
    #[error("{0}")]
    Running(String),
}

impl Failure {
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Running(_) => 1,
            Self::Input(_) => 2,
        }
    }

    pub(crate) fn writing(path: &Path, error: &dyn std::error::Error) -> Self {
        Self::Running(format!("{}: writing failed: {error}", path.display()))
    }
}

impl From<tumble_scene::SceneError> for Failure {
    fn from(error: tumble_scene::SceneError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<crate::gpu::GpuError> for Failure {
    fn from(error: crate::gpu::GpuError) -> Self {
        Self::Running(error.to_string())
    }
}
