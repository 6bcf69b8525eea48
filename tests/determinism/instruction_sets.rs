//! Promise: the pinned bits are those of every instruction set, and with each of them bodies have
//! the bits that they have beside other neighbours and in other archetypes.
//!
//! Why: peers of a game have other processors. It fails if a kernel of one set rounds otherwise.

use std::process::Command;

use tumble::simd_name;

/// How many tests are about bits that no instruction set may change.
const TESTS: u32 = 9;

/// Runs those whose names begin with `the_bits_` in a process for each instruction set, since a
/// process chooses once; one of them prints which. What a machine lacks, falls back to what it has.
#[test]
fn every_instruction_set_gives_the_same_bits() {
    for name in ["scalar", "baseline", "avx2", "avx512"] {
        let output = Command::new(std::env::current_exe().unwrap())
            .args(["the_bits_", "--nocapture", "--test-threads=1"])
            .env("TUMBLE_SIMD", name)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && said.contains(&format!("{TESTS} passed")), "{name}: {said}");
        let ran_on = said.lines().find_map(|line| line.strip_prefix("ran on ")).unwrap();
        assert!(ran_on == name || !is_there(name), "{name} was asked for, {ran_on} ran");
    }
}

/// Whether this build on this machine has an instruction set.
fn is_there(name: &str) -> bool {
    // An unoptimised build, or one for another processor, has no vector code.
    if name == "scalar" || simd_name() == "scalar" {
        return name == "scalar";
    }
    #[cfg(target_arch = "x86_64")]
    match name {
        "avx512" => return is_x86_feature_detected!("avx512f"),
        "avx2" => return is_x86_feature_detected!("avx2"),
        _ => {}
    }
    true
}
