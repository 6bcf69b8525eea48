//! A stage for characters: a world, what stands in it, and how it is played.
#![allow(
    dead_code,
    unreachable_pub,
    clippy::unwrap_used,
    reason = "each test takes what it needs, and fails without it"
)]

use tumble::hecs::{Entity, World};
use tumble::prelude::*;
use tumble_character::{
    Character, CharacterInput, CharacterSettings, CharacterState, CharacterTouches, move_characters,
};

/// The height of most characters [m].
pub const HEIGHT: Real = 1.8;

pub struct Stage {
    pub world: World,
    pub simulation: Simulation,
}

/// What was seen of a character in a step.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    pub position: Vec3,
    pub state: CharacterState,
}

impl Stage {
    /// An empty stage, with this number of steps a second.
    pub fn new(rate: u32) -> Self {
        let settings = Settings::default().with_dt(1.0 / rate as Real);
        Self { world: World::new(), simulation: Simulation::new(settings).unwrap() }
    }

    /// A stage with the ground y = 0.
    pub fn with_ground(rate: u32) -> Self {
        let mut stage = Self::new(rate);
        spawn_ground(&mut stage.world);
        stage
    }

    pub fn dt(&self) -> Real {
        self.simulation.settings().dt
    }

    pub fn block(&mut self, center: Vec3, half: Vec3) -> Entity {
        self.turned_block(center, half, Quat::IDENTITY)
    }

    pub fn turned_block(&mut self, center: Vec3, half: Vec3, orientation: Quat) -> Entity {
        let body = RigidBody::new(cuboid(half)).fixed().position(center).orientation(orientation);
        body.build().unwrap().spawn(&mut self.world)
    }

    /// A plane that rises along x by an angle, from the origin on, as the top of a thick block.
    pub fn slope(&mut self, angle: Real, width: Real) -> Entity {
        let turn = Quat::from_rotation_z(angle);
        let half = Vec3::new(200.0, 1.0, width);
        self.turned_block(turn * -Vec3::Y, half, turn)
    }

    pub fn mover(&mut self, center: Vec3, half: Vec3, velocity: Velocity) -> Entity {
        let body = RigidBody::new(cuboid(half)).kinematic().position(center);
        let body = body.linear_velocity(velocity.linear).angular_velocity(velocity.angular);
        body.build().unwrap().spawn(&mut self.world)
    }

    pub fn dynamic(&mut self, center: Vec3, half: Vec3, mass: f64) -> Entity {
        let body = RigidBody::new(cuboid(half)).mass(mass).position(center);
        body.build().unwrap().spawn(&mut self.world)
    }

    pub fn mesh(&mut self, vertices: &[Vec3], triangles: &[[u32; 3]]) -> Entity {
        let collider = tumble::Collider::mesh(vertices.iter().map(|it| tumble::math::dvec3(*it)), triangles).unwrap();
        self.world.spawn((Pose::default(), collider))
    }

    pub fn hero(&mut self, position: Vec3) -> Entity {
        self.character(CharacterSettings::of_height(HEIGHT), position)
    }

    pub fn character(&mut self, settings: CharacterSettings, position: Vec3) -> Entity {
        self.world.spawn(Character::new(settings).unwrap().at(position))
    }

    pub fn steer(&mut self, hero: Entity, velocity: Vec3) {
        self.world.get::<&mut CharacterInput>(hero).unwrap().velocity = velocity;
    }

    pub fn input(&mut self, hero: Entity, input: CharacterInput) {
        *self.world.get::<&mut CharacterInput>(hero).unwrap() = input;
    }

    pub fn step(&mut self) {
        move_characters(&mut self.world, &self.simulation);
        self.simulation.step(&mut self.world);
    }

    /// Plays for a time [s] and returns what was seen after each step.
    pub fn play(&mut self, hero: Entity, seconds: Real) -> Vec<Seen> {
        let steps = (seconds / self.dt()).round() as usize;
        let step = |_| {
            self.step();
            self.seen(hero)
        };
        (0..steps).map(step).collect()
    }

    pub fn seen(&self, hero: Entity) -> Seen {
        Seen { position: self.position(hero), state: *self.world.get::<&CharacterState>(hero).unwrap() }
    }

    pub fn position(&self, body: Entity) -> Vec3 {
        self.world.get::<&Pose>(body).unwrap().position
    }

    pub fn velocity(&self, body: Entity) -> Vec3 {
        self.world.get::<&Velocity>(body).unwrap().linear
    }

    pub fn touches(&self, hero: Entity) -> CharacterTouches {
        *self.world.get::<&CharacterTouches>(hero).unwrap()
    }

    pub fn set_velocity(&mut self, body: Entity, velocity: Velocity) {
        *self.world.get::<&mut Velocity>(body).unwrap() = velocity;
    }
}

pub fn cuboid(half: Vec3) -> Shape {
    Shape::cuboid(tumble::math::dvec3(half).to_array())
}

/// Those step rates at which all is to be the same.
pub const RATES: [u32; 5] = [10, 30, 60, 120, 240];
