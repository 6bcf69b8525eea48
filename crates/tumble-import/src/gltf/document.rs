//! The JSON of a glTF file, as far as physics needs it.

use std::sync::Arc;

use serde::{Deserialize, Deserializer};
use serde_json::Value;

use crate::gltf::Joint;
use crate::gltf::{CollisionFilter, SurfaceMaterial};

/// A whole document. What is not listed here is passed over.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct Document {
    pub(crate) asset: Asset,
    pub(crate) scene: Option<usize>,
    pub(crate) scenes: Vec<Roots>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) meshes: Vec<Mesh>,
    pub(crate) accessors: Vec<Accessor>,
    pub(crate) buffer_views: Vec<BufferView>,
    pub(crate) buffers: Vec<Buffer>,
    pub(crate) animations: Vec<Animation>,
    pub(crate) extensions_used: Vec<String>,
    pub(crate) extensions_required: Vec<String>,
    pub(crate) extensions: Tables,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Asset {
    pub(crate) version: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Roots {
    pub(crate) name: Option<String>,
    pub(crate) nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Node {
    pub(crate) name: Option<String>,
    pub(crate) children: Vec<usize>,
    pub(crate) matrix: Option<Box<[f64; 16]>>,
    pub(crate) translation: Option<[f64; 3]>,
    pub(crate) rotation: Option<[f64; 4]>,
    pub(crate) scale: Option<[f64; 3]>,
    pub(crate) mesh: Option<usize>,
    pub(crate) skin: Option<usize>,
    pub(crate) extensions: NodeExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct NodeExtensions {
    #[serde(rename = "KHR_physics_rigid_bodies")]
    pub(crate) khr: Option<Box<KhrNode>>,
    #[serde(rename = "OMI_physics_body")]
    pub(crate) omi: Option<Box<OmiNode>>,
    #[serde(rename = "OMI_physics_joint")]
    pub(crate) omi_joint: Option<JointOfNode>,
}

/// `nodes[i].extensions.KHR_physics_rigid_bodies`.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct KhrNode {
    pub(crate) motion: Option<MotionModel>,
    pub(crate) collider: Option<KhrCollider>,
    pub(crate) trigger: Option<KhrTrigger>,
    pub(crate) joint: Option<JointOfNode>,
}

/// `nodes[i].extensions.OMI_physics_body`.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct OmiNode {
    pub(crate) motion: Option<MotionModel>,
    pub(crate) collider: Option<OmiShape>,
    pub(crate) trigger: Option<OmiShape>,
}

/// The motions of both extensions: `is_kinematic` is KHR's, `type` OMI's.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct MotionModel {
    pub(crate) is_kinematic: bool,
    pub(crate) r#type: Option<String>,
    pub(crate) mass: Option<f64>,
    pub(crate) center_of_mass: Option<[f64; 3]>,
    pub(crate) inertia_diagonal: Option<[f64; 3]>,
    pub(crate) inertia_orientation: Option<[f64; 4]>,
    pub(crate) linear_velocity: Option<[f64; 3]>,
    pub(crate) angular_velocity: Option<[f64; 3]>,
    pub(crate) gravity_factor: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct KhrCollider {
    pub(crate) geometry: GeometryModel,
    pub(crate) physics_material: Option<usize>,
    pub(crate) collision_filter: Option<usize>,
}

/// Either a geometry or, for a compound, the nodes that have one.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct KhrTrigger {
    pub(crate) geometry: Option<GeometryModel>,
    pub(crate) nodes: Vec<usize>,
    pub(crate) collision_filter: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct GeometryModel {
    pub(crate) shape: Option<usize>,
    pub(crate) node: Option<usize>,
    pub(crate) convex_hull: bool,
}

/// OMI writes -1 for what is absent.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct OmiShape {
    pub(crate) shape: Option<i64>,
    pub(crate) nodes: Vec<usize>,
    pub(crate) physics_material: Option<i64>,
    pub(crate) collision_filter: Option<i64>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct JointOfNode {
    pub(crate) connected_node: usize,
    pub(crate) joint: usize,
    #[serde(default)]
    pub(crate) enable_collision: bool,
}

/// `extensions` of the document.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Tables {
    #[serde(rename = "KHR_physics_rigid_bodies")]
    pub(crate) khr: PhysicsTables,
    #[serde(rename = "KHR_implicit_shapes")]
    pub(crate) khr_shapes: ShapeTable,
    #[serde(rename = "OMI_physics_body")]
    pub(crate) omi: PhysicsTables,
    #[serde(rename = "OMI_physics_shape")]
    pub(crate) omi_shapes: ShapeTable,
    #[serde(rename = "OMI_physics_joint")]
    pub(crate) omi_joints: PhysicsTables,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct PhysicsTables {
    pub(crate) physics_materials: Vec<SurfaceMaterial>,
    #[serde(deserialize_with = "shared")]
    pub(crate) collision_filters: Vec<Arc<CollisionFilter>>,
    #[serde(deserialize_with = "shared")]
    pub(crate) physics_joints: Vec<Arc<Joint>>,
}

/// Entries that many nodes refer to, however long they are.
fn shared<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Arc<T>>, D::Error> {
    Vec::<T>::deserialize(deserializer).map(|entries| entries.into_iter().map(Arc::new).collect())
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct ShapeTable {
    pub(crate) shapes: Vec<ShapeModel>,
}

/// A shape of either extension. Only the member that `type` names counts, and it may be absent.
#[derive(Debug, Deserialize)]
pub(crate) struct ShapeModel {
    pub(crate) r#type: String,
    pub(crate) sphere: Option<RoundModel>,
    pub(crate) r#box: Option<BoxModel>,
    pub(crate) capsule: Option<RoundModel>,
    pub(crate) cylinder: Option<RoundModel>,
    pub(crate) plane: Option<PlaneModel>,
    pub(crate) convex: Option<MeshModel>,
    pub(crate) trimesh: Option<MeshModel>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct BoxModel {
    pub(crate) size: Option<[f64; 3]>,
}

/// A sphere, a capsule or a cylinder.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct RoundModel {
    pub(crate) radius: Option<f64>,
    pub(crate) height: Option<f64>,
    pub(crate) radius_bottom: Option<f64>,
    pub(crate) radius_top: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct PlaneModel {
    pub(crate) double_sided: bool,
    pub(crate) size_x: Option<f64>,
    pub(crate) size_z: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct MeshModel {
    pub(crate) mesh: Option<i64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Mesh {
    pub(crate) primitives: Vec<Primitive>,
    pub(crate) weights: Vec<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Primitive {
    pub(crate) attributes: Attributes,
    pub(crate) indices: Option<usize>,
    pub(crate) mode: Option<u64>,
    pub(crate) extensions: serde_json::Map<String, Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Attributes {
    #[serde(rename = "POSITION")]
    pub(crate) position: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct Accessor {
    pub(crate) buffer_view: Option<usize>,
    pub(crate) byte_offset: usize,
    pub(crate) component_type: u32,
    pub(crate) normalized: bool,
    pub(crate) count: usize,
    pub(crate) r#type: String,
    pub(crate) sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct BufferView {
    pub(crate) buffer: usize,
    pub(crate) byte_offset: usize,
    pub(crate) byte_length: usize,
    pub(crate) byte_stride: Option<usize>,
    pub(crate) extensions: serde_json::Map<String, Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct Buffer {
    pub(crate) uri: Option<String>,
    pub(crate) byte_length: usize,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Animation {
    pub(crate) name: Option<String>,
    pub(crate) channels: Vec<Channel>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Channel {
    pub(crate) target: Target,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Target {
    pub(crate) node: Option<usize>,
}
