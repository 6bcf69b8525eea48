//! Combine rules by their names in files.

use serde::{Deserialize, Deserializer};
use tumble::CombineRule;

/// The names that scenes and glTF share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename = "Combine", rename_all = "lowercase")]
pub(crate) enum CombineModel {
    Average,
    Minimum,
    Maximum,
    Multiply,
}

impl From<CombineModel> for CombineRule {
    fn from(model: CombineModel) -> Self {
        match model {
            CombineModel::Average => Self::Average,
            CombineModel::Minimum => Self::Minimum,
            CombineModel::Maximum => Self::Maximum,
            CombineModel::Multiply => Self::Multiply,
        }
    }
}

/// For a field of a model that holds the engine's own.
pub(crate) fn combine<'de, D: Deserializer<'de>>(deserializer: D) -> Result<CombineRule, D::Error> {
    CombineModel::deserialize(deserializer).map(CombineRule::from)
}
