//! Same bits: pinned, and compared over threads, instruction sets and orders.

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
#[path = "../tests/shared/mechanisms/mod.rs"]
mod mechanisms;
#[path = "../tests/shared/pile/mod.rs"]
mod pile;
