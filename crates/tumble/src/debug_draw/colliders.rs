//! Wireframe outlines of colliders.

use glam::DVec3;
use tumble_collide::{ColliderShape, Isometry};
use tumble_math::Shape;

use crate::collision::collider::Collider;
use crate::components::Pose;
use crate::debug_draw::outline::outline;
use crate::math::{Real, dquat, dvec3};

/// The edges of a collider of a body whose frame is given, each with whether it is of a sensor.
pub(crate) fn outline_collider(collider: &Collider, frame: Pose, draw: &mut dyn FnMut(DVec3, DVec3, bool)) {
    let frame = Isometry { position: frame.position.into(), orientation: frame.orientation.into() };
    let at = collider.placement(frame);
    let ColliderShape::Compound(compound) = collider.geometry() else {
        let is_sensor = collider.is_sensor();
        return outline_geometry(collider.geometry(), &at, &mut |from, to| draw(from, to, is_sensor));
    };
    for (place, (inner, part)) in (0..).zip(compound.parts()) {
        let (_, is_sensor) = collider.role_of_part(place);
        outline_geometry(part, &at.then(inner), &mut |from, to| draw(from, to, is_sensor));
    }
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
        // A half-space has no edges; parts of compounds are outlined one by one.
        _ => return,
    };
    outline(&shape, position, orientation, draw);
}
