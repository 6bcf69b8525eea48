//! Benchmark scenes with contacts: a pyramid of boxes, falling balls, compounds in each other,
//! worlds of eight boxes.

use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{BodyId, Collider, Material, Pose, RigidBody, Shape};

/// Coefficient of friction of all bodies of piles.
pub const FRICTION: Real = 0.5;

/// What shape a body of a pile is, for other engines that are shown it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PileShape {
    /// With half the lengths of its edges \[m\].
    Box(Vec3),
    /// With its radius \[m\].
    Ball(Real),
}

const UNIT_BOX: PileShape = PileShape::Box(Vec3::splat(0.5));

/// A pyramid of unit boxes of 1 kg on the ground, `base` by `base` at the bottom with gaps of a
/// tenth, each layer one box narrower: 2870 boxes for 20.
pub fn pyramid(base: u32) -> World {
    let mut world = World::new();
    fixed_box(&mut world, Vec3::new(100.0, 1.0, 100.0), -Vec3::Y);
    let pitch = 1.1;
    let mut id = 0;
    for layer in 0..base {
        let side = base - layer;
        let from_middle = |i: u32| (i as Real - (side as Real - 1.0) * 0.5) * pitch;
        for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
            let at = Vec3::new(from_middle(i), 0.5 + layer as Real, from_middle(j));
            spawn(&mut world, UNIT_BOX, |body| body.mass(1.0).position(at).id(BodyId(id)));
            id += 1;
        }
    }
    world
}

/// `count` balls of 1 kg and a metre across in layers of 18 by 18, each a little beside its place
/// in the grid, about to fall into a box of 20 by 20 m.
pub fn falling_balls(count: usize) -> World {
    let mut world = World::new();
    fixed_box(&mut world, Vec3::new(12.0, 1.0, 12.0), -Vec3::Y);
    for side in [-11.0, 11.0] {
        fixed_box(&mut world, Vec3::new(1.0, 30.0, 12.0), Vec3::new(side, 30.0, 0.0));
        fixed_box(&mut world, Vec3::new(12.0, 30.0, 1.0), Vec3::new(0.0, 30.0, side));
    }
    let mut draw = Lcg(7);
    for i in 0..count {
        let place = [i % 18, i / 324, i / 18 % 18].map(|place| place as f64);
        let [x, y, z] =
            [(place[0] - 8.5) * 1.1, 1.0 + place[1] * 1.1, (place[2] - 8.5) * 1.1].map(|x| x + draw.around(0.04));
        let at = Vec3::new(x as Real, y as Real, z as Real);
        spawn(&mut world, PileShape::Ball(0.5), |body| body.mass(1.0).position(at).id(BodyId(i as u64)));
    }
    world
}

/// Two bodies in the air of this many balls each, every ball of one in every ball of the other.
pub fn compounds_in_each_other(count: usize) -> World {
    let mut world = World::new();
    for x in [-0.01, 0.01] {
        let mut draw = Lcg(37);
        let places = (0..count).map(|_| {
            let [x, y, z] = [0.1; 3].map(|reach| draw.around(reach) as Real);
            Vec3::new(x, y, z)
        });
        spawn_compound(&mut world, Vec3::X * x, places);
    }
    world
}

/// Spawns a body of balls of a metre across in these places of it.
#[allow(clippy::expect_used, reason = "the bodies and colliders made here are possible")]
fn spawn_compound(world: &mut World, at: Vec3, places: impl Iterator<Item = Vec3>) {
    let ball = Shape::sphere(0.5);
    let part = |position| Collider::new(&ball).and_then(|ball| ball.with_offset(Pose { position, ..Pose::default() }));
    let parts: Result<Vec<_>, _> = places.map(part).collect();
    let collider = parts.and_then(Collider::compound).expect("a possible collider");
    let body = RigidBody::new(ball.clone()).mass(1.0).position(at).angular_velocity(Vec3::new(0.3, 1.0, -0.5));
    body.build().expect("a possible body").spawn_with(world, (collider,));
}

/// The `index`th of many small worlds: eight tumbling unit boxes of 1 kg above the ground.
pub fn eight_boxes(index: u64) -> World {
    let mut world = World::new();
    fixed_box(&mut world, Vec3::new(50.0, 1.0, 50.0), -Vec3::Y);
    let mut draw = Lcg(1000 + index);
    for _ in 0..4 {
        draw.unit();
    }
    for i in 0..8_u32 {
        let place = [i & 1, i >> 1 & 1, i >> 2].map(|place| f64::from(place) * 1.2);
        let [x, y, z] = [place[0], 1.0 + place[1], place[2]].map(|x| (x + draw.around(0.1)) as Real);
        let spin = 1.0 / 3.0_f64.sqrt();
        let [a, b, c] = [(); 3].map(|()| draw.around(spin) as Real);
        let spin = Vec3::new(a, b, c);
        spawn(&mut world, UNIT_BOX, |body| {
            body.mass(1.0).position(Vec3::new(x, y, z)).angular_velocity(spin).id(BodyId(i.into()))
        });
    }
    world
}

fn fixed_box(world: &mut World, half_extents: Vec3, at: Vec3) {
    let id = BodyId(u64::MAX - u64::from(world.len()));
    spawn(world, PileShape::Box(half_extents), |body| body.fixed().position(at).id(id));
}

/// A body that others touch.
#[allow(clippy::expect_used, reason = "the bodies made above are possible")]
fn spawn(world: &mut World, shape: PileShape, placed: impl FnOnce(RigidBody) -> RigidBody) {
    let solid = match shape {
        PileShape::Box(half_extents) => Shape::cuboid(half_extents),
        PileShape::Ball(radius) => Shape::sphere(radius),
    };
    let surface = Material::new(FRICTION, 0.0);
    let collider = Collider::new(&solid).and_then(|collider| collider.with_material(surface)).expect("a collider");
    let body = placed(RigidBody::new(solid)).build().expect("a possible body");
    body.spawn_with(world, (collider, shape));
}

/// The linear congruential generator of Knuth's MMIX, whose upper 31 bits count: the one that other
/// engines' drivers drew the same scenes with.
struct Lcg(u64);

impl Lcg {
    /// From 0 to 1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / 2_147_483_648.0
    }

    /// Up to `reach` from zero.
    fn around(&mut self, reach: f64) -> f64 {
        reach * (2.0 * self.unit() - 1.0)
    }
}
