use tumble_math::lane::Vec3;

use crate::math::Real;

/// What keeps two bodies apart at one point: an impulse along the normal that never pulls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Where the point is from the middle of the contact, along the tangents \[m\].
    pub(super) a: Real,
    pub(super) b: Real,
    /// Separation at the start of the step \[m\].
    pub(super) separation: Real,
    /// One over the velocity along the normal that a unit impulse gives \[kg\].
    pub(super) mass: Real,
    /// Impulse of a substep \[N s\].
    pub(super) impulse: Real,
    /// The greatest of the step.
    pub(super) most_impulse: Real,
    /// The fastest that the bodies came together here before the row held them, in this step: velocity along the normal \[m/s\].
    pub(super) approach: Real,
    pub(super) feature: u32,
}

/// Velocity and displacement of the second body seen from the first, at the middle of a contact.
#[derive(Clone, Copy)]
pub(super) struct Relative {
    pub(super) linear: Vec3<Real>,
    pub(super) angular: Vec3<Real>,
}
