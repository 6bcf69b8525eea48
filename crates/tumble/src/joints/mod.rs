//! Joints between bodies: the component, what it leaves free, and those of a world by slot.

pub(crate) mod axes;
pub(crate) mod axis_lock;
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
pub(crate) mod locked_axes;

use hecs::World;

use crate::joints::joint::Joint;
use crate::joints::locked_axes::LockedAxes;

/// Whether there are joints in a world, or bodies with locked axes.
pub(crate) fn are_in(world: &World) -> bool {
    let mut archetypes = world.archetypes().filter(|archetype| !archetype.is_empty());
    archetypes.any(|archetype| archetype.has::<Joint>() || archetype.has::<LockedAxes>())
}
