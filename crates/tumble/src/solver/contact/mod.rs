//! Contact constraints: effective masses, impulses, friction and restitution.

pub(crate) mod capsule_axes;
pub(crate) mod constraint;
pub(crate) mod contact_frame;
pub(crate) mod effective_mass;
pub(crate) mod follow_bodies;
pub(crate) mod free_collision;
pub(crate) mod friction;
pub(crate) mod impact;
pub(crate) mod line;
pub(crate) mod prepare;
pub(crate) mod restitution;
pub(crate) mod round_contacts;
pub(crate) mod softness;
pub(crate) mod solve;
pub(crate) mod store_impulses;
pub(crate) mod update_geometry;
