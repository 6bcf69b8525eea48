//! From the geometry of a collider to a shape with a volume.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use tumble::{Shape, TriangleMesh, convex_hull};

use crate::error::FieldError;
use crate::gltf::Geometry;
use crate::gltf::triangles::Triangles;
use crate::limits::MAX_HULL_POINTS;
use crate::tessellation::Tessellation;

/// Scales that differ by less are one scale, written in f32.
const EVEN: f64 = 1e-6;

/// A collider's shape, with what was decided on the way.
#[derive(Clone)]
pub(crate) struct Solid {
    /// `None` for what encloses nothing: planes, and flat meshes.
    pub(crate) shape: Option<Shape>,
    /// The triangles of a mesh as they are, open or not.
    pub(crate) surface: Option<Arc<TriangleMesh>>,
    pub(crate) notices: Vec<String>,
}

impl Solid {
    fn of(shape: Shape) -> Self {
        Self { shape: Some(shape), surface: None, notices: Vec::new() }
    }

    fn empty() -> Self {
        Self { shape: None, surface: None, notices: Vec::new() }
    }
}

/// A plane with an end, which encloses nothing.
fn rectangle(x: f64, z: f64) -> Result<Solid, FieldError> {
    let corners = [[-x, z], [x, z], [x, -z], [-x, -z]].map(|[x, z]| DVec3::new(x, 0.0, z));
    let surface = TriangleMesh::new(corners, [[0, 1, 2], [0, 2, 3]]);
    let surface = surface.map_err(|error| FieldError::new("plane", error))?;
    Ok(Solid { surface: Some(Arc::new(surface)), ..Solid::empty() })
}

/// The geometry with the scale of its node, which may mirror.
pub(crate) fn solid(geometry: &Geometry, scale: DVec3, triangles: &mut Triangles<'_>) -> Result<Solid, FieldError> {
    if scale == DVec3::ZERO {
        // The draft: such a shape is switched off.
        return Ok(Solid { notices: vec!["has a scale of zero and is switched off".to_owned()], ..Solid::empty() });
    }
    let lengths = scale.abs();
    match *geometry {
        Geometry::Plane { size_x: Some(x), size_z: Some(z), .. } => rectangle(0.5 * x * lengths.x, 0.5 * z * lengths.z),
        Geometry::Plane { .. } => Ok(Solid::empty()),
        Geometry::Mesh { source, convex_hull } => {
            let key = (source, convex_hull, scale.to_array().map(f64::to_bits));
            if let Some(known) = triangles.solids.get(&key) {
                return known.clone();
            }
            let surface = triangles.read(source, &DAffine3::from_scale(scale));
            let made = surface.and_then(|surface| if convex_hull { hull(&surface) } else { mesh(surface) });
            triangles.solids.insert(key, made.clone());
            made
        }
        // What has no thickness encloses nothing.
        _ if lengths.min_element() == 0.0 => {
            Ok(Solid { notices: vec!["is flattened by its scale and has no volume".to_owned()], ..Solid::empty() })
        }
        Geometry::Box { size } => Ok(Solid::of(Shape::cuboid(size * lengths * 0.5))),
        Geometry::Sphere { radius } if even(lengths) => Ok(Solid::of(Shape::sphere(radius * lengths.x))),
        Geometry::Sphere { radius } => Ok(Solid::of(Shape::ellipsoid(lengths * radius))),
        Geometry::Capsule { height, radius_bottom, radius_top } => {
            let capsule = |factor: f64| match (radius_bottom * factor, radius_top * factor, 0.5 * height * factor) {
                (bottom, top, half_height) if bottom == top => Shape::capsule(bottom, half_height),
                (radius_bottom, radius_top, half_height) => {
                    Shape::TaperedCapsule { radius_bottom, radius_top, half_height }
                }
            };
            if even(lengths) { Ok(Solid::of(capsule(lengths.x))) } else { stretched(&capsule(1.0), lengths, triangles) }
        }
        Geometry::Cylinder { height, radius_bottom, radius_top } => {
            let cylinder =
                |across: f64, along: f64| match (radius_bottom * across, radius_top * across, 0.5 * height * along) {
                    (bottom, top, half_height) if bottom == top => Shape::cylinder(bottom, half_height),
                    (bottom, 0.0, half_height) => Shape::cone(bottom, half_height),
                    (radius_bottom, radius_top, half_height) => {
                        Shape::Frustum { radius_bottom, radius_top, half_height }
                    }
                };
            if even(DVec3::new(lengths.x, lengths.x, lengths.z)) {
                Ok(Solid::of(cylinder(lengths.x, lengths.y)))
            } else {
                stretched(&cylinder(1.0, 1.0), lengths, triangles)
            }
        }
    }
}

fn even(lengths: DVec3) -> bool {
    lengths.max_element() - lengths.min_element() <= EVEN * lengths.max_element()
}

/// A round shape under a scale that leaves no round shape: the hull of its surface's vertices.
fn stretched(shape: &Shape, factors: DVec3, triangles: &mut Triangles<'_>) -> Result<Solid, FieldError> {
    let surface = Tessellation::of(shape).stretched(factors);
    triangles.take(surface.positions.len())?;
    let mut solid = hull_of(&surface.positions)?;
    solid.notices.push("is scaled unevenly and taken as the hull of its surface out of 24 sides".to_owned());
    Ok(solid)
}

fn hull(surface: &TriangleMesh) -> Result<Solid, FieldError> {
    Ok(Solid { surface: Some(Arc::new(surface.clone())), ..hull_of(surface.positions())? })
}

fn hull_of(points: &[DVec3]) -> Result<Solid, FieldError> {
    if points.len() > MAX_HULL_POINTS {
        let problem = format!("has {} vertices, a hull is made of at most {MAX_HULL_POINTS}", points.len());
        return Err(FieldError::new("", problem));
    }
    let solid = convex_hull(points).ok().and_then(|hull| hull.solid().ok());
    match solid {
        Some(solid) => Ok(Solid::of(Shape::Mesh(Arc::new(solid)))),
        None => Ok(Solid { notices: vec!["is flat and encloses no volume".to_owned()], ..Solid::empty() }),
    }
}

/// A mesh as it is if it encloses a volume, mended where that is safe, its hull where it is open.
fn mesh(surface: TriangleMesh) -> Result<Solid, FieldError> {
    if let Ok(solid) = surface.solid() {
        let surface = Some(Arc::new(surface));
        return Ok(Solid { surface, ..Solid::of(Shape::Mesh(Arc::new(solid))) });
    }
    match surface.repaired() {
        Ok((solid, repairs)) => {
            let notices = repairs.iter().map(|repair| format!("mesh is mended: {repair}")).collect();
            let surface = Some(Arc::new(surface));
            Ok(Solid { surface, notices, ..Solid::of(Shape::Mesh(Arc::new(solid))) })
        }
        Err(_) => {
            let mut solid = hull(&surface)?;
            solid.notices.push("is an open or broken mesh; mass and inertia are those of its convex hull".to_owned());
            Ok(solid)
        }
    }
}
