//! What a glTF file says of its colliders.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use tumble::{Shape, TriangleMesh};

use crate::bodies::collider_geometry::Geometry;
use crate::bodies::surface_material::{CollisionFilter, SurfaceMaterial};

/// A collider or trigger of a body, as its file describes it.
///
/// ```
/// use tumble_import::InertiaRepairs;
/// use tumble_import::gltf::GltfBodies;
///
/// let text = r#"{ "asset": { "version": "2.0" },
/// "extensions": { "KHR_implicit_shapes": { "shapes": [ { "type": "sphere", "sphere": {
///     "radius": 0.5 } } ] } },
/// "nodes": [ { "name": "ball", "extensions": { "KHR_physics_rigid_bodies": {
///     "motion": { "mass": 2 }, "collider": { "geometry": { "shape": 0 } } } } } ] }"#;
/// let file = GltfBodies::from_bytes(text.as_bytes(), None, "ball.gltf", InertiaRepairs::Refused)?;
/// let ball = file.bodies[0].body.as_ref().map_err(ToString::to_string)?;
/// let collider = &ball.pieces[0];
/// assert_eq!((collider.name.as_str(), collider.shape.is_some()), ("ball", true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ImportedCollider {
    /// The name of the node that it is.
    pub name: String,
    /// What it is for.
    pub role: ColliderRole,
    /// As the file has it, before the scale of its node.
    pub geometry: Geometry,
    /// The shape that the engine makes of it, in the collider's frame; `None` for what encloses no
    /// volume.
    pub shape: Option<Shape>,
    /// The triangles of a mesh, in the collider's frame, open or not.
    pub surface: Option<Arc<TriangleMesh>>,
    /// Where the collider's frame is in the body's \[m\].
    pub position: DVec3,
    /// The rotation from the collider's frame to the body's.
    pub orientation: DQuat,
    /// Its surface.
    pub material: SurfaceMaterial,
    /// With whom it collides; with all if absent.
    pub filter: Option<Arc<CollisionFilter>>,
}

/// What a collider is for.
///
/// ```
/// use tumble_import::gltf::GltfBodies;
/// use tumble_import::{ColliderRole, InertiaRepairs};
///
/// let text = r#"{ "asset": { "version": "2.0" },
/// "extensions": { "KHR_implicit_shapes": { "shapes": [ { "type": "sphere", "sphere": {
///     "radius": 0.5 } } ] } },
/// "nodes": [ { "name": "ball", "extensions": { "KHR_physics_rigid_bodies": {
///     "motion": { "mass": 2 }, "collider": { "geometry": { "shape": 0 } } } } } ] }"#;
/// let file = GltfBodies::from_bytes(text.as_bytes(), None, "ball.gltf", InertiaRepairs::Refused)?;
/// let ball = file.bodies[0].body.as_ref().map_err(ToString::to_string)?;
/// assert_eq!(ball.pieces[0].role, ColliderRole::Solid);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColliderRole {
    /// Others bounce off it.
    Solid,
    /// A sensor: it reports what comes into it and pushes nothing.
    Trigger,
}
