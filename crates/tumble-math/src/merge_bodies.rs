//! Moving bodies that become one.

use glam::{DMat3, DQuat, DVec3};
use thiserror::Error;

use crate::inertia_error::listed;
use crate::mass_error::MassError;
use crate::mass_properties::MassProperties;
use crate::symmetric_eigen::symmetric_eigen;

/// A rigid body as it moves.
///
/// ```
/// use glam::{DQuat, DVec3};
/// use tumble_math::{Amount, MovingBody, Shape};
/// let ball = MovingBody {
///     properties: Shape::sphere(0.1).mass_properties(Amount::Mass(2.0))?,
///     position: DVec3::Y,
///     orientation: DQuat::IDENTITY,
///     linear_velocity: DVec3::X,
///     angular_velocity: DVec3::ZERO,
/// };
/// # assert_eq!(ball.properties.mass(), 2.0);
/// # Ok::<(), tumble_math::ShapeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingBody {
    /// Mass properties in the body's own frame.
    pub properties: MassProperties,
    /// Where the origin of its frame is in the world \[m\].
    pub position: DVec3,
    /// Rotation from its frame to the world.
    pub orientation: DQuat,
    /// Velocity of its centre of mass in the world [m/s].
    pub linear_velocity: DVec3,
    /// Angular velocity in the world [rad/s].
    pub angular_velocity: DVec3,
}

/// What [`weld`] makes of several bodies, in the world's frame.
///
/// ```
/// use glam::{DQuat, DVec3};
/// use tumble_math::{Amount, MovingBody, Shape, weld};
/// let lump = |linear_velocity| -> Result<MovingBody, tumble_math::ShapeError> {
///     let properties = Shape::sphere(0.1).mass_properties(Amount::Mass(2.0))?;
///     let (position, orientation) = (DVec3::ZERO, DQuat::IDENTITY);
///     Ok(MovingBody {
///         properties,
///         position,
///         orientation,
///         linear_velocity,
///         angular_velocity: DVec3::ZERO,
///     })
/// };
/// // Head on, at 3 m/s each: nothing moves any more, and all 18 J are gone.
/// let stuck = weld([lump(DVec3::X * 3.0)?, lump(DVec3::X * -3.0)?])?;
/// assert_eq!((stuck.linear_velocity, stuck.energy_lost), (DVec3::ZERO, 18.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct WeldedBody {
    /// Mass, centre of mass and tensor about it, in the world's axes and about the world's origin.
    pub properties: MassProperties,
    /// Velocity of the centre of mass [m/s].
    pub linear_velocity: DVec3,
    /// Angular velocity [rad/s].
    pub angular_velocity: DVec3,
    /// Linear momentum [kg m/s]: the sum of those of the bodies.
    pub linear_momentum: DVec3,
    /// Angular momentum about the centre of mass [kg m^2/s]: the sum of those of the bodies about
    /// that point.
    pub angular_momentum: DVec3,
    /// Kinetic energy that the bodies had and the one has not \[J\], never negative: what it takes
    /// to make them stick.
    pub energy_lost: f64,
}

/// Why bodies cannot be welded.
///
/// ```
/// use tumble_math::{WeldError, weld};
/// assert_eq!(weld([]).unwrap_err(), WeldError::NoBodies);
/// ```
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum WeldError {
    /// There are none.
    #[error("there is no body to weld")]
    NoBodies,
    /// The pose of one is impossible.
    #[error("body {body}: {source}")]
    Pose {
        /// Index of the body, from 0.
        body: usize,
        /// What is wrong with it.
        source: MassError,
    },
    /// A velocity of one is not finite.
    #[error("body {body}: {field} {} is not finite", listed(*.velocity))]
    Velocity {
        /// Index of the body, from 0.
        body: usize,
        /// `linear_velocity` or `angular_velocity`.
        field: &'static str,
        /// The velocity [m/s] or [rad/s].
        velocity: DVec3,
    },
}

crate::debug_as_display!(WeldError);

/// One body of several that from now on move together: a perfectly inelastic collision, or a joint
/// that closes. Linear and angular momentum are kept.
///
/// With the masses m, centres c, velocities v and tensors I of the bodies in the world's axes, and
/// d = c - C:
///
/// ```text
/// M = sum m      C = sum m c / M      P = M V = sum m v
/// L = sum (I w + d x m (v - V)) = I_C W
/// lost energy = 1/2 sum (m u^2 + (w - W) . I (w - W)),  u = v - V - W x d
/// ```
///
/// The lost energy is that of the motions against each other, and so a sum of squares in which
/// nothing cancels: since momentum is kept, `sum m u = 0` and `sum (I (w - W) + d x m u) = 0`, the
/// products with V and W drop out of the difference of the energies. (Carnot's theorem on impacts
/// without rebound.)
///
/// A body without inertia about an axis, such as two points about the line through them, does not
/// turn about it.
///
/// ```
/// use tumble_math::{Amount, MovingBody, Shape, weld};
/// use glam::{DQuat, DVec3};
///
/// let ball = Shape::sphere(0.1).mass_properties(Amount::Mass(2.0))?;
/// let at = |position: DVec3, linear_velocity: DVec3| MovingBody {
///     properties: ball,
///     position,
///     orientation: DQuat::IDENTITY,
///     linear_velocity,
///     angular_velocity: DVec3::ZERO,
/// };
/// // Two balls catch each other in passing, and turn about their middle.
/// let pair = weld([at(DVec3::Y, DVec3::X), at(-DVec3::Y, -DVec3::X)])?;
/// assert_eq!(pair.linear_velocity, DVec3::ZERO);
/// assert_eq!(pair.angular_momentum, DVec3::Z * -4.0);
/// assert!((pair.angular_velocity.z * (4.0 + 2.0 * 0.4 * 2.0 * 0.01) + 4.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// No body at all, or one (named by its index) whose pose or velocity is impossible.
pub fn weld(bodies: impl IntoIterator<Item = MovingBody>) -> Result<WeldedBody, WeldError> {
    let mut placed: Vec<(MassProperties, MovingBody)> = Vec::new();
    for (index, body) in bodies.into_iter().enumerate() {
        placed.push((in_the_world(index, &body)?, body));
    }
    let properties =
        placed.iter().map(|(properties, _)| *properties).reduce(|a, b| a + b).ok_or(WeldError::NoBodies)?;
    let linear_momentum: DVec3 = placed.iter().map(|(p, body)| body.linear_velocity * p.mass()).sum();
    let linear_velocity = linear_momentum / properties.mass();

    let arm = |p: &MassProperties| p.center_of_mass() - properties.center_of_mass();
    let spin = |(p, body): &(MassProperties, MovingBody)| {
        let orbital = arm(p).cross((body.linear_velocity - linear_velocity) * p.mass());
        p.tensor_about_center() * body.angular_velocity + orbital
    };
    let angular_momentum: DVec3 = placed.iter().map(spin).sum();
    let angular_velocity = angular_velocity(&properties, angular_momentum);

    let against = |(p, body): &(MassProperties, MovingBody)| {
        let slip = body.linear_velocity - linear_velocity - angular_velocity.cross(arm(p));
        let turn = body.angular_velocity - angular_velocity;
        0.5 * (p.mass() * slip.length_squared() + turn.dot(p.tensor_about_center() * turn).max(0.0))
    };
    let energy_lost = placed.iter().map(against).sum();
    Ok(WeldedBody { properties, linear_velocity, angular_velocity, linear_momentum, angular_momentum, energy_lost })
}

/// Mass properties of a body in the world, its velocities checked.
fn in_the_world(index: usize, body: &MovingBody) -> Result<MassProperties, WeldError> {
    for (field, velocity) in [("linear_velocity", body.linear_velocity), ("angular_velocity", body.angular_velocity)] {
        if !velocity.is_finite() {
            return Err(WeldError::Velocity { body: index, field, velocity });
        }
    }
    let placed = body.properties.transformed(body.position, body.orientation);
    placed.map_err(|source| WeldError::Pose { body: index, source })
}

/// `I^-1 L`; nothing about an axis without a moment.
///
/// A long body turned out of its axes has an inverse with few digits; one step of iterative
/// refinement makes `I W = L` good to rounding.
fn angular_velocity(properties: &MassProperties, angular_momentum: DVec3) -> DVec3 {
    let tensor = properties.tensor_about_center();
    let inverse = properties.inertia().map_or_else(|_| pseudoinverse(tensor), |inertia| inertia.inverse());
    let estimate = inverse * angular_momentum;
    estimate + inverse * (angular_momentum - tensor * estimate)
}

/// The inverse where there are moments, zero about axes without. As in
/// [`InertiaTensor`](crate::InertiaTensor), a turned tensor holds a moment to 32 eps of the
/// largest.
fn pseudoinverse(tensor: DMat3) -> DMat3 {
    let (moments, axes) = symmetric_eigen(tensor);
    let rounding = 32.0 * f64::EPSILON * moments.max_element();
    let inverse = moments.to_array().map(|moment| if moment > rounding { 1.0 / moment } else { 0.0 });
    axes * DMat3::from_diagonal(inverse.into()) * axes.transpose()
}
