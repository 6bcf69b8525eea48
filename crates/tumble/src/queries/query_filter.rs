//! Which bodies a query is about.

use std::fmt;

use hecs::Entity;

use crate::collision::collider::{Collider, Groups};
use crate::components::BodyKind;

/// Which bodies a query is about: without anything said, all that have a collider that is no
/// sensor.
///
/// ```
/// use tumble::{Collider, QueryFilter, Ray, prelude::*};
///
/// let mut world = hecs::World::new();
/// let collider = Collider::new(&Shape::sphere(0.5))?;
/// let ball = |x: Real| RigidBody::new(Shape::sphere(0.5)).mass(1.0).position(Vec3::X * x).build();
/// let shooter = ball(0.0)?.spawn_with(&mut world, (collider.clone(),));
/// let friend = ball(3.0)?.spawn_with(&mut world, (collider.clone(),));
/// let target = ball(6.0)?.spawn_with(&mut world, (collider,));
///
/// let simulation = Simulation::new(Settings::default())?;
/// let queries = simulation.queries(&world);
/// let ray = Ray::new(Vec3::ZERO, Vec3::X);
/// let first = |filter: &QueryFilter<'_>| queries.cast_ray(&ray, filter).map(|hit| hit.entity);
/// assert_eq!(first(&QueryFilter::new()), Some(shooter));
/// assert_eq!(first(&QueryFilter::new().without(shooter)), Some(friend));
/// assert_eq!(first(&QueryFilter::new().matching(&|entity| entity == target)), Some(target));
/// assert_eq!(first(&QueryFilter::new().without_dynamic()), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("SpatialQueryFilter", "mask"))]
#[derive(Clone, Copy)]
pub struct QueryFilter<'a> {
    groups: Groups,
    without: Option<Entity>,
    without_all: &'a [Entity],
    kinds: [bool; BodyKind::ALL.len()],
    /// Whether what is solid is let through, and sensors are.
    roles: [bool; 2],
    matching: Option<&'a (dyn Fn(Entity) -> bool + Sync)>,
}

impl Default for QueryFilter<'_> {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Debug for QueryFilter<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { groups, without, without_all, kinds, roles, matching } = self;
        f.debug_struct("QueryFilter")
            .field("groups", groups)
            .field("without", without)
            .field("without_all", without_all)
            .field("kinds", kinds)
            .field("roles", roles)
            .field("matching", &matching.is_some())
            .finish()
    }
}

impl<'a> QueryFilter<'a> {
    /// All bodies, without sensors.
    pub const ALL: Self = Self {
        groups: Groups::ALL,
        without: None,
        without_all: &[],
        kinds: [true; BodyKind::ALL.len()],
        roles: [true, false],
        matching: None,
    };

    /// All bodies, without sensors.
    #[must_use]
    pub fn new() -> Self {
        Self::ALL
    }

    /// What the query is, and what it is about, as [`Collider::with_groups`] has it of a collider:
    /// those are found that would touch a collider with these groups.
    ///
    /// [`Collider::with_groups`]: crate::Collider::with_groups
    #[doc(alias("collision layers", "mask"))]
    #[must_use]
    pub fn with_groups(self, membership: u32, filter: u32) -> Self {
        Self { groups: Groups::new(membership, filter), ..self }
    }

    /// All but one: the one who shoots, for example.
    #[must_use]
    pub fn without(self, entity: Entity) -> Self {
        Self { without: Some(entity), ..self }
    }

    /// All but these.
    #[must_use]
    pub fn without_all(self, entities: &'a [Entity]) -> Self {
        Self { without_all: entities, ..self }
    }

    /// No [dynamic](BodyKind::Moving) bodies.
    #[must_use]
    pub fn without_dynamic(self) -> Self {
        self.without_kind(BodyKind::Moving)
    }

    /// No [kinematic](BodyKind::Kinematic) bodies.
    #[must_use]
    pub fn without_kinematic(self) -> Self {
        self.without_kind(BodyKind::Kinematic)
    }

    /// No [fixed](BodyKind::Fixed) bodies.
    #[must_use]
    pub fn without_fixed(self) -> Self {
        self.without_kind(BodyKind::Fixed)
    }

    fn without_kind(mut self, kind: BodyKind) -> Self {
        self.kinds[kind as usize] = false;
        self
    }

    /// [Sensors](crate::Collider::sensor) too.
    #[doc(alias = "trigger")]
    #[must_use]
    pub fn with_sensors(self) -> Self {
        Self { roles: [true; 2], ..self }
    }

    /// [Sensors](crate::Collider::sensor) and nothing else.
    ///
    /// ```
    /// use tumble::{Collider, Queries, QueryFilter, Ray, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// let sensor = Collider::new(&Shape::sphere(1.0))?.sensor();
    /// RigidBody::new(Shape::sphere(1.0)).fixed().build()?.spawn_with(&mut world, (sensor,));
    /// let (queries, ray) = (Queries::of(&world), Ray::new(Vec3::X * 3.0, -Vec3::X));
    /// assert!(queries.cast_ray(&ray, &QueryFilter::new()).is_none());
    /// assert!(queries.cast_ray(&ray, &QueryFilter::new().only_sensors()).is_some());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn only_sensors(self) -> Self {
        Self { roles: [false, true], ..self }
    }

    /// Only those for which a closure is true, of those that all else lets through. It is asked on
    /// any thread, and of a body as often as a query meets a part of it.
    #[must_use]
    pub fn matching(self, matching: &'a (dyn Fn(Entity) -> bool + Sync)) -> Self {
        Self { matching: Some(matching), ..self }
    }

    pub(crate) fn lets_through(&self, entity: Entity, kind: BodyKind) -> bool {
        self.kinds[kind as usize]
            && self.without != Some(entity)
            && !self.without_all.contains(&entity)
            && self.matching.is_none_or(|matching| matching(entity))
    }

    /// Whether any part of a collider may be let through.
    pub(crate) fn lets_any_through(&self, collider: &Collider) -> bool {
        let roles = [!collider.is_sensor(), collider.has_sensor()];
        self.groups.touch(collider.filter_groups()) && (0..2).any(|role| self.roles[role] && roles[role])
    }

    pub(crate) fn lets_part_through(&self, groups: Groups, is_sensor: bool) -> bool {
        self.roles[usize::from(is_sensor)] && self.groups.touch(groups)
    }
}
