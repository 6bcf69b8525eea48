//! Numbers of many bodies side by side, and vectors and quaternions of them: what a [`LaneLaw`](crate::LaneLaw) computes with.

pub use tumble_math::lane::{Lane, Quat, Vec3};
