//! What a glTF file says of its colliders.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use tumble::{Shape, TriangleMesh};

use crate::bodies::collider_geometry::Geometry;
use crate::bodies::surface_material::{CollisionFilter, SurfaceMaterial};

/// A collider or trigger of a body, as its file describes it.
///
/// ```
/// use tumble_scene::Scene;
///
/// let text = r#"{ "asset": { "version": "2.0" },
///     "extensions": { "KHR_implicit_shapes": { "shapes": [ { "type": "sphere", "sphere": { "radius": 0.5 } } ] } },
///     "nodes": [ { "name": "ball", "extensions": { "KHR_physics_rigid_bodies": {
///         "motion": { "mass": 2 }, "collider": { "geometry": { "shape": 0 } } } } } ] }"#;
/// let scene = Scene::from_gltf(text.as_bytes(), "ball.gltf")?;
/// let (body, collider) = scene.colliders().next().ok_or("no collider")?;
/// assert_eq!((body, collider.name.as_str(), collider.shape.is_some()), (0, "ball", true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SceneCollider {
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
/// use tumble_scene::{ColliderRole, Scene};
///
/// let text = r#"{ "asset": { "version": "2.0" },
///     "extensions": { "KHR_implicit_shapes": { "shapes": [ { "type": "sphere", "sphere": { "radius": 0.5 } } ] } },
///     "nodes": [ { "name": "ball", "extensions": { "KHR_physics_rigid_bodies": {
///         "motion": { "mass": 2 }, "collider": { "geometry": { "shape": 0 } } } } } ] }"#;
/// let scene = Scene::from_gltf(text.as_bytes(), "ball.gltf")?;
/// let (body, collider) = scene.colliders().next().ok_or("no collider")?;
/// assert_eq!((body, collider.role), (0, ColliderRole::Solid));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColliderRole {
    /// Others bounce off it.
    Solid,
    /// It notices what enters it.
    Trigger,
}
