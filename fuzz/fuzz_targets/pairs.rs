//! Fuzz target: pairs of shapes of any size, by the work that they take.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tumble_fuzz::pairs::meet(bytes));
