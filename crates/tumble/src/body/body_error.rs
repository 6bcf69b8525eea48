//! The typed errors of body construction.

use glam::DVec3;
use tumble_math::{InertiaError, MassError, ShapeError};

use crate::collision::collider_error::ColliderError;
use crate::components::InertiaComponentError;
use crate::components::property_error::PropertyError;
use crate::math::real;

/// Why a [`RigidBody`](crate::RigidBody) cannot be built.
///
/// ```
/// # use tumble::{BodyError, RigidBody, Shape};
/// let error = RigidBody::new(Shape::sphere(0.5)).build().unwrap_err();
/// assert_eq!(error, BodyError::MissingMass);
/// assert_eq!(error.field(), "mass");
/// // What a main prints that returns it.
/// assert_eq!(format!("{error:?}"), "a body that moves needs a mass or a density");
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BodyError {
    /// A body that is to move has neither a mass nor a density.
    #[error("a body that moves needs a mass or a density")]
    MissingMass,
    /// The shape has no mass properties.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The mass is impossible.
    #[error(transparent)]
    Mass(#[from] MassError),
    /// The mass does not fit the precision of the build.
    #[error(transparent)]
    MassRange(PropertyError),
    /// No rigid body has this inertia.
    #[error(transparent)]
    Inertia(#[from] InertiaError),
    /// The principal moments do not fit the precision of the build.
    #[error(transparent)]
    InertiaRange(InertiaComponentError),
    /// A vector is not finite in the precision of the build.
    #[error("{field} must be finite, got {value}")]
    NotFinite {
        /// Which one.
        field: &'static str,
        /// What was given.
        value: DVec3,
    },
    /// A coordinate of a vector is too large for what is done with it.
    #[error("{field} must be within {:e} along each axis, got {value}", real(*.most))]
    TooLarge {
        /// Which one.
        field: &'static str,
        /// What was given.
        value: DVec3,
        /// The most that a coordinate may be, in the unit of the field.
        most: f64,
    },
    /// A number is not finite, or negative where it must not be.
    #[error("{field} must be {wanted}, got {value}")]
    Number {
        /// Which one.
        field: &'static str,
        /// What it must be.
        wanted: &'static str,
        /// What was given.
        value: f64,
    },
    /// The orientation's length is further than 1e-3 from one.
    #[error("orientation must be a unit quaternion, its length is {0}")]
    NotUnit(f64),
    /// A fixed body was given a velocity.
    #[error("linear_velocity and angular_velocity of a fixed body must be zero")]
    MovingFixed,
    /// A point mass, having no inertia, cannot have an angular velocity.
    #[error("angular_velocity of a point mass must be zero: it has no inertia")]
    SpinningPoint,
    /// Its shape or its material cannot be those of a collider.
    #[error(transparent)]
    Collider(#[from] ColliderError),
}

tumble_math::debug_as_display!(BodyError);

impl BodyError {
    /// The field at fault, by the name it has in scene files: `mass`, `shape.radius`, `inertia`,
    /// `orientation`, …
    pub fn field(&self) -> String {
        match self {
            Self::MissingMass | Self::Mass(_) | Self::MassRange(_) => "mass".to_owned(),
            Self::Shape(error) => match error.path().as_str() {
                own @ ("mass" | "density") => own.to_owned(),
                path => format!("shape.{path}"),
            },
            Self::Inertia(_) | Self::InertiaRange(_) => "inertia".to_owned(),
            Self::NotFinite { field, .. } | Self::TooLarge { field, .. } | Self::Number { field, .. } => {
                (*field).to_owned()
            }
            Self::NotUnit(_) => "orientation".to_owned(),
            Self::MovingFixed => "linear_velocity".to_owned(),
            Self::SpinningPoint => "angular_velocity".to_owned(),
            Self::Collider(ColliderError::Material { field, .. }) => format!("material.{field}"),
            Self::Collider(ColliderError::Length { field, .. } | ColliderError::Size { field, .. }) => {
                format!("shape.{field}")
            }
            Self::Collider(_) => "collider".to_owned(),
        }
    }
}
