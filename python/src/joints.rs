//! Joints: where they stand, what they carry, and their drives, as numbers.

use hecs::{Entity, World};
use tumble::math::Real;
use tumble::{Drives, JointLoad};

use crate::state::Layout;

/// Numbers of a joint.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum JointQuantity {
    Values,
    Speeds,
    Forces,
    Torques,
}

impl JointQuantity {
    /// Numbers of a joint.
    pub(crate) fn width(self) -> usize {
        match self {
            Self::Values | Self::Speeds => 6,
            Self::Forces | Self::Torques => 3,
        }
    }
}

/// Lets the step write what the joints carry.
pub(crate) fn watch(world: &mut World, joints: &[Entity]) {
    for &joint in joints {
        // The joint is there: it was found in this world.
        drop(world.insert_one(joint, JointLoad::default()));
    }
}

/// Writes a quantity of all joints of a world, joint after joint.
pub(crate) fn read(world: &World, joints: &[Entity], quantity: JointQuantity, to: &mut [Real]) {
    for (&joint, place) in joints.iter().zip(to.chunks_mut(quantity.width())) {
        let Ok(load) = world.get::<&JointLoad>(joint) else { continue };
        match quantity {
            JointQuantity::Values => place.copy_from_slice(&load.values),
            JointQuantity::Speeds => place.copy_from_slice(&load.speeds),
            JointQuantity::Forces => place.copy_from_slice(&load.force.to_array()),
            JointQuantity::Torques => place.copy_from_slice(&load.torque.to_array()),
        }
    }
}

/// A number of a drive.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum DriveQuantity {
    Positions,
    Velocities,
    MaxForces,
}

impl DriveQuantity {
    /// As it is called in Python.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Positions => "positions",
            Self::Velocities => "velocities",
            Self::MaxForces => "max_forces",
        }
    }

    /// What the numbers must be, if one of them is not.
    pub(crate) fn fault(self, numbers: &[Real]) -> Option<String> {
        let (is_right, needed): (fn(&Real) -> bool, _) = match self {
            Self::Positions => (|number| number.is_finite() || number.is_nan(), "a finite number, or nan for none"),
            Self::Velocities => (|number| number.is_finite(), "a finite number"),
            Self::MaxForces => (|number| *number >= 0.0, "0 or more, or infinite"),
        };
        let wrong = numbers.iter().find(|number| !is_right(number))?;
        Some(format!("{wrong} is not {needed}"))
    }
}

/// Writes a number of each drive: of the positions nan where there is none.
pub(crate) fn read_drives(world: &World, layout: &Layout, quantity: DriveQuantity, to: &mut [Real]) {
    for (&(joint, drive), place) in layout.drives.iter().zip(to) {
        let Some(&joint) = layout.joints.get(joint) else { continue };
        let Ok(drives) = world.get::<&Drives>(joint) else { continue };
        let Some(drive) = drives.0.get(drive) else { continue };
        *place = match quantity {
            DriveQuantity::Positions => drive.position.unwrap_or(Real::NAN),
            DriveQuantity::Velocities => drive.velocity,
            DriveQuantity::MaxForces => drive.max_force,
        };
    }
}

/// Gives the chosen drives their numbers.
pub(crate) fn set_drives(world: &World, layout: &Layout, chosen: &[usize], quantity: DriveQuantity, numbers: &[Real]) {
    for (&index, &number) in chosen.iter().zip(numbers) {
        let Some(&(joint, drive)) = layout.drives.get(index) else { continue };
        let Some(&joint) = layout.joints.get(joint) else { continue };
        let Ok(mut drives) = world.get::<&mut Drives>(joint) else { continue };
        let Some(drive) = drives.0.get_mut(drive) else { continue };
        match quantity {
            DriveQuantity::Positions => drive.position = Some(number).filter(|number| !number.is_nan()),
            DriveQuantity::Velocities => drive.velocity = number,
            DriveQuantity::MaxForces => drive.max_force = number,
        }
    }
}
