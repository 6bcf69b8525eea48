//! The one serde model behind `.json` and `.ron`: what a scene file may say.
//!
//! Nothing is checked here but names and types; the folder `convert` checks values. The names that
//! serde gets are those that RON may write before a bracket and that messages use.

use std::marker::PhantomData;

use serde::de::Deserializer;
use tumble_import::{MAX_HULL_POINTS, MAX_PARTS};

use crate::limits::{MAX_BODIES, MAX_HEIGHTS};
use crate::model::collider_model::ColliderModel;
use crate::model::force_model::ForceModel;
use crate::model::gear_model::GearModel;
use crate::model::joint_model::JointModel;
use crate::model::mesh_shape::Made;
use crate::model::orientation_model::OrientationModel;
use crate::values::tuple::{List, Quadruple, Triple, Tuple};

/// A whole file. `name`, `description` and `source` are for people.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Scene", expecting = "a scene with named fields")]
pub(crate) struct SceneModel {
    pub(crate) name: Option<String>,
    pub(crate) description: Option<String>,
    pub(crate) source: Option<String>,
    pub(crate) gravity: Option<Triple>,
    pub(crate) dt: Option<f64>,
    pub(crate) steps: Option<u64>,
    pub(crate) substeps: Option<u32>,
    pub(crate) integrator: Option<String>,
    pub(crate) contact_substeps: Option<u32>,
    pub(crate) restitution_threshold: Option<f64>,
    pub(crate) joint_solver: Option<String>,
    pub(crate) sleep: Option<SleepModel>,
    #[serde(default, deserialize_with = "bodies")]
    pub(crate) bodies: Vec<BodyModel>,
    #[serde(default, deserialize_with = "joints")]
    pub(crate) joints: Vec<JointModel>,
    #[serde(default, deserialize_with = "gears")]
    pub(crate) gears: Vec<GearModel>,
    /// Remarks about the meshes.
    #[serde(skip)]
    pub(crate) notices: Vec<String>,
    /// Of what is in the files of meshes; 0 without one.
    #[serde(skip)]
    pub(crate) meshes_hash: u64,
    /// The files of meshes, and what those name.
    #[serde(skip)]
    pub(crate) files: Vec<std::path::PathBuf>,
}

impl SceneModel {
    /// What it says of the simulation, without bodies and joints.
    pub(crate) fn head(&self) -> Self {
        Self {
            gravity: self.gravity,
            dt: self.dt,
            steps: self.steps,
            substeps: self.substeps,
            integrator: self.integrator.clone(),
            contact_substeps: self.contact_substeps,
            restitution_threshold: self.restitution_threshold,
            joint_solver: self.joint_solver.clone(),
            sleep: self.sleep.clone(),
            ..Self::default()
        }
    }
}

/// When bodies at rest are left out of the steps.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Sleep", expecting = "an object with speed and time")]
pub(crate) struct SleepModel {
    pub(crate) speed: Option<f64>,
    pub(crate) time: Option<f64>,
}

impl SleepModel {
    /// A number by its name.
    pub(crate) fn number(&mut self, name: &str) -> Option<&mut f64> {
        match name {
            "speed" => Some(self.speed.get_or_insert(0.0)),
            "time" => Some(self.time.get_or_insert(0.0)),
            _ => None,
        }
    }
}

#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Body", expecting = "a body with named fields")]
pub(crate) struct BodyModel {
    pub(crate) name: Option<String>,
    pub(crate) shape: Option<ShapeModel>,
    pub(crate) mass: Option<f64>,
    pub(crate) density: Option<f64>,
    pub(crate) inertia: Option<Box<InertiaModel>>,
    pub(crate) center_of_mass: Option<Triple>,
    pub(crate) position: Option<Triple>,
    pub(crate) orientation: Option<OrientationModel>,
    pub(crate) linear_velocity: Option<Triple>,
    pub(crate) angular_velocity: Option<Triple>,
    pub(crate) gravity_scale: Option<f64>,
    #[serde(default)]
    pub(crate) locked_axes: Vec<String>,
    #[serde(default)]
    pub(crate) fixed: bool,
    #[serde(default)]
    pub(crate) kinematic: bool,
    #[serde(default)]
    pub(crate) forces: Vec<ForceModel>,
    pub(crate) collider: Option<ColliderModel>,
}

#[derive(Clone, Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Shape", rename_all = "snake_case")]
pub(crate) enum ShapeModel {
    Point,
    Sphere {
        radius: f64,
    },
    HollowSphere {
        radius: f64,
    },
    Cuboid {
        half_extents: Triple,
    },
    Cylinder {
        radius: f64,
        half_height: f64,
    },
    Capsule {
        radius: f64,
        half_height: f64,
    },
    Cone {
        radius: f64,
        half_height: f64,
    },
    Ellipsoid {
        radii: Triple,
    },
    Compound {
        #[serde(deserialize_with = "parts")]
        parts: Vec<PartModel>,
    },
    Mesh {
        file: String,
        #[serde(default = "one")]
        scale: f64,
        #[serde(default)]
        repair: bool,
        #[serde(skip)]
        solid: Made,
    },
    ConvexHull {
        #[serde(deserialize_with = "points")]
        points: Vec<Triple>,
        #[serde(skip)]
        solid: Made,
    },
    HalfSpace {
        #[serde(default = "up")]
        normal: Triple,
    },
    HeightField {
        heights: Rows,
        #[serde(default = "a_metre_each")]
        spacing: Tuple<f64, 2>,
    },
}

impl ShapeModel {
    /// Whether it is ground, which has no mass and is no part of a compound.
    pub(crate) fn is_ground(&self) -> bool {
        matches!(self, Self::HalfSpace { .. } | Self::HeightField { .. })
    }

    /// As it is called in files.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Sphere { .. } => "sphere",
            Self::HollowSphere { .. } => "hollow_sphere",
            Self::Cuboid { .. } => "cuboid",
            Self::Cylinder { .. } => "cylinder",
            Self::Capsule { .. } => "capsule",
            Self::Cone { .. } => "cone",
            Self::Ellipsoid { .. } => "ellipsoid",
            Self::Compound { .. } => "compound",
            Self::Mesh { .. } => "mesh",
            Self::ConvexHull { .. } => "convex_hull",
            Self::HalfSpace { .. } => "half_space",
            Self::HeightField { .. } => "height_field",
        }
    }
}

#[derive(Clone, Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Part", expecting = "a part with named fields")]
pub(crate) struct PartModel {
    pub(crate) shape: ShapeModel,
    pub(crate) position: Option<Triple>,
    pub(crate) orientation: Option<OrientationModel>,
    pub(crate) mass: Option<f64>,
    pub(crate) density: Option<f64>,
}

/// Either `principal` with optional `axes`, or `tensor`.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Inertia", expecting = "a inertia with named fields")]
pub(crate) struct InertiaModel {
    pub(crate) principal: Option<Triple>,
    pub(crate) axes: Option<Quadruple>,
    pub(crate) tensor: Option<Tuple<Triple, 3>>,
}

/// Rows of numbers, which need not be as long as each other.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(transparent)]
pub(crate) struct Rows(#[serde(deserialize_with = "rows")] pub(crate) Vec<Row>);

#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(transparent)]
pub(crate) struct Row(#[serde(deserialize_with = "heights")] pub(crate) Vec<f64>);

fn rows<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Row>, D::Error> {
    deserializer.deserialize_seq(List { exactly: None, at_most: MAX_HEIGHTS, noun: "rows of heights", of: PhantomData })
}

fn heights<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    deserializer.deserialize_seq(List { exactly: None, at_most: MAX_HEIGHTS, noun: "heights", of: PhantomData })
}

/// Numbers of groups, of which there are 32.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(transparent)]
pub(crate) struct Groups(#[serde(deserialize_with = "groups")] pub(crate) Vec<u32>);

fn groups<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u32>, D::Error> {
    deserializer.deserialize_seq(List { exactly: None, at_most: 32, noun: "groups", of: PhantomData })
}

fn bodies<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<BodyModel>, D::Error> {
    deserializer.deserialize_seq(List { exactly: None, at_most: MAX_BODIES, noun: "bodies", of: PhantomData })
}

fn joints<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<JointModel>, D::Error> {
    deserializer.deserialize_seq(List { exactly: None, at_most: MAX_BODIES, noun: "joints", of: PhantomData })
}

fn gears<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<GearModel>, D::Error> {
    deserializer.deserialize_seq(List { exactly: None, at_most: MAX_BODIES, noun: "gears", of: PhantomData })
}

fn parts<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<PartModel>, D::Error> {
    deserializer.deserialize_seq(List { exactly: None, at_most: MAX_PARTS, noun: "parts", of: PhantomData })
}

fn points<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Triple>, D::Error> {
    deserializer.deserialize_seq(List { exactly: None, at_most: MAX_HULL_POINTS, noun: "points", of: PhantomData })
}

fn one() -> f64 {
    1.0
}

fn a_metre_each() -> Tuple<f64, 2> {
    Tuple([1.0; 2])
}

fn up() -> Triple {
    Tuple([0.0, 1.0, 0.0])
}
