//! The game without its window: what the player does, and what happens before each step.

use std::error::Error;

use hecs::{Entity, World};
use tumble::prelude::*;
use tumble_character::{CharacterInput, SavedCharacters, move_characters};
use tumble_vehicle::{VehicleInput, VehicleState, drive_vehicles};

use crate::driver::{DOOR, PARKED, drive, enter_or_leave};
use crate::hand::{Grip, pull, release, shoot};
use crate::yard::{self, GATE_WAY, Lift, Yard};

const WALK: Real = 3.0; // [m/s]
const RUN: Real = 6.0;
const CROUCH: Real = 1.5;
/// How long the gate stays open when nothing is on the plate, in steps.
const GATE_STEPS: u64 = 600;
/// What stacks take to settle by their millimetre, before anybody looks, in steps.
pub(crate) const SETTLE: u64 = 120;
/// Of slow motion.
const SLOW: f64 = 0.15;

/// What the player wants: the keys that are down, and where it looks \[rad\].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Actions {
    /// From -1 to 1.
    pub(crate) ahead: Real,
    pub(crate) right: Real,
    /// About y from -z, and up.
    pub(crate) yaw: Real,
    pub(crate) pitch: Real,
    pub(crate) run: bool,
    pub(crate) jump: bool,
    pub(crate) crouch: bool,
    pub(crate) slow: bool,
    pub(crate) grab: bool,
    pub(crate) shoot: bool,
    pub(crate) use_car: bool,
}

/// What a snapshot does not know of the game.
#[derive(Clone, Copy, Default)]
pub(crate) struct Player {
    pub(crate) driving: bool,
    pub(crate) grip: Option<Grip>,
    /// Of the last step: what happens once is done when a key goes down.
    pub(crate) last: Actions,
    /// Of frames since: a key that is down in none but these counts too.
    missed: Actions,
    pub(crate) shots: u64,
    gate_until: u64,
}

/// The state to begin again from.
#[derive(Default)]
struct Start {
    bodies: Snapshot,
    characters: SavedCharacters,
    car: VehicleState,
}

pub(crate) struct Game {
    pub(crate) world: World,
    pub(crate) simulation: Simulation,
    pub(crate) yard: Yard,
    pub(crate) player: Player,
    start: Start,
}

impl Game {
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        let mut world = World::new();
        let yard = yard::build(&mut world)?;
        let simulation = Simulation::new(Settings::default())?;
        let mut game = Self { world, simulation, yard, player: Player::default(), start: Start::default() };
        let dt = f64::from(game.simulation.settings().dt);
        while game.simulation.steps() < SETTLE {
            game.update(dt, &Actions::default());
        }
        let (bodies, characters) = (game.simulation.snapshot(&game.world)?, SavedCharacters::capture(&game.world));
        game.start = Start { bodies, characters, car: *game.world.get::<&VehicleState>(game.yard.car)? };
        Ok(game)
    }

    /// A frame: as many fixed steps as fit, each with our systems before it. Returns how far the
    /// frame is past the last.
    pub(crate) fn update(&mut self, seconds: f64, actions: &Actions) -> Real {
        let (yard, player) = (&self.yard, &mut self.player);
        let missed = std::mem::take(&mut player.missed);
        let [shoot_key, use_key] = [actions.shoot || missed.shoot, actions.use_car || missed.use_car];
        let actions = Actions { shoot: shoot_key, use_car: use_key, jump: actions.jump || missed.jump, ..*actions };
        player.missed = actions;
        let seconds = if actions.slow { seconds * SLOW } else { seconds };
        self.simulation.advance_with(&mut self.world, seconds, |world, simulation| {
            player.missed = Actions::default();
            let last = std::mem::replace(&mut player.last, actions);
            if actions.use_car && !last.use_car {
                release(world, player);
                enter_or_leave(world, simulation, yard, player);
            }
            if actions.shoot && !last.shoot && !player.driving {
                shoot(world, simulation, yard, player);
            }
            pull(world, simulation, yard, player, actions.grab && !last.grab && !player.driving);
            walk(world, yard, &actions);
            if player.driving {
                drive(world, yard, &actions);
            }
            work_gate(world, simulation, yard, player);
            run_lifts(world, simulation);
            move_characters(world, simulation);
            drive_vehicles(world, simulation);
        })
    }

    /// Puts everything back: bodies and contacts by the snapshot, and what it does not hold.
    pub(crate) fn restart(&mut self) -> Result<(), Box<dyn Error>> {
        if self.player.driving {
            self.world.insert(self.yard.hero, self.yard.character.at(Vec3::ZERO))?;
        }
        release(&mut self.world, &mut self.player);
        for ball in self.simulation.restore(&self.start.bodies, &mut self.world)? {
            self.world.despawn(ball)?;
        }
        self.start.characters.restore(&mut self.world);
        *self.world.get::<&mut VehicleState>(self.yard.car)? = self.start.car;
        *self.world.get::<&mut VehicleInput>(self.yard.car)? = PARKED;
        self.player = Player::default();
        Ok(())
    }

    /// Where something is between the last two steps.
    pub(crate) fn drawn(&self, entity: Entity, alpha: Real) -> Pose {
        let found = self.world.entity(entity).ok();
        let pose = found.and_then(|it| it.get::<&Pose>()).map_or(Pose::default(), |it| *it);
        let previous = found.and_then(|it| it.get::<&PreviousPose>()).map_or(pose, |it| it.0);
        previous.interpolate(&pose, alpha)
    }

    /// Whether the hero is near enough to the car to enter it.
    pub(crate) fn is_at_car(&self) -> bool {
        !self.player.driving && place(&self.world, self.yard.hero).distance(place(&self.world, self.yard.car)) < DOOR
    }
}

pub(crate) fn place(world: &World, entity: Entity) -> Vec3 {
    world.get::<&Pose>(entity).map_or(Vec3::ZERO, |pose| pose.position)
}

/// Which way somebody looks.
pub(crate) fn direction(yaw: Real, pitch: Real) -> Vec3 {
    Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch) * Vec3::NEG_Z
}

/// Height of the head over the sole \[m\].
pub(crate) fn head_height(crouches: bool) -> Real {
    if crouches { 0.9 } else { 1.6 }
}

/// A character goes on by what is asked of it, relative to the way it looks.
fn walk(world: &World, yard: &Yard, actions: &Actions) {
    let Ok(mut input) = world.get::<&mut CharacterInput>(yard.hero) else { return };
    let speed = if actions.crouch {
        CROUCH
    } else if actions.run {
        RUN
    } else {
        WALK
    };
    let way = Vec3::new(actions.right, 0.0, -actions.ahead).clamp_length_max(1.0);
    input.velocity = Quat::from_rotation_y(actions.yaw) * way * speed;
    (input.jump, input.crouch) = (actions.jump, actions.crouch);
}

/// What is on the plate opens the gate.
fn work_gate(world: &World, simulation: &Simulation, yard: &Yard, player: &mut Player) {
    if simulation.sensed().any(|it| it.sensor == yard.plate) {
        player.gate_until = simulation.steps() + GATE_STEPS;
    }
    if let Ok(mut drives) = world.get::<&mut Drives>(yard.gate_slider) {
        let target = if simulation.steps() < player.gate_until { GATE_WAY } else { 0.0 };
        drives.0.iter_mut().for_each(|drive| drive.position = Some(target));
    }
}

fn run_lifts(world: &mut World, simulation: &Simulation) {
    let (next, dt) = (simulation.steps() + 1, simulation.settings().dt);
    for (lift, pose, velocity) in world.query_mut::<(&Lift, &Pose, &mut Velocity)>() {
        velocity.linear = Vec3::Y * ((lift.height_at(next) - pose.position.y) / dt);
    }
}
