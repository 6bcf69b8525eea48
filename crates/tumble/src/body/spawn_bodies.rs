//! Many bodies at once: whole columns are written instead of one entity after the other.

use std::borrow::Borrow;
use std::collections::BTreeMap;

use hecs::{ColumnBatch, ColumnBatchBuilder, ColumnBatchType, Entity, World};

use crate::body::body_columns::BodyColumns;
use crate::body::bundle::Body;
use crate::components::{BodyId, Momentum, Pose, PreviousPose};

/// Bodies that [`spawn_bodies`] sorts by kind at a time: they fit the second-level cache, and their
/// batches are not small.
const BLOCK: usize = 512;

/// Spawns many bodies, of any kinds, and returns their entities in the order of the bodies.
///
/// The world is as after a call of [`Body::spawn`] for each, several times sooner. In a world that
/// nothing was despawned from the entities ascend in the order of the bodies, so that what goes by
/// [`BodyOrder`](crate::BodyOrder) is the same too. Bodies are taken from the iterator a few
/// hundred at a time and none is kept; copies of one body come cheaper from [`Body::spawn_copies`].
///
/// ```
/// use tumble::prelude::*;
/// use tumble::spawn_bodies;
///
/// let mut world = hecs::World::new();
/// let bodies =
///     (1..=1000).map(|i| RigidBody::new(Shape::sphere(0.01 * f64::from(i))).mass(1.0).build());
/// let entities = spawn_bodies(&mut world, bodies.collect::<Result<Vec<_>, _>>()?);
/// assert_eq!((world.len(), entities.len()), (1000, 1000));
/// # Ok::<(), tumble::BodyError>(())
/// ```
///
/// # Panics
/// Where hecs does: if the world would have more than 2^32 - 2 entities.
pub fn spawn_bodies<B: Borrow<Body>>(world: &mut World, bodies: impl IntoIterator<Item = B>) -> Vec<Entity> {
    let mut bodies = bodies.into_iter();
    let expected = bodies.size_hint().0;
    let mut entities = Vec::with_capacity(expected);
    let mut block: Vec<B> = Vec::with_capacity(BLOCK);
    loop {
        block.clear();
        block.extend(bodies.by_ref().take(BLOCK));
        if block.is_empty() {
            return entities;
        }
        if expected > BLOCK
            && entities.is_empty()
            && block.iter().all(|body| body.borrow().kind() == block[0].borrow().kind())
        {
            // All others may well be of that kind too. Without room for them the columns would be
            // copied each time they double.
            block[0].borrow().reserve(world, u32::try_from(expected).unwrap_or(0));
        }
        spawn_block(world, &block, &mut entities);
    }
}

/// Spawns bodies, those of each kind in one batch, and appends their entities in the order of the
/// bodies.
fn spawn_block<B: Borrow<Body>>(world: &mut World, bodies: &[B], entities: &mut Vec<Entity>) {
    let mut kinds: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, body) in bodies.iter().enumerate() {
        kinds.entry(body.borrow().kind()).or_default().push(i);
    }
    // hecs looks a chosen handle up among all free ones, one by one, so handles are chosen only
    // where none are free.
    let handles: Option<Vec<Entity>> =
        (kinds.len() > 1 && world.freelist().len() == 0).then(|| world.reserve_entities(bodies.len() as u32).collect());
    world.flush();

    let first = entities.len();
    entities.resize(first + bodies.len(), Entity::DANGLING);
    let spawned = &mut entities[first..];
    for rows in kinds.values() {
        let Some(batch) = batch_of(rows.iter().map(|&i| bodies[i].borrow())) else { continue };
        match &handles {
            Some(handles) => {
                let chosen: Vec<Entity> = rows.iter().map(|&i| handles[i]).collect();
                world.spawn_column_batch_at(&chosen, batch);
                rows.iter().zip(chosen).for_each(|(&i, entity)| spawned[i] = entity);
            }
            None => {
                let given = world.spawn_column_batch(batch);
                rows.iter().zip(given).for_each(|(&i, entity)| spawned[i] = entity);
            }
        }
    }
}

/// The columns of bodies of one kind; `None` of no bodies.
fn batch_of<'b>(bodies: impl ExactSizeIterator<Item = &'b Body> + Clone) -> Option<ColumnBatch> {
    let mut types = ColumnBatchType::new();
    bodies.clone().next()?.insert_types_into(&mut types);
    let batch = types.into_batch(bodies.len() as u32);
    let mut columns = BodyColumns::of(&batch);
    bodies.for_each(|body| columns.push(body));
    drop(columns);
    batch.build().ok()
}

impl Body {
    /// Spawns a copy of the body for each pose of the centre of mass and momentum, and returns
    /// their entities in that order.
    ///
    /// What depends on the state, such as the [`Velocity`](crate::Velocity), is computed; all else
    /// is the body's. A body with a [`BodyId`] gives it to the first copy, and the next ids to the
    /// others, from 0 on after the largest. A fixed or kinematic body takes the poses and no
    /// momenta. Poses are taken as they are: finite, with unit quaternions.
    ///
    /// This is the fastest way to many bodies: the columns are allocated once and filled one after
    /// the other.
    ///
    /// ```
    /// use tumble::prelude::*;
    ///
    /// let mut world = hecs::World::new();
    /// let brick = RigidBody::new(Shape::cuboid([0.1, 0.05, 0.03])).mass(2.0).build()?;
    /// let column = (0..1000).map(|i| {
    ///     (Pose { position: Vec3::Y * 0.1 * i as Real, ..Pose::default() }, Momentum::default())
    /// });
    /// let bricks = brick.spawn_copies(&mut world, column);
    /// assert_eq!(world.get::<&Pose>(bricks[10])?.position.y, 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// An iterator that ends before the length it states spawns nothing, one that goes on is cut
    /// off there.
    ///
    /// # Panics
    /// Where hecs does: if the world would have more than 2^32 - 2 entities.
    pub fn spawn_copies<I>(&self, world: &mut World, states: I) -> Vec<Entity>
    where
        I: IntoIterator<Item = (Pose, Momentum)>,
        I::IntoIter: ExactSizeIterator,
    {
        let states = states.into_iter();
        let mut types = ColumnBatchType::new();
        self.insert_types_into(&mut types);
        // More bodies than a `u32` counts do not fit a world; hecs refuses them.
        let batch = types.into_batch(u32::try_from(states.len()).unwrap_or(u32::MAX));
        self.insert_copies_into(&batch, states);
        batch.build().map_or_else(|_| Vec::new(), |batch| world.spawn_column_batch(batch).collect())
    }

    /// Fills the columns of a batch with copies of the body, as
    /// [`spawn_copies`](Self::spawn_copies) does; the way to spawn many bodies that have components
    /// of the caller's own.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// struct Health(u32);
    /// # let mut world = hecs::World::new();
    /// let brick = RigidBody::new(Shape::cuboid([0.1, 0.05, 0.03])).mass(2.0).build()?;
    /// let mut types = hecs::ColumnBatchType::new();
    /// brick.insert_types_into(&mut types);
    /// types.add::<Health>();
    ///
    /// let batch = types.into_batch(1000);
    /// brick.insert_copies_into(&batch, (0..1000).map(|_| (Pose::default(), Momentum::default())));
    /// if let Some(mut health) = batch.writer() {
    ///     while health.push(Health(3)).is_ok() {}
    /// }
    /// let entities: Vec<_> = world.spawn_column_batch(batch.build()?).collect();
    /// # assert_eq!(world.query_mut::<(&Wrench, &Health)>().into_iter().count(), entities.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Columns that the batch does not have are left out, and so are copies that it has no room
    /// for. Where there are fewer states than rows, [`build`](ColumnBatchBuilder::build) says so.
    ///
    /// # Panics
    /// Where another writer of one of the body's columns is alive.
    pub fn insert_copies_into(&self, batch: &ColumnBatchBuilder, states: impl IntoIterator<Item = (Pose, Momentum)>) {
        let mut columns = BodyColumns::of(batch);
        let mut copy = self.clone();
        for (pose, momentum) in states {
            copy.set_state(pose, momentum);
            columns.push(&copy);
            copy.id = copy.id.map(|BodyId(id)| BodyId(id.wrapping_add(1)));
        }
    }

    /// Puts it elsewhere; the momentum is that of a dynamic body.
    fn set_state(&mut self, pose: Pose, momentum: Momentum) {
        self.pose = pose;
        self.previous_pose = self.previous_pose.map(|_| PreviousPose(pose));
        if let (Some(mass), Some(own)) = (self.mass, &mut self.momentum) {
            *own = momentum;
            let (velocity, inverse_inertia) = self.derived(mass, momentum);
            self.velocity = Some(velocity);
            self.inverse_inertia = self.inverse_inertia.map(|_| inverse_inertia);
        }
    }
}
