//! Promise: bodies of every shape rest, roll and slide as their shapes have it: what lies on two
//! points does not rock, what is round rolls without a bump, and nothing stumbles over the inner
//! edges of flat ground made of triangles.
//!
//! Why: a manifold that is right in itself may still be useless to a solver, with points that
//! wander, come and go, or push sideways. Each test would show that as a speed where there is none.

use std::f64::consts::FRAC_PI_2;

use hecs::{Entity, World};
use tumble::glam::DVec3;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{Amount, Collider, Material, Part};
use tumble_tests::touching::{pose, spawn, velocity};

const STEP: Real = 1.0 / 60.0;

fn slippery() -> Material {
    Material::new(0.0, 0.0)
}

fn fixed(world: &mut World, collider: Collider, position: Vec3) -> Entity {
    spawn(world, RigidBody::new(Shape::Point).fixed().position(position), collider)
}

/// A body of a shape, of water's density.
fn solid(world: &mut World, shape: &Shape, position: Vec3, orientation: Quat) -> Entity {
    let body = RigidBody::new(shape.clone()).density(1000.0).position(position).orientation(orientation);
    spawn(world, body, Collider::new(shape).unwrap())
}

/// Steps, and shows the world after each.
fn run(world: &mut World, steps: u32, mut look: impl FnMut(&World)) {
    let mut simulation = Simulation::new(Settings::default().with_dt(STEP)).unwrap();
    for _ in 0..steps {
        simulation.step(world);
        look(world);
    }
}

/// Flat ground of triangles, eight metres a side: squares of a fifth of a metre with diagonals this
/// way and that.
fn tiles() -> Collider {
    let count = 40;
    let corner = |i: u32, j: u32| j * (count + 1) + i;
    let mut corners = Vec::new();
    let mut triangles = Vec::new();
    for j in 0..=count {
        for i in 0..=count {
            corners.push(DVec3::new(0.2 * f64::from(i) - 4.0, 0.0, 0.2 * f64::from(j) - 4.0));
            if i < count && j < count {
                let [a, b, c, d] = [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)];
                triangles.extend(if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
            }
        }
    }
    Collider::mesh(corners, &triangles).unwrap()
}

fn level_field() -> Collider {
    Collider::height_field(vec![0.0; 41 * 41], 41, [0.2, 0.2]).unwrap()
}

fn around(axis: Vec3, angle: f64) -> Quat {
    Quat::from_axis_angle(axis, angle as Real)
}

/// What lies on flat ground stays where it is, for ten seconds after two in which soft contacts
/// take the weight.
#[test]
fn every_shape_rests_on_every_ground() {
    let lying = around(Vec3::X, FRAC_PI_2);
    let upright = Quat::IDENTITY;
    let grounds = [Collider::half_space(), tiles(), level_field()];
    let top = Collider::new(&Shape::cuboid([3.0, 1.0, 3.0])).unwrap();
    let slab: Vec<DVec3> = (0..8)
        .map(|i| {
            DVec3::new(
                if i & 1 == 0 { 0.3 } else { -0.3 },
                if i & 2 == 0 { 0.1 } else { -0.1 },
                if i & 4 == 0 { 0.4 } else { -0.4 },
            )
        })
        .collect();
    for (ground, y) in grounds.into_iter().map(|ground| (ground, 0.0)).chain([(top, -1.0)]) {
        let mut world = World::new();
        fixed(&mut world, ground.clone(), Vec3::Y * y);
        let mut bodies = vec![
            ("a capsule that lies", solid(&mut world, &Shape::capsule(0.2, 0.5), Vec3::new(-2.0, 0.2, 0.0), lying)),
            (
                "a cylinder that stands",
                solid(&mut world, &Shape::cylinder(0.3, 0.4), Vec3::new(-1.0, 0.4, 0.03), upright),
            ),
            ("a cylinder that lies", solid(&mut world, &Shape::cylinder(0.2, 0.5), Vec3::new(0.0, 0.2, 0.0), lying)),
            ("a cone that stands", solid(&mut world, &Shape::cone(0.3, 0.4), Vec3::new(1.0, 0.2, 0.0), upright)),
            (
                "a frustum that stands",
                solid(&mut world, &Shape::frustum(0.3, 0.2, 0.3), Vec3::new(2.0, 0.26, 0.0), upright),
            ),
            ("a box", solid(&mut world, &Shape::cuboid([0.3, 0.2, 0.3]), Vec3::new(-1.0, 0.2, 1.5), upright)),
        ];
        let hull = RigidBody::new(Shape::cuboid([0.3, 0.1, 0.4])).density(1000.0).position(Vec3::new(0.0, 0.1, 1.5));
        bodies.push(("a hull", spawn(&mut world, hull, Collider::convex_hull(slab.clone()).unwrap())));
        run(&mut world, 120, |_| {});
        let before: Vec<Pose> = bodies.iter().map(|(_, body)| pose(&world, *body)).collect();
        run(&mut world, 600, |world| {
            for (name, body) in &bodies {
                let velocity = velocity(world, *body);
                assert!(velocity.linear.length() < 2e-3, "{name} on {ground:?}: {velocity:?}");
                assert!(velocity.angular.length() < 5e-3, "{name} on {ground:?}: {velocity:?}");
            }
        });
        for ((name, body), before) in bodies.iter().zip(before) {
            let moved = (pose(&world, *body).position - before.position).length();
            assert!(moved < 1e-3, "{name} moved {moved} on {ground:?}");
        }
    }
}

/// A ball and a box that slide without friction over flat ground of many triangles keep their
/// height and speed, and a capsule its height.
#[test]
fn nothing_stumbles_over_inner_edges() {
    for ground in [tiles(), level_field()] {
        let mut world = World::new();
        fixed(&mut world, ground.with_material(slippery()).unwrap(), Vec3::ZERO);
        let material = slippery();
        let box_shape = Shape::cuboid([0.3, 0.15, 0.2]);
        let shapes = [
            (Shape::sphere(0.15), Vec3::new(-3.5, 0.15, -1.03)),
            (box_shape, Vec3::new(-3.5, 0.15, 1.07)),
            (Shape::capsule(0.15, 0.3), Vec3::new(-3.5, 0.45, 2.51)),
        ];
        let start = Vec3::new(2.0, 0.0, 0.13);
        let bodies: Vec<Entity> = shapes
            .iter()
            .map(|(shape, position)| {
                let body = RigidBody::new(shape.clone()).mass(2.0).position(*position).linear_velocity(start);
                spawn(&mut world, body, Collider::new(shape).unwrap().with_material(material).unwrap())
            })
            .collect();
        run(&mut world, 30, |_| {});
        run(&mut world, 120, |world| {
            for body in &bodies[..2] {
                let velocity = velocity(world, *body);
                assert!(velocity.linear.y.abs() < 1e-3, "{velocity:?}");
                assert!((velocity.linear - start).length() < 2e-3, "{velocity:?}");
                assert!(velocity.angular.length() < 2e-3, "{velocity:?}");
            }
            let capsule = velocity(world, bodies[2]);
            assert!(capsule.linear.y.abs() < 1e-3, "{capsule:?}");
        });
    }
}

/// A cylinder and a capsule roll on as they began: `v = w r`, no height lost or gained.
#[test]
fn what_is_round_rolls() {
    for ground in [Collider::half_space(), Collider::new(&Shape::cuboid([8.0, 1.0, 3.0])).unwrap()] {
        let mut world = World::new();
        let y = if ground == Collider::half_space() { 0.0 } else { -1.0 };
        fixed(&mut world, ground, Vec3::Y * y);
        let lying = around(Vec3::X, FRAC_PI_2);
        let mut bodies = Vec::new();
        for (shape, z) in [(Shape::cylinder(0.3, 0.5), -1.0), (Shape::capsule(0.3, 0.5), 1.0)] {
            let body = RigidBody::new(shape.clone())
                .density(1000.0)
                .position(Vec3::new(-4.0, 0.3, z))
                .orientation(lying)
                .linear_velocity(Vec3::new(1.5, 0.0, 0.0))
                .angular_velocity(Vec3::new(0.0, 0.0, -5.0));
            bodies.push(spawn(&mut world, body, Collider::new(&shape).unwrap()));
        }
        run(&mut world, 60, |_| {});
        let before: Vec<Pose> = bodies.iter().map(|body| pose(&world, *body)).collect();
        run(&mut world, 180, |world| {
            for body in &bodies {
                let velocity = velocity(world, *body);
                assert!(velocity.linear.y.abs() < 1e-3, "{velocity:?}");
                assert!((velocity.linear.x - 1.5).abs() < 5e-3, "{velocity:?}");
                assert!((velocity.angular.z + 5.0).abs() < 2e-2, "{velocity:?}");
            }
        });
        for (body, before) in bodies.iter().zip(before) {
            let moved = pose(&world, *body).position - before.position;
            assert!((moved.x - 4.5).abs() < 0.02 && moved.y.abs() < 1e-4 && moved.z.abs() < 1e-2, "{moved:?}");
        }
    }
}

/// Dumbbells, bodies with a foot, and shots that go through each other.
#[test]
fn parts_places_and_groups_are_heeded() {
    let mut world = World::new();
    fixed(&mut world, Collider::half_space(), Vec3::ZERO);
    let ball = |x: f64| Part::new(Shape::sphere(0.2), Amount::Mass(1.0)).at([x, 0.0, 0.0]);
    let weight = Part::new(Shape::Point, Amount::Mass(1.0));
    let shape = Shape::compound([ball(-0.5), ball(0.5), weight]);
    let body = RigidBody::new(shape.clone()).mass(3.0).position(Vec3::Y * 0.2);
    let dumbbell = spawn(&mut world, body, Collider::new(&shape).unwrap());
    // A box whose collider is a ball below it.
    let offset = Pose { position: Vec3::Y * -0.5, ..Pose::default() };
    let foot = Collider::new(&Shape::sphere(0.1)).unwrap().with_offset(offset).unwrap();
    let body = RigidBody::new(Shape::cuboid([0.1, 0.1, 0.1])).mass(1.0).position(Vec3::new(3.0, 0.7, 0.0));
    let standing = spawn(&mut world, body, foot);
    // Two boxes at one place that are not for each other.
    let shape = Shape::cuboid([0.2, 0.2, 0.2]);
    let mut ghosts = Vec::new();
    for groups in [(1, !2), (2, !1)] {
        let body = RigidBody::new(shape.clone()).mass(1.0).position(Vec3::new(-3.0, 0.2, 0.0));
        ghosts.push(spawn(&mut world, body, Collider::new(&shape).unwrap().with_groups(groups.0, groups.1)));
    }
    run(&mut world, 40, |_| {});
    assert!((pose(&world, dumbbell).position.y - 0.2).abs() < 1e-3);
    assert!(velocity(&world, dumbbell).angular.length() < 1e-3);
    let height = pose(&world, standing).position.y;
    assert!((height - 0.6).abs() < 2e-3, "{height}");
    for ghost in ghosts {
        let place = pose(&world, ghost).position;
        assert!((place - Vec3::new(-3.0, 0.2, 0.0)).length() < 1e-3, "{place:?}");
    }
}

/// All shapes fall on a heap between four walls, and come to rest there: none falls through, and
/// none gains energy.
#[test]
fn a_heap_of_all_shapes_comes_to_rest() {
    let mut world = World::new();
    fixed(&mut world, Collider::half_space(), Vec3::ZERO);
    let wall = Collider::new(&Shape::cuboid([0.5, 3.0, 3.0])).unwrap();
    let side = Collider::new(&Shape::cuboid([3.0, 3.0, 0.5])).unwrap();
    for sign in [-1.0, 1.0] {
        fixed(&mut world, wall.clone(), Vec3::new(1.5 * sign, 3.0, 0.0));
        fixed(&mut world, side.clone(), Vec3::new(0.0, 3.0, 1.5 * sign));
    }
    let shapes = [
        Shape::cylinder(0.15, 0.1),
        Shape::cone(0.2, 0.15),
        Shape::capsule(0.1, 0.15),
        Shape::ellipsoid([0.1, 0.15, 0.2]),
        Shape::frustum(0.1, 0.18, 0.12),
        Shape::tapered_capsule(0.1, 0.15, 0.1),
        Shape::cuboid([0.1, 0.15, 0.12]),
        Shape::sphere(0.14),
    ];
    let mut bodies = Vec::new();
    for i in 0..48_u32 {
        let shape = &shapes[i as usize % shapes.len()];
        let place =
            Vec3::new((i % 4) as Real * 0.45 - 0.7, 0.4 + (i / 16) as Real * 0.5, (i / 4 % 4) as Real * 0.45 - 0.7);
        let turned = around(Vec3::new(0.6, 0.0, 0.8), 0.37 * f64::from(i));
        bodies.push(solid(&mut world, shape, place, turned));
    }
    run(&mut world, 600, |_| {});
    for (i, body) in bodies.iter().enumerate() {
        let (place, velocity) = (pose(&world, *body).position, velocity(&world, *body));
        assert!(
            place.is_finite() && place.x.abs() < 1.0 && place.z.abs() < 1.0 && place.y > 0.05 && place.y < 2.0,
            "{i}: {place:?}"
        );
        assert!(velocity.linear.length() < 0.3, "{i}: {velocity:?}");
    }
}
