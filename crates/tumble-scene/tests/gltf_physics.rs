//! Promise: a glTF file with physics becomes the bodies that it describes, what is not simulated is
//! named, and a mistake names file, node and field.
//!
//! Why: velocities in the node's frame, scales, defaults and infinities are where readers of these
//! drafts differ, and a body that is read wrong moves and looks right.
#![cfg_attr(feature = "f64", allow(clippy::useless_conversion, reason = "Real is f64 in this build, f32 in the other"))]

use std::path::{Path, PathBuf};

use glam::{DMat3, DVec3};
use hecs::{Entity, World};
use tumble::{
    BodyId, BodyOrder, Collider, GravityScale, Inertia, Mass, Momentum, Pose, PrincipalAxes, RigidBody, Shape,
    Simulation, Velocity, state_hash,
};
use tumble_import::ColliderRole;
use tumble_import::gltf::{CombineRule, Geometry, Physics};
use tumble_scene::{Audit, AuditedBody, BodyNames, Scene};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/gltf_scenes").join(name)
}

fn open(name: &str) -> Scene {
    Scene::open(&file(name).to_string_lossy()).unwrap()
}

fn audit(name: &str) -> Audit {
    Audit::open(&file(name).to_string_lossy()).unwrap()
}

fn body<'a>(audit: &'a Audit, name: &str) -> &'a AuditedBody {
    audit.bodies.iter().find(|body| body.name == name).unwrap()
}

fn tensor(body: &AuditedBody) -> DMat3 {
    DMat3::from_cols_array_2d(&body.tensor.unwrap())
}

struct Spawned {
    world: World,
    names: BodyNames,
}

impl Spawned {
    fn of(scene: Scene) -> Self {
        let mut world = World::new();
        let names = scene.spawn(&mut world).unwrap();
        Self { world, names }
    }

    fn entity(&self, name: &str) -> Entity {
        let mut query = self.world.query::<(Entity, &BodyId)>();
        query.iter().find(|(_, id)| self.names.of(id.0) == name).unwrap().0
    }

    fn position(&self, name: &str) -> DVec3 {
        DVec3::from_array(self.world.get::<&Pose>(self.entity(name)).unwrap().position.to_array().map(f64::from))
    }

    fn velocity(&self, name: &str) -> [DVec3; 2] {
        let velocity = *self.world.get::<&Velocity>(self.entity(name)).unwrap();
        [velocity.linear, velocity.angular].map(|vector| DVec3::from_array(vector.to_array().map(f64::from)))
    }
}

fn hash(world: &World) -> u64 {
    state_hash(world, &BodyOrder::of(world))
}

/// Files are written in f32 where they come from exporters, and states may be f32.
const ROUNDING: f64 = 1e-6;

fn close(found: DVec3, expected: [f64; 3]) {
    let expected = DVec3::from_array(expected);
    assert!((found - expected).length() <= ROUNDING * (1.0 + expected.length()), "{found}, not {expected}");
}

#[test]
fn bodies_are_where_the_nodes_are_and_move_as_they_say() {
    let scene = open("everything.gltf");
    // The last is what a joint's node hangs on that no body carries.
    assert_eq!((scene.name.as_deref(), scene.body_count()), (Some("everything"), 17));
    let spawned = Spawned::of(scene);
    close(spawned.position("brick"), [11.0, 0.0, 0.0]);
    let [linear, angular] = spawned.velocity("brick");
    close(linear, [1.0, 0.0, 0.0]);
    close(angular, [0.0, 0.0, -1.0]);
    close(spawned.position("dumbbell"), [7.0 / 9.0, 5.0, 0.0]);
    close(spawned.position("spinner"), [0.5, 0.0, 5.0]);
    close(spawned.position("wedge"), [0.25, 0.5, -4.25]);
    close(spawned.position("hull"), [-0.25, 0.5, 0.75]);
    close(spawned.velocity("lift")[0], [0.0, 1.0, 0.0]);
    assert!(spawned.world.get::<&Momentum>(spawned.entity("lift")).is_err());
    for fixed in ["ground", "door"] {
        assert!(spawned.world.get::<&Velocity>(spawned.entity(fixed)).is_err(), "{fixed}");
    }
    // The second of two nodes with one name.
    close(spawned.velocity("bare (node-22)")[1], [0.0, 0.0, 0.0]);
    let half = spawned.world.get::<&GravityScale>(spawned.entity("dumbbell")).unwrap().0;
    assert_eq!(f64::from(half), 0.5);
}

/// Closed forms of blocks, balls, tetrahedra, ellipsoids and cones.
#[test]
fn mass_and_inertia_are_given_or_those_of_the_colliders() {
    let audit = audit("everything.gltf");
    let diagonal = |x: f64, y: f64, z: f64| DMat3::from_diagonal(DVec3::new(x, y, z));
    let check = |name: &str, mass: f64, expected: DMat3, tolerance: f64| {
        let body = body(&audit, name);
        assert!((body.mass.unwrap() - mass).abs() <= 1e-15 * mass, "{name}: {:?}", body.mass);
        let error = (tensor(body) - expected).to_cols_array().into_iter().fold(0.0, |worst: f64, e| worst.max(e.abs()));
        assert!(
            error <= tolerance * expected.to_cols_array().into_iter().fold(0.0, f64::max),
            "{name}: {:?}",
            body.tensor
        );
    };
    check("brick", 6.0, diagonal(6.5, 5.0, 2.5), 1e-14);
    // Two balls of masses 2/9 and 16/9 and radii 1/2 and 1 at -1 and 1.
    let (balls, apart) = (0.4 * (2.0 / 9.0 * 0.25 + 16.0 / 9.0), 2.0 / 9.0 * 16.0 / 9.0 / 2.0 * 4.0);
    check("dumbbell", 2.0, diagonal(balls, balls + apart, balls + apart), 1e-14);
    check("spinner", 4.0, diagonal(2.0, 1.0, 2.5), 1e-14);
    // A corner of a block, legs 1, 2, 3: integrals of x^2 and x y about the centre are 3/80 m a^2
    // and -1/80 m a b.
    let corner = |mirror: f64| {
        DMat3::from_cols(
            DVec3::new(3.0 * 13.0, mirror * 2.0, mirror * 3.0),
            DVec3::new(mirror * 2.0, 3.0 * 10.0, 6.0),
            DVec3::new(mirror * 3.0, 6.0, 3.0 * 5.0),
        ) * (2.0 / 80.0)
    };
    check("wedge", 2.0, corner(1.0), 1e-14);
    check("hull", 2.0, corner(-1.0), 1e-14);
    check("tray", 1.0, diagonal(1.0, 1.0, 1.0) * (1.0 / 6.0), 1e-14);
    check("egg", 1.0, diagonal(0.25, 0.1, 0.25), 1e-14);
    check("bare", 1.0, diagonal(0.1, 0.1, 0.1), 1e-14);
    // An elliptic cone out of 24 sides: a polygon of n sides has 1 - (2 pi/n)^2/6 of the ellipse's
    // second moments.
    let [a2, b2, h2] = [0.25, 1.0, 4.0];
    let across = |r2: f64| 0.15 * r2 + 3.0 / 80.0 * h2;
    check("flattened cone", 1.0, diagonal(across(b2), 0.15 * (a2 + b2), across(a2)), 0.012);
    let volume = Shape::TaperedCapsule { radius_bottom: 0.25, radius_top: 0.5, half_height: 0.5 }.volume().unwrap();
    assert!((body(&audit, "weightless by name only").mass.unwrap() / (1000.0 * volume) - 1.0).abs() < 1e-15);
}

/// Zero stands for infinity, which a body is as far as numbers go: it keeps to its axis, is not
/// moved by gravity, or does not turn.
#[test]
fn infinite_masses_and_moments_hold() {
    let scene = open("everything.gltf");
    let mut simulation = Simulation::new(scene.settings).unwrap();
    let mut spawned = Spawned::of(scene);
    // Or they would touch.
    for body in BodyOrder::of(&spawned.world).entities() {
        let _ = spawned.world.remove_one::<Collider>(*body);
    }
    simulation.step_many(&mut spawned.world, 100);
    close(spawned.position("wheel"), [0.0, 0.0, 0.0]);
    close(spawned.velocity("wheel")[1], [0.0, 2.0, 0.0]);
    assert!(spawned.world.get::<&Inertia>(spawned.entity("sledge")).is_err());
    let time = simulation.time();
    let [linear, angular] = spawned.velocity("sledge");
    assert!((linear - DVec3::new(1.0, -9.81 * time, 0.0)).length() < 1e-4, "{linear}");
    close(angular, [0.0, 0.0, 0.0]);
}

#[test]
fn colliders_are_kept_with_all_they_say() {
    let scene = open("everything.gltf");
    let of = |name: &str| scene.colliders().find(|(_, collider)| collider.name == name).unwrap().1.clone();
    let ground = of("ground");
    assert!(matches!(ground.geometry, Geometry::Plane { size_x: None, size_z: None, double_sided: false }));
    assert_eq!((ground.role, ground.shape.is_none()), (ColliderRole::Solid, true));
    assert_eq!((ground.material.static_friction, ground.material.dynamic_friction), (0.9, 0.8));
    assert_eq!(
        (ground.material.friction_combine, ground.material.restitution_combine),
        (CombineRule::Maximum, CombineRule::Average)
    );
    let filter = ground.filter.unwrap();
    assert_eq!(filter.collision_systems, ["ground"]);
    assert_eq!(filter.not_collide_with_systems.as_deref(), Some(&["ghosts".to_owned()][..]));
    let right = of("right");
    assert_eq!((right.position, right.shape), (DVec3::X, Some(Shape::sphere(1.0))));
    assert_eq!(of("door").role, ColliderRole::Trigger);
    // An open mesh is kept as it is; only its mass is that of its hull.
    assert_eq!(of("tray").surface.unwrap().triangles().len(), 10);
    let joint = Physics::open(&file("everything.gltf")).unwrap().node(20).unwrap().joint.clone().unwrap();
    assert_eq!((joint.connected_node, joint.joint.limits.len(), joint.joint.drives[0].max_force), (2, 2, Some(5.0)));
}

/// Triggers are sensors: of bodies of their own, beside solid colliders of a body, with filters.
#[test]
fn triggers_are_sensors() {
    let node = |name: &str, y: f64, inner: &str| {
        let physics = format!(r#""extensions": {{ "KHR_physics_rigid_bodies": {{ {inner} }} }}"#);
        format!(r#"{{ "name": "{name}", "translation": [0, {y}, 0], {physics} }}"#)
    };
    let shape = |number: u32| format!(r#""geometry": {{ "shape": {number} }}"#);
    let nodes = [
        node("ball", 3.0, &format!(r#""motion": {{ "mass": 1 }}, "collider": {{ {} }}"#, shape(0))),
        node("zone", 1.0, &format!(r#""trigger": {{ {} }}"#, shape(1))),
        node("ghosts only", 1.0, &format!(r#""trigger": {{ {}, "collisionFilter": 0 }}"#, shape(1))),
        node("pad", -2.0, &format!(r#""collider": {{ {} }}, "trigger": {{ {} }}"#, shape(1), shape(2))),
    ];
    let text = format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "nodes": [ {} ], "extensions": {{
            "KHR_physics_rigid_bodies": {{ "collisionFilters": [ {{ "collideWithSystems": ["ghosts"] }} ] }},
            "KHR_implicit_shapes": {{ "shapes": [ {{ "type": "sphere", "sphere": {{ "radius": 0.2 }} }},
                {{ "type": "box", "box": {{ "size": [2, 0.2, 2] }} }}, {{ "type": "box", "box": {{ "size": [2, 1, 2] }} }} ] }} }} }}"#,
        nodes.join(", ")
    );
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("zones.gltf");
    std::fs::write(&path, text).unwrap();
    let scene = Scene::open(&path.to_string_lossy()).unwrap();
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    let mut simulation = Simulation::new(scene.settings).unwrap();
    let mut spawned = Spawned::of(scene);
    let mut events = Vec::new();
    for _ in 0..180 {
        simulation.step(&mut spawned.world);
        events.extend(simulation.sensor_events().map(|event| (event.sensor, event.part, event.begins)));
    }
    let [zone, pad] = ["zone", "pad"].map(|name| spawned.entity(name));
    assert_eq!(events, [(zone, 0, true), (zone, 0, false), (pad, 1, true)]);
    // The solid box of the pad holds it.
    let height = spawned.position("ball").y;
    assert!((height + 1.7).abs() < 0.01, "{height}");
}

/// Nothing that the file says is dropped without a word.
#[test]
fn what_is_not_simulated_is_named() {
    let notices = open("everything.gltf").notices.join("\n");
    for part in [
        "animations are not played, physics moves (3): nodes[3] \"dumbbell\"",
        "meshes without physics are not part of the scene (1): nodes[21] \"picture\"",
        "extensions that are not read: KHR_lights_punctual",
        "has infinite mass: gravity does not move it, other forces would, as if it had that of its shape (1): nodes[8] \"wheel\"",
        "has infinite moments of inertia: they are 100000 times its finite one (1): nodes[8] \"wheel\"",
        "a collider is an open or broken mesh; mass and inertia are those of its convex hull (1): nodes[13] \"tray\"",
        "it has the inertia of a ball of radius 0.5 m (2): nodes[15] \"bare\", nodes[22] \"bare\"",
        "has no mass: it is that of its colliders at 1000 kg/m3 (1): nodes[16] \"weightless by name only\"",
        "a collider is scaled unevenly and taken as the hull of its surface out of 24 sides (1): nodes[18] \"flattened cone\"",
        "points and lines are no surface",
    ] {
        assert!(notices.contains(part), "{part:?} is not in:\n{notices}");
    }
}

/// The chunks of a binary file hold the same as text and buffer: the same bits after the same
/// steps.
#[test]
fn text_and_binary_are_the_same_scene() {
    let text = std::fs::read_to_string(file("omi.gltf")).unwrap();
    let buffer = std::fs::read(file("tetrahedron data.bin")).unwrap();
    let mut json = text.replace(r#", "uri": "tetrahedron%20data.bin""#, "").into_bytes();
    assert!(json.len() < text.len());
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunk = |kind: &[u8], content: &[u8]| [&(content.len() as u32).to_le_bytes()[..], kind, content].concat();
    let chunks = [chunk(b"JSON", &json), chunk(b"BIN\0", &buffer)].concat();
    let header = [&b"glTF\x02\0\0\0"[..], &(chunks.len() as u32 + 12).to_le_bytes()].concat();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("omi.glb");
    std::fs::write(&path, [header, chunks].concat()).unwrap();
    let after_a_while = |scene: Scene| {
        let mut simulation = Simulation::new(scene.settings).unwrap();
        let mut spawned = Spawned::of(scene);
        simulation.step_many(&mut spawned.world, 50);
        hash(&spawned.world)
    };
    assert_eq!(after_a_while(Scene::open(&path.to_string_lossy()).unwrap()), after_a_while(open("omi.gltf")));
}

/// Where OMI differs: a type of motion instead of a flag, a kilogram by default, zero for "compute
/// it", larger default shapes, -1 for none.
#[test]
fn omi_has_its_own_defaults() {
    let scene = open("omi.gltf");
    assert_eq!(scene.body_count(), 4);
    let lift = scene.colliders().find(|(_, collider)| collider.name == "lift shape").unwrap().1;
    assert_eq!((lift.material.restitution, lift.surface.as_ref().unwrap().triangles().len()), (0.5, 4));
    let spawned = Spawned::of(scene);
    close(spawned.velocity("can")[0], [1.0, 2.0, 3.0]);
    close(spawned.velocity("lift")[0], [0.0, 0.5, 0.0]);
    assert!(spawned.world.get::<&Velocity>(spawned.entity("floor")).is_err());
    let audit = audit("omi.gltf");
    let can = body(&audit, "can");
    assert_eq!(can.mass, Some(1.0));
    let moments = DVec3::from_array(can.principal.unwrap());
    assert!((moments - DVec3::new(0.0625 + 1.0 / 3.0, 0.125, 0.0625 + 1.0 / 3.0)).length() < 1e-15, "{moments}");
}

/// The same body through glTF and through the engine's own builder: the same bits.
#[test]
fn a_body_is_the_same_as_one_made_by_hand() {
    let text = r#"{ "asset": { "version": "2.0" }, "nodes": [ { "name": "a", "translation": [1, 2, 3], "extensions": { "KHR_physics_rigid_bodies":
        { "motion": { "mass": 2, "angularVelocity": [1, 2, 3] }, "collider": { "geometry": { "shape": 0 } } } } } ],
        "extensions": { "KHR_implicit_shapes": { "shapes": [ { "type": "box", "box": { "size": [1, 2, 4] } } ] } } }"#;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.gltf");
    std::fs::write(&path, text).unwrap();
    let spawned = Spawned::of(Scene::open(&path.to_string_lossy()).unwrap());
    let mut world = World::new();
    let by_hand = RigidBody::new(Shape::cuboid([0.5, 1.0, 2.0])).without_collider().mass(2.0).id(BodyId(0));
    let vector = |v: [f32; 3]| tumble::math::Vec3::from_array(v.map(Into::into));
    let by_hand = by_hand.position(vector([1.0, 2.0, 3.0])).angular_velocity(vector([1.0, 2.0, 3.0]));
    by_hand.build().unwrap().spawn(&mut world);
    assert_eq!(hash(&spawned.world), hash(&world));
    let entity = spawned.entity("a");
    assert!(spawned.world.get::<&PrincipalAxes>(entity).is_err() && spawned.world.get::<&Mass>(entity).is_ok());
}

#[test]
fn names_are_those_of_the_file_and_none_is_there_twice() {
    let node = |name: &str| {
        format!(r#"{{ "name": "{name}", "extensions": {{ "KHR_physics_rigid_bodies": {{ "motion": {{}} }} }} }}"#)
    };
    let given = ["a", "a (node-3)", "a (node-3, 2)", "a", "", "node-4"];
    let nodes = given.map(node).join(", ");
    let text = format!(r#"{{ "asset": {{ "version": "2.0" }}, "nodes": [ {nodes} ] }}"#);
    let scene = Scene::from_gltf(text.as_bytes(), "names.gltf").unwrap();
    let names = scene.spawn(&mut World::new()).unwrap();
    let names: Vec<_> = (0..6).map(|id| names.of(id).into_owned()).collect();
    assert_eq!(names[..4], ["a", "a (node-3)", "a (node-3, 2)", "a (node-3, 3)"]);
    assert_eq!(names.iter().collect::<std::collections::HashSet<_>>().len(), 6, "{names:?}");
}

/// A kinematic body is moved by the velocity of its frame's origin, a file says that of the centre
/// of mass.
#[test]
fn a_kinematic_body_has_the_velocity_of_its_centre_of_mass() {
    let text = r#"{ "asset": { "version": "2.0" }, "nodes": [ { "name": "arm", "extensions": { "KHR_physics_rigid_bodies": { "motion":
        { "isKinematic": true, "centerOfMass": [2, 0, 0], "linearVelocity": [0, 0, 0], "angularVelocity": [0, 0, 3] } } } } ] }"#;
    let scene = Scene::from_gltf(text.as_bytes(), "arm.gltf").unwrap();
    assert!(scene.notices.iter().any(|notice| notice.starts_with("is kinematic and turns about its node's origin")));
    close(Spawned::of(scene).velocity("arm")[0], [0.0, -6.0, 0.0]);
}

/// A document of one node with this physics, and of one shape.
fn document(physics: &str, shape: &str) -> String {
    format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "nodes": [ {{}}, {{ "name": "brick", "extensions": {{ "KHR_physics_rigid_bodies": {{ {physics} }} }} }} ],
        "extensions": {{ "KHR_implicit_shapes": {{ "shapes": [ {shape} ] }} }} }}"#
    )
}

#[test]
#[allow(clippy::too_many_lines, reason = "a table of cases")]
fn a_mistake_names_file_node_and_field() {
    let sphere = r#"{ "type": "sphere" }"#;
    let in_node = |physics: &str| document(physics, sphere);
    let collider = r#""collider": { "geometry": { "shape": 0 } }"#;
    let cases = [
        (
            in_node(r#""motion": { "mass": -1 }"#),
            "nodes[1].extensions.KHR_physics_rigid_bodies.motion.mass: node \"brick\" must be positive",
        ),
        (
            in_node(r#""motion": { "inertiaDiagonal": [1, -2, 3] }"#),
            "motion.inertiaDiagonal: node \"brick\" must not be negative, as -2 is",
        ),
        (
            in_node(r#""motion": { "mass": 1, "inertiaDiagonal": [1, 1, 9] }"#),
            "nodes[1].motion.inertiaDiagonal: node \"brick\" principal moments",
        ),
        (in_node(r#""motion": { "inertiaOrientation": [0, 0, 0, 0] }"#), "motion.inertiaOrientation: node \"brick\""),
        (in_node(r#""motion": { "linearVelocity": [1e30, 0, 0] }"#), "motion.linearVelocity: node \"brick\""),
        (
            in_node(r#""motion": { "mass": "heavy" }"#),
            "field nodes[1].extensions.KHR_physics_rigid_bodies.motion.mass: invalid type",
        ),
        (
            in_node(r#""collider": { "geometry": { "shape": 7 } }"#),
            "collider.geometry.shape: node \"brick\" there is no shape 7",
        ),
        (
            in_node(r#""collider": { "geometry": { "node": 9 } }"#),
            "collider.geometry.node: node \"brick\" there is no nodes[9]",
        ),
        (in_node(r#""collider": { "geometry": {} }"#), "collider.geometry.shape: node \"brick\" is missing"),
        (
            in_node(r#""collider": { "geometry": { "shape": 0 }, "physicsMaterial": 2 }"#),
            "collider.physicsMaterial: node \"brick\" there is no physicsMaterials[2]",
        ),
        (in_node(r#""collider": { "geometry": { "node": 0 } }"#), "nodes[1].collider: node \"brick\" has no triangles"),
        (
            in_node(r#""joint": { "connectedNode": 0, "joint": 0 }"#),
            "joint.joint: node \"brick\" there is no physicsJoints[0]",
        ),
        (
            document(collider, r#"{ "type": "sphere", "sphere": { "radius": 0 } }"#),
            "sphere.radius: node \"brick\" must be a positive length",
        ),
        (document(collider, r#"{ "type": "blob" }"#), "type: node \"brick\" \"blob\" is not known"),
        (r#"{ "nodes": [] }"#.to_owned(), "field asset.version: is missing"),
        (r#"{ "asset": { "version": "1.0" } }"#.to_owned(), "field asset.version: is \"1.0\""),
        (
            r#"{ "asset": { "version": "2.0" }, "extensionsRequired": ["EXT_of_tomorrow"] }"#.to_owned(),
            "field extensionsRequired: EXT_of_tomorrow",
        ),
        (
            r#"{ "asset": { "version": "2.0" }, "nodes": [ { "children": [0] } ], "scenes": [ { "nodes": [0] } ] }"#
                .to_owned(),
            "field nodes[0].children: lead back to the node itself",
        ),
        (
            r#"{ "asset": { "version": "2.0" }, "nodes": [ { "children": [2] }, { "children": [2] }, {} ] }"#
                .to_owned(),
            "field nodes[1].children[0]: nodes[2] is a child of nodes[0] already",
        ),
        (
            r#"{ "asset": { "version": "2.0" }, "nodes": [ { "rotation": [1, 1, 1, 1] } ] }"#.to_owned(),
            "field nodes[0].rotation",
        ),
        ("{".to_owned(), "EOF"),
        (r#"{ "asset": { "version": "2.0" } } { }"#.to_owned(), "trailing characters"),
    ];
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("bad.gltf");
    for (text, part) in cases {
        std::fs::write(&path, &text).unwrap();
        let error = Scene::open(&path.to_string_lossy()).unwrap_err().to_string();
        assert!(error.starts_with(&path.to_string_lossy().into_owned()) && error.contains(part), "{text}\n{error}");
    }
}
