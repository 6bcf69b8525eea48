//! How often the sums over a world are sampled in a run.

/// Up to this number of body-steps every step is a sample: measuring them all takes a second at
/// most.
pub(crate) const EVERY_STEP_UP_TO: u64 = 1_000_000;

/// Samples of longer runs.
const SAMPLES: u64 = 64;

/// Steps between samples; the last step is always one.
pub(crate) fn interval(bodies: u64, steps: u64) -> u64 {
    if bodies.max(1).saturating_mul(steps) <= EVERY_STEP_UP_TO { 1 } else { steps.div_ceil(SAMPLES).max(1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_runs_are_sampled_at_every_step_and_long_ones_at_most_64_times() {
        assert_eq!(interval(1, 1_000_000), 1);
        assert_eq!(interval(10_000, 600), 10);
        assert!(1_000_000_007_u64.div_ceil(interval(1, 1_000_000_007)) <= SAMPLES);
        assert_eq!(interval(u64::MAX, 1), 1);
    }
}
