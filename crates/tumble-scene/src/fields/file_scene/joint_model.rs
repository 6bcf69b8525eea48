//! The numbers of a joint of a file as the model of a scene's joint, and back.

use glam::DVec3;
use tumble::math::{Real, dquat, dvec3};
use tumble::{Axes, Drive, Gain, Limit, Limits};
use tumble_import::checked::finite;
use tumble_import::{FieldError, ImportedJoint};

use crate::convert::joint_options::{drives, friction, limits};
use crate::fields::file_scene::Frame;
use crate::model::joint_model::JointModel;
use crate::model::joint_options_model::{
    AxisModel, ConeModel, DriveModel, FrictionModel, GainModel, LimitModel, LimitsModel, ModeModel, OscillationModel,
};
use crate::values::checked::double;
use crate::values::tuple::Tuple;

/// The one axis that a joint leaves free: its direction, and whether it goes along it.
pub(crate) fn single_axis(joint: &ImportedJoint) -> Option<(DVec3, bool)> {
    let axis = Axes::EACH.iter().position(|axis| *axis == joint.free)?;
    Some((DVec3::AXES[axis % 3], axis < 3))
}

/// The frame of a joint on one of its bodies, whose centre of mass and orientation are given.
pub(crate) fn joint_frame(joint: &ImportedJoint, end: usize, (center, orientation): Frame) -> Frame {
    let frame = &joint.frames[end];
    (center + orientation * dvec3(frame.position), orientation * dquat(frame.orientation))
}

/// `bodies` are the centres of mass and orientations of both.
pub(crate) fn joint_model(joint: &ImportedJoint, bodies: Option<[Frame; 2]>) -> JointModel {
    let drives = joint.drives.iter().flat_map(|drives| &drives.0).map(drive_model).collect();
    JointModel {
        name: Some(joint.name.clone()),
        limits: joint.limits.as_ref().map(|limits| Box::new(limits_model(limits))),
        drives,
        friction: joint.friction.map(|friction| Box::new(friction_model(friction.max, joint.free))),
        position: bodies.and_then(|bodies| position(joint, bodies)),
        ..JointModel::default()
    }
}

/// How far a joint with one free axis is along or about it \[m\] \[rad\].
fn position(joint: &ImportedJoint, [a, b]: [Frame; 2]) -> Option<f64> {
    let (axis, is_along) = single_axis(joint)?;
    let [(from, along), (to, turned)] = [joint_frame(joint, 0, a), joint_frame(joint, 1, b)];
    if is_along {
        return Some((along.inverse() * (to - from)).dot(axis));
    }
    let turn = along.inverse() * turned;
    let turn = if turn.w < 0.0 { -turn } else { turn };
    Some(2.0 * libm::atan2(turn.xyz().dot(axis), turn.w))
}

/// Gives a joint what is other in `now` than it was. The place of its bodies is not its own.
pub(crate) fn change_joint(joint: &mut ImportedJoint, was: &JointModel, now: &JointModel) -> Result<(), FieldError> {
    if now.limits != was.limits
        && let Some(model) = &now.limits
    {
        joint.limits = Some(limits(model, joint.free).map_err(|error| error.inside("limits"))?);
    }
    if now.drives != was.drives {
        joint.drives = Some(drives(&now.drives, joint.free)?);
    }
    if now.friction != was.friction
        && let Some(model) = &now.friction
    {
        joint.friction = Some(friction(model, joint.free).map_err(|error| error.inside("friction"))?);
    }
    now.position.map_or(Ok(()), |position| finite("position", position).map(drop))
}

fn limits_model(limits: &Limits) -> LimitsModel {
    let [linear_x, linear_y, linear_z, angular_x, angular_y, angular_z] =
        limits.axes.map(|limit| limit.as_ref().map(limit_model));
    let cone = limits
        .cone
        .as_ref()
        .map(|cone| ConeModel { half_angles: Some(Tuple(cone.half_angles.map(double))), gain: gain_model(cone.gain) });
    let distance = limits.distance.as_ref().map(limit_model);
    LimitsModel { linear_x, linear_y, linear_z, angular_x, angular_y, angular_z, distance, cone }
}

fn limit_model(limit: &Limit) -> LimitModel {
    let bound = |bound: Real| bound.is_finite().then(|| double(bound));
    LimitModel { min: bound(limit.min), max: bound(limit.max), gain: gain_model(limit.gain) }
}

fn drive_model(drive: &Drive) -> DriveModel {
    let GainModel { stiffness, damping, frequency, damping_ratio, mode } = gain_model(drive.gain);
    let goes_somewhere = drive.position.is_some();
    DriveModel {
        axes: AXES.into_iter().filter(|axis| drive.axes.contains(Axes::from(*axis))).collect(),
        position: drive.position.map(double),
        // What would do nothing is refused where it is written.
        velocity: (!goes_somewhere || drive.gain != Gain::Rigid).then(|| double(drive.velocity)),
        max_force: drive.max_force.is_finite().then(|| double(drive.max_force)),
        stiffness: stiffness.filter(|_| goes_somewhere),
        damping,
        frequency,
        damping_ratio,
        mode,
        oscillation: drive.oscillation.filter(|_| goes_somewhere).map(|it| OscillationModel {
            amplitude: Some(double(it.amplitude)),
            frequency: Some(double(it.hertz)),
            phase: Some(double(it.phase)),
        }),
    }
}

const AXES: [AxisModel; 6] = [
    AxisModel::LinearX,
    AxisModel::LinearY,
    AxisModel::LinearZ,
    AxisModel::AngularX,
    AxisModel::AngularY,
    AxisModel::AngularZ,
];

fn gain_model(gain: Gain) -> GainModel {
    let of_spring = |stiffness, damping, mode| GainModel {
        stiffness: Some(double(stiffness)),
        damping: Some(double(damping)),
        mode: Some(mode),
        ..GainModel::default()
    };
    match gain {
        Gain::Rigid => GainModel::default(),
        Gain::Stiffness { stiffness, damping } => of_spring(stiffness, damping, ModeModel::Force),
        Gain::Acceleration { stiffness, damping } => of_spring(stiffness, damping, ModeModel::Acceleration),
        Gain::Frequency { hertz, damping_ratio } => GainModel {
            frequency: Some(double(hertz)),
            damping_ratio: Some(double(damping_ratio)),
            ..GainModel::default()
        },
    }
}

fn friction_model(max: [Real; 6], free: Axes) -> FrictionModel {
    let mut of_axes = max.into_iter().zip(Axes::EACH).map(|(max, axis)| free.contains(axis).then(|| double(max)));
    let [linear_x, linear_y, linear_z, angular_x, angular_y, angular_z] =
        std::array::from_fn(|_| of_axes.next().flatten());
    FrictionModel { linear_x, linear_y, linear_z, angular_x, angular_y, angular_z }
}
