//! Promise: under force components `SemiImplicitEuler` is of first order, `RungeKutta4` of fourth
//! and `MoserVeselov` of second; forces between bodies, which are kicks, are of second order under
//! the latter two and of first under the first. A law in lanes does what the same law for one body
//! does.
//!
//! Why: a component that is evaluated once a step where it should be at each stage, or with what
//! was before the kick, still looks right; only the order shows it.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::Integrator::{self, MoserVeselov, RungeKutta4, SemiImplicitEuler};
use tumble::lane::{Lane, Vec3 as LaneVec3};
use tumble::math::{Real, Vec3};
use tumble::{
    BodyOrder, BodyState, Buoyancy, ConstantWrench, Drag, ForceLaw, Frame, GravityMass, Hull, Magnus, Momentum,
    PointGravity, Pose, RigidBody, Shape, SimdBody, SimdForceLaw, SimdWrench, Spring, SpringToPoint, Thruster,
    Velocity, Wind, Wrench,
};
use tumble_benches::mixed_moving_bodies;
use tumble_tests::{DOUBLE, EPSILON, attitude_error, by_precision, dquat, dvec3, run, simulation};

/// What acts in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Drag,
    Magnus,
    Thruster,
    ConstantWrench,
    SpringToPoint,
    PointGravity,
    Buoyancy,
    /// All of these.
    All,
    /// From one of three bodies to the others, off their centres.
    Spring,
    /// Between two of them, with a damper.
    DampedSpring,
    /// From one to the others, with dampers: the springs share a body.
    DampedSprings,
    /// Among three.
    GravityMass,
    /// Both, and all components of one body.
    Everything,
}

const OF_ONE_BODY: [Kind; 8] = [
    Kind::Drag,
    Kind::Magnus,
    Kind::Thruster,
    Kind::ConstantWrench,
    Kind::SpringToPoint,
    Kind::PointGravity,
    Kind::Buoyancy,
    Kind::All,
];
const BETWEEN_BODIES: [Kind; 4] = [Kind::Spring, Kind::DampedSpring, Kind::GravityMass, Kind::Everything];

fn equip(world: &mut World, body: Entity, kind: Kind) {
    let has = |one: Kind| kind == one || matches!(kind, Kind::All | Kind::Everything);
    if has(Kind::Drag) {
        let drag = Drag { linear: Vec3::new(0.3, 0.8, 0.5), angular: Vec3::new(0.03, 0.05, 0.1) };
        world.insert(body, (drag, Wind(Vec3::new(0.5, -1.0, 0.3)))).unwrap();
    }
    if has(Kind::Magnus) {
        world.insert_one(body, Magnus { coefficient: 0.6 }).unwrap();
    }
    if has(Kind::Thruster) {
        let pair = Thruster::new(Vec3::new(2.0, 0.0, 1.0), Vec3::new(0.0, 0.2, 0.1));
        world.insert_one(body, pair.and(Vec3::Y, Vec3::X * 0.3)).unwrap();
    }
    if has(Kind::ConstantWrench) {
        let torque = Vec3::new(0.3, -0.2, 0.1);
        world.insert_one(body, ConstantWrench { force: Vec3::X, torque, frame: Frame::Body }).unwrap();
    }
    if has(Kind::SpringToPoint) {
        let (anchor, attachment) = (Vec3::new(0.0, 1.5, 0.5), Vec3::new(0.2, 0.3, -0.1));
        let spring = SpringToPoint { anchor, attachment, rest_length: 0.5, stiffness: 20.0, damping: 0.7 };
        world.insert_one(body, spring).unwrap();
    }
    if has(Kind::PointGravity) {
        let gravity = PointGravity { center: Vec3::new(1.0, 2.0, -1.0), mu: 5.0, softening: 0.5 };
        world.insert_one(body, gravity).unwrap();
    }
    if has(Kind::Buoyancy) {
        // Never all in or all out, where the force is not smooth; and so strong that differences
        // stand above rounding.
        let density = by_precision(0.05, 0.3) as Real;
        let buoyancy = Buoyancy { density, center: Vec3::Y * 0.2, ..Buoyancy::new(Hull::Sphere { radius: 9.0 }) };
        world.insert_one(body, buoyancy).unwrap();
    }
}

/// Where a body is and how fast.
type End = (DVec3, DQuat, DVec3);

fn after_a_second(kind: Kind, integrator: Integrator, steps: u32) -> Vec<End> {
    let mut world = World::new();
    let mut bodies = Vec::new();
    for x in [0.0, 1.5, -1.5].into_iter().take(if OF_ONE_BODY.contains(&kind) { 1 } else { 3 }) {
        let body = RigidBody::new(Shape::cuboid([0.3, 0.5, 0.8])).without_collider().mass(1.5 + 0.3 * f64::from(x));
        let body = body.position(Vec3::new(x, 0.2 * x * x, 0.1 * x)).gravity_scale(0.3);
        let body = body.linear_velocity(Vec3::new(1.0 - x, 0.5, -2.0 + 0.5 * x)).angular_velocity(Vec3::new(
            2.0,
            3.0 - x,
            1.0,
        ));
        let body = body.build().unwrap().spawn(&mut world);
        equip(&mut world, body, kind);
        if matches!(kind, Kind::GravityMass | Kind::Everything) {
            world.insert_one(body, GravityMass { mu: 4.0 - x, softening: 0.3 }).unwrap();
        }
        bodies.push(body);
    }
    let springs = match kind {
        Kind::Spring | Kind::DampedSprings | Kind::Everything => 2,
        Kind::DampedSpring => 1,
        _ => 0,
    };
    let damping = if matches!(kind, Kind::DampedSpring | Kind::DampedSprings) { 0.8 } else { 0.0 };
    {
        for (a, b) in [(0, 1), (2, 0)].into_iter().take(springs) {
            let spring = Spring::between(bodies[a], bodies[b]).attached_at(Vec3::X * 0.3, Vec3::new(0.0, 0.2, -0.1));
            world.spawn((spring.with_rest_length(1.0).with_stiffness(30.0).with_damping(damping),));
        }
    }
    run(&mut simulation(integrator, Vec3::new(0.3, -1.0, 0.2), 1.0 / steps as Real), &mut world, steps);
    let end = |body: &Entity| {
        let (pose, velocity) = (*world.get::<&Pose>(*body).unwrap(), *world.get::<&Velocity>(*body).unwrap());
        (dvec3(pose.position), dquat(pose.orientation), dvec3(velocity.linear))
    };
    bodies.iter().map(end).collect()
}

/// Metres, radians and metres a second, for bodies about a metre long that turn at some rad/s.
fn distance(a: &[End], b: &[End]) -> f64 {
    let one = |(a, b): (&End, &End)| (a.0 - b.0).length() + attitude_error(a.1, b.1) + (a.2 - b.2).length();
    a.iter().zip(b).map(one).sum()
}

/// Order from three runs, each with half the step of the one before: the first two differ by `2^p`
/// times what the last two do, up to the next term, some per cent at these steps.
fn assert_orders(kinds: &[Kind], integrator: Integrator, steps: u32, orders: std::ops::Range<f64>) {
    for &kind in kinds {
        let [a, b, c] = [1, 2, 4].map(|finer| after_a_second(kind, integrator, finer * steps));
        let (coarse, fine) = (distance(&a, &b), distance(&b, &c));
        let observed = (coarse / fine).log2();
        println!("{kind:?}, {integrator}: {coarse:.2e}, {fine:.2e}, order {observed:.3}");
        assert!(orders.contains(&observed), "{kind:?}, {integrator}: order {observed}");
    }
}

#[test]
fn components_leave_each_integrator_its_order() {
    if DOUBLE {
        assert_orders(&OF_ONE_BODY, SemiImplicitEuler, 4096, 0.9..1.1);
        assert_orders(&OF_ONE_BODY, RungeKutta4, 128, 3.9..4.1);
        assert_orders(&OF_ONE_BODY, MoserVeselov, 512, 1.9..2.1);
    } else {
        // Coarser steps, at which differences stand above rounding; the next terms of the error are
        // larger there.
        assert_orders(&OF_ONE_BODY, SemiImplicitEuler, 128, 0.75..1.25);
        assert_orders(&OF_ONE_BODY, MoserVeselov, 32, 1.75..2.25);
        assert_orders(&OF_ONE_BODY, RungeKutta4, 8, 3.0..5.0);
    }
}

#[test]
fn forces_between_bodies_are_of_second_order() {
    let (euler, others, slack) = if DOUBLE { (4096, 512, 0.1) } else { (128, 64, 0.25) };
    assert_orders(&BETWEEN_BODIES, SemiImplicitEuler, euler, 1.0 - slack..1.0 + slack);
    assert_orders(&BETWEEN_BODIES, RungeKutta4, others, 2.0 - slack..2.0 + slack);
    assert_orders(&BETWEEN_BODIES, MoserVeselov, others, 2.0 - slack..2.0 + slack);
}

/// Dampers of springs that share a body too.
#[test]
fn dampers_that_share_a_body_are_of_second_order() {
    let (steps, slack) = if DOUBLE { (512, 0.1) } else { (64, 0.25) };
    assert_orders(&[Kind::DampedSprings], RungeKutta4, steps, 2.0 - slack..2.0 + slack);
    assert_orders(&[Kind::DampedSprings], MoserVeselov, steps, 2.0 - slack..2.0 + slack);
}

/// All go to the same solution: that of the fourth-order method, or for kicks of the second at
/// smaller steps.
#[test]
fn all_integrators_agree() {
    for kind in OF_ONE_BODY.into_iter().chain(BETWEEN_BODIES) {
        let exact = after_a_second(kind, RungeKutta4, 2048);
        let euler = distance(&after_a_second(kind, SemiImplicitEuler, 4096), &exact);
        let split = distance(&after_a_second(kind, MoserVeselov, 1024), &exact);
        println!("{kind:?}: semi-implicit-euler {euler:.1e}, moser-veselov {split:.1e}");
        // Up to three bodies: half a first-order step turns each by some 1e-3; the split is off by
        // (w dt)^2/24 at up to 10 rad/s, and steps are rounded.
        assert!(euler <= 3e-2, "{kind:?}: {euler:e}");
        let bodies = exact.len() as f64;
        assert!(split <= bodies * (3e-4 + 4096.0 * EPSILON), "{kind:?}: {split:e}");
    }
}

/// A law that has all in it that laws see: a spring with a damper, a force in the body's frame,
/// wind and gravity.
#[derive(Clone, Copy)]
struct Mixed {
    stiffness: Real,
    push: Vec3,
    depends_on_velocity: bool,
}

/// The same in lanes.
#[derive(Clone, Copy)]
struct MixedInLanes(Mixed);

impl ForceLaw for Mixed {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        let hook = state.point_to_world(Vec3::new(0.1, 0.2, 0.3));
        let velocity = if self.depends_on_velocity { state.velocity_at(hook) - state.wind() } else { Vec3::ZERO };
        let pull = state.force_at(hook * -self.stiffness - velocity * 0.5, hook);
        let push = state.wrench_from_body_frame(self.push, Vec3::ZERO);
        let torque = state.apply_inertia(state.gravity()) * 0.01;
        Wrench {
            force: pull.force + push.force + state.gravity() * (state.mass * state.time as Real),
            torque: pull.torque + torque,
        }
    }

    fn depends_on_velocity(&self) -> bool {
        self.depends_on_velocity
    }
}

impl SimdForceLaw<5> for MixedInLanes {
    fn numbers(&self) -> [Real; 5] {
        let Mixed { stiffness, push, depends_on_velocity } = self.0;
        [stiffness, push.x, push.y, push.z, if depends_on_velocity { 0.5 } else { 0.0 }]
    }

    #[inline(always)]
    fn wrench<L: Lane>([stiffness, x, y, z, damping]: [L; 5], body: &SimdBody<L>) -> SimdWrench<L> {
        let arm = body.orientation.rotate(LaneVec3::new(L::splat(0.1), L::splat(0.2), L::splat(0.3)));
        let velocity = body.velocity_at(arm) - body.wind;
        let pull = SimdWrench::force_at((body.position + arm) * -stiffness - velocity * damping, arm);
        let time = L::splat(body.time) + body.offset;
        let force = pull.force + body.orientation.rotate(LaneVec3::new(x, y, z)) + body.gravity * (body.mass * time);
        SimdWrench { force, torque: pull.torque + body.apply_inertia(body.gravity) * L::splat(0.01) }
    }

    fn depends_on_velocity(&self) -> bool {
        self.0.depends_on_velocity
    }
}

/// One law written twice, on bodies of every kind, as a component of some and with velocity on
/// some: momenta after ten steps are the same but for roundings of the forces.
#[test]
fn a_law_in_lanes_is_the_law() {
    for integrator in Integrator::ALL {
        let momenta = |in_lanes: bool| {
            let mut world = mixed_moving_bodies(200);
            for (i, &body) in BodyOrder::of(&world).entities().iter().enumerate().filter(|(i, _)| i % 3 != 0) {
                let law =
                    Mixed { stiffness: 3.0, push: Vec3::new(1.0, i as Real, 0.0), depends_on_velocity: i % 2 == 0 };
                if i % 4 == 1 {
                    world.insert_one(body, Wind(Vec3::X * i as Real)).unwrap();
                }
                if in_lanes {
                    world.insert_one(body, MixedInLanes(law)).unwrap();
                } else {
                    world.insert_one(body, law).unwrap();
                }
            }
            let mut simulation = simulation(integrator, Vec3::NEG_Y * 9.81, 1.0 / 128.0);
            simulation.add_law::<Mixed>();
            simulation.add_simd_law::<MixedInLanes, 5>();
            run(&mut simulation, &mut world, 10);
            let momentum = |body: &Entity| *world.get::<&Momentum>(*body).unwrap();
            BodyOrder::of(&world).entities().iter().map(momentum).collect::<Vec<_>>()
        };
        for (one, lanes) in momenta(false).into_iter().zip(momenta(true)) {
            let near = |a: Vec3, b: Vec3| {
                // Forces of a few hundred newtons over a tenth of a second, and what a turn by a
                // rounding makes of a momentum.
                let allowed = 256.0 * EPSILON * (1.0 + dvec3(a).length() + 20.0);
                (dvec3(a) - dvec3(b)).length() <= allowed
            };
            assert!(
                near(one.linear, lanes.linear) && near(one.angular, lanes.angular),
                "{integrator}: {one:?}, {lanes:?}"
            );
        }
    }
}
