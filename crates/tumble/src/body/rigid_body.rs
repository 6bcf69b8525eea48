//! The rigid-body builder: shape, mass properties, motion type, initial state and validation.

use glam::{DQuat, DVec3};
use tumble_math::{Amount, InertiaTensor, MassProperties, PrincipalInertia, Shape};

use crate::body::body_error::BodyError;
use crate::body::bundle::Body;
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

/// A rigid body to be: says what it is made of and how it moves, and [`build`](Self::build) checks
/// it all and makes the components.
///
/// ```
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// let body =
///     RigidBody::new(Shape::cylinder(0.05, 0.2)).density(800.0).position(Vec3::Y).build()?;
/// let entity = body.spawn(&mut world);
/// assert!(world.get::<&Mass>(entity)?.kilograms() > 2.5);
///
/// let error = RigidBody::new(Shape::sphere(0.5)).mass(-1.0).build().unwrap_err();
/// assert_eq!(
///     (error.field().as_str(), error.to_string().as_str()),
///     ("mass", "mass must be positive, it is -1.0")
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
}

impl RigidBody {
    /// A body of this shape, at rest at the world's origin, that moves as forces make it. It needs
    /// a mass or a density.
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
        }
    }

    /// Makes it a body that does not move. It needs no mass.
    pub fn fixed(self) -> Self {
        Self { motion: MotionType::Fixed, ..self }
    }

    /// Makes it a body that moves with the velocities it is given, whatever pushes it. It needs no
    /// mass; it turns about the origin of its frame, or about the
    /// [`center_of_mass`](Self::center_of_mass) that it is given.
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
    /// shape's. One that was accepted [with a tolerance](InertiaTensor::with_tolerance) moves as
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
    pub fn position(self, position: Vec3) -> Self {
        Self { position, ..self }
    }

    /// The rotation from its frame to the world: a unit quaternion, up to 1e-3 in its length.
    pub fn orientation(self, orientation: Quat) -> Self {
        Self { orientation, ..self }
    }

    /// Velocity of its centre of mass in the world frame [m/s].
    pub fn linear_velocity(self, velocity: Vec3) -> Self {
        Self { linear_velocity: velocity, ..self }
    }

    /// Its angular velocity in the world frame [rad/s].
    pub fn angular_velocity(self, velocity: Vec3) -> Self {
        Self { angular_velocity: velocity, ..self }
    }

    /// How many times gravity acts on it; 0 floats.
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
        Ok(body)
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

fn within(field: &'static str, value: Vec3, most: Real) -> Result<(), BodyError> {
    finite(field, value)?;
    if range::within(value.into(), most) {
        return Ok(());
    }
    Err(BodyError::TooLarge { field, value: dvec3(value), most: most.into() })
}

fn finite(field: &'static str, value: Vec3) -> Result<Vec3, BodyError> {
    if value.is_finite() { Ok(value) } else { Err(BodyError::NotFinite { field, value: dvec3(value) }) }
}
