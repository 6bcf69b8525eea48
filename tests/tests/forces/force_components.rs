//! Promise: each force component does what its equation says: bodies under it go where the closed
//! form puts them, under all three integrators, as near as the order of the method allows.
//!
//! Why: these are the forces that people build games and studies on, and a factor of two in one of
//! them looks plausible on a screen. It fails if a component takes a vector in the wrong frame,
//! forgets the wind or the throttle, takes moments about the wrong point, or acts at the wrong
//! stage of a step. Springs are in `spring_to_point.rs` and `springs.rs`.

use crate::one_body::{DT, MASS, MOMENTS, after, allowed, assert_near, body, state, world_of};
use glam::{DQuat, DVec3};
use hecs::DynamicBundle;
use tumble::Integrator::{self, MoserVeselov, RungeKutta4, SemiImplicitEuler};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    AngularVelocityServo, ConstantWrench, Drag, Frame, Inertia, Magnus, Momentum, PointGravity, RigidBody, Shape,
    Thruster, Wind,
};
use tumble_tests::{EPSILON, attitude_error, dquat, dvec3, run, seconds, simulation, weightless};

/// How near to a steady velocity a body comes, relative to it, that goes there at this rate [1/s]:
/// it stays where what a step adds to its momentum is less than what the step rounds it by, half of
/// `EPSILON` in each of up to four additions.
fn stalls_at(rate: f64) -> f64 {
    EPSILON * (16.0 + 2.0 / (rate * seconds(DT)))
}

/// The wrench on a body as the step applies it: `SemiImplicitEuler` adds it to the momentum as it
/// is at the start, all of it.
fn wrench_on(body: RigidBody, components: impl DynamicBundle) -> (DVec3, DVec3) {
    let (mut world, entity) = world_of(body, components);
    let before = *world.get::<&Momentum>(entity).unwrap();
    weightless(SemiImplicitEuler, DT).step(&mut world);
    let after = *world.get::<&Momentum>(entity).unwrap();
    let over_step = |a: Vec3, b: Vec3| (dvec3(b) - dvec3(a)) / seconds(DT);
    (over_step(before.linear, after.linear), over_step(before.angular, after.angular))
}

const TURNED: [f64; 4] = [0.5, -0.1, 0.7, 0.5];

fn turned() -> Quat {
    let [x, y, z, w] = TURNED.map(|number| number as Real);
    Quat::from_xyzw(x, y, z, w).normalize()
}

/// `v0/(1 + v0 K t/M)`, and the way is the logarithm of it.
#[test]
fn drag_slows_a_ball_down() {
    for integrator in Integrator::ALL {
        let ball = body().linear_velocity(Vec3::X * 10.0);
        let (pose, velocity) = after(128, integrator, ball, (Drag::isotropic(0.5),));
        // At the start it loses 2.5 of itself a second.
        let slower = 1.0 + 2.5;
        assert_near("speed", integrator, velocity.linear, DVec3::X * 10.0 / slower, 10.0, 2.5, 128);
        assert_near("way", integrator, pose.position, DVec3::X * 4.0 * f64::ln(slower), 10.0, 2.5, 128);
    }
}

/// `v tanh(g t/v)` with the terminal speed `v = (M g/K)^(1/2)`.
#[test]
fn a_falling_ball_reaches_its_terminal_speed() {
    // What is missing to the terminal speed decays at the rate 2 g/v.
    for integrator in Integrator::ALL {
        let (mut world, ball) = world_of(body(), (Drag::isotropic(0.8),));
        let mut simulation = simulation(integrator, Vec3::NEG_Y * 9.81, DT);
        let terminal = f64::sqrt(MASS * 9.81 / 0.8);
        run(&mut simulation, &mut world, 64);
        let exact = DVec3::NEG_Y * terminal * f64::tanh(9.81 * 0.5 / terminal);
        assert_near(
            "half a second",
            integrator,
            state(&world, ball).1.linear,
            exact,
            terminal,
            2.0 * 9.81 / terminal,
            64,
        );
        for _ in 0..4 {
            run(&mut simulation, &mut world, 1000);
            println!(
                "{integrator}: {:e} of the terminal speed is missing",
                1.0 + f64::from(state(&world, ball).1.linear.y) / terminal
            );
        }
        // Nothing is left of the way there, and the fixed point of every method is that of the
        // force.
        let speed = -f64::from(state(&world, ball).1.linear.y);
        let allowed = stalls_at(2.0 * 9.81 / terminal);
        assert!((speed / terminal - 1.0).abs() <= allowed, "{integrator}: {speed} for {terminal}");
    }
}

/// Each axis of the body has its own resistance: a turned plate is carried sideways, by
/// `-|u| R K R^T u`.
#[test]
fn drag_is_along_the_axes_of_the_body() {
    let drag = Drag { linear: Vec3::new(0.1, 4.0, 0.3), angular: Vec3::new(0.02, 0.05, 0.01) };
    let (v, w) = (Vec3::new(3.0, -1.0, 2.0), Vec3::new(-1.0, 2.0, 0.5));
    let wind = Vec3::new(1.0, 1.0, -4.0);
    let plate = body().orientation(turned()).linear_velocity(v).angular_velocity(w);
    let (force, torque) = wrench_on(plate, (drag, Wind(wind)));
    let resistance = |u: DVec3, k: Vec3| {
        let q = dquat(turned());
        q * (q.inverse() * u * dvec3(k)) * -u.length()
    };
    let expected = (resistance(dvec3(v - wind), drag.linear), resistance(dvec3(w), drag.angular));
    // Rounding: of the momentum, which the step divides the change by, and some operations of the
    // force.
    let round = |momentum: f64, scale: f64| EPSILON * (momentum / seconds(DT) + 32.0 * scale);
    assert!((force - expected.0).length() <= round(8.0, expected.0.length()), "{force} for {}", expected.0);
    assert!((torque - expected.1).length() <= round(2.0, expected.1.length()), "{torque} for {}", expected.1);
    // It is no mere brake: there is a good part across the velocity.
    assert!(force.cross(dvec3(v - wind).normalize()).length() > 0.2 * force.length());
}

/// A plate that falls at 45 degrees glides: along each of its axes it is a fall of its own only if
/// the other has stopped, but at the terminal velocity the force along both is zero:
/// `|u| k_i u_i = M g_i`.
#[test]
fn a_plate_glides() {
    for integrator in Integrator::ALL {
        let half = std::f64::consts::FRAC_PI_4 as Real;
        let drag = Drag { linear: Vec3::new(0.5, 2.0, 1.0), angular: Vec3::ZERO };
        let (mut world, plate) = world_of(body().orientation(Quat::from_rotation_z(half)), (drag,));
        run(&mut simulation(integrator, Vec3::NEG_Y * 9.81, DT), &mut world, 4000);
        let pull = DQuat::from_rotation_z(half.into()).inverse() * DVec3::NEG_Y * 9.81 * MASS;
        let direction = pull / dvec3(drag.linear);
        let exact = DQuat::from_rotation_z(half.into()) * direction / direction.length().sqrt();
        let found = dvec3(state(&world, plate).1.linear);
        assert!(found.x.abs() > 1.0, "{found}");
        // The slower of the two ways there, of the axis with the least resistance: |u| K/M a
        // second.
        let allowed = stalls_at(exact.length() * 0.5 / MASS) * exact.length();
        assert!((found - exact).length() <= allowed, "{integrator}: {found} for {exact}");
    }
}

/// In a wind a ball at rest is what one in still air is at that speed, seen from the wind.
#[test]
fn wind_carries_a_ball_along() {
    let wind = Vec3::new(6.0, 0.0, -8.0);
    for integrator in Integrator::ALL {
        let (_, velocity) = after(128, integrator, body(), (Drag::isotropic(0.5), Wind(wind)));
        let exact = dvec3(wind) * (1.0 - 1.0 / 3.5);
        assert_near("velocity", integrator, velocity.linear, exact, 10.0, 2.5, 128);
    }
    // Without anything that feels it, wind does nothing at all.
    let (pose, velocity) = after(10, MoserVeselov, body(), (Wind(wind),));
    assert_eq!((pose.position, velocity.linear), (Vec3::ZERO, Vec3::ZERO));
}

/// `w0/(1 + w0 C t/I)` about a principal axis.
#[test]
fn drag_slows_a_spin_down() {
    for integrator in Integrator::ALL {
        let top = body().angular_velocity(Vec3::Z * 4.0);
        let drag = Drag { linear: Vec3::ZERO, angular: Vec3::new(0.1, 0.2, 0.3) };
        let (pose, velocity) = after(128, integrator, top, (drag,));
        // 0.3 * 4/0.6 = 2 a second. In the angle the map adds its sixth order, below all else here.
        assert_near("spin", integrator, velocity.angular, DVec3::Z * 4.0 / 3.0, 4.0, 2.0, 128);
        let angle = 2.0 * f64::atan2(pose.orientation.z.into(), pose.orientation.w.into());
        let exact = 2.0 * f64::ln(3.0);
        // The first-order rotation by 1/2 [0, w] q is short by (w dt)^3/12 a step, the fourth-order
        // one by (w dt)^5/1920.
        let bound = 4.0 * allowed(integrator, 4.0, 128);
        assert!((angle - exact).abs() <= bound, "{integrator}: {angle} for {exact}");
    }
}

/// A circle at the angular velocity `S w/M`, seen from the wind.
#[test]
fn a_spinning_ball_goes_round() {
    let (wind, v) = (Vec3::new(0.5, -1.0, 0.25), Vec3::new(3.0, 1.0, 0.5));
    for integrator in Integrator::ALL {
        for wind in [Vec3::ZERO, wind] {
            let ball = body().linear_velocity(v).angular_velocity(Vec3::Z * 5.0);
            let (pose, velocity) = after(256, integrator, ball, (Magnus { coefficient: 0.8 }, Wind(wind)));
            let (rate, time) = (0.8 * 5.0 / MASS, 2.0);
            let u = dvec3(v - wind);
            let round = DQuat::from_rotation_z(rate * time) * u;
            let scale = u.length();
            assert_near("velocity", integrator, velocity.linear, dvec3(wind) + round, scale, rate, 256);
            // Radius |u|/rate about a centre on the left, which goes with the wind; along the axis
            // nothing turns.
            let to_center = |u: DVec3| DVec3::new(-u.y, u.x, 0.0) / rate;
            let along = DVec3::Z * u.z * time;
            let exact = dvec3(wind) * time + along + to_center(u) - to_center(round);
            assert_near("place", integrator, pose.position, exact, time * scale, rate, 256);
            assert_eq!(velocity.angular, Vec3::Z * 5.0);
        }
    }
}

/// `throttle R f` and `throttle R (p x f)`, summed over the nozzles; a closed valve does nothing.
#[test]
fn a_thruster_pushes_at_its_point() {
    let nozzles = [
        (Vec3::new(1.0, 2.0, -0.5), Vec3::new(0.3, -0.2, 0.9)),
        (Vec3::new(-2.0, 0.5, 1.0), Vec3::new(-0.4, 0.1, 0.2)),
        (Vec3::new(0.0, 0.0, 3.0), Vec3::new(0.0, 0.7, 0.0)),
    ];
    let [(f, p), rest @ ..] = nozzles;
    let mut thruster = Thruster::new(f, p);
    for (f, p) in rest {
        thruster = thruster.and(f, p);
    }
    for throttle in [1.0, 0.25, -0.5, 0.0] {
        let (force, torque) = wrench_on(body().orientation(turned()), (Thruster { throttle, ..thruster },));
        let q = dquat(turned());
        let of = |sum: fn(DVec3, DVec3) -> DVec3| {
            nozzles.iter().map(|&(f, p)| q * sum(dvec3(f), dvec3(p)) * seconds(throttle)).sum::<DVec3>()
        };
        let expected = (of(|f, _| f), of(|f, p| p.cross(f)));
        // Some operations on newtons and newton metres.
        let allowed = 32.0 * EPSILON * 4.0;
        assert!((force - expected.0).length() <= allowed, "{force} for {}", expected.0);
        assert!((torque - expected.1).length() <= allowed, "{torque} for {}", expected.1);
        if throttle == 0.0 {
            assert_eq!((force, torque), (DVec3::ZERO, DVec3::ZERO));
        }
    }
}

/// A push along the body's x axis turns with it: `P = F/w (sin w t, 1 - cos w t)`. The same by a
/// thruster and by a constant wrench in the body's frame.
#[test]
fn what_is_fixed_to_the_body_turns_with_it() {
    let thruster = Thruster { throttle: 0.5, ..Thruster::new(Vec3::X * 6.0, Vec3::X * 2.0) };
    let wrench = ConstantWrench { force: Vec3::X * 3.0, torque: Vec3::ZERO, frame: Frame::Body };
    for integrator in Integrator::ALL {
        let spinning = || body().angular_velocity(Vec3::Z * 2.0);
        let by_thruster = after(192, integrator, spinning(), (thruster,));
        let by_wrench = after(192, integrator, spinning(), (wrench,));
        let phase: f64 = 2.0 * 1.5;
        let exact = DVec3::new(phase.sin(), 1.0 - phase.cos(), 0.0) * (3.0 / 2.0 / MASS);
        for (_, velocity) in [by_thruster, by_wrench] {
            assert_near("velocity", integrator, velocity.linear, exact, 1.5, 2.0, 192);
        }
    }
}

/// `x0 + v0 t + F t^2/2M`, to rounding where the method has the square of time right.
#[test]
fn a_constant_force_makes_a_parabola() {
    let force = Vec3::new(3.0, -1.0, 2.0);
    for integrator in Integrator::ALL {
        let stone = body().position(Vec3::Y).linear_velocity(Vec3::Z).orientation(turned());
        let wrench = ConstantWrench { force, ..ConstantWrench::default() };
        let (pose, velocity) = after(256, integrator, stone, (wrench,));
        let acceleration = dvec3(force) / MASS;
        // The first-order method is half a step ahead.
        let ahead =
            if integrator == SemiImplicitEuler { acceleration * (0.5 * seconds(DT) * 2.0) } else { DVec3::ZERO };
        let exact = DVec3::Y + DVec3::Z * 2.0 + acceleration * 2.0 + ahead;
        assert!((dvec3(pose.position) - exact).length() <= 256.0 * EPSILON * exact.length(), "{pose:?} for {exact}");
        let exact = DVec3::Z + acceleration * 2.0;
        assert!((dvec3(velocity.linear) - exact).length() <= 256.0 * EPSILON * exact.length());
    }
}

/// About a principal axis, in either frame: `w = tau t/I`, and the angle `tau t^2/2I`.
#[test]
fn a_constant_torque_spins_a_body_up() {
    for integrator in Integrator::ALL {
        for frame in [Frame::World, Frame::Body] {
            for (axis, moment) in [(Vec3::X, MOMENTS.x), (Vec3::Y, MOMENTS.y), (Vec3::Z, MOMENTS.z)] {
                // In the body's frame the axis is one of the turned body; in the world's frame the
                // body is upright.
                let orientation = if frame == Frame::Body { turned() } else { Quat::IDENTITY };
                let wrench = ConstantWrench { torque: axis * 0.25, frame, ..ConstantWrench::default() };
                let (pose, velocity) = after(256, integrator, body().orientation(orientation), (wrench,));
                let axis_world = dquat(orientation) * dvec3(axis);
                let rate = 0.25 * 2.0 / moment;
                let error = (dvec3(velocity.angular) - axis_world * rate).length();
                assert!(error <= 256.0 * EPSILON * rate, "{integrator}, {frame:?}: {} for {rate}", velocity.angular);
                let exact = DQuat::from_axis_angle(axis_world, rate) * dquat(orientation);
                let error = attitude_error(dquat(pose.orientation), exact);
                assert!(
                    error <= allowed(integrator, rate, 256) + 256.0 * EPSILON,
                    "{integrator}, {frame:?}: {error:e}"
                );
            }
        }
    }
}

/// The centre of mass of an ellipse at a time after the pericentre, by Kepler's equation, for
/// `a = 1`.
fn on_ellipse(eccentricity: f64, mean_anomaly: f64) -> DVec3 {
    let mut anomaly = mean_anomaly;
    for _ in 0..50 {
        anomaly -= (anomaly - eccentricity * anomaly.sin() - mean_anomaly) / (1.0 - eccentricity * anomaly.cos());
    }
    DVec3::new(anomaly.cos() - eccentricity, (1.0 - eccentricity * eccentricity).sqrt() * anomaly.sin(), 0.0)
}

/// Circles and ellipses, whatever the mass, at the times of Kepler's equation.
#[test]
fn a_planet_goes_round() {
    let center = Vec3::new(2.0, -1.0, 0.5);
    let gravity = PointGravity { center, mu: 4.0, softening: 0.0 };
    for integrator in Integrator::ALL {
        for eccentricity in [0.0, 0.3] {
            let nearest = 1.0 - eccentricity;
            let fastest = f64::sqrt(4.0 * (1.0 + eccentricity) / nearest);
            let planet = body().position(center + Vec3::X * nearest as Real).linear_velocity(Vec3::Y * fastest as Real);
            for steps in [128, 402] {
                let (pose, _) = after(steps, integrator, planet.clone(), (gravity,));
                let exact = dvec3(center) + on_ellipse(eccentricity, 2.0 * f64::from(steps) * seconds(DT));
                // The angular velocity at the pericentre; a shift in energy becomes one in phase,
                // so the errors add up twice.
                let rate = fastest / nearest;
                let turns = f64::from(steps) * seconds(DT) * rate;
                assert_near("place", integrator, pose.position, exact, 1.0 + turns, rate, steps);
            }
        }
    }
}

/// With softening: `M mu r/(r^2 + e^2)^(3/2)`; in the centre none; at planets' distances the
/// figures of single precision are enough.
#[test]
fn softened_gravity_is_finite() {
    let at = |x: Vec3, softening: Real, mu: Real| {
        wrench_on(body().position(x), (PointGravity { center: Vec3::ZERO, mu, softening },)).0
    };
    for (x, e, mu) in
        [(1.0, 0.0, 3.0), (0.5, 2.0, 3.0), (1.496e11, 0.0, 1.327e20), (1e-9, 0.0, 1e-20), (3.0, 1e10, 1e12)]
    {
        let force = at(Vec3::Z * x as Real, e as Real, mu as Real);
        let exact = -MASS * mu * x / (x * x + e * e).powf(1.5);
        assert!((force.z / exact - 1.0).abs() <= 16.0 * EPSILON, "{x}, {e}: {force} for {exact}");
        assert_eq!((force.x, force.y), (0.0, 0.0));
    }
    assert_eq!(at(Vec3::ZERO, 0.0, 1.0), DVec3::ZERO);
    assert_eq!(at(Vec3::ZERO, 1.0, 1.0), DVec3::ZERO);
}

/// Where the torque suffices, the wanted spin is there after one step: about a principal axis to
/// rounding, about others but for what the body precesses in a step. Under `RungeKutta4` 0.375 of
/// the difference is left.
#[test]
fn a_servo_reaches_its_target_in_a_step() {
    for integrator in Integrator::ALL {
        for frame in [Frame::World, Frame::Body] {
            let servo = AngularVelocityServo { target: Vec3::Y * 3.0, frame, max_torque: Real::INFINITY };
            let orientation = if frame == Frame::Body { turned() } else { Quat::IDENTITY };
            let target = dquat(orientation) * DVec3::Y * 3.0;
            let (_, velocity) = after(1, integrator, body().orientation(orientation), (servo,));
            let left = if integrator == RungeKutta4 { 0.375 } else { 0.0 };
            let error = (dvec3(velocity.angular) - target * (1.0 - left)).length();
            assert!(error <= 32.0 * EPSILON * 3.0, "{integrator}, {frame:?}: {}", velocity.angular);
            // From any spin, about any axis, and kept: to what w x I w/I does to the spin in a
            // step.
            let spinning = body().orientation(turned()).angular_velocity(Vec3::new(2.0, -1.0, 4.0));
            let servo = AngularVelocityServo { target: Vec3::new(1.0, 2.0, -1.0), ..servo };
            for steps in [20, 200] {
                let (pose, velocity) = after(steps, integrator, spinning.clone(), (servo,));
                let wanted = if frame == Frame::Body { pose.orientation * servo.target } else { servo.target };
                let error = (dvec3(velocity.angular) - dvec3(wanted)).length();
                let precession = dvec3(servo.target).length_squared() * 0.5;
                assert!(error <= precession * seconds(DT), "{integrator}, {frame:?}, {steps}: off by {error:e}");
            }
        }
    }
}

/// Against its limit the spin changes by `max_torque/I` a second, and then it is there and stays.
#[test]
fn a_servo_has_no_more_torque_than_it_has() {
    for integrator in Integrator::ALL {
        let servo = AngularVelocityServo { target: Vec3::X * 2.0, frame: Frame::Body, max_torque: 0.5 };
        let (_, velocity) = after(128, integrator, body(), (servo,));
        // A second: 0.5/0.4 rad/s.
        let error = (dvec3(velocity.angular) - DVec3::X * 1.25).length();
        assert!(error <= 256.0 * EPSILON, "{integrator}: {}", velocity.angular);
        let (_, velocity) = after(300, integrator, body(), (servo,));
        let error = (dvec3(velocity.angular) - DVec3::X * 2.0).length();
        assert!(error <= 32.0 * EPSILON, "{integrator}: {}", velocity.angular);
    }
    // None at all, and none missing.
    for servo in [
        AngularVelocityServo { target: Vec3::X, frame: Frame::World, max_torque: 0.0 },
        AngularVelocityServo { target: Vec3::ZERO, frame: Frame::World, max_torque: 0.0 },
        AngularVelocityServo { target: Vec3::ZERO, frame: Frame::Body, max_torque: Real::INFINITY },
    ] {
        let (pose, velocity) = after(10, MoserVeselov, body(), (servo,));
        assert_eq!((pose.orientation, velocity.angular), (Quat::IDENTITY, Vec3::ZERO), "{servo:?}");
    }
}

/// A body with its own principal axes and a point mass: the servo asks for `I w` in the right
/// frame, and for nothing of what cannot turn.
#[test]
fn a_servo_knows_the_principal_axes() {
    let inertia = tumble::InertiaTensor::from_principal(MOMENTS, dquat(turned())).unwrap();
    let lopsided = || RigidBody::new(Shape::Point).mass(MASS).inertia(inertia);
    let wanted = Vec3::new(0.3, -0.6, 0.9);
    let servo = AngularVelocityServo { target: wanted, frame: Frame::World, max_torque: Real::INFINITY };
    let (_, torque) = wrench_on(lopsided(), (servo,));
    let exact = inertia.matrix() * dvec3(wanted) / seconds(DT);
    assert!((torque - exact).length() <= 64.0 * EPSILON * exact.length(), "{torque} for {exact}");
    assert!(Inertia::new(MOMENTS).is_ok());
    let (_, velocity) = after(3, MoserVeselov, RigidBody::new(Shape::Point).mass(1.0), (servo,));
    assert_eq!(velocity.angular, Vec3::ZERO);
}
