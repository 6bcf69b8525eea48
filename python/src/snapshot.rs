//! Snapshots.

use std::collections::HashSet;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use tumble::{JointLoad, Trial};

use crate::MODULE;
use crate::error::Failure;

/// The state of a world between two steps: bodies, time and contacts. A simulation of the same
/// scene that restores it goes on with the same bits, under the same forces and targets of drives,
/// which are not in it. Made by `Simulation.snapshot()`; it can be pickled, and kept as
/// `bytes(snapshot)`.
#[cfg_attr(not(feature = "f64"), pyclass(module = "tumble", frozen))]
#[cfg_attr(feature = "f64", pyclass(module = "tumble.double", frozen))]
pub(crate) struct Snapshot(pub(crate) tumble::Snapshot);

impl Snapshot {
    /// Brings a world to this, all of whose bodies have to be in it.
    pub(crate) fn restore(&self, trial: &mut Trial) -> Result<(), Failure> {
        let Trial { simulation, world } = trial;
        let now = tumble::Snapshot::capture(world)?;
        let known: HashSet<_> = self.0.ids().iter().collect();
        if let Some(id) = now.ids().iter().filter(|id| !known.contains(id)).min() {
            return Err(Failure::Foreign(id.0));
        }
        simulation.restore(&self.0, world)?;
        // They are those of the last step, and none was taken from here.
        world.query_mut::<&mut JointLoad>().into_iter().for_each(|load| *load = JointLoad::default());
        Ok(())
    }
}

#[pymethods]
impl Snapshot {
    /// Reads the bytes of a snapshot.
    #[new]
    fn new(data: &[u8]) -> PyResult<Self> {
        Ok(Self(tumble::Snapshot::from_bytes(data).map_err(Failure::from)?))
    }

    fn __bytes__<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.to_bytes())
    }

    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        Ok((this.get_type().into_any(), (this.get().__bytes__(this.py()),)))
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Self>() else { return Ok(false) };
        Ok(self.0.to_bytes() == other.get().0.to_bytes())
    }

    fn __hash__(&self) -> PyResult<isize> {
        Err(PyTypeError::new_err("a Snapshot has no hash; state_hash is that of the bodies"))
    }

    /// Hash of the bodies' state, 16 hexadecimal digits.
    #[getter]
    fn state_hash(&self) -> String {
        format!("{:016x}", self.0.state_hash())
    }

    /// Steps that were done, `None` where the snapshot does not know.
    #[getter]
    fn steps(&self) -> Option<u64> {
        self.0.clock().map(|clock| clock.steps())
    }

    fn __repr__(&self) -> String {
        let steps = self.steps().map_or(String::new(), |steps| format!(" after {steps} steps"));
        format!("<{MODULE}.Snapshot of {}{steps}, state_hash {}>", crate::bodies(self.0.len()), self.state_hash())
    }
}
