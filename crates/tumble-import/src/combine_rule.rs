//! Combine rules by their names in files.

use serde::{Deserialize, Deserializer};
use tumble::CombineRule;

/// The names of combine rules that scenes and glTF share.
///
/// ```
/// use tumble_import::CombineName;
///
/// assert_eq!(tumble::CombineRule::from(CombineName::Maximum), tumble::CombineRule::Maximum);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename = "Combine", rename_all = "lowercase")]
pub enum CombineName {
    /// See [`CombineRule::Average`].
    Average,
    /// See [`CombineRule::Minimum`].
    Minimum,
    /// See [`CombineRule::Maximum`].
    Maximum,
    /// See [`CombineRule::Multiply`].
    Multiply,
}

impl From<CombineName> for CombineRule {
    fn from(model: CombineName) -> Self {
        match model {
            CombineName::Average => Self::Average,
            CombineName::Minimum => Self::Minimum,
            CombineName::Maximum => Self::Maximum,
            CombineName::Multiply => Self::Multiply,
        }
    }
}

/// For a field of a model that holds the engine's own.
pub(crate) fn combine<'de, D: Deserializer<'de>>(deserializer: D) -> Result<CombineRule, D::Error> {
    CombineName::deserialize(deserializer).map(CombineRule::from)
}
