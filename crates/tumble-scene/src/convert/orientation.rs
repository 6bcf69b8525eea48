//! Orientations: unit quaternions of what files say.

use glam::DQuat;
use tumble_import::FieldError;
use tumble_import::checked::unit_quaternion;

use crate::model::orientation_model::{OrientationModel, TurnModel};
use crate::values::checked::finite_triple;

/// The rotation that a field called `orientation` means.
pub(crate) fn rotation(model: &OrientationModel) -> Result<DQuat, FieldError> {
    match model {
        OrientationModel::Quaternion(quaternion) => unit_quaternion("orientation", quaternion.0),
        OrientationModel::Turn(turn) => turned(turn).map_err(|error| error.inside("orientation")),
    }
}

/// The rotation of an axis and an angle. The functions are libm's, whose bits are the same on every
/// machine.
pub(crate) fn turned(turn: &TurnModel) -> Result<DQuat, FieldError> {
    let axis = finite_triple("axis", &turn.axis)?;
    let axis = (axis / axis.abs().max_element()).try_normalize();
    let axis = axis.ok_or_else(|| FieldError::new("axis", "is zero: give a direction"))?;
    if !turn.angle.is_finite() {
        return Err(FieldError::new("angle", format!("must be finite, not {}", turn.angle)));
    }
    let half = 0.5 * turn.angle;
    let vector = axis * libm::sin(half);
    Ok(DQuat::from_xyzw(vector.x, vector.y, vector.z, libm::cos(half)).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::parse::{Format, parse};

    fn read(orientation: &str, format: Format) -> Result<DQuat, String> {
        let text = match format {
            Format::Json => format!("{{ \"bodies\": [ {{ \"orientation\": {orientation} }} ] }}"),
            Format::Ron => format!("( bodies: [ ( orientation: {orientation} ) ] )"),
        };
        let model = parse(&text, format, "scene").map_err(|error| error.to_string())?;
        rotation(model.bodies[0].orientation.as_ref().unwrap()).map_err(|error| error.to_string())
    }

    /// A third of a turn about the diagonal takes x to y, y to z and z to x.
    #[test]
    fn an_axis_and_an_angle_are_a_quaternion() {
        for (text, format) in [
            (r#"{ "axis": [2, 2, 2], "angle": 2.0943951023931953 }"#, Format::Json),
            ("(axis: (2, 2, 2), angle: 2.0943951023931953)", Format::Ron),
            ("[0.5, 0.5, 0.5, 0.5]", Format::Json),
            ("(0.5, 0.5, 0.5, 0.5)", Format::Ron),
        ] {
            let rotation = read(text, format).unwrap();
            let turned = (rotation * glam::DVec3::X - glam::DVec3::Y).length();
            assert!(
                turned < 1e-15 && (rotation * glam::DVec3::Z - glam::DVec3::X).length() < 1e-15,
                "{text}: {rotation}"
            );
        }
    }

    #[test]
    fn what_is_no_rotation_is_named() {
        for (text, wanted) in [
            (r#"{ "axis": [0, 0, 0], "angle": 1 }"#, "orientation.axis: is zero"),
            (r#"{ "axis": [0, 1, 0] }"#, "missing field `angle`"),
            (r#"{ "axis": [0, 1, 0], "angle": 1, "degrees": 2 }"#, "unknown field `degrees`"),
            ("[0, 0, 0, 2]", "is not a unit quaternion"),
            ("[0, 0, 1]", "4 values"),
            ("1", "a quaternion of 4 values, or an axis and an angle"),
        ] {
            let problem = read(text, Format::Json).unwrap_err();
            assert!(problem.contains(wanted), "{text}: {problem}");
        }
        assert!(read("(axis: (0, 1, 0), angle: inf)", Format::Ron).unwrap_err().contains("must be finite"));
    }
}
