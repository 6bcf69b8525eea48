//! The nearest points of two convex shapes that do not overlap.
//!
//! E. G. Gilbert, D. W. Johnson, S. S. Keerthi, "A fast procedure for computing the distance
//! between complex objects in three-dimensional space", IEEE J. Robot. Autom. 4 (1988); the nearest
//! points of triangle and tetrahedron after C. Ericson, "Real-Time Collision Detection" (2005),
//! 5.1.

use crate::common_normal::{CommonNormal, common_normal, common_normal_again};
use crate::minkowski::{Difference, Reached};
use crate::segments::nearest_of_few;
use crate::support_map::Vector;

/// Up to four points of the difference, and how much of each is in the point that is nearest to the
/// origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simplex {
    corners: [(Reached, f64); 4],
    len: usize,
}

/// How two convex shapes are to each other.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Nearest {
    /// Further apart than asked for.
    Far,
    /// Apart: the vector from the nearest point of the first to that of the second, and the former.
    Apart { between: Vector, on_first: Vector },
    /// Overlapping, or touching to rounding.
    Overlap(Simplex),
}

/// Each turn comes nearer; of polyhedra a dozen reach the end, and of round shapes thirty are
/// within rounding.
const MAX_TURNS: usize = 64;
/// Nearer than this part of what the difference reaches, the direction is lost in rounding.
const TOUCHING: f64 = 1e-10;
/// The square of the distance is good to this part.
const PRECISE: f64 = 1e-13;

/// After this many points, and each time half as many again, round shapes are tried for a common
/// normal.
const POINTS_TRIED: usize = 3;

/// Sine of the angle at which a corner of a tetrahedron is in the plane of the others.
const FLAT: f64 = 1e-10;

/// Looks no further than `limit`.
pub(crate) fn nearest(shapes: &Difference<'_>, limit: f64) -> Nearest {
    match nearest_of_few(shapes) {
        Some((between, _)) if between.dot(between) > limit * limit => Nearest::Far,
        Some((between, on_first)) => Nearest::Apart { between, on_first },
        None => nearest_of_all(shapes, limit),
    }
}

/// The same of shapes that were nearest along a unit vector a moment ago, without a limit.
pub(crate) fn nearest_again(shapes: &Difference<'_>, near: Option<Vector>) -> Nearest {
    let again = near.and_then(|near| common_normal_again(shapes, near));
    let reach = |v: Vector| v.dot(v).sqrt();
    match again {
        Some(CommonNormal { normal, separation, on_first })
            if separation > TOUCHING * (reach(on_first) + reach(shapes.position)) =>
        {
            Nearest::Apart { between: normal * separation, on_first }
        }
        _ => nearest(shapes, f64::INFINITY),
    }
}

/// The same for shapes of any kind.
fn nearest_of_all(shapes: &Difference<'_>, limit: f64) -> Nearest {
    let start = shapes.first.middle() - shapes.place(shapes.second.middle());
    let mut v = if start.dot(start) > 0.0 { start } else { Vector::new(1.0, 0.0, 0.0) };
    let mut simplex = Simplex::none();
    let (mut square, mut largest) = (f64::INFINITY, 0.0);
    let mut next_try = if shapes.has_round_core() { POINTS_TRIED } else { usize::MAX };
    for turn in 0..MAX_TURNS {
        let reached = shapes.support(v * -1.0);
        let (w, length_squared) = (reached.point, v.dot(v));
        let along = v.dot(w);
        if along > 0.0 && along * along > limit * limit * length_squared {
            return Nearest::Far;
        }
        if simplex.len > 0 && (length_squared - along <= PRECISE * length_squared || simplex.has(w)) {
            break;
        }
        largest = f64::max(largest, w.dot(w));
        let before = simplex;
        simplex.add(reached);
        let next = simplex.reduce();
        let now = next.dot(next);
        if simplex.len == 4 || now <= TOUCHING * TOUCHING * largest {
            return Nearest::Overlap(simplex);
        }
        // No nearer: rounding has the last word.
        if now.is_nan() || now >= square {
            simplex = before;
            break;
        }
        (v, square) = (next, now);
        if turn + 1 >= next_try {
            next_try += next_try / 2 + 1;
            let near = v * (-1.0 / now.sqrt());
            let found = common_normal(shapes, near, simplex.corners());
            let apart = found.filter(|found| found.separation > TOUCHING * f64::sqrt(largest));
            if let Some(CommonNormal { normal, separation, on_first }) = apart {
                let is_far = separation > limit;
                return if is_far { Nearest::Far } else { Nearest::Apart { between: normal * separation, on_first } };
            }
        }
    }
    Nearest::Apart { between: v * -1.0, on_first: simplex.on_first() }
}

impl Simplex {
    fn none() -> Self {
        let nothing = Reached { point: Vector::zero(), on_first: Vector::zero() };
        Self { corners: [(nothing, 0.0); 4], len: 0 }
    }

    pub(crate) fn corners(&self) -> impl Iterator<Item = Reached> + Clone {
        self.corners.into_iter().take(self.len).map(|(reached, _)| reached)
    }

    fn has(&self, point: Vector) -> bool {
        self.corners().any(|corner| corner.point == point)
    }

    fn add(&mut self, reached: Reached) {
        if let Some(slot) = self.corners.get_mut(self.len) {
            *slot = (reached, 1.0);
            self.len += 1;
        }
    }

    fn on_first(&self) -> Vector {
        self.corners
            .iter()
            .take(self.len)
            .fold(Vector::zero(), |sum, (reached, weight)| sum + reached.on_first * *weight)
    }

    /// Leaves those corners that the point nearest to the origin lies between, which it returns;
    /// all four if the origin is inside.
    fn reduce(&mut self) -> Vector {
        let p = self.corners.map(|(reached, _)| reached.point);
        let weights = match self.len {
            2 => {
                let [a, b] = on_segment(p[0], p[1]);
                [a, b, 0.0, 0.0]
            }
            3 => {
                let [a, b, c] = on_triangle([p[0], p[1], p[2]]);
                [a, b, c, 0.0]
            }
            4 => match on_tetrahedron(p) {
                Some(weights) => weights,
                None => return Vector::zero(),
            },
            _ => [1.0, 0.0, 0.0, 0.0],
        };
        let mut sum = Vector::zero();
        let mut left = Self::none();
        for ((reached, _), weight) in self.corners.into_iter().zip(weights) {
            if weight > 0.0 && left.len < 4 {
                left.corners[left.len] = (reached, weight);
                left.len += 1;
                sum = sum + reached.point * weight;
            }
        }
        *self = left;
        if left.len == 3 {
            let [a, b, c, _] = left.corners.map(|(reached, _)| reached.point);
            // The foot of the origin on the plane, which the weights give with fewer digits.
            let normal = (b - a).cross(c - a);
            sum = normal * (normal.dot(a) / normal.dot(normal));
        }
        sum
    }
}

/// Weights of the ends in the point nearest to the origin.
pub(crate) fn on_segment(a: Vector, b: Vector) -> [f64; 2] {
    let along = b - a;
    let (t, whole) = (-a.dot(along), along.dot(along));
    if t <= 0.0 || whole <= 0.0 {
        [1.0, 0.0]
    } else if t >= whole {
        [0.0, 1.0]
    } else {
        [1.0 - t / whole, t / whole]
    }
}

/// Weights of the corners in the point nearest to the origin.
pub(crate) fn on_triangle([a, b, c]: [Vector; 3]) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (-ab.dot(a), -ac.dot(a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (d3, d4) = (-ab.dot(b), -ac.dot(b));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    // Twice the areas that the origin's foot makes with two corners, times that of all three, from
    // products of differences: they lose fewer digits of thin triangles.
    let normal = ab.cross(ac);
    let area = |from: Vector, to: Vector| normal.dot(from.cross(to - from));
    let vc = area(a, b);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let [first, second] = on_segment(a, b);
        return [first, second, 0.0];
    }
    let (d5, d6) = (-ab.dot(c), -ac.dot(c));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = area(c, a);
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let [first, second] = on_segment(a, c);
        return [first, 0.0, second];
    }
    let va = area(b, c);
    let sum = va + vb + vc;
    if (va <= 0.0 && d4 >= d3 && d5 >= d6) || sum <= 0.0 {
        let [first, second] = on_segment(b, c);
        return [0.0, first, second];
    }
    [va / sum, vb / sum, vc / sum]
}

/// Weights of the corners in the point nearest to the origin; `None` if the origin is inside.
fn on_tetrahedron(p: [Vector; 4]) -> Option<[f64; 4]> {
    let mut best: Option<(f64, [f64; 4])> = None;
    for [i, j, k, l] in [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 3, 2, 0]] {
        let normal = (p[j] - p[i]).cross(p[k] - p[i]);
        let away = p[l] - p[i];
        let (of_origin, of_corner) = (-p[i].dot(normal), away.dot(normal));
        // On the side of the fourth corner the origin is not outside this face; a flat tetrahedron
        // has no sides.
        let is_flat = of_corner * of_corner <= FLAT * FLAT * normal.dot(normal) * away.dot(away);
        if !is_flat && of_origin * of_corner > 0.0 {
            continue;
        }
        let face = [p[i], p[j], p[k]];
        let weights = on_triangle(face);
        let point = face.iter().zip(weights).fold(Vector::zero(), |sum, (corner, weight)| sum + *corner * weight);
        let square = point.dot(point);
        if best.is_none_or(|(least, _)| square < least) {
            let mut all = [0.0; 4];
            [all[i], all[j], all[k]] = weights;
            best = Some((square, all));
        }
    }
    best.map(|(_, weights)| weights)
}
