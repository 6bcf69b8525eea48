//! Which contacts are solved with the joints of a mechanism.
//!
//! Contacts of its bodies with what is not dynamic come first, then free bodies join it with
//! theirs: an impulse that a light body of it takes from a heavy free one, or through a light one
//! to the ground, is answered by all of them. The most loaded come first, as far as a budget goes.
//! All others are in passes, also those of two of its own bodies: where joints keep what overlaps
//! from parting, the impulses that would part it have no bound, and in passes they are those of the
//! two bodies alone.

use crate::collision::contact::ContactRecord;
use crate::math::Real;
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::solver_bodies::{SolverBodies, SolverRow};
use crate::solver::substeps::GroupContact;

/// The most rows of a mechanism's direct contacts: their problem is dense.
const MAX_ROWS: usize = 64;

/// To which mechanism a body belongs: by its joints, with its number there, or because it has
/// joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Owner {
    pub(crate) mechanism: u32,
    pub(crate) body: Option<u32>,
}

/// The contacts of a group, and which of them have been chosen.
pub(crate) struct DirectChoice<'a> {
    records: &'a [ContactRecord],
    numbers: Vec<u32>,
    rows: Vec<[SolverRow; 2]>,
    bodies: &'a SolverBodies,
    owners: Vec<Option<Owner>>,
    /// By row, the contacts of a body that impulses move.
    of_row: Vec<Vec<u32>>,
    is_direct: Vec<bool>,
    is_number_direct: Vec<bool>,
}

impl<'a> DirectChoice<'a> {
    pub(crate) fn new(records: &'a [ContactRecord], contacts: &[GroupContact], bodies: &'a SolverBodies) -> Self {
        let mut of_row = vec![Vec::new(); bodies.first_non_dynamic()];
        for (place, contact) in (0..).zip(contacts) {
            let moving = contact.rows.into_iter().filter(|row| bodies.is_dynamic(*row));
            moving.for_each(|row| of_row[row.index()].push(place));
        }
        Self {
            records,
            numbers: contacts.iter().map(|contact| contact.number).collect(),
            rows: contacts.iter().map(|contact| contact.rows).collect(),
            bodies,
            owners: vec![None; bodies.len()],
            of_row,
            is_direct: vec![false; contacts.len()],
            is_number_direct: vec![false; records.len()],
        }
    }

    /// Notes the bodies of a mechanism that impulses move.
    pub(crate) fn own<'b>(&mut self, mechanism: u32, bodies: impl Iterator<Item = &'b MechanismBody>) {
        for (body, of_body) in (0..).zip(bodies).filter(|(_, of_body)| of_body.is_moved()) {
            self.owners[of_body.row.index()] = Some(Owner { mechanism, body: Some(body) });
        }
    }

    pub(crate) fn owner(&self, row: SolverRow) -> Option<Owner> {
        self.owners[row.index()]
    }

    /// Whether the contact at a place of the group has been chosen.
    pub(crate) fn is_direct(&self, place: usize) -> bool {
        self.is_direct[place]
    }

    /// Whether the contact with this number among all has been chosen.
    pub(crate) fn is_number_direct(&self, number: u32) -> bool {
        self.is_number_direct[number as usize]
    }

    /// Chooses the contacts of a mechanism; returns their places in the group, in its order.
    pub(crate) fn choose(&mut self, mechanism: u32) -> Vec<usize> {
        let of_it = |owner: &Option<Owner>| owner.is_some_and(|owner| owner.mechanism == mechanism);
        let owned = self.owners.iter().zip(&self.of_row).filter(|(owner, _)| of_it(owner));
        let mut waiting: Vec<u32> = owned.flat_map(|(_, contacts)| contacts).copied().collect();
        let (mut chosen, mut left) = (Vec::new(), MAX_ROWS);
        // What has all its bodies in the mechanism, then the next body that joins it.
        loop {
            self.sort(&mut waiting);
            let (whole, others): (Vec<u32>, Vec<u32>) =
                waiting.iter().partition(|place| self.lacks(**place as usize, mechanism) == Some(None));
            for place in whole {
                let rows = self.count(place as usize);
                if rows <= left {
                    left -= rows;
                    self.is_direct[place as usize] = true;
                    self.is_number_direct[self.numbers[place as usize] as usize] = true;
                    chosen.push(place as usize);
                }
            }
            let joins = |place: &u32| self.lacks(*place as usize, mechanism).flatten().map(|row| (*place, row));
            let Some((place, row)) =
                others.iter().find_map(joins).filter(|(place, _)| self.count(*place as usize) <= left)
            else {
                chosen.sort_unstable();
                return chosen;
            };
            debug_assert!(!self.is_direct[place as usize]);
            self.owners[row.index()] = Some(Owner { mechanism, body: None });
            waiting = others;
            waiting.extend(&self.of_row[row.index()]);
        }
    }

    /// Those with the greatest impulses first, each once.
    fn sort(&self, places: &mut Vec<u32>) {
        let load = |place: u32| {
            let record = &self.records[self.numbers[place as usize] as usize];
            record.normal_impulses.at_points.iter().sum::<Real>()
        };
        places.sort_by(|a, b| load(*b).total_cmp(&load(*a)).then(a.cmp(b)));
        places.dedup();
    }

    /// The free body that has to join a mechanism for a contact to be solved with it, if any;
    /// `None` where it cannot be.
    fn lacks(&self, place: usize, mechanism: u32) -> Option<Option<SolverRow>> {
        if self.records[self.numbers[place] as usize].is_of_meeting_centers() || self.is_direct[place] {
            return None;
        }
        let (mut lacking, mut jointed) = (None, 0);
        for row in self.rows[place].into_iter().filter(|row| self.bodies.is_dynamic(*row)) {
            match self.owners[row.index()] {
                Some(owner) if owner.mechanism == mechanism => jointed += usize::from(owner.body.is_some()),
                // Of another mechanism.
                Some(_) => return None,
                None if self.bodies.locked.has(row) => return None,
                None => lacking = Some(row),
            }
        }
        (jointed < 2).then_some(lacking)
    }

    /// How many rows a contact takes at most.
    fn count(&self, place: usize) -> usize {
        let record = &self.records[self.numbers[place] as usize];
        let rolls = record.geometry.rolling_resistance > 0.0;
        record.count() + if record.count() > 1 { 3 } else { 2 } + if rolls { 2 } else { 0 }
    }
}
