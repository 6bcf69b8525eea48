//! Numbers, vectors and quaternions from the JSON reference data.

use glam::{DQuat, DVec3};
use serde_json::Value;
use tumble::math::{Quat, Real, Vec3};

/// A file of `data`.
#[allow(clippy::expect_used, reason = "the files are part of this package")]
pub fn parse(text: &str) -> Value {
    serde_json::from_str(text).expect("a JSON file")
}

/// A number, or a string that holds a decimal with more digits than f64.
#[allow(clippy::expect_used, reason = "the files are part of this package")]
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| value.as_str().and_then(|text| text.parse().ok()).expect("a number"))
}

/// Three numbers.
pub fn vector(value: &Value) -> DVec3 {
    DVec3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

/// Four numbers in the order w, x, y, z.
pub fn quaternion(value: &Value) -> DQuat {
    DQuat::from_xyzw(number(&value[1]), number(&value[2]), number(&value[3]), number(&value[0]))
}

/// Rounded to the precision of the build.
#[cfg_attr(feature = "f64", allow(clippy::unnecessary_cast, reason = "the cast is one in the other precision"))]
pub fn real_vec3(v: DVec3) -> Vec3 {
    Vec3::new(v.x as Real, v.y as Real, v.z as Real)
}

/// Rounded to the precision of the build.
#[cfg_attr(feature = "f64", allow(clippy::unnecessary_cast, reason = "the cast is one in the other precision"))]
pub fn real_quat(q: DQuat) -> Quat {
    Quat::from_xyzw(q.x as Real, q.y as Real, q.z as Real, q.w as Real)
}

/// In double precision, as it is: not normalised.
#[cfg_attr(feature = "f64", allow(clippy::unnecessary_cast, reason = "the cast is one in the other precision"))]
pub fn double_quat(q: Quat) -> DQuat {
    DQuat::from_xyzw(q.x as f64, q.y as f64, q.z as f64, q.w as f64)
}
