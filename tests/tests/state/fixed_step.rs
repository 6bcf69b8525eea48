//! Promise: `Simulation::advance` takes as many fixed steps as fit into the time that has passed,
//! never more than a stated number a frame, keeps the rest, and gives the fraction with which
//! interpolated poses move smoothly at any frame rate.
//!
//! Why: games draw at other rates than they simulate. It fails if time is lost or gained over
//! frames, a slow frame is followed by ever slower ones, a bad clock stops the world, or bodies
//! stutter.

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{
    Collider, Integrator, Pose, PreviousPose, RigidBody, Settings, SettingsError, Shape, Simulation, state_hash,
};
use tumble_benches::mixed_bodies;
use tumble_tests::{EPSILON, seconds};

fn simulation(dt: Real) -> Simulation {
    Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(dt)).unwrap()
}

/// A body that moves at 3 m/s along x and turns at 2 rad/s about z, kept for interpolation.
fn spawn_moving(world: &mut World) -> Entity {
    let body = RigidBody::new(Shape::sphere(0.5)).without_collider().mass(1.0).interpolated();
    body.linear_velocity(Vec3::X * 3.0).angular_velocity(Vec3::Z * 2.0).build().unwrap().spawn(world)
}

fn drawn(world: &World, entity: Entity, alpha: Real) -> Pose {
    let mut query = world.query_one::<(&PreviousPose, &Pose)>(entity);
    let (previous, pose) = query.get().unwrap();
    previous.0.interpolate(pose, alpha)
}

/// Frames of all lengths: what has been simulated and what is owed add up to the time that has
/// passed.
#[test]
fn no_time_is_lost_or_gained() {
    for dt in [1.0 / 60.0, 0.01, 1.0 / 128.0] {
        for frames_per_second in [24.0, 30.0, 59.94, 60.0, 75.0, 144.0, 1000.0] {
            let (mut world, mut simulation) = (World::new(), simulation(dt));
            let frame: f64 = 1.0 / frames_per_second;
            for i in 1..=2000 {
                let alpha = simulation.advance(&mut world, frame);
                assert!((0.0..1.0).contains(&alpha), "{alpha}");
                let accounted = simulation.time() + seconds(alpha) * seconds(dt);
                // The fraction is rounded to the precision of the build, and capped one EPSILON
                // below one; the sum of frames in double precision.
                let allowed = 2.0 * EPSILON * seconds(dt) + f64::from(i) * frame * f64::EPSILON * 2000.0;
                assert!(
                    (accounted - f64::from(i) * frame).abs() <= allowed,
                    "{frames_per_second} Hz, frame {i}: {accounted} s"
                );
            }
        }
    }
}

/// A frame as long as a step has one from the first frame on, whatever the rounding of `dt`.
#[test]
fn a_frame_of_one_step_has_one() {
    for rate in 10..=240_u8 {
        let (mut world, mut simulation) = (World::new(), simulation(1.0 / Real::from(rate)));
        for frame in 1..=100 {
            let alpha = simulation.advance(&mut world, seconds(1.0 / Real::from(rate)));
            assert_eq!((simulation.steps(), alpha), (frame, 0.0), "{rate} Hz");
        }
    }
}

/// The same steps in the same order, however the frames cut the time.
#[test]
fn frames_do_not_change_the_simulation() {
    let dt: Real = 1.0 / 64.0;
    let hash = |frames: &[f64]| {
        let mut world = mixed_bodies(200);
        let mut simulation = simulation(dt);
        for &frame in frames {
            simulation.advance(&mut world, frame);
        }
        (simulation.steps(), state_hash(&world, &tumble::BodyOrder::of(&world)))
    };
    let even = hash(&[1.0 / 64.0; 64]);
    assert_eq!(even.0, 64);
    assert_eq!(hash(&[1.0 / 128.0; 128]), even);
    assert_eq!(hash(&[1.0 / 16.0; 16]), even);
    let uneven: Vec<f64> = [1.0 / 256.0, 7.0 / 256.0].repeat(32);
    assert_eq!(hash(&uneven), even);
}

/// A frame that took an hour is not made up for: eight steps, the fraction of what is left, and the
/// next frame is as any other.
#[test]
fn a_slow_frame_is_cut_short() {
    let (mut world, mut simulation) = (World::new(), simulation(1.0 / 64.0));
    let alpha = simulation.advance(&mut world, 3600.0 + 1.0 / 256.0);
    assert_eq!(simulation.steps(), u64::from(Simulation::MAX_STEPS_PER_FRAME));
    assert_eq!(alpha, 0.25);
    let alpha = simulation.advance(&mut world, 1.0 / 64.0);
    assert_eq!(simulation.steps(), u64::from(Simulation::MAX_STEPS_PER_FRAME) + 1);
    assert_eq!(alpha, 0.25);
    // Exactly as many as are allowed are not too many.
    let most = f64::from(Simulation::MAX_STEPS_PER_FRAME);
    simulation.advance(&mut world, most / 64.0);
    assert_eq!(simulation.steps(), 2 * u64::from(Simulation::MAX_STEPS_PER_FRAME) + 1);
}

/// A clock that went backwards, stood still or broke: no step, no time, and no harm to what
/// follows.
#[test]
fn a_bad_frame_time_counts_as_none() {
    let (mut world, mut simulation) = (World::new(), simulation(1.0 / 64.0));
    simulation.advance(&mut world, 1.0 / 128.0);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, -0.0, 0.0] {
        assert_eq!(simulation.advance(&mut world, bad), 0.5, "{bad}");
        assert_eq!((simulation.steps(), simulation.time()), (0, 0.0), "{bad}");
    }
    // A frame that would last for ever is cut like any long one.
    let alpha = simulation.advance(&mut world, f64::MAX);
    assert!((0.0..1.0).contains(&alpha));
    assert_eq!(simulation.steps(), u64::from(Simulation::MAX_STEPS_PER_FRAME));
    simulation.advance(&mut world, 1.0 / 64.0);
    assert_eq!(simulation.steps(), u64::from(Simulation::MAX_STEPS_PER_FRAME) + 1);
}

/// Drawn one step late, a body in uniform motion is where it was a step ago at every frame: no
/// stutter, at any odd rate. In rotation too, since slerp is uniform.
#[test]
fn interpolated_poses_move_smoothly() {
    let dt: Real = 1.0 / 50.0;
    for frames_per_second in [23.976, 60.0, 144.0, 333.3] {
        let (mut world, mut simulation) = (World::new(), simulation(dt));
        let entity = spawn_moving(&mut world);
        let frame: f64 = 1.0 / frames_per_second;
        for i in 1..=200 {
            let alpha = simulation.advance(&mut world, frame);
            let time = f64::from(i) * frame - seconds(dt);
            if time < 0.0 {
                continue;
            }
            let pose = drawn(&world, entity, alpha);
            // Positions of up to 25 m and angles of up to 17 rad, rounded in each of up to 420
            // steps.
            let allowed = EPSILON * 420.0 * 25.0;
            assert!(
                (f64::from(pose.position.x) - 3.0 * time).abs() <= allowed,
                "{frames_per_second} Hz: {}",
                pose.position
            );
            let turned = 2.0 * f64::from(pose.orientation.z).atan2(f64::from(pose.orientation.w));
            let error = (turned - 2.0 * time).rem_euclid(std::f64::consts::TAU);
            let error = error.min(std::f64::consts::TAU - error);
            // glam's slerp takes its angle from an arc cosine, which is only good to the square
            // root of EPSILON for small steps.
            assert!(error <= allowed + EPSILON.sqrt() * 0.04, "{frames_per_second} Hz: off by {error:e} rad");
        }
    }
}

/// The pose before is that before the last step, of kinematic bodies as well.
#[test]
fn the_previous_pose_is_that_before_the_step() {
    // With colliders, even such that touch no one, steps go another way.
    let collider = Collider::new(&Shape::sphere(0.5)).unwrap().with_groups(0, 0);
    for (integrator, collides) in Integrator::ALL.into_iter().flat_map(|it| [(it, false), (it, true)]) {
        let mut world = World::new();
        let dynamic = spawn_moving(&mut world);
        let kinematic =
            RigidBody::new(Shape::sphere(0.5)).without_collider().kinematic().interpolated().angular_velocity(Vec3::X);
        let kinematic = kinematic.linear_velocity(Vec3::Z).build().unwrap().spawn(&mut world);
        for entity in [dynamic, kinematic].into_iter().filter(|_| collides) {
            world.insert_one(entity, collider.clone()).unwrap();
        }
        let mut simulation = Simulation::new(Settings::default().with_integrator(integrator).with_substeps(3)).unwrap();
        for _ in 0..5 {
            let before = [dynamic, kinematic].map(|entity| *world.get::<&Pose>(entity).unwrap());
            simulation.step(&mut world);
            for (entity, before) in [dynamic, kinematic].into_iter().zip(before) {
                assert_eq!(world.get::<&PreviousPose>(entity).unwrap().0, before, "{integrator}");
                assert_ne!(*world.get::<&Pose>(entity).unwrap(), before, "{integrator}");
            }
        }
    }
}

/// Time is steps times dt, not a sum that drifts, and goes on from where it was when the step is
/// changed.
#[test]
fn time_does_not_drift() {
    let (mut world, mut simulation) = (World::new(), simulation(0.001));
    for _ in 0..100_000 {
        simulation.step(&mut world);
    }
    assert_eq!(simulation.time(), 1e5 * seconds(0.001));
    simulation.set_settings(simulation.settings().with_dt(0.5)).unwrap();
    simulation.step(&mut world);
    assert_eq!((simulation.steps(), simulation.time()), (100_001, 1e5 * seconds(0.001) + 0.5));
}

/// Settings that nothing can be simulated with are refused, and the old ones stay.
#[test]
fn impossible_settings_are_refused() {
    let good = Settings::default();
    for dt in [0.0, -0.01, Real::NAN, Real::INFINITY, Real::MIN_POSITIVE / 2.0] {
        assert!(matches!(Simulation::new(good.with_dt(dt)), Err(SettingsError::Step(_))), "{dt}");
    }
    for substeps in [0, Settings::MAX_SUBSTEPS + 1] {
        assert!(
            matches!(Simulation::new(good.with_substeps(substeps)), Err(SettingsError::Substeps(s)) if s == substeps)
        );
    }
    let gravity = good.with_gravity(Vec3::new(0.0, Real::NAN, 0.0));
    assert!(matches!(Simulation::new(gravity), Err(SettingsError::Gravity(_))));
    let mut simulation = Simulation::new(good).unwrap();
    assert!(simulation.set_settings(gravity).is_err());
    assert_eq!(*simulation.settings(), good);
}
