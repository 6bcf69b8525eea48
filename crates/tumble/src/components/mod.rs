//! The components of a body; who writes which is in the documentation of the crate.

mod body_id;
mod inertia;
mod mass;
mod momentum;
mod persistent;
mod pose;
mod velocity;
mod work;
mod wrench;

pub use body_id::BodyId;
pub use inertia::{CenterOfMass, Inertia, InertiaComponentError, InverseInertia, PrincipalAxes};
pub use mass::Mass;
pub use momentum::Momentum;
pub use persistent::{Damping, GravityScale};
pub use pose::{Pose, PreviousPose};
pub use velocity::Velocity;
pub use work::Work;
pub use wrench::Wrench;
