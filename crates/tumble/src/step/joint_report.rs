//! What a simulation tells of the joints of its world.

use crate::joints::joint_event::JointEvent;
use crate::step::simulation::Simulation;

impl Simulation {
    /// The joints that broke in the last step, or lost a body before it; in the same order each
    /// time, and of all the steps of one call, as
    /// [`contact_events`](Self::contact_events).
    ///
    /// ```
    /// # use tumble::{JointEvent, prelude::*};
    /// # let (mut world, mut simulation) = (tumble::hecs::World::new(), Simulation::new(Settings::default())?);
    /// simulation.step(&mut world);
    /// let gone: Vec<_> = simulation.joint_events().collect();
    /// for event in gone {
    ///     if let JointEvent::Broke(joint) | JointEvent::EndIsGone(joint) = event {
    ///         world.despawn(joint)?;
    ///     }
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn joint_events(&self) -> impl Iterator<Item = JointEvent> + '_ {
        let of_call = self.interactions.iter().filter(|_| self.has_stepped);
        let of_call = of_call.flat_map(|interactions| interactions.mechanisms.list.events.iter());
        self.joint_events.iter().chain(of_call).copied()
    }
}
