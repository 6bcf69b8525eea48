//! When shapes on their ways meet.
//!
//! Conservative advancement (B. Mirtich, "Impulse-based dynamic simulation of rigid body systems",
//! 1996): at a distance `d` along the unit vector `n` nothing can meet before `d` is gone at the
//! greatest rate at which any points of both shapes come together along `n`.

use std::cell::Cell;

use crate::collider_shape::{ColliderShape, Isometry};
use crate::contact_manifolds;
use crate::convex_pair::difference;
use crate::course::Course;
use crate::gjk::{Nearest, nearest_again};
use crate::manifold::{ContactPoint, Manifold, Points};
use crate::minkowski::Difference;
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector, narrow};
use crate::surface::normal_of;
use crate::surface_cast::with_surface;
use crate::triangle_approach::triangle_approach;
use crate::work;

/// A way is followed in at most this number of advances for each half turn, and for that many of
/// these; what has not met by then may meet.
const MAX_ADVANCES: usize = 48;
const MAX_HALF_TURNS: usize = 64;
/// Shapes that come this many times as near as what counts as meeting are sought the moment for
/// when they are nearest.
const NEARLY: f64 = 8.0;
/// The distance stays as it is where it changes by less than this part of how fast it may.
const STEADY: f64 = 1e-6;
/// How often the span of time in which that is is halved.
const HALVED: usize = 7;

/// Shapes that meet, or pass each other closely.
///
/// ```
/// use tumble_collide::{Course, ColliderShape, Meeting, Isometry};
/// use tumble_math::lane::Vec3;
///
/// let (zero, sphere) = (Vec3::<f64>::zero(), ColliderShape::Sphere { radius: 0.5 });
/// let wall = ColliderShape::Cuboid { half_extents: Vec3::new(0.1, 2.0, 2.0) };
/// let stays = Course::new(&Isometry::at(zero), zero, zero, zero);
/// let shot = |y: f64| {
///     let at = Vec3::new(-5.6, y, 0.0);
///     Course::new(&Isometry::at(at), at, Vec3::new(10.0, 0.0, 0.0), zero)
/// };
/// // Half a metre of radius before the wall after half of ten metres.
/// let met = Meeting::find([&wall, &sphere], [&stays, &shot(0.0)], 1e-6, 0.0).unwrap();
/// assert!(met.is_hit && (met.moment - 0.5).abs() < 1e-6);
/// assert!(Meeting::find([&wall, &sphere], [&stays, &shot(2.6)], 1e-6, 0.0).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// When, as a part of the interval.
    pub moment: f64,
    /// Whether they touch then; otherwise they are as near as they get, or that is not known.
    pub is_hit: bool,
    /// How far they are apart then \[m\].
    pub distance: f64,
    /// From the first to the second, unit vector, world frame; zero where they overlap.
    pub normal: tumble_math::lane::Vec3<f64>,
}

/// What points of contact go along with between the beginning of an interval and a meeting.
///
/// ```
/// use tumble_collide::{ColliderShape, Course, Follow, Isometry, Meeting};
/// use tumble_math::lane::Vec3;
///
/// let (zero, sphere) = (Vec3::<f64>::zero(), ColliderShape::Sphere { radius: 0.5_f64 });
/// let stays = Course::new(&Isometry::at(zero), zero, zero, zero);
/// let at = Vec3::new(-3.0, 0.6, 0.0);
/// let shot = Course::new(&Isometry::at(at), at, Vec3::new(4.0, 0.0, 0.0), zero);
/// let (pair, courses) = ([&sphere, &sphere], [&stays, &shot]);
/// let met = Meeting::find(pair, courses, 1e-9, 0.0).unwrap();
/// // They meet with centres 0.6 m apart across the way and 0.8 m along it: 2.2 m are left.
/// met.manifolds(pair, courses, [0.01, 0.01], Follow::Centers, &mut |_, manifold| {
///     assert!((manifold.normal.x + 0.8).abs() < 1e-6);
///     assert!((manifold.points()[0].separation - 0.8 * 2.2).abs() < 1e-6);
/// });
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follow {
    /// With the bodies as they move and turn.
    Bodies,
    /// With the centres of mass, as those of what is round: it turns under them.
    Centers,
    /// With the second body's centre of mass, and separations grow backwards in time by the
    /// velocities with which the points meet: as the two move straight on and turn at an even rate.
    Velocities,
}

/// Two convex shapes on their ways.
pub(crate) struct Moving<'a> {
    pub(crate) shapes: [Convex<'a>; 2],
    /// Of both together.
    pub(crate) layers: f64,
    pub(crate) courses: [&'a Course; 2],
    /// How far points are from what they turn about at most.
    pub(crate) radii: [f64; 2],
    /// Where they are at the beginning.
    pub(crate) start: [Isometry<f64>; 2],
    /// The direction in which they were nearest when that was last sought, as the first has it.
    near: Cell<Option<Vector>>,
}

/// Where shapes are when their courses begin.
pub(crate) fn starts(courses: [&Course; 2]) -> [Isometry<f64>; 2] {
    courses.map(|course| course.at(0.0))
}

/// How far two shapes are apart at some moment, and the unit vector from the first to the second.
pub(crate) struct Gap {
    pub(crate) distance: f64,
    pub(crate) normal: Vector,
    /// Of the first, inside its layer, the nearest point; world frame.
    pub(crate) on_first: Vector,
}

/// What comes of shapes on their ways.
pub(crate) enum Advance {
    Met(Meeting),
    /// They pass each other closely, somewhere in a span of time.
    Near([f64; 2]),
}

impl Meeting {
    /// The first of two shapes on their ways, or the nearest that they come to each other if that
    /// is nearer than `slack` \[m\]. What is nearer than `tolerance` \[m\], above zero, meets. None
    /// of compounds, half-spaces, and two surfaces. A surface is met from outside.
    pub fn find<R: Scalar>(
        shapes: [&ColliderShape<R>; 2],
        courses: [&Course; 2],
        tolerance: f64,
        slack: f64,
    ) -> Option<Self> {
        match shapes {
            [ColliderShape::Mesh(mesh), other] => with_surface(mesh.as_ref(), other, courses, (tolerance, slack)),
            [ColliderShape::HeightField(field), other] => {
                with_surface(field.as_ref(), other, courses, (tolerance, slack))
            }
            [other, surface @ (ColliderShape::Mesh(_) | ColliderShape::HeightField(_))] => {
                let [a, b] = courses;
                let met = Self::find([surface, other], [b, a], tolerance, slack);
                met.map(|met| Self { normal: met.normal * -1.0, ..met })
            }
            [first, second] => {
                let moving = Moving::new(Convex::of(first)?, Convex::of(second)?, [first, second], courses);
                if moving.are_passed(tolerance, slack) { None } else { moving.meet(tolerance, slack) }
            }
        }
    }

    /// Shows the manifolds that two shapes have when they meet, as [`contact_manifolds`] has them,
    /// laid back to the beginning of the interval: with separations that are used up at the
    /// meeting. They have all points that are nearer than `margin` \[m\] then, and one that is
    /// nearer than `near` \[m\].
    pub fn manifolds<R: Scalar>(
        &self,
        [first, second]: [&ColliderShape<R>; 2],
        courses: [&Course; 2],
        [near, margin]: [R; 2],
        follow: Follow,
        visit: &mut impl FnMut(u32, &Manifold<R>),
    ) {
        let [first_at, second_at] = courses.map(|course| narrow_placement::<R>(&course.at(self.moment)));
        contact_manifolds(first, &first_at, second, &second_at, margin, &mut |part, manifold| {
            if manifold.points().iter().any(|point| point.separation <= near) {
                visit(part, &laid_back(manifold, courses, self.moment, follow));
            }
        });
    }
}

impl<'a> Moving<'a> {
    pub(crate) fn new<R: Scalar>(
        (first, layer): (Convex<'a>, f64),
        (second, other_layer): (Convex<'a>, f64),
        shapes: [&ColliderShape<R>; 2],
        courses: [&'a Course; 2],
    ) -> Self {
        let reach = |which: usize, layer: f64| {
            let reach: f64 = shapes[which].reach().map_or(0.0, Into::into);
            courses[which].off_center() + (reach - layer).max(0.0)
        };
        let radii = [reach(0, layer), reach(1, other_layer)];
        Self::of_cores([first, second], layer + other_layer, courses, (radii, starts(courses)))
    }

    /// Of what is inside layers, whose sum is `layers` \[m\], with the radii and places of both.
    pub(crate) fn of_cores(
        shapes: [Convex<'a>; 2],
        layers: f64,
        courses: [&'a Course; 2],
        (radii, start): ([f64; 2], [Isometry<f64>; 2]),
    ) -> Self {
        Self { shapes, layers, courses, radii, start, near: Cell::default() }
    }

    /// Whether balls around both pass each other, or a ball around one passes the other, which turn
    /// as they like, or they stay apart along the direction in which they are nearest first.
    pub(crate) fn are_passed(&self, tolerance: f64, slack: f64) -> bool {
        let turns = self.courses.map(|course| course.angular().dot(course.angular()) > 0.0);
        let stays_apart = |gap: Gap| self.least_until(&gap, 0.0, 1.0) > tolerance.max(slack);
        self.are_balls_passed([true, true], tolerance, slack)
            || self.gap(0.0).is_some_and(stays_apart)
            || (turns[1] && !turns[0] && self.are_balls_passed([false, true], tolerance, slack))
            || (turns[0] && !turns[1] && self.are_balls_passed([true, false], tolerance, slack))
    }

    /// Whether they pass each other with balls around those that are `wrapped`.
    pub(crate) fn are_balls_passed(&self, wrapped: [bool; 2], tolerance: f64, slack: f64) -> bool {
        let more = (0..2).filter(|i| wrapped[*i]).fold(0.0, |sum, i| sum + self.radii[i]);
        let shapes = [0, 1].map(|i: usize| if wrapped[i] { Convex::Point } else { self.shapes[i] });
        let courses = [0, 1].map(|i: usize| if wrapped[i] { self.courses[i].of_center() } else { *self.courses[i] });
        let courses = courses.each_ref();
        let radii = [0, 1].map(|i: usize| if wrapped[i] { 0.0 } else { self.radii[i] });
        let start = [0, 1].map(|i: usize| if wrapped[i] { courses[i].at(0.0) } else { self.start[i] });
        Moving::of_cores(shapes, self.layers + more, courses, (radii, start)).meet(tolerance, slack).is_none()
    }

    /// Where one of them is.
    fn at(&self, which: usize, moment: f64) -> Isometry<f64> {
        let course = self.courses[which];
        if moment == 0.0 || course.is_still() { self.start[which] } else { course.at(moment) }
    }

    pub(crate) fn gap(&self, moment: f64) -> Option<Gap> {
        let (first_at, second_at) = (self.at(0, moment), self.at(1, moment));
        if let [Convex::Point, Convex::Point] = self.shapes {
            // No axes are needed.
            let between = first_at.to_local(second_at.position);
            let length = between.dot(between).sqrt();
            let normal = if length > 0.0 { between * (1.0 / length) } else { Vector::zero() };
            let normal = first_at.orientation.rotate(normal);
            let is_somewhere = length < f64::INFINITY;
            return is_somewhere.then_some(Gap { distance: length - self.layers, normal, on_first: first_at.position });
        }
        let shapes = difference(self.shapes[0], &first_at, self.shapes[1], &second_at)?;
        Some(match apart(&shapes, self.near.get()) {
            Some((length, normal, on_first)) => {
                self.near.set(Some(normal));
                let normal = first_at.orientation.rotate(normal);
                Gap { distance: length - self.layers, normal, on_first: first_at.to_world(on_first) }
            }
            None => Gap { distance: -self.layers, normal: Vector::zero(), on_first: first_at.position },
        })
    }

    /// How fast they can come together along a unit vector from the first to the second, in a leg
    /// in which the second goes `way` past the first.
    pub(crate) fn rate(&self, way: Vector, normal: Vector) -> f64 {
        self.turning_rate(normal) - way.dot(normal)
    }

    /// The part of the rate that comes of turning.
    fn turning_rate(&self, normal: Vector) -> f64 {
        let rate = |which: usize| self.courses[which].turning_rate(&self.shapes[which], self.radii[which], normal);
        rate(0) + rate(1)
    }

    /// No distance from a moment on up to another, or before it from that one on, is less than
    /// this, where they have this gap at the moment.
    pub(crate) fn least_until(&self, gap: &Gap, moment: f64, end: f64) -> f64 {
        let from = moment.min(end);
        let turns = self.courses.into_iter().flat_map(Course::turns);
        let legs = turns.filter(|turn| (from..moment.max(end)).contains(turn)).chain([from]);
        // Backwards in time all goes the other way.
        let sign = if end < moment { 1.0 } else { -1.0 };
        let along = legs.fold(f64::NEG_INFINITY, |most, leg| most.max(sign * self.way(leg).dot(gap.normal)));
        gap.distance - (self.turning_rate(gap.normal) + along).max(0.0) * (end - moment).abs()
    }

    pub(crate) fn way(&self, moment: f64) -> Vector {
        self.courses[1].linear(moment) - self.courses[0].linear(moment)
    }

    fn meet(&self, tolerance: f64, slack: f64) -> Option<Meeting> {
        match self.advance(tolerance, slack, f64::INFINITY)? {
            Advance::Met(met) => Some(met),
            Advance::Near(span) => self.nearest(span, slack),
        }
    }

    /// Follows them up to a moment; `None` where they stay apart, or meet later.
    pub(crate) fn advance(&self, tolerance: f64, slack: f64, until: f64) -> Option<Advance> {
        let (mut now, mut before) = (0.0, 0.0);
        let mut nearest: Option<(f64, [f64; 2])> = None;
        for _ in 0..self.most_advances() {
            work::compared(1);
            let gap = self.gap(now)?;
            if gap.distance <= tolerance {
                let Gap { distance, normal, .. } = gap;
                return Some(Advance::Met(Meeting { moment: now, is_hit: true, distance, normal }));
            }
            let end = self.courses.iter().flat_map(|course| course.turns()).filter(|end| *end > now);
            let end = end.fold(1.0, f64::min);
            let rate = self.rate(self.way(now), gap.normal);
            let passes = rate * (end - now) < gap.distance - tolerance;
            let next = if passes { end } else { now + (gap.distance - 0.5 * tolerance) / rate };
            match &mut nearest {
                Some((least, _)) if gap.distance >= *least => {}
                _ => nearest = Some((gap.distance, [before, next])),
            }
            if next >= 1.0 {
                let (least, span) = nearest?;
                return (least <= NEARLY * slack).then_some(Advance::Near(span));
            }
            (before, now) = (now, next);
            if now >= until {
                return None;
            }
        }
        // They graze each other for long: from here on anything may be.
        let Gap { distance, normal, .. } = self.gap(now)?;
        Some(Advance::Met(Meeting { moment: now, is_hit: false, distance, normal }))
    }

    fn most_advances(&self) -> usize {
        let square = |course: &&Course| course.angular().dot(course.angular());
        let [a, b] = self.courses.each_ref().map(square);
        let half_turns = (a.max(b).sqrt() / std::f64::consts::PI) as usize;
        MAX_ADVANCES * (1 + half_turns).min(MAX_HALF_TURNS)
    }

    /// When they are nearest within a span of time, if that is near enough: until then they come
    /// together, and from then on they part.
    pub(crate) fn nearest(&self, [mut low, mut high]: [f64; 2], slack: f64) -> Option<Meeting> {
        let high_end = high;
        for _ in 0..HALVED {
            let moment = 0.5 * (low + high);
            let gap = self.gap(moment)?;
            if [low, high].into_iter().all(|end| self.least_until(&gap, moment, end) > slack) {
                return None;
            }
            let way = self.way(moment);
            let (rate, most) = (self.opening_rate(&gap, moment), way.dot(way).sqrt() + self.turning_rate(gap.normal));
            // Beside a face nothing changes, and the middle is furthest from its edges.
            if rate.abs() <= STEADY * most {
                (low, high) = (moment, moment);
                break;
            }
            (low, high) = if rate > 0.0 { (low, moment) } else { (moment, high) };
        }
        let moment = if high == high_end { high } else { 0.5 * (low + high) };
        let Gap { distance, normal, .. } = self.gap(moment)?;
        (distance <= slack).then_some(Meeting { moment, is_hit: distance <= 0.0, distance, normal })
    }

    /// How fast the nearest points part.
    pub(crate) fn opening_rate(&self, gap: &Gap, moment: f64) -> f64 {
        let points = [gap.on_first, gap.on_first + gap.normal * (gap.distance + self.layers)];
        let [first, second] = [0, 1].map(|which: usize| {
            let course = self.courses[which];
            let arm = points[which] - course.center_and_turn(moment).0;
            course.linear(moment) + course.angular().cross(arm)
        });
        gap.normal.dot(second - first)
    }
}

/// The distance of two shapes that do not overlap, the unit vector from the first to the second and
/// the nearest point of the first, in its frame.
fn apart(shapes: &Difference<'_>, near: Option<Vector>) -> Option<(f64, Vector, Vector)> {
    match (shapes.first, shapes.second) {
        (Convex::Triangle(corners), Convex::Point | Convex::Segment { .. } | Convex::Cuboid { .. }) => {
            let found = triangle_approach(shapes, normal_of(&corners), f64::INFINITY)?;
            (found.between > 0.0).then_some((found.between, found.normal, found.on_first))
        }
        _ => match nearest_again(shapes, near) {
            Nearest::Apart { between, on_first } => {
                let length = between.dot(between).sqrt();
                Some((length, between * (1.0 / length), on_first))
            }
            Nearest::Far | Nearest::Overlap(_) => None,
        },
    }
}

pub(crate) fn furthest_from_origin(corners: [Vector; 3]) -> f64 {
    corners.iter().fold(0.0, |most, corner| f64::max(most, corner.dot(*corner).sqrt()))
}

fn narrow_placement<R: Scalar>(at: &Isometry<f64>) -> Isometry<R> {
    let tumble_math::lane::Quat { x, y, z, w } = at.orientation;
    let orientation = tumble_math::lane::Quat { x: R::splat(x), y: R::splat(y), z: R::splat(z), w: R::splat(w) };
    Isometry { position: narrow(at.position), orientation }
}

/// A manifold of some moment, as it lies when the interval begins.
fn laid_back<R: Scalar>(manifold: &Manifold<R>, courses: [&Course; 2], moment: f64, follow: Follow) -> Manifold<R> {
    let turns = follow == Follow::Bodies;
    let carried: f64 = if follow == Follow::Velocities { 1.0 } else { manifold.carried.into() };
    let normal = crate::support_map::wide(manifold.normal);
    // The normal turns with what does not carry the points.
    let reference = courses[usize::from(carried < 0.5 - 1e-3)];
    let before = if turns { reference.turn(moment).rotate_back(normal) } else { normal };
    let mut points = Points::none();
    for point in manifold.points() {
        let (middle, separation): (Vector, f64) = (crate::support_map::wide(point.position), point.separation.into());
        let half = normal * (0.5 * separation);
        let on_first = courses[0].back(middle - half, moment, turns);
        let on_second = courses[1].back(middle + half, moment, turns);
        let turning = if follow == Follow::Velocities { turning_speed(courses, moment, middle, normal) } else { 0.0 };
        let apart = before.dot(on_second - on_first) - turning * moment;
        // What swings around may begin behind the plane that it meets.
        let separation = if moment > 0.0 { apart.max(0.0) } else { apart };
        let half = before * (0.5 * separation);
        let position = (on_first + half) * (1.0 - carried) + (on_second - half) * carried;
        points.push(ContactPoint {
            position: narrow(position),
            separation: R::splat(separation),
            feature: point.feature,
        });
    }
    Manifold::new(narrow(before), R::splat(carried), points)
}

/// How fast two bodies that turn part at a point, along a normal, but for how their centres move.
fn turning_speed(courses: [&Course; 2], moment: f64, point: Vector, normal: Vector) -> f64 {
    let [first, second] = courses.map(|course| {
        let arm = point - course.center_and_turn(moment).0;
        course.angular().cross(arm)
    });
    normal.dot(second - first)
}
