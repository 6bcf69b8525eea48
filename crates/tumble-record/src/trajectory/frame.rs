//! One trajectory frame: time, step, and the state of every body in a fixed order.

use std::io;

use hecs::World;
use tumble::{BodyId, BodyOrder, Pose, Simulation, Velocity};

use tumble_scene::BodyNames;

/// All bodies at one step, as they are recorded. `Velocity` must be that of the state: run
/// [`update_derived`](tumble::update_derived) before.
///
/// ```
/// use tumble::{BodyOrder, Simulation};
/// use tumble_record::Frame;
/// use tumble_scene::Scene;
///
/// let scene = Scene::open("iss")?;
/// let mut world = hecs::World::new();
/// let simulation = Simulation::new(scene.settings)?;
/// let names = scene.spawn(&mut world)?;
/// let order = BodyOrder::of(&world);
/// let frame = Frame::of(&simulation, &world, &order, &names);
/// assert_eq!((frame.step, frame.time), (0, 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// Steps done.
    pub step: u64,
    /// Time \[s\].
    pub time: f64,
    /// Where the bodies are.
    pub world: &'a World,
    /// Which of them, in which order.
    pub order: &'a BodyOrder,
    /// What they are called.
    pub names: &'a BodyNames,
}

impl<'a> Frame<'a> {
    /// At the step that a simulation has come to.
    #[must_use]
    pub fn of(simulation: &Simulation, world: &'a World, order: &'a BodyOrder, names: &'a BodyNames) -> Self {
        Self { step: simulation.steps(), time: simulation.time(), world, order, names }
    }

    /// Calls `row` with the number for [`BodyNames::of`] and the state of each body, in order.
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
