use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::chance::Chance;
use crate::trial::Trial;

/// Many independent worlds, each with its own settings, stepped in parallel.
///
/// Threads take whole worlds, and a world takes many steps at a time while it is in cache. It gets the same bits as alone, for any
/// number of threads and whatever the other worlds are. The threads are those of the rayon pool that it is called in, as for a
/// step; a world of many bodies is split among them too.
///
/// Results come back in the order of the worlds. A batch is held in memory as a whole; [`stream`](crate::stream()) makes worlds one by one, as
/// many as one likes.
///
/// ```
/// use tumble::prelude::*;
/// use tumble::{Batch, Trial};
///
/// // A thousand bricks, each thrown in its own way.
/// let mut batch = Batch::from_seed(1000, 42, |_, mut chance| -> Result<_, Box<dyn std::error::Error + Send + Sync>> {
///     let mut world = hecs::World::new();
///     RigidBody::new(Shape::cuboid([0.1, 0.05, 0.03]))
///         .mass(2.0)
///         .angular_velocity(chance.vector(-5.0, 5.0))
///         .build()?
///         .spawn(&mut world);
///     Ok(Trial::new(Settings::default(), world)?)
/// })?;
/// batch.step_many(60);
/// let heights: Vec<f64> = batch.map(|_, trial| {
///     trial.world.query_mut::<&Pose>().into_iter().map(|pose| f64::from(pose.position.y)).sum()
/// });
/// assert_eq!(heights.len(), 1000);
/// assert!(heights.iter().all(|height| (height + 0.5 * 9.81).abs() < 1e-3));
/// # Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
/// ```
#[derive(Default)]
pub struct Batch {
    trials: Vec<Trial>,
}

impl Batch {
    /// A batch without worlds.
    pub fn new() -> Self {
        Self::default()
    }

    /// Makes `count` worlds in parallel. `set_up` is given the index of a world and [numbers](Chance::stream) of its own, so that a world
    /// depends on nothing but the seed and its index.
    ///
    /// # Errors
    /// That of the first world, by index, that could not be set up.
    pub fn from_seed<E: Send>(
        count: usize,
        seed: u64,
        set_up: impl Fn(usize, Chance) -> Result<Trial, E> + Sync,
    ) -> Result<Self, E> {
        let made: Vec<Result<Trial, E>> =
            (0..count).into_par_iter().map(|index| set_up(index, Chance::stream(seed, index as u64))).collect();
        // One after the other: in parallel it would be left to chance whose error is returned.
        Ok(Self { trials: made.into_iter().collect::<Result<_, E>>()? })
    }

    /// Adds a world at the end.
    pub fn push(&mut self, trial: Trial) {
        self.trials.push(trial);
    }

    /// The worlds, in order.
    pub fn trials(&self) -> &[Trial] {
        &self.trials
    }

    /// The worlds, in order, to be changed.
    pub fn trials_mut(&mut self) -> &mut [Trial] {
        &mut self.trials
    }

    /// How many worlds there are.
    pub fn len(&self) -> usize {
        self.trials.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.trials.is_empty()
    }

    /// Advances every world by `count` steps of its own.
    pub fn step_many(&mut self, count: u32) {
        self.trials.par_iter_mut().for_each(|trial| trial.step_many(count));
    }

    /// Calls `work` with every world and its index, in parallel, and returns what it gave, in the order of the worlds.
    pub fn map<R: Send>(&mut self, work: impl Fn(usize, &mut Trial) -> R + Sync) -> Vec<R> {
        self.trials.par_iter_mut().enumerate().map(|(index, trial)| work(index, trial)).collect()
    }

    /// [`Trial::run`] for every world, in parallel: up to `steps` steps, looked at every `every` steps. Each world ends by itself; the
    /// results say with what, in the order of the worlds.
    ///
    /// ```
    /// # use std::ops::ControlFlow;
    /// # use tumble::prelude::*;
    /// # use tumble::{Batch, Trial};
    /// # let mut batch = Batch::from_seed(10, 1, |_, _| Trial::new(Settings::default(), hecs::World::new()))?;
    /// let ends = batch.run(100, 10, |index, trial| {
    ///     // World 3 has seen enough after 50 steps.
    ///     if index == 3 && trial.simulation.steps() >= 50 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    /// });
    /// assert_eq!(ends.iter().filter(|end| end.is_break()).count(), 1);
    /// assert_eq!(batch.trials()[3].simulation.steps(), 50);
    /// # Ok::<(), tumble::SettingsError>(())
    /// ```
    pub fn run<B: Send>(
        &mut self,
        steps: u64,
        every: u32,
        observe: impl Fn(usize, &mut Trial) -> ControlFlow<B> + Sync,
    ) -> Vec<ControlFlow<B>> {
        self.map(|index, trial| trial.run(steps, every, |trial| observe(index, trial)))
    }
}

impl FromIterator<Trial> for Batch {
    fn from_iter<I: IntoIterator<Item = Trial>>(trials: I) -> Self {
        Self { trials: trials.into_iter().collect() }
    }
}

impl Extend<Trial> for Batch {
    fn extend<I: IntoIterator<Item = Trial>>(&mut self, trials: I) {
        self.trials.extend(trials);
    }
}

impl IntoIterator for Batch {
    type Item = Trial;
    type IntoIter = std::vec::IntoIter<Trial>;

    fn into_iter(self) -> Self::IntoIter {
        self.trials.into_iter()
    }
}
