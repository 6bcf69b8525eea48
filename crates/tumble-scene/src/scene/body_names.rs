//! Names of the bodies of a scene.

use std::borrow::Cow;

use hecs::Entity;

use crate::convert;

/// The names of a scene's bodies, by [`BodyId`](tumble::BodyId).
///
/// ```
/// use tumble_scene::Scene;
///
/// let mut world = hecs::World::new();
/// let names = Scene::open("mujoco-box")?.spawn(&mut world)?;
/// assert_eq!(names.of(0), "box");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct BodyNames {
    /// `None` where all are called by their number.
    pub(crate) given: Option<Vec<String>>,
    /// The joints that have a name.
    pub(crate) joints: Vec<(String, Entity)>,
}

impl BodyNames {
    /// The name of the body with this id; `body-<id>` for one that the scene does not know.
    #[must_use]
    pub fn of(&self, id: u64) -> Cow<'_, str> {
        let given = self.given.as_ref().zip(usize::try_from(id).ok());
        match given.and_then(|(names, index)| names.get(index)) {
            Some(name) => Cow::Borrowed(name),
            None => Cow::Owned(convert::numbered(id)),
        }
    }

    /// The joint of this name, the first if there are more: to read its
    /// [`JointLoad`](tumble::JointLoad), or give it [`Drives`](tumble::Drives).
    ///
    /// ```
    /// use tumble::{Axes, Drive, Drives};
    /// use tumble_scene::Scene;
    ///
    /// let link = r#"<link name="arm"> <inertial> <mass value="2"/>
    /// <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/> </inertial> </link>"#;
    /// let robot = format!(
    ///     r#"<robot name="r"> <link name="world"/> {link} <joint name="elbow" type="continuous">
    /// <parent link="world"/> <child link="arm"/> <axis xyz="0 0 1"/> </joint> </robot>"#
    /// );
    /// let mut world = hecs::World::new();
    /// let elbow = Scene::from_urdf(&robot, "r.urdf")?.spawn(&mut world)?.joint("elbow");
    /// let servo = Drive::position(Axes::ANGULAR_X, 0.5).with_frequency(2.0, 1.0);
    /// world.insert_one(elbow.ok_or("no elbow")?, Drives::from(servo))?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn joint(&self, name: &str) -> Option<Entity> {
        self.joints.iter().find(|(given, _)| given == name).map(|(_, joint)| *joint)
    }

    /// The joints that have a name, and their entities.
    ///
    /// ```
    /// use tumble_scene::Scene;
    ///
    /// let mut world = hecs::World::new();
    /// let names = Scene::open("crane")?.spawn(&mut world)?;
    /// for (name, joint) in names.joints() {
    ///     assert_eq!(names.joint(name), Some(joint));
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn joints(&self) -> impl Iterator<Item = (&str, Entity)> {
        self.joints.iter().map(|(name, joint)| (name.as_str(), *joint))
    }
}
