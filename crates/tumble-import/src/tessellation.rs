//! Shapes as triangles, for files and pictures that know no other surfaces.

pub(crate) mod revolution;

use glam::{DQuat, DVec3};
use tumble::{Part, Shape, TriangleMesh};

use crate::bodies::appearance::Appearance;
use crate::tessellation::revolution::{ball, cone_frustum, revolve, tapered_capsule};

/// Half the diagonals of the octahedron that stands for a point, which has no size \[m\].
pub const POINT_RADIUS: f64 = 0.02;

/// Triangles of a closed surface in the frame of the shape, seen anticlockwise from outside. Ground
/// is open: a half-space's square, and heights.
///
/// Round surfaces have 24 corners around; every vertex lies on the shape's surface, so the volume
/// is a little below the shape's (3 % for a ball). Corners of an edge that is sharp stand there
/// once for every normal: positions that touch are equal to the bit.
///
/// ```
/// use tumble_import::{Appearance, Tessellation};
///
/// let cube =
///     Tessellation::of_appearance(&Appearance::Shape(tumble::Shape::cuboid([1.0, 1.0, 1.0])));
/// assert_eq!((cube.positions.len(), cube.normals.len(), cube.triangles.len()), (24, 24, 12));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tessellation {
    /// \[m\]
    pub positions: Vec<DVec3>,
    /// Of unit length, outward, one for each position.
    pub normals: Vec<DVec3>,
    /// Indices into the positions.
    pub triangles: Vec<[u32; 3]>,
}

impl Tessellation {
    /// The surface that is seen.
    #[must_use]
    pub fn of_appearance(appearance: &Appearance) -> Self {
        match appearance {
            Appearance::Shape(shape) => Self::of(shape),
            Appearance::Mesh(surface) => mesh(surface),
            Appearance::HeightField(heights) => mesh(heights.triangles()),
            Appearance::HalfSpace => square(),
        }
    }

    /// The surface of a shape; of a compound, the surfaces of its parts, which may run through each
    /// other.
    #[must_use]
    pub fn of(shape: &Shape) -> Self {
        match *shape {
            Shape::Sphere { radius } | Shape::HollowSphere { radius } => revolve(&[ball(radius)]),
            Shape::Ellipsoid { radii } => revolve(&[ball(1.0)]).stretched(radii),
            Shape::Cuboid { half_extents } => cuboid(half_extents),
            Shape::Cylinder { radius, half_height } => revolve(&cone_frustum([radius, radius], half_height)),
            Shape::Cone { radius, half_height } => revolve(&cone_frustum([radius, 0.0], half_height)),
            Shape::Capsule { radius, half_height } => revolve(&[tapered_capsule([radius, radius], half_height)]),
            Shape::Frustum { radius_bottom, radius_top, half_height } => {
                revolve(&cone_frustum([radius_bottom, radius_top], half_height))
            }
            Shape::TaperedCapsule { radius_bottom, radius_top, half_height } => {
                revolve(&[tapered_capsule([radius_bottom, radius_top], half_height)])
            }
            Shape::Compound(ref parts) => compound(parts),
            Shape::Mesh(ref solid) => mesh(solid.mesh()),
            // Shapes are checked where scenes are read; one that is unknown here is at least seen.
            _ => octahedron(POINT_RADIUS),
        }
    }

    /// Each axis of the frame by its own factor.
    #[must_use]
    pub fn stretched(mut self, factors: DVec3) -> Self {
        for position in &mut self.positions {
            *position *= factors;
        }
        for normal in &mut self.normals {
            // Normals go with the inverse transpose; multiplied by the product of the factors,
            // nothing is divided by zero.
            let factors = factors / factors.max_element();
            *normal = (*normal * DVec3::new(factors.y * factors.z, factors.z * factors.x, factors.x * factors.y))
                .normalize_or(*normal);
        }
        self
    }

    fn placed(mut self, position: DVec3, orientation: DQuat) -> Self {
        let orientation = orientation.normalize();
        for point in &mut self.positions {
            *point = orientation * *point + position;
        }
        for normal in &mut self.normals {
            *normal = orientation * *normal;
        }
        self
    }

    fn append(&mut self, other: &Self) {
        let first = self.positions.len() as u32;
        self.positions.extend_from_slice(&other.positions);
        self.normals.extend_from_slice(&other.normals);
        self.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|index| index + first)));
    }

    /// A flat polygon, its corners anticlockwise.
    fn append_polygon(&mut self, corners: &[DVec3], normal: DVec3) {
        let first = self.positions.len() as u32;
        self.positions.extend_from_slice(corners);
        self.normals.extend(corners.iter().map(|_| normal));
        let last = first + corners.len() as u32;
        self.triangles.extend((first + 2..last).map(|corner| [first, corner - 1, corner]));
    }
}

fn compound(parts: &[Part]) -> Tessellation {
    let mut whole = Tessellation::default();
    for part in parts {
        whole.append(&Tessellation::of(&part.shape).placed(part.position, part.orientation));
    }
    whole
}

/// Triangles with normals of their own: a mesh does not say which of its edges are sharp.
fn mesh(mesh: &TriangleMesh) -> Tessellation {
    let mut whole = Tessellation::default();
    let positions = mesh.positions();
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| positions.get(corner as usize).copied().unwrap_or_default());
        whole.append_polygon(&[a, b, c], (b - a).cross(c - a).normalize_or(DVec3::Y));
    }
    whole
}

/// Two metres wide, about the origin: a part of what has no end.
fn square() -> Tessellation {
    let mut whole = Tessellation::default();
    let corners = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
    whole.append_polygon(&corners.map(|[x, z]| DVec3::new(x, 0.0, z)), DVec3::Y);
    whole
}

fn cuboid(half_extents: DVec3) -> Tessellation {
    let mut whole = Tessellation::default();
    for (u, v, normal) in
        [(DVec3::Y, DVec3::Z, DVec3::X), (DVec3::Z, DVec3::X, DVec3::Y), (DVec3::X, DVec3::Y, DVec3::Z)]
    {
        for side in [1.0, -1.0] {
            // Going around the other way on the other side keeps the corners anticlockwise.
            let (u, v) = if side > 0.0 { (u, v) } else { (v, u) };
            let corners = [-u - v, u - v, u + v, v - u].map(|corner| (corner + normal * side) * half_extents);
            whole.append_polygon(&corners, normal * side);
        }
    }
    whole
}

fn octahedron(radius: f64) -> Tessellation {
    let mut whole = Tessellation::default();
    for signs in 0..8_u8 {
        let sign = |bit: u8| if signs & bit == 0 { 1.0 } else { -1.0 };
        let (x, y, z) = (DVec3::X * sign(1), DVec3::Y * sign(2), DVec3::Z * sign(4));
        let around = if (x + y + z).to_array().into_iter().product::<f64>() > 0.0 { [x, y, z] } else { [x, z, y] };
        // Adding zero makes the zeros of all corners positive.
        whole.append_polygon(&around.map(|corner| corner * radius + DVec3::ZERO), (x + y + z).normalize());
    }
    whole
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use tumble::Amount;

    use super::*;

    /// By the divergence theorem, the sum of the tetrahedra from the origin.
    fn volume(surface: &Tessellation) -> f64 {
        let corner = |index: u32| surface.positions[index as usize];
        let tetrahedra = surface.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0);
        tetrahedra.sum()
    }

    /// Every edge between two places is gone along once in each direction, which is closed and one
    /// way out.
    fn assert_closed(surface: &Tessellation) {
        let mut edges: HashMap<[[u64; 3]; 2], i32> = HashMap::new();
        let place = |index: u32| surface.positions[index as usize].to_array().map(f64::to_bits);
        for &[a, b, c] in &surface.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                assert_ne!(place(from), place(to), "an edge of no length");
                *edges.entry([place(from), place(to)]).or_default() += 1;
            }
        }
        for ([from, to], count) in &edges {
            assert_eq!(*count, 1);
            assert_eq!(edges.get(&[*to, *from]), Some(&1));
        }
    }

    /// Normals are those of the triangles but for the bend between neighbouring ones.
    fn assert_outward(surface: &Tessellation, cosine: f64) {
        assert_eq!(surface.positions.len(), surface.normals.len());
        for triangle in &surface.triangles {
            let [a, b, c] = triangle.map(|index| surface.positions[index as usize]);
            let flat = (b - a).cross(c - a).normalize();
            for index in triangle {
                let normal = surface.normals[*index as usize];
                assert!((normal.length() - 1.0).abs() < 1e-12, "{normal}");
                assert!(normal.dot(flat) > cosine, "{normal} {flat}");
            }
        }
    }

    #[test]
    fn solids_are_closed_and_of_nearly_their_volume() {
        // A polygon of 24 corners has 0.9886 of the disk, and arcs of 12 chords over half a turn
        // cost about as much again.
        let (flat, round, curved) = (1.0 - 1e-12, 0.9885, 0.97);
        let solids = [
            (Shape::cuboid([0.1, 2.0, 0.3]), flat),
            (Shape::cylinder(0.3, 2.0), round),
            (Shape::cone(0.3, 2.0), round),
            (Shape::sphere(0.7), curved),
            (Shape::capsule(0.4, 0.3), curved),
            (Shape::ellipsoid([0.4, 1.3, 0.1]), curved),
        ];
        for (shape, least) in solids {
            let surface = Tessellation::of(&shape);
            assert_closed(&surface);
            let ratio = volume(&surface) / shape.volume().unwrap();
            assert!((least..1.0 + 1e-12).contains(&ratio), "{shape:?}: {ratio}");
            // The flat ellipsoid bends by an eighth of a turn and more from one triangle to the
            // next at its rim.
            assert_outward(&surface, if matches!(shape, Shape::Ellipsoid { .. }) { 0.0 } else { 0.97 });
        }
    }

    #[test]
    fn a_frustum_and_a_tapered_capsule_are_the_profiles_of_two_radii() {
        // pi h/3 (a^2 + a b + b^2) of height 1, with radii 1 and 2 either way round.
        for radii in [[1.0, 2.0], [2.0, 1.0]] {
            let frustum = revolve(&cone_frustum(radii, 0.5));
            assert_closed(&frustum);
            assert_outward(&frustum, 0.97);
            let ratio = volume(&frustum) / (std::f64::consts::PI * 7.0 / 3.0);
            assert!((0.9885..1.0).contains(&ratio), "{ratio}");
            let capsule = revolve(&[tapered_capsule(radii, 2.0)]);
            assert_closed(&capsule);
            assert_outward(&capsule, 0.97);
            // Between the capsules of the smaller and of the larger radius.
            let [thin, thick] = [1.0, 2.0].map(|radius| Shape::capsule(radius, 2.0).volume().unwrap());
            assert!((thin..thick).contains(&volume(&capsule)));
        }
        // The larger ball holds the smaller one.
        let ball = revolve(&[tapered_capsule([1.0, 0.2], 0.3)]);
        assert_closed(&ball);
        assert!((ball.positions.iter().fold(0.0_f64, |highest, p| highest.max(p.y)) - 0.7).abs() < 1e-12);
    }

    #[test]
    fn points_and_shells_are_seen() {
        let point = Tessellation::of(&Shape::Point);
        assert_closed(&point);
        assert_outward(&point, 1.0 - 1e-12);
        // An octahedron is 4/3 of the cube of half its diagonal.
        assert!((volume(&point) / (4.0 / 3.0 * POINT_RADIUS.powi(3)) - 1.0).abs() < 1e-12);
        assert_eq!(Tessellation::of(&Shape::hollow_sphere(2.0)), Tessellation::of(&Shape::sphere(2.0)));
    }

    #[test]
    fn parts_are_placed() {
        let brick = Part::new(Shape::cuboid([1.0, 2.0, 3.0]), Amount::Mass(1.0));
        let turned = brick.clone().at([10.0, 0.0, 0.0]).turned(DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2));
        let both = Tessellation::of(&Shape::compound([brick, turned]));
        assert_closed(&both);
        assert!((volume(&both) - 96.0).abs() < 1e-10);
        assert_outward(&both, 1.0 - 1e-12);
        let highest = both.positions.iter().copied().fold(DVec3::MIN, DVec3::max);
        assert!((highest - DVec3::new(12.0, 2.0, 3.0)).length() < 1e-12, "{highest}");
        assert_eq!(Tessellation::of(&Shape::compound([])), Tessellation::default());
    }
}
