//! How a node moves.

use glam::{DQuat, DVec3};

use crate::checked::MAX_COMPONENT;
use crate::gltf::document::MotionModel;
use crate::gltf::tree::unit;

/// What moves a body.
///
/// ```
/// use tumble_import::gltf::{MotionKind, Physics};
///
/// let physics = Physics::from_json(
///     r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "extensions": { "KHR_physics_rigid_bodies": { "motion": { "isKinematic": true } } } } ] }"#,
///     "scene.gltf",
/// )?;
/// let motion = physics.nodes[0].motion.as_ref();
/// assert_eq!(motion.map(|motion| motion.kind), Some(MotionKind::Kinematic));
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    /// Forces.
    Dynamic,
    /// The velocity it is given, whatever pushes it.
    Kinematic,
    /// Nothing: OMI's `static`.
    Static,
}

/// A body's motion as the file says it. What is `None` is for the reader to compute from the
/// colliders.
///
/// ```
/// use tumble_import::gltf::Physics;
///
/// let physics = Physics::from_json(
///     r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "extensions": { "KHR_physics_rigid_bodies": { "motion": { "mass": 2, "gravityFactor": 0 }
///     } } } ] }"#,
///     "scene.gltf",
/// )?;
/// let motion = physics.nodes[0].motion.as_ref();
/// assert!(motion.is_some_and(|motion| motion.mass == Some(2.0) && motion.gravity_factor == 0.0));
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// What moves it.
    pub kind: MotionKind,
    /// Mass \[kg\]; infinite where the file says zero.
    pub mass: Option<f64>,
    /// Centre of mass in the node's frame \[m\], to be scaled as the node is.
    pub center_of_mass: Option<DVec3>,
    /// Principal moments about the centre of mass [kg m^2], not to be scaled; a component is
    /// infinite where the file says zero.
    pub inertia_diagonal: Option<DVec3>,
    /// Rotation from the principal frame to the node's.
    pub inertia_orientation: DQuat,
    /// Velocity of the centre of mass in the node's frame [m/s], turned as the node is but not
    /// scaled.
    pub linear_velocity: DVec3,
    /// Angular velocity in the node's frame [rad/s].
    pub angular_velocity: DVec3,
    /// How many times gravity acts on it.
    pub gravity_factor: f64,
}

/// Whose rules a motion follows where the extensions differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dialect {
    Khr,
    Omi,
}

impl Motion {
    /// Checks a motion; an error is a field and what is wrong with it.
    pub(crate) fn new(model: &MotionModel, dialect: Dialect) -> Result<Self, (&'static str, String)> {
        let mut motion = Self {
            kind: kind(model, dialect)?,
            mass: None,
            center_of_mass: vector("centerOfMass", model.center_of_mass)?,
            inertia_diagonal: None,
            inertia_orientation: DQuat::IDENTITY,
            linear_velocity: vector("linearVelocity", model.linear_velocity)?.unwrap_or_default(),
            angular_velocity: vector("angularVelocity", model.angular_velocity)?.unwrap_or_default(),
            gravity_factor: model.gravity_factor.unwrap_or(1.0),
        };
        if !motion.gravity_factor.is_finite() {
            return Err(("gravityFactor", format!("must be finite, not {}", motion.gravity_factor)));
        }
        if let Some(orientation) = model.inertia_orientation {
            motion.inertia_orientation = unit(orientation).map_err(|problem| ("inertiaOrientation", problem))?;
        }
        let moments = vector("inertiaDiagonal", model.inertia_diagonal)?;
        if let Some(bad) = moments.and_then(|moments| moments.to_array().into_iter().find(|moment| *moment < 0.0)) {
            return Err(("inertiaDiagonal", format!("must not be negative, as {bad} is")));
        }
        if let Some(bad) = model.mass.filter(|mass| !(mass.is_finite() && *mass >= 0.0)) {
            return Err(("mass", format!("must be positive and finite, or zero for infinite, not {bad}")));
        }
        match dialect {
            // The draft's text: zero is no mass, so it stands for infinity, which JSON cannot say.
            Dialect::Khr => {
                let infinite = |value: f64| if value == 0.0 { f64::INFINITY } else { value };
                motion.mass = model.mass.map(infinite);
                motion.inertia_diagonal = moments.map(|moments| DVec3::from_array(moments.to_array().map(infinite)));
            }
            // OMI: a body weighs 1 kg and has its centre of mass at its origin unless it says
            // otherwise, and no moments are those of its shapes.
            Dialect::Omi => {
                motion.mass = Some(model.mass.filter(|mass| *mass > 0.0).unwrap_or(1.0));
                motion.center_of_mass = motion.center_of_mass.or(Some(DVec3::ZERO));
                motion.inertia_diagonal = moments.filter(|moments| *moments != DVec3::ZERO);
            }
        }
        Ok(motion)
    }
}

fn kind(model: &MotionModel, dialect: Dialect) -> Result<MotionKind, (&'static str, String)> {
    match (dialect, model.r#type.as_deref()) {
        (Dialect::Khr, _) if model.is_kinematic => Ok(MotionKind::Kinematic),
        (Dialect::Khr, _) | (Dialect::Omi, Some("dynamic")) => Ok(MotionKind::Dynamic),
        (Dialect::Omi, Some("kinematic")) => Ok(MotionKind::Kinematic),
        (Dialect::Omi, Some("static")) => Ok(MotionKind::Static),
        (Dialect::Omi, Some(other)) => Err(("type", format!("is {other:?}; there are static, kinematic and dynamic"))),
        (Dialect::Omi, None) => Err(("type", "is missing; there are static, kinematic and dynamic".to_owned())),
    }
}

fn vector(field: &'static str, value: Option<[f64; 3]>) -> Result<Option<DVec3>, (&'static str, String)> {
    match value.map(DVec3::from_array) {
        // Whatever is to be squared must have room.
        Some(vector) if vector.abs().max_element() > MAX_COMPONENT => {
            Err((field, format!("{value:?} is absurd: more than {MAX_COMPONENT:e}")))
        }
        vector => Ok(vector),
    }
}
