//! A vehicle by its size and mass: what both kinds of vehicle are made from.

use tumble::hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{Body, Pose, RigidBody, Shape};

use crate::error::{Check, VehicleError};
use crate::settings::{AntiRollBar, Motor, Probe, Suspension, Tyre, VehicleSettings, Wheel};
use crate::vehicle::Vehicle;

/// Gravity that springs, motor and brakes are made for [m/s^2].
pub(crate) const GRAVITY: Real = 9.81;

/// Which wheels the motor drives.
///
/// ```
/// use tumble_vehicle::{DrivenWheels, VehiclePlan};
///
/// let plan = VehiclePlan { driven_wheels: DrivenWheels::Front, ..VehiclePlan::car(4.5, 1500.0) };
/// let wheels = plan.settings()?.wheels;
/// assert!(wheels[0].drive > 0.0 && wheels[2].drive == 0.0);
/// # Ok::<(), tumble_vehicle::VehicleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum DrivenWheels {
    /// Those of the first axle.
    Front,
    /// Those of all other axles.
    #[default]
    Rear,
    /// All.
    All,
}

/// A vehicle by its size and mass, from which its [settings](Self::settings) and its chassis are
/// made. The numbers stand for a gravity of 9.81 m/s^2.
///
/// ```
/// use tumble_vehicle::{DrivenWheels, VehiclePlan};
///
/// let mut rally = VehiclePlan::car(4.0, 1200.0);
/// rally.driven_wheels = DrivenWheels::All;
/// rally.friction = 0.7;
/// let settings = rally.settings()?;
/// // A spring carries its load at (2 pi f)^2 times the mass on it.
/// let expected = 300.0 * (2.0 * 3.14159 * rally.suspension_frequency).powi(2);
/// assert!((settings.wheels[0].suspension.stiffness / expected - 1.0).abs() < 1e-4);
/// # Ok::<(), tumble_vehicle::VehicleError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct VehiclePlan {
    /// Of the body, along z, y and x \[m\].
    pub length: Real,
    /// Height of the body, without the gap under it \[m\].
    pub height: Real,
    /// Width of the body \[m\].
    pub width: Real,
    /// From the ground to the body at rest \[m\].
    pub clearance: Real,
    /// All of it, wheels included \[kg\].
    pub mass: Real,
    /// Height of the centre of mass over the ground at rest \[m\].
    pub center_height: Real,
    /// Part of the weight on the first axle, from 0.05 to 0.95.
    pub front_load: Real,
    /// From the first axle to the middle of all others \[m\].
    pub wheelbase: Real,
    /// From the left wheels to the right ones \[m\].
    pub track: Real,
    /// How many axles there are, two to six; all but the first stand close behind each other.
    pub axles: usize,
    /// Radius of the wheels \[m\].
    pub wheel_radius: Real,
    /// Width of the wheels \[m\].
    pub wheel_width: Real,
    /// Mass of each wheel \[kg\].
    pub wheel_mass: Real,
    /// Natural frequency of the body on its springs \[Hz\].
    pub suspension_frequency: Real,
    /// Damping ratio of the body on its springs.
    pub damping_ratio: Real,
    /// Stiffness of the anti-roll bars over that of the springs beside them.
    pub anti_roll: Real,
    /// Greatest force of a tyre over its load.
    pub friction: Real,
    /// Angle of the front wheels at full steering \[rad\].
    pub max_steering: Real,
    /// Which wheels the motor drives.
    pub driven_wheels: DrivenWheels,
    /// What the motor gives at low speed, as an acceleration of the whole [m/s^2].
    pub acceleration: Real,
    /// Power of the motor \[W\].
    pub power: Real,
    /// Speed at which the motor ends [m/s].
    pub top_speed: Real,
    /// What the brakes give, as a deceleration of the whole [m/s^2].
    pub deceleration: Real,
    /// How wheels look for the ground.
    pub probe: Probe,
}

impl VehiclePlan {
    /// A car of a length \[m\] and a mass \[kg\], from a model of 30 cm to a van. Speeds and
    /// frequencies are those that a model of a car of 4.5 m has: as the root of the length.
    #[must_use]
    pub fn car(length: Real, mass: Real) -> Self {
        let pace = (length / 4.5).sqrt();
        Self {
            length,
            height: 0.24 * length,
            width: 0.4 * length,
            clearance: 0.04 * length,
            mass,
            center_height: 0.12 * length,
            front_load: 0.5,
            wheelbase: 0.6 * length,
            track: 0.34 * length,
            axles: 2,
            wheel_radius: 0.07 * length,
            wheel_width: 0.045 * length,
            wheel_mass: 0.012 * mass,
            suspension_frequency: 1.5 / pace,
            damping_ratio: 0.4,
            anti_roll: 0.5,
            friction: 1.0,
            max_steering: 0.6,
            driven_wheels: DrivenWheels::Rear,
            acceleration: 5.0,
            power: 75.0 * pace * mass,
            top_speed: 50.0 * pace,
            deceleration: 10.0,
            probe: Probe::Ray,
        }
    }

    /// A truck of a length \[m\] and a mass \[kg\], with two axles at the rear.
    #[must_use]
    pub fn truck(length: Real, mass: Real) -> Self {
        let pace = (length / 4.5).sqrt();
        Self {
            height: 0.14 * length,
            width: 0.15 * length,
            center_height: 0.065 * length,
            front_load: 0.34,
            wheelbase: 0.55 * length,
            track: 0.125 * length,
            axles: 3,
            clearance: 0.03 * length,
            wheel_radius: 0.032 * length,
            wheel_width: 0.018 * length,
            wheel_mass: 0.006 * mass,
            suspension_frequency: 2.5 / pace,
            friction: 0.8,
            acceleration: 2.0,
            power: 6.0 * pace * mass,
            top_speed: 15.0 * pace,
            deceleration: 8.0,
            ..Self::car(length, mass)
        }
    }

    fn check(&self) -> Result<(), VehicleError> {
        let check = Check("");
        let lengths = [
            ("length", self.length),
            ("height", self.height),
            ("width", self.width),
            ("clearance", self.clearance),
            ("center_height", self.center_height),
            ("wheelbase", self.wheelbase),
            ("track", self.track),
            ("wheel_radius", self.wheel_radius),
            ("wheel_width", self.wheel_width),
        ];
        for (field, value) in lengths {
            check.within(field, value, 1e-4, 1e5)?;
        }
        check.within("mass", self.mass, 1e-6, 1e9)?;
        check.within("front_load", self.front_load, 0.05, 0.95)?;
        check.within("axles", self.axles as Real, 2.0, 6.0)?;
        check.within("wheel_mass", self.wheel_mass, 1e-9, f64::from(self.mass))?;
        check.within("suspension_frequency", self.suspension_frequency, 0.01, 1e4)?;
        check.within("damping_ratio", self.damping_ratio, 0.0, 10.0)?;
        check.within("anti_roll", self.anti_roll, 0.0, 1e3)?;
        check.within("friction", self.friction, 1e-3, 10.0)?;
        check.within("acceleration", self.acceleration, 0.0, 1e6)?;
        check.not_negative("power", self.power)?;
        check.within("top_speed", self.top_speed, 1e-3, 1e5)?;
        check.within("deceleration", self.deceleration, 0.0, 1e6)
    }

    /// Deflection of the springs at rest \[m\]: `g / (2 pi f)^2`.
    #[must_use]
    pub fn static_deflection(&self) -> Real {
        GRAVITY / (self.circular_frequency() * self.circular_frequency())
    }

    pub(crate) fn circular_frequency(&self) -> Real {
        std::f64::consts::TAU as Real * self.suspension_frequency
    }

    /// Part of the weight on each wheel of an axle.
    pub(crate) fn load_share(&self, axle: usize) -> Real {
        let of_axle = if axle == 0 { self.front_load } else { (1.0 - self.front_load) / (self.axles - 1) as Real };
        0.5 * of_axle
    }

    /// Where an axle is, along z from the centre of mass \[m\].
    pub(crate) fn axle_place(&self, axle: usize) -> Real {
        let rear = -self.front_load * self.wheelbase;
        if axle == 0 {
            return rear + self.wheelbase;
        }
        let middle = 0.5 * self.axles as Real;
        rear + (middle - axle as Real) * 2.4 * self.wheel_radius
    }

    /// The centre of mass in the frame of the chassis, whose origin is the middle of its box \[m\].
    pub(crate) fn center_of_mass(&self) -> Vec3 {
        Vec3::Y * (self.center_height - self.clearance - 0.5 * self.height)
    }

    pub(crate) fn is_driven(&self, axle: usize) -> bool {
        match self.driven_wheels {
            DrivenWheels::Front => axle == 0,
            DrivenWheels::Rear => axle > 0,
            DrivenWheels::All => true,
        }
    }

    /// The settings of a vehicle on ray-cast wheels: first the left and the right wheel of the
    /// first axle, then those of the others.
    ///
    /// # Errors
    /// [`VehicleError`] names the first number that cannot be.
    pub fn settings(&self) -> Result<VehicleSettings, VehicleError> {
        self.check()?;
        let mut wheels = Vec::new();
        let mut anti_roll_bars = Vec::new();
        for axle in 0..self.axles {
            let stiffness = self.anti_roll * self.suspension(axle).stiffness;
            anti_roll_bars.push(AntiRollBar { wheels: [2 * axle, 2 * axle + 1], stiffness });
            wheels.extend([1.0, -1.0].map(|side| self.wheel(axle, side)));
        }
        let settings = VehicleSettings {
            wheels,
            anti_roll_bars,
            motor: Motor {
                torque: self.acceleration * self.mass * self.wheel_radius,
                power: self.power,
                max_spin: self.top_speed / self.wheel_radius,
                max_reverse_spin: 0.25 * self.top_speed / self.wheel_radius,
                drag: 0.03 * GRAVITY * self.mass * self.wheel_radius,
            },
            max_steering: self.max_steering,
            steering_speed: 1.5,
            ackermann: 1.0,
            probe: self.probe,
            groups: (u32::MAX, u32::MAX),
        };
        settings.validate()?;
        Ok(settings)
    }

    /// The spring of a wheel: its own part of the mass at the frequency of the plan.
    pub(crate) fn suspension(&self, axle: usize) -> Suspension {
        let mass = self.mass * self.load_share(axle);
        let frequency = self.circular_frequency();
        let damping = 2.0 * self.damping_ratio * mass * frequency;
        let stiffness = mass * frequency * frequency;
        Suspension {
            stiffness,
            compression_damping: damping,
            rebound_damping: damping,
            travel: 2.0 * self.static_deflection(),
            bump_stiffness: 10.0 * stiffness,
        }
    }

    /// Where a wheel hangs free, in the frame of the chassis \[m\].
    pub(crate) fn hanging(&self, axle: usize, side: Real) -> Vec3 {
        let height = self.wheel_radius - self.clearance - 0.5 * self.height - self.static_deflection();
        Vec3::new(side * 0.5 * self.track, height, self.axle_place(axle))
    }

    fn wheel(&self, axle: usize, side: Real) -> Wheel {
        let weight = GRAVITY * self.mass * self.load_share(axle);
        let is_rear = axle > 0;
        Wheel {
            position: self.hanging(axle, side),
            radius: self.wheel_radius,
            width: self.wheel_width,
            inertia: 0.5 * self.wheel_mass * self.wheel_radius * self.wheel_radius,
            suspension: self.suspension(axle),
            tyre: Tyre { relaxation_length: self.wheel_radius, ..Tyre::default().with_friction(self.friction) },
            steering: if is_rear { 0.0 } else { 1.0 },
            drive: if self.is_driven(axle) { weight } else { 0.0 },
            brake_torque: self.deceleration * self.mass * self.load_share(axle) * self.wheel_radius,
            hand_brake_torque: if is_rear { 1.2 * weight * self.wheel_radius } else { 0.0 },
        }
    }

    /// The body of the chassis, at rest over the ground at a place: a box. It collides.
    pub(crate) fn chassis(&self, mass: Real, ground: Pose) -> RigidBody {
        let center = self.center_of_mass();
        let half = [self.width, self.height, self.length].map(|edge| 0.5 * f64::from(edge));
        let above = ground.transform_point(Vec3::Y * (self.clearance + 0.5 * self.height));
        RigidBody::new(Shape::cuboid(half))
            .mass(f64::from(mass))
            .center_of_mass(tumble::math::dvec3(center))
            .position(above)
            .orientation(ground.orientation)
    }

    /// The body of the chassis and the vehicle, to be changed before they are spawned. `ground` is
    /// where it stands: the point under the middle of the box, y up and z ahead.
    ///
    /// # Errors
    /// [`VehicleError`] names the first number that cannot be.
    pub fn build(&self, ground: Pose) -> Result<(RigidBody, Vehicle), VehicleError> {
        let vehicle = Vehicle::new(self.settings()?)?;
        Ok((self.chassis(self.mass, ground), vehicle))
    }

    /// Spawns the vehicle at rest on its wheels at a place on the ground, y up and z ahead.
    ///
    /// # Errors
    /// [`VehicleError`] names the first number that cannot be.
    pub fn spawn(&self, world: &mut World, ground: Pose) -> Result<Entity, VehicleError> {
        let (body, vehicle) = self.build(ground)?;
        let body: Body = body.build()?;
        Ok(body.spawn_with(world, vehicle.components()))
    }
}
