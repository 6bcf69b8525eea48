//! Promise: a robot's links are bodies with exactly the mass properties that the file gives them,
//! where the file puts them; what is wrong with a link is said with its name, the field and the
//! line, and what is not simulated is reported.
//!
//! Why: the inertials of published robots are wrong more often than any other of their numbers, and
//! a simulator that takes them as they come explodes later. It would fail by a sign of an
//! off-diagonal element, by a rotation taken the wrong way or about moving axes, or by a first
//! mistake that hides the others.

use proptest::prelude::*;
use serde_json::Value;
use tumble::Pose;
use tumble_import::{Appearance, FileError};
use tumble_scene::{Audit, AuditedBody, Scene, SceneError};

const PUBLISHED: &str = include_str!("../../../tests/data/inertia_robot_links.json");

fn robot(inside: &str) -> String {
    format!("<?xml version=\"1.0\"?>\n<robot name=\"r\">\n{inside}\n</robot>\n")
}

/// A link with a mass of 2 kg and moments 2, 3 and 4.
fn link(name: &str) -> String {
    format!(r#"<link name="{name}"><inertial><mass value="2"/>{INERTIA}</inertial></link>"#)
}

const INERTIA: &str = r#"<inertia ixx="2" ixy="0" ixz="0" iyy="3" iyz="0" izz="4"/>"#;

fn joint(name: &str, kind: &str, parent: &str, child: &str, origin: &str) -> String {
    format!(
        r#"<joint name="{name}" type="{kind}">{origin}<parent link="{parent}"/><child link="{child}"/><axis xyz="0 0 1"/></joint>"#
    )
}

fn audit(text: &str) -> Audit {
    Audit::from_urdf(text, "r.urdf").unwrap()
}

/// Problems of the only body.
fn problems(text: &str) -> Vec<String> {
    let audit = audit(text);
    assert_eq!(audit.bodies.len(), 1, "{audit:?}");
    audit.bodies[0].problems.clone()
}

fn text_of(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

fn triple_of(value: &Value) -> String {
    value.as_array().unwrap().iter().map(text_of).collect::<Vec<_>>().join(" ")
}

/// The link of the published robots as URDF text.
fn published(link: &Value) -> String {
    let i = &link["inertia"];
    let elements: String =
        ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].map(|name| format!("{name}=\"{}\" ", text_of(&i[name]))).concat();
    format!(
        r#"<link name="{}"><inertial><origin xyz="{}" rpy="{}"/><mass value="{}"/><inertia {elements}/></inertial></link>"#,
        link["link"].as_str().unwrap(),
        triple_of(&link["com_xyz"]),
        triple_of(&link["com_rpy"]),
        text_of(&link["mass"]),
    )
}

fn sorted(mut moments: [f64; 3]) -> [f64; 3] {
    moments.sort_by(f64::total_cmp);
    moments
}

/// Moments, mass and centre of mass of the links of three published robots; two of them have no
/// mass.
#[test]
fn published_robots() {
    let file: Value = serde_json::from_str(PUBLISHED).unwrap();
    let links = file["links"].as_array().unwrap();
    let mut refused = Vec::new();
    for link in links {
        let name = link["link"].as_str().unwrap();
        let body = audit(&robot(&published(link))).bodies.remove(0);
        assert_eq!(body.name, name);
        if !body.problems.is_empty() {
            assert_eq!(body.problems, ["inertial.mass.value: must be positive and finite, not 0, at line 3"]);
            refused.push(name);
            continue;
        }
        let expected: Vec<f64> =
            link["principal"].as_array().unwrap().iter().map(|moment| text_of(moment).parse().unwrap()).collect();
        for (moment, expected) in sorted(body.principal.unwrap()).into_iter().zip(expected) {
            // Frames that are turned round off twice more.
            assert!((moment / expected - 1.0).abs() < 1e-12, "{name}: {moment} for {expected}");
        }
        assert_eq!(body.mass, link["mass"].as_f64(), "{name}");
        let center: Vec<f64> = link["com_xyz"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        assert_eq!(body.center_of_mass.unwrap().to_vec(), center, "{name}");
    }
    assert_eq!((links.len(), refused), (20, vec!["lbr_iiwa_link_0", "panda_link8"]));
}

/// A box turned by 90 degrees about z has its moments about x and y exchanged, and an element `ixy`
/// is the matrix's own.
#[test]
fn the_inertial_frame_is_turned_into_the_links() {
    let turned = r#"<link name="a"><inertial><origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/><mass value="2"/>
        <inertia ixx="2" ixy="0.5" ixz="0" iyy="3" iyz="0" izz="4"/></inertial></link>"#;
    let body = audit(&robot(turned)).bodies.remove(0);
    let expected = [[3.0, -0.5, 0.0], [-0.5, 2.0, 0.0], [0.0, 0.0, 4.0]];
    for (row, expected) in body.tensor.unwrap().iter().flatten().zip(expected.iter().flatten()) {
        // The quaternion of a quarter turn is rounded, and so are its products.
        assert!((row - expected).abs() < 4e-15, "{:?}", body.tensor);
    }
    assert_eq!(body.center_of_mass, Some([1.0, 2.0, 3.0]));
}

/// Roll before pitch before yaw about fixed axes: with all three, only this order takes the axes
/// where they belong.
#[test]
fn angles_are_about_fixed_axes() {
    let (r, p, y) = (0.3_f64, -0.7_f64, 1.1_f64);
    let text = robot(&format!(
        r#"<link name="a"><inertial><origin rpy="{r} {p} {y}"/><mass value="1"/>{INERTIA}</inertial></link>"#
    ));
    let tensor = audit(&text).bodies.remove(0).tensor.unwrap();
    let (cr, sr, cp, sp, cy, sy) = (r.cos(), r.sin(), p.cos(), p.sin(), y.cos(), y.sin());
    let rotation = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ];
    for (i, row) in tensor.iter().enumerate() {
        for (j, element) in row.iter().enumerate() {
            let expected: f64 = (0..3).map(|k| rotation[i][k] * [2.0, 3.0, 4.0][k] * rotation[j][k]).sum();
            // Some roundings of numbers up to 4.
            assert!((element - expected).abs() < 1e-14, "({i}, {j}): {element} for {expected}");
        }
    }
}

#[test]
fn links_are_where_their_joints_put_them() {
    let quarter = r#"<origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/>"#;
    let text = robot(
        &[
            link("hand"),
            link("base"),
            link("arm"),
            joint("wrist", "revolute", "arm", "hand", r#"<origin xyz="2 0 0"/>"#),
            joint("shoulder", "revolute", "base", "arm", quarter),
        ]
        .concat(),
    );
    let scene = Scene::from_urdf(&text, "r.urdf").unwrap();
    assert_eq!(scene.settings.gravity.to_array(), [0.0, 0.0, -9.81]);
    assert_eq!(scene.notices, ["2 revolute joints without limit, taken for continuous: wrist, shoulder"]);
    let mut world = hecs::World::new();
    let names = scene.spawn(&mut world).unwrap();
    for (pose, id) in world.query::<(&Pose, &tumble::BodyId)>().iter() {
        let expected = match names.of(id.0).as_ref() {
            "base" => [0.0, 0.0, 0.0],
            "arm" => [1.0, 0.0, 0.0],
            _ => [1.0, 2.0, 0.0],
        };
        for (position, expected) in pose.position.to_array().into_iter().zip(expected) {
            // Single precision of numbers up to 2.
            assert!((position - expected).abs() < 2e-7, "{}: {pose:?}", names.of(id.0));
        }
    }
}

#[test]
#[allow(clippy::too_many_lines, reason = "a table of cases")]
fn every_mistake_of_a_link_is_reported() {
    let cases: [(&str, &[&str]); 9] = [
        ("", &["inertial.mass: is missing, at line 3", "inertial.inertia: is missing, at line 3"]),
        (
            r#"<mass/><inertia ixx="1" iyy="1" izz="one"/>"#,
            &[
                "inertial.mass.value: is missing, at line 3",
                "inertial.inertia.ixy: is missing, at line 3",
                "inertial.inertia.ixz: is missing, at line 3",
                "inertial.inertia.iyz: is missing, at line 3",
                "inertial.inertia.izz: \"one\" is not a number, at line 3",
            ],
        ),
        (
            r#"<mass value="-2"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>"#,
            &[
                "inertial.mass.value: must be positive and finite, not -2, at line 3",
                "inertial.inertia: principal moments of inertia must be positive beyond rounding, they are (0.0, 0.0, 0.0), at line 3",
            ],
        ),
        (
            r#"<mass value="NaN"/><inertia ixx="inf" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>"#,
            &[
                "inertial.mass.value: NaN is not a finite number, at line 3",
                "inertial.inertia.ixx: inf is not a finite number, at line 3",
            ],
        ),
        (
            r#"<mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="4"/>"#,
            &[
                "inertial.inertia: principal moments of inertia (1.0, 1.0, 4.0) break the triangle inequality: no moment may exceed \
               the sum of the others; here by 5.00e-1 of the largest; --repair takes the nearest possible, at line 3",
            ],
        ),
        (
            // Water, rounded to three digits.
            r#"<mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="0.653" iyz="0" izz="0.345"/>"#,
            &[
                "inertial.inertia: principal moments of inertia (0.345, 0.653, 1.0) break the triangle inequality: no moment may exceed \
               the sum of the others; here by 2.00e-3 of the largest, as rounding to three digits does: give more digits; --repair takes the nearest possible, at line 3",
            ],
        ),
        (
            r#"<mass value="1"/><inertia ixx="1" ixy="2" ixz="0" iyy="1" iyz="0" izz="1"/>"#,
            &[
                "inertial.inertia: principal moments of inertia must be positive beyond rounding, they are (-1.0, 1.0, 3.0), at line 3",
            ],
        ),
        (
            r#"<origin xyz="1 2" rpy="0,0,0"/><mass value="1"/><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>"#,
            &[
                "inertial.mass: is given twice, at line 3",
                "inertial.origin.xyz: \"1 2\" is not three numbers with spaces between them, at line 3",
            ],
        ),
        (
            r#"<origin rpy="0 0 1e30"/><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>"#,
            &["inertial.origin.rpy: 1e30 is absurd: more than 1e18, at line 3"],
        ),
    ];
    for (inertial, expected) in cases {
        let text = robot(&format!(r#"<link name="a"><inertial>{inertial}</inertial></link>"#));
        let found = problems(&text);
        assert_eq!(found.len(), expected.len(), "{inertial}: {found:#?}");
        for (found, expected) in found.iter().zip(expected) {
            // Zero moments may come out of the eigenvalues as minus zero.
            assert_eq!(&found.replace("-0.0", "0.0"), expected, "{inertial}");
        }
        let error = Scene::from_urdf(&text, "r.urdf").unwrap_err().to_string();
        let (field, problem) = found[0].split_once(": ").unwrap();
        assert_eq!(error, format!("r.urdf: link \"a\", field {field}: {problem}"));
    }
}

#[test]
fn trees_that_are_none_are_reported() {
    let of = |parts: &[String]| {
        let audit = audit(&robot(&parts.join("\n")));
        audit.bodies.into_iter().flat_map(|body| body.problems).collect::<Vec<_>>()
    };
    let ab = || [link("a"), link("b")];
    let with = |joints: &[String]| of(&ab().into_iter().chain(joints.iter().cloned()).collect::<Vec<_>>());
    assert_eq!(with(&[joint("j", "fixed", "a", "b", "")]), Vec::<String>::new());
    assert_eq!(with(&[]), ["joint: none leads here, nor to \"a\": a robot has one root"]);
    assert_eq!(
        with(&[joint("j", "fixed", "a", "b", ""), joint("k", "fixed", "b", "a", "")]),
        ["joint: the joints that lead here come from no root, they go round in a circle"; 2]
    );
    assert_eq!(
        with(&[joint("j", "fixed", "a", "b", ""), joint("k", "fixed", "a", "b", "")]),
        ["joint \"k\": leads here, and joint \"j\" does too: a link has one parent"]
    );
    let lost = with(&[joint("j", "fixed", "a", "b", ""), joint("k", "ball", "b", "c", "")]);
    assert_eq!(
        lost,
        [
            "joint \"k\".type: \"ball\" is none of fixed, revolute, continuous, prismatic, planar, floating, at line 6",
            "joint \"k\".child: no link is called \"c\", at line 6"
        ]
    );
    let twice = of(&[link("a"), link("a")]);
    assert_eq!(
        twice,
        [
            "name: is also that of the link at line 3, at line 4",
            "joint: none leads here, nor to \"a\": a robot has one root"
        ]
    );
    let unnamed = of(&[link("a").replace(" name=\"a\"", "")]);
    assert_eq!(unnamed, ["name: is missing, at line 3"]);
}

#[test]
fn what_is_no_body_and_what_is_not_read_is_reported() {
    let appearance = r#"<link name="a"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
        <collision><origin xyz="0 0 1"/><geometry><cylinder radius="0.1" length="2"/></geometry></collision>
        <collision><geometry><mesh filename="package://r/hand.dae"/></geometry></collision>
        <collision><geometry><box size="1 -1 1"/></geometry></collision></link>"#;
    let text = robot(&[appearance, r#"<link name="world"/>"#, &joint("j", "fixed", "world", "a", "")].concat());
    let scene = Scene::from_urdf(&text, "r.urdf").unwrap();
    assert_eq!(
        scene.notices,
        [
            "1 mesh file not read, for appearance only: package://r/hand.dae",
            "1 geometry not understood, for appearance only: link \"a\", collision.box: half_extents must be a length from 1e-90 to \
             1e90 m, it is -0.5, at line 6",
        ]
    );
    assert_eq!(scene.body_count(), 1);
    // A cylinder of URDF lies along z, ours along y.
    let Appearance::Shape(tumble::Shape::Compound(parts)) = &scene.appearance().unwrap()[0] else {
        panic!("not a compound")
    };
    assert_eq!((parts.len(), parts[0].position.to_array()), (1, [0.0, 0.0, 1.0]));
    let axis = parts[0].orientation * glam::DVec3::Y;
    // The quaternion of a quarter turn is rounded.
    assert!((axis - glam::DVec3::Z).length() < 1e-15, "{axis}");
}

fn refusal(text: &str) -> String {
    let error = Scene::from_urdf(text, "r.urdf").unwrap_err();
    assert!(matches!(error, SceneError::File(FileError::Malformed { .. })), "{error:?}");
    assert_eq!(Audit::from_urdf(text, "r.urdf").unwrap_err(), error);
    error.to_string()
}

#[test]
fn what_is_no_robot_is_refused_as_a_whole() {
    assert_eq!(refusal("<sdf/>"), "r.urdf: the outermost element of a robot is <robot>, not <sdf>");
    assert_eq!(refusal("<robot/>"), "r.urdf: the robot has no link");
    assert!(refusal("<robot><link></robot>").contains("1:14"), "{}", refusal("<robot><link></robot>"));
    assert!(refusal("<!DOCTYPE r [<!ENTITY a 'b'>]><robot/>").contains("DTD"));
    let expand = "has xacro macros that are not expanded";
    let declared = |inside: &str| format!(r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro">{inside}</robot>"#);
    assert!(refusal(&declared(r#"<xacro:include filename="a"/>"#)).contains(expand));
    assert!(refusal(&declared(r#"<link name="${prefix}a"/>"#)).contains(expand));
    assert!(refusal("<robot><xacro:macro/></robot>").contains(expand));
    assert_eq!(Scene::from_urdf(&declared(&link("a")), "r.urdf").unwrap().body_count(), 1);
}

/// Files made to exhaust stack, memory or patience end as any other bad file, at once.
#[test]
fn hostile_files_are_refused_soon() {
    let started = std::time::Instant::now();
    let deep = format!("<robot>{}{}</robot>", "<a>".repeat(100_000), "</a>".repeat(100_000));
    assert_eq!(refusal(&deep), "r.urdf: the robot has no link");
    assert!(refusal(&"<robot>".repeat(100_000)).contains("never closed"));
    let many = format!("<robot>{}</robot>", "<a/>".repeat(1_100_000));
    assert!(refusal(&many).ends_with("more than 1000000 elements, texts and comments"));
    let attributes: String = (0..100_000).map(|index| format!(" a{index}=''")).collect();
    assert!(refusal(&format!("<robot{attributes}/>")).ends_with("element <robot> has more than 1000 quotation marks"));
    let namespaces: String = (0..1000).map(|index| format!(" xmlns:a{index}='{index}'")).collect();
    assert!(refusal(&format!("<robot{namespaces}/>")).ends_with("more than 100 namespaces are declared"));
    // A chain of joints as long as a file may have, each with a mistake, and a line to be found for
    // it.
    let chain: String = (1..=50_000)
        .map(|i| {
            link(&format!("l{i}")) + "\n" + &joint(&format!("j{i}"), "x", &format!("l{}", i - 1), &format!("l{i}"), "")
        })
        .collect();
    assert_eq!(audit(&robot(&chain)).bodies.len(), 50_000);
    // Some seconds in all on a slow machine; what these guard against takes hours.
    assert!(started.elapsed().as_secs() < 60, "{:?}", started.elapsed());
}

/// A robot with everything that is read.
fn example() -> String {
    robot(
        &[
            r#"<link name="world"/>"#.to_owned(),
            r#"<link name="a"><inertial><origin xyz="0 0.1 0" rpy="0.1 0.2 0.3"/><mass value="1.5"/>
            <inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.03" iyz="-0.001" izz="0.04"/></inertial>
            <collision><origin rpy="0 1 0"/><geometry><box size="0.1 0.2 0.3"/></geometry></collision>
            <visual><geometry><mesh filename="a.stl" scale="1 1 1"/></geometry></visual></link>"#
                .to_owned(),
            link("b"),
            joint("fix", "fixed", "world", "a", ""),
            link("c"),
            link("d"),
            joint(
                "turn",
                "continuous",
                "a",
                "b",
                r#"<origin xyz="0 0 1" rpy="0 0 1"/><dynamics damping="0.1" friction="0.2"/>"#,
            ),
            joint("bend", "revolute", "b", "c", r#"<limit lower="-1" upper="2.5" effort="10" velocity="3"/>"#),
            joint(
                "slide",
                "prismatic",
                "b",
                "d",
                r#"<limit lower="0" upper="0.5" effort="10" velocity="3"/><mimic joint="bend" multiplier="0.2"/>"#,
            ),
        ]
        .join("\n"),
    )
}

#[test]
fn the_unmutated_robot_is_good() {
    let bodies = audit(&example()).bodies;
    assert!(bodies.len() == 4 && bodies.iter().all(|body: &AuditedBody| body.problems.is_empty()), "{bodies:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_robots(edits in prop::collection::vec((0.0..1.0, 0_usize..10, "\\PC{0,3}|<|>|\"|NaN|1e999|-1|</link>|<link>|0 0"), 1..4)) {
        let mut characters: Vec<char> = example().chars().collect();
        for (at, length, with) in edits {
            let start = (at * characters.len() as f64) as usize;
            characters.splice(start..(start + length).min(characters.len()), with.chars());
        }
        let text: String = characters.into_iter().collect();
        match Scene::from_urdf(&text, "scene.x") {
            Ok(scene) => {
                let mut simulation = tumble::Simulation::new(scene.settings).unwrap();
                let mut world = hecs::World::new();
                scene.spawn(&mut world).unwrap();
                simulation.step(&mut world);
                prop_assert!(!Audit::from_urdf(&text, "scene.x").unwrap().has_problems());
            }
            Err(error) => {
                let message = error.to_string();
                prop_assert!(message.starts_with("scene.x: ") && !message.chars().any(char::is_control), "{message:?}");
                prop_assert!(Audit::from_urdf(&text, "scene.x").map_or(true, |audit| audit.has_problems()));
            }
        }
    }
}
