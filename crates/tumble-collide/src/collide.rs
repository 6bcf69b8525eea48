use crate::ball::{ball_and_ball, cuboid_and_ball};
use crate::cuboids::{CuboidLanes, cuboid_pair};
use crate::geometry::{Geometry, Placement};
use crate::half_space::{half_space_and_ball, half_space_and_cuboid};
use crate::manifold::Manifold;
use crate::scalar::Scalar;

/// How two shapes touch, with all points where they are at most `margin` \[m\] apart. The normal goes from the first to the second.
///
/// Half-spaces do not touch each other. What is not finite touches nothing.
pub fn collide<R: Scalar>(
    first: &Geometry<R>,
    first_at: &Placement<R>,
    second: &Geometry<R>,
    second_at: &Placement<R>,
    margin: R,
) -> Manifold<R> {
    use Geometry::{Ball, Cuboid, HalfSpace};
    match (*first, *second) {
        (Ball { radius: a }, Ball { radius: b }) => ball_and_ball(a, first_at.position, b, second_at.position, margin),
        (Cuboid { half_extents }, Ball { radius }) => {
            cuboid_and_ball(half_extents, first_at, radius, second_at.position, margin)
        }
        (Cuboid { half_extents: a }, Cuboid { half_extents: b }) => {
            let first = CuboidLanes { half_extents: a, orientation: first_at.orientation };
            let second = CuboidLanes { half_extents: b, orientation: second_at.orientation };
            let origin = second_at.position;
            cuboid_pair(&first, &second, origin - first_at.position, margin).of_one(origin)
        }
        (HalfSpace, Ball { radius }) => half_space_and_ball(first_at, radius, second_at.position, margin),
        (HalfSpace, Cuboid { half_extents }) => half_space_and_cuboid(first_at, half_extents, second_at, margin),
        (HalfSpace, HalfSpace) => Manifold::none(),
        (Ball { .. }, Cuboid { .. }) | (Ball { .. } | Cuboid { .. }, HalfSpace) => {
            collide(second, second_at, first, first_at, margin).swapped()
        }
    }
}
