//! What is refused as absurd, so that a slip of a finger does not fill a disk or a memory.

use std::ops::RangeInclusive;

use tumble::math::Real;
use tumble_import::{checked, shortest};

/// Most bodies of a scene, listed or generated.
pub const MAX_BODIES: usize = 10_000_000;

/// Most drives of a joint.
pub(crate) const MAX_DRIVES: usize = 64;

/// Most heights of a height field in a scene.
pub const MAX_HEIGHTS: usize = 4_000_000;

/// Most steps of a run.
pub const MAX_STEPS: u64 = 1_000_000_000_000;

/// Time steps that make sense \[s\].
pub const TIME_STEPS: RangeInclusive<f64> = 1e-9..=1e6;

/// The time step \[s\] in the build's precision.
///
/// # Errors
/// A sentence about a step outside [`TIME_STEPS`], to stand behind the field's name.
///
/// ```
/// assert_eq!(tumble_scene::time_step(0.25), Ok(0.25));
/// assert!(tumble_scene::time_step(f64::NAN).is_err());
/// ```
pub fn time_step(seconds: f64) -> Result<Real, String> {
    if TIME_STEPS.contains(&seconds) {
        Ok(checked::real(seconds))
    } else {
        Err(format!(
            "must be from {:e} to {:e} seconds, not {}",
            TIME_STEPS.start(),
            TIME_STEPS.end(),
            shortest(seconds)
        ))
    }
}

/// How many steps of `dt` \[s\] a simulated time \[s\] has, rounded to the nearest.
///
/// # Errors
/// A sentence about a time below zero or a number over [`MAX_STEPS`], to stand behind the option's
/// or the field's name.
///
/// ```
/// assert_eq!(tumble_scene::steps_of_duration(1.1, 0.25), Ok(4));
/// assert!(tumble_scene::steps_of_duration(1e9, 1e-9).is_err());
/// assert!(tumble_scene::steps_of_duration(-1.0, 0.25).is_err());
/// ```
#[allow(clippy::useless_conversion, reason = "dt is f64 already in one of the two builds")]
pub fn steps_of_duration(seconds: f64, dt: Real) -> Result<u64, String> {
    if seconds < 0.0 {
        return Err(format!("must not be negative, as {seconds} is"));
    }
    let steps = (seconds / f64::from(dt)).round();
    if steps <= MAX_STEPS as f64 {
        Ok(steps as u64)
    } else {
        Err(format!("{seconds} makes {steps:e} steps, more than {MAX_STEPS}"))
    }
}

/// The number of steps of a run.
///
/// # Errors
/// A sentence about a number over [`MAX_STEPS`], to stand behind the field's name.
///
/// ```
/// assert_eq!(tumble_scene::step_count(1000), Ok(1000));
/// assert!(tumble_scene::step_count(u64::MAX).is_err());
/// ```
pub fn step_count(steps: u64) -> Result<u64, String> {
    if steps <= MAX_STEPS { Ok(steps) } else { Err(format!("must be at most {MAX_STEPS}, not {steps}")) }
}
