//! Promise: the books of any body balance: of a centimetre to a hundred metres, of a gram to a ton,
//! at rest or of ten radians a step, damped or not, with principal axes of its own or not, under
//! laws written for one body and for many. Under `MoserVeselov` what no force did is rounding, and
//! each work is the one that is found by hand.
//!
//! Why: works are booked for many bodies at a time. It fails if a number of one body gets into
//! another's account, if a work has another sign or goes into another account, or if a law is asked
//! at another time, state or share of the step than the one at which it pushed.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::lane::{Lane, Vec3 as LaneVec3};
use tumble::math::{Real, Vec3};
use tumble::{
    Amount, BodyState, Damping, ForceLaw, GravityScale, Inertia, Integrator, Ledger, Mass, Momentum, Part, Pose,
    PrincipalAxes, RigidBody, Settings, Shape, SimdBody, SimdForceLaw, SimdWrench, Simulation, Work, Wrench,
};
use tumble_tests::{Draw, EPSILON, dquat, dvec3, quat, real, seconds, vec3};

const GRAVITY: Vec3 = Vec3::new(1.0, -9.81, 0.5);
/// Tiles of every width, and what they leave over.
const BODIES: u32 = 16 + 8 + 4 + 3;
const STEPS: u32 = 40;

/// Swings with the time, as strong as the body is heavy; its torque too.
struct Swing;

impl ForceLaw for Swing {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        let pull = real(4.0 - (state.time * 40.0) % 8.0) * state.mass;
        Wrench { force: Vec3::new(pull, 0.5 * pull, 0.0), torque: Vec3::Z * (pull * 1e-3) }
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }
}

/// Pulls to the origin, by its stiffness [N/m], for many bodies at once.
struct Pull(Real);

impl SimdForceLaw<1> for Pull {
    fn numbers(&self) -> [Real; 1] {
        [self.0]
    }

    #[inline(always)]
    fn wrench<L: Lane>([stiffness]: [L; 1], body: &SimdBody<L>) -> SimdWrench<L> {
        SimdWrench { force: body.position * -stiffness, torque: LaneVec3::new(stiffness, L::splat(0.0), stiffness) }
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }
}

/// Which of the things that a body may have it has.
#[derive(Clone, Copy, Debug)]
struct Kind {
    damped: bool,
    axes: bool,
    laws: bool,
}

fn kinds() -> impl Iterator<Item = Kind> {
    (0..8_u8).map(|bits| Kind { damped: bits & 1 != 0, axes: bits & 2 != 0, laws: bits & 4 != 0 })
}

fn spawn(world: &mut World, draw: &mut Draw, kind: Kind, most_spin: f64) -> Entity {
    let size = draw.log_between(0.01, 100.0);
    let edges = DVec3::new(1.0, draw.log_between(0.1, 1.0), draw.log_between(0.1, 1.0)) * size;
    let mass = draw.log_between(1e-3, 1e3);
    let cuboid = Shape::cuboid(edges);
    let body = if kind.axes {
        let ball = Part::new(Shape::sphere(0.1 * size), Amount::Mass(0.2 * mass)).at(vec3(edges * 0.4));
        RigidBody::new(Shape::compound([Part::new(cuboid, Amount::Mass(mass)), ball]))
    } else {
        RigidBody::new(cuboid).mass(mass)
    };
    let body = body.without_collider().position(vec3(draw.vector(3.0))).orientation(quat(draw.orientation()));
    let spin = draw.direction() * draw.log_between(0.01, most_spin);
    let body = body.linear_velocity(vec3(draw.vector(3.0))).angular_velocity(vec3(spin));
    let body = body.build().unwrap().spawn(world);
    assert_eq!(world.get::<&PrincipalAxes>(body).is_ok(), kind.axes);
    world.insert_one(body, GravityScale(real(draw.between(-1.0, 1.5)))).unwrap();
    if kind.damped {
        let rate = |draw: &mut Draw| real(draw.between(0.0, 2.0));
        world.insert_one(body, Damping { linear: rate(draw), angular: rate(draw) }).unwrap();
    }
    if kind.laws {
        world.insert_one(body, Pull(real(mass * draw.between(0.5, 5.0)))).unwrap();
    }
    body
}

/// A world of one kind, with books.
fn booked(kind: Kind, integrator: Integrator, substeps: u32, most_spin: f64) -> (World, Vec<Entity>, Simulation) {
    let settings = Settings::default().with_gravity(GRAVITY).with_integrator(integrator).with_substeps(substeps);
    let mut simulation = Simulation::new(settings).unwrap();
    if kind.laws {
        simulation.add_simd_law::<Pull, 1>();
        simulation.add_global_law(Swing);
    }
    let mut world = World::new();
    let case = u64::from(kind.damped) + 2 * u64::from(kind.axes) + 4 * u64::from(kind.laws);
    let mut draw = Draw::new(0xb_00c5, case);
    let bodies = (0..BODIES).map(|_| spawn(&mut world, &mut draw, kind, most_spin)).collect();
    Ledger::attach(&mut world, &simulation);
    (world, bodies, simulation)
}

/// Pushes each body as much as it is heavy.
fn push(world: &mut World) {
    for (wrench, mass) in world.query_mut::<(&mut Wrench, &Mass)>() {
        wrench.add_force(Vec3::new(0.5, 2.0, -1.0) * mass.kilograms());
        wrench.add_torque(Vec3::new(-0.3, 0.2, 0.4) * (mass.kilograms() * 1e-3));
    }
}

/// Mass, and both velocities at momenta, in double precision.
fn velocities(world: &World, body: Entity, momentum: &Momentum, orientation: DQuat) -> (f64, DVec3, DVec3) {
    let mass = f64::from(world.get::<&Mass>(body).unwrap().kilograms());
    let axes = world.get::<&PrincipalAxes>(body).map_or(DQuat::IDENTITY, |axes| dquat(axes.0));
    let frame = (orientation * axes).normalize();
    let moments = dvec3(world.get::<&Inertia>(body).unwrap().moments());
    let spin = frame * ((frame.inverse() * dvec3(momentum.angular)) / moments);
    (mass, dvec3(momentum.linear) / mass, spin)
}

/// Kinetic energy \[J\], and how large what is rounded in it may be.
fn kinetic(world: &World, body: Entity) -> (f64, f64) {
    let momentum = *world.get::<&Momentum>(body).unwrap();
    let orientation = dquat(world.get::<&Pose>(body).unwrap().orientation);
    let (mass, velocity, spin) = velocities(world, body, &momentum, orientation);
    let (linear, angular) = (mass * velocity.length_squared(), dvec3(momentum.angular));
    (0.5 * (linear + angular.dot(spin)), 0.5 * linear + angular.length() * spin.length())
}

/// What was done in either direction, but by the integrator.
fn size(work: &Work) -> f64 {
    let of_laws: f64 = work.laws.iter().map(|law| law.abs()).sum();
    work.gravity.abs() + work.applied.abs() + work.damping.abs() + of_laws
}

/// The kinetic energy is taken by hand. Each step rounds the sums by some units of double
/// precision, and the attitude of the end is rounded in the precision of the build, once. Each
/// substep of `MoserVeselov` rounds the momenta and the attitude by a few units, at random.
#[test]
fn books_balance_and_the_rest_is_rounding() {
    let mut worst = 0.0_f64;
    for kind in kinds() {
        for (integrator, substeps) in Integrator::ALL.into_iter().flat_map(|it| [(it, 1), (it, 3)]) {
            let (mut world, bodies, mut simulation) = booked(kind, integrator, substeps, 600.0);
            let start: Vec<_> = bodies.iter().map(|&body| kinetic(&world, body)).collect();
            let mut most = vec![0.0; bodies.len()];
            for _ in 0..STEPS {
                push(&mut world);
                simulation.step(&mut world);
                for (most, &body) in most.iter_mut().zip(&bodies) {
                    let size = size(&world.get::<&Work>(body).unwrap()) + kinetic(&world, body).1;
                    *most = size.max(*most);
                }
            }
            for ((&body, start), most) in bodies.iter().zip(start).zip(most) {
                let (case, work) = (format!("{kind:?}, {integrator}, {substeps}"), *world.get::<&Work>(body).unwrap());
                let (scale, change) = (start.1 + most, kinetic(&world, body).0 - start.0);
                let error = (change - work.total()).abs();
                assert!(error <= (4.0 * EPSILON + 40.0 * f64::EPSILON) * scale, "{case}: {error:e} of {scale:e}");
                if integrator == Integrator::MoserVeselov {
                    let share = work.integrator.abs() / scale / EPSILON;
                    worst = worst.max(share);
                    assert!(share <= 4.0 * f64::from(STEPS * substeps).sqrt(), "{case}: {share}");
                }
                assert!(work.damping < 0.0 || !kind.damped, "{case}");
                assert!((work.damping != 0.0) == kind.damped && (work.laws[1] != 0.0) == kind.laws, "{case}");
            }
        }
    }
    println!("integrator's share at most {worst:.1} roundings");
}

/// Every account of a step of `SemiImplicitEuler` without damping: the impulse, of the forces at
/// the start, times the mean of the velocities before and after, with the attitude of the start.
#[test]
fn each_work_is_the_one_found_by_hand() {
    for kind in kinds().filter(|kind| !kind.damped) {
        let (mut world, bodies, mut simulation) = booked(kind, Integrator::SemiImplicitEuler, 1, 20.0);
        let h = seconds(simulation.settings().dt);
        let mut worked = [false; 4];
        for _ in 0..STEPS {
            push(&mut world);
            let time = simulation.time();
            let state = |world: &World, body| {
                let (pose, momentum) = (*world.get::<&Pose>(body).unwrap(), *world.get::<&Momentum>(body).unwrap());
                (pose, momentum, *world.get::<&Wrench>(body).unwrap(), *world.get::<&Work>(body).unwrap())
            };
            let before: Vec<_> = bodies.iter().map(|&body| state(&world, body)).collect();
            simulation.step(&mut world);
            for (&body, (pose, momentum, wrench, old)) in bodies.iter().zip(before) {
                let (_, after, _, new) = state(&world, body);
                let orientation = dquat(pose.orientation);
                let (mass, v0, w0) = velocities(&world, body, &momentum, orientation);
                let (_, v1, w1) = velocities(&world, body, &after, orientation);
                let (v, w) = ((v0 + v1) * 0.5, (w0 + w1) * 0.5);
                let size = h * mass * (GRAVITY.length() as f64 + 20.0) * (v0.length() + v1.length())
                    + h * mass * (w0.length() + w1.length());
                let scale = f64::from(world.get::<&GravityScale>(body).unwrap().0);
                let gravity = h * mass * scale * dvec3(GRAVITY).dot(v);
                let applied = h * (dvec3(wrench.force).dot(v) + dvec3(wrench.torque).dot(w));
                let [mut pull, mut swing] = [0.0; 2];
                if kind.laws {
                    let stiffness = f64::from(world.get::<&Pull>(body).unwrap().0);
                    pull = h * (-stiffness * dvec3(pose.position).dot(v) + stiffness * (w.x + w.z));
                    let strength = (4.0 - (time * 40.0) % 8.0) * mass;
                    swing = h * strength * (v.x + 0.5 * v.y + 1e-3 * w.z);
                }
                let found = [new.gravity - old.gravity, new.applied - old.applied]
                    .into_iter()
                    .chain([new.laws[0] - old.laws[0], new.laws[1] - old.laws[1]]);
                for (i, (found, expected)) in found.zip([gravity, applied, pull, swing]).enumerate() {
                    let error = (found - expected).abs();
                    let allowed = 20.0 * EPSILON * size + 4.0 * f64::EPSILON * old.total().abs();
                    assert!(error <= allowed, "{kind:?}, account {i}: {error:e} of {size:e}");
                    worked[i] |= expected != 0.0;
                }
            }
        }
        assert_eq!(worked, [true, true, kind.laws, kind.laws], "{kind:?}");
    }
}
