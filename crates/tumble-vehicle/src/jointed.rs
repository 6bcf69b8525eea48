//! A vehicle whose wheels are bodies on joints: sliders and cylinders with springs, and driven
//! hinges.

use tumble::glam::{DQuat, DVec3};
use tumble::hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3, dquat, dvec3};
use tumble::{
    Axes, BodyId, BodyOrder, Drive, Drives, IgnoreContacts, Joint, JointFriction, JointLoad, Limit, Limits, Material,
    Pose, RigidBody, Shape, Simulation,
};

use crate::error::VehicleError;
use crate::plan::{GRAVITY, VehiclePlan};
use crate::precision::{quat, real, vec3};
use crate::rigid::Rigid;
use crate::state::{VehicleInput, VehicleState};
use crate::vehicle::{Driver, Vehicle};

/// Part of the mass of a wheel that does not turn with it.
const CARRIER: Real = 0.2;

/// The entities of one wheel of a [`JointedVehicle`].
///
/// ```
/// # use tumble::prelude::*;
/// # use tumble_vehicle::{JointedVehicle, VehiclePlan};
/// # let mut world = tumble::hecs::World::new();
/// let car = VehiclePlan::car(4.5, 1500.0).spawn_on_joints(&mut world, Pose::default(), None)?;
/// let left = world.get::<&JointedVehicle>(car)?.wheels()[0];
/// assert!((world.get::<&Pose>(left.wheel)?.position.y - 0.315).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointedWheel {
    /// The body that rolls.
    pub wheel: Entity,
    /// The body that carries it, between suspension and axle.
    pub carrier: Entity,
    /// The joint of chassis and carrier: a slider, or a cylinder where the wheel is steered. Its
    /// [`JointLoad`] has the compression from rest \[m\] as its first value.
    pub suspension: Entity,
    /// The joint of carrier and wheel: a hinge. Its [`JointLoad`] has the spin [rad/s] as its
    /// fourth speed.
    pub axle: Entity,
}

/// A vehicle on joints: a component of its chassis, which [`drive_jointed_vehicles`] reads together
/// with [`VehicleInput`].
///
/// The angle of steering is the only state in it; who goes back in time keeps a copy.
///
/// Wheels touch the ground as all bodies do, with the friction of contacts in place of a slip
/// curve. There are no anti-roll bars. [`VehiclePlan::spawn_on_joints`] makes one.
///
/// ```
/// # use tumble::prelude::*;
/// # use tumble_vehicle::{JointedVehicle, VehiclePlan};
/// # let mut world = tumble::hecs::World::new();
/// let car = VehiclePlan::car(4.5, 1500.0).spawn_on_joints(&mut world, Pose::default(), None)?;
/// let parts = JointedVehicle::clone(&*world.get::<&JointedVehicle>(car)?);
/// assert!(parts.is_whole(&world));
/// parts.despawn_wheels(&mut world);
/// assert_eq!(world.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct JointedVehicle {
    vehicle: Vehicle,
    wheels: Vec<JointedWheel>,
    /// Pairs of bodies that pass through each other.
    apart: Vec<Entity>,
    /// Torque of rolling resistance at rest [N m].
    rolling: Vec<Real>,
    steering: f64,
}

impl JointedVehicle {
    /// The wheels, in the order of [`VehiclePlan::settings`].
    #[must_use]
    pub fn wheels(&self) -> &[JointedWheel] {
        &self.wheels
    }

    /// Whether all its wheels and joints are still in a world. What is left moves as its joints let
    /// it.
    #[must_use]
    pub fn is_whole(&self, world: &World) -> bool {
        let parts = |it: &JointedWheel| [it.wheel, it.carrier, it.suspension, it.axle];
        self.wheels.iter().flat_map(parts).all(|part| world.contains(part))
    }

    /// Despawns its wheels and joints, all but the chassis. What is gone already is no matter.
    pub fn despawn_wheels(&self, world: &mut World) {
        for it in &self.wheels {
            for part in [it.axle, it.suspension, it.carrier, it.wheel] {
                let _ = world.despawn(part);
            }
        }
        for pair in &self.apart {
            let _ = world.despawn(*pair);
        }
    }
}

/// Passes on what drivers do to the joints of their vehicles: to be called before each step, as
/// [`drive_vehicles`](crate::drive_vehicles) is.
///
/// It writes [`Drives`] and [`JointFriction`] of the joints. What was despawned is left out.
///
/// ```
/// # use tumble::prelude::*;
/// # use tumble_vehicle::{VehicleInput, VehiclePlan, drive_jointed_vehicles};
/// # let mut world = tumble::hecs::World::new();
/// # spawn_ground(&mut world);
/// # let car = VehiclePlan::car(4.5, 1500.0).spawn_on_joints(&mut world, Pose::default(), None)?;
/// world.get::<&mut VehicleInput>(car)?.throttle = -1.0;
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.advance_with(&mut world, 0.1, drive_jointed_vehicles);
/// assert!(world.get::<&Velocity>(car)?.linear.z < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drive_jointed_vehicles(world: &mut World, simulation: &Simulation) {
    if world.query_mut::<&JointedVehicle>().into_iter().next().is_none() {
        return;
    }
    let dt = f64::from(simulation.settings().dt);
    for entity in BodyOrder::of(world).entities() {
        let input = world.get::<&VehicleInput>(*entity).map_or_else(|_| VehicleInput::default(), |input| *input);
        let Ok(mut vehicle) = world.get::<&mut JointedVehicle>(*entity) else { continue };
        let state = VehicleState { steering: vehicle.steering, ..VehicleState::default() };
        let driver = Driver::of(vehicle.vehicle.settings(), input, &state, dt);
        vehicle.steering = driver.steering;
        for wheel in 0..vehicle.wheels.len() {
            drive_wheel(world, &vehicle, wheel, &driver);
        }
    }
}

fn drive_wheel(world: &World, vehicle: &JointedVehicle, wheel: usize, driver: &Driver) {
    let parts = vehicle.wheels[wheel];
    let (all, settings) = (vehicle.vehicle.settings(), &vehicle.vehicle.settings().wheels[wheel]);
    if let Ok(mut drives) = world.get::<&mut Drives>(parts.suspension) {
        let angle = real(vehicle.vehicle.angle_of_wheel(wheel, driver.steering));
        let of_steering = drives.0.iter_mut().filter(|drive| drive.axes == Axes::ANGULAR_X);
        of_steering.for_each(|drive| drive.position = Some(angle));
    }
    let spin = spin(world, &parts).unwrap_or(0.0);
    let shares: f64 = all.wheels.iter().map(|wheel| f64::from(wheel.drive)).sum();
    let share = if shares > 0.0 { f64::from(settings.drive) / shares } else { 0.0 };
    let motor = &all.motor;
    if let Ok(mut drives) = world.get::<&mut Drives>(parts.axle) {
        drives.0.clear();
        if driver.throttle != 0.0 && share > 0.0 {
            let ahead = (spin * driver.throttle.signum()).max(1e-9);
            let torque = f64::from(motor.torque).min(f64::from(motor.power) / ahead) * share * driver.throttle.abs();
            let most = if driver.throttle < 0.0 { -motor.max_reverse_spin } else { motor.max_spin };
            drives.0.push(Drive::velocity(Axes::ANGULAR_X, most).with_max_force(real(torque)));
        }
    }
    if let Ok(mut friction) = world.get::<&mut JointFriction>(parts.axle) {
        let brakes =
            driver.brake * f64::from(settings.brake_torque) + driver.hand_brake * f64::from(settings.hand_brake_torque);
        let drag = if driver.throttle == 0.0 { share * f64::from(motor.drag) } else { 0.0 };
        friction.max[3] = real(brakes + drag) + vehicle.rolling[wheel];
    }
}

/// Angular velocity of a wheel about its axle against its carrier [rad/s].
fn spin(world: &World, parts: &JointedWheel) -> Option<f64> {
    let [wheel, carrier] = [parts.wheel, parts.carrier].map(|body| Rigid::of(world, body));
    let turned = dquat(world.get::<&Pose>(parts.wheel).ok()?.orientation);
    Some((wheel?.angular - carrier?.angular).dot(turned * DVec3::Y))
}

/// Gives each body and joint the next id, if there are any.
struct Ids(Option<u64>);

impl Ids {
    fn next(&mut self) -> Option<BodyId> {
        let id = self.0?;
        self.0 = id.checked_add(1);
        Some(BodyId(id))
    }

    fn on(&mut self, world: &mut World, joint: Entity) {
        if let Some(id) = self.next() {
            // The joint was spawned just now.
            let _ = world.insert_one(joint, id);
        }
    }
}

fn with_id(body: RigidBody, id: Option<BodyId>) -> RigidBody {
    match id {
        Some(id) => body.id(id),
        None => body,
    }
}

impl VehiclePlan {
    /// Spawns the vehicle on joints, at rest on its wheels at a place on the ground, y up and z
    /// ahead. Returns the chassis, which has a [`JointedVehicle`] and a [`VehicleInput`].
    ///
    /// With a first id the chassis gets it, and each wheel the next four, of carrier, wheel,
    /// suspension and axle, as snapshots want.
    ///
    /// The greatest force of a tyre over its load is that of the plan on ground of the default
    /// [`Material`]: the wheels have what makes it the mean with that.
    ///
    /// # Errors
    /// [`VehicleError`] names the first number that cannot be. Nothing is spawned then, or what was
    /// spawned is despawned again.
    ///
    /// ```
    /// use tumble::prelude::*;
    /// use tumble_vehicle::{VehicleInput, VehiclePlan, drive_jointed_vehicles};
    ///
    /// let mut world = tumble::hecs::World::new();
    /// spawn_ground(&mut world);
    /// let plan = VehiclePlan::car(4.5, 1500.0);
    /// let car = plan.spawn_on_joints(&mut world, Pose::default(), None)?;
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// world.get::<&mut VehicleInput>(car)?.throttle = 0.5;
    /// for _ in 0..120 {
    ///     drive_jointed_vehicles(&mut world, &simulation);
    ///     simulation.step(&mut world);
    /// }
    /// assert!(world.get::<&Velocity>(car)?.linear.z > 3.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn spawn_on_joints(
        &self,
        world: &mut World,
        ground: Pose,
        first_id: Option<BodyId>,
    ) -> Result<Entity, VehicleError> {
        let vehicle = Vehicle::new(self.settings()?)?;
        let mut ids = Ids(first_id.map(|id| id.0));
        let chassis = with_id(self.jointed_chassis(ground), ids.next()).build()?.spawn(world);
        let mut jointed =
            JointedVehicle { vehicle, wheels: Vec::new(), apart: Vec::new(), rolling: Vec::new(), steering: 0.0 };
        for wheel in 0..2 * self.axles {
            if let Err(error) = self.spawn_wheel(world, chassis, wheel, ground, (&mut jointed, &mut ids)) {
                jointed.despawn_wheels(world);
                let _ = world.despawn(chassis);
                return Err(error);
            }
        }
        // The chassis was spawned just now.
        let _ = world.insert(chassis, (jointed, VehicleInput::default()));
        Ok(chassis)
    }

    /// The chassis without its wheels: the rest of the mass, so that all together has its centre
    /// where the plan says.
    fn jointed_chassis(&self, ground: Pose) -> RigidBody {
        let wheels = 2 * self.axles;
        let mass = self.sprung_mass();
        let of_wheels: Vec3 = (0..wheels)
            .map(|wheel| {
                let place = Vec3::new(0.0, self.wheel_radius - self.center_height, self.axle_place(wheel / 2));
                place * self.wheel_mass
            })
            .sum();
        let center = self.center_of_mass() - of_wheels / mass;
        self.chassis(mass, ground).center_of_mass(dvec3(center))
    }

    /// The mass without that of the wheels; a thousandth at least.
    fn sprung_mass(&self) -> Real {
        let wheels = 2 * self.axles;
        (self.mass - wheels as Real * self.wheel_mass).max(1e-3 * self.mass)
    }

    fn spawn_wheel(
        &self,
        world: &mut World,
        chassis: Entity,
        wheel: usize,
        ground: Pose,
        (jointed, ids): (&mut JointedVehicle, &mut Ids),
    ) -> Result<(), VehicleError> {
        let settings = jointed.vehicle.settings().wheels[wheel];
        let side = if wheel.is_multiple_of(2) { 1.0 } else { -1.0 };
        let place = Vec3::new(side * 0.5 * self.track, self.wheel_radius, self.axle_place(wheel / 2));
        let center = ground.transform_point(place);
        let turned = dquat(ground.orientation);
        let (up, left) = (vec3(turned * DVec3::Y), vec3(turned * DVec3::X));

        let carrier = RigidBody::new(Shape::sphere(0.4 * f64::from(self.wheel_radius))).without_collider();
        let carrier = carrier.mass(f64::from(CARRIER * self.wheel_mass)).position(center);
        let carrier = with_id(carrier.orientation(ground.orientation), ids.next()).build()?.spawn(world);
        let body = match with_id(self.wheel_body(center, ground.orientation), ids.next()).build() {
            Ok(body) => body.spawn(world),
            Err(error) => {
                let _ = world.despawn(carrier);
                return Err(error.into());
            }
        };
        let is_steered = settings.steering != 0.0;
        let suspension = if is_steered { Joint::cylinder(chassis, carrier) } else { Joint::slider(chassis, carrier) };
        let suspension = suspension.at(world, center, up)?;
        let suspension = world.spawn((suspension, self.spring(wheel), self.stops(wheel), JointLoad::default()));
        ids.on(world, suspension);
        let axle = Joint::hinge(carrier, body).at(world, center, left)?;
        let axle = world.spawn((axle, Drives::default(), JointFriction::default(), JointLoad::default()));
        ids.on(world, axle);
        let weight = GRAVITY * self.mass * self.load_share(wheel / 2);
        jointed.rolling.push(settings.tyre.rolling_resistance * weight * settings.radius);
        jointed.apart.push(world.spawn((IgnoreContacts::between(chassis, body),)));
        jointed.wheels.push(JointedWheel { wheel: body, carrier, suspension, axle });
        Ok(())
    }

    fn wheel_body(&self, center: Vec3, orientation: Quat) -> RigidBody {
        let shape = Shape::cylinder(f64::from(self.wheel_radius), 0.5 * f64::from(self.wheel_width));
        let other = Material::default().dynamic_friction;
        // The axis of a cylinder is y; that of a wheel is x.
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let upright = DQuat::from_xyzw(0.0, 0.0, -half, half);
        RigidBody::new(shape)
            .mass(f64::from((1.0 - CARRIER) * self.wheel_mass))
            .material(Material::new((2.0 * self.friction - other).max(0.0), 0.0))
            .position(center)
            .orientation(quat((dquat(orientation) * upright).normalize()))
    }

    /// The spring, at rest under what it carries, and the steering.
    fn spring(&self, wheel: usize) -> Drives {
        let suspension = self.suspension(wheel / 2);
        let weight = GRAVITY * (self.mass * self.load_share(wheel / 2) - self.wheel_mass);
        let spring = Drive::position(Axes::LINEAR_X, -weight / suspension.stiffness)
            .with_stiffness(suspension.stiffness, suspension.compression_damping);
        // Of a slider, this does nothing.
        Drives(vec![spring, Drive::position(Axes::ANGULAR_X, 0.0)])
    }

    /// From where it hangs free to the bump stop.
    fn stops(&self, wheel: usize) -> Limits {
        let suspension = self.suspension(wheel / 2);
        let deflection = self.static_deflection();
        let stop = Limit::new(-deflection, suspension.travel - deflection);
        Limits::along(Axes::LINEAR_X, stop.with_stiffness(suspension.bump_stiffness, suspension.compression_damping))
    }
}
