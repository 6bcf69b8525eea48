//! The macro for profiler scopes, empty without the feature `profiling`.

/// Shows a profiler how long the rest of the block takes; nothing at all without the feature
/// `profiling`.
macro_rules! scope {
    ($name:literal) => {
        #[cfg(feature = "profiling")]
        profiling::scope!($name);
    };
}

pub(crate) use scope;
