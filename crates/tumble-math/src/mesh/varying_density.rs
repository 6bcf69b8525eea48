//! Mass properties of a solid whose density varies from place to place.

use glam::{DMat3, DVec3};

use super::solid_mesh::SolidMesh;
use crate::inertia::parallel_axis;
use crate::mass_error::MassError;
use crate::mass_properties::MassProperties;

/// Nodes and weights of Gauss and Legendre's rule with five points on \[0, 1\], exact for
/// polynomials up to the ninth degree.
const RULE: [(f64, f64); 5] = [
    (0.046_910_077_030_668_0, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

impl SolidMesh {
    /// Mass, centre of mass and inertia of the solid with a density [kg/m^3] that depends on the
    /// place \[m\], in the mesh's frame.
    ///
    /// Over the tetrahedron between each triangle and the solid's centroid, with a product rule of
    /// five points in each of three directions, each cut into `parts` (at least one). Exact to
    /// rounding for polynomials up to the fifth degree: the rule reaches the ninth, of which the
    /// inertia takes two and the shape of the tetrahedron two. For other smooth densities the error
    /// falls with the tenth power of `parts`. Tetrahedra of a solid that is not convex reach
    /// outside it and cancel there, so the density is asked for in all of what they fill, and
    /// should be the same smooth function there.
    ///
    /// ```
    /// use glam::DVec3;
    /// use tumble_math::TriangleMesh;
    /// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let solid =
    ///     TriangleMesh::new(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?.solid()?;
    /// // Density x: the integral of x over the tetrahedron is 1/24, that of x^2 is 1/60.
    /// let body = solid.mass_properties_with_density(|place| place.x, 1)?;
    /// assert!((body.mass() - 1.0 / 24.0).abs() < 1e-16);
    /// assert!((body.center_of_mass().x - 24.0 / 60.0).abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MassError`]: densities that are not finite, or whose sum is no mass.
    pub fn mass_properties_with_density(
        &self,
        density: impl Fn(DVec3) -> f64,
        parts: u32,
    ) -> Result<MassProperties, MassError> {
        let center = self.center_of_mass();
        let positions = self.mesh().positions();
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| positions[corner as usize] - center);
        let (mut mass, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        let share = 1.0 / f64::from(parts.max(1));
        let nodes = || {
            (0..parts.max(1)).flat_map(move |part| {
                RULE.iter().map(move |(node, weight)| ((f64::from(part) + node) * share, weight * share))
            })
        };
        for [a, b, c] in self.mesh().triangles().iter().map(corners) {
            let volume_times_six = a.dot(b.cross(c));
            // From the centroid out by u, and on the triangle by v and w (1 - v): the Jacobian is
            // u^2 (1 - v).
            for (u, u_weight) in nodes() {
                for (v, v_weight) in nodes() {
                    for (w, w_weight) in nodes() {
                        let place = (a * v + (b * (1.0 - w) + c * w) * (1.0 - v)) * u;
                        let jacobian = volume_times_six * u * u * (1.0 - v);
                        let m = density(center + place) * jacobian * u_weight * v_weight * w_weight;
                        mass += m;
                        first += place * m;
                        second += parallel_axis(m, place);
                    }
                }
            }
        }
        let offset = first / mass;
        // By value, not by name of what was wrong: `from_parts` refuses masses and places that are
        // none.
        MassProperties::from_parts(mass, center + offset, second - parallel_axis(mass, offset))
    }
}
