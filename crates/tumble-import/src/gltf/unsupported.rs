//! What a document has that is not read: refused where its meaning would be lost, named where it
//! would only be missed.

use std::collections::HashSet;

use crate::error::FieldError;
use crate::gltf::Physics;
use crate::gltf::document::Document;
use crate::gltf::tree::Tree;

/// Extensions that are read.
const READ: [&str; 6] = [
    "KHR_physics_rigid_bodies",
    "KHR_implicit_shapes",
    "OMI_physics_body",
    "OMI_physics_shape",
    "OMI_physics_joint",
    "KHR_mesh_quantization",
];

/// Beginnings of the names of extensions that change how things look or are packed, and not how
/// they move.
const OF_LOOKS: [&str; 13] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "KHR_audio_",
    "EXT_texture_",
    "EXT_lights_",
    "EXT_materials_",
    "MSFT_texture_",
    "GODOT_single_root",
    // Where a collider needs such a mesh, it is refused there.
    "KHR_draco_mesh_compression",
    "KHR_meshopt_compression",
    "EXT_meshopt_compression",
];

/// Most names in one notice.
const MAX_NAMES: usize = 8;

/// Refuses a document of another version, and one that requires what is not read and may matter.
pub(crate) fn refuse(document: &Document) -> Result<(), FieldError> {
    let version = &document.asset.version;
    if version.is_empty() {
        return Err(FieldError::new("asset.version", "is missing: this is no glTF"));
    }
    if version.split('.').next() != Some("2") {
        return Err(FieldError::new("asset.version", format!("is {version:?}, only 2 can be read")));
    }
    let unknown = |name: &&String| {
        !READ.contains(&name.as_str()) && !OF_LOOKS.iter().any(|beginning| name.starts_with(beginning))
    };
    match document.extensions_required.iter().find(unknown) {
        Some(name) => Err(FieldError::new("extensionsRequired", format!("{name} is required and not read"))),
        None => Ok(()),
    }
}

/// A line for everything that is in the document and not in the simulation.
pub(crate) fn notices(document: &Document, tree: &Tree, physics: &Physics) -> Vec<String> {
    let mut notices = Vec::new();
    let called = |index: usize| document.nodes.get(index).and_then(|node| node.name.as_deref());
    let mut list = |what: &str, nodes: Vec<usize>| {
        if !nodes.is_empty() {
            notices.push(listed(what, &nodes, called));
        }
    };
    let in_scene = |index: &usize| tree.places.get(*index).is_some_and(Option::is_some);
    let placed: Vec<usize> = (0..document.nodes.len()).filter(in_scene).collect();
    let sheared = |index: &usize| tree.places.get(*index).copied().flatten().is_some_and(|place| place.sheared);
    let of_physics = |index: &usize| physics.node(*index).is_some();
    list(
        "sheared by uneven scales above them, taken without the shear",
        placed.iter().copied().filter(sheared).filter(of_physics).collect(),
    );
    let both = |index: &usize| {
        document.nodes.get(*index).is_some_and(|node| node.extensions.khr.is_some() && node.extensions.omi.is_some())
    };
    list("physics of KHR and of OMI, KHR's counts", placed.iter().copied().filter(both).collect());
    let targets: HashSet<usize> = document
        .animations
        .iter()
        .flat_map(|animation| animation.channels.iter().filter_map(|channel| channel.target.node))
        .collect();
    let animated = tree.inherited(|index| targets.get(&index).copied());
    let moved = placed.iter().copied().filter(of_physics).filter(|index| animated[*index].is_some()).collect();
    list("animations are not played, physics moves", moved);
    let bare = |index: &usize| document.nodes.get(*index).is_some_and(|node| node.mesh.is_some());
    let carried = tree.inherited(|index| physics.node(index).map(|_| index));
    list(
        "meshes without physics are not part of the scene",
        placed.iter().copied().filter(bare).filter(|index| carried[*index].is_none()).collect(),
    );
    let outside = (0..document.nodes.len()).filter(|index| {
        let node = &document.nodes[*index].extensions;
        !in_scene(index) && (node.khr.is_some() || node.omi.is_some())
    });
    list("physics of nodes outside the scene is left out", outside.collect());
    let unread: Vec<&str> =
        document.extensions_used.iter().map(String::as_str).filter(|name| !READ.contains(name)).collect();
    if !unread.is_empty() {
        notices.push(format!("extensions that are not read: {}", unread.join(", ")));
    }
    notices
}

/// A line about some nodes: how many there are, and the first of them by number and name.
pub(crate) fn listed<'a>(what: &str, nodes: &[usize], called: impl Fn(usize) -> Option<&'a str>) -> String {
    let named = |index: &usize| match called(*index) {
        Some(name) => format!("nodes[{index}] {:?}", crate::terminal::quoted(name)),
        None => format!("nodes[{index}]"),
    };
    let names: Vec<String> = nodes.iter().take(MAX_NAMES).map(named).collect();
    let more = if nodes.len() > MAX_NAMES { ", …" } else { "" };
    format!("{what} ({}): {}{more}", nodes.len(), names.join(", "))
}
