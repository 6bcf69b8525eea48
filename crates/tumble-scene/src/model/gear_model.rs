//! The model of a gear between two joints of a scene.

use crate::model::joint_options_model::AxisModel;
use crate::values::tuple::Tuple;

/// Which joints it ties, and how.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Gear", expecting = "a gear with named fields")]
pub(crate) struct GearModel {
    pub(crate) joints: Option<Tuple<String, 2>>,
    pub(crate) axes: Option<Tuple<AxisModel, 2>>,
    pub(crate) ratio: Option<f64>,
    pub(crate) offset: Option<f64>,
}
