//! The part of the model that makes bodies touch. Values are checked in `convert/collider.rs`.

use tumble_import::CombineName;

use crate::model::scene_model::Groups;
use crate::values::tuple::Triple;

/// What is left out has the default of [`tumble::Material`].
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields, rename = "Collider", expecting = "a collider with named fields")]
pub(crate) struct ColliderModel {
    /// Both coefficients at once.
    pub(crate) friction: Option<f64>,
    pub(crate) static_friction: Option<f64>,
    pub(crate) dynamic_friction: Option<f64>,
    pub(crate) restitution: Option<f64>,
    pub(crate) rolling_resistance: Option<f64>,
    pub(crate) surface_velocity: Option<Triple>,
    pub(crate) friction_combine: Option<CombineName>,
    pub(crate) restitution_combine: Option<CombineName>,
    /// Numbers of the groups that it is in, and of those that it touches.
    pub(crate) groups: Option<Groups>,
    pub(crate) touches: Option<Groups>,
    /// Whether it reports what comes into it and pushes nothing.
    pub(crate) sensor: Option<bool>,
    /// Of a compound, for each of its parts what is other there.
    #[serde(default)]
    pub(crate) parts: Vec<ColliderModel>,
}

impl ColliderModel {
    /// What it says, and where it is silent what the whole does.
    pub(crate) fn over(&self, whole: &Self) -> Self {
        let says_friction = [self.friction, self.static_friction, self.dynamic_friction].iter().any(Option::is_some);
        let friction = if says_friction { self } else { whole };
        Self {
            friction: friction.friction,
            static_friction: friction.static_friction,
            dynamic_friction: friction.dynamic_friction,
            restitution: self.restitution.or(whole.restitution),
            rolling_resistance: self.rolling_resistance.or(whole.rolling_resistance),
            surface_velocity: self.surface_velocity.or(whole.surface_velocity),
            friction_combine: self.friction_combine.or(whole.friction_combine),
            restitution_combine: self.restitution_combine.or(whole.restitution_combine),
            groups: self.groups.clone().or(whole.groups.clone()),
            touches: self.touches.clone().or(whole.touches.clone()),
            sensor: self.sensor.or(whole.sensor),
            parts: Vec::new(),
        }
    }
}
