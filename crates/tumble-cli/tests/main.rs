//! The program, run as a user runs it.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helper functions too")]

mod arbitrary_files;
mod bad_input;
mod inspect;
mod inspect_files;
mod outputs;
mod program;
mod report;
mod run;
mod support;
mod sweep;
mod sweep_observations;
mod sweep_series;
mod terminal;
