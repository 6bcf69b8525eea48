//! Mutual gravity of bodies by direct summation over all pairs.

use rayon::prelude::*;
use tumble_math::lane::Vec3 as LaneVec3;

use crate::forces::components::attraction;
use crate::math::{Real, Vec3};
use crate::simd::{Kernel, MAX_BODIES, Tile, dispatch};
use crate::threads::InParts;

/// Makes a body attract all others that carry one, and be attracted by them:
/// `F_i = M_i sum mu_j r/(r^2 + e_i^2 + e_j^2)^(3/2)`, `r` from i to j.
///
/// Every pair is computed, at any number of bodies; docs/forces.md says what that costs. Momentum
/// is kept, and there is an energy, where `mu` is in proportion to [`Mass`](crate::Mass). A body
/// further than 1e15 m from the origin along an axis, or nowhere, attracts nothing, and no more
/// does one whose numbers here are not finite or whose `mu` is beyond 1e33. A pull that would
/// change a velocity by more than 1e9 m/s in a part of a step is not felt. With a `mu` of zero a
/// body feels the others and they do not feel it.
///
/// ```
/// # use tumble::GravityMass;
/// // The earth, and a moon that in units of our own weighs two.
/// let (earth, moon) = (GravityMass::of_kilograms(5.972e24), GravityMass::new(2.0));
/// assert!((earth.mu / 3.986e14 - 1.0).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct GravityMass {
    /// Gravitational constant times mass [m^3/s^2].
    pub mu: Real,
    /// `e` \[m\]: the force stays finite where bodies meet.
    pub softening: Real,
}

impl GravityMass {
    /// Of a gravitational constant times mass [m^3/s^2], without softening.
    pub fn new(mu: Real) -> Self {
        Self { mu, softening: 0.0 }
    }

    /// The gravitational constant [m^3/(kg s^2)] (CODATA 2018).
    pub const CONSTANT: f64 = 6.674_30e-11;

    /// Of a mass \[kg\] in this universe.
    pub fn of_kilograms(mass: f64) -> Self {
        Self::new(crate::math::real(Self::CONSTANT * mass))
    }
}

/// Where masses are and how they pull.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct GravitySource {
    pub(crate) position: Vec3,
    pub(crate) mu: Real,
    pub(crate) softening_squared: Real,
}

/// The accelerations that bodies give each other, and of what they are.
#[derive(Clone, Default)]
pub(crate) struct Gravity {
    sources: Vec<GravitySource>,
    /// x, y, z and squared softening of the same in rows, filled up to whole tiles.
    rows: [Vec<Real>; 4],
    /// x, y and z [m/s^2], in rows.
    accelerations: [Vec<Real>; 3],
}

/// Bodies whose accelerations one thread computes at a time: a multiple of every tile's width.
const PART: usize = 2 * MAX_BODIES;
/// Fewest attractions that are worth handing to another thread: they take ten microseconds.
const ATTRACTIONS: usize = 8192;

impl Gravity {
    /// Computes the accelerations, unless these very sources were the last.
    pub(crate) fn update(&mut self, sources: impl Iterator<Item = GravitySource> + Clone) {
        if self.sources.iter().copied().eq(sources.clone()) {
            return;
        }
        self.sources.clear();
        self.sources.extend(sources);
        let filled = self.sources.len().next_multiple_of(PART);
        for row in self.rows.iter_mut().chain(&mut self.accelerations) {
            row.clear();
            row.resize(filled, 0.0);
        }
        for (i, GravitySource { position, softening_squared, .. }) in self.sources.iter().enumerate() {
            let numbers = [position.x, position.y, position.z, *softening_squared];
            for (row, number) in self.rows.iter_mut().zip(numbers) {
                row[i] = number;
            }
        }
        let (sources, rows) = (&self.sources, &self.rows);
        let [x, y, z] = &mut self.accelerations;
        let parts = x.par_chunks_mut(PART).zip(y.par_chunks_mut(PART)).zip(z.par_chunks_mut(PART));
        let least = ATTRACTIONS.div_ceil(PART * sources.len().max(1));
        parts.enumerate().by_at_least(least).for_each(|(part, ((x, y), z))| {
            dispatch(&mut Attract { sources, rows, first: part * PART, sums: [x, y, z] });
        });
    }

    /// The acceleration of a body [m/s^2].
    pub(crate) fn acceleration(&self, i: usize) -> Vec3 {
        let [x, y, z] = &self.accelerations;
        Vec3::new(x[i], y[i], z[i])
    }
}

/// Sums up what all sources do to some bodies, in the sources' order.
struct Attract<'a> {
    sources: &'a [GravitySource],
    rows: &'a [Vec<Real>; 4],
    first: usize,
    sums: [&'a mut [Real]; 3],
}

impl Kernel for Attract<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        PART
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let at = self.first + i;
        let ([x], [y], [z]) =
            (T::load(&self.rows[0][at..]), T::load(&self.rows[1][at..]), T::load(&self.rows[2][at..]));
        let [softening_squared] = T::load(&self.rows[3][at..]);
        let position = LaneVec3::new(x, y, z);
        let mut sum = LaneVec3::zero();
        for source in self.sources {
            let away = crate::storage::tile_io::splat::<T>(source.position) - position;
            let softening_squared = softening_squared + T::splat(source.softening_squared.into());
            sum = sum + attraction(away, T::splat(source.mu.into()), softening_squared);
        }
        T::store([sum.x], &mut self.sums[0][i..]);
        T::store([sum.y], &mut self.sums[1][i..]);
        T::store([sum.z], &mut self.sums[2][i..]);
    }
}
