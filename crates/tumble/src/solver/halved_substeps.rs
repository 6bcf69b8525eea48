//! Islands solved with shorter substeps: extraction from the main group, solution and write-back.

use crate::collision::contact::ContactRecord;
use crate::math::Real;
use crate::solver::solver_bodies::SolverRow;
use crate::solver::substeps::{SolverGroup, SubstepSettings};

/// The islands whose substeps are shorter than the others'.
#[derive(Clone, Default)]
pub(crate) struct HalvedGroup {
    /// How often the substeps are halved.
    halvings: u8,
    group: SolverGroup,
    /// Rows among all bodies of those here.
    rows: Vec<SolverRow>,
    /// By row among all bodies, the row here.
    places: Vec<SolverRow>,
}

/// In the place of a row here.
const NONE: SolverRow = SolverRow(u32::MAX);

impl HalvedGroup {
    /// Takes the contacts whose substeps are halved `these` times, and copies their bodies.
    pub(crate) fn take(&mut self, (these, halvings): (u8, &[u8]), all: &mut SolverGroup) {
        let Self { group, rows, places, .. } = self;
        let is_here = |number: u32| halvings[number as usize] == these;
        self.halvings = these;
        places.clear();
        places.resize(all.bodies.len(), NONE);
        group.contacts.clear();
        group.contacts.extend(all.contacts.extract_if(.., |contact| is_here(contact.number)));
        for row in group.contacts.iter().flat_map(|contact| contact.rows) {
            places[row.index()] = SolverRow(0);
        }
        rows.clear();
        rows.extend((0..places.len() as u32).map(SolverRow).filter(|row| places[row.index()] != NONE));
        group.bodies.copy(&all.bodies, rows, these);
        for (place, row) in group.bodies.places(rows) {
            places[row] = SolverRow(place as u32);
        }
        group.contact_works.copy(&all.contact_works, |row| place(places, row), these);
        group.rounds.clear();
        group.rounds.extend(all.rounds.extract_if(.., |round| is_here(round.number())));
        group.free_collisions.clear();
        group.free_collisions.extend(all.free_collisions.extract_if(.., |collision| is_here(collision.number)));
        let here = |all: [SolverRow; 2]| all.map(|row| places[row.index()]);
        group.rounds.iter_mut().for_each(|round| round.rows = here(round.rows));
        group.free_collisions.iter_mut().for_each(|collision| collision.rows = here(collision.rows));
        group.contacts.iter_mut().for_each(|contact| contact.rows = here(contact.rows));
    }

    /// Advances them by a substep of the settings, as others are `solving` theirs.
    pub(crate) fn solve_substeps(&mut self, contacts: &mut [ContactRecord], solving: SubstepSettings) {
        self.group.solve_substeps(contacts, solving.halved(self.halvings), None);
    }

    /// Copies the results back, with impulses over a substep of the settings.
    pub(crate) fn return_results(&self, contacts: &mut [ContactRecord], all: &mut SolverGroup) {
        let parts = (1u32 << self.halvings) as Real;
        self.group.contacts.iter().for_each(|contact| contacts[contact.number as usize].scale_impulses(parts));
        self.group.bodies.copy_back(&mut all.bodies, &self.rows);
        self.group.contact_works.copy_back(&mut all.contact_works, |row| place(&self.places, row));
    }
}

fn place(places: &[SolverRow], row: usize) -> Option<usize> {
    Some(places[row]).filter(|place| *place != NONE).map(SolverRow::index)
}
