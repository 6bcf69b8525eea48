//! Promise: a `ForceLaw` is evaluated at every stage of the integrator with the time and the state
//! of that stage, as often as the documentation says, on the bodies that have it or on all; under
//! laws that depend on place, orientation, velocity or time `SemiImplicitEuler` is of first order,
//! `RungeKutta4` of fourth and `MoserVeselov` of second; the result does not depend on threads.
//!
//! Why: a law that is evaluated once a step makes every integrator one of first order, and no one
//! sees it but in a comparison like this. It also fails if a body gets the law of its neighbour, if
//! a stage sees the time of the step, or if the time of a substep is wrong.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::Integrator::{self, MoserVeselov, RungeKutta4, SemiImplicitEuler};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    BodyId, BodyOrder, BodyState, Damping, ForceLaw, Momentum, Pose, RigidBody, Settings, Shape, Simulation, Velocity,
    Wrench,
};
use tumble_benches::mixed_bodies;
use tumble_tests::{EPSILON, attitude_error, dquat, dvec3, hash, run, weightless};

fn box_of_three_lengths() -> RigidBody {
    RigidBody::new(Shape::cuboid([0.3, 0.5, 0.8])).without_collider().mass(1.5)
}

/// Which law acts in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// A spring from a point of the body to a point of the world: depends on place and orientation.
    Spring,
    /// Drag on both velocities, more than in proportion: depends on velocity.
    Drag,
    /// A force and a torque, fixed in the body's frame, that come and go: depend on time and
    /// orientation.
    Thruster,
    /// All three.
    All,
}

impl ForceLaw for Kind {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        let mut sum = Wrench::default();
        if matches!(self, Self::Spring | Self::All) {
            let hook = state.point_to_world(Vec3::new(0.2, 0.5, -0.1));
            let pull = state.force_at((Vec3::new(0.0, 1.0, 0.5) - hook) * 20.0, hook);
            (sum.force, sum.torque) = (pull.force, pull.torque);
        }
        if matches!(self, Self::Drag | Self::All) {
            sum.force -= state.linear_velocity * (0.8 * state.linear_velocity.length());
            sum.torque -= state.angular_velocity * (0.1 * state.angular_velocity.length());
        }
        if matches!(self, Self::Thruster | Self::All) {
            let now = (3.0 * state.time).sin() as Real;
            let thrust = state.wrench_from_body_frame(Vec3::new(2.0, 0.0, 1.0) * now, Vec3::new(0.3, 0.5, -0.2) * now);
            sum.force += thrust.force;
            sum.torque += thrust.torque;
        }
        sum
    }

    fn depends_on_velocity(&self) -> bool {
        matches!(self, Self::Drag | Self::All)
    }
}

/// The state after a second.
#[derive(Clone, Copy)]
struct End {
    position: DVec3,
    orientation: DQuat,
    velocity: DVec3,
}

fn after_a_second(kind: Kind, integrator: Integrator, steps: u32) -> End {
    let mut world = World::new();
    let body =
        box_of_three_lengths().linear_velocity(Vec3::new(1.0, 0.5, -2.0)).angular_velocity(Vec3::new(2.0, 3.0, 1.0));
    let body = body.build().unwrap().spawn(&mut world);
    world.insert_one(body, kind).unwrap();
    let mut simulation = weightless(integrator, 1.0 / steps as Real);
    simulation.add_law::<Kind>();
    run(&mut simulation, &mut world, steps);
    let pose = *world.get::<&Pose>(body).unwrap();
    let velocity = dvec3(world.get::<&Velocity>(body).unwrap().linear);
    End { position: dvec3(pose.position), orientation: dquat(pose.orientation), velocity }
}

/// Distance of two states: metres, radians and metres a second, for a body about a metre long that
/// turns at some rad/s.
fn distance(a: End, b: End) -> f64 {
    (a.position - b.position).length()
        + attitude_error(a.orientation, b.orientation)
        + (a.velocity - b.velocity).length()
}

/// Order from three runs, each with half the step of the one before: the first two differ by `2^p`
/// times what the last two do, up to the next term, a few per cent at these steps. Each law by
/// itself, so that none hides behind another.
fn assert_orders(cases: &[(Integrator, u32, f64)], tolerance: f64) {
    for kind in [Kind::Spring, Kind::Drag, Kind::Thruster, Kind::All] {
        for &(integrator, steps, order) in cases {
            let [a, b, c] = [1, 2, 4].map(|finer| after_a_second(kind, integrator, finer * steps));
            let (coarse, fine) = (distance(a, b), distance(b, c));
            let observed = (coarse / fine).log2();
            println!("{kind:?}, {integrator}: {coarse:.2e}, {fine:.2e}, order {observed:.3}");
            assert!((observed - order).abs() <= tolerance, "{kind:?}, {integrator}: order {observed}");
        }
    }
}

#[cfg(feature = "f64")]
#[test]
fn laws_leave_each_integrator_its_order() {
    assert_orders(&[(SemiImplicitEuler, 4096, 1.0), (RungeKutta4, 256, 4.0), (MoserVeselov, 512, 2.0)], 0.1);
}

/// Coarser steps, at which differences stand above rounding; the next terms of the error are larger
/// there.
#[cfg(not(feature = "f64"))]
#[test]
fn laws_leave_each_integrator_its_order() {
    assert_orders(&[(SemiImplicitEuler, 128, 1.0), (MoserVeselov, 32, 2.0)], 0.25);
    assert_orders(&[(RungeKutta4, 8, 4.0)], 1.0);
}

/// All three go to the same solution: that of the fourth-order method at small steps.
#[test]
fn all_integrators_agree() {
    for kind in [Kind::Spring, Kind::Drag, Kind::Thruster, Kind::All] {
        let exact = after_a_second(kind, RungeKutta4, 512);
        let euler = distance(after_a_second(kind, SemiImplicitEuler, 4096), exact);
        let split = distance(after_a_second(kind, MoserVeselov, 1024), exact);
        println!("{kind:?}: semi-implicit-euler {euler:.1e}, moser-veselov {split:.1e}");
        // Half a step of the first-order method turns by 5e-4; the split is off by (w dt)^2/24 of
        // what it goes through, and 4096 steps are rounded.
        assert!(euler <= 2e-2, "{kind:?}: {euler:e}");
        assert!(split <= 5e-5 + 4096.0 * EPSILON, "{kind:?}: {split:e}");
    }
}

/// What a law was asked.
#[derive(Clone, Default)]
struct Asked {
    times: Arc<std::sync::Mutex<Vec<f64>>>,
    depends_on_velocity: bool,
}

impl ForceLaw for Asked {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        self.times.lock().unwrap().push(state.time);
        Wrench::default()
    }

    fn depends_on_velocity(&self) -> bool {
        self.depends_on_velocity
    }
}

/// At exactly these times, in binary fractions.
#[test]
fn laws_are_evaluated_at_every_stage() {
    let (start, middle, end) = (0.5, 0.625, 0.75);
    for (integrator, depends_on_velocity, times) in [
        (SemiImplicitEuler, false, vec![start]),
        (SemiImplicitEuler, true, vec![start]),
        (RungeKutta4, false, vec![start, middle, middle, end]),
        (RungeKutta4, true, vec![start, middle, middle, end]),
        (MoserVeselov, false, vec![start, end]),
        (MoserVeselov, true, vec![start, end, end]),
    ] {
        let law = Asked { depends_on_velocity, ..Asked::default() };
        let mut world = World::new();
        box_of_three_lengths().build().unwrap().spawn(&mut world);
        let mut simulation = weightless(integrator, 0.25);
        simulation.add_global_law(law.clone());
        run(&mut simulation, &mut world, 2);
        law.times.lock().unwrap().clear();
        simulation.step(&mut world);
        assert_eq!(*law.times.lock().unwrap(), times, "{integrator}, depends on velocity: {depends_on_velocity}");
    }
}

/// A substep is a step of its own to a law; and after a change of the step time goes on from where
/// it was.
#[test]
fn substeps_have_their_own_times() {
    let law = Asked::default();
    let mut world = World::new();
    box_of_three_lengths().build().unwrap().spawn(&mut world);
    let mut simulation = weightless(SemiImplicitEuler, 0.5);
    simulation.add_global_law(law.clone());
    simulation.step(&mut world);
    let settings = simulation.settings().with_dt(1.0).with_substeps(4);
    simulation.set_settings(settings).unwrap();
    run(&mut simulation, &mut world, 2);
    let times = [0.0, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25];
    assert_eq!(*law.times.lock().unwrap(), times);
    assert_eq!(simulation.time(), 2.5);
}

/// Substeps are steps to everything that laws can see, so the bits are the same; but the derived
/// velocity is of the end.
#[test]
fn substeps_under_laws_are_steps() {
    for integrator in Integrator::ALL {
        let hash = |substeps: u32| {
            let mut world = World::new();
            box_of_three_lengths().angular_velocity(Vec3::new(2.0, 3.0, 1.0)).build().unwrap().spawn(&mut world);
            let settings = Settings::default().with_gravity(Vec3::ZERO).with_integrator(integrator);
            // A power of two, so that the substep is exact.
            let settings = settings.with_dt(substeps as Real / 128.0).with_substeps(substeps);
            let mut simulation = Simulation::new(settings).unwrap();
            simulation.add_global_law(Kind::All);
            run(&mut simulation, &mut world, 64 / substeps);
            hash(&world)
        };
        assert_eq!(hash(1), hash(4), "{integrator}");
    }
}

/// Counts its evaluations, and pushes.
struct Push {
    force: Vec3,
    count: Arc<AtomicUsize>,
}

impl ForceLaw for Push {
    fn wrench(&self, _: &BodyState<'_>) -> Wrench {
        self.count.fetch_add(1, Ordering::Relaxed);
        Wrench { force: self.force, torque: Vec3::ZERO }
    }
}

/// Each body gets its own law, wherever it lies; those without one get none. Of the 9000 bodies
/// those of one kind are 3000, in three chunks.
#[test]
fn a_component_law_acts_on_its_own_bodies() {
    let count = Arc::new(AtomicUsize::new(0));
    let mut world = World::new();
    let mut pushed: Vec<(Entity, Vec3)> = Vec::new();
    let mut free = Vec::new();
    for i in 0..9000_u16 {
        let damping = Damping { linear: 0.0, angular: 0.5 };
        let body = box_of_three_lengths().mass(2.0);
        let body = if i % 3 == 0 { body.damping(damping) } else { body };
        let entity = body.build().unwrap().spawn(&mut world);
        if i % 2 == 0 {
            let force = Vec3::new(Real::from(i), 1.0, 0.0);
            world.insert_one(entity, Push { force, count: count.clone() }).unwrap();
            pushed.push((entity, force));
        } else {
            free.push(entity);
        }
    }
    // Rows are swapped about by this.
    for _ in 0..100 {
        world.despawn(pushed.remove(7).0).unwrap();
    }
    let mut simulation = weightless(SemiImplicitEuler, 0.25);
    simulation.add_law::<Push>();
    simulation.step(&mut world);
    assert_eq!(count.load(Ordering::Relaxed), pushed.len());
    for (entity, force) in pushed {
        assert_eq!(world.get::<&Momentum>(entity).unwrap().linear, force * 0.25);
    }
    for entity in free {
        assert_eq!(world.get::<&Momentum>(entity).unwrap().linear, Vec3::ZERO);
    }
}

/// Of all bodies, those that forces move.
#[test]
fn an_everywhere_law_acts_on_every_moving_body() {
    let count = Arc::new(AtomicUsize::new(0));
    let mut world = World::new();
    let thing = || box_of_three_lengths().mass(2.0);
    let moving = thing().build().unwrap().spawn(&mut world);
    let point = RigidBody::new(Shape::Point).mass(1.0).build().unwrap().spawn(&mut world);
    let fixed = thing().fixed().build().unwrap().spawn(&mut world);
    let kinematic = thing().kinematic().build().unwrap().spawn(&mut world);
    world.spawn(("not a body",));
    let mut simulation = weightless(SemiImplicitEuler, 0.25);
    simulation.add_global_law(Push { force: Vec3::X, count: count.clone() });
    simulation.step(&mut world);
    assert_eq!(count.load(Ordering::Relaxed), 2);
    for body in [moving, point] {
        assert_eq!(world.get::<&Momentum>(body).unwrap().linear, Vec3::X * 0.25);
    }
    for body in [fixed, kinematic] {
        assert_eq!(world.get::<&Pose>(body).unwrap().position, Vec3::ZERO);
    }
    assert_eq!(simulation.laws().names().collect::<Vec<_>>(), ["Push"]);
}

/// A force fixed in the body's frame turns with it: half a turn each way, and the body comes back
/// to rest.
#[test]
fn forces_in_the_body_frame_turn_with_the_body() {
    struct Forward;
    impl ForceLaw for Forward {
        fn wrench(&self, state: &BodyState<'_>) -> Wrench {
            state.wrench_from_body_frame(Vec3::X * 3.0, Vec3::ZERO)
        }
    }
    let mut world = World::new();
    let body = box_of_three_lengths().angular_velocity(Vec3::Z * std::f64::consts::TAU as Real);
    let body = body.build().unwrap().spawn(&mut world);
    let mut simulation = weightless(MoserVeselov, 1.0 / 256.0);
    simulation.add_global_law(Forward);
    run(&mut simulation, &mut world, 128);
    // Half a turn: the impulse is (0, 2/w F), to second order in the step of 0.025 rad: (w dt)^2/12
    // of it.
    let impulse = dvec3(world.get::<&Momentum>(body).unwrap().linear);
    let exact = 2.0 / std::f64::consts::TAU * 3.0;
    let allowed = exact * (0.025_f64.powi(2) / 6.0 + 128.0 * EPSILON);
    assert!((impulse - DVec3::Y * exact).length() <= allowed, "{impulse} not {exact}");
    run(&mut simulation, &mut world, 128);
    let impulse = dvec3(world.get::<&Momentum>(body).unwrap().linear);
    // A whole turn sums to nothing at any step, but that the sixth-order map turns short by 17/315
    // (w dt/2)^6 of it.
    let turned_short = std::f64::consts::TAU * 17.0 / 315.0 * 0.0125_f64.powi(6);
    assert!(impulse.length() <= 0.5 * exact * turned_short + 256.0 * EPSILON, "{impulse}");
}

/// What a law sees is the state as the components show it: velocities, inertia, frames.
#[test]
fn a_law_sees_the_state() {
    struct Checks(Vec3, Quat);
    impl ForceLaw for Checks {
        fn wrench(&self, state: &BodyState<'_>) -> Wrench {
            let near = |a: Vec3, b: Vec3| (dvec3(a) - dvec3(b)).length() <= 16.0 * EPSILON * (1.0 + dvec3(b).length());
            assert!(near(state.angular_velocity, self.0), "{}", state.angular_velocity);
            assert!(near(state.linear_velocity, Vec3::Y));
            assert!(near(state.point_to_world(Vec3::X), state.position + self.1 * Vec3::X));
            assert!(near(state.to_body(state.to_world(Vec3::ONE)), Vec3::ONE));
            assert!(near(state.velocity_at(state.position + Vec3::X), Vec3::Y + self.0.cross(Vec3::X)));
            let momentum = state.apply_inertia(state.angular_velocity);
            Wrench { force: Vec3::ZERO, torque: momentum }
        }
    }
    let (spin, frame) = (Vec3::new(0.3, -2.0, 0.7), Quat::from_xyzw(0.5, -0.1, 0.7, 0.5).normalize());
    let part = |x: f64, mass: f64| {
        tumble::Part::new(Shape::cuboid([0.1, 0.2, 0.3]), tumble::Amount::Mass(mass)).at([x, 0.3 * x, 0.0])
    };
    let compound =
        RigidBody::new(Shape::compound([part(0.5, 1.0), part(-1.0, 2.0)])).without_collider().orientation(frame);
    let mut world = World::new();
    let body = compound.linear_velocity(Vec3::Y).angular_velocity(spin).build().unwrap().spawn(&mut world);
    let before = *world.get::<&Momentum>(body).unwrap();
    let mut simulation = weightless(SemiImplicitEuler, 0.125);
    simulation.add_global_law(Checks(spin, frame));
    simulation.step(&mut world);
    // The torque was I w, so L has grown by an eighth of itself.
    let after = *world.get::<&Momentum>(body).unwrap();
    let error = (dvec3(after.angular) - dvec3(before.angular) * 1.125).length();
    assert!(error <= 16.0 * EPSILON * dvec3(before.angular).length(), "{error:e}");
}

/// Bits, for any number of threads, order of spawning and number of steps, under a component law
/// and an everywhere law together.
#[test]
fn laws_do_not_depend_on_threads() {
    for integrator in Integrator::ALL {
        let hash = |threads: usize| {
            let mut world = mixed_bodies(3000);
            let order = BodyOrder::of(&world);
            for &entity in order.entities() {
                let id = world.get::<&BodyId>(entity).unwrap().0;
                if id.is_multiple_of(3) {
                    world.insert_one(entity, Kind::Spring).unwrap();
                }
            }
            let mut simulation = weightless(integrator, 0.01);
            simulation.add_law::<Kind>();
            simulation.add_global_law(Kind::All);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| run(&mut simulation, &mut world, 20));
            hash(&world)
        };
        let one = hash(1);
        assert_eq!(one, hash(2), "{integrator}");
        assert_eq!(one, hash(4), "{integrator}");
    }
}

/// A law that does nothing changes nothing but, at most, the last bits: the paths with and without
/// laws are the same methods.
#[test]
fn a_law_without_force_changes_nothing() {
    struct Nothing;
    impl ForceLaw for Nothing {
        fn wrench(&self, _: &BodyState<'_>) -> Wrench {
            Wrench::default()
        }
    }
    for integrator in Integrator::ALL {
        let hash = |with_law: bool| {
            let mut world = mixed_bodies(200);
            let mut simulation = weightless(integrator, 0.01);
            if with_law {
                simulation.add_global_law(Nothing);
            }
            run(&mut simulation, &mut world, 50);
            hash(&world)
        };
        assert_eq!(hash(true), hash(false), "{integrator}");
    }
}

/// An everywhere law is asked for each body as often as its page says and for no others, however
/// many there are: not for copies that only fill up a tile.
#[test]
fn a_law_is_asked_for_bodies_that_are_there() {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU64, Ordering};

    struct Counting(Arc<AtomicU64>);
    impl ForceLaw for Counting {
        fn wrench(&self, _: &BodyState<'_>) -> Wrench {
            self.0.fetch_add(1, Ordering::Relaxed);
            Wrench::default()
        }
    }

    for (integrator, evaluations) in
        [(Integrator::SemiImplicitEuler, 1), (Integrator::RungeKutta4, 4), (Integrator::MoserVeselov, 3)]
    {
        for bodies in 1..40 {
            let asked = Arc::new(AtomicU64::new(0));
            let mut simulation = Simulation::new(Settings::default().with_integrator(integrator)).unwrap();
            simulation.add_global_law(Counting(Arc::clone(&asked)));
            simulation.step(&mut tumble_benches::tumbling_boxes(bodies as usize));
            assert_eq!(asked.load(Ordering::Relaxed), bodies * evaluations, "{integrator}, {bodies} bodies");
        }
    }
}
