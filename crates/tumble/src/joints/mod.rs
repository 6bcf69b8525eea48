//! Joints between bodies: the component, what it leaves free, and those of a world by slot.

pub(crate) mod axes;
pub(crate) mod breakable;
pub(crate) mod drives;
pub(crate) mod friction;
pub(crate) mod gain;
pub(crate) mod gear;
pub(crate) mod ignore_contacts;
pub(crate) mod joint;
pub(crate) mod joint_error;
pub(crate) mod joint_event;
pub(crate) mod joint_list;
pub(crate) mod joint_load;
pub(crate) mod joint_options;
pub(crate) mod limits;

use hecs::World;

use crate::joints::joint::Joint;

/// Whether there are joints in a world.
pub(crate) fn are_in(world: &World) -> bool {
    world.archetypes().any(|archetype| !archetype.is_empty() && archetype.has::<Joint>())
}
