//! Motion of a shape over a time interval: piecewise linear translation with uniform rotation.

use tumble_math::lane::{Quat, Vec3};
use tumble_math::rotate_exactly;

use crate::collider_shape::Isometry;
use crate::convex_pair::wide_placement;
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector, wide};

/// The most straight pieces of a course.
const MAX_LEGS: usize = 4;

/// How a shape moves over an interval of time: its body's centre of mass goes straight on, and
/// turns off a few times at most; the shape turns about it at an even rate. Moments are parts of
/// the interval, from 0 to 1.
///
/// ```
/// use tumble_collide::{Course, Isometry};
/// use tumble_math::lane::Vec3;
///
/// let (zero, along) = (Vec3::<f64>::zero(), Vec3::new(2.0, 0.0, 0.0));
/// let course = Course::new(&Isometry::at(zero), zero, along, zero);
/// assert_eq!(course.at(0.25).position, Vec3::new(0.5, 0.0, 0.0));
/// // From the middle of the interval on it goes upwards.
/// let turned_off = course.turned_off(0.5, Vec3::new(0.0, 2.0, 0.0));
/// assert_eq!(turned_off.at(1.0).position, Vec3::new(1.0, 1.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Course {
    start: Isometry<f64>,
    center: Vector,
    angular: Vector,
    /// When each begins, and how far it would go in the whole interval.
    legs: [(f64, Vector); MAX_LEGS],
    len: usize,
}

impl Course {
    /// Of a shape placed `at` in a body with the centre of mass `center` \[m\], which goes `linear`
    /// \[m\] in the interval and turns by `angular` \[rad\], about the direction of that vector.
    pub fn new<R: Scalar>(at: &Isometry<R>, center: Vec3<R>, linear: Vec3<R>, angular: Vec3<R>) -> Self {
        let mut legs = [(1.0, Vector::zero()); MAX_LEGS];
        legs[0] = (0.0, wide(linear));
        Self { start: wide_placement(at), center: wide(center), angular: wide(angular), legs, len: 1 }
    }

    /// The same up to a moment; from then on the centre goes `linear` \[m\] in a whole interval. A
    /// course that has turned off as often as it may goes on as it was.
    #[must_use]
    pub fn turned_off(&self, moment: f64, linear: Vec3<f64>) -> Self {
        let mut this = *self;
        this.len = self.legs().iter().filter(|(begin, _)| *begin < moment).count().max(1);
        if moment <= 0.0 {
            this.legs[0] = (0.0, linear);
        } else if let Some(leg) = this.legs.get_mut(this.len) {
            *leg = (moment, linear);
            this.len += 1;
        }
        this
    }

    /// The course of a part of the shape, placed `inner` in it.
    #[must_use]
    pub fn of_part<R: Scalar>(&self, inner: &Isometry<R>) -> Self {
        Self { start: self.start.then(&wide_placement(inner)), ..*self }
    }

    /// How far the centre would go in a whole interval \[m\], as it goes at a moment, or just
    /// after.
    #[must_use]
    pub fn linear(&self, moment: f64) -> Vec3<f64> {
        let legs = self.legs().iter().rev();
        legs.into_iter().find(|(begin, _)| *begin <= moment).map_or(self.legs[0].1, |(_, linear)| *linear)
    }

    /// How far the centre has gone \[m\].
    #[must_use]
    pub fn gone(&self, moment: f64) -> Vec3<f64> {
        let ends = self.legs().iter().skip(1).map(|(begin, _)| *begin).chain([1.0]);
        self.legs()
            .iter()
            .zip(ends)
            .fold(Vector::zero(), |sum, ((begin, linear), end)| sum + *linear * (end.min(moment) - begin).max(0.0))
    }

    /// Where the shape is.
    #[must_use]
    pub fn at(&self, moment: f64) -> Isometry<f64> {
        let center = self.center + self.gone(moment);
        let turn = self.turn(moment);
        let position = center + turn.rotate(self.start.position - self.center);
        Isometry { position, orientation: (turn * self.start.orientation).normalize() }
    }

    /// From one moment to another, as a course of its own.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        let mut legs = [(1.0, Vector::zero()); MAX_LEGS];
        legs[0] = (0.0, self.gone(to) - self.gone(from));
        let (center, _) = self.center_and_turn(from);
        Self { start: self.at(from), center, angular: self.angular * (to - from), legs, len: 1 }
    }

    /// Where the centre of mass is \[m\] at a moment, and how the body has turned since the
    /// beginning.
    #[must_use]
    pub fn center_and_turn(&self, moment: f64) -> (Vec3<f64>, Quat<f64>) {
        (self.center + self.gone(moment), self.turn(moment))
    }

    /// Whether it stays where it begins.
    pub(crate) fn is_still(&self) -> bool {
        let square = |v: Vector| v.dot(v);
        self.len == 1 && square(self.legs[0].1) == 0.0 && square(self.angular) == 0.0
    }

    /// Of a ball about what it turns about.
    pub(crate) fn of_center(&self) -> Self {
        let start = Isometry { position: self.center, ..self.start };
        Self { start, angular: Vector::zero(), ..*self }
    }

    /// When it begins to go another way, and 1.
    pub(crate) fn turns(&self) -> impl Iterator<Item = f64> {
        self.legs().iter().skip(1).map(|(begin, _)| *begin).chain([1.0])
    }

    /// The angle by which it turns in the interval, about its axis \[rad\].
    pub(crate) fn angular(&self) -> Vector {
        self.angular
    }

    /// How fast the shape can come further in a direction as it turns, of which no point is further
    /// than `radius` \[m\] from what it turns about.
    pub(crate) fn turning_rate(&self, shape: &Convex<'_>, radius: f64, direction: Vector) -> f64 {
        let length = |v: Vector| v.dot(v).sqrt();
        let turn = length(direction.cross(self.angular));
        if turn == 0.0 || !shape.is_axially_symmetric() {
            return turn * radius;
        }
        // Turning about its axis moves nothing of its outside; the axis stays at one angle to what
        // it turns about.
        let ([_, axis, _], apart) = (self.start.orientation.axes(), self.start.position - self.center);
        let along = axis.dot(apart);
        let (axis_turn, off_axis) = (length(axis.cross(self.angular)), length(apart - axis * along));
        (turn * radius).min(turn * off_axis + axis_turn * (radius - length(apart) + along.abs()))
    }

    /// How far the shape's origin is from what it turns about \[m\].
    pub(crate) fn off_center(&self) -> f64 {
        let apart = self.start.position - self.center;
        apart.dot(apart).sqrt()
    }

    pub(crate) fn turn(&self, moment: f64) -> Quat<f64> {
        let none = Quat::from_parts(1.0, Vector::zero());
        if self.angular.dot(self.angular) > 0.0 { rotate_exactly(none, self.angular, moment) } else { none }
    }

    /// Where a point of the shape that is at `point` at a moment was when the interval began; of
    /// what does not turn with it, only moved back.
    pub(crate) fn back(&self, point: Vector, moment: f64, turns: bool) -> Vector {
        let from_center = point - self.center - self.gone(moment);
        self.center + if turns { self.turn(moment).rotate_back(from_center) } else { from_center }
    }

    fn legs(&self) -> &[(f64, Vector)] {
        self.legs.get(..self.len).unwrap_or_default()
    }
}
