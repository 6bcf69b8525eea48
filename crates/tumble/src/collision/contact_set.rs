//! The contacts of a world in a substep: what collision detection gives to the solver.

use crate::collision::contact::ContactRecord;
use crate::collision::contact_materials::Extras;
use crate::collision::round_contact::RoundContact;
use crate::math::Real;

/// The contacts that there are, with the impulses that they begin with.
#[derive(Clone, Default)]
pub(crate) struct ContactSet {
    /// In the order of their keys.
    pub(crate) records: Vec<ContactRecord>,
    /// Of those of round shapes, what they are found again with as their bodies move.
    pub(crate) rounds: Vec<RoundContact>,
    pub(crate) extras: Extras,
    /// Length of the substeps that their impulses are for \[s\]; zero where it is not known.
    pub(crate) substep: Real,
}

impl ContactSet {
    /// Drops the others.
    pub(crate) fn retain(&mut self, stays: impl Fn(&ContactRecord) -> bool) {
        let Self { records, rounds, .. } = self;
        let mut numbers = Vec::with_capacity(records.len());
        let mut next = 0;
        records.retain(|contact| {
            let stays = stays(contact);
            numbers.push(stays.then_some(next));
            next += u32::from(stays);
            stays
        });
        rounds.retain_mut(|round| match numbers[round.contact as usize] {
            Some(number) => {
                round.contact = number;
                true
            }
            None => false,
        });
    }
}
