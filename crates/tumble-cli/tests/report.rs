//! `--report` writes a page that needs nothing else, beside the files that were there before.
//!
//! People open it, mail it and keep it. It would fail if it loaded anything, if a name in a scene
//! file could run as a script, if a large run made it too large to open, or if it did not say what
//! it leaves out.

use std::collections::BTreeSet;

use crate::support::Place;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use tumble::Pose;
use tumble::math::{Quat, Real, Vec3};

const ATTACK: &str = "</script><img src=x onerror=alert(1)>";

fn page(place: &Place, arguments: &[&str]) -> String {
    place.succeed(&[&["run"], arguments, &["--quiet", "--report", "report"]].concat());
    place.read("report/report.html")
}

/// What the script is given.
fn data(page: &str) -> serde_json::Value {
    let (_, data) = page.split_once("<script type=\"application/json\" id=\"run\">").unwrap();
    serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap()
}

fn list<'a>(data: &'a serde_json::Value, key: &str) -> &'a [serde_json::Value] {
    data[key].as_array().unwrap()
}

#[test]
fn the_page_is_whole_and_stands_beside_the_other_files() {
    let place = Place::new();
    let page = page(&place, &["t-handle"]);
    let mut files: Vec<String> = std::fs::read_dir(place.path("report"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    assert_eq!(files, ["drift.svg", "energy.svg", "ledger.csv", "report.html", "summary.json"]);
    // Both plots, which are those of the files but for the name that SVG has outside of HTML, and
    // again for narrow screens.
    for plot in ["energy.svg", "drift.svg"] {
        let svg = place.read(&format!("report/{plot}"));
        assert!(page.contains(&svg.replace(" xmlns=\"http://www.w3.org/2000/svg\"", "")), "{plot}");
    }
    assert_eq!((page.matches("class=\"plot wide\"").count(), page.matches("class=\"plot narrow\"").count()), (2, 2));
    let summary = place.summary();
    assert!(page.contains(summary["state_hash"].as_str().unwrap()));
    for phase in ["accumulate_forces", "integrate", "update_derived"] {
        assert!(page.contains(&format!("<th scope=\"row\">{phase}</th>")), "{phase}");
    }
    assert!(!page.contains("<!--slot:"), "a slot was left");
}

#[test]
fn nothing_is_loaded_from_elsewhere() {
    let place = Place::new();
    let page = page(&place, &["t-handle"]);
    for elsewhere in ["http:", "https:", "url(", "@import", "import(", " src=", "fetch("] {
        assert!(!page.contains(elsewhere), "{elsewhere}");
    }
    assert!(page.contains("default-src 'none'"));
}

#[test]
fn texts_of_a_scene_stay_texts() {
    let place = Place::new();
    let body = serde_json::json!({ "name": ATTACK, "mass": 1 });
    let scene =
        serde_json::json!({ "name": format!("{ATTACK}<!--slot:data-->"), "description": ATTACK, "bodies": [body] });
    place.write("scene.json", scene.to_string());
    let page = page(&place, &["scene.json", "--steps", "3"]);
    assert!(!page.contains("<img"));
    assert_eq!(page.matches("</script>").count(), 2, "one for the data, one for the script");
    assert_eq!(list(&data(&page), "bodies")[0]["name"], ATTACK);
    assert!(page.contains("<title>&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;&lt;!--slot:data--&gt;</title>"));
}

#[test]
fn what_is_left_out_is_said() {
    let place = Place::new();
    let page = page(&place, &["stress", "--bodies", "12000", "--steps", "100"]);
    assert!(page.len() < 14_000_000, "{} bytes", page.len());
    let data = data(&page);
    assert_eq!(list(&data, "bodies").len(), 10_000);
    let times = list(&data, "times");
    // Four of the nine mebibytes go to the capsules, each a mesh of its own. At fourteen bytes a
    // body there is room for 37 frames, which is each fourth of 100 steps, and the first.
    assert_eq!(times.len(), 26);
    assert_eq!(times[0], 0.0);
    // A hundred steps of 1/60 s in f32.
    assert!((times.last().unwrap().as_f64().unwrap() - 100.0 / 60.0).abs() < 1e-5, "{:?}", times.last());
    let said = "10\u{202f}000 of the 12\u{202f}000 bodies are shown";
    assert_eq!(page.matches(said).count(), 2, "on the page and in the comment");
    assert!(page.contains("26 frames of 100 steps are kept, one every 4 steps"));
}

/// A pyramid has no holes: its 2871 bodies are all there, with positions in 16 bits of the way of
/// each, which are those of the record to half of a part.
#[test]
fn many_bodies_are_shown_whole() {
    let place = Place::new();
    let page = page(&place, &["pyramid", "--steps", "40", "--record", "pyramid.csv"]);
    let data = data(&page);
    let (bodies, times) = (list(&data, "bodies").len(), list(&data, "times").len());
    assert_eq!((bodies, times), (2871, 41));
    assert!(page.contains("All bodies are shown."));
    let bytes = |key: &str| BASE64.decode(data[key].as_str().unwrap()).unwrap();
    let parts: Vec<f64> =
        bytes("positions").chunks_exact(2).map(|it| f64::from(u16::from_le_bytes([it[0], it[1]]))).collect();
    let ways: Vec<f64> =
        bytes("ways").chunks_exact(4).map(|it| f64::from(f32::from_le_bytes([it[0], it[1], it[2], it[3]]))).collect();
    assert_eq!((parts.len(), ways.len()), (3 * bodies * times, 6 * bodies));
    let record = place.read("pyramid.csv");
    let mut lines = record.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = ["px", "py", "pz"].map(|name| columns.iter().position(|it| *it == name).unwrap());
    let mut checked = 0;
    for (row, line) in lines.enumerate() {
        let numbers: Vec<&str> = line.split(',').collect();
        let body = row % bodies;
        for (axis, column) in column.into_iter().enumerate() {
            let [low, size] = [ways[6 * body + axis], ways[6 * body + 3 + axis]];
            let shown = low + parts[3 * row + axis] / 65535.0 * size;
            let recorded: f64 = numbers[column].parse().unwrap();
            // And a rounding of positions of metres in single precision.
            assert!((shown - recorded).abs() <= 0.51 * size / 65535.0 + 2e-6, "row {row}: {shown} and {recorded}");
        }
        checked += 1;
    }
    assert_eq!(checked, bodies * times);
}

#[test]
fn a_small_run_is_shown_whole() {
    let place = Place::new();
    let page = page(&place, &["t-handle", "--steps", "101"]);
    let data = data(&page);
    assert_eq!((list(&data, "bodies").len(), list(&data, "times").len()), (1, 102));
    assert!(page.contains("All bodies are shown. Every step is a frame, 102 with the start."));
}

/// The last state is there, whatever the frames' turns.
#[test]
fn a_long_run_keeps_its_end() {
    let place = Place::new();
    let page = page(&place, &["t-handle", "--steps", "5003", "--dt", "0.01"]);
    let data = data(&page);
    let times: Vec<f64> = list(&data, "times").iter().map(|time| time.as_f64().unwrap()).collect();
    // Of 5004 states every eighth is 626, and the end.
    assert_eq!(times.len(), 627);
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
    // Rounding of 0.01 in f32, 5003 times.
    assert!((times[626] - 50.03).abs() < 1e-5, "{}", times[626]);
    let bytes = |key: &str| data[key].as_str().unwrap().len() / 4 * 3;
    assert!(bytes("positions").abs_diff(627 * 12) < 3 && bytes("rotations").abs_diff(627 * 8) < 3);
}

#[test]
fn a_run_of_nothing_has_a_page() {
    let place = Place::new();
    place.write("empty.json", "{}");
    let page = page(&place, &["empty.json", "--steps", "5"]);
    assert!(list(&data(&page), "bodies").is_empty());
    assert!(!page.contains("NaN") && !page.contains("inf "));
}

#[test]
fn notices_of_the_scene_are_on_the_page() {
    let place = Place::new();
    let link =
        r#"<inertial><mass value="2"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial>"#;
    let robot = format!(
        r#"<robot name="arm"><link name="base">{link}</link><link name="tip">{link}</link>
           <joint name="elbow &lt;b&gt;" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/></joint></robot>"#
    );
    place.write("arm.urdf", robot);
    let page = page(&place, &["arm.urdf", "--steps", "2"]);
    let (_, notes) = page.split_once("<h2>Notes on the scene</h2>").unwrap();
    assert!(notes.contains("elbow &lt;b&gt;"), "{notes}");
    // Robots stand upright along z.
    assert_eq!(data(&page)["up"], serde_json::json!([0, 0, 1]));
}

/// Scenes of bodies that touch are run, recorded and reported like the others, with the time that
/// contacts took and the work that they did.
#[test]
fn scenes_of_contacts_are_reported() {
    for scene in ["pyramid", "wall", "pile", "dominoes", "cradle", "drum", "hills", "bowling", "spheres"] {
        let place = Place::new();
        let fewer: &[&str] = if ["cradle", "bowling"].contains(&scene) { &[] } else { &["--bodies", "30"] };
        let run = [&[scene, "--steps", "40"], fewer].concat();
        let page = page(&place, &run);
        assert!(page.contains("<th scope=\"row\">contacts</th>"), "{scene}");
        assert!(place.read("report/ledger.csv").lines().next().unwrap().contains(",work_contacts,"), "{scene}");
        let bodies = list(&data(&page), "bodies").len();
        for name in ["record.csv", "record.glb"] {
            place.succeed(&[&["run"], &run[..], &["--quiet", "--record", name]].concat());
        }
        let rows = place.read("record.csv").lines().count() - 1;
        assert!(rows > 0 && rows.is_multiple_of(41), "{scene}: {rows} rows");
        assert!(bodies >= rows / 41, "{scene}: {bodies} bodies in the page, {rows} rows");
        assert!(std::fs::metadata(place.path("record.glb")).unwrap().len() > 1000, "{scene}");
    }
}

/// Bytes of base64, without a crate for it.
fn bytes(text: &str) -> Vec<u8> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => u32::from(c - b'A'),
        b'a'..=b'z' => u32::from(c - b'a') + 26,
        b'0'..=b'9' => u32::from(c - b'0') + 52,
        b'+' => 62,
        _ => 63,
    };
    let text = text.trim_end_matches('=').as_bytes();
    let mut all = Vec::new();
    for chunk in text.chunks(4) {
        let word = (0..4).fold(0, |word, at| word << 6 | chunk.get(at).map_or(0, |c| digit(*c)));
        all.extend(word.to_be_bytes()[1..chunk.len()].iter().copied());
    }
    all
}

/// An anchor of a joint in a frame \[m\], as the script finds it.
fn anchor(data: &serde_json::Value, joint: &serde_json::Value, end: usize, frame: usize) -> Vec3 {
    let at = frame * list(data, "bodies").len() + joint["bodies"][end].as_u64().unwrap() as usize;
    let [positions, rotations] = ["positions", "rotations"].map(|key| bytes(data[key].as_str().unwrap()));
    let position = |i: usize| f32::from_le_bytes(*positions[4 * (3 * at + i)..].first_chunk().unwrap()) as Real;
    let rotation = |i: usize| Real::from(i16::from_le_bytes(*rotations[2 * (4 * at + i)..].first_chunk().unwrap()));
    let arm = [0, 1, 2].map(|i| joint["anchors"][end][i].as_f64().unwrap() as Real);
    let orientation = Quat::from_array([0, 1, 2, 3].map(rotation)).normalize();
    Pose { position: Vec3::from_array([0, 1, 2].map(position)), orientation }.transform_point(Vec3::from_array(arm))
}

/// Both anchors of a joint are one point in every frame, and those of a rope no further apart than
/// it is long, for bodies whose frames are off their centres too.
#[test]
fn joints_are_drawn_where_they_hold() {
    for (scene, ropes) in
        [("ragdoll", 0), ("heavy-chain", 0), ("rope-bridge", 0), ("gimbals", 0), ("arm", 0), ("crane", 1)]
    {
        let place = Place::new();
        let page = page(&place, &[scene, "--steps", "60"]);
        let data = data(&page);
        let joints = list(&data, "joints");
        assert!(!joints.is_empty(), "{scene}");
        assert_eq!(joints.iter().filter(|joint| joint["line"] == true).count(), ropes, "{scene}");
        for (number, joint) in joints.iter().enumerate() {
            assert!(joint["until"].is_null(), "{scene}");
            for frame in [0, 30, 60] {
                let apart = anchor(&data, joint, 0, frame).distance(anchor(&data, joint, 1, frame));
                // Rotations have sixteen bits, at up to eighteen metres. The trolley goes out.
                let most = if joint["line"] == true { 9.601 } else { 1e-3 };
                let is_slider = (scene, number) == ("crane", 1);
                assert!(apart < most || is_slider && frame > 0, "{scene} {number}: {apart} m in frame {frame}");
            }
        }
    }
}

#[test]
fn joints_that_break_go() {
    let place = Place::new();
    let body = |name: &str, x: f64| {
        format!(
            r#"{{ "name": "{name}", "shape": {{ "sphere": {{ "radius": 0.1 }} }}, "mass": 1, "position": [{x}, 0, 0] }}"#
        )
    };
    let joint = |second: &str, x: f64, more: &str| {
        format!(
            r#"{{ "between": ["hook", "{second}"], "free": {{ "at": [0, 1, 0], "to": [{x}, 0, 0] }}, "limits": {{ "distance": [0, 1.5] }}{more} }}"#
        )
    };
    let scene = format!(
        r#"{{ "bodies": [ {{ "name": "hook", "fixed": true }}, {}, {} ], "joints": [ {}, {} ] }}"#,
        body("a", 0.0),
        body("b", 1.0),
        joint("a", 0.0, r#", "break": { "force": 5 }"#),
        joint("b", 1.0, ""),
    );
    place.write("ropes.json", scene);
    let page = page(&place, &["ropes.json", "--steps", "120"]);
    let data = data(&page);
    let [first, second] = list(&data, "joints") else { panic!("two joints") };
    assert!(first["line"] == true && second["line"] == true && second["until"].is_null());
    // It falls by half a metre, in 0.32 s, and breaks in the first step in which the rope is tight.
    let until = first["until"].as_f64().unwrap();
    assert!((until - (2.0 * 0.5 / 9.81_f64).sqrt()).abs() < 2.0 / 60.0, "{until}");
    let lengths = [0, 60, 120].map(|frame| anchor(&data, second, 0, frame).distance(anchor(&data, second, 1, frame)));
    assert!((lengths[0] * lengths[0] - 2.0).abs() < 1e-3 && lengths.iter().all(|length| *length < 1.51), "{lengths:?}");
}

#[test]
fn joints_of_bodies_that_are_left_out_are_too() {
    let place = Place::new();
    let bodies: Vec<_> = (0..12_000).map(|i| serde_json::json!({ "mass": 1, "position": [i, 0, 0] })).collect();
    let joint = |i: usize| {
        let between = [format!("body-{i}"), format!("body-{}", i + 1)];
        serde_json::json!({ "between": between, "ball": { "at": [i as f64 + 0.5, 0, 0] } })
    };
    let joints: Vec<_> = (0..2000).map(joint).collect();
    place.write("chain.json", serde_json::json!({ "bodies": bodies, "joints": joints }).to_string());
    let page = page(&place, &["chain.json", "--steps", "1"]);
    let data = data(&page);
    let shown = list(&data, "joints").len();
    // A body that is left out takes the joints on both sides with it.
    let names: BTreeSet<_> = list(&data, "bodies").iter().map(|body| body["name"].as_str().unwrap()).collect();
    let is_there = |i: usize| names.contains(format!("body-{i}").as_str());
    assert_eq!(shown, (0..2000).filter(|i| is_there(*i) && is_there(i + 1)).count());
    assert!(shown > 100 && shown < 2000);
    assert!(page.contains(&format!("{shown} of the 2000 joints are shown.")), "{shown}");
    for (end, joint) in list(&data, "joints").iter().flat_map(|joint| [(0, joint), (1, joint)]) {
        let body = joint["bodies"][end].as_u64().unwrap() as usize;
        let name = list(&data, "bodies")[body]["name"].as_str().unwrap();
        let at: f64 = name.trim_start_matches("body-").parse().unwrap();
        let expected = at + joint["anchors"][end][0].as_f64().unwrap();
        assert_eq!(expected.fract(), 0.5, "{name}");
    }
}
