//! Joint contact solving of several small worlds, to fill the SIMD lanes.

use crate::collision::contact::ContactRecord;
use crate::collision::contact_materials::Extras;
use crate::settings::Settings;
use crate::solver::gather_scatter::{Constraints, ForceInputs};
use crate::solver::mechanism::mechanisms::Mechanisms;
use crate::solver::substeps::Solver;
use crate::storage::body_index::BodyIndex;
use crate::storage::world_columns::WorldColumns;

/// Contacts of several small worlds, solved side by side: of one world alone they would leave most
/// lanes empty.
///
/// A contact gets the same bits as alone. Its color depends on the contacts before it that have a
/// body in common with it, which are of its own world, and the contacts of a color do not depend on
/// each other.
#[derive(Default)]
pub(crate) struct MultiWorld {
    solver: Solver,
    /// Those of all worlds.
    contacts: Vec<ContactRecord>,
    /// Where the next world's rows begin: of dynamic bodies, and of others.
    next_rows: [usize; 2],
    /// How many contacts have been given back.
    returned: usize,
}

impl MultiWorld {
    /// Makes room for dynamic bodies, and for others.
    pub(crate) fn begin(&mut self, counts: [usize; 2]) {
        self.solver.reset(counts);
        self.contacts.clear();
        self.next_rows = self.solver.first_rows();
        self.returned = 0;
    }

    /// Adds the constrained bodies of a world, and their contacts.
    pub(crate) fn add(
        &mut self,
        mut constraints: Constraints<'_>,
        body_index: &BodyIndex,
        columns: &mut WorldColumns<'_>,
        inputs: ForceInputs<'_>,
    ) {
        self.next_rows = self.solver.add_world(&mut constraints, body_index, columns, inputs, self.next_rows);
        self.contacts.extend_from_slice(&constraints.contacts.records);
    }

    /// Solves the contacts of all worlds together, with settings that are alike.
    pub(crate) fn solve_substeps(&mut self, settings: &Settings, extras: Extras) {
        // Worlds with joints are not packed.
        self.solver.solve_substeps(&mut self.contacts, settings, extras, &mut Mechanisms::default());
    }

    /// Gives the contacts of the next world their impulses, in the order in which worlds were
    /// added.
    pub(crate) fn return_impulses(&mut self, contacts: &mut [ContactRecord]) {
        for (contact, solved) in contacts.iter_mut().zip(&self.contacts[self.returned..]) {
            (contact.normal_impulses, contact.friction) = (solved.normal_impulses, solved.friction);
            contact.total_impulse = solved.total_impulse;
        }
        self.returned += contacts.len();
    }

    pub(crate) fn solver(&self) -> &Solver {
        &self.solver
    }
}
