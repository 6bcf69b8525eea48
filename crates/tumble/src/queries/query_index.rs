//! The index that queries look in: where each collider is, and a tree of the boxes around them.

use std::borrow::Cow;

use hecs::{Archetype, Entity, Satisfies, With, World};
use rayon::prelude::*;
use tumble_collide::{Isometry, QueryTree, TreeBox};
use tumble_math::lane::{Lane, Quat};

use crate::collision::body_key::BodyKey;
use crate::collision::collider::Collider;
use crate::collision::collider_shape::ColliderShape;
use crate::collision::compound_parts::{narrow, wide};
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
/// let ball =
///     RigidBody::new(Shape::sphere(0.5)).fixed().build()?.spawn_with(&mut world, (collider,));
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
    rows: Rows,
    /// By number in the tree.
    objects: Vec<Object>,
    /// Numbers that no body has.
    unused: Vec<u32>,
    tree: QueryTree<Real>,
}

/// What the index has seen of bodies, each kind of number in a list of its own: where nothing has
/// moved, the time of a comparison is that of reading them.
#[derive(Clone, Debug, Default)]
struct Rows {
    entities: Vec<Entity>,
    poses: Vec<Pose>,
    colliders: Vec<Collider>,
    centers: Vec<Vec3>,
    /// Some number where there is none.
    ids: Vec<BodyId>,
    kinds: Vec<Kind>,
    objects: Vec<u32>,
}

/// What of a body its archetype decides.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Kind {
    body: BodyKind,
    has_center: bool,
    has_id: bool,
}

/// What of a body decides where its collider is.
#[derive(Clone, Copy, Debug)]
struct Seen<'a> {
    pose: &'a Pose,
    collider: &'a Collider,
    center: Vec3,
    id: BodyId,
    kind: Kind,
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
        let Rows { entities, poses, colliders, centers, ids, kinds, .. } = &self.rows;
        if !world.query::<With<Entity, (&Pose, &Collider)>>().iter().eq(entities.iter().copied()) {
            return Changes::Bodies;
        }
        let mut changed = Vec::new();
        let mut begin = 0;
        for archetype in world.archetypes() {
            let (Some(now), Some(collide)) = (archetype.get::<&Pose>(), archetype.get::<&Collider>()) else {
                continue;
            };
            let rows = begin..begin + now.len();
            begin = rows.end;
            let of_poses = poses[rows.clone()].iter().zip(&*now).map(|(a, b)| is_same_pose(a, b));
            add_changes(&mut changed, rows.start, of_poses);
            let of_colliders = colliders[rows.clone()].iter().zip(&*collide).map(|(a, b)| a.is_same(b));
            add_changes(&mut changed, rows.start, of_colliders);
            let kind = Kind::of(archetype);
            add_changes(&mut changed, rows.start, kinds[rows.clone()].iter().map(|it| *it == kind));
            if let Some(now) = archetype.get::<&CenterOfMass>() {
                let of_centers = centers[rows.clone()].iter().zip(&*now).map(|(a, b)| is_same_vector(*a, b.0));
                add_changes(&mut changed, rows.start, of_centers);
            }
            if let Some(now) = archetype.get::<&BodyId>() {
                add_changes(&mut changed, rows.start, ids[rows].iter().zip(&*now).map(|(a, b)| a == b));
            }
        }
        changed.sort_unstable();
        changed.dedup();
        Changes::Rows(changed)
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
                self.rows.set(number as usize, seen(columns).1);
            }
        }
    }

    /// Lists the bodies again, and returns the rows of those that are new or have changed.
    fn list_bodies(&mut self, world: &World) -> Vec<u32> {
        let before = std::mem::take(&mut self.rows);
        // By the number of the entity, the row before.
        let most = before.entities.iter().map(|entity| entity.id() as usize + 1).max().unwrap_or(0);
        let mut row_of = vec![usize::MAX; most];
        before.entities.iter().enumerate().for_each(|(row, entity)| row_of[entity.id() as usize] = row);
        let mut changed = Vec::new();
        let mut stays = vec![false; self.objects.len()];
        self.unused.iter().for_each(|object| stays[*object as usize] = true);
        let mut query = world.query::<Columns<'_>>();
        for (number, columns) in (0..).zip(query.iter()) {
            let (entity, seen) = seen(columns);
            let known = row_of.get(entity.id() as usize).copied();
            let known = known.filter(|row| before.entities.get(*row) == Some(&entity));
            let object = known.map_or(u32::MAX, |row| before.objects[row]);
            if let Some(stays) = stays.get_mut(object as usize) {
                *stays = true;
            }
            if known.is_none_or(|row| !before.seen(row).is_same(&seen)) {
                changed.push(number);
            }
            self.rows.push(entity, seen, object);
        }
        for (object, _) in (0..).zip(&stays).filter(|(_, stays)| !**stays) {
            self.tree.set(object, TreeBox::Nowhere);
            self.unused.push(object);
        }
        for row in 0..self.rows.objects.len() {
            if self.rows.objects[row] == u32::MAX {
                let number = self.unused.pop().unwrap_or(self.objects.len() as u32);
                self.rows.objects[row] = number;
                let object = Object::of(self.rows.entities[row], &self.rows.seen(row));
                match self.objects.get_mut(number as usize) {
                    Some(unused) => *unused = object,
                    None => self.objects.push(object),
                }
            }
        }
        changed
    }

    /// Finds out where the colliders of rows are now.
    fn place(&mut self, changed: &[u32]) {
        let Self { rows, objects, tree, .. } = self;
        let placed = |number: &u32| {
            let row = *number as usize;
            let object = Object::of(rows.entities[row], &rows.seen(row));
            (rows.objects[row], object.tree_box(&rows.poses[row]), object)
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

impl Rows {
    fn seen(&self, row: usize) -> Seen<'_> {
        let Self { poses, colliders, centers, ids, kinds, .. } = self;
        Seen { pose: &poses[row], collider: &colliders[row], center: centers[row], id: ids[row], kind: kinds[row] }
    }

    fn push(&mut self, entity: Entity, Seen { pose, collider, center, id, kind }: Seen<'_>, object: u32) {
        self.entities.push(entity);
        self.poses.push(*pose);
        self.colliders.push(collider.clone());
        self.centers.push(center);
        self.ids.push(id);
        self.kinds.push(kind);
        self.objects.push(object);
    }

    fn set(&mut self, row: usize, Seen { pose, collider, center, id, kind }: Seen<'_>) {
        self.poses[row] = *pose;
        self.colliders[row] = collider.clone();
        self.centers[row] = center;
        self.ids[row] = id;
        self.kinds[row] = kind;
    }
}

impl Kind {
    fn of(archetype: &Archetype) -> Self {
        Self::new(
            [archetype.has::<Momentum>(), archetype.has::<Velocity>()],
            [archetype.has::<CenterOfMass>(), archetype.has::<BodyId>()],
        )
    }

    fn new([has_momentum, has_velocity]: [bool; 2], [has_center, has_id]: [bool; 2]) -> Self {
        let body = match (has_momentum, has_velocity) {
            (true, _) => BodyKind::Moving,
            (false, true) => BodyKind::Kinematic,
            (false, false) => BodyKind::Fixed,
        };
        Self { body, has_center, has_id }
    }
}

impl Seen<'_> {
    fn is_same(&self, now: &Self) -> bool {
        let Self { pose, collider, center, id, kind } = self;
        is_same_pose(pose, now.pose)
            && collider.is_same(now.collider)
            && is_same_vector(*center, now.center)
            && (*id, *kind) == (now.id, now.kind)
    }

    fn id(&self) -> Option<BodyId> {
        self.kind.has_id.then_some(self.id)
    }
}

/// Adds the rows, from the first on, that are not the same. Where all are, which is the usual case,
/// that is found without a branch for each.
#[inline(always)]
fn add_changes(changed: &mut Vec<u32>, first: usize, are_same: impl Iterator<Item = bool> + Clone) {
    if !are_same.clone().fold(true, |all, is_same| all & is_same) {
        let rows = (first as u32..).zip(are_same);
        changed.extend(rows.filter(|(_, is_same)| !is_same).map(|(row, _)| row));
    }
}

/// Bit for bit: what is not a number is no change.
#[inline(always)]
fn is_same_pose(a: &Pose, b: &Pose) -> bool {
    let turned = |Pose { orientation: q, .. }: &Pose| [q.x, q.y, q.z, q.w].map(Real::to_bits);
    let is_turned = turned(a).into_iter().zip(turned(b)).fold(0, |changed, (a, b)| changed | (a ^ b)) != 0;
    is_same_vector(a.position, b.position) & !is_turned
}

/// Bit for bit.
#[inline(always)]
fn is_same_vector(a: Vec3, b: Vec3) -> bool {
    let [a, b] = [a, b].map(|it| it.to_array().map(Real::to_bits));
    (a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2]) == 0
}

fn seen((entity, pose, collider, center, id, moves, has_velocity): Shown<'_>) -> (Entity, Seen<'_>) {
    let kind = Kind::new([moves, has_velocity], [center.is_some(), id.is_some()]);
    let center = center.map_or(Vec3::ZERO, |center| center.0);
    (entity, Seen { pose, collider, center, id: id.copied().unwrap_or(BodyId(0)), kind })
}

impl Object {
    fn of(entity: Entity, seen: &Seen<'_>) -> Self {
        let Seen { pose, collider, center, kind, .. } = seen;
        let orientation = Quat::<f64>::from(dquat(pose.orientation)).normalize();
        let position = tumble_math::lane::Vec3::from(dvec3(pose.position)) - orientation.rotate(dvec3(*center).into());
        let body = Isometry { position, orientation };
        let placement = collider.place().map_or(body, |offset| body.then(&wide(&offset)));
        Self {
            entity,
            key: BodyKey::of(seen.id(), entity.id()),
            collider: (*collider).clone(),
            placement,
            kind: kind.body,
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
