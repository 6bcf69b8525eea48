//! The game without its window: what the player does, and what happens before each step.

use std::error::Error;

use hecs::{Entity, World};
use tumble::prelude::*;
use tumble_character::{Character, CharacterInput, CharacterState, SavedCharacters, move_characters};
use tumble_vehicle::{VehicleInput, VehicleState, drive_vehicles};

use crate::yard::{self, GATE_WAY, Lift, Look, Yard};

const WALK: Real = 3.0; // [m/s]
const RUN: Real = 6.0;
const CROUCH: Real = 1.5;
const BALL: Real = 0.15; // [m], 4 kg
const BALL_SPEED: Real = 24.0; // [m/s]
const MAX_BALLS: usize = 60;
/// How far the hand reaches, and a car's door \[m\].
const REACH: Real = 12.0;
const DOOR: Real = 3.0;
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

/// What was shot, and in which step.
pub(crate) struct Ball(u64);

/// What the hand holds: the joint, the body, where on it, and how far away \[m\].
#[derive(Clone, Copy)]
pub(crate) struct Grip {
    joint: Entity,
    pub(crate) body: Entity,
    pub(crate) local: Vec3,
    reach: Real,
}

/// What a snapshot does not know of the game.
#[derive(Clone, Copy, Default)]
pub(crate) struct Player {
    pub(crate) driving: bool,
    pub(crate) grip: Option<Grip>,
    /// Of the last step: what happens once is done when a key goes down.
    last: Actions,
    shots: u64,
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
        let seconds = if actions.slow { seconds * SLOW } else { seconds };
        self.simulation.advance_with(&mut self.world, seconds, |world, simulation| {
            let last = std::mem::replace(&mut player.last, *actions);
            if actions.use_car && !last.use_car {
                enter_or_leave(world, simulation, yard, player);
            }
            if actions.shoot && !last.shoot && !player.driving {
                shoot(world, simulation, yard, player, actions);
            }
            pull(world, simulation, yard, player, actions.grab && !last.grab);
            if player.driving {
                drive(world, yard, actions)
            } else {
                walk(world, yard, actions)
            }
            work_gate(world, simulation, yard, player);
            run_lifts(world, simulation);
            move_characters(world, simulation);
            drive_vehicles(world, simulation);
        })
    }

    /// Puts everything back: bodies and contacts from the snapshot, what it does not hold beside it.
    pub(crate) fn restart(&mut self) -> Result<(), Box<dyn Error>> {
        if self.player.driving {
            self.world.insert(self.yard.hero, self.yard.character.at(Vec3::ZERO))?;
        }
        if let Some(grip) = self.player.grip {
            self.world.despawn(grip.joint)?;
        }
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

pub(crate) const PARKED: VehicleInput = VehicleInput { throttle: 0.0, brake: 0.0, hand_brake: 1.0, steering: 0.0 };

pub(crate) fn place(world: &World, entity: Entity) -> Vec3 {
    world.get::<&Pose>(entity).map_or(Vec3::ZERO, |pose| pose.position)
}

/// Which way somebody looks.
pub(crate) fn direction(yaw: Real, pitch: Real) -> Vec3 {
    Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch) * Vec3::NEG_Z
}

/// Where the hero looks from, shoots and holds: beside its head, but not through a wall.
pub(crate) fn shoulder(queries: &Queries<'_>, yard: &Yard, head: Vec3, yaw: Real) -> Vec3 {
    let side = Quat::from_rotation_y(yaw) * Vec3::X;
    let ray = Ray::new(head, side).with_max_distance(0.75);
    let room = queries.cast_ray(&ray, &QueryFilter::new().without(yard.hero)).map_or(0.75, |hit| hit.distance);
    head + side * (room - 0.2).max(0.0)
}

/// The head of the hero over its sole.
fn head(world: &World, yard: &Yard) -> Vec3 {
    let crouches = world.get::<&CharacterState>(yard.hero).is_ok_and(|state| state.is_crouching);
    place(world, yard.hero) + Vec3::Y * head_height(crouches)
}

pub(crate) fn head_height(crouches: bool) -> Real {
    if crouches { 0.9 } else { 1.6 }
}

fn aim(world: &World, queries: &Queries<'_>, yard: &Yard, actions: &Actions) -> (Vec3, Vec3) {
    (shoulder(queries, yard, head(world, yard), actions.yaw), direction(actions.yaw, actions.pitch))
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

/// The hero is where the car is, and has no collider.
fn drive(world: &World, yard: &Yard, actions: &Actions) {
    let Ok(chassis) = world.entity(yard.car) else { return };
    let (Some(pose), Some(velocity)) = (chassis.get::<&Pose>(), chassis.get::<&Velocity>()) else { return };
    let speed = velocity.linear.dot(pose.orientation * Vec3::Z);
    let against = actions.ahead * speed < 0.0 && speed.abs() > 1.0;
    if let Some(mut input) = chassis.get::<&mut VehicleInput>() {
        input.throttle = if against { 0.0 } else { actions.ahead };
        input.brake = if against { 1.0 } else { 0.0 };
        input.hand_brake = if actions.jump { 1.0 } else { 0.0 };
        // Less at speed, as a driver would.
        input.steering = -actions.right / (1.0 + speed.abs() / 12.0);
    }
    if let Ok((seat, moves)) = world.query_one::<(&mut Pose, &mut Velocity)>(yard.hero).get() {
        (*seat, *moves) = (Pose::at(pose.position), Velocity::default());
    }
}

fn enter_or_leave(world: &mut World, simulation: &Simulation, yard: &Yard, player: &mut Player) {
    if player.driving {
        let Some(out) = beside_car(world, simulation, yard) else { return };
        let hero = (yard.character.at(out), PreviousPose(Pose::at(out)));
        player.driving = world.insert(yard.hero, hero.0).and_then(|()| world.insert_one(yard.hero, hero.1)).is_err();
        if let Ok(mut input) = world.get::<&mut VehicleInput>(yard.car) {
            *input = PARKED;
        }
    } else if place(world, yard.hero).distance(place(world, yard.car)) < DOOR {
        release(world, player);
        player.driving = world.remove::<(Character, Collider)>(yard.hero).is_ok();
    }
}

/// Room to stand beside the car.
fn beside_car(world: &World, simulation: &Simulation, yard: &Yard) -> Option<Vec3> {
    let car = *world.get::<&Pose>(yard.car).ok()?;
    let standing = yard.character.at(Vec3::ZERO).2;
    let (queries, filter) = (simulation.queries(world), QueryFilter::new().without(yard.car));
    [Vec3::X, Vec3::NEG_X, Vec3::NEG_Z, Vec3::Z].into_iter().find_map(|side| {
        let out = car.orientation * side * if side.x == 0.0 { 2.4 } else { 1.25 };
        let blocked = queries.is_blocked(&Ray::new(car.position, out).with_max_distance(out.length()), &filter);
        let below = queries.cast_ray(&Ray::new(car.position + out + Vec3::Y * 0.5, Vec3::NEG_Y), &filter)?;
        let sole = below.point + Vec3::Y * 0.02;
        let free = queries.overlapping(&standing, &Pose::at(sole), &QueryFilter::new()).is_empty();
        (free && !blocked).then_some(sole)
    })
}

/// A ball leaves as far ahead of the shoulder as there is room, and the oldest go.
fn shoot(world: &mut World, simulation: &Simulation, yard: &Yard, player: &mut Player, actions: &Actions) {
    let queries = simulation.queries(world);
    let (from, way) = aim(world, &queries, yard, actions);
    let ahead = Ray::new(from, way).with_max_distance(0.7);
    let room = queries.cast_ray(&ahead, &QueryFilter::new().without(yard.hero)).map_or(0.7, |hit| hit.distance);
    drop(queries);
    let body = RigidBody::new(Shape::sphere(BALL)).mass(4.0).material(Material::default().with_restitution(0.3));
    let body = body.position(from + way * (room - 0.2).max(0.0)).linear_velocity(way * BALL_SPEED).interpolated();
    let Ok(body) = body.id(BodyId(yard.next_id + player.shots)).build() else { return };
    let look = Look::of(Shape::sphere(BALL), [0.95, 0.75, 0.15]);
    body.spawn_with(world, (Ball(player.shots), look));
    player.shots += 1;
    let spent = |ball: &Ball| ball.0 + (MAX_BALLS as u64) < player.shots;
    let old: Vec<Entity> =
        world.query::<(Entity, &Ball)>().iter().filter(|(_, ball)| spent(ball)).map(|(it, _)| it).collect();
    for ball in old {
        if player.grip.is_some_and(|grip| grip.body == ball) {
            release(world, player);
        }
        // It was found a moment ago.
        let _ = world.despawn(ball);
    }
}

/// The hand is where the hero looks; a spring pulls what it holds there.
fn pull(world: &mut World, simulation: &Simulation, yard: &Yard, player: &mut Player, takes: bool) {
    let actions = player.last;
    let queries = simulation.queries(world);
    let (from, way) = aim(world, &queries, yard, &actions);
    let ray = Ray::new(from, way).with_max_distance(REACH);
    let hit = queries.cast_ray(&ray, &QueryFilter::new().without(yard.hero));
    drop(queries);
    // Who stands on what it holds would lift itself.
    let ground = world.get::<&CharacterState>(yard.hero).ok().and_then(|state| state.ground_entity);
    if player.grip.is_some_and(|grip| !actions.grab || ground == Some(grip.body)) {
        release(world, player);
    }
    if takes
        && !player.driving
        && let Some(hit) = hit.filter(|hit| world.satisfies::<&Momentum>(hit.entity) && ground != Some(hit.entity))
        && let Ok(local) = world.get::<&Pose>(hit.entity).map(|pose| pose.inverse_transform_point(hit.point))
    {
        let joint = Joint::free(yard.hand, hit.entity).with_frames(Pose::default(), Pose::at(local));
        let spring = Drive::position(Axes::LINEAR, 0.0).with_frequency(2.0, 1.0).with_max_force(600.0);
        let calm = Drive::velocity(Axes::ANGULAR, 0.0).with_acceleration(0.0, 3.0);
        let joint = world.spawn((joint, Drives(vec![spring, calm])));
        player.grip = Some(Grip { joint, body: hit.entity, local, reach: hit.distance });
        if let Ok(mut hand) = world.get::<&mut Pose>(yard.hand) {
            hand.position = hit.point;
        }
    }
    let dt = simulation.settings().dt;
    if let (Some(grip), Ok((hand, velocity))) = (player.grip, world.query_one_mut::<(&Pose, &mut Velocity)>(yard.hand))
    {
        let target = from + way * grip.reach;
        velocity.linear = ((target - hand.position) / dt).clamp_length_max(15.0);
    } else if let Ok(mut velocity) = world.get::<&mut Velocity>(yard.hand) {
        *velocity = Velocity::default();
    }
}

fn release(world: &mut World, player: &mut Player) {
    if let Some(grip) = player.grip.take() {
        // The joint is there as long as the grip is.
        let _ = world.despawn(grip.joint);
    }
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
