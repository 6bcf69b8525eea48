//! The component of a chassis, and where its wheels are.

use tumble::glam::{DQuat, DVec3};
use tumble::hecs::World;
use tumble::math::{dquat, dvec3};
use tumble::{CenterOfMass, Collider, Pose, Shape};

use crate::error::VehicleError;
use crate::precision::{quat, vec3};
use crate::settings::{Probe, VehicleSettings};
use crate::state::{VehicleInput, VehicleState};

/// A vehicle on ray-cast wheels: a component of a dynamic body, the chassis.
///
/// The frame of the chassis has x to the left, y up and z ahead. The mass of the wheels is in that
/// of the chassis. [`drive_vehicles`](crate::drive_vehicles) reads it together with
/// [`VehicleInput`] and writes [`VehicleState`].
///
/// ```
/// use tumble::prelude::*;
/// use tumble_vehicle::{VehicleInput, VehiclePlan, VehicleState, drive_vehicles};
///
/// let mut world = tumble::hecs::World::new();
/// spawn_ground(&mut world);
/// let car = VehiclePlan::car(4.5, 1500.0).spawn(&mut world, Pose::default())?;
/// let mut simulation = Simulation::new(Settings::default())?;
/// world.get::<&mut VehicleInput>(car)?.throttle = 1.0;
/// for _ in 0..120 {
///     drive_vehicles(&mut world, &simulation);
///     simulation.step(&mut world);
/// }
/// assert!(world.get::<&Velocity>(car)?.linear.z > 5.0);
/// assert_eq!(world.get::<&VehicleState>(car)?.wheels_on_ground(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Vehicle {
    settings: VehicleSettings,
    /// What each wheel looks for the ground with; none of rays.
    probes: Vec<Collider>,
    layout: SteeringLayout,
}

/// Around where the vehicle turns, as far as its wheels say.
#[derive(Clone, Copy, Debug)]
struct SteeringLayout {
    /// Where the axles that are not steered are on the average, along z \[m\].
    pivot: f64,
    /// From there to the wheels that are steered most \[m\].
    wheelbase: f64,
}

impl SteeringLayout {
    fn of(settings: &VehicleSettings) -> Self {
        let mean = |places: Vec<f64>| {
            let count = places.len() as f64;
            (count > 0.0).then(|| places.iter().sum::<f64>() / count)
        };
        let along = |filter: &dyn Fn(f64) -> bool| {
            let wheels = settings.wheels.iter().filter(|wheel| filter(wheel.steering.into()));
            mean(wheels.map(|wheel| f64::from(wheel.position.z)).collect())
        };
        let most = settings.wheels.iter().map(|wheel| f64::from(wheel.steering).abs()).fold(0.0, f64::max);
        let pivot = along(&|steering| steering == 0.0).or_else(|| along(&|_| true)).unwrap_or(0.0);
        let leading = along(&|steering| steering.abs() == most).unwrap_or(pivot);
        Self { pivot, wheelbase: leading - pivot }
    }
}

impl Vehicle {
    /// A vehicle of these settings.
    ///
    /// # Errors
    /// [`VehicleError`] names the first setting that cannot be.
    pub fn new(settings: VehicleSettings) -> Result<Self, VehicleError> {
        settings.validate()?;
        let shape = |wheel: &crate::settings::Wheel| match settings.probe {
            Probe::Ray => None,
            Probe::Sphere => Some(Shape::sphere(f64::from(wheel.radius))),
            Probe::Cylinder => Some(Shape::cylinder(f64::from(wheel.radius), 0.5 * f64::from(wheel.width))),
        };
        let probes = settings.wheels.iter().filter_map(shape);
        let probes = probes.map(|shape| Collider::new(&shape)).collect::<Result<_, _>>();
        let probes = probes.map_err(tumble::BodyError::from)?;
        let layout = SteeringLayout::of(&settings);
        Ok(Self { settings, probes, layout })
    }

    /// All that a chassis needs beside its body: for
    /// [`spawn_with`](tumble::Body::spawn_with) or [`World::insert`].
    #[must_use]
    pub fn components(self) -> (Self, VehicleInput, VehicleState) {
        (self, VehicleInput::default(), VehicleState::default())
    }

    /// What it is made of.
    #[must_use]
    pub fn settings(&self) -> &VehicleSettings {
        &self.settings
    }

    /// Changes the settings between two steps.
    ///
    /// # Errors
    /// [`VehicleError`], and the old settings stay.
    pub fn set_settings(&mut self, settings: VehicleSettings) -> Result<(), VehicleError> {
        *self = Self::new(settings)?;
        Ok(())
    }

    /// Where a wheel is for drawing, world frame: its frame has x along the axle to the left, and
    /// turns as it rolls. `chassis` is the pose of the chassis, between two steps too.
    ///
    /// `None` of a wheel that there is not.
    #[must_use]
    pub fn wheel_pose(
        &self,
        wheel: usize,
        state: &VehicleState,
        chassis: &Pose,
        center_of_mass: Option<&CenterOfMass>,
    ) -> Option<Pose> {
        let (settings, state) = (self.settings.wheels.get(wheel)?, state.wheels().get(wheel)?);
        let up = DVec3::Y * f64::from(state.compression);
        let from_center = dvec3(settings.position) + up - center_of_mass.map_or(DVec3::ZERO, |it| dvec3(it.0));
        let orientation = dquat(chassis.orientation);
        let position = dvec3(chassis.position) + orientation * from_center;
        let turned = about_y(state.steering_angle.into()) * about_x(state.spin_angle.into());
        Some(Pose { position: vec3(position), orientation: quat((orientation * turned).normalize()) })
    }

    /// The angle that a wheel is steered by at an angle of steering \[rad\].
    pub(crate) fn angle_of_wheel(&self, wheel: usize, steering: f64) -> f64 {
        let settings = &self.settings.wheels[wheel];
        let share = f64::from(settings.steering);
        if share == 0.0 || steering == 0.0 {
            return 0.0;
        }
        let parallel = share * steering;
        let SteeringLayout { pivot, wheelbase } = self.layout;
        if wheelbase == 0.0 {
            return parallel;
        }
        // The centre of the turn is on the line of the axle that is not steered.
        let curvature = libm::tan(steering) / wheelbase;
        let (ahead, left) = (f64::from(settings.position.z) - pivot, f64::from(settings.position.x));
        let beside = 1.0 - curvature * left;
        let around = if beside > 0.05 { libm::atan(curvature * ahead / beside) } else { parallel };
        let ackermann = f64::from(self.settings.ackermann);
        parallel + ackermann * (around - parallel)
    }

    pub(crate) fn probe(&self, wheel: usize) -> Option<&Collider> {
        self.probes.get(wheel)
    }
}

/// Where all wheels of a vehicle are for drawing, as the last step left it; none of an entity that
/// is no vehicle.
///
/// ```
/// use tumble::prelude::*;
/// use tumble_vehicle::{VehiclePlan, drive_vehicles, wheel_poses};
///
/// let mut world = tumble::hecs::World::new();
/// let car = VehiclePlan::car(4.5, 1500.0).spawn(&mut world, Pose::default())?;
/// drive_vehicles(&mut world, &Simulation::new(Settings::default())?);
/// let wheels = wheel_poses(&world, car);
/// // The left front wheel hangs free.
/// assert!(wheels[0].position.x > 0.5 && wheels[0].position.z > 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn wheel_poses(world: &World, vehicle: tumble::hecs::Entity) -> Vec<Pose> {
    let mut found = world.query_one::<(&Vehicle, &VehicleState, &Pose, Option<&CenterOfMass>)>(vehicle);
    let Ok((vehicle, state, pose, center)) = found.get() else { return Vec::new() };
    (0..state.count).filter_map(|wheel| vehicle.wheel_pose(wheel, state, pose, center)).collect()
}

/// A rotation about y by an angle \[rad\].
pub(crate) fn about_y(angle: f64) -> DQuat {
    DQuat::from_xyzw(0.0, libm::sin(0.5 * angle), 0.0, libm::cos(0.5 * angle))
}

/// A rotation about x by an angle \[rad\].
pub(crate) fn about_x(angle: f64) -> DQuat {
    DQuat::from_xyzw(libm::sin(0.5 * angle), 0.0, 0.0, libm::cos(0.5 * angle))
}

/// The input and state that a step of a vehicle begins with.
#[derive(Clone, Copy)]
pub(crate) struct Driver {
    pub(crate) throttle: f64,
    pub(crate) brake: f64,
    pub(crate) hand_brake: f64,
    /// After the steering has moved, and where each wheel points then \[rad\].
    pub(crate) steering: f64,
}

impl Driver {
    /// Turns the steering towards where it is to be.
    pub(crate) fn of(settings: &VehicleSettings, input: VehicleInput, state: &VehicleState, dt: f64) -> Self {
        let [throttle, brake, hand_brake, steering] = input.checked();
        let wanted = steering * f64::from(settings.max_steering);
        let most = f64::from(settings.steering_speed) * dt;
        let steering = state.steering + (wanted - state.steering).clamp(-most, most);
        Self { throttle, brake, hand_brake, steering }
    }
}
