//! Whether work is handed to other threads.
//!
//! To hand work over takes some microseconds where the other threads are awake and idle, and where
//! they are not, as long as it takes until the system lets them run: milliseconds on a busy
//! machine, for each time that one waits for another. So a step that is called from outside a pool
//! enters it once, as a whole, where it has enough to do, and takes place on the calling thread
//! alone where it has not. Within a pool work is divided where each of the parts is worth it.
//! Nothing but time depends on any of it.

use rayon::iter::{IndexedParallelIterator, MinLen};

/// Work as the time that it takes one thread, roughly \[us\].
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Effort(f64);

/// Less work \[us\] does not enter a pool. It is a sixteenth of a frame, of which two threads would
/// save half at best.
const MIN: Effort = Effort(1000.0);

/// A step of a body \[us\].
pub(crate) const BODY: f64 = 0.02;
/// The same under force laws.
pub(crate) const BODY_UNDER_LAWS: f64 = 0.1;

impl Effort {
    /// Work that takes one thread about this long \[us\].
    pub(crate) fn of_microseconds(time: f64) -> Self {
        Self(time)
    }

    /// Of a system that goes once through this many bodies.
    pub(crate) fn of_bodies(bodies: u32) -> Self {
        Self(f64::from(bodies) * BODY)
    }

    /// The same under force laws.
    pub(crate) fn of_bodies_under_laws(bodies: u32) -> Self {
        Self(f64::from(bodies) * BODY_UNDER_LAWS)
    }

    /// Of sums over this many bodies, which take about as long as a step of them.
    pub(crate) fn of_sums(bodies: usize) -> Self {
        Self(bodies as f64 * BODY)
    }

    /// Does it within the rayon pool that is the caller's where it is worth it, and otherwise where
    /// the caller is.
    pub(crate) fn run<R: Send>(self, work: impl FnOnce() -> R + Send) -> R {
        if self < MIN || are_shared() || rayon::current_num_threads() < 2 {
            return work();
        }
        rayon::scope(|_| work())
    }
}

/// Whether this is a thread of a pool, so that work can be shared without waiting to get in.
pub(crate) fn are_shared() -> bool {
    rayon::current_thread_index().is_some()
}

/// Does both, side by side within a pool.
pub(crate) fn join<A: Send, B: Send>(first: impl FnOnce() -> A + Send, second: impl FnOnce() -> B + Send) -> (A, B) {
    if are_shared() { rayon::join(first, second) } else { (first(), second()) }
}

/// Parts of some work that are done in parallel within a pool.
pub(crate) trait InParts: IndexedParallelIterator {
    /// Divides them among threads by no fewer than this, and outside a pool not at all.
    fn by_at_least(self, parts: usize) -> MinLen<Self> {
        self.with_min_len(if are_shared() { parts.max(1) } else { usize::MAX })
    }
}

impl<I: IndexedParallelIterator> InParts for I {}
