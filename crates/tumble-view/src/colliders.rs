//! What bodies touch with, where that is not what is seen of them.

use tumble::{Collider, Pose, Shape, TriangleMesh, convex_hull};
use tumble_import::Appearance;

/// A mesh fills its convex hull if what is missing is less than this part of it: rounding of sums
/// over all triangles.
const FILLED: f64 = 1e-9;

/// Whether a body that looks like this touches others with something else.
///
/// To be asked once: colliders are made to be compared with.
pub(crate) fn differs(collider: &Collider, appearance: &Appearance) -> bool {
    let (membership, filter) = collider.groups();
    let is_the_same = |seen: Collider| {
        let Ok(seen) = seen.with_groups(membership, filter).with_material(*collider.material()) else { return false };
        // What is put at the origin is where it was.
        *collider == seen || seen.with_offset(Pose::default()).is_ok_and(|placed| *collider == placed)
    };
    !of_appearance(appearance).into_iter().flatten().any(is_the_same)
}

/// The colliders that are what is seen, solid and as a surface.
fn of_appearance(appearance: &Appearance) -> [Option<Collider>; 2] {
    let surface = |mesh: &TriangleMesh| Collider::mesh(mesh.positions().iter().copied(), mesh.triangles()).ok();
    match appearance {
        Appearance::HalfSpace => [Some(Collider::half_space()), None],
        Appearance::Mesh(mesh) => [None, surface(mesh)],
        Appearance::HeightField(heights) => [Some(heights.collider().clone()), None],
        Appearance::Shape(shape) => {
            let solid = if fills_its_hull(shape) { Collider::new(shape).ok() } else { None };
            [solid, if let Shape::Mesh(mesh) = shape { surface(mesh.mesh()) } else { None }]
        }
    }
}

/// Whether every mesh in a shape is convex; what moves is touched as the convex hull of each.
fn fills_its_hull(shape: &Shape) -> bool {
    match shape {
        Shape::Mesh(solid) => {
            let hull = convex_hull(solid.mesh().positions()).ok().and_then(|hull| hull.solid().ok());
            hull.and_then(|hull| Shape::mesh(hull).volume())
                .zip(shape.volume())
                .is_some_and(|(hull, own)| own >= (1.0 - FILLED) * hull)
        }
        Shape::Compound(parts) => parts.iter().all(|part| fills_its_hull(&part.shape)),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use tumble::math::Vec3;
    use tumble::{Amount, Material, Part};

    use tumble_scene::Scene;

    use super::*;

    #[test]
    fn a_collider_of_what_is_seen_does_not_differ() {
        let cuboid = Shape::cuboid([0.1, 0.2, 0.3]);
        let of_cuboid = Collider::new(&cuboid).unwrap();
        let slippery = Material { static_friction: 0.0, dynamic_friction: 0.0, ..Material::default() };
        let appearance = Appearance::Shape(cuboid);
        assert!(!differs(&of_cuboid, &appearance));
        assert!(!differs(&of_cuboid.clone().with_material(slippery).unwrap().with_groups(1, 2), &appearance));
        assert!(!differs(&of_cuboid.clone().with_offset(Pose::default()).unwrap(), &appearance));
        assert!(!differs(&Collider::half_space(), &Appearance::HalfSpace));
        let hill =
            r#"{ "bodies": [ { "shape": { "height_field": { "heights": [[0, 1], [0, 0]] } }, "fixed": true } ] }"#;
        let hill = Scene::from_json(hill, "hill.json").unwrap().appearance().unwrap().remove(0);
        let heights = Collider::height_field([0.0, 1.0, 0.0, 0.0], 2, [1.0, 1.0]).unwrap();
        assert!(!differs(&heights.with_material(slippery).unwrap(), &hill) && differs(&of_cuboid, &hill));

        let aside = Pose { position: Vec3::X, ..Pose::default() };
        assert!(differs(&of_cuboid.clone().with_offset(aside).unwrap(), &appearance));
        assert!(differs(&of_cuboid, &Appearance::HalfSpace));
        assert!(differs(&of_cuboid, &Appearance::Shape(Shape::sphere(0.1))));
        // A point is drawn as the ellipsoid of its inertia.
        assert!(differs(&of_cuboid, &Appearance::Shape(Shape::Point)));
    }

    #[test]
    fn a_mesh_is_seen_as_it_is_and_touched_as_its_hull() {
        let corners = [[1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -0.5, 0.0]];
        let convex = convex_hull(&corners.map(Into::into)).unwrap();
        // The lower tip is pushed in to where it leaves a hollow.
        let dented = convex.positions().iter().map(|at| if at.y < 0.0 { -0.5 * *at } else { *at });
        let dented = TriangleMesh::new(dented.collect::<Vec<_>>(), convex.triangles().to_vec()).unwrap();
        for (mesh, is_hollow) in [(convex, false), (dented, true)] {
            let surface = Collider::mesh(mesh.positions().iter().copied(), mesh.triangles()).unwrap();
            let shape = Shape::mesh(mesh.clone().solid().unwrap());
            let hull = Collider::new(&shape).unwrap();
            let part = Part::new(shape.clone(), Amount::Mass(1.0)).at([0.0, 1.0, 0.0]);
            let compound = Shape::Compound(vec![part]);
            let hulls = Collider::new(&compound).unwrap();
            let expected = [
                (&surface, Appearance::Mesh(Arc::new(mesh)), false),
                (&surface, Appearance::Shape(shape.clone()), false),
                (&hull, Appearance::Shape(shape), is_hollow),
                (&hulls, Appearance::Shape(compound), is_hollow),
            ];
            for (collider, appearance, expected) in expected {
                assert_eq!(differs(collider, &appearance), expected, "{appearance:?}");
            }
        }
    }
}
