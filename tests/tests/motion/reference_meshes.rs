//! Promise: volume, centre of mass and inertia of what a triangle mesh bounds agree with exact
//! figures, wherever it is and however it is turned; what bounds nothing is refused.
//!
//! The figures of `tests/data/inertia_meshes.json` were computed in rational numbers from the files
//! in `tests/data/meshes`. It fails if an integral, a sign or a frame is wrong, or if digits are
//! lost far from the origin.

use crate::reference::{Check, list, matrix};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use proptest::prelude::*;
use serde_json::Value;
use tumble_math::{
    Amount, MassProperties, MeshDefect, MeshError, Shape, SolidMesh, TriangleMesh, change_of_basis, convex_hull,
};
use tumble_tests::largest;
use tumble_tests::meshes::{block, reference_mesh, sphere, torus, without_shared_vertices};
use tumble_tests::references::{number, parse, vector};

/// Of density one.
fn properties(solid: &SolidMesh) -> MassProperties {
    solid.mass_properties(Amount::Density(1.0)).unwrap()
}

/// The records that bound a solid, and their meshes.
fn solids(file: &Value) -> impl Iterator<Item = (&Value, TriangleMesh)> {
    let good = list(file, "meshes").iter().filter(|record| record.get("expect").is_none());
    good.map(|record| (record, reference_mesh(record["file"].as_str().unwrap())))
}

fn figures() -> Value {
    parse(include_str!("../../data/inertia_meshes.json"))
}

fn relative(actual: f64, expected: f64) -> f64 {
    (actual - expected).abs() / expected.abs()
}

/// The root of the mean square distance from the centre, as the size of a body.
fn radius(tensor: DMat3, volume: f64) -> f64 {
    (0.5 * (tensor.x_axis.x + tensor.y_axis.y + tensor.z_axis.z) / volume).sqrt()
}

#[test]
fn figures_of_reference_meshes() {
    let file = figures();
    let mut check = Check::new("inertia_meshes", &file);
    let mut count = 0;
    for (record, mesh) in solids(&file) {
        let name = record["file"].as_str().unwrap();
        for mesh in [mesh.clone(), without_shared_vertices(&mesh)] {
            let audit = mesh.audit();
            assert_eq!(audit.problems(), [], "{name}");
            assert_eq!(audit.triangles as u64, record["n_faces"].as_u64().unwrap());
            assert_eq!((audit.vertices - audit.duplicate_vertices) as u64, record["n_vertices"].as_u64().unwrap());
            check.error(name, relative(audit.area, number(&record["surface_area"])));
            let solid = mesh.solid().unwrap();
            let (volume, tensor) = (number(&record["volume"]), matrix(&record["inertia_com"]));
            check.error(name, relative(audit.volume, volume));
            check.error(name, relative(solid.volume(), volume));
            let size = radius(tensor, volume);
            check.error(name, (solid.center_of_mass() - vector(&record["com"])).length() / size);
            let actual = properties(&solid);
            check.error(name, largest(actual.tensor_about_center() - tensor) / largest(tensor));
            let moments = actual.inertia().unwrap().principal().moments;
            let mut moments = moments.to_array();
            moments.sort_by(f64::total_cmp);
            for (moment, expected) in moments.into_iter().zip(list(record, "principal_moments")) {
                check.error(name, relative(moment, number(expected)));
            }
        }
        count += 1;
    }
    assert_eq!(count, 8);
    check.report();
}

#[test]
fn what_bounds_nothing_is_refused() {
    let file = figures();
    let refused = ["m23_inverted.obj", "m24_open.obj"].map(reference_mesh);
    let defects = [MeshDefect::InsideOutParts { parts: 1 }, MeshDefect::OpenEdges { edges: 3 }];
    for (mesh, defect) in refused.iter().zip(defects) {
        assert_eq!(mesh.solid().unwrap_err(), MeshError::NotSolid { defects: vec![defect] });
    }
    assert_eq!(refused[0].audit().volume, number(&list(&file, "meshes")[8]["volume"]));
    let (turned, repairs) = refused[0].repaired().unwrap();
    assert_eq!(repairs.iter().map(ToString::to_string).collect::<Vec<_>>(), ["1 part turned outside out"]);
    assert_eq!(turned.volume(), 6.0);
    // Turned round, its inertia is that of the record with the opposite sign.
    let tensor = matrix(&list(&file, "meshes")[8]["inertia_com"]);
    assert!(largest(properties(&turned).tensor_about_center() + tensor) <= 1e-12 * largest(tensor));
    assert_eq!(refused[1].repaired().unwrap_err(), refused[1].solid().unwrap_err());
}

#[test]
fn far_away_nothing_is_lost_but_what_the_vertices_lose() {
    let file = figures();
    for (record, mesh) in solids(&file) {
        let name = record["file"].as_str().unwrap();
        // First with vertices on a grid of 2^-20 m, shifted by 2^20 m: exact, so that near and far
        // are the same body.
        let grid: Vec<DVec3> = mesh.positions().iter().map(|p| (*p * 1048576.0).round() / 1048576.0).collect();
        let near = TriangleMesh::new(grid, mesh.triangles()).unwrap();
        let offset = DVec3::new(1048576.0, -2097152.0, 3145728.0);
        let far = near.transformed(&DAffine3::from_translation(offset)).unwrap();
        let [near, far] = [near, far].map(|mesh| properties(&mesh.solid().unwrap()));
        let (tensor, shifted) = (near.tensor_about_center(), far.tensor_about_center());
        // The same integrals with the same numbers, but for the rounding of the shift to local
        // coordinates near the origin.
        assert!(largest(tensor - shifted) <= 1e-14 * largest(tensor), "{name}");
        assert!(relative(far.mass(), near.mass()) <= 1e-14, "{name}");
        // The centre itself is a number of some 1e6 m: half a unit of its last place.
        assert!((far.center_of_mass() - offset - near.center_of_mass()).abs().max_element() <= 2.4e-10, "{name}");

        // Then shifted by 1e6 m on each axis, which rounds vertices to 0.6e-10 m: the surface moves
        // by sqrt(3) times that at most; times area and largest squared distance it is the bound.
        let far = mesh.transformed(&DAffine3::from_translation(DVec3::splat(1e6))).unwrap();
        let [near, far] = [mesh, far].map(|mesh| (mesh.audit(), properties(&mesh.solid().unwrap())));
        let shift = 3.0_f64.sqrt() * 0.5 * 2.0_f64.powi(-33);
        let reach = (near.0.extents.1 - near.0.extents.0).length();
        let bound = near.0.area * shift * reach * reach;
        let tensor = near.1.tensor_about_center();
        assert!(largest(tensor - far.1.tensor_about_center()) <= bound, "{name}");
        // That bound is some 1e-8; roundings of many vertices cancel each other in part.
        assert!(largest(tensor - far.1.tensor_about_center()) <= 1e-9 * largest(tensor), "{name}");
    }
}

#[test]
fn a_turned_mesh_has_the_turned_tensor() {
    let file = figures();
    for (record, mesh) in solids(&file) {
        let name = record["file"].as_str().unwrap();
        let near = properties(&mesh.solid().unwrap());
        for (turn, angle) in [(DVec3::X, 0.3), (DVec3::new(0.6, 0.0, -0.8), 2.0), (DVec3::NEG_Y, 1.5)] {
            let rotation = DQuat::from_axis_angle(turn, angle);
            let position = DVec3::new(3.0, -2.0, 7.0);
            let moved = mesh.transformed(&DAffine3::from_rotation_translation(rotation, position)).unwrap();
            let moved = properties(&moved.solid().unwrap());
            let expected = near.transformed(position, rotation).unwrap();
            let tensor = expected.tensor_about_center();
            // Vertices are rounded when they are turned and moved, to eps of some 10 m.
            assert!(largest(moved.tensor_about_center() - tensor) <= 1e-13 * largest(tensor), "{name}");
            assert!((moved.center_of_mass() - expected.center_of_mass()).length() <= 1e-13 * 10.0, "{name}");
        }
        // A mirror image keeps its outside; the products of inertia with the mirrored axis change
        // sign.
        let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        let mirrored = properties(&mesh.transformed(&DAffine3::from_mat3(mirror)).unwrap().solid().unwrap());
        let tensor = mirror * near.tensor_about_center() * mirror;
        assert!(largest(mirrored.tensor_about_center() - tensor) <= 1e-14 * largest(tensor), "{name}");
        assert!(relative(mirrored.mass(), near.mass()) <= 1e-14);
    }
}

#[test]
fn a_block_is_the_block_of_the_shapes() {
    for half_extents in [DVec3::new(0.1, 0.05, 0.03), DVec3::new(3.0, 1e-4, 2.0), DVec3::new(1e-6, 1e3, 1e3)] {
        let expected = Shape::cuboid(half_extents).mass_properties(Amount::Density(7.0)).unwrap();
        for (offset, shift) in [(DVec3::ZERO, 0.0), (DVec3::new(0.5, 0.25, -0.125), 1e-15)] {
            let mesh = block(half_extents).transformed(&DAffine3::from_translation(offset)).unwrap();
            let actual = mesh.solid().unwrap().mass_properties(Amount::Density(7.0)).unwrap();
            // The thinnest side is a difference of coordinates that the offset has rounded.
            let tolerance = 1e-14 + shift * offset.length() / half_extents.min_element();
            assert!(relative(actual.mass(), expected.mass()) <= tolerance);
            let tensor = expected.tensor_about_center();
            assert!(largest(actual.tensor_about_center() - tensor) <= tolerance * largest(tensor));
            // Each diagonal element to its own size, also the smallest of a plate.
            for axis in 0..3 {
                let (actual, expected) = (actual.tensor_about_center().col(axis)[axis], tensor.col(axis)[axis]);
                assert!(relative(actual, expected) <= 3.0 * tolerance, "{half_extents} {axis}");
            }
        }
    }
}

#[test]
fn any_size_from_the_smallest_length_to_the_largest() {
    let unit = properties(&torus(1.0, 0.3, 12, 8).solid().unwrap());
    for exponent in [-280, -100, -1, 30, 200, 270] {
        let scale = 2.0_f64.powi(exponent);
        let mesh = torus(1.0, 0.3, 12, 8).transformed(&DAffine3::from_scale(DVec3::splat(scale))).unwrap();
        let solid = mesh.solid().unwrap();
        assert_eq!(solid.volume(), unit.mass() * scale * scale * scale);
        let one = solid.mass_properties(Amount::Mass(1.0)).unwrap().tensor_about_center();
        let expected = unit.scaled_to_mass(1.0).unwrap().tensor_about_center() * (scale * scale);
        assert!(largest(one - expected) <= 1e-15 * largest(expected), "2^{exponent}");
    }
    let dust = torus(1.0, 0.3, 12, 8).transformed(&DAffine3::from_scale(DVec3::splat(1e-100))).unwrap();
    assert!(matches!(dust.solid(), Err(MeshError::Extent { .. })));
}

#[test]
fn a_cavity_is_taken_away() {
    let (outer, inner) = (sphere(1.0, 3), block([0.2, 0.3, 0.1]));
    let pose = DAffine3::from_rotation_translation(DQuat::from_rotation_y(0.4), DVec3::new(0.3, 0.2, -0.4));
    let inner = inner.transformed(&pose).unwrap();
    let both = TriangleMesh::merged([outer.clone(), tumble_tests::meshes::inside_out(&inner)]).unwrap();
    let hollow = both.solid().unwrap();
    assert_eq!((hollow.parts(), hollow.cavities()), (2, 1));
    let [whole, hole] = [outer, inner].map(|mesh| properties(&mesh.solid().unwrap()));
    let expected = whole.without(&hole).unwrap();
    let actual = properties(&hollow);
    assert!(relative(actual.mass(), expected.mass()) <= 1e-14);
    assert!((actual.center_of_mass() - expected.center_of_mass()).length() <= 1e-14);
    let tensor = expected.tensor_about_center();
    assert!(largest(actual.tensor_about_center() - tensor) <= 1e-14 * largest(tensor));
}

/// The facets lie inside the torus: its volume is `2 pi^2 R r^2`, and with n sides to the tube and
/// m around, what lacks goes with 1/n^2 and 1/m^2. Exactly, the volume of such a torus is that of
/// the regular polygons it is swept from.
#[test]
fn a_finely_divided_torus_comes_near_the_smooth_one() {
    let (ring, tube) = (2.0, 0.5);
    let smooth = 2.0 * std::f64::consts::PI.powi(2) * ring * tube * tube;
    let mut lacks = Vec::new();
    for sides in [16, 32, 64] {
        let solid = torus(ring, tube, 2 * sides, sides).solid().unwrap();
        lacks.push(1.0 - solid.volume() / smooth);
        let moment = properties(&solid).tensor_about_center().z_axis.z / solid.volume();
        assert!(relative(moment, ring * ring + 0.75 * tube * tube) <= 12.0 / f64::from(sides * sides));
    }
    for pair in lacks.windows(2) {
        assert!((pair[0] / pair[1] - 4.0).abs() <= 0.05, "{lacks:?}");
    }
}

fn points(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<DVec3>> {
    let coordinate = -1.0..1.0_f64;
    let point = (coordinate.clone(), coordinate.clone(), coordinate).prop_map(DVec3::from);
    proptest::collection::vec(point, count)
}

proptest! {
    /// A convex solid is cut into tetrahedra from one of its corners, whose mass properties have a
    /// closed form of their own.
    #[test]
    fn a_convex_solid_is_the_sum_of_its_tetrahedra(points in points(8..40), far in -1e3..1e3_f64) {
        let hull = convex_hull(&points).unwrap();
        let hull = hull.transformed(&DAffine3::from_translation(DVec3::new(far, 2.0 * far, -far))).unwrap();
        let (positions, apex) = (hull.positions(), hull.positions()[0]);
        let mut sum: Option<MassProperties> = None;
        for corners in hull.triangles().iter().filter(|corners| !corners.contains(&0)) {
            let [a, b, c] = corners.map(|corner| positions[corner as usize]);
            // Where the apex lies nearly in a face, the tetrahedron is nothing.
            if let Ok(part) = MassProperties::tetrahedron([apex, a, b, c], Amount::Density(1.0)) {
                sum = Some(sum.map_or(part, |sum| sum + part));
            }
        }
        let (actual, expected) = (properties(&hull.solid().unwrap()), sum.unwrap());
        // The closed form for tetrahedra scales badly where they are slivers: 1e-12.
        prop_assert!(relative(actual.mass(), expected.mass()) <= 1e-12);
        prop_assert!((actual.center_of_mass() - expected.center_of_mass()).length() <= 1e-12 * (1.0 + far.abs()));
        let tensor = expected.tensor_about_center();
        prop_assert!(largest(actual.tensor_about_center() - tensor) <= 1e-11 * largest(tensor));
        let turn = DQuat::from_rotation_x(far);
        let turned = hull.transformed(&DAffine3::from_quat(turn)).unwrap();
        let turned = properties(&turned.solid().unwrap()).tensor_about_center();
        // Turning rounds vertices some 1e3 m away to 1e-13 m.
        prop_assert!(largest(turned - change_of_basis(actual.tensor_about_center(), turn)) <= 1e-10 * largest(turned));
    }
}
