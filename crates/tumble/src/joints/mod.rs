//! Joints between bodies, with limits, drives, friction and gears; locked axes.

pub(crate) mod axes;
pub(crate) mod axis_lock;
pub(crate) mod breakable;
pub(crate) mod drives;
pub(crate) mod friction;
pub(crate) mod gain;
pub(crate) mod gear;
pub(crate) mod held_impulses;
pub(crate) mod ignore_contacts;
pub(crate) mod joint;
pub(crate) mod joint_error;
pub(crate) mod joint_event;
pub(crate) mod joint_list;
pub(crate) mod joint_load;
pub(crate) mod joint_marks;
pub(crate) mod joint_options;
pub(crate) mod limits;
pub(crate) mod locked_axes;
pub(crate) mod oscillation;

pub use crate::joint_solver::{JointSolver, UnknownJointSolver};
pub use crate::joints::axes::Axes;
pub use crate::joints::breakable::Breakable;
pub use crate::joints::drives::{Drive, Drives};
pub use crate::joints::friction::JointFriction;
pub use crate::joints::gain::Gain;
pub use crate::joints::gear::Gear;
pub use crate::joints::ignore_contacts::IgnoreContacts;
pub use crate::joints::joint::Joint;
pub use crate::joints::joint_error::JointError;
pub use crate::joints::joint_event::JointEvent;
pub use crate::joints::joint_load::JointLoad;
pub use crate::joints::limits::{Cone, Limit, Limits};
pub use crate::joints::locked_axes::LockedAxes;
pub use crate::joints::oscillation::Oscillation;

use hecs::World;

/// Whether there are joints in a world, or bodies with locked axes.
pub(crate) fn are_in(world: &World) -> bool {
    let mut archetypes = world.archetypes().filter(|archetype| !archetype.is_empty());
    archetypes.any(|archetype| archetype.has::<Joint>() || archetype.has::<LockedAxes>())
}
