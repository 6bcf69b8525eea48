//! The identity of a sweep: everything its rows depend on, compared before files are merged.

use std::ops::Range;

use serde::{Deserialize, Serialize};
use tumble::math::PRECISION;
use tumble_scene::RunLength;

use crate::shard::Shard;
use crate::sweep::Sweep;

/// The version of the files; the only one so far.
const FORMAT: u32 = 1;

/// Which arithmetic the build has: two builds of one version may differ in the bits of their
/// results, and their rows are not to be mixed. Raised by one whenever a hash that
/// `tests/determinism/determinism.rs` pins changes.
const ARITHMETIC: u32 = 2;

/// What the rows of a sweep's file depend on, as its first line has it: two files with the same
/// identity can be one.
///
/// Threads and instruction sets are not in it, because no bit depends on them. It says nothing of
/// the place of the scene's file either, which differs between machines; a hash of its text stands
/// for it.
///
/// ```
/// use tumble_sweep::{Sweep, SweepIdentity, SweepPlan};
///
/// let plan =
///     SweepPlan { scene: "t-handle".into(), worlds: Some(10), ..SweepPlan::default() };
/// let sweep = Sweep::new(plan)?;
/// assert_eq!(SweepIdentity::new(&sweep, None).range(), 0..10);
/// let second = SweepIdentity::new(&sweep, Some("2/3".parse()?));
/// assert_eq!(second.range(), 3..6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepIdentity {
    format: u32,
    tumble: String,
    arithmetic: u32,
    precision: String,
    scene: String,
    worlds: u64,
    seed: u64,
    vary: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    steps: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    duration: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    dt: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    substeps: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    integrator: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    bodies: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    observe: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    until: Option<String>,
    /// No row depends on it, but the file of the series goes with that of the rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    series: Option<u64>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    repair: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    shard: Option<String>,
}

impl SweepIdentity {
    /// That of a sweep, or of one shard of it.
    #[allow(clippy::useless_conversion, reason = "dt is f64 already in one of the two builds")]
    #[must_use]
    pub fn new(sweep: &Sweep, shard: Option<Shard>) -> Self {
        let plan = sweep.plan();
        let (steps, duration) = match plan.length {
            Some(RunLength::Steps(steps)) => (Some(steps), None),
            Some(RunLength::Duration(seconds)) => (None, Some(seconds)),
            None => (None, None),
        };
        Self {
            format: FORMAT,
            tumble: env!("CARGO_PKG_VERSION").to_owned(),
            arithmetic: ARITHMETIC,
            precision: PRECISION.to_owned(),
            scene: format!("{:016x}", sweep.scene_hash()),
            worlds: sweep.worlds(),
            seed: plan.seed,
            vary: plan.vary.iter().map(ToString::to_string).collect(),
            steps,
            duration,
            dt: plan.dt.map(f64::from),
            substeps: plan.substeps,
            integrator: plan.integrator.map(|integrator| integrator.name().to_owned()),
            bodies: plan.bodies.clone(),
            observe: plan.observe.clone(),
            until: plan.until.clone(),
            series: plan.series.map(u64::from),
            repair: plan.repair,
            shard: shard.map(|shard| shard.to_string()),
        }
    }

    /// Which part of the sweep the file is; `None` for the whole.
    #[must_use]
    pub fn shard(&self) -> Option<Shard> {
        self.shard.as_ref().and_then(|shard| shard.parse().ok())
    }

    /// The worlds that the finished file has: all, or those of its shard.
    #[must_use]
    pub fn range(&self) -> Range<u64> {
        self.shard().map_or(0..self.worlds, |shard| shard.range(self.worlds))
    }

    /// The same as the whole of the sweep.
    #[must_use]
    pub(crate) fn whole(&self) -> Self {
        Self { shard: None, ..self.clone() }
    }

    /// The first thing in which two of them differ, and how.
    pub(crate) fn difference(&self, other: &Self) -> Option<String> {
        let keys = |identity: &Self| match serde_json::to_value(identity) {
            Ok(serde_json::Value::Object(keys)) => keys,
            _ => serde_json::Map::new(),
        };
        let (own, others) = (keys(self), keys(other));
        let shown = |value: Option<&serde_json::Value>| value.map_or("none".to_owned(), ToString::to_string);
        let all = own.keys().chain(others.keys());
        let mut different = all.filter(|key| own.get(*key) != others.get(*key));
        different.next().map(|key| format!("{key}: {} is not {}", shown(own.get(key)), shown(others.get(key))))
    }

    /// Whether a file may say so: another format cannot be read, a shard must be one.
    pub(crate) fn check(&self) -> Result<(), String> {
        if self.format != FORMAT {
            return Err(format!("it is of format {}, and this program knows {FORMAT}", self.format));
        }
        match &self.shard {
            Some(shard) => shard.parse::<Shard>().map(|_| ()).map_err(|error| error.to_string()),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep_plan::SweepPlan;

    /// The pins that the revision stands for.
    const REVISION: u32 = 2;
    const PINS: [&str; 6] = [
        "0x3dfb_2099_2a23_8f88",
        "0x2c7d_8c7c_a8a2_08ea",
        "0x549f_3006_89e2_df1b",
        "0xf348_153e_7d2d_ed93",
        "0x2357_723b_af0d_4bf3",
        "0x0204_387f_d417_4a04",
    ];

    #[test]
    fn another_arithmetic_has_another_revision() {
        let determinism = include_str!("../../../tests/determinism/determinism.rs");
        assert!(
            PINS.iter().all(|pin| determinism.contains(pin)),
            "the pinned hashes changed: raise ARITHMETIC and REVISION by one, and put the new hashes here"
        );
        assert_eq!(ARITHMETIC, REVISION);
    }

    #[test]
    fn builds_of_one_version_differ_by_their_arithmetic() {
        let plan = SweepPlan { scene: "iss".into(), worlds: Some(1), ..SweepPlan::default() };
        let own = SweepIdentity::new(&Sweep::new(plan).unwrap(), None);
        let other = SweepIdentity { arithmetic: ARITHMETIC + 1, ..own.clone() };
        let expected = format!("arithmetic: {ARITHMETIC} is not {}", ARITHMETIC + 1);
        assert_eq!(own.difference(&other), Some(expected));
    }
}
