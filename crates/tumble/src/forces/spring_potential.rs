//! The potential with which a spring acts in kicks of fixed length: Hooke's where the step resolves
//! it, and a softer one where not.
//!
//! A kick is one of a symplectic method as long as its force is the gradient of a function of
//! poses, and energy keeps within bounds as long as no kick turns or moves a body by more than that
//! function is smooth over. A spring that is attached at `r` from the centre of mass of a body, and
//! pulls with `F`, turns it as a pendulum of frequency `w^2 = F r/I`: however soft the spring is, a
//! long pull makes that as fast as it likes, and kicks that are longer than its swing add energy at
//! random. So three things are limited, the first two by functions of poses alone:
//!
//! - the stiffness, so that the frequencies of moving and of turning stay below an angle each
//!   ([`stiffness_up_to`]),
//! - the arm `r`, which is drawn in where the length of the spring would make the pendulum faster
//!   ([`Arm`]),
//! - what is left unresolved is damped, where the pendulum turns by more than 0.55 radians a
//!   substep.

use tumble_math::lane::{Lane, Vec3};

use crate::forces::stable_spring::stiffness_up_to;

/// The square of the angle in a substep up to which turning by a spring at its given arm is
/// resolved.
const MAX_TURNING: f64 = 1.0;

/// The square of the angle in a substep up to which the arm stays as it is.
const RESOLVED: f64 = 0.5;

/// The same up to which nothing is damped.
const UNDAMPED: f64 = 0.3;

/// The most of the velocity along a spring that a kick takes away for the sake of what the step
/// does not resolve.
const MAX_DAMPED: f64 = 0.25;

/// One end of a spring.
#[derive(Clone, Copy)]
pub(crate) struct End<L> {
    /// From the centre of mass to the attachment \[m\], world frame.
    pub(crate) arm: Vec3<L>,
    /// Translation and, at its most, rotation in the inverse effective mass of the spring [1/kg].
    pub(crate) inverse_masses: [L; 2],
}

/// The force of a spring at one moment: on its first end, and the opposite on its second.
#[derive(Clone, Copy)]
pub(crate) struct Pull<L> {
    /// From one end to the other, of unit length.
    pub(crate) direction: Vec3<L>,
    /// From the centres of mass to where it pulls \[m\].
    pub(crate) arms: [Vec3<L>; 2],
    /// Along the direction \[N\].
    pub(crate) tension: L,
    /// The force \[N\] on the first end by which arms are drawn in.
    pub(crate) drawing: Vec3<L>,
    /// The torques [N m] of that on the first and, already the other way, on the second body.
    pub(crate) drawing_torques: [Vec3<L>; 2],
    /// Impulse over the speed of elongation, in a kick of any length \[kg\].
    pub(crate) damping: L,
}

/// A spring's stiffness and rest length, and the substep.
#[derive(Clone, Copy)]
pub(crate) struct Hooke<L> {
    /// [N/m]
    pub(crate) stiffness: L,
    /// \[m\]
    pub(crate) rest_length: L,
    /// \[s\]
    pub(crate) h: L,
}

/// An arm as it is drawn in: `share` of its length, with the gradient of the share \[1/m\] by the
/// far end.
struct Arm<L> {
    share: L,
    gradient: Vec3<L>,
    /// The square of the angle by which the body swings under the longest pull in a substep.
    angle_squared: L,
}

/// The force of a spring whose bodies' centres of mass are `difference` apart; `most_angle` is that
/// of moving in a substep \[rad\].
#[inline(always)]
pub(crate) fn pull<L: Lane>(spring: Hooke<L>, difference: Vec3<L>, ends: [End<L>; 2], most_angle: L) -> Pull<L> {
    let (zero, one, h) = (L::splat(0.0), L::splat(1.0), spring.h);
    let [a, b] = &ends;
    let moving = a.inverse_masses[0] + b.inverse_masses[0];
    let turning = a.inverse_masses[1] + b.inverse_masses[1];
    let inverse_mass = moving + turning;
    let most_squared = most_angle * most_angle;
    let most = inverse_mass / (moving / most_squared + turning * L::splat(1.0 / MAX_TURNING));
    // Between two bodies that nothing moves.
    let most = L::select(zero.lt(inverse_mass), most, most_squared);
    let hooke = Hooke { stiffness: stiffness_up_to(spring.stiffness, inverse_mass, h, most), ..spring };
    let near = Arm::drawn(&hooke, a, difference + b.arm);
    let far = Arm::drawn(&hooke, b, a.arm - difference);
    let arms = [a.arm * near.share, b.arm * far.share];
    let between = difference + (arms[1] - arms[0]);
    let length = between.dot(between).sqrt();
    let direction = between * L::select(zero.lt(length), one / length, zero);
    let angle_squared = hooke.stiffness * inverse_mass * h * h;
    let tension = hooke.stiffness * (length - hooke.rest_length);
    // The potential depends on the arms' shares, and through each on the place of the other end.
    let by_near = near.gradient * (direction.dot(a.arm) * tension * L::splat(-1.0));
    let by_far = far.gradient * (direction.dot(b.arm) * tension * L::splat(-1.0));
    // Kick and drift are stable with it as long as it stays below (4 - z)/2.
    let swing = near.angle_squared.max(far.angle_squared).max(L::splat(UNDAMPED));
    let damped = L::splat(MAX_DAMPED) * (one - L::splat(UNDAMPED) / swing);
    let damped = damped.min(L::splat(0.4) * (L::splat(4.0) - angle_squared));
    Pull {
        direction,
        arms,
        tension,
        drawing: by_near + by_far,
        drawing_torques: [a.arm.cross(by_far), by_near.cross(b.arm)],
        damping: L::select(zero.lt(inverse_mass), damped / inverse_mass, zero),
    }
}

impl<L: Lane> Arm<L> {
    /// For an end from whose body's centre of mass the far end is `away`. The share is one where
    /// the longest pull turns the body by what is resolved, or by what a pull of the arm's own
    /// length does; at `x` times that it is `(2 x - 1)/x^2`, which leaves one smoothly and falls as
    /// `2/x`.
    #[inline(always)]
    fn drawn(spring: &Hooke<L>, end: &End<L>, away: Vec3<L>) -> Self {
        let (zero, one, two) = (L::splat(0.0), L::splat(1.0), L::splat(2.0));
        let (length, distance) = (end.arm.dot(end.arm).sqrt(), away.dot(away).sqrt());
        let per_metre = spring.stiffness * spring.h * spring.h * end.inverse_masses[1] / length;
        let per_metre = L::select(zero.lt(length), per_metre, zero);
        let off = distance - spring.rest_length;
        let stretch = off.max(zero - off);
        let angle_squared = per_metre * stretch.max(length);
        let unit = L::splat(RESOLVED).max(per_metre * length);
        let x = (angle_squared / unit).max(one);
        let share = (two * x - one) / (x * x);
        let slope = two * (one - x) / (x * x * x) * (per_metre / unit) / distance;
        let slope = L::select(off.lt(zero), zero - slope, slope);
        // At no distance there is no direction.
        let slope = L::select(zero.lt(distance), slope, zero);
        Self { share, gradient: away * slope, angle_squared: angle_squared * share }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The potential of which the pull is the gradient, by the same limits.
    fn potential(k: f64, l0: f64, difference: Vec3<f64>, ends: [End<f64>; 2]) -> f64 {
        let h = 1.0 / 64.0;
        let weight: f64 = ends.iter().map(|end| end.inverse_masses[0] + end.inverse_masses[1]).sum();
        let turning: f64 = ends.iter().map(|end| end.inverse_masses[1]).sum();
        let most = weight / ((weight - turning) / 4.0 + turning);
        let stiffness = stiffness_up_to(k, weight, h, most);
        let hooke = Hooke { stiffness, rest_length: l0, h };
        let near = Arm::drawn(&hooke, &ends[0], difference + ends[1].arm);
        let far = Arm::drawn(&hooke, &ends[1], ends[0].arm - difference);
        let between = difference + (ends[1].arm * far.share - ends[0].arm * near.share);
        0.5 * stiffness * (between.dot(between).sqrt() - l0).powi(2)
    }

    /// Forces and torques are the slopes of one potential, for shifts and turns of either end: from
    /// pressed to far out, and attached anywhere.
    #[test]
    fn the_pull_is_the_gradient_of_a_potential() {
        let mut regimes = [0; 3];
        for case in 0..400_u32 {
            let mut seed = u64::from(case + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let mut number = || {
                seed ^= seed << 13;
                seed ^= seed >> 7;
                seed ^= seed << 17;
                (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
            };
            let mut vector = |scale: f64| Vec3::new(number() * scale, number() * scale, number() * scale);
            let [difference, arm_a, arm_b, scales] = [vector(3.0), vector(0.5), vector(0.5), vector(1.0)];
            let l0 = if case % 2 == 0 { 0.0 } else { scales.x.abs() * 4.0 };
            let k = 10.0_f64.powf(2.0 + 2.0 * scales.y);
            let weights = [[0.3, 1.0 + scales.z], [0.2, 1.0 - scales.z]];
            let end = |arm, i: usize| End { arm, inverse_masses: weights[i] };
            let at = |difference, turned: [Vec3<f64>; 2]| {
                potential(
                    k,
                    l0,
                    difference,
                    [end(arm_a + turned[0].cross(arm_a), 0), end(arm_b + turned[1].cross(arm_b), 1)],
                )
            };
            let hooke = Hooke { stiffness: k, rest_length: l0, h: 1.0 / 64.0 };
            let found = pull(hooke, difference, [end(arm_a, 0), end(arm_b, 1)], 2.0);
            let along = found.direction * found.tension;
            let force = along + found.drawing;
            let torques = [
                found.arms[0].cross(along) + found.drawing_torques[0],
                found.arms[1].cross(along) * -1.0 + found.drawing_torques[1],
            ];
            let scale = found.tension.abs() + force.dot(force).sqrt() + 1e-3;
            let step = 1e-6;
            for axis in [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)] {
                let none = [Vec3::zero(); 2];
                let slope = |plus: f64, minus: f64| (plus - minus) / (2.0 * step);
                // The first body pulled along is the centres brought nearer.
                let by_shift = slope(at(difference + axis * step, none), at(difference - axis * step, none));
                let shifted = (by_shift - force.dot(axis)).abs();
                let mut worst = shifted;
                for (body, torque) in torques.iter().enumerate() {
                    let turned = |by: f64| {
                        let mut turns = none;
                        turns[body] = axis * by;
                        at(difference, turns)
                    };
                    worst = worst.max((slope(turned(step), turned(-step)) + torque.dot(axis)).abs());
                }
                // The second difference over a step of 1e-6, and roundings of an energy of some
                // tens of forces over it.
                assert!(worst <= 1e-4 * scale, "case {case}: off by {worst:e} of {scale:e}");
            }
            let total = difference.cross(force * -1.0) + torques[0] + torques[1];
            assert!(total.dot(total).sqrt() <= 1e-12 * scale * 10.0, "case {case}: angular momentum {total:?}");
            regimes[0] += u32::from(found.arms[0].dot(found.arms[0]) < 0.99 * arm_a.dot(arm_a));
            regimes[1] += u32::from(found.damping > 0.0);
            regimes[2] += u32::from(found.tension < 0.0);
        }
        assert!(regimes.iter().all(|count| *count > 10), "{regimes:?} of drawn, damped, pressed");
    }

    /// At lengths and stiffnesses that the step resolves it is Hooke's law to the last bit, but for
    /// the filter of its frequency.
    #[test]
    fn what_is_resolved_is_hookes_law() {
        let ends = [0.2, -0.1].map(|x| End { arm: Vec3::new(x, 0.1, 0.0), inverse_masses: [1.0, 0.5] });
        let (difference, h) = (Vec3::new(1.0, 0.5, 0.0), 1e-4);
        let found = pull(Hooke { stiffness: 100.0, rest_length: 0.3, h }, difference, ends, 2.0);
        let between = difference + (ends[1].arm - ends[0].arm);
        let length = between.dot(between).sqrt();
        assert_eq!(found.damping, 0.0);
        // The filter takes z/12.
        assert!((found.tension / (100.0 * (length - 0.3)) - 1.0_f64).abs() < 1e-6);
        assert_eq!(found.drawing, Vec3::zero());
        assert_eq!(found.arms, ends.map(|end| end.arm));
    }
}
