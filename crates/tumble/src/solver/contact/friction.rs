//! Friction impulses: rolling resistance, then sliding and twisting within a limit ellipsoid.

use tumble_math::lane::Vec3;

use crate::simd::Tile;
use crate::simd::block_lanes::{at, put};
use crate::solver::contact::constraint::{Friction, Rolling};
use crate::solver::contact::contact_frame::{ContactFrame, Relative};

/// Impulses of what resists sliding, twisting and rolling, in the frames of a tile's contacts.
#[derive(Clone, Copy)]
pub(crate) struct FrictionImpulse<T> {
    sliding: [T; 2],
    twist: T,
    roll: [T; 2],
}

impl<T: Tile> FrictionImpulse<T> {
    #[inline(always)]
    pub(crate) fn none() -> Self {
        let zero = T::splat(0.0);
        Self { sliding: [zero; 2], twist: zero, roll: [zero; 2] }
    }

    #[inline(always)]
    pub(crate) fn load(friction: &Friction, rolling: Option<&Rolling>, lane: usize) -> Self {
        let zero = T::splat(0.0);
        let roll = match rolling {
            Some(rolling) => [at(&rolling.impulse[0], lane), at(&rolling.impulse[1], lane)],
            None => [zero; 2],
        };
        let sliding = [at(&friction.sliding[0], lane), at(&friction.sliding[1], lane)];
        Self { sliding, twist: at(&friction.twist, lane), roll }
    }

    #[inline(always)]
    pub(crate) fn store(&self, friction: &mut Friction, rolling: Option<&mut Rolling>, lane: usize) {
        put(self.sliding[0], &mut friction.sliding[0], lane);
        put(self.sliding[1], &mut friction.sliding[1], lane);
        put(self.twist, &mut friction.twist, lane);
        if let Some(rolling) = rolling {
            put(self.roll[0], &mut rolling.impulse[0], lane);
            put(self.roll[1], &mut rolling.impulse[1], lane);
        }
    }

    /// The same impulses, given in the world.
    #[inline(always)]
    pub(crate) fn from_world(frame: &ContactFrame<T>, linear: Vec3<T>, angular: Vec3<T>) -> Self {
        let [s, t] = frame.tangents;
        Self {
            sliding: [s.dot(linear), t.dot(linear)],
            twist: frame.normal.dot(angular),
            roll: [s.dot(angular), t.dot(angular)],
        }
    }

    /// The same with a torque about the tangents only where something resists rolling: of what is
    /// kept from step to step it may have one elsewhere, since the normal turns.
    #[inline(always)]
    pub(crate) fn of_what_rolls(self, length: T) -> Self {
        let (zero, [u, v]) = (T::splat(0.0), self.roll);
        let rolls = zero.lt(length);
        Self { roll: [T::select(rolls, u, zero), T::select(rolls, v, zero)], ..self }
    }

    /// A part of the same.
    #[inline(always)]
    pub(crate) fn scaled(&self, part: T) -> Self {
        let [[s, t], [u, v]] = [self.sliding, self.roll];
        Self { sliding: [s * part, t * part], twist: self.twist * part, roll: [u * part, v * part] }
    }

    #[inline(always)]
    pub(crate) fn plus(&self, other: &Self) -> Self {
        let ([s, t], [u, v]) = (self.sliding, self.roll);
        let ([other_s, other_t], [other_u, other_v]) = (other.sliding, other.roll);
        Self { sliding: [s + other_s, t + other_t], twist: self.twist + other.twist, roll: [u + other_u, v + other_v] }
    }

    /// The impulse in the tangent plane, world frame.
    #[inline(always)]
    pub(crate) fn linear(&self, frame: &ContactFrame<T>) -> Vec3<T> {
        frame.tangents[0] * self.sliding[0] + frame.tangents[1] * self.sliding[1]
    }

    /// The angular impulse, world frame.
    #[inline(always)]
    pub(crate) fn angular(&self, frame: &ContactFrame<T>) -> Vec3<T> {
        frame.normal * self.twist + frame.tangents[0] * self.roll[0] + frame.tangents[1] * self.roll[1]
    }

    /// The same with as much of the rolling taken out as what resists it can take.
    ///
    /// To be applied before [`slid`](Self::slid) is asked: sliding friction turns a body too, and
    /// both at once, each as if it were alone, would turn it back and forth.
    #[inline(always)]
    pub(crate) fn rolled(
        &self,
        rolling: &Rolling,
        (frame, lane): (&ContactFrame<T>, usize),
        motion: &Relative<T>,
        normal: T,
    ) -> Self {
        let [s, t] = frame.tangents;
        let mass = [at(&rolling.mass[0], lane), at(&rolling.mass[1], lane), at(&rolling.mass[2], lane)];
        let [du, dv] = product(mass, [s.dot(motion.angular), t.dot(motion.angular)]);
        let (u, v) = (self.roll[0] - du, self.roll[1] - dv);
        let (wanted, limit) = ((u * u + v * v).sqrt(), at::<T>(&rolling.length, lane) * normal);
        let scale = T::select(limit.lt(wanted), limit / wanted, T::splat(1.0));
        Self { roll: [u * scale, v * scale], ..*self }
    }

    /// The same with as much of the sliding and twisting taken out as friction can take.
    ///
    /// Sliding and twisting share what there is: the impulse `f` and the angular impulse `t` are
    /// within `|f|^2 + (t/radius)^2 <= (mu N)^2`, the ellipsoid that approximates the limit surface
    /// of a patch (S. Goyal, A. Ruina, J. Papadopoulos, 1991). What slips is resisted against its
    /// velocity, `(u, radius r)`, as the ellipsoid has it: what would stop it in one go, with all
    /// the tipping of the body that goes with that, points elsewhere.
    #[inline(always)]
    pub(crate) fn slid<const P: usize>(
        &self,
        friction: &Friction,
        (frame, lane): (&ContactFrame<T>, usize),
        motion: &Relative<T>,
        normal: T,
    ) -> Self {
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let [s, t] = frame.tangents;
        let mass = [at(&friction.mass[0], lane), at(&friction.mass[1], lane), at(&friction.mass[2], lane)];
        let along = [s.dot(motion.linear), t.dot(motion.linear)];
        let [du, dv] = product(mass, along);
        let (u, v) = (self.sliding[0] - du, self.sliding[1] - dv);
        let radius: T = at(&friction.radius, lane);
        let has_patch = zero.lt(radius);
        let twisting_mass: T = at(&friction.twisting_mass, lane);
        let spin = frame.normal.dot(motion.angular);
        let (mut twist, mut reach) = (zero, zero);
        // One point is no patch.
        if P > 1 {
            // The twist that is left when nothing slides: both at once, each as if it were alone,
            // swing up where the middle is far from below the centre of mass.
            let [of_s, of_t]: [T; 2] = [at(&friction.twist_couplings[0], lane), at(&friction.twist_couplings[1], lane)];
            let left = spin - (of_s * du + of_t * dv);
            twist = T::select(has_patch, self.twist - twisting_mass * left, zero);
            reach = T::select(has_patch, twist / radius, zero);
        }
        let hold = at::<T>(&friction.limits[0], lane) * normal;
        let slips = hold.lt((u * u + v * v + reach * reach).sqrt());
        if !T::any(slips) {
            return Self { sliding: [u, v], twist, ..*self };
        }

        // With one mass for all directions, the inverse of the mean of what impulses along them do:
        // more would turn the slip around where the directions differ.
        let both = one / (mass[0] + mass[2]);
        let even = (mass[0] * (mass[2] * both) - mass[1] * (mass[1] * both)) * T::splat(2.0);
        // Where locked axes leave one direction, its mass.
        let even = T::select(zero.lt(even), even, mass[0] + mass[2]);
        let of_twist = T::select(zero.lt(radius * twisting_mass), radius * radius / twisting_mass, zero);
        let even = even / (one + even * of_twist * T::splat(0.5));
        let lost = [even * along[0], even * along[1], even * (radius * spin)];
        let (p, q) = (self.sliding[0] - lost[0], self.sliding[1] - lost[1]);
        let reach = T::select(has_patch, self.twist / radius - lost[2], zero);
        // What static friction stops in this substep is not sliding yet, or no more: it may hold.
        let stops = (lost[0] * lost[0] + lost[1] * lost[1] + lost[2] * lost[2]).sqrt();
        let limit = T::select(hold.lt(stops), at::<T>(&friction.limits[1], lane) * normal, hold);
        let wanted = (p * p + q * q + reach * reach).sqrt();
        let scale = T::select(limit.lt(wanted), limit / wanted, one);
        let slid = [p * scale, q * scale, reach * radius * scale];
        let sliding = [T::select(slips, slid[0], u), T::select(slips, slid[1], v)];
        Self { sliding, twist: T::select(slips, slid[2], twist), ..*self }
    }
}

/// A symmetric 2x2 matrix `xx, xy, yy` times a vector.
#[inline(always)]
fn product<T: Tile>([a, b, c]: [T; 3], [x, y]: [T; 2]) -> [T; 2] {
    [a * x + b * y, b * x + c * y]
}
