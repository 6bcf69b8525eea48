//! The stable body identity that fixes the order of sums, hashes and records.

/// A body's stable identity, chosen by the caller.
///
/// A hecs entity's place in memory changes when others are despawned or components are added, and
/// its handle depends on what was spawned before it. Whatever depends on order (state hashes, sums
/// over bodies, records) goes by `BodyId`; bodies without one come after those with one, by entity.
/// Two worlds with the same ids and states have the same hash, whatever order they were spawned in.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// let ship =
///     RigidBody::new(Shape::sphere(1.0)).mass(2.0).id(BodyId(7)).build()?.spawn(&mut world);
/// assert_eq!(*world.get::<&BodyId>(ship)?, BodyId(7));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId(pub u64);
