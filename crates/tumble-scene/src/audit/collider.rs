//! The audit of a collider: friction, restitution, combine rules, collision groups, sensors.

use serde::{Serialize, Serializer};
use tumble::math::Real;
use tumble::{Collider, CombineRule, Material};

/// The surface and the groups of a body's collider: written as JSON it is what a scene could have
/// said.
///
/// ```
/// use tumble_scene::Audit;
///
/// let text = r#"{ "bodies": [ { "shape": { "sphere": { "radius": 0.5 } }, "mass": 2,
///     "collider": { "friction": 0.25 } } ] }"#;
/// let audit = Audit::from_json(text, "ball.json")?;
/// assert_eq!(
///     audit.bodies[0].collider.as_ref().map(|collider| collider.static_friction),
///     Some(0.25)
/// );
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditedCollider {
    /// Coefficient of friction of what does not slide.
    pub static_friction: Real,
    /// Coefficient of friction of what slides.
    pub dynamic_friction: Real,
    /// Speed after a bounce over speed before it.
    pub restitution: Real,
    /// Resistance to rolling \[m\].
    pub rolling_resistance: Real,
    /// Of the surface on the body, in the frame of the collider \[m/s\]; left out of JSON where it
    /// does not move.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface_velocity: Option<[Real; 3]>,
    /// How the frictions of two surfaces become one.
    #[serde(serialize_with = "name")]
    pub friction_combine: CombineRule,
    /// How the restitutions of two surfaces become one.
    #[serde(serialize_with = "name")]
    pub restitution_combine: CombineRule,
    /// Numbers of the groups that the body is in, from 0 to 31; left out of JSON where it is in
    /// all.
    #[serde(skip_serializing_if = "are_all")]
    pub groups: Vec<u32>,
    /// Numbers of the groups that it touches; left out of JSON where it touches all.
    #[serde(skip_serializing_if = "are_all")]
    pub touches: Vec<u32>,
    /// Whether it reports what comes into it and pushes nothing; left out of JSON where it pushes.
    #[serde(skip_serializing_if = "is_solid")]
    pub sensor: bool,
    /// Of a compound whose parts have surfaces of their own, each of them in order, but for points;
    /// left out of JSON where there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<AuditedCollider>,
}

impl AuditedCollider {
    pub(crate) fn of(collider: &Collider) -> Self {
        let surfaces = collider.materials().zip(collider.groups_of_parts()).zip(collider.sensors_of_parts());
        let parts: Vec<Self> =
            surfaces.map(|((material, groups), sensor)| Self::of_surface(material, groups, sensor)).collect();
        // Of one surface, the part is the whole.
        let parts = if parts.len() > 1 { parts } else { Vec::new() };
        Self { parts, ..Self::of_surface(collider.material(), collider.groups(), collider.is_sensor()) }
    }

    fn of_surface(material: &Material, (membership, filter): (u32, u32), sensor: bool) -> Self {
        let numbers = |bits: u32| (0..u32::BITS).filter(|group| bits >> group & 1 == 1).collect();
        Self {
            static_friction: material.static_friction,
            dynamic_friction: material.dynamic_friction,
            restitution: material.restitution,
            rolling_resistance: material.rolling_resistance,
            surface_velocity: Some(material.surface_velocity.to_array()).filter(|it| *it != [0.0; 3]),
            friction_combine: material.friction_combine,
            restitution_combine: material.restitution_combine,
            groups: numbers(membership),
            touches: numbers(filter),
            sensor,
            parts: Vec::new(),
        }
    }
}

fn are_all(groups: &[u32]) -> bool {
    groups.len() == u32::BITS as usize
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_solid(sensor: &bool) -> bool {
    !sensor
}

/// As it is called in files.
fn name<S: Serializer>(combine: &CombineRule, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(match combine {
        CombineRule::Average => "average",
        CombineRule::Minimum => "minimum",
        CombineRule::Maximum => "maximum",
        CombineRule::Multiply => "multiply",
    })
}
