//! Principal moments, principal axes, centre of mass, and the inverse inertia in the world frame.

use glam::DVec3;
use tumble_math::{InertiaError, InertiaTensor};

use crate::components::property_error::PropertyError;
use crate::math::{Mat3, Quat, Real, Vec3, vec3};

/// Principal moments of inertia about the centre of mass [kg m^2], with their inverses.
///
/// A body whose frame is not the principal one also has [`PrincipalAxes`]. A body without `Inertia`
/// is a point mass: it does not turn. Replacing the component while the simulation runs keeps the
/// angular momentum, so the body spins up or down, as a skater does.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// // A skater pulls in the arms: half the moment of inertia, twice the angular velocity.
/// let skater =
///     RigidBody::new(Shape::sphere(0.5)).mass(50.0).angular_velocity(Vec3::Y * 3.0).build()?;
/// let skater = skater.spawn(&mut world);
/// let halved = Inertia::new(world.get::<&Inertia>(skater)?.moments() * 0.5)?;
/// *world.get::<&mut Inertia>(skater)? = halved;
/// Simulation::new(Settings::default())?.step(&mut world);
/// assert!((world.get::<&Velocity>(skater)?.angular.y - 6.0).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Inertia {
    moments: Vec3,
    inverse_moments: Vec3,
}

impl Inertia {
    /// The three principal moments [kg m^2].
    ///
    /// # Errors
    /// [`InertiaError`] where they are not positive and finite, or one is larger than the sum of
    /// the others; [`PropertyError`] where they do not fit the precision of the build, or differ by
    /// more than it resolves (1e7 in single precision).
    ///
    /// ```
    /// # use tumble::{Inertia, math::Vec3};
    /// let inertia = Inertia::new(Vec3::new(1.0, 2.0, 2.5))?;
    /// assert_eq!(inertia.inverse_moments().y, 0.5);
    /// assert!(Inertia::new(Vec3::new(1.0, 2.0, 3.5)).is_err());
    /// # Ok::<(), tumble::InertiaComponentError>(())
    /// ```
    pub fn new(moments: impl Into<DVec3>) -> Result<Self, InertiaComponentError> {
        Self::within_tolerance(moments, InertiaTensor::TOLERANCE)
    }

    /// The three principal moments [kg m^2], of which the largest may exceed the sum of the others
    /// by `relative` times itself, as published moments of flat bodies do. The body then moves with
    /// the [nearest moments](InertiaTensor::nearest_possible) that one can have.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    ///
    /// ```
    /// # use tumble::Inertia;
    /// let plate = Inertia::within_tolerance([0.345, 0.653, 1.0], 3e-3)?;
    /// assert!((plate.moments().z - 0.999_333).abs() < 1e-6);
    /// # Ok::<(), tumble::InertiaComponentError>(())
    /// ```
    pub fn within_tolerance(moments: impl Into<DVec3>, relative: f64) -> Result<Self, InertiaComponentError> {
        let matrix = glam::DMat3::from_diagonal(moments.into());
        let possible = InertiaTensor::within_tolerance(matrix, relative)?.nearest_possible().matrix();
        let moments = DVec3::new(possible.x_axis.x, possible.y_axis.y, possible.z_axis.z);
        for moment in moments.to_array() {
            PropertyError::check("principal moment", moment)?;
        }
        let (smallest, largest) = (moments.min_element(), moments.max_element());
        if smallest < largest * f64::from(Real::EPSILON) {
            return Err(PropertyError::TooUnequal { smallest, largest }.into());
        }
        Ok(Self { moments: vec3(moments), inverse_moments: vec3(moments.recip()) })
    }

    /// The principal moments [kg m^2].
    #[inline]
    pub fn moments(&self) -> Vec3 {
        self.moments
    }

    /// Their inverses [1/(kg m^2)].
    #[inline]
    pub fn inverse_moments(&self) -> Vec3 {
        self.inverse_moments
    }

    /// Angular momentum in the world frame [kg m^2/s] at an angular velocity in the world frame
    /// [rad/s]: `L = R I R^T w`.
    ///
    /// `frame` takes principal-frame coordinates to world coordinates: the orientation, times the
    /// principal axes where there are any.
    ///
    /// This is the Unity idiom for a wanted spin:
    /// `inertia.angular_momentum(frame, wanted) - momentum.angular` is the angular impulse that
    /// reaches it at once, and divided by the step it is the torque that reaches it in one step.
    pub fn angular_momentum(&self, frame: Quat, angular_velocity: Vec3) -> Vec3 {
        frame * (self.moments * (frame.conjugate() * angular_velocity))
    }
}

/// Why principal moments are refused.
///
/// ```
/// # use tumble::{Inertia, InertiaComponentError, math::Vec3};
/// // One moment is larger than the other two together: no solid is like that.
/// let error = Inertia::new(Vec3::new(1.0, 2.0, 3.5)).unwrap_err();
/// assert!(matches!(error, InertiaComponentError::Impossible(_)));
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InertiaComponentError {
    /// No rigid body has such moments.
    #[error(transparent)]
    Impossible(#[from] InertiaError),
    /// A moment does not fit the precision of the build.
    #[error(transparent)]
    Property(#[from] PropertyError),
}

tumble_math::debug_as_display!(InertiaComponentError);

/// The rotation whose matrix has the principal axes, in body coordinates, as columns: it takes
/// principal-frame coordinates to body-frame coordinates, `I_body = R diag(moments) R^T`. A body
/// whose frame is principal does without.
///
/// ```
/// # use tumble::{InertiaTensor, prelude::*};
/// # let mut world = hecs::World::new();
/// let tilted =
///     InertiaTensor::from_principal([1.0, 2.0, 2.5], tumble::glam::DQuat::from_rotation_z(0.3))?;
/// let body = RigidBody::new(Shape::sphere(1.0)).mass(1.0);
/// let (plain, tilted) =
///     (body.clone().build()?.spawn(&mut world), body.inertia(tilted).build()?.spawn(&mut world));
/// assert!(world.get::<&PrincipalAxes>(plain).is_err());
/// assert!(world.get::<&PrincipalAxes>(tilted).is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct PrincipalAxes(pub Quat);

/// The centre of mass in the body's own frame \[m\]. A body whose frame has its origin there does
/// without.
///
/// The state is that of the centre of mass; [`Pose::origin`](crate::Pose::origin) gives where the
/// frame's origin is.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// let weeble =
///     RigidBody::new(Shape::sphere(0.1)).mass(0.3).center_of_mass([0.0, -0.06, 0.0]).build()?;
/// let weeble = weeble.spawn(&mut world);
/// let (pose, center) = (world.get::<&Pose>(weeble)?, world.get::<&CenterOfMass>(weeble)?);
/// assert!((pose.position - Vec3::Y * -0.06).length() < 1e-6);
/// assert!(pose.origin(Some(&*center)).length() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CenterOfMass(pub Vec3);

/// Inverse inertia tensor about the centre of mass in the world frame [1/(kg m^2)], symmetric: what
/// a torque is multiplied with to give an angular acceleration. Derived by
/// [`update_derived`](crate::update_derived).
///
/// ```
/// # use tumble::{InverseInertia, prelude::*};
/// # let mut world = hecs::World::new();
/// // A moment of 2/5 M r^2 = 1 kg m^2 about every axis.
/// let ball = RigidBody::new(Shape::sphere(0.5)).mass(10.0).build()?.spawn(&mut world);
/// let angular_acceleration = *world.get::<&InverseInertia>(ball)? * (Vec3::X * 3.0);
/// assert!((angular_acceleration - Vec3::X * 3.0).length() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(C)]
pub struct InverseInertia {
    /// `xx, yy, zz`.
    pub diagonal: Vec3,
    /// `yz, zx, xy`.
    pub off_diagonal: Vec3,
}

impl InverseInertia {
    /// The tensor as a matrix.
    pub fn to_mat3(self) -> Mat3 {
        let (d, o) = (self.diagonal, self.off_diagonal);
        Mat3::from_cols(Vec3::new(d.x, o.z, o.y), Vec3::new(o.z, d.y, o.x), Vec3::new(o.y, o.x, d.z))
    }
}

/// The angular acceleration [rad/s^2] that a torque [N m] gives a body that does not spin,
/// `I^-1 tau`, in the world frame.
impl std::ops::Mul<Vec3> for InverseInertia {
    type Output = Vec3;
    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        let (d, o) = (self.diagonal, self.off_diagonal);
        Vec3::new(
            d.x * v.x + o.z * v.y + o.y * v.z,
            o.z * v.x + d.y * v.y + o.x * v.z,
            o.y * v.x + o.x * v.y + d.z * v.z,
        )
    }
}
