//! The questions that can be asked about the bodies of a world.

use std::ops::Deref;
use std::sync::Arc;

use hecs::{Entity, World};
use rayon::prelude::*;
use tumble_collide::{Aabb, Isometry, NearestPoint, ShapeCastHit, ShapeRayHit};

use crate::collision::body_key::BodyKey;
use crate::collision::collider::Collider;
use crate::collision::collider_shape::ColliderShape;
use crate::collision::compound_parts::{narrow, wide};
use crate::components::Pose;
use crate::math::{Real, Vec3, dquat, dvec3, real, vec3};
use crate::queries::hits::{PartHit, PointHit, RayHit, ShapeHit};
use crate::queries::query_filter::QueryFilter;
use crate::queries::query_index::{Object, QueryIndex};
use crate::queries::ray::Ray;
use crate::threads::{Effort, InParts};

/// What rays meet, what is near a point, what a shape overlaps or is stopped by: questions about
/// the colliders of a world, as they are now.
///
/// It is up to date with the world, whatever the caller has changed since the last step, and holds
/// it: while there is one the world does not change. Any number of threads may ask. Answers depend
/// on the bodies alone: of what is equally near, that comes first which is first in
/// [`BodyOrder`](crate::BodyOrder), and of one body the part and the triangle of the lowest number.
/// Bodies that contacts would not find, such as those nowhere or turned by no rotation, are not
/// found.
///
/// Distances are computed in double precision, for shapes as they are: what is round is round. See
/// `docs/queries.md`.
///
/// ```
/// use tumble::{Queries, QueryFilter, Ray, prelude::*};
///
/// let mut world = hecs::World::new();
/// spawn_ground(&mut world);
///
/// let queries = Queries::of(&world);
/// let hit = queries.cast_ray(&Ray::new(Vec3::Y * 2.0, -Vec3::Y), &QueryFilter::new());
/// assert_eq!(hit.map(|hit| hit.distance), Some(2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("query pipeline", "SpatialQuery", "raycast", "shapecast"))]
#[derive(Clone, Debug)]
pub struct Queries<'a> {
    index: Index<'a>,
}

/// The index that is asked, of its owner or shared with it.
#[derive(Clone, Debug)]
enum Index<'a> {
    Borrowed(&'a QueryIndex),
    Shared(Arc<QueryIndex>, std::marker::PhantomData<&'a World>),
}

impl Deref for Index<'_> {
    type Target = QueryIndex;

    fn deref(&self) -> &QueryIndex {
        match self {
            Self::Borrowed(index) => index,
            Self::Shared(index, _) => index,
        }
    }
}

/// Rays that one thread casts at a time.
const RAYS: usize = 64;
/// A ray, roughly \[us\].
const RAY: f64 = 1.0;

/// What is found, with what decides between those that are equally near.
type Found<H> = (f64, BodyKey, u32, u32, Entity, H);

/// Takes what is nearer, or comes earlier in order.
fn take<H>(first: &mut Option<Found<H>>, found: Found<H>) {
    let is_first = first.as_ref().is_none_or(|first| {
        let (a, b) = (&found, first);
        a.0 < b.0 || (a.0 == b.0 && (a.1, a.2, a.3) < (b.1, b.2, b.3))
    });
    if is_first {
        *first = Some(found);
    }
}

impl<'a> Queries<'a> {
    /// About a world, this one time. A [`Simulation`](crate::Simulation) or a
    /// [`QueryIndex`] keep what is made for it.
    ///
    /// # Panics
    /// Like every query of hecs, while the caller holds a mutable reference to poses, colliders,
    /// centres of mass or ids.
    #[must_use]
    pub fn of(world: &'a World) -> Self {
        let mut index = QueryIndex::default();
        let changes = index.find_changes(world);
        index.apply(world, &changes);
        Self::shared(Arc::new(index))
    }

    pub(crate) fn in_index(index: &'a QueryIndex) -> Self {
        Self { index: Index::Borrowed(index) }
    }

    pub(crate) fn shared(index: Arc<QueryIndex>) -> Self {
        Self { index: Index::Shared(index, std::marker::PhantomData) }
    }

    /// What a ray meets first. Solid shapes are met at no distance by a ray that begins inside;
    /// meshes and height fields are surfaces, and are met from both sides.
    #[doc(alias("raycast", "ray cast", "ray_test"))]
    #[must_use]
    pub fn cast_ray(&self, ray: &Ray, filter: &QueryFilter<'_>) -> Option<RayHit> {
        let ray = ray.wide()?;
        let mut first: Option<Found<ShapeRayHit>> = None;
        self.along_ray(&ray, filter, &mut |object, hit| {
            take(&mut first, (hit.distance, object.key, hit.part, hit.triangle, object.entity, hit));
            first.as_ref().map_or(ray.max_distance(), |first| first.0)
        });
        first.map(|(.., entity, hit)| ray_hit(entity, &hit, &ray))
    }

    /// What each of many rays meets first; in parallel where that is worth it.
    ///
    /// ```
    /// use tumble::{QueryFilter, Ray, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// spawn_ground(&mut world);
    ///
    /// let simulation = Simulation::new(Settings::default())?;
    /// let rays = [1.0, 2.0, 3.0].map(|y| Ray::new(Vec3::Y * y, -Vec3::Y));
    /// let hits = simulation.queries(&world).cast_rays(&rays, &QueryFilter::new());
    /// assert!(hits.iter().map(|hit| hit.unwrap().distance).eq([1.0, 2.0, 3.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "raycast_many")]
    #[must_use]
    pub fn cast_rays(&self, rays: &[Ray], filter: &QueryFilter<'_>) -> Vec<Option<RayHit>> {
        let mut hits = vec![None; rays.len()];
        Effort::of_microseconds(rays.len() as f64 * RAY).run(|| {
            let parts = rays.par_chunks(RAYS).zip(hits.par_chunks_mut(RAYS));
            parts.by_at_least(1).for_each(|(rays, hits)| {
                rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.cast_ray(ray, filter));
            });
        });
        hits
    }

    /// Whether a ray meets anything: whether one point can be seen from another, with
    /// [`Ray::between`].
    #[doc(alias("line of sight", "raycast_any"))]
    #[must_use]
    pub fn is_blocked(&self, ray: &Ray, filter: &QueryFilter<'_>) -> bool {
        let mut is_met = false;
        if let Some(ray) = ray.wide() {
            self.along_ray(&ray, filter, &mut |_, _| {
                is_met = true;
                // Nothing further away is asked for.
                -1.0
            });
        }
        is_met
    }

    /// All that a ray meets, nearest first: each part of a body where the ray enters it, of a mesh
    /// or a height field the first triangle.
    ///
    /// ```
    /// use tumble::{Collider, QueryFilter, Ray, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// for x in [1.0, 2.0, 3.0] {
    ///     let collider = Collider::new(&Shape::sphere(0.25))?;
    ///     let ball = RigidBody::new(Shape::sphere(0.25)).mass(1.0).position(Vec3::X * x);
    ///     ball.build()?.spawn_with(&mut world, (collider,));
    /// }
    /// let simulation = Simulation::new(Settings::default())?;
    /// let ray = Ray::new(Vec3::ZERO, Vec3::X).with_max_distance(2.5);
    /// let hits = simulation.queries(&world).cast_ray_through(&ray, &QueryFilter::new());
    /// assert_eq!(hits.iter().map(|hit| hit.distance).collect::<Vec<_>>(), [0.75, 1.75]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias("raycast_all", "ray_hits", "intersect_ray"))]
    #[must_use]
    pub fn cast_ray_through(&self, ray: &Ray, filter: &QueryFilter<'_>) -> Vec<RayHit> {
        let Some(ray) = ray.wide() else { return Vec::new() };
        let mut found: Vec<Found<ShapeRayHit>> = Vec::new();
        self.along_ray(&ray, filter, &mut |object, hit| {
            found.push((hit.distance, object.key, hit.part, hit.triangle, object.entity, hit));
            ray.max_distance()
        });
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2, a.3).cmp(&(b.1, b.2, b.3))));
        found.iter().map(|(.., entity, hit)| ray_hit(*entity, hit, &ray)).collect()
    }

    /// Shows what a ray meets of each body along it. `visit` returns how far is still asked for.
    fn along_ray(
        &self,
        ray: &tumble_collide::Ray,
        filter: &QueryFilter<'_>,
        visit: &mut dyn FnMut(&Object, ShapeRayHit) -> f64,
    ) {
        let mut most = ray.max_distance();
        let mut ask = |number: u32| {
            if let Some(object) = self.index.object(number, filter) {
                object.for_each_part(filter, |part, shape, at| {
                    if most >= 0.0
                        && let Some(hit) = shape.cast_ray(at, &ray.shortened(most))
                    {
                        most = visit(object, ShapeRayHit { part, ..hit });
                    }
                });
            }
            most
        };
        let tree = self.index.tree();
        for number in tree.endless() {
            ask(*number);
        }
        let zero = tumble_math::lane::Vec3::zero();
        tree.along_ray(ray, zero, &mut |number, _| ask(number));
    }

    /// What a shape meets first that is at a pose, as a body's frame, and is moved by a way \[m\]
    /// without turning. Surfaces are met from both sides. A surface that is moved meets neither
    /// surfaces nor half-spaces; half-spaces are not moved.
    ///
    /// What it overlaps from the beginning it meets at no distance, whichever way it goes; what it
    /// touches and leaves it does not meet.
    #[doc(alias("shapecast", "shape cast", "sweep test", "spherecast"))]
    #[must_use]
    pub fn cast_shape(&self, shape: &Collider, from: &Pose, way: Vec3, filter: &QueryFilter<'_>) -> Option<ShapeHit> {
        let from = placement(shape, from);
        let moved = shape.geometry();
        let aabb = moved.aabb(&narrow(&from), 0.0)?;
        let ray = tumble_collide::Ray::new(from.position, dvec3(way).into(), dvec3(way).length())?;
        // The box around the shape, from its middle.
        let [low, high] = [aabb.low, aabb.high].map(|corner| dvec3(corner.into()));
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let of_box = tumble_collide::Ray::new(middle.into(), ray.direction(), ray.max_distance())?;
        let slack = middle.abs().max_element() + half.max_element();
        let half = half + glam::DVec3::splat(slack * 1e-6);

        let mut first: Option<Found<ShapeCastHit>> = None;
        let mut ask = |number: u32| {
            if let Some(object) = self.index.object(number, filter) {
                object.for_each_part(filter, |part, shape, at| {
                    let most = first.as_ref().map_or(ray.max_distance(), |first| first.0);
                    if let Some(hit) = shape.cast_shape(at, moved, &from, &ray.shortened(most)) {
                        let hit = ShapeCastHit { part, ..hit };
                        take(&mut first, (hit.distance, object.key, part, hit.triangle, object.entity, hit));
                    }
                });
            }
            first.as_ref().map_or(ray.max_distance(), |first| first.0)
        };
        let tree = self.index.tree();
        for number in tree.endless() {
            ask(*number);
        }
        tree.along_ray(&of_box, half.into(), &mut |number, _| ask(number));
        first.map(|(.., entity, hit)| ShapeHit {
            entity,
            part: hit.part,
            triangle: hit.triangle,
            distance: real(hit.distance),
            point: vec3(hit.point.into()),
            normal: vec3(hit.normal.into()),
        })
    }

    /// All that a shape at a pose, as a body's frame, has a point in common with, in the order of
    /// [`BodyOrder`](crate::BodyOrder). Meshes and height fields are surfaces: what is under one
    /// does not overlap it, and they do not overlap each other, nor do half-spaces.
    ///
    /// ```
    /// use tumble::{Collider, QueryFilter, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// let collider = Collider::new(&Shape::sphere(0.5))?;
    /// let ball = RigidBody::new(Shape::sphere(0.5))
    ///     .mass(1.0)
    ///     .build()?
    ///     .spawn_with(&mut world, (collider.clone(),));
    ///
    /// let simulation = Simulation::new(Settings::default())?;
    /// let queries = simulation.queries(&world);
    /// let at = |x| Pose { position: Vec3::X * x, ..Pose::default() };
    /// assert_eq!(queries.overlapping(&collider, &at(0.9), &QueryFilter::new())[0].entity, ball);
    /// assert!(queries.overlapping(&collider, &at(1.1), &QueryFilter::new()).is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias("intersect_shape", "overlap test"))]
    #[must_use]
    pub fn overlapping(&self, shape: &Collider, at: &Pose, filter: &QueryFilter<'_>) -> Vec<PartHit> {
        let at = placement(shape, at);
        let geometry = shape.geometry();
        let narrow_at = narrow(&at);
        let size = [narrow_at.position.x, narrow_at.position.y, narrow_at.position.z].map(Real::abs);
        let margin = (size[0].max(size[1]).max(size[2]) + geometry.reach().unwrap_or(0.0)) * 8.0 * Real::EPSILON;
        let touches = |shape: &ColliderShape, placed: &Isometry<f64>| shape.overlap(placed, geometry, &at).is_some();
        match geometry.aabb(&narrow_at, margin) {
            Some(aabb) => self.parts_in(Some(&aabb), filter, touches),
            None => self.parts_in(None, filter, touches),
        }
    }

    /// All that a point \[m\] is inside of, in the order of [`BodyOrder`](crate::BodyOrder). Meshes
    /// and height fields, which are surfaces, have no inside.
    #[doc(alias("intersect_point", "point_intersections", "pick"))]
    #[must_use]
    pub fn containing(&self, point: Vec3, filter: &QueryFilter<'_>) -> Vec<PartHit> {
        let aabb = Aabb { low: point.into(), high: point.into() };
        let point = dvec3(point).into();
        self.parts_in(Some(&aabb), filter, |shape, at| shape.contains(at, point))
    }

    /// The bodies whose boxes along the world's axes meet a box with these corners \[m\], in the
    /// order of [`BodyOrder`](crate::BodyOrder); half-spaces always do.
    ///
    /// ```
    /// use tumble::{Collider, QueryFilter, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// let collider = Collider::new(&Shape::sphere(0.5))?;
    /// let ball = RigidBody::new(Shape::sphere(0.5))
    ///     .mass(1.0)
    ///     .build()?
    ///     .spawn_with(&mut world, (collider,));
    ///
    /// let simulation = Simulation::new(Settings::default())?;
    /// let found = simulation.queries(&world).in_box(
    ///     Vec3::splat(0.4),
    ///     Vec3::splat(2.0),
    ///     &QueryFilter::new(),
    /// );
    /// assert_eq!(found, [ball]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias("aabb query", "intersect_aabb"))]
    #[must_use]
    pub fn in_box(&self, low: Vec3, high: Vec3, filter: &QueryFilter<'_>) -> Vec<Entity> {
        let aabb = Aabb { low: low.into(), high: high.into() };
        let mut found = self.parts_in(Some(&aabb), filter, |_, _| true);
        found.dedup_by_key(|part| part.entity);
        found.into_iter().map(|part| part.entity).collect()
    }

    /// The parts of bodies whose boxes meet a box, or of all without one, for which a test is true.
    fn parts_in(
        &self,
        aabb: Option<&Aabb<Real>>,
        filter: &QueryFilter<'_>,
        test: impl Fn(&ColliderShape, &Isometry<f64>) -> bool,
    ) -> Vec<PartHit> {
        let mut found: Vec<(BodyKey, PartHit)> = Vec::new();
        let mut ask = |number: u32| {
            let Some(object) = self.index.object(number, filter) else { return };
            object.for_each_part(filter, |part, shape, at| {
                if test(shape, at) {
                    found.push((object.key, PartHit { entity: object.entity, part }));
                }
            });
        };
        let tree = self.index.tree();
        tree.endless().iter().for_each(|number| ask(*number));
        match aabb {
            Some(aabb) => tree.meeting(aabb, &mut ask),
            None => tree.meeting(&EVERYWHERE, &mut ask),
        }
        found.sort_by_key(|(key, part)| (*key, part.entity.id(), part.part));
        found.into_iter().map(|(_, part)| part).collect()
    }

    /// What is nearest to a point, if it is not further away than this \[m\].
    #[doc(alias("project_point", "closest point"))]
    #[must_use]
    pub fn nearest(&self, point: Vec3, max_distance: Real, filter: &QueryFilter<'_>) -> Option<PointHit> {
        let (place, max) = (dvec3(point), f64::from(max_distance));
        if !place.is_finite() || max.is_nan() || max < 0.0 {
            return None;
        }
        let mut first: Option<Found<NearestPoint>> = None;
        let mut ask = |number: u32| {
            if let Some(object) = self.index.object(number, filter) {
                object.for_each_part(filter, |part, shape, at| {
                    let most = first.as_ref().map_or(max, |first| first.0);
                    if let Some(found) = shape.nearest_point(at, place.into(), most) {
                        let found = NearestPoint { part, ..found };
                        take(&mut first, (found.distance, object.key, part, found.triangle, object.entity, found));
                    }
                });
            }
            first.as_ref().map_or(max, |first| first.0)
        };
        let tree = self.index.tree();
        for number in tree.endless() {
            ask(*number);
        }
        tree.around(place.into(), max, &mut |number, _| ask(number));
        first.map(|(.., entity, found)| PointHit {
            entity,
            part: found.part,
            triangle: found.triangle,
            distance: real(found.distance),
            point: if found.distance == 0.0 { point } else { vec3(found.point.into()) },
        })
    }
}

/// The box in which everything is.
const EVERYWHERE: Aabb<Real> = {
    let end = Real::INFINITY;
    Aabb {
        low: tumble_math::lane::Vec3 { x: -end, y: -end, z: -end },
        high: tumble_math::lane::Vec3 { x: end, y: end, z: end },
    }
};

/// Where the shape of a collider is, of a body at a pose.
fn placement(collider: &Collider, at: &Pose) -> Isometry<f64> {
    let orientation = tumble_math::lane::Quat::<f64>::from(dquat(at.orientation)).normalize();
    let body = Isometry { position: dvec3(at.position).into(), orientation };
    collider.place().map_or(body, |offset| body.then(&wide(&offset)))
}

fn ray_hit(entity: Entity, hit: &ShapeRayHit, ray: &tumble_collide::Ray) -> RayHit {
    RayHit {
        entity,
        part: hit.part,
        triangle: hit.triangle,
        distance: real(hit.distance),
        point: vec3(ray.at(hit.distance).into()),
        normal: vec3(hit.normal.into()),
    }
}
