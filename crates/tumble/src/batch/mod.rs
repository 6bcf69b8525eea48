//! Batches of independent worlds, stepped in parallel with results in world order.

pub(crate) mod rng;
pub(crate) mod run_worlds;
pub(crate) mod trial;

pub use crate::batch::rng::Rng;
pub use crate::batch::run_worlds::for_each_world;
pub use crate::batch::trial::Trial;

use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::solver::multi_world::MultiWorld;
use crate::step::interacting::step_interacting;
use crate::step::pack_key::PackKey;

/// Many independent worlds, each with its own settings, stepped in parallel.
///
/// Threads take whole worlds, and a world takes many steps at a time while it is in cache. It gets
/// the same bits as alone, for any number of threads and whatever the other worlds are. The threads
/// are those of the rayon pool that it is called in, as for a step; a world of many bodies is split
/// among them too.
///
/// Results come back in the order of the worlds. A batch is held in memory as a whole;
/// [`for_each_world`] makes worlds one by one, as many as one likes.
///
/// ```
/// use tumble::prelude::*;
/// use tumble::{Batch, Trial};
///
/// // A thousand bricks, each thrown in its own way.
/// let mut batch = Batch::from_seed(
///     1000,
///     42,
///     |_, mut rng| -> Result<_, Box<dyn std::error::Error + Send + Sync>> {
///         let mut world = hecs::World::new();
///         RigidBody::new(Shape::cuboid([0.1, 0.05, 0.03]))
///             .mass(2.0)
///             .angular_velocity(rng.vector(-5.0, 5.0))
///             .build()?
///             .spawn(&mut world);
///         Ok(Trial::new(Settings::default(), world)?)
///     },
/// )?;
/// batch.step_many(60);
/// let heights: Vec<f64> = batch.map(|_, trial| {
///     trial.world.query_mut::<&Pose>().into_iter().map(|pose| f64::from(pose.position.y)).sum()
/// });
/// assert_eq!(heights.len(), 1000);
/// assert!(heights.iter().all(|height| (height + 0.5 * 9.81).abs() < 1e-3));
/// # Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
/// ```
#[doc(alias("parallel worlds", "vectorized environments"))]
#[derive(Default)]
pub struct Batch {
    trials: Vec<Trial>,
    /// For worlds next to each other, what their contacts are packed in.
    packs: Vec<MultiWorld>,
}

/// Worlds that go through their steps together: enough for the contacts of eight bodies in each to
/// fill lanes.
const PACK: usize = 16;

impl Batch {
    /// A batch without worlds.
    pub fn new() -> Self {
        Self::default()
    }

    /// Makes `count` worlds in parallel. `set_up` is given the index of a world and
    /// [numbers](Rng::stream) of its own, so that a world depends on nothing but the seed and its
    /// index.
    ///
    /// # Errors
    /// That of the first world, by index, that could not be set up.
    pub fn from_seed<E: Send>(
        count: usize,
        seed: u64,
        set_up: impl Fn(usize, Rng) -> Result<Trial, E> + Sync,
    ) -> Result<Self, E> {
        let made: Vec<Result<Trial, E>> =
            (0..count).into_par_iter().map(|index| set_up(index, Rng::stream(seed, index as u64))).collect();
        // One after the other: in parallel it would be left to chance whose error is returned.
        made.into_iter().collect()
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
    ///
    /// Small worlds with contacts take their steps in packs, since alone they leave most lanes of a
    /// vector empty: up to sixteen neighbours, each with the bits that it has alone. In a pack are
    /// worlds of at most 128 entities, without a ledger, that have `dt`, `substeps`,
    /// `contact_substeps` and `restitution_threshold` in common with the first of them, and also
    /// whether anything in them bounces or resists rolling, and which speed is an impact: where
    /// steps are long, that follows from gravity. The others take their steps by themselves, as all
    /// do in [`map`](Self::map) and [`run`](Self::run).
    pub fn step_many(&mut self, count: u32) {
        self.step_many_then(count, |_, _| {});
    }

    /// [`step_many`](Self::step_many), and calls `observe` with every world and its index when its
    /// steps are done, in parallel: what a world has just computed is still in cache.
    ///
    /// ```
    /// # use std::sync::atomic::{AtomicU64, Ordering};
    /// # use tumble::prelude::*;
    /// # use tumble::{Batch, Trial};
    /// # let trial = || Trial::new(Settings::default(), hecs::World::new());
    /// # let mut batch = Batch::from_seed(10, 1, |_, _| trial())?;
    /// let steps = AtomicU64::new(0);
    /// batch.step_many_then(16, |_index, trial| {
    ///     steps.fetch_add(trial.simulation.steps(), Ordering::Relaxed);
    /// });
    /// assert_eq!(steps.into_inner(), 10 * 16);
    /// # Ok::<(), tumble::SettingsError>(())
    /// ```
    pub fn step_many_then(&mut self, count: u32, observe: impl Fn(usize, &mut Trial) + Sync) {
        // With fewer worlds than would give each thread a pack, threads come first.
        let size = self.trials.len().div_ceil(rayon::current_num_threads()).clamp(1, PACK);
        self.packs.resize_with(self.trials.len().div_ceil(size), MultiWorld::default);
        let packs = self.trials.par_chunks_mut(size).zip(&mut self.packs).enumerate();
        packs.for_each(|(number, (trials, pack))| {
            step_pack(trials, pack, count);
            trials.iter_mut().zip(number * size..).for_each(|(trial, index)| observe(index, trial));
        });
    }

    /// Calls `work` with every world and its index, in parallel, and returns what it gave, in the
    /// order of the worlds.
    pub fn map<R: Send>(&mut self, work: impl Fn(usize, &mut Trial) -> R + Sync) -> Vec<R> {
        self.trials.par_iter_mut().enumerate().map(|(index, trial)| work(index, trial)).collect()
    }

    /// [`Trial::run`] for every world, in parallel: up to `steps` steps, tested every `every`
    /// steps. Each world ends by itself; the results say with what, in the order of the worlds.
    ///
    /// ```
    /// # use std::ops::ControlFlow;
    /// # use tumble::prelude::*;
    /// # use tumble::{Batch, Trial};
    /// # let trial = || Trial::new(Settings::default(), hecs::World::new());
    /// # let mut batch = Batch::from_seed(10, 1, |_, _| trial())?;
    /// let ends = batch.run(100, 10, |index, trial| {
    ///     // World 3 has seen enough after 50 steps.
    ///     if index == 3 && trial.simulation.steps() >= 50 {
    ///         ControlFlow::Break(())
    ///     } else {
    ///         ControlFlow::Continue(())
    ///     }
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

/// Advances worlds, those together that can be.
fn step_pack(trials: &mut [Trial], pack: &mut MultiWorld, count: u32) {
    let (mut common, mut together, mut others) = (None, Vec::new(), Vec::new());
    for trial in trials {
        let is_alone = count == 0 || trial.simulation.has_contact_hook();
        match PackKey::of(&trial.world, trial.simulation.settings()).filter(|_| !is_alone) {
            Some(pack_key) if *common.get_or_insert(pack_key) == pack_key => together.push(trial),
            _ => others.push(trial),
        }
    }
    if together.len() < 2 {
        others.append(&mut together);
    }
    let step_others = || others.into_par_iter().for_each(|trial| trial.step_many(count));
    match common.filter(|_| !together.is_empty()) {
        Some(pack_key) => rayon::join(|| step_together(&mut together, pack, pack_key, count), step_others).0,
        None => step_others(),
    }
}

fn step_together(trials: &mut [&mut Trial], pack: &mut MultiWorld, pack_key: PackKey, count: u32) {
    crate::scope::scope!("tumble::pack");
    let worlds = trials.iter_mut().filter_map(|trial| trial.simulation.interacting(&mut trial.world));
    let mut worlds: Vec<_> = worlds.collect();
    let found = worlds.len();
    step_interacting(&mut worlds, Some((pack, pack_key)), count, None);
    drop(worlds);
    // Where there are colliders, bodies may act on each other.
    debug_assert_eq!(found, trials.len());
    trials.iter_mut().for_each(|trial| trial.simulation.count_steps(count));
}

impl FromIterator<Trial> for Batch {
    fn from_iter<I: IntoIterator<Item = Trial>>(trials: I) -> Self {
        Self { trials: trials.into_iter().collect(), packs: Vec::new() }
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
