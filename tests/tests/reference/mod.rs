//! Reading of the reference figures in `tests/data`, and the comparison with them.

#![allow(clippy::unwrap_used, reason = "the files are part of this package")]

use glam::{DMat3, DVec3};
use serde_json::Value;

pub(crate) fn read(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

pub(crate) fn list<'a>(file: &'a Value, key: &str) -> &'a Vec<Value> {
    file[key].as_array().unwrap()
}

/// A number, or a string that holds a decimal with more digits than f64.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| value.as_str().unwrap().parse().unwrap())
}

pub(crate) fn vector(value: &Value) -> DVec3 {
    DVec3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

/// From a list of rows.
pub(crate) fn matrix(value: &Value) -> DMat3 {
    DMat3::from_cols(vector(&value[0]), vector(&value[1]), vector(&value[2])).transpose()
}

/// The largest absolute value of the elements; NaN if there is one.
pub(crate) fn largest(m: DMat3) -> f64 {
    if m.is_nan() { f64::NAN } else { m.to_cols_array().iter().fold(0.0, |largest: f64, x| largest.max(x.abs())) }
}

/// Checks errors against the tolerance stated in a file and keeps the worst.
pub(crate) struct Check {
    name: &'static str,
    pub(crate) tolerance: f64,
    worst: f64,
}

impl Check {
    pub(crate) fn new(name: &'static str, file: &Value) -> Self {
        Self { name, tolerance: number(&file["tolerance"]), worst: 0.0 }
    }

    pub(crate) fn error(&mut self, what: &str, error: f64) {
        assert!(error <= self.tolerance, "{}, {what}: error {error:e} > {:e}", self.name, self.tolerance);
        self.worst = self.worst.max(error);
    }

    /// Prints the worst error, for `cargo test -- --nocapture`.
    pub(crate) fn report(&self) {
        println!("{}: worst error {:.1e}, allowed {:.0e}", self.name, self.worst, self.tolerance);
    }
}
