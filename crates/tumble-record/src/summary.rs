//! What a run did, in numbers for programs.

use serde::{Deserialize, Serialize};
use tumble::math::Real;

/// The contents of `summary.json`; the keys stand in this order. All numbers are finite.
///
/// Energies are in \[J\], linear momentum in \[kg m/s\], angular momentum about the world's
/// origin in \[kg m^2/s\], times in \[s\]; everything in the world frame.
///
/// ```
/// use tumble_record::Conserved;
///
/// let energy = Conserved { initial: 2.0, r#final: 2.5, max_relative_drift: 0.25 };
/// assert_eq!(energy.max_relative_drift, (energy.r#final - energy.initial) / energy.initial);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Bodies, fixed and kinematic ones among them.
    pub bodies: u64,
    /// Independent worlds.
    pub worlds: u64,
    /// Steps that were done, fewer than asked for if the run was interrupted.
    pub steps: u64,
    /// Time step \[s\].
    pub dt: Real,
    /// Parts that each step was divided into.
    pub substeps: u32,
    /// The integrator's name on the command line.
    pub integrator: String,
    /// `f32` or `f64`.
    pub precision: String,
    /// Threads that stepped.
    pub threads: u64,
    /// The vector instructions that were used, or `scalar`.
    pub simd: String,
    /// From the start of the first step to the end of the last, with recording and measuring \[s\].
    pub wall_seconds: f64,
    /// Spent inside the steps \[s\].
    pub step_seconds: f64,
    /// `bodies * steps / step_seconds`, 0 where no time passed \[1/s\].
    pub body_steps_per_second: f64,
    /// Kinetic energy and the potential energies of gravity and of forces that have one.
    pub energy: Conserved<f64>,
    /// Sum over bodies of `P`.
    pub linear_momentum: Conserved<[f64; 3]>,
    /// Sum over bodies of `x * P + L`.
    pub angular_momentum: Conserved<[f64; 3]>,
    /// Hash over pose and momentum bits in body order, 16 hexadecimal digits.
    pub state_hash: String,
}

/// A quantity at both ends of a run, and the largest departure from its start in between.
///
/// The drift is relative to a scale that the run took at the start, never smaller than
/// `|initial|`; see the run's documentation. Where the scale is zero the drift is 0 if the quantity
/// stayed zero and 1 if it did not.
///
/// ```
/// use tumble_record::Conserved;
///
/// // An energy that rose by a quarter of the scale and came back.
/// let energy = Conserved { initial: 2.0, r#final: 2.0, max_relative_drift: 0.25 };
/// assert!(energy.max_relative_drift > 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conserved<T> {
    /// Before the first step.
    pub initial: T,
    /// After the last step.
    pub r#final: T,
    /// Largest `|value - initial| / scale` over the samples.
    pub max_relative_drift: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keys_are_the_contract() {
        let zero = Conserved { initial: 0.0, r#final: 0.0, max_relative_drift: 0.0 };
        let zeros = Conserved { initial: [0.0; 3], r#final: [0.0; 3], max_relative_drift: 0.0 };
        let summary = Summary {
            bodies: 1,
            worlds: 1,
            steps: 2,
            dt: 0.01,
            substeps: 1,
            integrator: "moser-veselov".into(),
            precision: "f32".into(),
            threads: 2,
            simd: "scalar".into(),
            wall_seconds: 0.5,
            step_seconds: 0.25,
            body_steps_per_second: 8.0,
            energy: zero,
            linear_momentum: zeros,
            angular_momentum: zeros,
            state_hash: format!("{:016x}", 1),
        };
        // The order of keys is that of the text, which a map of serde_json would lose.
        assert_eq!(
            serde_json::to_string(&summary).unwrap(),
            "{\"bodies\":1,\"worlds\":1,\"steps\":2,\"dt\":0.01,\"substeps\":1,\
             \"integrator\":\"moser-veselov\",\"precision\":\"f32\",\"threads\":2,\"simd\":\"scalar\",\
             \"wall_seconds\":0.5,\"step_seconds\":0.25,\"body_steps_per_second\":8.0,\
             \"energy\":{\"initial\":0.0,\"final\":0.0,\"max_relative_drift\":0.0},\
             \"linear_momentum\":{\"initial\":[0.0,0.0,0.0],\"final\":[0.0,0.0,0.0],\"max_relative_drift\":0.0},\
             \"angular_momentum\":{\"initial\":[0.0,0.0,0.0],\"final\":[0.0,0.0,0.0],\"max_relative_drift\":0.0},\
             \"state_hash\":\"0000000000000001\"}"
        );
    }
}
