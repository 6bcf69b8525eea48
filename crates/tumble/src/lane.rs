//! Numbers of many bodies side by side, and vectors and quaternions of them: what a
//! [`SimdForceLaw`](crate::SimdForceLaw) computes with.

pub use tumble_math::lane::{Lane, Quat, Vec3};
