//! How a triangle lies to a box: the thirteen directions of face normals and of cross products of
//! edges, in the frame of the box.

use crate::convex_pair::{Approach, approach};
use crate::minkowski::Difference;
use crate::support_map::Vector;

/// By how much, as part of the size of both, a direction across two edges must separate more than a
/// face to be taken: more than rounding makes of edges that lie in the face.
const EDGE_LEAD: f64 = 1e-11;
/// Sine of the angle below which two edges are parallel: what is lost by leaving their direction
/// out is as small.
const PARALLEL: f64 = 1e-10;

/// A triangle and a box about the origin, along its axes.
struct Seen {
    corners: [[f64; 3]; 3],
    /// Unit normal of the triangle.
    normal: [f64; 3],
    half: [f64; 3],
}

/// What meets along a direction.
#[derive(Clone, Copy)]
enum Features {
    /// The triangle's face and a corner of the box.
    Face,
    /// A corner of the triangle and the face of the box across an axis.
    FaceOfBox(usize),
    /// A side of the triangle, by its number, and an edge of the box along an axis.
    Edges(usize, usize),
}

/// A direction from the triangle to the box, and how far they are apart along it.
#[derive(Clone, Copy)]
struct Way {
    separation: f64,
    normal: [f64; 3],
    features: Features,
}

/// As [`approach`], where the second shape is a box; corners are given about its middle.
pub(crate) fn of_cuboid(
    shapes: &Difference<'_>,
    corners: &[Vector; 3],
    normal: Vector,
    half: Vector,
    limit: f64,
) -> Option<Approach> {
    let numbers = |v: Vector| [v.x, v.y, v.z];
    let seen = Seen {
        corners: corners.map(|corner| numbers(shapes.turned_back(corner))),
        normal: numbers(shapes.turned_back(normal)),
        half: numbers(half),
    };
    let way = seen.across_edges(seen.across_faces(), limit)?;
    let is_apart = way.separation > 0.0;
    let Some(on_first) = seen.meeting(&way, is_apart) else {
        // Nearest are two corners, or a corner and an edge, which no such direction separates by
        // their distance.
        return approach(shapes, limit);
    };
    let vector = |[x, y, z]: [f64; 3]| Vector::new(x, y, z);
    let [normal, on_first] = [shapes.turn(vector(way.normal)), shapes.place(vector(on_first))];
    Some(Approach { normal, between: way.separation, lead: 0.0, on_first })
}

/// Whether a box is further from the corners of a triangle than `limit` along one of its axes.
pub(crate) fn is_beside_cuboid(shapes: &Difference<'_>, corners: &[Vector; 3], half: Vector, limit: f64) -> bool {
    let [a, b, c] = [corners[0], corners[1], corners[2]].map(|corner| corner - shapes.position);
    let beyond = |axis: Vector, half: f64| {
        let (a, b, c, most) = (axis.dot(a), axis.dot(b), axis.dot(c), half + limit);
        (a > most && b > most && c > most) || (a < -most && b < -most && c < -most)
    };
    let [x, y, z] = &shapes.axes;
    beyond(*x, half.x) || beyond(*y, half.y) || beyond(*z, half.z)
}

impl Seen {
    /// The best of the normals of faces.
    fn across_faces(&self) -> Way {
        let (n, h, p) = (self.normal, self.half, self.corners);
        let reach = n[0].abs() * h[0] + n[1].abs() * h[1] + n[2].abs() * h[2];
        let height = -dot(n, p[0]);
        let sign = if height < 0.0 { -1.0 } else { 1.0 };
        let mut best = Way { separation: sign * height - reach, normal: n.map(|x| x * sign), features: Features::Face };
        for axis in 0..3 {
            let low = f64::min(f64::min(p[0][axis], p[1][axis]), p[2][axis]);
            let high = f64::max(f64::max(p[0][axis], p[1][axis]), p[2][axis]);
            let (separation, sign) = if low >= -high { (low - h[axis], -1.0) } else { (-high - h[axis], 1.0) };
            if separation > best.separation {
                let mut normal = [0.0; 3];
                normal[axis] = sign;
                best = Way { separation, normal, features: Features::FaceOfBox(axis) };
            }
        }
        best
    }

    /// The best of these and of directions across two edges; `None` where they are further apart
    /// than `limit` along one.
    fn across_edges(&self, mut best: Way, limit: f64) -> Option<Way> {
        let (h, p) = (self.half, self.corners);
        if best.separation >= limit {
            return None;
        }
        let size = h[0] + h[1] + h[2] + p[0][0].abs() + p[0][1].abs() + p[0][2].abs();
        for side in 0..3 {
            let (from, way) = (p[side], minus(p[(side + 1) % 3], p[side]));
            let other = minus(p[(side + 2) % 3], from);
            let square = dot(way, way);
            for axis in 0..3 {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                // Across both, and away from the rest of the triangle.
                let (x, y) = (way[v], -way[u]);
                let inwards = x * other[u] + y * other[v];
                let (x, y) = if inwards > 0.0 { (-x, -y) } else { (x, y) };
                let separation = -(x * from[u] + y * from[v]) - (x.abs() * h[u] + y.abs() * h[v]);
                let length = (x * x + y * y).sqrt();
                if separation > (best.separation + EDGE_LEAD * size) * length
                    && x * x + y * y > PARALLEL * PARALLEL * square
                {
                    let inverse = 1.0 / length;
                    let mut normal = [0.0; 3];
                    (normal[u], normal[v]) = (x * inverse, y * inverse);
                    best = Way { separation: separation * inverse, normal, features: Features::Edges(side, axis) };
                }
            }
        }
        (best.separation < limit).then_some(best)
    }

    /// The point of the triangle that is nearest to the box, or deepest in it; `None` where what
    /// meets along a direction does not lie over one another, if that is asked.
    fn meeting(&self, way: &Way, is_asked: bool) -> Option<[f64; 3]> {
        let (n, h, p) = (way.normal, self.half, self.corners);
        match way.features {
            Features::Face => {
                let corner: [f64; 3] = std::array::from_fn(|axis| if n[axis] < 0.0 { h[axis] } else { -h[axis] });
                let foot = minus(corner, n.map(|x| x * way.separation));
                let is_inside = (0..3).all(|side| {
                    let along = minus(p[(side + 1) % 3], p[side]);
                    dot(self.normal, cross(along, minus(foot, p[side]))) >= 0.0
                });
                (is_inside || !is_asked).then_some(foot)
            }
            Features::FaceOfBox(axis) => {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut corner = p[0];
                for other in &p[1..] {
                    if other[axis] * n[axis] > corner[axis] * n[axis] {
                        corner = *other;
                    }
                }
                let is_inside = corner[u].abs() <= h[u] && corner[v].abs() <= h[v];
                (is_inside || !is_asked).then_some(corner)
            }
            Features::Edges(side, axis) => {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let (from, along) = (p[side], minus(p[(side + 1) % 3], p[side]));
                // Seen along the edge of the box and the direction, the side goes past the edge.
                let edge = [u, v].map(|across| if n[across] < 0.0 { h[across] } else { -h[across] });
                let before = n[v] * (from[u] - edge[0]) - n[u] * (from[v] - edge[1]);
                let t = -before / (n[v] * along[u] - n[u] * along[v]);
                let at = |t: f64| [0, 1, 2].map(|k| from[k] + along[k] * t);
                let is_inside = (0.0..=1.0).contains(&t) && at(t)[axis].abs() <= h[axis];
                if is_inside { Some(at(t)) } else { (!is_asked).then(|| at(t.clamp(0.0, 1.0))) }
            }
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
