//! Dynamic, kinematic and fixed bodies, distinguished by their components.

use std::fmt;

use hecs::Archetype;

use crate::components::momentum::Momentum;
use crate::components::pose::Pose;
use crate::components::velocity::Velocity;

/// Whether a body is dynamic, kinematic or fixed, which decides what its state is.
///
/// ```
/// # use tumble::BodyKind;
/// assert_eq!(BodyKind::Kinematic.to_string(), "kinematic");
/// ```
#[doc(alias("RigidBodyType", "kinematic", "static", "dynamic"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BodyKind {
    /// Dynamic: it has [`Momentum`]. Pose and momentum are its state.
    Moving,
    /// It has a [`Velocity`] and no momentum. Pose and velocity are its state.
    Kinematic,
    /// It has neither. Its pose is its state: the caller may move it.
    Fixed,
}

impl BodyKind {
    /// In the order in which a snapshot holds them.
    pub(crate) const ALL: [Self; 3] = [Self::Moving, Self::Kinematic, Self::Fixed];

    /// Of the entities of an archetype; `None` where they are not bodies.
    pub(crate) fn of(archetype: &Archetype) -> Option<Self> {
        if archetype.is_empty() || !archetype.has::<Pose>() {
            None
        } else if archetype.has::<Momentum>() {
            Some(Self::Moving)
        } else if archetype.has::<Velocity>() {
            Some(Self::Kinematic)
        } else {
            Some(Self::Fixed)
        }
    }
}

impl fmt::Display for BodyKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Moving => "moving",
            Self::Kinematic => "kinematic",
            Self::Fixed => "fixed",
        })
    }
}
