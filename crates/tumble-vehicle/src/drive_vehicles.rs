//! The system that turns the input of drivers into forces, before each step.

use std::collections::BTreeMap;

use tumble::glam::DVec3;
use tumble::hecs::{Entity, World};
use tumble::math::dvec3;
use tumble::{BodyOrder, Queries, QueryFilter, Simulation, Wrench};

use crate::error::MAX_WHEELS;
use crate::light_bodies::{Finder, Passed};
use crate::precision::{real, vec3};
use crate::probe::{Ground, Hub};
use crate::rigid::{Chassis, Rigid};
use crate::slip_curve::Rubber;
use crate::solve::{ITERATIONS, solve};
use crate::state::{VehicleInput, VehicleState, WheelContact, WheelState};
use crate::vehicle::{Driver, Vehicle};
use crate::wheel_step::{Footing, ForceLine, Motion, Row, WheelStep};

/// How fast a spring takes up what is not of it, over the root of gravity and radius.
const RETURN: f64 = 0.05;

/// Compression that may be there at once, over the radius of the wheel.
const SUDDEN: f64 = 0.05;

/// A vehicle in the course of a step.
struct Plan<'a> {
    entity: Entity,
    vehicle: &'a Vehicle,
    chassis: Chassis,
    driver: Driver,
    state: VehicleState,
    hubs: Vec<Hub>,
    grounds: Vec<Option<Ground>>,
    /// Light bodies that wheels go through, with the impulse on it [N s].
    passed: Vec<(Passed, DVec3)>,
}

/// What comes of a vehicle: its state, and forces on bodies.
struct Outcome {
    entity: Entity,
    state: VehicleState,
    /// Body, force \[N\], torque about its centre of mass [N m].
    pushes: Vec<(Entity, DVec3, DVec3)>,
}

/// Finds the ground under all wheels and adds the forces of the next step to the
/// [`Wrench`] of each chassis, and their opposites to dynamic bodies under wheels.
///
/// To be called before each step, after all else that adds forces: tyres hold against what they
/// know of. Within [`advance_with`](Simulation::advance_with) it is
/// `simulation.advance_with(&mut world, seconds, drive_vehicles)`.
///
/// Vehicles go in [`BodyOrder`], and none sees the forces of another. A [`Vehicle`] that is no
/// dynamic body, or has numbers that are not finite, is left out, and its wheels are in the air. A
/// chassis without [`VehicleInput`] is one without a driver.
///
/// ```
/// # use tumble::prelude::*;
/// # use tumble_vehicle::{VehicleInput, VehiclePlan, VehicleState, drive_vehicles};
/// # let mut world = tumble::hecs::World::new();
/// # spawn_ground(&mut world);
/// # let car = VehiclePlan::car(4.5, 1500.0).spawn(&mut world, Pose::default())?;
/// world.get::<&mut VehicleInput>(car)?.throttle = -1.0;
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.advance_with(&mut world, 0.1, drive_vehicles);
/// assert!(world.get::<&VehicleState>(car)?.wheels()[2].spin < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drive_vehicles(world: &mut World, simulation: &Simulation) {
    if world.query_mut::<&Vehicle>().into_iter().next().is_none() {
        return;
    }
    let outcomes = outcomes(world, simulation, ITERATIONS);
    for outcome in outcomes {
        for (body, force, torque) in &outcome.pushes {
            if let Ok(mut wrench) = world.get::<&mut Wrench>(*body) {
                wrench.add_force(vec3(*force));
                wrench.add_torque(vec3(*torque));
            }
        }
        if let Ok(mut state) = world.get::<&mut VehicleState>(outcome.entity) {
            *state = outcome.state;
            continue;
        }
        // It is there: it was found above.
        let _ = world.insert_one(outcome.entity, outcome.state);
    }
}

fn outcomes(world: &World, simulation: &Simulation, iterations: usize) -> Vec<Outcome> {
    let dt = f64::from(simulation.settings().dt);
    let gravity = dvec3(simulation.settings().gravity);
    let queries = simulation.queries(world);
    let mut found = world.query::<&Vehicle>();
    let view = found.view();
    let entities = BodyOrder::of(world);
    let mut plans = Vec::new();
    let mut outcomes = Vec::new();
    for entity in entities.entities() {
        let Some(vehicle) = view.get(*entity) else { continue };
        let state = world.get::<&VehicleState>(*entity).map_or_else(|_| VehicleState::default(), |state| *state);
        match Plan::of(world, *entity, vehicle, state, gravity, dt) {
            Some(plan) => plans.push(plan),
            None => outcomes.push(Outcome { entity: *entity, state: at_rest(vehicle, state), pushes: Vec::new() }),
        }
    }
    plans.iter_mut().for_each(|plan| plan.find_grounds(world, &queries, (gravity.length(), dt)));
    let mut wheels_on = BTreeMap::new();
    for ground in plans.iter().flat_map(|plan| plan.grounds.iter().flatten()) {
        *wheels_on.entry(ground.bearer).or_insert(0.0) += 1.0;
    }
    outcomes.extend(plans.iter().map(|plan| plan.outcome(world, &wheels_on, (gravity.length(), dt), iterations)));
    outcomes
}

/// The state of a vehicle that nothing can be done for.
fn at_rest(vehicle: &Vehicle, state: VehicleState) -> VehicleState {
    let count = vehicle.settings().wheels.len();
    let mut wheels = [WheelState::default(); MAX_WHEELS];
    for (wheel, before) in wheels.iter_mut().zip(state.wheels).take(count) {
        wheel.spin_angle = before.spin_angle;
        wheel.steering_angle = before.steering_angle;
    }
    VehicleState { wheels, count, steering: state.steering }
}

impl<'a> Plan<'a> {
    fn of(
        world: &World,
        entity: Entity,
        vehicle: &'a Vehicle,
        state: VehicleState,
        gravity: DVec3,
        dt: f64,
    ) -> Option<Self> {
        let chassis = Chassis::of(world, entity, gravity)?;
        let input = world.get::<&VehicleInput>(entity).map_or_else(|_| VehicleInput::default(), |input| *input);
        let driver = Driver::of(vehicle.settings(), input, &state, dt);
        let wheels = 0..vehicle.settings().wheels.len();
        let hubs = wheels.map(|wheel| Hub::of(vehicle, wheel, &chassis, driver.steering)).collect();
        Some(Self { entity, vehicle, chassis, driver, state, hubs, grounds: Vec::new(), passed: Vec::new() })
    }

    fn find_grounds(&mut self, world: &World, queries: &Queries<'_>, (gravity, dt): (f64, f64)) {
        let (membership, filter) = self.vehicle.settings().groups;
        let filter = QueryFilter::new().without(self.entity).with_groups(membership, filter);
        let (vehicle, chassis) = (self.vehicle, &self.chassis);
        let finder = Finder { world, queries, vehicle, chassis, filter, gravity, dt };
        let mut all = Vec::new();
        for (wheel, hub) in self.hubs.iter().enumerate() {
            let (ground, passed) = finder.find(wheel, hub, self.state.wheels().get(wheel));
            self.grounds.push(ground);
            all.extend(passed.into_iter().map(|it| (wheel, it)));
        }
        for (wheel, passed) in &all {
            let wheels = all.iter().filter(|(_, other)| other.entity == passed.entity).count() as f64;
            if let Some(impulse) = finder.impulse_on(passed, &self.hubs[*wheel], wheels) {
                self.passed.push((*passed, impulse));
            }
        }
    }

    fn outcome(
        &self,
        world: &World,
        wheels_on: &BTreeMap<Entity, f64>,
        (gravity, dt): (f64, f64),
        iterations: usize,
    ) -> Outcome {
        let settings = self.vehicle.settings();
        let shares: f64 = settings.wheels.iter().map(|wheel| f64::from(wheel.drive)).sum();
        let mut steps: Vec<WheelStep> =
            (0..self.hubs.len()).map(|wheel| self.wheel_step(wheel, shares, world, wheels_on, (gravity, dt))).collect();
        let solved =
            solve(&self.chassis, &mut steps, &settings.anti_roll_bars, &settings.motor, (gravity, dt), iterations);
        let Some(motion) = solved else {
            let state = at_rest(self.vehicle, self.state);
            return Outcome { entity: self.entity, state, pushes: Vec::new() };
        };
        let mut state = at_rest(self.vehicle, self.state);
        state.steering = self.driver.steering;
        for (wheel, step) in steps.iter().enumerate() {
            state.wheels[wheel] = self.end_state(wheel, step, &motion, gravity, dt);
        }
        Outcome { entity: self.entity, state, pushes: self.pushes(world, &steps, dt) }
    }

    fn wheel_step(
        &self,
        wheel: usize,
        shares: f64,
        world: &World,
        wheels_on: &BTreeMap<Entity, f64>,
        (gravity, dt): (f64, f64),
    ) -> WheelStep {
        let (settings, before) = (self.vehicle.settings().wheels[wheel], &self.state.wheels[wheel]);
        let drive = f64::from(settings.drive);
        let footing =
            self.grounds[wheel].and_then(|ground| self.footing(wheel, &ground, world, wheels_on, (gravity, dt)));
        let Driver { throttle, brake, hand_brake, .. } = self.driver;
        let brake = brake * f64::from(settings.brake_torque) + hand_brake * f64::from(settings.hand_brake_torque);
        let mut step = WheelStep {
            settings,
            rubber: Rubber::of(&settings.tyre),
            footing,
            spin: before.spin.into(),
            shear: before.shear,
            speed: 0.0,
            sliding: 1.0,
            share: if shares > 0.0 { drive / shares } else { 0.0 },
            throttle,
            brake,
            suspension: before.suspension_force.into(),
            forces: [before.longitudinal_force.into(), before.lateral_force.into()],
            end_spin: before.spin.into(),
            lines: [ForceLine::default(); 2],
        };
        let motion = Motion::of(&self.chassis.body);
        step.begin(&motion, gravity);
        let was_there = before.contact.is_some_and(|it| self.grounds[wheel].is_some_and(|on| on.entity == it.ground));
        if was_there {
            step.catch_up(before.speeds, &motion, dt, gravity);
        }
        step
    }

    /// The directions in which a wheel and the ground act on each other.
    fn footing(
        &self,
        wheel: usize,
        ground: &Ground,
        world: &World,
        wheels_on: &BTreeMap<Entity, f64>,
        (gravity, dt): (f64, f64),
    ) -> Option<Footing> {
        let (hub, center) = (&self.hubs[wheel], self.chassis.body.position);
        let body = Rigid::of(world, ground.bearer)?;
        let forward = hub.axle.cross(ground.normal).try_normalize()?;
        let left = ground.normal.cross(forward);
        let up = ground.normal.dot(hub.up);
        let along_normal = ground.normal / up;
        let lean = [up, forward.dot(hub.up), left.dot(hub.up)];
        // What of a tangential force goes along the suspension presses the spring, not the chassis.
        let directions = [along_normal, forward - along_normal * lean[1], left - along_normal * lean[2]];
        let before = &self.state.wheels[wheel];
        let was_there = before.contact.is_some_and(|contact| contact.ground == ground.entity);
        let forces = [before.suspension_force, before.longitudinal_force, before.lateral_force];
        let count = wheels_on.get(&ground.bearer).copied().unwrap_or(1.0);
        let mut rows = directions.map(|direction| Row::new(direction, ground.point, center));
        for (i, row) in rows.iter_mut().enumerate() {
            row.ground = body.at_point(ground.point).dot(directions[i]);
            if !body.is_dynamic() {
                continue;
            }
            let give = body.give(ground.point, directions[i]);
            row.give = (count + 1.0) * give;
            if was_there {
                // What lies on something else gives way less than its mass would.
                row.before = forces[i].into();
                let expected = (dt * give * row.before).abs();
                let found = (row.ground - before.ground[i]).abs();
                row.give *= if found < expected { found / expected } else { 1.0 };
            }
        }
        let [normal, along, across] = rows;
        let closing = -normal.speed(&Motion::of(&self.chassis.body));
        let slack = self.slack(wheel, ground.compression, closing, (gravity, dt));
        let compression = ground.compression - slack;
        Some(Footing { normal, tangents: [along, across], lean, compression, slack })
    }

    /// How much of a compression is not of the spring. One that is there all at once, of a wheel
    /// that had nothing below it, is no work that anything has done.
    fn slack(&self, wheel: usize, compression: f64, closing: f64, (gravity, dt): (f64, f64)) -> f64 {
        let (before, radius) = (&self.state.wheels[wheel], self.hubs[wheel].radius);
        let there = compression.max(0.0);
        if before.met {
            let back = RETURN * (gravity * radius).sqrt() * dt;
            return (before.slack - back).clamp(0.0, there);
        }
        if self.state.count == 0 {
            // One that begins deep in something does not begin with its stop pressed.
            return if there > self.hubs[wheel].travel { there } else { 0.0 };
        }
        (there - 1.5 * (closing * dt).max(0.0) - SUDDEN * radius).max(0.0)
    }

    fn pushes(&self, world: &World, steps: &[WheelStep], dt: f64) -> Vec<(Entity, DVec3, DVec3)> {
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        let mut pushes = Vec::new();
        for ((step, hub), ground) in steps.iter().zip(&self.hubs).zip(&self.grounds) {
            // What spins the wheel up turns the chassis the other way.
            torque -= hub.axle * (f64::from(step.settings.inertia) * (step.end_spin - step.spin) / dt);
            let (Some(footing), Some(ground)) = (&step.footing, ground) else { continue };
            let [along, across] = footing.tangents;
            let [longitudinal, lateral] = step.forces;
            let push = footing.normal.linear * step.suspension + along.linear * longitudinal + across.linear * lateral;
            force += push;
            torque += (ground.point - self.chassis.body.position).cross(push);
            if let Some(body) = Rigid::of(world, ground.bearer).filter(Rigid::is_dynamic) {
                // In the course of the step the wheel rolls on, and the ground moves too.
                let rolled = (self.chassis.body.linear - body.linear) * (0.5 * dt);
                pushes.push((ground.bearer, -push, (ground.point + rolled - body.position).cross(-push)));
            }
        }
        for (passed, impulse) in &self.passed {
            let (push, Some(body)) = (*impulse / dt, Rigid::of(world, passed.entity)) else { continue };
            force -= push;
            torque -= (passed.point - self.chassis.body.position).cross(push);
            pushes.push((passed.entity, push, (passed.point - body.position).cross(push)));
        }
        pushes.push((self.entity, force, torque));
        pushes
    }

    fn end_state(&self, wheel: usize, step: &WheelStep, motion: &Motion, gravity: f64, dt: f64) -> WheelState {
        let before = &self.state.wheels[wheel];
        let turned = f64::from(before.spin_angle) + step.end_spin * dt;
        let turns = (turned / std::f64::consts::TAU).round();
        let mut state = WheelState {
            spin: real(step.end_spin),
            spin_angle: real(turned - turns * std::f64::consts::TAU),
            steering_angle: real(self.hubs[wheel].angle),
            ..WheelState::default()
        };
        let (Some(footing), Some(ground)) = (&step.footing, self.grounds[wheel]) else { return state };
        (state.met, state.reach, state.slack) = (true, ground.compression, footing.slack);
        let load = step.load();
        if load <= 0.0 {
            return state;
        }
        let [along, across] = footing.tangents.map(|row| row.speed(motion));
        let rim = step.end_spin * f64::from(step.settings.radius);
        // At rest there is no slip, whatever the last bits of the speeds say.
        let speed = along.abs().max(rim.abs()).max(step.still_speed(gravity));
        state.contact = Some(WheelContact {
            ground: ground.entity,
            point: vec3(ground.point),
            normal: vec3(ground.normal),
            forward: vec3(self.hubs[wheel].axle.cross(ground.normal).normalize_or_zero()),
        });
        state.load = real(load);
        state.suspension_force = real(step.suspension);
        state.longitudinal_force = real(step.forces[0]);
        state.lateral_force = real(step.forces[1]);
        state.compression = real(ground.compression.max(0.0));
        state.slip_ratio = real((rim - along) / speed);
        state.slip_angle = real(libm::atan2(across, along.abs().max(step.still_speed(gravity))));
        let [on, off] = footing.tangents;
        state.ground = [footing.normal.ground, on.ground, off.ground];
        state.speeds = [along, across];
        state.shear = step.end_shear(motion, dt, gravity);
        state
    }
}

#[cfg(test)]
mod tests {
    use tumble::math::{Real, Vec3};
    use tumble::{Collider, Pose, RigidBody, Rng, Settings, Shape};

    use super::*;
    use crate::plan::VehiclePlan;

    /// Eight iterations give the forces of a hundred, on rough ground with random input: in nearly
    /// all steps to a thousandth of the weight.
    #[test]
    fn more_iterations_change_little() {
        let (mut steps, mut far, mut worst) = (0, 0, 0.0_f64);
        for case in 0..12 {
            let mut rng = Rng::stream(7, case);
            let heights: Vec<f64> = (0..40 * 40).map(|_| 0.2 * rng.unit()).collect();
            let field = Collider::height_field(&heights, 40, [2.0, 2.0]).expect("a field");
            let mut world = World::new();
            RigidBody::new(Shape::Point).fixed().collider(field).build().expect("ground").spawn(&mut world);
            let plan = VehiclePlan::car(4.5, 1500.0);
            let car = plan.spawn(&mut world, Pose::at(Vec3::Y * 0.3)).expect("a car");
            let dt = 1.0 / [30.0, 60.0, 240.0][case as usize % 3];
            let mut simulation = Simulation::new(Settings::default().with_dt(dt)).expect("settings");
            for step in 0..300 {
                if step % 30 == 0 {
                    let mut within = |low: f64| (low + (1.0 - low) * rng.unit()) as Real;
                    let input = VehicleInput {
                        throttle: within(-1.0),
                        brake: within(-2.0),
                        hand_brake: within(-3.0),
                        steering: within(-1.0),
                    };
                    *world.get::<&mut VehicleInput>(car).expect("input") = input;
                }
                let forces = [ITERATIONS, 100].map(|it| outcomes(&world, &simulation, it)[0].pushes[0].1);
                let change = (forces[1] - forces[0]).length() / (1500.0 * 9.81);
                worst = worst.max(change);
                far += u32::from(change > 1e-3);
                steps += 1;
                drive_vehicles(&mut world, &simulation);
                simulation.step(&mut world);
            }
        }
        println!("{far} of {steps} steps are off by over a thousandth, the worst by {worst}");
        assert!(f64::from(far) < 0.05 * f64::from(steps), "{far} of {steps}, the worst {worst}");
        assert!(worst < 0.3, "{worst} of the weight");
    }
}
