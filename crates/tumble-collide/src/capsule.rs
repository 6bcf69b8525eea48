//! A capsule against a ball, another capsule and a box. Its axis is the segment from -`half_height`
//! to +`half_height` on y.

use tumble_math::lane::Vec3;

use crate::collider_shape::Isometry;
use crate::face_clipping::FaceClipping;
use crate::feature::Feature;
use crate::manifold::Manifold;
use crate::scalar::Scalar;

/// A capsule seen from somewhere.
#[derive(Clone, Copy)]
pub(crate) struct Rod<R> {
    center: Vec3<R>,
    /// From the centre to the end of the axis.
    half: Vec3<R>,
    /// A unit vector across the axis.
    across: Vec3<R>,
    radius: R,
}

/// Nearer than this part of the lengths they are computed from two points are one, in units of
/// rounding: the direction between them is lost.
const ONE_POINT: f64 = 32.0;
/// The square of a shorter length \[m\] may not be a normal number in either precision.
const MIN_DISTANCE: f64 = 1e-18;
/// The most points that an edge and another, or a face, have in common, and the nearest.
const MAX_SHARED: usize = 3;
/// By how much more \[m\] an edge of a box must separate than a face to be taken.
const EDGE_LEAD: f64 = 5e-4;

impl<R: Scalar> Rod<R> {
    pub(crate) fn new(radius: R, half_height: R, at: &Isometry<R>) -> Self {
        let [across, along, _] = at.orientation.axes();
        Self { center: at.position, half: along * half_height, across, radius }
    }

    fn at(&self, t: R) -> Vec3<R> {
        self.center + self.half * t
    }

    fn feature(&self) -> Feature<R, 2> {
        Feature::segment(self.center - self.half, self.center + self.half)
    }

    /// From -1 to 1: where the axis is nearest to a point.
    fn nearest_to(&self, point: Vec3<R>) -> R {
        let t = self.half.dot(point - self.center) / self.half.dot(self.half);
        clamped(t, R::splat(1.0))
    }
}

/// Whether two points computed from these vectors can be told apart.
fn is_apart<R: Scalar>(distance: R, from: &[Vec3<R>]) -> bool {
    let size = from.iter().fold(R::splat(0.0), |size, v| size + v.x.abs() + v.y.abs() + v.z.abs());
    distance > size * R::splat(ONE_POINT * R::ROUNDING)
}

fn clamped<R: Scalar>(x: R, most: R) -> R {
    x.max(-most).min(most)
}

/// From the capsule to the ball.
pub(crate) fn capsule_and_sphere<R: Scalar>(rod: &Rod<R>, radius: R, center: Vec3<R>, margin: R) -> Manifold<R> {
    let apart = center - rod.at(rod.nearest_to(center));
    let distance = apart.dot(apart).sqrt();
    let normal = if distance > R::splat(MIN_DISTANCE) { apart * (R::splat(1.0) / distance) } else { rod.across };
    Manifold::of_point(normal, center - normal * radius, distance - (rod.radius + radius), 0, margin).carried_by_both()
}

/// One point, or the two ends of what lies side by side.
pub(crate) fn capsule_and_capsule<R: Scalar>(first: &Rod<R>, second: &Rod<R>, margin: R) -> Manifold<R> {
    let (on_first, on_second) = nearest_of_axes(first, second);
    let apart = on_second - on_first;
    let distance = apart.dot(apart).sqrt();
    let (one, half) = (R::splat(1.0), R::splat(0.5));
    let layers = [first.radius, second.radius];
    let is_near = distance - (layers[0] + layers[1]) <= margin;
    if !is_near {
        return Manifold::none();
    }
    let between = second.center - first.center;
    let normal = if is_apart(distance, &[between, first.half, second.half]) {
        apart * (one / distance)
    } else {
        // Axes that cross: out of the plane of both, to whichever side.
        let out = first.half.cross(second.half);
        let length = out.dot(out).sqrt();
        if length > R::splat(MIN_DISTANCE) { out * (one / length) } else { first.across }
    };
    let separation = distance - (layers[0] + layers[1]);
    let nearest = (on_first + normal * layers[0] + on_second - normal * layers[1]) * half;
    let face_clipping = FaceClipping { normal, separation, layers, margin };
    let along = |rod: &Rod<R>| (rod.center + rod.half) - (rod.center - rod.half);
    if !face_clipping.are_parallel(along(first), along(second)) {
        return Manifold::of_nearest(normal, nearest, separation);
    }
    let middles = [first.center, second.center];
    let (first, second) = (first.feature(), second.feature());
    face_clipping.manifold_of::<2, 2, MAX_SHARED>(&first, &second, nearest, R::splat(0.0), middles).carried_by_both()
}

/// The nearest points of two axes; of parallel ones, some that are nearest.
fn nearest_of_axes<R: Scalar>(first: &Rod<R>, second: &Rod<R>) -> (Vec3<R>, Vec3<R>) {
    let (s, t) = nearest_of_segments([first.center, first.half], [second.center, second.half]);
    (first.at(s), second.at(t))
}

/// Where two segments, each given by its middle and from there to its end, are nearest to each
/// other, from -1 to 1 (C. Ericson, "Real-Time Collision Detection", 2005, 5.1.9).
pub(crate) fn nearest_of_segments<R: Scalar>(
    [first, first_half]: [Vec3<R>; 2],
    [second, second_half]: [Vec3<R>; 2],
) -> (R, R) {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let apart = first - second;
    let (a, e, b) = (first_half.dot(first_half), second_half.dot(second_half), first_half.dot(second_half));
    let (c, f) = (first_half.dot(apart), second_half.dot(apart));
    let denominator = a * e - b * b;
    let s = if denominator > zero { clamped((b * f - c * e) / denominator, one) } else { zero };
    let t = (b * s + f) / e;
    let inside = clamped(t, one);
    let s = if t == inside { s } else { clamped((b * inside - c) / a, one) };
    (s, inside)
}

/// From the box to the capsule.
pub(crate) fn cuboid_and_capsule<R: Scalar>(
    half_extents: Vec3<R>,
    at: &Isometry<R>,
    rod: &Rod<R>,
    margin: R,
) -> Manifold<R> {
    let turned = |v: Vec3<R>| at.orientation.rotate_back(v);
    let local =
        Rod { center: at.to_local(rod.center), half: turned(rod.half), across: turned(rod.across), radius: rod.radius };
    let (one, half, zero) = (R::splat(1.0), R::splat(0.5), R::splat(0.0));
    let on_axis = local.at(nearest_to_cuboid(&local, half_extents));
    let h = half_extents;
    let nearest = Vec3::new(clamped(on_axis.x, h.x), clamped(on_axis.y, h.y), clamped(on_axis.z, h.z));
    let apart = on_axis - nearest;
    let distance = apart.dot(apart).sqrt();
    let is_near = distance - rod.radius <= margin;
    if !is_near {
        return Manifold::none();
    }
    let (normal, between, nearest) = if is_apart(distance, &[h, local.center, local.half]) {
        (apart * (one / distance), distance, nearest)
    } else {
        let (normal, between) = way_out(&local, h);
        (normal, between, on_axis - normal * between)
    };
    let (separation, layers, middles) = (between - rod.radius, [zero, rod.radius], [Vec3::zero(), local.center]);
    let face_clipping = FaceClipping { normal, separation, layers, margin };
    let middle = nearest + normal * (separation * half);
    let face = Feature::of_cuboid(h, normal);
    let manifold = face_clipping.manifold_of::<4, 2, MAX_SHARED>(&face, &local.feature(), middle, zero, middles);
    manifold.seen(|point| at.to_world(point), |v| at.orientation.rotate(v))
}

/// From -1 to 1: where an axis is nearest to a box about the origin, in the middle of where it is
/// so everywhere.
///
/// The square of the distance is convex along the axis, and its derivative goes through zero in
/// straight pieces: those between places where the axis goes through the plane of a face.
fn nearest_to_cuboid<R: Scalar>(rod: &Rod<R>, h: Vec3<R>) -> R {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let along = [(rod.center.x, rod.half.x, h.x), (rod.center.y, rod.half.y, h.y), (rod.center.z, rod.half.z, h.z)];
    let slope = |t: R| {
        along.iter().fold(zero, |sum, &(center, half, most)| {
            let x = center + half * t;
            sum + half * (x - clamped(x, most))
        })
    };
    // The end of the last piece before the slope is positive, and where it is zero in the next;
    // `flat` counts zero as positive.
    let root = |flat: bool| {
        let is_up = |slope: R| slope > zero || flat && slope == zero;
        let (mut low, mut high) = ((-one, slope(-one)), (one, slope(one)));
        if is_up(low.1) {
            return -one;
        }
        if !is_up(high.1) {
            return one;
        }
        for &(center, half, most) in &along {
            for face in [-most, most] {
                let t = (face - center) / half;
                if t > low.0 && t < high.0 {
                    let slope = slope(t);
                    *(if is_up(slope) { &mut high } else { &mut low }) = (t, slope);
                }
            }
        }
        low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1))
    };
    (root(true) + root(false)) * R::splat(0.5)
}

/// Out of a box about the origin for an axis that is in it: the unit normal, and minus the
/// distance.
fn way_out<R: Scalar>(rod: &Rod<R>, h: Vec3<R>) -> (Vec3<R>, R) {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let axes = [Vec3::new(one, zero, zero), Vec3::new(zero, one, zero), Vec3::new(zero, zero, one)];
    let separation = |axis: Vec3<R>| {
        let reach = axis.x.abs() * h.x + axis.y.abs() * h.y + axis.z.abs() * h.z;
        axis.dot(rod.center).abs() - axis.dot(rod.half).abs() - reach
    };
    let edges = axes.iter().filter_map(|axis| {
        let across = axis.cross(rod.half);
        let length = across.dot(across).sqrt();
        (length > R::splat(MIN_DISTANCE)).then(|| (across * (one / length), R::splat(EDGE_LEAD)))
    });
    let mut best = (axes[0], separation(axes[0]));
    for (axis, lead) in axes.into_iter().map(|axis| (axis, zero)).chain(edges) {
        let separation = separation(axis);
        if separation > best.1 + lead {
            best = (axis, separation);
        }
    }
    let (axis, separation) = best;
    (if axis.dot(rod.center) < zero { axis * -one } else { axis }, separation)
}
