//! Promise: bodies that are welded become the one body that they make together, with the linear and
//! angular momentum they had and never more energy; in the engine, to the rounding of the build.
//! What cannot be welded is named.
//!
//! It fails if an arm, a frame or a spin is left out of the angular momentum, or if the composite
//! is not that of the parts.

use crate::reference::{Check, list, matrix};
use glam::{DMat3, DQuat, DVec3};
use hecs::{Entity, World};
use proptest::prelude::*;
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    BodyId, CenterOfMass, Damping, GravityScale, Momentum, Pose, RigidBody, Velocity, WeldError, Wrench, weld,
};
use tumble_math::{Amount, InertiaTensor, MassProperties, MovingBody, Part, Shape, quat_from_matrix};
use tumble_tests::references::{number, parse, vector};
use tumble_tests::{EPSILON, dquat, dvec3, largest, run, weightless};

fn kinetic_energy(p: &MassProperties, v: DVec3, w: DVec3) -> f64 {
    0.5 * (p.mass() * v.length_squared() + w.dot(p.tensor_about_center() * w))
}

fn vector_within(reach: f64) -> impl Strategy<Value = DVec3> {
    let coordinate = move || -reach..reach;
    (coordinate(), coordinate(), coordinate()).prop_map(DVec3::from)
}

fn moving_body() -> impl Strategy<Value = MovingBody> {
    let shape = prop_oneof![
        1 => Just(Shape::Point),
        4 => prop::array::uniform3(0.1..2.0_f64).prop_map(Shape::cuboid),
        2 => (0.1..1.0_f64, 0.1..1.0_f64).prop_map(|(radius, half_height)| Shape::cone(radius, half_height)),
    ];
    let turn = (vector_within(1.0), 0.0..6.0_f64)
        .prop_map(|(axis, angle)| DQuat::from_axis_angle(axis.try_normalize().unwrap_or(DVec3::X), angle));
    (shape, 0.1..10.0_f64, vector_within(5.0), turn, vector_within(5.0), vector_within(5.0)).prop_map(
        |(shape, mass, position, orientation, linear_velocity, angular_velocity)| {
            let properties = shape.mass_properties(Amount::Mass(mass)).unwrap();
            MovingBody { properties, position, orientation, linear_velocity, angular_velocity }
        },
    )
}

proptest! {
    #[test]
    fn momentum_is_kept_and_energy_only_lost(bodies in prop::collection::vec(moving_body(), 1..8)) {
        let welded = tumble_math::weld(bodies.iter().copied()).unwrap();
        // All about the origin of the world, from the definitions.
        let (mut linear, mut angular, mut energy, mut terms) = (DVec3::ZERO, DVec3::ZERO, 0.0, 0.0);
        let mut sum: Option<MassProperties> = None;
        for body in &bodies {
            let p = body.properties.transformed(body.position, body.orientation).unwrap();
            let spin = p.tensor_about_center() * body.angular_velocity;
            let orbital = p.center_of_mass().cross(body.linear_velocity * p.mass());
            linear += body.linear_velocity * p.mass();
            angular += spin + orbital;
            energy += kinetic_energy(&p, body.linear_velocity, body.angular_velocity);
            terms += spin.length() + p.center_of_mass().length() * body.linear_velocity.length() * p.mass();
            sum = Some(sum.map_or(p, |sum| sum + p));
        }
        prop_assert_eq!(welded.properties, sum.unwrap());
        prop_assert!((welded.linear_momentum - linear).length() <= 1e-14 * linear.length().max(1.0));
        let center = welded.properties.center_of_mass();
        let about_origin = welded.angular_momentum + center.cross(welded.linear_momentum);
        prop_assert!((about_origin - angular).length() <= 1e-14 * terms);
        // L = I W wherever there is a moment; a row of points, and a point that turns about itself,
        // have none.
        let spin = welded.properties.tensor_about_center() * welded.angular_velocity;
        let turning = welded.angular_velocity.length() * largest(welded.properties.tensor_about_center());
        prop_assert!((spin - welded.angular_momentum).length() <= 1e-14 * (terms + turning));
        let after = kinetic_energy(&welded.properties, welded.linear_velocity, welded.angular_velocity);
        prop_assert!(welded.energy_lost >= 0.0);
        // About an axis with a small moment a rounding of L is a large one of W, and of the energy
        // computed with it here.
        let scale = energy + welded.angular_velocity.length() * (terms + turning);
        prop_assert!((energy - after - welded.energy_lost).abs() <= 1e-14 * scale);
    }

    /// Bodies that move as one already lose nothing, and go on as they do.
    #[test]
    fn one_motion_loses_nothing(
        mut bodies in prop::collection::vec(moving_body(), 2..8),
        v in vector_within(5.0),
        w in vector_within(5.0),
    ) {
        for body in &mut bodies {
            let center = body.position + body.orientation * body.properties.center_of_mass();
            body.linear_velocity = v + w.cross(center);
            body.angular_velocity = w;
        }
        let welded = tumble_math::weld(bodies.iter().copied()).unwrap();
        let center = welded.properties.center_of_mass();
        prop_assert!((welded.linear_velocity - v - w.cross(center)).length() <= 1e-13 * (1.0 + v.length() + 5.0 * w.length()));
        let energy = kinetic_energy(&welded.properties, welded.linear_velocity, welded.angular_velocity);
        prop_assert!(welded.energy_lost <= 1e-13 * energy.max(1.0));
    }

    #[test]
    fn the_engine_keeps_momentum_to_its_rounding(bodies in prop::collection::vec(moving_body(), 1..8)) {
        let mut world = World::new();
        let real = |v: DVec3| Vec3::new(v.x as Real, v.y as Real, v.z as Real);
        // Points make no body that turns, if they are all there are; these have an extent.
        let entities: Vec<Entity> = bodies.iter().zip(0..).map(|(body, i)| {
            let shape = Shape::cone(0.5 + 0.1 * f64::from(i), 0.7);
            let q = body.orientation;
            let body = RigidBody::new(shape).without_collider()
                .mass(body.properties.mass())
                .position(real(body.position))
                .orientation(Quat::from_xyzw(q.x as Real, q.y as Real, q.z as Real, q.w as Real))
                .linear_velocity(real(body.linear_velocity))
                .angular_velocity(real(body.angular_velocity));
            body.build().unwrap().spawn(&mut world)
        }).collect();
        let about_origin = |world: &World, entity: Entity| {
            let (pose, momentum) = (*world.get::<&Pose>(entity).unwrap(), *world.get::<&Momentum>(entity).unwrap());
            let (linear, spin) = (dvec3(momentum.linear), dvec3(momentum.angular));
            (linear, spin + dvec3(pose.position).cross(linear), spin.length() + pose.position.length() as f64 * linear.length())
        };
        let before: Vec<_> = entities.iter().map(|entity| about_origin(&world, *entity)).collect();
        let composite = weld(&world, &entities).unwrap().spawn(&mut world);
        let after = about_origin(&world, composite);
        let sum = before.iter().fold((DVec3::ZERO, DVec3::ZERO, 0.0), |s, b| (s.0 + b.0, s.1 + b.1, s.2 + b.2));
        // Each component of the result is rounded once: half an EPSILON. So is the position, which
        // moves the arm of the momentum. The sums before are good to 1e-14, as in the first test.
        prop_assert!((after.0 - sum.0).length() <= EPSILON * sum.0.length() + 1e-14 * sum.2);
        prop_assert!((after.1 - sum.1).length() <= (EPSILON + 1e-14) * (sum.2 + after.2));
        // The velocity is derived already.
        let velocity = *world.get::<&Velocity>(composite).unwrap();
        let mass = bodies.iter().map(|body| body.properties.mass()).sum::<f64>();
        prop_assert!((dvec3(velocity.linear) * mass - sum.0).length() <= 4.0 * EPSILON * sum.0.length() + 1e-12);
    }
}

/// Ascent and descent stage, each as a body in the frame of the lunar module, docked.
#[test]
fn apollo_lunar_module() {
    let file = parse(include_str!("../../data/inertia_compounds.json"));
    let mut check = Check::new("inertia_compounds, welded", &file);
    let mut exact = Vec::new();
    let (mut world, mut stages) = (World::new(), Vec::new());
    let (place, turn) = (Vec3::new(10.0, -20.0, 5.0), Quat::from_xyzw(0.1, 0.2, -0.3, 0.9).normalize());
    let (drift, spin) = (DVec3::new(1.0, 2.0, -0.5), DVec3::new(0.02, -0.05, 0.03));
    for part in list(&file, "parts") {
        let struct_to_body = quat_from_matrix(matrix(&part["R_part_struct_to_body"])).unwrap();
        let inertia = DMat3::from_diagonal(vector(&part["inertia_diag_in_part_body"]));
        let inertia = InertiaTensor::new(inertia).unwrap().rotated(struct_to_body.conjugate()).unwrap();
        let (mass, center) = (number(&part["mass"]), vector(&part["com_in_part_struct"]));
        // All turning about the origin of the module's frame.
        let velocity = drift + spin.cross(dquat(turn) * center);
        let stage = Shape::compound([Part::new(Shape::Point, Amount::Mass(mass)).at(center)]);
        exact.push(MovingBody {
            properties: MassProperties::new(mass, center, inertia).unwrap(),
            position: DVec3::ZERO,
            orientation: DQuat::IDENTITY,
            linear_velocity: drift + spin.cross(center),
            angular_velocity: spin,
        });
        let real = |v: DVec3| Vec3::new(v.x as Real, v.y as Real, v.z as Real);
        let stage = RigidBody::new(stage)
            .without_collider()
            .inertia(inertia)
            .position(place)
            .orientation(turn)
            .linear_velocity(real(velocity))
            .angular_velocity(real(spin));
        stages.push(stage.build().unwrap().spawn(&mut world));
    }
    let tree = &file["subtrees"][0];
    let tensor = matrix(&tree["computed_inertia"]);
    let welded = tumble_math::weld(exact).unwrap();
    check.error("inertia", largest(welded.properties.tensor_about_center() - tensor) / largest(tensor));
    check.error("spin", (welded.angular_velocity - spin).length() / spin.length());
    check.report();

    let module = weld(&world, &stages).unwrap();
    let properties = *module.properties().unwrap();
    // Masses, moments and positions of the stages are in the precision of the build; positions are
    // rounded at some 20 m.
    let mass = number(&tree["jeod_mass"]);
    assert!((properties.mass() / mass - 1.0).abs() <= 2.0 * EPSILON);
    assert!((properties.center_of_mass() - vector(&tree["computed_com"])).length() <= 40.0 * EPSILON);
    // The reference tensor is given to eight decimals of some 1e4 kg m^2, good to 2e-14 as seen
    // above.
    assert!(largest(properties.tensor_about_center() - tensor) <= (4.0 * EPSILON + 2e-14) * largest(tensor));

    let entity = module.spawn(&mut world);
    let velocity = *world.get::<&Velocity>(entity).unwrap();
    assert!((dvec3(velocity.angular) - spin).length() <= 40.0 * EPSILON * spin.length());
    let pose = *world.get::<&Pose>(entity).unwrap();
    let origin = pose.origin(Some(&*world.get::<&CenterOfMass>(entity).unwrap()));
    assert!((dvec3(origin) - dvec3(place)).length() <= 40.0 * EPSILON);
    for stage in stages {
        world.despawn(stage).unwrap();
    }
    let before = *world.get::<&Momentum>(entity).unwrap();
    run(&mut weightless(tumble::Integrator::MoserVeselov, 0.01), &mut world, 100);
    assert_eq!(*world.get::<&Momentum>(entity).unwrap(), before, "it moves on as one body");
}

#[test]
fn what_the_first_has_stays() {
    let mut world = World::new();
    let body = RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3])).without_collider().mass(1.0);
    let damping = Damping { linear: 0.1, angular: 0.2 };
    let first = body.clone().id(BodyId(7)).gravity_scale(0.5).damping(damping).interpolated();
    let first = first.position(Vec3::X).build().unwrap().spawn(&mut world);
    let second = body.id(BodyId(8)).build().unwrap().spawn(&mut world);
    world.get::<&mut Wrench>(first).unwrap().force = Vec3::X;
    let pair = weld(&world, &[first, second]).unwrap().spawn(&mut world);
    assert_eq!(*world.get::<&BodyId>(pair).unwrap(), BodyId(7));
    assert_eq!(*world.get::<&GravityScale>(pair).unwrap(), GravityScale(0.5));
    assert_eq!(*world.get::<&Damping>(pair).unwrap(), damping);
    assert_eq!(world.get::<&tumble::PreviousPose>(pair).unwrap().0.position, Vec3::X * 0.5);
    assert_eq!(world.get::<&Wrench>(pair).unwrap().force, Vec3::ZERO);
    assert_eq!(world.get::<&CenterOfMass>(pair).unwrap().0, Vec3::X * -0.5);
}

#[test]
fn what_cannot_be_welded_is_named() {
    let mut world = World::new();
    let ball = || RigidBody::new(Shape::sphere(0.1)).without_collider().mass(1.0);
    let a = ball().build().unwrap().spawn(&mut world);
    let gone = ball().build().unwrap().spawn(&mut world);
    world.despawn(gone).unwrap();
    let fixed = RigidBody::new(Shape::sphere(0.1)).without_collider().fixed().build().unwrap().spawn(&mut world);
    let told = RigidBody::new(Shape::sphere(0.1)).without_collider().kinematic().build().unwrap().spawn(&mut world);
    let nothing = world.spawn(());
    let error = |world: &World, entities: &[Entity]| weld(world, entities).unwrap_err();
    assert_eq!(error(&world, &[]), WeldError::NoBodies);
    assert_eq!(error(&world, &[a, fixed, a]), WeldError::Duplicate { entity: a });
    assert_eq!(error(&world, &[a, gone]), WeldError::Missing { entity: gone });
    assert_eq!(error(&world, &[a, fixed]), WeldError::Immovable { entity: fixed, lacks: "Momentum" });
    assert_eq!(error(&world, &[told, a]), WeldError::Immovable { entity: told, lacks: "Momentum" });
    assert_eq!(error(&world, &[nothing]), WeldError::Immovable { entity: nothing, lacks: "Pose" });
    assert!(error(&world, &[a, fixed]).to_string().ends_with("is no body that forces move: it lacks a Momentum"));

    let lost = ball().build().unwrap().spawn(&mut world);
    world.get::<&mut Momentum>(lost).unwrap().angular.y = Real::NAN;
    assert!(matches!(error(&world, &[a, lost]), WeldError::Impossible { entity, .. } if entity == lost));
    // Two points have no moment about the line through them, which a body of the engine needs; one
    // has no inertia at all.
    let point = |x: Real| RigidBody::new(Shape::Point).mass(1.0).position(Vec3::X * x).build().unwrap();
    let points = [point(0.0).spawn(&mut world), point(1.0).spawn(&mut world)];
    assert!(matches!(error(&world, &points), WeldError::Together(_)));
    assert!(weld(&world, &points[..1]).is_ok());
    assert!(weld(&world, &[points[0], a]).is_ok());
}
