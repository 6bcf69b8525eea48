//! The part of the model that is what a joint has beside its place. Values are checked in
//! `convert/joint_options.rs`.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

use crate::limits::MAX_DRIVES;
use crate::values::tuple::{List, Tuple};

/// How far it goes along and about each axis.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Limits", expecting = "limits with named fields")]
pub(crate) struct LimitsModel {
    pub(crate) linear_x: Option<LimitModel>,
    pub(crate) linear_y: Option<LimitModel>,
    pub(crate) linear_z: Option<LimitModel>,
    pub(crate) angular_x: Option<LimitModel>,
    pub(crate) angular_y: Option<LimitModel>,
    pub(crate) angular_z: Option<LimitModel>,
    pub(crate) distance: Option<LimitModel>,
    pub(crate) cone: Option<ConeModel>,
}

/// Bounds, and how hard they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct LimitModel {
    pub(crate) min: Option<f64>,
    pub(crate) max: Option<f64>,
    pub(crate) gain: GainModel,
}

/// Half angles, and how hard they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ConeModel {
    pub(crate) half_angles: Option<Tuple<f64, 2>>,
    pub(crate) gain: GainModel,
}

/// A stiffness and a damping, or a frequency and a damping ratio.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GainModel {
    pub(crate) stiffness: Option<f64>,
    pub(crate) damping: Option<f64>,
    pub(crate) frequency: Option<f64>,
    pub(crate) damping_ratio: Option<f64>,
    pub(crate) mode: Option<ModeModel>,
}

/// What stiffness and damping make.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename = "Mode", rename_all = "snake_case")]
pub(crate) enum ModeModel {
    Force,
    Acceleration,
}

/// A motor, a servo or a spring.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Drive", expecting = "a drive with named fields")]
pub(crate) struct DriveModel {
    #[serde(default, deserialize_with = "axes")]
    pub(crate) axes: Vec<AxisModel>,
    pub(crate) position: Option<f64>,
    pub(crate) velocity: Option<f64>,
    pub(crate) max_force: Option<f64>,
    pub(crate) stiffness: Option<f64>,
    pub(crate) damping: Option<f64>,
    pub(crate) frequency: Option<f64>,
    pub(crate) damping_ratio: Option<f64>,
    pub(crate) mode: Option<ModeModel>,
    pub(crate) oscillation: Option<OscillationModel>,
}

/// How the position of a drive oscillates.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Oscillation", expecting = "an oscillation with named fields")]
pub(crate) struct OscillationModel {
    pub(crate) amplitude: Option<f64>,
    pub(crate) frequency: Option<f64>,
    pub(crate) phase: Option<f64>,
}

impl DriveModel {
    pub(crate) fn gain(&self) -> GainModel {
        let Self { stiffness, damping, frequency, damping_ratio, mode, .. } = *self;
        GainModel { stiffness, damping, frequency, damping_ratio, mode }
    }
}

/// An axis, or all three of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename = "Axis", rename_all = "snake_case")]
pub(crate) enum AxisModel {
    LinearX,
    LinearY,
    LinearZ,
    AngularX,
    AngularY,
    AngularZ,
    Linear,
    Angular,
}

/// The greatest force or torque along and about each axis.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Friction", expecting = "friction with named fields")]
pub(crate) struct FrictionModel {
    pub(crate) linear_x: Option<f64>,
    pub(crate) linear_y: Option<f64>,
    pub(crate) linear_z: Option<f64>,
    pub(crate) angular_x: Option<f64>,
    pub(crate) angular_y: Option<f64>,
    pub(crate) angular_z: Option<f64>,
}

/// What a joint stands.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Break", expecting = "a break with named fields")]
pub(crate) struct BreakModel {
    pub(crate) force: Option<f64>,
    pub(crate) torque: Option<f64>,
}

pub(crate) fn drives<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<DriveModel>, D::Error> {
    deserializer.deserialize_seq(List { exactly: None, at_most: MAX_DRIVES, noun: "drives", of: PhantomData })
}

fn axes<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<AxisModel>, D::Error> {
    deserializer.deserialize_seq(List { exactly: None, at_most: 6, noun: "axes", of: PhantomData })
}

/// A limit with names.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Limit")]
struct NamedLimit {
    min: Option<f64>,
    max: Option<f64>,
    stiffness: Option<f64>,
    damping: Option<f64>,
    frequency: Option<f64>,
    damping_ratio: Option<f64>,
    mode: Option<ModeModel>,
}

/// A cone with names.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Cone")]
struct NamedCone {
    half_angles: Option<Tuple<f64, 2>>,
    stiffness: Option<f64>,
    damping: Option<f64>,
    frequency: Option<f64>,
    damping_ratio: Option<f64>,
    mode: Option<ModeModel>,
}

impl<'de> Deserialize<'de> for LimitModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ListOrLimit)
    }
}

struct ListOrLimit;

impl<'de> Visitor<'de> for ListOrLimit {
    type Value = LimitModel;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of min and max, or a limit with named fields")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<LimitModel, A::Error> {
        let Tuple([min, max]) = Tuple::deserialize(SeqAccessDeserializer::new(list))?;
        Ok(LimitModel { min: Some(min), max: Some(max), gain: GainModel::default() })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<LimitModel, A::Error> {
        let NamedLimit { min, max, stiffness, damping, frequency, damping_ratio, mode } =
            NamedLimit::deserialize(MapAccessDeserializer::new(map))?;
        Ok(LimitModel { min, max, gain: GainModel { stiffness, damping, frequency, damping_ratio, mode } })
    }
}

impl<'de> Deserialize<'de> for ConeModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AnglesOrCone)
    }
}

struct AnglesOrCone;

impl AnglesOrCone {
    fn round(half_angle: f64) -> ConeModel {
        ConeModel { half_angles: Some(Tuple([half_angle; 2])), gain: GainModel::default() }
    }
}

impl<'de> Visitor<'de> for AnglesOrCone {
    type Value = ConeModel;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a half angle, a list of two, or a cone with named fields")
    }

    fn visit_f64<E>(self, half_angle: f64) -> Result<ConeModel, E> {
        Ok(Self::round(half_angle))
    }

    fn visit_u64<E>(self, half_angle: u64) -> Result<ConeModel, E> {
        Ok(Self::round(half_angle as f64))
    }

    fn visit_i64<E>(self, half_angle: i64) -> Result<ConeModel, E> {
        Ok(Self::round(half_angle as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<ConeModel, A::Error> {
        let half_angles = Tuple::deserialize(SeqAccessDeserializer::new(list))?;
        Ok(ConeModel { half_angles: Some(half_angles), gain: GainModel::default() })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ConeModel, A::Error> {
        let NamedCone { half_angles, stiffness, damping, frequency, damping_ratio, mode } =
            NamedCone::deserialize(MapAccessDeserializer::new(map))?;
        Ok(ConeModel { half_angles, gain: GainModel { stiffness, damping, frequency, damping_ratio, mode } })
    }
}
