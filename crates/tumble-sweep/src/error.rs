//! Errors of sweep construction.

use tumble_import::{FieldError, one_line, printable};
use tumble_scene::SceneError;

/// Why a sweep cannot be made. `Display` is one line that names the field, and
/// the option by which the program takes it.
///
/// ```
/// use tumble_sweep::{Sweep, SweepError, SweepPlan};
///
/// let plan = SweepPlan { scene: "t-handle".into(), ..SweepPlan::default() };
/// let error = Sweep::new(plan).unwrap_err();
/// assert!(matches!(error, SweepError::Worlds(_)));
/// assert!(error.to_string().starts_with("--worlds N is missing"));
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The scene cannot be used, or cannot with the values at the ends of what is to be drawn.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A field cannot be varied.
    #[error("--vary {}: {}", printable(.field), printable(.problem))]
    Field {
        /// Its path.
        field: String,
        /// Why not.
        problem: String,
    },
    /// No body has the name.
    #[error("--body {0:?}: the scene has no body of that name")]
    Body(String),
    /// What is to be watched is no observable or no condition of this scene.
    #[error("--{option} {text:?}: {}", printable(.problem))]
    Observation {
        /// `observe` or `until`.
        option: &'static str,
        /// As it was written.
        text: String,
        /// Why not.
        problem: String,
    },
    /// The number of worlds is missing, zero or absurd.
    #[error("--worlds {}", printable(.0))]
    Worlds(String),
}

tumble_math::debug_as_display!(SweepError);

impl From<FieldError> for SweepError {
    fn from(error: FieldError) -> Self {
        Self::Field { field: one_line(&error.field), problem: error.problem }
    }
}
