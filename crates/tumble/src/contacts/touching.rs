use std::fmt;

use hecs::World;
use rayon::prelude::*;
use tumble_collide::{Bounds, BroadPhase, Geometry, Placement, Proxy, touching};
use tumble_math::lane::{Quat, Vec3};

use super::collider::{Collider, Groups};
use super::contact::Contact;
use super::keeping::Past;
use super::materials::Materials;
use super::names::Names;
use super::narrow::{Kind, Pairs, Shapes};
use super::pushing::Pushing;
use crate::columns::for_each_archetype_in_turn;
use crate::components::{CenterOfMass, Mass, Momentum, Pose, PrincipalAxes, Velocity, Work, Wrench};
use crate::force_laws::ForceLaws;
use crate::integrators::Forces;
use crate::law_forces::LawForces;
use crate::math::{Real, Vec3 as WorldVec3};
use crate::members::Members;
use crate::settings::Settings;
use crate::state::{Constants, Force};
use crate::surroundings::Surroundings;

/// How near \[m\] two surfaces are a contact.
pub(super) const MARGIN: Real = 0.02;

/// The contacts of a world: what they were at the end of the last step is where the next begins.
#[derive(Clone, Default)]
pub(crate) struct Contacts {
    pub(super) members: Members,
    /// Who the slots of the last step's contacts stood for.
    pub(super) names: Names,
    pub(super) past: Past,
    /// By slot.
    pub(super) colliders: Vec<Option<(Collider, WorldVec3)>>,
    groups: Vec<Groups>,
    pub(super) shapes: Vec<Shape>,
    /// By slot: its row among the solver's bodies, if it touches anything.
    rows: Vec<u32>,
    pub(super) broad_phase: BroadPhase<Real>,
    proxies: Vec<Proxy<Real>>,
    lanes: Shapes,
    /// The pairs of each kind.
    cuboids: Pairs,
    balls: Pairs,
    others: Vec<[u32; 2]>,
    /// Contacts of the last, in parts that threads find.
    found: Vec<Vec<Contact>>,
    materials: Materials,
    /// In the order of their keys.
    pub(super) contacts: Vec<Contact>,
    pub(super) last: Vec<Contact>,
    /// What pushes them where they are not pushed together with those of other worlds.
    pushing: Option<Box<Pushing>>,
}

/// Where a body with a collider is at the start of a step.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    placement: Placement<Real>,
    /// Centre of mass \[m\].
    center: Vec3<Real>,
    kind: Kind,
    /// Whether impulses move it.
    moves: bool,
    /// How far from its surface another's may be to be a contact, with the other's reach added \[m\].
    reach: Real,
    /// Of what impulses do not move \[m/s\] \[rad/s\].
    velocity: (Vec3<Real>, Vec3<Real>),
}

/// So many contacts go on from those there were on one thread at a time.
const PART: usize = 512;
/// And so many pairs of shapes that have no lanes of their own are looked at.
const OTHERS_PART: usize = 16;

/// No row.
const NONE: u32 = u32::MAX;

impl fmt::Debug for Contacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Contacts").field("contacts", &self.contacts.len()).finish_non_exhaustive()
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
        self.colliders.clear();
        self.colliders.resize(self.members.len(), None);
        let Self { members, colliders, .. } = self;
        members.for_each_archetype(world, |archetype, places| {
            if let Some(column) = archetype.get::<&Collider>() {
                let offsets = archetype.get::<&CenterOfMass>();
                let offset = |row: usize| offsets.as_deref().map_or(WorldVec3::ZERO, |offsets| offsets[row].0);
                places.for_each(|(row, slot)| colliders[slot] = Some((column[row].clone(), offset(row))));
            }
        });
        self.materials
            .list(self.colliders.iter().map(|collider| collider.as_ref().map(|(collider, _)| collider.material())));
        let of = |collider: &Option<(Collider, _)>| collider.as_ref().map_or(Groups::ALL, |(it, _)| it.filter_groups());
        if !self.colliders.iter().map(of).eq(self.groups.iter().copied()) {
            // Who touches whom is asked once.
            self.broad_phase.reset();
            self.groups.clear();
            self.groups.extend(self.colliders.iter().map(of));
        }
        self.renumber(world);
    }

    /// Works out where what touches something will be after one substep of the settings, starting from the world as it is.
    pub(crate) fn solve(&mut self, world: &World, settings: &Settings, laws: &ForceLaws, time: f64) {
        let touching = self.find_touching(world, settings);
        let mut pushing = self.pushing.take().unwrap_or_default();
        pushing.reset(touching);
        let first = [0, pushing.bodies.first_unmoved()];
        self.gather(world, settings, laws, time, &mut pushing, first);
        let Self { contacts, rows, materials, .. } = self;
        pushing.push(contacts, |contact| rows_of(contact, rows), settings, materials.extras());
        self.pushing = Some(pushing);
    }

    /// Finds what touches in a substep of the settings, and how many bodies that is: of those that impulses move and of those that they do not.
    pub(crate) fn find_touching(&mut self, world: &World, settings: &Settings) -> [usize; 2] {
        self.look(world, settings.substep());
        self.find_contacts();
        let Self { members, shapes, rows, contacts, .. } = self;
        rows.clear();
        rows.resize(members.len(), NONE);
        for slot in contacts.iter().flat_map(|contact| contact.slots) {
            rows[slot as usize] = 0;
        }
        let touching = || (0..shapes.len()).filter(|slot| rows[*slot] != NONE);
        let moved = touching().filter(|slot| shapes[*slot].moves).count();
        [moved, touching().count() - moved]
    }

    /// The rows of a contact's bodies.
    pub(super) fn rows_of(&self, contact: &Contact) -> [u32; 2] {
        rows_of(contact, &self.rows)
    }

    /// Writes what was worked out, alone or with other worlds, over what the integrator made of the same bodies.
    pub(crate) fn write(&self, world: &World, with_others: Option<&Pushing>) {
        let Some(Pushing { bodies, bookings, .. }) = with_others.or(self.pushing.as_deref()) else { return };
        // Accounts were opened in the order of places too.
        let mut accounts = bookings.close(bodies).peekable();
        self.members.for_each_archetype(world, |archetype, places| {
            let (Some(mut poses), Some(mut momenta)) = (archetype.get::<&mut Pose>(), archetype.get::<&mut Momentum>())
            else {
                return;
            };
            let axes = archetype.get::<&PrincipalAxes>();
            let mut works = archetype.get::<&mut Work>();
            for (row, slot) in places.filter(|(_, slot)| self.rows[*slot] != NONE && self.shapes[*slot].moves) {
                let axes = axes.as_deref().map(|axes| Quat::from(axes[row].0));
                let state = bodies.state(self.rows[slot] as usize, axes);
                poses[row] = Pose { position: state.position.into(), orientation: state.orientation.into() };
                momenta[row] = Momentum { linear: state.linear.into(), angular: state.angular.into() };
                if let (Some(works), Some((_, work))) = (&mut works, accounts.next_if(|(booked, _)| *booked == slot)) {
                    works[row] = work;
                }
            }
        });
    }

    /// Reads where all bodies with colliders are, and how far from there they may go in an interval \[s\].
    fn look(&mut self, world: &World, interval: Real) {
        let Self { members, shapes, colliders, lanes, .. } = self;
        lanes.reset(members.len());
        shapes.clear();
        shapes.resize(members.len(), Shape::NOWHERE);
        members.for_each_archetype(world, |archetype, places| {
            let Some(poses) = archetype.get::<&Pose>() else { return };
            let pushed = archetype.get::<&Momentum>().zip(archetype.get::<&Mass>());
            let pushed = pushed.filter(|_| archetype.has::<Wrench>());
            let velocities = archetype.get::<&Velocity>();
            for (row, slot) in places {
                let center = Vec3::from(poses[row].position);
                let orientation = Quat::from(poses[row].orientation).normalize();
                let Some((collider, offset)) = &colliders[slot] else { continue };
                let position = center - orientation.rotate(Vec3::from(*offset));
                let mut placement = collider.placement(Placement { position, orientation });
                let velocity = velocities.as_deref().map_or(Velocity::default(), |velocities| velocities[row]);
                let (linear, angular) = match &pushed {
                    Some((momenta, masses)) => (momenta[row].linear / masses[row].kilograms(), momenta[row].angular),
                    None => (velocity.linear, velocity.angular),
                };
                if !(linear.is_finite() && angular.is_finite()) {
                    // It is nowhere then, and touches nothing that it could spoil.
                    placement.position = Vec3::splat(Real::NAN);
                }
                let reach = reach(&collider.geometry, linear.length() * interval);
                lanes.set(slot, &collider.geometry, &placement, center, reach);
                let (kind, moves) = (Kind::of(&collider.geometry), pushed.is_some());
                let velocity = (velocity.linear.into(), velocity.angular.into());
                shapes[slot] = Shape { placement, center, kind, moves, reach, velocity };
            }
        });
    }

    /// Reads the bodies that touch something, and the forces on them as they are now, into rows from these on: of what impulses move, and of what they do not. Returns the rows after them.
    pub(super) fn gather(
        &mut self,
        world: &World,
        settings: &Settings,
        laws: &ForceLaws,
        time: f64,
        pushing: &mut Pushing,
        [mut next_moved, mut next_unmoved]: [usize; 2],
    ) -> [usize; 2] {
        let Self { members, shapes, rows, .. } = self;
        let (Pushing { bodies, bookings, .. }, h) = (pushing, settings.contact_substep());
        for (slot, shape) in shapes.iter().enumerate() {
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
        for_each_archetype_in_turn(world, laws, |entities, chunk| {
            for (row, entity) in entities.iter().enumerate() {
                let Some(slot) = members.slot(*entity).filter(|slot| rows[*slot] != NONE) else { continue };
                let constants: Constants<Real> = chunk.constants(row);
                let state = chunk.state(row);
                let wind = chunk.wind.map_or(WorldVec3::ZERO, |wind| wind[row].0);
                let surroundings = Surroundings { wind, ..Surroundings::new(settings) };
                let (wrench, laws) = (chunk.wrench[row], chunk.laws);
                let forces = LawForces { constants: &constants, surroundings: &surroundings, wrench, laws, row, time };
                let force: Force<Real> = forces.at(0.0, &state);
                bodies.set_free(rows[slot] as usize, &constants, &state, force, h);
                if let Some(work) = chunk.work.as_deref() {
                    let gravity = chunk.gravity_on(row, settings);
                    bookings.open((slot, rows[slot]), work[row], (&forces, gravity), &state, h);
                }
            }
        });
        [next_moved, next_unmoved]
    }

    /// The contacts there are, beginning with the impulses of those that there were.
    fn find_contacts(&mut self) {
        self.find_near();
        self.keep_the_past();
        std::mem::swap(&mut self.contacts, &mut self.last);
        let Self { shapes, lanes, cuboids, balls, others, found, contacts, colliders, .. } = self;
        contacts.clear();
        cuboids.touch(Kind::Cuboid, lanes, contacts);
        balls.touch(Kind::Ball, lanes, contacts);
        let parts = others.len().div_ceil(OTHERS_PART);
        found.resize_with(parts.max(found.len()), Vec::new);
        others.par_chunks(OTHERS_PART).zip(&mut *found).for_each(|(pairs, found)| {
            found.clear();
            pairs.iter().for_each(|slots| touch_one(*slots, shapes, colliders, found));
        });
        found[..parts].iter().for_each(|found| contacts.extend_from_slice(found));
        contacts.retain(|contact| contact.count() > 0);
        let Self { contacts, last, materials, .. } = self;
        contacts.par_chunks_mut(PART).for_each(|contacts| go_on(contacts, last, materials));
        // The next step's list takes the place of the last one's: so it allocates nothing. Exactly as much, for with some more both would outgrow each other without end.
        self.last.reserve_exact(self.contacts.capacity().saturating_sub(self.last.len()));
    }

    /// Finds the pairs that may touch, and sorts them by the kind of their shapes. Where impulses move only one of two, it is the second.
    fn find_near(&mut self) {
        let Self { shapes, proxies, colliders, groups, broad_phase, cuboids, balls, others, .. } = self;
        proxies.clear();
        proxies.extend(shapes.iter().zip(&*colliders).map(|(shape, collider)| shape.proxy(collider.as_ref())));
        cuboids.clear();
        balls.clear();
        others.clear();
        for &(first, second) in broad_phase.update(proxies, |a, b| groups[a as usize].touch(groups[b as usize])) {
            // Which others are found depends on what was before; the contacts must not.
            let [p, q] = [&proxies[first as usize], &proxies[second as usize]];
            if !p.is_near(q) {
                continue;
            }
            let slots = if p.moves && !q.moves { [second, first] } else { [first, second] };
            match Kind::both(shapes[first as usize].kind, shapes[second as usize].kind) {
                Kind::Cuboid => cuboids.push(slots),
                Kind::Ball => balls.push(slots),
                Kind::Other => others.push(slots),
            }
        }
    }
}

fn rows_of(contact: &Contact, rows: &[u32]) -> [u32; 2] {
    contact.slots.map(|slot| rows[slot as usize])
}

/// Adds the contacts of shapes that have no lanes of their own.
fn touch_one(slots: [u32; 2], shapes: &[Shape], colliders: &[Option<(Collider, WorldVec3)>], found: &mut Vec<Contact>) {
    let [first, second] = slots.map(|slot| &shapes[slot as usize]);
    if let [Some((a, _)), Some((b, _))] = slots.map(|slot| colliders[slot as usize].as_ref()) {
        let before = found.len();
        let (margin, center) = (first.reach + second.reach, second.center);
        touching(&a.geometry, &first.placement, &b.geometry, &second.placement, margin, &mut |part, manifold| {
            found.push(Contact::new(slots, part, manifold, center));
        });
        found[before..].sort_by_key(Contact::key);
    }
}

/// Begins contacts with the impulses of those there were, both in the order of their keys.
fn go_on(contacts: &mut [Contact], last: &[Contact], materials: &Materials) {
    let Some(first) = contacts.first().map(Contact::key) else { return };
    let mut last = last[last.partition_point(|old| old.key() < first)..].iter().peekable();
    for contact in contacts {
        while last.next_if(|old| old.key() < contact.key()).is_some() {}
        if let Some(old) = last.next_if(|old| old.key() == contact.key()) {
            contact.take_over(old);
        }
        contact.set_surface(&materials.between(contact.slots));
    }
}

/// How far from its surface a shape looks for others \[m\] that goes so far \[m\] in a step. What goes less than half its thickness is stopped in what it hits and leaves it on the side it came
/// from; only what is faster looks further, since a surface is taken for endless on the way to it.
fn reach(geometry: &Geometry<Real>, way: Real) -> Real {
    let enough = 0.5 * geometry.half_thickness();
    0.5 * MARGIN + if way > enough && way.is_finite() { way - enough } else { 0.0 }
}

impl Shape {
    /// What the broad phase is to know of it. What has no collider is nowhere.
    fn proxy(&self, collider: Option<&(Collider, WorldVec3)>) -> Proxy<Real> {
        let nowhere = Some(Bounds::about(Vec3::splat(Real::NAN), Vec3::zero()));
        let bounds = collider.map_or(nowhere, |(collider, _)| collider.geometry.bounds(&self.placement, self.reach));
        Proxy { bounds, moves: self.moves }
    }

    /// Known by its centre of mass alone.
    pub(super) fn at_center([x, y, z]: [Real; 3]) -> Self {
        Self { center: Vec3::new(x, y, z), ..Self::NOWHERE }
    }

    pub(super) fn center(&self) -> [Real; 3] {
        [self.center.x, self.center.y, self.center.z]
    }

    const NOWHERE: Self = {
        let zero = Vec3 { x: 0.0, y: 0.0, z: 0.0 };
        let orientation = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
        Self {
            placement: Placement { position: zero, orientation },
            center: zero,
            kind: Kind::Other,
            moves: false,
            reach: 0.0,
            velocity: (zero, zero),
        }
    };
}
