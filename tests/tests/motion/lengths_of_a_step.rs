//! Promise: whatever the body and however long the step, nothing becomes NaN, orientations stay of
//! unit length, momentum is kept, and `MoserVeselov` keeps the energy to rounding up to 27 rad a
//! step, more than four turns, and within its bounds beyond.
//!
//! Why: a game throws anything at a step: a needle that spins at 10 000 rad/s, a frame that took a
//! second. It fails if Newton's method diverges, the number of parts overflows, a coefficient
//! cancels for extreme moments, or a length underflows.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use proptest::prelude::*;
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    Damping, Inertia, InertiaTensor, Integrator, Momentum, Pose, PrincipalAxes, RigidBody, Settings, Shape, Simulation,
    Wrench,
};
use tumble_tests::references::{real_quat, real_vec3};
use tumble_tests::{EPSILON, dvec3, energy_of, weightless};

/// One of 10^low .. 10^high, all magnitudes alike.
fn magnitude(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high).prop_map(|exponent| 10.0_f64.powf(exponent))
}

fn unit_vector() -> impl Strategy<Value = DVec3> {
    let component = -1.0..1.0_f64;
    (component.clone(), component.clone(), component)
        .prop_map(|(x, y, z)| DVec3::new(x, y, z))
        .prop_filter("too short to have a direction", |v| v.length() > 0.01)
        .prop_map(DVec3::normalize)
}

fn orientation() -> impl Strategy<Value = DQuat> {
    (unit_vector(), -3.2..3.2_f64).prop_map(|(axis, angle)| DQuat::from_axis_angle(axis, angle))
}

/// Moments of a body with any three second moments of mass up to 10^6 apart, one of which may be
/// zero: flat bodies, needles, balls.
fn moments() -> impl Strategy<Value = DVec3> {
    let second = || prop_oneof![8 => magnitude(-6.0, 0.0), 1 => Just(1.0)];
    (second(), second(), prop_oneof![9 => second(), 1 => Just(0.0)], 0..3_usize).prop_map(|(a, b, c, turn)| {
        let mut t = [a, b, c];
        t.rotate_left(turn);
        DVec3::new(t[1] + t[2], t[2] + t[0], t[0] + t[1])
    })
}

#[derive(Clone, Debug)]
struct Case {
    moments: DVec3,
    axes: Option<DQuat>,
    orientation: DQuat,
    /// Direction of the spin in the principal frame.
    direction: DVec3,
    /// `|w| dt` \[rad\].
    turn: f64,
    dt: f64,
    integrator: Integrator,
}

fn case() -> impl Strategy<Value = Case> {
    let axes = proptest::option::of(orientation());
    // A spin exactly about a principal axis as often as any other; turns from 1e-9 to 1000 rad a
    // step.
    let direction = prop_oneof![4 => unit_vector(), 1 => proptest::sample::select(DVec3::AXES.to_vec())];
    let integrator = proptest::sample::select(Integrator::ALL.to_vec());
    (moments(), axes, orientation(), direction, magnitude(-9.0, 3.0), magnitude(-4.0, 0.0), integrator).prop_map(
        |(moments, axes, orientation, direction, turn, dt, integrator)| Case {
            moments,
            axes,
            orientation,
            direction,
            turn,
            dt,
            integrator,
        },
    )
}

impl Case {
    fn spawn(&self, world: &mut World, damping: Option<Damping>) -> Entity {
        let axes = self.axes.unwrap_or(DQuat::IDENTITY);
        let inertia = InertiaTensor::from_principal(self.moments, axes).unwrap();
        let spin = self.orientation * axes * self.direction * (self.turn / self.dt);
        let mut body = RigidBody::new(Shape::Point)
            .mass(1.0)
            .inertia(inertia)
            .orientation(real_quat(self.orientation))
            .linear_velocity(Vec3::X)
            .angular_velocity(real_vec3(spin));
        if let Some(damping) = damping {
            body = body.damping(damping);
        }
        body.build().unwrap().spawn(world)
    }

    fn simulation(&self) -> Simulation {
        weightless(self.integrator, self.dt as Real)
    }
}

/// The map's limit is on `kappa`, at most a third of the squared turn (`(|w| dt)^2/4` for a ball, a
/// third for a flat needle that turns in its plane): within `LARGEST_KAPPA MAX_PARTS^2` up to a
/// turn of 27 rad for every body, and up to this one where moments a million times apart, rounded
/// to single precision, move `kappa` by a tenth.
const LONGEST_MAPPED: f64 = 25.0;

fn length(q: Quat) -> f64 {
    let [x, y, z, w] = q.to_array().map(f64::from);
    (x * x + y * y + z * z + w * w).sqrt()
}

/// `|w|` [rad/s] from the state, in double precision: the largest rate at which the body's momentum
/// makes it turn now.
fn angular_speed(world: &World, entity: Entity) -> f64 {
    let mut query = world.query_one::<(&Pose, &Momentum, &Inertia, Option<&PrincipalAxes>)>(entity);
    let (pose, momentum, inertia, axes) = query.get().unwrap();
    let frame = tumble_tests::dquat(pose.orientation) * axes.map_or(DQuat::IDENTITY, |a| tumble_tests::dquat(a.0));
    (frame.conjugate() * dvec3(momentum.angular) / dvec3(inertia.moments())).length()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100_000, failure_persistence: None, max_global_rejects: 100_000, ..ProptestConfig::default() })]

    /// Three steps of a free body.
    #[test]
    fn a_free_body(case in case()) {
        let mut world = World::new();
        let entity = case.spawn(&mut world, None);
        let before = *world.get::<&Momentum>(entity).unwrap();
        let start = energy_of(&world, entity);
        let mut simulation = case.simulation();
        for _ in 0..3 {
            // The rate at which a rounding of the orientation changes the energy, |w x L| times its
            // angle.
            let sensitivity = angular_speed(&world, entity) * dvec3(before.angular).length();
            let energy = energy_of(&world, entity);
            simulation.step(&mut world);
            let pose = *world.get::<&Pose>(entity).unwrap();
            prop_assert!(pose.position.is_finite());
            prop_assert!((length(pose.orientation) - 1.0).abs() <= 2.0 * EPSILON, "|q| = {}", length(pose.orientation));
            prop_assert_eq!(*world.get::<&Momentum>(entity).unwrap(), before);
            let after = energy_of(&world, entity);
            if case.integrator == Integrator::MoserVeselov && case.turn <= LONGEST_MAPPED {
                // Of up to 64 parts each rounds the orientation several times.
                let parts = 1.0 + 2.0 * case.turn;
                let allowed = 8.0 * EPSILON * parts * sensitivity;
                prop_assert!((after - energy).abs() <= allowed, "{energy:e} J to {after:e} J, allowed {allowed:e}");
            }
        }
        let momentum = dvec3(before.angular);
        let range = momentum.length_squared() / 2.0 / dvec3(world.get::<&Inertia>(entity).unwrap().moments());
        let end = energy_of(&world, entity);
        // Turning the momentum into the principal frame and summing up takes a dozen roundings in
        // double precision.
        let slack = 16.0 * f64::EPSILON;
        prop_assert!(end >= range.min_element() * (1.0 - slack) && end <= range.max_element() * (1.0 + slack), "{end:e} J");
        prop_assert!(start > 0.0 || case.turn < 1e-6);
    }

    /// Pushed, twisted and damped at any rate as well: only finiteness and unit length can be
    /// promised.
    #[test]
    fn a_driven_body(
        case in case(),
        damping in (magnitude(-6.0, 12.0), magnitude(-6.0, 12.0)),
        force in (unit_vector(), magnitude(-6.0, 6.0)),
    ) {
        let mut world = World::new();
        let damping = Damping { linear: damping.0 as Real, angular: damping.1 as Real };
        let entity = case.spawn(&mut world, Some(damping));
        let mut simulation = case.simulation();
        for _ in 0..3 {
            let push = real_vec3(force.0 * force.1);
            *world.get::<&mut Wrench>(entity).unwrap() = Wrench { force: push, torque: -push };
            simulation.step(&mut world);
            let (pose, momentum) = (*world.get::<&Pose>(entity).unwrap(), *world.get::<&Momentum>(entity).unwrap());
            prop_assert!(pose.position.is_finite() && momentum.linear.is_finite() && momentum.angular.is_finite());
            prop_assert!((length(pose.orientation) - 1.0).abs() <= 2.0 * EPSILON, "|q| = {}", length(pose.orientation));
        }
    }
}

/// The corners of what the precision of the build can hold, where squares overflow and underflow:
/// `MoserVeselov` leaves a rotation that no number can hold out, and stays on its feet.
#[test]
fn extreme_bodies_stay_finite() {
    let (tiny, huge) = if tumble_tests::DOUBLE { (1e-290, 1e290) } else { (1e-30, 1e30) };
    for moment in [tiny, 1.0, huge] {
        for momentum in [0.0, tiny, 1.0, huge] {
            for dt in [1e-8, 1.0, 1e9] {
                let mut world = World::new();
                let moments = DVec3::new(moment, moment * 1.5, moment * 2.0);
                let inertia = InertiaTensor::from_principal(moments, DQuat::IDENTITY).unwrap();
                let entity = RigidBody::new(Shape::Point).mass(1.0).inertia(inertia).build().unwrap().spawn(&mut world);
                let angular = Vec3::new(1.0, 2.0, 3.0) * momentum as Real;
                world.get::<&mut Momentum>(entity).unwrap().angular = angular;
                let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(dt);
                Simulation::new(settings).unwrap().step(&mut world);
                let q = world.get::<&Pose>(entity).unwrap().orientation;
                let label = format!("moment {moment:e}, momentum {momentum:e}, dt {dt:e}: {q}");
                assert!((length(q) - 1.0).abs() <= 2.0 * EPSILON, "{label}");
                assert_eq!(world.get::<&Momentum>(entity).unwrap().angular, angular, "{label}");
            }
        }
    }
}

/// The most unequal moments that the precision admits, a wire's, are ordinary input: nothing
/// becomes NaN. A wire that is thinner is refused by name, since its angular momentum could not
/// hold its spin.
#[test]
fn the_thinnest_wire() {
    for integrator in Integrator::ALL {
        for excess in [1.5, 3.0, 10.0, 1e3] {
            let thin = excess * EPSILON;
            let moments = DVec3::new(1.0, 1.0, thin);
            let inertia = InertiaTensor::from_principal(moments, glam::DQuat::IDENTITY).unwrap();
            let mut world = World::new();
            let body =
                RigidBody::new(Shape::Point).mass(1.0).inertia(inertia).angular_velocity(Vec3::new(1.0, 2.0, 3.0));
            let entity = body.build().unwrap().spawn(&mut world);
            let mut simulation = Simulation::new(Settings::default().with_integrator(integrator)).unwrap();
            for _ in 0..2000 {
                simulation.step(&mut world);
            }
            let pose = *world.get::<&Pose>(entity).unwrap();
            assert!(pose.position.is_finite() && (length(pose.orientation) - 1.0).abs() <= 2.0 * EPSILON);
        }
    }
    let wire = InertiaTensor::from_principal(DVec3::new(1.0, 1.0, 0.5 * EPSILON), glam::DQuat::IDENTITY).unwrap();
    let error = RigidBody::new(Shape::Point).mass(1.0).inertia(wire).build().unwrap_err();
    assert_eq!(error.field(), "inertia");
    assert!(error.to_string().contains("too unequal"), "{error}");
}

/// An orientation that a caller has set to any length, zero too, is a rotation after a step of a
/// body that turns.
#[test]
fn an_orientation_of_any_length_is_made_a_rotation() {
    for integrator in Integrator::ALL {
        for scale in [1e-3, 0.5, 1.8, 2.3, 3.0, 1e3] {
            let mut world = World::new();
            let body = RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3]))
                .without_collider()
                .mass(1.0)
                .angular_velocity(Vec3::new(1.0, 2.0, 3.0));
            let entity = body.build().unwrap().spawn(&mut world);
            let set = world.get::<&Pose>(entity).unwrap().orientation * scale;
            world.get::<&mut Pose>(entity).unwrap().orientation = set;
            let mut simulation = Simulation::new(Settings::default().with_integrator(integrator)).unwrap();
            for _ in 0..200 {
                simulation.step(&mut world);
            }
            let found = length(world.get::<&Pose>(entity).unwrap().orientation);
            assert!((found - 1.0).abs() <= 2.0 * EPSILON, "{integrator}, from {scale}: {found}");
        }
    }
}
