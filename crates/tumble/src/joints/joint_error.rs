//! Why a joint cannot be made.

use hecs::Entity;

/// Why the frames of a [`Joint`](crate::Joint) cannot be set.
///
/// ```
/// use tumble::{Joint, JointError, prelude::*};
///
/// let mut world = tumble::hecs::World::new();
/// let door =
///     RigidBody::new(Shape::cuboid([0.5, 1.0, 0.05])).mass(20.0).build()?.spawn(&mut world);
/// let error = Joint::hinge(door, door).at(&world, Vec3::ZERO, Vec3::Y).unwrap_err();
/// assert_eq!(error, JointError::SameBody(door));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JointError {
    /// Both ends are the same entity.
    #[error("both ends of a joint are {0:?}: it takes two bodies")]
    SameBody(Entity),
    /// An end is not in the world, or has no [`Pose`](crate::Pose).
    #[error("{0:?}, an end of a joint, is not a body of this world: it has no Pose there")]
    NoBody(Entity),
    /// The point is not finite, or further away than bodies can be.
    #[error("the point of the joint between {0:?} and {1:?} is not finite or too far away")]
    Point(Entity, Entity),
    /// The axis is zero or not finite.
    #[error("the axis of the joint between {0:?} and {1:?} is zero or not finite")]
    Axis(Entity, Entity),
}

tumble_math::debug_as_display!(JointError);
