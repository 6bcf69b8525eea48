//! When a convex shape on its way meets a surface of triangles.

use crate::aabb::Aabb;
use crate::cast::{Advance, Meeting, Moving, furthest_from_origin, starts};
use crate::collider_shape::{ColliderShape, Isometry};
use crate::course::Course;
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector};
use crate::surface::{Surface, normal_of};
use crate::triangle_approach::distance_to;

/// Past more triangles of a surface no way is gone along: something may meet at once.
const MAX_TRIANGLES: usize = 4096;

/// The first meeting of a convex shape with a surface.
pub(crate) fn with_surface<R: Scalar>(
    surface: &impl Surface,
    shape: &ColliderShape<R>,
    courses: [&Course; 2],
    (tolerance, slack): (f64, f64),
) -> Option<Meeting> {
    let (convex, layer) = Convex::of(shape)?;
    let reach: f64 = shape.reach()?.into();
    let start = starts(courses);
    let mut triangles = Vec::new();
    let aabb = around_way(courses, &start[0], reach + slack + tolerance);
    surface.near(&aabb, &mut |triangle| triangles.push(triangle));
    if triangles.len() > MAX_TRIANGLES {
        return Some(Meeting { moment: 0.0, is_hit: false, distance: f64::INFINITY, normal: Vector::zero() });
    }
    triangles.sort_unstable();
    let radius = courses[1].off_center() + (reach - layer).max(0.0);
    OnSurface { surface, convex, layer, courses, start, radius, tolerance, slack }.first(&triangles)
}

/// The box, as a surface sees it, of what reaches so far from a body on its way.
fn around_way(courses: [&Course; 2], ground: &Isometry<f64>, reach: f64) -> Aabb<f64> {
    let turned = {
        let angle = courses[0].angular();
        angle.dot(angle).sqrt()
    };
    let moments = courses[0].turns().chain(courses[1].turns()).chain([0.0]);
    moments.fold(Aabb::empty(), |aabb, moment| {
        let body = courses[1].at(moment).position - courses[0].gone(moment);
        let from_center = body - ground.position;
        // What turns by an angle moves by no more than that times its distance.
        let more =
            reach + courses[1].off_center() + turned * (from_center.dot(from_center).sqrt() + courses[0].off_center());
        aabb.union(&Aabb::about(ground.to_local(body), Vector::splat(more)))
    })
}

/// A convex shape and a surface on their ways.
struct OnSurface<'a, S> {
    surface: &'a S,
    convex: Convex<'a>,
    layer: f64,
    courses: [&'a Course; 2],
    start: [Isometry<f64>; 2],
    /// How far points of the convex shape are from what they turn about.
    radius: f64,
    tolerance: f64,
    slack: f64,
}

impl<'a, S: Surface> OnSurface<'a, S> {
    fn moving(&self, corners: [Vector; 3]) -> Moving<'a> {
        let radii = [self.courses[0].off_center() + furthest_from_origin(corners), self.radius];
        let shapes = [Convex::Triangle(corners), self.convex];
        Moving::of_cores(shapes, self.layer, self.courses, (radii, self.start))
    }

    /// The first meeting with any of these triangles.
    fn first(&self, triangles: &[u32]) -> Option<Meeting> {
        let (tolerance, slack) = (self.tolerance, self.slack);
        let around = ball_around(self.courses, &self.start[0]);
        let most = self.radius + self.layer + slack.max(tolerance);
        let (mut first, mut passed): (Option<Meeting>, _) = (None, Vec::new());
        for &triangle in triangles {
            let corners = self.surface.triangle(triangle);
            let normal = normal_of(&corners);
            let moving = self.moving(corners);
            let is_passed = match around {
                Some((middle, far)) => distance_to(&corners, normal, middle) > far + most,
                None => moving.are_passed(tolerance, slack),
            };
            if is_passed || moving.stays_over(normal, corners[0], tolerance) {
                continue;
            }
            let until = first.filter(|first| first.is_hit).map_or(f64::INFINITY, |first| first.moment);
            match moving.advance(tolerance, slack, until) {
                Some(Advance::Met(met)) => self.take(met, triangle, &mut first),
                Some(Advance::Near(span)) => passed.push((triangle, span)),
                None => {}
            }
        }
        // What is only passed counts where nothing is met.
        if !first.is_some_and(|first| first.is_hit) {
            for (triangle, span) in passed {
                if let Some(met) = self.moving(self.surface.triangle(triangle)).nearest(span, slack) {
                    self.take(met, triangle, &mut first);
                }
            }
        }
        first
    }

    /// Keeps a meeting that is earlier than the first, if the shape is before the triangle then.
    fn take(&self, met: Meeting, triangle: u32, first: &mut Option<Meeting>) {
        let [ground, body] = self.courses.map(|course| course.at(met.moment));
        let middle = ground.to_local(body.to_world(self.convex.middle()));
        let [corner, ..] = self.surface.triangle(triangle);
        let is_before = self.surface.normal(triangle).dot(middle - corner) > 0.0;
        let key = |met: &Meeting| (!met.is_hit, met.moment);
        if is_before && first.as_ref().is_none_or(|first| key(&met) < key(first)) {
            *first = Some(met);
        }
    }
}

/// The middle of the way of the second's centre, as a first that stays sees it, and how far the
/// centre is from there at most.
fn ball_around(courses: [&Course; 2], ground: &Isometry<f64>) -> Option<(Vector, f64)> {
    let center = courses[1].of_center();
    let (from, to) = (center.at(0.0).position, center.at(1.0).position);
    let middle = (from + to) * 0.5;
    let radius = center.turns().chain([0.0]).fold(0.0, |most, moment| {
        let apart = center.at(moment).position - middle;
        f64::max(most, apart.dot(apart))
    });
    courses[0].is_still().then(|| (ground.to_local(middle), radius.sqrt()))
}

impl Moving<'_> {
    /// Whether the second stays on its side of the plane of a face of the first, given by its
    /// outward normal and a point in the frame of the first.
    fn stays_over(&self, normal: Vector, point: Vector, tolerance: f64) -> bool {
        let [ground, body] = self.start;
        let up = ground.orientation.rotate(normal);
        let lowest = body.to_world(self.shapes[1].support(body.orientation.rotate_back(up * -1.0)));
        let mut height = up.dot(lowest - ground.to_world(point)) - self.layers;
        // What begins below is not held by this face.
        if height < 0.0 {
            return false;
        }
        let mut begin = 0.0;
        while begin < 1.0 {
            let later = self.courses.iter().flat_map(|course| course.turns()).filter(|end| *end > begin);
            let end = later.fold(1.0, f64::min);
            height -= self.rate(self.way(begin), up).max(0.0) * (end - begin);
            begin = end;
        }
        height > 0.25 * tolerance
    }
}
