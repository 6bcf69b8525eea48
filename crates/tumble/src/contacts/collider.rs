use tumble_collide::Geometry;
use tumble_math::Shape;

use super::material::Material;
use crate::math::{Real, real, vec3};

/// What other bodies bump into: a shape and its surface. A component of anything that has a [`Pose`](crate::Pose).
///
/// The shape is in the body's own frame. A body with [`Momentum`](crate::Momentum) is pushed, one with a [`Velocity`](crate::Velocity) and no momentum
/// pushes and is not pushed, and one with neither is ground.
///
/// ```
/// use tumble::{Collider, prelude::*};
///
/// let mut world = hecs::World::new();
/// let ground = RigidBody::new(Shape::Point).fixed().build()?.spawn(&mut world);
/// world.insert_one(ground, Collider::half_space())?;
///
/// let shape = Shape::cuboid([0.5, 0.25, 0.5]);
/// let crate_of_tea = RigidBody::new(shape.clone()).mass(10.0).position(Vec3::Y).build()?.spawn(&mut world);
/// world.insert_one(crate_of_tea, Collider::new(&shape)?)?;
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// for _ in 0..120 {
///     simulation.step(&mut world);
/// }
/// // It fell on the ground and lies there.
/// let height = world.get::<&Pose>(crate_of_tea)?.position.y;
/// assert!((height - 0.25).abs() < 1e-3, "{height}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collider {
    pub(super) geometry: Geometry<Real>,
    material: Material,
}

/// Why a collider cannot be one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ColliderError {
    /// Contacts of this shape are not computed.
    #[error("a {shape} cannot be a collider: only spheres, cuboids and half-spaces can")]
    Shape {
        /// The shape's name.
        shape: &'static str,
    },
    /// A length of the shape is not a positive normal number in the build's precision.
    #[error("{field} must be a positive number, got {value}")]
    Length {
        /// `"radius"` or `"half_extents"`.
        field: &'static str,
        /// What was given.
        value: f64,
    },
    /// A coefficient of the material is out of its range.
    #[error("{field} must be from 0 to {most}, got {value}")]
    Material {
        /// Its name.
        field: &'static str,
        /// What was given.
        value: Real,
        /// The most it may be.
        most: Real,
    },
}

impl Collider {
    /// A collider of a body's shape, with the [default](Material::default) surface.
    ///
    /// # Errors
    /// [`ColliderError`] for shapes whose contacts are not computed, and lengths that are none.
    pub fn new(shape: &Shape) -> Result<Self, ColliderError> {
        let length = |field, value: f64| {
            let length = real(value);
            if length.is_normal() && length > 0.0 { Ok(length) } else { Err(ColliderError::Length { field, value }) }
        };
        let unknown = |shape| Err(ColliderError::Shape { shape });
        let geometry = match *shape {
            Shape::Sphere { radius } | Shape::HollowSphere { radius } => {
                Geometry::Ball { radius: length("radius", radius)? }
            }
            Shape::Cuboid { half_extents } => {
                for value in half_extents.to_array() {
                    length("half_extents", value)?;
                }
                Geometry::Cuboid { half_extents: vec3(half_extents).into() }
            }
            Shape::Point => return unknown("point"),
            Shape::Cylinder { .. } => return unknown("cylinder"),
            Shape::Capsule { .. } | Shape::TaperedCapsule { .. } => return unknown("capsule"),
            Shape::Cone { .. } | Shape::Frustum { .. } => return unknown("cone"),
            Shape::Ellipsoid { .. } => return unknown("ellipsoid"),
            Shape::Mesh(_) => return unknown("mesh"),
            _ => return unknown("compound"),
        };
        Ok(Self { geometry, material: Material::default() })
    }

    /// All that is below the plane y = 0 of the body's frame: ground without end. Nothing with momentum should have it.
    #[must_use]
    pub fn half_space() -> Self {
        Self { geometry: Geometry::HalfSpace, material: Material::default() }
    }

    /// The same with another surface.
    ///
    /// # Errors
    /// [`ColliderError::Material`] for coefficients that are negative or not a number, and a restitution of more than one.
    pub fn with_material(self, material: Material) -> Result<Self, ColliderError> {
        material.check()?;
        Ok(Self { material, ..self })
    }

    /// Its surface.
    #[must_use]
    pub fn material(&self) -> &Material {
        &self.material
    }
}
