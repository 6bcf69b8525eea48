//! A deterministic order of bodies, and blockwise evaluation in that order.

use hecs::{Entity, World};
use rayon::prelude::*;

use crate::components::{BodyId, Mass, Momentum, Pose};
use crate::threads::InParts;

/// Bodies whose sums are taken in one go. Where a block ends decides the last bits of sums, so it
/// depends on nothing.
const BLOCK: usize = 1024;

/// The bodies of a world in an order that does not depend on how they lie in memory: by [`BodyId`],
/// and after them, by entity, those without one. A body is an entity with a [`Pose`].
///
/// It is a list made once: bodies spawned or despawned later are not followed. Making it reads the
/// world and, like every query of hecs, panics while the caller holds a mutable reference to one of
/// the components; so do [`Totals::of`](crate::Totals::of), [`state_hash`](crate::state_hash())
/// and what else takes an order.
///
/// ```
/// # use tumble::{BodyOrder, prelude::*};
/// # let mut world = hecs::World::new();
/// let body = RigidBody::new(Shape::sphere(1.0)).mass(2.0);
/// let second = body.clone().id(BodyId(2)).build()?.spawn(&mut world);
/// let first = body.id(BodyId(1)).build()?.spawn(&mut world);
/// assert_eq!(BodyOrder::of(&world).entities(), [first, second]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BodyOrder {
    entities: Vec<Entity>,
}

impl BodyOrder {
    /// The bodies that are in the world now.
    pub fn of(world: &World) -> Self {
        let mut bodies = world.query::<(Entity, &Pose, Option<&BodyId>)>();
        Self::sorted(bodies.iter().map(|(entity, _, id)| (id.copied(), entity)).collect())
    }

    /// The dynamic bodies: those that have a state array.
    pub fn moving(world: &World) -> Self {
        let mut bodies = world.query::<(Entity, &Pose, &Momentum, &Mass, Option<&BodyId>)>();
        Self::sorted(bodies.iter().map(|(entity, _, _, _, id)| (id.copied(), entity)).collect())
    }

    fn sorted(mut keyed: Vec<(Option<BodyId>, Entity)>) -> Self {
        keyed.sort_unstable_by_key(|(id, entity)| (id.is_none(), *id, entity.id()));
        Self { entities: keyed.into_iter().map(|(_, entity)| entity).collect() }
    }

    /// The bodies, in order.
    pub fn entities(&self) -> &[Entity] {
        &self.entities
    }

    /// Maps each block of bodies, in order; in parallel within a pool.
    pub(crate) fn in_blocks<T: Send>(&self, of_block: impl Fn(&[Entity]) -> T + Sync) -> Vec<T> {
        self.entities.par_chunks(BLOCK).by_at_least(1).map(&of_block).collect()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.entities.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.entities.is_empty()
    }
}
