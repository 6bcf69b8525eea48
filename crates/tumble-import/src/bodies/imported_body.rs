//! A body of a file, checked.

use tumble::{Body, Collider};

use crate::bodies::appearance::Appearance;
use crate::bodies::imported_collider::ImportedCollider;

/// A checked body, what it collides with and what it looks like.
///
/// ```
/// use tumble_import::{Appearance, InertiaRepairs, Robot};
///
/// let robot = r#"<robot name="brick"> <link name="base"> <inertial>
///     <mass value="2"/> <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/>
/// </inertial> <visual> <geometry> <sphere radius="0.1"/> </geometry> </visual> </link> </robot>"#;
/// let robot = Robot::from_text(robot, "brick.urdf", InertiaRepairs::Refused)?;
/// let (bodies, names) = robot.into_bodies("brick.urdf")?;
/// assert_eq!(names, ["base"]);
/// assert!(bodies[0].collider.is_none() && matches!(bodies[0].appearance, Appearance::Shape(_)));
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ImportedBody {
    /// Mass properties, pose and velocity.
    pub body: Body,
    /// What it looks like in its own frame.
    pub appearance: Appearance,
    /// What it touches others with.
    pub collider: Option<Collider>,
    /// What its file says of its colliders and triggers.
    pub pieces: Vec<ImportedCollider>,
}
