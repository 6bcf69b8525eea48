//! How long the benches measure.

use std::time::Duration;

use criterion::Criterion;

/// Short enough that the whole suite takes minutes. Ten samples even where one takes a tenth of a
/// second; for a closer look
/// `cargo bench --bench NAME -- FILTER --measurement-time 10 --sample-size 50`.
pub(crate) fn criterion() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(600))
        // Both take longer than the measurement, and ten samples have no more to tell.
        .nresamples(5_000)
        .without_plots()
}
