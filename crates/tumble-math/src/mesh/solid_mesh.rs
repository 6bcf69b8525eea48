//! A mesh that bounds a solid, and its mass properties.

use glam::{DMat3, DVec3};

use super::audit::MeshAudit;
use super::connected_components::turned;
use super::defect::{MeshDefect, MeshRepair};
use super::local_frame::LocalFrame;
use super::mesh_analysis::Anatomy;
use super::mesh_error::MeshError;
use super::moments::{Moments, moments};
use super::triangle_mesh::TriangleMesh;
use crate::mass_properties::MassProperties;
use crate::shape::{Amount, Shape};
use crate::shape_error::{ShapeError, ShapeErrorReason};
use crate::symmetric_eigen::symmetric_eigen;

/// A closed surface wound consistently: solids outwards, cavities inwards, with a positive volume.
/// Made by [`TriangleMesh::solid`] and [`TriangleMesh::repaired`].
///
/// Volume, centre and inertia are computed once, here, by exact integration over the solid (no
/// sampling); rounding is some eps of each, wherever in the world the mesh is.
///
/// ```
/// use glam::{DAffine3, DVec3};
/// use tumble_math::{Amount, TriangleMesh};
///
/// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let outer = TriangleMesh::new(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let shrink = DAffine3::from_scale_rotation_translation(
///     DVec3::splat(0.5),
///     Default::default(),
///     DVec3::splat(0.1),
/// );
/// let both = TriangleMesh::merged([outer.clone(), outer.transformed(&shrink)?])?;
///
/// assert_eq!(
///     both.solid().unwrap_err().to_string(),
///     "the mesh bounds no solid: 1 part inside out"
/// );
/// let (hollow, repairs) = both.repaired()?;
/// assert_eq!(repairs[0].to_string(), "1 part turned outside out");
/// assert_eq!(hollow.cavities(), 1);
/// assert!((hollow.volume() - (1.0 - 0.125) / 6.0).abs() < 1e-16);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SolidMesh {
    mesh: TriangleMesh,
    parts: usize,
    cavities: usize,
    volume: f64,
    center_of_mass: DVec3,
    /// Inertia about the centre of mass of one kilogram of it, in units of `unit` squared.
    tensor: DMat3,
    unit: f64,
}

impl SolidMesh {
    pub(crate) fn strictly(mesh: &TriangleMesh) -> Result<Self, MeshError> {
        let anatomy = Anatomy::of(mesh);
        let mut defects = MeshAudit::from_anatomy(mesh, &anatomy).problems();
        defects.retain(|defect| !defect.is_harmless());
        if defects.is_empty() { Self::assembled(mesh, &anatomy) } else { Err(MeshError::NotSolid { defects }) }
    }

    pub(crate) fn with_repairs(mesh: &TriangleMesh) -> Result<(Self, Vec<MeshRepair>), MeshError> {
        let anatomy = Anatomy::of(mesh);
        let mut defects = MeshAudit::from_anatomy(mesh, &anatomy).problems();
        let repairs = defects.iter().filter_map(MeshDefect::repair).collect();
        defects.retain(MeshDefect::is_fatal);
        if defects.is_empty() {
            Ok((Self::assembled(mesh, &anatomy)?, repairs))
        } else {
            Err(MeshError::NotSolid { defects })
        }
    }

    /// With all parts the right way round. Nothing fatal may be wrong with the mesh.
    fn assembled(mesh: &TriangleMesh, anatomy: &Anatomy) -> Result<Self, MeshError> {
        let mesh = rewound(mesh, anatomy)?;
        let frame = LocalFrame::around(mesh.positions().iter().copied());
        let extent = frame.extent();
        if extent < *Shape::LENGTHS.start() {
            return Err(MeshError::Extent { extent });
        }
        let corners = || mesh.triangles().iter().map(|corners| corners.map(|c| mesh.positions()[c as usize]));
        let Moments { volume, center, second } = moments(corners, &frame);
        let unit = frame.unit;
        let cubic_metres = volume.value * unit * unit * unit;
        // Second moments of matter have no negative eigenvalue, unlike those of a surface that
        // crosses itself. A determinant's rounding, d/6 in the volume, is at most 36 d/120 in them.
        let spread = symmetric_eigen(second).0;
        let is_matter = volume.value > volume.rounding && spread.min_element() >= -2.0 * volume.rounding;
        if !is_matter {
            return Err(MeshError::NoVolume { volume: cubic_metres });
        }
        let trace = second.x_axis.x + second.y_axis.y + second.z_axis.z;
        let depths = anatomy.depths.as_deref().unwrap_or_default();
        Ok(Self {
            parts: anatomy.parts.parts.len(),
            cavities: depths.iter().filter(|depth| **depth % 2 == 1).count(),
            volume: cubic_metres,
            center_of_mass: frame.global(center),
            tensor: (DMat3::from_diagonal(DVec3::splat(trace)) - second) * (1.0 / volume.value),
            unit,
            mesh,
        })
    }

    /// The surface: each vertex used and at a place of its own, each triangle counter-clockwise as
    /// seen from where there is no matter.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// How many closed surfaces there are, cavities included.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.parts
    }

    /// How many of them bound cavities.
    #[must_use]
    pub fn cavities(&self) -> usize {
        self.cavities
    }

    /// Volume [m^3].
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Centre of mass, the matter being homogeneous, in the frame of the vertices \[m\].
    #[must_use]
    pub fn center_of_mass(&self) -> DVec3 {
        self.center_of_mass
    }

    /// Mass properties in the frame of the vertices.
    ///
    /// # Errors
    /// A mass or a density that is zero, negative, not finite or absurd.
    pub fn mass_properties(&self, amount: Amount) -> Result<MassProperties, ShapeError> {
        let mass = amount.mass(Some(self.volume), "mesh")?;
        MassProperties::from_parts(mass, self.center_of_mass, self.tensor * (mass * self.unit * self.unit))
            .map_err(|error| ShapeError::here(ShapeErrorReason::Mass(error)))
    }
}

/// The surface with triangles turned as the anatomy says, and only the vertices it uses, in their
/// order.
fn rewound(mesh: &TriangleMesh, anatomy: &Anatomy) -> Result<TriangleMesh, MeshError> {
    let inside_out: Vec<bool> = (0..anatomy.parts.parts.len()).map(|part| anatomy.is_inside_out(part)).collect();
    let mut numbers: Vec<Option<u32>> = vec![None; mesh.positions().len()];
    for &corner in anatomy.surface.triangles.iter().flatten() {
        numbers[corner as usize] = Some(0);
    }
    let mut positions = Vec::new();
    for (number, &position) in numbers.iter_mut().zip(mesh.positions()) {
        if let Some(number) = number {
            *number = positions.len() as u32;
            positions.push(position);
        }
    }
    let parts = &anatomy.parts;
    let turns = parts.flipped.iter().zip(&parts.of_triangle).map(|(flip, part)| *flip != inside_out[*part as usize]);
    let triangles: Vec<[u32; 3]> = anatomy
        .surface
        .triangles
        .iter()
        .zip(turns)
        .map(|(corners, turn)| turned(corners.map(|corner| numbers[corner as usize].unwrap_or(0)), turn))
        .collect();
    TriangleMesh::new(positions, triangles)
}
