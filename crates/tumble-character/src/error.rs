//! What is wrong with the settings of a character.

use tumble::ColliderError;

/// Why there is no character with such [settings](crate::CharacterSettings).
///
/// ```
/// use tumble_character::{Character, CharacterSettings};
///
/// let mut settings = CharacterSettings::of_height(1.8);
/// settings.step_height = -0.1;
/// let error = Character::new(settings).unwrap_err();
/// assert_eq!(error.field(), "step_height");
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CharacterError {
    /// A number that cannot be.
    #[error("{field} must be {wanted}, got {value}")]
    Setting {
        /// The field of [`CharacterSettings`](crate::CharacterSettings).
        field: &'static str,
        /// What it must be.
        wanted: &'static str,
        /// What was given.
        value: f64,
    },
    /// The capsule is too large or too small for a collider.
    #[error("radius and height make no collider: {0}")]
    Collider(#[from] ColliderError),
}

impl CharacterError {
    /// The field that is at fault.
    #[must_use]
    pub fn field(&self) -> &'static str {
        match self {
            Self::Setting { field, .. } => field,
            Self::Collider(_) => "height",
        }
    }
}
