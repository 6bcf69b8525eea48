//! Promise: the limits of a joint are drawn where they are: an arc is where the hand of the joint
//! is when it is at an angle within them, a cone's rim where its axis is at the greatest angles, a
//! range as long as it is; and the colour says whether a bound is reached.
//!
//! Why: people set limits by these lines. An arc about the wrong axis, or of the wrong sign, is
//! worse than none.

use glam::{DQuat, DVec3};
use hecs::World;
use proptest::prelude::*;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{Axes, Breakable, Cone, DebugView, Gain, Joint, Limit, Limits};
use tumble_tests::{EPSILON, dquat, dvec3};

type Line = (DVec3, DVec3, [f32; 3]);

/// The radius of arcs and cones \[m\].
const RADIUS: f64 = 0.25;
/// Rounding of a rotation and a point a few metres off.
const ROUNDING: f64 = 64.0 * EPSILON;

/// A joint between a body that stands anywhere and one that is turned and shifted against it.
struct Drawn {
    /// The first frame.
    origin: DVec3,
    orientation: DQuat,
    lines: Vec<Line>,
}

impl Drawn {
    fn of(free: Axes, shift: DVec3, turn: DQuat, limits: Limits) -> Self {
        let mut world = World::new();
        let mut body = |position: Vec3, orientation: Quat| {
            let body = RigidBody::new(Shape::sphere(0.1))
                .without_collider()
                .mass(1.0)
                .position(position)
                .orientation(orientation);
            body.build().unwrap().spawn(&mut world)
        };
        let (position, orientation) = (Vec3::new(1.0, -2.0, 0.5), Quat::from_rotation_y(0.7));
        let frame = Pose { position: Vec3::new(0.0, 0.3, 0.1), orientation: Quat::from_rotation_x(-1.2) };
        let first = body(position, orientation);
        let frame_in_world = (position + orientation * frame.position, orientation * frame.orientation);
        let (origin, to_world) = (dvec3(frame_in_world.0), dquat(frame_in_world.1).normalize());
        let real = |vector: DVec3| Vec3::from_array(vector.to_array().map(|number| number as Real));
        let turned = (to_world * turn).to_array().map(|number| number as Real);
        let second = body(real(origin + to_world * shift), Quat::from_array(turned));
        let joint = Joint::free_along(first, second, free).with_frames(frame, Pose::default());
        world.spawn((joint, limits));
        let mut lines = Vec::new();
        let view = DebugView { joints: Some(RADIUS as Real), ..DebugView::nothing() };
        view.draw(&world, &mut |from, to, color| lines.push((dvec3(from), dvec3(to), color)));
        Self { origin, orientation: to_world, lines }
    }

    /// Ends of the lines of a colour, in the first frame.
    fn ends(&self, color: [f32; 3]) -> Vec<DVec3> {
        let of_color = self.lines.iter().filter(|line| line.2 == color);
        let to_frame = |point: DVec3| self.orientation.conjugate() * (point - self.origin);
        of_color.flat_map(|(from, to, _)| [to_frame(*from), to_frame(*to)]).collect()
    }

    fn has(&self, color: [f32; 3]) -> bool {
        self.lines.iter().any(|line| line.2 == color)
    }
}

fn assert_near(a: DVec3, b: DVec3) {
    assert!(a.distance(b) < ROUNDING, "{a} is not {b}");
}

/// The axes of a joint with some free rotations, and the rotation that has these values.
fn rotations() -> impl Strategy<Value = (Axes, usize, usize)> {
    const ANGULAR: [Axes; 3] = [Axes::ANGULAR_X, Axes::ANGULAR_Y, Axes::ANGULAR_Z];
    (0_usize..3, 0_usize..3).prop_map(|(axis, other)| {
        let free = if axis == other { ANGULAR[axis] } else { ANGULAR[axis] | ANGULAR[other] };
        (free, axis, other)
    })
}

const UNITS: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];
const LIMIT_AXES: [Axes; 3] = [Axes::ANGULAR_X, Axes::ANGULAR_Y, Axes::ANGULAR_Z];

/// The one line from the middle that is the hand.
fn hand(drawn: &Drawn) -> DVec3 {
    let ends = drawn.ends(DebugView::JOINT);
    let hands: Vec<_> = ends.chunks(2).filter(|line| (line[1].length() - RADIUS).abs() < ROUNDING).collect();
    assert_eq!(hands.len(), 1, "{ends:?}");
    hands[0][1]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// The joint is brought to either bound, where its hand is to be at that end of the arc, and
    /// to the middle, where the colour changes.
    #[test]
    fn an_arc_ends_where_the_hand_is_at_its_bounds(
        (free, axis, other) in rotations(),
        (a, b) in (-3.0..3.0, -3.0..3.0),
        second in -1.4..1.4,
    ) {
        let (min, max) = (f64::min(a, b), f64::max(a, b));
        prop_assume!(max - min > 0.1);
        let limits = Limits::along(LIMIT_AXES[axis], Limit::new(min as Real, max as Real));
        let drawn = |angle: f64| {
            let turn = DQuat::from_axis_angle(UNITS[axis], angle);
            let bend = DQuat::from_axis_angle(UNITS[other], if axis == other { 0.0 } else { second });
            // About the first axis, then about the other as it has been turned.
            let turn = if axis < other { turn * bend } else { bend * turn };
            Drawn::of(free, DVec3::ZERO, turn, limits)
        };
        let ends = [min, 0.5 * (min + max), max].map(|angle| {
            let drawn = drawn(angle);
            let (color, none) = if angle == min || angle == max {
                (DebugView::LIMIT_REACHED, DebugView::LIMIT)
            } else {
                (DebugView::LIMIT, DebugView::LIMIT_REACHED)
            };
            assert!(drawn.has(color) && !drawn.has(none));
            let ends = drawn.ends(color);
            for end in &ends {
                assert!(end.length() < ROUNDING || (end.length() - RADIUS).abs() < ROUNDING, "{end}");
            }
            (ends, hand(&drawn))
        });
        // The lines go from the middle to one end, along the arc, and back from the other.
        let [(at_min, first), (arc, middle), (at_max, last)] = &ends;
        assert_near(at_min[1], *first);
        assert_near(at_max[at_max.len() - 2], *last);
        let nearest = arc.iter().map(|end| end.distance(*middle)).fold(f64::INFINITY, f64::min);
        // Strokes are at most a twelfth of half a turn long.
        assert!(nearest < RADIUS * std::f64::consts::PI / 12.0, "{nearest}");
    }

    #[test]
    fn the_rim_of_a_cone_is_at_its_half_angles((y, z) in (0.1..3.0, 0.1..3.0), out in 0.0..1.5_f64) {
        let cone = Cone { half_angles: [y as Real, z as Real], gain: Gain::Rigid };
        let limits = Limits { cone: Some(cone), ..Limits::default() };
        // A rotation about y takes x to -z.
        prop_assume!((out - 1.0).abs() > 0.05 && out * y < 3.1);
        let drawn = Drawn::of(Axes::ANGULAR, DVec3::ZERO, DQuat::from_rotation_y(out * y), limits);
        let color = if out < 1.0 { DebugView::LIMIT } else { DebugView::LIMIT_REACHED };
        let ends = drawn.ends(color);
        assert_eq!(drawn.lines.iter().filter(|line| line.2 == color).count(), 20);
        let rim = [DQuat::from_rotation_y(y), DQuat::from_rotation_y(-y), DQuat::from_rotation_z(z), DQuat::from_rotation_z(-z)];
        for point in rim.map(|turn| turn * DVec3::X * RADIUS) {
            assert!(ends.iter().any(|end| end.distance(point) < ROUNDING), "{point} {ends:?}");
        }
        assert_near(hand(&drawn), DQuat::from_rotation_y(out * y) * DVec3::X * RADIUS);
    }

    /// The twist of a ball is what is left when its axis is brought back the shortest way.
    #[test]
    fn the_arc_of_a_twist_goes_with_the_swing(twist in -2.0..2.0, (y, z) in (-1.0..1.0, -1.0..1.0)) {
        let swing = DQuat::from_scaled_axis(DVec3::new(0.0, y, z));
        let limits = Limits::along(Axes::ANGULAR_X, Limit::new(-2.0, twist as Real));
        let drawn = Drawn::of(Axes::ANGULAR, DVec3::ZERO, swing * DQuat::from_rotation_x(twist), limits);
        let ends = drawn.ends(DebugView::LIMIT_REACHED);
        assert_near(ends[1], swing * DQuat::from_rotation_x(-2.0) * DVec3::Y * RADIUS);
        assert_near(ends[ends.len() - 2], hand(&drawn));
    }

    #[test]
    fn a_range_is_as_long_as_it_is((a, b) in (-3.0..3.0, -3.0..3.0), value in -3.0..3.0_f64) {
        let (min, max) = (f64::min(a, b), f64::max(a, b));
        prop_assume!(max - min > 0.1 && (value - min).abs() > 0.01 && (value - max).abs() > 0.01);
        let limits = Limits::along(Axes::LINEAR_Y, Limit::new(min as Real, max as Real));
        let drawn = Drawn::of(Axes::LINEAR_Y, DVec3::Y * value, DQuat::IDENTITY, limits);
        let color = if (min..max).contains(&value) { DebugView::LIMIT } else { DebugView::LIMIT_REACHED };
        let ends = drawn.ends(color);
        for bound in [min, max] {
            assert!(ends.iter().any(|end| end.distance(DVec3::Y * bound) < ROUNDING), "{bound} {ends:?}");
        }
        // A rope of which the second end is within reach or not.
        let (apart, length) = (DVec3::new(a, b, value), 3.0);
        prop_assume!((apart.length() - length).abs() > 0.01);
        let drawn = Drawn::of(Axes::LINEAR | Axes::ANGULAR, apart, DQuat::IDENTITY, Limits::rope(length as Real));
        let color = if apart.length() < length { DebugView::LIMIT } else { DebugView::LIMIT_REACHED };
        let ends = drawn.ends(color);
        assert_eq!(ends.len(), 2);
        assert_near(ends[0], DVec3::ZERO);
        assert_near(ends[1], apart);
    }
}

/// Of limits without a bound nothing but numbers is drawn; of one that does nothing, and of a joint
/// that is broken, none.
#[test]
fn what_does_nothing_is_not_drawn() {
    let open = Limit::new(Real::NEG_INFINITY, 0.5);
    let limits = Limits::along(Axes::LINEAR | Axes::ANGULAR, open);
    let drawn = Drawn::of(Axes::LINEAR | Axes::ANGULAR, DVec3::X * 0.2, DQuat::IDENTITY, limits);
    assert!(drawn.has(DebugView::LIMIT));
    assert!(drawn.lines.iter().all(|(from, to, _)| from.is_finite() && to.is_finite()));
    let locked = Drawn::of(Axes::LINEAR_X, DVec3::ZERO, DQuat::IDENTITY, Limits::along(Axes::ANGULAR_X, open));
    assert!(!locked.has(DebugView::LIMIT));

    let mut world = World::new();
    let mut body =
        || RigidBody::new(Shape::sphere(0.1)).without_collider().mass(1.0).build().unwrap().spawn(&mut world);
    let (a, b) = (body(), body());
    let joint = world.spawn((Joint::ball(a, b), Breakable::at_force(1.0)));
    let count = |world: &World| {
        let mut lines = 0;
        let view = DebugView { joints: Some(1.0), ..DebugView::nothing() };
        view.draw(world, &mut |_: Vec3, _: Vec3, _: [f32; 3]| lines += 1);
        lines
    };
    assert!(count(&world) > 0);
    world.get::<&mut Breakable>(joint).unwrap().is_broken = true;
    assert_eq!(count(&world), 0);
}
