//! Fuzz target: reading of stl files, which must neither panic nor take long.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tumble_fuzz::open(bytes, "stl"));
