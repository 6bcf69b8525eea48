//! Meshes for the tests: read from the reference files, or made.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::Path;

use glam::DVec3;
use tumble_math::TriangleMesh;

/// A mesh of `tests/data/meshes`.
pub fn reference_mesh(file: &str) -> TriangleMesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/meshes").join(file);
    let text = std::fs::read_to_string(path).expect("a file of this package");
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f64> = words.map(|word| word.parse().expect("a coordinate")).collect();
                positions.push(DVec3::from_slice(&numbers));
            }
            Some("f") => {
                let corners: Vec<u32> = words.map(|word| word.parse::<u32>().expect("a corner") - 1).collect();
                triangles.push(corners.try_into().expect("a triangle"));
            }
            _ => {}
        }
    }
    TriangleMesh::new(positions, triangles).expect("a mesh")
}

/// A block about the origin, wound outwards. Vertices are numbered by the bits of `zyx`.
pub fn block(half_extents: impl Into<DVec3>) -> TriangleMesh {
    let half_extents = half_extents.into();
    let sign = |i: u32, axis: u32| if i >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let corners = (0..8).map(|i| DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)) * half_extents);
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    TriangleMesh::new(corners.collect::<Vec<_>>(), triangles.collect::<Vec<_>>()).expect("a mesh")
}

/// A torus about z with the radii of its middle and of its tube.
pub fn torus(ring: f64, tube: f64, around: u32, across: u32) -> TriangleMesh {
    let mut positions = Vec::new();
    for i in 0..around {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(around)).sin_cos();
        for j in 0..across {
            let (up, out) = (TAU * f64::from(j) / f64::from(across)).sin_cos();
            let distance = ring + tube * out;
            positions.push(DVec3::new(distance * cos, distance * sin, tube * up));
        }
    }
    let at = |i: u32, j: u32| i % around * across + j % across;
    let squares = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let triangles = squares.flat_map(|(i, j)| {
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        [[a, b, c], [a, c, d]]
    });
    TriangleMesh::new(positions, triangles.collect::<Vec<_>>()).expect("a mesh")
}

/// A sphere of this radius about the origin: an octahedron whose triangles are divided into four
/// this many times.
pub fn sphere(radius: f64, divisions: u32) -> TriangleMesh {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut positions: Vec<DVec3> = axes.into_iter().chain(axes.map(|axis| -axis)).collect();
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    for _ in 0..divisions {
        let mut middles = HashMap::new();
        let mut divided = Vec::with_capacity(4 * triangles.len());
        for &[a, b, c] in &triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to): (u32, u32)| {
                *middles.entry((from.min(to), from.max(to))).or_insert_with(|| {
                    positions.push((positions[from as usize] + positions[to as usize]).normalize());
                    positions.len() as u32 - 1
                })
            });
            divided.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = divided;
    }
    for position in &mut positions {
        *position *= radius;
    }
    TriangleMesh::new(positions, triangles).expect("a mesh")
}

/// Every triangle with three vertices of its own, as in files that know no shared ones.
pub fn without_shared_vertices(mesh: &TriangleMesh) -> TriangleMesh {
    let corners = mesh.triangles().iter().flatten().map(|corner| mesh.positions()[*corner as usize]);
    let count = mesh.triangles().len() as u32;
    let triangles: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriangleMesh::new(corners.collect::<Vec<_>>(), triangles).expect("a mesh")
}

/// The mesh with every triangle turned round.
pub fn inside_out(mesh: &TriangleMesh) -> TriangleMesh {
    let triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    TriangleMesh::new(mesh.positions(), triangles).expect("a mesh")
}
