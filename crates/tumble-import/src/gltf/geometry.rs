//! Shapes of colliders, as the file names them.

use glam::DVec3;

use crate::checked::MAX_COMPONENT;
use crate::error::FieldError;
use crate::gltf::document::{Document, GeometryModel, RoundModel, ShapeModel};
use crate::gltf::motion::Dialect;
use crate::gltf::{Geometry, MeshSource};

/// KHR's `geometry`, which is one of a shape and a node.
pub(crate) fn of_khr(document: &Document, model: &GeometryModel) -> Result<Geometry, FieldError> {
    match (model.shape, model.node) {
        (Some(_), Some(_)) => Err(FieldError::new("node", "shape is given too: give one of them")),
        (None, None) => Err(FieldError::new("shape", "is missing: give a shape or a node")),
        (None, Some(node)) if node >= document.nodes.len() => {
            Err(FieldError::new("node", format!("there is no nodes[{node}]")))
        }
        (None, Some(node)) => Ok(Geometry::Mesh { source: MeshSource::Node(node), convex_hull: model.convex_hull }),
        (Some(index), None) => {
            let shapes = &document.extensions.khr_shapes.shapes;
            let missing = || FieldError::new("shape", format!("there is no shape {index} in KHR_implicit_shapes"));
            of_shape(document, shapes.get(index).ok_or_else(missing)?, Dialect::Khr)
                .map_err(|error| error.inside(&format!("shape {index} of KHR_implicit_shapes")))
        }
    }
}

/// OMI's index of a shape, which is -1 for none.
pub(crate) fn of_omi(document: &Document, index: i64) -> Result<Option<Geometry>, FieldError> {
    if index == -1 {
        return Ok(None);
    }
    let shapes = &document.extensions.omi_shapes.shapes;
    let missing = || FieldError::new("shape", format!("there is no shape {index} in OMI_physics_shape"));
    let shape = usize::try_from(index).ok().and_then(|index| shapes.get(index)).ok_or_else(missing)?;
    of_shape(document, shape, Dialect::Omi)
        .map(Some)
        .map_err(|error| error.inside(&format!("shape {index} of OMI_physics_shape")))
}

/// What a shape has where it is silent: (radius of a capsule or cylinder, height of a capsule,
/// height of a cylinder) \[m\].
fn defaults(dialect: Dialect) -> (f64, f64, f64) {
    match dialect {
        Dialect::Khr => (0.25, 0.5, 0.5),
        Dialect::Omi => (0.5, 1.0, 2.0),
    }
}

fn of_shape(document: &Document, model: &ShapeModel, dialect: Dialect) -> Result<Geometry, FieldError> {
    let (radius, capsule, cylinder) = defaults(dialect);
    match model.r#type.as_str() {
        "box" => {
            let size = model.r#box.unwrap_or_default().size.unwrap_or([1.0; 3]);
            for length in size {
                positive("box.size", length)?;
            }
            Ok(Geometry::Box { size: DVec3::from_array(size) })
        }
        "sphere" => {
            let radius = model.sphere.unwrap_or_default().radius.unwrap_or(0.5);
            Ok(Geometry::Sphere { radius: positive("sphere.radius", radius)? })
        }
        "capsule" => {
            let (height, radius_bottom, radius_top) = round("capsule", model.capsule, capsule, radius)?;
            Ok(Geometry::Capsule { height, radius_bottom, radius_top })
        }
        "cylinder" => {
            let (height, radius_bottom, radius_top) = round("cylinder", model.cylinder, cylinder, radius)?;
            Ok(Geometry::Cylinder { height, radius_bottom, radius_top })
        }
        "plane" => {
            let plane = model.plane.unwrap_or_default();
            let length = |field: &str, length: Option<f64>| length.map(|length| positive(field, length)).transpose();
            Ok(Geometry::Plane {
                size_x: length("plane.sizeX", plane.size_x)?,
                size_z: length("plane.sizeZ", plane.size_z)?,
                double_sided: plane.double_sided,
            })
        }
        kind @ ("convex" | "trimesh") => {
            let model = if kind == "convex" { model.convex } else { model.trimesh };
            let index = model.and_then(|model| usize::try_from(model.mesh?).ok());
            match index.filter(|index| *index < document.meshes.len()) {
                Some(mesh) => Ok(Geometry::Mesh { source: MeshSource::Mesh(mesh), convex_hull: kind == "convex" }),
                None => Err(FieldError::new(format!("{kind}.mesh"), "names no mesh of the file")),
            }
        }
        other => {
            let known = "box, sphere, capsule, cylinder and plane, in OMI's also convex and trimesh";
            Err(FieldError::new("type", format!("{other:?} is not known; there are {known}")))
        }
    }
}

/// Height and radii of a capsule or a cylinder. One radius may be zero. Older files of both
/// extensions give one radius for both ends.
fn round(name: &str, model: Option<RoundModel>, height: f64, radius: f64) -> Result<(f64, f64, f64), FieldError> {
    let model = model.unwrap_or_default();
    let radius = model.radius.unwrap_or(radius);
    let (bottom, top) = (model.radius_bottom.unwrap_or(radius), model.radius_top.unwrap_or(radius));
    for (field, value) in [("radiusBottom", bottom), ("radiusTop", top)] {
        if value != 0.0 || (bottom == 0.0 && top == 0.0) {
            positive(&format!("{name}.{field}"), value)?;
        }
    }
    Ok((positive(&format!("{name}.height"), model.height.unwrap_or(height))?, bottom, top))
}

fn positive(field: &str, length: f64) -> Result<f64, FieldError> {
    if length > 0.0 && length <= MAX_COMPONENT {
        Ok(length)
    } else {
        Err(FieldError::new(field, format!("must be a positive length, not {}", crate::terminal::shortest(length))))
    }
}
