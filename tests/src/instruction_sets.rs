//! The same tests on every instruction set.

use std::process::Command;

use tumble::simd_name;

/// Runs the tests of the calling program whose names begin with `the_bits_` once for each
/// instruction set, in a process of its own each, since a process chooses once. `passed` of them
/// are to pass, and one is to print `ran on NAME`, by [`simd_name`]. On a machine without one of
/// the sets the choice falls back to what it has.
pub fn run_on_every_instruction_set(passed: u32) {
    for name in ["scalar", "baseline", "avx2", "avx512"] {
        let output = Command::new(std::env::current_exe().expect("a test is a program"))
            .args(["the_bits_", "--nocapture", "--test-threads=1"])
            .env("TUMBLE_SIMD", name)
            .output()
            .expect("a program can run itself");
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && said.contains(&format!("{passed} passed")), "{name}: {said}");
        let ran_on = said.lines().find_map(|line| line.strip_prefix("ran on ")).expect("a test says what it ran on");
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
