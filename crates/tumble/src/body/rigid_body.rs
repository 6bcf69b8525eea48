//! The rigid-body builder: shape, mass properties, motion type, initial state and validation.

use glam::{DQuat, DVec3};
use tumble_math::{Amount, InertiaTensor, MassProperties, PrincipalInertia, Shape};

use crate::body::body_error::BodyError;
use crate::body::bundle::Body;
use crate::collision::collider::Collider;
use crate::collision::collider_error::ColliderError;
use crate::collision::material::Material;
use crate::components::{
    BodyId, CenterOfMass, Damping, GravityScale, Inertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Velocity,
    Wrench,
};
use crate::math::{Quat, Real, Vec3, dquat, dvec3, quat, vec3};
use crate::range;
use crate::range::{MAX_DISTANCE, MAX_SPEED};

/// Whether a body is dynamic, kinematic or fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MotionType {
    /// Forces move it.
    Dynamic,
    /// It moves with a prescribed velocity.
    Kinematic,
    /// It does not move.
    Fixed,
}

/// What a body collides with others by.
#[derive(Clone, Debug)]
enum ColliderChoice {
    /// Its shape, if that has a surface.
    Shape,
    /// This collider.
    Given(Collider),
    /// Nothing: others pass through it.
    None,
}

/// A rigid body to be: says what it is made of and how it moves, and [`build`](Self::build) checks
/// it all and makes the components.
///
/// It collides: the [`Collider`] is that of its shape, unless it is given
/// [another](Self::collider) or [none](Self::without_collider). A [`Point`](Shape::Point) has no
/// surface and so no collider, and a [`Mesh`](Shape::Mesh) is touched as its convex hull. Colliders
/// have lengths from 1e-9 to 1e9 m; a larger body, such as a star, is made without one.
///
/// ```
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// spawn_ground(&mut world);
/// let can = RigidBody::new(Shape::cylinder(0.05, 0.2))
///     .density(800.0)
///     .material(Material::default().with_friction(0.3))
///     .position(Vec3::Y)
///     .build()?
///     .spawn(&mut world);
/// assert!(world.get::<&Mass>(can)?.kilograms() > 2.5);
/// Simulation::new(Settings::default())?.step_many(&mut world, 120);
/// assert!((world.get::<&Pose>(can)?.position.y - 0.2).abs() < 1e-3); // it stands on the ground
///
/// let error = RigidBody::new(Shape::sphere(0.5)).mass(-1.0).build().unwrap_err();
/// assert_eq!(
///     (error.field().as_str(), error.to_string().as_str()),
///     ("mass", "mass must be positive, it is -1.0")
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "body builder")]
#[derive(Clone, Debug)]
#[must_use]
pub struct RigidBody {
    shape: Shape,
    motion: MotionType,
    amount: Option<Amount>,
    inertia: Option<PrincipalInertia>,
    center_of_mass: Option<DVec3>,
    position: Vec3,
    orientation: Quat,
    linear_velocity: Vec3,
    angular_velocity: Vec3,
    gravity_scale: Option<Real>,
    damping: Option<Damping>,
    interpolated: bool,
    id: Option<BodyId>,
    collider: ColliderChoice,
    material: Option<Material>,
    /// Membership and filter.
    groups: Option<(u32, u32)>,
    is_sensor: bool,
}

impl RigidBody {
    /// A body of this shape, at rest at the world's origin, that moves as forces make it and
    /// collides. It needs a mass or a density.
    pub fn new(shape: Shape) -> Self {
        Self {
            shape,
            motion: MotionType::Dynamic,
            amount: None,
            inertia: None,
            center_of_mass: None,
            position: Vec3::ZERO,
            orientation: Quat::IDENTITY,
            linear_velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            gravity_scale: None,
            damping: None,
            interpolated: false,
            id: None,
            collider: ColliderChoice::Shape,
            material: None,
            groups: None,
            is_sensor: false,
        }
    }

    /// Infinite ground: a fixed body that fills everything below the plane y = 0 of its frame.
    /// [`spawn_ground`](crate::spawn_ground) spawns one where it is most often wanted.
    ///
    /// ```
    /// use tumble::math::Quat;
    /// use tumble::prelude::*;
    ///
    /// let mut world = hecs::World::new();
    /// // A slope of ice that falls off along x.
    /// let slope = RigidBody::ground()
    ///     .orientation(Quat::from_rotation_z(-0.3))
    ///     .material(Material::default().with_friction(0.02))
    ///     .build()?;
    /// slope.spawn(&mut world);
    /// # Ok::<(), tumble::BodyError>(())
    /// ```
    #[doc(alias("floor", "plane", "half space"))]
    pub fn ground() -> Self {
        Self::new(Shape::Point).fixed().collider(Collider::half_space())
    }

    /// Makes it a body that does not move. It needs no mass.
    #[doc(alias = "static")]
    pub fn fixed(self) -> Self {
        Self { motion: MotionType::Fixed, ..self }
    }

    /// Makes it a body that moves with the velocities it is given, whatever pushes it. It needs no
    /// mass; it turns about the origin of its frame, or about the
    /// [`center_of_mass`](Self::center_of_mass) that it is given.
    #[doc(alias("KinematicVelocityBased", "moving platform"))]
    pub fn kinematic(self) -> Self {
        Self { motion: MotionType::Kinematic, ..self }
    }

    /// Its mass \[kg\]. Replaces a density.
    pub fn mass(self, kilograms: impl Into<f64>) -> Self {
        Self { amount: Some(Amount::Mass(kilograms.into())), ..self }
    }

    /// Its density [kg/m^3]. Replaces a mass.
    pub fn density(self, density: impl Into<f64>) -> Self {
        Self { amount: Some(Amount::Density(density.into())), ..self }
    }

    /// Its inertia tensor about the centre of mass [kg m^2], in its own frame, instead of the
    /// shape's. One that was accepted [with a tolerance](InertiaTensor::within_tolerance) moves as
    /// its [`nearest_possible`](InertiaTensor::nearest_possible).
    pub fn inertia(self, inertia: InertiaTensor) -> Self {
        self.principal_inertia(inertia.nearest_possible().principal())
    }

    /// Its principal moments about the centre of mass [kg m^2] and principal axes, instead of the
    /// shape's.
    pub fn principal_inertia(self, inertia: PrincipalInertia) -> Self {
        Self { inertia: Some(inertia), ..self }
    }

    /// Where its centre of mass is in its own frame \[m\], instead of the shape's. Its inertia
    /// about the centre of mass stays what it is.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// let weeble = RigidBody::new(Shape::sphere(0.1))
    ///     .mass(0.3)
    ///     .center_of_mass([0.0, -0.06, 0.0])
    ///     .build()?;
    /// assert_eq!(
    ///     weeble.properties().map(|properties| properties.center_of_mass().y),
    ///     Some(-0.06)
    /// );
    /// # Ok::<(), tumble::BodyError>(())
    /// ```
    pub fn center_of_mass(self, center: impl Into<DVec3>) -> Self {
        Self { center_of_mass: Some(center.into()), ..self }
    }

    /// Where the origin of its frame is in the world \[m\].
    #[doc(alias = "translation")]
    pub fn position(self, position: Vec3) -> Self {
        Self { position, ..self }
    }

    /// The rotation from its frame to the world: a unit quaternion, up to 1e-3 in its length.
    #[doc(alias = "rotation")]
    pub fn orientation(self, orientation: Quat) -> Self {
        Self { orientation, ..self }
    }

    /// Velocity of its centre of mass in the world frame [m/s].
    #[doc(alias("linvel", "velocity"))]
    pub fn linear_velocity(self, velocity: Vec3) -> Self {
        Self { linear_velocity: velocity, ..self }
    }

    /// Its angular velocity in the world frame [rad/s].
    #[doc(alias("angvel", "spin"))]
    pub fn angular_velocity(self, velocity: Vec3) -> Self {
        Self { angular_velocity: velocity, ..self }
    }

    /// How many times gravity acts on it; 0 floats.
    #[doc(alias = "gravity factor")]
    pub fn gravity_scale(self, scale: Real) -> Self {
        Self { gravity_scale: Some(scale), ..self }
    }

    /// The rates at which its momenta decay [1/s].
    pub fn damping(self, damping: Damping) -> Self {
        Self { damping: Some(damping), ..self }
    }

    /// Gives it a [`PreviousPose`], so that it can be drawn between steps.
    pub fn interpolated(self) -> Self {
        Self { interpolated: true, ..self }
    }

    /// Its stable identity, for snapshots, hashes and all that goes by order.
    pub fn id(self, id: BodyId) -> Self {
        Self { id: Some(id), ..self }
    }

    /// What it collides by, instead of its shape.
    ///
    /// ```
    /// use tumble::{Collider, prelude::*};
    ///
    /// // Heavy as a slab, and touched where its two legs are.
    /// let legs = [-0.4, 0.4].map(|x| {
    ///     Collider::new(&Shape::cuboid([0.1, 0.3, 0.1]))?.with_offset(Pose::at(Vec3::X * x))
    /// });
    /// let [left, right] = legs;
    /// let table = RigidBody::new(Shape::cuboid([0.5, 0.05, 0.5])).mass(8.0);
    /// let table = table.collider(Collider::compound([left?, right?])?).build()?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn collider(self, collider: Collider) -> Self {
        Self { collider: ColliderChoice::Given(collider), ..self }
    }

    /// Others pass through it: it gets no [`Collider`]. Where nothing in a world has one, nothing
    /// looks for contacts.
    ///
    /// ```
    /// # use tumble::{Collider, prelude::*};
    /// # let mut world = hecs::World::new();
    /// let ghost = RigidBody::new(Shape::sphere(0.5)).mass(1.0).without_collider().build()?;
    /// let ghost = ghost.spawn(&mut world);
    /// assert!(world.get::<&Collider>(ghost).is_err());
    /// # Ok::<(), tumble::BodyError>(())
    /// ```
    #[doc(alias("ghost", "no collision"))]
    pub fn without_collider(self) -> Self {
        Self { collider: ColliderChoice::None, ..self }
    }

    /// The surface of its collider: friction, bounce, resistance to rolling.
    #[doc(alias("friction", "restitution"))]
    pub fn material(self, material: Material) -> Self {
        Self { material: Some(material), ..self }
    }

    /// The collision groups of its collider, as [`Collider::with_groups`] has them.
    #[doc(alias("collision layers", "collision groups", "mask"))]
    pub fn groups(self, membership: u32, filter: u32) -> Self {
        Self { groups: Some((membership, filter)), ..self }
    }

    /// Makes its collider a [sensor](Collider::sensor), which pushes nothing and tells what is in
    /// it.
    #[doc(alias = "trigger")]
    pub fn sensor(self) -> Self {
        Self { is_sensor: true, ..self }
    }

    /// Checks everything and computes the components.
    ///
    /// # Errors
    /// [`BodyError`] says what is wrong, with the number, and [`BodyError::field`] where.
    pub fn build(self) -> Result<Body, BodyError> {
        self.check_numbers()?;
        let orientation = self.unit_orientation()?;
        let pose = Pose { position: self.position, orientation: quat(orientation) };
        let mut body = Body { id: self.id, ..Body::at(pose) };
        match self.motion {
            MotionType::Fixed => {
                // It needs no mass, but its shape and what was given must be possible.
                self.shape_properties(Some(Amount::Mass(1.0)))?;
                if (self.linear_velocity, self.angular_velocity) != (Vec3::ZERO, Vec3::ZERO) {
                    return Err(BodyError::MovingFixed);
                }
            }
            MotionType::Kinematic => {
                self.shape_properties(Some(Amount::Mass(1.0)))?;
                body.velocity = Some(Velocity { linear: self.linear_velocity, angular: self.angular_velocity });
                if let Some(center) = self.center_of_mass {
                    body.center_of_mass = Some(CenterOfMass(finite("center_of_mass", vec3(center))?));
                    body.pose.position = finite("position", vec3(dvec3(self.position) + orientation * center))?;
                }
            }
            MotionType::Dynamic => self.make_dynamic(&mut body, orientation)?,
        }
        body.previous_pose = self.interpolated.then_some(PreviousPose(body.pose));
        body.collider = self.make_collider()?;
        Ok(body)
    }

    fn make_collider(self) -> Result<Option<Collider>, ColliderError> {
        let is_asked_for = self.material.is_some() || self.groups.is_some() || self.is_sensor;
        let mut collider = match self.collider {
            ColliderChoice::None => return Ok(None),
            ColliderChoice::Given(collider) => collider,
            ColliderChoice::Shape => match Collider::new(&self.shape) {
                // Points, and compounds of points.
                Err(ColliderError::Shape { .. }) if !is_asked_for => return Ok(None),
                made => made?,
            },
        };
        if let Some(material) = self.material {
            collider = collider.with_material(material)?;
        }
        if let Some((membership, filter)) = self.groups {
            collider = collider.with_groups(membership, filter);
        }
        Ok(Some(if self.is_sensor { collider.sensor() } else { collider }))
    }

    fn make_dynamic(&self, body: &mut Body, orientation: DQuat) -> Result<(), BodyError> {
        let (properties, principal) = self.mass_properties()?;
        let mass = Mass::new(properties.mass()).map_err(BodyError::MassRange)?;
        let center = properties.center_of_mass();
        if center != DVec3::ZERO {
            body.center_of_mass = Some(CenterOfMass(finite("center_of_mass", vec3(center))?));
            body.pose.position = finite("position", vec3(dvec3(self.position) + orientation * center))?;
        }
        let linear = finite("linear_velocity", vec3(dvec3(self.linear_velocity) * properties.mass()))?;
        let mut angular = Vec3::ZERO;
        if let Some(PrincipalInertia { moments, axes, .. }) = principal {
            let frame = orientation * axes;
            let spin = frame.inverse() * dvec3(self.angular_velocity);
            angular = finite("angular_velocity", vec3(frame * (moments * spin)))?;
            body.inertia = Some(Inertia::new(moments).map_err(BodyError::InertiaRange)?);
            body.axes = (axes != DQuat::IDENTITY).then(|| PrincipalAxes(quat(axes)));
        } else if self.angular_velocity != Vec3::ZERO {
            return Err(BodyError::SpinningPoint);
        }
        body.mass = Some(mass);
        body.momentum = Some(Momentum { linear, angular });
        body.wrench = Some(Wrench::default());
        body.gravity_scale = self.gravity_scale.map(GravityScale);
        body.damping = self.damping;
        body.properties = Some(properties);
        let (velocity, inverse_inertia) = body.derived(mass, Momentum { linear, angular });
        body.velocity = Some(velocity);
        body.inverse_inertia = body.inertia.map(|_| inverse_inertia);
        Ok(())
    }

    /// Mass and centre of mass, and the principal inertia of a body that has any extent.
    fn mass_properties(&self) -> Result<(MassProperties, Option<PrincipalInertia>), BodyError> {
        let mut properties = self.shape_properties(None)?;
        if let Some(center) = self.center_of_mass {
            finite("center_of_mass", vec3(center))?;
            let far = |_| BodyError::NotFinite { field: "center_of_mass", value: center };
            properties = properties.centered_at(center).map_err(far)?;
        }
        if let Some(principal) = self.inertia {
            let tensor = InertiaTensor::from_principal(principal.moments, principal.axes)?;
            let given = MassProperties::new(properties.mass(), properties.center_of_mass(), tensor)?;
            return Ok((given, Some(PrincipalInertia { axes: principal.axes.normalize(), ..principal })));
        }
        let is_point = properties.tensor_about_center() == glam::DMat3::ZERO;
        let principal = if is_point { None } else { Some(properties.inertia()?.principal()) };
        Ok((properties, principal))
    }

    /// The shape's mass properties, with `otherwise` for the amount that was not given; a compound
    /// has its own.
    fn shape_properties(&self, otherwise: Option<Amount>) -> Result<MassProperties, BodyError> {
        Ok(match (self.amount, &self.shape) {
            (Some(amount), shape) => shape.mass_properties(amount)?,
            (None, shape @ Shape::Compound(_)) => shape.own_mass_properties()?,
            (None, shape) => shape.mass_properties(otherwise.ok_or(BodyError::MissingMass)?)?,
        })
    }

    fn unit_orientation(&self) -> Result<DQuat, BodyError> {
        let orientation = dquat(self.orientation);
        let length = orientation.length();
        if (length - 1.0).abs() <= 1e-3 { Ok(orientation.normalize()) } else { Err(BodyError::NotUnit(length)) }
    }

    fn check_numbers(&self) -> Result<(), BodyError> {
        within("position", self.position, MAX_DISTANCE)?;
        within("linear_velocity", self.linear_velocity, MAX_SPEED)?;
        within("angular_velocity", self.angular_velocity, MAX_SPEED)?;
        let number = |field, wanted, value: Option<Real>, fits: fn(Real) -> bool| match value {
            Some(value) if !fits(value) => Err(BodyError::Number { field, wanted, value: value.into() }),
            _ => Ok(()),
        };
        let rate = |value: Real| value >= 0.0 && value.is_finite();
        number("gravity_scale", "finite", self.gravity_scale, Real::is_finite)?;
        number("damping.linear", "zero or positive, and finite", self.damping.map(|d| d.linear), rate)?;
        number("damping.angular", "zero or positive, and finite", self.damping.map(|d| d.angular), rate)
    }
}

pub(super) fn within(field: &'static str, value: Vec3, most: Real) -> Result<(), BodyError> {
    finite(field, value)?;
    if range::within(value.into(), most) {
        return Ok(());
    }
    Err(BodyError::TooLarge { field, value: dvec3(value), most: most.into() })
}

pub(super) fn finite(field: &'static str, value: Vec3) -> Result<Vec3, BodyError> {
    if value.is_finite() { Ok(value) } else { Err(BodyError::NotFinite { field, value: dvec3(value) }) }
}
