//! Free rotation of a rigid body over one step, with energy and angular momentum kept to rounding.
//!
//! # The map
//!
//! Let `R` be the rotation from the principal frame to the world, `L` the world-frame angular
//! momentum (constant, since nothing acts on the body), `y = R^T L` its principal-frame components
//! and `h` the step. The discrete Moser-Veselov map solves
//!
//! ```text
//! J u + u x (J u) = h/2 y (1 + |u|^2)           for u, then          q <- q (1, u)/|(1, u)|
//! ```
//!
//! with `J = I` the principal moments. It keeps `|y|` and `sum y_j^2/J_j` exactly and is of second
//! order in the attitude (J. Moser, A. P. Veselov, Commun. Math. Phys. 139, 1991). E. Hairer and G.
//! Vilmart ("Preprocessed discrete Moser-Veselov algorithm for the full dynamics of a rigid body",
//! J. Phys. A 39, 2006) raise the order by *modifying the moments*: with
//! `1/J_j = alpha/I_j + delta`, where alpha and delta are series in `h^2` of the two invariants
//!
//! ```text
//! C = 1/2 |y|^2,         H = 1/2 sum y_j^2/I_j  (the kinetic energy),
//! ```
//!
//! `sum y_j^2/J_j = 2 (alpha H + delta C)`, so the energy is still kept exactly, whatever alpha and
//! delta are. Two terms of each series make the map of sixth order.
//!
//! # The coefficients
//!
//! We write them in the body's second moments of mass `T_1 = (I_2 + I_3 - I_1)/2 = sum m x_1^2` and
//! so on, which the triangle inequality makes non-negative. In units where `T_1 + T_2 + T_3 = 1`
//! (so `I_j = 1 - T_j`), with `t2 = T_1 T_2 + T_2 T_3 + T_3 T_1`, `t3 = T_1 T_2 T_3`,
//! `e = I_1 I_2 I_3 = t2 - t3`, `D = H - C = 1/2 sum I_j T_j w_j^2`:
//!
//! ```text
//! alpha = 1 - h^2 (t2 H + D)/(3 e)
//!           + h^4 ((t2^2 - 3 t3) H^2 + 4 (t2 + t3) H D + (1 - 3 t2) D^2)/(30 e^2)
//! delta =     h^2 D/(3 e)          + h^4 (3 t3 H^2 - 4 t2 H D - D^2)/(30 e^2)
//! ```
//!
//! All sums in alpha are of non-negative terms. The same coefficients in the elementary symmetric
//! functions of the moments cancel catastrophically for a needle (moments 1, 1, 1e-6), where each
//! of their terms is a million times their sum.
//!
//! `u` is found by Newton's method, to rounding, from differences of the moments that are kept
//! exactly.
//!
//! # Long steps
//!
//! `kappa = h^2 (t2 H + D)/(3 e)` is, like H and C, the same all along the motion and is
//! `(h|w|/2)^2` for a sphere: the square of the largest half-turn a step can make. A step with
//! kappa over [`LARGEST_KAPPA`] is divided into equal parts, at most [`MAX_PARTS`]; beyond, where a
//! step turns the body about four times around, it turns about its angular momentum at the mean
//! rate `2 H/|L|`, which keeps momentum and energy but not the phase.

use crate::lane::{Lane, Quat, Vec3};
use crate::orientation::rotate_exactly;

/// The largest `(h|w|/2)^2` that the map takes in one part: a turn of about half a radian.
pub const LARGEST_KAPPA: f64 = 0.06;
/// The most parts a step is divided into; past it a step turns the body by more than 25 radians.
pub const MAX_PARTS: f64 = 64.0;
/// Newton iterations at most; from the starting value below two or three are enough.
const MAX_ITERATIONS: u32 = 6;

/// The orientation after the time `h` \[s\] of a body on which nothing acts.
///
/// - `orientation`: unit quaternion, body frame to world;
/// - `axes`: unit quaternion, principal frame to body frame, where the two differ;
/// - `angular_momentum`: in the world frame [kg m^2/s], the same before and after;
/// - `moments`: the principal moments of inertia [kg m^2], positive, none above the sum of the
///   others, up to rounding.
///
/// Sixth order in `h` up to a turn of about 25 rad. Angular momentum and kinetic energy are kept to
/// rounding at any `h`; the result is of unit length, and for finite arguments finite. A body at
/// rest keeps its orientation to the bit.
///
/// ```
/// use glam::{DQuat, DVec3};
/// use tumble_math::rotate_freely;
/// // About a principal axis the rotation is uniform: here a tenth of a radian in one step.
/// let (momentum, moments) = (DVec3::new(0.0, 0.0, 3.0 * 2.0), DVec3::new(1.0, 2.0, 3.0));
/// let turned: DQuat =
///     rotate_freely(DQuat::IDENTITY.into(), None, momentum.into(), moments.into(), 0.05).into();
/// assert!(turned.angle_between(DQuat::from_rotation_z(0.1)) < 1e-10);
/// ```
#[inline(always)]
pub fn rotate_freely<L: Lane>(
    orientation: Quat<L>,
    axes: Option<Quat<L>>,
    angular_momentum: Vec3<L>,
    moments: Vec3<L>,
    h: L,
) -> Quat<L> {
    let one = L::splat(1.0);
    let inverse_moments = Vec3::new(one / moments.x, one / moments.y, one / moments.z);
    FreeRotation::new(moments, inverse_moments, axes, h).rotate(orientation, angular_momentum)
}

/// The free rotation of one body over steps of one length: what of [`rotate_freely`] does not
/// depend on the state.
///
/// ```
/// use tumble_math::FreeRotation;
/// use tumble_math::lane::{Quat, Vec3};
/// // 3 kg m^2/s about the axis with a moment of 3 kg m^2: a radian a second.
/// let (moments, inverse_moments) =
///     (Vec3::new(1.5, 2.0, 3.0), Vec3::new(1.0 / 1.5, 0.5, 1.0 / 3.0));
/// let step = FreeRotation::new(moments, inverse_moments, None, 0.1);
/// let mut orientation = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
/// for _ in 0..10 {
///     orientation = step.rotate(orientation, Vec3::new(0.0, 0.0, 3.0));
/// }
/// assert!((orientation.z - 0.5_f64.sin()).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct FreeRotation<L> {
    ratios: Ratios<L>,
    axes: Option<Quat<L>>,
    /// `h/I_j`: what takes the angular momentum in the principal frame to the angles `h w_j`.
    to_angles: Vec3<L>,
    /// Half the step over the unit of the moments: what takes the angular momentum to the right
    /// side of the equation.
    to_drive: L,
}

impl<L: Lane> FreeRotation<L> {
    /// Prepares steps of length `h` \[s\], for the arguments of [`rotate_freely`].
    #[inline(always)]
    pub fn new(moments: Vec3<L>, inverse_moments: Vec3<L>, axes: Option<Quat<L>>, h: L) -> Self {
        let ratios = Ratios::new(moments, inverse_moments);
        let to_drive = h * ratios.unit * L::splat(0.5);
        Self { ratios, axes, to_angles: inverse_moments * h, to_drive }
    }

    /// The orientation one step later; see [`rotate_freely`].
    #[inline(always)]
    pub fn rotate(&self, orientation: Quat<L>, angular_momentum: Vec3<L>) -> Quat<L> {
        let lack = (L::splat(1.0) - orientation.length_squared()).abs();
        let far_from_unit = L::splat(1e-2).lt(lack);
        let orientation = if L::any(far_from_unit) {
            // Not what a step leaves, but what a caller may have set: it is made a rotation first.
            let unit = orientation.normalize_or(Quat::from_parts(L::splat(1.0), Vec3::zero()));
            Quat::select(far_from_unit, unit, orientation)
        } else {
            orientation
        };
        let y = self.principal_components(orientation, angular_momentum);
        let invariants = self.ratios.invariants(y.scale(self.to_angles));
        let kappa = self.ratios.kappa(invariants);
        let turned = if L::all(kappa.lt(L::splat(LARGEST_KAPPA))) {
            self.turned(orientation, self.ratios.map(invariants).turn(y * self.to_drive))
        } else {
            self.rotate_in_parts(orientation, angular_momentum, y, invariants)
        };
        Quat::select(L::splat(0.0).lt(kappa), turned, orientation)
    }

    /// A step in which some body needs several parts. A body that needs one gets the bits that it
    /// gets without the others.
    #[inline(always)]
    fn rotate_in_parts(&self, orientation: Quat<L>, momentum: Vec3<L>, y: Vec3<L>, (h2, d2): (L, L)) -> Quat<L> {
        let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
        let kappa = self.ratios.kappa((h2, d2));
        let slow_enough = kappa.lt(L::splat(LARGEST_KAPPA * MAX_PARTS * MAX_PARTS));
        let parts = parts_needed(L::select(slow_enough, kappa, zero));
        let part = one / parts;
        let map = self.ratios.map((h2 * (part * part), d2 * (part * part)));
        let to_drive = self.to_drive * part;

        let mut turned = self.turned(orientation, map.turn(y * to_drive));
        let mut left = parts - one;
        while L::any(half.lt(left)) {
            let next = self.turned(turned, map.turn(self.principal_components(turned, momentum) * to_drive));
            turned = Quat::select(half.lt(left), next, turned);
            left = left - one;
        }
        if L::all(slow_enough) {
            return turned;
        }
        Quat::select(slow_enough, turned, rotate_exactly(orientation, self.mean_rotation(momentum, y), one))
    }

    /// The rotation vector of a step about the angular momentum at the mean rate `2 H/|L|`: it
    /// leaves `y`, and so the energy, as they are.
    #[inline(always)]
    fn mean_rotation(&self, momentum: Vec3<L>, y: Vec3<L>) -> Vec3<L> {
        let one = L::splat(1.0);
        // Squares of large momenta are no numbers in single precision.
        let scale = one / y.x.abs().max(y.y.abs()).max(y.z.abs());
        let unit = y * scale;
        momentum * (scale * (y.scale(self.to_angles).dot(unit) / unit.dot(unit)))
    }

    /// `y = R^T L`: the angular momentum about the principal axes.
    #[inline(always)]
    fn principal_components(&self, orientation: Quat<L>, angular_momentum: Vec3<L>) -> Vec3<L> {
        let body = turned_back(orientation, angular_momentum);
        match self.axes {
            Some(axes) => axes.rotate_back(body),
            None => body,
        }
    }

    /// A vector of the principal frame in the body frame.
    #[inline(always)]
    fn in_body_frame(&self, principal: Vec3<L>) -> Vec3<L> {
        match self.axes {
            Some(axes) => axes.rotate(principal),
            None => principal,
        }
    }

    /// `q (1, u)/|q (1, u)|`, with `u` in the principal frame, for a `q` of unit length up to
    /// rounding.
    ///
    /// Computed as `q + (d + e (q + d))` with the small `d = q (0, u)` and `e = 1/|q (1, u)| - 1`,
    /// so that one rounding of `q` itself is made and not four: what drifts in the energy over a
    /// million steps is the sum of these.
    #[inline(always)]
    fn turned(&self, q: Quat<L>, u: Vec3<L>) -> Quat<L> {
        let (one, half) = (L::splat(1.0), L::splat(0.5));
        let u_body = self.in_body_frame(u);
        let uu = u_body.dot(u_body);
        let s = (one + uu).sqrt();
        // 1/sqrt(1 + u^2) - 1 without its cancellation, and half of what |q|^2 lacks to one.
        let e = (one - q.length_squared()) * half - uu / (s * (one + s));
        let d = Quat::from_parts(-q.vector().dot(u_body), u_body * q.w + q.vector().cross(u_body));
        q + (d + (q + d) * e)
    }
}

/// The world-frame vector in the body frame, for an orientation of unit length up to rounding.
///
/// What the orientation lacks to unit length is made good: the change of the vector is divided by
/// `|q|^2`. Without that the same lack, step after step, makes the energy drift.
#[inline(always)]
fn turned_back<L: Lane>(q: Quat<L>, vector: Vec3<L>) -> Vec3<L> {
    let axis = q.vector();
    let half_turned = vector.cross(axis);
    let half_turned = half_turned + half_turned;
    let change = half_turned * q.w + half_turned.cross(axis);
    vector + (change + change * (L::splat(1.0) - q.length_squared()))
}

/// The least whole number of parts, at least one, whose kappa is at most [`LARGEST_KAPPA`].
#[inline(always)]
fn parts_needed<L: Lane>(kappa: L) -> L {
    // Adding and taking away 1.5 * 2^mantissa rounds to the nearest whole number.
    let rounder = L::splat(0.75 / L::ROUNDING);
    let parts = ((kappa * L::splat(1.0 / LARGEST_KAPPA)).sqrt() + L::splat(0.5) + rounder) - rounder;
    parts.max(L::splat(1.0))
}

/// A body's principal moments as ratios, in units of half their sum `T_1 + T_2 + T_3`.
#[derive(Clone, Copy, Debug)]
struct Ratios<L> {
    /// One over the unit.
    unit: L,
    /// `I_j`.
    moments: Vec3<L>,
    /// `1/I_j`.
    inverses: Vec3<L>,
    /// `T_j`.
    seconds: Vec3<L>,
    t2: L,
    t3: L,
    inverse_e: L,
}

impl<L: Lane> Ratios<L> {
    #[inline(always)]
    fn new(moments: Vec3<L>, inverse_moments: Vec3<L>) -> Self {
        let (a, b, c) = (moments.x, moments.y, moments.z);
        let half_sum = ((a + b) + c) * L::splat(0.5);
        let unit = L::splat(1.0) / half_sum;
        let half_unit = unit * L::splat(0.5);
        // Differences first: they are exact where two moments nearly agree. Rounded moments of a
        // flat body may miss zero.
        let seconds = Vec3::new((b - a) + c, (c - b) + a, (a - c) + b) * half_unit;
        let zero = L::splat(0.0);
        let seconds = Vec3::new(seconds.x.max(zero), seconds.y.max(zero), seconds.z.max(zero));
        let (t1, t2, t3) = (seconds.x, seconds.y, seconds.z);
        let inverses = inverse_moments * half_sum;
        Self {
            unit,
            moments: moments * unit,
            inverses,
            seconds,
            t2: t1 * t2 + t2 * t3 + t3 * t1,
            t3: t1 * t2 * t3,
            inverse_e: inverses.x * inverses.y * inverses.z,
        }
    }

    /// `(h^2 H, h^2 D)` from the angles `h w_j`.
    #[inline(always)]
    fn invariants(&self, angles: Vec3<L>) -> (L, L) {
        let energies = self.moments.scale(angles.scale(angles)) * L::splat(0.5);
        (energies.x + energies.y + energies.z, energies.dot(self.seconds))
    }

    #[inline(always)]
    fn kappa(&self, (h, d): (L, L)) -> L {
        (self.t2 * h + d) * self.inverse_e * L::splat(1.0 / 3.0)
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    fn kinetic_energy(orientation: DQuat, momentum: DVec3, moments: DVec3) -> f64 {
        let y = orientation.inverse() * momentum;
        0.5 * (y * y / moments).element_sum()
    }

    fn run(moments: DVec3, angular_velocity: DVec3, dt: f64, steps: u32) -> DQuat {
        let momentum = (moments * angular_velocity).into();
        (0..steps).fold(DQuat::IDENTITY.into(), |q, _| rotate_freely(q, None, momentum, moments.into(), dt)).into()
    }

    /// The attitude error after a second falls with the sixth power of the step.
    #[test]
    fn order_is_six() {
        let (moments, w) = (DVec3::new(1.0, 2.0, 2.6), DVec3::new(2.0, 3.0, 1.0));
        let exact = run(moments, w, 1.0 / 1024.0, 1024);
        let error = |steps: u32| {
            let q = run(moments, w, 1.0 / f64::from(steps), steps);
            2.0 * (exact.inverse() * q).xyz().length()
        };
        let order = (error(16) / error(32)).log2();
        assert!((order - 6.0).abs() < 0.2, "observed order {order}");
    }

    #[test]
    fn energy_is_kept_to_rounding_at_any_step() {
        for moments in [DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 1.0, 1e-6), DVec3::new(2.0, 2.0, 2.0)] {
            for dt in [1e-3, 0.1, 0.5, 3.0] {
                let w = DVec3::new(0.3, 1.0, 0.2);
                let before = kinetic_energy(DQuat::IDENTITY, moments * w, moments);
                let q = run(moments, w, dt, 1000);
                let after = kinetic_energy(q, moments * w, moments);
                // A rounding of q moves the energy by up to the moments' spread times itself; 1000
                // of them add up at random.
                assert!((after / before - 1.0).abs() < 1e-12, "{moments} dt {dt}: {before} to {after}");
            }
        }
    }

    #[test]
    fn a_body_at_rest_keeps_its_orientation_to_the_bit() {
        let q = Quat { x: 0.1_f32, y: 0.2, z: 0.3, w: 0.927_361_8 };
        let axes = Some(Quat { x: 0.5_f32, y: 0.5, z: 0.5, w: 0.5 });
        assert_eq!(rotate_freely(q, axes, Vec3::zero(), Vec3::new(1.0, 2.0, 2.5), 0.1), q);
    }
}
