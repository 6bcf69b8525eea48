//! Colliders, materials and events of contacts: bodies with colliders push each other.
//!
//! Once a step, or a substep of the settings: bodies with colliders are gathered in the order of
//! [`BodyId`](crate::BodyId), those near each other found, and each touching pair becomes a
//! `ContactRecord`. Then momenta and poses of all bodies that touch
//! something are advanced together in substeps: forces, a pass that pushes bodies apart, free
//! motion, a pass that takes the push's velocity out again and adds friction ("Small Steps in
//! Physics Simulation", M. Macklin and others, SCA 2019; E. Catto, "Solver2D", 2024). Bodies
//! without contacts are left to the integrator of the settings.

pub(crate) mod aabb_tiles;
pub(crate) mod body_key;
pub(crate) mod collider;
pub(crate) mod collider_error;
pub(crate) mod collider_shape;
pub(crate) mod collider_state;
pub(crate) mod compound_parts;
pub(crate) mod contact;
pub(crate) mod contact_cache;
pub(crate) mod contact_events;
pub(crate) mod contact_hook;
pub(crate) mod contact_materials;
pub(crate) mod contact_rows;
pub(crate) mod contact_set;
pub(crate) mod contact_ways;
pub(crate) mod crossed_axes;
pub(crate) mod internal_edges;
pub(crate) mod islands;
pub(crate) mod jointed_reach;
pub(crate) mod lost_momentum;
pub(crate) mod material;
pub(crate) mod met_contacts;
pub(crate) mod narrow_phase;
pub(crate) mod near_pairs;
pub(crate) mod pair_limit;
pub(crate) mod partners;
pub(crate) mod pipeline;
pub(crate) mod remaining_motion;
pub(crate) mod rest;
pub(crate) mod round_contact;
pub(crate) mod saved_contacts;
pub(crate) mod sensors;
pub(crate) mod sleep;
pub(crate) mod sleep_mask;
pub(crate) mod speculative;
pub(crate) mod strike;
pub(crate) mod sweep;
pub(crate) mod traveller;
pub(crate) mod update_aabbs;

pub use crate::collision::collider::Collider;
pub use crate::collision::collider_error::ColliderError;
pub use crate::collision::contact_events::{ContactEvent, Impact};
pub use crate::collision::contact_hook::ContactProposal;
pub use crate::collision::material::{CombineRule, Material};
pub use crate::collision::sensors::SensorEvent;

use hecs::World;

/// Whether any contacts are possible in a world.
pub(crate) fn are_in(world: &World) -> bool {
    world.archetypes().any(|archetype| !archetype.is_empty() && archetype.has::<Collider>())
}
