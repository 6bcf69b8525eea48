//! Contact impulses that have lost what they held against. A body that a joint or a heavy one
//! pressed down would be thrown by the impulses of the last step once that is gone.

use tumble_math::lane::Vec3;

use crate::collision::contact::ContactRecord;
use crate::collision::contact_ways::length;
use crate::math::Real;
use crate::solver::constrained_bodies::ConstrainedBodies;
use crate::solver::solver_bodies::{SolverBodies, SolverRow};

/// What is held back by more than this part of what is left is not thrown: of a light body under a
/// heavy one that lands the impulses are not in balance yet.
const HELD_BACK: Real = 0.1;
/// What holds bodies on joints pushes all there are by no more than this number of impacts: where a
/// joint and a contact contradict each other, every step would add to it.
const MAX_IMPACTS: Real = 10.0;

/// What acts on a body in a substep.
#[derive(Clone, Copy)]
struct Net {
    /// Of forces and contacts \[N s\].
    impulse: Vec3<Real>,
    /// The part of its contacts that is against that \[N s\].
    held_back: Real,
}

/// Memory that is kept from step to step, by row.
#[derive(Clone, Default)]
pub(crate) struct StaleImpulses {
    is_held: Vec<bool>,
    nets: Vec<Net>,
}

impl StaleImpulses {
    /// Drops the impulses of contacts on free bodies that would get more than a speed \[m/s\] from
    /// them and from forces in a substep; then those of others that were in balance with these.
    /// Joints or springs act on `held` ones: of their contacts the impulses are bounded.
    pub(crate) fn drop(
        &mut self,
        records: &mut [ContactRecord],
        constrained: &ConstrainedBodies,
        bodies: &SolverBodies,
        held: impl Iterator<Item = SolverRow>,
        most: Real,
    ) {
        let inverse_mass =
            |row: SolverRow| if bodies.is_dynamic(row) { bodies.motion[row.index()].inverse_mass } else { 0.0 };
        let is_great = |contact: &ContactRecord| {
            let [first, second] = constrained.rows_of(contact.slots).map(inverse_mass);
            normal_load(contact) * first.max(second) > most
        };
        if !records.iter().any(is_great) {
            return;
        }
        let Self { is_held, nets } = self;
        is_held.clear();
        is_held.resize(bodies.first_non_dynamic(), false);
        held.filter(|row| bodies.is_dynamic(*row)).for_each(|row| is_held[row.index()] = true);
        // Of this world alone, in the order of its slots: others may be solved with it.
        let dynamic = constrained.rows().flatten().filter(|row| bodies.is_dynamic(*row));
        let mass = dynamic.map(|row| 1.0 / inverse_mass(row)).sum::<Real>();
        let bound = MAX_IMPACTS * most * mass;
        for contact in &mut *records {
            let is_known = |row: SolverRow| is_held.get(row.index()) == Some(&true);
            let load = normal_load(contact);
            if load > bound && constrained.rows_of(contact.slots).into_iter().any(is_known) {
                // What is infinite has no part.
                if load.is_finite() { contact.keep_of_impulses(bound / load) } else { contact.drop_impulses() }
            }
        }
        // Each round drops the impulses of a contact at least.
        loop {
            sum_up(nets, records, constrained, bodies);
            let is_thrown = |row: SolverRow| {
                let Net { impulse, held_back } = nets[row.index()];
                let size = length(impulse);
                size * inverse_mass(row) > most
                    && held_back < HELD_BACK * size
                    && !is_held[row.index()]
                    && !bodies.locked.has(row)
            };
            let mut is_any = false;
            for contact in records.iter_mut().filter(|contact| normal_load(contact) > 0.0) {
                if constrained.rows_of(contact.slots).into_iter().any(is_thrown) {
                    contact.drop_impulses();
                    is_any = true;
                }
            }
            if !is_any {
                return;
            }
        }
    }
}

/// Along the normal, as far as the next step begins with it \[N s\].
fn normal_load(contact: &ContactRecord) -> Real {
    if contact.normal_impulses.steady > 0.0 { contact.normal_impulses.at_points.iter().sum() } else { 0.0 }
}

/// Sums up by row of a body.
fn sum_up(nets: &mut Vec<Net>, records: &[ContactRecord], constrained: &ConstrainedBodies, bodies: &SolverBodies) {
    nets.clear();
    nets.resize(bodies.len(), Net { impulse: Vec3::zero(), held_back: 0.0 });
    for (net, force) in nets.iter_mut().zip(&bodies.force_impulse).take(bodies.first_non_dynamic()) {
        net.impulse = force.linear;
    }
    // Of both bodies, with what acts on each.
    let ends = |contact: &ContactRecord| {
        let load = normal_load(contact);
        let impulse = contact.geometry.normal * load + contact.friction.linear;
        let [first, second] = constrained.rows_of(contact.slots).map(SolverRow::index);
        (load > 0.0).then_some([(first, impulse * -1.0), (second, impulse)])
    };
    for (row, impulse) in records.iter().filter_map(ends).flatten() {
        nets[row].impulse = nets[row].impulse + impulse;
    }
    for (row, impulse) in records.iter().filter_map(ends).flatten() {
        let net = &mut nets[row];
        let size = length(net.impulse);
        if size > 0.0 {
            net.held_back += (-impulse.dot(net.impulse) / size).max(0.0);
        }
    }
}
