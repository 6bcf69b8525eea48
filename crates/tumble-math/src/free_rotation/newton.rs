//! The equation of the map in `u`, by Newton's method to the last digit: for double precision.

use super::Ratios;
use super::solver::Solver;
use crate::lane::{Lane, Vec3};

/// Newton iterations at most; from the starting value below two or three are enough.
const MAX_ITERATIONS: u32 = 6;

/// What of the equation does not depend on the state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Newton<L> {
    /// `I_j`, in units of half their sum.
    moments: Vec3<L>,
    /// `1/I_j`.
    inverses: Vec3<L>,
    /// `T_j`.
    seconds: Vec3<L>,
    t2: L,
    t3: L,
    inverse_e: L,
    /// `h/I_j`: what takes the angular momentum to the angles `h w_j`.
    to_angles: Vec3<L>,
}

impl<L: Lane> Newton<L> {
    /// For steps of length `h` of a body with these moments and their inverses.
    #[inline(always)]
    pub(super) fn new(ratios: &Ratios<L>, moments: Vec3<L>, inverse_moments: Vec3<L>, h: L) -> Self {
        let Ratios { unit, inverses, seconds } = *ratios;
        let (t1, t2, t3) = (seconds.x, seconds.y, seconds.z);
        Self {
            moments: moments * unit,
            inverses,
            seconds,
            t2: t1 * t2 + t2 * t3 + t3 * t1,
            t3: t1 * t2 * t3,
            inverse_e: inverses.x * inverses.y * inverses.z,
            to_angles: inverse_moments * h,
        }
    }

    /// The map of a step with these invariants, of sixth order.
    #[inline(always)]
    fn map(&self, (h, d): (L, L)) -> Map<L> {
        let (one, three, four) = (L::splat(1.0), L::splat(3.0), L::splat(4.0));
        let (third, thirtieth) = (L::splat(1.0 / 3.0), L::splat(1.0 / 30.0));
        let (t2, t3) = (self.t2, self.t3);
        let (h, d) = (h * self.inverse_e, d * self.inverse_e);
        let (hh, hd, dd) = (h * h, h * d, d * d);
        let alpha4 = (t2 * t2 - three * t3) * hh + four * (t2 + t3) * hd + (one - three * t2) * dd;
        let delta4 = three * t3 * hh - four * t2 * hd - dd;
        let alpha = one - (t2 * h + d) * third + alpha4 * thirtieth;
        let delta = d * third + delta4 * thirtieth;
        // g_j = I_j/J_j; J_1 = I_1 g_2 g_3/(g_1 g_2 g_3) is one division for all three.
        let g = Vec3::splat(alpha) + self.moments * delta;
        let common = one / (g.x * g.y * g.z);
        Map::new(self.moments.scale(Vec3::new(g.y * g.z, g.z * g.x, g.x * g.y)) * common, self.inverses.scale(g))
    }
}

impl<L: Lane> Solver<L> for Newton<L> {
    const LARGEST_SHORT_KAPPA: f64 = super::LARGEST_KAPPA;

    /// `(h^2 H, h^2 D)`.
    #[inline(always)]
    fn invariants(&self, y: Vec3<L>, _: Vec3<L>) -> (L, L) {
        let angles = self.angles(y, L::splat(0.0));
        let energies = self.moments.scale(angles.scale(angles)) * L::splat(0.5);
        (energies.x + energies.y + energies.z, energies.dot(self.seconds))
    }

    #[inline(always)]
    fn kappa(&self, (h, d): (L, L)) -> L {
        (self.t2 * h + d) * self.inverse_e * L::splat(1.0 / 3.0)
    }

    #[inline(always)]
    fn short_turn(&self, invariants: (L, L), _: L, b: Vec3<L>) -> Vec3<L> {
        self.map(invariants).turn(b)
    }

    #[inline(always)]
    fn turn(&self, invariants: (L, L), _: L, b: Vec3<L>) -> Vec3<L> {
        self.map(invariants).turn(b)
    }

    #[inline(always)]
    fn short_shrinkage(&self, uu: L) -> L {
        let one = L::splat(1.0);
        let s = (one + uu).sqrt();
        // Without the cancellation of 1/s - 1.
        -(uu / (s * (one + s)))
    }

    #[inline(always)]
    fn shrinkage(&self, _: L, uu: L) -> L {
        self.short_shrinkage(uu)
    }

    #[inline(always)]
    fn angles(&self, y: Vec3<L>, _: L) -> Vec3<L> {
        y.scale(self.to_angles)
    }
}

/// The Moser-Veselov equation of one part, `J u + u x (J u) = b (1 + |u|^2)` with `b = h/2 y`.
///
/// It keeps `sum y_j^2/J_j` for any three numbers `J_j`, so that rounding these does no harm; but
/// it must then be solved with just these. Written as `u_1 + k_1 u_2 u_3 = m_1 (1 + |u|^2)` with
/// rounded `k_1 = (J_3 - J_2)/J_1` it keeps nothing, and the energy would drift by a thousandth of
/// a rounding a step, always the same way.
#[derive(Clone, Copy)]
struct Map<L> {
    /// `J_j`.
    moments: Vec3<L>,
    /// `1/J_j`, rounded: good enough to solve with.
    inverses: Vec3<L>,
    /// `(J_3 - J_2, J_1 - J_3, J_2 - J_1)`, rounded, and what rounding took from them, exactly.
    differences: Vec3<L>,
    remainders: Vec3<L>,
}

impl<L: Lane> Map<L> {
    #[inline(always)]
    fn new(moments: Vec3<L>, inverses: Vec3<L>) -> Self {
        let (x, x_left) = exact_difference(moments.z, moments.y);
        let (y, y_left) = exact_difference(moments.x, moments.z);
        let (z, z_left) = exact_difference(moments.y, moments.x);
        Self { moments, inverses, differences: Vec3::new(x, y, z), remainders: Vec3::new(x_left, y_left, z_left) }
    }

    /// `u`, solved to rounding.
    #[inline(always)]
    fn turn(&self, b: Vec3<L>) -> Vec3<L> {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let k = self.differences.scale(self.inverses);
        let m = b.scale(self.inverses);
        let m2 = m + m;
        let mut u = fixed_point(m, k, fixed_point(m, k, fixed_point(m, k, m)));
        let mut open = one;
        for _ in 0..MAX_ITERATIONS {
            let p = pairs(u);
            let crossed = self.differences.scale(p) + self.remainders.scale(p);
            let residual = (self.moments.scale(u) + crossed - b * (one + u.dot(u))).scale(self.inverses);
            // The rows of the Jacobian, and their cross products, which are the columns of its
            // adjugate.
            let r1 = Vec3::new(one - m2.x * u.x, k.x * u.z - m2.x * u.y, k.x * u.y - m2.x * u.z);
            let r2 = Vec3::new(k.y * u.z - m2.y * u.x, one - m2.y * u.y, k.y * u.x - m2.y * u.z);
            let r3 = Vec3::new(k.z * u.y - m2.z * u.x, k.z * u.x - m2.z * u.y, one - m2.z * u.z);
            let c1 = r2.cross(r3);
            let adjugate_residual = c1 * residual.x + r3.cross(r1) * residual.y + r1.cross(r2) * residual.z;
            let correction = adjugate_residual * (one / r1.dot(c1));
            u = Vec3::select(zero.lt(open), u - correction, u);
            // The next correction is at most about the square of this one. A body is done where
            // that is far below rounding, as the error left has the same sign in every step.
            let size = correction.dot(correction);
            let limit = L::splat(L::ROUNDING / 1024.0);
            let goes_on = (limit * limit * u.dot(u)).lt(size * size);
            open = L::select(goes_on, open, zero);
            if !L::any(zero.lt(open)) {
                break;
            }
        }
        // Where the moments are so unequal that their rounded differences mean nothing, there may
        // be no solution; then the body turns about its present angular velocity.
        Vec3::select(u.dot(u).lt(one), u, m)
    }
}

/// `(u_2 u_3, u_3 u_1, u_1 u_2)`.
#[inline(always)]
fn pairs<L: Lane>(u: Vec3<L>) -> Vec3<L> {
    Vec3::new(u.y * u.z, u.z * u.x, u.x * u.y)
}

/// The next approximation to `u_1 + k_1 u_2 u_3 = m_1 (1 + |u|^2)`.
#[inline(always)]
fn fixed_point<L: Lane>(m: Vec3<L>, k: Vec3<L>, u: Vec3<L>) -> Vec3<L> {
    m * (L::splat(1.0) + u.dot(u)) - k.scale(pairs(u))
}

/// `a - b` rounded, and what rounding took from it: their sum is the difference exactly (D. E.
/// Knuth, The Art of Computer Programming, vol. 2, section 4.2.2).
#[inline(always)]
fn exact_difference<L: Lane>(a: L, b: L) -> (L, L) {
    let difference = a - b;
    let b_part = a - difference;
    let a_part = difference + b_part;
    (difference, (a - a_part) - (b - b_part))
}
