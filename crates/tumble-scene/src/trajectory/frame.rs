use std::io;

use hecs::World;
use tumble::{BodyId, BodyOrder, Pose, Velocity};

use crate::Names;

/// All bodies at one step.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) step: u64,
    pub(crate) time: f64,
    pub(crate) world: &'a World,
    pub(crate) order: &'a BodyOrder,
    pub(crate) names: &'a Names,
}

impl Frame<'_> {
    /// Calls `row` with the number for [`Names::of`] and the state of each body, in order.
    pub(crate) fn for_each(
        &self,
        mut row: impl FnMut(u64, &Pose, Option<&Velocity>) -> io::Result<()>,
    ) -> io::Result<()> {
        let states = self.world.view::<(&Pose, Option<&Velocity>, Option<&BodyId>)>();
        for (index, &entity) in self.order.entities().iter().enumerate() {
            let Some((pose, velocity, id)) = states.get(entity) else { continue };
            row(id.map_or(index as u64, |id| id.0), pose, velocity)?;
        }
        Ok(())
    }
}
