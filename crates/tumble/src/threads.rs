//! Whether work is handed to other threads.
//!
//! To hand work over takes some microseconds where the other threads are awake and idle, and where they are not, as long as it takes until the system lets them run: milliseconds on a busy
//! machine, for each time that one waits for another. So a step that is called from outside a pool enters it once, as a whole, where it has enough to do, and takes place on the calling thread alone
//! where it has not. Within a pool work is divided where each of the parts is worth it. Nothing but time depends on any of it.

use hecs::World;
use rayon::iter::{IndexedParallelIterator, MinLen};

use crate::contacts::{Collider, Contacts};
use crate::force_laws::ForceLaws;
use crate::pairs::{GravityMass, Spring};

/// Work as the time that it takes one thread, roughly \[us\].
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Effort(f64);

/// Less work \[us\] does not enter a pool. It is a sixteenth of a frame, of which two threads would save half at best.
const LEAST: Effort = Effort(1000.0);

/// A step of a body [us].
const BODY: f64 = 0.02;
/// The same under force laws.
const BODY_UNDER_LAWS: f64 = 0.1;
/// What two bodies do that attract each other.
const ATTRACTION: f64 = 0.002;
const SPRING: f64 = 0.2;
/// A contact, from finding it to the last of four substeps.
const CONTACT: f64 = 0.6;
/// What is added where shapes have no lanes of their own.
const PAIR_OF_OTHERS: f64 = 3.0;

impl Effort {
    /// Of steps in a world, whose contacts were these after the last. Of bodies that act on each other it is that of one step, for they wait for each other in every one.
    pub(crate) fn of_steps(world: &World, laws: &ForceLaws, contacts: Option<&Contacts>, steps: u32) -> Self {
        let [mut attracting, mut springs, mut colliders] = [0.0; 3];
        let mut bodies = 0.0;
        for archetype in world.archetypes().filter(|archetype| !archetype.is_empty()) {
            let count = f64::from(archetype.len());
            bodies += count * if laws.may_act_on(archetype) { BODY_UNDER_LAWS } else { BODY };
            attracting += if archetype.has::<GravityMass>() { count } else { 0.0 };
            springs += if archetype.has::<Spring>() { count } else { 0.0 };
            colliders += if archetype.has::<Collider>() { count } else { 0.0 };
        }
        if attracting + springs + colliders == 0.0 {
            return Self(bodies * f64::from(steps));
        }
        // Before the first step nobody knows how many touch.
        let (known, of_others) = contacts.map_or((0, 0), Contacts::counts);
        let contacts = CONTACT * colliders.max(known as f64) + PAIR_OF_OTHERS * of_others as f64;
        Self(bodies + ATTRACTION * attracting * attracting + SPRING * springs + contacts)
    }

    /// Of a system that goes once through the bodies of a world.
    pub(crate) fn of_bodies(world: &World, laws: &ForceLaws) -> Self {
        let each = if laws.act_in(world) { BODY_UNDER_LAWS } else { BODY };
        Self(f64::from(world.len()) * each)
    }

    /// Of sums over this many bodies, which take about as long as a step of them.
    pub(crate) fn of_sums(bodies: usize) -> Self {
        Self(bodies as f64 * BODY)
    }

    /// Does it within the rayon pool that is the caller's where it is worth it, and otherwise where the caller is.
    pub(crate) fn run<R: Send>(self, work: impl FnOnce() -> R + Send) -> R {
        if self < LEAST || are_shared() || rayon::current_num_threads() < 2 {
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
