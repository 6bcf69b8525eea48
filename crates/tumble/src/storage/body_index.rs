//! Bodies that act on each other, by forces or contacts, gathered from their archetypes.

use std::ops::Range;

use hecs::{Archetype, World};

use crate::components::{BodyId, Pose, Velocity};
use crate::integrators::derived::{Derived, derived};
use crate::integrators::response_range::responds_in_range;
use crate::integrators::state::{Constants, Moments, State};
use crate::math::Real;
use crate::range::{MAX_DISTANCE, MAX_SPEED, within};
use crate::storage::world_columns::{ArchetypeBodies, WorldColumns};

/// The number of a body among those of a [`BodyIndex`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub(crate) struct Slot(pub(crate) u32);

impl Slot {
    /// No slot.
    pub(crate) const NONE: Self = Self(u32::MAX);

    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// What was kept by slot, by the slots that bodies have now: `slots` are these by slot before, and
/// `none` is what a body has of which nothing is known.
pub(crate) fn by_new_slot<T: Clone>(before: Vec<T>, slots: &[Slot], count: usize, none: T) -> Vec<T> {
    let mut now = vec![none; count];
    for (it, slot) in before.into_iter().zip(slots).filter(|(_, slot)| **slot != Slot::NONE) {
        now[slot.index()] = it;
    }
    now
}

/// The sort key of bodies: those without a [`BodyId`] come last, by the number of their entity.
pub(crate) type Key = (bool, Option<BodyId>, u32);

/// Where a body's components are.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct BodyPlace {
    key: Key,
    place: RowPlace,
}

/// An archetype of a world, by its index, and a row of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct RowPlace {
    pub(crate) archetype: u32,
    pub(crate) row: u32,
}

/// A body as forces between bodies see it.
#[derive(Clone, Copy)]
pub(crate) struct BodyView {
    pub(crate) state: State<Real>,
    /// Zero for non-dynamic bodies.
    pub(crate) inverse_mass: Real,
    /// Of a dynamic body.
    pub(crate) constants: Option<Constants<Real>>,
    pub(crate) derived: Derived<Real>,
}

/// The bodies concerned, each with a slot, in the order of their [`BodyId`]s.
#[derive(Clone, Default)]
pub(crate) struct BodyIndex {
    members: Vec<BodyPlace>,
    marks: Marks,
    /// By entity number.
    slots: Vec<Slot>,
    /// The slots in the order of places.
    by_place: Vec<Slot>,
    /// In the order of places: the numbers of entities, and their ids.
    entities: Vec<u32>,
    ids: Vec<Option<BodyId>>,
    /// By archetype, where its slots begin in that order; those of the last end with all.
    begins: Vec<u32>,
    /// How often bodies were listed: as long as it stays, they are the same in the same places.
    listing: u64,
    pub(crate) views: Vec<BodyView>,
}

/// The entities among which bodies are found.
#[derive(Clone, Default)]
pub(crate) struct Marks {
    /// By number.
    entities: Vec<bool>,
    /// By the index of an archetype, whether all of its entities are marked.
    archetypes: Vec<bool>,
}

impl Marks {
    /// Marks an entity by its number.
    pub(crate) fn mark(&mut self, entity: u32) {
        let entity = entity as usize;
        if self.entities.len() <= entity {
            self.entities.resize(entity + 1, false);
        }
        self.entities[entity] = true;
    }

    /// Marks all entities of the archetype that is shown.
    pub(crate) fn mark_archetype(&mut self) {
        if let Some(last) = self.archetypes.last_mut() {
            *last = true;
        }
    }

    fn has(&self, entity: u32) -> bool {
        self.entities.get(entity as usize).is_some_and(|mark| *mark)
    }

    fn has_all_of(&self, archetype: usize) -> bool {
        self.archetypes.get(archetype).is_some_and(|mark| *mark)
    }
}

impl BodyIndex {
    /// Finds the bodies among the entities that are marked when each archetype of the world is
    /// shown.
    pub(crate) fn find(&mut self, world: &World, marked: impl Fn(&Archetype, &mut Marks)) {
        let mut marks = std::mem::take(&mut self.marks);
        marks.entities.clear();
        marks.archetypes.clear();
        for archetype in world.archetypes() {
            marks.archetypes.push(false);
            if !archetype.is_empty() {
                marked(archetype, &mut marks);
            }
        }
        // From step to step they are mostly the same, and need not be sorted again.
        if !self.is_known(world, &marks) {
            self.list(archetypes_of_bodies(world).flat_map(|it| found(it, &marks)));
            self.listing += 1;
        }
        self.marks = marks;
    }

    /// The number of the list of bodies.
    pub(crate) fn listing(&self) -> u64 {
        self.listing
    }

    /// Whether the bodies among marked entities are those that were listed, in the same places.
    fn is_known(&self, world: &World, marks: &Marks) -> bool {
        let mut count = 0;
        for (index, archetype) in archetypes_of_bodies(world) {
            let part = self.part(index);
            count += part.len();
            let is_same = if marks.has_all_of(index) {
                let ids = archetype.get::<&BodyId>();
                let id = |row: usize| ids.as_deref().map(|ids| ids[row]);
                archetype.ids() == &self.entities[part.clone()] && are_equal(&self.ids[part], id)
            } else {
                let known = self.by_place[part].iter().map(|slot| self.members[slot.index()]);
                known.eq(found((index, archetype), marks))
            };
            if !is_same {
                return false;
            }
        }
        count == self.by_place.len()
    }

    /// Gives slots to bodies, which come in the order of their places.
    fn list(&mut self, found: impl Iterator<Item = BodyPlace>) {
        let Self { members, slots, by_place, entities, ids, begins, .. } = self;
        members.clear();
        members.extend(found);
        if !members.is_sorted() {
            members.sort_unstable();
        }
        slots.clear();
        by_place.clear();
        for (slot, member) in members.iter().enumerate() {
            let entity = member.key.2 as usize;
            if slots.len() <= entity {
                slots.resize(entity + 1, Slot::NONE);
            }
            slots[entity] = Slot(slot as u32);
            by_place.push(Slot(slot as u32));
        }
        let place = |slot: &Slot| members[slot.index()].place;
        if !by_place.is_sorted_by_key(place) {
            by_place.sort_unstable_by_key(place);
        }
        entities.clear();
        entities.extend(by_place.iter().map(|slot| members[slot.index()].key.2));
        ids.clear();
        ids.extend(by_place.iter().map(|slot| members[slot.index()].key.1));
        begins.clear();
        for (place, slot) in by_place.iter().enumerate() {
            let archetype = members[slot.index()].place.archetype as usize;
            begins.resize(begins.len().max(archetype + 1), place as u32);
        }
    }

    /// The slot of an entity, if it is a body that was found.
    pub(crate) fn slot(&self, id: u32) -> Option<Slot> {
        self.slots.get(id as usize).copied().filter(|slot| *slot != Slot::NONE)
    }

    /// The sort key of a slot.
    pub(crate) fn key(&self, slot: Slot) -> Key {
        self.members[slot.index()].key
    }

    /// Where the components of a slot's body are.
    pub(crate) fn place(&self, slot: Slot) -> RowPlace {
        self.members[slot.index()].place
    }

    /// All slots, in order.
    pub(crate) fn all(&self) -> impl Iterator<Item = Slot> + use<> {
        (0..self.members.len() as u32).map(Slot)
    }

    /// The slots of the bodies in an archetype, by its index, in the order of rows: those of all
    /// its rows where archetypes are marked as a whole.
    pub(crate) fn slots_in(&self, archetype: usize) -> &[Slot] {
        &self.by_place[self.part(archetype)]
    }

    /// The bodies in an archetype, in the order of places.
    fn part(&self, archetype: usize) -> Range<usize> {
        let begin = |archetype| self.begins.get(archetype).map_or(self.by_place.len(), |begin| *begin as usize);
        begin(archetype)..begin(archetype + 1)
    }

    pub(crate) fn len(&self) -> usize {
        self.members.len()
    }

    /// The archetypes with members, and the row and slot of each of them there.
    pub(crate) fn archetypes<'a>(
        &'a self,
        world: &'a World,
    ) -> impl Iterator<Item = (&'a Archetype, impl Iterator<Item = (usize, Slot)> + 'a)> {
        world.archetypes().enumerate().filter_map(move |(index, archetype)| {
            let slots = self.slots_in(index);
            let has_all = slots.len() == archetype.len() as usize;
            let row = move |(place, slot): (usize, &Slot)| {
                (if has_all { place } else { self.place(*slot).row as usize }, *slot)
            };
            (!slots.is_empty()).then(|| (archetype, slots.iter().enumerate().map(row)))
        })
    }

    /// Reads the state of all.
    pub(crate) fn update_views(&mut self, columns: &WorldColumns<'_>) {
        let Self { members, views, .. } = self;
        views.clear();
        views
            .extend(members.iter().map(|member| BodyView::of(columns.bodies(member.place), member.place.row as usize)));
    }
}

/// Archetypes of bodies, with their indices.
fn archetypes_of_bodies(world: &World) -> impl Iterator<Item = (usize, &Archetype)> {
    world.archetypes().enumerate().filter(|(_, archetype)| archetype.has::<Pose>())
}

/// Compares all without a branch between them, for they are mostly equal.
fn are_equal(known: &[Option<BodyId>], now: impl Fn(usize) -> Option<BodyId>) -> bool {
    known.iter().enumerate().fold(true, |are_equal, (row, known)| are_equal & (*known == now(row)))
}

/// The bodies among the marked entities of an archetype, in the order of rows.
fn found<'a>((index, archetype): (usize, &'a Archetype), marks: &'a Marks) -> impl Iterator<Item = BodyPlace> + 'a {
    let ids = archetype.get::<&BodyId>();
    archetype.ids().iter().enumerate().filter_map(move |(row, &entity)| {
        let id = ids.as_deref().map(|ids| ids[row]);
        let place = RowPlace { archetype: index as u32, row: row as u32 };
        let is_marked = marks.has_all_of(index) || marks.has(entity);
        is_marked.then_some(BodyPlace { key: (id.is_none(), id, entity), place })
    })
}

impl BodyView {
    /// In the place of one that is not there.
    const NOWHERE: Self = {
        let zero = tumble_math::lane::Vec3 { x: 0.0, y: 0.0, z: 0.0 };
        let orientation = tumble_math::lane::Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
        Self {
            state: State { position: zero, orientation, linear: zero, angular: zero },
            inverse_mass: 0.0,
            constants: None,
            derived: Derived { linear: zero, angular: zero, diagonal: zero, off_diagonal: zero },
        }
    };

    /// Whether others can be pulled by it, or pull it.
    pub(crate) fn is_in_range(&self) -> bool {
        let State { position, orientation, linear, angular } = self.state;
        let turned = (0.5..2.0).contains(&orientation.length_squared());
        let moves = match &self.constants {
            Some(constants) => responds_in_range(constants, [linear, angular], 0.0),
            None => within(self.derived.linear, MAX_SPEED) && within(self.derived.angular, MAX_SPEED),
        };
        turned && moves && within(position, MAX_DISTANCE)
    }

    /// A body in a row.
    fn of(bodies: &ArchetypeBodies<'_>, row: usize) -> Self {
        let columns = match bodies {
            ArchetypeBodies::Dynamic(columns) => columns,
            ArchetypeBodies::NonDynamic(columns) => {
                return Self::non_dynamic(columns.pose[row], columns.velocity(row));
            }
            ArchetypeBodies::None => return Self::NOWHERE,
        };
        let axes = columns.axes.as_deref().map(|column| column[row]);
        let inertia = columns.inertia.as_deref().map(|column| Moments::new(&column[row], axes.as_ref()));
        let constants = Constants { mass: columns.mass[row].kilograms(), inertia, damping: None };
        let state = State::new(&columns.pose[row], &columns.momentum[row]);
        let upright = State { orientation: state.orientation.normalize(), ..state };
        Self {
            state: upright,
            inverse_mass: 1.0 / constants.mass,
            constants: Some(constants),
            derived: derived(&constants, &upright),
        }
    }

    /// A fixed or kinematic body.
    fn non_dynamic(pose: Pose, velocity: Velocity) -> Self {
        let mut view = Self::NOWHERE;
        view.state.position = pose.position.into();
        view.state.orientation = tumble_math::lane::Quat::from(pose.orientation).normalize();
        view.derived.linear = velocity.linear.into();
        view.derived.angular = velocity.angular.into();
        view
    }
}

#[cfg(test)]
mod tests {
    use hecs::Entity;

    use super::*;
    use crate::batch::rng::Rng;

    /// Entities with this component are found, with all others of their archetypes.
    struct Whole;

    /// It marks this entity.
    struct Mark(Entity);

    fn find(index: &mut BodyIndex, world: &World) {
        index.find(world, |archetype, marks| {
            if archetype.has::<Whole>() {
                marks.mark_archetype();
            }
            for Mark(entity) in archetype.get::<&Mark>().iter().flat_map(|column| column.iter()) {
                marks.mark(entity.id());
            }
        });
    }

    /// What is known from the last time gives what is found from nothing.
    #[test]
    fn an_index_that_is_kept_is_one_that_is_made() {
        let mut rng = Rng::new(7);
        let mut draw = |below: usize| rng.next_u64() as usize % below.max(1);
        let (mut worlds, mut kept) = ([World::new(), World::new()], BodyIndex::default());
        let mut all: [Vec<Entity>; 2] = [Vec::new(), Vec::new()];
        let mut known = 0;
        for _ in 0..4000 {
            let which = usize::from(draw(10) == 0);
            let (world, all) = (&mut worlds[which], &mut all[which]);
            let any = all.get(draw(all.len())).copied();
            let id = BodyId(draw(20) as u64);
            match (draw(12), any) {
                (0 | 1, _) if all.len() < 30 => all.push(world.spawn((Pose::default(), Whole, id))),
                (2, _) if all.len() < 30 => all.push(world.spawn((Pose::default(), id))),
                (3, _) if all.len() < 30 => all.push(world.spawn((Pose::default(), Whole))),
                (4, Some(any)) => world.insert_one(any, id).unwrap(),
                (5, Some(any)) => drop(world.remove_one::<BodyId>(any)),
                (6, Some(any)) => all.push(world.spawn((Mark(any),))),
                (7, Some(any)) => {
                    world.despawn(any).unwrap();
                    all.retain(|entity| *entity != any);
                }
                (8, Some(any)) => drop(world.remove_one::<Whole>(any)),
                _ => {}
            }
            let mut made = BodyIndex::default();
            find(&mut made, world);
            let before: Vec<_> = kept.all().map(|slot| (kept.key(slot), kept.place(slot))).collect();
            let listing = kept.listing();
            find(&mut kept, world);
            let is_same = kept.listing() == listing;
            let now: Vec<_> = kept.all().map(|slot| (kept.key(slot), kept.place(slot))).collect();
            assert!(now.iter().copied().eq(made.all().map(|slot| (made.key(slot), made.place(slot)))));
            assert_eq!(is_same, now == before);
            let archetypes = world.archetypes().len();
            assert!((0..archetypes + 2).all(|archetype| kept.slots_in(archetype) == made.slots_in(archetype)));
            let rows = kept.archetypes(world).flat_map(|(_, rows)| rows);
            assert!(rows.eq(kept.by_place.iter().map(|slot| (kept.place(*slot).row as usize, *slot))));
            known += usize::from(is_same && !now.is_empty());
        }
        assert!((1000..3000).contains(&known), "{known}");
    }
}
