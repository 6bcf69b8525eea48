//! Dock with a tumbling satellite: a game prototype to copy from. `README.md` beside it has the
//! keys.
//!
//! How the game uses tumble is in this file; rules, models and drawing are beside it. What to look
//! for, from top to bottom:
//! - components of our own (`Fuel`, `DockingPort`, ..) stand beside tumble's on the same entities
//!   of one `hecs::World`: `spawn_craft`;
//! - forces live in two ways: `Thruster` and servo push until they are changed or removed
//!   (`steer`), a `Wrench` for one step (`bump`);
//! - two bodies become one, with all their momentum: `dock`;
//! - systems of our own run before each fixed step, however many of them a frame has:
//!   `Game::update`;
//! - a `Snapshot` holds what tumble steps, and what is ours is kept beside it: `Game::save`,
//!   `Game::restore`;
//! - drawing looks between two steps, and changes nothing: `draw_world`.
//!
//! Beside it: `approach.rs` is the rule of the game, `models.rs` what the craft are made of,
//! `screen.rs` macroquad, `options.rs` the command line. Nothing of the game needs a window:
//! `tests.rs` plays it without one, with `pilot.rs` at the keys.

mod approach;
mod models;
mod options;
mod pilot;
mod screen;
#[cfg(test)]
mod tests;

use std::error::Error;

use hecs::{Entity, World};
use macroquad::prelude as mq;
use tumble::batch::Rng;
use tumble::body::{WeldError, weld};
use tumble::prelude::*;
use tumble::step::update_derived;

use approach::{Approach, Craft, Outcome};
use models::{Look, Looks};
use options::Options;

// ---- The game's own components. Of a craft y is forward, x right and z up.

/// What the player flies.
struct Player;
/// What it is to dock with.
struct Target;
/// What is left in the tank \[kg\].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fuel(Real);
/// Where a craft docks, and which way its port looks: from the centre of mass, along the body's
/// axes.
#[derive(Clone, Copy)]
struct DockingPort {
    point: Vec3,
    axis: Vec3,
}
/// One of the small engines: its force \[N\] and place \[m\] in the body's frame, and whether its
/// valve is open.
struct Nozzle {
    force: Vec3,
    point: Vec3,
    open: bool,
}
/// All that a craft has.
struct Nozzles(Vec<Nozzle>);
/// Places it was at, for the dotted line behind it.
#[derive(Default)]
struct Trail(Vec<Vec3>);
/// Scenery in the same world: without `Momentum` and a `Pose` it is no body, and no step looks at
/// it.
struct Star {
    direction: Vec3,
    brightness: f32,
}

const SHIP: BodyId = BodyId(1);
const SATELLITE: BodyId = BodyId(2);
const TANK: Fuel = Fuel(4.0); // [kg], some 20 m/s
const NOZZLE_FORCE: Real = 20.0; // [N]
const NOZZLE_FLOW: Real = 0.01; // [kg/s]
const TURN_RATE: Real = 0.2; // [rad/s], with an assist on
const WHEEL_TORQUE: Real = 150.0; // [N m]
const HULLS: Real = 2.1; // [m], the radii of both hulls together; panels do not touch anything
const HULL_STIFFNESS: Real = 2e4; // [N/m]

/// Names of the levels, and how the satellite spins in each, along its own axes [rad/s]. About z it
/// keeps on, about y, its middle axis, it turns over every seventy seconds.
const LEVELS: [(&str, Vec3); 3] = [
    ("drift", Vec3::new(0.0, 0.003, 0.012)),
    ("tumble", Vec3::new(0.006, 0.01, 0.05)),
    ("flip", Vec3::new(0.03, 0.12, 0.01)),
];

// ---- What a pilot does and sees.

/// What helps the pilot to turn.
#[derive(Clone, Copy, Default, PartialEq)]
enum Assist {
    /// The nozzles alone.
    Off,
    /// Reaction wheels stop every turn, but for those that the keys ask for.
    #[default]
    Hold,
    /// The wheels turn the ship as the satellite turns.
    Match,
}

/// The keys that are down, of a player or of `pilot.rs`: along the ship's axes, -1, 0 or 1.
#[derive(Clone, Copy, Default)]
struct Controls {
    push: Vec3,
    turn: Vec3,
    brake: bool,
    assist: Assist,
}

// ---- Bodies.

/// Both craft at a start: tumble's components and ours on the same entities.
fn spawn_craft(world: &mut World, level: usize, seed: u64) -> Result<(), BodyError> {
    let mut rng = Rng::new(seed);
    let (_, spin) = LEVELS.get(level).copied().unwrap_or_default();
    let attitude = rng.orientation();
    let from_port = (attitude * Vec3::Y + rng.vector(-0.6, 0.6)).normalize();
    let ahead = Quat::from_rotation_arc(Vec3::Y, -from_port);

    let looks = models::satellite();
    let satellite =
        RigidBody::new(models::shape_of(&looks)).id(SATELLITE).orientation(attitude).angular_velocity(attitude * spin);
    let port = DockingPort { point: Vec3::Y, axis: Vec3::Y };
    spawn_body(world, satellite, (Target, port, Looks(looks)))?;

    let looks = models::ship(&nozzles());
    let place = from_port * rng.range(22.0, 30.0);
    let ship = RigidBody::new(models::shape_of(&looks)).id(SHIP).orientation(ahead).position(place);
    let port = DockingPort { point: Vec3::Y * 1.6, axis: Vec3::Y };
    spawn_body(world, ship, (Player, port, Looks(looks), TANK, nozzles(), Thruster::default(), Trail::default()))
}

/// Ballast puts the centre of mass where the drawing has its origin; `interpolated` is for frames
/// between steps.
fn spawn_body(world: &mut World, body: RigidBody, ours: impl hecs::DynamicBundle) -> Result<(), BodyError> {
    body.without_collider().center_of_mass([0.0; 3]).interpolated().build()?.spawn_with(world, ours);
    Ok(())
}

/// Three nozzles on each of eight corners, blowing away from the ship.
fn nozzles() -> Nozzles {
    let corner = |i: u32| Vec3::from_array([1, 2, 4].map(|bit| if i & bit == 0 { -1.0 } else { 1.0 }));
    let mut all = Vec::new();
    for corner in (0..8).map(corner) {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let force = -axis * axis.dot(corner) * NOZZLE_FORCE;
            all.push(Nozzle { force, point: corner * Vec3::new(0.48, 0.6, 0.48), open: false });
        }
    }
    Nozzles(all)
}

// ---- Systems: what happens before a step.

/// Keys to valves and wheels. Both push through this step and all that follow, until they are set
/// otherwise or removed.
fn steer(world: &mut World, controls: &Controls) {
    let (Some(ship), Some(target)) = (Craft::of::<Player>(world), Craft::of::<Target>(world)) else { return };
    let drift = ship.pose.orientation.conjugate() * Approach::of(&ship, &target).drift;
    let push = if controls.brake { -drift.map(|v| key(v, 0.02)) } else { controls.push };
    let turn = if controls.assist == Assist::Off { controls.turn } else { Vec3::ZERO };
    for (nozzles, thruster, fuel) in world.query_mut::<(&mut Nozzles, &mut Thruster, &Fuel)>() {
        *thruster = Thruster::default();
        for nozzle in &mut nozzles.0 {
            let (force, torque) = (nozzle.force.normalize(), nozzle.point.cross(nozzle.force).normalize());
            nozzle.open = fuel.0 > 0.0 && force.dot(push) + torque.dot(turn) > 0.3;
            if nozzle.open {
                *thruster = thruster.and(nozzle.force, nozzle.point);
            }
        }
    }
    let asked = ship.pose.orientation * controls.turn * TURN_RATE;
    let wheels = |target| AngularVelocityServo { target, frame: Frame::World, max_torque: WHEEL_TORQUE };
    // Either fails only where there is nothing to do.
    let _ = match controls.assist {
        Assist::Off => world.remove_one::<AngularVelocityServo>(ship.entity).map(|_| ()).map_err(drop),
        Assist::Hold => world.insert_one(ship.entity, wheels(asked)).map_err(drop),
        Assist::Match => world.insert_one(ship.entity, wheels(target.velocity.angular + asked)).map_err(drop),
    };
}

/// A key for a number: which way, unless it is small.
fn key(value: Real, small: Real) -> Real {
    if value.abs() > small { value.signum() } else { 0.0 }
}

fn burn_fuel(world: &mut World, dt: Real) {
    for (nozzles, fuel) in world.query_mut::<(&Nozzles, &mut Fuel)>() {
        let open = nozzles.0.iter().filter(|nozzle| nozzle.open).count();
        fuel.0 = (fuel.0 - open as Real * NOZZLE_FLOW * dt).max(0.0);
    }
}

/// Hulls that meet push each other off: a force of this one step, added again before the next if
/// they still touch.
fn bump(world: &mut World) {
    let (Some(ship), Some(target)) = (Craft::of::<Player>(world), Craft::of::<Target>(world)) else { return };
    let apart = ship.pose.position - target.pose.position;
    let force = apart.normalize_or_zero() * (HULLS - apart.length()).max(0.0) * HULL_STIFFNESS;
    let touch = target.pose.position + apart * 0.5;
    for (craft, force) in [(ship, force), (target, -force)] {
        if let Ok(mut wrench) = world.get::<&mut Wrench>(craft.entity) {
            wrench.add_force_at(force, touch, craft.pose.position);
        }
    }
}

/// Every third of a second a dot, of which the last two hundred stay.
fn leave_trail(world: &mut World, step: u64) {
    for (trail, pose) in world.query_mut::<(&mut Trail, &Pose)>().into_iter().filter(|_| step.is_multiple_of(20)) {
        trail.0.push(pose.position);
        let old = trail.0.len().saturating_sub(200);
        trail.0.drain(..old);
    }
}

/// One body in the place of two, unless that is done: in the frame of the satellite, with the
/// linear and angular momentum of both.
fn dock(world: &mut World) -> Result<(), WeldError> {
    let (Some(ship), Some(target)) = (Craft::of::<Player>(world), Craft::of::<Target>(world)) else { return Ok(()) };
    let pair = weld(world, &[target.entity, ship.entity])?;
    let mut looks = Vec::new();
    for craft in [target, ship] {
        let own = world.remove_one::<Looks>(craft.entity).map_or_else(|_| Vec::new(), |looks| looks.0);
        let to_target = target.pose.inverse() * craft.pose;
        looks.extend(own.into_iter().map(|look| Look { pose: to_target * look.pose, ..look }));
        // An entity that was found a moment ago is there.
        let _ = world.despawn(craft.entity);
    }
    pair.spawn_with(world, (Looks(looks),));
    Ok(())
}

// ---- The game: a world, a simulation, and how it stands.

/// What a flight goes on from: tumble's state and ours.
struct Saved {
    bodies: Snapshot,
    fuel: Fuel,
}

struct Game {
    world: World,
    simulation: Simulation,
    level: usize,
    seed: u64,
    outcome: Outcome,
}

impl Game {
    fn new(level: usize, seed: u64) -> Result<Self, Box<dyn Error>> {
        let mut world = World::new();
        spawn_craft(&mut world, level, seed)?;
        let mut rng = Rng::new(1);
        for _ in 0..500 {
            let direction = rng.orientation() * Vec3::X;
            world.spawn((Star { direction, brightness: rng.unit().powi(3) as f32 },));
        }
        let simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO))?;
        Ok(Self { world, simulation, level, seed, outcome: Outcome::Flying })
    }

    /// A frame: as many fixed steps as fit, each with our systems before it. Returns how far the
    /// frame is past the last.
    fn update(&mut self, frame_seconds: f64, mut pilot: impl FnMut(&World) -> Controls) -> Real {
        let (outcome, dt) = (&mut self.outcome, self.simulation.settings().dt);
        self.simulation.advance_with(&mut self.world, frame_seconds, |world, simulation| {
            *outcome = approach::judge(world, outcome);
            if *outcome == Outcome::Docked {
                dock(world).unwrap_or_else(|error| *outcome = Outcome::Missed(error.to_string()));
            }
            let controls = pilot(world);
            steer(world, &controls);
            burn_fuel(world, dt);
            bump(world);
            leave_trail(world, simulation.steps());
        })
    }

    /// Between steps, and before they are docked: a pair would have to be taken apart again.
    fn save(&self) -> Result<Saved, Box<dyn Error>> {
        let bodies = Snapshot::capture(&self.world)?.with_clock(self.simulation.clock());
        let fuel = self.world.query::<&Fuel>().iter().next().copied().unwrap_or(Fuel(0.0));
        Ok(Saved { bodies, fuel })
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Box<dyn Error>> {
        // A snapshot is no body: those that were welded are spawned again, in whatever state.
        if self.outcome == Outcome::Docked {
            let pair: Vec<Entity> =
                self.world.query_mut::<(Entity, &BodyId)>().into_iter().map(|(pair, _)| pair).collect();
            pair.into_iter().try_for_each(|pair| self.world.despawn(pair))?;
            spawn_craft(&mut self.world, self.level, self.seed)?;
        }
        saved.bodies.restore(&mut self.world)?;
        saved.bodies.clock().into_iter().for_each(|clock| self.simulation.set_clock(clock));
        // Our systems look at velocities before the next step makes them.
        update_derived(&mut self.world);
        for (fuel, trail) in self.world.query_mut::<(&mut Fuel, &mut Trail)>() {
            (*fuel, *trail) = (saved.fuel, Trail::default());
        }
        self.outcome = Outcome::Flying;
        Ok(())
    }
}

// ---- Drawing and keys.

/// Bodies where they are between the last step and the one before.
fn draw_world(world: &World, alpha: Real, camera: &mq::Camera3D) {
    screen::draw_sky(world.query::<&Star>().iter().map(|star| (star.direction, star.brightness)), camera);
    for (pose, previous, center, looks) in world.query::<(&Pose, &PreviousPose, Option<&CenterOfMass>, &Looks)>().iter()
    {
        // A pose is that of the centre of mass, which a pair does not have where the drawing has
        // its origin.
        let between = previous.0.interpolate(pose, alpha);
        let body = Pose { position: between.origin(center), ..between };
        looks.0.iter().for_each(|look| screen::draw_look(look, body.to_mat4()));
    }
    world.query::<&Trail>().iter().for_each(|trail| screen::draw_trail(&trail.0));
    for (pose, previous, nozzles) in world.query::<(&Pose, &PreviousPose, &Nozzles)>().iter() {
        let body = previous.0.interpolate(pose, alpha).to_mat4();
        nozzles.0.iter().filter(|nozzle| nozzle.open).for_each(|nozzle| screen::draw_plume(nozzle, body));
    }
    mq::set_default_camera();
}

/// What the keys ask for; the assist stays until another is chosen.
fn keyboard(assist: &mut Assist) -> Controls {
    use mq::KeyCode::{A, C, D, Down, E, H, Left, M, Q, Right, S, Up, W, X, Z};
    let axis = |more, less| Real::from(i8::from(mq::is_key_down(more)) - i8::from(mq::is_key_down(less)));
    for (key, kind) in [(H, Assist::Hold), (M, Assist::Match)] {
        if mq::is_key_pressed(key) {
            *assist = if *assist == kind { Assist::Off } else { kind };
        }
    }
    let push = Vec3::new(axis(D, A), axis(W, S), axis(E, Q));
    let turn = Vec3::new(axis(Up, Down), axis(C, Z), axis(Left, Right));
    Controls { push, turn, brake: mq::is_key_down(X), assist: *assist }
}

/// Keys that are no part of a flight. Returns whether to go on.
fn menu(game: &mut Game, kept: &mut Saved, start: &mut Saved, autopilot: &mut bool) -> Result<bool, Box<dyn Error>> {
    use mq::KeyCode::{Backspace, Escape, K, Key1, Key2, Key3, L, N, P};
    let flown = |game: &Game| game.outcome != Outcome::Docked;
    let pressed = [P, Backspace, K, L, Key1, Key2, Key3, N].into_iter().filter(|key| mq::is_key_pressed(*key));
    for key in pressed {
        match key {
            P => *autopilot = !*autopilot,
            Backspace => game.restore(start)?,
            K if flown(game) => *kept = game.save()?,
            L => game.restore(kept)?,
            Key1 | Key2 | Key3 | N => {
                let level = [Key1, Key2, Key3].iter().position(|one| *one == key);
                *game = Game::new(level.unwrap_or(game.level), game.seed.wrapping_add(u64::from(key == N)))?;
                (*start, *kept) = (game.save()?, game.save()?);
            }
            _ => {}
        }
    }
    Ok(!mq::is_key_pressed(Escape))
}

async fn play(options: Options) -> Result<(), Box<dyn Error>> {
    let mut game = Game::new(options.level, options.seed)?;
    let (mut start, mut kept) = (game.save()?, game.save()?);
    let (mut assist, mut autopilot, mut view) = (Assist::default(), options.autopilot, screen::Follow::default());
    while menu(&mut game, &mut kept, &mut start, &mut autopilot)? {
        let controls = keyboard(&mut assist);
        let fly = |world: &World| if autopilot { pilot::fly(world) } else { controls };
        let (mut frame, mut alpha) = (f64::from(mq::get_frame_time()), 1.0);
        if options.screenshot.is_some() {
            frame = 1.0 / 60.0;
            while game.simulation.time() < options.at {
                game.update(frame, pilot::fly);
                view.camera(&game.world, 1.0, frame as f32);
            }
        } else {
            alpha = game.update(frame, fly);
        }
        let camera = view.camera(&game.world, alpha, frame as f32);
        draw_world(&game.world, alpha, &camera);
        screen::draw_instruments(&game, if autopilot { Assist::Match } else { assist }, &camera);
        if let Some(file) = &options.screenshot {
            return screen::save_picture(file);
        }
        mq::next_frame().await;
    }
    Ok(())
}

fn main() {
    let options = Options::of_process();
    // Where there is no display, what opens the window panics.
    if cfg!(target_os = "linux") && ["DISPLAY", "WAYLAND_DISPLAY"].iter().all(|name| std::env::var_os(name).is_none()) {
        eprintln!("docking: no window can be opened: neither DISPLAY nor WAYLAND_DISPLAY is set");
        std::process::exit(1);
    }
    macroquad::Window::from_config(screen::window(), async {
        if let Err(error) = play(options).await {
            eprintln!("docking: {error}");
            std::process::exit(1);
        }
    });
}
