//! Which breakable joints are broken, apart from the world that they are in.

use hecs::{Entity, World};

use crate::components::{BodyId, Pose};
use crate::joints::breakable::Breakable;
use crate::joints::joint::Joint;
use crate::snapshot::bytes::Reader;
use crate::snapshot::error::SnapshotError;
use crate::snapshot::state_hash::Fnv;
use crate::storage::body_order::BodyOrder;

/// The persistent key of a joint: the [`BodyId`] of its entity, or without one the entity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum JointKey {
    Id(BodyId),
    /// As bits, the generation among them.
    Entity(u64),
}

#[derive(Clone, Copy, Debug)]
struct SavedJoint {
    key: JointKey,
    is_broken: bool,
}

/// The breakable joints of a world that have a body there, broken or whole.
#[derive(Clone, Debug, Default)]
pub(crate) struct SavedJoints {
    /// In the order of their keys, no two the same.
    joints: Vec<SavedJoint>,
}

impl JointKey {
    fn of(id: Option<BodyId>, entity: Entity) -> Self {
        id.map_or(Self::Entity(entity.to_bits().get()), Self::Id)
    }

    fn id(self) -> Option<BodyId> {
        match self {
            Self::Id(id) => Some(id),
            Self::Entity(_) => None,
        }
    }
}

impl SavedJoints {
    pub(crate) fn clear(&mut self) {
        self.joints.clear();
    }

    /// Bytes of memory that its buffer holds.
    pub(crate) fn memory(&self) -> usize {
        self.joints.capacity() * size_of::<SavedJoint>()
    }

    /// Takes those of a world in the place of what it held.
    pub(crate) fn record(&mut self, world: &World) -> Result<(), SnapshotError> {
        self.clear();
        let mut all = world.query::<(Entity, &Joint, &Breakable, Option<&BodyId>)>();
        for (entity, joint, breakable, id) in all.iter() {
            if joint.bodies.iter().any(|body| world.satisfies::<&Pose>(*body)) {
                let key = JointKey::of(id.copied(), entity);
                self.joints.push(SavedJoint { key, is_broken: breakable.is_broken });
            }
        }
        self.joints.sort_unstable_by_key(|joint| joint.key);
        let twice = self.joints.windows(2).find(|pair| pair[0].key == pair[1].key);
        let id = twice.and_then(|pair| pair[0].key.id());
        id.map_or(Ok(()), |id| Err(SnapshotError::DuplicateJoint { id }))
    }

    /// Breaks or mends the joints of a world that it knows.
    pub(crate) fn write(&self, world: &mut World) {
        if self.joints.is_empty() {
            return;
        }
        let all = world.query_mut::<(Entity, &mut Breakable, Option<&BodyId>)>().with::<&Joint>();
        for (entity, breakable, id) in all {
            let key = JointKey::of(id.copied(), entity);
            if let Ok(place) = self.joints.binary_search_by_key(&key, |joint| joint.key) {
                breakable.is_broken = self.joints[place].is_broken;
            }
        }
    }

    /// Adds the broken ones to a hash.
    pub(crate) fn add_to(&self, hash: &mut Fnv) {
        let broken = || self.joints.iter().filter(|joint| joint.is_broken);
        hash.add_broken(broken().count(), broken().filter_map(|joint| joint.key.id()));
    }

    /// How many go by a [`BodyId`], and how many by their entity.
    pub(crate) fn counts(&self) -> [u64; 2] {
        let ids = self.joints.iter().filter(|joint| joint.key.id().is_some()).count();
        [ids as u64, (self.joints.len() - ids) as u64]
    }

    /// How many bytes this many take; `u64::MAX` where it is more.
    pub(crate) fn length([ids, entities]: [u64; 2]) -> u64 {
        ids.saturating_add(entities).saturating_mul(9)
    }

    pub(crate) fn write_bytes(&self, bytes: &mut Vec<u8>) {
        let numbers = self.joints.iter().map(|joint| match joint.key {
            JointKey::Id(BodyId(number)) | JointKey::Entity(number) => number,
        });
        bytes.extend(numbers.flat_map(u64::to_le_bytes));
        bytes.extend(self.joints.iter().map(|joint| u8::from(joint.is_broken)));
    }

    /// Reads as many as are counted, which are known to be there.
    pub(crate) fn read(reader: &mut Reader<'_>, counts: [u64; 2]) -> Result<Self, SnapshotError> {
        let [ids, entities] = counts.map(|count| count as usize);
        let mut keys = reader.many(ids, |reader| reader.u64().map(|id| JointKey::Id(BodyId(id))))?;
        keys.extend(reader.many(entities, |reader| reader.u64().map(JointKey::Entity))?);
        if let Some(pair) = keys.windows(2).position(|pair| pair[0] >= pair[1]) {
            return Err(SnapshotError::Joint { joint: pair + 1 });
        }
        let mut joints = Vec::with_capacity(keys.len());
        for (joint, key) in keys.into_iter().enumerate() {
            match reader.u8()? {
                flag @ (0 | 1) => joints.push(SavedJoint { key, is_broken: flag == 1 }),
                _ => return Err(SnapshotError::Joint { joint }),
            }
        }
        Ok(Self { joints })
    }
}

/// Adds the broken joints of a world that have a body in an order to a hash.
pub(crate) fn add_broken_joints(hash: &mut Fnv, world: &World, order: &BodyOrder) {
    let mut all = world.query::<(&Joint, &Breakable, Option<&BodyId>)>();
    let broken: Vec<_> = all.iter().filter(|(_, breakable, _)| breakable.is_broken).collect();
    if broken.is_empty() {
        return;
    }
    let mut listed = order.entities().to_vec();
    listed.sort_unstable();
    let is_listed = |body: &Entity| listed.binary_search(body).is_ok() && world.satisfies::<&Pose>(*body);
    let here = broken.into_iter().filter(|(joint, ..)| joint.bodies.iter().any(is_listed));
    let mut ids: Vec<Option<BodyId>> = here.map(|(_, _, id)| id.copied()).collect();
    ids.sort_unstable();
    hash.add_broken(ids.len(), ids.into_iter().flatten());
}
