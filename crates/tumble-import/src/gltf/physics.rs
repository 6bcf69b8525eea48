//! What a document says of physics.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use crate::error::FieldError;
use crate::gltf::Joint;
use crate::gltf::Motion;
use crate::gltf::document::{Document, JointOfNode, KhrTrigger, Node, OmiShape, PhysicsTables};
use crate::gltf::motion::Dialect;
use crate::gltf::tree::{Place, Tree};
use crate::gltf::{CollisionFilter, SurfaceMaterial};
use crate::gltf::{Geometry, geometry};

/// The physics of a glTF file, read and checked, in the world's frame: Y up, metres, kilograms,
/// seconds.
///
/// It follows the drafts KHR_physics_rigid_bodies and KHR_implicit_shapes at revision ac5c413 of
/// `eoineoineoin/glTF_Physics` (2025-10-29) and OMI_physics_body, OMI_physics_shape and
/// OMI_physics_joint at 89d328b of `omigroup/gltf-extensions`. Of a node that has both, KHR's alone
/// counts. [`GltfBodies`](crate::gltf::GltfBodies) is the bodies that it makes.
///
/// ```
/// use tumble_import::gltf::Physics;
///
/// let physics = Physics::from_json(
///     r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "extensions": { "KHR_physics_rigid_bodies": { "motion": { "mass": 2 } } } } ] }"#,
///     "scene.gltf",
/// )?;
/// assert_eq!(physics.nodes.len(), 1);
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Physics {
    /// The nodes of the scene that have any physics, by index.
    pub nodes: Vec<PhysicsNode>,
    /// What is read and not simulated, or not read: a line each.
    pub notices: Vec<String>,
}

/// A node with physics.
///
/// ```
/// use tumble_import::gltf::Physics;
///
/// let physics = Physics::from_json(
///     r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "extensions": { "KHR_physics_rigid_bodies": { "motion": { "mass": 2,
///     "linearVelocity": [0, 0, 3] } } } } ] }"#,
///     "scene.gltf",
/// )?;
/// let node = &physics.nodes[0];
/// assert_eq!((node.index, node.body, node.linear_velocity().z), (0, Some(0), 3.0));
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PhysicsNode {
    /// Its index in the file.
    pub index: usize,
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Where its origin is in the world \[m\].
    pub position: DVec3,
    /// The rotation from its frame to the world.
    pub rotation: DQuat,
    /// Its scale along its own axes; negative where it mirrors.
    pub scale: DVec3,
    /// The node whose motion carries it: itself or the nearest above it that has one. `None` for
    /// what stands still.
    pub body: Option<usize>,
    /// How it moves.
    pub motion: Option<Motion>,
    /// What others collide with.
    pub collider: Option<Collider>,
    /// A volume that notices what enters it.
    pub trigger: Option<Trigger>,
    /// What connects it to another node.
    pub joint: Option<JointTo>,
}

impl PhysicsNode {
    /// Velocity of the centre of mass in the world [m/s].
    #[must_use]
    pub fn linear_velocity(&self) -> DVec3 {
        self.motion.map_or(DVec3::ZERO, |motion| self.rotation * motion.linear_velocity)
    }

    /// Angular velocity in the world [rad/s].
    #[must_use]
    pub fn angular_velocity(&self) -> DVec3 {
        self.motion.map_or(DVec3::ZERO, |motion| self.rotation * motion.angular_velocity)
    }

    /// The centre of mass in the world \[m\], where the file says it.
    #[must_use]
    pub fn center_of_mass(&self) -> Option<DVec3> {
        Some(self.position + self.rotation * (self.scale * self.motion?.center_of_mass?))
    }
}

/// The collider of a node.
///
/// ```
/// use tumble_import::gltf::Physics;
///
/// let physics = Physics::from_json(
///     r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "extensions": { "KHR_physics_rigid_bodies": { "collider": { "geometry": { "shape": 0 } }
///     } } } ],
/// "extensions": { "KHR_implicit_shapes": { "shapes": [ { "type": "sphere", "sphere": {
///     "radius": 0.5 } } ] } } }"#,
///     "scene.gltf",
/// )?;
/// let collider = physics.nodes[0].collider.as_ref();
/// assert!(
///     collider.is_some_and(|collider| collider.geometry.is_some() && collider.material.is_none())
/// );
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Collider {
    /// Its shape; `None` for a node that only holds together those below it, which OMI allows.
    pub geometry: Option<Geometry>,
    /// Its surface, if the file gives it one.
    pub material: Option<SurfaceMaterial>,
    /// With whom it collides; with all if absent.
    pub filter: Option<Arc<CollisionFilter>>,
}

/// The trigger of a node.
///
/// ```
/// use tumble_import::gltf::Physics;
///
/// let physics = Physics::from_json(
///     r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "extensions": { "KHR_physics_rigid_bodies": { "trigger": { "geometry": { "shape": 0 } } }
///     } } ],
/// "extensions": { "KHR_implicit_shapes": { "shapes": [ { "type": "sphere", "sphere": {
///     "radius": 0.5 } } ] } } }"#,
///     "scene.gltf",
/// )?;
/// let trigger = physics.nodes[0].trigger.as_ref();
/// assert!(trigger.is_some_and(|trigger| trigger.geometry.is_some() && trigger.nodes.is_empty()));
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Trigger {
    /// Its shape; `None` for a compound.
    pub geometry: Option<Geometry>,
    /// The nodes that make up a compound.
    pub nodes: Vec<usize>,
    /// Whom it notices; all if absent.
    pub filter: Option<Arc<CollisionFilter>>,
}

/// A joint between two nodes.
///
/// ```
/// use tumble_import::gltf::Physics;
///
/// let physics = Physics::from_json(
///     r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "extensions": { "KHR_physics_rigid_bodies": { "motion": {}, "joint": {
///     "connectedNode": 1, "joint": 0 } } } }, {} ],
/// "extensions": { "KHR_physics_rigid_bodies": { "physicsJoints": [ {
///     "limits": [ { "linearAxes": [0, 1, 2] } ], "drives": [ { "type": "angular",
///         "mode": "force", "axis": 1, "velocityTarget": 3 } ] } ] } } }"#,
///     "scene.gltf",
/// )?;
/// assert!(physics.nodes[0].joint.as_ref().is_some_and(|to| to.connected_node == 1));
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct JointTo {
    /// The other node.
    pub connected_node: usize,
    /// What it allows and drives.
    pub joint: Arc<Joint>,
    /// Whether the two bodies collide.
    pub enable_collision: bool,
}

impl Physics {
    pub(crate) fn of(document: &Document, tree: &Tree) -> Result<Self, FieldError> {
        let tables = &document.extensions;
        for (extension, table) in [
            ("KHR_physics_rigid_bodies", &tables.khr),
            ("OMI_physics_body", &tables.omi),
            ("OMI_physics_joint", &tables.omi_joints),
        ] {
            check_table(table).map_err(|error| error.inside(&format!("extensions.{extension}")))?;
        }
        let bodies = tree.inherited(|index| document.nodes.get(index).filter(|node| moves(node)).map(|_| index));
        let mut nodes = Vec::new();
        for (index, (node, place)) in document.nodes.iter().zip(&tree.places).enumerate() {
            let Some(place) = place else { continue };
            let read = physics_node(document, index, node, place);
            let read = read.map_err(|error| match &node.name {
                Some(name) => error.of_node(index, name),
                None => error.inside(&format!("nodes[{index}]")),
            })?;
            nodes.extend(read.map(|node| PhysicsNode { body: bodies.get(index).copied().flatten(), ..node }));
        }
        Ok(Self { nodes, notices: Vec::new() })
    }

    /// The node of this index, if it has physics.
    #[must_use]
    pub fn node(&self, index: usize) -> Option<&PhysicsNode> {
        self.nodes.binary_search_by_key(&index, |node| node.index).ok().and_then(|at| self.nodes.get(at))
    }
}

/// Whether a node has a motion, by whichever extension.
fn moves(node: &Node) -> bool {
    let extensions = &node.extensions;
    extensions.khr.as_ref().is_some_and(|khr| khr.motion.is_some())
        || extensions.omi.as_ref().is_some_and(|omi| omi.motion.is_some())
}

fn physics_node(
    document: &Document,
    index: usize,
    node: &Node,
    place: &Place,
) -> Result<Option<PhysicsNode>, FieldError> {
    let mut found = PhysicsNode {
        index,
        name: node.name.clone(),
        position: place.transform.translation,
        rotation: place.rotation,
        scale: place.scale,
        body: None,
        motion: None,
        collider: None,
        trigger: None,
        joint: None,
    };
    if node.extensions.khr.is_none() {
        omi(document, node, &mut found)?;
    }
    if let Some(khr) = &node.extensions.khr {
        let inside = |field: &str| {
            let field = format!("extensions.KHR_physics_rigid_bodies.{field}");
            move |error: FieldError| error.inside(&field)
        };
        if let Some(model) = &khr.motion {
            let motion = Motion::new(model, Dialect::Khr).map_err(|(field, problem)| FieldError::new(field, problem));
            found.motion = Some(motion.map_err(inside("motion"))?);
        }
        let table = &document.extensions.khr;
        if let Some(model) = &khr.collider {
            let geometry = geometry::of_khr(document, &model.geometry).map_err(inside("collider.geometry"))?;
            found.collider = Some(Collider {
                geometry: Some(geometry),
                material: material(table, model.physics_material).map_err(inside("collider"))?,
                filter: filter(table, model.collision_filter).map_err(inside("collider"))?,
            });
        }
        if let Some(model) = &khr.trigger {
            found.trigger = Some(khr_trigger(document, model).map_err(inside("trigger"))?);
        }
        if let Some(model) = &khr.joint {
            found.joint = Some(joint(document, &table.physics_joints, model).map_err(inside("joint"))?);
        }
    }
    let any = found.motion.is_some() || found.collider.is_some() || found.trigger.is_some() || found.joint.is_some();
    Ok(any.then_some(found))
}

/// What OMI's extensions say of a node.
fn omi(document: &Document, node: &Node, found: &mut PhysicsNode) -> Result<(), FieldError> {
    let table = &document.extensions.omi;
    let inside = |field: &str| {
        let field = format!("extensions.OMI_physics_body.{field}");
        move |error: FieldError| error.inside(&field)
    };
    if let Some(omi) = &node.extensions.omi {
        if let Some(model) = &omi.motion {
            let motion = Motion::new(model, Dialect::Omi).map_err(|(field, problem)| FieldError::new(field, problem));
            found.motion = Some(motion.map_err(inside("motion"))?);
        }
        if let Some(model) = &omi.collider {
            found.collider = Some(Collider {
                geometry: omi_geometry(document, model).map_err(inside("collider"))?,
                material: material(table, given(model.physics_material)).map_err(inside("collider"))?,
                filter: filter(table, given(model.collision_filter)).map_err(inside("collider"))?,
            });
        }
        if let Some(model) = &omi.trigger {
            found.trigger = Some(Trigger {
                geometry: omi_geometry(document, model).map_err(inside("trigger"))?,
                nodes: existing(document, &model.nodes).map_err(inside("trigger"))?,
                filter: filter(table, given(model.collision_filter)).map_err(inside("trigger"))?,
            });
        }
    }
    if let Some(model) = &node.extensions.omi_joint {
        let joints = &document.extensions.omi_joints.physics_joints;
        let found_joint = joint(document, joints, model);
        found.joint = Some(found_joint.map_err(|error| error.inside("extensions.OMI_physics_joint"))?);
    }
    Ok(())
}

fn omi_geometry(document: &Document, model: &OmiShape) -> Result<Option<Geometry>, FieldError> {
    geometry::of_omi(document, model.shape.unwrap_or(-1))
}

/// OMI's index, which is -1 for none. What is more negative is out of range of every table.
fn given(index: Option<i64>) -> Option<usize> {
    index.filter(|index| *index != -1).map(|index| usize::try_from(index).unwrap_or(usize::MAX))
}

fn khr_trigger(document: &Document, model: &KhrTrigger) -> Result<Trigger, FieldError> {
    let geometry = model.geometry.as_ref().map(|geometry| geometry::of_khr(document, geometry)).transpose();
    Ok(Trigger {
        geometry: geometry.map_err(|error| error.inside("geometry"))?,
        nodes: existing(document, &model.nodes)?,
        filter: filter(&document.extensions.khr, model.collision_filter)?,
    })
}

/// The nodes of a compound trigger.
fn existing(document: &Document, nodes: &[usize]) -> Result<Vec<usize>, FieldError> {
    match nodes.iter().find(|node| **node >= document.nodes.len()) {
        Some(missing) => Err(FieldError::new("nodes", format!("there is no nodes[{missing}]"))),
        None => Ok(nodes.to_vec()),
    }
}

fn joint(document: &Document, joints: &[Arc<Joint>], model: &JointOfNode) -> Result<JointTo, FieldError> {
    if model.connected_node >= document.nodes.len() {
        return Err(FieldError::new("connectedNode", format!("there is no nodes[{}]", model.connected_node)));
    }
    let missing = || FieldError::new("joint", format!("there is no physicsJoints[{}]", model.joint));
    Ok(JointTo {
        connected_node: model.connected_node,
        joint: joints.get(model.joint).ok_or_else(missing)?.clone(),
        enable_collision: model.enable_collision,
    })
}

fn material(table: &PhysicsTables, index: Option<usize>) -> Result<Option<SurfaceMaterial>, FieldError> {
    entry(&table.physics_materials, index, "physicsMaterial")
}

fn filter(table: &PhysicsTables, index: Option<usize>) -> Result<Option<Arc<CollisionFilter>>, FieldError> {
    entry(&table.collision_filters, index, "collisionFilter")
}

fn entry<T: Clone>(entries: &[T], index: Option<usize>, field: &str) -> Result<Option<T>, FieldError> {
    let Some(index) = index else { return Ok(None) };
    let missing = || FieldError::new(field, format!("there is no {field}s[{index}]"));
    entries.get(index).cloned().map(Some).ok_or_else(missing)
}

fn check_table(table: &PhysicsTables) -> Result<(), FieldError> {
    for (index, material) in table.physics_materials.iter().enumerate() {
        if let Some((field, problem)) = material.problem() {
            return Err(FieldError::new(format!("physicsMaterials[{index}].{field}"), problem));
        }
    }
    for (index, filter) in table.collision_filters.iter().enumerate() {
        if filter.collide_with_systems.is_some() && filter.not_collide_with_systems.is_some() {
            let problem = "collideWithSystems is given too: give one of them";
            return Err(FieldError::new(format!("collisionFilters[{index}].notCollideWithSystems"), problem));
        }
    }
    for (index, joint) in table.physics_joints.iter().enumerate() {
        joint.check().map_err(|error| error.inside(&format!("physicsJoints[{index}]")))?;
    }
    Ok(())
}
