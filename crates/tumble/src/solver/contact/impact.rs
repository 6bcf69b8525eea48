//! The impulses of an impact, at all points of a contact together.
//!
//! One after the other, the first point would take most of a flat impact, and what turns because of
//! it is hardly stopped by the others.

use crate::simd::Tile;
use crate::simd::block_lanes::at;
use crate::solver::contact::constraint::Block;
use crate::solver::contact::solve::coupling;

/// The impulse that each point of a contact would take of an impact if there were no other point.
pub(crate) struct DecoupledImpulses<T, const P: usize> {
    /// \[N s\].
    impulses: [T; P],
    /// The velocities along the normal that these give at the same points \[m/s\].
    responses: [T; P],
}

impl<T: Tile, const P: usize> DecoupledImpulses<T, P> {
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self { impulses: [T::splat(0.0); P], responses: [T::splat(0.0); P] }
    }

    /// That the point with an effective `mass` \[kg\] takes an impulse \[N s\] where `which` is
    /// above zero, if it pushes.
    #[inline(always)]
    pub(crate) fn set(&mut self, j: usize, impulse: T, mass: T, which: T) {
        let zero = T::splat(0.0);
        // A point that is not there may have any numbers, but no mass.
        let which = T::select(zero.lt(mass), which, zero);
        let impulse = T::select(zero.lt(which), impulse, zero).max(zero);
        self.impulses[j] = impulse;
        self.responses[j] = T::select(zero.lt(impulse), impulse / mass, zero);
    }

    /// Impulses at all points in the ratio of these, as large as leaves least of the impact.
    /// Changes the `speeds` at the points; returns the impulses, and how fast each point moves
    /// along the normal meanwhile.
    #[inline(always)]
    pub(crate) fn together<const C: usize>(
        &self,
        block: &Block<P, C>,
        lane: usize,
        speeds: &mut [T; P],
    ) -> ([T; P], [T; P]) {
        let (zero, half) = (T::splat(0.0), T::splat(0.5));
        let (wanted, mut responses) = (self.impulses, self.responses);
        let (mut decoupled, mut coupled) = (zero, zero);
        let mut j = 0;
        while j < P {
            let mut k = j + 1;
            while k < P {
                let between: T = at(&block.couplings[coupling::<P>(j, k)], lane);
                responses[j] = responses[j] + between * wanted[k];
                responses[k] = responses[k] + between * wanted[j];
                k += 1;
            }
            decoupled = decoupled + self.responses[j] * wanted[j];
            coupled = coupled + responses[j] * wanted[j];
            j += 1;
        }
        // Where points hardly resist together rounding would have the say.
        let part = T::select(zero.lt(coupled), (decoupled / coupled).min(T::splat(P as f64)), zero);
        let (mut impulses, mut means) = (wanted, *speeds);
        j = 0;
        while j < P {
            let change = responses[j] * part;
            impulses[j] = wanted[j] * part;
            means[j] = speeds[j] + change * half;
            speeds[j] = speeds[j] + change;
            j += 1;
        }
        (impulses, means)
    }
}

/// In how many substeps after each other an impact may be given: it is over when what comes has
/// come as near as it may. What is as fast for longer is pressed.
const LONGEST: f64 = 2.0;

/// In how many substeps up to this one a contact has had an impact, from that up to the last one,
/// and from whether it `begins` in one of the two passes of this one. What the first notes for the
/// second is below zero.
#[inline(always)]
pub(crate) fn record_impact<T: Tile>(noted: T, begins: T, is_first_pass: bool) -> T {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    if is_first_pass {
        return T::select(zero.lt(begins), zero - noted - one, noted);
    }
    let begins = T::select(noted.lt(zero), one, begins);
    let count = T::select(noted.lt(zero), zero - noted, noted + one);
    let may_be = T::select(count.lt(T::splat(LONGEST + 0.5)), begins, zero);
    T::select(zero.lt(may_be), count, zero)
}
