//! Errors of sweep construction.

use tumble_import::{FieldError, one_line, printable};

use crate::error::SceneError;

/// Why a sweep cannot be made. `Display` is one line that names the field.
///
/// ```
/// use tumble_scene::{Sweep, SweepError, SweepPlan};
///
/// let plan = SweepPlan { scene: "t-handle".into(), worlds: Some(1), bodies: vec!["anvil".into()], ..SweepPlan::default() };
/// assert!(matches!(Sweep::new(plan), Err(SweepError::Body(name)) if name == "anvil"));
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The scene cannot be used, or cannot with the values at the ends of what is to be drawn.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A field cannot be varied.
    #[error("--vary {}: {}", printable(.field), printable(.problem))]
    SweepParameter {
        /// Its path.
        field: String,
        /// Why not.
        problem: String,
    },
    /// No body has the name.
    #[error("--body {0:?}: the scene has no body of that name")]
    Body(String),
    /// The number of worlds is missing, zero or absurd.
    #[error("--worlds {}", printable(.0))]
    Worlds(String),
    /// The generated scene has no fields.
    #[error("the stress scene cannot be swept: it is generated, and has no fields to vary")]
    Stress,
}

impl From<FieldError> for SweepError {
    fn from(error: FieldError) -> Self {
        Self::SweepParameter { field: one_line(&error.field), problem: error.problem }
    }
}
