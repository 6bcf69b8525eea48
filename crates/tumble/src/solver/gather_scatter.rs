//! Between the columns of a world and the bodies that contacts are solved with.

use std::ops::Range;

use tumble_math::lane::Quat;

use crate::collision::find_contacts::{Contacts, NONE};
use crate::forces::evaluate::LawForces;
use crate::forces::force_context::ForceContext;
use crate::forces::registry::{ForceLaws, Laws};
use crate::integrators::Forces;
use crate::integrators::state::{Constants, State};
use crate::math::{Real, Vec3 as WorldVec3};
use crate::settings::Settings;
use crate::solver::contact_work::ContactWorks;
use crate::solver::solver_bodies::{FreeRows, SolverBodies};
use crate::solver::substeps::{ContactSolver, SolverGroup};
use crate::storage::chunk::{Chunk, MIN_CHUNK};
use crate::storage::world_columns::WorldColumns;
use crate::threads;

impl Contacts {
    /// Reads the bodies that touch something, and the forces on them as they are now, into rows
    /// from these on: of what impulses move, and of what they do not. Returns the rows after them.
    pub(crate) fn gather(
        &mut self,
        columns: &mut WorldColumns<'_>,
        (settings, laws, time): (&Settings, &ForceLaws, f64),
        group: &mut SolverGroup,
        [mut next_dynamic, mut next_non_dynamic]: [usize; 2],
    ) -> [usize; 2] {
        let Self { body_index, shapes, rows, .. } = self;
        let (SolverGroup { bodies, contact_works, .. }, mut begin, first_dynamic) = (group, next_dynamic, next_dynamic);
        for slot in body_index.in_order_of_places() {
            let shape = &shapes[slot];
            if rows[slot] == NONE {
                continue;
            }
            let next = if shape.moves { &mut next_dynamic } else { &mut next_non_dynamic };
            rows[slot] = *next as u32;
            if !shape.moves {
                bodies.set_non_dynamic(*next, shape.center, shape.velocity.0, shape.velocity.1);
            }
            *next += 1;
        }
        let gathering = Gather { rows, settings, time };
        laws.for_each_archetype_of(columns, |archetype, chunk, laws| {
            let slots = body_index.slots_in(archetype);
            let count = gathering.count(slots);
            debug_assert!(
                slots.is_empty() || slots.len() == chunk.len(),
                "all bodies of an archetype have colliders, or none"
            );
            debug_assert!(
                slots
                    .iter()
                    .map(|slot| rows[*slot as usize])
                    .find(|row| *row != NONE)
                    .is_none_or(|row| row as usize == begin)
            );
            let free = bodies.free_rows(begin..begin + count);
            begin += count;
            if chunk.work.is_some() {
                gathering.read((&chunk, laws), slots, free, Some(contact_works));
            } else if count > 0 {
                gathering.read_in_parts((chunk, laws), slots, free);
            }
        });
        debug_assert_eq!(begin, next_dynamic);
        self.leave_out(bodies, first_dynamic..next_dynamic);
        [next_dynamic, next_non_dynamic]
    }

    /// Lets bodies of these rows, under forces that are out of range, touch nothing: what they
    /// become they become alone.
    fn leave_out(&mut self, bodies: &SolverBodies, rows: Range<usize>) {
        if rows.clone().all(|row| bodies.is_kicked_in_range(row)) {
            return;
        }
        let Self { contacts, rows: row_of, .. } = self;
        contacts.retain(|contact| {
            let mut its_rows = contact.slots.into_iter().map(|slot| row_of[slot as usize] as usize);
            its_rows.all(|row| !rows.contains(&row) || bodies.is_kicked_in_range(row))
        });
        // Who touches nothing then is left to the integrator, as if the others were not there.
        let mut touching = vec![false; row_of.len()];
        contacts.iter().flat_map(|contact| contact.slots).for_each(|slot| touching[slot as usize] = true);
        row_of.iter_mut().zip(touching).filter(|(_, touching)| !touching).for_each(|(row, _)| *row = NONE);
    }

    /// Writes what was worked out, alone or with other worlds, over what the integrator made of the
    /// same bodies.
    pub(crate) fn write(&self, columns: &mut WorldColumns<'_>, contact_solver: &ContactSolver) {
        let SolverGroup { bodies, contact_works, .. } = &contact_solver.group;
        columns.for_each_chunk(|archetype, chunk| {
            let slots = self.body_index.slots_in(archetype).iter().skip(chunk.first_row);
            for (i, slot) in slots.enumerate().take(chunk.len()) {
                let row = self.rows[*slot as usize];
                if row != NONE {
                    let axes = chunk.axes.map(|axes| Quat::from(axes[i].0));
                    chunk.set_state(i, &bodies.state(row as usize, axes));
                }
            }
        });
        // Worlds in which accounts are kept are not packed with others.
        for (slot, work) in contact_works.close(bodies).filter(|(slot, _)| self.rows[*slot] != NONE) {
            let place = self.body_index.place(slot);
            if let Some(works) = columns.moving_mut(place).and_then(|moving| moving.work.as_mut()) {
                works[place.row as usize] = work;
            }
        }
    }
}

/// How bodies that touch something are read.
struct Gather<'a> {
    /// By slot.
    rows: &'a [u32],
    settings: &'a Settings,
    /// Time at the start of the substep \[s\].
    time: f64,
}

impl Gather<'_> {
    /// How many of these touch something.
    fn count(&self, slots: &[u32]) -> usize {
        slots.iter().filter(|slot| self.rows[**slot as usize] != NONE).count()
    }

    /// Reads those bodies of a chunk that touch something, of which the slots are given, in
    /// parallel.
    fn read_in_parts(&self, (chunk, laws): (Chunk<'_>, Laws<'_>), slots: &[u32], free: FreeRows<'_>) {
        if chunk.len() <= MIN_CHUNK {
            return self.read((&chunk, laws), slots, free, None);
        }
        let (slots, other_slots) = slots.split_at(slots.len() / 2);
        let (chunk, other_chunk) = chunk.split_at(slots.len());
        let (free, other_free) = free.split_at(self.count(slots));
        threads::join(
            || self.read_in_parts((chunk, laws), slots, free),
            || self.read_in_parts((other_chunk, laws), other_slots, other_free),
        );
    }

    fn read(
        &self,
        (chunk, laws): (&Chunk<'_>, Laws<'_>),
        slots: &[u32],
        mut free: FreeRows<'_>,
        mut contact_works: Option<&mut ContactWorks>,
    ) {
        let Self { rows, settings, time } = *self;
        let h = settings.contact_substep();
        let touching = slots.iter().enumerate().filter(|(_, slot)| rows[**slot as usize] != NONE);
        for (next, (i, &slot)) in touching.enumerate() {
            let constants: Constants<Real> = chunk.constants(i);
            let state: State<Real> = chunk.state(i);
            let wind = chunk.wind.map_or(WorldVec3::ZERO, |wind| wind[i].0);
            let context = ForceContext { wind, ..ForceContext::new(settings) };
            let (wrench, row) = (chunk.wrench[i], chunk.first_row + i);
            let forces = LawForces { constants: &constants, context: &context, wrench, laws, row, time };
            free.set(next, &constants, &state, forces.at(0.0, &state), h);
            if let (Some(work), Some(contact_works)) = (chunk.work.as_deref(), contact_works.as_deref_mut()) {
                let (booked, gravity) = ((slot as usize, rows[slot as usize]), chunk.gravity_on(i, settings));
                contact_works.open(booked, work[i], (&forces, gravity), &state, h);
            }
        }
    }
}
