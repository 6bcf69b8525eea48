//! Promise: settings that cannot be are refused by name, and nothing that a caller does to a world
//! makes a step panic.

use tumble::hecs::World;
use tumble::math::{Real, Vec3};
use tumble::prelude::*;
use tumble_vehicle::{Vehicle, VehicleError, VehicleInput, VehiclePlan, VehicleSettings, VehicleState, drive_vehicles};

use crate::course::{Course, Draw};

const HOSTILE: [Real; 8] = [Real::NAN, Real::INFINITY, Real::NEG_INFINITY, -1.0, 0.0, 1e30, 1e-30, Real::MIN_POSITIVE];

type Field = (&'static str, fn(&mut VehicleSettings) -> &mut Real);

const FIELDS: [Field; 30] = [
    ("wheels[1].position.x", |it| &mut it.wheels[1].position.x),
    ("wheels[1].position.y", |it| &mut it.wheels[1].position.y),
    ("wheels[1].position.z", |it| &mut it.wheels[1].position.z),
    ("wheels[1].radius", |it| &mut it.wheels[1].radius),
    ("wheels[1].width", |it| &mut it.wheels[1].width),
    ("wheels[1].inertia", |it| &mut it.wheels[1].inertia),
    ("wheels[1].steering", |it| &mut it.wheels[1].steering),
    ("wheels[1].drive", |it| &mut it.wheels[1].drive),
    ("wheels[1].brake_torque", |it| &mut it.wheels[1].brake_torque),
    ("wheels[1].hand_brake_torque", |it| &mut it.wheels[1].hand_brake_torque),
    ("wheels[1].suspension.stiffness", |it| &mut it.wheels[1].suspension.stiffness),
    ("wheels[1].suspension.compression_damping", |it| &mut it.wheels[1].suspension.compression_damping),
    ("wheels[1].suspension.rebound_damping", |it| &mut it.wheels[1].suspension.rebound_damping),
    ("wheels[1].suspension.travel", |it| &mut it.wheels[1].suspension.travel),
    ("wheels[1].suspension.bump_stiffness", |it| &mut it.wheels[1].suspension.bump_stiffness),
    ("wheels[1].tyre.longitudinal_friction", |it| &mut it.wheels[1].tyre.longitudinal_friction),
    ("wheels[1].tyre.lateral_friction", |it| &mut it.wheels[1].tyre.lateral_friction),
    ("wheels[1].tyre.longitudinal_stiffness", |it| &mut it.wheels[1].tyre.longitudinal_stiffness),
    ("wheels[1].tyre.lateral_stiffness", |it| &mut it.wheels[1].tyre.lateral_stiffness),
    ("wheels[1].tyre.shape", |it| &mut it.wheels[1].tyre.shape),
    ("wheels[1].tyre.relaxation_length", |it| &mut it.wheels[1].tyre.relaxation_length),
    ("wheels[1].tyre.rolling_resistance", |it| &mut it.wheels[1].tyre.rolling_resistance),
    ("anti_roll_bars[0].stiffness", |it| &mut it.anti_roll_bars[0].stiffness),
    ("motor.torque", |it| &mut it.motor.torque),
    ("motor.power", |it| &mut it.motor.power),
    ("motor.max_spin", |it| &mut it.motor.max_spin),
    ("motor.drag", |it| &mut it.motor.drag),
    ("max_steering", |it| &mut it.max_steering),
    ("steering_speed", |it| &mut it.steering_speed),
    ("ackermann", |it| &mut it.ackermann),
];

fn settings() -> VehicleSettings {
    VehiclePlan::car(4.5, 1500.0).settings().unwrap()
}

/// Each number alone, each kind of nonsense: it is named, or it is one that can be driven with.
#[test]
fn what_cannot_be_is_named_and_all_else_can_be_driven() {
    for (name, field) in FIELDS {
        let mut refused = 0;
        for value in HOSTILE {
            let mut settings = settings();
            *field(&mut settings) = value;
            match Vehicle::new(settings) {
                Err(error) => {
                    assert_eq!(error.field(), Some(name), "{error}");
                    assert!(error.to_string().contains(name), "{error}");
                    refused += 1;
                }
                Ok(vehicle) => drive_for_a_while(vehicle, &format!("{name} = {value:e}")),
            }
        }
        assert!(refused >= 4, "{name}: {refused} values are refused");
    }
}

fn drive_for_a_while(vehicle: Vehicle, what: &str) {
    let plan = VehiclePlan::car(4.5, 1500.0);
    let mut course = Course::flat(&plan, 1.0 / 60.0);
    *course.world.get::<&mut Vehicle>(course.vehicle).unwrap() = vehicle;
    course.drive(|input| (input.throttle, input.steering) = (1.0, 0.5));
    for step in 0..40 {
        course.drive(|input| input.brake = if step > 20 { 1.0 } else { 0.0 });
        course.step();
        let pose = course.pose();
        assert!(pose.position.is_finite() && pose.orientation.is_finite(), "{what}: {pose:?}");
    }
}

/// All numbers at once, over many magnitudes: refused, or finite.
#[test]
fn random_settings_are_refused_or_finite() {
    let mut driven = 0;
    for case in 0..200 {
        let mut draw = Draw::new(80, case);
        let mut settings = settings();
        for (_, field) in FIELDS {
            if draw.between(0.0, 1.0) < 0.5 {
                *field(&mut settings) *= draw.log_between(1e-3, 1e3) as Real;
            }
        }
        if let Ok(vehicle) = Vehicle::new(settings) {
            drive_for_a_while(vehicle, &format!("case {case}"));
            driven += 1;
        }
    }
    assert!(driven > 20, "{driven} of 200 can be driven");
}

#[test]
fn numbers_of_wheels_and_bars_are_checked() {
    let mut none = settings();
    none.wheels.clear();
    assert_eq!(none.validate(), Err(VehicleError::Wheels(0)));
    let mut many = settings();
    many.wheels = vec![many.wheels[0]; tumble_vehicle::MAX_WHEELS + 1];
    assert_eq!(many.validate().unwrap_err().field(), Some("wheels"));
    for joined in [[0, 0], [0, 4], [9, 1]] {
        let mut bars = settings();
        bars.anti_roll_bars[1].wheels = joined;
        assert_eq!(bars.validate().unwrap_err().field(), Some("anti_roll_bars[1].wheels"));
    }
    let mut plan = VehiclePlan::car(4.5, 1500.0);
    plan.front_load = 1.0;
    assert_eq!(plan.settings().unwrap_err().field(), Some("front_load"));
    plan = VehiclePlan::car(Real::NAN, 1500.0);
    assert_eq!(plan.spawn(&mut World::new(), Pose::default()).unwrap_err().field(), Some("length"));
}

/// Inputs out of range, and what happens to the chassis between two steps.
#[test]
fn nothing_in_a_world_makes_it_panic() {
    let plan = VehiclePlan::car(4.5, 1500.0);
    for value in HOSTILE {
        let mut course = Course::flat(&plan, 1.0 / 60.0);
        course.drive(|it| *it = VehicleInput { throttle: value, brake: value, hand_brake: value, steering: value });
        course.run(0.5);
        assert!(course.pose().position.is_finite());
    }

    let changes: [fn(&mut World, tumble::hecs::Entity); 9] = [
        |world, car| drop(world.despawn(car)),
        |world, car| drop(world.remove_one::<Momentum>(car)),
        |world, car| drop(world.remove_one::<Inertia>(car)),
        |world, car| drop(world.remove_one::<Wrench>(car)),
        |world, car| drop(world.remove_one::<VehicleState>(car)),
        |world, car| drop(world.remove_one::<VehicleInput>(car)),
        |world, car| world.get::<&mut Momentum>(car).unwrap().linear.x = Real::NAN,
        |world, car| world.get::<&mut Pose>(car).unwrap().position = Vec3::splat(Real::INFINITY),
        |world, car| world.get::<&mut Momentum>(car).unwrap().linear = Vec3::splat(1e30),
    ];
    for change in changes {
        let mut course = Course::flat(&plan, 1.0 / 60.0);
        let other = plan.spawn(&mut course.world, Pose::at(Vec3::X * 5.0)).unwrap();
        course.run(0.2);
        change(&mut course.world, course.vehicle);
        course.run(0.5);
        let place = course.world.get::<&Pose>(other).unwrap().position;
        assert!((place - Vec3::new(5.0, 0.54, 0.0)).length() < 0.01, "the other stands where it stood: {place}");
    }

    // A vehicle on nothing, and a vehicle that is no body.
    let mut world = World::new();
    let vehicle = Vehicle::new(settings()).unwrap();
    let alone = world.spawn((vehicle.clone(),));
    let scenery = world.spawn((vehicle, Pose::default()));
    drive_vehicles(&mut world, &Simulation::new(Settings::default()).unwrap());
    assert!(world.get::<&VehicleState>(alone).is_err());
    assert_eq!(world.get::<&VehicleState>(scenery).unwrap().wheels_on_ground(), 0);
}
