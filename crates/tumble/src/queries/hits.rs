//! What queries find.

use hecs::Entity;

use crate::math::{Real, Vec3};

/// What a ray meets first of a body.
///
/// ```
/// use tumble::{QueryFilter, Ray, prelude::*};
///
/// let mut world = hecs::World::new();
/// let wall = RigidBody::new(Shape::cuboid([1.0, 1.0, 1.0]))
///     .fixed()
///     .position(Vec3::X * 5.0)
///     .build()?
///     .spawn(&mut world);
///
/// let simulation = Simulation::new(Settings::default())?;
/// let hit = simulation
///     .queries(&world)
///     .cast_ray(&Ray::new(Vec3::ZERO, Vec3::X), &QueryFilter::new())
///     .unwrap();
/// assert_eq!((hit.entity, hit.distance), (wall, 4.0));
/// assert_eq!((hit.point, hit.normal), (Vec3::X * 4.0, -Vec3::X));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "raycast hit")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RayHit {
    /// The body.
    pub entity: Entity,
    /// Of a compound collider, which of its parts, from zero on; otherwise zero.
    pub part: u32,
    /// Of a mesh or a height field, which of its triangles; otherwise zero.
    pub triangle: u32,
    /// From the ray's origin \[m\]; zero where that is inside.
    pub distance: Real,
    /// Where it is met, world frame \[m\].
    pub point: Vec3,
    /// Of the surface, against the ray; unit vector, world frame. Where the origin is inside, the
    /// direction back along the ray.
    pub normal: Vec3,
}

/// What a shape is stopped by that is moved along a straight line.
///
/// ```
/// use tumble::{Collider, QueryFilter, prelude::*};
///
/// let mut world = hecs::World::new();
/// let ground = spawn_ground(&mut world);
///
/// let simulation = Simulation::new(Settings::default())?;
/// let (ball, from) =
///     (Collider::new(&Shape::sphere(0.5))?, Pose { position: Vec3::Y * 3.0, ..Pose::default() });
/// let hit = simulation
///     .queries(&world)
///     .cast_shape(&ball, &from, Vec3::Y * -10.0, &QueryFilter::new())
///     .unwrap();
/// assert_eq!((hit.entity, hit.distance, hit.normal), (ground, 2.5, Vec3::Y));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("shapecast hit", "time of impact", "toi"))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShapeHit {
    /// The body that is met.
    pub entity: Entity,
    /// Of a compound collider that is met, which of its parts, from zero on; otherwise zero.
    pub part: u32,
    /// Of a mesh or a height field that is met, which of its triangles; otherwise zero.
    pub triangle: u32,
    /// How far the shape goes \[m\]; zero where both overlap from the beginning.
    pub distance: Real,
    /// Where they touch then, world frame \[m\].
    pub point: Vec3,
    /// Of the surface that is met, towards the shape; unit vector, world frame. Where both overlap
    /// from the beginning, the shortest way out.
    pub normal: Vec3,
}

/// What is nearest to a point of a body.
///
/// ```
/// use tumble::{Collider, QueryFilter, prelude::*};
///
/// let mut world = hecs::World::new();
/// let ball = Collider::new(&Shape::sphere(0.5))?;
/// let body =
///     RigidBody::new(Shape::sphere(0.5)).mass(1.0).build()?.spawn_with(&mut world, (ball,));
///
/// let simulation = Simulation::new(Settings::default())?;
/// let hit = simulation.queries(&world).nearest(Vec3::X * 2.0, 10.0, &QueryFilter::new()).unwrap();
/// assert_eq!((hit.entity, hit.distance, hit.point), (body, 1.5, Vec3::X * 0.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PointHit {
    /// The body.
    pub entity: Entity,
    /// Of a compound collider, which of its parts, from zero on; otherwise zero.
    pub part: u32,
    /// Of a mesh or a height field, which of its triangles; otherwise zero.
    pub triangle: u32,
    /// From the point to the body \[m\]; zero inside.
    pub distance: Real,
    /// The nearest point of the body, world frame \[m\]; the point itself where that is inside.
    pub point: Vec3,
}

/// A body, and which part of its collider.
///
/// ```
/// use tumble::{Collider, QueryFilter, prelude::*};
///
/// let mut world = hecs::World::new();
/// let ball = Collider::new(&Shape::sphere(0.5))?;
/// let body =
///     RigidBody::new(Shape::sphere(0.5)).mass(1.0).build()?.spawn_with(&mut world, (ball,));
///
/// let simulation = Simulation::new(Settings::default())?;
/// let hits = simulation.queries(&world).containing(Vec3::X * 0.4, &QueryFilter::new());
/// assert_eq!((hits.len(), hits[0].entity, hits[0].part), (1, body, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PartHit {
    /// The body.
    pub entity: Entity,
    /// Of a compound collider, which of its parts, from zero on; otherwise zero.
    pub part: u32,
}
