//! Debug drawing of the limits of a joint: arcs, ranges and cones in which it can be.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::debug_draw::{DebugView, Pen};
use crate::joints::axes::Axes;
use crate::joints::limits::{Cone, Limit, Limits};

/// Strokes of an arc, for each half turn that it has.
const SEGMENTS: f64 = 12.0;
/// Strokes of the rim of a cone.
const RIM: u32 = 16;
/// Nearer to a bound than this it is taken for reached: parts of the arrow's length for lengths,
/// \[rad\] for angles. It is less than can be seen.
const NEAR: f64 = 1e-2;

/// Where a joint stands, in double precision.
pub(crate) struct Standing {
    /// Points of both frames \[m\], world frame.
    pub(crate) anchors: [DVec3; 2],
    /// From each frame to the world.
    pub(crate) orientations: [DQuat; 2],
    pub(crate) free: Axes,
}

const UNITS: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];

impl Pen<'_> {
    /// The limits of a joint; arcs and cones have this radius \[m\].
    pub(crate) fn limits(&mut self, limits: &Limits, at: &Standing, radius: f64) {
        let limits = limits.within(at.free);
        for (axis, unit) in UNITS.into_iter().enumerate() {
            if let Some(limit) = limits.axes[axis] {
                self.range(&limit, at, at.orientations[0] * unit, radius);
            }
            if let Some(limit) = limits.axes[3 + axis] {
                limit.bounds_of_angle().into_iter().for_each(|bounds| self.arc(bounds, at, axis, radius));
            }
        }
        if let Some(limit) = limits.distance {
            let apart = at.apart();
            let is_reached = is_reached(limit.bounds(), apart.length(), NEAR * radius);
            self.line(at.anchors[0], at.anchors[0] + apart, color(is_reached));
        }
        if let Some(cone) = limits.cone {
            self.cone(&cone, at, radius);
        }
    }

    /// From one end of a translation to the other, with a stroke across at each.
    fn range(&mut self, limit: &Limit, at: &Standing, axis: DVec3, radius: f64) {
        let origin = at.anchors[0];
        let value = axis.dot(at.anchors[1] - origin);
        let color = color(is_reached(limit.bounds(), value, NEAR * radius));
        let bounds = limit.bounds();
        let across = axis.any_orthonormal_vector() * (0.25 * radius);
        for bound in bounds.into_iter().filter(|bound| bound.is_finite()) {
            let end = origin + axis * bound;
            self.line(end - across, end + across, color);
        }
        // Where it has no end it is drawn as far as it has come.
        let [from, to] = bounds.map(|bound| if bound.is_finite() { bound } else { value });
        self.line(origin + axis * from, origin + axis * to, color);
    }

    /// The arc in which the hand of a rotation can be, with a stroke from the middle to either end,
    /// and the hand.
    fn arc(&mut self, bounds: [f64; 2], at: &Standing, axis: usize, radius: f64) {
        let Turn { about, zero, hand } = at.turn(axis);
        let value = about.dot(zero.cross(hand)).atan2(zero.dot(hand));
        let color = color(is_reached(bounds, from_middle(bounds, value), NEAR));
        let origin = at.anchors[0];
        let at_angle = |angle: f64| origin + DQuat::from_axis_angle(about, angle) * zero * radius;
        let [min, max] = bounds;
        let count = ((max - min) / (0.5 * TAU) * SEGMENTS).ceil().max(1.0);
        let points = (0..=count as u32).map(|number| at_angle(min + (max - min) * f64::from(number) / count));
        let mut before = origin;
        for point in points.chain([origin]) {
            self.line(before, point, color);
            before = point;
        }
        self.line(origin, origin + hand * radius, DebugView::JOINT);
    }

    /// The rim of a cone, four strokes to it, and the axis that is to be within.
    fn cone(&mut self, cone: &Cone, at: &Standing, radius: f64) {
        let origin = at.anchors[0];
        let [a, b] = at.orientations.map(|orientation| UNITS.map(|unit| orientation * unit));
        let tangents = cone.half_angles.map(|angle| (0.5 * f64::from(angle)).tan());
        let [about_y, about_z] = tangents;
        let fall = 1.0 + a[0].dot(b[0]);
        let out = DVec3::new(a[1].dot(b[0]) / about_z, a[2].dot(b[0]) / about_y, 0.0).length() / fall;
        let color = color(out.is_nan() || out > 1.0 - NEAR);
        let on_rim = |turn: f64| {
            let (t, u) = (about_z * turn.cos(), about_y * turn.sin());
            let square = t * t + u * u;
            origin + (a[0] * (1.0 - square) + (a[1] * t + a[2] * u) * 2.0) * (radius / (1.0 + square))
        };
        let point = |number: u32| on_rim(TAU * f64::from(number) / f64::from(RIM));
        for number in 0..RIM {
            self.line(point(number), point(number + 1), color);
            if number % (RIM / 4) == 0 {
                self.line(origin, point(number), color);
            }
        }
        self.line(origin, origin + b[0] * radius, DebugView::JOINT);
    }
}

/// A rotation as a hand that goes round.
struct Turn {
    about: DVec3,
    /// Where the hand is at zero.
    zero: DVec3,
    hand: DVec3,
}

impl Standing {
    /// From the first point to the second, along the free translations.
    fn apart(&self) -> DVec3 {
        let gap = self.anchors[1] - self.anchors[0];
        let axes = UNITS.map(|unit| self.orientations[0] * unit);
        (0..3).filter(|axis| self.free.has(*axis)).map(|axis| axes[axis] * axes[axis].dot(gap)).sum()
    }

    /// The rotation about an axis.
    fn turn(&self, axis: usize) -> Turn {
        let [a, b] = self.orientations.map(|orientation| UNITS.map(|unit| orientation * unit));
        let others: Vec<usize> = (0..3).filter(|other| *other != axis && self.free.has(3 + other)).collect();
        let next = (axis + 1) % 3;
        match others.as_slice() {
            // About the first axis of the first body, then the other one of the second.
            [other] if axis < *other => Turn { about: a[axis], zero: a[*other], hand: b[*other] },
            [other] => Turn { about: b[axis], zero: a[*other], hand: b[*other] },
            [] => Turn { about: a[axis], zero: a[next], hand: b[next] },
            // What is left of a rotation when the axis has been brought back the shortest way.
            _ => Turn { about: b[axis], zero: DQuat::from_rotation_arc(a[axis], b[axis]) * a[next], hand: b[next] },
        }
    }
}

/// An angle, gone round to where it is nearest to the middle of its range.
fn from_middle([min, max]: [f64; 2], angle: f64) -> f64 {
    let middle = 0.5 * (min + max);
    angle - TAU * ((angle - middle) / TAU).round()
}

/// Whether it is at a bound or past it.
fn is_reached([min, max]: [f64; 2], value: f64, near: f64) -> bool {
    value < min + near || value > max - near
}

fn color(is_reached: bool) -> [f32; 3] {
    if is_reached { DebugView::LIMIT_REACHED } else { DebugView::LIMIT }
}
