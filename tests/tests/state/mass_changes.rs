//! Promise: a body in a world can be given another mass, centre and inertia; its frame, its linear
//! momentum and its angular momentum about any point stay. What impulses and such changes between
//! steps do to the kinetic energy has an entry in the ledger, so that the books sum up. A tensor
//! that was accepted with a tolerance makes a body.
//!
//! Why: an engine whose books leave a remainder without a name has books that no one can check. It
//! fails if the centre moves without its momentum, if the frame jumps, or if the remainder is lost.

use glam::{DMat3, DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{
    CenterOfMass, ChangeMassError, Inertia, InertiaTensor, Integrator, InverseInertia, Ledger, MassProperties,
    Momentum, Pose, PreviousPose, PrincipalAxes, RigidBody, Rng, Shape, Velocity, change_mass_properties,
};
use tumble_tests::{EPSILON, dvec3, weightless};

fn properties(rng: &mut Rng) -> MassProperties {
    let moments = DVec3::new(rng.range(1.0, 2.0).into(), rng.range(1.0, 2.0).into(), 1.9);
    let q = rng.orientation();
    let axes = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into()).normalize();
    let tensor = InertiaTensor::from_principal(moments, axes).unwrap();
    MassProperties::new(rng.range(0.5, 8.0).into(), dvec3(rng.vector(-0.5, 0.5)), tensor).unwrap()
}

/// Linear momentum, angular momentum about the world's origin, and where the frame's origin is.
fn kept(world: &World, body: Entity) -> [DVec3; 3] {
    let (pose, momentum) = (*world.get::<&Pose>(body).unwrap(), *world.get::<&Momentum>(body).unwrap());
    let center = world.get::<&CenterOfMass>(body).map(|center| *center).ok();
    let angular = dvec3(pose.position).cross(dvec3(momentum.linear)) + dvec3(momentum.angular);
    [dvec3(momentum.linear), angular, dvec3(pose.origin(center.as_ref()))]
}

/// Two hundred changes in a row, with what a step would have derived.
#[test]
fn momentum_and_frame_are_kept() {
    let mut rng = Rng::new(11);
    let mut world = World::new();
    let body =
        RigidBody::new(Shape::cuboid([0.3, 0.4, 0.5])).without_collider().mass(2.0).position(Vec3::new(1.0, -2.0, 0.5));
    let body = body.linear_velocity(Vec3::new(1.0, 2.0, -1.0)).angular_velocity(Vec3::new(0.5, 3.0, -1.0));
    let body = body.interpolated().build().unwrap().spawn(&mut world);
    let mut simulation = weightless(Integrator::MoserVeselov, 1.0 / 64.0);
    for change in 0..200 {
        let before = kept(&world, body);
        let new = properties(&mut rng);
        change_mass_properties(&mut world, body, &new).unwrap();
        for (before, after) in before.into_iter().zip(kept(&world, body)) {
            // Positions and momenta of some units, and a handful of roundings.
            assert!(
                (after - before).length() <= 64.0 * EPSILON * (1.0 + before.length()),
                "{change}: {before} {after}"
            );
        }
        let (pose, previous) = (*world.get::<&Pose>(body).unwrap(), *world.get::<&PreviousPose>(body).unwrap());
        let momentum = *world.get::<&Momentum>(body).unwrap();
        let (velocity, inverse) =
            (*world.get::<&Velocity>(body).unwrap(), *world.get::<&InverseInertia>(body).unwrap());
        assert!((dvec3(velocity.linear) * new.mass() - dvec3(momentum.linear)).length() <= 64.0 * EPSILON);
        let spin = dvec3(inverse * momentum.angular) - dvec3(velocity.angular);
        assert!(spin.length() <= 64.0 * EPSILON * dvec3(momentum.angular).length(), "{change}");
        let expected = new.inertia().unwrap().principal();
        let moments = dvec3(world.get::<&Inertia>(body).unwrap().moments());
        assert!((moments - expected.moments).length() <= 4.0 * EPSILON);
        assert!(world.get::<&PrincipalAxes>(body).is_ok());
        assert!((dvec3(pose.position) - dvec3(previous.0.position)).length() <= 0.5, "{change}: the frame jumped");
        simulation.step(&mut world);
    }
}

#[test]
fn what_cannot_be_changed_stays() {
    let mut world = World::new();
    let body = RigidBody::new(Shape::sphere(1.0)).without_collider().mass(1.0).build().unwrap().spawn(&mut world);
    let wall = RigidBody::new(Shape::sphere(1.0)).without_collider().fixed().build().unwrap().spawn(&mut world);
    let ball = Shape::sphere(1.0).mass_properties(tumble::Amount::Mass(1.0)).unwrap();
    assert_eq!(change_mass_properties(&mut world, wall, &ball), Err(ChangeMassError::NotMoving(wall)));
    let before = kept(&world, body);
    let far = ball.centered_at([1e80, 0.0, 0.0]).unwrap();
    if Real::MAX as f64 <= 1e80 {
        assert!(matches!(change_mass_properties(&mut world, body, &far), Err(ChangeMassError::Center(_))));
    }
    assert_eq!(kept(&world, body), before);
    // A point holds no spin, and is a body all the same.
    change_mass_properties(&mut world, body, &MassProperties::point(3.0, [0.0; 3]).unwrap()).unwrap();
    assert!(world.get::<&Inertia>(body).is_err());
    world.despawn(body).unwrap();
    assert_eq!(change_mass_properties(&mut world, body, &ball), Err(ChangeMassError::NotMoving(body)));
}

/// An impulse of 6 N s on 2 kg at 1 m/s: from 1 J to 16 J; a skater who halves the moment of
/// inertia doubles the energy of the spin.
#[test]
fn the_books_have_what_happens_between_steps() {
    let mut world = World::new();
    let ball = RigidBody::new(Shape::sphere(0.5))
        .without_collider()
        .mass(2.0)
        .linear_velocity(Vec3::X)
        .angular_velocity(Vec3::Y * 2.0);
    let ball = ball.build().unwrap().spawn(&mut world);
    let mut simulation = weightless(Integrator::MoserVeselov, 1.0 / 64.0);
    let mut ledger = Ledger::attach(&mut world, &simulation);
    simulation.step_many(&mut world, 5);
    assert!(ledger.record(&world, &simulation).between_steps.abs() <= 64.0 * EPSILON);
    world.get::<&mut Momentum>(ball).unwrap().apply_impulse(Vec3::X * 6.0);
    simulation.step_many(&mut world, 5);
    let entry = ledger.record(&world, &simulation);
    assert!((entry.between_steps - 15.0).abs() <= 256.0 * EPSILON, "{}", entry.between_steps);
    let halved = dvec3(world.get::<&Inertia>(ball).unwrap().moments()) * 0.5;
    let tensor = InertiaTensor::from_principal(halved, DQuat::IDENTITY).unwrap();
    let properties = MassProperties::new(2.0, [0.0; 3], tensor).unwrap();
    change_mass_properties(&mut world, ball, &properties).unwrap();
    let entry = ledger.record(&world, &simulation);
    // 2/5 M r^2 w^2/2.
    let spin = 0.5 * 0.2 * 4.0;
    assert!((entry.between_steps - 15.0 - spin).abs() <= 256.0 * EPSILON, "{}", entry.between_steps);
    assert_eq!(Ledger::watch(&world, &simulation).record(&world, &simulation).between_steps, 0.0);
}

/// Moments that were published with three digits, of any flat body: what was accepted makes a body,
/// whose moments are possible and within the tolerance.
#[test]
fn what_is_accepted_with_a_tolerance_makes_a_body() {
    let mut rng = Rng::new(5);
    for case in 0..500 {
        let (x, y) = (f64::from(rng.range(0.1, 1.0)), f64::from(rng.range(0.1, 1.0)));
        let excess = f64::from(rng.range(0.0, 2.9e-3));
        let z = (x + y) / (1.0 - excess);
        let turn = rng.orientation();
        let r = DMat3::from_quat(tumble_tests::dquat(turn).normalize());
        let matrix = r * DMat3::from_diagonal(DVec3::new(x, y, z)) * r.transpose();
        let tensor = InertiaTensor::within_tolerance(matrix, 3e-3).unwrap();
        assert!(tensor.matrix().abs_diff_eq(matrix, 1e-15), "it is kept as it was given");
        let possible = tensor.nearest_possible().principal().moments;
        let over = 2.0 * possible.max_element() - possible.element_sum();
        assert!(over <= 1.1e-6 * z, "{case}: {over:e}");
        let mut given = [x, y, z];
        let mut found = possible.to_array();
        given.sort_by(f64::total_cmp);
        found.sort_by(f64::total_cmp);
        for (given, found) in given.into_iter().zip(found) {
            assert!((given - found).abs() <= 1.01e-3 * z, "{case}: {given} {found}");
        }
        RigidBody::new(Shape::sphere(1.0)).without_collider().mass(1.0).inertia(tensor).build().unwrap();
        assert!(MassProperties::new(1.0, [0.0; 3], tensor).unwrap().inertia().is_ok());
        Inertia::within_tolerance([x, y, z], 3e-3).unwrap();
        assert!(excess < 2e-6 || Inertia::new([x, y, z]).is_err());
    }
}
