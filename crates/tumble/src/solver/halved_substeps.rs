//! Islands solved with shorter substeps: extraction from the main group, solution and write-back.

use crate::collision::contact::ContactRecord;
use crate::collision::find_contacts::NONE;
use crate::math::Real;
use crate::solver::substeps::{SolverGroup, SubstepSettings};

/// The islands whose substeps are shorter than the others'.
#[derive(Clone, Default)]
pub(crate) struct HalvedGroup {
    /// How often the substeps are halved.
    halvings: u8,
    group: SolverGroup,
    /// Rows among all bodies of those here.
    rows: Vec<u32>,
    /// By row among all bodies, the row here.
    places: Vec<u32>,
}

impl HalvedGroup {
    /// Takes over what belongs to the contacts whose substeps are halved so often.
    pub(crate) fn take(
        &mut self,
        (these, halvings): (u8, &[u8]),
        contacts: &[ContactRecord],
        rows_of: impl Fn(&ContactRecord) -> [u32; 2],
        all: &mut SolverGroup,
    ) {
        let is_here = |contact: u32| halvings[contact as usize] == these;
        self.halvings = these;
        self.places.clear();
        self.places.resize(all.bodies.len(), NONE);
        self.group.selected.clear();
        self.group.selected.extend((0..contacts.len() as u32).filter(|contact| is_here(*contact)));
        for contact in &self.group.selected {
            rows_of(&contacts[*contact as usize]).into_iter().for_each(|row| self.places[row as usize] = 0);
        }
        self.rows.clear();
        self.rows.extend((0..self.places.len() as u32).filter(|row| self.places[*row as usize] != NONE));
        self.group.bodies.copy(&all.bodies, &self.rows, these);
        for (place, row) in self.group.bodies.places(&self.rows) {
            self.places[row] = place as u32;
        }
        self.group.contact_works.copy(&all.contact_works, |row| place(&self.places, row), these);
        self.group.rounds.clear();
        self.group.rounds.extend(all.rounds.extract_if(.., |round| is_here(round.contact)));
        for round in &mut self.group.rounds {
            round.rows = round.rows.map(|row| self.places[row as usize]);
        }
    }

    /// Advances them by a substep of the settings, as others are `solving` theirs.
    pub(crate) fn solve_substeps(
        &mut self,
        contacts: &mut [ContactRecord],
        rows_of: impl Fn(&ContactRecord) -> [u32; 2],
        solving: SubstepSettings,
    ) {
        let places = &self.places;
        let rows = |contact: &ContactRecord| rows_of(contact).map(|row| places[row as usize]);
        self.group.solve_substeps(contacts, rows, solving.halved(self.halvings));
    }

    /// Gives back what has become of them, the impulses as those of a substep of the settings.
    pub(crate) fn return_results(&self, contacts: &mut [ContactRecord], all: &mut SolverGroup) {
        let parts = (1u32 << self.halvings) as Real;
        self.group.selected.iter().for_each(|contact| contacts[*contact as usize].scale_impulses(parts));
        self.group.bodies.copy_back(&mut all.bodies, &self.rows);
        self.group.contact_works.copy_back(&mut all.contact_works, |row| place(&self.places, row));
    }
}

fn place(places: &[u32], row: usize) -> Option<usize> {
    Some(places[row]).filter(|place| *place != NONE).map(|place| place as usize)
}
