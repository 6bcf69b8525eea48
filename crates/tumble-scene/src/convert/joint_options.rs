//! What a joint has beside its place, from its model: limits, drives, friction and breaking.

use std::f64::consts::{PI, TAU};

use tumble::math::Real;
use tumble::{Axes, Breakable, Cone, Drive, Drives, Gain, JointFriction, Limit, Limits, Oscillation};
use tumble_import::checked::{positive, real};
use tumble_import::{FieldError, shortest};

use crate::model::joint_options_model::{
    AxisModel, BreakModel, ConeModel, DriveModel, FrictionModel, GainModel, LimitModel, LimitsModel, ModeModel,
    OscillationModel,
};
use crate::values::axes::named_axes;
use crate::values::checked::{not_negative, number};

/// A range may be a little more than a turn, for pi is rounded in files \[rad\].
const MAX_RANGE: f64 = TAU + 2e-4;

/// The limits of a joint with these free axes.
pub(crate) fn limits(model: &LimitsModel, free: Axes) -> Result<Limits, FieldError> {
    let LimitsModel { linear_x, linear_y, linear_z, angular_x, angular_y, angular_z, distance, cone } = model;
    let of_axes = [linear_x, linear_y, linear_z, angular_x, angular_y, angular_z];
    let mut limits = Limits::default();
    for ((model, (name, axis)), place) in of_axes.into_iter().zip(named_axes()).zip(&mut limits.axes) {
        let Some(model) = model else { continue };
        check_free(name, axis, free)?;
        if free.contains(Axes::ANGULAR) && (axis == Axes::ANGULAR_Y || axis == Axes::ANGULAR_Z) {
            return Err(FieldError::new(name, "does nothing: of three free rotations it takes a cone"));
        }
        let checked = if Axes::ANGULAR.contains(axis) { range_of_angles(model) } else { Ok(()) };
        *place = Some(checked.and_then(|()| limit(model)).map_err(|error| error.inside(name))?);
    }
    if let Some(model) = distance {
        if !Axes::EACH[..3].iter().any(|axis| free.contains(*axis)) {
            return Err(FieldError::new("distance", "does nothing: the joint locks all translations"));
        }
        for (field, bound) in [("distance.min", model.min), ("distance.max", model.max)] {
            bound.map(|bound| not_negative(field, bound)).transpose()?;
        }
        limits.distance = Some(limit(model).map_err(|error| error.inside("distance"))?);
    }
    if let Some(model) = cone {
        if !free.contains(Axes::ANGULAR) {
            return Err(FieldError::new("cone", "does nothing: the joint locks rotations"));
        }
        limits.cone = Some(self::cone(model).map_err(|error| error.inside("cone"))?);
    }
    if limits == Limits::default() {
        return Err(FieldError::new("", "needs an axis, distance or cone"));
    }
    Ok(limits)
}

/// The drives of a joint with these free axes.
pub(crate) fn drives(models: &[DriveModel], free: Axes) -> Result<Drives, FieldError> {
    let mut drives = Vec::with_capacity(models.len());
    let mut rigid = Axes::NONE;
    for (index, model) in models.iter().enumerate() {
        let inside = |error: FieldError| error.inside(&format!("drives[{index}]"));
        let drive = drive(model, free).map_err(inside)?;
        if drive.gain == Gain::Rigid {
            if Axes::EACH.iter().any(|axis| rigid.contains(*axis) && drive.axes.contains(*axis)) {
                let problem = "another drive without stiffness, damping and frequency is along the same axis";
                return Err(inside(FieldError::new("axes", problem)));
            }
            rigid = rigid | drive.axes;
        }
        drives.push(drive);
    }
    Ok(Drives(drives))
}

/// The friction of a joint with these free axes.
pub(crate) fn friction(model: &FrictionModel, free: Axes) -> Result<JointFriction, FieldError> {
    let FrictionModel { linear_x, linear_y, linear_z, angular_x, angular_y, angular_z } = model;
    let of_axes = [linear_x, linear_y, linear_z, angular_x, angular_y, angular_z];
    let mut friction = JointFriction::default();
    for ((model, (name, axis)), max) in of_axes.into_iter().zip(named_axes()).zip(&mut friction.max) {
        let Some(model) = model else { continue };
        check_free(name, axis, free)?;
        *max = real(not_negative(name, *model)?);
    }
    if of_axes.iter().all(|model| model.is_none()) {
        return Err(FieldError::new("", "needs an axis"));
    }
    Ok(friction)
}

/// What a joint stands.
pub(crate) fn breakable(model: &BreakModel) -> Result<Breakable, FieldError> {
    if model.force.is_none() && model.torque.is_none() {
        return Err(FieldError::new("", "needs force or torque"));
    }
    let most = |field, value: Option<f64>| -> Result<Real, FieldError> {
        let Some(value) = value else { return Ok(Real::INFINITY) };
        number(field, positive(field, value)?).map(real)
    };
    Ok(Breakable {
        max_force: most("force", model.force)?,
        max_torque: most("torque", model.torque)?,
        is_broken: false,
    })
}

fn check_free(name: &str, axis: Axes, free: Axes) -> Result<(), FieldError> {
    if free.contains(axis) { Ok(()) } else { Err(FieldError::new(name, "does nothing: the joint locks that axis")) }
}

/// Refuses a range of angles that bounds nothing. A bound that is missing is half a turn.
fn range_of_angles(model: &LimitModel) -> Result<(), FieldError> {
    match (model.min, model.max) {
        (Some(min), None) if min > PI => {
            Err(FieldError::new("min", format!("is {}, more than pi: give max too", shortest(min))))
        }
        (None, Some(max)) if max < -PI => {
            Err(FieldError::new("max", format!("is {}, less than -pi: give min too", shortest(max))))
        }
        (min, max) if max.unwrap_or(PI) - min.unwrap_or(-PI) > MAX_RANGE => {
            Err(FieldError::new("", "is a range of more than a turn, which bounds nothing"))
        }
        _ => Ok(()),
    }
}

fn limit(model: &LimitModel) -> Result<Limit, FieldError> {
    if model.min.is_none() && model.max.is_none() {
        return Err(FieldError::new("", "needs min or max"));
    }
    let bound = |field, value: Option<f64>, none| -> Result<Real, FieldError> {
        let Some(value) = value else { return Ok(none) };
        number(field, value).map(real)
    };
    let min = bound("min", model.min, Real::NEG_INFINITY)?;
    let max = bound("max", model.max, Real::INFINITY)?;
    if min > max {
        return Err(FieldError::new("min", format!("is more than max: {} and {}", bare(min), bare(max))));
    }
    Ok(Limit { min, max, gain: gain(&model.gain)? })
}

fn cone(model: &ConeModel) -> Result<Cone, FieldError> {
    let Some(angles) = &model.half_angles else {
        return Err(FieldError::new("half_angles", "is missing: give an angle about y and one about z"));
    };
    let mut half_angles = [0.0; 2];
    for (angle, given) in half_angles.iter_mut().zip(angles.0) {
        *angle = real(given);
        if !(*angle > 0.0 && *angle < real(PI)) {
            let problem = format!("must be more than 0 and less than pi, not {}", shortest(given));
            return Err(FieldError::new("half_angles", problem));
        }
    }
    Ok(Cone { half_angles, gain: gain(&model.gain)? })
}

/// How hard it is: as hard as it takes where nothing is given.
fn gain(model: &GainModel) -> Result<Gain, FieldError> {
    let GainModel { stiffness, damping, frequency, damping_ratio, mode } = *model;
    let is_spring = stiffness.is_some() || damping.is_some();
    if is_spring && (frequency.is_some() || damping_ratio.is_some()) {
        return Err(FieldError::new("frequency", "is for what has neither stiffness nor damping"));
    }
    if mode.is_some() && !is_spring {
        return Err(FieldError::new("mode", "is for what has stiffness or damping"));
    }
    let rate = |field, value: Option<f64>| not_negative(field, value.unwrap_or(0.0)).map(real);
    if is_spring {
        let [stiffness, damping] = [rate("stiffness", stiffness)?, rate("damping", damping)?];
        return Ok(match mode.unwrap_or(ModeModel::Force) {
            ModeModel::Force => Gain::Stiffness { stiffness, damping },
            ModeModel::Acceleration => Gain::Acceleration { stiffness, damping },
        });
    }
    match (frequency, damping_ratio) {
        (None, None) => Ok(Gain::Rigid),
        (None, Some(_)) => Err(FieldError::new("frequency", "is missing: a damping_ratio is of a frequency")),
        (Some(_), ratio) => Ok(Gain::Frequency {
            hertz: rate("frequency", frequency)?,
            damping_ratio: rate("damping_ratio", Some(ratio.unwrap_or(1.0)))?,
        }),
    }
}

fn drive(model: &DriveModel, free: Axes) -> Result<Drive, FieldError> {
    let mut axes = Axes::NONE;
    for axis in &model.axes {
        let these = Axes::from(*axis);
        for (name, one) in named_axes().filter(|(_, one)| these.contains(*one)) {
            check_free(name, one, free).map_err(|error| error.inside("axes"))?;
            if axes.contains(one) {
                return Err(FieldError::new("axes", format!("{name} is there twice")));
            }
        }
        axes = axes | these;
    }
    if axes == Axes::NONE {
        return Err(FieldError::new("axes", "is missing: give a list of axes"));
    }
    let gain = gain(&model.gain())?;
    let pulls_to_position = model.stiffness.is_some() || model.frequency.is_some();
    if model.position.is_none() && pulls_to_position {
        let field = if model.stiffness.is_some() { "stiffness" } else { "frequency" };
        return Err(FieldError::new(field, "does nothing without a position"));
    }
    if model.position.is_some() && model.velocity.is_some() && gain == Gain::Rigid {
        let problem = "does nothing: a drive to a position has one only with stiffness, damping or frequency";
        return Err(FieldError::new("velocity", problem));
    }
    let max_force = match model.max_force {
        Some(force) => real(not_negative("max_force", force)?),
        None => Real::INFINITY,
    };
    let position = model.position.map(|position| number("position", position).map(real)).transpose()?;
    let velocity = real(number("velocity", model.velocity.unwrap_or(0.0))?);
    let oscillation = model.oscillation.as_ref().map(oscillation).transpose();
    let oscillation = oscillation.map_err(|error| error.inside("oscillation"))?;
    if oscillation.is_some() && position.is_none() {
        return Err(FieldError::new("oscillation", "does nothing without a position"));
    }
    Ok(Drive { axes, position, velocity, gain, max_force, oscillation })
}

fn oscillation(model: &OscillationModel) -> Result<Oscillation, FieldError> {
    let needed = |field: &'static str, value: Option<f64>| {
        let value = value.ok_or_else(|| FieldError::new(field, "is missing"))?;
        number(field, value).map(real)
    };
    Ok(Oscillation {
        amplitude: needed("amplitude", model.amplitude)?,
        hertz: needed("frequency", model.frequency)?,
        phase: real(number("phase", model.phase.unwrap_or(0.0))?),
    })
}

/// As it stands in files.
#[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
fn bare(value: Real) -> String {
    shortest(value.into())
}

impl From<AxisModel> for Axes {
    fn from(model: AxisModel) -> Self {
        match model {
            AxisModel::LinearX => Self::LINEAR_X,
            AxisModel::LinearY => Self::LINEAR_Y,
            AxisModel::LinearZ => Self::LINEAR_Z,
            AxisModel::AngularX => Self::ANGULAR_X,
            AxisModel::AngularY => Self::ANGULAR_Y,
            AxisModel::AngularZ => Self::ANGULAR_Z,
            AxisModel::Linear => Self::LINEAR,
            AxisModel::Angular => Self::ANGULAR,
        }
    }
}
