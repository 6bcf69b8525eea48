//! Exponential decay, exact over a step of any length.
//!
//! A quantity that is damped at the rate `c` [1/s] and driven by a constant `f`, `dp/dt = f - c p`,
//! is after a time `h`
//!
//! ```text
//! p(h) = e^(-c h) p(0) + h phi(c h) f,    phi(x) = (1 - e^(-x)) / x
//! ```
//!
//! so a step that multiplies by the first factor and weighs the force with the second one makes no
//! error, at any `h`.

use crate::lane::Lane;

/// `e^(-x)` and `phi(x) = (1 - e^(-x))/x`, the factors by which a state and a constant rate enter
/// after a decay of `x >= 0`.
///
/// ```
/// // Three half-lives.
/// let decay = tumble_math::decay(3.0 * std::f64::consts::LN_2);
/// assert!((decay.kept - 0.125).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay<L> {
    /// `e^(-x)`, in `[0, 1]`.
    pub kept: L,
    /// `(1 - e^(-x))/x`, in `[0, 1]`.
    pub mean: L,
}

/// Past this the state has shrunk by 34 orders of magnitude, and `e^(-x)` is still a normal number
/// in single precision.
const LONGEST: f64 = 80.0;
const LOG2_E: f64 = std::f64::consts::LOG2_E;
/// ln 2 in two parts; the first has few enough bits for its product with a whole number up to 115
/// to be exact in single precision.
const LN_2_HIGH: f64 = 0.693_145_751_953_125;
const LN_2_LOW: f64 = 1.428_606_820_309_417_2e-6;
/// Terms of `e^r - 1` for `|r| <= ln(2)/2`: the first one left out is `r^14/14! < 4e-18`, below
/// rounding in double precision.
const TERMS: i32 = 13;

/// The factors of an exponential decay over `x = rate * time`. Zero, negative and NaN `x` decay
/// nothing: `(1, 1)`.
///
/// Both are within three units in the last place, from correctly rounded operations only, so they
/// have the same bits everywhere.
///
/// ```
/// let half_life = tumble_math::decay(std::f64::consts::LN_2);
/// assert!((half_life.kept - 0.5).abs() < 1e-15);
/// ```
#[inline(always)]
pub fn decay<L: Lane>(x: L) -> Decay<L> {
    let one = L::splat(1.0);
    let zero = L::splat(0.0);
    // `max` gives its argument where `x` is NaN, so whatever arrives is in range from here on.
    let whole = x.max(zero);
    let x = whole.min(L::splat(LONGEST));
    // x = n ln 2 + r with |r| <= ln(2)/2: adding and taking away 1.5 * 2^mantissa rounds to the
    // nearest whole number.
    let rounder = L::splat(0.75 / L::ROUNDING);
    let n = (x * L::splat(LOG2_E) + rounder) - rounder;
    let r = (x - n * L::splat(LN_2_HIGH)) - n * L::splat(LN_2_LOW);
    // 1 - e^(-r) = r (1 - r/2 (1 - r/3 (1 - ...)))
    let mut series = one;
    let mut term = TERMS;
    while term > 1 {
        series = one - r * series * L::splat(1.0 / f64::from(term));
        term -= 1;
    }
    let lost_in_r = r * series;
    let scale = (-n).exp2_of_integer();
    let lost = (one - scale) + scale * lost_in_r;
    let tiny = whole.lt(L::splat(L::ROUNDING));
    Decay { kept: (one - lost_in_r) * scale, mean: L::select(tiny, one, lost / L::select(tiny, one, whole)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn double_precision_agrees_with_libm() {
        for i in 0..=80_000 {
            let x = f64::from(i) * 1e-3;
            let d = decay(x);
            let exact = libm::exp(-x);
            assert!((d.kept - exact).abs() <= 3.0 * f64::EPSILON * exact, "e^-{x}: {} not {exact}", d.kept);
            let mean = if i == 0 { 1.0 } else { -libm::expm1(-x) / x };
            assert!((d.mean - mean).abs() <= 3.0 * f64::EPSILON * mean, "phi({x}): {} not {mean}", d.mean);
        }
    }

    #[test]
    fn single_precision_agrees_with_libm() {
        for i in 0..=80_000_u32 {
            let x = i as f32 * 1e-3;
            let d = decay(x);
            let exact = libm::exp(-f64::from(x));
            assert!((f64::from(d.kept) - exact).abs() <= 3.0 * f64::from(f32::EPSILON) * exact, "e^-{x}");
            let mean = if i == 0 { 1.0 } else { -libm::expm1(-f64::from(x)) / f64::from(x) };
            assert!((f64::from(d.mean) - mean).abs() <= 3.0 * f64::from(f32::EPSILON) * mean, "phi({x})");
        }
    }

    #[test]
    fn small_arguments_keep_their_digits() {
        for x in [1e-300, 1e-20, 1e-9, 1e-5] {
            let mean = decay(x).mean;
            assert!((mean - (1.0 - 0.5 * x)).abs() <= f64::EPSILON + x * x, "phi({x}) = {mean}");
        }
    }

    #[test]
    fn what_is_no_decay_keeps_everything() {
        for x in [0.0, -1.0, f64::NAN, f64::NEG_INFINITY] {
            assert_eq!(decay(x), Decay { kept: 1.0, mean: 1.0 });
        }
        assert!(decay(f64::INFINITY).kept < 1e-34);
        assert_eq!(decay(f64::INFINITY).mean, 0.0);
    }

    #[test]
    fn past_the_longest_decay_the_mean_goes_on_falling() {
        for x in [80.0, 81.0, 1e3, 1e30] {
            let mean = decay(x).mean;
            assert!((mean * x - 1.0).abs() <= 2.0 * f64::EPSILON, "phi({x}) = {mean}");
        }
    }
}
