//! Promise: what is added to a `Wrench` acts in one step, in all its substeps, and is gone
//! afterwards; a force component acts in every step until it is removed, and then no more.
//!
//! Why: how long a force lasts is what people get wrong with every engine, and an engine that gets
//! it wrong itself — a wrench spent in the first of four substeps, a thruster that burns one step
//! longer — is not found by looking. It fails if the paths of the step, with forces between bodies
//! or without, consume wrenches at different times.

use hecs::{Component, Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{
    AngularVelocityServo, Buoyancy, ConstantWrench, Damping, Drag, ForceLaws, Frame, GravityMass, Hull, Integrator,
    Magnus, Momentum, PointGravity, Pose, RigidBody, Shape, Simulation, Spring, SpringToPoint, Thruster, Wrench,
};
use tumble_tests::{EPSILON, dvec3, seconds, simulation};

const DT: Real = 1.0 / 64.0;

/// Two kilograms, moving and spinning, so that everything that can act on it does.
fn spawn(world: &mut World) -> Entity {
    let body =
        RigidBody::new(Shape::cuboid([0.5, 0.6, 0.7])).without_collider().mass(2.0).position(Vec3::new(1.0, 0.25, 0.0));
    let body = body.linear_velocity(Vec3::X * 2.0).angular_velocity(Vec3::Z * 3.0).gravity_scale(0.0);
    body.build().unwrap().spawn(world)
}

fn momentum(world: &World, body: Entity) -> Momentum {
    *world.get::<&Momentum>(body).unwrap()
}

/// With gravity, which buoyancy needs, and which the bodies' own scale of zero leaves out.
fn in_substeps(integrator: Integrator, substeps: u32) -> Simulation {
    let mut simulation = simulation(integrator, Vec3::NEG_Y * 8.0, DT);
    simulation.set_settings(simulation.settings().with_substeps(substeps)).unwrap();
    simulation
}

/// Puts two bodies on a spring, and two that attract each other, far from all else: the world is
/// stepped from kick to kick then.
fn couple(world: &mut World) {
    let mut far = |x: Real| {
        let body = RigidBody::new(Shape::sphere(0.1))
            .without_collider()
            .mass(1.0)
            .position(Vec3::new(x, 0.0, 1e3))
            .gravity_scale(0.0);
        let body = body.build().unwrap().spawn(world);
        world.insert_one(body, GravityMass::new(1.0)).unwrap();
        body
    };
    let (a, b) = (far(0.0), far(2.0));
    world.spawn((Spring::between(a, b).with_stiffness(10.0).with_rest_length(1.0),));
}

/// The force acts for a step, however many substeps it has: the momentum has `F dt` more, exactly,
/// for all numbers are short, and the next step adds nothing. It acts in every substep: the way
/// under `MoserVeselov` and `RungeKutta4` is `F dt^2/2M`.
#[test]
fn a_wrench_acts_in_one_step() {
    for integrator in Integrator::ALL {
        for (substeps, coupled) in [(1, false), (4, false), (1, true), (4, true)] {
            let mut world = World::new();
            let body = RigidBody::new(Shape::sphere(0.5))
                .without_collider()
                .mass(2.0)
                .gravity_scale(0.0)
                .build()
                .unwrap()
                .spawn(&mut world);
            if coupled {
                couple(&mut world);
            }
            let mut simulation = in_substeps(integrator, substeps);
            let (force, torque) = (Vec3::new(64.0, -128.0, 32.0), Vec3::new(0.0, 0.5, 0.0));
            let mut wrench = world.get::<&mut Wrench>(body).unwrap();
            wrench.add_force(force);
            wrench.add_torque(torque);
            drop(wrench);
            simulation.step(&mut world);
            let case = format!("{integrator}, {substeps} substeps, coupled: {coupled}");
            let pushed = Momentum { linear: force * DT, angular: torque * DT };
            assert_eq!(momentum(&world, body), pushed, "{case}");
            assert_eq!(*world.get::<&Wrench>(body).unwrap(), Wrench::default(), "{case}");
            let way = dvec3(world.get::<&Pose>(body).unwrap().position);
            // Kicks come first under the first-order method: with n substeps it is (n + 1)/n of it.
            let ahead = if integrator == Integrator::SemiImplicitEuler { 1.0 + 1.0 / f64::from(substeps) } else { 1.0 };
            let exact = dvec3(force) * (seconds(DT) * seconds(DT) / 4.0 * ahead);
            assert!((way - exact).length() <= 8.0 * EPSILON * exact.length(), "{case}: {way} for {exact}");
            for _ in 0..3 {
                simulation.step(&mut world);
                assert_eq!(momentum(&world, body), pushed, "{case}");
            }
        }
    }
}

/// Of many steps at once the wrench acts in the first.
#[test]
fn a_wrench_acts_in_the_first_of_many_steps() {
    for coupled in [false, true] {
        let mut world = World::new();
        let body = spawn(&mut world);
        world.insert_one(body, ConstantWrench { force: Vec3::Y, ..ConstantWrench::default() }).unwrap();
        if coupled {
            couple(&mut world);
        }
        world.get::<&mut Wrench>(body).unwrap().add_force(Vec3::X * 64.0);
        let before = momentum(&world, body).linear;
        in_substeps(Integrator::MoserVeselov, 2).step_many(&mut world, 16);
        // One step of the one, sixteen of the other.
        assert_eq!(momentum(&world, body).linear - before, Vec3::new(64.0 * DT, 16.0 * DT, 0.0), "coupled: {coupled}");
    }
}

/// Under a component the momentum changes in each of ten steps; without it, from the next step on
/// not a bit.
fn assert_acts_until_removed<C: Component + Clone>(component: C) {
    let name = std::any::type_name::<C>();
    for integrator in Integrator::ALL {
        for (substeps, coupled) in [(1, false), (3, false), (2, true)] {
            let mut world = World::new();
            let body = spawn(&mut world);
            if coupled {
                couple(&mut world);
            }
            let mut simulation = in_substeps(integrator, substeps);
            // A body without any before, after and in between.
            for _ in 0..2 {
                let free = momentum(&world, body);
                simulation.step(&mut world);
                assert_eq!(momentum(&world, body), free, "{name}, {integrator}");
                world.insert_one(body, component.clone()).unwrap();
                for step in 0..10 {
                    let before = momentum(&world, body);
                    simulation.step(&mut world);
                    assert_ne!(momentum(&world, body), before, "{name}, {integrator}, step {step}, coupled: {coupled}");
                }
                world.remove_one::<C>(body).unwrap();
            }
            let left = momentum(&world, body);
            simulation.step_many(&mut world, 5);
            assert_eq!(momentum(&world, body), left, "{name}, {integrator}, coupled: {coupled}");
        }
    }
}

#[test]
fn a_component_acts_until_it_is_removed() {
    assert_acts_until_removed(Drag { linear: Vec3::ONE, angular: Vec3::ONE });
    assert_acts_until_removed(Magnus { coefficient: 1.0 });
    assert_acts_until_removed(Thruster::new(Vec3::X, Vec3::Y));
    assert_acts_until_removed(ConstantWrench { force: Vec3::X, torque: Vec3::Y, frame: Frame::World });
    assert_acts_until_removed(SpringToPoint { stiffness: 3.0, ..SpringToPoint::default() });
    assert_acts_until_removed(PointGravity { mu: 3.0, ..PointGravity::default() });
    // So thin that it does not lift the body out.
    assert_acts_until_removed(Buoyancy { density: 0.01, ..Buoyancy::new(Hull::Sphere { radius: 5.0 }) });
    // A limit that it does not reach the target under in twenty steps.
    assert_acts_until_removed(AngularVelocityServo { target: Vec3::X * 1e3, frame: Frame::World, max_torque: 1.0 });
    assert_acts_until_removed(Damping { linear: 1.0, angular: 1.0 });
    assert_eq!(ForceLaws::COMPONENTS.len(), 10, "a kind of component that is not in this test");
}

/// A spring between bodies acts as long as it is there, and attraction as long as one carries its
/// component and there is another that does.
#[test]
fn forces_between_bodies_act_until_they_are_removed() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let (a, b) = (spawn(&mut world), spawn(&mut world));
        world.get::<&mut Pose>(b).unwrap().position.x += 2.0;
        let mut simulation = in_substeps(integrator, 2);
        let mut changes = |world: &mut World| {
            let before = [a, b].map(|body| momentum(world, body));
            simulation.step(world);
            let after = [a, b].map(|body| momentum(world, body));
            (before[0] != after[0], before[1] != after[1])
        };
        assert_eq!(changes(&mut world), (false, false), "{integrator}");
        let spring = world.spawn((Spring::between(a, b).with_stiffness(5.0),));
        (0..5).for_each(|_| assert_eq!(changes(&mut world), (true, true), "{integrator}: spring"));
        world.despawn(spring).unwrap();
        assert_eq!(changes(&mut world), (false, false), "{integrator}: spring");
        world.insert_one(a, GravityMass::new(5.0)).unwrap();
        assert_eq!(changes(&mut world), (false, false), "{integrator}: one mass");
        world.insert_one(b, GravityMass::new(5.0)).unwrap();
        (0..5).for_each(|_| assert_eq!(changes(&mut world), (true, true), "{integrator}: gravity"));
        world.remove_one::<GravityMass>(a).unwrap();
        assert_eq!(changes(&mut world), (false, false), "{integrator}: gravity");
        // A body that is gone attracts no one.
        world.insert_one(a, GravityMass::new(5.0)).unwrap();
        world.despawn(b).unwrap();
        let before = momentum(&world, a);
        simulation.step(&mut world);
        assert_eq!(momentum(&world, a), before, "{integrator}: despawned");
    }
}
