//! A joint of a file, checked.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};
use tumble::hecs::Entity;
use tumble::{Axes, Drives, Joint, JointFriction, Limit, Limits, Pose};

use crate::bodies::imported_body::ImportedBody;
use crate::checked::{real, real_quaternion, real_vector};

/// How far from the centre of mass of its bodies a joint can be \[m\].
const MAX_DISTANCE: f64 = 1e9;

/// A checked joint between two bodies of a file, with what the file says of its axes.
///
/// ```
/// use tumble_import::{InertiaRepairs, Robot};
///
/// let link = |name: &str| {
///     format!(
///         r#"<link name="{name}"> <inertial> <mass value="2"/>
/// <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/> </inertial> </link>"#
///     )
/// };
/// let robot = format!(
///     r#"<robot name="arm"> {} {} <joint name="elbow" type="revolute">
/// <origin xyz="0 0 1"/> <parent link="upper"/> <child link="lower"/> <axis xyz="0 1 0"/>
/// <limit lower="-1" upper="2" effort="10" velocity="3"/> </joint> </robot>"#,
///     link("upper"),
///     link("lower")
/// );
/// let robot = Robot::from_text(&robot, "arm.urdf", InertiaRepairs::Refused)?;
/// let elbow = &robot.joints[0];
/// assert_eq!((elbow.name.as_str(), elbow.bodies, elbow.kind()), ("elbow", [0, 1], "hinge"));
/// assert_eq!((elbow.max_effort, elbow.max_speed), (Some(10.0), Some(3.0)));
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ImportedJoint {
    /// What its file calls it.
    pub name: String,
    /// The bodies, by their index among those of the file.
    pub bodies: [usize; 2],
    /// The frame of each: origin \[m\] from the centre of mass and orientation, both along the
    /// body's axes.
    pub frames: [Pose; 2],
    /// The axes that are not locked.
    pub free: Axes,
    /// Whether the colliders of its two bodies touch each other.
    pub contacts_enabled: bool,
    /// How far it goes.
    pub limits: Option<Limits>,
    /// Its motors, springs and dampers.
    pub drives: Option<Drives>,
    /// Its dry friction.
    pub friction: Option<JointFriction>,
    /// The greatest force \[N\] or torque [N m] of what drives it, as the file says. It drives
    /// nothing by itself.
    pub max_effort: Option<f64>,
    /// The greatest speed [m/s] [rad/s], as the file says. Nothing keeps to it.
    pub max_speed: Option<f64>,
}

impl ImportedJoint {
    /// The engine's joint between these entities, the bodies in the order of
    /// [`bodies`](Self::bodies).
    #[must_use]
    pub fn between(&self, [a, b]: [Entity; 2]) -> Joint {
        let joint = Joint::free_along(a, b, self.free).with_frames(self.frames[0], self.frames[1]);
        if self.contacts_enabled { joint.with_contacts() } else { joint }
    }

    /// What joints that leave such axes free are called: as the constructors of [`Joint`], or
    /// `other`.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        kind_of(self.free)
    }
}

fn kind_of(free: Axes) -> &'static str {
    let along: Vec<usize> = (0..3).filter(|axis| free.contains(Axes::EACH[*axis])).collect();
    let about: Vec<usize> = (0..3).filter(|axis| free.contains(Axes::EACH[3 + axis])).collect();
    match (along.as_slice(), about.as_slice()) {
        ([], []) => "fixed",
        ([], [_]) => "hinge",
        ([], [_, _]) => "universal",
        ([], _) => "ball",
        ([_], []) => "slider",
        ([a], [b]) if a == b => "cylinder",
        ([a, b], [c]) if a != c && b != c => "planar",
        ([_, _, _], [_, _, _]) => "free",
        _ => "other",
    }
}

/// The frame of a joint on a body, from where it is in the body's frame; `None` if it is too far
/// from the centre of mass.
pub(crate) fn frame_on(body: &ImportedBody, position: DVec3, orientation: DQuat) -> Option<Pose> {
    let center = body.body.properties().map_or(DVec3::ZERO, tumble::MassProperties::center_of_mass);
    let from_center = position - center;
    // Written so that what is not a number is too far.
    let is_near = from_center.abs().max_element() <= MAX_DISTANCE && orientation.is_finite();
    let orientation = real_quaternion(orientation.normalize());
    is_near.then(|| Pose { position: real_vector(from_center), orientation })
}

/// A range of angles \[rad\] if it bounds anything: less than a whole turn, with half a turn in the
/// place of a bound that is infinite.
pub(crate) fn angles(lower: f64, upper: f64) -> Option<[f64; 2]> {
    let from = if lower.is_finite() { lower } else { -PI };
    let to = if upper.is_finite() { upper } else { PI };
    Some([lower, upper]).filter(|_| (0.0..TAU).contains(&(to - from)))
}

/// A hard limit in the engine's precision.
pub(crate) fn hard([lower, upper]: [f64; 2]) -> Limit {
    Limit::new(real(lower), real(upper))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_angles_are_as_they_are_up_to_a_turn() {
        assert_eq!(angles(-1.0, 2.0), Some([-1.0, 2.0]));
        assert_eq!(angles(0.5, 0.5), Some([0.5, 0.5]));
        assert_eq!(angles(-TAU, TAU), None);
        assert_eq!(angles(-PI, PI), None);
        assert_eq!(angles(f64::NEG_INFINITY, f64::INFINITY), None);
        assert_eq!(angles(0.5, f64::INFINITY), Some([0.5, f64::INFINITY]));
        assert_eq!(angles(f64::NEG_INFINITY, 2.5), Some([f64::NEG_INFINITY, 2.5]));
        for bound in [-7.0, -PI, 4.0] {
            assert_eq!(angles(bound, f64::INFINITY), None);
            assert_eq!(angles(f64::NEG_INFINITY, -bound), None);
        }
        // The sixth joint of a published arm.
        assert_eq!(angles(-0.0175, 3.7525), Some([-0.0175, 3.7525]));
        assert_eq!(angles(TAU + 0.5, TAU + 1.0), Some([TAU + 0.5, TAU + 1.0]));
        assert_eq!(angles(-1.0, TAU - 1.0), None);
    }

    #[test]
    fn kinds_are_those_of_the_constructors() {
        let [a, b] = [Entity::DANGLING; 2];
        for (joint, kind) in [
            (Joint::ball(a, b), "ball"),
            (Joint::hinge(a, b), "hinge"),
            (Joint::slider(a, b), "slider"),
            (Joint::cylinder(a, b), "cylinder"),
            (Joint::universal(a, b), "universal"),
            (Joint::planar(a, b), "planar"),
            (Joint::fixed(a, b), "fixed"),
            (Joint::free(a, b), "free"),
            (Joint::free_along(a, b, Axes::LINEAR_X | Axes::ANGULAR_Y), "other"),
        ] {
            assert_eq!(kind_of(joint.free), kind);
        }
    }
}
