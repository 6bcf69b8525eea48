//! Joints as files describe them.

use serde::Deserialize;

use crate::checked::finite;
use crate::error::FieldError;

/// A description of a joint: what it keeps from moving, and what it drives.
///
/// ```
/// use tumble_import::gltf::Physics;
///
/// let physics = Physics::from_json(
///     r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "extensions": { "KHR_physics_rigid_bodies": { "motion": {}, "joint": {
///     "connectedNode": 1, "joint": 0 } } } }, {} ],
/// "extensions": { "KHR_physics_rigid_bodies": { "physicsJoints": [ {
///     "limits": [ { "linearAxes": [0, 1, 2] } ], "drives": [ { "type": "angular",
///         "mode": "force", "axis": 1, "velocityTarget": 3 } ] } ] } } }"#,
///     "scene.gltf",
/// )?;
/// let joint = physics.nodes[0].joint.as_ref();
/// assert!(joint.is_some_and(|to| to.joint.limits.len() == 1 && to.joint.drives.len() == 1));
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Joint {
    /// What restricts the relative motion of the two frames.
    pub limits: Vec<JointLimit>,
    /// What pushes them.
    pub drives: Vec<JointDrive>,
}

impl Joint {
    /// Checks its numbers.
    pub(crate) fn check(&self) -> Result<(), FieldError> {
        for (index, limit) in self.limits.iter().enumerate() {
            limit.check().map_err(|error| error.inside(&format!("limits[{index}]")))?;
        }
        for (index, drive) in self.drives.iter().enumerate() {
            drive.check().map_err(|error| error.inside(&format!("drives[{index}]")))?;
        }
        Ok(())
    }
}

/// A limit of the relative motion along or about one to three axes of the joint's frame (0 x, 1 y,
/// 2 z).
///
/// ```
/// use tumble_import::gltf::JointLimit;
///
/// // A hinge about y turns by a right angle at most; another limit keeps all else from moving.
/// let hinge = JointLimit {
///     angular_axes: vec![1],
///     min: Some(0.0),
///     max: Some(1.5708),
///     ..JointLimit::default()
/// };
/// # assert!(hinge.linear_axes.is_empty());
/// ```
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct JointLimit {
    /// Axes along which the frames may not move apart.
    pub linear_axes: Vec<u8>,
    /// Axes about which they may not turn.
    pub angular_axes: Vec<u8>,
    /// Least distance \[m\] or angle \[rad\].
    pub min: Option<f64>,
    /// Largest distance \[m\] or angle \[rad\].
    pub max: Option<f64>,
    /// Stiffness beyond the limit [N/m] or [N m/rad]; infinite if absent.
    pub stiffness: Option<f64>,
    /// Damping beyond the limit [N s/m] or [N m s/rad].
    pub damping: f64,
}

impl JointLimit {
    fn check(&self) -> Result<(), FieldError> {
        let (field, axes) = match (self.linear_axes.as_slice(), self.angular_axes.as_slice()) {
            ([], []) => {
                return Err(FieldError::new("linearAxes", "is missing, and so is angularAxes: give one of them"));
            }
            (linear, []) => ("linearAxes", linear),
            ([], angular) => ("angularAxes", angular),
            _ => return Err(FieldError::new("angularAxes", "linearAxes is given too: give one of them")),
        };
        for (place, axis) in axes.iter().enumerate() {
            check_axis(field, *axis)?;
            if axes.iter().take(place).any(|earlier| earlier == axis) {
                return Err(FieldError::new(field, format!("has axis {axis} twice")));
            }
        }
        let [min, max] = [("min", self.min), ("max", self.max)]
            .map(|(field, bound)| bound.map(|bound| finite(field, bound)).transpose());
        if let (Some(min), Some(max)) = (min?, max?)
            && min > max
        {
            return Err(FieldError::new("min", format!("is {min}, more than max, {max}")));
        }
        not_negative("stiffness", self.stiffness.unwrap_or(0.0))?;
        not_negative("damping", self.damping)
    }
}

fn check_axis(field: &str, axis: u8) -> Result<(), FieldError> {
    if axis <= 2 {
        Ok(())
    } else {
        Err(FieldError::new(field, format!("there is no axis {axis}: they are 0, 1 and 2")))
    }
}

fn not_negative(field: &str, value: f64) -> Result<(), FieldError> {
    match finite(field, value)? {
        value if value < 0.0 => Err(FieldError::new(field, format!("must not be negative, as {value} is"))),
        _ => Ok(()),
    }
}

/// A motor or spring along or about one axis of the joint's frame.
///
/// ```
/// use tumble_import::gltf::JointDrive;
///
/// // A motor about y.
/// let motor = JointDrive {
///     r#type: "angular".into(),
///     axis: 1,
///     velocity_target: Some(3.0),
///     damping: 5.0,
///     ..JointDrive::default()
/// };
/// # assert_eq!(motor.stiffness, 0.0);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct JointDrive {
    /// `linear` or `angular`.
    pub r#type: String,
    /// `force` or `acceleration`.
    pub mode: String,
    /// 0 x, 1 y, 2 z.
    pub axis: u8,
    /// Largest force \[N\] or torque [N m]; no limit if absent.
    pub max_force: Option<f64>,
    /// Wanted distance \[m\] or angle \[rad\].
    pub position_target: Option<f64>,
    /// Wanted velocity [m/s] or angular velocity [rad/s].
    pub velocity_target: Option<f64>,
    /// Pull towards the wanted position.
    pub stiffness: f64,
    /// Pull towards the wanted velocity.
    pub damping: f64,
}

impl JointDrive {
    fn check(&self) -> Result<(), FieldError> {
        for (field, value) in [("type", &self.r#type), ("mode", &self.mode)] {
            if value.is_empty() {
                return Err(FieldError::new(field, "is missing"));
            }
        }
        check_axis("axis", self.axis)?;
        for (field, target) in [("positionTarget", self.position_target), ("velocityTarget", self.velocity_target)] {
            finite(field, target.unwrap_or(0.0))?;
        }
        not_negative("maxForce", self.max_force.unwrap_or(0.0))?;
        not_negative("stiffness", self.stiffness)?;
        not_negative("damping", self.damping)
    }
}
