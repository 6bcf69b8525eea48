//! The components of a body, grouped by who writes them.
//!
//! | written | components |
//! |---|---|
//! | at spawn | [`Mass`], [`Inertia`], [`PrincipalAxes`], [`CenterOfMass`], [`BodyId`] |
//! | by [`integrate`](crate::integrate) (the state) | [`Pose`], [`Momentum`] |
//! | by the caller, consumed by the step | [`Wrench`] |
//! | by [`update_derived`](crate::update_derived) | [`Velocity`], [`InverseInertia`] |
//! | by the caller, kept until removed | [`GravityScale`], [`Damping`], and [laws](crate::ForceLaw) of the caller's own |
//! | by [`integrate`](crate::integrate), where a [`Ledger`](crate::Ledger) wants it | [`Work`] |

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
