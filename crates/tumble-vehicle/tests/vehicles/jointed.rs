//! Promise: a vehicle on joints stands, drives, brakes and turns as that on ray-cast wheels does,
//! and does without parts that are gone.

use tumble::hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::prelude::*;
use tumble::{BodyOrder, Rollback, state_hash};
use tumble_vehicle::{JointedVehicle, VehicleError, VehicleInput, VehiclePlan, drive_jointed_vehicles, drive_vehicles};

use crate::course::{Course, Draw, GRAVITY, assert_near, settling};

/// One vehicle of either kind on level ground.
fn pair(plan: &VehiclePlan, dt: Real) -> [Course; 2] {
    let on_rays = Course::flat(plan, dt);
    let mut on_joints = Course::flat(plan, dt);
    on_joints.world.despawn(on_joints.vehicle).unwrap();
    on_joints.vehicle = plan.spawn_on_joints(&mut on_joints.world, Pose::default(), None).unwrap();
    [on_rays, on_joints]
}

/// Steps a world with vehicles of both kinds.
fn run(course: &mut Course, seconds: f64) {
    for _ in 0..course.steps(seconds) {
        drive_vehicles(&mut course.world, &course.simulation);
        drive_jointed_vehicles(&mut course.world, &course.simulation);
        course.simulation.step(&mut course.world);
    }
}

/// A plan at a step at which wheels of contacts do not sink.
fn drawn(stream: u64, case: u64) -> (VehiclePlan, Real, Draw) {
    let mut draw = Draw::new(stream, case);
    let plan = VehiclePlan { anti_roll: 0.0, ..draw.plan() };
    let dt = draw.one_of::<Real>(&[1.0 / 60.0, 1.0 / 120.0]);
    (plan, dt, draw)
}

fn joints(course: &Course) -> JointedVehicle {
    JointedVehicle::clone(&course.world.get::<&JointedVehicle>(course.vehicle).unwrap())
}

#[test]
fn both_kinds_stand_alike() {
    for case in 0..10 {
        let (plan, dt, _) = drawn(90, case);
        let [mut on_rays, mut on_joints] = pair(&plan, dt);
        [&mut on_rays, &mut on_joints].into_iter().for_each(|course| run(course, settling(&plan)));
        let unsprung = GRAVITY * f64::from(plan.wheel_mass);
        for (wheel, (parts, of_ray)) in joints(&on_joints).wheels().iter().zip(on_rays.wheels()).enumerate() {
            let load = *on_joints.world.get::<&JointLoad>(parts.suspension).unwrap();
            let what = format!("case {case}, load of wheel {wheel}");
            assert_near(unsprung - f64::from(load.force.y), of_ray.load.into(), 0.02, &what);
            let most = 0.01 * plan.static_deflection();
            assert!(load.values[0].abs() < most, "case {case}: off its rest by {} m", load.values[0]);
        }
        // Light wheels under a heavy body sink in, by about half of what a step of fall is.
        let [height, of_joints] = [&on_rays, &on_joints].map(|course| {
            let center = course.world.get::<&CenterOfMass>(course.vehicle).unwrap();
            course.pose().origin(Some(&center)).y
        });
        let sunk = height - of_joints;
        let most = 0.6 * 9.81 * dt * dt + 2e-3 * plan.wheel_radius;
        assert!(sunk.abs() < most, "case {case}: stands {sunk} m lower");
    }
}

#[test]
fn both_kinds_accelerate_alike() {
    for case in 0..10 {
        let (mut plan, dt, mut draw) = drawn(91, case);
        plan.acceleration = draw.real(0.5, 2.0);
        (plan.power, plan.top_speed) = (1e9, 1e4);
        let gained = pair(&plan, dt).map(|mut course| {
            run(&mut course, 0.5 * settling(&plan));
            course.drive(|input| input.throttle = 1.0);
            run(&mut course, settling(&plan));
            f64::from(course.velocity().linear.z)
        });
        assert_near(gained[1], gained[0], 0.03, &format!("case {case}, speed on joints and on rays"));
    }
}

/// Contacts have one friction: the distance is that of sliding without a slip curve.
#[test]
fn on_joints_it_brakes_by_its_friction() {
    for case in 0..6 {
        let (mut plan, dt, mut draw) = drawn(92, case);
        plan.deceleration = 30.0;
        let [_, mut course] = pair(&plan, dt);
        run(&mut course, 0.3);
        let speed = draw.real(8.0, 15.0) * (plan.length / 4.5).sqrt();
        for wheel in joints(&course).wheels() {
            for body in [wheel.wheel, wheel.carrier] {
                set_linear_velocity(&mut course.world, body, Vec3::Z * speed).unwrap();
            }
            set_angular_velocity(&mut course.world, wheel.wheel, Vec3::X * (speed / plan.wheel_radius)).unwrap();
        }
        set_linear_velocity(&mut course.world, course.vehicle, Vec3::Z * speed).unwrap();
        let before = course.pose().position.z;
        course.drive(|input| input.brake = 1.0);
        run(&mut course, 1.6 * f64::from(speed / plan.friction) / GRAVITY);
        let distance = f64::from(course.pose().position.z - before);
        let expected = f64::from(speed).powi(2) / (2.0 * f64::from(plan.friction) * GRAVITY);
        assert_near(distance, expected, 0.1, &format!("case {case}, from {speed} m/s"));
    }
}

#[test]
fn on_joints_it_turns_about_one_point() {
    for case in 0..6 {
        let (mut plan, dt, mut draw) = drawn(93, case);
        plan.axles = 2;
        let [_, mut course] = pair(&plan, dt);
        let steering = draw.real(0.3, 1.0) * if case % 2 == 0 { 1.0 } else { -1.0 };
        let radius = plan.wheelbase / (steering * plan.max_steering).tan();
        let speed = (0.05 * 9.81 * radius.abs()).sqrt();
        course.drive(|input| input.steering = steering);
        for _ in 0..course.steps(2.5 * settling(&plan)) {
            let forward = course.pose().orientation * Vec3::Z;
            let now = course.velocity().linear.dot(forward);
            course.drive(|input| input.throttle = (speed - now).clamp(-1.0, 1.0));
            run(&mut course, f64::from(dt) * 0.5);
        }
        let (pose, velocity) = (course.pose(), course.velocity());
        let rear = pose.transform_point(Vec3::Z * (-plan.front_load * plan.wheelbase));
        let at_rear = velocity.at_point(rear, pose.position);
        let found = at_rear.dot(pose.orientation * Vec3::Z) / velocity.angular.y;
        assert_near(found.into(), radius.into(), 0.06, &format!("case {case}, radius at {speed} m/s"));
    }
}

#[test]
fn it_does_without_parts_that_are_gone() {
    let plan = VehiclePlan::car(4.5, 1500.0);
    let takers: [fn(&JointedVehicle, Entity) -> Entity; 5] = [
        |it, _| it.wheels()[0].wheel,
        |it, _| it.wheels()[1].carrier,
        |it, _| it.wheels()[2].suspension,
        |it, _| it.wheels()[3].axle,
        |_, chassis| chassis,
    ];
    for take in takers {
        let [_, mut course] = pair(&plan, 1.0 / 60.0);
        let whole = joints(&course);
        assert!(whole.is_whole(&course.world));
        course.drive(|input| (input.throttle, input.steering) = (1.0, 0.5));
        run(&mut course, 0.2);
        let gone = take(&whole, course.vehicle);
        course.world.despawn(gone).unwrap();
        run(&mut course, 0.5);
        assert_eq!(whole.is_whole(&course.world), gone == course.vehicle);
        let mut poses = course.world.query::<&Pose>();
        assert!(poses.iter().all(|pose| pose.position.is_finite()));
        drop(poses);
        whole.despawn_wheels(&mut course.world);
        assert_eq!(course.world.query::<&JointLoad>().iter().count(), 0);
    }
    let mut bad = plan;
    bad.wheel_mass = -1.0;
    let mut world = World::new();
    let error: VehicleError = bad.spawn_on_joints(&mut world, Pose::default(), None).unwrap_err();
    assert_eq!((error.field(), world.len()), (Some("wheel_mass"), 0));
}

/// With ids, a snapshot and a copy of the component are all of the state.
#[test]
fn on_joints_it_goes_back_in_the_same_bits() {
    let mut world = World::new();
    spawn_ground(&mut world);
    let plan = VehiclePlan::car(4.5, 1500.0);
    let car = plan.spawn_on_joints(&mut world, Pose::default(), Some(BodyId(100))).unwrap();
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    let mut rollback = Rollback::new(128);
    let (mut kept, mut hashes) = (Vec::new(), Vec::new());
    let step = |world: &mut World, simulation: &mut Simulation| {
        let mut draw = Draw::new(94, simulation.steps() / 10);
        let (throttle, steering, brake) = (draw.real(-1.0, 1.0), draw.real(-1.0, 1.0), draw.real(-2.0, 1.0));
        *world.get::<&mut VehicleInput>(car).unwrap() = VehicleInput { throttle, steering, brake, hand_brake: 0.0 };
        drive_jointed_vehicles(world, simulation);
        simulation.step(world);
    };
    for _ in 0..100 {
        rollback.save(&world, &simulation).unwrap();
        kept.push(JointedVehicle::clone(&world.get::<&JointedVehicle>(car).unwrap()));
        hashes.push(state_hash(&world, &BodyOrder::of(&world)));
        step(&mut world, &mut simulation);
    }
    let from = 40;
    rollback.rewind_to_step(from, &mut world, &mut simulation).unwrap();
    *world.get::<&mut JointedVehicle>(car).unwrap() = kept[from as usize].clone();
    for at in from..100 {
        assert_eq!(state_hash(&world, &BodyOrder::of(&world)), hashes[at as usize], "step {at}");
        step(&mut world, &mut simulation);
    }
}
