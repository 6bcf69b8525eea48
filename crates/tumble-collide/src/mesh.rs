//! Triangle meshes as collision surfaces: welded vertices, triangle adjacency, and a BVH.

use tumble_math::{MeshError, TriangleMesh};

use crate::aabb::Aabb;
use crate::bvh::Bvh;
use crate::query::line::Line;
use crate::support_map::Vector;
use crate::surface::{Patches, Surface};

/// A surface of triangles, made to be touched from its outside: the side from which the corners of
/// a triangle run counter-clockwise.
///
/// What is behind a triangle is not held by it, so a closed mesh holds things out of its inside,
/// and an open one is ground seen from above. Corners at exactly the same place are one. Between
/// triangles that lie in one plane, and where the surface is hollow, nothing sticks out: what
/// slides over it meets no edges there. Triangles without area are passed over.
///
/// ```
/// use tumble_collide::Mesh;
/// use tumble_math::lane::Vec3;
///
/// let corners = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
///     .map(|[x, y, z]| Vec3::new(x, y, z));
/// let ground = Mesh::new(&corners, &[[0, 1, 2], [0, 2, 3]])?;
/// assert_eq!((ground.triangles().len(), ground.edges().count()), (2, 5));
/// let error = Mesh::new(&corners, &[[0, 1, 4]]).unwrap_err();
/// assert_eq!(error, tumble_math::MeshError::Index { triangle: 0, index: 4, vertices: 4 });
/// # Ok::<(), tumble_math::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    points: Vec<Vector>,
    triangles: Vec<[u32; 3]>,
    neighbours: Vec<[Option<u32>; 3]>,
    /// By point, where its neighbours begin in the list of them all.
    starts: Vec<u32>,
    ends: Vec<u32>,
    patches: Patches,
    bvh: Bvh,
}

impl Mesh {
    /// The most triangles of a mesh: their patches, sides and corners are to be counted in 32 bits.
    pub const MAX: usize = 1 << 28;

    /// From vertices \[m\] and, for each triangle, the indices of its corners.
    ///
    /// # Errors
    /// [`MeshError`] names the vertex that is not finite or too far out, or the triangle with an
    /// index out of range, by its index.
    pub fn new(vertices: &[Vector], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        for (what, count) in [("vertices", vertices.len()), ("triangles", triangles.len())] {
            if count > Self::MAX {
                return Err(MeshError::TooLarge { what, count });
            }
        }
        let positions: Vec<_> = vertices.iter().map(|vertex| (*vertex).into()).collect();
        let checked = TriangleMesh::new(positions, triangles.to_vec())?;
        let (points, numbers) = distinct(vertices);
        let triangles: Vec<[u32; 3]> =
            checked.triangles().iter().map(|corners| corners.map(|corner| numbers[corner as usize])).collect();
        let mut this = Self {
            neighbours: neighbours(&triangles),
            starts: Vec::new(),
            ends: Vec::new(),
            patches: Patches::default(),
            bvh: Bvh::new(&[]),
            points,
            triangles,
        };
        this.join_corners();
        let boxes: Vec<Aabb<f64>> = (0..this.count()).map(|triangle| around(&this.triangle(triangle))).collect();
        this.bvh = Bvh::new(&boxes);
        this.patches = Patches::of(&this);
        Ok(this)
    }

    /// Its vertices \[m\], those at one place once.
    #[must_use]
    pub fn points(&self) -> &[Vector] {
        &self.points
    }

    /// The corners of each triangle, as indices of [`points`](Self::points).
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The ends \[m\] of each side of the triangles, of two that are next to each other once.
    pub fn edges(&self) -> impl Iterator<Item = [Vector; 2]> + '_ {
        Surface::edges(self)
    }

    /// The box along the axes that holds it.
    pub(crate) fn aabb(&self) -> Aabb<f64> {
        self.bvh.aabb()
    }

    fn join_corners(&mut self) {
        let mut sides: Vec<[u32; 2]> = Vec::with_capacity(6 * self.triangles.len());
        for &[a, b, c] in &self.triangles {
            sides.extend([[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]);
        }
        sides.sort_unstable();
        sides.dedup();
        self.starts = (0..=self.points.len() as u32)
            .map(|point| sides.partition_point(|[from, _]| *from < point) as u32)
            .collect();
        self.ends = sides.into_iter().map(|[_, to]| to).collect();
    }
}

/// The box of a triangle.
pub(crate) fn around([a, b, c]: &[Vector; 3]) -> Aabb<f64> {
    let of = |point: Vector| Aabb { low: point, high: point };
    of(*a).union(&of(*b)).union(&of(*c))
}

/// The points at different places, and the number of each point's place.
fn distinct(points: &[Vector]) -> (Vec<Vector>, Vec<u32>) {
    // Minus zero is zero.
    let points: Vec<Vector> = points.iter().map(|point| *point + Vector::zero()).collect();
    let compare = |a: u32, b: u32| {
        let (a, b) = (points[a as usize], points[b as usize]);
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
    };
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by(|a, b| compare(*a, *b).then(a.cmp(b)));
    // Of each, the first at the same place.
    let mut firsts: Vec<u32> = (0..points.len() as u32).collect();
    for pair in order.windows(2) {
        if compare(pair[0], pair[1]).is_eq() {
            firsts[pair[1] as usize] = firsts[pair[0] as usize];
        }
    }
    let (mut places, mut numbers) = (Vec::new(), vec![0; points.len()]);
    for (index, point) in points.iter().enumerate() {
        let first = firsts[index] as usize;
        if first == index {
            numbers[index] = places.len() as u32;
            places.push(*point);
        } else {
            numbers[index] = numbers[first];
        }
    }
    (places, numbers)
}

/// Beyond each side of each triangle the one that has it the other way round. A side of more than
/// two is the end of each.
fn neighbours(triangles: &[[u32; 3]]) -> Vec<[Option<u32>; 3]> {
    let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
    for (triangle, &[a, b, c]) in (0..).zip(triangles) {
        sides.extend([[a, b], [b, c], [c, a]].map(|side| (side, triangle)));
    }
    sides.sort_unstable();
    let only = |side: [u32; 2]| {
        let from = sides.partition_point(|(other, _)| *other < side);
        match &sides[from..] {
            [(first, _), (second, _), ..] if *first == side && *second == side => None,
            [(first, triangle), ..] if *first == side => Some(*triangle),
            _ => None,
        }
    };
    let beyond = |[from, to]: [u32; 2]| only([from, to]).and(only([to, from]));
    triangles.iter().map(|&[a, b, c]| [beyond([a, b]), beyond([b, c]), beyond([c, a])]).collect()
}

impl Surface for Mesh {
    fn count(&self) -> u32 {
        self.triangles.len() as u32
    }

    fn corners(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize]
    }

    fn point(&self, number: u32) -> Vector {
        self.points[number as usize]
    }

    fn across(&self, triangle: u32, side: usize) -> Option<u32> {
        self.neighbours[triangle as usize][side]
    }

    fn corners_beside(&self, corner: u32, visit: &mut dyn FnMut(u32)) {
        let range = self.starts[corner as usize] as usize..self.starts[corner as usize + 1] as usize;
        self.ends[range].iter().for_each(|end| visit(*end));
    }

    fn near(&self, aabb: &Aabb<f64>, visit: &mut dyn FnMut(u32)) {
        self.bvh.near(aabb, visit);
    }

    fn along(&self, line: &Line, half: Vector, most: f64, visit: &mut dyn FnMut(u32) -> f64) {
        self.bvh.along(line, half, most, visit);
    }

    fn around(&self, point: Vector, most: f64, visit: &mut dyn FnMut(u32) -> f64) {
        self.bvh.around(point, most, visit);
    }

    fn patches(&self) -> &Patches {
        &self.patches
    }
}
