//! What a vehicle on ray-cast wheels is made of: springs, tyres, wheels, bars and the motor.

use tumble::math::{Real, Vec3};

use crate::error::{Check, MAX_WHEELS, VehicleError};

/// A spring and a damper that carry one wheel, which moves along the chassis's y axis.
///
/// With the compression `x` \[m\] from where the wheel hangs free, the force is
/// `stiffness x + damping dx/dt`, and from `travel` on the bump stop adds to it. It never pulls.
///
/// ```
/// let spring = tumble_vehicle::VehiclePlan::car(4.5, 1500.0).settings()?.wheels[0].suspension;
/// // A quarter of the weight, and the deflection that it makes.
/// assert!((spring.stiffness * 0.1104 / (375.0 * 9.81) - 1.0).abs() < 1e-3);
/// # Ok::<(), tumble_vehicle::VehicleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suspension {
    /// Force per compression [N/m]. Of the car of 1500 kg: 33 kN/m.
    pub stiffness: Real,
    /// Force per speed while it is compressed [N s/m].
    pub compression_damping: Real,
    /// Force per speed while it extends [N s/m].
    pub rebound_damping: Real,
    /// From where the wheel hangs free to the bump stop \[m\].
    pub travel: Real,
    /// Force per compression beyond the travel [N/m], added to that of the spring.
    pub bump_stiffness: Real,
}

/// Rubber on the road: how hard it grips, and how far it slips for that.
///
/// See `docs/vehicles.md` for the equations.
///
/// ```
/// let wet = tumble_vehicle::Tyre::default().with_friction(0.5);
/// assert_eq!((wet.lateral_friction, wet.lateral_stiffness), (0.5, 12.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tyre {
    /// Greatest force along the wheel over load. 1 unless set.
    pub longitudinal_friction: Real,
    /// Greatest force across the wheel over load. 1 unless set.
    pub lateral_friction: Real,
    /// Force along the wheel over load, per slip ratio, for little slip. 15 unless set.
    pub longitudinal_stiffness: Real,
    /// Force across the wheel over load, per radian of slip angle, for little slip. 12 unless set.
    pub lateral_stiffness: Real,
    /// Shape factor of the slip curve, from 1 to 2: at 1 it does not fall after its peak, and the
    /// more the larger. 1.3 unless set: sliding on and on is 0.89 of the peak.
    pub shape: Real,
    /// How far the tyre rolls until its force has followed to 63 % \[m\]. A wheel's radius of the
    /// car, 0.315, unless set.
    pub relaxation_length: Real,
    /// Resistance to rolling over load. 0.012 unless set.
    pub rolling_resistance: Real,
}

impl Default for Tyre {
    fn default() -> Self {
        Self {
            longitudinal_friction: 1.0,
            lateral_friction: 1.0,
            longitudinal_stiffness: 15.0,
            lateral_stiffness: 12.0,
            shape: 1.3,
            relaxation_length: 0.315,
            rolling_resistance: 0.012,
        }
    }
}

impl Tyre {
    /// The same with one greatest force over load for all directions.
    #[must_use]
    pub fn with_friction(self, friction: Real) -> Self {
        Self { longitudinal_friction: friction, lateral_friction: friction, ..self }
    }
}

/// One wheel: where it is, and what is done with it.
///
/// ```
/// let settings = tumble_vehicle::VehiclePlan::car(4.5, 1500.0).settings()?;
/// let [left, right] = [settings.wheels[0], settings.wheels[1]];
/// assert_eq!(left.position.x, -right.position.x);
/// assert!(left.position.x > 0.0 && left.steering == 1.0);
/// # Ok::<(), tumble_vehicle::VehicleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    /// The centre of the wheel as it hangs free \[m\], in the chassis's own frame: x to the left, y
    /// up, z ahead.
    pub position: Vec3,
    /// Radius \[m\].
    pub radius: Real,
    /// From side to side \[m\]. Only [`Probe::Cylinder`] has use for it.
    pub width: Real,
    /// Moment of inertia about the axle [kg m^2], with what turns with it.
    pub inertia: Real,
    /// What carries it.
    pub suspension: Suspension,
    /// What it grips with.
    pub tyre: Tyre,
    /// How much of the steering angle it gets, from -1 to 1: 1 of a front wheel, 0 of one that is
    /// not steered, negative at the rear of a vehicle that is steered at both ends.
    pub steering: Real,
    /// Its share of the motor's torque; the shares of all wheels are divided by their sum. 0 of one
    /// that is not driven.
    pub drive: Real,
    /// Torque of the brake at full [N m].
    pub brake_torque: Real,
    /// Torque of the hand brake at full [N m].
    pub hand_brake_torque: Real,
}

/// A bar that takes the difference of compression of two wheels, so that the body leans less.
///
/// ```
/// use tumble_vehicle::{AntiRollBar, VehiclePlan};
///
/// let mut settings = VehiclePlan::car(4.5, 1500.0).settings()?;
/// settings.anti_roll_bars = vec![AntiRollBar { wheels: [0, 1], stiffness: 2e4 }];
/// assert!(settings.validate().is_ok());
/// # Ok::<(), tumble_vehicle::VehicleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AntiRollBar {
    /// The wheels that it joins, by number.
    pub wheels: [usize; 2],
    /// Force at either wheel per difference of compression [N/m].
    pub stiffness: Real,
}

/// The motor, with its gears: torque at the wheels.
///
/// Each driven wheel gets its share of `min(torque, power / spin)` times the throttle, and of that
/// less and less in the last tenth before its `max_spin`.
///
/// ```
/// let motor = tumble_vehicle::VehiclePlan::car(4.5, 1500.0).settings()?.motor;
/// // Up to 15 m/s the torque is what there is, from there on the power.
/// assert!((motor.power / motor.torque * 0.315 - 15.0).abs() < 1e-3);
/// # Ok::<(), tumble_vehicle::VehicleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Torque at all wheels together [N m].
    pub torque: Real,
    /// Power at all wheels together \[W\].
    pub power: Real,
    /// Spin of a wheel from which on it is not driven [rad/s].
    pub max_spin: Real,
    /// The same backwards [rad/s].
    pub max_reverse_spin: Real,
    /// Torque of the motor against the driven wheels while there is no throttle [N m].
    pub drag: Real,
}

/// How a wheel looks for the ground.
///
/// ```
/// use tumble_vehicle::{Probe, VehiclePlan};
///
/// let plan = VehiclePlan { probe: Probe::Cylinder, ..VehiclePlan::car(4.5, 1500.0) };
/// assert_eq!(plan.settings()?.probe, Probe::Cylinder);
/// # Ok::<(), tumble_vehicle::VehicleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Probe {
    /// By one ray along the suspension. The cheapest; it steps onto a kerb at once, and sees
    /// nothing that is narrower than the wheel and beside its middle.
    #[default]
    Ray,
    /// By a ball of the wheel's radius that is moved along the suspension: it rolls over kerbs and
    /// stones. It also meets what is up to a radius beside the wheel.
    Sphere,
    /// By the wheel itself, a cylinder.
    Cylinder,
}

/// All settings of a vehicle on ray-cast wheels. [`VehiclePlan`](crate::VehiclePlan) makes them
/// from size and mass.
///
/// ```
/// use tumble_vehicle::{Vehicle, VehiclePlan};
///
/// let mut settings = VehiclePlan::truck(10.0, 12e3).settings()?;
/// settings.wheels.truncate(4);
/// settings.anti_roll_bars.clear();
/// assert!(Vehicle::new(settings).is_ok());
/// # Ok::<(), tumble_vehicle::VehicleError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleSettings {
    /// The wheels, up to [`MAX_WHEELS`].
    pub wheels: Vec<Wheel>,
    /// Bars between them.
    pub anti_roll_bars: Vec<AntiRollBar>,
    /// What drives them.
    pub motor: Motor,
    /// Angle of a front wheel at full steering \[rad\], below a quarter turn.
    pub max_steering: Real,
    /// How fast that angle changes at the most [rad/s].
    pub steering_speed: Real,
    /// How far the inner wheel is steered more than the outer: 0, both alike, to 1, both around one
    /// centre of the turn.
    pub ackermann: Real,
    /// How wheels look for the ground.
    pub probe: Probe,
    /// Which colliders are ground: groups that the wheels are of, and those that they touch, as
    /// [`Collider::with_groups`](tumble::Collider::with_groups) has it.
    pub groups: (u32, u32),
}

impl VehicleSettings {
    /// Whether a vehicle can be made of these.
    ///
    /// # Errors
    /// [`VehicleError`] names the first setting that cannot be.
    pub fn validate(&self) -> Result<(), VehicleError> {
        let wheels = self.wheels.len();
        if !(1..=MAX_WHEELS).contains(&wheels) {
            return Err(VehicleError::Wheels(wheels));
        }
        for (index, wheel) in self.wheels.iter().enumerate() {
            wheel.check(&format!("wheels[{index}]."))?;
        }
        for (index, bar) in self.anti_roll_bars.iter().enumerate() {
            let field = format!("anti_roll_bars[{index}]");
            let joined = bar.wheels;
            if joined[0] == joined[1] || joined.iter().any(|wheel| *wheel >= wheels) {
                return Err(VehicleError::Bar { field: format!("{field}.wheels"), joined, wheels });
            }
            Check(&format!("{field}.")).not_negative("stiffness", bar.stiffness)?;
        }
        let Motor { torque, power, max_spin, max_reverse_spin, drag } = self.motor;
        let check = Check("motor.");
        check.not_negative("torque", torque)?;
        check.not_negative("power", power)?;
        check.positive("max_spin", max_spin)?;
        check.positive("max_reverse_spin", max_reverse_spin)?;
        check.not_negative("drag", drag)?;
        let check = Check("");
        check.within("max_steering", self.max_steering, 0.0, 1.5)?;
        check.not_negative("steering_speed", self.steering_speed)?;
        check.within("ackermann", self.ackermann, 0.0, 1.0)
    }
}

impl Wheel {
    fn check(&self, place: &str) -> Result<(), VehicleError> {
        let check = Check(place);
        for (field, value) in ["position.x", "position.y", "position.z"].into_iter().zip(self.position.to_array()) {
            check.within(field, value, -1e6, 1e6)?;
        }
        check.within("radius", self.radius, 1e-6, 1e6)?;
        check.within("width", self.width, 1e-6, 1e6)?;
        check.positive("inertia", self.inertia)?;
        check.within("steering", self.steering, -1.0, 1.0)?;
        check.not_negative("drive", self.drive)?;
        check.not_negative("brake_torque", self.brake_torque)?;
        check.not_negative("hand_brake_torque", self.hand_brake_torque)?;
        self.suspension.check(&format!("{place}suspension."))?;
        self.tyre.check(&format!("{place}tyre."))
    }
}

impl Suspension {
    fn check(&self, place: &str) -> Result<(), VehicleError> {
        let check = Check(place);
        check.positive("stiffness", self.stiffness)?;
        check.not_negative("compression_damping", self.compression_damping)?;
        check.not_negative("rebound_damping", self.rebound_damping)?;
        check.within("travel", self.travel, 1e-6, 1e6)?;
        check.not_negative("bump_stiffness", self.bump_stiffness)
    }
}

impl Tyre {
    fn check(&self, place: &str) -> Result<(), VehicleError> {
        let check = Check(place);
        check.within("longitudinal_friction", self.longitudinal_friction, 1e-6, 100.0)?;
        check.within("lateral_friction", self.lateral_friction, 1e-6, 100.0)?;
        check.within("longitudinal_stiffness", self.longitudinal_stiffness, 1e-3, 1e4)?;
        check.within("lateral_stiffness", self.lateral_stiffness, 1e-3, 1e4)?;
        check.within("shape", self.shape, 1.0, 1.99)?;
        check.within("relaxation_length", self.relaxation_length, 1e-6, 1e6)?;
        check.within("rolling_resistance", self.rolling_resistance, 0.0, 1.0)
    }
}
