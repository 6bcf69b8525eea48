//! Promise: everything that is wrong with a triangle mesh is found and named, with how often; what
//! leaves no doubt is repaired, the rest refused.
//!
//! Each test breaks a good mesh in one way or several and states what the audit must count. It
//! fails if a defect is missed or counted twice, if a repair changes the solid that was meant, or
//! if bad data panic.

use glam::{DAffine3, DQuat, DVec3};
use proptest::prelude::*;
use tumble_math::{Amount, MeshDefect, MeshError, MeshRepair, ShapeErrorReason, SolidMesh, TriangleMesh};
use tumble_tests::meshes::{block, inside_out, sphere, torus, without_shared_vertices};

fn mesh(positions: &[DVec3], triangles: &[[u32; 3]]) -> TriangleMesh {
    TriangleMesh::new(positions, triangles).unwrap()
}

/// The mesh with its triangles changed.
fn with_triangles(mesh: &TriangleMesh, change: impl FnOnce(&mut Vec<[u32; 3]>)) -> TriangleMesh {
    let mut triangles = mesh.triangles().to_vec();
    change(&mut triangles);
    TriangleMesh::new(mesh.positions(), triangles).unwrap()
}

fn moved(mesh: &TriangleMesh, offset: impl Into<DVec3>) -> TriangleMesh {
    mesh.transformed(&DAffine3::from_translation(offset.into())).unwrap()
}

fn merged<const N: usize>(meshes: [TriangleMesh; N]) -> TriangleMesh {
    TriangleMesh::merged(meshes).unwrap()
}

fn refused(mesh: &TriangleMesh) -> Vec<MeshDefect> {
    match mesh.solid() {
        Err(MeshError::NotSolid { defects }) => defects,
        other => panic!("{other:?}"),
    }
}

fn beyond_repair(mesh: &TriangleMesh) -> Vec<MeshDefect> {
    match mesh.repaired() {
        Err(MeshError::NotSolid { defects }) => defects,
        other => panic!("{other:?}"),
    }
}

fn names(error: &MeshError) -> String {
    error.to_string()
}

#[test]
fn input_errors_name_what_is_at_fault() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let new = |positions: &[DVec3], triangles: &[[u32; 3]]| TriangleMesh::new(positions, triangles).unwrap_err();
    assert_eq!(names(&new(&corners, &[])), "a mesh needs at least one triangle");
    let bad = new(&corners, &[[0, 1, 2], [0, 3, 1]]);
    assert_eq!(names(&bad), "triangle 1 names vertex 3, but there are only 3, counted from 0");
    for (x, shown) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf"), (-1e91, "-1e91")] {
        let bad = new(&[DVec3::ZERO, DVec3::new(x, 0.0, 1.0), DVec3::Y], &[[0, 1, 2]]);
        assert_eq!(names(&bad), format!("vertex 1 at ({shown}, 0.0, 1.0) is not finite or beyond 1e90 m"));
    }
    assert_eq!(TriangleMesh::merged([]).unwrap_err(), MeshError::NoTriangles);
    for matrix in [DVec3::splat(1e300), DVec3::splat(f64::NAN), DVec3::INFINITY] {
        let error = block([1.0; 3]).transformed(&DAffine3::from_scale(matrix)).unwrap_err();
        assert!(matches!(error, MeshError::Position { vertex: 0, .. }), "{error}");
    }
}

#[test]
fn a_good_mesh_has_no_problems() {
    let audit = without_shared_vertices(&block([1.0, 2.0, 3.0])).audit();
    assert_eq!((audit.vertices, audit.duplicate_vertices, audit.triangles), (36, 28, 12));
    assert_eq!((audit.parts, audit.cavities, audit.inside_out_parts), (1, Some(0), 0));
    assert_eq!((audit.volume, audit.area), (48.0, 88.0));
    assert_eq!(audit.extents, (DVec3::new(-1.0, -2.0, -3.0), DVec3::new(1.0, 2.0, 3.0)));
    assert_eq!(audit.problems(), []);
    let solid = torus(1.0, 0.3, 9, 7).solid().unwrap();
    assert_eq!((solid.parts(), solid.cavities()), (1, 0));
    // Repairing what is whole changes nothing.
    assert_eq!(torus(1.0, 0.3, 9, 7).repaired().unwrap(), (solid, vec![]));
}

#[test]
fn negative_zero_is_the_same_place() {
    let mesh = mesh(
        &[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(-0.0, -0.0, 0.0)],
        &[[0, 2, 1], [4, 1, 3], [0, 3, 2], [1, 2, 3]],
    );
    assert_eq!(mesh.audit().duplicate_vertices, 1);
    assert_eq!(mesh.solid().unwrap().mesh().positions().len(), 4);
}

#[test]
fn holes_are_counted_and_stay() {
    let open = with_triangles(&block([1.0; 3]), |triangles| {
        triangles.truncate(10);
        triangles.remove(0);
    });
    // The last two triangles share an edge, so their hole has four; the other has three.
    let holes = [MeshDefect::OpenEdges { edges: 7 }];
    assert_eq!(refused(&open), holes);
    assert_eq!(beyond_repair(&open), holes);
    assert!(holes[0].is_fatal());
}

#[test]
fn a_triangle_turned_round_is_turned_back() {
    let good = sphere(1.0, 2);
    let bad = with_triangles(&good, |triangles| {
        for triangle in [3, 40, 77] {
            triangles[triangle].swap(0, 1);
        }
    });
    let audit = bad.audit();
    let reversed = MeshDefect::ReversedEdges { edges: audit.reversed_edges };
    assert_eq!((audit.reversed_edges, audit.inside_out_parts), (9, 0));
    assert_eq!(refused(&bad), [reversed]);
    let (solid, repairs) = bad.repaired().unwrap();
    assert_eq!(repairs, [MeshRepair::FlipTriangles { edges: audit.reversed_edges }]);
    assert_eq!(solid.volume(), good.solid().unwrap().volume());
    // Whatever the first triangle says, the volume decides which way is out.
    let mostly_bad = with_triangles(&inside_out(&good), |triangles| triangles[5].swap(0, 1));
    assert_eq!(mostly_bad.repaired().unwrap().0.volume(), solid.volume());
}

#[test]
fn superfluous_triangles_are_left_out() {
    let good = block([1.0, 2.0, 3.0]);
    let degenerate = with_triangles(&good, |triangles| triangles.extend([[0, 0, 1], [5, 5, 5]]));
    assert_eq!(degenerate.audit().problems(), [MeshDefect::DegenerateTriangles { triangles: 2 }]);
    assert_eq!(degenerate.solid().unwrap(), good.solid().unwrap());
    assert_eq!(degenerate.repaired().unwrap().1, [MeshRepair::DropDegenerate { triangles: 2 }]);

    let doubled = with_triangles(&good, |triangles| {
        let [a, b, c] = triangles[2];
        triangles.extend([[b, c, a], [a, c, b]]);
    });
    assert_eq!(refused(&doubled), [MeshDefect::DuplicateTriangles { triangles: 2 }]);
    let (solid, repairs) = doubled.repaired().unwrap();
    assert_eq!((solid, repairs), (good.solid().unwrap(), vec![MeshRepair::DropDuplicates { triangles: 2 }]));

    let nothing = mesh(&[DVec3::ZERO, DVec3::X], &[[0, 1, 0]]);
    assert_eq!(nothing.solid().unwrap_err(), MeshError::NoTriangles);
}

/// A vertex on an edge of the neighbour, with a triangle of no area to fill the gap.
#[test]
fn a_triangle_of_no_area_that_holds_the_mesh_together_is_kept() {
    let p = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.5, 0.0, 0.0)];
    let stitched = mesh(&p, &[[0, 2, 4], [4, 2, 1], [0, 4, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
    let audit = stitched.audit();
    assert_eq!(audit.problems(), [MeshDefect::CollinearTriangles { triangles: 1 }]);
    assert!((stitched.solid().unwrap().volume() - 1.0 / 6.0).abs() <= 1e-16);
    let unstitched = with_triangles(&stitched, |triangles| triangles.retain(|triangle| *triangle != [0, 4, 1]));
    assert_eq!(refused(&unstitched), [MeshDefect::OpenEdges { edges: 3 }]);
}

#[test]
fn sheets_that_meet_in_a_line_are_refused() {
    let (a, b) = (block([1.0; 3]), moved(&block([1.0; 3]), [2.0, 2.0, 0.0]));
    assert_eq!(beyond_repair(&merged([a, b])), [MeshDefect::OverfullEdges { edges: 1 }]);
    let fin = with_triangles(&block([1.0; 3]), |triangles| triangles.push([0, 1, 7]));
    let defects = beyond_repair(&fin);
    // One edge of the block and a diagonal or two have a third triangle; the rest of the fin is
    // open.
    let [MeshDefect::OpenEdges { edges: open }, MeshDefect::OverfullEdges { edges: overfull }] = defects[..] else {
        panic!("{defects:?}")
    };
    assert_eq!(open + overfull, 3);
}

#[test]
fn one_sided_and_flat_parts_are_refused() {
    // A Moebius strip of five triangles, closed with a disc: the projective plane in six vertices.
    let p: Vec<DVec3> = (0..6).map(|i| DVec3::new(f64::from(i), f64::from(i * i), f64::from(i * i * i))).collect();
    let plane =
        [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 1], [1, 2, 4], [2, 3, 5], [3, 4, 1], [4, 5, 2], [5, 1, 3]];
    let defects = beyond_repair(&mesh(&p, &plane));
    assert_eq!(defects, [MeshDefect::OneSidedParts { parts: 1 }]);

    let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y].map(|p| DQuat::from_rotation_x(0.3) * p);
    let pillow = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    assert_eq!(beyond_repair(&mesh(&square, &pillow)), [MeshDefect::FlatParts { parts: 1 }]);
    // A plate of which rounding leaves nothing, and one of which it leaves seven digits.
    let lid = |height: f64| {
        let thin = block([1.0, 1.0, height]);
        thin.transformed(&DAffine3::from_quat(DQuat::from_axis_angle(DVec3::new(0.6, 0.8, 0.0), 1.0))).unwrap()
    };
    assert!(lid(1e-17).repaired().is_err());
    let plate = lid(1e-9).solid().unwrap();
    assert!((plate.volume() / 8e-9 - 1.0).abs() <= 1e-6);
}

#[test]
fn cracks_close_if_that_closes_everything() {
    let good = sphere(1.0, 2);
    let triangles = without_shared_vertices(&good);
    // Every vertex moved by up to 2e-10 of the extent, in a pattern of its own.
    let cracked: Vec<DVec3> = triangles
        .positions()
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let i = i as f64;
            *p + DVec3::new((i * 1.7).sin(), (i * 2.3).sin(), (i * 0.9).sin()) * 2e-10
        })
        .collect();
    let cracked = mesh(&cracked, triangles.triangles());
    let audit = cracked.audit();
    assert_eq!((audit.duplicate_vertices, audit.open_edges, audit.cracks), (0, 0, 3 * 128));
    assert_eq!(audit.near_duplicates, 3 * 128 - good.positions().len());
    let defect = MeshDefect::Cracks { edges: 384, vertices: audit.near_duplicates };
    assert_eq!(refused(&cracked), [defect]);
    let (solid, repairs) = cracked.repaired().unwrap();
    assert_eq!(repairs, [MeshRepair::WeldNear { vertices: audit.near_duplicates }]);
    assert_eq!(solid.mesh().positions().len(), good.positions().len());
    // The surface has moved by less than 2e-9.
    assert!((solid.volume() - good.solid().unwrap().volume()).abs() <= good.audit().area * 2e-9);
    // With a hole besides, nothing is welded.
    let holed = with_triangles(&cracked, |triangles| triangles.truncate(127));
    assert_eq!(holed.audit().cracks, 0);
    assert_eq!(beyond_repair(&holed), [MeshDefect::OpenEdges { edges: 3 * 127 }]);
    // Further apart than that, they are different vertices.
    let apart = merged([triangles.clone(), moved(&triangles, [1e-8, 0.0, 0.0])]);
    assert_eq!(apart.audit().near_duplicates, 0);
}

/// A row of vertices each near the next does not become one.
#[test]
fn a_chain_of_near_vertices_does_not_collapse() {
    let mut positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    positions.extend((1..=1000).map(|i| DVec3::new(1.0, 6e-10 * f64::from(i), 0.0)));
    let triangles: Vec<[u32; 3]> = (3..1002).map(|i| [0, i, i + 1]).chain([[0, 1, 2]]).collect();
    // 1.2e-9 is further than 1e-9, so every other one stays.
    assert_eq!(mesh(&positions, &triangles).audit().near_duplicates, 500);
}

#[test]
fn parts_are_turned_by_how_deep_they_lie() {
    let shell = |size: f64| block([size; 3]);
    let nested = |inner: [bool; 4]| {
        let sizes = [4.0, 3.0, 2.0, 1.0];
        TriangleMesh::merged(sizes.iter().zip(inner).map(
            |(size, turned)| {
                if turned { inside_out(&shell(*size)) } else { shell(*size) }
            },
        ))
        .unwrap()
    };
    let volume = 512.0 - 216.0 + 64.0 - 8.0;
    let good = nested([false, true, false, true]);
    assert_eq!(good.audit().problems(), []);
    let solid = good.solid().unwrap();
    assert_eq!((solid.volume(), solid.parts(), solid.cavities()), (volume, 4, 2));
    for bits in 0..16_u32 {
        let turned = [0, 1, 2, 3].map(|part| bits >> part & 1 == 1);
        let wrong = [0, 1, 2, 3].iter().filter(|part| turned[**part] != (*part % 2 == 1)).count();
        let mesh = nested(turned);
        assert_eq!(mesh.audit().inside_out_parts, wrong);
        let (repaired, repairs) = mesh.repaired().unwrap();
        assert_eq!(repaired, solid, "{bits:b}");
        let expected: &[MeshRepair] = if wrong == 0 { &[] } else { &[MeshRepair::FlipParts { parts: wrong }] };
        assert_eq!(repairs, expected);
        assert_eq!(mesh.solid().is_ok(), wrong == 0);
    }
}

/// Neither beside nor around nor wall to wall is inside.
#[test]
fn what_is_not_nested_is_solid() {
    let cube = block([1.0; 3]);
    let ring = torus(3.0, 1.0, 24, 16);
    let beads = [
        ("in the hole", merged([ring.clone(), moved(&cube, [0.0, 0.0, 0.0])]), 0),
        ("in the tube", merged([ring.clone(), moved(&block([0.2; 3]), [3.0, 0.1, 0.0])]), 1),
        ("beside", merged([cube.clone(), moved(&cube, [2.5, 0.0, 0.0])]), 0),
        ("wall to wall in x", merged([cube.clone(), moved(&block([1.0, 0.4, 0.4]), [2.0, 0.1, 0.2])]), 0),
        ("wall to wall in y", merged([cube.clone(), moved(&block([0.4, 1.0, 0.4]), [0.1, -2.0, 0.2])]), 0),
        ("wall to wall in z", merged([cube.clone(), moved(&block([0.4, 0.4, 1.0]), [0.1, 0.3, 2.0])]), 0),
        ("inside, flush with a wall", merged([cube.clone(), moved(&block([0.4, 0.3, 0.2]), [0.6, 0.1, 0.2])]), 1),
        ("a block on a grid of lines", merged([block([2.0; 3]), block([1.0; 3])]), 1),
    ];
    for (name, mesh, cavities) in beads {
        for turn in
            [DQuat::IDENTITY, DQuat::from_rotation_y(0.7), DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 2.0)]
        {
            let turned = mesh.transformed(&DAffine3::from_quat(turn)).unwrap();
            // Turning rounds walls that touch, and those that are flush may then stick out: then
            // what is inside is not.
            if name.contains("flush") && turn != DQuat::IDENTITY {
                continue;
            }
            assert_eq!(turned.repaired().unwrap().0.cavities(), cavities, "{name}");
        }
    }
}

/// Ten thousand bubbles in a ball of foam: each compared with all triangles would be 1e9
/// comparisons, some seconds.
#[test]
fn many_parts_take_no_squares() {
    let bubble = sphere(0.01, 0);
    let places = (0..22).flat_map(|x| (0..22).flat_map(move |y| (0..22).map(move |z| (x, y, z))));
    let places = places.map(|(x, y, z)| (DVec3::new(x.into(), y.into(), z.into()) - 10.5) * 0.05);
    let places: Vec<DVec3> = places.filter(|place: &DVec3| place.length() < 0.95).collect();
    assert!(places.len() > 9_000, "{}", places.len());
    let bubbles = places.iter().map(|place| inside_out(&moved(&bubble, *place)));
    let foam = TriangleMesh::merged(std::iter::once(sphere(1.0, 6)).chain(bubbles)).unwrap();
    let solid = foam.solid().unwrap();
    assert_eq!(solid.cavities(), places.len());
    let expected = sphere(1.0, 6).solid().unwrap().volume() - places.len() as f64 * bubble.solid().unwrap().volume();
    assert!((solid.volume() / expected - 1.0).abs() <= 1e-14);
}

#[test]
fn what_crosses_itself_so_that_no_matter_is_left_is_refused() {
    let hole = |low: [f64; 3], high: [f64; 3]| {
        let (low, high) = (DVec3::from(low), DVec3::from(high));
        inside_out(&moved(&block((high - low) * 0.5), (high + low) * 0.5))
    };
    let volume = |mesh: &TriangleMesh| match mesh.solid() {
        Err(MeshError::NoVolume { volume }) => volume,
        other => panic!("{other:?}"),
    };
    // Two cavities that overlap: what both take away is taken away twice, and more than all is
    // gone.
    let negative = merged([
        block([1.0; 3]),
        hole([-0.99, -0.99, -0.99], [0.9, 0.99, 0.99]),
        hole([-0.9, -0.99, -0.99], [0.99, 0.99, 0.99]),
    ]);
    assert_eq!(negative.audit().cavities, Some(2));
    assert!((volume(&negative) - (8.0 - 2.0 * 1.89 * 1.98 * 1.98)).abs() <= 1e-14);
    // Two such pairs at the ends: the volume is positive, but the mean square of x is not.
    let end = |far: f64, low: f64, high: f64| hole([0.5, low, low], [far, high, high]);
    let ends = [end(0.99, -0.99, 0.98), end(0.98, -0.98, 0.99)];
    let turn = DAffine3::from_quat(DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0));
    let others = ends.clone().map(|end| end.transformed(&turn).unwrap());
    let hollow = TriangleMesh::merged([block([1.0; 3])].into_iter().chain(ends).chain(others)).unwrap();
    assert!(volume(&hollow) > 0.3);
}

#[test]
fn all_that_is_wrong_is_said_at_once() {
    let bad = with_triangles(&block([1.0; 3]), |triangles| {
        triangles[0].swap(0, 1);
        triangles.pop();
        triangles.push([2, 2, 3]);
        triangles.push(triangles[5]);
    });
    let all = merged([bad, inside_out(&moved(&block([1.0; 3]), [5.0, 0.0, 0.0]))]);
    let error = all.solid().unwrap_err().to_string();
    let expected = "the mesh bounds no solid: 1 duplicate triangle, 3 open edges, 3 edges between triangles wound \
                    oppositely, 1 part inside out";
    assert_eq!(error, expected);
    assert_eq!(all.audit().degenerate_triangles, 1);
    assert_eq!(beyond_repair(&all), [MeshDefect::OpenEdges { edges: 3 }]);
}

#[test]
fn amounts_are_checked() {
    let solid = block([1.0; 3]).solid().unwrap();
    for amount in [Amount::Mass(0.0), Amount::Mass(f64::NAN), Amount::Mass(1e200)] {
        let error = solid.mass_properties(amount).unwrap_err();
        assert!(matches!(error.reason, ShapeErrorReason::Mass(_)), "{error}");
    }
    let error = solid.mass_properties(Amount::Density(-1.0)).unwrap_err();
    assert_eq!(error.to_string(), "density must be positive and finite, it is -1.0");
}

fn any_mesh() -> impl Strategy<Value = TriangleMesh> {
    let coordinate = || prop_oneof![3 => -2.0..2.0_f64, 2 => (-2..3_i32).prop_map(f64::from), 1 => -1e-9..1e-9_f64];
    let position = (coordinate(), coordinate(), coordinate()).prop_map(DVec3::from);
    (proptest::collection::vec(position, 3..12), proptest::collection::vec([0..64_u32, 0..64, 0..64], 1..40)).prop_map(
        |(positions, triangles)| {
            let count = positions.len() as u32;
            let triangles: Vec<[u32; 3]> = triangles.into_iter().map(|corners| corners.map(|c| c % count)).collect();
            TriangleMesh::new(positions, triangles).unwrap()
        },
    )
}

fn is_solid(solid: &SolidMesh) -> bool {
    solid.volume() > 0.0 && solid.mesh().solid().is_ok_and(|again| again == *solid)
}

proptest! {
    /// Whatever the triangles, there is an answer; a solid is a solid.
    #[test]
    fn any_triangles_are_judged_without_a_panic(mesh in any_mesh()) {
        let audit = mesh.audit();
        let problems = audit.problems();
        match mesh.solid() {
            Ok(solid) => prop_assert!(problems.iter().all(MeshDefect::is_harmless) && is_solid(&solid)),
            Err(MeshError::NotSolid { defects }) => prop_assert!(!defects.is_empty() && defects.len() <= problems.len()),
            Err(error) => {
                let nothing = matches!(error, MeshError::NoVolume { .. } | MeshError::NoTriangles);
                prop_assert!(nothing, "{}", error);
            }
        }
        if let Ok((solid, _)) = mesh.repaired() {
            prop_assert!(is_solid(&solid));
        }
    }

    /// A good mesh broken in ways that can be repaired comes back as it was: triangles turned, in
    /// any order, doubled, no vertices shared.
    #[test]
    fn what_was_broken_is_repaired(turned in proptest::collection::vec(any::<bool>(), 56), seed in any::<u64>(), share in any::<bool>()) {
        let good = torus(1.0, 0.4, 7, 4);
        let mut triangles = good.triangles().to_vec();
        let mut rng = seed;
        for i in (1..triangles.len()).rev() {
            rng = rng.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            triangles.swap(i, (rng >> 33) as usize % (i + 1));
        }
        for (triangle, turned) in triangles.iter_mut().zip(turned) {
            if turned { triangle.swap(1, 2); }
        }
        triangles.extend_from_within(3..9);
        let bad = TriangleMesh::new(good.positions(), triangles).unwrap();
        let bad = if share { bad } else { without_shared_vertices(&bad) };
        let (solid, _) = bad.repaired().unwrap();
        let (volume, expected) = (solid.volume(), good.solid().unwrap().volume());
        prop_assert!((volume / expected - 1.0).abs() <= 1e-15);
    }
}
