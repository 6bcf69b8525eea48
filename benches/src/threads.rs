//! Benchmark sizes, and thread pools for single-threaded and parallel runs.

use rayon::{ThreadPool, ThreadPoolBuilder};

/// The numbers of bodies that each bench runs with.
pub const SIZES: [usize; 5] = [100, 1_000, 10_000, 100_000, 1_000_000];

/// A pool of one thread and one of two.
///
/// # Panics
/// As [`pool`] does.
pub fn pools() -> [ThreadPool; 2] {
    [1, 2].map(pool)
}

/// A pool of this many threads: made once, since starting threads is not what is measured.
///
/// # Panics
/// Where the system has no threads to give; there is nothing to measure then.
#[allow(clippy::expect_used, reason = "without threads there is nothing to measure")]
pub fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool")
}

/// Calls `work` with all items, a part of them on each of `threads` threads, and each part in a
/// pool of its own with one thread: two worlds of an engine whose steps wait in a pool of two
/// threads wait for each other forever.
pub fn in_pools_of_one<T: Send>(items: &mut [T], threads: usize, work: impl Fn(&mut T) + Sync) {
    let alone: Vec<ThreadPool> = (0..threads).map(|_| pool(1)).collect();
    let part = items.len().div_ceil(threads).max(1);
    let work = &work;
    std::thread::scope(|scope| {
        for (items, alone) in items.chunks_mut(part).zip(&alone) {
            scope.spawn(move || alone.install(|| items.iter_mut().for_each(work)));
        }
    });
}

/// How a bench is called that runs on a pool, such as `"2 threads"`.
pub fn label(pool: &ThreadPool) -> String {
    match pool.current_num_threads() {
        1 => "1 thread".to_owned(),
        threads => format!("{threads} threads"),
    }
}
