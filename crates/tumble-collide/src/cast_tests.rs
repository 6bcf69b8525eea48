//! Promise: what two shapes on their courses do in a span of time is bounded by their distance and
//! rates at one moment, and they are nearest where that is said.
//!
//! Why: what is taken for passed is not followed, and goes through.

use proptest::prelude::*;

use crate::cast::Moving;
use crate::collider_shape::{ColliderShape, Isometry};
use crate::course::Course;
use crate::pair_tests::orientation;
use crate::support_map::{Convex, Vector, unit};

fn vector(most: f64) -> impl Strategy<Value = Vector> {
    [-most..most, -most..most, -most..most].prop_map(|[x, y, z]| Vector::new(x, y, z))
}

fn shape() -> impl Strategy<Value = ColliderShape<f64>> {
    prop_oneof![
        (0.1..1.0).prop_map(|radius| ColliderShape::Sphere { radius }),
        (0.1..1.0, 0.1..2.0).prop_map(|(radius, half_height)| ColliderShape::Capsule { radius, half_height }),
        [0.1..1.0, 0.1..1.0, 0.1..1.0]
            .prop_map(|[x, y, z]| { ColliderShape::Cuboid { half_extents: Vector::new(x, y, z) } }),
        (0.1..1.0, 0.1..1.0, 0.1..2.0).prop_map(|(radius_bottom, radius_top, half_height)| {
            ColliderShape::Frustum { radius_bottom, radius_top, half_height }
        }),
        (0.1..1.0, 0.1..1.0, 0.1..2.0).prop_map(|(radius_bottom, radius_top, half_height)| {
            ColliderShape::TaperedCapsule { radius_bottom, radius_top, half_height }
        }),
        (0.1..1.0, 0.1..1.0).prop_map(|(x, y)| ColliderShape::Ellipsoid { radii: Vector::new(x, y, x) }),
    ]
}

/// Also such that turn off or do not turn, about points beside the shape.
fn course() -> impl Strategy<Value = Course> {
    let turn = prop_oneof![vector(2.0), Just(Vector::zero())];
    let part = (vector(0.5), orientation());
    // Some spin about the axis of the shape.
    let about_axis = prop_oneof![Just(0.0), -6.0..6.0_f64];
    (vector(3.0), vector(0.5), vector(4.0), turn, 0.0..1.0, vector(4.0), part, about_axis).prop_map(
        |(at, off, way, turn, moment, after, (place, orientation), about_axis)| {
            let [_, axis, _] = orientation.axes();
            let course = Course::new(&Isometry::at(at), at + off, way, turn + axis * about_axis);
            course.of_part(&Isometry { position: place, orientation }).turned_off(moment, after)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]
    #[test]
    fn no_distance_is_less_than_the_bound_of_a_span(
        (first, second) in (shape(), shape()),
        (a, b) in (course(), course()),
        (moment, end, part) in (0.0..1.0, 0.0..1.0, 0.0..1.0),
    ) {
        let convex = [&first, &second].map(Convex::of);
        let [Some(one), Some(other)] = convex else { return Ok(()) };
        let moving = Moving::new(one, other, [&first, &second], [&a, &b]);
        let Some(gap) = moving.gap(moment) else { return Ok(()) };
        let between = moment + (end - moment) * part;
        let Some(there) = moving.gap(between) else { return Ok(()) };
        let least = moving.least_until(&gap, moment, end);
        prop_assert!(there.distance >= least - 1e-9, "{} < {least} at {between}", there.distance);
    }

    /// No point that is furthest in a direction goes faster in it than the bound says.
    #[test]
    fn what_turns_comes_no_faster(shape in shape(), course in course(), d in vector(1.0), moment in 0.0..1.0) {
        let (Some((inner, layer)), direction) = (Convex::of(&shape), unit(d)) else { return Ok(()) };
        let at = course.at(moment);
        let furthest = at.to_world(inner.support(at.orientation.rotate_back(direction)));
        let rate = course.angular().cross(furthest - course.center_and_turn(moment).0).dot(direction);
        let radius = course.off_center() + shape.reach().unwrap_or(0.0) - layer;
        let most = course.turning_rate(&inner, radius, direction);
        prop_assert!(rate <= most + 1e-9, "{rate} for {most}");
    }

    /// The rate at which shapes part is how their distance changes, where that is smooth.
    #[test]
    fn the_rate_is_that_of_the_distance(
        (first, second) in (shape(), shape()), (a, b) in (course(), course()), moment in 0.01..0.99,
    ) {
        let convex = [&first, &second].map(Convex::of);
        let [Some(one), Some(other)] = convex else { return Ok(()) };
        let moving = Moving::new(one, other, [&first, &second], [&a, &b]);
        let part = 1e-5;
        let gaps = [moment - part, moment, moment + part].map(|moment| moving.gap(moment));
        let [Some(before), Some(now), Some(after)] = gaps else { return Ok(()) };
        prop_assume!(before.distance > 0.1 && now.distance > 0.1 && after.distance > 0.1);
        let [came, goes] = [now.distance - before.distance, after.distance - now.distance].map(|way| way / part);
        prop_assume!((came - goes).abs() < 1e-2);
        let rate = moving.opening_rate(&now, moment);
        prop_assert!((rate - 0.5 * (came + goes)).abs() < 2e-2, "{rate} for {came} and {goes}");
    }

    /// The distance of what goes straight on falls, and then grows.
    #[test]
    fn what_passes_is_found_where_it_is_nearest(
        (first, second) in (shape(), shape()), (at, off) in (vector(3.0), vector(0.5)), way in vector(8.0),
    ) {
        let (zero, at) = (Vector::zero(), at * 2.0);
        let courses = [&Course::new(&Isometry::at(zero), zero, zero, zero), &Course::new(&Isometry::at(at), at + off, way, zero)];
        let (Some(one), Some(other)) = (Convex::of(&first), Convex::of(&second)) else { return Ok(()) };
        let moving = Moving::new(one, other, [&first, &second], courses);
        let Some(met) = moving.nearest([0.0, 1.0], f64::INFINITY) else { return Err(TestCaseError::fail("no answer")) };
        let least = (0..=200).filter_map(|part| moving.gap(f64::from(part) / 200.0)).map(|gap| gap.distance);
        let least = least.fold(f64::INFINITY, f64::min);
        // Of half of what is left of the span, and half of a part.
        let missed = way.dot(way).sqrt() * (1.0 / 256.0 + 1.0 / 400.0);
        prop_assert!(least < 0.0 || (met.distance - least).abs() <= missed, "{} for {least}", met.distance);
        prop_assert!(least > -missed || met.distance <= missed, "{} for {least}", met.distance);
    }

    /// Balls that go straight along their line of centres come together at the greatest rate.
    #[test]
    fn the_bound_of_balls_that_meet_straight_is_their_distance(
        (radius, apart, speed) in (0.1..1.0, 2.0..9.0, -5.0..5.0_f64),
        (moment, end) in (0.0..1.0, 0.0..1.0),
    ) {
        let ball = ColliderShape::Sphere { radius };
        let zero = Vector::zero();
        let stays = Course::new(&Isometry::at(zero), zero, zero, zero);
        let at = Vector::new(0.0, apart, 0.0);
        let goes = Course::new(&Isometry::at(at), at, Vector::new(0.0, speed, 0.0), zero);
        let Some(shape) = Convex::of(&ball) else { return Ok(()) };
        let moving = Moving::new(shape, shape, [&ball, &ball], [&stays, &goes]);
        let distance = |moment: f64| -> f64 { apart + speed * moment - 2.0 * radius };
        prop_assume!(distance(moment) + 2.0 * radius > 0.1);
        let Some(gap) = moving.gap(moment) else { return Ok(()) };
        let least = moving.least_until(&gap, moment, end);
        prop_assert!((least - distance(moment).min(distance(end))).abs() < 1e-9);
    }
}
