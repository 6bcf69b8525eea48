//! Convex hulls as collision shapes: merged coplanar faces, support points and contact features.

use tumble_math::{HullError, convex_hull};

use crate::feature::{Feature, MAX_CORNERS};
use crate::furthest::Furthest;
use crate::support_map::{Vector, unit};

/// The convex hull of points, made to be touched: its corners and its flat faces, in its own frame.
///
/// Faces that lie in one plane, within a thousandth of a degree, are one. A face of more than
/// sixteen corners touches with sixteen of them. Finding out how far it reaches in a direction
/// looks at a number of corners that grows as the root of how many there are.
///
/// ```
/// use tumble_collide::ConvexHull;
/// use tumble_math::lane::Vec3;
///
/// let corners: Vec<_> =
///     (0..8).map(|i| Vec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into())).collect();
/// let cube = ConvexHull::new(&corners)?;
/// assert_eq!((cube.points().len(), cube.edges().count(), cube.faces()), (8, 12, 6));
/// assert!(ConvexHull::new(&corners[..4]).is_err()); // they lie in one plane
/// # Ok::<(), tumble_math::HullError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexHull {
    points: Vec<Vector>,
    furthest_points: Furthest,
    faces: Vec<Face>,
    /// Of the faces, by place.
    normals: Vec<Vector>,
    furthest_normals: Furthest,
    /// The corners of all faces, one after the other.
    corners: Vec<u32>,
    /// Of sharp edges: an outward unit normal, of a plane that nothing is beyond, and a corner.
    rims: Vec<(Vector, Vector)>,
    middle: Vector,
    reach: f64,
}

/// Counter-clockwise as seen from outside.
#[derive(Clone, Debug, PartialEq)]
struct Face {
    from: usize,
    to: usize,
}

/// Normals whose scalar product is less than one by no more than this belong to one plane.
const ONE_PLANE: f64 = 1e-10;

/// The scalar product of the normals on both sides of a sharp edge is less: joined faces, which are
/// in one plane but for rounding, would meet far from it.
const SHARP: f64 = -0.5;

/// Part of the hull's reach by which one corner must be further out than others to be shown in
/// place of one of them.
const FURTHER: f64 = 1e-5;
/// A load's tilt makes others of many corners lower by this part of how far they are pressed in.
const TILTED: f64 = 0.05;

impl ConvexHull {
    /// The hull of points \[m\].
    ///
    /// # Errors
    /// Fewer than four points, one that is not finite or too far out (named by its index), or all
    /// of them in one plane.
    pub fn new(points: &[Vector]) -> Result<Self, HullError> {
        let points: Vec<_> = points.iter().map(|point| (*point).into()).collect();
        let mesh = convex_hull(&points)?;
        let points: Vec<Vector> = mesh.positions().iter().map(|position| (*position).into()).collect();
        let sum = points.iter().fold(Vector::zero(), |sum, point| sum + *point);
        let middle = sum * (1.0 / points.len() as f64);
        let reach = points.iter().fold(0.0, |reach, point| f64::max(reach, point.dot(*point))).sqrt();
        let mut this = Self {
            furthest_points: Furthest::new(&points),
            points,
            faces: Vec::new(),
            normals: Vec::new(),
            furthest_normals: Furthest::default(),
            corners: Vec::new(),
            rims: Vec::new(),
            middle,
            reach,
        };
        this.join_faces(mesh.triangles());
        this.rims = this.find_rims();
        this.furthest_normals = Furthest::new(&this.normals);
        Ok(this)
    }

    /// Its corners \[m\].
    #[must_use]
    pub fn points(&self) -> &[Vector] {
        &self.points
    }

    /// How many flat faces it has.
    #[must_use]
    pub fn faces(&self) -> usize {
        self.faces.len()
    }

    /// The ends \[m\] of each edge between two faces.
    pub fn edges(&self) -> impl Iterator<Item = [Vector; 2]> + '_ {
        let sides = self.faces.iter().flat_map(|face| {
            let corners = &self.corners[face.from..face.to];
            corners.iter().zip(corners.iter().cycle().skip(1))
        });
        // Of the two faces at an edge, one goes along it upwards.
        sides.filter(|(from, to)| from < to).map(|(from, to)| [*from, *to].map(|corner| self.points[corner as usize]))
    }

    /// Outward unit normals of planes that nothing of it is beyond, and a corner \[m\] in each:
    /// those of all faces and sharp edges, which have nothing but it between them.
    pub(crate) fn planes(&self) -> impl Iterator<Item = (Vector, Vector)> + '_ {
        let of_faces = self.normals.iter().zip(&self.faces).filter_map(|(normal, face)| {
            self.corners.get(face.from).map(|corner| (*normal, self.points[*corner as usize]))
        });
        of_faces.chain(self.rims.iter().copied())
    }

    /// The planes through sharp edges that halve what is outside.
    fn find_rims(&self) -> Vec<(Vector, Vector)> {
        let sides = self.faces.iter().zip(&self.normals).flat_map(|(face, normal)| {
            let corners = &self.corners[face.from..face.to];
            corners.iter().zip(corners.iter().cycle().skip(1)).map(move |(from, to)| ([*from, *to], *normal))
        });
        let mut sides: Vec<_> = sides.collect();
        sides.sort_unstable_by_key(|(side, _)| *side);
        let across = |[from, to]: [u32; 2]| sides.binary_search_by_key(&[to, from], |(side, _)| *side).ok();
        let rim = |([from, to], normal): &([u32; 2], Vector)| {
            let (_, other) = sides[across([*from, *to]).filter(|_| from < to)?];
            let [begin, end] = [from, to].map(|corner| self.points[*corner as usize]);
            (normal.dot(other) < SHARP).then(|| (unit((end - begin).cross(*normal - other)), begin))
        };
        sides.iter().filter_map(rim).collect()
    }

    /// Triangles with a side in common that lie in one plane become one face.
    fn join_faces(&mut self, triangles: &[[u32; 3]]) {
        let at = |corner: u32| self.points[corner as usize];
        let normals: Vec<Vector> =
            triangles.iter().map(|&[a, b, c]| unit((at(b) - at(a)).cross(at(c) - at(a)))).collect();
        // Each side once for the triangle it belongs to, in order, to be found from the triangle on
        // its other hand.
        let mut sides: Vec<([u32; 2], u32)> = Vec::new();
        for (triangle, [a, b, c]) in triangles.iter().enumerate() {
            sides.extend([[*a, *b], [*b, *c], [*c, *a]].map(|side| (side, triangle as u32)));
        }
        sides.sort_unstable();
        let across = |[from, to]: [u32; 2]| {
            sides.binary_search_by_key(&[to, from], |(side, _)| *side).ok().map(|place| sides[place].1 as usize)
        };
        let mut taken = vec![false; triangles.len()];
        for seed in 0..triangles.len() {
            if taken[seed] {
                continue;
            }
            taken[seed] = true;
            let (mut members, mut next) = (vec![seed], 0);
            let mut outline: Vec<[u32; 2]> = Vec::new();
            while let Some(&member) = members.get(next) {
                next += 1;
                let [a, b, c] = triangles[member];
                for side in [[a, b], [b, c], [c, a]] {
                    match across(side) {
                        Some(other) if normals[other].dot(normals[seed]) >= 1.0 - ONE_PLANE => {
                            if !taken[other] {
                                taken[other] = true;
                                members.push(other);
                            } else if !members.contains(&other) {
                                outline.push(side);
                            }
                        }
                        _ => outline.push(side),
                    }
                }
            }
            let from = self.corners.len();
            self.corners.extend(around(outline));
            self.faces.push(Face { from, to: self.corners.len() });
            self.normals.push(normals[seed]);
        }
    }

    pub(crate) fn support(&self, d: Vector) -> Vector {
        self.furthest_points.find(&self.points, d).map_or(Vector::zero(), |place| self.points[place])
    }

    /// The place of the face that looks most in a direction.
    fn face(&self, d: Vector) -> Option<usize> {
        let first = if self.normals.is_empty() { None } else { Some(0) };
        self.furthest_normals.find(&self.normals, d).or(first)
    }

    pub(crate) fn face_normal(&self, d: Vector) -> Vector {
        self.face(d).map_or(d, |face| self.normals[face])
    }

    /// The foot of a point on the face with this normal, if it is inside.
    pub(crate) fn on_face(&self, normal: Vector, point: Vector) -> Option<Vector> {
        let face = &self.faces[self.face(normal)?];
        let corners = &self.corners[face.from..face.to];
        let at = |corner: &u32| self.points[*corner as usize];
        let mut sides = corners.iter().zip(corners.iter().cycle().skip(1));
        let is_inside = sides.all(|(a, b)| normal.dot((at(b) - at(a)).cross(point - at(a))) >= 0.0);
        let height = normal.dot(point - at(corners.first()?));
        is_inside.then(|| point - normal * height)
    }

    pub(crate) fn feature(&self, d: Vector, pressed: f64) -> Feature<f64> {
        let Some(place) = self.face(d) else { return Feature::point(self.support(d)) };
        let (face, normal) = (&self.faces[place], self.normals[place]);
        let corners = &self.corners[face.from..face.to];
        let most = corners.len().min(MAX_CORNERS);
        let along = |place: usize| self.points[corners[place] as usize].dot(d);
        let mut places = [0; MAX_CORNERS];
        let (mut furthest, mut of_few) = (0, f64::NEG_INFINITY);
        for (k, place) in places.iter_mut().take(most).enumerate() {
            *place = k * corners.len() / most;
            of_few = f64::max(of_few, along(*place));
        }
        for place in 1..corners.len() {
            if along(place) > along(furthest) {
                furthest = place;
            }
        }
        // Of many corners that furthest out takes the place of one beside it, unless others are as
        // far but for rounding and a load's tilt.
        if along(furthest) > of_few + f64::max(FURTHER * self.reach, TILTED * pressed) {
            let before = places.iter().take(most).rposition(|place| *place <= furthest).unwrap_or(0);
            places[before] = furthest;
        }
        let chosen = places.iter().take(most).map(|place| corners[*place]);
        Feature::new(chosen.map(|corner| (self.points[corner as usize], corner)), normal)
    }

    pub(crate) fn middle(&self) -> Vector {
        self.middle
    }

    /// The longest distance of a corner from the origin.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }
}

/// The corners of an outline whose sides come in any order.
fn around(mut outline: Vec<[u32; 2]>) -> Vec<u32> {
    outline.sort_unstable();
    let Some(&[start, mut next]) = outline.first() else { return Vec::new() };
    let mut corners = vec![start];
    // Each corner has one side that goes on from it; what rounding made otherwise is left where it
    // comes back to a corner.
    while next != start && corners.len() < outline.len() {
        corners.push(next);
        let Ok(place) = outline.binary_search_by_key(&next, |[from, _]| *from) else { break };
        next = outline[place][1];
    }
    corners
}
