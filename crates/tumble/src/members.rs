//! Bodies that act on each other, by forces or contacts, gathered from their archetypes.

use hecs::{Archetype, World};

use crate::components::{BodyId, Inertia, Mass, Momentum, Pose, PrincipalAxes, Velocity, Wrench};
use crate::derived::{Derived, derived};
use crate::math::Real;
use crate::state::{Constants, Moments, State};

/// No slot.
const NONE: u32 = u32::MAX;

/// What the order of bodies goes by: those without a [`BodyId`] last, by the number of their entity.
pub(crate) type Key = (bool, Option<BodyId>, u32);

/// Where a body's components are.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Member {
    key: Key,
    archetype: usize,
    row: usize,
}

/// A body as forces between bodies see it.
#[derive(Clone, Copy)]
pub(crate) struct Seen {
    pub(crate) state: State<Real>,
    /// Zero for a body that forces do not move.
    pub(crate) inverse_mass: Real,
    /// Of one that they move.
    pub(crate) constants: Option<Constants<Real>>,
    pub(crate) derived: Derived<Real>,
}

/// The bodies concerned, each with a slot, in the order of their [`BodyId`]s.
#[derive(Clone, Default)]
pub(crate) struct Members {
    members: Vec<Member>,
    /// By entity number.
    slots: Vec<u32>,
    /// The slots by archetype, then row.
    by_place: Vec<usize>,
    pub(crate) seen: Vec<Seen>,
}

impl Members {
    /// Finds the bodies among the entities that are marked, by number, when each archetype of the world is gone through.
    pub(crate) fn find(&mut self, world: &World, marked: impl Fn(&Archetype, &mut dyn FnMut(u32))) {
        self.slots.clear();
        for archetype in world.archetypes().filter(|archetype| !archetype.is_empty()) {
            marked(archetype, &mut |entity| self.mark(entity));
        }
        self.members.clear();
        for (index, archetype) in world.archetypes().enumerate().filter(|(_, archetype)| archetype.has::<Pose>()) {
            let ids = archetype.get::<&BodyId>();
            for (row, &entity) in archetype.ids().iter().enumerate() {
                if self.slots.get(entity as usize).is_some_and(|slot| *slot != NONE) {
                    let id = ids.as_deref().map(|ids| ids[row]);
                    self.members.push(Member { key: (id.is_none(), id, entity), archetype: index, row });
                }
            }
        }
        // hecs goes through archetypes and rows in their order, so this is that of places.
        self.by_place.clear();
        self.by_place.resize(self.members.len(), 0);
        if !self.members.is_sorted() {
            self.members.sort_unstable();
        }
        self.slots.fill(NONE);
        for (slot, member) in self.members.iter().enumerate() {
            self.slots[member.key.2 as usize] = slot as u32;
            self.by_place[slot] = slot;
        }
        let members = &self.members;
        let place = |slot: &usize| (members[*slot].archetype, members[*slot].row);
        if !self.by_place.is_sorted_by_key(place) {
            self.by_place.sort_unstable_by_key(place);
        }
    }

    fn mark(&mut self, id: u32) {
        let id = id as usize;
        if self.slots.len() <= id {
            self.slots.resize(id + 1, NONE);
        }
        self.slots[id] = 0;
    }

    /// The slot of an entity, if it is a body that was found.
    pub(crate) fn slot(&self, id: u32) -> Option<usize> {
        self.slots.get(id as usize).filter(|slot| **slot != NONE).map(|slot| *slot as usize)
    }

    /// What the order of slots goes by.
    pub(crate) fn key(&self, slot: usize) -> Key {
        self.members[slot].key
    }

    pub(crate) fn len(&self) -> usize {
        self.members.len()
    }

    /// Calls `then` for each archetype with members, and the row and slot of each of them there.
    pub(crate) fn for_each_archetype(
        &self,
        world: &World,
        mut then: impl FnMut(&Archetype, &mut dyn Iterator<Item = (usize, usize)>),
    ) {
        let groups = self.by_place.chunk_by(|a, b| self.members[*a].archetype == self.members[*b].archetype);
        let mut archetypes = world.archetypes().enumerate();
        for group in groups {
            let wanted = self.members[group[0]].archetype;
            if let Some((_, archetype)) = archetypes.find(|(index, _)| *index == wanted) {
                then(archetype, &mut group.iter().map(|&slot| (self.members[slot].row, slot)));
            }
        }
    }

    /// Reads the state of all.
    pub(crate) fn gather(&mut self, world: &World) {
        let mut seen = std::mem::take(&mut self.seen);
        seen.clear();
        seen.resize(self.len(), Seen::NOWHERE);
        self.for_each_archetype(world, |archetype, places| {
            let columns = Columns::of(archetype);
            places.for_each(|(row, slot)| seen[slot] = columns.seen(row));
        });
        self.seen = seen;
    }
}

/// The columns that there are of one archetype.
struct Columns<'a> {
    pose: Option<hecs::ArchetypeColumn<'a, Pose>>,
    momentum: Option<hecs::ArchetypeColumn<'a, Momentum>>,
    mass: Option<hecs::ArchetypeColumn<'a, Mass>>,
    inertia: Option<hecs::ArchetypeColumn<'a, Inertia>>,
    axes: Option<hecs::ArchetypeColumn<'a, PrincipalAxes>>,
    velocity: Option<hecs::ArchetypeColumn<'a, Velocity>>,
    /// Whether there are wrenches: without them a body is not integrated.
    wrench: bool,
}

impl<'a> Columns<'a> {
    fn of(archetype: &'a Archetype) -> Self {
        Self {
            pose: archetype.get::<&Pose>(),
            momentum: archetype.get::<&Momentum>(),
            mass: archetype.get::<&Mass>(),
            inertia: archetype.get::<&Inertia>(),
            axes: archetype.get::<&PrincipalAxes>(),
            velocity: archetype.get::<&Velocity>(),
            wrench: archetype.has::<Wrench>(),
        }
    }

    fn seen(&self, row: usize) -> Seen {
        let Some(pose) = self.pose.as_deref().map(|column| column[row]) else { return Seen::NOWHERE };
        let (Some(momentum), Some(mass), true) = (&self.momentum, &self.mass, self.wrench) else {
            let velocity = self.velocity.as_deref().map_or(Velocity::default(), |column| column[row]);
            return Seen::unmoved(pose, velocity);
        };
        let axes = self.axes.as_deref().map(|column| column[row]);
        let inertia = self.inertia.as_deref().map(|column| Moments::new(&column[row], axes.as_ref()));
        let constants = Constants { mass: mass[row].kilograms(), inertia, damping: None };
        let state = State::new(&pose, &momentum[row]);
        let upright = State { orientation: state.orientation.normalize(), ..state };
        Seen {
            state: upright,
            inverse_mass: 1.0 / constants.mass,
            constants: Some(constants),
            derived: derived(&constants, &upright),
        }
    }
}

impl Seen {
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

    /// A body that stays or moves as it is told.
    fn unmoved(pose: Pose, velocity: Velocity) -> Self {
        let mut seen = Self::NOWHERE;
        seen.state.position = pose.position.into();
        seen.state.orientation = tumble_math::lane::Quat::from(pose.orientation).normalize();
        seen.derived.linear = velocity.linear.into();
        seen.derived.angular = velocity.angular.into();
        seen
    }
}
