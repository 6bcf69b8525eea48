//! Promise: the joints of a robot hold its links as the file says: where, about which axis, in
//! which sense and how far; links that fixed joints connect are one body with exactly their mass
//! together.
//!
//! Why: an axis that is taken in the wrong frame, or a sense of rotation the wrong way round, gives
//! a robot that moves and looks right until it is driven.
#![cfg_attr(
    feature = "f64",
    allow(clippy::useless_conversion, clippy::unnecessary_cast, reason = "Real is f64 here, f32 in the other build")
)]

use glam::{DMat3, DQuat, DVec3};
use hecs::World;
use proptest::prelude::*;
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    Axes, BodyId, BodyOrder, Drive, Drives, InertiaTensor, Joint, JointFriction, JointLoad, Limit, Limits,
    MassProperties, Pose, RigidBody, Shape, Simulation, state_hash,
};
use tumble_import::{InertiaRepairs, Robot};
use tumble_math::MovingBody;
use tumble_scene::{Audit, BodyNames, Scene};

fn dvec3(v: Vec3) -> DVec3 {
    DVec3::from_array(v.to_array().map(f64::from))
}

fn dquat(q: Quat) -> DQuat {
    DQuat::from_array(q.to_array().map(f64::from))
}

fn words(v: DVec3) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

/// A link of one kilogram with its centre of mass there.
fn link(name: &str, center: DVec3) -> String {
    format!(
        r#"<link name="{name}"><inertial><origin xyz="{}"/><mass value="1"/>
        <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial></link>"#,
        words(center)
    )
}

fn joint(name: &str, kind: &str, [parent, child]: [&str; 2], inside: &str) -> String {
    format!(r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>"#)
}

fn robot(parts: &[String]) -> String {
    format!("<robot name=\"r\">\n{}\n</robot>", parts.join("\n"))
}

const WORLD: &str = r#"<link name="world"/>"#;

struct Running {
    world: World,
    simulation: Simulation,
    names: BodyNames,
}

impl Running {
    fn of(text: &str) -> Self {
        let scene = Scene::from_urdf(text, "r.urdf").unwrap();
        let simulation = Simulation::new(scene.settings).unwrap();
        let mut world = World::new();
        let names = scene.spawn(&mut world).unwrap();
        Self { world, simulation, names }
    }

    fn load(&self, joint: &str) -> JointLoad {
        *self.world.get::<&JointLoad>(self.names.joint(joint).unwrap()).unwrap()
    }

    fn pose(&self, body: &str) -> Pose {
        let mut query = self.world.query::<(&BodyId, &Pose)>();
        *query.iter().find(|(id, _)| self.names.of(id.0) == body).unwrap().1
    }

    /// The frames of a joint in the world.
    fn frames(&self, joint: &str) -> [(DVec3, DQuat); 2] {
        let joint = *self.world.get::<&Joint>(self.names.joint(joint).unwrap()).unwrap();
        [0, 1].map(|end| {
            let (body, frame) = (*self.world.get::<&Pose>(joint.bodies[end]).unwrap(), joint.frames[end]);
            let (turned, position) = (dquat(body.orientation), dvec3(frame.position));
            (dvec3(body.position) + turned * position, turned * dquat(frame.orientation))
        })
    }
}

/// A link of a random tree: its parent, how it hangs on it, and what it weighs.
#[derive(Clone, Debug)]
struct Drawn {
    parent: f64,
    kind: usize,
    xyz: DVec3,
    rpy: DVec3,
    axis: DVec3,
    center: DVec3,
    inertial_rpy: DVec3,
    mass: f64,
    sides: DVec3,
    has_inertial: bool,
}

const KINDS: [&str; 6] = ["fixed", "revolute", "continuous", "prismatic", "planar", "floating"];

fn vector(reach: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-reach..reach).prop_map(DVec3::from_array)
}

fn drawn() -> impl Strategy<Value = Drawn> {
    let axis = prop_oneof![
        vector(1.0).prop_filter("it has a direction", |axis| axis.length() > 0.1),
        prop::sample::select(vec![DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z]),
    ];
    let place = (0.0..1.0, 0..KINDS.len(), vector(1.0), vector(3.0), axis);
    let mass = (vector(0.3), vector(3.0), 0.1..10.0, prop::array::uniform3(0.05..0.5), 0.0..1.0);
    (place, mass).prop_map(|((parent, kind, xyz, rpy, axis), (center, inertial_rpy, mass, sides, weighs))| Drawn {
        parent,
        kind,
        xyz,
        rpy,
        axis,
        center,
        inertial_rpy,
        mass,
        sides: DVec3::from_array(sides),
        has_inertial: weighs < 0.8,
    })
}

/// By matrices, not by what is tested.
fn rotation([roll, pitch, yaw]: [f64; 3]) -> DMat3 {
    DMat3::from_rotation_z(yaw) * DMat3::from_rotation_y(pitch) * DMat3::from_rotation_x(roll)
}

impl Drawn {
    /// The moments of a block about its centre, along its axes.
    fn moments(&self) -> DVec3 {
        let squares = self.sides * self.sides;
        (DVec3::splat(squares.element_sum()) - squares) * (self.mass / 12.0)
    }

    fn text(&self, index: usize) -> String {
        if !self.has_inertial {
            return format!(r#"<link name="l{index}"/>"#);
        }
        let [x, y, z] = self.moments().to_array();
        format!(
            r#"<link name="l{index}"><inertial><origin xyz="{}" rpy="{}"/><mass value="{}"/>
            <inertia ixx="{x}" ixy="0" ixz="0" iyy="{y}" iyz="0" izz="{z}"/></inertial></link>"#,
            words(self.center),
            words(self.inertial_rpy),
            self.mass
        )
    }

    fn parent(&self, index: usize) -> usize {
        (self.parent * index as f64) as usize
    }

    fn joint(&self, index: usize) -> String {
        let inside = format!(
            r#"<origin xyz="{}" rpy="{}"/><axis xyz="{}"/><limit lower="-1" upper="1" effort="1" velocity="1"/>"#,
            words(self.xyz),
            words(self.rpy),
            words(self.axis)
        );
        let ends = [format!("l{}", self.parent(index)), format!("l{index}")];
        joint(&format!("j{index}"), KINDS[self.kind], ends.each_ref().map(String::as_str), &inside)
    }
}

/// Where the links are, by matrices.
fn places(links: &[Drawn]) -> Vec<(DVec3, DMat3)> {
    let mut places = vec![(DVec3::ZERO, DMat3::IDENTITY)];
    for (index, link) in links.iter().enumerate().skip(1) {
        let (position, turned) = places[link.parent(index)];
        places.push((position + turned * link.xyz, turned * rotation(link.rpy.to_array())));
    }
    places
}

fn tree(links: &[Drawn]) -> String {
    let mut parts: Vec<String> = links.iter().enumerate().map(|(index, link)| link.text(index)).collect();
    parts.extend(links.iter().enumerate().skip(1).map(|(index, link)| link.joint(index)));
    robot(&parts)
}

/// Some roundings of lengths up to a dozen metres, which ten joints in a row reach.
const ROUNDING: f64 = 60.0 * Real::EPSILON as f64;

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Frames of a joint coincide at the start, are where the chain of origins puts the child, and
    /// have x along the axis.
    #[test]
    fn joints_of_random_trees_are_where_the_file_puts_them(links in prop::collection::vec(drawn(), 1..10)) {
        let running = Running::of(&tree(&links));
        let places = places(&links);
        let mut count = 0;
        for (index, link) in links.iter().enumerate().skip(1) {
            let Some(_) = running.names.joint(&format!("j{index}")) else { continue };
            count += 1;
            prop_assert!(!["fixed", "floating"].contains(&KINDS[link.kind]));
            let [(a, qa), (b, qb)] = running.frames(&format!("j{index}"));
            let (position, turned) = places[index];
            prop_assert!((a - b).length() <= ROUNDING && (a - position).length() <= ROUNDING, "{a} {b} {position}");
            prop_assert!(1.0 - qa.dot(qb).abs() <= ROUNDING, "{qa} {qb}");
            prop_assert!((qa * DVec3::X - turned * link.axis.normalize()).length() <= ROUNDING, "{qa}");
        }
        prop_assert_eq!(count, running.world.query::<&Joint>().iter().count());
        // Nothing is pushed but by gravity: the first step moves no anchor from the other.
        let Running { mut world, mut simulation, names } = running;
        simulation.step(&mut world);
        let running = Running { world, simulation, names };
        for (index, link) in links.iter().enumerate().skip(1) {
            if let Some(joint) = running.names.joint(&format!("j{index}")) && KINDS[link.kind] != "prismatic" && KINDS[link.kind] != "planar" {
                let [(a, _), (b, _)] = running.frames(&format!("j{index}"));
                // Light links under load yield a little; a wrong frame would be off by its length.
                prop_assert!((a - b).length() < 1e-4, "{joint:?}: {a} {b}");
            }
        }
    }

    /// Mass, centre and moments of bodies are those of the welds of their links, by another way.
    #[test]
    fn links_that_do_not_move_against_each_other_are_one_body(mut links in prop::collection::vec(drawn(), 1..8)) {
        for (index, link) in links.iter_mut().enumerate() {
            link.kind = 0;
            link.has_inertial |= index == 0;
        }
        let (mut bodies, names) =
            Robot::from_text(&tree(&links), "r.urdf", InertiaRepairs::Refused).unwrap().into_bodies("r.urdf").unwrap();
        prop_assert_eq!((bodies.len(), names), (1, vec!["l0".to_owned()]));
        let found = *bodies.remove(0).body.properties().unwrap();
        let places = places(&links);
        let moving = |(link, (position, turned)): (&Drawn, &(DVec3, DMat3))| link.has_inertial.then(|| MovingBody {
            properties: MassProperties::new(link.mass, DVec3::ZERO, InertiaTensor::from_principal(link.moments(), DQuat::IDENTITY).unwrap()).unwrap(),
            position: *position + *turned * link.center,
            orientation: DQuat::from_mat3(&(*turned * rotation(link.inertial_rpy.to_array()))),
            linear_velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
        });
        let expected = tumble_math::weld(links.iter().zip(&places).filter_map(moving)).unwrap().properties;
        // Some roundings of a sum of eight.
        let near = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-13 * scale;
        prop_assert!(near(found.mass(), expected.mass(), expected.mass()));
        prop_assert!((found.center_of_mass() - expected.center_of_mass()).length() <= 1e-13 * 10.0);
        let (found, expected) = (found.tensor_about_center().to_cols_array(), expected.tensor_about_center().to_cols_array());
        let scale = expected.iter().fold(0.0, |most: f64, element| most.max(element.abs()));
        prop_assert!(found.iter().zip(expected).all(|(a, b)| near(*a, b, scale)), "{found:?} {expected:?}");
    }
}

/// An arm of two links through the file and through the engine's own builders: the same bits, with
/// limits, damping and friction.
#[test]
fn an_arm_is_the_same_as_one_made_by_hand() {
    let elbow =
        r#"<origin xyz="0 0 -1"/><axis xyz="1 0 0"/><limit lower="-0.5" upper="0.25" effort="9" velocity="2"/>"#;
    let text = robot(&[
        WORLD.to_owned(),
        link("upper", DVec3::NEG_Z * 0.5),
        link("lower", DVec3::new(0.0, 0.25, -0.25)),
        joint("shoulder", "continuous", ["world", "upper"], r#"<dynamics damping="0.125"/>"#),
        joint("elbow", "revolute", ["upper", "lower"], &format!(r#"{elbow}<dynamics friction="0.0625"/>"#)),
    ]);
    let mut running = Running::of(&text);
    let mut world = World::new();
    let inertia = || InertiaTensor::from_principal(DVec3::new(0.02, 0.03, 0.04), DQuat::IDENTITY).unwrap();
    let body = |id: u64, center: DVec3, z: Real| {
        let body = RigidBody::new(Shape::Point).mass(1.0).center_of_mass(center).inertia(inertia()).id(BodyId(id));
        body.position(Vec3::Z * z).build().unwrap()
    };
    let base = RigidBody::new(Shape::Point).fixed().id(BodyId(0)).build().unwrap().spawn(&mut world);
    let upper = body(1, DVec3::NEG_Z * 0.5, 0.0).spawn(&mut world);
    let lower = body(2, DVec3::new(0.0, 0.25, -0.25), -1.0).spawn(&mut world);
    let frame = |y: Real, z: Real| Pose { position: Vec3::new(0.0, y, z), orientation: Quat::IDENTITY };
    let shoulder = Joint::hinge(base, upper).with_frames(frame(0.0, 0.0), frame(0.0, 0.5));
    let damper = Drive::velocity(Axes::ANGULAR_X, 0.0).with_stiffness(0.0, 0.125);
    world.spawn((shoulder, Drives::from(damper), JointLoad::default()));
    let elbow = Joint::hinge(upper, lower).with_frames(frame(0.0, -0.5), frame(-0.25, 0.25));
    let limits = Limits::along(Axes::ANGULAR_X, Limit::new(-0.5, 0.25));
    world.spawn((elbow, limits, JointFriction::along(Axes::ANGULAR_X, 0.0625), JointLoad::default()));
    let mut simulation = Simulation::new(*running.simulation.settings()).unwrap();
    let mut furthest = [0.0_f64; 2];
    for _ in 0..240 {
        running.simulation.step(&mut running.world);
        simulation.step(&mut world);
        let hash = |world: &World| state_hash(world, &BodyOrder::of(world));
        assert_eq!(hash(&running.world), hash(&world));
        let angle = f64::from(running.load("elbow").values[3]);
        furthest = [furthest[0].min(angle), furthest[1].max(angle)];
    }
    // It swings out by more than a hundredth, and stays within its range.
    assert!(furthest[0] > -0.5001 && furthest[1] < 0.2501 && furthest[1] - furthest[0] > 0.01, "{furthest:?}");
}

/// A bar at a right angle to its hinge falls to the bound that the right-hand rule names, for every
/// sense of the axis and with the joint turned.
#[test]
fn limits_hold_in_the_sense_of_the_axis() {
    for (sense, bound) in [(1.0, 0.5), (-1.0, -0.75)] {
        for yaw in [0.0, 1.0, 3.0] {
            // About y a bar along x falls by a positive angle: x turns to -z.
            let hinge = format!(
                r#"<origin xyz="0.3 0.2 1" rpy="0 0 {yaw}"/><axis xyz="0 {} 0"/>
                <limit lower="-0.75" upper="0.5" effort="1" velocity="1"/><dynamics damping="0.1"/>"#,
                3.0 * sense
            );
            let bar = link("bar", DVec3::X * 0.4);
            let parts = [WORLD.to_owned(), bar, joint("hinge", "revolute", ["world", "bar"], &hinge)];
            let mut running = Running::of(&robot(&parts));
            running.simulation.step_many(&mut running.world, 180);
            let angle = f64::from(running.load("hinge").values[3]);
            // A limit is met to rounding; at rest nothing pushes past it.
            assert!((angle - bound).abs() < 1e-5, "{sense} {yaw}: {angle}");
            let down = dquat(running.pose("bar").orientation) * DVec3::X;
            assert!((down.z + (bound * sense).sin()).abs() < 1e-5, "{sense} {yaw}: {down}");
        }
    }
}

/// A carriage slides down its axis to the lower bound, and a plate moves in its plane only.
#[test]
fn a_carriage_slides_and_a_plate_stays_in_its_plane() {
    let rail =
        r#"<origin xyz="0 0 2"/><axis xyz="0 0.6 0.8"/><limit lower="-0.5" upper="0.5" effort="1" velocity="1"/>"#;
    let parts =
        [WORLD.to_owned(), link("carriage", DVec3::ZERO), joint("rail", "prismatic", ["world", "carriage"], rail)];
    let mut running = Running::of(&robot(&parts));
    running.simulation.step_many(&mut running.world, 120);
    let at = dvec3(running.pose("carriage").position);
    assert!((at - DVec3::new(0.0, -0.3, 1.6)).length() < 1e-5, "{at}");

    let table = r#"<axis xyz="0 0.6 0.8"/>"#;
    let parts = [WORLD.to_owned(), link("plate", DVec3::X * 0.2), joint("table", "planar", ["world", "plate"], table)];
    let mut running = Running::of(&robot(&parts));
    running.simulation.step_many(&mut running.world, 30);
    let time = running.simulation.time();
    let at = dvec3(running.pose("plate").position) - DVec3::X * 0.2;
    let normal = DVec3::new(0.0, 0.6, 0.8);
    assert!(at.dot(normal).abs() < 1e-5, "{at}");
    // It falls along the plane: by the part of gravity that lies in it, sin = 0.6.
    let along = at.dot(DVec3::new(0.0, 0.8, -0.6));
    assert!((along - 0.5 * 9.81 * 0.6 * time * time).abs() < 1e-4, "{along} in {time}");
}

/// Which bodies there are, and which of them move.
#[test]
fn the_root_is_free_unless_it_is_the_world_or_weighs_nothing() {
    let moving = |parts: &[String]| {
        let scene = Scene::from_urdf(&robot(parts), "r.urdf").unwrap();
        let count = scene.body_count();
        let free: Vec<bool> = (0..count).map(|index| scene.is_free(index)).collect();
        let names = scene.spawn(&mut World::new()).unwrap();
        (0..count).map(|index| format!("{} {}", names.of(index as u64), free[index])).collect::<Vec<_>>()
    };
    let arm = link("arm", DVec3::ZERO);
    let empty = |name: &str| format!(r#"<link name="{name}"/>"#);
    let turn = |ends| joint("turn", "continuous", ends, "");
    let weld = |ends| joint("weld", "fixed", ends, "");
    let base = link("base", DVec3::X);
    assert_eq!(moving(&[base.clone(), arm.clone(), turn(["base", "arm"])]), ["base true", "arm true"]);
    assert_eq!(moving(&[empty("base"), arm.clone(), turn(["base", "arm"])]), ["base false", "arm true"]);
    assert_eq!(moving(&[empty("base"), arm.clone(), weld(["base", "arm"])]), ["arm true"]);
    assert_eq!(moving(&[WORLD.into(), arm.clone(), weld(["world", "arm"])]), ["world false"]);
    assert_eq!(moving(&[WORLD.into(), arm.clone(), joint("f", "floating", ["world", "arm"], "")]), ["arm true"]);
    let footprint = [empty("foot"), base.clone(), arm.clone(), weld(["foot", "base"]), turn(["base", "arm"])];
    assert_eq!(moving(&footprint), ["base true", "arm true"]);
    // A wheel that weighs nothing is held by what it hangs on.
    assert_eq!(moving(&[base, empty("wheel"), turn(["base", "wheel"])]), ["base true"]);
}

#[test]
fn what_of_joints_is_not_simulated_is_reported() {
    let limited =
        |lower: f64, upper: f64| format!(r#"<limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>"#);
    let parts: Vec<String> = ["base", "a", "b", "c", "d"].map(|name| link(name, DVec3::ZERO)).into();
    let joints = [
        joint("finger", "prismatic", ["base", "a"], &format!(r#"{}<mimic joint="table"/>"#, limited(0.0, 1.0))),
        joint("bare", "revolute", ["base", "b"], ""),
        joint("far", "revolute", ["base", "c"], &limited(-2.0, 4.5)),
        joint("table", "planar", ["base", "d"], r#"<dynamics damping="1"/>"#),
        r#"<link name="tip"/>"#.to_owned(),
        joint("tool", "continuous", ["d", "tip"], ""),
    ];
    let scene = Scene::from_urdf(&robot(&[parts, joints.to_vec()].concat()), "r.urdf").unwrap();
    assert_eq!(
        scene.notices,
        [
            "1 joint to what has no inertial, held as if fixed: tool",
            "1 joint with mimic that ties nothing, not simulated: finger",
            "1 revolute joint without limit, taken for continuous: bare",
            "1 revolute joint with a range of a turn or more, which bounds nothing: far",
            "1 joint with several axes, whose dynamics is not simulated: table",
        ]
    );
    assert_eq!(scene.body_count(), 5);
}

#[test]
fn mistakes_of_joints_are_reported() {
    for (kind, inside, problem) in [
        (
            "revolute",
            r#"<limit lower="1" upper="-1"/>"#,
            "joint \"j\".limit.lower: is 1, more than the upper one, -1, at line 4",
        ),
        ("revolute", r#"<limit lower="x" upper="1"/>"#, "joint \"j\".limit.lower: \"x\" is not a number, at line 4"),
        ("revolute", r#"<limit effort="1e999"/>"#, "joint \"j\".limit.effort: inf is not a finite number, at line 4"),
        ("revolute", "<limit/><limit/>", "joint \"j\".limit: is given twice, at line 4"),
        ("continuous", r#"<axis xyz="0 0 0"/>"#, "joint \"j\".axis.xyz: is zero: give a direction, at line 4"),
        (
            "prismatic",
            r#"<axis xyz="0 0"/>"#,
            "joint \"j\".axis.xyz: \"0 0\" is not three numbers with spaces between them, at line 4",
        ),
        (
            "prismatic",
            r#"<dynamics damping="-1"/>"#,
            "joint \"j\".dynamics.damping: must not be negative, as -1 is, at line 4",
        ),
        (
            "continuous",
            r#"<origin xyz="0 0 1e12"/>"#,
            "joint \"j\".origin: is more than 1e9 m from the centre of mass of a body",
        ),
    ] {
        let parts = [
            link("a", DVec3::ZERO).replace('\n', ""),
            link("b", DVec3::ZERO).replace('\n', ""),
            joint("j", kind, ["a", "b"], inside),
        ];
        let audit = Audit::from_urdf(&robot(&parts), "r.urdf").unwrap();
        assert_eq!(audit.bodies[1].problems, [problem], "{inside}");
        let error = Scene::from_urdf(&robot(&parts), "r.urdf").unwrap_err().to_string();
        assert!(error.starts_with("r.urdf: link \"b\", field joint \"j\"."), "{error}");
    }
}
