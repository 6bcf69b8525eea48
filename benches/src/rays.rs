//! Boxes at random in a large cube, and rays through it.

use hecs::World;
use tumble::math::{Quat, Real, Vec3};
use tumble::{Collider, Pose, Ray, Rng, Shape};

/// Edge of the cube that boxes and rays are in \[m\].
const CUBE: Real = 100.0;

/// Fixed boxes with edges of a metre, at random in a cube of a hundred metres; of a million in one
/// of as large a density.
///
/// # Panics
/// Never: the shape can be touched.
#[must_use]
#[allow(clippy::unwrap_used, reason = "a cube of a metre is a collider")]
pub fn scattered_boxes(count: usize) -> World {
    let edge = CUBE * (count as Real / 10_000.0).cbrt();
    let collider = Collider::new(&Shape::cuboid([0.5; 3])).unwrap();
    let mut world = World::new();
    let mut rng = Rng::new(23);
    world.spawn_batch((0..count).map(|_| {
        let position = rng.vector(0.0, edge);
        let orientation: Quat = rng.orientation();
        (Pose { position, orientation }, collider.clone())
    }));
    world
}

/// Rays of a hundred metres from anywhere in the cube of ten thousand boxes.
#[must_use]
pub fn rays_through_boxes(count: usize) -> Vec<Ray> {
    let mut rng = Rng::new(24);
    let ray = || {
        let (from, direction) = (rng.vector(0.0, CUBE), rng.vector(-1.0, 1.0));
        Ray::new(from, if direction == Vec3::ZERO { Vec3::X } else { direction }).with_max_distance(CUBE)
    };
    std::iter::repeat_with(ray).take(count).collect()
}
