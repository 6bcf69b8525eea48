//! The collider component: shape, offset, surface material and collision groups.

use std::sync::Arc;

use glam::DVec3;
use tumble_collide::{HeightField, Isometry, Mesh};
use tumble_math::Shape;
use tumble_math::lane::Quat;

use crate::collision::collider_error::ColliderError;
use crate::collision::collider_shape;
use crate::collision::collider_shape::ColliderShape;
use crate::collision::compound_parts::PartSurface;
use crate::collision::material::Material;
use crate::components::Pose;
use crate::math::Real;
use crate::range::{LENGTHS, within};

/// The shape by which a body collides, and its surface. A component of anything that has a
/// [`Pose`](crate::Pose).
///
/// The shape is in the body's own frame, or at a [place](Self::with_offset) in it. A body with
/// [`Momentum`](crate::Momentum) is pushed, one with a [`Velocity`](crate::Velocity) and no
/// momentum pushes and is not pushed, and one with neither is ground.
///
/// ```
/// use tumble::{Collider, prelude::*};
///
/// let mut world = hecs::World::new();
/// world.spawn((Pose::default(), Collider::half_space())); // what spawn_ground does
///
/// // RigidBody gives it the collider of its shape.
/// let crate_of_tea = RigidBody::new(Shape::cuboid([0.5, 0.25, 0.5])).mass(10.0).position(Vec3::Y);
/// let crate_of_tea = crate_of_tea.build()?.spawn(&mut world);
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// for _ in 0..120 {
///     simulation.step(&mut world);
/// }
/// // It fell on the ground and lies there.
/// let height = world.get::<&Pose>(crate_of_tea)?.position.y;
/// assert!((height - 0.25).abs() < 1e-3, "{height}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("collision shape", "hitbox"))]
#[derive(Clone, Debug, PartialEq)]
pub struct Collider {
    /// Shared by all copies, so that it is seen at once whether a collider is still the same.
    properties: Arc<Properties>,
}

#[derive(Clone, Debug, PartialEq)]
struct Properties {
    geometry: ColliderShape,
    material: Material,
    /// Where the shape is in the body's frame; `None` where that is its own.
    offset: Option<Isometry<Real>>,
    groups: Groups,
    /// Whether it only senses what is in it, and pushes nothing.
    is_sensor: bool,
    /// Of a compound of colliders, what its parts have.
    parts: Option<Arc<[PartSurface]>>,
}

/// Collision groups as bits: memberships and filter. Two colliders touch if each is a member of a
/// group in the other's filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Groups {
    membership: u32,
    filter: u32,
}

impl Groups {
    pub(crate) const ALL: Self = Self { membership: u32::MAX, filter: u32::MAX };

    pub(crate) fn new(membership: u32, filter: u32) -> Self {
        Self { membership, filter }
    }

    /// Membership and filter.
    pub(crate) fn bits(self) -> (u32, u32) {
        (self.membership, self.filter)
    }

    /// The union of both.
    pub(crate) fn with(self, other: Self) -> Self {
        Self { membership: self.membership | other.membership, filter: self.filter | other.filter }
    }

    pub(crate) fn touch(self, other: Self) -> bool {
        self.membership & other.filter != 0 && other.membership & self.filter != 0
    }
}

impl Collider {
    /// A collider of a body's shape, with the [default](Material::default) surface.
    ///
    /// Everything but a [`Point`](Shape::Point) can be touched; in a compound, points are left out.
    /// A [`Mesh`](Shape::Mesh) is touched as its convex hull: what moves has to be solid to
    /// everything. [`mesh`](Self::mesh) is its surface as it is. Cylinders, cones, frustums,
    /// capsules and ellipsoids are round, not cut out of planes.
    ///
    /// # Errors
    /// [`ColliderError`] for points, lengths that are none, and meshes without a volume; in a
    /// compound it names the part.
    pub fn new(shape: &Shape) -> Result<Self, ColliderError> {
        Ok(Self::of(collider_shape::of_shape(shape)?))
    }

    /// All that is below the plane y = 0 of the body's frame: infinite ground. Nothing with
    /// momentum should have it.
    #[doc(alias("plane", "floor", "ground"))]
    #[must_use]
    pub fn half_space() -> Self {
        Self::of(ColliderShape::HalfSpace)
    }

    /// The convex hull of points \[m\].
    ///
    /// ```
    /// use tumble::{Collider, ColliderError, HullError, math::Vec3};
    ///
    /// let wedge = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::X + Vec3::Z];
    /// assert!(Collider::convex_hull(wedge).is_ok());
    /// let error = Collider::convex_hull([Vec3::ZERO, Vec3::X, Vec3::Y]).unwrap_err();
    /// assert_eq!(error, ColliderError::Hull(HullError::TooFew { count: 3 }));
    /// ```
    ///
    /// # Errors
    /// [`ColliderError::Hull`] says which point is not finite, or that there are too few or all lie
    /// in one plane.
    pub fn convex_hull(points: impl IntoIterator<Item = impl Into<DVec3>>) -> Result<Self, ColliderError> {
        let points: Vec<DVec3> = points.into_iter().map(Into::into).collect();
        Ok(Self::of(collider_shape::hull(&points)?))
    }

    /// The surface of triangles: vertices \[m\] and, for each triangle, the indices of its corners,
    /// counter-clockwise as seen from outside.
    ///
    /// It is touched from outside only, by everything but other surfaces, so it is for ground and
    /// for what is carried about, and not for bodies that are to bump into each other. Where
    /// triangles lie in one plane or make a hollow, nothing stumbles over the edges between them.
    ///
    /// ```
    /// use tumble::{Collider, ColliderError, MeshError, math::Vec3};
    ///
    /// let corners = [Vec3::ZERO, Vec3::Z, Vec3::X];
    /// assert!(Collider::mesh(corners, &[[0, 1, 2]]).is_ok());
    /// let error = Collider::mesh(corners, &[[0, 1, 3]]).unwrap_err();
    /// assert_eq!(
    ///     error,
    ///     ColliderError::Mesh(MeshError::Index { triangle: 0, index: 3, vertices: 3 })
    /// );
    /// ```
    ///
    /// # Errors
    /// [`ColliderError::Mesh`] names the vertex that is not finite or the triangle with an index
    /// out of range.
    #[doc(alias("trimesh", "triangle mesh"))]
    pub fn mesh(
        vertices: impl IntoIterator<Item = impl Into<DVec3>>,
        triangles: &[[u32; 3]],
    ) -> Result<Self, ColliderError> {
        let vertices: Vec<_> = vertices.into_iter().map(|vertex| Into::<DVec3>::into(vertex).into()).collect();
        let mesh = Mesh::new(&vertices, triangles)?;
        Ok(Self::of(collider_shape::checked(ColliderShape::Mesh(Arc::new(mesh)))?))
    }

    /// Ground given by its heights \[m\] over a grid, row by row, `columns` of them in a row. y is
    /// up, rows run along x and follow each other along z, `spacing` \[m\] apart in x and z, and
    /// the origin is in the middle of the grid.
    ///
    /// It is touched from above only, as a [`mesh`](Self::mesh) is from outside.
    ///
    /// ```
    /// use tumble::Collider;
    ///
    /// let waves: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i % 10)).collect();
    /// assert!(Collider::height_field(&waves, 10, [0.5, 0.5]).is_ok());
    /// let error = Collider::height_field(&waves, 30, [0.5, 0.5]).unwrap_err();
    /// assert_eq!(error.to_string(), "100 heights are no two full rows of 30");
    /// ```
    ///
    /// # Errors
    /// [`ColliderError::HeightField`] says which number is wrong, or that rows are not full.
    #[doc(alias("heightmap", "terrain"))]
    pub fn height_field(heights: impl AsRef<[f64]>, columns: usize, spacing: [f64; 2]) -> Result<Self, ColliderError> {
        let field = HeightField::new(heights, columns, spacing)?;
        Ok(Self::of(collider_shape::checked(ColliderShape::HeightField(Arc::new(field)))?))
    }

    /// The same with another surface.
    ///
    /// # Errors
    /// [`ColliderError::Material`] for coefficients that are negative or not a number, and a
    /// restitution of more than one.
    pub fn with_material(self, material: Material) -> Result<Self, ColliderError> {
        material.check()?;
        let parts = self.changed_parts(|part| PartSurface { material, ..part });
        Ok(self.changed(|it| (it.material, it.parts) = (material, parts)))
    }

    /// The same at another place: a pose of the shape's frame in the body's, in place of the one it
    /// has. A body's frame is that of its own shape, whatever its centre of mass.
    ///
    /// ```
    /// use tumble::{Collider, Pose, Shape, math::Vec3};
    ///
    /// let foot = Collider::new(&Shape::sphere(0.1))?.with_offset(Pose::at(Vec3::Y * -0.5))?;
    /// # Ok::<(), tumble::ColliderError>(())
    /// ```
    ///
    /// # Errors
    /// [`ColliderError::Offset`] if the position is not finite or further than 1e9 m, or the
    /// orientation not about a unit quaternion.
    #[doc(alias = "local pose")]
    pub fn with_offset(self, offset: Pose) -> Result<Self, ColliderError> {
        let orientation = Quat::<Real>::from(offset.orientation);
        let length = orientation.length_squared();
        if !within(offset.position.into(), *LENGTHS.end()) || !(0.5..2.0).contains(&length) {
            return Err(ColliderError::Offset { offset });
        }
        let offset = Isometry { position: offset.position.into(), orientation: orientation.normalize() };
        Ok(self.changed(|it| it.offset = Some(offset)))
    }

    /// The same with groups: what the collider is, and what it touches, each a set of up to 32
    /// bits. Two colliders touch if each is something that the other touches. Without groups a
    /// collider is everything and touches everything.
    ///
    /// ```
    /// use tumble::{Collider, Shape};
    ///
    /// const PLAYER: u32 = 1;
    /// const SHOT: u32 = 2;
    /// // Shots go through each other.
    /// let shot = Collider::new(&Shape::sphere(0.1))?.with_groups(SHOT, !SHOT);
    /// assert_eq!(shot.groups(), (SHOT, !SHOT));
    /// # Ok::<(), tumble::ColliderError>(())
    /// ```
    #[doc(alias("collision layers", "collision groups", "collision mask", "CollisionLayers"))]
    #[must_use]
    pub fn with_groups(self, membership: u32, filter: u32) -> Self {
        let groups = Groups { membership, filter };
        let parts = self.changed_parts(|part| PartSurface { groups, ..part });
        self.changed(|it| (it.groups, it.parts) = (groups, parts))
    }

    /// The same as a sensor: nothing is pushed by it or pushes it, and
    /// [`Simulation::sensor_events`](crate::Simulation::sensor_events) tells what comes into it and
    /// what leaves. Queries pass it over unless asked for sensors.
    ///
    /// Sensors do not sense each other, and fixed ones do not sense fixed bodies. In a
    /// [compound](Self::compound) some parts may be sensors; called on the whole, all are. Meshes
    /// and height fields are surfaces: as sensors they sense what crosses them.
    ///
    /// ```
    /// use tumble::{SensorEvent, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// let plate = RigidBody::new(Shape::cuboid([1.0, 0.1, 1.0])).fixed().sensor().build()?;
    /// let plate = plate.spawn(&mut world);
    /// let ball = RigidBody::new(Shape::sphere(0.2)).mass(1.0).position(Vec3::Y).build()?;
    /// let ball = ball.spawn(&mut world);
    ///
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.step_many(&mut world, 60);
    /// let events: Vec<_> = simulation.sensor_events().collect();
    /// let it = SensorEvent { sensor: plate, part: 0, body: ball, begins: true };
    /// assert_eq!(events, [it, SensorEvent { begins: false, ..it }]); // it fell through
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias("trigger", "is_trigger"))]
    #[must_use]
    pub fn sensor(self) -> Self {
        let parts = self.changed_parts(|part| PartSurface { is_sensor: true, ..part });
        self.changed(|it| (it.is_sensor, it.parts) = (true, parts))
    }

    /// Whether it, or all of its parts, are [sensors](Self::sensor).
    #[must_use]
    pub fn is_sensor(&self) -> bool {
        self.properties.is_sensor
    }

    /// Its surface; of [several colliders](Self::compound) the first one's.
    #[must_use]
    pub fn material(&self) -> &Material {
        &self.properties.material
    }

    /// Its collision groups; of [several colliders](Self::compound) the union of theirs.
    #[must_use]
    pub fn groups(&self) -> (u32, u32) {
        self.properties.groups.bits()
    }

    pub(crate) fn geometry(&self) -> &ColliderShape {
        &self.properties.geometry
    }

    /// Whether it is the other one, or a copy of it: what was made separately is another, even
    /// where it is equal.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.properties, &other.properties)
    }

    /// Whether any of it is a sensor.
    pub(crate) fn has_sensor(&self) -> bool {
        self.is_sensor() || self.surfaces().iter().any(|part| part.is_sensor)
    }

    fn changed(mut self, change: impl FnOnce(&mut Properties)) -> Self {
        change(Arc::make_mut(&mut self.properties));
        self
    }

    pub(crate) fn filter_groups(&self) -> Groups {
        self.properties.groups
    }

    /// Where the shape is, for a body whose frame is there.
    pub(crate) fn placement(&self, body: Isometry<Real>) -> Isometry<Real> {
        self.properties.offset.as_ref().map_or(body, |offset| body.then(offset))
    }

    pub(crate) fn place(&self) -> Option<Isometry<Real>> {
        self.properties.offset
    }

    /// The surfaces of its parts, if they have their own.
    pub(crate) fn surfaces(&self) -> &[PartSurface] {
        self.properties.parts.as_deref().unwrap_or_default()
    }

    fn changed_parts(&self, change: impl Fn(PartSurface) -> PartSurface) -> Option<Arc<[PartSurface]>> {
        self.properties.parts.as_ref().map(|parts| parts.iter().cloned().map(change).collect())
    }

    pub(crate) fn of_parts(
        geometry: ColliderShape,
        material: Material,
        groups: Groups,
        parts: Arc<[PartSurface]>,
    ) -> Self {
        let is_sensor = parts.iter().all(|part| part.is_sensor);
        let parts = Some(parts);
        Self { properties: Arc::new(Properties { geometry, material, offset: None, groups, is_sensor, parts }) }
    }

    fn of(geometry: ColliderShape) -> Self {
        let (material, groups) = (Material::default(), Groups::ALL);
        let is_sensor = false;
        Self { properties: Arc::new(Properties { geometry, material, offset: None, groups, is_sensor, parts: None }) }
    }
}
