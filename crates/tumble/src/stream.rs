use std::ops::{ControlFlow, Range};
use std::time::{Duration, Instant};

use rayon::prelude::*;

/// A block is doubled while it takes less than this.
const BLOCK_TIME: Duration = Duration::from_millis(100);

/// Results that are held at a time, at most.
const LARGEST_BLOCK: usize = 8192;

/// Works through any number of worlds in bounded memory: each is made, run, reduced and dropped inside `work`, in parallel, and
/// `take` is given the results in the order of the worlds.
///
/// Worlds are worked on in blocks, one world a thread at first and more while a block takes less than a tenth of a second, up to
/// 8192. So no more than that many results, and one world a thread, are in memory at a time. Neither the results nor their order depend
/// on the blocks or the threads. `take` ends the work with [`ControlFlow::Break`]; the rest of the block is dropped.
///
/// ```
/// use std::ops::ControlFlow;
/// use tumble::prelude::*;
/// use tumble::{Chance, Trial, stream};
///
/// let mut highest = f64::NEG_INFINITY;
/// let end = stream(
///     0..10_000,
///     |index| {
///         let mut world = hecs::World::new();
///         let speed = Chance::stream(1, index).between(0.0, 10.0);
///         let ball = RigidBody::new(Shape::Point).mass(1.0).linear_velocity(Vec3::Y * speed).build()?;
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
pub fn stream<R: Send, B>(
    worlds: Range<u64>,
    work: impl Fn(u64) -> R + Sync,
    mut take: impl FnMut(u64, R) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let mut block = rayon::current_num_threads().clamp(1, LARGEST_BLOCK);
    let mut results = Vec::new();
    let mut next = worlds.start;
    while next < worlds.end {
        let begun = Instant::now();
        let count = usize::try_from(worlds.end - next).map_or(block, |left| left.min(block));
        let first = next;
        (0..count).into_par_iter().map(|i| work(first + i as u64)).collect_into_vec(&mut results);
        for result in results.drain(..) {
            take(next, result)?;
            next += 1;
        }
        if begun.elapsed() < BLOCK_TIME {
            block = (2 * block).min(LARGEST_BLOCK);
        }
    }
    ControlFlow::Continue(())
}
