//! Promise: the parts of a compound collider have materials and groups of their own, in the API, in
//! scene files and in glTF: two bodies meet only where parts of them touch by their groups, and
//! with the surfaces of the parts that meet there.
//!
//! Why: with one filter for all a body falls through ground that a part of it should rest on. It
//! fails if the number of a part leads to another part's surface, or a compound of equal parts is
//! another than a compound shape.

use hecs::{Entity, World};
use proptest::prelude::*;
use tumble::math::{Real, Vec3};
use tumble::prelude::*;
use tumble::{Amount, Contact, Part, Rng};
use tumble_scene::Scene;
use tumble_tests::touching::{collider, pose, spawn};
use tumble_tests::{hash, run};

fn at(position: Vec3) -> Pose {
    Pose { position, ..Pose::default() }
}

/// A part of a rack: a ball, or a bar of two balls that is a compound itself, in a place of its
/// own.
struct Foot {
    place: Vec3,
    shape: Shape,
    friction: Real,
    membership: u32,
    filter: u32,
}

/// Feet in a row along x, all on the ground.
fn feet(rng: &mut Rng) -> Vec<Foot> {
    let count = 2 + (rng.next_u64() % 6) as usize;
    (0..count)
        .map(|i| {
            let ball = |z: f64| Part::new(Shape::sphere(0.1), Amount::Density(500.0)).at([0.0, 0.0, z]);
            let is_bar = rng.next_u64().is_multiple_of(2);
            Foot {
                place: Vec3::X * (i as Real - 0.5 * (count - 1) as Real),
                shape: if is_bar { Shape::compound([ball(-0.2), ball(0.2)]) } else { Shape::sphere(0.1) },
                friction: rng.range(0.1, 1.0),
                membership: 1 << (rng.next_u64() % 3),
                filter: rng.next_u64() as u32 % 8,
            }
        })
        .collect()
}

/// A rack of feet that slides over the ground at 3 m/s, turned about the upright.
fn rack(world: &mut World, feet: &[Foot], turn: Real) -> Entity {
    let parts = feet.iter().map(|foot| {
        let part = collider(&foot.shape).with_material(Material::new(foot.friction, 0.0)).unwrap();
        part.with_groups(foot.membership, foot.filter).with_offset(at(foot.place)).unwrap()
    });
    let body = RigidBody::new(Shape::cuboid([3.0, 0.05, 0.3])).mass(10.0).linear_velocity(Vec3::Z * 3.0);
    let body = body.orientation(tumble::math::Quat::from_rotation_y(turn)).position(Vec3::Y * 0.0999);
    spawn(world, body, Collider::compound(parts).unwrap())
}

/// The foot that a point is of.
fn foot_at<'a>(feet: &'a [Foot], pose: &Pose, point: Vec3) -> &'a Foot {
    let place = pose.orientation.conjugate() * (point - pose.position);
    feet.iter().min_by(|a, b| (a.place.x - place.x).abs().total_cmp(&(b.place.x - place.x).abs())).unwrap()
}

/// Ground of two plates, each with its material and groups, side by side along z; or of one
/// half-space.
fn ground(world: &mut World, rng: &mut Rng) -> (u32, u32, Real) {
    let (membership, filter, friction) = (1 << (rng.next_u64() % 3), rng.next_u64() as u32 % 8, rng.range(0.1, 1.0));
    let surface = Material::new(friction, 0.0);
    let one = Collider::half_space().with_groups(membership, filter).with_material(surface).unwrap();
    let ground = if rng.next_u64().is_multiple_of(2) {
        one
    } else {
        // Far below, and with other numbers: it is never met.
        let other = Collider::new(&Shape::cuboid([1.0, 1.0, 1.0])).unwrap().with_offset(at(Vec3::Y * -9.0)).unwrap();
        Collider::compound([other, one]).unwrap()
    };
    spawn(world, RigidBody::new(Shape::Point).fixed(), ground);
    (membership, filter, friction)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn each_part_meets_with_its_own(seed in any::<u64>(), turn in -3.0..3.0_f64) {
        let mut rng = Rng::new(seed);
        let mut world = World::new();
        let feet = feet(&mut rng);
        let (membership, filter, friction) = ground(&mut world, &mut rng);
        let body = rack(&mut world, &feet, turn as Real);
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        let touches = |foot: &Foot| foot.membership & filter != 0 && membership & foot.filter != 0;
        let expected: usize =
            feet.iter().filter(|foot| touches(foot)).map(|foot| if foot.shape == Shape::sphere(0.1) { 1 } else { 2 }).sum();
        let before = pose(&world, body);
        run(&mut simulation, &mut world, 1);
        let contacts: Vec<Contact> = simulation.contacts().collect();
        prop_assert_eq!(contacts.len(), expected);
        for contact in &contacts {
            let foot = foot_at(&feet, &before, contact.points()[0].position);
            prop_assert!(touches(foot));
            let normal: Real = contact.points().iter().map(|point| point.impulse).sum();
            // All slide: the coefficient is the mean of both surfaces'. What is lifted in the first
            // step has none.
            let sliding = 0.5 * (foot.friction + friction) * normal;
            prop_assert!((contact.friction.length() - sliding).abs() <= 2e-3 * sliding + 1e-6, "{:?}", contact);
        }
        // What nothing holds falls.
        if expected == 0 {
            run(&mut simulation, &mut world, 60);
            prop_assert!(pose(&world, body).position.y < -1.0);
        }
    }
}

/// Parts that are alike are as a compound shape is, to the bit.
#[test]
fn equal_parts_are_one_shape() {
    let places = [Vec3::new(-0.3, 0.1, 0.0), Vec3::new(0.3, 0.0, 0.1), Vec3::new(0.0, -0.2, 0.3)];
    let ball = |place: &Vec3| {
        let place = tumble::glam::DVec3::new(place.x.into(), place.y.into(), place.z.into());
        Part::new(Shape::sphere(0.2), Amount::Density(500.0)).at(place)
    };
    let shape = Shape::compound(places.iter().map(ball));
    let parts = places.iter().map(|place| collider(&Shape::sphere(0.2)).with_offset(at(*place)).unwrap());
    let ends = [collider(&shape), Collider::compound(parts).unwrap()].map(|collider| {
        let mut world = World::new();
        tumble_tests::touching::ground(&mut world, Material::default(), tumble::math::Quat::IDENTITY);
        spawn(&mut world, RigidBody::new(shape.clone()).position(Vec3::Y), collider);
        run(&mut Simulation::new(Settings::default()).unwrap(), &mut world, 120);
        hash(&world)
    });
    assert_eq!(ends[0], ends[1]);
}

#[test]
fn a_compound_of_nothing_is_refused() {
    assert!(Collider::compound([]).is_err());
}

/// Where the only moving body of a scene is after two seconds, in y.
fn height(scene: Scene) -> f64 {
    let mut simulation = Simulation::new(scene.settings).unwrap();
    let mut world = World::new();
    scene.spawn(&mut world).unwrap();
    simulation.step_many(&mut world, 120);
    let momenta = world.query_mut::<(&Pose, &Momentum)>().into_iter();
    momenta.map(|(pose, _)| f64::from(pose.position.y)).next().unwrap()
}

/// Two balls side by side, on ground of group 1: it holds the body if it touches both of them, and
/// not if it touches none.
#[test]
fn parts_of_scene_files_have_their_own() {
    let scene = |first: &str, second: &str| {
        let text = format!(
            r#"{{ "bodies": [ {{ "shape": {{ "half_space": {{}} }}, "fixed": true, "collider": {{ "groups": [1] }} }},
                {{ "shape": {{ "compound": {{ "parts": [
                     {{ "shape": {{ "sphere": {{ "radius": 0.5 }} }}, "mass": 1, "position": [-1, 0, 0] }},
                     {{ "shape": {{ "sphere": {{ "radius": 0.5 }} }}, "mass": 1, "position": [1, 0, 0] }} ] }} }},
                   "position": [0, 0.6, 0],
                   "collider": {{ "touches": [0], "parts": [ {first}, {second} ] }} }} ] }}"#
        );
        Scene::from_json(&text, "parts.json")
    };
    let held = r#"{ "touches": [0, 1] }"#;
    assert!((height(scene(held, held).unwrap()) - 0.5).abs() < 1e-2);
    assert!(height(scene("{}", "{}").unwrap()) < -5.0);
    // Held at one end it tips down on the other.
    let tipped = height(scene(held, r#"{ "friction": 0.1 }"#).unwrap());
    assert!(tipped < 0.3, "{tipped}");
    for (first, second, problem) in [
        (held, r#"{ "friction": -1 }"#, "collider.parts[1]"),
        (held, r#"{ "touches": [32] }"#, "collider.parts[1]"),
        (held, "{}, {}", "one for each part"),
    ] {
        let error = scene(first, second).unwrap_err().to_string();
        assert!(error.contains(problem), "{error}");
    }
}

/// A body of two colliders, each with a filter: the second's lets it rest where the first's alone
/// would let it fall.
#[test]
fn colliders_of_gltf_have_their_own() {
    let scene = |filters: [u32; 2]| {
        let ball = |name: &str, x: f64, filter: u32| {
            format!(
                r#"{{ "name": "{name}", "translation": [{x}, 0, 0], "extensions": {{ "KHR_physics_rigid_bodies": {{
                    "collider": {{ "geometry": {{ "shape": 1 }}, "collisionFilter": {filter} }} }} }} }}"#
            )
        };
        let text = format!(
            r#"{{ "asset": {{ "version": "2.0" }}, "nodes": [
                {{ "name": "floor", "extensions": {{ "KHR_physics_rigid_bodies": {{ "collider": {{ "geometry": {{ "shape": 0 }}, "collisionFilter": 0 }} }} }} }},
                {{ "name": "body", "translation": [0, 0.6, 0], "children": [2, 3, 4, 5], "extensions": {{ "KHR_physics_rigid_bodies": {{ "motion": {{ "mass": 2 }} }} }} }},
                {}, {}, {}, {} ], "scenes": [ {{ "nodes": [0, 1] }} ], "scene": 0, "extensions": {{
                "KHR_implicit_shapes": {{ "shapes": [ {{ "type": "plane" }}, {{ "type": "sphere", "sphere": {{ "radius": 0.5 }} }} ] }},
                "KHR_physics_rigid_bodies": {{ "collisionFilters": [ {{ "collisionSystems": [ "a" ] }}, {{ "collideWithSystems": [ "a" ] }},
                    {{ "notCollideWithSystems": [ "a" ] }} ] }} }} }}"#,
            ball("first", -1.0, filters[0]),
            ball("second", -2.0, filters[1]),
            ball("third", 1.0, filters[0]),
            ball("fourth", 2.0, filters[1]),
        );
        let scene = Scene::from_gltf(text.as_bytes(), "file.gltf").unwrap();
        assert!(scene.notices.is_empty(), "{:?}", scene.notices);
        scene
    };
    for (filters, is_held) in [([1, 1], true), ([2, 2], false), ([2, 1], true), ([1, 2], true)] {
        let height = height(scene(filters));
        assert_eq!((height - 0.5).abs() < 1e-2, is_held, "{filters:?}: {height}");
        assert_eq!(height < -5.0, !is_held, "{filters:?}: {height}");
    }
}
