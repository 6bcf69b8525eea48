//! The part of the model that is a body's list of forces. Values are checked in
//! `convert/forces.rs`.

use std::fmt;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserialize, Deserializer, SeqAccess, Visitor};

use crate::values::tuple::Triple;

#[derive(Clone, Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Force", rename_all = "snake_case")]
pub(crate) enum ForceModel {
    Damping {
        #[serde(default)]
        linear: f64,
        #[serde(default)]
        angular: f64,
    },
    GravityScale(f64),
    Drag {
        linear: Option<PerAxis>,
        angular: Option<PerAxis>,
    },
    Wind(Triple),
    Magnus {
        coefficient: f64,
    },
    Thruster {
        force: Triple,
        point: Option<Triple>,
        throttle: Option<f64>,
    },
    ConstantWrench {
        force: Option<Triple>,
        torque: Option<Triple>,
        #[serde(default)]
        frame: FrameModel,
    },
    SpringToPoint {
        anchor: Triple,
        attachment: Option<Triple>,
        #[serde(default)]
        rest_length: f64,
        stiffness: f64,
        #[serde(default)]
        damping: f64,
    },
    Spring {
        to: String,
        attachment: Option<Triple>,
        attachment_to: Option<Triple>,
        rest_length: Option<f64>,
        stiffness: f64,
        #[serde(default)]
        damping: f64,
    },
    PointGravity {
        center: Option<Triple>,
        mu: f64,
        #[serde(default)]
        softening: f64,
    },
    GravityMass {
        mu: Option<f64>,
        #[serde(default)]
        softening: f64,
    },
    Buoyancy {
        density: Option<f64>,
        #[serde(default)]
        level: f64,
        hull: Option<HullModel>,
        center: Option<Triple>,
    },
    AngularVelocityServo {
        target: Triple,
        #[serde(default)]
        frame: FrameModel,
        max_torque: Option<f64>,
    },
}

impl ForceModel {
    /// As it is called in files.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Damping { .. } => "damping",
            Self::GravityScale(_) => "gravity_scale",
            Self::Drag { .. } => "drag",
            Self::Wind(_) => "wind",
            Self::Magnus { .. } => "magnus",
            Self::Thruster { .. } => "thruster",
            Self::ConstantWrench { .. } => "constant_wrench",
            Self::SpringToPoint { .. } => "spring_to_point",
            Self::Spring { .. } => "spring",
            Self::PointGravity { .. } => "point_gravity",
            Self::GravityMass { .. } => "gravity_mass",
            Self::Buoyancy { .. } => "buoyancy",
            Self::AngularVelocityServo { .. } => "angular_velocity_servo",
        }
    }
}

/// Which axes a vector is given along.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename = "Frame", rename_all = "snake_case")]
pub(crate) enum FrameModel {
    #[default]
    World,
    Body,
}

#[derive(Clone, Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Hull", rename_all = "snake_case")]
pub(crate) enum HullModel {
    Sphere { radius: f64 },
    Cuboid { half_extents: Triple },
}

impl HullModel {
    /// As it is called in files.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Sphere { .. } => "sphere",
            Self::Cuboid { .. } => "cuboid",
        }
    }
}

/// A number for all three axes, or one for each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PerAxis {
    All(f64),
    Each(Triple),
}

impl PerAxis {
    pub(crate) fn to_triple(self) -> Triple {
        match self {
            Self::All(number) => crate::values::tuple::Tuple([number; 3]),
            Self::Each(numbers) => numbers,
        }
    }
}

impl<'de> Deserialize<'de> for PerAxis {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberOrList)
    }
}

struct NumberOrList;

impl<'de> Visitor<'de> for NumberOrList {
    type Value = PerAxis;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a list of 3 values")
    }

    fn visit_f64<E>(self, number: f64) -> Result<PerAxis, E> {
        Ok(PerAxis::All(number))
    }

    fn visit_u64<E>(self, number: u64) -> Result<PerAxis, E> {
        Ok(PerAxis::All(number as f64))
    }

    fn visit_i64<E>(self, number: i64) -> Result<PerAxis, E> {
        Ok(PerAxis::All(number as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<PerAxis, A::Error> {
        Triple::deserialize(SeqAccessDeserializer::new(list)).map(PerAxis::Each)
    }
}
