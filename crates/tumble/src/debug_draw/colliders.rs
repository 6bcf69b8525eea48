//! Wireframe outlines of colliders.

use glam::DVec3;
use tumble_collide::{ColliderShape, Isometry};
use tumble_math::Shape;

use crate::collision::collider::Collider;
use crate::components::Pose;
use crate::debug_draw::outline::outline;
use crate::math::{Real, dquat, dvec3};

/// The edges of a collider of a body whose frame is given.
pub(crate) fn outline_collider(collider: &Collider, frame: Pose, draw: &mut dyn FnMut(DVec3, DVec3)) {
    let frame = Isometry { position: frame.position.into(), orientation: frame.orientation.into() };
    outline_geometry(collider.geometry(), &collider.placement(frame), draw);
}

/// Solids are outlined as the shapes that they are of; surfaces have edges of their own.
fn outline_geometry(geometry: &ColliderShape<Real>, at: &Isometry<Real>, draw: &mut dyn FnMut(DVec3, DVec3)) {
    let (position, orientation) = (dvec3(at.position.into()), dquat(at.orientation.into()));
    let edge = |ends: [_; 2]| {
        let [from, to] = ends.map(|end| position + orientation * DVec3::from(end));
        draw(from, to);
    };
    let shape = match *geometry {
        ColliderShape::Sphere { radius } => Shape::sphere(radius),
        ColliderShape::Cuboid { half_extents } => Shape::cuboid(dvec3(half_extents.into())),
        ColliderShape::Capsule { radius, half_height } => Shape::capsule(radius, half_height),
        ColliderShape::Cylinder { radius, half_height } => Shape::cylinder(radius, half_height),
        ColliderShape::Cone { radius, half_height } => Shape::cone(radius, half_height),
        ColliderShape::Frustum { radius_bottom, radius_top, half_height } => {
            Shape::frustum(radius_bottom, radius_top, half_height)
        }
        ColliderShape::TaperedCapsule { radius_bottom, radius_top, half_height } => {
            Shape::tapered_capsule(radius_bottom, radius_top, half_height)
        }
        ColliderShape::Ellipsoid { radii } => Shape::ellipsoid(dvec3(radii.into())),
        ColliderShape::Hull(ref hull) => return hull.edges().for_each(edge),
        ColliderShape::Mesh(ref mesh) => return mesh.edges().for_each(edge),
        ColliderShape::HeightField(ref field) => return field.edges().for_each(edge),
        ColliderShape::Compound(ref compound) => {
            for (inner, part) in compound.parts() {
                outline_geometry(part, &at.then(inner), draw);
            }
            return;
        }
        // A half-space has no edges.
        _ => return,
    };
    outline(&shape, position, orientation, draw);
}
