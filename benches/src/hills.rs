//! Benchmark scenes on ground of triangles: hills under boxes, balls and capsules.

use hecs::World;
use tumble::math::{Quat, Real, Vec3};
use tumble::{BodyId, Collider, Material, RigidBody, Rng, Shape};

use crate::piles::FRICTION;

/// What lies on hills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HillBodies {
    /// Boxes of half a metre.
    Boxes,
    /// Balls of half a metre.
    Balls,
    /// Capsules of half a metre and more.
    Capsules,
    /// One of each after the other.
    Mixed,
}

/// What hills are made of; the triangles are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HillGround {
    /// Heights over a grid.
    HeightField,
    /// Triangles with corners at the same places.
    Mesh,
}

/// Distance of bodies at the start \[m\].
const PITCH: f64 = 1.5;
/// From a valley to the next, in cells of a metre.
const PERIOD: usize = 12;
/// How high hills are above the valleys between them \[m\].
const HEIGHT: f64 = 1.0;

/// `count` bodies that fall from half a metre on hills of a metre with cells of a metre, and slide
/// and roll into the valleys.
pub fn hills(count: usize, bodies: HillBodies, ground: HillGround) -> World {
    let mut world = World::new();
    let side = (1..).find(|side| side * side >= count).unwrap_or(1);
    let crossings = (side as f64 * PITCH) as usize + 6;
    spawn_ground(&mut world, crossings, ground);
    let mut rng = Rng::new(11);
    for index in 0..count {
        let across = |place: usize| PITCH * (place as f64 - 0.5 * (side as f64 - 1.0));
        let mut around = |middle: f64, width: f64| (middle + width * (2.0 * rng.unit() - 1.0)) as Real;
        let place =
            Vec3::new(around(across(index % side), 0.3), HEIGHT as Real + 0.7, around(across(index / side), 0.3));
        let kind = match bodies {
            HillBodies::Boxes => 0,
            HillBodies::Balls => 1,
            HillBodies::Capsules => 2,
            HillBodies::Mixed => index % 3,
        };
        let solid = match kind {
            0 => Shape::cuboid(Vec3::new(around(0.25, 0.1), around(0.25, 0.1), around(0.25, 0.1))),
            1 => Shape::sphere(around(0.25, 0.1)),
            _ => Shape::capsule(around(0.2, 0.05), around(0.25, 0.1)),
        };
        let turned = Quat::from_xyzw(around(0.0, 1.0), around(0.0, 1.0), around(0.0, 1.0), 1.0).normalize();
        let way = Vec3::new(around(0.0, 1.0), 0.0, around(0.0, 1.0));
        let id = BodyId(index as u64);
        spawn(&mut world, solid, |body| body.mass(1.0).position(place).orientation(turned).linear_velocity(way).id(id));
    }
    world
}

#[allow(clippy::expect_used, reason = "the heights made here are possible")]
fn spawn_ground(world: &mut World, crossings: usize, ground: HillGround) {
    let height = |index: usize| HEIGHT * wave(index % crossings) * wave(index / crossings);
    let heights: Vec<f64> = (0..crossings * crossings).map(height).collect();
    let collider = match ground {
        HillGround::HeightField => Collider::height_field(heights, crossings, [1.0; 2]),
        HillGround::Mesh => {
            let middle = 0.5 * (crossings as f64 - 1.0);
            let corner = |(index, height): (usize, &f64)| {
                [(index % crossings) as f64 - middle, *height, (index / crossings) as f64 - middle]
            };
            let corners: Vec<[f64; 3]> = heights.iter().enumerate().map(corner).collect();
            let cells =
                (0..crossings - 1).flat_map(|row| (0..crossings - 1).map(move |column| row * crossings + column));
            let triangles: Vec<[u32; 3]> = cells
                .flat_map(|here| {
                    let [here, along_z] = [here as u32, (here + crossings) as u32];
                    [[here, along_z, along_z + 1], [here, along_z + 1, here + 1]]
                })
                .collect();
            Collider::mesh(corners, &triangles)
        }
    };
    let surface = Material::new(FRICTION, 0.0);
    let collider = collider.expect("ground").with_material(surface).expect("a material");
    world.spawn((tumble::Pose::default(), BodyId(u64::MAX), collider));
}

/// A body that others touch.
#[allow(clippy::expect_used, reason = "the bodies made above are possible")]
fn spawn(world: &mut World, solid: Shape, placed: impl FnOnce(RigidBody) -> RigidBody) {
    let surface = Material::new(FRICTION, 0.0).with_rolling_resistance(0.01);
    let collider = Collider::new(&solid).and_then(|collider| collider.with_material(surface)).expect("a collider");
    placed(RigidBody::new(solid)).build().expect("a possible body").spawn_with(world, (collider,));
}

/// From 0 to 1 and back, smoothly: parabolas, so that no sine is needed.
fn wave(cell: usize) -> f64 {
    let phase = (cell % PERIOD) as f64 / PERIOD as f64;
    let from_top = phase.min(1.0 - phase) * 2.0;
    if from_top < 0.5 { 1.0 - 2.0 * from_top * from_top } else { 2.0 * (1.0 - from_top) * (1.0 - from_top) }
}
