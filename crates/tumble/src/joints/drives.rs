//! Motors, servos and springs of a joint.

use crate::joints::axes::Axes;
use crate::joints::gain::Gain;
use crate::joints::oscillation::Oscillation;
use crate::math::Real;

/// The motors, servos and springs of a joint: a component of the entity of a
/// [`Joint`](crate::Joint).
///
/// They act along its free axes; one of a locked axis does nothing. Targets can be changed between
/// steps.
///
/// ```
/// use tumble::{Axes, Drive, Drives, Joint, prelude::*};
///
/// let mut world = tumble::hecs::World::new();
/// let base = RigidBody::new(Shape::Point).fixed().build()?.spawn(&mut world);
/// let wheel = RigidBody::new(Shape::cylinder(0.3, 0.1)).mass(5.0).build()?.spawn(&mut world);
/// let hinge = Joint::hinge(base, wheel).at(&world, Vec3::ZERO, Vec3::Y)?;
/// let motor = Drive::velocity(Axes::ANGULAR_X, 10.0).with_max_force(2.0);
/// world.spawn((hinge, Drives::from(motor)));
///
/// Simulation::new(Settings::default())?.step_many(&mut world, 120);
/// let angular_velocity = world.get::<&Velocity>(wheel)?.angular;
/// assert!((angular_velocity.y - 10.0).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("motor", "servo", "actuator"))]
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Drives(pub Vec<Drive>);

impl From<Drive> for Drives {
    fn from(drive: Drive) -> Self {
        Self(vec![drive])
    }
}

/// A motor, a servo or a spring along free axes of a joint.
///
/// A spring pulls with `-stiffness (value - position) - damping (speed - velocity)`, by
/// [`JointLoad::values`](crate::JointLoad::values) and speeds; a rigid one does what it takes to
/// reach its position, or to keep its velocity, up to its greatest force. Values of rotations are
/// between -pi and pi, so the way to a position is the shorter one.
///
/// ```
/// use tumble::{Axes, Drive};
///
/// let suspension = Drive::position(Axes::LINEAR_X, 0.3).with_stiffness(2e4, 1e3);
/// let motor = Drive::velocity(Axes::ANGULAR_X, -5.0).with_max_force(40.0);
/// assert!(suspension.position.is_some() && motor.position.is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Along or about which axes: each for itself, but for three rotations, of which the positions
    /// together are a rotation vector.
    pub axes: Axes,
    /// Where to, if anywhere \[m\] \[rad\]. A rigid drive goes there at 3 m/s or 10 rad/s at most.
    pub position: Option<Real>,
    /// How fast \[m/s\] \[rad/s\]. A rigid drive to a position does not use it.
    pub velocity: Real,
    /// How hard. Without a position the stiffness does nothing.
    pub gain: Gain,
    /// The greatest force \[N\] or torque [N m]; infinite if there is none.
    pub max_force: Real,
    /// How the position oscillates, if it does. Without a position it does nothing.
    pub oscillation: Option<Oscillation>,
}

impl Drive {
    /// Keeps a velocity \[m/s\] \[rad/s\]: a motor.
    pub const fn velocity(axes: Axes, velocity: Real) -> Self {
        Self { axes, position: None, velocity, gain: Gain::Rigid, max_force: Real::INFINITY, oscillation: None }
    }

    /// Goes to a position \[m\] \[rad\] and stays there: a servo.
    pub const fn position(axes: Axes, position: Real) -> Self {
        Self { position: Some(position), ..Self::velocity(axes, 0.0) }
    }

    /// The same as a spring and a damper.
    #[must_use]
    pub const fn with_stiffness(self, stiffness: Real, damping: Real) -> Self {
        Self { gain: Gain::Stiffness { stiffness, damping }, ..self }
    }

    /// The same as a spring and a damper of a frequency \[Hz\].
    #[must_use]
    pub const fn with_frequency(self, hertz: Real, damping_ratio: Real) -> Self {
        Self { gain: Gain::Frequency { hertz, damping_ratio }, ..self }
    }

    /// The same as a spring [1/s^2] and a damper [1/s] for each kilogram, or kg m^2.
    #[must_use]
    pub const fn with_acceleration(self, stiffness: Real, damping: Real) -> Self {
        Self { gain: Gain::Acceleration { stiffness, damping }, ..self }
    }

    /// The same with a greatest force \[N\] or torque [N m].
    #[must_use]
    pub const fn with_max_force(self, max_force: Real) -> Self {
        Self { max_force, ..self }
    }

    /// The same with a position that oscillates, as a joint of a gait does.
    #[must_use]
    pub const fn with_oscillation(self, oscillation: Oscillation) -> Self {
        Self { oscillation: Some(oscillation), ..self }
    }

    /// Whether its target moves by itself.
    pub(crate) fn oscillates(&self) -> bool {
        self.position.is_some() && self.oscillation.is_some()
    }

    /// Where to at a time \[s\], if anywhere, and how fast.
    pub(crate) fn target(&self, time: f64) -> (Option<f64>, f64) {
        let (position, velocity) = (self.position.map(f64::from), f64::from(self.velocity));
        match (position, self.oscillation) {
            (Some(position), Some(oscillation)) => {
                let [way, speed] = oscillation.at(time);
                (Some(position + way), velocity + speed)
            }
            _ => (position, velocity),
        }
    }

    /// Whether its numbers can be reckoned with.
    pub(crate) fn is_in_range(&self) -> bool {
        self.gain.is_in_range()
            && self.max_force >= 0.0
            && self.velocity.is_finite()
            && self.position.is_none_or(Real::is_finite)
            && self.oscillation.is_none_or(|it| it.is_in_range())
    }
}
