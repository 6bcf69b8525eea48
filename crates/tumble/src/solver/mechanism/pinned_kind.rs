//! Kinds of joints that are computed four at a time.

use crate::solver::mechanism::free_axis::FreeAxis;
use crate::solver::mechanism::joint_rows::JointRows;
use crate::solver::mechanism::rotations::Rotations;

/// What joints have in common that lock all translations, and along whose free axes nothing acts
/// but about the axis of a hinge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PinnedKind {
    pub(super) rotations: Rotations,
    /// Whether the last row is that of a hinge's axis.
    pub(super) has_free_row: bool,
}

impl PinnedKind {
    pub(super) const BALL: Self = Self { rotations: Rotations::Free, has_free_row: false };
    pub(super) const HINGE: Self = Self { rotations: Rotations::About(0), has_free_row: false };
    pub(super) const DRIVEN_HINGE: Self = Self { rotations: Rotations::About(0), has_free_row: true };
    pub(super) const WELD: Self = Self { rotations: Rotations::Locked, has_free_row: false };

    /// That of joints which have the same; `None` where they differ, or one has another.
    pub(super) fn of_all(joints: &[JointRows]) -> Option<Self> {
        let kind = Self::of(joints.first()?)?;
        joints.iter().all(|joint| Self::of(joint) == Some(kind)).then_some(kind)
    }

    fn of(joint: &JointRows) -> Option<Self> {
        let has_free_row = match &joint.free_rows[..] {
            [] => false,
            [row] if row.axis == FreeAxis::Rotation(0) => true,
            _ => return None,
        };
        let kind = Self { rotations: joint.rotations, has_free_row };
        let is_known = [Self::BALL, Self::HINGE, Self::DRIVEN_HINGE, Self::WELD].contains(&kind);
        (joint.is_pinned() && is_known).then_some(kind)
    }

    /// How many rows turn the bodies about an axis: those after the first three.
    #[inline(always)]
    pub(super) fn turning_rows(self) -> usize {
        self.rotations.locked() + if self.has_free_row { 1 } else { 0 }
    }
}
