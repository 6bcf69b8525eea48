//! Between the columns of a world and what contacts are found and solved with.

use tumble_collide::{Geometry, Placement, Proxy};
use tumble_math::lane::{Quat, Vec3};

use super::booking::Bookings;
use super::collider::Collider;
use super::narrow::{Kind, ShapesPart};
use super::pushing::Pushing;
use super::solver_bodies::FreeRows;
use super::touching::{Contacts, MARGIN, NONE, Shape};
use crate::columns::{Chunk, LEAST_CHUNK};
use crate::components::Velocity;
use crate::force_laws::ForceLaws;
use crate::held::{Held, Looked};
use crate::integrators::Forces;
use crate::law_forces::LawForces;
use crate::math::{Real, Vec3 as WorldVec3};
use crate::settings::Settings;
use crate::state::{Constants, State};
use crate::surroundings::Surroundings;

impl Contacts {
    /// Reads where all bodies with colliders are, and how far from there they may go in an interval \[s\].
    pub(super) fn look(&mut self, held: &Held<'_>, interval: Real) {
        let Self { members, shapes, colliders, lanes, proxies, .. } = self;
        lanes.reset(members.len());
        shapes.clear();
        shapes.resize(members.len(), Shape::NOWHERE);
        proxies.clear();
        proxies.resize(members.len(), Shape::NOWHERE.proxy(None));
        for (archetype, bodies) in held.looked() {
            let mut row = 0;
            // Slots go by another order than rows, mostly the same.
            for run in members.slots_in(archetype).chunk_by(|a, b| *b == a + 1) {
                let slots = run[0] as usize..run[0] as usize + run.len();
                let sight = Sight {
                    colliders: &colliders[slots.clone()],
                    shapes: &mut shapes[slots.clone()],
                    proxies: &mut proxies[slots.clone()],
                    lanes: lanes.part(slots),
                };
                sight.look_in_parts(bodies.rows(row..row + run.len()), interval);
                row += run.len();
            }
        }
    }

    /// Reads the bodies that touch something, and the forces on them as they are now, into rows from these on: of what impulses move, and of what they do not. Returns the rows after them.
    pub(super) fn gather(
        &mut self,
        held: &mut Held<'_>,
        (settings, laws, time): (&Settings, &ForceLaws, f64),
        pushing: &mut Pushing,
        [mut next_moved, mut next_unmoved]: [usize; 2],
    ) -> [usize; 2] {
        let Self { members, shapes, rows, .. } = self;
        let (Pushing { bodies, bookings, .. }, mut begin) = (pushing, next_moved);
        for slot in members.in_order_of_places() {
            let shape = &shapes[slot];
            if rows[slot] == NONE {
                continue;
            }
            let next = if shape.moves { &mut next_moved } else { &mut next_unmoved };
            rows[slot] = *next as u32;
            if !shape.moves {
                bodies.set_unmoved(*next, shape.center, shape.velocity.0, shape.velocity.1);
            }
            *next += 1;
        }
        let gathering = Gathering { rows, settings, time };
        held.for_each_archetype(laws, |archetype, chunk| {
            let slots = members.slots_in(archetype);
            let count = gathering.count(slots);
            let free = bodies.free_rows(begin..begin + count);
            begin += count;
            if chunk.work.is_some() {
                gathering.read(&chunk, slots, free, Some(bookings));
            } else if count > 0 {
                gathering.read_in_parts(chunk, slots, free);
            }
        });
        [next_moved, next_unmoved]
    }

    /// Writes what was worked out, alone or with other worlds, over what the integrator made of the same bodies.
    pub(crate) fn write(&self, held: &mut Held<'_>, laws: &ForceLaws, with_others: Option<&Pushing>) {
        let Some(Pushing { bodies, bookings, .. }) = with_others.or(self.pushing.as_deref()) else { return };
        held.for_each_chunk(laws, |archetype, chunk| {
            let slots = self.members.slots_in(archetype).iter().skip(chunk.first_row);
            for (i, slot) in slots.enumerate().take(chunk.len()) {
                let row = self.rows[*slot as usize];
                if row != NONE {
                    let axes = chunk.axes.map(|axes| Quat::from(axes[i].0));
                    chunk.set_state(i, &bodies.state(row as usize, axes));
                }
            }
        });
        // Worlds in which accounts are kept are not packed with others.
        for (slot, work) in bookings.close(bodies) {
            let place = self.members.place(slot);
            if let Some(works) = held.moving_mut(place).and_then(|columns| columns.work.as_mut()) {
                works[place.row as usize] = work;
            }
        }
    }
}

/// Neighbouring slots, for what is seen of their bodies.
struct Sight<'a> {
    colliders: &'a [Option<(Collider, WorldVec3)>],
    shapes: &'a mut [Shape],
    proxies: &'a mut [Proxy<Real>],
    lanes: ShapesPart<'a>,
}

impl Sight<'_> {
    /// Looks at bodies in parallel.
    fn look_in_parts(mut self, bodies: Looked<'_>, interval: Real) {
        let middle = self.shapes.len() / 2;
        if self.shapes.len() <= LEAST_CHUNK {
            return (0..self.shapes.len()).for_each(|i| self.look(i, bodies, interval));
        }
        let (colliders, other_colliders) = self.colliders.split_at(middle);
        let (shapes, other_shapes) = self.shapes.split_at_mut(middle);
        let (proxies, other_proxies) = self.proxies.split_at_mut(middle);
        let (lanes, other_lanes) = self.lanes.split_at(middle);
        let others =
            Sight { colliders: other_colliders, shapes: other_shapes, proxies: other_proxies, lanes: other_lanes };
        let these = Sight { colliders, shapes, proxies, lanes };
        rayon::join(
            || these.look_in_parts(bodies.rows(0..middle), interval),
            || others.look_in_parts(bodies.rows(middle..bodies.pose.len()), interval),
        );
    }

    fn look(&mut self, i: usize, bodies: Looked<'_>, interval: Real) {
        let Some((collider, offset)) = &self.colliders[i] else { return };
        let center = Vec3::from(bodies.pose[i].position);
        let orientation = Quat::from(bodies.pose[i].orientation).normalize();
        let position = center - orientation.rotate(Vec3::from(*offset));
        let mut placement = collider.placement(Placement { position, orientation });
        let velocity = bodies.velocity.map_or(Velocity::default(), |velocities| velocities[i]);
        let (linear, angular) = match bodies.pushed {
            Some((momenta, masses)) => (momenta[i].linear / masses[i].kilograms(), momenta[i].angular),
            None => (velocity.linear, velocity.angular),
        };
        if !(linear.is_finite() && angular.is_finite()) {
            // It is nowhere then, and touches nothing that it could spoil.
            placement.position = Vec3::splat(Real::NAN);
        }
        let geometry = &collider.geometry;
        let reach = reach(geometry, linear.length() * interval);
        self.lanes.set(i, geometry, &placement, center, reach);
        let (kind, moves) = (Kind::of(geometry), bodies.pushed.is_some());
        let velocity = (velocity.linear.into(), velocity.angular.into());
        self.shapes[i] = Shape { placement, center, kind, moves, reach, velocity };
        self.proxies[i] = self.shapes[i].proxy(Some(geometry));
    }
}

/// How bodies that touch something are read.
struct Gathering<'a> {
    /// By slot.
    rows: &'a [u32],
    settings: &'a Settings,
    /// Time at the start of the substep \[s\].
    time: f64,
}

impl Gathering<'_> {
    /// How many of these touch something.
    fn count(&self, slots: &[u32]) -> usize {
        slots.iter().filter(|slot| self.rows[**slot as usize] != NONE).count()
    }

    /// Reads those bodies of a chunk that touch something, of which the slots are given, in parallel.
    fn read_in_parts(&self, chunk: Chunk<'_>, slots: &[u32], free: FreeRows<'_>) {
        if chunk.len() <= LEAST_CHUNK {
            return self.read(&chunk, slots, free, None);
        }
        let (slots, other_slots) = slots.split_at(slots.len() / 2);
        let (chunk, other_chunk) = chunk.split_at(slots.len());
        let (free, other_free) = free.split_at(self.count(slots));
        rayon::join(
            || self.read_in_parts(chunk, slots, free),
            || self.read_in_parts(other_chunk, other_slots, other_free),
        );
    }

    fn read(&self, chunk: &Chunk<'_>, slots: &[u32], mut free: FreeRows<'_>, mut bookings: Option<&mut Bookings>) {
        let Self { rows, settings, time } = *self;
        let h = settings.contact_substep();
        let touching = slots.iter().enumerate().filter(|(_, slot)| rows[**slot as usize] != NONE);
        for (next, (i, &slot)) in touching.enumerate() {
            let constants: Constants<Real> = chunk.constants(i);
            let state: State<Real> = chunk.state(i);
            let wind = chunk.wind.map_or(WorldVec3::ZERO, |wind| wind[i].0);
            let surroundings = Surroundings { wind, ..Surroundings::new(settings) };
            let (wrench, laws, row) = (chunk.wrench[i], chunk.laws, chunk.first_row + i);
            let forces = LawForces { constants: &constants, surroundings: &surroundings, wrench, laws, row, time };
            free.set(next, &constants, &state, forces.at(0.0, &state), h);
            if let (Some(work), Some(bookings)) = (chunk.work.as_deref(), bookings.as_deref_mut()) {
                let (booked, gravity) = ((slot as usize, rows[slot as usize]), chunk.gravity_on(i, settings));
                bookings.open(booked, work[i], (&forces, gravity), &state, h);
            }
        }
    }
}

/// How far from its surface a shape looks for others \[m\] that goes so far \[m\] in a step. What goes less than half its thickness is stopped in what it hits and leaves it on the side it came
/// from; only what is faster looks further, since a surface is taken for endless on the way to it.
fn reach(geometry: &Geometry<Real>, way: Real) -> Real {
    let enough = 0.5 * geometry.half_thickness();
    0.5 * MARGIN + if way > enough && way.is_finite() { way - enough } else { 0.0 }
}
