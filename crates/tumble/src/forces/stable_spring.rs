//! Stiff springs at steps that are long for them.

use tumble_math::lane::Lane;

/// The angle `w h` past which an oscillation of frequency `w` is slowed down to it \[rad\]: 0.45
/// periods a step. At half a period the method is stable no more.
pub(crate) const MAX_ANGLE: f64 = 0.9 * std::f64::consts::PI;

/// The same for a spring in a net, a third of a period: springs that are not in line are not
/// linear, and need room.
pub(crate) const MAX_ANGLE_IN_A_NET: f64 = std::f64::consts::TAU / 3.0;

/// `(2/x)^2 sin^2(x/2)` as a series in `-x^2`: `2/(2n + 2)!`. The first term left out is 3e-16 at
/// the largest angle.
const SINC_SQUARED: [f64; 12] = {
    let mut terms = [1.0; 12];
    let mut n = 1;
    while n < 12 {
        terms[n] = terms[n - 1] / ((2 * n + 1) * (2 * n + 2)) as f64;
        n += 1;
    }
    terms
};

/// The stiffness for which kicks and drifts of a substep `h` give the frequency that `stiffness`
/// and `inverse_mass` have in truth, up to an angle of `most_angle` a substep.
#[inline(always)]
pub(crate) fn stable_stiffness<L: Lane>(stiffness: L, inverse_mass: L, h: L, most_angle: L) -> L {
    stiffness_up_to(stiffness, inverse_mass, h, most_angle * most_angle)
}

/// The same for the square of the largest angle.
#[inline(always)]
pub(crate) fn stiffness_up_to<L: Lane>(stiffness: L, inverse_mass: L, h: L, most: L) -> L {
    let angle_squared = stiffness * inverse_mass * h * h;
    let z = angle_squared.min(most);
    let mut series = L::splat(SINC_SQUARED[11]);
    let mut n = 11;
    while n > 0 {
        n -= 1;
        series = L::splat(SINC_SQUARED[n]) - z * series;
    }
    // Past the largest angle the frequency is that of the angle: stiffness in inverse proportion.
    let too_stiff = most.lt(angle_squared);
    L::select(too_stiff, series * most / (inverse_mass * h * h), stiffness * series)
}

/// The damping with which one kick of the duration `t` takes away no more than the velocity there
/// is: the one given, where that does.
#[inline(always)]
pub(crate) fn stable_damping<L: Lane>(damping: L, inverse_mass: L, t: L) -> L {
    damping.min(L::splat(1.0) / (inverse_mass * t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_sine() {
        for i in 1..=900 {
            let angle = f64::from(i) * 1e-3 * std::f64::consts::PI;
            let stiffness = angle * angle;
            let exact = 4.0 * (angle / 2.0).sin().powi(2);
            let error = (stable_stiffness(stiffness, 1.0, 1.0, MAX_ANGLE) - exact).abs();
            // A dozen roundings of terms that are up to eight.
            assert!(error <= 1e-14, "{angle}: {error:e}");
        }
    }

    #[test]
    fn no_stiffness_is_too_much() {
        for stiffness in [10.0, 1e3, 1e9, 1e300, f64::INFINITY] {
            let stable = stable_stiffness(stiffness, 0.5, 0.1, MAX_ANGLE);
            assert!(stable * 0.5 * 0.01 < 4.0, "{stiffness:e}: {stable:e}");
        }
        assert_eq!(stable_stiffness(0.0_f32, 2.0, 0.1, 2.0), 0.0);
    }
}
