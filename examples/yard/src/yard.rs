//! The level: what stands in the yard, and the components of our own beside tumble's.

use std::error::Error;

use hecs::{Entity, World};
use tumble::prelude::*;
use tumble_character::{Character, CharacterSettings};
use tumble_import::Tessellation;
use tumble_vehicle::{VehicleInput, VehiclePlan};

/// From the middle of the yard to its walls \[m\].
pub(crate) const YARD: Real = 18.0;
/// How far the gate slides \[m\].
pub(crate) const GATE_WAY: Real = 4.4;
/// Where the player stands at the beginning.
const START: Vec3 = Vec3::new(0.0, 0.0, 14.0);

const STONE: [f32; 3] = [0.62, 0.64, 0.68];
const WALL: [f32; 3] = [0.80, 0.76, 0.68];
const STEEL: [f32; 3] = [0.36, 0.40, 0.46];
const BLUE: [f32; 3] = [0.20, 0.50, 0.80];
const RED: [f32; 3] = [0.84, 0.26, 0.20];
pub(crate) const YELLOW: [f32; 3] = [0.95, 0.75, 0.15];
const WOOD: [[f32; 3]; 2] = [[0.86, 0.62, 0.32], [0.76, 0.50, 0.24]];

// ---- Components.

/// A part of what an entity looks like, from the origin of its body.
#[derive(Clone)]
pub(crate) struct Piece {
    pub(crate) pose: Pose,
    pub(crate) surface: Tessellation,
    pub(crate) color: [f32; 3],
}
/// What an entity looks like.
#[derive(Clone)]
pub(crate) struct Look(pub(crate) Vec<Piece>);
impl Look {
    pub(crate) fn of(shape: &Shape, color: [f32; 3]) -> Self {
        Self(Vec::new()).and(shape, Vec3::ZERO, color)
    }
    /// A crate: a frame, and panels that stand out of it by a millimetre.
    fn framed(half: f64, [r, g, b]: [f32; 3]) -> Self {
        let (out, inner) = (half + 0.001, half * 0.8);
        let panels = [[out, inner, inner], [inner, out, inner], [inner, inner, out]];
        let frame = Self::of(&Shape::cuboid([half; 3]), [r * 0.8, g * 0.8, b * 0.8]);
        panels.into_iter().fold(frame, |look, it| look.and(&Shape::cuboid(it), Vec3::ZERO, [r, g, b]))
    }
    fn and(mut self, shape: &Shape, at: Vec3, color: [f32; 3]) -> Self {
        self.0.push(Piece { pose: Pose::at(at), surface: Tessellation::of(shape), color });
        self
    }
}
/// A platform that goes up and down between two heights, and waits at both.
pub(crate) struct Lift {
    low: Real,
    high: Real,
    /// There and back, in steps.
    period: u64,
}
impl Lift {
    pub(crate) fn height_at(&self, step: u64) -> Real {
        let phase = (step % self.period) as Real / self.period as Real;
        let way = ((1.0 - (2.0 * phase - 1.0).abs()) * 2.0 - 0.5).clamp(0.0, 1.0);
        self.low + (self.high - self.low) * way * way * (3.0 - 2.0 * way)
    }
}

// ---- The level.

/// The entities that the game asks for by name, and what it makes more of.
pub(crate) struct Yard {
    pub(crate) hero: Entity,
    /// To be put on the hero again when it leaves the car.
    pub(crate) character: Character,
    /// What the hero pulls with: a point without a collider.
    pub(crate) hand: Entity,
    pub(crate) car: Entity,
    pub(crate) plate: Entity,
    pub(crate) gate_slider: Entity,
    /// The first `BodyId` that is free for balls.
    pub(crate) next_id: u64,
}

/// Spawns bodies with looks and ids.
struct Builder<'a> {
    world: &'a mut World,
    next_id: u64,
}

pub(crate) fn build(world: &mut World) -> Result<Yard, Box<dyn Error>> {
    let mut builder = Builder { world, next_id: 1 };
    builder.walls()?;
    builder.stairs()?;
    let post = builder.garage()?;
    builder.door(post)?;
    let gate_slider = builder.gate(post)?;
    let plate = builder.plate()?;
    builder.lift()?;
    builder.carousel()?;
    builder.weight()?;
    builder.stacks()?;
    let car = builder.car()?;
    let (hero, character, hand) = builder.hero()?;
    let next_id = builder.next_id;
    Ok(Yard { hero, character, hand, car, plate, gate_slider, next_id })
}

impl Builder<'_> {
    fn id(&mut self) -> BodyId {
        self.next_id += 1;
        BodyId(self.next_id - 1)
    }

    fn add(&mut self, body: RigidBody, look: Look) -> Result<Entity, BodyError> {
        let body = body.id(self.id()).interpolated().build()?;
        Ok(body.spawn_with(self.world, (look,)))
    }

    /// A block that does not move: half extents, and where.
    fn block(&mut self, half: [Real; 3], at: Pose, color: [f32; 3]) -> Result<Entity, BodyError> {
        let shape = Shape::cuboid(half.map(f64::from));
        let body = RigidBody::new(shape.clone()).fixed().position(at.position).orientation(at.orientation);
        Ok(body.build()?.spawn_with(self.world, (Look::of(&shape, color),)))
    }

    /// Something loose.
    fn loose(&mut self, shape: &Shape, mass: f64, at: Vec3, color: [f32; 3]) -> Result<Entity, BodyError> {
        self.add(RigidBody::new(shape.clone()).mass(mass).position(at), Look::of(shape, color))
    }

    /// The ground, and four half-spaces that nothing gets over; the walls are what is seen.
    fn walls(&mut self) -> Result<(), BodyError> {
        spawn_ground(self.world);
        for out in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
            let inwards = Quat::from_rotation_arc(Vec3::Y, -out);
            RigidBody::ground().position(out * YARD).orientation(inwards).build()?.spawn(self.world);
            let half = Vec3::new(0.2, 1.0, YARD + 0.4);
            let half = if out.x == 0.0 { Vec3::new(half.z, half.y, half.x) } else { half };
            let look = Look::of(&Shape::cuboid(half.to_array().map(f64::from)), WALL);
            self.world.spawn((Pose::at(out * (YARD + 0.2) + Vec3::Y), look));
        }
        Ok(())
    }

    /// A deck with a stair and a slope.
    fn stairs(&mut self) -> Result<(), BodyError> {
        self.block([2.0, 1.0, 2.0], Pose::at(Vec3::new(-14.0, 1.0, 2.0)), STONE)?;
        for i in 0..7_u8 {
            let i = Real::from(i);
            let half = 0.125 * (i + 1.0);
            self.block([0.2, half, 1.2], Pose::at(Vec3::new(-9.4 - 0.4 * i, half, 2.8)), STONE)?;
        }
        let down = Quat::from_rotation_x(0.436);
        let (length, top) = (2.0 / (0.436 as Real).sin(), Vec3::new(-14.0, 1.0, 4.0 + 1.0 / (0.436 as Real).tan()));
        let at = Pose { position: top - down * Vec3::Y * 0.1, orientation: down };
        self.block([1.2, 0.1, 0.5 * length], at, STONE)?;
        Ok(())
    }

    /// Walls of a room in the corner with two openings; returns the post of the door and gate.
    fn garage(&mut self) -> Result<Entity, BodyError> {
        self.block([0.15, 1.3, 2.2], Pose::at(Vec3::new(8.0, 1.3, 15.8)), WALL)?;
        self.block([0.15, 0.2, 0.6], Pose::at(Vec3::new(8.0, 2.4, 13.0)), WALL)?;
        self.block([2.575, 1.3, 0.15], Pose::at(Vec3::new(10.425, 1.3, 8.0)), WALL)?;
        self.block([0.3, 1.3, 0.15], Pose::at(Vec3::new(17.7, 1.3, 8.0)), WALL)?;
        self.block([0.15, 1.3, 2.125], Pose::at(Vec3::new(8.0, 1.3, 10.275)), WALL)
    }

    /// A door that is pushed open either way and closes itself.
    fn door(&mut self, post: Entity) -> Result<(), Box<dyn Error>> {
        let door = self.loose(&Shape::cuboid([0.04, 1.05, 0.56]), 25.0, Vec3::new(8.0, 1.08, 13.0), BLUE)?;
        let hinge = Joint::hinge(post, door).at(self.world, Vec3::new(8.0, 1.08, 12.42), Vec3::Y)?;
        let limits = Limits::along(Axes::ANGULAR_X, Limit::new(-1.7, 1.7).with_frequency(3.0, 0.7));
        let closer = Drive::position(Axes::ANGULAR_X, 0.0).with_stiffness(12.0, 14.0);
        self.world.spawn((hinge, limits, Drives::from(closer)));
        Ok(())
    }

    /// A gate on a slider; returns the slider.
    fn gate(&mut self, post: Entity) -> Result<Entity, Box<dyn Error>> {
        let place = Vec3::new(15.2, 1.22, 8.27);
        let gate = self.loose(&Shape::cuboid([2.3, 1.18, 0.06]), 90.0, place, STEEL)?;
        let slider = Joint::slider(post, gate).at(self.world, place, Vec3::NEG_X)?;
        let motor = Drive::position(Axes::LINEAR_X, 0.0).with_frequency(0.5, 1.0).with_max_force(900.0);
        Ok(self.world.spawn((slider, Drives::from(motor))))
    }

    /// A sensor on the ground, with a plate to be seen.
    fn plate(&mut self) -> Result<Entity, BodyError> {
        let body = RigidBody::new(Shape::cuboid([1.2, 0.1, 1.2])).fixed().sensor().position(Vec3::new(15.0, 0.1, 11.0));
        let look = Look(Vec::new()).and(&Shape::cuboid([1.2, 0.02, 1.2]), Vec3::Y * -0.09, RED);
        Ok(body.build()?.spawn_with(self.world, (look,)))
    }

    fn lift(&mut self) -> Result<(), Box<dyn Error>> {
        let lift = Lift { low: 0.12, high: 1.9, period: 600 };
        let shape = Shape::cuboid([1.0, 0.1, 1.0]);
        let at = Vec3::new(-14.0, lift.low, -1.05);
        let entity = self.add(RigidBody::new(shape.clone()).kinematic().position(at), Look::of(&shape, RED))?;
        self.world.insert_one(entity, lift)?;
        Ok(())
    }

    fn carousel(&mut self) -> Result<(), BodyError> {
        let body = RigidBody::new(Shape::cylinder(1.8, 0.1)).kinematic().position(Vec3::new(-6.0, 0.12, 8.0));
        let look = Look::of(&Shape::cylinder(1.8, 0.1), BLUE);
        let look = look.and(&Shape::cuboid([1.7, 0.01, 0.1]), Vec3::Y * 0.1, [0.9; 3]);
        self.add(body.angular_velocity(Vec3::Y * 0.7), look)?;
        Ok(())
    }

    /// A heavy ball on a chain.
    fn weight(&mut self) -> Result<(), Box<dyn Error>> {
        let top = Vec3::new(-8.0, 4.5, -9.0);
        self.block([0.12, 2.3, 0.12], Pose::at(Vec3::new(-8.0, 2.3, -11.5)), STEEL)?;
        let beam = self.block([0.12, 0.12, 1.5], Pose::at(Vec3::new(-8.0, 4.6, -10.2)), STEEL)?;
        let (mut above, mut at) = (beam, top);
        for _ in 0..7 {
            let link = self.loose(&Shape::capsule(0.05, 0.15), 1.5, at - Vec3::Y * 0.2, STEEL)?;
            self.world.spawn((Joint::ball(above, link).at_point(self.world, at)?,));
            (above, at) = (link, at - Vec3::Y * 0.4);
        }
        let weight = self.loose(&Shape::sphere(0.45), 80.0, at - Vec3::Y * 0.45, STEEL)?;
        self.world.spawn((Joint::ball(above, weight).at_point(self.world, at)?,));
        Ok(())
    }

    fn crate_at(&mut self, half: f64, mass: f64, at: Vec3, color: usize) -> Result<(), BodyError> {
        let body = RigidBody::new(Shape::cuboid([half; 3])).mass(mass).position(at);
        self.add(body, Look::framed(half, WOOD[color % 2])).map(|_| ())
    }

    /// A wall and a tower of crates, and pins.
    fn stacks(&mut self) -> Result<(), BodyError> {
        for row in 0..6_u8 {
            for column in 0..6 - row % 2 {
                let x = 0.62 * (Real::from(column) - 2.5 + 0.5 * Real::from(row % 2));
                let at = Vec3::new(x, 0.3 + 0.6 * Real::from(row), -5.0);
                self.crate_at(0.3, 4.0, at, usize::from(row + column))?;
            }
        }
        for i in 0..8_u8 {
            let at = Vec3::new(-11.0, 0.35 + 0.7 * Real::from(i / 2), -9.4 + 0.8 * Real::from(i % 2));
            self.crate_at(0.35, 6.0, at, usize::from(i / 2))?;
        }
        for i in 0..4_u8 {
            for j in 0..=i {
                let at =
                    Vec3::new(8.0 + 0.6 * (Real::from(j) - 0.5 * Real::from(i)), 0.45, -7.0 - 0.52 * Real::from(i));
                self.loose(&Shape::cylinder(0.14, 0.45), 1.6, at, [0.92, 0.92, 0.88])?;
            }
        }
        Ok(())
    }

    fn car(&mut self) -> Result<Entity, Box<dyn Error>> {
        let ground = Pose {
            position: Vec3::new(15.0, 0.0, 14.6),
            orientation: Quat::from_rotation_y(std::f64::consts::PI as Real),
        };
        let plan = VehiclePlan::car(3.6, 900.0);
        let (body, vehicle) = plan.build(ground)?;
        let half = [0.5 * plan.width, 0.25 * plan.height, 0.5 * plan.length].map(f64::from);
        let look = Look(Vec::new()).and(&Shape::cuboid(half), Vec3::Y * -0.25 * plan.height, RED);
        let cabin = [half[0] * 0.85, half[1], half[2] * 0.5];
        let look = look.and(&Shape::cuboid(cabin), Vec3::new(0.0, 0.25 * plan.height, -0.15), [0.22, 0.26, 0.32]);
        let car = self.add(body, look)?;
        self.world.insert(car, vehicle.components())?;
        self.world.get::<&mut VehicleInput>(car)?.hand_brake = 1.0;
        Ok(car)
    }

    fn hero(&mut self) -> Result<(Entity, Character, Entity), Box<dyn Error>> {
        let character = Character::new(CharacterSettings::of_height(1.8))?;
        let hero = self.world.spawn(character.at(START));
        let id = self.id();
        self.world.insert(hero, (id, PreviousPose(Pose::at(START))))?;
        let hand = RigidBody::new(Shape::Point).kinematic().without_collider().id(self.id());
        let hand = hand.build()?.spawn(self.world);
        Ok((hero, character, hand))
    }
}
