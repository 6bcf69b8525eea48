//! What a simulation tells of the sensors of its world.

use crate::collision::sensors::SensorEvent;
use crate::step::simulation::Simulation;

impl Simulation {
    /// What has come into [sensors](crate::Collider::sensor) and left them in the steps of the last
    /// call, as [`contact_events`](Self::contact_events): each event once, in the order of the
    /// steps, and within a step in the order of the bodies.
    ///
    /// A body is in a sensor where their shapes have a point in common at the end of a step, or of
    /// a substep of the settings. What passes through a sensor within one comes in and leaves in
    /// it. What is in a sensor and is despawned, or loses its collider, leaves in the step after.
    /// After a [`restore`](Self::restore) what is in a sensor has come in before.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// # let mut world = tumble::hecs::World::new();
    /// # let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.step(&mut world);
    /// for event in simulation.sensor_events().filter(|event| event.begins) {
    ///     println!("{:?} steps on {:?}", event.body, event.sensor);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sensor_events(&self) -> impl Iterator<Item = SensorEvent> + '_ {
        let collision = self.collision().filter(|_| self.has_stepped);
        let of_call = collision.into_iter().flat_map(|collision| collision.sensors.events.iter());
        self.sensor_events.iter().chain(of_call).copied()
    }

    /// What was in [sensors](crate::Collider::sensor) when the last step ended, in the order of the
    /// bodies: each as the event with which it came in.
    ///
    /// ```
    /// use tumble::prelude::*;
    ///
    /// let mut world = hecs::World::new();
    /// let water = RigidBody::new(Shape::cuboid([5.0, 1.0, 5.0])).fixed().sensor().build()?;
    /// let water = water.spawn(&mut world);
    /// let ball = RigidBody::new(Shape::sphere(0.2)).mass(1.0).build()?.spawn(&mut world);
    ///
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.step(&mut world);
    /// let swimming: Vec<_> = simulation.sensed().map(|it| (it.sensor, it.body)).collect();
    /// assert_eq!(swimming, [(water, ball)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sensed(&self) -> impl Iterator<Item = SensorEvent> + '_ {
        self.collision().into_iter().flat_map(|collision| collision.sensors.inside())
    }
}
