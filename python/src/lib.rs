//! Python bindings of tumble. This source is compiled twice: in single precision it is the module
//! `tumble._single`, with the feature `f64` `tumble._double`.
#![cfg_attr(
    feature = "f64",
    allow(
        clippy::useless_conversion,
        reason = "Real is f64 in this build; the same line converts from f32 in the other"
    )
)]

mod actions;
mod arrays;
mod batch;
mod body_arrays;
mod error;
mod joints;
mod maker;
mod recording;
mod scene;
mod selection;
mod settings;
mod simulation;
mod snapshot;
mod state;
mod sweep;
mod threads;
mod worlds;

use pyo3::prelude::*;

/// Where the classes are found in Python.
pub(crate) const MODULE: &str = if cfg!(feature = "f64") { "tumble.double" } else { "tumble" };

/// A number of bodies in words.
pub(crate) fn bodies(count: usize) -> String {
    format!("{count} {}", if count == 1 { "body" } else { "bodies" })
}

fn fill(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<scene::Scene>()?;
    module.add_class::<simulation::Simulation>()?;
    module.add_class::<batch::Batch>()?;
    module.add_class::<recording::Recording>()?;
    module.add_class::<snapshot::Snapshot>()?;
    module.add_class::<sweep::SweepCore>()?;
    module.add_class::<sweep::SweepWriter>()?;
    module.add_function(wrap_pyfunction!(scene::scenes, module)?)?;
    module.add_function(wrap_pyfunction!(threads::threads, module)?)?;
    module.add_function(wrap_pyfunction!(threads::set_threads, module)?)?;
    module.add("PRECISION", tumble::math::PRECISION)?;
    module.add("SIMD", tumble::simd_name())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}

#[cfg(not(feature = "f64"))]
#[pymodule]
fn _single(module: &Bound<'_, PyModule>) -> PyResult<()> {
    fill(module)
}

#[cfg(feature = "f64")]
#[pymodule]
fn _double(module: &Bound<'_, PyModule>) -> PyResult<()> {
    fill(module)
}
