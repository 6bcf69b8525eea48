//! Same bits: pinned, and compared over threads, instruction sets and orders.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]
#![allow(
    clippy::unnecessary_cast,
    clippy::useless_conversion,
    reason = "Real is f32 in one build and f64 in the other"
)]

mod changing_archetypes;
mod contact_determinism;
#[path = "../tests/shared/coupled/mod.rs"]
mod coupled;
mod coupled_determinism;
mod determinism;
mod file_determinism;
mod helper_determinism;
mod instruction_sets;
mod joint_determinism;
mod ledger_determinism;
#[path = "../tests/shared/mechanisms/mod.rs"]
mod mechanisms;
#[path = "../tests/shared/pile/mod.rs"]
mod pile;
mod plain_bodies;
