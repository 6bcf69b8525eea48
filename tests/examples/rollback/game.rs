//! The game: two ships among tumbling rocks, that turn, thrust and shoot.

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::{Body, BodyError, BodyId, Momentum, Pose, RigidBody, Shape, Simulation, Wrench};

/// What a player does in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Input {
    /// -1, 0 or 1.
    pub(crate) turn: i8,
    /// -1, 0 or 1.
    pub(crate) thrust: i8,
    /// Whether the trigger is pulled.
    pub(crate) trigger: Trigger,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Trigger {
    #[default]
    Loose,
    Pulled,
}

/// The inputs of both players in one step.
pub(crate) type Inputs = [Input; 2];

/// What a player will do in a step, whoever asks: the same game in every run.
pub(crate) fn script(player: usize, step: u64) -> Input {
    let phase = step / 13 + 5 * player as u64;
    let steer = |phase: u64| [0, 1, 1, 0, -1, 1, 0, -1][(phase % 8) as usize];
    let trigger = if step % 37 == 11 + 9 * player as u64 { Trigger::Pulled } else { Trigger::Loose };
    Input { turn: steer(phase), thrust: steer(3 * phase + 2), trigger }
}

const ROCKS: u64 = 200;
const FIRST_ROCK: u64 = 100;
const FIRST_SHOT: u64 = 1000;
/// Steps after which a shot is gone.
const LIFE_OF_A_SHOT: u64 = 25;

/// Numbers that look random, from 0 to 1.
fn scatter(seed: u64) -> Real {
    let mixed = (seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ((mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as Real / (1_u32 << 24) as Real
}

/// Everything about a body that does not change, by its identity: what a snapshot does not hold, so
/// that a body that was despawned can be spawned again before it is restored.
pub(crate) fn body(id: BodyId) -> Result<Body, BodyError> {
    let random = |n: u64| scatter(16 * id.0 + n);
    let vector = |n| Vec3::new(random(n), random(n + 1), random(n + 2)) - Vec3::splat(0.5);
    let body = match id.0 {
        0..FIRST_ROCK => RigidBody::new(Shape::cone(1.0, 1.5))
            .without_collider()
            .mass(2.0)
            .position(Vec3::X * (id.0 as Real * 20.0 - 10.0)),
        FIRST_ROCK..FIRST_SHOT => RigidBody::new(Shape::cuboid([1.0, 0.6, 0.3]))
            .without_collider()
            .density(3.0)
            .position(vector(0) * 100.0)
            .linear_velocity(vector(3) * 2.0)
            .angular_velocity(vector(6) * 8.0),
        _ => RigidBody::new(Shape::sphere(0.1)).without_collider().mass(0.1),
    };
    body.id(id).build()
}

/// The game at its start.
pub(crate) fn start() -> Result<World, BodyError> {
    let mut world = World::new();
    for id in (0..2).chain(FIRST_ROCK..FIRST_ROCK + ROCKS) {
        body(BodyId(id))?.spawn(&mut world);
    }
    Ok(world)
}

/// One step of the game under these inputs. Shots come and go by the number of the step alone, so
/// each replay is the same.
pub(crate) fn step(world: &mut World, simulation: &mut Simulation, inputs: &Inputs) -> Result<(), BodyError> {
    let now = simulation.steps();
    if let Some(born) = now.checked_sub(LIFE_OF_A_SHOT) {
        for player in 0..2 {
            if let Some(shot) = find(world, shot_of(player, born)) {
                // It was found in this world a moment ago.
                let _ = world.despawn(shot);
            }
        }
    }
    for (player, input) in inputs.iter().enumerate() {
        let Some(ship) = find(world, BodyId(player as u64)) else { continue };
        steer(world, ship, *input);
        if input.trigger == Trigger::Pulled {
            shoot(world, ship, shot_of(player, now))?;
        }
    }
    simulation.step(world);
    Ok(())
}

/// Both peers give the same shot the same identity.
fn shot_of(player: usize, step: u64) -> BodyId {
    BodyId(FIRST_SHOT + 2 * step + player as u64)
}

fn find(world: &mut World, id: BodyId) -> Option<Entity> {
    world.query_mut::<(Entity, &BodyId)>().into_iter().find(|(_, found)| **found == id).map(|(entity, _)| entity)
}

fn steer(world: &mut World, ship: Entity, input: Input) {
    if let Ok((pose, wrench)) = world.query_one_mut::<(&Pose, &mut Wrench)>(ship) {
        wrench.add_force(pose.orientation * Vec3::Y * (Real::from(input.thrust) * 20.0));
        wrench.add_torque(Vec3::new(0.3, 0.0, 1.0) * (Real::from(input.turn) * 4.0));
    }
}

fn shoot(world: &mut World, ship: Entity, id: BodyId) -> Result<(), BodyError> {
    let Ok((pose, momentum)) = world.query_one_mut::<(&mut Pose, &mut Momentum)>(ship) else { return Ok(()) };
    let muzzle = pose.transform_point(Vec3::Y * 2.0);
    let kick = pose.orientation * Vec3::Y * 3.0;
    momentum.apply_impulse_at(-kick, muzzle, pose.position);
    let shot = body(id)?.spawn(world);
    if let Ok((pose, momentum)) = world.query_one_mut::<(&mut Pose, &mut Momentum)>(shot) {
        *pose = Pose { position: muzzle, orientation: Quat::IDENTITY };
        momentum.linear = kick;
    }
    Ok(())
}
