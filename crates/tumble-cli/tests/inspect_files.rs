//! `tumble inspect` of robots and meshes, and the pictures it draws.
//!
//! It is what one reaches for when a robot explodes or a part weighs nothing. It would fail if a
//! bad link hid the others, if a mesh with a hole had a mass, or if a picture were not well-formed.

use crate::support::{Place, stderr};

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

const ROBOT: &str = r#"<robot name="two">
  <link name="base"><inertial><mass value="2"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial>
    <collision><geometry><cylinder radius="0.1" length="0.3"/></geometry></collision></link>
  <link name="&lt;tip&gt;"><inertial><mass value="0"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="wrist" type="revolute"><parent link="base"/><child link="&lt;tip&gt;"/></joint>
</robot>"#;

fn json(place: &Place, arguments: &[&str], code: i32) -> serde_json::Value {
    let output = place.run(&[&["inspect", "--json"], arguments].concat());
    assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_robot_is_listed_link_by_link_and_refused_as_a_scene() {
    let place = Place::new();
    place.write("two.urdf", ROBOT);
    let audit = json(&place, &["two.urdf"], 2);
    let bodies = audit["bodies"].as_array().unwrap();
    assert_eq!((bodies.len(), &bodies[0]["mass"], &bodies[0]["problems"]), (2, &2.0.into(), &serde_json::json!([])));
    let problem = "inertial.mass.value: must be positive and finite, not 0, at line 4";
    assert_eq!(bodies[1]["problems"], serde_json::json!([problem]));
    assert_eq!(audit["notices"], serde_json::json!(["1 revolute joint without limit, taken for continuous: wrist"]));
    assert!(audit.get("joints").is_none());
    let output = place.run(&["inspect", "two.urdf"]);
    assert!(stderr(&output).contains("tumble: note: 1 revolute joint without limit"), "{}", stderr(&output));
    let refused = place.run(&["run", "two.urdf"]);
    assert_eq!(refused.status.code(), Some(2));
    let expected = format!("tumble: two.urdf: link \"<tip>\", field {problem}\n");
    assert_eq!(stderr(&refused), expected);
    place.write("good.urdf", ROBOT.replace("value=\"0\"", "value=\"1\""));
    let report = place.succeed(&["run", "good.urdf", "--steps", "10"]);
    assert!(report.contains("bodies                 2"), "{report}");
    assert!(json(&place, &["two.urdf", "--body", "base"], 0)["bodies"].as_array().unwrap().len() == 1);
}

/// Joints are listed with their limits and drives, and with a body those of the body.
#[test]
fn joints_are_listed() {
    let place = Place::new();
    let inside = r#"<axis xyz="0 1 0"/><limit lower="-0.5" upper="2" effort="10" velocity="3"/><dynamics damping="0.25" friction="0.5"/>"#;
    let robot = ROBOT
        .replace("value=\"0\"", "value=\"1\"")
        .replace("type=\"revolute\">", &format!("type=\"revolute\">{inside}"));
    place.write("arm.urdf", &robot);
    let wrist = json(&place, &["arm.urdf"], 0)["joints"][0].clone();
    let expected = serde_json::json!({
        "name": "wrist", "kind": "hinge", "between": ["base", "<tip>"], "free": ["angular_x"],
        "limits": [ { "of": "angular_x", "min": -0.5, "max": 2.0 } ],
        "drives": [ { "of": ["angular_x"], "velocity": 0.0, "gain": { "mode": "force", "stiffness": 0.0, "damping": 0.25 } } ],
        "friction": [ { "of": "angular_x", "max": 0.5 } ],
        "max_effort": 10.0, "max_speed": 3.0, "contacts": false,
    });
    assert_eq!(wrist, expected);
    let text = place.succeed(&["inspect", "arm.urdf"]);
    for line in [
        "wrist\n  joint                  hinge\n  between                base, <tip>\n  free                   angular_x\n",
        "  limit                  {\"of\":\"angular_x\",\"min\":-0.5,\"max\":2.0}\n",
        "  friction               {\"of\":\"angular_x\",\"max\":0.5}\n",
        "  max effort [N] [N m]   10\n",
    ] {
        assert!(text.contains(line), "{text}");
    }
    assert_eq!(json(&place, &["arm.urdf", "--body", "base"], 0)["joints"].as_array().unwrap().len(), 1);
}

#[test]
fn a_mesh_has_volume_counts_and_the_mass_of_a_density() {
    let place = Place::new();
    place.write("part.obj", TETRAHEDRON);
    let audit = json(&place, &["part.obj", "--density", "600"], 0);
    let body = &audit["bodies"][0];
    // Volume 1/6, centre 1/4, moments about it m (3/40, 3/40) and others; a few roundings.
    let close = |value: &serde_json::Value, expected: f64| assert!((value.as_f64().unwrap() - expected).abs() < 1e-13);
    close(&body["mass"], 100.0);
    close(&body["volume"], 1.0 / 6.0);
    close(&body["center_of_mass"][2], 0.25);
    close(&body["tensor"][0][0], 7.5);
    close(&body["tensor"][0][1], 1.25);
    assert_eq!(
        (&body["name"], &body["mesh"]["triangles"], &body["mesh"]["open_edges"]),
        (&"part".into(), &4.into(), &0.into())
    );
    let text = place.succeed(&["inspect", "part.obj"]);
    assert!(text.contains("triangles              4\n") && !text.contains("open edges"), "{text}");
}

#[test]
fn defects_are_counted_and_repairs_asked_for() {
    let place = Place::new();
    place.write("open.obj", TETRAHEDRON.trim_end_matches("f 2 3 4\n"));
    let body = &json(&place, &["open.obj", "--repair"], 2)["bodies"][0];
    assert_eq!(body["problems"], serde_json::json!(["mesh: 3 open edges (cannot be repaired)"]));
    assert_eq!((&body["mass"], &body["mesh"]["open_edges"]), (&serde_json::Value::Null, &3.into()));
    place.write("turned.obj", TETRAHEDRON.replace("f 2 3 4", "f 2 4 3"));
    let body = &json(&place, &["turned.obj"], 2)["bodies"][0];
    assert_eq!(
        body["problems"],
        serde_json::json!(["mesh: 3 edges between triangles wound oppositely (can be repaired)"])
    );
    let audit = json(&place, &["turned.obj", "--repair"], 0);
    assert_eq!(
        audit["notices"],
        serde_json::json!(["repaired: triangles turned round until they agreed across 3 edges"])
    );
    assert!((audit["bodies"][0]["mass"].as_f64().unwrap() - 1.0 / 6.0).abs() < 1e-16);
}

#[test]
fn options_that_do_not_fit_are_refused() {
    let place = Place::new();
    place.write("part.obj", TETRAHEDRON);
    for (arguments, expected) in [
        (&["iss", "--density", "2"][..], "--density goes with a mesh only, not with \"iss\""),
        (&["iss", "--repair"], "--repair goes with a mesh, or a .gltf, .glb or .urdf file, not with \"iss\""),
        (&["part.obj", "--density", "-2"], "must be positive and finite"),
        (&["part.obj", "--body", "other"], "part.obj: no body is called \"other\""),
        (&["part.obj", "--draw", "no/where.svg"], "no/where.svg: cannot be written"),
    ] {
        let output = place.run(&[&["inspect"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}

/// A picture is well-formed whatever the names are, has each thing that it is to show, and nothing
/// of it is outside.
#[test]
fn portraits() {
    let place = Place::new();
    place.write("two.urdf", ROBOT);
    place.write("part.obj", TETRAHEDRON);
    let draw = |arguments: &[&str], code: i32| {
        let output = place.run(&[&["inspect", "--draw", "drawing.svg"], arguments].concat());
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        std::fs::read_to_string(place.path("drawing.svg")).unwrap()
    };
    let texts = |svg: &str| {
        let document = roxmltree::Document::parse(svg).unwrap();
        for node in document.descendants().filter(|node| node.has_tag_name("path")) {
            let numbers = node.attribute("d").unwrap().split(|c: char| "MLZzHVvha ".contains(c));
            for number in numbers.filter(|word| !word.is_empty()).map(|word| word.parse::<f64>().unwrap()) {
                assert!((-6.0..=800.0).contains(&number), "{number}");
            }
        }
        let texts = document.descendants().filter(|node| node.has_tag_name("text"));
        texts.map(|node| node.text().unwrap_or_default().to_owned()).collect::<Vec<_>>()
    };
    let link = draw(&["two.urdf", "--body", "base"], 0);
    let said = texts(&link);
    for expected in [
        "base",
        "2.000 kg",
        "0, 0, 0 m",
        "1: 0.02000 kg m\u{b2}",
        "3: 0.04000 kg m\u{b2}",
        "ellipsoid with this mass",
        "0.1 m",
    ] {
        assert!(said.iter().any(|text| text == expected), "{expected}: {said:?}");
    }
    for class in ["ellipsoid", "axis a0", "axis a1", "axis a2", "center"] {
        assert!(link.contains(&format!("class=\"{class}\"")), "{class}");
    }
    // A cylinder of 32 sides: two triangles each, and the ends.
    assert!(link.matches("class=\"s").count() > 64);
    let bad = texts(&draw(&["two.urdf", "--body", "<tip>"], 2));
    assert!(bad.contains(&"<tip>".to_owned()) && bad.contains(&"problem".to_owned()), "{bad:?}");
    assert!(texts(&draw(&["part.obj"], 0)).contains(&"volume".to_owned()));
    for name in tumble_scene::builtin_names().filter(|name| *name != "stress") {
        texts(&draw(&[name], 0));
    }
    // Of a great many parts there is a remark instead of a surface.
    let part = r#"{ "shape": { "sphere": { "radius": 1 } }, "mass": 1 }"#;
    let parts = vec![part; 500].join(",");
    place.write(
        "many.json",
        format!(r#"{{ "bodies": [ {{ "shape": {{ "compound": {{ "parts": [ {parts} ] }} }} }} ] }}"#),
    );
    assert!(texts(&draw(&["many.json"], 0)).contains(&"more than 400 parts, not drawn".to_owned()));
}

/// The moments of a wheel in a published sample; the other body is sound.
#[test]
fn an_impossible_body_is_left_out_by_name_and_repaired_when_asked() {
    let place = Place::new();
    let node = |name: &str, moments: &str| {
        let motion = format!(r#"{{ "motion": {{ "mass": 1, "inertiaDiagonal": {moments} }} }}"#);
        format!(r#"{{ "name": "{name}", "extensions": {{ "KHR_physics_rigid_bodies": {motion} }} }}"#)
    };
    let (wheel, crate_) = (node("wheel", "[0.4, 0.1, 0.1]"), node("crate", "[1, 1, 1]"));
    place.write("two.gltf", format!(r#"{{ "asset": {{ "version": "2.0" }}, "nodes": [ {wheel}, {crate_} ] }}"#));
    for quiet in [&[][..], &["--quiet"]] {
        let output = place.run(&[&["run", "two.gltf", "--steps", "1", "--record", "two.csv"], quiet].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stderr(&output).contains("left out") && stderr(&output).contains("\"wheel\""), "{}", stderr(&output));
        assert!(stderr(&output).contains("--repair"), "{}", stderr(&output));
        assert!(place.record("two.csv").iter().all(|row| &row[2] == "crate"));
    }
    let output = place.run(&["run", "two.gltf", "--steps", "1", "--repair", "--record", "two.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let told = "\"wheel\"";
    assert!(stderr(&output).contains("repaired") && stderr(&output).contains(told), "{}", stderr(&output));
    assert_eq!(place.record("two.csv").len(), 4);
    let bodies = json(&place, &["two.gltf"], 2)["bodies"].clone();
    assert!(bodies[0]["problems"][0].as_str().unwrap().contains("--repair") && bodies[1]["mass"] == 1.0);
    let bodies = json(&place, &["two.gltf", "--repair"], 0)["bodies"].clone();
    // A third of the excess of 0.2 from the largest to each of the others, in the roundings of the
    // build's precision.
    let moment = |index: usize| bodies[0]["tensor"][index][index].as_f64().unwrap();
    assert!((moment(0) - 1.0 / 3.0).abs() < 1e-6 && (moment(1) - 1.0 / 6.0).abs() < 1e-6, "{bodies}");
    place.refused(&["run", "iss", "--repair"], "--repair goes with");
}
