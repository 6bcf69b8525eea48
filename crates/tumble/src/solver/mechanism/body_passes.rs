//! What all bodies of a mechanism do in a substep: kicks, free motion, and the inertia that follows
//! it and the loads; four bodies at a time.

use tumble_math::FreeRotation;
use tumble_math::lane::Vec3;

use crate::integrators::state::Moments;
use crate::simd::{FourKernel, FourLane, dispatch_fours};
use crate::solver::mechanism::fours::{
    by_place, four_of, of_each, quaternion, quaternions, row, rows, rows_of, vectors,
};
use crate::solver::mechanism::mechanism_body::{MechanismBody, SavedBody};
use crate::solver::mechanism::raised_inertia::{KEPT_LOAD, load_of, momentum_with};

/// Notes what a substep changes of bodies.
pub(super) fn save(bodies: &[MechanismBody], saved: &mut [SavedBody]) {
    dispatch_fours(Save { bodies, saved });
}

/// Adds what forces do in half a substep that was halved this many times.
pub(super) fn kick(bodies: &mut [MechanismBody], halvings: u32) {
    dispatch_fours(Kick { bodies, halvings });
}

/// Moves bodies from where they were saved for `h` \[s\], without what turns with them but their
/// orientations.
pub(super) fn drift(bodies: &mut [MechanismBody], saved: &[SavedBody], h: f64) {
    dispatch_fours(Drift { bodies, saved, h });
}

/// Lets the inverse inertia of bodies follow their orientations.
pub(super) fn follow(bodies: &mut [MechanismBody]) {
    dispatch_fours(Follow { bodies });
}

/// Raises the inertia of bodies to the loads of a substep of `h` \[s\]: by body, the sum over its
/// joints of impulse times arm [kg m^2/s].
pub(super) fn take_loads(bodies: &mut [MechanismBody], pulls: &[f64], h: f64) {
    dispatch_fours(TakeLoads { bodies, pulls, h });
}

struct Save<'a> {
    bodies: &'a [MechanismBody],
    saved: &'a mut [SavedBody],
}

impl FourKernel for Save<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        for (saved, body) in self.saved.iter_mut().zip(self.bodies) {
            T::load(&body.linear).store(&mut saved.linear);
            T::load(&body.angular).store(&mut saved.angular);
            T::load(&body.translation).store(&mut saved.translation);
            T::load(&body.orientation).store(&mut saved.orientation);
            T::load(&body.dropped).store(&mut saved.dropped);
            saved.load = body.load();
        }
    }
}

struct Kick<'a> {
    bodies: &'a mut [MechanismBody],
    halvings: u32,
}

impl FourKernel for Kick<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        for body in self.bodies {
            if self.halvings > 0 || body.is_damped() {
                body.kick(self.halvings);
            } else {
                (T::load(&body.linear) + T::load(&body.kick[0])).store(&mut body.linear);
                (T::load(&body.angular) + T::load(&body.kick[1])).store(&mut body.angular);
            }
        }
    }
}

struct Drift<'a> {
    bodies: &'a mut [MechanismBody],
    saved: &'a [SavedBody],
    h: f64,
}

impl FourKernel for Drift<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        let Self { bodies, saved, h } = self;
        let [zero, one] = [0.0, 1.0].map(T::splat);
        for first in (0..bodies.len()).step_by(4) {
            let four = four_of(first, bodies.len());
            let (at, _) = vectors::<T>(of_each!(four, i => &saved[i].translation));
            let (linear, inverse_mass) = vectors::<T>(of_each!(four, i => &bodies[i].linear));
            // What is not dynamic has velocities for momenta.
            let inverse_mass = T::select(zero.lt(inverse_mass), inverse_mass, one);
            let translations = rows_of(at + linear * inverse_mass * T::splat(h), zero);
            let orientation = quaternions::<T>(of_each!(four, i => &saved[i].orientation));
            let (angular, turns) = vectors::<T>(of_each!(four, i => &bodies[i].angular));
            let turns = zero.lt(turns);
            let (moments, _) = vectors::<T>(of_each!(four, i => &bodies[i].moments));
            let (inverses, _) = vectors::<T>(of_each!(four, i => &bodies[i].inverse_moments));
            let moments = Vec3::select(turns, moments, Vec3::splat(one));
            let inverses = Vec3::select(turns, inverses, Vec3::splat(one));
            let angular = Vec3::select(turns, angular, Vec3::splat(zero));
            let turned = FreeRotation::new(moments, inverses, None, T::splat(h)).rotate(orientation, angular);
            let orientations = rows(turned);
            // Of fewer than four bodies the last stands here several times, with the same numbers.
            by_place!(k of 4 {
                let body = &mut bodies[four[k]];
                translations[k].store(&mut body.translation);
                if body.turns() {
                    orientations[k].store(&mut body.orientation);
                } else if !body.is_moved() {
                    let start = quaternion(&saved[four[k]].orientation);
                    body.orientation = row(tumble_math::rotate_exactly(start, body.angular(), h));
                }
            });
        }
    }
}

struct Follow<'a> {
    bodies: &'a mut [MechanismBody],
}

impl FourKernel for Follow<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        let Self { bodies } = self;
        for first in (0..bodies.len()).step_by(4) {
            let four = four_of(first, bodies.len());
            let (inverse_moments, _) = vectors::<T>(of_each!(four, i => &bodies[i].inverse_moments));
            set_inverse_inertia(bodies, four, inverse_moments);
        }
    }
}

/// Sets the inverse inertia of those of four bodies that turn to these inverse moments.
#[inline(always)]
fn set_inverse_inertia<T: FourLane>(bodies: &mut [MechanismBody], four: [usize; 4], inverse_moments: Vec3<T>) {
    let orientation = quaternions::<T>(of_each!(four, i => &bodies[i].orientation));
    let moments = Moments { moments: inverse_moments, inverse_moments, axes: None };
    let (diagonal, off_diagonal) = moments.inverse_in_world(orientation);
    let zero = T::splat(0.0);
    let (diagonals, off_diagonals) = (rows_of(diagonal, zero), rows_of(off_diagonal, zero));
    by_place!(k of 4 {
        let body = &mut bodies[four[k]];
        if body.turns() {
            diagonals[k].store(&mut body.inverse_inertia[0]);
            off_diagonals[k].store(&mut body.inverse_inertia[1]);
        }
    });
}

struct TakeLoads<'a> {
    bodies: &'a mut [MechanismBody],
    pulls: &'a [f64],
    h: f64,
}

impl FourKernel for TakeLoads<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        let Self { bodies, pulls, h } = self;
        let zero = T::splat(0.0);
        for first in (0..bodies.len()).step_by(4) {
            let four = four_of(first, bodies.len());
            let (own, least) = vectors::<T>(of_each!(four, i => &bodies[i].own_moments));
            let (moments, load) = vectors::<T>(of_each!(four, i => &bodies[i].moments));
            let (momentum, turns) = vectors::<T>(of_each!(four, i => &bodies[i].angular));
            let pull = T::load(&of_each!(four, i => pulls[i]));
            let asked = load_of(pull, h).max(T::splat(KEPT_LOAD) * load);
            // What is no more changes nothing now, and nothing that is left of it will.
            let asked = T::select(least.lt(asked), asked, zero);
            let is_loaded = zero.lt(T::select(zero.lt(turns), asked.max(load), zero));
            if !T::any(is_loaded) {
                continue;
            }
            let raised = Vec3::new(own.x.max(asked), own.y.max(asked), own.z.max(asked));
            let orientation = quaternions::<T>(of_each!(four, i => &bodies[i].orientation));
            let scaled = momentum_with(raised, moments, orientation, momentum);
            // More inertia is taken at the momentum that there is, less of it at the velocity:
            // neither makes energy.
            let change = raised - moments;
            let change = change.x.abs().max(change.y.abs()).max(change.z.abs());
            let change = T::select(load.lt(asked), zero, T::select(is_loaded, change, zero));
            let is_scaled = zero.lt(change);
            let (dropped, damping_work) = vectors::<T>(of_each!(four, i => &bodies[i].dropped));
            let dropped = Vec3::select(is_scaled, dropped + momentum - scaled, dropped);
            let momentum = Vec3::select(is_scaled, scaled, momentum);
            let moments = Vec3::select(is_loaded, raised, moments);
            let load = T::select(is_loaded, asked, load);
            let one = T::splat(1.0);
            let inverses = Vec3::new(one / moments.x, one / moments.y, one / moments.z);
            let (momenta, moments) = (rows_of(momentum, turns), rows_of(moments, load));
            let (inverse_moments, dropped) = (rows_of(inverses, zero), rows_of(dropped, damping_work));
            by_place!(k of 4 {
                let body = &mut bodies[four[k]];
                momenta[k].store(&mut body.angular);
                moments[k].store(&mut body.moments);
                inverse_moments[k].store(&mut body.inverse_moments);
                dropped[k].store(&mut body.dropped);
            });
            set_inverse_inertia(bodies, four, inverses);
        }
    }
}
