//! A world in which everything acts that can: every force component, springs between bodies,
//! attraction among them, laws of the caller's.

#![allow(dead_code, reason = "each test uses a part of it")]

use hecs::{Entity, World};
use tumble::lane::Lane;
use tumble::math::{Real, Vec3};
use tumble::{
    AngularVelocityServo, BodyState, Buoyancy, ConstantWrench, Drag, ForceLaw, Frame, GravityMass, Hull, Magnus,
    PointGravity, Pose, Rng, SimdBody, SimdForceLaw, SimdWrench, Spring, SpringToPoint, Thruster, Wind, Wrench,
};
use tumble_benches::mixed_body;

/// More than one part of springs and of masses.
pub(crate) const BODIES: u64 = 230;

/// Which kinds of bodies there are.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Kinds {
    All,
    /// Without kinematic ones, which only the step moves.
    NoKinematic,
}

/// A law of one body: pulls in alternating directions.
pub(crate) struct Tide;

impl ForceLaw for Tide {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        let phase = (state.time - state.time.floor() - 0.5) as Real;
        Wrench { force: Vec3::Z * (phase * state.mass), torque: Vec3::ZERO }
    }
}

/// A law in lanes, of the bodies that have it.
#[derive(Clone, Copy)]
pub(crate) struct Honey(pub(crate) Real);

impl SimdForceLaw<1> for Honey {
    fn numbers(&self) -> [Real; 1] {
        [self.0]
    }

    #[inline(always)]
    fn wrench<L: Lane>([strength]: [L; 1], body: &SimdBody<L>) -> SimdWrench<L> {
        SimdWrench::force(body.linear_velocity * -strength)
    }
}

pub(crate) fn spawn(world: &mut World, id: u64) -> Entity {
    let mut rng = Rng::stream(3, id);
    let body = mixed_body(id).spawn(world);
    let when = |every: u64| id.is_multiple_of(every);
    if when(2) {
        let gravity = GravityMass { mu: rng.range(0.0, 500.0), softening: rng.range(0.0, 1.0) };
        world.insert_one(body, gravity).unwrap();
    }
    if when(3) {
        world.insert_one(body, Drag { linear: rng.vector(0.0, 1e-3), angular: rng.vector(0.0, 1e-5) }).unwrap();
    }
    if when(4) {
        world.insert_one(body, Wind(rng.vector(-5.0, 5.0))).unwrap();
    }
    if when(5) {
        world.insert_one(body, Magnus { coefficient: rng.range(0.0, 1.0) }).unwrap();
    }
    if when(6) {
        let thruster = Thruster::new(rng.vector(-5.0, 5.0), rng.vector(-0.1, 0.1));
        world.insert_one(body, thruster.and(rng.vector(-5.0, 5.0), rng.vector(-0.1, 0.1))).unwrap();
    }
    if when(7) {
        let frame = if when(2) { Frame::Body } else { Frame::World };
        let wrench = ConstantWrench { force: rng.vector(-5.0, 5.0), torque: rng.vector(-0.1, 0.1), frame };
        world.insert_one(body, wrench).unwrap();
    }
    if when(8) {
        let (anchor, attachment) = (rng.vector(-50.0, 50.0), rng.vector(-0.1, 0.1));
        let stiffness = rng.range(0.0, 1e3);
        let damping = if when(16) { 3.0 } else { 0.0 };
        let spring = SpringToPoint { anchor, attachment, rest_length: 1.0, stiffness, damping };
        world.insert_one(body, spring).unwrap();
    }
    if when(9) {
        let gravity = PointGravity { center: Vec3::X, mu: rng.range(0.0, 1e3), softening: 0.5 };
        world.insert_one(body, gravity).unwrap();
    }
    if when(10) {
        let sphere = Hull::Sphere { radius: 0.3 };
        let hull = if when(20) { sphere } else { Hull::Cuboid { half_extents: rng.vector(0.1, 0.6) } };
        let buoyancy = Buoyancy { level: rng.range(-20.0, 20.0), center: rng.vector(-0.1, 0.1), ..Buoyancy::new(hull) };
        world.insert_one(body, buoyancy).unwrap();
    }
    if when(11) {
        let target = rng.vector(-2.0, 2.0);
        world.insert_one(body, AngularVelocityServo { target, frame: Frame::Body, max_torque: 0.5 }).unwrap();
    }
    if when(13) {
        world.insert_one(body, Honey(0.3)).unwrap();
    }
    body
}

/// Springs by the identities of their bodies: at random, some soft, some stiff, some damped, some
/// twice, some the other way round; bodies with many and with none.
pub(crate) fn springs() -> Vec<([u64; 2], Spring)> {
    let mut rng = Rng::new(8);
    let mut springs = Vec::new();
    for i in 0..700_u64 {
        let a = rng.next_u64() % if i % 5 == 0 { 10 } else { BODIES };
        let b = (a + 1 + rng.next_u64() % (BODIES - 1)) % BODIES;
        // The stiff ones hold centres, so that no small body is shaken to pieces.
        let off = if i % 7 == 0 { 0.0 } else { 1.0 };
        let spring = Spring::between(Entity::DANGLING, Entity::DANGLING)
            .attached_at(rng.vector(-0.05, 0.05) * off, rng.vector(-0.05, 0.05) * off)
            // Times the distance at the start.
            .with_rest_length(rng.range(0.99, 1.01))
            .with_stiffness(if i % 7 == 0 { 1e8 } else { rng.range(0.0, 200.0) })
            .with_damping(match i {
                _ if i % 7 == 0 => 1e3,
                _ if i % 3 == 0 => rng.range(0.0, 20.0),
                _ => 0.0,
            });
        springs.push(([a, b], spring));
        if i % 11 == 0 {
            springs.push(([a, b], spring));
            springs.push(([b, a], spring));
        }
    }
    springs
}

/// In the order of `ids`, with the springs in any order, before or between the bodies' archetypes.
pub(crate) fn scene(ids: &[u64], springs: &[([u64; 2], Spring)], kinds: Kinds) -> World {
    struct Red;
    let mut world = World::new();
    let mut bodies = vec![Entity::DANGLING; BODIES as usize];
    for &id in ids.iter().filter(|id| kinds == Kinds::All || *id % 16 != 14) {
        bodies[id as usize] = spawn(&mut world, id);
    }
    for (i, (ends, spring)) in springs.iter().enumerate() {
        let bodies = ends.map(|id| bodies[id as usize]);
        let place = |body: Entity| world.get::<&Pose>(body).map(|pose| pose.position);
        let distance = match bodies.map(place) {
            [Ok(a), Ok(b)] => (b - a).dot(b - a).sqrt(),
            _ => 1.0,
        };
        let spring = Spring { bodies, rest_length: spring.rest_length * distance, ..*spring };
        if i % 4 == 0 {
            world.spawn((spring, Red))
        } else {
            world.spawn((spring,))
        };
    }
    world
}

pub(crate) fn plain_scene(kinds: Kinds) -> World {
    scene(&(0..BODIES).collect::<Vec<_>>(), &springs(), kinds)
}

/// Shuffled by numbers of chance.
pub(crate) fn shuffled<T>(mut list: Vec<T>, seed: u64) -> Vec<T> {
    let mut rng = Rng::new(seed);
    for i in (1..list.len()).rev() {
        list.swap(i, (rng.next_u64() % (i as u64 + 1)) as usize);
    }
    list
}
