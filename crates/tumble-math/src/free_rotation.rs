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
//! # The equation
//!
//! In double precision `u` is found by Newton's method, to rounding, from differences of the
//! moments `J` that are kept exactly (`newton.rs`). Single precision (`sweeps.rs`) needs neither
//! `J` nor a division. With `b = h/2 y`, `D_j = 1/J_j` and the unknown `a = J u/(1 + |u|^2)`, which
//! is the mean of `b` before and after the step, the equation is
//!
//! ```text
//! a + u x a = b,      u = s D a,      s = 1 + |u|^2 = 2/(1 + sqrt(1 - 4 n)),      n = |D a|^2
//! a_1 = b_1 - c_1 a_2 a_3,            c_1 = s (D_2 - D_3),        and so on
//! ```
//!
//! A sweep computes `a_1`, `a_2` and `a_3` one after the other from the second line, each with what
//! is new already, which gains two orders of `|u|`: four sweeps do for a short step, nine for the
//! longest of one part. That number follows from the body's own kappa (below), and what a neighbour
//! in a tile needs beyond it is thrown away. `s(n)` and `1/sqrt(1 + |u|^2)` are polynomials.
//!
//! The differences are those of the rounded `D_j` themselves, and exact where these nearly agree.
//! For a needle that decides: the spin about its own axis hangs on a difference that is as small as
//! its moment. `u x a` multiplied out loses it to rounding, and so does `s alpha (1/I_2 - 1/I_3)`.
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

mod newton;
mod solver;
mod sweeps;

use newton::Newton;
use solver::Solver;
use sweeps::Sweeps;

/// The largest `(h|w|/2)^2` that the map takes in one part: a turn of about half a radian.
pub const LARGEST_KAPPA: f64 = 0.06;
/// The most parts a step is divided into; past it a step turns the body by more than 25 radians.
pub const MAX_PARTS: f64 = 64.0;
/// The most by which `|q|^2` may differ from one for `q` to be taken as it is.
const LARGEST_LACK: f64 = 1e-2;

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
    method: Method<L>,
    axes: Option<Quat<L>>,
    /// Half the step over the unit of the moments: what takes the angular momentum to the right
    /// side of the equation.
    to_drive: L,
}

/// How the equation is solved: known when a lane's precision is.
#[derive(Clone, Copy, Debug)]
enum Method<L> {
    Sweeps(Sweeps<L>),
    Newton(Newton<L>),
}

impl<L: Lane> FreeRotation<L> {
    /// Whether the polynomials of [`Sweeps`] are exact to rounding.
    const IS_SINGLE: bool = L::ROUNDING > 1e-10;

    /// Prepares steps of length `h` \[s\], for the arguments of [`rotate_freely`].
    #[inline(always)]
    pub fn new(moments: Vec3<L>, inverse_moments: Vec3<L>, axes: Option<Quat<L>>, h: L) -> Self {
        let ratios = Ratios::new(moments, inverse_moments);
        let to_drive = h * ratios.unit * L::splat(0.5);
        let method = if Self::IS_SINGLE {
            Method::Sweeps(Sweeps::new(&ratios))
        } else {
            Method::Newton(Newton::new(&ratios, moments, inverse_moments, h))
        };
        Self { method, axes, to_drive }
    }

    /// The same with the same bits, for bodies that may nearly rest: squares of their angles may be
    /// subnormal numbers, which many processors are a hundred times slower with, and are left out.
    ///
    /// ```
    /// use tumble_math::FreeRotation;
    /// use tumble_math::lane::{Quat, Vec3};
    /// let (moments, inverse) = (Vec3::new(1.0, 2.0, 2.5), Vec3::new(1.0, 0.5, 0.4));
    /// let step = FreeRotation::new(moments, inverse, None, 0.01_f32);
    /// let (start, slow) = (Quat { x: 0.0, y: 0.6, z: 0.0, w: 0.8 }, Vec3::new(3e-9, 1e-9, 2e-9));
    /// assert_eq!(step.for_resting().rotate(start, slow), step.rotate(start, slow));
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn for_resting(self) -> Self {
        let Method::Sweeps(solver) = self.method else { return self };
        Self { method: Method::Sweeps(solver.for_resting()), ..self }
    }

    /// The orientation one step later; see [`rotate_freely`].
    #[inline(always)]
    pub fn rotate(&self, orientation: Quat<L>, angular_momentum: Vec3<L>) -> Quat<L> {
        match self.rotate_shortly(orientation, angular_momentum) {
            Some(turned) => turned,
            None => self.rotate_far(orientation, angular_momentum),
        }
    }

    /// What [`rotate`](Self::rotate) returns, to the bit, or `None` where that takes more than the
    /// shortest way for some body: where one turns far in the step, or its orientation is not of
    /// unit length. Less code than `rotate`, for callers who have another place for the rest.
    ///
    /// ```
    /// use tumble_math::FreeRotation;
    /// use tumble_math::lane::{Quat, Vec3};
    /// let step = FreeRotation::new(Vec3::splat(2.0_f32), Vec3::splat(0.5), None, 0.1);
    /// let start = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
    /// let (slow, fast) = (Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, 0.0, 100.0));
    /// assert_eq!(step.rotate_shortly(start, slow), Some(step.rotate(start, slow)));
    /// assert_eq!(step.rotate_shortly(start, fast), None);
    /// ```
    #[inline(always)]
    pub fn rotate_shortly(&self, orientation: Quat<L>, angular_momentum: Vec3<L>) -> Option<Quat<L>> {
        match &self.method {
            Method::Sweeps(solver) => self.rotate_shortly_by(solver, orientation, angular_momentum),
            Method::Newton(solver) => self.rotate_shortly_by(solver, orientation, angular_momentum),
        }
    }

    #[inline(always)]
    fn rotate_shortly_by<S: Solver<L>>(&self, solver: &S, q: Quat<L>, momentum: Vec3<L>) -> Option<Quat<L>> {
        let lack = L::splat(1.0) - q.length_squared();
        if L::any(L::splat(LARGEST_LACK).lt(lack.abs())) {
            return None;
        }
        let y = self.principal_components(q, lack, momentum);
        let b = y * self.to_drive;
        let invariants = solver.invariants(y, b);
        let kappa = solver.kappa(invariants);
        if !L::all(kappa.lt(L::splat(S::LARGEST_SHORT_KAPPA))) {
            return None;
        }
        let u = self.in_body_frame(solver.short_turn(invariants, kappa, b));
        let turned = turned(q, lack, u, solver.short_shrinkage(u.dot(u)));
        Some(Quat::select(L::splat(0.0).lt(kappa), turned, q))
    }

    /// The same without its limits. A body that is within them gets the same bits.
    #[inline(always)]
    fn rotate_far(&self, orientation: Quat<L>, angular_momentum: Vec3<L>) -> Quat<L> {
        match &self.method {
            Method::Sweeps(solver) => self.rotate_far_by(solver, orientation, angular_momentum),
            Method::Newton(solver) => self.rotate_far_by(solver, orientation, angular_momentum),
        }
    }

    #[inline(always)]
    fn rotate_far_by<S: Solver<L>>(&self, solver: &S, q: Quat<L>, momentum: Vec3<L>) -> Quat<L> {
        let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
        // Not what a step leaves, but what a caller may have set: it is made a rotation first.
        let far_from_unit = L::splat(LARGEST_LACK).lt((one - q.length_squared()).abs());
        let unit = q.normalize_or(Quat::from_parts(one, Vec3::zero()));
        let q = Quat::select(far_from_unit, unit, q);
        let lack = one - q.length_squared();

        let y = self.principal_components(q, lack, momentum);
        let (first, second) = solver.invariants(y, y * self.to_drive);
        let kappa = solver.kappa((first, second));
        let slow_enough = kappa.lt(L::splat(LARGEST_KAPPA * MAX_PARTS * MAX_PARTS));
        let parts = parts_needed(L::select(slow_enough, kappa, zero));
        let part = one / parts;
        let invariants = (first * (part * part), second * (part * part));
        let part_kappa = solver.kappa(invariants);
        let to_drive = self.to_drive * part;

        let mut after = q;
        let mut y_now = y;
        let mut lack_now = lack;
        let mut left = parts;
        loop {
            let u = self.in_body_frame(solver.turn(invariants, part_kappa, y_now * to_drive));
            let next = turned(after, lack_now, u, solver.shrinkage(part_kappa, u.dot(u)));
            // Moments that are more unequal than rounding allows may make `u` anything.
            let is_rotation = (one - next.length_squared()).abs().lt(L::splat(LARGEST_LACK));
            let next = Quat::select(is_rotation, next, next.normalize_or(after));
            after = Quat::select(half.lt(left), next, after);
            left = left - one;
            if !L::any(half.lt(left)) {
                break;
            }
            lack_now = one - after.length_squared();
            y_now = self.principal_components(after, lack_now, momentum);
        }
        if !L::all(slow_enough) {
            let angles = solver.angles(y, self.to_drive);
            after = Quat::select(slow_enough, after, rotate_exactly(q, mean_rotation(momentum, y, angles), one));
        }
        Quat::select(zero.lt(kappa), after, q)
    }

    /// `y = R^T L`: the angular momentum about the principal axes.
    #[inline(always)]
    fn principal_components(&self, orientation: Quat<L>, lack: L, angular_momentum: Vec3<L>) -> Vec3<L> {
        let body = turned_back(orientation, lack, angular_momentum);
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
}

/// The rotation vector of a step about the angular momentum at the mean rate `2 H/|L|`, from the
/// momentum, its principal components and the angles `h w_j`: it leaves `y`, and so the energy, as
/// they are.
#[inline(always)]
fn mean_rotation<L: Lane>(momentum: Vec3<L>, y: Vec3<L>, angles: Vec3<L>) -> Vec3<L> {
    let one = L::splat(1.0);
    // Squares of large momenta are no numbers in single precision.
    let scale = one / y.x.abs().max(y.y.abs()).max(y.z.abs());
    let unit = y * scale;
    momentum * (scale * (angles.dot(unit) / unit.dot(unit)))
}

/// `q (1, u)/|q (1, u)|`, for a `q` whose `|q|^2` lacks this much to one and the shrinkage
/// `1/|(1, u)| - 1`.
///
/// Computed as `q + (d + e (q + d))` with the small `d = q (0, u)` and `e = 1/|q (1, u)| - 1`, so
/// that one rounding of `q` itself is made and not four: what drifts in the energy over a million
/// steps is the sum of these.
#[inline(always)]
fn turned<L: Lane>(q: Quat<L>, lack: L, u: Vec3<L>, shrinkage: L) -> Quat<L> {
    let e = lack * L::splat(0.5) + shrinkage;
    let d = Quat::from_parts(-q.vector().dot(u), u * q.w + q.vector().cross(u));
    q + (d + (q + d) * e)
}

/// The world-frame vector in the body frame, for an orientation whose `|q|^2` lacks this much to
/// one, about a rounding.
///
/// What the orientation lacks to unit length is made good: the change of the vector is divided by
/// `|q|^2`. Without that the same lack, step after step, makes the energy drift.
#[inline(always)]
fn turned_back<L: Lane>(q: Quat<L>, lack: L, vector: Vec3<L>) -> Vec3<L> {
    let axis = q.vector();
    let half_turned = vector.cross(axis);
    let half_turned = half_turned + half_turned;
    let change = half_turned * q.w + half_turned.cross(axis);
    vector + (change + change * lack)
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
    /// `1/I_j`.
    inverses: Vec3<L>,
    /// `T_j`.
    seconds: Vec3<L>,
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
        Self { unit, inverses: inverse_moments * half_sum, seconds }
    }
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

    /// Uniform numbers from 0 to 1.
    pub(super) struct Uniform(pub(super) u64);

    impl Uniform {
        pub(super) fn next(&mut self) -> f64 {
            // D. E. Knuth's constants for congruences modulo 2^64.
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn log_between(&mut self, low: f64, high: f64) -> f64 {
            (low.ln() + (high / low).ln() * self.next()).exp()
        }

        fn direction(&mut self) -> DVec3 {
            loop {
                let v = DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0;
                if (0.1..1.0).contains(&v.length()) {
                    return v.normalize();
                }
            }
        }
    }

    /// A step in single precision beside the same map in double precision, from the same numbers:
    /// boxes of a centimetre to a hundred metres and up to 500 times as long as thick, at turns up
    /// to the longest of one part.
    ///
    /// To turn the momentum into the body's frame takes a rounding of it, which is that over a
    /// moment in the spin; a rounding of the moments moves the energy by that of a rounding of the
    /// orientation, `|w x L|`.
    #[test]
    fn single_precision_is_off_by_rounding() {
        let mut random = Uniform(1);
        let (mut most_off, mut most_gained) = (0.0_f64, 0.0_f64);
        for _ in 0..100_000 {
            let [a, b] = [random.log_between(1.0, 500.0), random.log_between(1.0, 500.0)];
            let squares = DVec3::new(1.0, 1.0 / (a * a), 1.0 / (b * b)) * random.log_between(1e-4, 1e4);
            let [x, y, z] = squares.to_array();
            let moments = DVec3::new(y + z, z + x, x + y) * random.log_between(1e-3, 1e3);
            let direction = random.direction();
            let direction = if random.next() < 0.3 { (DVec3::Z + direction * 1e-2).normalize() } else { direction };
            let (turn, h) = (random.log_between(1e-5, 0.42), random.log_between(1.0 / 240.0, 0.1));
            let q = DQuat::from_axis_angle(random.direction(), 6.0 * random.next());

            let (q, moments, h) = (q.as_quat(), moments.as_vec3(), h as f32);
            let momentum = (q.as_dquat() * (moments.as_dvec3() * direction * (turn / f64::from(h)))).as_vec3();
            let single: glam::Quat = rotate_freely(q.into(), None, momentum.into(), moments.into(), h).into();
            let wide = (q.as_dquat().normalize(), momentum.as_dvec3(), moments.as_dvec3());
            let double: DQuat = rotate_freely(wide.0.into(), None, wide.1.into(), wide.2.into(), f64::from(h)).into();

            let most_turn = f64::from(h) * wide.1.length() / wide.2.min_element();
            let off = 2.0 * (double.inverse() * single.as_dquat()).xyz().length();
            most_off = most_off.max(off / (f64::from(f32::EPSILON) * (1.0 + most_turn)));
            let gained =
                kinetic_energy(single.as_dquat().normalize(), wide.1, wide.2) - kinetic_energy(wide.0, wide.1, wide.2);
            let spin = (wide.0.inverse() * wide.1 / wide.2).length();
            most_gained = most_gained.max(gained.abs() / (f64::from(f32::EPSILON) * spin * wide.1.length()));
        }
        println!("{most_off} and {most_gained} roundings");
        assert!(most_off <= 4.0, "attitude: {most_off} roundings");
        assert!(most_gained <= 2.0, "energy: {most_gained} roundings");
    }

    #[test]
    fn a_body_at_rest_keeps_its_orientation_to_the_bit() {
        let q = Quat { x: 0.1_f32, y: 0.2, z: 0.3, w: 0.927_361_8 };
        let axes = Some(Quat { x: 0.5_f32, y: 0.5, z: 0.5, w: 0.5 });
        assert_eq!(rotate_freely(q, axes, Vec3::zero(), Vec3::new(1.0, 2.0, 2.5), 0.1), q);
    }
}
