//! The index that queries look in: where each collider is, and a tree of the boxes around them.

use std::borrow::Cow;

use hecs::{Entity, Satisfies, World};
use rayon::prelude::*;
use tumble_collide::{Isometry, QueryTree, TreeBox};
use tumble_math::lane::{Lane, Quat};

use crate::collision::body_key::BodyKey;
use crate::collision::collider::Collider;
use crate::collision::collider_shape::ColliderShape;
use crate::collision::compound_parts::wide;
use crate::components::{BodyId, BodyKind, CenterOfMass, Momentum, Pose, Velocity};
use crate::math::{Real, Vec3, dquat, dvec3, real};
use crate::queries::query_filter::QueryFilter;
use crate::queries::world_queries::Queries;
use crate::range::{MAX_DISTANCE_OF_CONTACTS, is_rotation, within};
use crate::threads::{Effort, InParts};

/// The memory of queries, for worlds without a simulation.
///
/// A [`Simulation`](crate::Simulation) has one of its own, and there is
/// [`Queries::of`] for a single time. What is kept is brought up to date in each
/// [`queries`](Self::queries): a comparison for each body, and more for those that have moved.
///
/// ```
/// use tumble::{Collider, QueryFilter, QueryIndex, Ray, prelude::*};
///
/// let mut world = hecs::World::new();
/// let collider = Collider::new(&Shape::sphere(0.5))?;
/// let ball = RigidBody::new(Shape::sphere(0.5)).fixed().build()?.spawn_with(&mut world, (collider,));
///
/// let mut index = QueryIndex::default();
/// let down = Ray::new(Vec3::Y * 3.0, -Vec3::Y);
/// assert_eq!(index.queries(&world).cast_ray(&down, &QueryFilter::new()).unwrap().distance, 2.5);
/// world.get::<&mut Pose>(ball)?.position.y = 1.0;
/// assert_eq!(index.queries(&world).cast_ray(&down, &QueryFilter::new()).unwrap().distance, 1.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct QueryIndex {
    /// The bodies with colliders, in the order in which the world shows them.
    rows: Vec<Row>,
    /// By number in the tree.
    objects: Vec<Object>,
    /// Numbers that no body has.
    unused: Vec<u32>,
    tree: QueryTree<Real>,
}

/// What the index has seen of a body.
#[derive(Clone, Debug)]
struct Row {
    entity: Entity,
    seen: Seen<Collider>,
    object: u32,
}

/// What of a body decides where its collider is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen<C> {
    pose: Pose,
    center: Vec3,
    id: Option<BodyId>,
    kind: BodyKind,
    collider: C,
}

/// A collider at its place.
#[derive(Clone, Debug)]
pub(crate) struct Object {
    pub(crate) entity: Entity,
    pub(crate) key: BodyKey,
    pub(crate) collider: Collider,
    placement: Isometry<f64>,
    kind: BodyKind,
}

/// The rows that are not as they were.
pub(crate) enum Changes {
    /// Others are there, or in another order.
    Bodies,
    /// Those of these numbers, which may be none.
    Rows(Vec<u32>),
}

/// What the world shows of a body.
type Columns<'a> = (
    Entity,
    &'a Pose,
    &'a Collider,
    Option<&'a CenterOfMass>,
    Option<&'a BodyId>,
    Satisfies<&'a Momentum>,
    Satisfies<&'a Velocity>,
);

/// A body as these show it.
type Shown<'a> = (Entity, &'a Pose, &'a Collider, Option<&'a CenterOfMass>, Option<&'a BodyId>, bool, bool);

/// Colliders that one thread places at a time.
const PART: usize = 256;
/// Placing one, roughly \[us\].
const PLACE: f64 = 0.1;

impl Changes {
    pub(crate) fn are_none(&self) -> bool {
        matches!(self, Self::Rows(rows) if rows.is_empty())
    }
}

impl QueryIndex {
    /// Brings the index up to date with a world, and asks it.
    ///
    /// # Panics
    /// Like every query of hecs, while the caller holds a mutable reference to poses, colliders,
    /// centres of mass or ids.
    pub fn queries<'a>(&'a mut self, world: &'a World) -> Queries<'a> {
        let changes = self.find_changes(world);
        self.apply(world, &changes);
        Queries::in_index(self)
    }

    /// What has changed since it was brought up to date.
    pub(crate) fn find_changes(&self, world: &World) -> Changes {
        let mut changed = Vec::new();
        let mut query = world.query::<Columns<'_>>();
        let mut rows = self.rows.iter();
        for (number, columns) in (0..).zip(query.iter()) {
            let (entity, seen) = seen(columns);
            match rows.next() {
                Some(row) if row.entity == entity => {
                    if !row.seen.is_same(&seen) {
                        changed.push(number);
                    }
                }
                _ => return Changes::Bodies,
            }
        }
        if rows.next().is_some() { Changes::Bodies } else { Changes::Rows(changed) }
    }

    /// Takes over what has changed.
    pub(crate) fn apply(&mut self, world: &World, changes: &Changes) {
        let changed = match changes {
            Changes::Rows(changed) => {
                self.read_rows(world, changed);
                Cow::Borrowed(changed)
            }
            Changes::Bodies => Cow::Owned(self.list_bodies(world)),
        };
        self.place(&changed);
        self.tree.refit();
    }

    fn read_rows(&mut self, world: &World, changed: &[u32]) {
        let mut changed = changed.iter().copied().peekable();
        for (number, columns) in (0..).zip(world.query::<Columns<'_>>().iter()) {
            if changed.next_if_eq(&number).is_some() {
                self.rows[number as usize].seen = seen(columns).1.cloned();
            }
        }
    }

    /// Lists the bodies again, and returns the rows of those that are new or have changed.
    fn list_bodies(&mut self, world: &World) -> Vec<u32> {
        let before = std::mem::take(&mut self.rows);
        // By the number of the entity, the row before.
        let most = before.iter().map(|row| row.entity.id() as usize + 1).max().unwrap_or(0);
        let mut row_of = vec![u32::MAX; most];
        (0..).zip(&before).for_each(|(number, row)| row_of[row.entity.id() as usize] = number);
        let mut changed = Vec::new();
        let mut stays = vec![false; self.objects.len()];
        self.unused.iter().for_each(|object| stays[*object as usize] = true);
        let mut query = world.query::<Columns<'_>>();
        for (number, columns) in (0..).zip(query.iter()) {
            let (entity, seen) = seen(columns);
            let known = row_of.get(entity.id() as usize).and_then(|row| before.get(*row as usize));
            match known.filter(|row| row.entity == entity) {
                Some(row) => {
                    stays[row.object as usize] = true;
                    if row.seen.is_same(&seen) {
                        self.rows.push(row.clone());
                    } else {
                        changed.push(number);
                        self.rows.push(Row { seen: seen.cloned(), ..*row });
                    }
                }
                None => {
                    changed.push(number);
                    self.rows.push(Row { entity, seen: seen.cloned(), object: u32::MAX });
                }
            }
        }
        for (object, _) in (0..).zip(&stays).filter(|(_, stays)| !**stays) {
            self.tree.set(object, TreeBox::Nowhere);
            self.unused.push(object);
        }
        for row in self.rows.iter_mut().filter(|row| row.object == u32::MAX) {
            row.object = self.unused.pop().unwrap_or(self.objects.len() as u32);
            let object = Object::of(row);
            match self.objects.get_mut(row.object as usize) {
                Some(unused) => *unused = object,
                None => self.objects.push(object),
            }
        }
        changed
    }

    /// Finds out where the colliders of rows are now.
    fn place(&mut self, changed: &[u32]) {
        let Self { rows, objects, tree, .. } = self;
        let placed = |number: &u32| {
            let row = &rows[*number as usize];
            let object = Object::of(row);
            (row.object, object.tree_box(&row.seen.pose), object)
        };
        let place_all = || -> Vec<Vec<_>> {
            let parts = changed.par_chunks(PART).by_at_least(1);
            parts.map(|part| part.iter().map(placed).collect()).collect()
        };
        for (number, tree_box, object) in
            Effort::of_microseconds(changed.len() as f64 * PLACE).run(place_all).into_iter().flatten()
        {
            tree.set(number, tree_box);
            objects[number as usize] = object;
        }
    }

    pub(crate) fn tree(&self) -> &QueryTree<Real> {
        &self.tree
    }

    /// The collider of a number, if a filter lets it through.
    pub(crate) fn object(&self, number: u32, filter: &QueryFilter<'_>) -> Option<&Object> {
        let object = &self.objects[number as usize];
        let is_wanted = filter.lets_any_through(&object.collider);
        (is_wanted && filter.lets_through(object.entity, object.kind)).then_some(object)
    }
}

impl<C> Seen<C> {
    fn with<D>(self, collider: D) -> Seen<D> {
        let Self { pose, center, id, kind, .. } = self;
        Seen { pose, center, id, kind, collider }
    }
}

impl Seen<&Collider> {
    fn cloned(self) -> Seen<Collider> {
        let collider = self.collider.clone();
        self.with(collider)
    }
}

impl Seen<Collider> {
    fn is_same(&self, now: &Seen<&Collider>) -> bool {
        let Self { pose, center, id, kind, collider } = self;
        (*pose, *center, *id, *kind) == (now.pose, now.center, now.id, now.kind) && collider.is_same(now.collider)
    }
}

fn seen((entity, pose, collider, center, id, moves, has_velocity): Shown<'_>) -> (Entity, Seen<&Collider>) {
    let kind = match (moves, has_velocity) {
        (true, _) => BodyKind::Moving,
        (false, true) => BodyKind::Kinematic,
        (false, false) => BodyKind::Fixed,
    };
    let center = center.map_or(Vec3::ZERO, |center| center.0);
    (entity, Seen { pose: *pose, center, id: id.copied(), kind, collider })
}

impl Object {
    fn of(row: &Row) -> Self {
        let Seen { pose, center, id, kind, collider } = &row.seen;
        let orientation = Quat::<f64>::from(dquat(pose.orientation)).normalize();
        let position = tumble_math::lane::Vec3::from(dvec3(pose.position)) - orientation.rotate(dvec3(*center).into());
        let body = Isometry { position, orientation };
        let placement = collider.place().map_or(body, |offset| body.then(&wide(&offset)));
        Self {
            entity: row.entity,
            key: BodyKey::of(*id, row.entity.id()),
            collider: collider.clone(),
            placement,
            kind: *kind,
        }
    }

    /// The box around it; none where contacts would not find it either.
    fn tree_box(&self, pose: &Pose) -> TreeBox<Real> {
        let Isometry { position, orientation } = narrow(&self.placement);
        let is_somewhere = within(position, MAX_DISTANCE_OF_CONTACTS) && is_rotation(pose.orientation.into());
        if !is_somewhere {
            return TreeBox::Nowhere;
        }
        let geometry = self.collider.geometry();
        let size = position.x.abs().max(position.y.abs()).max(position.z.abs()) + geometry.reach().unwrap_or(0.0);
        // What rounding of the place and of the box may be.
        let margin = size * real(8.0 * Real::ROUNDING);
        geometry.aabb(&Isometry { position, orientation }, margin).map_or(TreeBox::Endless, TreeBox::Bounded)
    }

    /// Shows the parts that a filter lets through: which, its shape, and where it is.
    pub(crate) fn for_each_part(
        &self,
        filter: &QueryFilter<'_>,
        mut visit: impl FnMut(u32, &ColliderShape, &Isometry<f64>),
    ) {
        self.collider.for_each_part(&self.placement, |part, (groups, is_sensor), shape, at| {
            if filter.lets_part_through(groups, is_sensor) {
                visit(part, shape, at);
            }
        });
    }
}

/// A place in the precision of the build.
pub(crate) fn narrow(at: &Isometry<f64>) -> Isometry<Real> {
    let vector = |v: tumble_math::lane::Vec3<f64>| tumble_math::lane::Vec3::new(real(v.x), real(v.y), real(v.z));
    let orientation = Quat::from_parts(real(at.orientation.w), vector(at.orientation.vector()));
    Isometry { position: vector(at.position), orientation }
}
