//! A gear between joints of a file, checked.

use tumble::Gear;
use tumble::hecs::Entity;

use crate::checked::real;

/// A checked gear between two joints of a file: `second = offset + ratio * first`.
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
/// let joint = |name: &str, inside: &str| {
///     format!(
///         r#"<joint name="{name}" type="prismatic">
/// <parent link="palm"/> <child link="{name}"/> {inside} </joint>"#
///     )
/// };
/// let text = format!(
///     r#"<robot name="gripper"> {} {} {} {} {} </robot>"#,
///     link("palm"),
///     link("left"),
///     link("right"),
///     joint("left", ""),
///     joint("right", r#"<mimic joint="left" multiplier="-1"/>"#)
/// );
/// let robot = Robot::from_text(&text, "gripper.urdf", InertiaRepairs::Refused)?;
/// let gear = robot.gears[0];
/// assert_eq!(gear.joints.map(|joint| robot.joints[joint].name.as_str()), ["left", "right"]);
/// assert_eq!((gear.ratio, gear.offset), (-1.0, 0.0));
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImportedGear {
    /// The joints, by their index among those of the file. Each has one free axis.
    pub joints: [usize; 2],
    /// How much the second value changes with the first: a number, [m/rad] or [rad/m].
    pub ratio: f64,
    /// The second value where the first is zero \[m\] \[rad\].
    pub offset: f64,
}

impl ImportedGear {
    /// The engine's gear between these entities, the joints in the order of
    /// [`joints`](Self::joints).
    #[must_use]
    pub fn between(&self, [first, second]: [Entity; 2]) -> Gear {
        Gear { offset: real(self.offset), ..Gear::new(first, second, real(self.ratio)) }
    }
}
