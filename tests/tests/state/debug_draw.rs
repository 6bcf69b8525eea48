//! Promise: what `DebugView` draws is where it should be: outlines lie on the surfaces of shapes
//! and colliders, arrows are as long as what they stand for, contacts are where bodies touch, and
//! nothing that is not finite reaches the renderer.
//!
//! Why: people find their own mistakes with these lines, so the lines must not be mistaken. It
//! fails if a frame is taken for another, the centre of mass for the origin, or a radius for a
//! diameter.

use glam::{DQuat, DVec3};
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{Amount, Collider, DebugDraw, DebugView, Part, convex_hull};
use tumble_tests::{EPSILON, dquat, dvec3};

type Line = (DVec3, DVec3, [f32; 3]);

fn lines(view: &DebugView, world: &hecs::World) -> Vec<Line> {
    let mut lines = Vec::new();
    view.draw(world, &mut |from, to, color| lines.push((dvec3(from), dvec3(to), color)));
    lines
}

fn outlines() -> DebugView {
    DebugView { outlines: true, ..DebugView::nothing() }
}

/// Ends of the outline's lines in the shape's own frame, of a body that is turned and has its frame
/// away from the origin.
fn ends_in_shape_frame(shape: &Shape) -> Vec<DVec3> {
    let position = Vec3::new(1.0, -2.0, 0.5);
    let orientation = Quat::from_rotation_x(0.7) * Quat::from_rotation_y(-1.9);
    let mut world = hecs::World::new();
    let body = RigidBody::new(shape.clone())
        .without_collider()
        .fixed()
        .position(position)
        .orientation(orientation)
        .build()
        .unwrap();
    let entity = body.spawn(&mut world);
    world.insert_one(entity, shape.clone()).unwrap();
    let to_shape = |point: DVec3| dquat(orientation).conjugate() * (point - dvec3(position));
    let lines = lines(&outlines(), &world);
    assert!(lines.iter().all(|line| line.2 == DebugView::FIXED));
    lines.into_iter().flat_map(|(from, to, _)| [to_shape(from), to_shape(to)]).collect()
}

/// Rounding of a few operations on lengths of some metres.
const ROUNDING: f64 = 16.0 * EPSILON;

/// How far from the surface the ends are at the most, by a function that is the distance to it; and
/// that they span the shape's box.
fn assert_on_surface(shape: &Shape, half_size: DVec3, distance: impl Fn(DVec3) -> f64) {
    let ends = ends_in_shape_frame(shape);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for end in ends {
        assert!(distance(end).abs() < ROUNDING, "{shape:?}: {end} is {} off", distance(end));
        (low, high) = (low.min(end), high.max(end));
    }
    assert!((high - half_size).abs().max_element() < ROUNDING, "{shape:?} up to {high}");
    assert!((low + half_size).abs().max_element() < ROUNDING, "{shape:?} down to {low}");
}

/// Distance from a segment on y between two heights.
fn from_segment(point: DVec3, half_height: f64) -> f64 {
    (point - DVec3::Y * point.y.clamp(-half_height, half_height)).length()
}

#[test]
fn outlines_lie_on_surfaces() {
    let corner = DVec3::new(0.3, 0.5, 0.9);
    assert_on_surface(&Shape::cuboid(corner), corner, |end| (end.abs() - corner).length());
    assert_on_surface(&Shape::sphere(0.7), DVec3::splat(0.7), |end| end.length() - 0.7);
    let radii = DVec3::new(0.3, 1.2, 0.6);
    assert_on_surface(&Shape::ellipsoid(radii), radii, |end| (end / radii).length() - 1.0);
    let tall = DVec3::new(0.4, 1.1, 0.4);
    assert_on_surface(&Shape::cylinder(0.4, 1.1), tall, |end| {
        (end.with_y(0.0).length() - 0.4).abs().max((end.y.abs() - 1.1).abs())
    });
    assert_on_surface(&Shape::capsule(0.4, 0.7), tall, |end| from_segment(end, 0.7) - 0.4);
    // The radius of a cone falls from its base to its apex.
    assert_on_surface(&Shape::cone(0.4, 1.1), tall, |end| end.with_y(0.0).length() - 0.4 * (1.1 - end.y) / 2.2);
}

/// Every end is on the one ball or the other, at the circles where a cone touches both on both
/// sides of it, and inside neither.
#[test]
fn capsules_whose_ends_differ() {
    let [bottom, top, half_height] = [0.5, 0.2, 0.6];
    let shape = Shape::TaperedCapsule { radius_bottom: bottom, radius_top: top, half_height };
    for end in ends_in_shape_frame(&shape) {
        let from_bottom = (end + DVec3::Y * half_height).length() - bottom;
        let from_top = (end - DVec3::Y * half_height).length() - top;
        assert!(from_bottom.min(from_top).abs() < ROUNDING, "{end}: {from_bottom}, {from_top}");
    }
    // Where one ball holds the other it is all there is to see.
    let shape = Shape::TaperedCapsule { radius_bottom: 0.1, radius_top: 0.5, half_height: 0.2 };
    let ends = ends_in_shape_frame(&shape);
    assert!(ends.len() > 100);
    for end in ends {
        assert!(((end - DVec3::Y * 0.2).length() - 0.5).abs() < ROUNDING, "{end}");
    }
}

#[test]
fn compounds_and_meshes_are_drawn_by_their_parts() {
    let half = DVec3::new(0.1, 0.2, 0.3);
    let turned = DQuat::from_rotation_z(0.5);
    let part = Part::new(Shape::cuboid(half), Amount::Mass(1.0)).at([2.0, 0.0, 0.0]).turned(turned);
    let ends = ends_in_shape_frame(&Shape::Compound(vec![part]));
    assert_eq!(ends.len(), 24);
    for end in ends {
        let corner = turned.conjugate() * (end - DVec3::X * 2.0);
        assert!((corner.abs() - half).length() < ROUNDING, "{corner}");
    }

    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let solid = convex_hull(&corners).unwrap().solid().unwrap();
    // A tetrahedron has six edges, and each is drawn once.
    let ends = ends_in_shape_frame(&Shape::mesh(solid));
    assert_eq!(ends.len(), 12);
    for end in ends {
        assert!(corners.iter().any(|corner| (*corner - end).length() < ROUNDING), "{end}");
    }
}

/// A body that does not carry its shape is shown as the box of its inertia, which of a cuboid is
/// the cuboid: about the centre of mass and along the principal axes, wherever the origin and the
/// axes of its frame are.
#[test]
fn a_body_without_shape_is_the_box_of_its_inertia() {
    let half = DVec3::new(0.2, 0.5, 0.3);
    let tilt = DQuat::from_rotation_x(0.4);
    let shape =
        Shape::Compound(vec![Part::new(Shape::cuboid(half), Amount::Mass(3.0)).at([0.0, 2.0, 0.0]).turned(tilt)]);
    let mut world = hecs::World::new();
    let orientation = Quat::from_rotation_z(1.1);
    RigidBody::new(shape).without_collider().orientation(orientation).build().unwrap().spawn(&mut world);
    let lines = lines(&DebugView { ellipsoids: true, ..outlines() }, &world);
    let to_part = |end: DVec3| tilt.conjugate() * (dquat(orientation).conjugate() * end - DVec3::Y * 2.0);
    let (mut box_ends, mut ellipsoid_ends) = (0, 0);
    for (from, to, color) in lines {
        for end in [from, to].map(to_part) {
            // Principal axes are found to about the root of the rounding of the moments'
            // differences: a few times more than before.
            if color == DebugView::DYNAMIC {
                box_ends += 1;
                assert!((end.abs() - half).length() < 10.0 * ROUNDING, "{end}");
            } else {
                assert_eq!(color, DebugView::ELLIPSOID);
                ellipsoid_ends += 1;
                // Same mass and moments: m/5 of the squared semi-axes is m/3 of the squared half
                // edges.
                let radii = half * (5.0_f64 / 3.0).sqrt();
                assert!(((end / radii).length() - 1.0).abs() < 40.0 * ROUNDING, "{end}");
            }
        }
    }
    assert_eq!(box_ends, 24);
    assert!(ellipsoid_ends > 100);
}

/// The shafts among lines of one colour: what starts at the body.
fn arrows(lines: &[Line], from: DVec3, color: [f32; 3]) -> Vec<DVec3> {
    lines.iter().filter(|line| line.2 == color && line.0 == from).map(|line| line.1 - line.0).collect()
}

#[test]
fn arrows_are_what_they_stand_for() {
    let mut world = hecs::World::new();
    let position = Vec3::new(4.0, 0.0, -8.0);
    let quarter = Quat::from_rotation_arc(Vec3::X, Vec3::Y);
    let body = RigidBody::new(Shape::cuboid([0.5, 0.5, 0.5]))
        .without_collider()
        .mass(6.0)
        .position(position)
        .orientation(quarter)
        .linear_velocity(Vec3::X)
        .angular_velocity(Vec3::Y * 2.0)
        .build()
        .unwrap()
        .spawn(&mut world);
    world.get::<&mut Wrench>(body).unwrap().add_force(Vec3::Z * 3.0);
    world.insert(body, (ConstantWrench { force: Vec3::X, torque: Vec3::Y, frame: Frame::Body },)).unwrap();
    let nothing = lines(&DebugView::nothing(), &world);
    assert_eq!(nothing, []);
    let view = DebugView {
        axes: Some(0.25),
        momentum: Some(0.5),
        angular_momentum: Some(0.25),
        angular_velocity: Some(2.0),
        forces: Some(0.5),
        ..DebugView::nothing()
    };
    let lines = lines(&view, &world);
    let near = |color, expected: &[DVec3]| {
        let found = arrows(&lines, dvec3(position), color);
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            // Ends are up to nine metres from the origin.
            assert!((*found - *expected).length() < 4.0 * ROUNDING, "{found} is not {expected}");
        }
    };
    near(DebugView::MOMENTUM, &[DVec3::X * 3.0]);
    // A cube of 6 kg and one metre has moments of one.
    near(DebugView::ANGULAR_MOMENTUM, &[DVec3::Y * 0.5]);
    near(DebugView::ANGULAR_VELOCITY, &[DVec3::Y * 4.0]);
    // A quarter turn about z takes x to y, and y to minus x.
    near(DebugView::FORCE, &[DVec3::Z * 1.5, DVec3::Y * 0.5]);
    near(DebugView::TORQUE, &[DVec3::X * -0.5]);
    near(DebugView::AXES[0], &[DVec3::Y * 0.25]);
    near(DebugView::AXES[1], &[DVec3::X * -0.25]);
    near(DebugView::AXES[2], &[DVec3::Z * 0.25]);
}

#[test]
fn springs_join_their_ends_and_frames_are_between_steps() {
    let mut world = hecs::World::new();
    let ball = |x: Real| {
        RigidBody::new(Shape::sphere(0.25))
            .without_collider()
            .mass(1.0)
            .position(Vec3::X * x)
            .interpolated()
            .build()
            .unwrap()
    };
    let (left, right) = (ball(-2.0).spawn(&mut world), ball(2.0).spawn(&mut world));
    world.spawn((Spring::between(left, right).attached_at(Vec3::Y, Vec3::ZERO),));
    world.insert_one(right, SpringToPoint { anchor: Vec3::Z * 8.0, ..SpringToPoint::default() }).unwrap();
    world.get::<&mut Pose>(right).unwrap().position = Vec3::X * 4.0;

    // The right one was at 2 and is at 4: a quarter of the way it is at 2.5.
    let forces = DebugView { forces: Some(1.0), alpha: 0.25, ..DebugView::nothing() };
    let mut found = lines(&forces, &world);
    found.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
    let [between, to_point] = found.try_into().unwrap();
    assert_eq!(between, (DVec3::new(-2.0, 1.0, 0.0), DVec3::X * 2.5, DebugView::FORCE));
    assert_eq!(to_point, (DVec3::X * 2.5, DVec3::Z * 8.0, DebugView::FORCE));

    // A spring whose body is gone has no end there.
    world.despawn(left).unwrap();
    assert_eq!(lines(&forces, &world).len(), 1);
}

/// The ends of springs are given along the axes of bodies that are turned, from centres of mass
/// that are not where the bodies' frames are.
#[test]
fn springs_end_where_they_are_attached() {
    let mut world = hecs::World::new();
    let (far, tilt) = (Vec3::new(1.0, -2.0, 0.5), Quat::from_rotation_x(0.7) * Quat::from_rotation_y(-1.9));
    let quarter = Quat::from_rotation_arc(Vec3::X, Vec3::Y);
    let shape = || Shape::Compound(vec![Part::new(Shape::sphere(0.5), Amount::Mass(2.0)).at([0.0, 1.0, 0.0])]);
    let body = |at: Vec3, turn: Quat| {
        RigidBody::new(shape()).without_collider().position(at).orientation(turn).build().unwrap()
    };
    let (one, other) = (body(Vec3::X * 3.0, quarter).spawn(&mut world), body(far, tilt).spawn(&mut world));
    let on_other = Vec3::new(0.25, -0.5, 0.75);
    world.spawn((Spring::between(one, other).attached_at(Vec3::X * 0.5, on_other),));
    let anchor = Vec3::new(-4.0, 8.0, 2.0);
    let to_point = SpringToPoint { anchor, attachment: Vec3::Y * 2.0, ..SpringToPoint::default() };
    world.insert_one(one, to_point).unwrap();

    // A quarter turn about z takes x to y, and y to minus x; the centre of mass is a metre up from
    // where the first body's frame is, and so at its left.
    let above = dvec3(far) + dquat(tilt) * (DVec3::Y + dvec3(on_other));
    let expected = [(DVec3::new(2.0, 0.5, 0.0), above), (DVec3::ZERO, dvec3(anchor))];
    let springs = DebugView { springs: true, ..DebugView::nothing() };
    let seen = |view: &DebugView, world: &hecs::World, color| {
        let found = lines(view, world);
        assert!(found.iter().all(|line| line.2 == color), "{found:?}");
        let is_there = |(from, to): (DVec3, DVec3)| {
            let near = |line: &&Line| (line.0 - from).length().max((line.1 - to).length()) < 4.0 * ROUNDING;
            found.iter().filter(near).count()
        };
        (found.len(), expected.map(is_there))
    };
    assert_eq!(seen(&springs, &world, DebugView::SPRING), (2, [1, 1]));
    // Forces show them as well, which does not draw them twice: nothing else pushes here.
    let both = DebugView { forces: Some(1.0), ..springs.clone() };
    assert_eq!(seen(&both, &world, DebugView::FORCE), (2, [1, 1]));

    let mut of_one = Vec::new();
    springs.draw_body(&world, one, &mut |from, to, _| of_one.push((dvec3(from), dvec3(to))));
    assert_eq!(of_one.len(), 1, "{of_one:?}");
    // With its body a spring loses its end, on either side.
    world.despawn(other).unwrap();
    assert_eq!(seen(&springs, &world, DebugView::SPRING), (1, [0, 1]));
    world.despawn(one).unwrap();
    assert_eq!(seen(&springs, &world, DebugView::SPRING), (0, [0, 0]));
}

/// A world with a box of 3 kg, its lower face in the plane of the ground; with the ground before
/// the box in the order of bodies, or behind it.
fn box_on_ground(ground: u64) -> (hecs::World, hecs::Entity) {
    let mut world = hecs::World::new();
    let fixed = RigidBody::new(Shape::Point).fixed().id(BodyId(ground));
    fixed.build().unwrap().spawn_with(&mut world, (Collider::half_space(),));
    let shape = Shape::cuboid([0.5, 0.25, 0.75]);
    let collider = Collider::new(&shape).unwrap();
    let body = RigidBody::new(shape).without_collider().mass(3.0).position(Vec3::Y * 0.25).id(BodyId(1));
    let body = body.orientation(Quat::from_rotation_y(0.4)).build().unwrap();
    let body = body.spawn_with(&mut world, (collider,));
    (world, body)
}

/// Crosses are at the corners, and arrows go up from them, together as long as the weight: the
/// force on what moves, whichever comes first.
#[test]
fn a_box_that_rests_has_its_weight_at_its_corners() {
    let [width, scale] = [0.1, 0.05];
    let view = DebugView { contacts: Some(width), contact_forces: Some(scale), ..DebugView::nothing() };
    for ground in [0, 2] {
        let (mut world, body) = box_on_ground(ground);
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        simulation.step_many(&mut world, 120);
        let mut lines: Vec<Line> = Vec::new();
        view.draw_contacts(&simulation, &world, &mut |from, to, color| lines.push((dvec3(from), dvec3(to), color)));
        assert!(lines.iter().all(|line| line.2 == DebugView::CONTACT));
        let pose = *world.get::<&Pose>(body).unwrap();
        let mut total = 0.0;
        for (x, z) in [(-0.5, -0.75), (-0.5, 0.75), (0.5, -0.75), (0.5, 0.75)] {
            let corner = dvec3(pose.transform_point(Vec3::new(x, -0.25, z)));
            // At rest a step moves nothing by more than rounding, and the surfaces sink into each
            // other by less than a millimetre.
            let near = |point: DVec3| (point - corner).length() < 1e-3;
            let crosses: Vec<DVec3> =
                lines.iter().filter(|it| near(0.5 * (it.0 + it.1))).map(|it| it.1 - it.0).collect();
            assert_eq!(crosses.len(), 2, "{corner}: {lines:?}");
            for stroke in crosses {
                assert!((stroke.length() - f64::from(width)).abs() < ROUNDING && stroke.y.abs() < ROUNDING, "{stroke}");
            }
            let shafts: Vec<DVec3> = lines.iter().filter(|it| near(it.0)).map(|it| it.1 - it.0).collect();
            assert_eq!(shafts.len(), 1, "{corner}: {lines:?}");
            // The ground's normal is exact.
            assert!(shafts[0].y > 0.0 && shafts[0].with_y(0.0).length() < ROUNDING, "{shafts:?}");
            total += shafts[0].y;
        }
        let weight = 3.0 * 9.81 * f64::from(scale);
        assert!((total / weight - 1.0).abs() < 0.01, "{total} {weight}");
        // Two strokes of a cross, a shaft and four strokes of a head each.
        assert_eq!(lines.len(), 4 * (2 + 1 + 4));
    }
}

#[test]
fn what_does_not_push_is_a_point_and_what_does_not_touch_is_nothing() {
    let view = DebugView { contacts: Some(0.1), contact_forces: Some(1.0), ..DebugView::nothing() };
    // Without gravity: in touch, and half a margin apart.
    for (lift, expected) in [(0.0, 4 * 2), (0.003, 0)] {
        let (mut world, body) = box_on_ground(0);
        world.get::<&mut Pose>(body).unwrap().position.y += lift;
        let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
        simulation.step(&mut world);
        let points: usize = simulation.contacts().map(|contact| contact.points().len()).sum();
        assert_eq!(points, 4);
        for (view, expected) in [(&view, expected), (&DebugView::default(), 0)] {
            let mut count = 0;
            view.draw_contacts(&simulation, &world, &mut |_, _, _| count += 1);
            assert_eq!(count, expected);
        }
    }
}

/// Ends of a collider's lines in the collider's own frame. The body is turned, its centre of mass
/// is not the origin of its frame, and the collider is put aside in it.
fn ends_in_collider_frame(collider: Collider) -> Vec<DVec3> {
    let pose = Pose { position: Vec3::new(1.0, -2.0, 0.5), orientation: Quat::from_rotation_x(0.7) };
    let offset = Pose { position: Vec3::new(0.25, 0.5, -0.25), orientation: Quat::from_rotation_z(-1.9) };
    let mut world = hecs::World::new();
    let shape = Shape::Compound(vec![Part::new(Shape::sphere(0.5), Amount::Mass(2.0)).at([0.0, 1.0, 0.0])]);
    let body =
        RigidBody::new(shape).without_collider().position(pose.position).orientation(pose.orientation).build().unwrap();
    let body = body.spawn_with(&mut world, (collider.with_offset(offset).unwrap(),));
    assert!(world.get::<&CenterOfMass>(body).is_ok());
    let lines = lines(&DebugView { colliders: true, ..DebugView::nothing() }, &world);
    assert!(lines.iter().all(|line| line.2 == DebugView::COLLIDER));
    let to_body = |point: DVec3| dquat(pose.orientation).conjugate() * (point - dvec3(pose.position));
    let to_collider = |point: DVec3| dquat(offset.orientation).conjugate() * (to_body(point) - dvec3(offset.position));
    lines.into_iter().flat_map(|(from, to, _)| [to_collider(from), to_collider(to)]).collect()
}

#[test]
fn colliders_are_drawn_where_others_bump_into_them() {
    let of = |shape: Shape| ends_in_collider_frame(Collider::new(&shape).unwrap());
    let round = [
        (Shape::sphere(0.7), DVec3::splat(0.7)),
        (Shape::ellipsoid([0.3, 1.2, 0.6]), DVec3::new(0.3, 1.2, 0.6)),
        (Shape::cylinder(0.4, 1.1), DVec3::new(0.4, 1.1, 0.4)),
        (Shape::capsule(0.4, 0.7), DVec3::new(0.4, 1.1, 0.4)),
        (Shape::cone(0.4, 1.1), DVec3::new(0.4, 1.1, 0.4)),
        (Shape::frustum(0.4, 0.2, 1.1), DVec3::new(0.4, 1.1, 0.4)),
        (Shape::tapered_capsule(0.4, 0.4, 0.7), DVec3::new(0.4, 1.1, 0.4)),
    ];
    for (shape, size) in round {
        // Lengths and places went through the precision of the build.
        let farthest = of(shape.clone()).into_iter().fold(DVec3::ZERO, |most, end| most.max(end.abs()));
        assert!((farthest - size).abs().max_element() < 4.0 * ROUNDING, "{shape:?}: {farthest}");
    }

    let half = DVec3::new(0.1, 0.2, 0.3);
    let corners: Vec<DVec3> = (0..8_u8)
        .map(|bits| half * DVec3::from_array([0, 1, 2].map(|axis| 2.0 * f64::from(bits >> axis & 1) - 1.0)))
        .collect();
    let part = Part::new(Shape::cuboid(half), Amount::Mass(1.0));
    let compound = of(Shape::Compound(vec![part.clone(), Part::new(Shape::Point, Amount::Mass(1.0))]));
    let hull = ends_in_collider_frame(Collider::convex_hull(corners.iter().copied()).unwrap());
    for ends in [of(part.shape), compound, hull] {
        assert_eq!(ends.len(), 24);
        assert!(ends.iter().all(|end| (end.abs() - half).length() < 4.0 * ROUNDING), "{ends:?}");
    }
}

/// Each side of a triangle is drawn once, those at the rim too.
#[test]
fn surfaces_are_drawn_by_their_triangles() {
    let corners = [DVec3::ZERO, DVec3::Z, DVec3::X + DVec3::Z, DVec3::X];
    let mesh = Collider::mesh(corners, &[[0, 1, 2], [0, 2, 3]]).unwrap();
    let field = Collider::height_field([0.0; 4], 2, [1.0, 1.0]).unwrap();
    // The field's origin is in its middle.
    for (collider, middle) in [(mesh, DVec3::new(0.5, 0.0, 0.5)), (field, DVec3::ZERO)] {
        let ends = ends_in_collider_frame(collider);
        assert_eq!(ends.len(), 10);
        for end in ends {
            assert!(((end - middle).abs() - DVec3::new(0.5, 0.0, 0.5)).length() < 4.0 * ROUNDING, "{end}");
        }
    }
    assert_eq!(ends_in_collider_frame(Collider::half_space()), []);
}

#[derive(Default)]
struct Texts(Vec<(Vec3, String)>);

impl DebugDraw for Texts {
    fn line(&mut self, from: Vec3, to: Vec3, _: [f32; 3]) {
        assert!(from.is_finite() && to.is_finite());
    }

    fn text(&mut self, at: Vec3, text: &str, _: [f32; 3]) {
        assert!(at.is_finite());
        self.0.push((at, text.to_owned()));
    }
}

/// A body whose state is lost is not seen, and the others are.
#[test]
fn what_is_not_finite_is_not_drawn() {
    let mut world = hecs::World::new();
    let cube = |id| {
        RigidBody::new(Shape::cuboid([1.0, 1.0, 1.0])).without_collider().mass(1.0).id(BodyId(id)).build().unwrap()
    };
    let (lost, _) = (cube(3).spawn(&mut world), cube(7).spawn(&mut world));
    world.get::<&mut Pose>(lost).unwrap().position.x = Real::NAN;
    world.get::<&mut Momentum>(lost).unwrap().angular.y = Real::INFINITY;
    let all = DebugView {
        ellipsoids: true,
        momentum: Some(1.0),
        angular_momentum: Some(1.0),
        angular_velocity: Some(1.0),
        forces: Some(1.0),
        springs: true,
        ids: true,
        ..DebugView::default()
    };
    let mut texts = Texts::default();
    all.draw(&world, &mut texts);
    assert_eq!(texts.0, [(Vec3::ZERO, "7".to_owned())]);
    assert!(!lines(&all, &world).is_empty());

    let mut lone = Texts::default();
    all.draw_body(&world, lost, &mut lone);
    world.despawn(lost).unwrap();
    all.draw_body(&world, lost, &mut lone);
    assert_eq!(lone.0, []);
}
