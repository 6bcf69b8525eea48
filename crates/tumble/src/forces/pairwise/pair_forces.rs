//! Springs and mutual gravity of a world, applied to the momenta as impulses.

use std::fmt;

use hecs::World;

use crate::components::Work;
use crate::forces::pairwise::gravity_mass::{Gravity, GravitySource};
use crate::forces::pairwise::spring_impulse::{Impulse, Springs, Velocities};
use crate::forces::pairwise::{GravityMass, Spring};
use crate::forces::registry::{GRAVITY_MASS, SPRING};
use crate::math::{Real, Vec3, double};
use crate::range::{MAX_DISTANCE, MAX_MU, MAX_SPEED, within};
use crate::storage::body_index::BodyIndex;
use crate::storage::world_columns::WorldColumns;

/// The forces between the bodies of a world, with what their evaluation needs: kept from step to
/// step, so that a step need not allocate.
#[derive(Clone, Default)]
pub(crate) struct PairForces {
    body_index: BodyIndex,
    springs: Springs,
    gravity: Gravity,
    /// By slot: at which springs are damped.
    velocities: Vec<Velocities>,
    /// By slot: what gravity does there. Its index among the masses, if it is one.
    masses: Vec<Option<usize>>,
    attracting: Vec<(usize, GravityMass)>,
}

impl fmt::Debug for PairForces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PairForces").field("bodies", &self.body_index.len()).finish_non_exhaustive()
    }
}

impl PairForces {
    /// Lists the springs and gravity sources of a world. To be called again when anything was
    /// spawned, despawned or changed but momentum and pose.
    pub(crate) fn find(&mut self, world: &World) {
        self.body_index.find(world, |archetype, marks| {
            if let Some(springs) = archetype.get::<&Spring>() {
                let ends = springs.iter().flat_map(|spring| spring.bodies);
                ends.filter(|end| world.contains(*end)).for_each(|end| marks.mark(end.id()));
            }
            if archetype.has::<GravityMass>() {
                marks.mark_archetype();
            }
        });
        self.springs.find(world, &self.body_index);
        self.masses.clear();
        self.masses.resize(self.body_index.len(), None);
        self.attracting.clear();
        let Self { body_index, attracting, .. } = self;
        for (archetype, places) in body_index.archetypes(world) {
            if let Some(column) = archetype.get::<&GravityMass>() {
                attracting.extend(places.map(|(row, slot)| (slot.index(), column[row])));
            }
        }
        self.attracting.sort_unstable_by_key(|(slot, _)| *slot);
        for (index, (slot, _)) in self.attracting.iter().enumerate() {
            self.masses[*slot] = Some(index);
        }
    }

    /// Whether they may act on the body of an entity with this number.
    pub(crate) fn act_on(&self, entity: u32) -> bool {
        self.body_index.slot(entity).is_some()
    }

    /// Changes the momenta by what the forces, as they are now, do in the time `t` \[s\]; `h` \[s\]
    /// is the substep.
    pub(crate) fn apply(&mut self, columns: &mut WorldColumns<'_>, t: Real, h: Real) {
        self.body_index.update_views(columns);
        let views = &self.body_index.views;
        self.gravity.update(self.attracting.iter().map(|(slot, mass)| {
            let position = views[*slot].state.position;
            let softening_squared = mass.softening * mass.softening;
            if within(position, MAX_DISTANCE) && mass.mu.abs() <= MAX_MU && softening_squared.is_finite() {
                GravitySource { position: position.into(), mu: mass.mu, softening_squared }
            } else {
                // It attracts nothing.
                GravitySource { position: Vec3::ZERO, mu: 0.0, softening_squared: 1.0 }
            }
        }));
        self.velocities.clear();
        self.velocities.extend(views.iter().map(|view| Velocities::halfway(view, &Impulse::zero())));
        self.springs.prepare(&self.body_index, t, h);
        self.springs.update(&self.velocities);
        if self.springs.are_damped() {
            // Once more at the half-way velocities, which makes the kick one of second order. All
            // dampers of a net together leave between half and all of every motion.
            for slot in 0..self.body_index.len() {
                let mut impulse = self.springs.impulse(slot);
                impulse.linear = impulse.linear + self.by_gravity(slot, t).linear;
                self.velocities[slot] = Velocities::halfway(&self.body_index.views[slot], &impulse);
            }
            self.springs.update(&self.velocities);
        }
        for (slot, view) in
            self.body_index.all().zip(&self.body_index.views).filter(|(_, view)| view.constants.is_some())
        {
            let (place, slot) = (self.body_index.place(slot), slot.index());
            let (Some(moving), row) = (columns.dynamic_mut(place), place.row as usize) else { continue };
            let (by_springs, by_gravity) = (self.springs.impulse(slot), self.by_gravity(slot, t));
            let momentum = &mut moving.momentum[row];
            momentum.linear = (view.state.linear + (by_springs.linear + by_gravity.linear)).into();
            momentum.angular = (view.state.angular + by_springs.angular).into();
            if let Some(works) = &mut moving.work {
                self.book(&mut works[row], slot, &by_springs, &by_gravity);
            }
        }
    }

    fn by_gravity(&self, slot: usize, t: Real) -> Impulse {
        let mut impulse = Impulse::zero();
        let inverse_mass = self.body_index.views[slot].inverse_mass;
        if let Some(index) = self.masses[slot]
            && inverse_mass > 0.0
        {
            // Near a great mass the pull may be too great for numbers: then there is none.
            let change = self.gravity.acceleration(index) * t;
            let linear = (self.gravity.acceleration(index) * (t / inverse_mass)).into();
            if within(change.into(), MAX_SPEED) && within(linear, Real::MAX) {
                impulse.linear = linear;
            }
        }
        impulse
    }

    /// Enters the work of both, each with its share of the impulse and the mean velocity.
    fn book(&self, work: &mut Work, slot: usize, by_springs: &Impulse, by_gravity: &Impulse) {
        let view = &self.body_index.views[slot];
        let linear_change = (by_springs.linear + by_gravity.linear) * view.inverse_mass;
        let linear = double(view.derived.linear) + 0.5 * double(linear_change);
        let angular =
            double(view.derived.angular) + 0.5 * double(view.derived.apply_inverse_inertia(by_springs.angular));
        work.forces[SPRING] += double(by_springs.linear).dot(linear) + double(by_springs.angular).dot(angular);
        work.forces[GRAVITY_MASS] += double(by_gravity.linear).dot(linear);
    }
}
