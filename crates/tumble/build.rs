//! Decides whether vector code is compiled: `cfg(vector_code)`, where there is some for the target,
//! and `cfg(avx_code)`, that of x86-64 besides; but none without optimisation. In browsers there is
//! `cfg(vectors_alone)`: no environment asks for other code there, and less of it loads sooner.
//!
//! A kernel is one function into which everything is inlined. Unoptimised, each of its thousands of
//! intermediate vectors gets memory of its own on the stack, megabytes of it, and a game's debug
//! build would overflow a thread's stack. One body at a time gives the same bits.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(vector_code)");
    println!("cargo::rustc-check-cfg=cfg(avx_code)");
    println!("cargo::rustc-check-cfg=cfg(vectors_alone)");
    let of = |variable: &str| env::var(variable).unwrap_or_default();
    let features = of("CARGO_CFG_TARGET_FEATURE");
    let has = |wanted: &str| features.split(',').any(|feature| feature == wanted);
    let architecture = of("CARGO_CFG_TARGET_ARCH");
    let has_vectors = match architecture.as_str() {
        "x86_64" => true,
        "aarch64" => has("neon") && of("CARGO_CFG_TARGET_ENDIAN") == "little",
        "wasm32" => has("simd128"),
        _ => false,
    };
    if has_vectors && of("OPT_LEVEL") != "0" {
        println!("cargo::rustc-cfg=vector_code");
        if architecture == "x86_64" {
            println!("cargo::rustc-cfg=avx_code");
        }
        if architecture == "wasm32" && of("CARGO_CFG_TARGET_OS") == "unknown" {
            println!("cargo::rustc-cfg=vectors_alone");
        }
    }
}
