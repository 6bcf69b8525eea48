//! From the shapes of bodies to those of colliders.

use std::sync::Arc;

use glam::DVec3;
use tumble_collide::{Compound, ConvexHull, Isometry};
use tumble_math::{Part, Shape};

use crate::collision::collider_error::ColliderError;
use crate::components::Pose;
use crate::math::{Real, quat, real, vec3};
use crate::range::{LENGTHS, within};

pub(crate) type ColliderShape = tumble_collide::ColliderShape<Real>;

/// In the precision of the build.
fn length(field: &'static str, value: f64) -> Result<Real, ColliderError> {
    let length = real(value);
    match length {
        _ if !(length.is_normal() && length > 0.0) => Err(ColliderError::Length { field, value }),
        _ if !LENGTHS.contains(&length) => Err(ColliderError::Size { field, value }),
        _ => Ok(length),
    }
}

/// Of two radii one may be zero.
fn radii(bottom: f64, top: f64) -> Result<[Real; 2], ColliderError> {
    let or_zero = |field, value: f64, other: f64| {
        if value == 0.0 && other != 0.0 { Ok(0.0) } else { length(field, value) }
    };
    Ok([or_zero("radius_bottom", bottom, top)?, or_zero("radius_top", top, bottom)?])
}

pub(crate) fn of_shape(shape: &Shape) -> Result<ColliderShape, ColliderError> {
    let all = |field, values: DVec3| values.to_array().into_iter().try_for_each(|x| length(field, x).map(drop));
    let half_height = |value| length("half_height", value);
    Ok(match *shape {
        Shape::Point => return Err(ColliderError::Shape { shape: "point" }),
        Shape::Sphere { radius } | Shape::HollowSphere { radius } => {
            ColliderShape::Sphere { radius: length("radius", radius)? }
        }
        Shape::Cuboid { half_extents } => {
            all("half_extents", half_extents)?;
            ColliderShape::Cuboid { half_extents: vec3(half_extents).into() }
        }
        Shape::Cylinder { radius, half_height: h } => {
            ColliderShape::Cylinder { radius: length("radius", radius)?, half_height: half_height(h)? }
        }
        Shape::Capsule { radius, half_height: h } => {
            ColliderShape::Capsule { radius: length("radius", radius)?, half_height: half_height(h)? }
        }
        Shape::Cone { radius, half_height: h } => {
            ColliderShape::Cone { radius: length("radius", radius)?, half_height: half_height(h)? }
        }
        Shape::Frustum { radius_bottom, radius_top, half_height: h } => {
            let [radius_bottom, radius_top] = radii(radius_bottom, radius_top)?;
            ColliderShape::Frustum { radius_bottom, radius_top, half_height: half_height(h)? }
        }
        Shape::TaperedCapsule { radius_bottom, radius_top, half_height: h } => {
            let [radius_bottom, radius_top] = radii(radius_bottom, radius_top)?;
            ColliderShape::TaperedCapsule { radius_bottom, radius_top, half_height: half_height(h)? }
        }
        Shape::Ellipsoid { radii } => {
            all("radii", radii)?;
            ColliderShape::Ellipsoid { radii: vec3(radii).into() }
        }
        Shape::Mesh(ref mesh) => hull(mesh.mesh().positions())?,
        Shape::Compound(ref parts) => compound(parts, 1)?,
        _ => return Err(ColliderError::Shape { shape: "shape of this kind" }),
    })
}

/// The collider shape of a compound.
fn compound(parts: &[Part], depth: usize) -> Result<ColliderShape, ColliderError> {
    let mut found = Vec::new();
    if depth > Shape::MAX_DEPTH {
        return Err(ColliderError::Shape { shape: "compound nested so deep" });
    }
    for (index, part) in parts.iter().enumerate() {
        let in_part = |error| ColliderError::Part { part: index, error: Box::new(error) };
        let geometry = match &part.shape {
            // A weight, with nothing to touch.
            Shape::Point => continue,
            Shape::Compound(inner) => compound(inner, depth + 1),
            shape => of_shape(shape),
        };
        let geometry = geometry.map_err(in_part)?;
        let offset = Pose { position: vec3(part.position), orientation: quat(part.orientation.normalize()) };
        if !within(offset.position.into(), *LENGTHS.end()) || !offset.orientation.is_finite() {
            return Err(in_part(ColliderError::Offset { offset }));
        }
        let at = Isometry { position: offset.position.into(), orientation: offset.orientation.into() };
        found.push((at, geometry));
    }
    if found.is_empty() {
        return Err(ColliderError::Shape { shape: "compound of points" });
    }
    Ok(ColliderShape::Compound(Arc::new(Compound::new(found))))
}

pub(crate) fn hull(points: &[DVec3]) -> Result<ColliderShape, ColliderError> {
    let points: Vec<_> = points.iter().map(|point| (*point).into()).collect();
    checked(ColliderShape::Hull(Arc::new(ConvexHull::new(&points)?)))
}

/// Sizes given in double precision must not vanish in that of the build.
pub(crate) fn checked(geometry: ColliderShape) -> Result<ColliderShape, ColliderError> {
    match geometry.reach() {
        Some(reach) if !(reach.is_normal() && reach > 0.0) => {
            Err(ColliderError::Length { field: "extent", value: reach.into() })
        }
        Some(reach) if !LENGTHS.contains(&reach) => Err(ColliderError::Size { field: "extent", value: reach.into() }),
        _ => Ok(geometry),
    }
}
