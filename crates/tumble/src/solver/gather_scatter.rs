//! Between the columns of a world and the solver's bodies.

use std::ops::Range;

use tumble_math::lane::{Quat, Vec3};

use crate::collision::contact_set::ContactSet;
use crate::collision::traveller::state_of;
use crate::components::{Momentum, Velocity};
use crate::forces::evaluate::LawForces;
use crate::forces::force_context::ForceContext;
use crate::forces::pairwise::PairForces;
use crate::forces::registry::{ForceLaws, Laws};
use crate::integrators::Forces;
use crate::integrators::kinetic_energy::KineticEnergy;
use crate::integrators::state::{Constants, State};
use crate::joints::axis_lock::LockedSlot;
use crate::joints::joint_list::JointList;
use crate::math::{Real, Vec3 as WorldVec3};
use crate::range::{MAX_DISTANCE_OF_CONTACTS, MAX_SPEED, within};
use crate::settings::Settings;
use crate::solver::constrained_bodies::ConstrainedBodies;
use crate::solver::contact_work::ContactWorks;
use crate::solver::gather_tiles::{are_kicked_in_range, gather_tiles, is_in_range};
use crate::solver::mechanism::mechanisms::Mechanisms;
use crate::solver::solver_bodies::{DynamicRows, SolverBodies, SolverRow};
use crate::storage::body_index::{BodyIndex, Slot};
use crate::storage::chunk::{Chunk, MIN_CHUNK};
use crate::storage::world_columns::{ArchetypeBodies, WorldColumns};
use crate::threads;

/// What the forces on the bodies of a world depend on: settings, laws, and the time at the start of
/// the substep \[s\].
pub(crate) type ForceInputs<'a> = (&'a Settings, &'a ForceLaws, f64);

/// The constraints of a world, and the bodies that they act on.
pub(crate) struct Constraints<'a> {
    pub(crate) bodies: &'a mut ConstrainedBodies,
    pub(crate) contacts: &'a mut ContactSet,
    pub(crate) mechanisms: &'a mut Mechanisms,
    /// Springs and gravity between bodies.
    pub(crate) pairs: Option<&'a PairForces>,
}

/// Reads the constrained bodies, and the forces on them as they are now, into rows from these on:
/// dynamic ones, and others. Returns the rows after them.
///
/// Contacts of bodies under forces out of range are dropped, and those bodies are no longer
/// constrained.
pub(crate) fn gather(
    Constraints { bodies: constrained, contacts, mechanisms, .. }: &mut Constraints<'_>,
    body_index: &BodyIndex,
    columns: &mut WorldColumns<'_>,
    (settings, laws, time): ForceInputs<'_>,
    (bodies, contact_works): (&mut SolverBodies, &mut ContactWorks),
    [first_dynamic, first_non_dynamic]: [usize; 2],
) -> [usize; 2] {
    let next_dynamic = give_rows(constrained, body_index, columns, first_dynamic);
    let next_non_dynamic = gather_non_dynamic(constrained, body_index, columns, bodies, first_non_dynamic);
    let mut begin = first_dynamic;
    let gathering = Gather { constrained, settings, time };
    laws.for_each_archetype_of(columns, |archetype, chunk, laws| {
        let slots = body_index.slots_in(archetype);
        let count = gathering.count(slots);
        debug_assert!(
            slots.is_empty() || slots.len() == chunk.len(),
            "all bodies of an archetype have a slot, or none"
        );
        let dynamic = bodies.dynamic_rows(begin..begin + count);
        begin += count;
        if chunk.work.is_some() {
            gathering.read((&chunk, laws), slots, dynamic, Some(contact_works));
        } else if count > 0 {
            gathering.read_in_parts((chunk, laws), slots, dynamic);
        }
    });
    debug_assert_eq!(begin, next_dynamic);
    bodies.lock(constrained.locks());
    drop_out_of_range((constrained, contacts, &mechanisms.list), bodies, first_dynamic..next_dynamic);
    [next_dynamic, next_non_dynamic]
}

/// Gives rows to the dynamic bodies, in the order of their places. Returns the row after them.
fn give_rows(
    constrained: &mut ConstrainedBodies,
    body_index: &BodyIndex,
    columns: &WorldColumns<'_>,
    mut next: usize,
) -> usize {
    for (archetype, _) in columns.kinds().filter(|(_, is_dynamic)| *is_dynamic) {
        for slot in body_index.slots_in(archetype) {
            if constrained.awake_row(*slot).is_some() {
                constrained.set_row(*slot, SolverRow(next as u32));
                next += 1;
            }
        }
    }
    next
}

/// Gives rows to the bodies that are not dynamic or sleep, and reads them. Returns the row after
/// them.
fn gather_non_dynamic(
    constrained: &mut ConstrainedBodies,
    body_index: &BodyIndex,
    columns: &WorldColumns<'_>,
    bodies: &mut SolverBodies,
    mut next: usize,
) -> usize {
    let are_any_asleep = !constrained.sleepers.is_empty();
    for (archetype, is_dynamic) in columns.kinds().filter(|(_, is_dynamic)| are_any_asleep || !*is_dynamic) {
        for slot in body_index.slots_in(archetype) {
            if constrained.contains(*slot) && (!is_dynamic || constrained.sleepers.has(*slot)) {
                let place = body_index.place(*slot);
                let row = place.row as usize;
                let (pose, velocity) = match columns.bodies(place) {
                    ArchetypeBodies::Dynamic(columns) => (columns.pose[row], Velocity::default()),
                    ArchetypeBodies::NonDynamic(columns) => (columns.pose[row], columns.velocity(row)),
                    ArchetypeBodies::None => continue,
                };
                let [center, linear, angular] = [pose.position, velocity.linear, velocity.angular].map(Vec3::from);
                let in_range = within(linear, MAX_SPEED) && within(angular, MAX_SPEED);
                if in_range && within(center, MAX_DISTANCE_OF_CONTACTS) {
                    bodies.set_non_dynamic(next, (center, pose.orientation.into()), [linear, angular]);
                }
                constrained.set_row(*slot, SolverRow(next as u32));
                next += 1;
            }
        }
    }
    next
}

/// Drops the contacts of bodies of these rows whose forces are out of range: what becomes of those
/// is the integrator's.
fn drop_out_of_range(
    (constrained, contacts, joints): (&mut ConstrainedBodies, &mut ContactSet, &JointList),
    bodies: &SolverBodies,
    rows: Range<usize>,
) {
    if are_kicked_in_range(bodies, rows.clone()) {
        return;
    }
    let is_in_range = |slots: &[Slot; 2]| {
        let mut its_rows = slots.iter().map(|slot| constrained.row(*slot).map(SolverRow::index));
        its_rows.all(|row| row.is_some_and(|row| !rows.contains(&row) || bodies.is_kicked_in_range(row)))
    };
    contacts.retain(|contact| is_in_range(&contact.slots));
    let pairs: Vec<_> = joints.pairs().filter(is_in_range).collect();
    let locked: Vec<_> = constrained.locked.iter().map(|it| [it.slot; 2]).filter(is_in_range).collect();
    let pairs = contacts.records.iter().map(|contact| contact.slots).chain(pairs).chain(locked);
    constrained.retain(pairs, |row| bodies.is_dynamic(row));
}

/// Writes the constrained bodies back to their columns, with the work done on them.
pub(crate) fn scatter(
    constrained: &ConstrainedBodies,
    body_index: &BodyIndex,
    columns: &mut WorldColumns<'_>,
    (bodies, contact_works): (&SolverBodies, &ContactWorks),
) {
    columns.for_each_chunk(|archetype, chunk| {
        let slots = body_index.slots_in(archetype).iter().skip(chunk.first_row);
        for (i, slot) in slots.enumerate().take(chunk.len()) {
            let Some(row) = constrained.awake_row(*slot) else { continue };
            let axes = chunk.axes.map(|axes| Quat::from(axes[i].0));
            chunk.set_state(i, &bodies.state(row.index(), axes));
        }
    });
    // Worlds in which accounts are kept are not packed with others.
    for (slot, work) in contact_works.close(bodies).filter(|(slot, _)| constrained.contains(*slot)) {
        let place = body_index.place(slot);
        if let Some(works) = columns.dynamic_mut(place).and_then(|moving| moving.work.as_mut()) {
            works[place.row as usize] += work;
        }
    }
}

/// Takes from the momenta of bodies with locked axes what they cannot have.
pub(crate) fn hold_locked(constrained: &ConstrainedBodies, body_index: &BodyIndex, columns: &mut WorldColumns<'_>) {
    for LockedSlot { slot, lock, .. } in &constrained.locked {
        let place = body_index.place(*slot);
        let row = place.row as usize;
        let Some((constants, state)) = state_of(columns, place) else { continue };
        let held = lock.held(&constants, &state);
        let Some(moving) = columns.dynamic_mut(place) else { continue };
        moving.momentum[row] = Momentum { linear: held.linear.into(), angular: held.angular.into() };
        if let Some(works) = moving.work.as_mut() {
            let energy = |state| KineticEnergy::of(&constants, state).sum();
            works[row].contacts += energy(&held) - energy(&state);
        }
    }
}

/// How constrained bodies are read.
struct Gather<'a> {
    constrained: &'a ConstrainedBodies,
    settings: &'a Settings,
    /// Time at the start of the substep \[s\].
    time: f64,
}

impl Gather<'_> {
    /// How many of these are constrained.
    fn count(&self, slots: &[Slot]) -> usize {
        slots.iter().filter(|slot| self.constrained.awake_row(**slot).is_some()).count()
    }

    /// Reads the constrained bodies of a chunk, of which the slots are given, in parallel.
    fn read_in_parts(&self, (chunk, laws): (Chunk<'_>, Laws<'_>), slots: &[Slot], dynamic: DynamicRows<'_>) {
        if chunk.len() <= MIN_CHUNK {
            return self.read((&chunk, laws), slots, dynamic, None);
        }
        let (slots, other_slots) = slots.split_at(slots.len() / 2);
        let (chunk, other_chunk) = chunk.split_at(slots.len());
        let (dynamic, other_dynamic) = dynamic.split_at(self.count(slots));
        threads::join(
            || self.read_in_parts((chunk, laws), slots, dynamic),
            || self.read_in_parts((other_chunk, laws), other_slots, other_dynamic),
        );
    }

    fn read(
        &self,
        (chunk, laws): (&Chunk<'_>, Laws<'_>),
        slots: &[Slot],
        mut dynamic: DynamicRows<'_>,
        mut contact_works: Option<&mut ContactWorks>,
    ) {
        let Self { constrained, settings, time } = *self;
        let h = settings.contact_substep();
        if laws.is_empty() && contact_works.is_none() {
            let is_read = |slot: &Slot| constrained.awake_row(*slot).is_some();
            return gather_tiles(chunk, slots.iter().map(is_read), dynamic, h);
        }
        let rows = slots.iter().enumerate().filter_map(|(i, slot)| Some((i, *slot, constrained.awake_row(*slot)?)));
        for (next, (i, slot, solver_row)) in rows.enumerate() {
            let constants: Constants<Real> = chunk.constants(i);
            let state: State<Real> = chunk.state(i);
            let wind = chunk.wind.map_or(WorldVec3::ZERO, |wind| wind[i].0);
            let context = ForceContext { wind, ..ForceContext::new(settings) };
            let (wrench, row) = (chunk.wrench[i], chunk.first_row + i);
            let forces = LawForces { constants: &constants, context: &context, wrench, laws, row, time };
            dynamic.set(next, &constants, &state, forces.at(0.0, &state), h);
            if !is_in_range(&constants, &state) {
                dynamic.set_out_of_range(next);
            }
            if let Some(contact_works) = contact_works.as_deref_mut() {
                contact_works.open((slot, solver_row), (&forces, chunk.gravity_on(i, settings.gravity)), &state, h);
            }
        }
    }
}
