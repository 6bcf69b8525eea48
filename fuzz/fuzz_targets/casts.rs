//! Fuzz target: rays, points and casts of shapes of any size, against brute force.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tumble_fuzz::casts::ask(bytes));
