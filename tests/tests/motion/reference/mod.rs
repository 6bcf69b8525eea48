//! Reading of the reference figures in `tests/data`, and the comparison with them.

use glam::{DMat3, DVec3};
use serde_json::Value;
use tumble_tests::references::{number, vector};

pub(crate) fn list<'a>(file: &'a Value, key: &str) -> &'a Vec<Value> {
    file[key].as_array().unwrap()
}

/// From a list of rows.
pub(crate) fn matrix(value: &Value) -> DMat3 {
    DMat3::from_cols(vector(&value[0]), vector(&value[1]), vector(&value[2])).transpose()
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

    pub(crate) fn vector(&mut self, what: &str, actual: DVec3, expected: DVec3) {
        self.error(what, (actual - expected).abs().max_element());
    }

    /// Prints the worst error, for `cargo test -- --nocapture`.
    pub(crate) fn report(&self) {
        println!("{}: worst error {:.1e}, allowed {:.0e}", self.name, self.worst, self.tolerance);
    }
}
