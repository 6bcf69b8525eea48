//! What a document costs is limited by what is in it and beside it, not by how often that is named:
//! work is counted, not timed.

use std::fmt::Write as _;

use proptest::prelude::*;
use tumble::Shape;

use super::*;
use crate::error::Scope;
use crate::gltf::collider::MADE;

/// An octahedron of 6 vertices and 8 triangles, as a buffer of positions and indices.
fn octahedron() -> Vec<u8> {
    let corners =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0_f32]];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5_u16]];
    let corners = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes());
    corners.chain(faces.as_flattened().iter().flat_map(|index| index.to_le_bytes())).collect()
}

const VERTICES: usize = 6;
const TRIANGLES: usize = 8;

/// Bodies that take a mesh each, by its number, with a scale; every mesh has buffers of its own,
/// which all name the same file.
fn document(bodies: &[(usize, f64, bool)], meshes: usize, uri: &str) -> String {
    let (mut nodes, mut lists) = (String::new(), [const { String::new() }; 4]);
    for (mesh, scale, moves) in bodies {
        let motion = if *moves { r#""motion": { "mass": 1 }, "# } else { "" };
        let geometry = format!(r#"{{ "node": {} }}"#, bodies.len() + mesh);
        let physics = format!(r#"{{ {motion}"collider": {{ "geometry": {geometry} }} }}"#);
        let _ = write!(
            nodes,
            r#"{{ "scale": [{scale}, {scale}, {scale}], "extensions": {{ "KHR_physics_rigid_bodies": {physics} }} }},"#
        );
    }
    let (positions, bytes) = (VERTICES * 12, octahedron().len());
    for mesh in 0..meshes {
        let _ = write!(nodes, r#"{{ "mesh": {mesh} }},"#);
        let (first, second) = (2 * mesh, 2 * mesh + 1);
        let entries = [
            format!(r#"{{ "primitives": [ {{ "attributes": {{ "POSITION": {first} }}, "indices": {second} }} ] }},"#),
            format!(
                r#"{{ "bufferView": {first}, "componentType": 5126, "count": {VERTICES}, "type": "VEC3" }}, {{ "bufferView": {second}, "componentType": 5123, "count": {}, "type": "SCALAR" }},"#,
                3 * TRIANGLES
            ),
            format!(
                r#"{{ "buffer": {first}, "byteLength": {positions} }}, {{ "buffer": {second}, "byteOffset": {positions}, "byteLength": {} }},"#,
                bytes - positions
            ),
            format!(
                r#"{{ "uri": "{uri}", "byteLength": {positions} }}, {{ "uri": "./{uri}", "byteLength": {bytes} }},"#
            ),
        ];
        lists.iter_mut().zip(entries).for_each(|(list, entry)| list.push_str(&entry));
    }
    let roots = (0..bodies.len()).map(|index| index.to_string()).collect::<Vec<_>>().join(", ");
    let cut = |list: &str| list.trim_end_matches(',').to_owned();
    let [meshes, accessors, views, buffers] = lists.map(|list| cut(&list));
    format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "scenes": [ {{ "nodes": [{roots}] }} ], "nodes": [ {} ], "meshes": [ {meshes} ],
            "accessors": [ {accessors} ], "bufferViews": [ {views} ], "buffers": [ {buffers} ] }}"#,
        cut(&nodes)
    )
}

/// What it costs to read the bodies.
struct Cost {
    bytes: u64,
    work: usize,
    solids: usize,
    colliders: usize,
    bodies: Vec<GltfBody>,
}

fn cost(text: &str, directory: &Path) -> Cost {
    let mut reading = Reading::default();
    let read = File::read(text.as_bytes(), "scene.gltf").unwrap();
    MADE.with(|made| made.set(0));
    let mut triangles = read.triangles(Some(directory), &mut reading);
    let (bodies, ..) = bodies::bodies((&read.physics, &read.tree), &mut triangles, InertiaRepairs::Refused);
    let (work, solids) = (triangles.work(), triangles.solids.len());
    Cost { bytes: reading.bytes(), work, solids, colliders: MADE.with(std::cell::Cell::get), bodies }
}

/// The file has more than its buffers are said to have.
fn place() -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    let mut bytes = octahedron();
    bytes.resize(100_000, 0);
    std::fs::write(place.path().join("a.bin"), bytes).unwrap();
    place
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// However many bodies, meshes and buffers name a thing, it is read and made once for each size
    /// that it is wanted in.
    #[test]
    fn shared_things_cost_once(
        meshes in 1_usize..12,
        bodies in prop::collection::vec((0_usize..12, prop::sample::select(vec![1.0, 2.0, 0.5]), any::<bool>()), 1..120),
    ) {
        let place = place();
        let bodies: Vec<_> = bodies.into_iter().map(|(mesh, scale, moves)| (mesh % meshes, scale, moves)).collect();
        let cost = cost(&document(&bodies, meshes, "a.bin"), place.path());
        prop_assert!(cost.bodies.iter().all(|body| body.body.is_ok()));
        prop_assert_eq!(cost.bytes, 100_000);
        let distinct = |with_motion: bool| {
            let key = |(mesh, scale, moves): &(usize, f64, bool)| (*mesh, scale.to_bits(), with_motion && *moves);
            bodies.iter().map(key).collect::<std::collections::HashSet<_>>().len()
        };
        let solids = distinct(false);
        prop_assert_eq!(cost.solids, solids);
        prop_assert_eq!(cost.work, solids * (1 + VERTICES + TRIANGLES));
        prop_assert_eq!(cost.colliders, distinct(true));
    }
}

/// Shared or not, each body has the volume of its own size.
#[test]
fn what_is_shared_is_what_each_would_have_had() {
    let place = place();
    let bodies: Vec<_> = (0..30).map(|index| (index % 3, [1.0, 2.0, 0.5][index % 2], true)).collect();
    let all = cost(&document(&bodies, 3, "a.bin"), place.path());
    for (body, one) in all.bodies.iter().zip(&bodies) {
        let alone = cost(&document(&[*one], 3, "a.bin"), place.path());
        let (body, alone) = (body.body.as_ref().unwrap(), alone.bodies[0].body.as_ref().unwrap());
        assert_eq!(body.body.properties(), alone.body.properties());
        assert_eq!(body.collider, alone.collider);
        let [Some(Shape::Mesh(mesh))] = [&body.pieces[0].shape] else { panic!("no mesh") };
        // Four thirds of the cube of its half diagonal.
        assert!((mesh.volume() / (4.0 / 3.0 * one.1.powi(3)) - 1.0).abs() < 1e-14);
    }
}

/// A scene's own limit, of what all its buffers have together, and not of what they are said to
/// have.
#[test]
fn limits_are_of_the_whole_document() {
    let place = place();
    let text = document(&[(0, 1.0, true)], 1, "a.bin");
    let read = File::read(text.as_bytes(), "scene.gltf").unwrap();
    // Sparse: they take no space. Two of them are more than the limit.
    for name in ["x.bin", "y.bin"] {
        let file = std::fs::File::create(place.path().join(name)).unwrap();
        file.set_len(MAX_FILE_BYTES / 2 + 1).unwrap();
    }
    let text = text.replace("./a.bin", "y.bin").replace("a.bin", "x.bin");
    let mut reading = Reading::default();
    let both = File::read(text.as_bytes(), "scene.gltf").unwrap();
    let (bodies, ..) = bodies::bodies(
        (&both.physics, &both.tree),
        &mut both.triangles(Some(place.path()), &mut reading),
        InertiaRepairs::Refused,
    );
    let Err(error) = &bodies[0].body else { panic!("no limit") };
    assert_eq!(error.scope, Scope::Limit("bytes in all buffers together", MAX_FILE_BYTES));
    // Of triangles: the last that has room is made, the next is not.
    let mut reading = Reading::default();
    let mut triangles = read.triangles(Some(place.path()), &mut reading);
    triangles.take(triangles::MAX_TRIANGLES - VERTICES - TRIANGLES - 1).unwrap();
    let (bodies, ..) = bodies::bodies((&read.physics, &read.tree), &mut triangles, InertiaRepairs::Refused);
    assert!(bodies[0].body.is_ok());
    let text = document(&[(0, 1.0, true), (0, 2.0, true)], 1, "a.bin");
    let twice = File::read(text.as_bytes(), "scene.gltf").unwrap();
    let mut reading = Reading::default();
    let mut triangles = twice.triangles(Some(place.path()), &mut reading);
    triangles.take(triangles::MAX_TRIANGLES - VERTICES - TRIANGLES - 2).unwrap();
    let (bodies, ..) = bodies::bodies((&twice.physics, &twice.tree), &mut triangles, InertiaRepairs::Refused);
    let Err(error) = &bodies[1].body else { panic!("no limit") };
    assert_eq!(error.scope, Scope::Limit(triangles::OF_COLLIDERS, triangles::MAX_TRIANGLES as u64));
    assert!(matches!(
        GltfBodies::from_bytes(deep(10_001).as_bytes(), None, "deep.gltf", InertiaRepairs::Refused),
        Err(FileError::TooMuch { limit: 10_000, what: "nodes above one another", .. })
    ));
    assert!(GltfBodies::from_bytes(deep(10_000).as_bytes(), None, "deep.gltf", InertiaRepairs::Refused).is_ok());
}

/// A chain of nodes.
fn deep(nodes: usize) -> String {
    let node = |index: usize| {
        if index + 1 < nodes { format!(r#"{{ "children": [{}] }}"#, index + 1) } else { "{}".to_owned() }
    };
    let nodes = (0..nodes).map(node).collect::<Vec<_>>().join(",");
    format!(r#"{{ "asset": {{ "version": "2.0" }}, "scenes": [ {{ "nodes": [0] }} ], "nodes": [ {nodes} ] }}"#)
}
