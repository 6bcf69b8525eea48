//! Chunks of bodies that have nothing but what a body needs.

use crate::components::{Inertia, InverseInertia, Mass, Momentum, Pose, Velocity, Wrench};
use crate::storage::chunk::Chunk;

/// Bodies that have moments of inertia and derived quantities, and no principal axes apart from
/// the body's, no damping, no gravity of their own, no previous pose and no account of work.
pub(crate) struct PlainChunk<'a> {
    first_row: usize,
    pose: &'a mut [Pose],
    momentum: &'a mut [Momentum],
    wrench: &'a mut [Wrench],
    velocity: &'a mut [Velocity],
    inverse_inertia: &'a mut [InverseInertia],
    mass: &'a [Mass],
    inertia: &'a [Inertia],
}

impl<'a> PlainChunk<'a> {
    /// The bodies of a chunk; `None` where they have something else, or less.
    pub(crate) fn of(bodies: &'a mut Chunk<'_>) -> Option<Self> {
        let has_more = bodies.axes.is_some()
            || bodies.damping.is_some()
            || bodies.gravity_scale.is_some()
            || bodies.previous_pose.is_some()
            || bodies.work.is_some();
        if has_more {
            return None;
        }
        Some(Self {
            first_row: bodies.first_row,
            velocity: bodies.velocity.as_deref_mut()?,
            inverse_inertia: bodies.inverse_inertia.as_deref_mut()?,
            inertia: bodies.inertia?,
            pose: bodies.pose,
            momentum: bodies.momentum,
            wrench: bodies.wrench,
            mass: bodies.mass,
        })
    }

    /// How many bodies.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.pose.len()
    }

    /// The same bodies as a chunk. What they have and what they lack is known where this is
    /// inlined.
    #[inline(always)]
    pub(crate) fn as_chunk(&mut self) -> Chunk<'_> {
        Chunk {
            first_row: self.first_row,
            pose: self.pose,
            momentum: self.momentum,
            wrench: self.wrench,
            mass: self.mass,
            velocity: Some(self.velocity),
            inverse_inertia: Some(self.inverse_inertia),
            previous_pose: None,
            work: None,
            inertia: Some(self.inertia),
            axes: None,
            gravity_scale: None,
            damping: None,
            wind: None,
        }
    }
}
