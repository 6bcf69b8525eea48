//! What a simulation tells of the joints of its world.

use crate::joints::joint_event::JointEvent;
use crate::step::simulation::Simulation;

impl Simulation {
    /// The joints that broke in the last step, or lost a body before it; in the same order each
    /// time, and of all the steps of one call, as [`contact_events`](Self::contact_events).
    ///
    /// ```
    /// # use tumble::{JointEvent, prelude::*};
    /// # let mut world = tumble::hecs::World::new();
    /// # let mut simulation = Simulation::new(Settings::default())?;
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

    /// In how many parts joints were solved in the last step, of mechanisms that nothing touches:
    /// for each its substeps, and the halves of those in which its joints were not met. Many more
    /// than substeps are a mechanism that is too fast for them.
    ///
    /// ```
    /// # use tumble::{Joint, prelude::*};
    /// # let mut world = tumble::hecs::World::new();
    /// # let base = RigidBody::new(Shape::Point);
    /// # let bob = RigidBody::new(Shape::Point).mass(1.0).position(Vec3::X);
    /// # let base = base.fixed().build()?.spawn(&mut world);
    /// # let bob = bob.build()?.spawn(&mut world);
    /// world.spawn((Joint::ball(base, bob).at_point(&world, Vec3::ZERO)?,));
    /// let mut simulation = Simulation::new(Settings::default().with_contact_substeps(4))?;
    /// simulation.step(&mut world);
    /// assert_eq!(simulation.joint_substeps(), 4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn joint_substeps(&self) -> u64 {
        self.interactions.as_ref().map_or(0, |interactions| interactions.mechanisms.parts())
    }
}
