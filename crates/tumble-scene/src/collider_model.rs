//! The part of the model that makes bodies touch. Values are checked in `convert/collider.rs`.

use serde::{Deserialize, Deserializer};
use tumble::Combine;

use crate::model::Groups;

/// What is left out has the default of [`tumble::Material`].
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Collider", expecting = "a collider with named fields")]
pub(crate) struct ColliderModel {
    /// Both coefficients at once.
    pub(crate) friction: Option<f64>,
    pub(crate) static_friction: Option<f64>,
    pub(crate) dynamic_friction: Option<f64>,
    pub(crate) restitution: Option<f64>,
    pub(crate) rolling_friction: Option<f64>,
    pub(crate) friction_combine: Option<CombineModel>,
    pub(crate) restitution_combine: Option<CombineModel>,
    /// Numbers of the groups that it is in, and of those that it touches.
    pub(crate) groups: Option<Groups>,
    pub(crate) touches: Option<Groups>,
}

/// The names that scenes and glTF share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename = "Combine", rename_all = "lowercase")]
pub(crate) enum CombineModel {
    Average,
    Minimum,
    Maximum,
    Multiply,
}

impl From<CombineModel> for Combine {
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
pub(crate) fn combine<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Combine, D::Error> {
    CombineModel::deserialize(deserializer).map(Combine::from)
}
