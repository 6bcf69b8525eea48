//! What the driver does, and what the wheels do: the components beside [`Vehicle`](crate::Vehicle).

use tumble::hecs::Entity;
use tumble::math::{Real, Vec3};

use crate::error::MAX_WHEELS;

/// What the driver does: a component to be written whenever it changes.
///
/// Numbers beyond their range count as its end, and what is not a number as zero.
///
/// ```
/// use tumble_vehicle::VehicleInput;
///
/// let parked = VehicleInput { hand_brake: 1.0, ..VehicleInput::default() };
/// assert_eq!(parked.throttle, 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct VehicleInput {
    /// From -1, full power backwards, to 1.
    pub throttle: Real,
    /// From 0 to 1: all wheels, by their `brake_torque`.
    pub brake: Real,
    /// From 0 to 1: by their `hand_brake_torque`.
    pub hand_brake: Real,
    /// From -1, to the right, to 1, to the left: as rotations about the chassis's y axis have it.
    pub steering: Real,
}

impl VehicleInput {
    /// The same within its ranges.
    pub(crate) fn checked(self) -> [f64; 4] {
        let within = |value: Real, low: f64| {
            let value = f64::from(value);
            if value.is_finite() { value.clamp(low, 1.0) } else { 0.0 }
        };
        [
            within(self.throttle, -1.0),
            within(self.brake, 0.0),
            within(self.hand_brake, 0.0),
            within(self.steering, -1.0),
        ]
    }
}

/// Where a wheel is on the ground.
///
/// ```
/// # use tumble::prelude::*;
/// # use tumble_vehicle::{VehiclePlan, VehicleState, drive_vehicles};
/// # let mut world = tumble::hecs::World::new();
/// let ground = spawn_ground(&mut world);
/// let car = VehiclePlan::car(4.5, 1500.0).spawn(&mut world, Pose::default())?;
/// drive_vehicles(&mut world, &Simulation::new(Settings::default())?);
/// let contact = world.get::<&VehicleState>(car)?.wheels()[0].contact.unwrap();
/// assert_eq!((contact.ground, contact.normal), (ground, Vec3::Y));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelContact {
    /// The body under the wheel.
    pub ground: Entity,
    /// Where it touches \[m\], world frame.
    pub point: Vec3,
    /// Of the ground, towards the wheel; unit vector, world frame.
    pub normal: Vec3,
    /// Along the ground where the wheel rolls to; unit vector, world frame.
    pub forward: Vec3,
}

/// What a wheel does, as [`drive_vehicles`](crate::drive_vehicles) left it.
///
/// ```
/// # use tumble::prelude::*;
/// # use tumble_vehicle::{VehiclePlan, VehicleState, drive_vehicles};
/// # let mut world = tumble::hecs::World::new();
/// # spawn_ground(&mut world);
/// # let car = VehiclePlan::car(4.5, 1500.0).spawn(&mut world, Pose::default())?;
/// drive_vehicles(&mut world, &Simulation::new(Settings::default())?);
/// let wheel = world.get::<&VehicleState>(car)?.wheels()[0];
/// // A quarter of the weight, on a spring of 33 kN/m.
/// assert!((wheel.load - 1500.0 * 9.81 / 4.0).abs() < 1.0);
/// assert!((wheel.compression - 0.1104).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct WheelState {
    /// Where it touches the ground; `None` in the air.
    pub contact: Option<WheelContact>,
    /// Force of the ground along the normal \[N\].
    pub load: Real,
    /// Force of the ground along `forward` \[N\].
    pub longitudinal_force: Real,
    /// Force of the ground to the left of `forward` \[N\].
    pub lateral_force: Real,
    /// Force of spring, damper, bump stop and bar on the chassis, along its y axis \[N\].
    pub suspension_force: Real,
    /// Compression of the suspension from where the wheel hangs free \[m\]; zero in the air.
    pub compression: Real,
    /// Angular velocity about the axle [rad/s], positive ahead.
    pub spin: Real,
    /// Angle that it has turned about the axle \[rad\], from -pi to pi.
    pub spin_angle: Real,
    /// Angle about the chassis's y axis that it is steered by \[rad\], positive to the left.
    pub steering_angle: Real,
    /// `(spin radius - speed) / max(|speed|, |spin radius|)`: positive where it drives, -1 locked.
    pub slip_ratio: Real,
    /// Angle of its motion over the ground to where it points \[rad\], positive where it goes to
    /// the left of that.
    pub slip_angle: Real,
    /// Shear of the tyre \[m\], along and across.
    pub(crate) shear: [f64; 2],
    /// Speeds along and across, with which the step was thought to end [m/s].
    pub(crate) speeds: [f64; 2],
    /// Velocity of the ground along the normal, along and across [m/s].
    pub(crate) ground: [f64; 3],
    /// Whether ground was in reach.
    pub(crate) met: bool,
    /// Compression to that ground \[m\], whether it pushed or not; negative of a gap.
    pub(crate) reach: f64,
    /// How much further the suspension is compressed than its spring \[m\].
    pub(crate) slack: f64,
}

/// What the wheels of a vehicle do and what they remember: a component that
/// [`drive_vehicles`](crate::drive_vehicles) writes, and adds where there is none.
///
/// It is state. Who goes back in time keeps a copy of it beside the snapshot, which is all there is
/// to do: it is plain numbers.
///
/// ```
/// let mut state = tumble_vehicle::VehicleState::default();
/// let kept = state;
/// state.set_spin(0, 30.0);
/// assert_ne!(state, kept);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleState {
    pub(crate) wheels: [WheelState; MAX_WHEELS],
    pub(crate) count: usize,
    pub(crate) steering: f64,
}

impl Default for VehicleState {
    fn default() -> Self {
        Self { wheels: [WheelState::default(); MAX_WHEELS], count: 0, steering: 0.0 }
    }
}

impl VehicleState {
    /// The wheels, in the order of the settings; none before the first
    /// [`drive_vehicles`](crate::drive_vehicles).
    #[must_use]
    pub fn wheels(&self) -> &[WheelState] {
        &self.wheels[..self.count.min(MAX_WHEELS)]
    }

    /// Lets a wheel spin [rad/s], as that of a vehicle that begins at speed. `wheel` beyond the
    /// last does nothing.
    pub fn set_spin(&mut self, wheel: usize, spin: Real) {
        if let Some(state) = self.wheels.get_mut(wheel)
            && spin.is_finite()
        {
            state.spin = spin;
        }
    }

    /// The angle of steering \[rad\], before it is shared out to the wheels.
    #[must_use]
    pub fn steering_angle(&self) -> Real {
        self.steering as Real
    }

    /// How many wheels are on the ground.
    #[must_use]
    pub fn wheels_on_ground(&self) -> usize {
        self.wheels().iter().filter(|wheel| wheel.contact.is_some()).count()
    }
}
