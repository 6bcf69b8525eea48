//! The model of a joint between two bodies of a scene.

use crate::values::tuple::{Triple, Tuple};

/// One of the kinds, each with where it is.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Joint", expecting = "a joint with named fields")]
pub(crate) struct JointModel {
    pub(crate) name: Option<String>,
    pub(crate) between: Option<Tuple<String, 2>>,
    pub(crate) ball: Option<JointPlaceModel>,
    pub(crate) hinge: Option<JointPlaceModel>,
    pub(crate) slider: Option<JointPlaceModel>,
    pub(crate) cylinder: Option<JointPlaceModel>,
    pub(crate) universal: Option<JointPlaceModel>,
    pub(crate) planar: Option<JointPlaceModel>,
    pub(crate) fixed: Option<JointPlaceModel>,
    #[serde(default)]
    pub(crate) contacts: bool,
}

/// A point of the world, and the axis where the kind has one.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Place", expecting = "a place with named fields")]
pub(crate) struct JointPlaceModel {
    pub(crate) at: Option<Triple>,
    pub(crate) axis: Option<Triple>,
}
