//! The JSON of a glTF file, as far as physics needs it.

use std::sync::Arc;

use serde::{Deserialize, Deserializer};
use serde_json::Value;

use super::joint::Joint;
use super::material::{CollisionFilter, SurfaceMaterial};

/// A whole document. What is not listed here is passed over.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    pub(super) asset: Asset,
    pub(super) scene: Option<usize>,
    pub(super) scenes: Vec<Roots>,
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<BufferView>,
    pub(super) buffers: Vec<Buffer>,
    pub(super) animations: Vec<Animation>,
    pub(super) extensions_used: Vec<String>,
    pub(super) extensions_required: Vec<String>,
    pub(super) extensions: Tables,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Asset {
    pub(super) version: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Roots {
    pub(super) name: Option<String>,
    pub(super) nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) children: Vec<usize>,
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    pub(super) extensions: NodeExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "KHR_physics_rigid_bodies")]
    pub(super) khr: Option<Box<KhrNode>>,
    #[serde(rename = "OMI_physics_body")]
    pub(super) omi: Option<Box<OmiNode>>,
    #[serde(rename = "OMI_physics_joint")]
    pub(super) omi_joint: Option<JointOfNode>,
}

/// `nodes[i].extensions.KHR_physics_rigid_bodies`.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct KhrNode {
    pub(super) motion: Option<MotionModel>,
    pub(super) collider: Option<KhrCollider>,
    pub(super) trigger: Option<KhrTrigger>,
    pub(super) joint: Option<JointOfNode>,
}

/// `nodes[i].extensions.OMI_physics_body`.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct OmiNode {
    pub(super) motion: Option<MotionModel>,
    pub(super) collider: Option<OmiShape>,
    pub(super) trigger: Option<OmiShape>,
}

/// The motions of both extensions: `is_kinematic` is KHR's, `type` OMI's.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct MotionModel {
    pub(super) is_kinematic: bool,
    pub(super) r#type: Option<String>,
    pub(super) mass: Option<f64>,
    pub(super) center_of_mass: Option<[f64; 3]>,
    pub(super) inertia_diagonal: Option<[f64; 3]>,
    pub(super) inertia_orientation: Option<[f64; 4]>,
    pub(super) linear_velocity: Option<[f64; 3]>,
    pub(super) angular_velocity: Option<[f64; 3]>,
    pub(super) gravity_factor: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct KhrCollider {
    pub(super) geometry: GeometryModel,
    pub(super) physics_material: Option<usize>,
    pub(super) collision_filter: Option<usize>,
}

/// Either a geometry or, for a compound, the nodes that have one.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct KhrTrigger {
    pub(super) geometry: Option<GeometryModel>,
    pub(super) nodes: Vec<usize>,
    pub(super) collision_filter: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct GeometryModel {
    pub(super) shape: Option<usize>,
    pub(super) node: Option<usize>,
    pub(super) convex_hull: bool,
}

/// OMI writes -1 for what is absent.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct OmiShape {
    pub(super) shape: Option<i64>,
    pub(super) nodes: Vec<usize>,
    pub(super) physics_material: Option<i64>,
    pub(super) collision_filter: Option<i64>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct JointOfNode {
    pub(super) connected_node: usize,
    pub(super) joint: usize,
    #[serde(default)]
    pub(super) enable_collision: bool,
}

/// `extensions` of the document.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Tables {
    #[serde(rename = "KHR_physics_rigid_bodies")]
    pub(super) khr: PhysicsTables,
    #[serde(rename = "KHR_implicit_shapes")]
    pub(super) khr_shapes: ShapeTable,
    #[serde(rename = "OMI_physics_body")]
    pub(super) omi: PhysicsTables,
    #[serde(rename = "OMI_physics_shape")]
    pub(super) omi_shapes: ShapeTable,
    #[serde(rename = "OMI_physics_joint")]
    pub(super) omi_joints: PhysicsTables,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct PhysicsTables {
    pub(super) physics_materials: Vec<SurfaceMaterial>,
    #[serde(deserialize_with = "shared")]
    pub(super) collision_filters: Vec<Arc<CollisionFilter>>,
    #[serde(deserialize_with = "shared")]
    pub(super) physics_joints: Vec<Arc<Joint>>,
}

/// Entries that many nodes refer to, however long they are.
fn shared<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Arc<T>>, D::Error> {
    Vec::<T>::deserialize(deserializer).map(|entries| entries.into_iter().map(Arc::new).collect())
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct ShapeTable {
    pub(super) shapes: Vec<ShapeModel>,
}

/// A shape of either extension. Only the member that `type` names counts, and it may be absent.
#[derive(Debug, Deserialize)]
pub(super) struct ShapeModel {
    pub(super) r#type: String,
    pub(super) sphere: Option<RoundModel>,
    pub(super) r#box: Option<BoxModel>,
    pub(super) capsule: Option<RoundModel>,
    pub(super) cylinder: Option<RoundModel>,
    pub(super) plane: Option<PlaneModel>,
    pub(super) convex: Option<MeshModel>,
    pub(super) trimesh: Option<MeshModel>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct BoxModel {
    pub(super) size: Option<[f64; 3]>,
}

/// A sphere, a capsule or a cylinder.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct RoundModel {
    pub(super) radius: Option<f64>,
    pub(super) height: Option<f64>,
    pub(super) radius_bottom: Option<f64>,
    pub(super) radius_top: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct PlaneModel {
    pub(super) double_sided: bool,
    pub(super) size_x: Option<f64>,
    pub(super) size_z: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct MeshModel {
    pub(super) mesh: Option<i64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Mesh {
    pub(super) primitives: Vec<Primitive>,
    pub(super) weights: Vec<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    pub(super) mode: Option<u64>,
    pub(super) extensions: serde_json::Map<String, Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub(super) position: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    pub(super) normalized: bool,
    pub(super) count: usize,
    pub(super) r#type: String,
    pub(super) sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
    pub(super) extensions: serde_json::Map<String, Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: usize,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Animation {
    pub(super) name: Option<String>,
    pub(super) channels: Vec<Channel>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Channel {
    pub(super) target: Target,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Target {
    pub(super) node: Option<usize>,
}
