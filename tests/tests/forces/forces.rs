//! Promise: forces and impulses act as mechanics says: at a point they are a force and a torque,
//! many are their sum, and each step uses them up; a torque makes a body with products of inertia
//! turn about other axes too; a wanted angular velocity can be reached at once; a change of inertia
//! keeps angular momentum; gravity scales per body; a point mass never turns.
//!
//! Why: this is where a game or a controller meets the engine. It fails if a torque is taken about
//! the wrong point, in the wrong frame or with the wrong sign, if a wrench survives its step, or if
//! spin rather than angular momentum is kept.

use glam::{DMat3, DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    CenterOfMass, GravityScale, Inertia, InertiaTensor, Integrator, InverseInertia, Momentum, Pose, PrincipalAxes,
    RigidBody, Settings, Shape, Simulation, Velocity, Wrench, update_derived,
};
use tumble_benches::Rng;
use tumble_tests::references::real_vec3;
use tumble_tests::{EPSILON, dquat, dvec3, energy_of, seconds, weightless};

fn spawn(world: &mut World, body: RigidBody) -> Entity {
    body.build().unwrap().spawn(world)
}

/// Steps of a power of two, so that a second of them is exact.
const DT: Real = 1.0 / 64.0;

fn brick() -> RigidBody {
    RigidBody::new(Shape::cuboid([0.5, 1.0, 1.5])).without_collider().mass(2.0)
}

/// A tensor with products of inertia: `Ixy = -0.4` as a matrix element, so mass leans towards
/// `x = y`.
fn lopsided() -> InertiaTensor {
    let columns = [DVec3::new(2.0, -0.4, 0.1), DVec3::new(-0.4, 1.5, 0.3), DVec3::new(0.1, 0.3, 2.5)];
    InertiaTensor::new(DMat3::from_cols(columns[0], columns[1], columns[2])).unwrap()
}

/// The whole state and what is derived from it.
fn state(world: &World, entity: Entity) -> (Pose, Momentum, Velocity) {
    let mut query = world.query_one::<(&Pose, &Momentum, &Velocity)>(entity);
    let (pose, momentum, velocity) = query.get().unwrap();
    (*pose, *momentum, *velocity)
}

/// A force at a point is that force through the centre of mass with the torque `r x F` about it:
/// the same bits, for a body whose own frame has its origin elsewhere too.
#[test]
fn a_force_at_a_point_is_a_force_and_a_torque() {
    let (force, arm) = (Vec3::new(1.0, -2.0, 3.0), Vec3::new(0.5, 0.25, -1.0));
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let cone =
            || RigidBody::new(Shape::cone(0.5, 1.0)).without_collider().mass(2.0).position(Vec3::new(3.0, 2.0, 1.0));
        let (at_point, split) = (spawn(&mut world, cone()), spawn(&mut world, cone()));
        assert!(world.get::<&CenterOfMass>(at_point).is_ok());
        let center = world.get::<&Pose>(at_point).unwrap().position;
        world.get::<&mut Wrench>(at_point).unwrap().add_force_at(force, center + arm, center);
        world.get::<&mut Wrench>(split).unwrap().add_force(force);
        // The arm as it comes out of the difference of two positions.
        world.get::<&mut Wrench>(split).unwrap().add_torque(((center + arm) - center).cross(force));
        weightless(integrator, DT).step(&mut world);
        assert_eq!(state(&world, at_point), state(&world, split), "{integrator}");
        let momentum = state(&world, at_point).1;
        // F dt and r x F dt, but for the arm's rounding and that of the weights 1/6 and 1/3 of the
        // fourth-order scheme.
        assert!((momentum.linear - force / 64.0).length() <= 4.0 * Real::EPSILON * force.length() / 64.0);
        let torque = dvec3(arm).cross(dvec3(force)) / 64.0;
        assert!(
            (dvec3(momentum.angular) - torque).length() <= 16.0 * EPSILON * torque.length(),
            "{}",
            momentum.angular
        );
    }
}

/// The wrench is zero after the step and does not act again.
#[test]
fn a_step_uses_its_wrench_up() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let entity = spawn(&mut world, brick());
        *world.get::<&mut Wrench>(entity).unwrap() = Wrench { force: Vec3::X, torque: Vec3::Y };
        let mut simulation = weightless(integrator, DT);
        simulation.step(&mut world);
        let after_one = state(&world, entity).1;
        assert_ne!(after_one, Momentum::default());
        assert_eq!(*world.get::<&Wrench>(entity).unwrap(), Wrench::default());
        simulation.step(&mut world);
        assert_eq!(state(&world, entity).1, after_one, "{integrator}");
    }
}

/// A rod struck at its end moves off with `v = J/m` and turns with `w = r x J/I`, so that a point
/// at two thirds of its length from there stays at rest for the moment (the centre of percussion).
/// Three or four roundings each.
#[test]
fn a_blow_at_the_end_of_a_rod() {
    let (mass, length, blow) = (3.0, 2.0, 6.0);
    let mut world = World::new();
    // A thin rod along x: m l^2/12 across it.
    let across = mass * length * length / 12.0;
    let inertia = InertiaTensor::from_principal([1e-4, across, across], DQuat::IDENTITY).unwrap();
    let rod = spawn(&mut world, RigidBody::new(Shape::Point).mass(mass).inertia(inertia).position(Vec3::Y));
    let end = Vec3::new(1.0, 1.0, 0.0);
    world.get::<&mut Momentum>(rod).unwrap().apply_impulse_at(Vec3::Z * blow, end, Vec3::Y);
    update_derived(&mut world);
    let velocity = state(&world, rod).2;
    assert!((velocity.linear - Vec3::Z * 2.0).length() <= 4.0 * Real::EPSILON);
    assert!((velocity.angular - Vec3::NEG_Y * 6.0).length() <= 4.0 * Real::EPSILON * 6.0);
    let percussion = end - Vec3::X * (2.0 / 3.0 * 2.0);
    assert!(velocity.at_point(percussion, Vec3::Y).length() <= 16.0 * Real::EPSILON);
    assert!((velocity.at_point(end, Vec3::Y) - Vec3::Z * 8.0).length() <= 16.0 * Real::EPSILON * 8.0);
}

/// D'Alembert: a hundred forces at points move a body as their resultant and its moment do. The
/// sums of a hundred terms differ by their roundings, half an `EPSILON` of the running sum each.
#[test]
fn many_forces_are_their_sum() {
    for integrator in Integrator::ALL {
        let mut rng = Rng::new(7);
        let mut world = World::new();
        let (many, one) = (spawn(&mut world, brick()), spawn(&mut world, brick()));
        let (mut force, mut torque, mut size) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for _ in 0..100 {
            let (f, at) = (rng.vector(-10.0, 10.0), rng.vector(-2.0, 2.0));
            world.get::<&mut Wrench>(many).unwrap().add_force_at(f, at, Vec3::ZERO);
            force += dvec3(f);
            torque += dvec3(at).cross(dvec3(f));
            size += dvec3(f).length() * (1.0 + dvec3(at).length());
        }
        *world.get::<&mut Wrench>(one).unwrap() = Wrench { force: real_vec3(force), torque: real_vec3(torque) };
        weightless(integrator, DT).step(&mut world);
        let (of_many, of_one) = (state(&world, many).1, state(&world, one).1);
        let allowed = EPSILON * size / 64.0;
        assert!(dvec3(of_one.linear).length() > 1e4 * allowed);
        assert!((dvec3(of_many.linear) - dvec3(of_one.linear)).length() <= allowed, "{integrator}");
        assert!((dvec3(of_many.angular) - dvec3(of_one.angular)).length() <= allowed, "{integrator}");
    }
}

/// A constant force through the centre for a second: `v = F t/m`; a constant torque about a
/// principal axis: `w = tau t/I` and the angle `tau t^2/2I`, first-order schemes off by half a step
/// of it. Rounding: one a step.
#[test]
fn constant_force_and_torque() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let entity = spawn(&mut world, brick());
        let moment = f64::from(world.get::<&Inertia>(entity).unwrap().moments().z);
        let mut simulation = weightless(integrator, DT);
        for _ in 0..64 {
            let mut wrench = world.get::<&mut Wrench>(entity).unwrap();
            wrench.add_force(Vec3::X * 4.0);
            wrench.add_torque(Vec3::Z * 0.5);
            drop(wrench);
            simulation.step(&mut world);
        }
        let (pose, _, velocity) = state(&world, entity);
        assert!((velocity.linear.x - 2.0).abs() <= 64.0 * Real::EPSILON, "{integrator}");
        assert!((f64::from(velocity.angular.z) * moment / 0.5 - 1.0).abs() <= 64.0 * EPSILON, "{integrator}");
        let turned = 2.0 * dquat(pose.orientation).z.asin();
        let exact = 0.5 / moment / 2.0;
        let late = match integrator {
            Integrator::SemiImplicitEuler => exact / 64.0,
            _ => 0.0,
        };
        // The first-order turn is short by (w dt)^3/12, the fourth-order one by (w dt)^5/480 a
        // step, the exact one by nothing.
        let short = 64.0 * (exact * 2.0 / 64.0_f64).powi(3) / 12.0;
        assert!((turned - exact - late).abs() <= short + 64.0 * EPSILON, "{integrator}: {turned} rad");
    }
}

/// The Unity idiom: the torque that reaches a wanted angular momentum in one step, and the impulse
/// that reaches a wanted angular velocity at once, for a body whose principal axes are not those of
/// its frame.
#[test]
fn a_wanted_angular_velocity_is_reached() {
    let wanted = Vec3::new(0.3, -2.0, 1.5);
    let orientation = Quat::from_xyzw(0.1, 0.7, -0.5, 0.5).normalize();
    let body = || brick().inertia(lopsided()).orientation(orientation).angular_velocity(Vec3::new(1.0, 1.0, -4.0));
    let needed = |world: &World, entity: Entity| {
        let mut query = world.query_one::<(&Pose, &Momentum, &Inertia, &PrincipalAxes)>(entity);
        let (pose, momentum, inertia, axes) = query.get().unwrap();
        inertia.angular_momentum(pose.orientation * axes.0, wanted) - momentum.angular
    };
    let tensor =
        DMat3::from_quat(dquat(orientation)) * lopsided().matrix() * DMat3::from_quat(dquat(orientation)).transpose();

    let mut world = World::new();
    let struck = spawn(&mut world, body());
    let impulse = needed(&world, struck);
    world.get::<&mut Momentum>(struck).unwrap().apply_angular_impulse(impulse);
    update_derived(&mut world);
    let error = (state(&world, struck).2.angular - wanted).length();
    // Two rotations there and two back through the principal frame, about ten roundings each.
    assert!(error <= 40.0 * Real::EPSILON * 2.5, "{error:e} rad/s");

    for integrator in Integrator::ALL {
        let mut world = World::new();
        let turned = spawn(&mut world, body());
        let torque = needed(&world, turned) * 64.0;
        world.get::<&mut Wrench>(turned).unwrap().add_torque(torque);
        weightless(integrator, DT).step(&mut world);
        let error = dvec3(state(&world, turned).1.angular) - tensor * dvec3(wanted);
        // Angular momentum to rounding; the spin is then that of a free body of this angular
        // momentum, which wobbles.
        assert!(error.length() <= 40.0 * EPSILON * 10.0, "{integrator}: {error}");
    }
}

/// "What I_xy tells us is how much our object will be accelerated around the y axis when we apply
/// torque around the x axis": `dw = I^-1 tau`, by an independent inverse of the tensor. A body
/// without products of inertia accelerates about x alone.
#[test]
fn a_torque_about_x_accelerates_a_lopsided_body_about_y() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let lopsided_body = spawn(&mut world, brick().inertia(lopsided()));
        let symmetric = spawn(&mut world, brick());
        let dt: Real = 1.0 / 1024.0;
        for entity in [lopsided_body, symmetric] {
            world.get::<&mut Wrench>(entity).unwrap().add_torque(Vec3::X);
        }
        let at_rest = *world.get::<&InverseInertia>(lopsided_body).unwrap() * Vec3::X;
        weightless(integrator, dt).step(&mut world);
        let expected = lopsided().matrix().inverse() * DVec3::X;
        assert!(expected.y > 0.1, "the products of inertia must matter: {expected}");
        // Forming the inverse takes about twenty roundings.
        assert!((dvec3(at_rest) - expected).length() <= 20.0 * EPSILON);
        let gained = dvec3(state(&world, lopsided_body).2.angular) / seconds(dt);
        // Meanwhile the body turns by at most dw dt^2, which turns its tensor by as much.
        let turned = expected.length() * seconds(dt).powi(2);
        assert!((gained - expected).length() <= 2.0 * turned + 40.0 * EPSILON, "{integrator}: {gained} not {expected}");
        let straight = state(&world, symmetric).2.angular;
        assert!(straight.x > 0.0 && straight.y == 0.0 && straight.z == 0.0, "{integrator}: {straight}");
    }
}

/// The skater draws her arms in: half the moment, the same angular momentum, twice the spin and
/// twice the energy, for which her arms have worked. All factors are powers of two: exact.
#[test]
fn the_skater() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let inertia = InertiaTensor::from_principal([4.0, 2.0, 4.0], DQuat::IDENTITY).unwrap();
        let body = RigidBody::new(Shape::Point).mass(64.0).inertia(inertia).angular_velocity(Vec3::Y * 3.0);
        let skater = spawn(&mut world, body);
        let mut simulation = weightless(integrator, DT);
        let (_, before, velocity) = state(&world, skater);
        let energy = energy_of(&world, skater);
        assert_eq!(velocity.angular, Vec3::Y * 3.0);

        world.insert_one(skater, Inertia::new([4.0, 1.0, 4.0].map(f64::from)).unwrap()).unwrap();
        simulation.step(&mut world);
        let (_, after, velocity) = state(&world, skater);
        assert_eq!(after, before, "{integrator}");
        // The orientation is rounded once.
        assert!((velocity.angular - Vec3::Y * 6.0).length() <= 6.0 * 4.0 * Real::EPSILON, "{integrator}");
        assert!((energy_of(&world, skater) / energy - 2.0).abs() <= 8.0 * EPSILON, "{integrator}");

        // Off her axis she wobbles, and what is kept is the vector.
        world.get::<&mut Momentum>(skater).unwrap().apply_angular_impulse(Vec3::X);
        let tilted = state(&world, skater).1;
        for moment in [2.0, 3.0, 1.0, 2.0] {
            world.insert_one(skater, Inertia::new([4.0, moment, 4.0]).unwrap()).unwrap();
            for _ in 0..64 {
                simulation.step(&mut world);
            }
            assert_eq!(state(&world, skater).1, tilted, "{integrator}");
        }
    }
}

/// `v = s g t`; a body without the component falls with 1. One rounding a step.
#[test]
fn gravity_scales_per_body() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let scales: [Option<Real>; 5] = [None, Some(0.0), Some(0.5), Some(-1.0), Some(2.0)];
        let bodies = scales.map(|scale| spawn(&mut world, scale.map_or(brick(), |s| brick().gravity_scale(s))));
        let mut simulation =
            Simulation::new(Settings::default().with_dt(1.0 / 64.0).with_integrator(integrator)).unwrap();
        for _ in 0..64 {
            simulation.step(&mut world);
        }
        for (scale, body) in scales.into_iter().zip(bodies) {
            let v = state(&world, body).2.linear.y;
            let expected = -9.81 * scale.unwrap_or(1.0);
            assert!((v - expected).abs() <= 64.0 * Real::EPSILON * expected.abs(), "{integrator}: {v} not {expected}");
        }
        // Changed while running, it acts from the next step on.
        world.get::<&mut GravityScale>(bodies[4]).unwrap().0 = 0.0;
        let before = state(&world, bodies[4]).1;
        simulation.step(&mut world);
        assert_eq!(state(&world, bodies[4]).1, before);
    }
}

/// A point has no inertia: a force moves it, a torque on it turns nothing, and it has no spin.
#[test]
fn a_point_mass_moves_and_does_not_turn() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let point = spawn(&mut world, RigidBody::new(Shape::Point).mass(0.5).linear_velocity(Vec3::X));
        assert!(world.get::<&Inertia>(point).is_err());
        let mut simulation = weightless(integrator, DT);
        for _ in 0..64 {
            *world.get::<&mut Wrench>(point).unwrap() = Wrench { force: Vec3::Y, torque: Vec3::Z };
            simulation.step(&mut world);
        }
        let (pose, momentum, velocity) = state(&world, point);
        assert_eq!(pose.orientation, Quat::IDENTITY, "{integrator}");
        assert_eq!(velocity.angular, Vec3::ZERO, "{integrator}");
        // Of 64 steps each rounds once or twice.
        let close = |v: Vec3, expected: Vec3| (v - expected).length() <= 64.0 * Real::EPSILON * expected.length();
        assert!(close(momentum.linear, Vec3::new(0.5, 1.0, 0.0)), "{integrator}: {}", momentum.linear);
        assert!(close(velocity.linear, Vec3::new(1.0, 2.0, 0.0)), "{integrator}: {}", velocity.linear);
        // One second along x at 1 m/s.
        assert!((pose.position.x - 1.0).abs() <= 64.0 * Real::EPSILON, "{integrator}: {}", pose.position);
    }
}
