//! Promise: what a scene file says of a joint is what the joint has, in JSON and in RON; and what
//! it cannot mean is refused with the field's name.
//!
//! Why: a limit that is read as that of another axis, or a drive without its greatest force, would
//! show only as a mechanism that moves wrongly. A field that does nothing is as bad as a wrong one.

use proptest::prelude::*;
use tumble::math::Real;
use tumble::{
    Axes, Breakable, Cone, Drive, Drives, Gain, Joint, JointFriction, JointSolver, Limit, Limits, Oscillation,
};
use tumble_scene::{Audit, Scene};

use crate::axes::AXES;
use crate::written_joints::Format;

/// The kinds with the numbers of their free axes.
const KINDS: [(&str, &[usize]); 8] = [
    ("ball", &[3, 4, 5]),
    ("hinge", &[3]),
    ("slider", &[0]),
    ("cylinder", &[0, 3]),
    ("universal", &[3, 4]),
    ("planar", &[1, 2, 3]),
    ("fixed", &[]),
    ("free", &[0, 1, 2, 3, 4, 5]),
];

/// A number that both precisions have to the bit.
fn number(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    range.prop_map(|number| f64::from(number as f32))
}

fn real(number: f64) -> Real {
    number as Real
}

#[derive(Clone, Debug)]
struct GainCase {
    fields: Vec<(&'static str, f64)>,
    is_acceleration: bool,
    gain: Gain,
}

fn gain() -> impl Strategy<Value = GainCase> {
    (0..5, number(0.0..1e4), number(0.0..1e2)).prop_map(|(kind, a, b)| {
        let case = |fields: &[_], gain| GainCase { fields: fields.to_vec(), is_acceleration: kind == 2, gain };
        let (stiffness, damping) = (real(a), real(b));
        match kind {
            0 => case(&[], Gain::Rigid),
            1 => case(&[("stiffness", a), ("damping", b)], Gain::Stiffness { stiffness, damping }),
            2 => case(&[("damping", b), ("stiffness", a)], Gain::Acceleration { stiffness, damping }),
            3 => case(
                &[("frequency", a), ("damping_ratio", b)],
                Gain::Frequency { hertz: stiffness, damping_ratio: damping },
            ),
            _ => case(&[("frequency", a)], Gain::Frequency { hertz: stiffness, damping_ratio: 1.0 }),
        }
    })
}

impl GainCase {
    fn write(&self, format: Format) -> Vec<(&'static str, String)> {
        let mut fields: Vec<_> = self.fields.iter().map(|(name, value)| (*name, format!("{value:?}"))).collect();
        if self.is_acceleration {
            fields.push(("mode", format.word("acceleration")));
        }
        fields
    }
}

/// Bounds, either of which may be missing, and how hard they are.
#[derive(Clone, Debug)]
struct LimitCase {
    bounds: [Option<f64>; 2],
    gain: GainCase,
}

fn limit(least: f64) -> impl Strategy<Value = LimitCase> {
    (number(least..3.0), number(least..3.0), 0..3, gain()).prop_map(|(a, b, which, gain)| {
        let bounds = [Some(a.min(b)).filter(|_| which != 1), Some(a.max(b)).filter(|_| which != 2)];
        LimitCase { bounds, gain }
    })
}

/// Ranges of less than a turn, wherever they are. A bound alone is within half a turn of zero.
fn limit_of_angle() -> impl Strategy<Value = LimitCase> {
    (limit(-3.0), number(-9.0..9.0)).prop_map(|(mut limit, by)| {
        if let [Some(min), Some(max)] = &mut limit.bounds {
            (*min, *max) = (f64::from((*min + by) as f32), f64::from((*max + by) as f32));
        }
        limit
    })
}

impl LimitCase {
    fn limit(&self) -> Limit {
        let [min, max] = self.bounds.map(|bound| bound.map(real));
        Limit { min: min.unwrap_or(Real::NEG_INFINITY), max: max.unwrap_or(Real::INFINITY), gain: self.gain.gain }
    }

    fn write(&self, format: Format) -> String {
        if let ([Some(min), Some(max)], Gain::Rigid) = (self.bounds, self.gain.gain) {
            return format.list(&[format!("{min:?}"), format!("{max:?}")]);
        }
        let named = ["min", "max"].into_iter().zip(self.bounds);
        let bounds = named.filter_map(|(name, bound)| bound.map(|bound| (name, format!("{bound:?}"))));
        format.object(&bounds.chain(self.gain.write(format)).collect::<Vec<_>>())
    }
}

#[derive(Clone, Debug)]
struct DriveCase {
    axes: Vec<usize>,
    position: Option<f64>,
    velocity: Option<f64>,
    max_force: Option<f64>,
    gain: GainCase,
    /// Amplitude, frequency and phase.
    oscillation: Option<[f64; 3]>,
}

impl DriveCase {
    fn drive(&self) -> Drive {
        Drive {
            axes: self.axes.iter().fold(Axes::NONE, |axes, axis| axes | AXES[*axis].1),
            position: self.position.map(real),
            velocity: self.velocity.map_or(0.0, real),
            gain: self.gain.gain,
            max_force: self.max_force.map_or(Real::INFINITY, real),
            oscillation: self.oscillation.map(|numbers| {
                let [amplitude, hertz, phase] = numbers.map(real);
                Oscillation { amplitude, hertz, phase }
            }),
        }
    }

    fn write(&self, format: Format) -> String {
        let axes: Vec<_> = self.axes.iter().map(|axis| format.word(AXES[*axis].0)).collect();
        let mut fields = vec![("axes", format!("[{}]", axes.join(", ")))];
        for (name, value) in [("velocity", self.velocity), ("position", self.position), ("max_force", self.max_force)] {
            fields.extend(value.map(|value| (name, format!("{value:?}"))));
        }
        fields.extend(self.gain.write(format));
        fields.extend(self.oscillation.map(|numbers| {
            let named = ["amplitude", "frequency", "phase"].into_iter().zip(numbers);
            let named: Vec<_> = named.map(|(name, number)| (name, format!("{number:?}"))).collect();
            ("oscillation", format.object(&named))
        }));
        format.object(&fields)
    }
}

#[derive(Clone, Debug)]
struct Case {
    kind: &'static str,
    limits: [Option<LimitCase>; 6],
    distance: Option<LimitCase>,
    cone: Option<([f64; 2], GainCase)>,
    drives: Vec<DriveCase>,
    friction: [Option<f64>; 6],
    breaks: [Option<f64>; 2],
}

/// A subset of the free axes of a kind.
fn axes_of(free: &'static [usize]) -> impl Strategy<Value = Vec<usize>> {
    prop::sample::subsequence(free, 1..=free.len()).prop_shuffle()
}

fn drive(free: &'static [usize]) -> impl Strategy<Value = DriveCase> {
    let numbers =
        (prop::option::of(number(-3.0..3.0)), prop::option::of(number(-9.0..9.0)), prop::option::of(number(0.0..99.0)));
    let oscillation = prop::option::of(prop::array::uniform3(number(-3.0..3.0)));
    (axes_of(free), numbers, gain(), oscillation).prop_map(
        |(axes, (mut position, velocity, max_force), gain, oscillation)| {
            if gain.fields.iter().any(|(name, _)| matches!(*name, "stiffness" | "frequency")) {
                position = position.or(Some(0.5));
            }
            let velocity = velocity.filter(|_| position.is_none() || gain.gain != Gain::Rigid);
            let oscillation = oscillation.filter(|_| position.is_some());
            DriveCase { axes, position, velocity, max_force, gain, oscillation }
        },
    )
}

fn case() -> impl Strategy<Value = Case> {
    prop::sample::select(KINDS.to_vec()).prop_flat_map(|(kind, free)| {
        let three = (
            prop::array::uniform3(prop::option::of(limit(-3.0))),
            prop::array::uniform3(prop::option::of(limit_of_angle())),
        );
        let six = three.prop_map(|([a, b, c], [d, e, f])| [a, b, c, d, e, f]);
        let drives: BoxedStrategy<Vec<DriveCase>> =
            if free.is_empty() { Just(Vec::new()).boxed() } else { prop::collection::vec(drive(free), 0..3).boxed() };
        let cone = prop::option::of((prop::array::uniform2(number(0.01..3.1)), gain()));
        let friction = prop::array::uniform6(prop::option::of(number(0.0..9.0)));
        let breaks = prop::array::uniform2(prop::option::of(number(0.1..9.0)));
        (six, prop::option::of(limit(0.0)), cone, drives, friction, breaks).prop_map(
            move |(mut limits, distance, cone, mut drives, mut friction, breaks)| {
                (0..6).filter(|axis| !free.contains(axis)).for_each(|axis| {
                    limits[axis] = None;
                    friction[axis] = None;
                });
                // Of three rotations only the twist can be limited alone.
                if free.ends_with(&[3, 4, 5]) {
                    (limits[4], limits[5]) = (None, None);
                }
                // Only one of those that do what it takes can be along an axis.
                let mut rigid = 0;
                drives.retain(|drive| drive.gain.gain != Gain::Rigid || std::mem::replace(&mut rigid, 1) == 0);
                let distance = distance.filter(|_| free.iter().any(|axis| *axis < 3));
                let cone = cone.filter(|_| free.ends_with(&[3, 4, 5]));
                Case { kind, limits, distance, cone, drives, friction, breaks }
            },
        )
    })
}

impl Case {
    fn write(&self, format: Format) -> String {
        let place = format.object(&[
            ("at", format.list(&["1", "2", "3"].map(str::to_owned))),
            ("axis", format.list(&["0", "0", "1"].map(str::to_owned))),
        ]);
        let mut fields = vec![("between", r#"["a", "b"]"#.to_owned()), (self.kind, place)];
        let mut limits: Vec<(&str, String)> = AXES
            .iter()
            .zip(&self.limits)
            .filter_map(|((name, _), limit)| Some((*name, limit.as_ref()?.write(format))))
            .collect();
        limits.extend(self.distance.iter().map(|limit| ("distance", limit.write(format))));
        limits.extend(self.cone.iter().map(|([y, z], gain)| {
            let angles = format.list(&[format!("{y:?}"), format!("{z:?}")]);
            let named = || [vec![("half_angles", angles.clone())], gain.write(format)].concat();
            ("cone", if gain.gain == Gain::Rigid { angles.clone() } else { format.object(&named()) })
        }));
        if !limits.is_empty() {
            fields.push(("limits", format.object(&limits)));
        }
        if !self.drives.is_empty() {
            let drives: Vec<_> = self.drives.iter().map(|drive| drive.write(format)).collect();
            fields.push(("drives", format!("[{}]", drives.join(", "))));
        }
        let named = |names: &[&'static str], values: &[Option<f64>]| -> Vec<(&'static str, String)> {
            names.iter().zip(values).filter_map(|(name, value)| Some((*name, format!("{:?}", (*value)?)))).collect()
        };
        let friction = named(&AXES.map(|(name, _)| name), &self.friction);
        if !friction.is_empty() {
            fields.push(("friction", format.object(&friction)));
        }
        let breaks = named(&["force", "torque"], &self.breaks);
        if !breaks.is_empty() {
            fields.push(("break", format.object(&breaks)));
        }
        format.object(&fields)
    }

    fn limits(&self) -> Option<Limits> {
        let limits = Limits {
            axes: std::array::from_fn(|axis| self.limits[axis].as_ref().map(LimitCase::limit)),
            distance: self.distance.as_ref().map(LimitCase::limit),
            cone: self.cone.as_ref().map(|(angles, gain)| Cone { half_angles: angles.map(real), gain: gain.gain }),
        };
        (limits != Limits::default()).then_some(limits)
    }

    fn friction(&self) -> Option<JointFriction> {
        let is_there = self.friction.iter().any(Option::is_some);
        is_there.then(|| JointFriction { max: self.friction.map(|max| max.map_or(0.0, real)) })
    }

    fn breakable(&self) -> Option<Breakable> {
        let [max_force, max_torque] = self.breaks.map(|most| most.map_or(Real::INFINITY, real));
        let is_there = self.breaks.iter().any(Option::is_some);
        is_there.then_some(Breakable { max_force, max_torque, is_broken: false })
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_joint_has_what_its_file_says(case in case()) {
        for format in [Format::Json, Format::Ron] {
            let text = case.write(format);
            let world = format.open(&text).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
            let joint = world.iter().find(hecs::EntityRef::has::<Joint>).unwrap();
            prop_assert_eq!(joint.get::<&Limits>().map(|limits| *limits), case.limits(), "{}", text);
            let drives: Vec<_> = case.drives.iter().map(DriveCase::drive).collect();
            prop_assert_eq!(joint.get::<&Drives>().map_or(Vec::new(), |drives| drives.0.clone()), drives, "{}", text);
            prop_assert_eq!(joint.get::<&JointFriction>().map(|friction| *friction), case.friction(), "{}", text);
            prop_assert_eq!(joint.get::<&Breakable>().map(|breakable| *breakable), case.breakable(), "{}", text);
        }
    }
}

/// A rope from a point of the one to a point of the other, that three names of axes go with, and a
/// round cone by a number.
#[test]
fn short_forms_are_understood() {
    let rope = r#"{ "between": ["a", "b"], "free": { "at": [0, 1, 0], "to": [2, 0, 0] }, "limits": { "distance": { "max": 3 } } }"#;
    let world = Format::Json.open(rope).unwrap();
    let joint = *world.query::<&Joint>().iter().next().unwrap();
    assert_eq!(joint.frames.map(|frame| frame.position.to_array()), [[0.0, 1.0, 0.0], [2.0, 0.0, 0.0]]);
    assert_eq!(joint.free, Axes::LINEAR | Axes::ANGULAR);
    let limit = world.query::<&Limits>().iter().next().unwrap().distance;
    assert_eq!(limit, Some(Limit::new(Real::NEG_INFINITY, 3.0)));

    let ball = r#"{ "between": ["a", "b"], "ball": { "at": [0, 0, 0] }, "limits": { "cone": 1 },
        "drives": [ { "axes": ["angular"], "damping": 2 } ] }"#;
    let world = Format::Json.open(ball).unwrap();
    assert_eq!(*world.query::<&Limits>().iter().next().unwrap(), Limits::cone(1.0));
    let drive = Drive::velocity(Axes::ANGULAR, 0.0).with_stiffness(0.0, 2.0);
    assert_eq!(*world.query::<&Drives>().iter().next().unwrap(), Drives::from(drive));
}

/// What a hinge is given, and what is said of it.
const OF_HINGE: &[(&str, &str)] = &[
    (r#""limits": {}"#, "joints[0].limits: needs an axis"),
    (r#""limits": { "angular": [0, 1] }"#, "joints[0].limits.angular: unknown field `angular`"),
    (r#""limits": { "angular_y": [0, 1] }"#, "joints[0].limits.angular_y: does nothing: the joint locks that axis"),
    (r#""limits": { "linear_x": [0, 1] }"#, "joints[0].limits.linear_x: does nothing"),
    (r#""limits": { "distance": [0, 1] }"#, "joints[0].limits.distance: does nothing"),
    (r#""limits": { "cone": 1 }"#, "joints[0].limits.cone: does nothing"),
    (r#""limits": { "angular_x": [1, 0] }"#, "joints[0].limits.angular_x.min: is more than max: 1 and 0"),
    (r#""limits": { "angular_x": [0] }"#, "joints[0].limits.angular_x: invalid length 1"),
    (r#""limits": { "angular_x": {} }"#, "joints[0].limits.angular_x: needs min or max"),
    (r#""limits": { "angular_x": { "max": 4 } }"#, "joints[0].limits.angular_x: is a range of more than a turn"),
    (r#""limits": { "angular_x": [-3, 3.5] }"#, "joints[0].limits.angular_x: is a range of more than a turn"),
    (r#""limits": { "angular_x": { "min": 4 } }"#, "joints[0].limits.angular_x.min: is 4, more than pi: give max too"),
    (r#""limits": { "angular_x": { "max": -4 } }"#, "limits.angular_x.max: is -4, less than -pi: give min too"),
    (r#""limits": { "angular_x": { "min": 0, "stiffness": -1 } }"#, "limits.angular_x.stiffness: must not be negative"),
    (
        r#""limits": { "angular_x": { "min": 0, "stiffness": 1, "frequency": 1 } }"#,
        "limits.angular_x.frequency: is for",
    ),
    (r#""limits": { "angular_x": { "min": 0, "damping_ratio": 1 } }"#, "limits.angular_x.frequency: is missing"),
    (
        r#""limits": { "angular_x": { "min": 0, "frequency": 1, "damping_ratio": -1 } }"#,
        "damping_ratio: must not be negative",
    ),
    (r#""limits": { "angular_x": { "min": 0, "mode": "force" } }"#, "limits.angular_x.mode: is for"),
    (r#""limits": { "angular_x": { "min": 0, "mode": "speed", "damping": 1 } }"#, "unknown variant `speed`"),
    (r#""drives": [ {} ]"#, "joints[0].drives[0].axes: is missing"),
    (r#""drives": [ { "axes": ["sideways"] } ]"#, "drives[0].axes[0]: unknown variant `sideways`"),
    (r#""drives": [ { "axes": ["angular_z"] } ]"#, "drives[0].axes.angular_z: does nothing: the joint locks that axis"),
    (r#""drives": [ { "axes": ["angular"] } ]"#, "drives[0].axes.angular_y: does nothing"),
    (r#""drives": [ { "axes": ["angular_x", "angular_x"] } ]"#, "drives[0].axes: angular_x is there twice"),
    (
        r#""drives": [ { "axes": ["angular_x"], "stiffness": 1 } ]"#,
        "drives[0].stiffness: does nothing without a position",
    ),
    (
        r#""drives": [ { "axes": ["angular_x"], "frequency": 1 } ]"#,
        "drives[0].frequency: does nothing without a position",
    ),
    (r#""drives": [ { "axes": ["angular_x"], "position": 1, "velocity": 1 } ]"#, "drives[0].velocity: does nothing"),
    (r#""drives": [ { "axes": ["angular_x"], "max_force": -1 } ]"#, "drives[0].max_force: must not be negative"),
    (r#""drives": [ { "axes": ["angular_x"], "velocity": 1e300, "max_force": 1e300 } ]"#, "drives[0]"),
    (
        r#""drives": [ { "axes": ["angular_x"] }, { "axes": ["angular_x"], "position": 1 } ]"#,
        "drives[1].axes: another drive",
    ),
    (r#""friction": {}"#, "joints[0].friction: needs an axis"),
    (r#""friction": { "angular_x": -0.5 }"#, "joints[0].friction.angular_x: must not be negative"),
    (r#""friction": { "linear_y": 0.5 }"#, "joints[0].friction.linear_y: does nothing"),
    (r#""break": {}"#, "joints[0].break: needs force or torque"),
    (r#""break": { "force": 0 }"#, "joints[0].break.force: must be positive"),
    (r#""break": { "torque": -2 }"#, "joints[0].break.torque: must be positive"),
];

/// Limits of a free joint, and what is said of them.
const OF_FREE: &[(&str, &str)] = &[
    (r#"{ "cone": 0 }"#, "joints[0].limits.cone.half_angles: must be more than 0 and less than pi, not 0"),
    (r#"{ "cone": [1, 3.2] }"#, "limits.cone.half_angles: must be more than 0 and less than pi, not 3.2"),
    (r#"{ "cone": {} }"#, "limits.cone.half_angles: is missing"),
    (r#"{ "cone": { "half_angles": [1, 1], "damping": -1 } }"#, "limits.cone.damping: must not be negative"),
    (r#"{ "distance": [-1, 1] }"#, "limits.distance.min: must not be negative"),
    (r#"{ "distance": { "max": -1 } }"#, "limits.distance.max: must not be negative"),
];

#[test]
fn what_a_joint_cannot_mean_is_refused_with_its_field() {
    for (options, problem) in OF_HINGE {
        let joint =
            format!(r#"{{ "between": ["a", "b"], "hinge": {{ "at": [0, 0, 0], "axis": [1, 0, 0] }}, {options} }}"#);
        let refused = Format::Json.open(&joint).err();
        if options.contains("1e300") && size_of::<Real>() == 8 {
            // Double precision has the number.
            assert_eq!(refused, None);
            continue;
        }
        let error = refused.unwrap_or_default();
        assert!(error.contains(problem), "{options}: {error:?} is not {problem:?}");
    }
    for (limits, problem) in OF_FREE {
        let joint = format!(r#"{{ "between": ["a", "b"], "free": {{ "at": [0, 0, 0] }}, "limits": {limits} }}"#);
        let error = Format::Json.open(&joint).err().unwrap_or_default();
        assert!(error.contains(problem), "{limits}: {error:?} is not {problem:?}");
    }
    // RON has what JSON has not.
    for number in ["NaN", "inf", "-inf"] {
        for options in [
            "limits: (angular_x: (min: #))",
            "drives: [(axes: [angular_x], velocity: #)]",
            "friction: (angular_x: #)",
            "break: (force: #)",
        ] {
            let options = options.replace('#', number);
            let joint = format!(r#"(between: ("a", "b"), hinge: (at: (0, 0, 0), axis: (1, 0, 0)), {options})"#);
            let error = Format::Ron.open(&joint).err().unwrap_or_default();
            assert!(error.contains("joints[0]."), "{options}: {error:?}");
        }
    }
}

/// What an audit shows of a joint is what its file says; and a wrong one does not hide the others.
#[test]
fn an_audit_shows_joints_and_what_is_wrong_with_them() {
    let scene = |joints: &str| {
        let body = |name| format!(r#"{{ "name": "{name}", "shape": {{ "sphere": {{ "radius": 0.1 }} }}, "mass": 1 }}"#);
        format!(r#"{{ "bodies": [ {}, {} ], "joints": [ {joints} ] }}"#, body("a"), body("b"))
    };
    let door = r#"{ "name": "door", "between": ["a", "b"], "contacts": true, "hinge": { "at": [0, 0, 0], "axis": [0, 1, 0] },
        "limits": { "angular_x": [-1, 2] }, "friction": { "angular_x": 0.25 }, "break": { "torque": 30 },
        "drives": [ { "axes": ["angular_x"], "position": 0.5, "stiffness": 8, "damping": 2, "max_force": 4 } ] }"#;
    let wrong = r#"{ "between": ["b", "a"], "hinge": { "at": [0, 0, 0], "axis": [0, 1, 0] }, "limits": { "linear_x": [0, 1] } }"#;
    let audit = Audit::from_json(&scene(door), "door.json").unwrap();
    assert!(!audit.has_problems());
    let expected = serde_json::json!([{ "name": "door", "kind": "hinge", "between": ["a", "b"], "free": ["angular_x"],
        "limits": [{ "of": "angular_x", "min": -1.0, "max": 2.0 }],
        "drives": [{ "of": ["angular_x"], "position": 0.5, "velocity": 0.0, "max_force": 4.0,
            "gain": { "mode": "force", "stiffness": 8.0, "damping": 2.0 } }],
        "friction": [{ "of": "angular_x", "max": 0.25 }], "breaks": { "torque": 30.0 }, "contacts": true }]);
    assert_eq!(serde_json::to_value(&audit.joints).unwrap(), expected);
    let shoulder = r#"{ "between": ["a", "b"], "ball": { "at": [0, 0, 0] }, "limits": { "cone": { "half_angles": [1.25, 0.75] } } }"#;
    let audit = Audit::from_json(&scene(shoulder), "shoulder.json").unwrap();
    let cone = serde_json::to_value(&audit.joints[0].limits).unwrap();
    assert_eq!(cone, serde_json::json!([{ "of": "cone", "half_angles": [1.25, 0.75] }]));
    let audit = Audit::from_json(&scene(&format!("{wrong}, {door}")), "door.json").unwrap();
    assert!(audit.has_problems());
    let [first, second] = [&audit.joints[0], &audit.joints[1]];
    assert_eq!((first.name.as_str(), first.between.join(" ")), ("joints[0]", "b a".to_owned()));
    assert_eq!(first.problems, ["limits.linear_x: does nothing: the joint locks that axis"]);
    assert!(second.problems.is_empty() && second.kind == "hinge");
}

#[test]
fn a_scene_says_how_joints_are_solved() {
    let of = |text: &str| Scene::from_json(text, "scene.x").map(|scene| scene.settings.joint_solver);
    assert_eq!(of("{}").unwrap(), JointSolver::Auto);
    for solver in JointSolver::ALL {
        assert_eq!(of(&format!(r#"{{ "joint_solver": "{solver}" }}"#)).unwrap(), solver);
    }
    let error = of(r#"{ "joint_solver": "soft" }"#).unwrap_err().to_string();
    assert!(error.contains("joint_solver") && error.contains("unknown joint solver 'soft'"), "{error}");
}
