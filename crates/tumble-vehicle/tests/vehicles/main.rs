//! Vehicles against closed forms and bounds of physics, on random vehicles.
//!
//! Each file is one promise of `docs/vehicles.md`.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what is not as the test needs it is a failed test")]
#![cfg_attr(
    feature = "f64",
    allow(
        clippy::unnecessary_cast,
        clippy::useless_conversion,
        reason = "Real is f64 in this build; the same line converts from f32 in the other"
    )
)]

mod at_rest;
mod bounds;
mod course;
mod exchange;
mod jointed;
mod light_bodies;
mod same_bits;
mod settings;
mod statics;
mod straight;
mod terrain;
mod tumbling;
mod turning;
