//! What the tests share: a vehicle on some ground, and random plans of vehicles.

use tumble::hecs::{Entity, World};
use tumble::prelude::*;
use tumble_vehicle::{
    DrivenWheels, Probe, Vehicle, VehicleInput, VehiclePlan, VehicleState, WheelState, drive_vehicles,
};

/// Gravity of the default settings [m/s^2].
pub(crate) const GRAVITY: f64 = 9.81;

/// Random numbers of one case.
pub(crate) struct Draw(tumble::Rng);

impl Draw {
    pub(crate) fn new(stream: u64, case: u64) -> Self {
        Self(tumble::Rng::stream(stream, case))
    }

    /// Uniform from `low` to `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.unit()
    }

    /// Uniform in the logarithm.
    pub(crate) fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub(crate) fn real(&mut self, low: f64, high: f64) -> Real {
        self.between(low, high) as Real
    }

    pub(crate) fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[(self.0.unit() * choices.len() as f64) as usize % choices.len()]
    }

    /// A step of 30 to 240 a second \[s\].
    pub(crate) fn dt(&mut self) -> Real {
        1.0 / self.one_of::<Real>(&[30.0, 60.0, 120.0, 240.0])
    }

    pub(crate) fn probe(&mut self) -> Probe {
        self.one_of(&[Probe::Ray, Probe::Sphere, Probe::Cylinder])
    }

    /// From a model of 30 cm to a truck of 20 m.
    pub(crate) fn plan(&mut self) -> VehiclePlan {
        let length = self.log_between(0.3, 20.0);
        // From 40 to 250 kg for each cubic metre of a car's proportions.
        let mass = self.between(8.0, 25.0) * length.powi(3);
        let (length, mass) = (length as Real, mass as Real);
        let mut plan = if length > 6.0 { VehiclePlan::truck(length, mass) } else { VehiclePlan::car(length, mass) };
        plan.driven_wheels = self.one_of(&[DrivenWheels::Front, DrivenWheels::Rear, DrivenWheels::All]);
        plan.front_load *= self.real(0.85, 1.15);
        plan.friction = self.real(0.6, 1.1);
        plan.suspension_frequency *= self.real(0.8, 1.5);
        plan.damping_ratio = self.real(0.25, 0.7);
        plan.anti_roll = self.real(0.0, 1.0);
        plan
    }
}

/// One vehicle in a world.
pub(crate) struct Course {
    pub(crate) world: World,
    pub(crate) simulation: Simulation,
    pub(crate) vehicle: Entity,
}

impl Course {
    /// On a plane through the origin, which `tilt` turns with the vehicle.
    pub(crate) fn on_plane(plan: &VehiclePlan, dt: Real, tilt: Quat, heading: Real) -> Self {
        let mut world = World::new();
        RigidBody::ground().orientation(tilt).build().unwrap().spawn(&mut world);
        let place = Pose::from_rotation(tilt) * Pose::from_rotation(Quat::from_rotation_y(heading));
        let vehicle = plan.spawn(&mut world, place).unwrap();
        let simulation = Simulation::new(Settings::default().with_dt(dt)).unwrap();
        Self { world, simulation, vehicle }
    }

    /// On level ground, along z.
    pub(crate) fn flat(plan: &VehiclePlan, dt: Real) -> Self {
        Self::on_plane(plan, dt, Quat::IDENTITY, 0.0)
    }

    /// A random plan with any probe on level ground, at any step, and the numbers that are left.
    pub(crate) fn drawn(stream: u64, case: u64) -> (Draw, VehiclePlan, Self) {
        let mut draw = Draw::new(stream, case);
        let (mut plan, dt) = (draw.plan(), draw.dt());
        plan.probe = draw.probe();
        let course = Self::flat(&plan, dt);
        (draw, plan, course)
    }

    /// On random hills up to a height \[m\], a size of this many vehicles' lengths.
    pub(crate) fn on_hills(plan: &VehiclePlan, dt: Real, draw: &mut Draw, height: f64, [x, z]: [usize; 2]) -> Self {
        let mut world = World::new();
        let spacing = 0.6 * f64::from(plan.length);
        RigidBody::new(Shape::Point)
            .fixed()
            .collider(hills(draw, height, spacing, [x, z]))
            .build()
            .unwrap()
            .spawn(&mut world);
        let from = Vec3::Z * (-0.45 * spacing * z as f64) as Real;
        let down = Ray::new(from + Vec3::Y * 1e3, -Vec3::Y);
        let ground = Queries::of(&world).cast_ray(&down, &QueryFilter::new()).unwrap().point;
        let vehicle = plan.spawn(&mut world, Pose::at(ground + Vec3::Y * (0.3 * height) as Real)).unwrap();
        let simulation = Simulation::new(Settings::default().with_dt(dt)).unwrap();
        Self { world, simulation, vehicle }
    }

    /// How far the middle of the chassis is above the ground \[m\], or below.
    pub(crate) fn above_ground(&self) -> Option<Real> {
        let place = self.pose().position;
        let down = Ray::new(place + Vec3::Y * 1e3, -Vec3::Y);
        let filter = QueryFilter::new().without(self.vehicle);
        let hit = self.simulation.queries(&self.world).cast_ray(&down, &filter)?;
        Some(place.y - hit.point.y)
    }

    pub(crate) fn step(&mut self) {
        drive_vehicles(&mut self.world, &self.simulation);
        self.simulation.step(&mut self.world);
    }

    pub(crate) fn run(&mut self, seconds: f64) {
        for _ in 0..self.steps(seconds) {
            self.step();
        }
    }

    pub(crate) fn steps(&self, seconds: f64) -> u32 {
        (seconds / f64::from(self.simulation.settings().dt)).ceil() as u32
    }

    pub(crate) fn drive(&mut self, change: impl FnOnce(&mut VehicleInput)) {
        change(&mut self.world.get::<&mut VehicleInput>(self.vehicle).unwrap());
    }

    pub(crate) fn pose(&self) -> Pose {
        *self.world.get::<&Pose>(self.vehicle).unwrap()
    }

    pub(crate) fn velocity(&self) -> Velocity {
        *self.world.get::<&Velocity>(self.vehicle).unwrap()
    }

    pub(crate) fn state(&self) -> VehicleState {
        *self.world.get::<&VehicleState>(self.vehicle).unwrap()
    }

    pub(crate) fn wheels(&self) -> Vec<WheelState> {
        self.state().wheels().to_vec()
    }

    /// Kinetic energy of body and wheels, and what is in height, springs and bars \[J\].
    pub(crate) fn energy(&self) -> f64 {
        let mut energy = self.energy_without_springs();
        let (wheels, vehicle) = (self.wheels(), self.world.get::<&Vehicle>(self.vehicle).unwrap());
        for (wheel, state) in vehicle.settings().wheels.iter().zip(&wheels) {
            let x = f64::from(state.compression);
            let beyond = (x - f64::from(wheel.suspension.travel)).max(0.0);
            energy += 0.5 * f64::from(wheel.suspension.stiffness) * x * x;
            energy += 0.5 * f64::from(wheel.suspension.bump_stiffness) * beyond * beyond;
        }
        for bar in &vehicle.settings().anti_roll_bars {
            let [a, b] = bar.wheels.map(|wheel| f64::from(wheels[wheel].compression));
            energy += 0.5 * f64::from(bar.stiffness) * (a - b).powi(2);
        }
        energy
    }

    /// Kinetic energy of body and wheels, and what is in height \[J\].
    pub(crate) fn energy_without_springs(&self) -> f64 {
        let vehicle = self.world.get::<&Vehicle>(self.vehicle).unwrap();
        let spins = vehicle.settings().wheels.iter().zip(self.wheels());
        let of_spins: f64 =
            spins.map(|(wheel, state)| 0.5 * f64::from(wheel.inertia) * f64::from(state.spin).powi(2)).sum();
        self.energy_of(self.vehicle) + of_spins
    }

    /// Kinetic energy of a body, and what is in height \[J\].
    pub(crate) fn energy_of(&self, body: Entity) -> f64 {
        let body = self.world.entity(body).unwrap();
        let (velocity, momentum) = (*body.get::<&Velocity>().unwrap(), *body.get::<&Momentum>().unwrap());
        let mass = f64::from(body.get::<&Mass>().unwrap().kilograms());
        let height = f64::from(self.simulation.settings().gravity.dot(body.get::<&Pose>().unwrap().position));
        let (linear, angular) = (momentum.linear.dot(velocity.linear), momentum.angular.dot(velocity.angular));
        0.5 * f64::from(linear + angular) - mass * height
    }

    /// Gives the vehicle a speed along z, wheels that roll included.
    pub(crate) fn launch(&mut self, plan: &VehiclePlan, speed: Real) {
        set_linear_velocity(&mut self.world, self.vehicle, Vec3::Z * speed).unwrap();
        let mut state = self.world.get::<&mut VehicleState>(self.vehicle).unwrap();
        (0..2 * plan.axles).for_each(|wheel| state.set_spin(wheel, speed / plan.wheel_radius));
    }
}

/// A height field of sines and bumps.
fn hills(draw: &mut Draw, height: f64, spacing: f64, [columns, rows]: [usize; 2]) -> Collider {
    let waves: Vec<[f64; 3]> =
        (0..6).map(|_| [draw.between(-0.6, 0.6), draw.between(-0.6, 0.6), draw.between(0.0, 6.0)]).collect();
    let heights: Vec<f64> = (0..rows * columns)
        .map(|i| {
            let (x, z) = ((i % columns) as f64, (i / columns) as f64);
            let swell: f64 = waves.iter().map(|[a, b, c]| (a * x + b * z + c).sin()).sum();
            height * (swell / 6.0 + 0.15 * draw.between(-1.0, 1.0))
        })
        .collect();
    Collider::height_field(&heights, columns, [spacing, spacing]).unwrap()
}

/// Time in which the body comes to rest on its springs \[s\].
pub(crate) fn settling(plan: &VehiclePlan) -> f64 {
    2.5 / f64::from(plan.suspension_frequency * plan.damping_ratio.min(1.0))
}

#[track_caller]
pub(crate) fn assert_near(value: f64, expected: f64, relative: f64, what: &str) {
    let error = (value - expected).abs();
    assert!(error <= relative * expected.abs(), "{what}: {value} and not {expected}, off by {:e}", error / expected);
}
