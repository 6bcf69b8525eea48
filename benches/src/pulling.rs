//! Benchmark scenes with pairwise forces: a net of springs and a cloud of attracting points.

use hecs::{DynamicBundle, Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{BodyId, GravityMass, RigidBody, Rng, Shape, Spring};

/// A square net of `side` times `side` balls, a metre apart, with a damped spring between
/// neighbours: `2 side (side - 1)` of them.
pub fn net_of_springs(side: usize) -> World {
    let mut world = World::new();
    let net: Vec<Entity> = (0..side * side)
        .map(|i| {
            let place = Vec3::new((i % side) as Real, 0.0, (i / side) as Real);
            spawn(&mut world, Shape::sphere(0.1), i, place, ())
        })
        .collect();
    for i in 0..net.len() {
        let right = (i % side + 1 < side).then_some(i + 1);
        for other in right.into_iter().chain((i + side < net.len()).then_some(i + side)) {
            world.spawn((Spring::between(net[i], net[other])
                .with_rest_length(1.0)
                .with_stiffness(100.0)
                .with_damping(0.1),));
        }
    }
    world
}

/// A cloud of points in which every one pulls at every other.
pub fn attracting_points(count: usize) -> World {
    let (mut world, mut rng) = (World::new(), Rng::new(7));
    for i in 0..count {
        let place = rng.vector(-100.0, 100.0);
        spawn(&mut world, Shape::Point, i, place, (GravityMass { mu: 1.0, softening: 0.1 },));
    }
    world
}

/// A body of a kilogram, with more components.
#[allow(clippy::expect_used, reason = "the bodies made above are possible")]
fn spawn(world: &mut World, shape: Shape, id: usize, place: Vec3, with: impl DynamicBundle) -> Entity {
    let body = RigidBody::new(shape).without_collider().mass(1.0).id(BodyId(id as u64)).position(place);
    body.build().expect("a possible body").spawn_with(world, with)
}
