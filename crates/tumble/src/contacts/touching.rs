use std::fmt;

use hecs::World;
use tumble_collide::{Bounds, BroadPhase, Manifold, Placement, Proxy, collide};
use tumble_math::lane::Vec3;

use super::body::SolverBody;
use super::collider::Collider;
use super::constraint::{Constraint, Pass};
use super::kept::Kept;
use super::material::Surface;
use super::soft::Softness;
use crate::columns::for_each_archetype_in_turn;
use crate::components::{CenterOfMass, Momentum, Pose};
use crate::force_laws::ForceLaws;
use crate::integrators::Forces;
use crate::law_forces::LawForces;
use crate::math::{Real, Vec3 as WorldVec3};
use crate::members::{Key, Members, Seen};
use crate::settings::Settings;
use crate::state::{Constants, Force};
use crate::surroundings::Surroundings;

/// How near \[m\] two surfaces are a contact.
const MARGIN: Real = 0.02;

/// The contacts of a world: what they were at the end of the last step is where the next begins.
#[derive(Clone, Default)]
pub(crate) struct Contacts {
    members: Members,
    colliders: Vec<Option<(Collider, WorldVec3)>>,
    bodies: Vec<SolverBody>,
    touched: Vec<bool>,
    /// The slots of those that touch something.
    active: Vec<usize>,
    broad_phase: BroadPhase<Real>,
    proxies: Vec<Proxy<Real>>,
    /// In the order of their keys.
    kept: Vec<Kept>,
}

impl fmt::Debug for Contacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Contacts").field("kept", &self.kept.len()).finish_non_exhaustive()
    }
}

impl Contacts {
    /// Finds out what has a collider. To be called again when anything was spawned, despawned or changed but momentum and pose.
    pub(crate) fn find(&mut self, world: &World) {
        self.members.find(world, |archetype, mark| {
            if archetype.has::<Collider>() {
                archetype.ids().iter().for_each(|id| mark(*id));
            }
        });
        self.broad_phase.reset();
        self.colliders.clear();
        self.colliders.resize(self.members.len(), None);
        let Self { members, colliders, .. } = self;
        members.for_each_archetype(world, |archetype, places| {
            if let Some(column) = archetype.get::<&Collider>() {
                let offsets = archetype.get::<&CenterOfMass>();
                let offset = |row: usize| offsets.as_deref().map_or(WorldVec3::ZERO, |offsets| offsets[row].0);
                places.for_each(|(row, slot)| colliders[slot] = Some((column[row], offset(row))));
            }
        });
    }

    /// Works out where what touches something will be after one substep of the settings, starting from the world as it is.
    pub(crate) fn solve(&mut self, world: &World, settings: &Settings, laws: &ForceLaws, time: f64) {
        let interval = settings.substep();
        let substeps = settings.contact_substeps.div_ceil(settings.substeps).max(1);
        let h = interval / substeps as Real;
        self.gather(world, settings, laws, (time, h));
        let mut contacts = self.touching(h);
        self.keep_impulses(&mut contacts);
        for _ in 0..substeps {
            self.active.iter().for_each(|slot| self.bodies[*slot].kick());
            contacts.iter().for_each(|contact| contact.warm_start(pair(&mut self.bodies, contact.slots)));
            contacts.iter_mut().for_each(|contact| contact.note_approach(contact.slots.map(|slot| &self.bodies[slot])));
            for contact in &mut contacts {
                contact.solve(pair(&mut self.bodies, contact.slots), Pass::Biased, h);
            }
            self.active.iter().for_each(|slot| self.bodies[*slot].drift(h));
            contacts.iter_mut().for_each(|contact| contact.follow(contact.slots.map(|slot| &self.bodies[slot])));
            for contact in &mut contacts {
                contact.solve(pair(&mut self.bodies, contact.slots), Pass::Relaxing, h);
            }
        }
        for contact in &mut contacts {
            contact.bounce(pair(&mut self.bodies, contact.slots), settings.restitution_threshold);
        }
        let members = &self.members;
        self.kept.clear();
        self.kept.extend(contacts.iter().map(|contact| Kept::of(contact.slots.map(|slot| members.key(slot)), contact)));
        self.kept.sort_unstable_by_key(|kept| kept.keys);
    }

    /// Writes what was worked out over what the integrator made of the same bodies.
    pub(crate) fn write(&self, world: &World) {
        self.members.for_each_archetype(world, |archetype, places| {
            let (Some(mut poses), Some(mut momenta)) = (archetype.get::<&mut Pose>(), archetype.get::<&mut Momentum>())
            else {
                return;
            };
            for (row, slot) in places.filter(|(_, slot)| self.touched[*slot] && self.bodies[*slot].free.is_some()) {
                let state = &self.bodies[slot].state;
                poses[row] = Pose { position: state.position.into(), orientation: state.orientation.into() };
                momenta[row] = Momentum { linear: state.linear.into(), angular: state.angular.into() };
            }
        });
    }

    /// Reads all bodies with colliders, and the forces on them as they are now.
    fn gather(&mut self, world: &World, settings: &Settings, laws: &ForceLaws, (time, h): (f64, Real)) {
        self.members.gather(world);
        self.bodies.clear();
        self.bodies.extend(self.members.seen.iter().map(|seen: &Seen| SolverBody::unmoved(seen.state, seen.derived)));
        let Self { members, bodies, .. } = self;
        for_each_archetype_in_turn(world, laws, |entities, chunk| {
            for (row, entity) in entities.iter().enumerate() {
                let Some(slot) = members.slot(*entity) else { continue };
                let constants: Constants<Real> = chunk.constants(row);
                let state = chunk.state(row);
                let wind = chunk.wind.map_or(WorldVec3::ZERO, |wind| wind[row].0);
                let surroundings = Surroundings { wind, ..Surroundings::new(settings) };
                let (wrench, laws) = (chunk.wrench[row], chunk.laws);
                let forces = LawForces { constants: &constants, surroundings: &surroundings, wrench, laws, row, time };
                let force: Force<Real> = forces.at(0.0, &state);
                bodies[slot] = SolverBody::moved(&constants, state, force, h);
            }
        });
    }

    fn placement(&self, slot: usize) -> Option<(&Collider, Placement<Real>)> {
        let (collider, center_of_mass) = self.colliders[slot].as_ref()?;
        let state = &self.bodies[slot].state;
        let position = state.position - state.orientation.rotate(Vec3::from(*center_of_mass));
        Some((collider, Placement { position, orientation: state.orientation }))
    }

    /// What the broad phase is to know of a slot. One without a collider is nowhere.
    fn proxy(&self, slot: usize) -> Proxy<Real> {
        let nowhere = Some(Bounds::about(Vec3::splat(Real::NAN), Vec3::zero()));
        let bounds = self.placement(slot).map_or(nowhere, |(collider, at)| collider.geometry.bounds(&at, 0.5 * MARGIN));
        Proxy { bounds, moves: self.bodies[slot].free.is_some() }
    }

    /// The contacts there are: those between moving bodies first, then those with what does not move, which has the last word.
    fn touching(&mut self, h: Real) -> Vec<Constraint> {
        let mut broad_phase = std::mem::take(&mut self.broad_phase);
        let mut proxies = std::mem::take(&mut self.proxies);
        proxies.clear();
        proxies.extend((0..self.members.len()).map(|slot| self.proxy(slot)));
        // Which others are found depends on what was before; the contacts must not.
        let near = broad_phase.update(&proxies, |_, _| true).iter().map(|(a, b)| [*a as usize, *b as usize]);
        let near = near.filter(|[a, b]| proxies[*a].is_near(&proxies[*b]));

        self.touched.clear();
        self.touched.resize(self.members.len(), false);
        let (mut moving, mut grounded) = (Vec::new(), Vec::new());
        let (soft, stiff) = (Softness::between_moving(h.into()), Softness::on_ground(h.into()));
        for slots in near {
            let Some((surface, manifold)) = self.manifold(slots) else { continue };
            let bodies = slots.map(|slot| &self.bodies[slot]);
            let both = bodies.iter().all(|body| body.free.is_some());
            let softness = if both { soft } else { stiff };
            let contact = Constraint::new(slots, bodies, &manifold, &surface, (MARGIN, softness));
            slots.into_iter().for_each(|slot| self.touched[slot] = true);
            if both { moving.push(contact) } else { grounded.push(contact) }
        }
        (self.broad_phase, self.proxies) = (broad_phase, proxies);
        self.active.clear();
        self.active.extend((0..self.touched.len()).filter(|slot| self.touched[*slot]));
        moving.append(&mut grounded);
        moving
    }

    fn manifold(&self, [first, second]: [usize; 2]) -> Option<(Surface, Manifold<Real>)> {
        let ((a, a_at), (b, b_at)) = (self.placement(first)?, self.placement(second)?);
        let manifold = collide(&a.geometry, &a_at, &b.geometry, &b_at, MARGIN);
        (!manifold.points().is_empty()).then(|| (Surface::between(a.material(), b.material()), manifold))
    }

    /// Begins with the impulses of the last step.
    fn keep_impulses(&self, contacts: &mut [Constraint]) {
        for contact in contacts {
            let keys: [Key; 2] = contact.slots.map(|slot| self.members.key(slot));
            if let Ok(index) = self.kept.binary_search_by_key(&keys, |kept| kept.keys) {
                self.kept[index].hand_over(contact);
            }
        }
    }
}

/// Two bodies of a list.
fn pair(bodies: &mut [SolverBody], [first, second]: [usize; 2]) -> [&mut SolverBody; 2] {
    // The lower slot is the first, always.
    let (before, after) = bodies.split_at_mut(second);
    [&mut before[first], &mut after[0]]
}
