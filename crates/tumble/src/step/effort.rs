//! How much work steps of a world are, so that threads get some only where it pays.

use hecs::World;

use crate::collision::collider::Collider;
use crate::collision::pipeline::CollisionPipeline;
use crate::forces::pairwise::{GravityMass, Spring};
use crate::forces::registry::ForceLaws;
use crate::joints::joint::Joint;
use crate::threads::{BODY, BODY_UNDER_LAWS, Effort};

/// Mutual gravity of two bodies.
const ATTRACTION: f64 = 0.002;
const SPRING: f64 = 0.2;
/// A joint, over four substeps.
const JOINT: f64 = 4.0;
/// A contact, from finding it to the last of four substeps.
const CONTACT: f64 = 0.6;
/// Added for a pair of shapes without lanes of their own.
const PAIR_OF_OTHERS: f64 = 3.0;

/// Of steps in a world, whose contacts were these after the last. Of bodies that act on each other
/// it is that of one step, for they wait for each other in every one.
pub(crate) fn effort_of_steps(
    world: &World,
    laws: &ForceLaws,
    collision: Option<&CollisionPipeline>,
    steps: u32,
) -> Effort {
    let [mut attracting, mut springs, mut joints, mut colliders] = [0.0; 4];
    let mut bodies = 0.0;
    // Nothing acts on what is alone, and asking for components is a part of its step that shows.
    let is_alone = world.len() == 1;
    for archetype in world.archetypes().filter(|archetype| !archetype.is_empty()) {
        let count = f64::from(archetype.len());
        bodies += count * if laws.may_act_on(archetype) { BODY_UNDER_LAWS } else { BODY };
        if is_alone {
            continue;
        }
        attracting += if archetype.has::<GravityMass>() { count } else { 0.0 };
        springs += if archetype.has::<Spring>() { count } else { 0.0 };
        joints += if archetype.has::<Joint>() { count } else { 0.0 };
        colliders += if archetype.has::<Collider>() { count } else { 0.0 };
    }
    if attracting + springs + joints + colliders == 0.0 {
        return Effort::of_microseconds(bodies * f64::from(steps));
    }
    // Before the first step the number of contacts is unknown.
    let (known, of_others) = collision.map_or((0, 0), CollisionPipeline::counts);
    let contacts = CONTACT * colliders.max(known as f64) + PAIR_OF_OTHERS * of_others as f64;
    Effort::of_microseconds(
        bodies + ATTRACTION * attracting * attracting + SPRING * springs + JOINT * joints + contacts,
    )
}
