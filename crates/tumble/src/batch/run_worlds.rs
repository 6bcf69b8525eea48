//! Parallel runs over any number of worlds in bounded memory, with results in order.

use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

/// No world of a block is begun after this.
const BLOCK_TIME: Duration = Duration::from_millis(100);

/// Results that are held at a time, at most.
const LARGEST_BLOCK: usize = 8192;

/// Works through any number of worlds in bounded memory: each is made, run, reduced and dropped
/// inside `work`, in parallel, and `take` is given the results in the order of the worlds.
///
/// Worlds are run in blocks of a tenth of a second, of 8192 worlds at most: a block begins no
/// world after that time, but one on each thread. So at most 8192 results are in memory, and what
/// is finished waits to be taken for a tenth of a second and the time of one world, about. Of the
/// worlds themselves there is one a thread; but a thread that waits inside `work` for others in the
/// same rayon pool, as it does where a world of more than 512 bodies is stepped, may begin further
/// worlds meanwhile, which then are in memory too. Neither the results nor their order depend on
/// the blocks or the threads. `take` ends the work with [`ControlFlow::Break`]; the rest of the
/// block is dropped.
///
/// ```
/// use std::ops::ControlFlow;
/// use tumble::prelude::*;
/// use tumble::{Rng, Trial, for_each_world};
///
/// let mut highest = f64::NEG_INFINITY;
/// let end = for_each_world(
///     0..10_000,
///     |index| {
///         let mut world = hecs::World::new();
///         let speed = Rng::stream(1, index).range(0.0, 10.0);
///         let ball =
///             RigidBody::new(Shape::Point).mass(1.0).linear_velocity(Vec3::Y * speed).build()?;
///         let ball = ball.spawn(&mut world);
///         let mut trial = Trial::new(Settings::default(), world)?;
///         trial.step_many(30);
///         let height = f64::from(trial.world.get::<&Pose>(ball)?.position.y);
///         Ok::<_, Box<dyn std::error::Error + Send + Sync>>(height)
///     },
///     |_, height| match height {
///         Ok(height) => {
///             highest = highest.max(height);
///             ControlFlow::Continue(())
///         }
///         Err(error) => ControlFlow::Break(error),
///     },
/// );
/// assert!(end.is_continue() && highest > 3.7);
/// ```
pub fn for_each_world<R: Send, B>(
    worlds: Range<u64>,
    work: impl Fn(u64) -> R + Sync,
    mut take: impl FnMut(u64, R) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let threads = rayon::current_num_threads().max(1);
    let mut next = worlds.start;
    while next < worlds.end {
        let begun = Instant::now();
        let left = worlds.end - next;
        let count = usize::try_from(left).map_or(LARGEST_BLOCK, |left| left.min(LARGEST_BLOCK));
        let (first, claimed) = (next, AtomicUsize::new(0));
        // Each thread claims the next world until time is up. All that is claimed is done, so the
        // results have no gap.
        let work_until_time_is_up = |_| {
            let mut results = Vec::new();
            loop {
                let index = claimed.fetch_add(1, Ordering::Relaxed);
                if index >= count {
                    break;
                }
                results.push((index, work(first + index as u64)));
                if begun.elapsed() >= BLOCK_TIME {
                    break;
                }
            }
            results
        };
        let results: Vec<Vec<(usize, R)>> =
            (0..threads).into_par_iter().with_max_len(1).map(work_until_time_is_up).collect();
        let mut results: Vec<(usize, R)> = results.into_iter().flatten().collect();
        results.sort_unstable_by_key(|(index, _)| *index);
        for (_, result) in results {
            take(next, result)?;
            next += 1;
        }
    }
    ControlFlow::Continue(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worlds that suddenly take long must not be held back by the thousand because those before
    /// were short.
    #[test]
    fn long_worlds_after_short_ones_do_not_wait_for_each_other() {
        const SHORT: u64 = 30_000;
        const TIME: Duration = Duration::from_millis(2);
        for threads in [1, 2, 4] {
            let done = AtomicUsize::new(0);
            let (mut taken, mut most_waiting) = (0, 0);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let end = pool.install(|| {
                for_each_world(
                    0..SHORT + 500,
                    |index| {
                        if index >= SHORT {
                            std::thread::sleep(TIME);
                            done.fetch_add(1, Ordering::SeqCst);
                        }
                        index
                    },
                    |index, worked_on| {
                        assert_eq!(index, worked_on);
                        if index >= SHORT {
                            most_waiting = most_waiting.max(done.load(Ordering::SeqCst) - taken);
                            taken += 1;
                        }
                        ControlFlow::<()>::Continue(())
                    },
                )
            });
            assert!(end.is_continue());
            assert_eq!(taken, 500);
            // A sleep is never shorter than asked for, so this many end on a thread before time is
            // up, and one more is begun.
            let most = threads * (BLOCK_TIME.as_millis() / TIME.as_millis() + 1) as usize;
            assert!(most_waiting <= most, "{most_waiting} results waited, {threads} threads");
        }
    }
}
