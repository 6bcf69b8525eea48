//! The threads that step: a pool of this process, made when it is needed first.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::Failure;

/// Threads of a pool belong to the process that started them; a fork has none of them.
struct Pool {
    process: u32,
    wanted: usize,
    pool: Option<Arc<ThreadPool>>,
}

static POOL: Mutex<Pool> = Mutex::new(Pool { process: 0, wanted: 0, pool: None });

/// Bodies of a world up to which a step stays on the calling thread.
pub(crate) const ONE_THREAD: usize = 512;

/// Calls `work` in the pool, while other threads of Python run.
pub(crate) fn in_pool<R: Send>(py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    let pool = pool()?;
    Ok(py.detach(|| pool.install(work)))
}

/// How long a burst of steps is to take: after each a Ctrl-C is noticed.
const BURST: Duration = Duration::from_millis(50);

/// How many steps a burst has: found while stepping.
pub(crate) struct Burst(u32);

impl Default for Burst {
    fn default() -> Self {
        Self(1)
    }
}

/// Takes `count` steps in bursts, while other threads of Python run; `step` gets whether it is the
/// last.
pub(crate) fn in_bursts(
    py: Python<'_>,
    burst: &mut Burst,
    count: u32,
    mut step: impl FnMut(u32, bool) + Send,
) -> PyResult<()> {
    let (mut left, Burst(burst)) = (count, burst);
    while left > 0 {
        let (now, begun) = ((*burst).min(left), Instant::now());
        left -= now;
        py.detach(|| step(now, left == 0));
        if begun.elapsed() < BURST / 2 {
            *burst = burst.saturating_mul(2);
        } else if begun.elapsed() > BURST {
            *burst = (*burst / 2).max(1);
        }
        py.check_signals()?;
    }
    Ok(())
}

pub(crate) fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if held.process != process {
        // To end threads that are not there would wait for ever.
        std::mem::forget(held.pool.take());
        held.process = process;
    }
    if let Some(pool) = &held.pool {
        return Ok(Arc::clone(pool));
    }
    let made = ThreadPoolBuilder::new().num_threads(held.wanted).build();
    let made = made.map_err(|error| PyRuntimeError::new_err(format!("cannot start threads: {error}")))?;
    Ok(Arc::clone(held.pool.insert(Arc::new(made))))
}

/// How many threads step. At first one for each core, or `RAYON_NUM_THREADS`.
#[pyfunction]
pub(crate) fn threads() -> PyResult<usize> {
    Ok(pool()?.current_num_threads())
}

/// Lets `count` threads step from now on; 0 is one for each core. Results do not depend on it.
#[pyfunction]
pub(crate) fn set_threads(py: Python<'_>, count: i64) -> PyResult<()> {
    let wanted = usize::try_from(count).ok().filter(|count| *count <= 1024);
    let wanted = wanted.ok_or_else(|| Failure::argument("count", format!("0 to 1024 threads, not {count}")))?;
    let old = {
        let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
        held.wanted = wanted;
        let old = held.pool.take();
        if held.process == std::process::id() {
            old
        } else {
            std::mem::forget(old);
            None
        }
    };
    // Its threads end when nobody uses them any more.
    py.detach(|| drop(old));
    Ok(())
}
