//! The equation of the map in `a`, solved without a division: for single precision.

use super::Ratios;
use super::solver::Solver;
use crate::lane::{Lane, Vec3};

/// What of the equation does not depend on the state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sweeps<L> {
    /// `1/I_j`, in units of the inverse of half the moments' sum.
    inverses: Vec3<L>,
    /// `T_j`.
    seconds: Vec3<L>,
    t2: L,
    t3: L,
    /// `2/e`.
    twice_inverse_e: L,
    /// Whether squares of what is negligible are left out; see [`FreeRotation::for_resting`].
    ///
    /// [`FreeRotation::for_resting`]: super::FreeRotation::for_resting
    skips_negligible: bool,
}

/// A kappa and a `|u|^2` below this are lost beside one in any sum here.
const NEGLIGIBLE: f64 = 1e-15;

/// How many sweeps follow the first three where a step is not short.
const FURTHER_SWEEPS: u32 = 5;

impl<L: Lane> Sweeps<L> {
    #[inline(always)]
    pub(super) fn new(ratios: &Ratios<L>) -> Self {
        let Ratios { inverses, seconds, .. } = *ratios;
        let (i, t) = (inverses, seconds);
        let t12 = t.x * t.y;
        Self {
            inverses,
            seconds,
            t2: t12 + (t.x + t.y) * t.z,
            t3: t12 * t.z,
            twice_inverse_e: (i.x * i.y) * (i.z + i.z),
            skips_negligible: false,
        }
    }

    #[inline(always)]
    pub(super) fn for_resting(self) -> Self {
        Self { skips_negligible: true, ..self }
    }

    /// Zero where `size` is negligible, if that is to be left out.
    #[inline(always)]
    fn significant(&self, number: L, size: L) -> L {
        if self.skips_negligible { L::select(size.lt(L::splat(NEGLIGIBLE)), L::splat(0.0), number) } else { number }
    }

    /// `|v|^2` as the polynomials take it.
    #[inline(always)]
    fn square(&self, v: Vec3<L>) -> L {
        let n = v.dot(v);
        self.significant(n, n)
    }

    /// `D_j = 1/J_j = alpha/I_j + delta`, for the sixth order.
    #[inline(always)]
    fn modified(&self, (x, y): (L, L), kappa: L) -> Vec3<L> {
        let (x, y) = (self.significant(x, kappa), self.significant(y, kappa));
        let (one, third, thirtieth) = (L::splat(1.0), L::splat(1.0 / 3.0), L::splat(1.0 / 30.0));
        let (three, four) = (L::splat(3.0), L::splat(4.0));
        let (p, t3_x, four_y, yy) = (self.t2 * x, self.t3 * x, four * y, y * y);
        // alpha + delta has fewer terms than alpha.
        let sum4 = (p * p + t3_x * four_y) - three * (self.t2 * yy);
        let delta4 = three * (t3_x * x) - (p * four_y + yy);
        let delta = y * third + delta4 * thirtieth;
        let alpha = ((one - p * third) + sum4 * thirtieth) - delta;
        self.inverses * alpha + Vec3::splat(delta)
    }

    /// `a` after three sweeps and `1 + |u|^2` of the second.
    #[inline(always)]
    fn begin(&self, d: Vec3<L>, c: Vec3<L>, kappa: L, b: Vec3<L>) -> (Vec3<L>, L) {
        // The first has J = I and |u|^2 = kappa, so that it waits for neither.
        let first = sweep(b, b, differences(self.inverses) * (L::splat(1.0) + kappa));
        let c = c * short_stretch(self.square(d.scale(first)));
        let second = sweep(first, b, c);
        (sweep(second, b, c), short_stretch(self.square(d.scale(second))))
    }
}

impl<L: Lane> Solver<L> for Sweeps<L> {
    /// Such a step has `|u|^2` under 0.0087, which the polynomials are for.
    const LARGEST_SHORT_KAPPA: f64 = 0.0057;

    /// `(h^2 H/e, h^2 D/e)`.
    #[inline(always)]
    fn invariants(&self, _: Vec3<L>, b: Vec3<L>) -> (L, L) {
        let energies = self.inverses.scale(b).scale(b);
        (
            ((energies.x + energies.y) + energies.z) * self.twice_inverse_e,
            energies.dot(self.seconds) * self.twice_inverse_e,
        )
    }

    #[inline(always)]
    fn kappa(&self, (x, y): (L, L)) -> L {
        (self.t2 * x + y) * L::splat(1.0 / 3.0)
    }

    #[inline(always)]
    fn short_turn(&self, invariants: (L, L), kappa: L, b: Vec3<L>) -> Vec3<L> {
        let d = self.modified(invariants, kappa);
        let c = differences(d);
        let (a, s) = self.begin(d, c, kappa, b);
        end(a, s, d, c, b)
    }

    #[inline(always)]
    fn turn(&self, invariants: (L, L), kappa: L, b: Vec3<L>) -> Vec3<L> {
        let d = self.modified(invariants, kappa);
        let c = differences(d);
        let (mut a, mut s) = self.begin(d, c, kappa, b);
        let is_short = kappa.lt(L::splat(Self::LARGEST_SHORT_KAPPA));
        for _ in 0..FURTHER_SWEEPS {
            let next_s = stretch(self.square(d.scale(a)));
            let next_a = sweep(a, b, c * next_s);
            a = Vec3::select(is_short, a, next_a);
            s = L::select(is_short, s, next_s);
        }
        let u = end(a, s, d, c, b);
        // Where the moments are so unequal that their rounded differences mean nothing, sweeps may
        // lead away; then the body turns about its present angular velocity.
        let steady = self.inverses.scale(b);
        let has_ended = u.dot(u).lt(L::splat(1.0));
        Vec3::select(is_short, u, Vec3::select(has_ended, u, steady))
    }

    /// Off by `6e-9 u^2`.
    #[inline(always)]
    fn short_shrinkage(&self, v: L) -> L {
        let w = self.significant(v, v);
        v * ((L::splat(-0.499_999_994_648) + w * L::splat(0.374_988_769_6)) + (w * w) * L::splat(-0.309_005_36))
    }

    #[inline(always)]
    fn shrinkage(&self, kappa: L, v: L) -> L {
        let one = L::splat(1.0);
        let root = (one + v).sqrt();
        let exact = -(v / (root * (one + root)));
        L::select(kappa.lt(L::splat(Self::LARGEST_SHORT_KAPPA)), self.short_shrinkage(v), exact)
    }

    #[inline(always)]
    fn angles(&self, y: Vec3<L>, to_drive: L) -> Vec3<L> {
        (y * (to_drive + to_drive)).scale(self.inverses)
    }
}

/// The next approximation to `a_1 = b_1 - c_1 a_2 a_3` and so on, each with what is new already.
#[inline(always)]
fn sweep<L: Lane>(a: Vec3<L>, b: Vec3<L>, c: Vec3<L>) -> Vec3<L> {
    // Multiplied in the order in which the factors are known.
    let x = b.x - (c.x * a.z) * a.y;
    let y = b.y - (c.y * a.z) * x;
    let z = b.z - (c.z * x) * y;
    Vec3::new(x, y, z)
}

/// `(d_2 - d_3, d_3 - d_1, d_1 - d_2)`.
#[inline(always)]
fn differences<L: Lane>(d: Vec3<L>) -> Vec3<L> {
    Vec3::new(d.y - d.z, d.z - d.x, d.x - d.y)
}

/// `u` from `a` nearly solved.
#[inline(always)]
fn end<L: Lane>(a: Vec3<L>, s: L, d: Vec3<L>, c: Vec3<L>, b: Vec3<L>) -> Vec3<L> {
    d.scale(sweep(a, b, c * s) * s)
}

/// `1 + |u|^2` of a short step, from the square of `D a = u/(1 + |u|^2)`; off by `3e-7 |u|^2`.
#[inline(always)]
fn short_stretch<L: Lane>(n: L) -> L {
    L::splat(1.0) + n * ((L::splat(1.000_000_293) + n * L::splat(1.999_391_616)) + (n * n) * L::splat(5.186_406_06))
}

/// The same where kappa is at most [`LARGEST_KAPPA`](super::LARGEST_KAPPA); off by `2e-7 |u|^2`.
#[inline(always)]
fn stretch<L: Lane>(n: L) -> L {
    let nn = n * n;
    let low = L::splat(0.999_999_824_5) + n * L::splat(2.000_148_382_9);
    let middle = L::splat(4.979_755_529) + n * L::splat(14.996_610_998);
    let high = L::splat(20.520_654_09) + n * L::splat(327.650_230_9);
    L::splat(1.0) + n * (low + nn * (middle + nn * high))
}

#[cfg(test)]
mod tests {
    use super::super::FreeRotation;
    use super::super::tests::Uniform;
    use super::*;
    use crate::lane::Quat;

    /// Of random bodies, from the smallest turn to one of many parts; also by the longer way, which
    /// a tile takes with a fast body in it.
    #[test]
    fn resting_bodies_have_the_same_bits() {
        let mut uniform = Uniform(7);
        for _ in 0..20_000 {
            let mut size = |least: f64| (least.ln() + (1e3 / least).ln() * uniform.next()).exp() as f32;
            let (a, b) = (size(1e-3), size(1e-3));
            let momentum = Vec3::new(size(1e-38), size(1e-38), size(1e-38));
            let mut part = || uniform.next() as f32 * 2.0 - 1.0;
            // No moment is more than the other two.
            let moments = Vec3::new(a, b, (a - b).abs() + (a + b - (a - b).abs()) * part().abs());
            let inverse_moments = Vec3::new(1.0 / moments.x, 1.0 / moments.y, 1.0 / moments.z);
            let q = Quat { x: part(), y: part(), z: part(), w: 1.5 + part() }.normalize();
            let step = FreeRotation::new(moments, inverse_moments, None, 1.0 / 480.0);
            let bits = |q: Quat<f32>| [q.x, q.y, q.z, q.w].map(f32::to_bits);
            let same = format!("{moments:?} {momentum:?} {q:?}");
            assert_eq!(bits(step.for_resting().rotate(q, momentum)), bits(step.rotate(q, momentum)), "{same}");
            assert_eq!(bits(step.for_resting().rotate_far(q, momentum)), bits(step.rotate_far(q, momentum)), "{same}");
        }
    }

    /// The polynomials beside their functions, from no turn to the longest that each is for, which
    /// is `sqrt(6 kappa)`, of a disc about its axis.
    #[test]
    fn polynomials_are_their_functions() {
        let ball = Vec3::splat(1.0);
        let solver = Sweeps::new(&Ratios::new(ball, ball));
        let largest = |kappa: f64| (0.5 * (6.0 * kappa).sqrt()).tan().powi(2);
        let error = |found: f64, exact: f64, uu: f64| (found - exact).abs() / uu;
        for (is_short, kappa, allowed) in
            [(true, Sweeps::<f64>::LARGEST_SHORT_KAPPA, [3e-7, 6e-9]), (false, crate::LARGEST_KAPPA, [2e-7, 1e-15])]
        {
            for step in 1..=1000 {
                let uu = largest(kappa) * f64::from(step) / 1000.0;
                let da = Vec3::new(uu.sqrt() / (1.0 + uu), 0.0, 0.0);
                let s = if is_short { short_stretch(da.dot(da)) } else { stretch(da.dot(da)) };
                let exact = 1.0 / (1.0 + uu).sqrt() - 1.0;
                let shrinkage = if is_short { solver.short_shrinkage(uu) } else { solver.shrinkage(kappa, uu) };
                let errors = [error(s, 1.0 + uu, uu), error(shrinkage, exact, uu)];
                let slack = 4.0 * f64::EPSILON / uu;
                assert!(errors[0] <= allowed[0] && errors[1] <= allowed[1] + slack, "{kappa}, {uu}: {errors:?}");
            }
        }
    }
}
