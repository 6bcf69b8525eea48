//! Promise: a scene's colliders, half-spaces and contact settings are what the simulation has, in
//! every format; what cannot be is refused with the body and the field; and a glTF file's colliders
//! touch wherever the engine can make them, or are named.
//!
//! Why: a collider that is read and dropped lets bodies fall through a floor that everyone sees.

use glam::DVec3;
use hecs::World;
use tumble::{BodyOrder, Collider, CombineRule, Pose, Simulation};
use tumble_import::Appearance;
use tumble_scene::{Audit, RunOverrides, Scene, SceneTemplate};

/// Where the bodies of a scene are after some steps.
fn run(scene: Scene, steps: u32) -> Vec<DVec3> {
    let mut simulation = Simulation::new(scene.settings).unwrap();
    let mut world = World::new();
    scene.spawn(&mut world).unwrap();
    simulation.step_many(&mut world, steps);
    places(&world)
}

#[allow(clippy::useless_conversion, reason = "it is f64 already in one of the two builds")]
fn places(world: &World) -> Vec<DVec3> {
    let place = |entity| DVec3::from_array(world.get::<&Pose>(entity).unwrap().position.to_array().map(f64::from));
    BodyOrder::of(world).entities().iter().map(|entity| place(*entity)).collect()
}

const BOX_ON_GROUND: &str = r#"{ "contact_substeps": 8, "restitution_threshold": 0.25, "bodies": [
    { "name": "ground", "shape": { "half_space": {} }, "fixed": true, "collider": {} },
    { "name": "box", "shape": { "cuboid": { "half_extents": [0.5, 0.25, 0.5] } }, "mass": 2, "position": [0, 1, 0],
      "collider": { "friction": 0.75, "rolling_resistance": 0.125, "restitution": 0.5, "surface_velocity": [0, 0, -2],
                    "friction_combine": "minimum", "restitution_combine": "multiply" } } ] }"#;

#[test]
fn what_a_scene_says_is_what_the_simulation_has() {
    let scene = Scene::from_json(BOX_ON_GROUND, "box.json").unwrap();
    assert_eq!((scene.settings.contact_substeps, scene.settings.restitution_threshold), (8, 0.25));
    assert_eq!(scene.appearance().unwrap()[0], Appearance::HalfSpace);
    let mut world = World::new();
    scene.clone().spawn(&mut world).unwrap();
    let order = BodyOrder::of(&world);
    let collider = world.get::<&Collider>(order.entities()[1]).unwrap();
    let material = *collider.material();
    assert_eq!((material.static_friction, material.dynamic_friction), (0.75, 0.75));
    assert_eq!((material.restitution, material.rolling_resistance), (0.5, 0.125));
    assert_eq!(material.surface_velocity.to_array(), [0.0, 0.0, -2.0]);
    assert_eq!(
        (material.friction_combine, material.restitution_combine),
        (CombineRule::Minimum, CombineRule::Multiply)
    );
    let ground = world.get::<&Collider>(order.entities()[0]).unwrap();
    assert_eq!(*ground.material(), tumble::Material::default());
    // It lies on the ground.
    let height = run(scene, 240)[1].y;
    assert!((height - 0.25).abs() < 2e-3, "{height}");
}

#[test]
fn both_formats_say_the_same() {
    let ron = r#"( contact_substeps: 8, restitution_threshold: 0.25, bodies: [
        ( name: "ground", shape: half_space(), fixed: true, collider: () ),
        ( name: "box", shape: cuboid(half_extents: (0.5, 0.25, 0.5)), mass: 2, position: (0, 1, 0),
          collider: ( friction: 0.75, rolling_resistance: 0.125, restitution: 0.5, surface_velocity: (0, 0, -2), friction_combine: minimum, restitution_combine: multiply ) ) ] )"#;
    let [json, ron] = [Scene::from_json(BOX_ON_GROUND, "a").unwrap(), Scene::from_ron(ron, "a").unwrap()];
    assert_eq!(run(json, 100), run(ron, 100));
}

/// A block on a slope of 3 in 4 holds with a friction above 0.75, and slides below: a half second
/// with 0.5 is g (0.6 - 0.5 0.8)/8 = 0.245 m along it.
#[test]
fn a_normal_tilts_the_ground() {
    let along = |friction: f64, ground: &str| {
        // The block begins as deep as it lies, so that nothing is lost on the way.
        let text = format!(
            r#"{{ "dt": 0.001, "bodies": [
                 {{ {ground}, "fixed": true, "collider": {{ "friction": {friction} }} }},
                 {{ "shape": {{ "cuboid": {{ "half_extents": [0.2, 0.2, 0.2] }} }}, "mass": 1, "position": [0.12, 0.16, 0],
                    "orientation": [0, 0, -0.316227766, 0.948683298], "collider": {{ "friction": {friction} }} }} ] }}"#
        );
        let place = run(Scene::from_json(&text, "slope.json").unwrap(), 500)[1];
        (place - DVec3::new(0.12, 0.16, 0.0)).dot(DVec3::new(0.8, -0.6, 0.0))
    };
    let normal = r#""shape": { "half_space": { "normal": [3, 4, 0] } }"#;
    assert!(along(0.8, normal).abs() < 1e-3, "{}", along(0.8, normal));
    let slid = along(0.5, normal);
    // A hundredth for the first steps, in which it sinks in.
    assert!((slid / 0.245 - 1.0).abs() < 0.02, "{slid}");
    // Turned by its orientation it is the same ground.
    let turned = r#""shape": { "half_space": {} }, "orientation": [0, 0, -0.316227766, 0.948683298]"#;
    assert!((along(0.5, turned) - slid).abs() < 1e-4, "{} {slid}", along(0.5, turned));
}

#[test]
#[allow(clippy::too_many_lines, reason = "a table of cases")]
fn what_cannot_be_is_refused_by_body_and_field() {
    let ground = r#""shape": { "half_space": {} }"#;
    let ball = r#""shape": { "sphere": { "radius": 1 } }, "mass": 1"#;
    let heights = |rows: &str, more: &str| {
        format!(r#""fixed": true, "shape": {{ "height_field": {{ "heights": {rows}{more} }} }}"#)
    };
    let cases = [
        (format!(r#"{ball}, "collider": {{ "groups": [0, 32] }}"#), "collider.groups[1]", "must be from 0 to 31, not 32"),
        (format!(r#"{ball}, "collider": {{ "touches": [-1] }}"#), "collider.touches[0]", "invalid value"),
        (heights("[[0, 1], [2, 3, 4]]", ""), "shape.height_field.heights[1]", "has 3 heights, and the first row 2"),
        (heights("[[0, 1], [2, 1e7]]", ""), "shape.height_field.heights[1][1]", "must be from -1e6 to 1e6 m, not 10000000"),
        (heights(r#"[[0, 1], [2, "3"]]"#, ""), "shape.height_field.heights[1][1]", "invalid type"),
        (heights("[[0, 1]]", ""), "shape.height_field.heights", "at least two rows"),
        (heights("[]", ""), "shape.height_field.heights", "at least two rows"),
        (heights("[[0, 1], [2, 3]]", r#", "spacing": [1, 0]"#), "shape.height_field.spacing", "rows"),
        (heights("[[0, 1], [2, 3]]", "") + r#", "mass": 1"#, "mass", "a volume"),
        (
            r#""shape": { "height_field": { "heights": [[0, 1], [2, 3]] } }"#.to_owned(),
            "shape.height_field",
            "is to be fixed or kinematic",
        ),
        (format!(r#"{ball}, "collider": {{ "friction": -1 }}"#), "collider.friction", "must be zero or positive"),
        (
            format!(r#"{ball}, "collider": {{ "restitution": 1.5 }}"#),
            "collider.restitution",
            "must be from 0 to 1, not 1.5",
        ),
        (format!(r#"{ball}, "collider": {{ "static_friction": 1e999 }}"#), "collider.static_friction", ""),
        (format!(r#"{ball}, "collider": {{ "surface_velocity": [0, 2e6, 0] }}"#), "collider.surface_velocity", "got 2000000"),
        (format!(r#"{ball}, "collider": {{ "rolling_resistance": -0.5 }}"#), "collider.rolling_resistance", "not -0.5"),
        (
            format!(r#"{ball}, "collider": {{ "friction": 1, "dynamic_friction": 1 }}"#),
            "collider.dynamic_friction",
            "friction is given too",
        ),
        (
            format!(r#"{ball}, "collider": {{ "friction_combine": "mean" }}"#),
            "collider.friction_combine",
            "unknown variant",
        ),
        // The engine has torsion from the size of the patch that touches, and no coefficient of its
        // own for it.
        (format!(r#"{ball}, "collider": {{ "spinning_friction": 0 }}"#), "collider.spinning_friction", "unknown field"),
        (r#""mass": 1, "collider": {}"#.to_owned(), "collider", "a point cannot be a collider"),
        (ground.to_owned(), "shape.half_space", "is to be fixed"),
        (format!(r#"{ground}, "kinematic": true"#), "shape.half_space", "is to be fixed"),
        (format!(r#"{ground}, "fixed": true, "density": 1"#), "density", "half_space"),
        (format!(r#"{ground}, "fixed": true, "center_of_mass": [0, 0, 0]"#), "center_of_mass", "half_space"),
        (
            r#""fixed": true, "shape": { "half_space": { "normal": [0, 0, 0] } }"#.to_owned(),
            "shape.half_space.normal",
            "has no direction",
        ),
        (
            r#""shape": { "compound": { "parts": [ { "shape": { "half_space": {} }, "mass": 1 } ] } }"#.to_owned(),
            "shape.parts[0].shape.half_space",
            "cannot be a part",
        ),
        (
            r#""shape": { "compound": { "parts": [ { "shape": { "height_field": { "heights": [] } }, "mass": 1 } ] } }"#
                .to_owned(),
            "shape.parts[0].shape.height_field",
            "cannot be a part",
        ),
    ];
    for (body, field, problem) in cases {
        let text = format!(r#"{{ "bodies": [ {{ "name": "bad", {body} }} ] }}"#);
        let error = Scene::from_json(&text, "bad.json").unwrap_err().to_string();
        let place = format!("bad.json: body \"bad\" (bodies[0]), field {field}: ");
        assert!(error.starts_with(&place) && error.contains(problem), "{body}: {error}");
    }
    for (setting, problem) in
        [("\"contact_substeps\": 0", "from 1 to 1000"), ("\"restitution_threshold\": -1", "from 0 to 1e9 m/s")]
    {
        let error = Scene::from_json(&format!("{{ {setting} }}"), "bad.json").unwrap_err().to_string();
        assert!(error.contains(problem) && error.contains(setting.split('"').nth(1).unwrap()), "{error}");
    }
}

#[test]
fn an_audit_shows_colliders_with_all_defaults() {
    let audit = Audit::from_json(BOX_ON_GROUND, "box.json").unwrap();
    assert!(!audit.has_problems());
    let json = serde_json::to_value(&audit).unwrap();
    assert_eq!(json["bodies"][0]["collider"]["static_friction"], 0.5);
    assert_eq!(json["bodies"][0]["mass"], serde_json::Value::Null);
    assert_eq!(json["bodies"][1]["collider"]["friction_combine"], "minimum");
    assert!(json["bodies"][1]["collider"].get("groups").is_none(), "what is in all groups is not listed");
    let text = r#"{ "bodies": [ { "shape": { "sphere": { "radius": 1 } }, "mass": 1, "collider": { "groups": [31, 0], "touches": [] } } ] }"#;
    let grouped = serde_json::to_value(Audit::from_json(text, "grouped.json").unwrap()).unwrap();
    let collider = &grouped["bodies"][0]["collider"];
    assert_eq!((&collider["groups"], &collider["touches"]), (&serde_json::json!([0, 31]), &serde_json::json!([])));
    let bare = Audit::from_json(r#"{ "bodies": [ { "mass": 1 } ] }"#, "bare.json").unwrap();
    assert_eq!(serde_json::to_value(&bare).unwrap()["bodies"][0].get("collider"), None);
}

/// A sensor of a scene senses and pushes nothing, as a whole or as a part of a compound, and what a
/// part does not say is as the whole has it.
#[test]
fn sensors_of_scenes_sense_and_push_nothing() {
    let ball = r#"{ "name": "ball", "shape": { "sphere": { "radius": 0.1 } }, "mass": 1, "position": [0, 2, 0], "collider": {} }"#;
    let gate = r#""name": "gate", "fixed": true"#;
    let slab = r#""shape": { "cuboid": { "half_extents": [1, 0.1, 1] } }"#;
    let part = |height: f64| format!(r#"{{ {slab}, "mass": 1, "position": [0, {height}, 0] }}"#);
    let compound = format!(r#""shape": {{ "compound": {{ "parts": [ {}, {} ] }} }}"#, part(1.0), part(-1.0));
    for (gate_shape, collider, sensed, lowest) in [
        (slab.to_owned(), r#"{ "sensor": true }"#, vec![0], -1.5),
        (compound.clone(), r#"{ "parts": [ { "sensor": true }, {} ] }"#, vec![0], -0.81),
        (compound, r#"{ "sensor": true, "parts": [ {}, { "sensor": false } ] }"#, vec![0], -0.81),
    ] {
        let text = format!(r#"{{ "bodies": [ {{ {gate}, {gate_shape}, "collider": {collider} }}, {ball} ] }}"#);
        let scene = Scene::from_json(&text, "gate.json").unwrap();
        let mut simulation = Simulation::new(scene.settings).unwrap();
        let mut world = World::new();
        scene.spawn(&mut world).unwrap();
        let mut begun = Vec::new();
        for _ in 0..55 {
            simulation.step(&mut world);
            begun.extend(simulation.sensor_events().filter(|event| event.begins).map(|event| event.part));
        }
        assert_eq!(begun, sensed, "{text}");
        let ball = BodyOrder::of(&world).entities()[1];
        let height = world.get::<&Pose>(ball).unwrap().position.y;
        assert!(if lowest < -1.0 { height < lowest } else { (height - lowest).abs() < 0.02 }, "{height} {text}");
        let audit = serde_json::to_value(Audit::from_json(&text, "gate.json").unwrap()).unwrap();
        let shown = &audit["bodies"][0]["collider"];
        assert!(shown["sensor"] == true || shown["parts"][0]["sensor"] == true, "{audit}");
        assert!(audit["bodies"][1]["collider"].get("sensor").is_none());
    }
}

/// A ball bounces as high as its restitution has it, in every world its own way.
#[test]
fn a_sweep_varies_surfaces_and_settings() {
    let text = r#"{ "dt": 0.001, "steps": 1000, "restitution_threshold": 0, "bodies": [
        { "name": "ground", "shape": { "half_space": {} }, "fixed": true,
          "collider": { "restitution_combine": "maximum" } },
        { "name": "ball", "shape": { "sphere": { "radius": 0.1 } }, "mass": 1, "position": [0, 1.1, 0],
          "collider": { "restitution_combine": "maximum" } } ] }"#;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("bounce.json");
    std::fs::write(&path, text).unwrap();
    let varied = |field: &str| {
        let template = SceneTemplate::open(path.to_str().unwrap(), RunOverrides::default()).unwrap();
        let field = template.field(field).unwrap();
        template.varied(vec![field])
    };
    let scene = varied("bodies.ball.collider.restitution");
    let heights: Vec<f64> = [0.0, 0.5, 1.0]
        .into_iter()
        .map(|restitution| {
            let mut world = scene.build(&[restitution]).unwrap();
            // It falls for 0.4515 s, and rises for as long times the restitution.
            let mut highest = f64::NEG_INFINITY;
            for step in 0..1000 {
                world.trial.step_many(1);
                if step > 500 {
                    highest = highest.max(places(&world.trial.world)[1].y - 0.1);
                }
            }
            highest
        })
        .collect();
    for (height, expected) in heights.iter().zip([0.0, 0.25, 1.0]) {
        assert!((height - expected).abs() < 0.01, "{heights:?}");
    }
    for (setting, values) in [
        ("contact_substeps", [1.0, 8.0]),
        ("restitution_threshold", [0.0, 2.0]),
        ("bodies.ground.shape.normal.0", [0.0, 1.0]),
    ] {
        let scene = varied(setting);
        let ends: Vec<_> = values
            .into_iter()
            .map(|value| {
                let mut world = scene.build(&[value]).unwrap();
                world.trial.step_many(600);
                places(&world.trial.world)[1]
            })
            .collect();
        let differ = ends[0] != ends[1];
        // Nothing bounces in this scene but with a threshold that never is met.
        assert_eq!(differ, !setting.starts_with("restitution"), "{setting}: {ends:?}");
    }
}

fn gltf(nodes: &str) -> Scene {
    let text = format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "nodes": [ {nodes} ], "extensions": {{
            "KHR_implicit_shapes": {{ "shapes": [ {{ "type": "plane" }}, {{ "type": "sphere", "sphere": {{ "radius": 0.5 }} }},
                {{ "type": "plane", "plane": {{ "sizeX": 2, "sizeZ": 2 }} }},
                {{ "type": "plane", "plane": {{ "doubleSided": true }} }} ] }},
            "KHR_physics_rigid_bodies": {{ "physicsMaterials": [ {{ "restitution": 1, "restitutionCombine": "maximum", "dynamicFriction": 0.25 }}, {{ "restitution": 1.5 }} ],
                "collisionFilters": [ {{ "collisionSystems": [ "a" ] }}, {{ "collideWithSystems": [ "a" ] }},
                    {{ "notCollideWithSystems": [ "a" ] }} ] }} }} }}"#
    );
    Scene::from_gltf(text.as_bytes(), "file.gltf").unwrap()
}

fn node(name: &str, translation: [f64; 3], physics: &str) -> String {
    format!(
        r#"{{ "name": "{name}", "translation": {translation:?}, "extensions": {{ "KHR_physics_rigid_bodies": {{ {physics} }} }} }}"#
    )
}

#[test]
fn colliders_of_gltf_touch() {
    let plane = |material: &str| {
        let collider = format!(r#""collider": {{ "geometry": {{ "shape": 0 }} {material} }}"#);
        node("floor", [0.0, 1.0, 0.0], &collider)
    };
    let ball = |material: &str| {
        let collider =
            format!(r#""motion": {{ "mass": 2 }}, "collider": {{ "geometry": {{ "shape": 1 }} {material} }}"#);
        node("ball", [0.0, 3.0, 0.0], &collider)
    };
    let dull = gltf(&format!("{}, {}", plane(""), ball("")));
    assert_eq!(dull.appearance().unwrap()[0], Appearance::HalfSpace);
    assert!(dull.notices.is_empty(), "{:?}", dull.notices);
    let height = run(dull, 240)[1].y;
    assert!((height - 1.5).abs() < 2e-3, "{height}");
    // It falls for 0.553 s, and is near where it began after twice that.
    let [plane, ball] = [plane(r#", "physicsMaterial": 0"#), ball(r#", "physicsMaterial": 0"#)];
    let bouncing = gltf(&format!("{plane}, {ball}"));
    let mut world = World::new();
    bouncing.clone().spawn(&mut world).unwrap();
    let collider = *world.get::<&Collider>(BodyOrder::of(&world).entities()[1]).unwrap().material();
    assert_eq!((collider.static_friction, collider.dynamic_friction, collider.restitution), (0.6, 0.25, 1.0));
    let height = run(bouncing, 66)[1].y;
    assert!((height - 3.0).abs() < 0.2, "{height}");
}

/// A plane with an end, moved up by its node, holds a ball that falls on it, and one that falls
/// beside it falls on.
#[test]
fn a_plane_with_an_end_ends() {
    let plate = node("plate", [0.0, 1.0, 0.0], r#""collider": { "geometry": { "shape": 2 } }"#);
    let ball = |name: &str, x: f64| {
        node(name, [x, 2.0, 0.0], r#""motion": { "mass": 2 }, "collider": { "geometry": { "shape": 1 } }"#)
    };
    let scene = gltf(&format!("{plate}, {}, {}", ball("on", 0.25), ball("off", 2.5)));
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    let places = run(scene, 180);
    assert!((places[1].y - 1.5).abs() < 2e-3, "{places:?}");
    assert!(places[2].y < -10.0, "{places:?}");
}

/// Filter 0 is of system a, filter 1 collides with a only, filter 2 with all but a.
#[test]
fn filters_decide_who_touches() {
    let floor =
        |filter: &str| node("floor", [0.0; 3], &format!(r#""collider": {{ "geometry": {{ "shape": 0 }} {filter} }}"#));
    let ball = |filter: &str| {
        let collider = format!(r#""motion": {{ "mass": 2 }}, "collider": {{ "geometry": {{ "shape": 1 }} {filter} }}"#);
        node("ball", [0.0, 1.0, 0.0], &collider)
    };
    let of = |index: &str| if index.is_empty() { String::new() } else { format!(r#", "collisionFilter": {index}"#) };
    for (floor_of, ball_of, is_held) in [
        ("", "", true),
        ("0", "", true),
        ("0", "1", true),
        ("", "1", false),
        ("1", "0", true),
        ("0", "2", false),
        ("", "2", true),
        ("2", "1", false),
    ] {
        let scene = gltf(&format!("{}, {}", floor(&of(floor_of)), ball(&of(ball_of))));
        assert!(scene.notices.is_empty(), "{:?}", scene.notices);
        let height = run(scene, 120)[1].y;
        assert_eq!(height > 0.0, is_held, "floor of {floor_of:?}, ball of {ball_of:?}: {height}");
    }
}

#[test]
fn what_gltf_has_and_contacts_have_not_is_named() {
    let plane = node("tray", [0.0; 3], r#""motion": {}, "collider": { "geometry": { "shape": 2 } }"#);
    let two_sided = node("both", [0.0; 3], r#""collider": { "geometry": { "shape": 3 } }"#);
    let bouncy = node(
        "rubber",
        [0.0, 5.0, 0.0],
        r#""motion": {}, "collider": { "geometry": { "shape": 1 }, "physicsMaterial": 1 }"#,
    );
    let notices = gltf(&format!("{plane}, {two_sided}, {bouncy}")).notices.join("\n");
    for part in [
        "has a plane that touches nothing: it is neither ground nor the only collider of a fixed body (1): nodes[0] \"tray\"",
        "has a plane of two sides, of which one touches (1): nodes[1] \"both\"",
        "has a restitution of more than 1, taken for 1 (1): nodes[2] \"rubber\"",
    ] {
        assert!(notices.contains(part), "{part:?} is not in:\n{notices}");
    }
}

/// A bowl is hollow where it stands, and solid where it moves.
#[test]
fn a_mesh_that_stands_still_is_touched_as_it_is() {
    // A block of two metres with a pit of one metre and a half in its top: a wall of 16 corners,
    // counter-clockwise from outside.
    let mut vertices = String::new();
    for (half, height) in [(1.0, -1.0), (1.0, 1.0), (0.75, 1.0), (0.75, -0.5)] {
        for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)] {
            vertices += &format!("v {} {height} {}\n", half * x, half * z);
        }
    }
    let mut faces = String::from("f 4 3 2 1\nf 13 14 15 16\n");
    for ring in 0..3 {
        for corner in 0..4 {
            let (a, b) = (4 * ring + corner + 1, 4 * ring + (corner + 1) % 4 + 1);
            faces += &format!("f {a} {b} {} {}\n", b + 4, a + 4);
        }
    }
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("pit.obj"), vertices + &faces).unwrap();
    let height = |pit: &str| {
        let text = format!(
            r#"{{ "bodies": [ {{ "shape": {{ "mesh": {{ "file": "pit.obj" }} }}, {pit}, "collider": {{}} }},
                 {{ "shape": {{ "sphere": {{ "radius": 0.25 }} }}, "mass": 1, "position": [0.1, 2, 0.05], "collider": {{}} }},
                 {{ "shape": {{ "half_space": {{}} }}, "fixed": true, "position": [0, -1, 0], "collider": {{}} }} ] }}"#
        );
        let path = directory.path().join("scene.json");
        std::fs::write(&path, text).unwrap();
        run(Scene::load(&path).unwrap(), 240)[1].y
    };
    // On the pit's floor, at -0.5, or on the lid that its hull has at 1.
    assert!((height(r#""fixed": true"#) + 0.25).abs() < 2e-3, "{}", height(r#""fixed": true"#));
    assert!((height(r#""mass": 1000"#) - 1.25).abs() < 5e-3, "{}", height(r#""mass": 1000"#));
}
