//! Decides whether vector code is compiled: `cfg(vector_code)`, on x86-64, but not without
//! optimisation.
//!
//! A kernel is one function into which everything is inlined. Unoptimised, each of its thousands of
//! intermediate vectors gets memory of its own on the stack, megabytes of it, and a game's debug
//! build would overflow a thread's stack. One body at a time gives the same bits.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(vector_code)");
    let is = |variable: &str, value: &str| env::var(variable).is_ok_and(|found| found == value);
    if is("CARGO_CFG_TARGET_ARCH", "x86_64") && !is("OPT_LEVEL", "0") {
        println!("cargo::rustc-cfg=vector_code");
    }
}
