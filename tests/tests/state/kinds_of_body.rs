//! Promise: what moves is decided by the components an entity has. Without `Momentum` a body is
//! fixed, with a `Velocity` and no `Momentum` it is kinematic and moves exactly with it; what is
//! not a body, or not all of one, is left alone; nothing panics, and the caller's own components
//! change nothing.
//!
//! Why: the world is the caller's, and anything may be in it. It fails if a system takes a missing
//! component for granted, or writes to entities it has no business with.

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    BodyOrder, Collider, Damping, GravityMass, GravityScale, Integrator, InverseInertia, Mass, Momentum, Pose,
    PreviousPose, RigidBody, Settings, Shape, Simulation, Totals, Velocity, Wrench, accumulate_forces, integrate,
    update_derived,
};
use tumble_benches::mixed_body;
use tumble_tests::{EPSILON, attitude_error, dquat, dvec3, hash, seconds};

fn simulations() -> impl Iterator<Item = Simulation> {
    Integrator::ALL.into_iter().map(|i| Simulation::new(Settings::default().with_integrator(i)).unwrap())
}

fn pose(world: &World, entity: Entity) -> Pose {
    *world.get::<&Pose>(entity).unwrap()
}

fn turned() -> Quat {
    Quat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize()
}

#[test]
fn a_fixed_body_does_not_move() {
    for mut simulation in simulations() {
        let mut world = World::new();
        let body = RigidBody::new(Shape::cuboid([1.0, 2.0, 3.0]))
            .without_collider()
            .fixed()
            .position(Vec3::ONE)
            .orientation(turned());
        assert_eq!(body.clone().linear_velocity(Vec3::X).build().unwrap_err().field(), "linear_velocity");
        let entity = body.build().unwrap().spawn(&mut world);
        let before = pose(&world, entity);
        for _ in 0..100 {
            simulation.step(&mut world);
        }
        assert_eq!(pose(&world, entity), before);
        assert!(!world.satisfies::<&Momentum>(entity) && !world.satisfies::<&Velocity>(entity));
    }
}

/// A constant angular velocity is a rotation by `|w| t` about it, at any step, of however many
/// turns: no error but of rounding, `EPSILON` a step for the orientation and `|w| dt EPSILON` for
/// the angle, which is rounded before its sine is taken.
#[test]
fn a_kinematic_body_turns_exactly() {
    let axis = Vec3::new(2.0, -1.0, 2.0) / 3.0;
    for (dt, steps) in [(1e-3, 1000), (1.0 / 60.0, 600), (1.0, 10), (20.0, 5)] {
        for rate in [1e-6, 0.5, 3.0, 100.0] {
            let mut world = World::new();
            let body = RigidBody::new(Shape::sphere(1.0)).without_collider().kinematic().orientation(turned());
            let entity = body.angular_velocity(axis * rate).build().unwrap().spawn(&mut world);
            let mut simulation = Simulation::new(Settings::default().with_dt(dt)).unwrap();
            for _ in 0..steps {
                simulation.step(&mut world);
            }
            let w = dvec3(world.get::<&Velocity>(entity).unwrap().angular);
            let angle = w.length() * seconds(dt) * f64::from(steps);
            let exact = glam::DQuat::from_axis_angle(w.normalize(), angle) * dquat(turned());
            let error = attitude_error(dquat(pose(&world, entity).orientation), exact);
            let allowed = EPSILON * (2.0 * f64::from(steps) + 2.0 * angle) + 1e-15 * angle;
            assert!(error <= allowed, "{rate} rad/s at dt {dt}: {error:e} rad > {allowed:e}");
        }
    }
}

/// Gravity, wrenches, damping and mass mean nothing to it, and its velocity stays as it was set.
#[test]
fn a_kinematic_body_moves_as_told_whatever_pushes_it() {
    for mut simulation in simulations() {
        let mut world = World::new();
        let velocity = Velocity { linear: Vec3::new(1.0, 2.0, -4.0), angular: Vec3::ZERO };
        let wrench = Wrench { force: Vec3::ONE * 1e3, torque: Vec3::ONE * 1e3 };
        let damping = Damping { linear: 10.0, angular: 10.0 };
        let components = (Pose::default(), velocity, Mass::new(2.0).unwrap(), wrench, damping, GravityScale(5.0));
        let entity = world.spawn(components);
        for _ in 0..64 {
            simulation.step(&mut world);
        }
        let expected = velocity.linear * (64.0 * simulation.settings().dt);
        let error = (pose(&world, entity).position - expected).length();
        // Rounded once a step.
        assert!(error <= 64.0 * Real::EPSILON * expected.length(), "{error:e} m");
        assert_eq!(*world.get::<&Velocity>(entity).unwrap(), velocity);
        assert_eq!(pose(&world, entity).orientation, Quat::IDENTITY);
    }
}

/// Gaining and losing `Momentum` makes a body move and stop.
#[test]
fn a_body_changes_kind_with_its_components() {
    let mut world = World::new();
    let entity = RigidBody::new(Shape::sphere(0.5)).without_collider().mass(1.0).build().unwrap().spawn(&mut world);
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    simulation.step(&mut world);
    let falling = pose(&world, entity);
    assert!(falling.position.y < 0.0);
    let momentum = world.remove_one::<Momentum>(entity).unwrap();
    world.remove_one::<Velocity>(entity).unwrap();
    simulation.step(&mut world);
    assert_eq!(pose(&world, entity), falling);
    world.insert_one(entity, momentum).unwrap();
    simulation.step(&mut world);
    assert!(pose(&world, entity).position.y < falling.position.y);
}

/// Every subset of a moving body's components: no panic, and only those with all four that motion
/// needs, or a kinematic body's two, go anywhere.
#[test]
fn any_part_of_a_body_is_taken_as_it_is() {
    let whole = RigidBody::new(Shape::cone(0.3, 0.5))
        .without_collider()
        .mass(2.0)
        .damping(Damping { linear: 0.1, angular: 0.1 });
    let whole = whole.linear_velocity(Vec3::X).angular_velocity(Vec3::ONE).gravity_scale(0.5).interpolated();
    let whole = whole.build().unwrap();
    // Where bodies may act on each other, steps go another way. These do not: they touch no one and
    // pull at no one.
    let collider = Collider::new(&Shape::sphere(0.1)).unwrap().with_groups(0, 0);
    let lonely: [&dyn Fn(&mut World) -> Entity; 3] =
        [&|world| whole.spawn(world), &|world| whole.spawn_with(world, (collider.clone(),)), &|world| {
            whole.spawn_with(world, (GravityMass { mu: 0.0, softening: 1.0 },))
        }];
    for (mut simulation, spawn) in simulations().flat_map(|it| lonely.map(|spawn| (it.clone(), spawn))) {
        let mut world = World::new();
        let bodies: Vec<(u32, Entity)> = (0..1 << 8)
            .map(|missing| {
                let entity = spawn(&mut world);
                macro_rules! remove {
                    ($($bit:literal $Component:ty),+) => {$(
                        if missing & 1 << $bit != 0 {
                            world.remove_one::<$Component>(entity).unwrap();
                        }
                    )+};
                }
                remove!(0 Pose, 1 Momentum, 2 Mass, 3 Wrench, 4 Velocity, 5 tumble::Inertia, 6 InverseInertia, 7 PreviousPose);
                (missing, entity)
            })
            .collect();
        let start = *whole_pose(&whole);
        for _ in 0..3 {
            simulation.step(&mut world);
        }
        let order = BodyOrder::of(&world);
        assert_eq!(Totals::of(&world, simulation.settings(), &order).non_finite, None);
        for (missing, entity) in bodies {
            let Ok(now) = world.get::<&Pose>(entity).map(|pose| *pose) else { continue };
            let has = |bit: u32| missing & 1 << bit == 0;
            let (dynamic, kinematic) = (has(1) && has(2) && has(3), !has(1) && has(4));
            assert_eq!(now.position != start.position, dynamic || kinematic, "without {missing:08b}");
            // A body without inertia is a point and does not turn.
            let turns = dynamic && has(5) || kinematic;
            assert_eq!(now.orientation != start.orientation, turns, "without {missing:08b}");
        }
    }
}

/// The pose a body starts with.
fn whole_pose(body: &tumble::Body) -> Box<Pose> {
    let mut world = World::new();
    let entity = body.spawn(&mut world);
    Box::new(pose(&world, entity))
}

#[test]
fn an_empty_world_can_be_stepped() {
    for mut simulation in simulations() {
        let mut world = World::new();
        simulation.step(&mut world);
        accumulate_forces(&mut world, simulation.settings().gravity);
        integrate(&mut world, simulation.settings());
        update_derived(&mut world);
        assert!(world.is_empty());
        assert!(BodyOrder::of(&world).is_empty());
        assert_eq!(simulation.steps(), 1);
        // An archetype that once had bodies and has none now is as empty.
        let entity = mixed_body(0).spawn(&mut world);
        world.despawn(entity).unwrap();
        simulation.step(&mut world);
        assert!(world.is_empty());
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Name(String);

#[derive(Clone, Copy, Debug, PartialEq)]
struct Health(u32);

/// Entities that are not bodies, even with components that look like it, stay as they are.
#[test]
fn what_is_not_a_body_is_left_alone() {
    for mut simulation in simulations() {
        let mut world = World::new();
        let wrench = Wrench { force: Vec3::ONE, torque: Vec3::ONE };
        let momentum = Momentum { linear: Vec3::ONE, angular: Vec3::ONE };
        let named = world.spawn((Name("score".into()), Health(3)));
        let empty = world.spawn(());
        let loose = world.spawn((wrench, momentum, Mass::new(1.0).unwrap(), Name("no pose".into())));
        mixed_body(3).spawn(&mut world);
        for _ in 0..10 {
            simulation.step(&mut world);
        }
        assert_eq!(*world.get::<&Name>(named).unwrap(), Name("score".into()));
        assert_eq!(*world.get::<&Health>(named).unwrap(), Health(3));
        assert!(world.contains(empty));
        assert_eq!(*world.get::<&Wrench>(loose).unwrap(), wrench);
        assert_eq!(*world.get::<&Momentum>(loose).unwrap(), momentum);
    }
}

/// The caller's components beside a body's change nothing about its motion and are not touched.
#[test]
fn components_of_the_caller_are_kept() {
    for mut simulation in simulations() {
        let (mut alone, mut beside) = (World::new(), World::new());
        for id in 0..64 {
            mixed_body(id).spawn(&mut alone);
            let mut entity = hecs::EntityBuilder::new();
            mixed_body(id).insert_into(&mut entity);
            entity.add(Health(id as u32)).add(Name(format!("body {id}")));
            beside.spawn(entity.build());
        }
        for _ in 0..50 {
            simulation.step(&mut alone);
            simulation.step(&mut beside);
        }
        assert_eq!(hash(&alone), hash(&beside));
        let order = BodyOrder::of(&beside);
        for (id, &entity) in order.entities().iter().enumerate() {
            assert_eq!(*beside.get::<&Health>(entity).unwrap(), Health(id as u32));
            assert_eq!(*beside.get::<&Name>(entity).unwrap(), Name(format!("body {id}")));
        }
    }
}

/// The velocities that a step derives are good to rounding for thin rods too, whichever axis of
/// their own they are long in: turned about that axis, spinning about another, nothing of the one's
/// small moment may get into the other's.
#[test]
fn a_thin_rod_has_the_angular_velocity_it_was_given() {
    for long in 0..3 {
        let mut half_extents = [0.001; 3];
        half_extents[long] = 0.5;
        let mut along = [0.0; 3];
        along[long] = 1.0;
        let mut across: [Real; 3] = [2.0; 3];
        across[long] = 0.0;
        let mut world = World::new();
        let rod = RigidBody::new(Shape::cuboid(half_extents))
            .without_collider()
            .mass(1.0)
            .orientation(Quat::from_axis_angle(Vec3::from(along), 0.7))
            .angular_velocity(Vec3::from(across))
            .build()
            .unwrap()
            .spawn(&mut world);
        tumble::update_derived(&mut world);
        let found = world.get::<&Velocity>(rod).unwrap().angular;
        // A dozen roundings of numbers that add up without cancelling.
        let apart = (found - Vec3::from(across)).length() / Vec3::from(across).length();
        assert!(apart < 12.0 * Real::EPSILON, "long in {long}: {found} for {across:?}, {apart} off");
    }
}
