//! One body under a force component: the body, its state after some steps, and how near to a closed
//! form it has to be.

use glam::{DQuat, DVec3};
use hecs::{DynamicBundle, Entity, World};
use tumble::Integrator::{self, MoserVeselov, SemiImplicitEuler};
use tumble::math::{Real, Vec3};
use tumble::{Pose, RigidBody, Shape, Velocity};
use tumble_tests::{EPSILON, dvec3, run, seconds, weightless};

/// A power of two, so that all that is multiplied with it keeps its bits.
pub(crate) const DT: Real = 1.0 / 128.0;

/// What a method of order p may be off by, relative to what moves at this rate [1/s]: in each step
/// the term of the Taylor series after the last that it has, `(rate dt)^(p+1)/(p+1)!`, and a
/// rounding of the state; compounded, as what a step adds grows with what is there.
pub(crate) fn allowed(integrator: Integrator, rate: f64, steps: u32) -> f64 {
    let (power, factorial) = match integrator {
        SemiImplicitEuler => (2, 2.0),
        MoserVeselov => (3, 6.0),
        _ => (5, 120.0),
    };
    (f64::from(steps) * ((rate * seconds(DT)).powi(power) / factorial + EPSILON)).exp_m1()
}

/// Asserts that a vector is as near to its closed form as [`allowed`], relative to a scale.
pub(crate) fn assert_near(
    what: &str,
    integrator: Integrator,
    found: Vec3,
    exact: DVec3,
    scale: f64,
    rate: f64,
    steps: u32,
) {
    let error = (dvec3(found) - exact).length();
    let bound = scale * allowed(integrator, rate, steps);
    println!("{what}, {integrator}: {found} for {exact}, off by {error:.1e} of {bound:.1e}");
    assert!(error <= bound, "{what}, {integrator}: {found} for {exact}, off by {error:e}, allowed {bound:e}");
}

pub(crate) const MOMENTS: DVec3 = DVec3::new(0.4, 0.5, 0.6);

pub(crate) const MASS: f64 = 2.0;

/// Two kilograms; principal moments [`MOMENTS`].
pub(crate) fn body() -> RigidBody {
    let inertia = tumble::InertiaTensor::from_principal(MOMENTS, DQuat::IDENTITY).unwrap();
    RigidBody::new(Shape::Point).mass(MASS).inertia(inertia)
}

/// A world of one body with components, and the body.
pub(crate) fn world_of(body: RigidBody, components: impl DynamicBundle) -> (World, Entity) {
    let mut world = World::new();
    let entity = body.build().unwrap().spawn(&mut world);
    world.insert(entity, components).unwrap();
    (world, entity)
}

/// Where a body is, and its velocities.
pub(crate) fn state(world: &World, body: Entity) -> (Pose, Velocity) {
    (*world.get::<&Pose>(body).unwrap(), *world.get::<&Velocity>(body).unwrap())
}

/// The state of one body after this many steps without gravity.
pub(crate) fn after(
    steps: u32,
    integrator: Integrator,
    body: RigidBody,
    components: impl DynamicBundle,
) -> (Pose, Velocity) {
    let (mut world, entity) = world_of(body, components);
    run(&mut weightless(integrator, DT), &mut world, steps);
    state(&world, entity)
}
