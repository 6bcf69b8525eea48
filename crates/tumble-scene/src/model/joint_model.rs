//! The model of a joint between two bodies of a scene.

use crate::model::joint_options_model::{BreakModel, DriveModel, FrictionModel, LimitsModel, drives};
use crate::values::tuple::{Triple, Tuple};

/// One of the kinds, each with where it is. What most joints lack is in boxes, for a file may have
/// millions of them.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Joint", expecting = "a joint with named fields")]
pub(crate) struct JointModel {
    pub(crate) name: Option<String>,
    pub(crate) between: Option<Tuple<String, 2>>,
    pub(crate) ball: Option<Box<JointPlaceModel>>,
    pub(crate) hinge: Option<Box<JointPlaceModel>>,
    pub(crate) slider: Option<Box<JointPlaceModel>>,
    pub(crate) cylinder: Option<Box<JointPlaceModel>>,
    pub(crate) universal: Option<Box<JointPlaceModel>>,
    pub(crate) planar: Option<Box<JointPlaceModel>>,
    pub(crate) fixed: Option<Box<JointPlaceModel>>,
    pub(crate) free: Option<Box<JointPlaceModel>>,
    #[serde(default)]
    pub(crate) contacts: bool,
    pub(crate) limits: Option<Box<LimitsModel>>,
    #[serde(default, deserialize_with = "drives")]
    pub(crate) drives: Vec<DriveModel>,
    pub(crate) friction: Option<Box<FrictionModel>>,
    #[serde(rename = "break")]
    pub(crate) breaks: Option<Box<BreakModel>>,
    /// How far a joint of a file of others is along or about its one free axis \[m\] \[rad\].
    #[serde(skip)]
    pub(crate) position: Option<f64>,
}

/// A point of the world, and the axis where the kind has one.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Place", expecting = "a place with named fields")]
pub(crate) struct JointPlaceModel {
    pub(crate) at: Option<Triple>,
    /// Of the second body, where that is another one.
    pub(crate) to: Option<Triple>,
    pub(crate) axis: Option<Triple>,
}
