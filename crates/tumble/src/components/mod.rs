//! The components of a body; who writes which is in the documentation of the crate.

pub(crate) mod body_id;
pub(crate) mod body_kind;
pub(crate) mod inertia;
pub(crate) mod mass;
pub(crate) mod momentum;
pub(crate) mod persistent;
pub(crate) mod pose;
pub(crate) mod property_error;
pub(crate) mod velocity;
pub(crate) mod wind;
pub(crate) mod work;
pub(crate) mod wrench;

pub use crate::components::body_id::BodyId;
pub use crate::components::body_kind::BodyKind;
pub use crate::components::inertia::{CenterOfMass, Inertia, InertiaComponentError, InverseInertia, PrincipalAxes};
pub use crate::components::mass::Mass;
pub use crate::components::momentum::Momentum;
pub use crate::components::persistent::{Damping, GravityScale};
pub use crate::components::pose::{Pose, PreviousPose};
pub use crate::components::property_error::PropertyError;
pub use crate::components::velocity::Velocity;
pub use crate::components::wind::Wind;
pub use crate::components::work::Work;
pub use crate::components::wrench::Wrench;
pub(crate) use crate::components::wrench::Wrenches;
