//! Which of the two builds this is, and how far off it may be.

#![allow(dead_code, reason = "each test uses a part of it")]

pub(crate) const SINGLE: bool = size_of::<tumble::math::Real>() == 4;

/// The first in single precision, the second in double.
pub(crate) fn by_precision(single: f64, double: f64) -> f64 {
    if SINGLE { single } else { double }
}
