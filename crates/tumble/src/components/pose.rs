//! The pose of a body, rigid transforms with it, and the previous pose for interpolation.

use crate::components::CenterOfMass;
use crate::math::{Mat3, Mat4, Quat, Real, Vec3, product, rotated};
use crate::rotation::{NotARotation, quat_from_matrix};

/// Where a body is: the centre of mass and the orientation of its frame. Of a fixed or kinematic
/// body, which has no mass, the origin of its frame stands for the centre of mass.
///
/// ```
/// # use tumble::{Pose, math::{Quat, Real, Vec3}};
/// let pose = Pose {
///     position: Vec3::Y,
///     orientation: Quat::from_rotation_z(std::f64::consts::FRAC_PI_2 as Real),
/// };
/// assert!((pose.transform_point(Vec3::X) - Vec3::Y * 2.0).length() < 1e-6);
/// assert!((pose.to_mat4().transform_point3(Vec3::X) - Vec3::Y * 2.0).length() < 1e-6);
/// ```
#[doc(alias("transform", "isometry", "position", "rotation"))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Pose {
    /// Unit quaternion that takes body coordinates to world coordinates.
    pub orientation: Quat,
    /// Position of the centre of mass in the world \[m\].
    pub position: Vec3,
}

impl Default for Pose {
    fn default() -> Self {
        Self { position: Vec3::ZERO, orientation: Quat::IDENTITY }
    }
}

impl Pose {
    /// At a position \[m\], not turned.
    ///
    /// ```
    /// # use tumble::{Pose, math::{Quat, Vec3}};
    /// assert_eq!(Pose::at(Vec3::Y), Pose { position: Vec3::Y, ..Pose::default() });
    /// let turned = Pose::at(Vec3::Y) * Pose::from_rotation(Quat::from_rotation_x(1.0));
    /// assert_eq!(turned.position, Vec3::Y);
    /// ```
    #[doc(alias("from_translation", "from_position", "translation"))]
    #[inline]
    #[must_use]
    pub fn at(position: Vec3) -> Self {
        Self { position, ..Self::default() }
    }

    /// At the origin, turned by a unit quaternion.
    ///
    /// ```
    /// # use tumble::{Pose, math::{Quat, Vec3}};
    /// let turned = Pose::from_rotation(Quat::from_rotation_y(0.5));
    /// assert_eq!((turned.position, turned.orientation), (Vec3::ZERO, Quat::from_rotation_y(0.5)));
    /// ```
    #[inline]
    #[must_use]
    pub fn from_rotation(rotation: Quat) -> Self {
        Self { orientation: rotation, ..Self::default() }
    }

    /// World coordinates \[m\] of a point given relative to the centre of mass along the body's
    /// axes.
    #[inline]
    pub fn transform_point(&self, point_body: Vec3) -> Vec3 {
        self.position + rotated(self.orientation, point_body)
    }

    /// Coordinates relative to the centre of mass along the body's axes \[m\] of a point in the
    /// world.
    #[inline]
    pub fn inverse_transform_point(&self, point_world: Vec3) -> Vec3 {
        rotated(self.orientation.conjugate(), point_world - self.position)
    }

    /// The origin of the body's own frame in the world \[m\]: where the centre of mass is not, if
    /// the body has a [`CenterOfMass`].
    #[inline]
    pub fn origin(&self, center_of_mass: Option<&CenterOfMass>) -> Vec3 {
        center_of_mass.map_or(self.position, |offset| self.transform_point(-offset.0))
    }

    /// The 4x4 transform from body coordinates (relative to the centre of mass) to world
    /// coordinates, as renderers take it.
    #[inline]
    pub fn to_mat4(&self) -> Mat4 {
        Mat4::from_rotation_translation(self.orientation, self.position)
    }

    /// The pose of a 4x4 transform that turns and shifts, such as [`to_mat4`](Self::to_mat4) makes.
    ///
    /// ```
    /// # use tumble::{Pose, math::{Mat4, Quat, Vec3}};
    /// let pose =
    ///     Pose { position: Vec3::new(1.0, 2.0, 3.0), orientation: Quat::from_rotation_y(0.5) };
    /// let found = Pose::from_mat4(pose.to_mat4())?;
    /// assert_eq!(found.position, pose.position);
    /// assert!((found.orientation - pose.orientation).length() < 1e-6);
    /// assert!(Pose::from_mat4(Mat4::from_scale(Vec3::splat(2.0))).is_err());
    /// # Ok::<(), tumble::rotation::NotARotation>(())
    /// ```
    ///
    /// # Errors
    /// [`NotARotation`](crate::rotation::NotARotation): a transform that scales, shears, mirrors,
    /// projects, or is not finite.
    pub fn from_mat4(transform: Mat4) -> Result<Self, NotARotation> {
        let rows = transform.transpose();
        let projects = (rows.w_axis.truncate(), rows.w_axis.w) != (Vec3::ZERO, 1.0);
        let position = transform.w_axis.truncate();
        if projects || !position.is_finite() {
            return Err(NotARotation::NotOrthonormal { error: f64::NAN });
        }
        Ok(Self { position, orientation: quat_from_matrix(Mat3::from_mat4(transform))? })
    }

    /// Where the world is as seen from here: what takes this pose to that of the world's origin,
    /// not turned.
    ///
    /// ```
    /// # use tumble::{Pose, math::{Quat, Vec3}};
    /// # let (station, ship) = (Pose::at(Vec3::X * 3.0), Pose::at(Vec3::Y * 4.0));
    /// // The ship in the station's frame.
    /// let relative = station.inverse() * ship;
    /// assert_eq!(relative.position, Vec3::new(-3.0, 4.0, 0.0));
    /// ```
    #[inline]
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self { position: self.inverse_transform_point(Vec3::ZERO), orientation: self.orientation.conjugate() }
    }

    /// The pose at the fraction `alpha` of the way from `self` (0) to `next` (1): straight in
    /// position, slerp in orientation. For rendering between two steps: its last bits are those of
    /// glam on the machine.
    ///
    /// ```
    /// # use tumble::{Pose, math::{Quat, Vec3}};
    /// let next = Pose { position: Vec3::X, orientation: Quat::from_rotation_z(1.0) };
    /// let half = Pose::default().interpolate(&next, 0.5);
    /// assert_eq!(half.position, Vec3::X * 0.5);
    /// assert!(half.orientation.angle_between(Quat::from_rotation_z(0.5)) < 1e-3);
    /// ```
    pub fn interpolate(&self, next: &Self, alpha: Real) -> Self {
        Self {
            position: self.position.lerp(next.position, alpha),
            orientation: self.orientation.slerp(next.orientation, alpha),
        }
    }
}

impl std::ops::Mul for Pose {
    type Output = Self;

    /// The pose in the world of something whose pose in the frame of `self` is `attached`.
    #[inline]
    fn mul(self, attached: Self) -> Self {
        let orientation = product(self.orientation, attached.orientation);
        Self { position: self.transform_point(attached.position), orientation }
    }
}

/// The pose before the last step. The step keeps it up to date on bodies that have it, for
/// [`Pose::interpolate`] to draw frames between steps.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// let ball = RigidBody::new(Shape::sphere(0.1))
///     .mass(1.0)
///     .linear_velocity(Vec3::X)
///     .interpolated()
///     .build()?;
/// let ball = ball.spawn(&mut world);
/// let mut simulation = Simulation::new(Settings::default())?;
/// let alpha = simulation.advance(&mut world, 1.5 / 60.0); // a step and a half
/// let drawn = world.get::<&PreviousPose>(ball)?.0.interpolate(&*world.get::<&Pose>(ball)?, alpha);
/// assert!((drawn.position.x - 0.5 / 60.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "interpolation")]
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(transparent)]
pub struct PreviousPose(pub Pose);
