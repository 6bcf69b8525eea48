//! The nearest points of points, segments and boxes in closed form: what is inside the layers of
//! balls and capsules, and balls beside boxes.

use crate::capsule::nearest_of_segments;
use crate::minkowski::Difference;
use crate::support_map::{Convex, Vector};

/// The vector from the nearest point of the first to that of the second, and the former; `None`
/// where the shapes are others, or touch to rounding.
pub(crate) fn nearest_of_few(shapes: &Difference<'_>) -> Option<(Vector, Vector)> {
    let Difference { first, second, position, .. } = *shapes;
    let (on_first, on_second) = match (first, second) {
        (Convex::Point, Convex::Point) => (Vector::zero(), position),
        (Convex::Point, Convex::Segment { half_height }) => {
            (Vector::zero(), on_line(position, shapes.axes[1] * half_height, Vector::zero()))
        }
        (Convex::Segment { half_height }, Convex::Point) => {
            (on_line(Vector::zero(), Vector::new(0.0, half_height, 0.0), position), position)
        }
        (Convex::Segment { half_height }, Convex::Segment { half_height: other }) => {
            of_segments(Vector::new(0.0, half_height, 0.0), (position, shapes.axes[1] * other))
        }
        (Convex::Point, Convex::Cuboid { half }) => {
            (Vector::zero(), shapes.place(in_box(shapes.turned_back(position * -1.0), half)))
        }
        (Convex::Cuboid { half }, Convex::Point) => (in_box(position, half), position),
        _ => return None,
    };
    let between = on_second - on_first;
    let size = position.dot(position).max(on_first.dot(on_first));
    let is_apart = between.dot(between) > TOUCHING * TOUCHING * size;
    is_apart.then_some((between, on_first))
}

/// Nearer than this part of where they are, the direction between two points is lost in rounding.
const TOUCHING: f64 = 1e-10;

/// The point of a segment, given by its middle and half of it, that is nearest to another.
fn on_line(middle: Vector, half: Vector, point: Vector) -> Vector {
    let square = half.dot(half);
    let along = half.dot(point - middle);
    middle + half * if square > 0.0 { (along / square).clamp(-1.0, 1.0) } else { 0.0 }
}

/// Of a segment about the origin and another: inside both, or where one of four ends is nearest.
fn of_segments(half: Vector, (middle, other_half): (Vector, Vector)) -> (Vector, Vector) {
    let (inside, _) = nearest_of_segments([Vector::zero(), half], [middle, other_half]);
    let mut best = beside(half * inside, middle, other_half);
    for end in [half, half * -1.0] {
        best = nearer(best, beside(end, middle, other_half));
    }
    for end in [middle + other_half, middle - other_half] {
        let (on_second, on_first) = beside(end, Vector::zero(), half);
        best = nearer(best, (on_first, on_second));
    }
    best
}

/// A point, and that of a segment which is nearest to it.
fn beside(point: Vector, middle: Vector, half: Vector) -> (Vector, Vector) {
    (point, on_line(middle, half, point))
}

fn nearer(a: (Vector, Vector), b: (Vector, Vector)) -> (Vector, Vector) {
    let square = |(p, q): (Vector, Vector)| (q - p).dot(q - p);
    if square(b) < square(a) { b } else { a }
}

/// The point of a box about the origin that is nearest to another.
pub(crate) fn in_box(point: Vector, half: Vector) -> Vector {
    let within = |x: f64, half: f64| x.max(-half).min(half);
    Vector::new(within(point.x, half.x), within(point.y, half.y), within(point.z, half.z))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use tumble_math::lane::Quat;

    use super::*;

    /// Part of their size by which nearest points may be wrong.
    const ROUNDING: f64 = 1e-14;

    const STRAIGHT: Quat<f64> = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![4 => -1.0..1.0_f64, 1 => Just(0.0), 1 => -1e-7..1e-7_f64]
    }

    fn vector() -> impl Strategy<Value = Vector> {
        [number(), number(), number()].prop_map(|[x, y, z]| Vector::new(x, y, z))
    }

    /// From a micrometre to a kilometre.
    fn size() -> impl Strategy<Value = f64> {
        (-6.0..3.0_f64).prop_map(|exponent| 10.0_f64.powf(exponent))
    }

    fn few() -> impl Strategy<Value = Convex<'static>> {
        prop_oneof![
            Just(Convex::Point),
            prop_oneof![size(), Just(0.0)].prop_map(|half_height| Convex::Segment { half_height }),
            [size(), size(), size()].prop_map(|[x, y, z]| Convex::Cuboid { half: Vector::new(x, y, z) }),
        ]
    }

    /// Also parallel and nearly parallel ones, and such that touch.
    fn pairs() -> impl Strategy<Value = Difference<'static>> {
        (few(), few(), vector(), size(), vector(), number()).prop_map(|(first, second, at, size, turn, w)| {
            let turn = Quat { x: turn.x, y: turn.y, z: turn.z, w };
            let turn = if turn.length_squared() > 1e-3 { turn.normalize() } else { STRAIGHT };
            Difference { first, second, position: at * size, axes: turn.axes() }
        })
    }

    /// How far a point is from a shape.
    fn outside(shape: Convex<'_>, point: Vector) -> f64 {
        let half = match shape {
            Convex::Segment { half_height } => Vector::new(0.0, half_height, 0.0),
            Convex::Cuboid { half } => half,
            _ => Vector::zero(),
        };
        let off = point - in_box(point, half);
        off.dot(off).sqrt()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        /// Points of both shapes are no further apart than planes across the vector between them,
        /// which nothing of either is beyond.
        #[test]
        fn nearest_points_are_of_the_shapes_and_nothing_is_nearer(shapes in pairs()) {
            let Some((between, on_first)) = nearest_of_few(&shapes) else { return Ok(()) };
            let size = [shapes.first.support(between), shapes.second.support(shapes.turned_back(between)), shapes.position]
                .iter()
                .fold(0.0, |size: f64, v| size.max(v.dot(*v).sqrt()));
            let on_second = shapes.turned_back(on_first + between - shapes.position);
            prop_assert!(outside(shapes.first, on_first) <= ROUNDING * size);
            prop_assert!(outside(shapes.second, on_second) <= ROUNDING * size);
            let distance = between.dot(between).sqrt();
            let apart = shapes.separation(between * (1.0 / distance));
            // Of a direction that is wrong by an angle, what is across it counts.
            let wrong = ROUNDING * size * (1.0 + size / distance);
            prop_assert!(apart >= distance - wrong, "{apart} of {distance}, size {size}");
            prop_assert!(apart <= distance + wrong);
        }
    }

    #[test]
    fn all_pairs_of_points_segments_and_boxes_but_two_boxes_and_rods_beside_boxes_are_known() {
        let half = Vector::new(1.0, 2.0, 3.0);
        let shapes = [Convex::Point, Convex::Segment { half_height: 2.0 }, Convex::Cuboid { half }];
        let (position, axes) = (Vector::new(9.0, 1.0, -7.0), STRAIGHT.axes());
        let known = shapes
            .map(|first| shapes.map(|second| nearest_of_few(&Difference { first, second, position, axes }).is_some()));
        assert_eq!(known, [[true, true, true], [true, true, false], [true, false, false]]);
    }
}
