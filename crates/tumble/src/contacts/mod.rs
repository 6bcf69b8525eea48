//! Contacts: bodies with colliders that touch push each other.
//!
//! Once a step, or a substep of the settings: bodies with colliders are gathered in the order of [`BodyId`](crate::BodyId), those near each other found, and
//! each touching pair becomes a [`Contact`](contact::Contact). Then momenta and poses of all bodies that touch something are advanced together in substeps: forces, a pass that
//! pushes bodies apart, free motion, a pass that takes the push's velocity out again and adds friction ("Small Steps in Physics Simulation", M. Macklin and others,
//! SCA 2019; E. Catto, "Solver2D", 2024). What touches nothing is left to the integrator of the settings.

mod block;
mod blow;
mod booking;
mod collider;
mod collider_error;
mod collider_shape;
mod colouring;
mod contact;
mod crowds;
mod effective_mass;
mod events;
mod finer;
mod foreseen;
mod frame;
mod gathering;
mod islands;
mod keep;
mod keeping;
mod material;
mod materials;
mod names;
mod narrow;
mod packed;
mod parts;
mod passes;
mod prepare;
mod pushing;
mod reading;
mod refine;
mod refresh;
mod rows;
mod rubbing;
mod saved;
mod seams;
mod sight;
mod soft;
mod solver;
mod solver_bodies;
mod stacks;
mod touching;

pub use collider::Collider;
pub use collider_error::ColliderError;
pub use events::ContactEvent;
pub use material::{Combine, Material};
pub(crate) use names::Name;
pub(crate) use packed::{Likeness, Packed};
pub use reading::{Contact, ContactPoint};
pub(crate) use saved::{SavedContact, SavedContacts, SavedPoint};
pub(crate) use touching::Contacts;

use hecs::World;

/// Whether anything in a world can touch anything.
pub(crate) fn are_in(world: &World) -> bool {
    world.archetypes().any(|archetype| !archetype.is_empty() && archetype.has::<Collider>())
}
