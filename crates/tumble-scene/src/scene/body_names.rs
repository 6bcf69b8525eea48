//! Names of the bodies of a scene.

use std::borrow::Cow;

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
}
