//! Forces between bodies: springs and gravity among them.
//!
//! Forces between two bodies cannot be computed a chunk at a time. So these forces are
//! kicks: impulses on all bodies concerned, before and after each substep of everything else (the
//! first alone for the first-order integrator). Momentum changes and place does not, so no stage of
//! an integrator sees half a kick.
//!
//! Bodies are gathered in the order of `BodyId`, and every sum is taken in an order that follows
//! from it.

pub(crate) mod between_bodies;
pub(crate) mod gravity_mass;
pub(crate) mod pair_forces;
pub(crate) mod potential;
pub(crate) mod spring;
pub(crate) mod spring_impulse;

pub use crate::forces::pairwise::gravity_mass::GravityMass;
pub(crate) use crate::forces::pairwise::pair_forces::PairForces;
pub(crate) use crate::forces::pairwise::potential::potential;
pub use crate::forces::pairwise::spring::Spring;

use hecs::World;

use crate::forces::registry::may_have_forces;

/// Whether there may be such forces in a world.
pub(crate) fn are_in(world: &World) -> bool {
    let mut archetypes = world.archetypes().filter(|archetype| !archetype.is_empty() && may_have_forces(archetype));
    archetypes.any(|archetype| archetype.has::<Spring>() || archetype.has::<GravityMass>())
}
