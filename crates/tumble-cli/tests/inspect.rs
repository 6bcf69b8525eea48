//! `tumble inspect` shows the mass properties and forces of every body, the impossible ones with
//! their problems.
//!
//! It is the tool to find out why a scene is refused. It would fail if it stopped at the first bad
//! body, or if a key of its JSON changed.

use crate::support::{Place, stderr};

fn json(place: &Place, scene: &str, code: i32) -> serde_json::Value {
    let output = place.run(&["inspect", scene, "--json"]);
    assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn json_has_exactly_the_keys_and_the_figures() {
    let place = Place::new();
    let scene =
        r#"{ "bodies": [ { "name": "cone", "shape": { "cone": { "radius": 1, "half_height": 2 } }, "mass": 3 } ] }"#;
    place.write("scene.json", scene);
    let text = place.succeed(&["inspect", "scene.json", "--json"]);
    let order = [
        "\"bodies\"",
        "\"name\"",
        "\"mass\"",
        "\"center_of_mass\"",
        "\"tensor\"",
        "\"principal\"",
        "\"axes\"",
        "\"forces\"",
        "\"problems\"",
    ];
    let places: Vec<usize> = order.iter().map(|key| text.find(key).unwrap()).collect();
    assert!(places.is_sorted(), "{text}");
    let bodies = json(&place, "scene.json", 0);
    assert_eq!(bodies.as_object().unwrap().len(), 1);
    let body = &bodies["bodies"][0];
    assert_eq!(body.as_object().unwrap().len(), 8);
    assert_eq!(body["mass"], 3.0);
    assert_eq!(body["center_of_mass"], serde_json::json!([0.0, -1.0, 0.0]));
    assert_eq!(body["axes"], serde_json::json!([0.0, 0.0, 0.0, 1.0]));
    assert_eq!((&body["forces"], &body["problems"]), (&serde_json::json!([]), &serde_json::json!([])));
    // 3/20 m (r^2 + h^2) across and 3/10 m r^2 along the axis, h the half height; a few roundings.
    for (index, moment) in [2.25, 0.9, 2.25].into_iter().enumerate() {
        assert!((body["tensor"][index][index].as_f64().unwrap() - moment).abs() < 1e-14);
        assert!((body["principal"][index].as_f64().unwrap() - moment).abs() < 1e-14);
    }
}

#[test]
fn impossible_bodies_are_listed_with_their_problems() {
    let place = Place::new();
    let scene = r#"{ "bodies": [
        { "name": "good", "mass": 1 },
        { "name": "bad", "mass": -1, "orientation": [0, 0, 0, 2], "inertia": { "principal": [1, 1, 3] } },
        { "name": "good", "mass": 2 },
        { "name": "floor", "fixed": true } ] }"#;
    place.write("scene.json", scene);
    let bodies = json(&place, "scene.json", 2);
    let problems = |index: usize| bodies["bodies"][index]["problems"].as_array().unwrap().clone();
    assert_eq!(bodies["bodies"].as_array().unwrap().len(), 4);
    assert!(problems(0).is_empty() && problems(3).is_empty());
    let fields: Vec<String> =
        problems(1).iter().map(|problem| problem.as_str().unwrap().split(':').next().unwrap().to_owned()).collect();
    assert_eq!(fields, ["mass", "inertia.principal", "orientation"]);
    assert!(problems(2)[0].as_str().unwrap().starts_with("name: "));
    assert_eq!(bodies["bodies"][1]["mass"], serde_json::Value::Null);
    assert_eq!(bodies["bodies"][3]["mass"], serde_json::Value::Null);
    assert!(stderr(&place.run(&["inspect", "scene.json"])).contains("2 of 4 bodies have problems"));
}

#[test]
fn a_file_that_is_no_scene_is_refused_as_in_run() {
    let place = Place::new();
    place.write("scene.json", r#"{ "bodies": [ { "name": "a", "mas": 1 } ] }"#);
    let output = place.run(&["inspect", "scene.json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    assert!(stderr(&output).starts_with("tumble: scene.json: body \"a\" (bodies[0]), field mas: "));
}

#[test]
fn people_get_a_paragraph_a_body() {
    let text = Place::new().succeed(&["inspect", "t-handle"]);
    assert!(text.starts_with("t-handle\n  mass [kg]              0.0266407"), "{text}");
    for label in ["centre of mass [m]", "tensor [kg m2]", "principal [kg m2]", "axes x y z w"] {
        assert!(text.contains(label), "{text}");
    }
}

#[test]
fn forces_are_listed_with_all_their_numbers() {
    let place = Place::new();
    let scene = r#"{ "bodies": [
        { "name": "boat", "shape": { "sphere": { "radius": 2 } }, "mass": 3, "gravity_scale": 2, "forces": [
            { "buoyancy": {} }, { "spring": { "to": "quay", "stiffness": 10 } }, { "drag": { "angular": 0.5 } } ] },
        { "name": "quay", "fixed": true, "position": [0, 3, 4] } ] }"#;
    place.write("scene.json", scene);
    let forces = serde_json::json!([
        { "gravity_scale": 2.0 },
        { "buoyancy": { "density": 1000.0, "level": 0.0, "hull": { "sphere": { "radius": 2.0 } }, "center": [0.0, 0.0, 0.0] } },
        { "spring": { "to": "quay", "attachment": [0.0, 0.0, 0.0], "attachment_to": [0.0, 0.0, 0.0], "rest_length": 5.0,
                      "stiffness": 10.0, "damping": 0.0 } },
        { "drag": { "linear": [0.0, 0.0, 0.0], "angular": [0.5, 0.5, 0.5] } },
    ]);
    let bodies = json(&place, "scene.json", 0);
    assert_eq!(bodies["bodies"][0]["forces"], forces);
    assert_eq!(bodies["bodies"][1]["forces"], serde_json::json!([]));
    let text = place.succeed(&["inspect", "scene.json"]);
    let drag = r#"  force                  {"drag":{"linear":[0.0,0.0,0.0],"angular":[0.5,0.5,0.5]}}"#;
    assert!(text.lines().any(|line| line == drag), "{text}");
}

/// What is listed of a compound's parts makes the same collider again, and people see a line for
/// each.
#[test]
fn parts_of_a_collider_are_listed_with_their_surfaces() {
    let place = Place::new();
    let ways = ["average", "minimum", "maximum", "multiply"];
    let scene = |collider: &serde_json::Value| {
        let part =
            |x: f64| serde_json::json!({ "shape": { "sphere": { "radius": 0.5 } }, "mass": 1, "position": [x, 0, 0] });
        let shape = serde_json::json!({ "compound": { "parts": [part(0.0), part(1.0), part(2.0)] } });
        serde_json::json!({ "bodies": [ { "name": "a", "shape": shape, "collider": collider } ] }).to_string()
    };
    let listed = |collider: &serde_json::Value| {
        place.write("scene.json", scene(collider));
        json(&place, "scene.json", 0)["bodies"][0]["collider"].clone()
    };
    for (i, way) in ways.iter().enumerate() {
        // Eighths and quarters are written as they are in either precision.
        let part = |k: usize| {
            serde_json::json!({
                "static_friction": 0.5 + 0.125 * (i + k) as f64, "dynamic_friction": 0.25, "restitution": 0.125 * k as f64,
                "rolling_resistance": 0.25 * i as f64, "friction_combine": way, "restitution_combine": ways[k],
                "groups": [i, k + 4], "touches": [k],
            })
        };
        let parts = [part(0), part(1), part(2)];
        let found = listed(&serde_json::json!({ "friction": 0.75, "parts": parts }));
        assert_eq!(found["parts"], serde_json::json!(parts));
        assert_eq!(listed(&found), found, "what is listed is not what a scene could have said");
        let text = place.succeed(&["inspect", "scene.json"]);
        let lines: Vec<_> = text.lines().filter(|line| line.trim_start().starts_with("collider part ")).collect();
        assert_eq!(lines.len(), 3, "{text}");
        assert!(lines[2].contains(&format!("\"static_friction\":{}", 0.75 + 0.125 * i as f64)), "{text}");
    }
    let plain = listed(&serde_json::json!({ "friction": 0.75 }));
    assert_eq!(plain.get("parts"), None);
}

#[test]
fn every_built_in_can_be_inspected() {
    let place = Place::new();
    for name in tumble_scene::builtin_names() {
        assert!(!place.succeed(&["inspect", name]).is_empty());
    }
}
