//! The convex hull of points.

use glam::DVec3;

use super::grid_point::{GridPoint, cross, dot};
use super::hull_error::HullError;
use super::triangle_mesh::TriangleMesh;
use crate::mass_properties::check_position;
use crate::shape::Shape;

/// The convex hull of points \[m\]: a closed mesh, wound outwards, whose vertices are those of the
/// points that are its corners, in their order.
///
/// On which side of a face a point lies is decided without rounding, for points shifted to a grid
/// of 2^37 to 2^38 steps over the longest side of their box, by half a step on each axis at most
/// (4e-12 of that side). So points in one plane, on one line or at one place do no harm: the result
/// is closed and convex on the grid, faces with more than three corners are cut into triangles, and
/// none of these is without area there. A point that is above no face by more than two steps does
/// not become a corner, for that is no more than the shift can do.
///
/// Points are added furthest first to a growing hull that keeps, for each face, a list of points
/// outside it (quickhull). That takes about `n log n` steps, a fraction of a second for a hundred
/// thousand points on a sphere. In bad cases, such as all points on two circles, it would take
/// `n^2`: these are given up after some seconds' work.
///
/// Source: C. B. Barber, D. P. Dobkin, H. Huhdanpaa, "The quickhull algorithm for convex hulls",
/// ACM Trans. Math. Softw. 22 (1996).
///
/// ```
/// use glam::DVec3;
/// use tumble_math::convex_hull;
///
/// let corners = (0..8).map(|i| DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into()));
/// let points: Vec<DVec3> =
///     corners.chain([DVec3::splat(0.5), DVec3::new(0.5, 0.25, 1.0)]).collect();
/// let cube = convex_hull(&points)?;
/// assert_eq!((cube.positions().len(), cube.triangles().len()), (8, 12));
/// assert_eq!(cube.solid()?.volume(), 1.0);
/// assert!(convex_hull(&points[..4]).is_err()); // they lie in one plane
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Fewer than four points, one that is not finite or too far out (named by its index), or all of
/// them in one plane; and more work than there is patience for, which depends on the points alone
/// and not on the machine.
pub fn convex_hull(points: &[DVec3]) -> Result<TriangleMesh, HullError> {
    let count = points.len();
    if count < 4 {
        return Err(HullError::TooFew { count });
    }
    if let Some((point, &position)) = points.iter().enumerate().find(|(_, p)| check_position(**p).is_err()) {
        return Err(HullError::Position { point, position });
    }
    if count > TriangleMesh::MAX {
        return Err(HullError::Mesh(super::MeshError::TooLarge { what: "vertices", count }));
    }
    let low = points.iter().fold(DVec3::INFINITY, |low, p| low.min(*p));
    let extent = points.iter().fold(0.0_f64, |extent, p| extent.max((*p - low).max_element()));
    if extent < *Shape::LENGTHS.start() {
        return Err(HullError::Flat { count });
    }
    let grid = GridPoint::all(points);
    let mut hull = Hull::started(&grid, MAX_WORK + WORK_OF_POINT * count).ok_or(HullError::Flat { count })?;
    if !hull.grow() {
        return Err(HullError::TooMuchWork { count });
    }
    Ok(hull.mesh(points)?)
}

/// Comparisons of a point with a face at the most, some seconds' work, and how many more for each
/// point: six times as often as points on a sphere need.
const MAX_WORK: usize = 1 << 27;
const WORK_OF_POINT: usize = 256;

/// A face of the growing hull.
#[derive(Clone, Debug)]
struct Face {
    corners: [u32; 3],
    /// Across the edge that starts at each corner.
    neighbours: [u32; 3],
    normal: [i128; 3],
    /// Above this [`height`](Hull::height) a point is outside for certain.
    margin: i128,
    /// Points outside this face, each in the list of one face only.
    outside: Vec<u32>,
    /// Whether the face is part of the hull still.
    stands: bool,
}

/// An edge between faces to go and a face that stays.
#[derive(Clone, Copy, Debug)]
struct HorizonEdge {
    from: u32,
    to: u32,
    stays: u32,
}

struct Hull<'a> {
    points: &'a [GridPoint],
    faces: Vec<Face>,
    /// Places in `faces` to be used again.
    free: Vec<u32>,
    /// Faces that may have points outside.
    waiting: Vec<u32>,
    /// By point, the new face whose horizon edge starts there.
    starts: Vec<u32>,
    /// How many times a point was compared with a face, and how many times it may be.
    work: usize,
    most_work: usize,
}

impl<'a> Hull<'a> {
    /// A tetrahedron of points far from each other, every other point in the list of a face it is
    /// outside of. `None` if all points are in one plane.
    fn started(points: &'a [GridPoint], most_work: usize) -> Option<Self> {
        let corners = tetrahedron(points)?;
        let mut hull = Self {
            points,
            faces: Vec::new(),
            free: Vec::new(),
            waiting: Vec::new(),
            starts: vec![0; points.len()],
            work: 0,
            most_work,
        };
        let [a, b, c, d] = corners;
        // Each face's neighbours are across its edges in their order.
        for (corners, neighbours) in
            [([a, b, c], [1, 2, 3]), ([b, a, d], [0, 3, 2]), ([c, b, d], [0, 1, 3]), ([a, c, d], [0, 2, 1])]
        {
            let face = hull.add(corners);
            hull.faces[face as usize].neighbours = neighbours;
        }
        hull.share_out((0..points.len() as u32).collect(), &[0, 1, 2, 3]);
        Some(hull)
    }

    fn add(&mut self, corners: [u32; 3]) -> u32 {
        let [a, b, c] = corners.map(|corner| self.points[corner as usize]);
        let normal = cross(b - a, c - a);
        let (margin, outside) = (margin(normal), Vec::new());
        let face = Face { corners, neighbours: [0; 3], normal, margin, outside, stands: true };
        if let Some(place) = self.free.pop() {
            self.faces[place as usize] = face;
            place
        } else {
            self.faces.push(face);
            self.faces.len() as u32 - 1
        }
    }

    /// Height of a point above a face, times the length of the face's normal. Exact.
    fn height(&self, face: u32, point: u32) -> i128 {
        let face = &self.faces[face as usize];
        dot(face.normal, self.points[point as usize] - self.points[face.corners[0] as usize])
    }

    /// Puts each point into the list of the first of the faces that it is outside of. What is
    /// outside of none of them is inside for good, or within the margin: seen from the new point,
    /// the hull is the cone that they bound.
    fn share_out(&mut self, points: Vec<u32>, faces: &[u32]) {
        for point in points {
            if self.work > self.most_work {
                return;
            }
            let is_above = |face: &u32| self.height(*face, point) > self.faces[*face as usize].margin;
            let place = faces.iter().position(is_above);
            self.work += place.unwrap_or(faces.len());
            if let Some(&face) = place.and_then(|place| faces.get(place)) {
                self.faces[face as usize].outside.push(point);
            }
        }
        self.waiting.extend(faces.iter().filter(|face| !self.faces[**face as usize].outside.is_empty()));
    }

    /// Adds points until none is outside; `false` where that is given up.
    fn grow(&mut self) -> bool {
        while let Some(face) = self.waiting.pop() {
            if self.work > self.most_work {
                return false;
            }
            if !self.faces[face as usize].stands {
                continue;
            }
            self.work += self.faces[face as usize].outside.len();
            let outside = self.faces[face as usize].outside.iter();
            // Of equally high ones the first in the order of the points, so that nothing depends on
            // the order of lists.
            let highest = outside.copied().max_by_key(|point| (self.height(face, *point), std::cmp::Reverse(*point)));
            if let Some(point) = highest {
                self.reach(face, point);
            }
        }
        true
    }

    /// Grows the hull to a point outside `face`.
    fn reach(&mut self, face: u32, point: u32) {
        let (gone, horizon) = self.visible_from(face, point);
        let mut orphans = Vec::new();
        for &face in &gone {
            orphans.append(&mut self.faces[face as usize].outside);
        }
        orphans.retain(|orphan| *orphan != point);
        let mut new = Vec::with_capacity(horizon.len());
        for edge in &horizon {
            let face = self.add([edge.from, edge.to, point]);
            new.push(face);
            self.starts[edge.from as usize] = face;
            let stays = &mut self.faces[edge.stays as usize];
            // In the face that stays the edge runs the other way.
            for corner in 0..3 {
                if stays.corners[corner] == edge.to && stays.corners[(corner + 1) % 3] == edge.from {
                    stays.neighbours[corner] = face;
                }
            }
            self.faces[face as usize].neighbours[0] = edge.stays;
        }
        for (edge, &face) in horizon.iter().zip(&new) {
            let next = self.starts[edge.to as usize];
            self.faces[face as usize].neighbours[1] = next;
            self.faces[next as usize].neighbours[2] = face;
        }
        self.free.extend(gone);
        self.share_out(orphans, &new);
    }

    /// The faces that a new point makes go, and the edges around them.
    ///
    /// These are the faces it is above, and those it is level with that are reached from them
    /// through edges. Were the latter to stay, a new face could have its three corners on one line:
    /// the edge of a level face that points at the new point. So such an edge has level faces on
    /// both sides, and both go.
    fn visible_from(&mut self, start: u32, point: u32) -> (Vec<u32>, Vec<HorizonEdge>) {
        let (mut gone, mut horizon) = (vec![start], Vec::new());
        self.faces[start as usize].stands = false;
        let mut next = 0;
        while let Some(&face) = gone.get(next) {
            (next, self.work) = (next + 1, self.work + 3);
            let Face { corners, neighbours, .. } = self.faces[face as usize];
            for (corner, neighbour) in neighbours.into_iter().enumerate() {
                if !self.faces[neighbour as usize].stands {
                    continue;
                }
                if self.height(neighbour, point) >= 0 {
                    self.faces[neighbour as usize].stands = false;
                    gone.push(neighbour);
                } else {
                    horizon.push(HorizonEdge {
                        from: corners[corner],
                        to: corners[(corner + 1) % 3],
                        stays: neighbour,
                    });
                }
            }
        }
        (gone, horizon)
    }

    /// The faces that stand, over the points that are corners of one.
    fn mesh(&self, points: &[DVec3]) -> Result<TriangleMesh, super::MeshError> {
        let standing = || self.faces.iter().filter(|face| face.stands);
        let mut numbers: Vec<Option<u32>> = vec![None; points.len()];
        for corner in standing().flat_map(|face| face.corners) {
            numbers[corner as usize] = Some(0);
        }
        let mut positions = Vec::new();
        for (number, position) in numbers.iter_mut().zip(points) {
            if let Some(number) = number {
                *number = positions.len() as u32;
                positions.push(*position);
            }
        }
        let number = |corner: u32| numbers[corner as usize].unwrap_or(0);
        TriangleMesh::new(positions, standing().map(|face| face.corners.map(number)).collect::<Vec<_>>())
    }
}

/// Four points not in one plane, far from each other, the fourth below the plane in which the first
/// three run counter-clockwise.
fn tetrahedron(points: &[GridPoint]) -> Option<[u32; 4]> {
    let numbers = || 0..points.len() as u32;
    let at = |number: u32| points[number as usize];
    let a = numbers().min_by_key(|i| at(*i))?;
    let b = numbers().max_by_key(|i| dot(at(*i) - at(a), at(*i) - at(a)))?;
    // Exactly zero or not is what matters; which is the furthest may be rounded.
    let from_line = |i: u32| {
        let [x, y, z] = cross(at(b) - at(a), at(i) - at(a)).map(|x| x as f64);
        x * x + y * y + z * z
    };
    let c = numbers().max_by(|i, j| from_line(*i).total_cmp(&from_line(*j)))?;
    let normal = cross(at(b) - at(a), at(c) - at(a));
    let height = |i: u32| dot(normal, at(i) - at(a));
    let d = numbers().max_by_key(|i| height(*i).abs())?;
    match height(d) {
        level if level.abs() <= margin(normal) => None,
        below if below < 0 => Some([a, b, c, d]),
        _ => Some([a, c, b, d]),
    }
}

/// Two steps of the grid, as a height over a face with this normal, at least zero and so never
/// short of exactly level.
fn margin(normal: [i128; 3]) -> i128 {
    let [x, y, z] = normal.map(|x| x as f64);
    (2.0 * (x * x + y * y + z * z).sqrt()) as i128
}

#[cfg(test)]
mod tests {
    use super::*;

    fn work(points: &[DVec3], most: usize) -> (usize, bool) {
        let grid = GridPoint::all(points);
        let mut hull = Hull::started(&grid, most).unwrap();
        let is_done = hull.grow();
        (hull.work, is_done)
    }

    /// On a sphere: along a spiral, on circles of latitude, in three directions with few digits.
    fn spheres(count: usize) -> [Vec<DVec3>; 3] {
        let at = |y: f64, angle: f64| {
            let ((sin, cos), around) = (libm::sincos(angle), (1.0 - y * y).max(0.0).sqrt());
            DVec3::new(around * cos, y, around * sin)
        };
        let turn = std::f64::consts::TAU;
        let spiral = (0..count).map(|k| at(1.0 - (2 * k + 1) as f64 / count as f64, 0.381_966_011 * turn * k as f64));
        let rows = (count as f64).sqrt() as usize;
        let circles = (0..rows * rows).map(|k| {
            let latitude = std::f64::consts::PI * (k / rows) as f64 / (rows - 1) as f64;
            at(libm::cos(latitude), turn * (k % rows) as f64 / rows as f64)
        });
        let (spiral, circles): (Vec<DVec3>, Vec<DVec3>) = (spiral.collect(), circles.collect());
        let short = spiral.iter().map(|point| (*point * 1e3).round()).collect();
        [spiral, circles, short]
    }

    /// About `n log n`: twice as many points take 2.2 times the work, at a hundred thousand 42
    /// comparisons a point.
    #[test]
    fn points_of_a_sphere_take_work_in_proportion() {
        for (few, many) in spheres(20_000).into_iter().zip(spheres(40_000)) {
            let ((least, _), (most, is_done)) = (work(&few, usize::MAX), work(&many, usize::MAX));
            assert!(is_done && most < 64 * many.len(), "{most} for {} points", many.len());
            assert!(most < 5 * least / 2, "{least} and {most}");
        }
    }

    /// Where it would take `n^2`, it ends soon after as much as is allowed, and says so.
    #[test]
    fn patience_has_an_end() {
        let on_circles = |count: usize| -> Vec<DVec3> {
            let place = |k: usize| {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * (k / 2) as f64 / (count / 2) as f64);
                DVec3::new(cos, (k % 2) as f64, sin)
            };
            (0..count).map(place).collect()
        };
        let points = on_circles(3000);
        let (whole, is_done) = work(&points, usize::MAX);
        assert!(is_done && whole > 1_000_000, "{whole}");
        let (part, is_done) = work(&points, 200_000);
        // What is begun is ended: as many comparisons as there are points and faces.
        assert!(!is_done && part < 200_000 + 8 * points.len(), "{part}");
    }
}
