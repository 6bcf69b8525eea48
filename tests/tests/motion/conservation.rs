//! Promise: on a free body momentum and angular momentum never change, to the bit, under any
//! integrator; energy is kept to rounding by `MoserVeselov`, to the fifth power of the step by
//! `RungeKutta4`, and grows under `SemiImplicitEuler` as its documentation says; orientations stay
//! of unit length; a body spins on about its largest and its smallest axis and flips about the
//! middle one, as often as the exact solution says.
//!
//! Why: it is what the engine is for. It fails if the state is velocity instead of momentum, if a
//! frame or the order of a product is wrong, if the map is not the energy-keeping one, or if
//! orientations are not normalised.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    BodyOrder, Damping, InertiaTensor, Integrator, Momentum, Pose, PrincipalAxes, RigidBody, Settings, Shape, Totals,
    Velocity,
};
use tumble_benches::mixed_body;
use tumble_tests::{EPSILON, FreeBody, attitude_error, by_precision, dquat, dvec3, energy_of, run, weightless};

/// All kinds of bodies, and the reference bodies, without damping.
fn many_free_bodies() -> World {
    let mut world = World::new();
    for id in 0..512 {
        let entity = mixed_body(id).spawn(&mut world);
        let _ = world.remove_one::<Damping>(entity);
    }
    for body in [FreeBody::van_zon_top(), FreeBody::drake_cylinder(), FreeBody::t_handle()] {
        body.spawn(&mut world);
    }
    world
}

/// Nothing is added to a momentum but zero, so there is no rounding and no tolerance.
#[test]
fn both_momenta_are_kept_to_the_bit() {
    for integrator in Integrator::ALL {
        let mut world = many_free_bodies();
        let order = BodyOrder::of(&world);
        let momenta = |world: &World| -> Vec<Momentum> {
            order.entities().iter().filter_map(|&e| world.get::<&Momentum>(e).ok().map(|m| *m)).collect()
        };
        let before = momenta(&world);
        run(&mut weightless(integrator, 0.01), &mut world, 1000);
        let after = momenta(&world);
        assert!(before.iter().any(|m| m.angular != Vec3::ZERO && m.linear != Vec3::ZERO));
        // Bit by bit, but that a zero may lose its sign: -0 + 0 is 0.
        assert_eq!(before, after, "{integrator}");
    }
}

/// Rounding `q (1, u)`, its length and the quotient are three roundings of `EPSILON/2` at most.
#[test]
fn orientations_stay_of_unit_length() {
    for integrator in Integrator::ALL {
        let mut world = many_free_bodies();
        run(&mut weightless(integrator, 0.01), &mut world, 1000);
        for pose in world.query_mut::<&Pose>() {
            let q = pose.orientation;
            let [x, y, z, w] = q.to_array().map(f64::from);
            let length = (x * x + y * y + z * z + w * w).sqrt();
            assert!((length - 1.0).abs() <= 2.0 * EPSILON, "{integrator}: |{q}| = {length}");
        }
    }
}

/// Each step rounds the orientation, turning it by about `EPSILON`, and a turn by `e` changes the
/// energy by at most `|w x L| e`, here less than `2 T e`. At random the steps add up to
/// `2 EPSILON sqrt(steps)`; four times that is all but never reached.
#[test]
fn moser_veselov_keeps_energy_to_rounding() {
    for body in [FreeBody::van_zon_top(), FreeBody::drake_cylinder(), FreeBody::t_handle(), FreeBody::mujoco_box()] {
        for dt in [0.001, 0.01, 0.1] {
            let (mut world, mut simulation) = (World::new(), weightless(Integrator::MoserVeselov, dt));
            let entity = body.spawn(&mut world);
            let start = energy_of(&world, entity);
            // As in the source, up to rounding of moments and momenta: a few EPSILON.
            assert!((start / body.energy - 1.0).abs() <= 4.0 * EPSILON, "{}: {start} J", body.name);
            let mut worst = 0.0_f64;
            for _ in 0..10_000 {
                simulation.step(&mut world);
                worst = worst.max((energy_of(&world, entity) / start - 1.0).abs());
            }
            println!("{} at dt {dt}: energy kept to {worst:.1e}", body.name);
            assert!(worst <= 8.0 * EPSILON * 100.0, "{} at dt {dt}: {worst:e}", body.name);
        }
    }
}

fn energy_drift(body: &FreeBody, integrator: Integrator, dt: Real, steps: u32) -> f64 {
    let mut world = World::new();
    let entity = body.spawn(&mut world);
    let start = energy_of(&world, entity);
    run(&mut weightless(integrator, dt), &mut world, steps);
    energy_of(&world, entity) / start - 1.0
}

/// The figures in the documentation of `Integrator`: MuJoCo's box, 5 s at 100 steps a second, here
/// with three digits. In single precision rounding adds up to `8 EPSILON sqrt(500)`, 2e-5, in which
/// the drift of the fourth-order method is lost.
#[test]
fn energy_drifts_as_documented() {
    let body = FreeBody::mujoco_box();
    let euler = energy_drift(&body, Integrator::SemiImplicitEuler, 0.01, 500);
    let runge_kutta = energy_drift(&body, Integrator::RungeKutta4, 0.01, 500);
    println!("semi-implicit-euler {euler:.4e}, runge-kutta4 {runge_kutta:.4e}");
    assert!((euler - 8.34e-2).abs() <= 5e-5 + 2e-5, "{euler:e}");
    let allowed = by_precision(2e-5, 5e-12);
    assert!((runge_kutta - -1.04e-9).abs() <= allowed, "{runge_kutta:e}");
}

/// Growth to first order in the step: halving it halves the energy gained, up to the next term, a
/// few per cent at these steps.
#[test]
fn energy_grows_in_proportion_to_the_step_under_semi_implicit_euler() {
    let body = FreeBody::mujoco_box();
    let gain = |steps: u32| energy_drift(&body, Integrator::SemiImplicitEuler, 5.0 / steps as Real, steps);
    let (coarse, fine) = (gain(1000), gain(2000));
    assert!(fine > 0.0 && (coarse / fine - 2.0).abs() <= 0.1, "{coarse:e}, {fine:e}");
}

/// Besides an oscillation with the fourth power of the step there is a loss with the fifth, which
/// outgrows it: 100 s of the top that flips. In single precision rounding adds a tenth to the
/// smaller loss.
#[test]
fn runge_kutta4_loses_energy_with_the_fifth_power_of_the_step() {
    let body = FreeBody::van_zon_top();
    let loss = |rate: u32| -energy_drift(&body, Integrator::RungeKutta4, 1.0 / rate as Real, 100 * rate);
    let order = (loss(64) / loss(128)).log2();
    assert!((order - 5.0).abs() <= by_precision(0.2, 0.1), "order {order}");
}

/// The body's angular velocity in its own frame, which is principal.
fn spin(world: &World, entity: Entity) -> DVec3 {
    let mut query = world.query_one::<(&Pose, &Velocity)>(entity);
    let (pose, velocity) = query.get().unwrap();
    dquat(pose.orientation).conjugate() * dvec3(velocity.angular)
}

/// A body with moments 1, 2, 3 kg m^2.
fn unequal(angular_velocity: Vec3) -> RigidBody {
    let inertia = InertiaTensor::from_principal([1.0, 2.0, 3.0], DQuat::IDENTITY).unwrap();
    RigidBody::new(Shape::Point).mass(1.0).inertia(inertia).angular_velocity(angular_velocity)
}

/// About the largest moment the conserved `2 T I3 - L^2 = I1 (I3 - I1) w1^2 + I2 (I3 - I2) w2^2`
/// bounds the other two components for ever, and `L^2 - 2 T I1` does about the smallest. Rounding
/// moves these differences of squares by `EPSILON sqrt(steps)` times `L^2`, which is 5600 times the
/// difference here: 5 % in single precision, nothing in double.
#[test]
fn a_body_spins_on_about_its_largest_and_its_smallest_axis() {
    let slack = by_precision(1.05, 1.0 + 1e-9);
    for integrator in [Integrator::RungeKutta4, Integrator::MoserVeselov] {
        let mut world = World::new();
        let (about_largest, about_smallest) = (Vec3::new(0.1, 0.1, 5.0), Vec3::new(5.0, 0.1, 0.1));
        let largest = unequal(about_largest).build().unwrap().spawn(&mut world);
        let smallest = unequal(about_smallest).build().unwrap().spawn(&mut world);
        let mut simulation = weightless(integrator, 1.0 / 256.0);
        let (c_largest, c_smallest) = (2.0 * 0.1 * 0.1 + 2.0 * 0.1 * 0.1, 2.0 * 0.1 * 0.1 + 6.0 * 0.1 * 0.1);
        for _ in 0..5000 {
            simulation.step(&mut world);
            let w = spin(&world, largest);
            assert!(2.0 * w.x * w.x <= c_largest * slack && 2.0 * w.y * w.y <= c_largest * slack, "{integrator}: {w}");
            let w = spin(&world, smallest);
            assert!(
                2.0 * w.y * w.y <= c_smallest * slack && 6.0 * w.z * w.z <= c_smallest * slack,
                "{integrator}: {w}"
            );
        }
    }
}

/// The same nudge about the middle axis turns the body over: its spin about that axis changes sign,
/// at nearly full speed. 20 s are a few flips.
#[test]
fn a_body_flips_about_its_middle_axis() {
    for integrator in [Integrator::RungeKutta4, Integrator::MoserVeselov] {
        let mut world = World::new();
        let body = unequal(Vec3::new(0.1, 5.0, 0.1)).build().unwrap().spawn(&mut world);
        let mut simulation = weightless(integrator, 1.0 / 256.0);
        let mut least = f64::INFINITY;
        for _ in 0..20 * 256 {
            simulation.step(&mut world);
            least = least.min(spin(&world, body).y);
        }
        // At the turn the other two components are as small as at the start, so |w_2| is what it
        // was, to their squares.
        assert!((least + 5.0).abs() <= 0.01, "{integrator}: {least}");
    }
}

/// The times between sign changes of the middle component are half the period of the elliptic
/// functions.
///
/// A straight line between two steps misses the time of a zero by less than `lambda^2 dt^3`, since
/// the component has no curvature there. Rounding shifts it as `convergence.rs` derives.
#[test]
fn flips_come_when_the_exact_solution_says() {
    let dt: Real = 1.0 / 512.0;
    for (body, middle, seconds) in [(FreeBody::van_zon_top(), 1, 10), (FreeBody::t_handle(), 0, 20)] {
        let elliptic = body.elliptic.unwrap();
        let (mut world, mut simulation) = (World::new(), weightless(Integrator::MoserVeselov, dt));
        let entity = body.spawn(&mut world);
        let mut times = Vec::new();
        let mut before = spin(&world, entity)[middle];
        for step in 0..seconds * 512 {
            simulation.step(&mut world);
            let now = spin(&world, entity)[middle];
            if before * now < 0.0 {
                times.push((f64::from(step) + before / (before - now)) * f64::from(dt));
            }
            before = now;
        }
        let mut moments = body.moments.to_array();
        moments.sort_by(f64::total_cmp);
        let [i1, i2, i3] = moments;
        let steps = f64::from(seconds * 512);
        let parameter = 0.25 * EPSILON * steps.sqrt() * (i3 / (i3 - i2) + i1 / (i2 - i1));
        let allowed = parameter / ((1.0 - elliptic.parameter) * elliptic.frequency)
            + 2.0 * elliptic.frequency.powi(2) * f64::from(dt).powi(3);
        let worst = times.windows(2).map(|t| (t[1] - t[0] - elliptic.flip_interval).abs()).fold(0.0, f64::max);
        println!("{}: {} flips, intervals within {worst:.1e} s, allowed {allowed:.1e} s", body.name, times.len());
        // The first may come at any time within an interval.
        assert!((times.len() as f64 - f64::from(seconds) / elliptic.flip_interval).abs() < 1.0, "{}", body.name);
        assert!(worst <= allowed, "{}: {worst:e} > {allowed:e}", body.name);
    }
}

/// The same body, described in a frame that is not principal, moves the same. Each of the two runs
/// rounds its orientation about twice a step, by `EPSILON/2` each time.
#[test]
fn the_choice_of_body_frame_does_not_matter() {
    let reference = FreeBody::mujoco_box();
    let frame = Quat::from_xyzw(0.5, -0.1, 0.7, 0.5).normalize();
    // In the other frame the principal axes are turned back by it; the frame itself starts turned.
    let inertia = InertiaTensor::from_principal(reference.moments, dquat(frame).conjugate()).unwrap();
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let principal = reference.spawn(&mut world);
        let turned = reference.rigid_body().inertia(inertia).orientation(frame).build().unwrap().spawn(&mut world);
        assert!(world.get::<&PrincipalAxes>(turned).is_ok());
        run(&mut weightless(integrator, 0.01), &mut world, 500);
        let orientation = |entity| dquat(world.get::<&Pose>(entity).unwrap().orientation);
        let difference = attitude_error(orientation(principal), orientation(turned) * dquat(frame).conjugate());
        println!("{integrator}: {difference:.1e} rad");
        assert!(difference <= 2.0 * EPSILON * 500.0, "{integrator}: {difference:e} rad");
        let energies = (energy_of(&world, principal), energy_of(&world, turned));
        assert!((energies.0 / energies.1 - 1.0).abs() <= 2.0 * EPSILON * 500.0, "{integrator}: {energies:?}");
    }
}

/// `Totals::of` adds up what single bodies have: a pair thrown apart has no momentum, and the
/// angular momentum of its orbit and spins.
#[test]
fn totals_are_the_sums_over_bodies() {
    let mut world = World::new();
    let throw = |x: Real, v: Real| unequal(Vec3::Z).position(Vec3::X * x).linear_velocity(Vec3::Y * v).build().unwrap();
    throw(2.0, 3.0).spawn(&mut world);
    throw(-2.0, -3.0).spawn(&mut world);
    let settings = Settings::default().with_gravity(Vec3::X * -2.0);
    let totals = Totals::of(&world, &settings, &BodyOrder::of(&world));
    // All numbers are whole: exact.
    assert_eq!(totals.linear_momentum, DVec3::ZERO);
    assert_eq!(totals.angular_momentum, DVec3::Z * (2.0 * 6.0 + 2.0 * 3.0));
    assert_eq!((totals.linear_kinetic, totals.rotational_kinetic, totals.potential), (9.0, 3.0, 0.0));
    assert_eq!(totals.energy(), 12.0);
    assert_eq!(totals.non_finite, None);
}
