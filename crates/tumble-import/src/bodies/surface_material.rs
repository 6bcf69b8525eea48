//! What colliders are made of, and with whom they collide.

use std::collections::HashSet;

use serde::{Deserialize, Deserializer};
use tumble::{CombineRule, Material};

use crate::checked::real;
use crate::combine_rule::combine;

/// A surface, as KHR_physics_rigid_bodies and OMI_physics_body describe it.
///
/// ```
/// use tumble_import::gltf::SurfaceMaterial;
///
/// let rubber = SurfaceMaterial {
///     static_friction: 1.0,
///     dynamic_friction: 0.9,
///     restitution: 0.8,
///     ..SurfaceMaterial::default()
/// };
/// # assert_ne!(rubber, SurfaceMaterial::default());
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct SurfaceMaterial {
    /// Coefficient of friction of what does not slide.
    pub static_friction: f64,
    /// Coefficient of friction of what slides.
    pub dynamic_friction: f64,
    /// Share of the approaching velocity that a bounce gives back.
    pub restitution: f64,
    /// How the frictions of two surfaces become one.
    #[serde(deserialize_with = "combine")]
    pub friction_combine: CombineRule,
    /// How the restitutions of two surfaces become one.
    #[serde(deserialize_with = "combine")]
    pub restitution_combine: CombineRule,
}

impl Default for SurfaceMaterial {
    /// What both extensions say of a surface without a material, or with one that is silent.
    fn default() -> Self {
        Self {
            static_friction: 0.6,
            dynamic_friction: 0.6,
            restitution: 0.0,
            friction_combine: CombineRule::Average,
            restitution_combine: CombineRule::Average,
        }
    }
}

impl SurfaceMaterial {
    /// The engine's, which has no restitution of more than 1.
    pub(crate) fn to_engine(&self) -> Material {
        Material {
            friction_combine: self.friction_combine,
            restitution_combine: self.restitution_combine,
            static_friction: real(self.static_friction),
            dynamic_friction: real(self.dynamic_friction),
            ..Material::new(0.0, real(self.restitution.min(1.0)))
        }
    }

    /// The field that is not a number a surface can have, with what is wrong with it.
    pub(crate) fn problem(&self) -> Option<(&'static str, String)> {
        let fields = [
            ("staticFriction", self.static_friction),
            ("dynamicFriction", self.dynamic_friction),
            ("restitution", self.restitution),
        ];
        let bad = |value: f64| !(value.is_finite() && value >= 0.0);
        let (field, value) = fields.into_iter().find(|(_, value)| bad(*value))?;
        Some((field, format!("must be zero or positive, and finite, not {value}")))
    }
}

/// Who collides with whom, by names of systems.
///
/// KHR's draft writes of subsets where it means, as its examples have it, that one system in common
/// is enough; so it is here. An empty list is none, as OMI has it.
///
/// ```
/// use tumble_import::gltf::CollisionFilter;
///
/// let everyone = CollisionFilter::default();
/// let ghosts = CollisionFilter {
///     collision_systems: vec!["ghosts".into()],
///     not_collide_with_systems: Some(vec!["walls".into()]),
///     ..CollisionFilter::default()
/// };
/// let walls =
///     CollisionFilter { collision_systems: vec!["walls".into()], ..CollisionFilter::default() };
/// assert!(!ghosts.collides_with(&walls));
/// assert!(everyone.collides_with(&walls));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct CollisionFilter {
    /// The systems that the collider belongs to.
    pub collision_systems: Vec<String>,
    /// If given, the only systems that it collides with.
    #[serde(deserialize_with = "any")]
    pub collide_with_systems: Option<Vec<String>>,
    /// If given, the systems that it does not collide with.
    #[serde(deserialize_with = "any")]
    pub not_collide_with_systems: Option<Vec<String>>,
}

/// A list that is not empty.
fn any<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Vec<String>>, D::Error> {
    Ok(Some(Vec::deserialize(deserializer)?).filter(|list| !list.is_empty()))
}

impl CollisionFilter {
    /// Whether two colliders collide: each must agree to the other.
    ///
    /// ```
    /// use tumble_import::gltf::CollisionFilter;
    ///
    /// let all = CollisionFilter::default();
    /// let ghost =
    ///     CollisionFilter { collide_with_systems: Some(vec!["walls".into()]), ..all.clone() };
    /// let wall = CollisionFilter { collision_systems: vec!["walls".into()], ..all.clone() };
    /// assert!(ghost.collides_with(&wall) && wall.collides_with(&ghost));
    /// assert!(!ghost.collides_with(&all) && !all.collides_with(&ghost));
    /// ```
    #[must_use]
    pub fn collides_with(&self, other: &Self) -> bool {
        self.accepts(other) && other.accepts(self)
    }

    fn accepts(&self, other: &Self) -> bool {
        // Sets, for the lists are the file's and may be long.
        let theirs: HashSet<&str> = other.collision_systems.iter().map(String::as_str).collect();
        let listed = |systems: &Vec<String>| systems.iter().any(|system| theirs.contains(system.as_str()));
        self.collide_with_systems.as_ref().is_none_or(listed)
            && !self.not_collide_with_systems.as_ref().is_some_and(listed)
    }
}
