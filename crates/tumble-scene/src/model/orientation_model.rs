//! An orientation as files write it: a quaternion, or an axis and an angle.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

use crate::values::tuple::{Quadruple, Triple};

/// A rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum OrientationModel {
    Quaternion(Quadruple),
    Turn(TurnModel),
}

/// About an axis of any length, by an angle \[rad\].
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Turn", expecting = "an axis and an angle")]
pub(crate) struct TurnModel {
    pub(crate) axis: Triple,
    pub(crate) angle: f64,
}

impl<'de> Deserialize<'de> for OrientationModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Orientation;

        impl<'de> Visitor<'de> for Orientation {
            type Value = OrientationModel;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a quaternion of 4 values, or an axis and an angle")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<OrientationModel, A::Error> {
                Quadruple::deserialize(SeqAccessDeserializer::new(list)).map(OrientationModel::Quaternion)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<OrientationModel, A::Error> {
                TurnModel::deserialize(MapAccessDeserializer::new(map)).map(OrientationModel::Turn)
            }
        }

        deserializer.deserialize_any(Orientation)
    }
}
