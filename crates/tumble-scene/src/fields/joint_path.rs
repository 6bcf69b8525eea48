//! The numbers of a joint, by what follows the joint in a path.

use crate::fields::field_path::{component, element};
use crate::model::joint_model::{JointModel, JointPlaceModel};
use crate::model::joint_options_model::{
    BreakModel, DriveModel, FrictionModel, GainModel, LimitModel, LimitsModel, OscillationModel,
};
use crate::values::axes;

/// The number that a path such as `["drives", "0", "stiffness"]` leads to, if the joint has it.
///
/// Places, limits and drives have to stand in the scene; their numbers, friction and what it stands
/// need not.
pub(crate) fn in_joint<'a>(joint: &'a mut JointModel, path: &[&str]) -> Option<&'a mut f64> {
    match path {
        ["position"] => joint.position.as_mut(),
        ["limits", rest @ ..] => in_limits(joint.limits.as_deref_mut()?, rest),
        ["drives", index, field] => in_drive(element(&mut joint.drives, index)?, field),
        ["drives", index, "oscillation", field] => {
            in_oscillation(element(&mut joint.drives, index)?.oscillation.as_mut()?, field)
        }
        ["friction", axis] => in_friction(joint.friction.get_or_insert_default(), axis),
        ["break", field] => in_break(joint.breaks.get_or_insert_default(), field),
        [kind, rest @ ..] => in_place(place(joint, kind)?, rest),
        [] => None,
    }
}

fn place<'a>(joint: &'a mut JointModel, kind: &str) -> Option<&'a mut JointPlaceModel> {
    let place = match kind {
        "ball" => &mut joint.ball,
        "hinge" => &mut joint.hinge,
        "slider" => &mut joint.slider,
        "cylinder" => &mut joint.cylinder,
        "universal" => &mut joint.universal,
        "planar" => &mut joint.planar,
        "fixed" => &mut joint.fixed,
        "free" => &mut joint.free,
        _ => return None,
    };
    place.as_deref_mut()
}

fn in_place<'a>(place: &'a mut JointPlaceModel, path: &[&str]) -> Option<&'a mut f64> {
    match path {
        ["at", axis] => component(place.at.as_mut()?, axis),
        ["to", axis] => component(place.to.as_mut()?, axis),
        ["axis", axis] => component(place.axis.as_mut()?, axis),
        _ => None,
    }
}

fn in_limits<'a>(limits: &'a mut LimitsModel, path: &[&str]) -> Option<&'a mut f64> {
    match path {
        ["cone", "half_angles", which] => component(limits.cone.as_mut()?.half_angles.as_mut()?, which),
        ["cone", field] => in_gain(&mut limits.cone.as_mut()?.gain, field),
        [name, field] => {
            let LimitModel { min, max, gain } = limit(limits, name)?;
            match *field {
                "min" => Some(min.get_or_insert(0.0)),
                "max" => Some(max.get_or_insert(0.0)),
                _ => in_gain(gain, field),
            }
        }
        _ => None,
    }
}

fn limit<'a>(limits: &'a mut LimitsModel, name: &str) -> Option<&'a mut LimitModel> {
    let LimitsModel { linear_x, linear_y, linear_z, angular_x, angular_y, angular_z, distance, cone: _ } = limits;
    let limit = match name {
        "distance" => distance,
        _ => of_axis([linear_x, linear_y, linear_z, angular_x, angular_y, angular_z], name)?,
    };
    limit.as_mut()
}

fn in_friction<'a>(friction: &'a mut FrictionModel, axis: &str) -> Option<&'a mut f64> {
    let FrictionModel { linear_x, linear_y, linear_z, angular_x, angular_y, angular_z } = friction;
    let number = of_axis([linear_x, linear_y, linear_z, angular_x, angular_y, angular_z], axis)?;
    Some(number.get_or_insert(0.0))
}

/// The field of an axis, of those of all six.
fn of_axis<'a, T>(fields: [&'a mut T; 6], name: &str) -> Option<&'a mut T> {
    fields.into_iter().zip(axes::NAMES).find(|(_, axis)| *axis == name).map(|(field, _)| field)
}

fn in_drive<'a>(drive: &'a mut DriveModel, field: &str) -> Option<&'a mut f64> {
    let DriveModel { position, velocity, max_force, stiffness, damping, frequency, damping_ratio, .. } = drive;
    let number = match field {
        "position" => position,
        "velocity" => velocity,
        "max_force" => max_force,
        _ => of_gain([stiffness, damping, frequency, damping_ratio], field)?,
    };
    Some(number.get_or_insert(0.0))
}

fn in_oscillation<'a>(oscillation: &'a mut OscillationModel, field: &str) -> Option<&'a mut f64> {
    let OscillationModel { amplitude, frequency, phase } = oscillation;
    let number = match field {
        "amplitude" => amplitude,
        "frequency" => frequency,
        "phase" => phase,
        _ => return None,
    };
    Some(number.get_or_insert(0.0))
}

fn in_gain<'a>(gain: &'a mut GainModel, field: &str) -> Option<&'a mut f64> {
    let GainModel { stiffness, damping, frequency, damping_ratio, mode: _ } = gain;
    Some(of_gain([stiffness, damping, frequency, damping_ratio], field)?.get_or_insert(0.0))
}

fn of_gain<'a>(fields: [&'a mut Option<f64>; 4], name: &str) -> Option<&'a mut Option<f64>> {
    let names = ["stiffness", "damping", "frequency", "damping_ratio"];
    fields.into_iter().zip(names).find(|(_, field)| *field == name).map(|(field, _)| field)
}

fn in_break<'a>(breaks: &'a mut BreakModel, field: &str) -> Option<&'a mut f64> {
    let number = match field {
        "force" => &mut breaks.force,
        "torque" => &mut breaks.torque,
        _ => return None,
    };
    Some(number.get_or_insert(0.0))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::model::parse::{Format, parse};

    /// Joints, and the paths of all their numbers.
    const JOINTS: [(&str, &str); 5] = [
        (
            r#"{ "hinge": { "at": [0, 0, 0], "axis": [0, 0, 1] }, "limits": { "angular_x": [-1, 1] }, "drives": [
                { "axes": ["angular_x"] }, { "axes": ["angular_x"], "position": 1, "stiffness": 2, "damping": 3,
                  "oscillation": { "amplitude": 1, "frequency": 2 } } ] }"#,
            "hinge.at.0 hinge.at.2 hinge.axis.1 limits.angular_x.min limits.angular_x.max limits.angular_x.stiffness \
             limits.angular_x.damping limits.angular_x.frequency limits.angular_x.damping_ratio drives.0.position \
             drives.0.velocity drives.0.max_force drives.1.position drives.1.stiffness drives.1.damping \
             drives.1.frequency drives.1.damping_ratio drives.1.oscillation.amplitude \
             drives.1.oscillation.frequency drives.1.oscillation.phase friction.angular_x friction.angular_y friction.angular_z \
             break.force break.torque",
        ),
        (
            r#"{ "ball": { "at": [0, 0, 0] }, "limits": { "cone": [1, 2], "angular_x": { "max": 1 } },
                 "friction": { "angular_x": 1 }, "break": { "force": 1 } }"#,
            "ball.at.1 limits.cone.half_angles.0 limits.cone.half_angles.1 limits.cone.stiffness limits.cone.frequency \
             limits.angular_x.max limits.angular_x.min friction.angular_x friction.angular_y break.force break.torque",
        ),
        (
            r#"{ "free": { "at": [0, 0, 0], "to": [1, 1, 1] }, "limits": { "distance": [0, 1] } }"#,
            "free.at.0 free.to.2 limits.distance.min limits.distance.max limits.distance.damping friction.linear_x \
             friction.linear_y friction.linear_z",
        ),
        (
            r#"{ "planar": { "at": [0, 0, 0] }, "limits": { "linear_x": [0, 1], "linear_y": [0, 1], "linear_z": [0, 1],
                 "angular_y": [0, 1], "angular_z": [0, 1] } }"#,
            "planar.at.0 limits.linear_x.min limits.linear_y.max limits.linear_z.min limits.angular_y.max \
             limits.angular_z.min",
        ),
        (r#"{ "slider": { "at": [0, 0, 0], "axis": [1, 0, 0] } }"#, "slider.at.0 slider.axis.0"),
    ];

    fn joint(text: &str) -> JointModel {
        let mut model = parse(&format!(r#"{{ "joints": [{text}] }}"#), Format::Json, "scene").unwrap();
        model.joints.remove(0)
    }

    #[test]
    fn every_number_of_every_joint_has_a_path() {
        for (text, paths) in JOINTS {
            let mut seen = BTreeSet::new();
            for path in paths.split_whitespace() {
                let (mut joint, path) = (joint(text), path.split('.').collect::<Vec<_>>());
                *in_joint(&mut joint, &path).unwrap() = 4321.0;
                let text = format!("{joint:?}");
                assert_eq!(text.matches("4321").count(), 1, "{path:?}: {text}");
                assert!(seen.insert(text), "{path:?} is the same number as another path");
            }
        }
        for kind in ["ball", "hinge", "slider", "cylinder", "universal", "planar", "fixed", "free"] {
            let mut joint = joint(&format!(r#"{{ "{kind}": {{ "at": [0, 0, 0] }} }}"#));
            assert!(in_joint(&mut joint, &[kind, "at", "1"]).is_some(), "{kind}");
        }
    }

    #[test]
    fn what_is_no_number_has_none() {
        for (text, _) in JOINTS {
            for path in [
                "",
                "at.0",
                "fixed.at.0",
                "hinge.at",
                "hinge.at.3",
                "hinge.to.0",
                "slider.to.0",
                "name",
                "between.0",
                "contacts",
                "limits",
                "limits.cone",
                "limits.cone.half_angles.2",
                "limits.cone.min",
                "limits.angular_x",
                "limits.angular_x.mode",
                "limits.distance.0",
                "drives",
                "drives.2.velocity",
                "drives.0.axes",
                "drives.0.mode",
                "friction",
                "friction.x",
                "break",
                "break.angle",
                "break.force.0",
            ] {
                let mut joint = joint(text);
                assert!(in_joint(&mut joint, &path.split('.').collect::<Vec<_>>()).is_none(), "{path} in {text}");
            }
        }
        // Neither a limit nor a cone begins from a default.
        let mut free = joint(r#"{ "free": { "at": [0, 0, 0] } }"#);
        assert!(in_joint(&mut free, &["limits", "distance", "max"]).is_none());
        assert!(in_joint(&mut free, &["drives", "0", "velocity"]).is_none());
    }
}
