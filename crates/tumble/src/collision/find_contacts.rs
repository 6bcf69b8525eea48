//! Contact detection of a step: broad phase, narrow phase, and matching with the previous contacts.

use std::fmt;

use hecs::World;
use rayon::prelude::*;
use tumble_collide::{Aabb, BroadPhase, ColliderShape, Isometry, Proxy, contact_manifolds};
use tumble_math::lane::{Quat, Vec3};

use crate::collision::body_key::BodyKeys;
use crate::collision::collider::{Collider, Groups};
use crate::collision::contact::{ContactRecord, FIXED, MATERIAL, REFINED, Second};
use crate::collision::contact_cache::PreviousContacts;
use crate::collision::contact_materials::Materials;
use crate::collision::internal_edges::InternalEdges;
use crate::collision::narrow_phase::{LaneKind, Pairs, ShapeLanes};
use crate::collision::pair_limit::{PairLimit, most_listed, near_pair};
use crate::collision::speculative::Way;
use crate::components::CenterOfMass;
use crate::math::{Real, Vec3 as WorldVec3};
use crate::settings::Settings;
use crate::storage::body_index::BodyIndex;
use crate::storage::world_columns::WorldColumns;
use crate::threads::InParts;

/// The contacts of a world: what they were at the end of the last step is where the next begins.
#[derive(Clone, Default)]
pub(crate) struct Contacts {
    pub(crate) body_index: BodyIndex,
    /// Who the slots of the last step's contacts stood for.
    pub(crate) body_keys: BodyKeys,
    pub(crate) previous: PreviousContacts,
    /// By slot.
    pub(crate) colliders: Vec<Option<(Collider, WorldVec3)>>,
    pub(crate) groups: Vec<Groups>,
    pub(crate) shapes: Vec<ColliderState>,
    /// By slot: its row among the solver's bodies, if it touches anything.
    pub(crate) rows: Vec<u32>,
    pub(crate) broad_phase: BroadPhase<Real>,
    pub(crate) proxies: Vec<Proxy<Real>>,
    pub(crate) lanes: ShapeLanes,
    /// The pairs that are near each other, in parts that threads find; then those of each kind.
    pub(crate) near: Vec<Vec<(LaneKind, [u32; 2])>>,
    pub(crate) pair_limit: PairLimit,
    cuboids: Pairs,
    spheres: Pairs,
    others: Vec<[u32; 2]>,
    /// Contacts of the last, in parts that threads find.
    found: Vec<Vec<ContactRecord>>,
    pub(crate) materials: Materials,
    /// In the order of their keys.
    pub(crate) contacts: Vec<ContactRecord>,
    /// By contact.
    pub(crate) ways: Vec<Way>,
    pub(crate) internal_edges: InternalEdges,
    pub(crate) last: Vec<ContactRecord>,
}

/// Where a body with a collider is at the start of a step.
#[derive(Clone, Copy)]
pub(crate) struct ColliderState {
    pub(crate) placement: Isometry<Real>,
    /// Centre of mass \[m\].
    pub(crate) center: Vec3<Real>,
    pub(crate) kind: LaneKind,
    /// Whether impulses move it.
    pub(crate) moves: bool,
    /// How far from its surface another's may be to be a contact, with the other's reach added
    /// \[m\].
    pub(crate) reach: Real,
    /// The same but for how fast it goes \[m\]; zero of what impulses do not move.
    pub(crate) margin: Real,
    /// Of what impulses do not move \[m/s\] \[rad/s\].
    pub(crate) velocity: (Vec3<Real>, Vec3<Real>),
    pub(crate) motion: Motion,
}

/// How a body with a collider goes on if nothing holds it, through a step and one more substep: so
/// far contacts look ahead.
#[derive(Clone, Copy)]
pub(crate) struct Motion {
    /// How far its centre of mass goes \[m\].
    pub(crate) way: Vec3<Real>,
    /// By which angle it turns, about this direction \[rad\]; zero of what hardly does.
    pub(crate) turn: Vec3<Real>,
    /// How far from its centre of mass its collider reaches \[m\].
    pub(crate) radius: Real,
}

impl Motion {
    pub(crate) const NONE: Self = {
        let zero = Vec3 { x: 0.0, y: 0.0, z: 0.0 };
        Self { way: zero, turn: zero, radius: 0.0 }
    };
}

/// Contacts that one thread takes at a time.
pub(crate) const PART: usize = 512;
/// Pairs that may be near each other that one thread takes at a time.
const CANDIDATES_PART: usize = 1024;
/// Pairs of shapes without lanes of their own that one thread takes at a time.
const OTHERS_PART: usize = 16;

/// No row.
pub(crate) const NONE: u32 = u32::MAX;

impl fmt::Debug for Contacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Contacts").field("contacts", &self.contacts.len()).finish_non_exhaustive()
    }
}

impl Contacts {
    /// Finds out what has a collider. To be called again when anything was spawned, despawned or
    /// changed but momentum and pose.
    pub(crate) fn find(&mut self, world: &World) {
        self.body_index.find(world, |archetype, mark| {
            if archetype.has::<Collider>() {
                archetype.ids().iter().for_each(|id| mark(*id));
            }
        });
        self.colliders.clear();
        self.colliders.resize(self.body_index.len(), None);
        let Self { body_index, colliders, .. } = self;
        body_index.for_each_archetype(world, |archetype, places| {
            if let Some(column) = archetype.get::<&Collider>() {
                let offsets = archetype.get::<&CenterOfMass>();
                let offset = |row: usize| offsets.as_deref().map_or(WorldVec3::ZERO, |offsets| offsets[row].0);
                places.for_each(|(row, slot)| colliders[slot] = Some((column[row].clone(), offset(row))));
            }
        });
        self.materials.list(self.colliders.iter().map(|collider| collider.as_ref().map(|(collider, _)| collider)));
        let of = |collider: &Option<(Collider, _)>| collider.as_ref().map_or(Groups::ALL, |(it, _)| it.filter_groups());
        if !self.colliders.iter().map(of).eq(self.groups.iter().copied()) {
            // Who touches whom is asked once.
            self.broad_phase.reset();
            self.groups.clear();
            self.groups.extend(self.colliders.iter().map(of));
        }
        self.renumber(world);
    }

    /// Finds the contacts in a substep of the settings, and how many bodies they have: of those
    /// that impulses move and of those that they do not.
    pub(crate) fn find_touching(&mut self, columns: &WorldColumns<'_>, settings: &Settings) -> [usize; 2] {
        // After the last substep contacts see to it that in one more nothing would come too near.
        let ahead = settings.substep() + settings.contact_substep();
        self.update_aabbs(columns, [settings.substep(), ahead]);
        self.find_contacts(settings.gravity.length() * ahead * ahead);
        let Self { body_index, shapes, rows, contacts, .. } = self;
        rows.clear();
        rows.resize(body_index.len(), NONE);
        for slot in contacts.iter().flat_map(|contact| contact.slots) {
            rows[slot as usize] = 0;
        }
        let touching = || (0..shapes.len()).filter(|slot| rows[*slot] != NONE);
        let dynamic = touching().filter(|slot| shapes[*slot].moves).count();
        [dynamic, touching().count() - dynamic]
    }

    /// How many contacts there were after the last step, and how many pairs of shapes without lanes
    /// of their own.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.contacts.len(), self.others.len())
    }

    /// The rows of a contact's bodies.
    pub(crate) fn rows_of(&self, contact: &ContactRecord) -> [u32; 2] {
        rows_of(contact, &self.rows)
    }

    /// The contacts there are, beginning with the impulses of those that there were.
    /// Gravity has what is let go fall by `fall` \[m\].
    fn find_contacts(&mut self, fall: Real) {
        self.find_near();
        self.keep_previous();
        std::mem::swap(&mut self.contacts, &mut self.last);
        let Self { shapes, lanes, cuboids, spheres, others, found, contacts, colliders, .. } = self;
        let (end, some_empty) = cuboids.touch(LaneKind::Cuboid, lanes, contacts, 0);
        let (end, more_empty) = spheres.touch(LaneKind::Sphere, lanes, contacts, end);
        contacts.truncate(end);
        let parts = others.len().div_ceil(OTHERS_PART);
        found.resize_with(parts.max(found.len()), Vec::new);
        others.par_chunks(OTHERS_PART).zip(&mut *found).by_at_least(2).for_each(|(pairs, found)| {
            found.clear();
            pairs.iter().for_each(|slots| collide_pair(*slots, shapes, colliders, found));
        });
        found[..parts].iter().for_each(|found| contacts.extend_from_slice(found));
        if some_empty || more_empty || contacts[end..].iter().any(|contact| contact.count() == 0) {
            contacts.retain(|contact| contact.count() > 0);
        }
        self.limit_speculative(fall);
        self.leave_out_internal_edges();
        let Self { contacts, last, materials, .. } = self;
        contacts.par_chunks_mut(PART).by_at_least(2).for_each(|contacts| match_impulses(contacts, last, materials));
        // The next step's list takes the place of the last one's: so it allocates nothing. Exactly
        // as much, for with some more both would outgrow each other forever.
        self.last.reserve_exact(self.contacts.capacity().saturating_sub(self.last.len()));
    }

    /// Finds the pairs that may touch, and sorts them by the kind of their shapes. Where impulses
    /// move only one of two, it is the second.
    fn find_near(&mut self) {
        let Self { shapes, proxies, groups, broad_phase, near, .. } = self;
        let wanted = |a: u32, b: u32| groups[a as usize].touch(groups[b as usize]);
        let mut parts = 1;
        if let Some(candidates) = broad_phase.update_within(proxies, most_listed(proxies.len()), wanted) {
            parts = candidates.len().div_ceil(CANDIDATES_PART);
            near.resize_with(parts.max(near.len()), Vec::new);
            candidates.par_chunks(CANDIDATES_PART).zip(&mut *near).by_at_least(2).for_each(|(candidates, near)| {
                near.clear();
                near.extend(candidates.iter().filter_map(|&(first, second)| {
                    // Which others are candidates depends on what was before; the contacts must
                    // not.
                    let is_near = proxies[first as usize].is_near(&proxies[second as usize]);
                    is_near.then(|| near_pair(shapes, proxies, (first, second)))
                }));
            });
            self.limit_near(parts);
        } else {
            self.find_near_limited();
        }
        let Self { near, cuboids, spheres, others, .. } = self;
        cuboids.clear();
        spheres.clear();
        others.clear();
        for &(kind, slots) in near[..parts].iter().flatten() {
            match kind {
                LaneKind::Cuboid => cuboids.push(slots),
                LaneKind::Sphere => spheres.push(slots),
                LaneKind::Other => others.push(slots),
            }
        }
    }
}

pub(crate) fn rows_of(contact: &ContactRecord, rows: &[u32]) -> [u32; 2] {
    contact.slots.map(|slot| rows[slot as usize])
}

/// Adds the contacts of shapes that have no lanes of their own.
fn collide_pair(
    slots: [u32; 2],
    shapes: &[ColliderState],
    colliders: &[Option<(Collider, WorldVec3)>],
    found: &mut Vec<ContactRecord>,
) {
    let [first, second] = slots.map(|slot| &shapes[slot as usize]);
    if let [Some((a, _)), Some((b, _))] = slots.map(|slot| colliders[slot as usize].as_ref()) {
        let before = found.len();
        let margin = first.reach + second.reach;
        let of_second = Second { center: second.center, alone: !first.moves, margin: first.margin + second.margin };
        let rolls = law([first, second], [&a.geometry, &b.geometry]);
        contact_manifolds(
            &a.geometry,
            &first.placement,
            &b.geometry,
            &second.placement,
            margin,
            &mut |part, manifold| {
                if a.parts_touch(b, part) {
                    // What lies on three points does not roll.
                    let law = if manifold.points().len() < 3 { rolls } else { MATERIAL };
                    found.push(ContactRecord::new(slots, part, manifold, of_second, law));
                }
            },
        );
        found[before..].sort_by_key(ContactRecord::key);
    }
}

/// How the geometry of a contact follows its bodies.
fn law(shapes: [&ColliderState; 2], shapes_of_pair: [&ColliderShape<Real>; 2]) -> f64 {
    if !shapes_of_pair.iter().any(|geometry| geometry.is_round()) {
        return MATERIAL;
    }
    let is_centered = |which: usize| {
        let apart = shapes[which].placement.position - shapes[which].center;
        matches!(shapes_of_pair[which], ColliderShape::Sphere { .. }) && apart.dot(apart) == 0.0
    };
    let is_flat_ground = |which: usize| {
        let [u, v, w] = [shapes[which].velocity.1.x, shapes[which].velocity.1.y, shapes[which].velocity.1.z];
        let flat = matches!(
            shapes_of_pair[which],
            ColliderShape::HalfSpace | ColliderShape::Mesh(_) | ColliderShape::HeightField(_)
        );
        flat && !shapes[which].moves && [u, v, w] == [0.0; 3]
    };
    if (is_centered(0) && is_flat_ground(1)) || (is_centered(1) && is_flat_ground(0)) { FIXED } else { REFINED }
}

/// Begins contacts with the impulses of those there were, both in the order of their keys.
fn match_impulses(contacts: &mut [ContactRecord], last: &[ContactRecord], materials: &Materials) {
    let Some(first) = contacts.first().map(ContactRecord::key) else { return };
    let mut last = last[last.partition_point(|old| old.key() < first)..].iter().peekable();
    for contact in contacts {
        while last.next_if(|old| old.key() < contact.key()).is_some() {}
        if let Some(old) = last.next_if(|old| old.key() == contact.key()) {
            contact.take_impulses_of(old);
        }
        contact.set_surface(&materials.between(contact.slots, contact.part));
    }
}

impl ColliderState {
    /// What the broad phase is to know of it. What has no geometry is nowhere.
    pub(crate) fn proxy(&self, geometry: Option<&ColliderShape<Real>>) -> Proxy<Real> {
        let nowhere = Some(Aabb::about(Vec3::splat(Real::NAN), Vec3::zero()));
        let aabb = geometry.map_or(nowhere, |geometry| geometry.aabb(&self.placement, self.reach));
        Proxy { aabb, moves: self.moves }
    }

    /// Known by its centre of mass alone.
    pub(crate) fn at_center([x, y, z]: [Real; 3]) -> Self {
        Self { center: Vec3::new(x, y, z), ..Self::NOWHERE }
    }

    pub(crate) fn center(&self) -> [Real; 3] {
        [self.center.x, self.center.y, self.center.z]
    }

    pub(crate) const NOWHERE: Self = {
        let zero = Vec3 { x: 0.0, y: 0.0, z: 0.0 };
        let orientation = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
        Self {
            placement: Isometry { position: zero, orientation },
            center: zero,
            kind: LaneKind::Other,
            moves: false,
            reach: 0.0,
            margin: 0.0,
            velocity: (zero, zero),
            motion: Motion::NONE,
        }
    };
}
