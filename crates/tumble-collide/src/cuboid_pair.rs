//! Two boxes: the axis that separates them most, and the points where the faces or edges that it belongs to meet.
//!
//! The separating axis test over the three face normals of each and the nine products of their edges (S. Gottschalk, M. Lin, D. Manocha, "OBBTree",
//! SIGGRAPH 1996); the points of a face contact are the face of one box that looks against the axis, clipped to the face of the other (Sutherland and Hodgman, 1974).

use tumble_math::lane::Vec3;

use crate::geometry::Placement;
use crate::manifold::{ContactPoint, Manifold, Points};
use crate::reduction::reduce;
use crate::scalar::Scalar;

/// An edge axis must separate by so much more \[m\] than the best face to be taken: a face holds a body better, and a choice that
/// changes back and forth holds it worst.
const EDGE_LEAD: f64 = 5e-4;
/// And a face of the second box by so much more than one of the first.
const SECOND_LEAD: f64 = 2.5e-4;
/// Edges at a smaller sine of the angle between them are parallel: a face separates as well.
const LEAST_SINE: f64 = 5e-3;

/// A box seen from the world.
#[derive(Clone, Copy)]
struct Oriented<R> {
    center: Vec3<R>,
    axes: [Vec3<R>; 3],
    half: [R; 3],
}

impl<R: Scalar> Oriented<R> {
    fn new(half: Vec3<R>, at: &Placement<R>) -> Self {
        Self { center: at.position, axes: at.orientation.axes(), half: [half.x, half.y, half.z] }
    }

    /// How far the box reaches from its centre along a unit vector.
    fn reach(&self, axis: Vec3<R>) -> R {
        let [x, y, z] = self.axes;
        axis.dot(x).abs() * self.half[0] + axis.dot(y).abs() * self.half[1] + axis.dot(z).abs() * self.half[2]
    }
}

/// What the least overlap, or the widest gap, is between.
#[derive(Clone, Copy)]
enum Between {
    FaceOfFirst(usize),
    FaceOfSecond(usize),
    Edges(usize, usize),
}

pub(crate) fn cuboid_and_cuboid<R: Scalar>(
    first: Vec3<R>,
    first_at: &Placement<R>,
    second: Vec3<R>,
    second_at: &Placement<R>,
    margin: R,
) -> Manifold<R> {
    let (a, b) = (Oriented::new(first, first_at), Oriented::new(second, second_at));
    let apart = b.center - a.center;
    let mut best: Option<(R, Between)> = None;
    // Whether some axis keeps them further apart than the margin; what is not finite is not near.
    let mut consider = |separation: R, between: Between, lead: R| {
        if best.is_none_or(|(best, _)| separation > best + lead) {
            best = Some((separation, between));
        }
        separation <= margin
    };
    for i in 0..3 {
        let axis = a.axes[i];
        let separation = axis.dot(apart).abs() - (a.half[i] + b.reach(axis));
        if !consider(separation, Between::FaceOfFirst(i), R::splat(0.0)) {
            return Manifold::none();
        }
    }
    for j in 0..3 {
        let axis = b.axes[j];
        let separation = axis.dot(apart).abs() - (b.half[j] + a.reach(axis));
        if !consider(separation, Between::FaceOfSecond(j), R::splat(SECOND_LEAD)) {
            return Manifold::none();
        }
    }
    let mut best_edges: Option<(R, [usize; 2])> = None;
    for (i, j) in (0..9).map(|pair| (pair / 3, pair % 3)) {
        if let Some(axis) = edge_axis(&a, &b, i, j) {
            let separation = axis.dot(apart).abs() - (a.reach(axis) + b.reach(axis));
            if separation > margin {
                return Manifold::none();
            }
            if best_edges.is_none_or(|(best, _)| separation > best) {
                best_edges = Some((separation, [i, j]));
            }
        }
    }
    // Among edges the best has to be taken: the nearest points of others may be past their ends.
    if let Some((separation, [i, j])) = best_edges {
        consider(separation, Between::Edges(i, j), R::splat(EDGE_LEAD));
    }
    match best {
        Some((_, Between::FaceOfFirst(i))) => face_contact(&a, i, &b, 0, margin),
        Some((_, Between::FaceOfSecond(j))) => face_contact(&b, j, &a, 1, margin).swapped(),
        Some((separation, Between::Edges(i, j))) => edge_contact(&a, i, &b, j, separation, margin),
        None => Manifold::none(),
    }
}

/// The common perpendicular of an edge of each; `None` where they are parallel.
fn edge_axis<R: Scalar>(a: &Oriented<R>, b: &Oriented<R>, i: usize, j: usize) -> Option<Vec3<R>> {
    let axis = a.axes[i].cross(b.axes[j]);
    let length = axis.dot(axis).sqrt();
    (length > R::splat(LEAST_SINE)).then(|| axis * (R::splat(1.0) / length))
}

/// `value` with the sign of `of`.
fn signed<R: Scalar>(value: R, of: R) -> R {
    if of < R::splat(0.0) { -value } else { value }
}

/// The points of an edge of each where they are nearest to each other: one contact.
fn edge_contact<R: Scalar>(
    a: &Oriented<R>,
    i: usize,
    b: &Oriented<R>,
    j: usize,
    separation: R,
    margin: R,
) -> Manifold<R> {
    let Some(axis) = edge_axis(a, b, i, j) else { return Manifold::none() };
    let apart = b.center - a.center;
    let normal = axis * signed(R::splat(1.0), axis.dot(apart));
    // The edges' middles: of the first as far along the normal as it reaches, of the second against it.
    let (mut on_a, mut on_b) = (a.center, b.center);
    let (mut corner_a, mut corner_b) = (0, 0);
    for k in 0..3 {
        if k != i {
            let along = normal.dot(a.axes[k]);
            on_a = on_a + a.axes[k] * signed(a.half[k], along);
            corner_a |= u32::from(along < R::splat(0.0)) << k;
        }
        if k != j {
            let along = normal.dot(b.axes[k]);
            on_b = on_b - b.axes[k] * signed(b.half[k], along);
            corner_b |= u32::from(along < R::splat(0.0)) << k;
        }
    }
    // Of the lines p + s d and q + t e, the points whose difference is perpendicular to both.
    let (d, e, r) = (a.axes[i], b.axes[j], on_b - on_a);
    let across = d.dot(e);
    let t = (across * d.dot(r) - e.dot(r)) / (R::splat(1.0) - across * across);
    let feature = 1 << 31 | (i as u32) << 8 | (j as u32) << 10 | corner_a << 12 | corner_b << 16;
    Manifold::of_point(normal, on_b + e * t, separation, feature, margin).carried_by_both()
}

/// A corner of a polygon in the plane of a face, and which edge goes on from it: of the incident face (0 to 3) or a side of the
/// reference face (4 to 7).
#[derive(Clone, Copy)]
struct Corner<R> {
    u: R,
    v: R,
    /// Height above the reference face.
    height: R,
    edge: u32,
}

/// Of a quadrilateral cut by four lines.
const MOST_CORNERS: usize = 8;

/// From the box whose face `i` is the reference to the other. `which` says whose face it is.
fn face_contact<R: Scalar>(
    reference: &Oriented<R>,
    i: usize,
    incident: &Oriented<R>,
    which: u32,
    margin: R,
) -> Manifold<R> {
    let apart = incident.center - reference.center;
    let one = R::splat(1.0);
    let side = signed(one, reference.axes[i].dot(apart));
    let normal = reference.axes[i] * side;
    let (iu, iv) = ((i + 1) % 3, (i + 2) % 3);
    let (u, v) = (reference.axes[iu], reference.axes[iv]);
    let face = reference.center + normal * reference.half[i];

    // The incident face is the one that looks most against the normal.
    let mut j = 0;
    for k in 1..3 {
        if normal.dot(incident.axes[k]).abs() > normal.dot(incident.axes[j]).abs() {
            j = k;
        }
    }
    let facing = -signed(one, normal.dot(incident.axes[j]));
    let middle = incident.center + incident.axes[j] * (incident.half[j] * facing) - face;
    let (ju, jv) = ((j + 1) % 3, (j + 2) % 3);
    let (p, q) = (incident.axes[ju] * incident.half[ju], incident.axes[jv] * incident.half[jv]);

    let mut polygon = Polygon::none();
    for (edge, corner) in [middle - p - q, middle + p - q, middle + p + q, middle - p + q].into_iter().enumerate() {
        polygon.push(Corner { u: u.dot(corner), v: v.dot(corner), height: normal.dot(corner), edge: edge as u32 });
    }
    let (width, depth) = (reference.half[iu], reference.half[iv]);
    let polygon = polygon
        .clipped(4, |corner| corner.u - width)
        .clipped(5, |corner| corner.v - depth)
        .clipped(6, |corner| -corner.u - width)
        .clipped(7, |corner| -corner.v - depth);

    let faces = which << 16 | (i as u32) << 8 | u32::from(side < R::splat(0.0)) << 10;
    let faces = faces | (j as u32) << 12 | u32::from(facing < R::splat(0.0)) << 14;
    let half = R::splat(0.5);
    let mut near = [ContactPoint { position: Vec3::zero(), separation: one, feature: 0 }; MOST_CORNERS];
    let mut count = 0;
    for (before, corner) in polygon.with_the_one_before() {
        if corner.height <= margin && count < near.len() {
            near[count] = ContactPoint {
                position: face + u * corner.u + v * corner.v + normal * (corner.height * half),
                separation: corner.height,
                feature: faces | before.edge << 4 | corner.edge,
            };
            count += 1;
        }
    }
    let points = if count == 0 { Points::none() } else { reduce(&near[..count], normal, margin) };
    Manifold::new(normal, carried(&points), points)
}

/// A corner of the incident face goes with its box, one of the reference face with the other, and where an edge crosses one of the other
/// face's with both.
fn carried<R: Scalar>(points: &Points<R>) -> R {
    let (mut sum, mut count) = (R::splat(0.0), R::splat(0.0));
    for point in points.iter() {
        let of_incident = |edge: u32| R::splat(if edge < 4 { 0.5 } else { 0.0 });
        sum = sum + of_incident(point.feature >> 4 & 15) + of_incident(point.feature & 15);
        count = count + R::splat(1.0);
    }
    if count > R::splat(0.0) { sum / count } else { R::splat(0.5) }
}

/// A convex polygon, its corners in order.
struct Polygon<R> {
    corners: [Corner<R>; MOST_CORNERS],
    len: usize,
}

impl<R: Scalar> Polygon<R> {
    fn none() -> Self {
        let zero = R::splat(0.0);
        Self { corners: [Corner { u: zero, v: zero, height: zero, edge: 0 }; MOST_CORNERS], len: 0 }
    }

    /// Adds a corner where there is room; rounding may make more of them than geometry has.
    fn push(&mut self, corner: Corner<R>) {
        if let Some(slot) = self.corners.get_mut(self.len) {
            *slot = corner;
            self.len += 1;
        }
    }

    fn with_the_one_before(&self) -> impl Iterator<Item = (Corner<R>, Corner<R>)> {
        let corners = &self.corners[..self.len];
        corners.iter().enumerate().map(move |(index, corner)| {
            let before = if index == 0 { corners.len() - 1 } else { index - 1 };
            (corners[before], *corner)
        })
    }

    /// What is left where `beyond` is not positive; the edge that cuts is called `edge`.
    fn clipped(&self, edge: u32, beyond: impl Fn(&Corner<R>) -> R) -> Self {
        let mut left = Self::none();
        let zero = R::splat(0.0);
        for (before, corner) in self.with_the_one_before() {
            let (from, to) = (beyond(&before), beyond(&corner));
            if (from <= zero) != (to <= zero) {
                let along = from / (from - to);
                let between = |a: R, b: R| a + (b - a) * along;
                left.push(Corner {
                    u: between(before.u, corner.u),
                    v: between(before.v, corner.v),
                    height: between(before.height, corner.height),
                    // Going out, it goes on along what cuts; coming in, along the edge it was on.
                    edge: if from <= zero { edge } else { before.edge },
                });
            }
            if to <= zero {
                left.push(corner);
            }
        }
        left
    }
}
