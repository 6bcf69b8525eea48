//! Promise: numbers of glTF and URDF files vary in sweeps as those of scenes do: a world has what
//! the file says with these numbers written into it, a mechanism moves as one, and the joints of a
//! robot begin where they are asked to. What such a file does not say is refused by name.
//!
//! Why: an arm that is posed about the wrong axis or in the wrong sense, or a mass that changes
//! without its moments, still moves and looks right.
#![allow(clippy::useless_conversion, clippy::unnecessary_cast, reason = "Real is f64 in one of the two builds")]

use std::f64::consts::PI;

use glam::{DQuat, DVec3};
use hecs::World;
use proptest::prelude::*;
use tumble::math::Real;
use tumble::{BodyId, BodyOrder, Collider, Joint, JointLoad, Pose, Trial, Velocity, state_hash};
use tumble_import::InertiaRepairs;
use tumble_scene::{RunLength, RunOverrides, Scene, SceneTemplate};

use crate::precision::by_precision;

fn template(text: &str, ending: &str) -> SceneTemplate {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(format!("scene.{ending}"));
    std::fs::write(&path, text).unwrap();
    SceneTemplate::open(&path.to_string_lossy(), RunOverrides::default()).unwrap()
}

/// The world in which these fields have these values.
fn varied(text: &str, ending: &str, values: &[(&str, f64)]) -> Trial {
    let template = template(text, ending);
    let fields: Vec<_> = values.iter().map(|(path, _)| template.field(path).unwrap()).collect();
    fields.iter().for_each(|field| template.check(field).unwrap());
    let values: Vec<f64> = values.iter().map(|(_, value)| *value).collect();
    template.varied(fields).build(&values).unwrap().trial
}

/// Position, rotation vector's quaternion, velocities of each body, in order.
fn states(world: &World) -> Vec<[DVec3; 4]> {
    let order = BodyOrder::of(world);
    let state = |entity: &hecs::Entity| {
        let pose = *world.get::<&Pose>(*entity).unwrap();
        let velocity = world.get::<&Velocity>(*entity).map(|it| *it).unwrap_or_default();
        let turned = double(pose.orientation * tumble::math::Vec3::new(1.0, 2.0, 3.0));
        [double(pose.position), turned, double(velocity.linear), double(velocity.angular)]
    };
    order.entities().iter().map(state).collect()
}

fn double(vector: tumble::math::Vec3) -> DVec3 {
    DVec3::from_array(vector.to_array().map(f64::from))
}

fn largest_difference(a: &World, b: &World) -> f64 {
    let (a, b) = (states(a), states(b));
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (*a - *b).length() / (1.0 + a.length())).fold(0.0, f64::max)
}

/// A ball and a spinning box over ground, with the numbers of the box.
fn crates(numbers: [f64; 9]) -> String {
    let [mass, x, y, speed, spin, at_rest, sliding, bounce, gravity] = numbers;
    format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "extensionsUsed": ["KHR_physics_rigid_bodies", "KHR_implicit_shapes"],
        "scene": 0, "scenes": [{{ "nodes": [0, 1] }}],
        "extensions": {{
          "KHR_implicit_shapes": {{ "shapes": [ {{ "type": "box", "box": {{ "size": [40, 1, 40] }} }},
            {{ "type": "box", "box": {{ "size": [0.5, 0.3, 0.4] }} }} ] }},
          "KHR_physics_rigid_bodies": {{ "physicsMaterials": [ {{ "staticFriction": {at_rest:?},
            "dynamicFriction": {sliding:?}, "restitution": {bounce:?} }} ] }} }},
        "nodes": [
          {{ "name": "floor", "translation": [0, -0.5, 0], "extensions": {{ "KHR_physics_rigid_bodies": {{
            "collider": {{ "geometry": {{ "shape": 0 }}, "physicsMaterial": 0 }} }} }} }},
          {{ "name": "box", "translation": [{x:?}, {y:?}, 0], "extensions": {{ "KHR_physics_rigid_bodies": {{
            "motion": {{ "mass": {mass:?}, "linearVelocity": [{speed:?}, 0, 0], "angularVelocity": [0, {spin:?}, 0.5],
              "gravityFactor": {gravity:?} }},
            "collider": {{ "geometry": {{ "shape": 1 }}, "physicsMaterial": 0 }} }} }} }} ] }}"#
    )
}

const BOX: [&str; 9] = [
    "bodies.box.mass",
    "bodies.box.position.0",
    "bodies.box.position.1",
    "bodies.box.linear_velocity.0",
    "bodies[1].angular_velocity[1]",
    "bodies.box.collider.static_friction",
    "bodies.box.collider.dynamic_friction",
    "bodies.box.collider.restitution",
    "bodies.box.gravity_scale",
];

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) })]
    /// Numbers of a glTF file, each alone and all together, while it falls, hits and slides. The
    /// floor has its material of the same file, so both have to change for what they share.
    #[test]
    fn a_varied_world_is_that_of_the_file_with_the_numbers(
        numbers in (0.1_f64..50.0, -5.0_f64..5.0, 0.6_f64..2.0, -3.0_f64..3.0, -6.0_f64..6.0, 0.5_f64..0.9, 0.1_f64..0.4, 0.0_f64..0.6, 0.2_f64..2.0),
        chosen in prop::sample::subsequence((0..9).collect::<Vec<usize>>(), 1..=9),
    ) {
        let usual = [2.0, 0.0, 1.0, 1.0, 2.0, 0.6, 0.5, 0.0, 1.0];
        let (m, x, y, v, w, a, s, b, g) = numbers;
        let numbers = [m, x, y, v, w, a, s, b, g];
        let mut said = usual;
        chosen.iter().for_each(|&which| said[which] = numbers[which]);
        let mut paths: Vec<_> = chosen.iter().map(|&which| (BOX[which], numbers[which])).collect();
        for (which, of_floor) in [(5, "bodies.floor.collider.static_friction"), (6, "bodies.0.collider.dynamic_friction"), (7, "bodies.0.collider.restitution")] {
            if chosen.contains(&which) {
                paths.push((of_floor, numbers[which]));
            }
        }
        let mut swept = varied(&crates(usual), "gltf", &paths);
        let mut written = varied(&crates(said), "gltf", &[]);
        for _ in 0..4 {
            // Rounding grows in a tumble; what is wrong is wrong by more from the first steps on.
            prop_assert!(largest_difference(&swept.world, &written.world) < by_precision(3e-4, 1e-11), "{chosen:?}");
            swept.step_many(5);
            written.step_many(5);
        }
    }
}

/// A tree of links: of each its parent, whether its joint slides, and where and along what its
/// joint is.
#[derive(Clone, Debug)]
struct Link {
    parent: usize,
    slides: bool,
    place: [f64; 6],
    axis: [f64; 3],
    position: f64,
}

fn robot(links: &[Link], is_fixed: bool) -> String {
    let inertial = r#"<inertial><origin xyz="0.05 -0.02 0.1"/><mass value="0.5"/><inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial>"#;
    let root = if is_fixed { String::new() } else { inertial.to_owned() };
    let mut text = format!("<robot name=\"tree\"><link name=\"l0\">{root}</link>");
    for (index, link) in links.iter().enumerate() {
        let [x, y, z, roll, pitch, yaw] = link.place;
        let ([a, b, c], kind) = (link.axis, if link.slides { "prismatic" } else { "continuous" });
        let limit = if link.slides { r#"<limit lower="-9" upper="9" effort="1" velocity="1"/>"# } else { "" };
        text += &format!(
            r#"<link name="l{0}">{inertial}</link><joint name="j{0}" type="{kind}"><origin xyz="{x} {y} {z}" rpy="{roll} {pitch} {yaw}"/>
            <parent link="l{1}"/><child link="l{0}"/><axis xyz="{a} {b} {c}"/>{limit}</joint>"#,
            index + 1,
            link.parent
        );
    }
    text + "</robot>"
}

fn links() -> impl Strategy<Value = Vec<Link>> {
    let link = (
        any::<prop::sample::Index>(),
        any::<bool>(),
        prop::array::uniform6(-1.0_f64..1.0),
        prop::array::uniform3(-1.0_f64..1.0).prop_filter("a direction", |axis| DVec3::from_array(*axis).length() > 0.1),
        -2.9_f64..2.9,
    );
    prop::collection::vec(link, 1..7).prop_map(|links| {
        let links = links.into_iter().enumerate();
        links
            .map(|(index, (parent, slides, place, axis, position))| Link {
                parent: parent.index(index + 1),
                slides,
                place,
                axis,
                position,
            })
            .collect()
    })
}

/// What the engine reads of each joint after a short step without gravity, by its child's number.
fn positions_of(trial: &mut Trial) -> Vec<f64> {
    trial.step_many(1);
    let mut query = trial.world.query::<(&Joint, &JointLoad)>();
    let mut found: Vec<(u64, f64)> = query
        .iter()
        .map(|(joint, load)| {
            let child = trial.world.get::<&BodyId>(joint.bodies[1]).unwrap().0;
            // Of the locked axes it is zero.
            (child, load.values.iter().map(|value| f64::from(*value)).sum())
        })
        .collect();
    found.sort_by_key(|(child, _)| *child);
    found.into_iter().map(|(_, position)| position).collect()
}

const STILL: [(&str, f64); 4] = [("gravity.0", 0.0), ("gravity.1", 0.0), ("gravity.2", 0.0), ("dt", 1e-3)];

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) })]
    #[test]
    fn a_robot_begins_in_the_posture_that_is_asked_for(links in links(), is_fixed in any::<bool>()) {
        let text = robot(&links, is_fixed);
        let names: Vec<String> = (1..=links.len()).map(|link| format!("joints.j{link}.position")).collect();
        let asked = names.iter().zip(&links).map(|(name, link)| (name.as_str(), link.position));
        let values: Vec<_> = asked.chain(STILL).collect();
        let mut trial = varied(&text, "urdf", &values);
        let root = states(&trial.world)[0];
        prop_assert!(root[0].length() < 0.2, "the root stays");
        let found = positions_of(&mut trial);
        prop_assert_eq!(found.len(), links.len());
        for (found, link) in found.iter().zip(&links) {
            prop_assert!((found - link.position).abs() < by_precision(2e-4, 1e-9), "{} for {:?}", found, link);
        }
        // Nothing had to be pulled together.
        let fastest = states(&trial.world).iter().map(|it| it[2].length().max(it[3].length())).fold(0.0, f64::max);
        prop_assert!(fastest < by_precision(0.05, 1e-9), "{}", fastest);
    }

    /// The place of any of its bodies moves a robot as a whole.
    #[test]
    fn a_mechanism_moves_as_one(
        links in links(), which in any::<prop::sample::Index>(), place in prop::array::uniform3(-20.0_f64..20.0), angle in -3.0_f64..3.0,
    ) {
        let text = robot(&links, false);
        let link = which.index(links.len() + 1);
        let before = states(&varied(&text, "urdf", &[]).world);
        let paths: Vec<String> = (0..3).map(|axis| format!("bodies.l{link}.position.{axis}")).collect();
        let mut values: Vec<_> = paths.iter().zip(place).map(|(path, value)| (path.as_str(), value)).collect();
        let turn = format!("bodies.l{link}.orientation.angle");
        // A link that is turned in the file has a quaternion.
        let is_turned = template(&text, "urdf").check(&template(&text, "urdf").field(&turn).unwrap()).is_err();
        if !is_turned {
            values.push((turn.as_str(), angle));
        }
        let after = states(&varied(&text, "urdf", &values).world);
        let turn = if is_turned { DQuat::IDENTITY } else { DQuat::from_rotation_y(angle) };
        let pairs = before.iter().zip(&after);
        for (b, a) in pairs {
            let (b_way, a_way) = (b[0] - before[link][0], a[0] - after[link][0]);
            prop_assert!((turn * b_way - a_way).length() < by_precision(1e-4, 1e-12));
            prop_assert!((turn * b[1] - a[1]).length() < by_precision(1e-4, 1e-12));
        }
        // The origin of the link, from its centre of mass.
        let center = DVec3::new(0.05, -0.02, 0.1);
        let expected = DVec3::from_array(place) + orientation(&text, link, turn) * center;
        prop_assert!((after[link][0] - expected).length() < by_precision(1e-4, 1e-12), "{} {}", after[link][0], expected);
    }
}

/// How a link stands after the whole was turned.
fn orientation(text: &str, link: usize, turn: DQuat) -> DQuat {
    let scene = Scene::from_urdf(text, "tree.urdf").unwrap();
    let mut world = World::new();
    scene.spawn(&mut world).unwrap();
    let entity = BodyOrder::of(&world).entities()[link];
    let pose = *world.get::<&Pose>(entity).unwrap();
    turn * DQuat::from_array(pose.orientation.to_array().map(f64::from))
}

/// Without fields a world is what the file says, to the bit.
#[test]
fn a_world_without_fields_is_the_scene() {
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");
    for (file, repairs) in [("crates.gltf", InertiaRepairs::Refused), ("robot.urdf", InertiaRepairs::Made)] {
        let path = format!("{models}/{file}");
        let overrides = RunOverrides { length: Some(RunLength::Steps(40)), ..RunOverrides::default() };
        let template = SceneTemplate::open_with(&path, overrides, repairs).unwrap();
        let names = template.body_names();
        assert_eq!(template.files(), [std::path::PathBuf::from(&path)]);
        let built = template.varied(Vec::new()).build(&[]).unwrap();
        assert_eq!(built.steps, 40);
        let scene = Scene::load_with(path.as_ref(), repairs).unwrap();
        let mut world = World::new();
        let mut simulation = tumble::Simulation::new(scene.settings).unwrap();
        let of_scene = scene.spawn(&mut world).unwrap();
        assert_eq!(names, (0..names.len() as u64).map(|id| of_scene.of(id).into_owned()).collect::<Vec<_>>());
        let mut trial = built.trial;
        trial.step_many(40);
        simulation.step_many(&mut world, 40);
        let hash = |world: &World| state_hash(world, &BodyOrder::of(world));
        assert_eq!(hash(&trial.world), hash(&world), "{file}");
    }
    assert!(SceneTemplate::open(&format!("{models}/robot.urdf"), RunOverrides::default()).is_err());
}

/// A link that swings on a fixed one with friction, between limits.
const ARM: &str = r#"<robot name="arm"><link name="foot"/>
    <link name="lower"><inertial><origin xyz="0.3 0 0"/><mass value="1"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial></link>
    <joint name="elbow" type="revolute"><parent link="foot"/><child link="lower"/><axis xyz="0 1 0"/>
      <limit lower="-1" upper="UPPER" effort="9" velocity="9"/><dynamics damping="DAMPING" friction="FRICTION"/></joint></robot>"#;

fn arm(upper: f64, damping: f64, friction: f64) -> String {
    let number = |value: f64| format!("{value:?}");
    ARM.replace("UPPER", &number(upper)).replace("DAMPING", &number(damping)).replace("FRICTION", &number(friction))
}

/// Limits, dampers and friction of a robot's joint are those of the file with these numbers, to the
/// bit.
#[test]
fn what_a_joint_has_varies() {
    let usual = (1.0, 0.5, 0.25);
    let said = [
        ("joints.elbow.limits.angular_x.max", (0.5, 0.5, 0.25), 0.5),
        ("joints.elbow.drives.0.damping", (1.0, 0.125, 0.25), 0.125),
        ("joints[0].friction.angular_x", (1.0, 0.5, 0.75), 0.75),
    ];
    let hash = |trial: &mut Trial| {
        trial.step_many(200);
        state_hash(&trial.world, &BodyOrder::of(&trial.world))
    };
    let text = |(upper, damping, friction)| arm(upper, damping, friction);
    let mut hashes = vec![hash(&mut varied(&text(usual), "urdf", &[]))];
    for (path, written, value) in said {
        let swept = hash(&mut varied(&text(usual), "urdf", &[(path, value)]));
        assert_eq!(swept, hash(&mut varied(&text(written), "urdf", &[])), "{path}");
        assert!(!hashes.contains(&swept), "{path} does nothing");
        hashes.push(swept);
    }
}

#[test]
fn what_such_a_file_does_not_say_is_refused() {
    let crates = crates([2.0, 0.0, 1.0, 1.0, 2.0, 0.6, 0.5, 0.0, 1.0]);
    let arm = arm(1.0, 0.5, 0.25);
    for (text, ending, path, problem) in [
        (&crates, "gltf", "bodies.floor.mass", "the body has no mass that could vary"),
        (&crates, "gltf", "bodies.0.linear_velocity.0", "the body has no velocity that could vary"),
        (&crates, "gltf", "bodies.box.density", "only mass, gravity_scale, position.I"),
        (&crates, "gltf", "bodies.box.shape.cuboid.half_extents.0", "only mass"),
        (&crates, "gltf", "bodies.box.inertia.principal.0", "only mass"),
        (&crates, "gltf", "bodies.box.forces.0.gravity_scale", "only mass"),
        (&crates, "gltf", "bodies.box.collider.friction", "has two coefficients: static_friction and dynamic_friction"),
        (&arm, "urdf", "bodies.lower.collider.restitution", "the body has no collider that could vary"),
        (&arm, "urdf", "joints.elbow.hinge.at.0", "of glTF and URDF also position"),
        (&arm, "urdf", "joints.elbow.drives.0.stiffness.0", "there may be"),
    ] {
        let template = template(text, ending);
        let error = template.field(path).and_then(|field| template.check(&field)).unwrap_err();
        assert_eq!(error.field, path);
        assert!(error.problem.contains(problem), "{path}: {error}");
    }
    for (text, ending, values, problem) in [
        (&crates, "gltf", &[("bodies.box.mass", -1.0)][..], "bodies[1].mass: "),
        (&crates, "gltf", &[("bodies.box.mass", f64::NAN)], "bodies[1].mass: "),
        (&crates, "gltf", &[("bodies.box.position.0", f64::INFINITY)], "bodies[1].position"),
        (&crates, "gltf", &[("bodies.box.position.0", 1e16)], "bodies[1].position: is further than 1e15 m"),
        (&crates, "gltf", &[("bodies.box.linear_velocity.0", 1e60)], "bodies[1].linear_velocity: "),
        (&crates, "gltf", &[("bodies.box.collider.static_friction", -0.1)], "bodies[1].collider.static_friction: "),
        (&crates, "gltf", &[("bodies.box.collider.restitution", 1.5)], "bodies[1].collider.restitution: "),
        (&crates, "gltf", &[("bodies.box.orientation.0", 1.0)], "bodies[1].orientation: "),
        (&arm, "urdf", &[("joints.elbow.position", f64::NAN)], "joints[0].position: "),
        (&arm, "urdf", &[("joints.elbow.drives.0.stiffness", 1.0)], "joints[0].drives[0].stiffness: "),
        (&arm, "urdf", &[("joints.elbow.limits.angular_x.max", -2.0)], "joints[0].limits.angular_x.min: "),
        (
            &arm,
            "urdf",
            &[("bodies.0.position.0", 1.0), ("bodies.lower.position.0", 2.0)],
            "bodies[1].position: is that of a mechanism whose place bodies[0] has already",
        ),
    ] {
        let template = template(text, ending);
        let fields = values.iter().map(|(path, _)| template.field(path).unwrap()).collect();
        let values: Vec<f64> = values.iter().map(|(_, value)| *value).collect();
        let error = template.varied(fields).build(&values).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(&format!("field {problem}")), "{error}");
    }
}

/// A four-bar loop has no side of a joint that could be moved alone; a body in two places is one.
#[test]
fn a_joint_of_a_loop_has_no_position() {
    let node = |name: &str, x: f64| {
        format!(
            r#"{{ "name": "{name}", "translation": [{x:?}, 0, 0], "extensions": {{ "KHR_physics_rigid_bodies": {{
            "motion": {{ "mass": 1 }}, "collider": {{ "geometry": {{ "shape": 0 }} }} }} }} }}"#
        )
    };
    let pivot = |other: usize| {
        format!(
            r#"{{ "name": "pivot-{other}", "extensions": {{ "KHR_physics_rigid_bodies": {{ "joint": {{ "connectedNode": {other}, "joint": 0 }} }} }} }}"#
        )
    };
    let bodies = [node("a", 0.0), node("b", 1.0), node("c", 2.0)];
    let scene = |joints: &[(usize, usize)]| {
        let mut nodes: Vec<String> = bodies.to_vec();
        let mut children = vec![Vec::new(); 3];
        for &(first, second) in joints {
            children[first].push(nodes.len());
            nodes.push(pivot(second));
        }
        for (node, children) in nodes.iter_mut().zip(&children) {
            if !children.is_empty() {
                *node = node.replacen('{', &format!(r#"{{ "children": {children:?}, "#), 1);
            }
        }
        let locked = r#"{ "limits": [ { "linearAxes": [0, 1, 2], "min": 0, "max": 0 }, { "angularAxes": [0, 1], "min": 0, "max": 0 } ] }"#;
        format!(
            r#"{{ "asset": {{ "version": "2.0" }}, "extensionsUsed": ["KHR_physics_rigid_bodies", "KHR_implicit_shapes"],
            "scene": 0, "scenes": [{{ "nodes": [0, 1, 2] }}], "nodes": [{}],
            "extensions": {{ "KHR_implicit_shapes": {{ "shapes": [{{ "type": "sphere", "sphere": {{ "radius": 0.1 }} }}] }},
              "KHR_physics_rigid_bodies": {{ "physicsJoints": [{locked}] }} }} }}"#,
            nodes.join(",")
        )
    };
    let build = |joints: &[(usize, usize)]| {
        let template = template(&scene(joints), "gltf");
        let field = template.field("joints.0.position").unwrap();
        template.varied(vec![field]).build(&[0.5 * PI])
    };
    let error = build(&[(0, 1), (1, 2), (2, 0)]).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("joints[0].position: cannot vary: other joints connect the same bodies"), "{error}");
    let open = build(&[(0, 1), (1, 2)]).unwrap().trial.world;
    let shut = states(&template(&scene(&[(0, 1), (1, 2)]), "gltf").varied(Vec::new()).build(&[]).unwrap().trial.world);
    let moved = states(&open);
    assert_eq!(moved[0][0], shut[0][0]);
    assert!((1..3).all(|body| (moved[body][1] - shut[body][1]).length() > 0.1));
}

/// The material of a collider keeps how it combines with others'.
#[test]
fn a_surface_keeps_its_rules() {
    let text = crates([2.0, 0.0, 1.0, 1.0, 2.0, 0.6, 0.5, 0.0, 1.0]).replace(
        r#""restitution": 0.0"#,
        r#""restitution": 0.0, "frictionCombine": "maximum", "restitutionCombine": "minimum""#,
    );
    let material = |values: &[(&str, f64)]| {
        let world = varied(&text, "gltf", values).world;
        let entity = BodyOrder::of(&world).entities()[1];
        *world.get::<&Collider>(entity).unwrap().material()
    };
    let (was, now) = (material(&[]), material(&[("bodies.box.collider.restitution", 0.5)]));
    assert_eq!(tumble::Material { restitution: 0.5 as Real, ..was }, now);
    assert_ne!(was.friction_combine, tumble::Material::default().friction_combine);
}
