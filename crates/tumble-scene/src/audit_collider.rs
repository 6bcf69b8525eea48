use serde::{Serialize, Serializer};
use tumble::math::Real;
use tumble::{Combine, Material};

/// The surface of a body's collider: written as JSON it is what a scene could have said.
///
/// ```
/// use tumble_scene::Audit;
///
/// let text = r#"{ "bodies": [ { "shape": { "sphere": { "radius": 0.5 } }, "mass": 2, "collider": { "friction": 0.25 } } ] }"#;
/// let audit = Audit::from_json(text, "ball.json")?;
/// assert_eq!(audit.bodies[0].collider.as_ref().map(|collider| collider.static_friction), Some(0.25));
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
    pub rolling_friction: Real,
    /// How the frictions of two surfaces become one.
    #[serde(serialize_with = "name")]
    pub friction_combine: Combine,
    /// How the restitutions of two surfaces become one.
    #[serde(serialize_with = "name")]
    pub restitution_combine: Combine,
}

impl AuditedCollider {
    pub(crate) fn of(material: &Material) -> Self {
        Self {
            static_friction: material.static_friction,
            dynamic_friction: material.dynamic_friction,
            restitution: material.restitution,
            rolling_friction: material.rolling_friction,
            friction_combine: material.friction_combine,
            restitution_combine: material.restitution_combine,
        }
    }
}

/// As it is called in files.
fn name<S: Serializer>(combine: &Combine, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(match combine {
        Combine::Average => "average",
        Combine::Minimum => "minimum",
        Combine::Maximum => "maximum",
        Combine::Multiply => "multiply",
    })
}
