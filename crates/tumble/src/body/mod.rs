//! Bodies as they are made: from a shape and a mass to components, one by one or in batches.

pub(crate) mod body_columns;
pub(crate) mod body_error;
pub(crate) mod bundle;
pub(crate) mod change_mass;
pub(crate) mod rigid_body;
pub(crate) mod set_velocity;
pub(crate) mod spawn_bodies;
pub(crate) mod spawn_ground;
pub(crate) mod weld;

pub use crate::body::body_error::BodyError;
pub use crate::body::bundle::Body;
pub use crate::body::change_mass::{ChangeMassError, change_mass_properties};
pub use crate::body::rigid_body::RigidBody;
pub use crate::body::set_velocity::{VelocityError, set_angular_velocity, set_linear_velocity, set_velocity};
pub use crate::body::spawn_bodies::spawn_bodies;
pub use crate::body::spawn_ground::spawn_ground;
pub use crate::body::weld::{WeldError, weld};
