//! Promise: a gear of a scene file is the gear that the world has, in JSON and in RON, and what it
//! cannot mean is refused with its field; a joint of a robot that follows another (`mimic`) keeps
//! to its multiplier and its offset, whatever they are and whichever kinds the two joints are.
//!
//! Why: a ratio that is taken the wrong way round, or an offset with the wrong sign, moves a
//! gripper that looks right where both fingers are alike.
#![allow(clippy::useless_conversion, clippy::unnecessary_cast, reason = "Real is f64 in one of the two builds")]

use std::f64::consts::TAU;

use hecs::World;
use proptest::prelude::*;
use tumble::math::Real;
use tumble::{Axes, Drive, Drives, Gear, JointLoad, Simulation};
use tumble_scene::{Audit, BodyNames, RunOverrides, Scene, SceneTemplate};

use crate::axes::AXES;
use crate::precision::by_precision;

/// Kinds of joints that can be geared, with the numbers of their axes; each joint has its kind's
/// name.
const KINDS: [(&str, &[usize]); 5] =
    [("hinge", &[3]), ("slider", &[0]), ("cylinder", &[0, 3]), ("universal", &[3, 4]), ("planar", &[1, 2, 3])];

/// A scene with a joint of each kind, one without name and two of one name.
fn scene(gears: &str) -> String {
    let body =
        |number: usize| format!(r#"{{ "name": "{number}", "shape": {{ "sphere": {{ "radius": 0.1 }} }}, "mass": 1 }}"#);
    let names = KINDS.map(|(kind, _)| (kind, kind)).into_iter();
    let names =
        names.chain([("weld", "fixed"), ("ball", "ball"), ("free", "free"), ("twin", "hinge"), ("twin", "hinge")]);
    let joints: Vec<_> = names
        .enumerate()
        .map(|(number, (name, kind))| {
            format!(r#"{{ "name": "{name}", "between": ["{number}", "{}"], "{kind}": {{ "at": [0, 0, 0], "axis": [0, 0, 1] }} }}"#, number + 1)
        })
        .collect();
    let bodies: Vec<_> = (0..=joints.len()).map(body).collect();
    format!(r#"{{ "bodies": [{}], "joints": [{}], "gears": {gears} }}"#, bodies.join(", "), joints.join(", "))
}

#[derive(Clone, Debug)]
struct GearCase {
    /// Indices of [`KINDS`].
    kinds: [usize; 2],
    axes: Option<[usize; 2]>,
    ratio: f64,
    offset: Option<f64>,
}

/// A number that both precisions have to the bit.
fn number(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    range.prop_map(|number| f64::from(number as f32))
}

fn gear() -> impl Strategy<Value = GearCase> {
    let kinds = prop::sample::subsequence((0..KINDS.len()).collect::<Vec<_>>(), 2).prop_shuffle();
    let ratio = number(-9.0..9.0).prop_filter("a ratio", |ratio| *ratio != 0.0);
    let axes = prop::option::of(prop::array::uniform2(any::<prop::sample::Index>()));
    (kinds, axes, ratio, prop::option::of(number(-3.0..3.0))).prop_map(|(kinds, axes, ratio, offset)| {
        let kinds = [kinds[0], kinds[1]];
        let axes = axes.map(|axes| [0, 1].map(|end| *axes[end].get(KINDS[kinds[end]].1)));
        GearCase { kinds, axes, ratio, offset }
    })
}

impl GearCase {
    fn write(&self, is_json: bool) -> String {
        let names = self.kinds.map(|kind| format!("\"{}\"", KINDS[kind].0)).join(", ");
        let word = |axis: usize| if is_json { format!("\"{}\"", AXES[axis].0) } else { AXES[axis].0.to_owned() };
        let [open, close] = if is_json { ["[", "]"] } else { ["(", ")"] };
        let mut fields = vec![("joints", format!("{open}{names}{close}")), ("ratio", format!("{:?}", self.ratio))];
        fields.extend(self.axes.map(|axes| ("axes", format!("{open}{}{close}", axes.map(word).join(", ")))));
        fields.extend(self.offset.map(|offset| ("offset", format!("{offset:?}"))));
        let field = |(name, value): &(&str, String)| {
            if is_json { format!("\"{name}\": {value}") } else { format!("{name}: {value}") }
        };
        let fields = fields.iter().map(field).collect::<Vec<_>>().join(", ");
        if is_json { format!("{{ {fields} }}") } else { format!("( {fields} )") }
    }

    fn gear(&self, names: &BodyNames) -> Gear {
        let [first, second] = self.kinds.map(|kind| names.joint(KINDS[kind].0).unwrap());
        let axes = self.axes.map_or([Axes::NONE; 2], |axes| axes.map(|axis| AXES[axis].1));
        let offset = self.offset.unwrap_or(0.0) as Real;
        Gear { axes, offset, ..Gear::new(first, second, self.ratio as Real) }
    }
}

/// JSON with the brackets and the names of RON.
fn ron(scene: &str, gears: &str) -> String {
    let mut text = scene.replace("\"gears\": []", "").replace('{', "(").replace('}', ")");
    for word in ["name", "shape", "radius", "mass", "between", "at", "axis", "bodies", "joints"] {
        text = text.replace(&format!("\"{word}\":"), &format!("{word}:"));
    }
    for kind in KINDS.iter().map(|(kind, _)| *kind).chain(["fixed", "ball", "free"]) {
        text = text.replace(&format!("\"{kind}\":"), &format!("{kind}:"));
    }
    text = text.replace("( \"sphere\": ( radius: 0.1 ) )", "sphere(radius: 0.1)");
    let end = text.rfind(')').unwrap();
    format!("{} gears: {gears} )", &text[..end])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_gear_is_what_its_file_says(gear in gear(), other in gear()) {
        let mut cases = vec![gear];
        // Two between the same axes are refused.
        let is_other = |kinds: [usize; 2]| kinds != cases[0].kinds && kinds != [cases[0].kinds[1], cases[0].kinds[0]];
        if is_other(other.kinds) {
            cases.push(other);
        }
        for is_json in [true, false] {
            let gears: Vec<_> = cases.iter().map(|case| case.write(is_json)).collect();
            let gears = format!("[{}]", gears.join(", "));
            let scene = if is_json { Scene::from_json(&scene(&gears), "a.json") } else { Scene::from_ron(&ron(&scene("[]"), &gears), "a.ron") };
            let mut world = World::new();
            let scene = scene.map_err(|error| TestCaseError::fail(format!("{error}\n{gears}")))?;
            let names = scene.spawn(&mut world).unwrap();
            let found: Vec<Gear> = world.query::<&Gear>().iter().copied().collect();
            let expected: Vec<Gear> = cases.iter().map(|case| case.gear(&names)).collect();
            prop_assert_eq!(found, expected, "{}", gears);
        }
    }
}

#[test]
fn what_a_gear_cannot_mean_is_refused_with_its_field() {
    for (gear, problem) in [
        (r#"{ "ratio": 1 }"#, "joints: is missing"),
        (r#"{ "joints": ["hinge"], "ratio": 1 }"#, "joints: invalid length 1"),
        (r#"{ "joints": ["hinge", "rack"], "ratio": 1 }"#, "joints: no joint is called \"rack\""),
        (r#"{ "joints": ["twin", "hinge"], "ratio": 1 }"#, "joints: several joints are called \"twin\""),
        (r#"{ "joints": ["hinge", "hinge"], "ratio": 1 }"#, "joints: names one joint twice"),
        (r#"{ "joints": ["hinge", "weld"], "ratio": 1 }"#, "joints: \"weld\" locks all axes"),
        (r#"{ "joints": ["ball", "hinge"], "ratio": 1 }"#, "joints: \"ball\" has three free rotations"),
        (
            r#"{ "joints": ["hinge", "free"], "axes": ["angular_x", "angular_y"], "ratio": 1 }"#,
            "axes: \"free\" has three free rotations",
        ),
        (
            r#"{ "joints": ["hinge", "slider"], "axes": ["angular_x", "angular_x"], "ratio": 1 }"#,
            "axes: \"slider\" locks angular_x",
        ),
        (
            r#"{ "joints": ["hinge", "slider"], "axes": ["angular", "linear_x"], "ratio": 1 }"#,
            "axes: linear and angular are three axes each",
        ),
        (r#"{ "joints": ["hinge", "slider"], "axes": ["angular_x"], "ratio": 1 }"#, "axes: invalid length 1"),
        (r#"{ "joints": ["hinge", "slider"], "axes": ["about", "linear_x"], "ratio": 1 }"#, "unknown variant `about`"),
        (r#"{ "joints": ["hinge", "slider"] }"#, "ratio: is missing"),
        (r#"{ "joints": ["hinge", "slider"], "ratio": 0 }"#, "ratio: must not be zero, as 0 is"),
        (r#"{ "joints": ["hinge", "slider"], "ratio": 1, "teeth": 3 }"#, "unknown field `teeth`"),
    ] {
        let error = Scene::from_json(&scene(&format!("[{gear}]")), "a.json").unwrap_err().to_string();
        assert!(error.starts_with("a.json: field gears[0]") && error.contains(problem), "{gear}: {error}");
    }
    let twice = r#"[{ "joints": ["cylinder", "slider"], "ratio": 2 },
        { "joints": ["slider", "cylinder"], "axes": ["linear_x", "angular_x"], "ratio": 3 }]"#;
    let error = Scene::from_json(&scene(twice), "a.json").unwrap_err().to_string();
    assert_eq!(error, "a.json: field gears[1].joints: gears[0] ties the same axes");
    // RON has what JSON has not.
    for number in ["NaN", "inf", "-inf"] {
        for fields in ["ratio: #", "ratio: 1, offset: #"] {
            let gears = format!("[(joints: (\"hinge\", \"slider\"), {})]", fields.replace('#', number));
            let error = Scene::from_ron(&ron(&scene("[]"), &gears), "a.ron").unwrap_err().to_string();
            assert!(error.contains("gears[0].") && error.contains("is not a finite number"), "{gears}: {error}");
        }
    }
    let tiny = scene(r#"[{ "joints": ["hinge", "slider"], "ratio": 1e-60 }]"#);
    assert_eq!(Scene::from_json(&tiny, "a.json").is_err(), size_of::<Real>() == 4);
}

/// Worlds of a sweep have the gears too.
#[test]
fn worlds_of_a_sweep_have_gears() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.json");
    std::fs::write(&path, scene(r#"[{ "joints": ["hinge", "slider"], "ratio": 2 }]"#)).unwrap();
    let template = SceneTemplate::open(&path.to_string_lossy(), RunOverrides::default()).unwrap();
    let world = template.varied(Vec::new()).build(&[]).unwrap();
    assert_eq!(world.trial.world.query::<&Gear>().iter().count(), 1);
}

const PALM: &str = r#"<link name="world"/>"#;

fn link(name: &str) -> String {
    format!(
        r#"<link name="{name}"><inertial><mass value="0.5"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial></link>"#
    )
}

fn joint(name: &str, kind: &str, parent: &str, inside: &str) -> String {
    format!(r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{name}"/>{inside}</joint>"#)
}

fn robot(parts: &[String]) -> String {
    format!("<robot name=\"r\">\n{}\n</robot>", parts.join("\n"))
}

/// Two fingers, of which the second follows the first.
#[derive(Clone, Debug)]
struct Gripper {
    /// Whether each turns, or slides.
    turns: [bool; 2],
    axes: [[f64; 3]; 2],
    range: [f64; 2],
    multiplier: f64,
    offset: f64,
    /// How much more room the second has at either end [m] [rad].
    room: f64,
}

fn gripper() -> impl Strategy<Value = Gripper> {
    let axis =
        || prop::array::uniform3(-1.0..1.0_f64).prop_filter("a direction", |it| it.iter().any(|it| it.abs() > 0.1));
    let room = prop_oneof![Just(0.0), 0.1..0.3];
    let numbers = (-1.0..-0.1, 0.1..1.0, 0.3..2.5_f64, any::<bool>(), -1.0..1.0, room);
    (any::<[bool; 2]>(), [axis(), axis()], numbers).prop_map(
        |(turns, axes, (min, max, size, is_negative, offset, room))| {
            let multiplier = if is_negative { -size } else { size };
            Gripper { turns, axes, range: [min, max], multiplier, offset, room }
        },
    )
}

impl Gripper {
    fn text(&self) -> String {
        let kind = |end: usize| if self.turns[end] { "revolute" } else { "prismatic" };
        let inside = |end: usize, [lower, upper]: [f64; 2], more: &str| {
            let [x, y, z] = self.axes[end];
            format!(
                r#"<origin xyz="{end} 0 0"/><axis xyz="{x} {y} {z}"/><limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>{more}"#
            )
        };
        let Self { range, multiplier, offset, room, .. } = self;
        let mimic = format!(r#"<mimic joint="first" multiplier="{multiplier}" offset="{offset}"/>"#);
        let mut of_second = range.map(|bound| multiplier * bound + offset);
        of_second.sort_unstable_by(f64::total_cmp);
        let of_second = [of_second[0] - room, of_second[1] + room];
        // The one that follows stands before the one that it follows.
        let joints = [
            joint("second", kind(1), "world", &inside(1, of_second, &mimic)),
            joint("first", kind(0), "world", &inside(0, *range, "")),
        ];
        robot(&[PALM.to_owned(), link("first"), link("second"), joints.concat()])
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_finger_keeps_to_multiplier_and_offset(gripper in gripper()) {
        let scene = Scene::from_urdf(&gripper.text(), "r.urdf").unwrap();
        prop_assert_eq!(&scene.notices, &Vec::<String>::new());
        let mut simulation = Simulation::new(scene.settings).unwrap();
        let mut world = World::new();
        let names = scene.spawn(&mut world).unwrap();
        let joints = ["first", "second"].map(|name| names.joint(name).unwrap());
        let axis = |end: usize| if gripper.turns[end] { 3 } else { 0 };
        let mut on_the_way = [f64::INFINITY, f64::NEG_INFINITY];
        for step in 0..360 {
            if step % 120 == 0 {
                // To one end, to the other, and back; strong enough for the weight of both.
                let way = if step == 120 { -2.0 } else { 2.0 };
                let motor = Drive::velocity(Axes::EACH[axis(0)], way).with_max_force(200.0);
                world.insert_one(joints[0], Drives::from(motor)).unwrap();
            }
            simulation.step(&mut world);
            // What the offset asks for at the start takes a while: up to 1 m and 1 rad.
            if step < 60 {
                continue;
            }
            let [first, second] = [0, 1].map(|end| f64::from(world.get::<&JointLoad>(joints[end]).unwrap().values[axis(end)]));
            on_the_way = [on_the_way[0].min(first), on_the_way[1].max(first)];
            let mut off = second - gripper.multiplier * first - gripper.offset;
            if gripper.turns[1] {
                off -= TAU * (off / TAU).round();
            }
            // Roundings of metres and radians, of either value.
            // Where both are at their bounds, three rows say what two could: they are held to the
            // regularisation of their matrix, which in double precision leaves up to 5e-7.
            let is_at_both = gripper.room == 0.0 && gripper.range.iter().any(|it| (first - it).abs() < 2.0 / 60.0);
            let most = if is_at_both { 3e-6 } else { by_precision(3e-6, 1e-9) } * (1.0 + gripper.multiplier.abs());
            prop_assert!(off.abs() < most, "step {}: {} and {}, off by {:e}", step, first, second, off);
        }
        for (reached, bound) in on_the_way.into_iter().zip(gripper.range) {
            prop_assert!((reached - bound).abs() < 1e-4, "{:?} of {:?}", on_the_way, gripper.range);
        }
    }
}

/// Wheels that go round keep whole numbers of teeth, with an offset that is met from the start.
#[test]
fn wheels_of_a_robot_go_round_together() {
    let mimic = r#"<axis xyz="0 0 1"/><mimic joint="a" multiplier="-1.5" offset="0.4"/>"#;
    let parts = [PALM.to_owned(), link("a"), link("b"), joint("a", "continuous", "world", r#"<axis xyz="0 0 1"/>"#)];
    let text = robot(&[parts.concat(), joint("b", "continuous", "world", mimic)]);
    let scene = Scene::from_urdf(&text, "r.urdf").unwrap();
    let mut simulation = Simulation::new(scene.settings).unwrap();
    let mut world = World::new();
    let names = scene.spawn(&mut world).unwrap();
    let joints = ["a", "b"].map(|name| names.joint(name).unwrap());
    world.insert_one(joints[0], Drives::from(Drive::velocity(Axes::ANGULAR_X, 5.0))).unwrap();
    for step in 0..1200 {
        simulation.step(&mut world);
        let [a, b] = joints.map(|joint| f64::from(world.get::<&JointLoad>(joint).unwrap().values[3]));
        // Either may have gone round; of the ratio 3/2 that is half a turn.
        let off = b + 1.5 * a - 0.4;
        let off = off - TAU / 2.0 * (off / (TAU / 2.0)).round();
        assert!(step < 30 || off.abs() < by_precision(1e-5, 1e-9), "step {step}: {off:e}");
    }
}

#[test]
fn the_audit_shows_who_follows_whom() {
    let follow = |name: &str, of: &str| {
        joint(name, "prismatic", "world", &format!(r#"<mimic joint="{of}" multiplier="0.25"/>"#))
    };
    let text = robot(&[PALM.to_owned(), link("a"), link("b"), joint("a", "continuous", "world", ""), follow("b", "a")]);
    let audit = Audit::from_urdf(&text, "r.urdf").unwrap();
    let json = serde_json::to_value(&audit.joints[1]).unwrap();
    assert_eq!(json["follows"], serde_json::json!([{ "joint": "a", "ratio": 0.25, "offset": 0.0 }]));
    assert!(audit.joints[0].follows.is_empty());
    // A joint of a scene may follow several.
    let gears = r#"[ { "joints": ["hinge", "planar"], "ratio": 2, "offset": 0.5 },
        { "joints": ["slider", "planar"], "axes": ["linear_x", "linear_y"], "ratio": -1 } ]"#;
    let audit = Audit::from_json(&scene(gears), "gears.json").unwrap();
    let json = serde_json::to_value(&audit.joints[4]).unwrap();
    let expected = serde_json::json!([{ "joint": "hinge", "ratio": 2.0, "offset": 0.5 },
        { "joint": "slider", "axes": ["linear_x", "linear_y"], "ratio": -1.0, "offset": 0.0 }]);
    assert_eq!((audit.joints[4].name.as_str(), &json["follows"]), ("planar", &expected));
    let wrong = r#"[ { "joints": ["hinge", "nobody"], "ratio": 2 } ]"#;
    let error = Audit::from_json(&scene(wrong), "gears.json").unwrap_err().to_string();
    assert!(error.contains("gears[0].joints: no joint is called \"nobody\""), "{error}");
}

#[test]
fn what_is_wrong_with_a_mimic_is_reported() {
    let of = |a: &str, b: &str| {
        let parts = [PALM.to_owned(), link("a"), link("b")].map(|part| part.replace('\n', ""));
        let joints = [joint("a", "continuous", "world", a), joint("b", "prismatic", "world", b)];
        robot(&[parts.to_vec(), joints.to_vec()].concat())
    };
    for (a, b, problem) in [
        ("", r#"<mimic joint="c"/>"#, "joint \"b\".mimic.joint: no joint is called \"c\", at line 6"),
        ("", r#"<mimic joint="b"/>"#, "joint \"b\".mimic.joint: is the joint itself, at line 6"),
        ("", "<mimic/>", "joint \"b\".mimic.joint: is missing, at line 6"),
        ("", r#"<mimic joint="a"/><mimic joint="a"/>"#, "joint \"b\".mimic: is given twice, at line 6"),
        (
            "",
            r#"<mimic joint="a" multiplier="1e999"/>"#,
            "joint \"b\".mimic.multiplier: inf is not a finite number, at line 6",
        ),
        ("", r#"<mimic joint="a" offset="x"/>"#, "joint \"b\".mimic.offset: \"x\" is not a number, at line 6"),
        (
            r#"<mimic joint="b"/>"#,
            r#"<mimic joint="a"/>"#,
            "joint \"a\".mimic.joint: \"b\" follows this joint by way of others, at line 5",
        ),
    ] {
        let audit = Audit::from_urdf(&of(a, b), "r.urdf").unwrap();
        let found: Vec<_> = audit.bodies.iter().flat_map(|body| &body.problems).collect();
        assert_eq!(found, [problem]);
        assert!(Scene::from_urdf(&of(a, b), "r.urdf").is_err());
    }
    // What is no mistake, and ties nothing: a multiplier of zero, and what follows a fixed joint.
    let zero = of("", r#"<mimic joint="a" multiplier="0"/>"#);
    let fixed = of("", r#"<mimic joint="a"/>"#).replace("continuous", "fixed");
    for text in [zero, fixed] {
        let scene = Scene::from_urdf(&text, "r.urdf").unwrap();
        assert_eq!(scene.notices[0], "1 joint with mimic that ties nothing, not simulated: b");
        let mut world = World::new();
        scene.spawn(&mut world).unwrap();
        assert_eq!(world.query::<&Gear>().iter().count(), 0);
    }
}
