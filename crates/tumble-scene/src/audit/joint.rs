//! Joints as an audit shows them.

use std::collections::HashMap;

use serde::Serialize;
use tumble::math::Real;
use tumble::{Axes, Drive, Gain, Limit, Limits, Pose};
use tumble_import::{FieldError, ImportedGear, ImportedJoint};

use crate::alike::find;
use crate::bodies::scene_joint::SceneJoint;
use crate::bodies::scene_joints::SceneGear;
use crate::convert;
use crate::model::joint_model::JointModel;
use crate::model::scene_model::SceneModel;
use crate::values::axes::named_axes;

/// A joint between two bodies, as `tumble inspect` shows it.
///
/// ```
/// use tumble_scene::Audit;
///
/// let link = |name: &str| {
///     format!(
///         r#"<link name="{name}"> <inertial> <mass value="2"/>
/// <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/> </inertial> </link>"#
///     )
/// };
/// let robot = format!(
///     r#"<robot name="arm"> {} {} <joint name="elbow" type="revolute">
/// <parent link="upper"/> <child link="lower"/> <limit lower="-0.5" upper="2"/>
/// </joint> </robot>"#,
///     link("upper"),
///     link("lower")
/// );
/// let elbow = &Audit::from_urdf(&robot, "arm.urdf")?.joints[0];
/// assert_eq!((elbow.kind, elbow.between.join(" ")), ("hinge", "upper lower".to_owned()));
/// assert_eq!((elbow.limits[0].of.as_str(), elbow.limits[0].max), ("angular_x", Some(2.0)));
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditedJoint {
    /// What its file calls it.
    pub name: String,
    /// What joints that leave such axes free are called: as the constructors of
    /// [`Joint`](tumble::Joint), or `other`.
    pub kind: &'static str,
    /// The names of its bodies.
    pub between: [String; 2],
    /// The axes that are not locked, such as `angular_x`.
    pub free: Vec<&'static str>,
    /// How far it goes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<AuditedLimit>,
    /// Its motors, springs and dampers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drives: Vec<AuditedDrive>,
    /// Its dry friction.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub friction: Vec<AuditedFriction>,
    /// The greatest force \[N\] or torque [N m] of what drives it, as the file says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_effort: Option<f64>,
    /// The greatest speed [m/s] [rad/s], as the file says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_speed: Option<f64>,
    /// What it breaks at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub breaks: Option<AuditedBreak>,
    /// What it follows: gears of a scene of which it is the second, `mimic` of a robot.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub follows: Vec<AuditedGear>,
    /// Whether the colliders of its bodies touch each other.
    pub contacts: bool,
    /// What is wrong with it, as `field: problem`; then only its name and bodies are given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub problems: Vec<String>,
}

/// The greatest load that a joint bears.
///
/// ```
/// let thread = tumble_scene::AuditedBreak { force: Some(50.0), torque: None };
/// assert_eq!(thread.force, Some(50.0));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditedBreak {
    /// \[N\]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// [N m]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque: Option<f64>,
}

/// How a joint follows another: its value is `ratio` times that of the other, and `offset`.
///
/// ```
/// let finger =
///     tumble_scene::AuditedGear { joint: "thumb".into(), axes: None, ratio: -1.0, offset: 0.0 };
/// assert_eq!(finger.ratio, -1.0);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditedGear {
    /// The name of the other joint.
    pub joint: String,
    /// Along which axis of the other joint, and of this, where the file says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<[&'static str; 2]>,
    /// A number, [m/rad] or [rad/m].
    pub ratio: f64,
    /// \[m\] \[rad\]
    pub offset: f64,
}

/// A range that a joint stays in.
///
/// ```
/// use tumble_scene::AuditedLimit;
///
/// let (of, max) = ("distance".to_owned(), Some(2.0));
/// let limit = AuditedLimit { of, min: None, max, half_angles: None, gain: None };
/// assert_eq!(limit.max, Some(2.0));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditedLimit {
    /// An axis, `distance` or `cone`.
    pub of: String,
    /// \[m\] \[rad\]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// \[m\] \[rad\]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Of a cone, about y and about z of the first frame \[rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_angles: Option<[f64; 2]>,
    /// `None` of a hard limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<AuditedGain>,
}

/// What drives a joint along one axis or several.
///
/// ```
/// use tumble_scene::{AuditedDrive, AuditedGain};
///
/// let gain = Some(AuditedGain { mode: "force", stiffness: 0.0, damping: 0.5 });
/// let damper = AuditedDrive {
///     of: vec!["angular_x"],
///     position: None,
///     velocity: 0.0,
///     gain,
///     max_force: None,
///     oscillation: None,
/// };
/// assert!(damper.position.is_none());
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditedDrive {
    /// Along or about which axes.
    pub of: Vec<&'static str>,
    /// Where to, if anywhere \[m\] \[rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<f64>,
    /// How fast [m/s] [rad/s].
    pub velocity: f64,
    /// `None` of one that does what it takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<AuditedGain>,
    /// The greatest force \[N\] or torque [N m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_force: Option<f64>,
    /// How the position oscillates, if it does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oscillation: Option<AuditedOscillation>,
}

/// A sine that is added to the position of a drive.
///
/// ```
/// use tumble_scene::AuditedOscillation;
///
/// let gait = AuditedOscillation { amplitude: 0.3, frequency: 2.0, phase: 0.0 };
/// assert_eq!(gait.frequency, 2.0);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditedOscillation {
    /// The furthest from the position \[m\] \[rad\].
    pub amplitude: f64,
    /// Periods a second \[Hz\].
    pub frequency: f64,
    /// At the time zero \[rad\].
    pub phase: f64,
}

/// How hard a limit or a drive pulls.
///
/// ```
/// use tumble_scene::AuditedGain;
///
/// let spring = AuditedGain { mode: "force", stiffness: 100.0, damping: 1.0 };
/// assert_eq!(spring.mode, "force");
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditedGain {
    /// `force` [N/m] [N s/m], `acceleration` [1/s^2] [1/s], or `frequency`: \[Hz\] and the ratio to
    /// critical damping.
    pub mode: &'static str,
    /// Of the spring.
    pub stiffness: f64,
    /// Of the damper.
    pub damping: f64,
}

/// Dry friction along or about one axis.
///
/// ```
/// let friction = tumble_scene::AuditedFriction { of: "angular_x", max: 0.5 };
/// assert_eq!(friction.max, 0.5);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditedFriction {
    /// The axis.
    pub of: &'static str,
    /// The greatest force \[N\] or torque [N m].
    pub max: f64,
}

impl AuditedJoint {
    /// Of joints between bodies of these names, and of the gears between the joints.
    pub(crate) fn all(joints: &[ImportedJoint], gears: &[ImportedGear], names: &[String]) -> Vec<Self> {
        let mut audited: Vec<Self> = joints.iter().map(|joint| Self::of(joint, names)).collect();
        for ImportedGear { joints, ratio, offset } in gears {
            follow(&mut audited, *joints, |joint| AuditedGear { joint, axes: None, ratio: *ratio, offset: *offset });
        }
        audited
    }

    /// Of the joints of a scene between bodies of these names, and of its gears if no joint has a
    /// problem.
    ///
    /// # Errors
    /// [`FieldError`] of a gear.
    pub(crate) fn of_scene(model: &SceneModel, names: &[String]) -> Result<Vec<Self>, FieldError> {
        let by_name: HashMap<&str, usize> = (0..).zip(names).map(|(index, name)| (name.as_str(), index)).collect();
        let body = |name: &str| find("body", name, &by_name);
        let named = |index: usize, model: &JointModel| model.name.clone().unwrap_or_else(|| format!("joints[{index}]"));
        let mut audited = Vec::with_capacity(model.joints.len());
        for (index, joint) in model.joints.iter().enumerate() {
            audited.push(match convert::joints::joint(joint, &body) {
                Ok(checked) => Self::of_scene_joint(checked, named(index, joint), names),
                Err(error) => Self::impossible(named(index, joint), joint, &error),
            });
        }
        if audited.iter().all(|joint| joint.problems.is_empty()) {
            for SceneGear { joints, gear } in convert::gears::joints_and_gears(model, names)?.gears {
                let axis = |end: usize| named_axes().find(|(_, axis)| *axis == gear.axes[end]).map(|(name, _)| name);
                let axes = axis(0).zip(axis(1)).map(|(first, second)| [first, second]);
                let (ratio, offset) = (double(gear.ratio), double(gear.offset));
                follow(&mut audited, joints, |joint| AuditedGear { joint, axes, ratio, offset });
            }
        }
        Ok(audited)
    }

    fn of_scene_joint(joint: SceneJoint, name: String, names: &[String]) -> Self {
        let breaks = joint.options.breakable.map(|breakable| {
            let finite = |most: Real| Some(double(most)).filter(|most| most.is_finite());
            AuditedBreak { force: finite(breakable.max_force), torque: finite(breakable.max_torque) }
        });
        let imported = ImportedJoint {
            name,
            bodies: joint.bodies,
            frames: [Pose::default(); 2],
            free: joint.free(),
            contacts_enabled: joint.contacts,
            limits: joint.options.limits,
            drives: joint.options.drives,
            friction: joint.options.friction,
            max_effort: None,
            max_speed: None,
        };
        Self { breaks, ..Self::of(&imported, names) }
    }

    fn impossible(name: String, model: &JointModel, problem: &FieldError) -> Self {
        Self {
            name,
            kind: "other",
            between: model.between.as_ref().map(|between| between.0.clone()).unwrap_or_default(),
            free: Vec::new(),
            limits: Vec::new(),
            drives: Vec::new(),
            friction: Vec::new(),
            max_effort: None,
            max_speed: None,
            breaks: None,
            follows: Vec::new(),
            contacts: model.contacts,
            problems: vec![problem.to_string()],
        }
    }

    /// Of a joint between bodies of these names.
    fn of(joint: &ImportedJoint, names: &[String]) -> Self {
        let friction = joint.friction.map_or([0.0; 6], |friction| friction.max);
        let friction = named_axes().zip(friction).filter(|(_, max)| *max > 0.0);
        Self {
            name: joint.name.clone(),
            kind: joint.kind(),
            between: joint.bodies.map(|body| names.get(body).cloned().unwrap_or_default()),
            free: named(joint.free),
            limits: joint.limits.iter().flat_map(AuditedLimit::all).collect(),
            drives: joint.drives.iter().flat_map(|drives| &drives.0).map(AuditedDrive::of).collect(),
            friction: friction.map(|((of, _), max)| AuditedFriction { of, max: double(max) }).collect(),
            max_effort: joint.max_effort,
            max_speed: joint.max_speed,
            breaks: None,
            follows: Vec::new(),
            contacts: joint.contacts_enabled,
            problems: Vec::new(),
        }
    }
}

/// Has the second of two joints follow the first; `gear` is of the name of the first.
fn follow(audited: &mut [AuditedJoint], [first, second]: [usize; 2], gear: impl FnOnce(String) -> AuditedGear) {
    let Some(leader) = audited.get(first).map(|joint| joint.name.clone()) else { return };
    if let Some(follower) = audited.get_mut(second) {
        follower.follows.push(gear(leader));
    }
}

impl AuditedLimit {
    fn all(limits: &Limits) -> Vec<Self> {
        let of = |of: &str, limit: Limit| {
            let [min, max] = [limit.min, limit.max].map(|bound| Some(double(bound)).filter(|it| it.is_finite()));
            Self { of: of.to_owned(), min, max, half_angles: None, gain: AuditedGain::of(limit.gain) }
        };
        let axes = named_axes().zip(limits.axes).filter_map(|((name, _), limit)| Some(of(name, limit?)));
        let distance = limits.distance.map(|limit| of("distance", limit));
        let cone = limits.cone.map(|cone| {
            let half_angles = Some(cone.half_angles.map(double));
            Self { of: "cone".to_owned(), min: None, max: None, half_angles, gain: AuditedGain::of(cone.gain) }
        });
        axes.chain(distance).chain(cone).collect()
    }
}

impl AuditedDrive {
    fn of(drive: &Drive) -> Self {
        Self {
            of: named(drive.axes),
            position: drive.position.map(double),
            velocity: double(drive.velocity),
            gain: AuditedGain::of(drive.gain),
            max_force: Some(double(drive.max_force)).filter(|max| max.is_finite()),
            oscillation: drive.oscillation.map(|it| AuditedOscillation {
                amplitude: double(it.amplitude),
                frequency: double(it.hertz),
                phase: double(it.phase),
            }),
        }
    }
}

impl AuditedGain {
    fn of(gain: Gain) -> Option<Self> {
        let (mode, stiffness, damping) = match gain {
            Gain::Rigid => return None,
            Gain::Stiffness { stiffness, damping } => ("force", stiffness, damping),
            Gain::Acceleration { stiffness, damping } => ("acceleration", stiffness, damping),
            Gain::Frequency { hertz, damping_ratio } => ("frequency", hertz, damping_ratio),
        };
        Some(Self { mode, stiffness: double(stiffness), damping: double(damping) })
    }
}

fn named(axes: Axes) -> Vec<&'static str> {
    named_axes().filter(|(_, axis)| axes.contains(*axis)).map(|(name, _)| name).collect()
}

/// Of the engine's number the shortest decimal, as files have it.
fn double(value: Real) -> f64 {
    value.to_string().parse().unwrap_or(f64::NAN)
}
