//! The commands of sweeps, which `tumble-sweep` runs.

pub(crate) mod command;
pub(crate) mod merge;
pub(crate) mod options;
pub(crate) mod plot;
