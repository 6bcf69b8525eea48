//! The impulses that joints in passes begin a step with.

use crate::joints::joint_list::ListedJoint;
use crate::math::Real;
use crate::storage::body_index::Slot;

/// The most rows of a joint.
pub(crate) const MAX_ROWS: usize = 6;

/// Impulses along the rows of a joint in a substep, zero beyond them \[N s\] [N m s].
pub(crate) type RowImpulses = [Real; MAX_ROWS];

/// By joint in passes, in the order of the list of joints, what it did in the last substep. It is
/// state.
#[derive(Clone, Debug, Default)]
pub(crate) struct HeldImpulses {
    pub(crate) joints: Vec<HeldImpulse>,
}

/// The impulses of a joint in a substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HeldImpulse {
    /// Its bodies, in its own order.
    pub(crate) slots: [Slot; 2],
    /// On the second body.
    pub(crate) impulses: RowImpulses,
}

impl HeldImpulses {
    pub(crate) fn clear(&mut self) {
        self.joints.clear();
    }

    /// Gives them the slots that their bodies have now; `slots` are these by slot before. Those of
    /// bodies that are gone are dropped.
    pub(crate) fn renumber(&mut self, slots: &[Slot]) {
        let slot = |before: Slot| slots.get(before.index()).copied().filter(|slot| *slot != Slot::NONE);
        self.joints.retain_mut(|held| {
            let [Some(a), Some(b)] = held.slots.map(slot) else { return false };
            held.slots = [a, b];
            true
        });
        self.joints.sort_by_key(|held| held.slots);
    }

    /// The impulses of joints that are asked for in the order of the list: of several between the
    /// same bodies in their order, and zero where there are none.
    pub(crate) fn in_order(&self) -> impl FnMut(&ListedJoint) -> RowImpulses + '_ {
        let mut next = self.joints.iter().peekable();
        move |joint| {
            while next.next_if(|held| held.slots < joint.slots).is_some() {}
            next.next_if(|held| held.slots == joint.slots).map_or(RowImpulses::default(), |held| held.impulses)
        }
    }

    /// Whether all its numbers are finite.
    pub(crate) fn are_finite(&self) -> bool {
        self.joints.iter().flat_map(|held| held.impulses).all(Real::is_finite)
    }
}
