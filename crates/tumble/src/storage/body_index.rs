//! Bodies that act on each other, by forces or contacts, gathered from their archetypes.

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
    /// By entity number, whether it is concerned.
    marks: Vec<bool>,
    /// By entity number.
    slots: Vec<Slot>,
    /// The slots in the order of places.
    by_place: Vec<Slot>,
    /// By archetype, where its slots begin in that order; and where the last end.
    begins: Vec<u32>,
    pub(crate) views: Vec<BodyView>,
}

impl BodyIndex {
    /// Finds the bodies among the entities that are marked, by number, when each archetype of the
    /// world is gone through.
    pub(crate) fn find(&mut self, world: &World, marked: impl Fn(&Archetype, &mut dyn FnMut(u32))) {
        let mut marks = std::mem::take(&mut self.marks);
        marks.clear();
        for archetype in world.archetypes().filter(|archetype| !archetype.is_empty()) {
            marked(archetype, &mut |entity| mark(&mut marks, entity as usize));
        }
        // From step to step they are mostly the same, and need not be sorted again.
        let known = self.by_place.iter().map(|slot| self.members[slot.index()]);
        if !known.eq(found(world, &marks)) {
            self.list(found(world, &marks));
        }
        self.begins.clear();
        let mut begin = 0;
        for (index, _) in world.archetypes().enumerate() {
            self.begins.push(begin as u32);
            let is_here = |slot: &&Slot| self.members[slot.index()].place.archetype as usize == index;
            begin += self.by_place[begin..].iter().take_while(is_here).count();
        }
        self.begins.push(begin as u32);
        self.marks = marks;
    }

    /// Gives slots to bodies, which come in the order of their places.
    fn list(&mut self, found: impl Iterator<Item = BodyPlace>) {
        let Self { members, slots, by_place, .. } = self;
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
        match self.begins.get(archetype..archetype + 2) {
            Some(&[begin, end]) => &self.by_place[begin as usize..end as usize],
            _ => &[],
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.members.len()
    }

    /// Calls `then` for each archetype with members, and the row and slot of each of them there.
    pub(crate) fn for_each_archetype(
        &self,
        world: &World,
        mut then: impl FnMut(&Archetype, &mut dyn Iterator<Item = (usize, Slot)>),
    ) {
        for (index, archetype) in world.archetypes().enumerate() {
            let slots = self.slots_in(index).iter();
            if slots.len() > 0 {
                then(archetype, &mut slots.map(|slot| (self.place(*slot).row as usize, *slot)));
            }
        }
    }

    /// Reads the state of all.
    pub(crate) fn update_views(&mut self, columns: &WorldColumns<'_>) {
        let Self { members, views, .. } = self;
        views.clear();
        views
            .extend(members.iter().map(|member| BodyView::of(columns.bodies(member.place), member.place.row as usize)));
    }
}

fn mark(marks: &mut Vec<bool>, entity: usize) {
    if marks.len() <= entity {
        marks.resize(entity + 1, false);
    }
    marks[entity] = true;
}

/// The bodies among marked entities, in the order of their places: hecs goes through archetypes and
/// rows in theirs.
fn found<'a>(world: &'a World, marks: &'a [bool]) -> impl Iterator<Item = BodyPlace> + 'a {
    let archetypes = world.archetypes().enumerate().filter(|(_, archetype)| archetype.has::<Pose>());
    archetypes.flat_map(move |(index, archetype)| {
        let ids = archetype.get::<&BodyId>();
        archetype.ids().iter().enumerate().filter_map(move |(row, &entity)| {
            let id = ids.as_deref().map(|ids| ids[row]);
            let place = RowPlace { archetype: index as u32, row: row as u32 };
            let is_marked = marks.get(entity as usize).is_some_and(|mark| *mark);
            is_marked.then_some(BodyPlace { key: (id.is_none(), id, entity), place })
        })
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
