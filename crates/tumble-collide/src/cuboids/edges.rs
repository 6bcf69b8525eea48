//! Edge-edge contacts of two boxes: the nine cross-product axes, and the closest points.

use tumble_math::lane::{Lane, Vec3};

use super::{MIN_SINE, Pair};
use crate::lanes::{FAR, ManifoldLanes, sign};

/// A negative gap stays below a bar whatever rounding does to it where it is below when multiplied
/// by this.
const NEARER: f64 = 1.0 - 1e-5;

/// How far the common perpendicular of an edge of each separates the boxes at most, and which
/// edges: `3 i + j`. Among edges the best has to be taken: the nearest points of others may be past
/// their ends. Where all are below zero and below `bar`, a gap below both.
#[inline(always)]
pub(super) fn widest_gap<L: Lane>(pair: &Pair<L>, bar: L) -> (L, L) {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let ([h, k], along, c, d) = (pair.half, pair.along[0], &pair.cosines, &pair.absolute);
    let (mut squares, mut gaps, mut most) = ([one; 9], [zero; 9], L::splat(-FAR));
    let mut index = 0;
    while index < 9 {
        let (i, j) = (index / 3, index % 3);
        let ([i1, i2], [j1, j2]) = (others(i), others(j));
        // Of a_i x b_j along the axes of the first box.
        let square = c[i1][j] * c[i1][j] + c[i2][j] * c[i2][j];
        let distance = (c[i1][j] * along[i2] - c[i2][j] * along[i1]).abs();
        let reach = (h[i2] * d[i1][j] + h[i1] * d[i2][j]) + (k[j1] * d[i][j2] + k[j2] * d[i][j1]);
        squares[index] = square;
        gaps[index] = L::select(square.lt(L::splat(MIN_SINE * MIN_SINE)), L::splat(-FAR), distance - reach);
        most = most.max(gaps[index]);
        index += 1;
    }
    let (mut best, mut code) = (L::splat(-FAR), zero);
    // A sine is at most one, so what is negative is more so when divided by it.
    if L::all((most * L::splat(NEARER)).lt(bar.min(zero))) {
        return (best, code);
    }
    let mut index = 0;
    while index < 9 {
        let gap = gaps[index] * (one / squares[index].sqrt());
        let better = best.lt(gap);
        best = L::select(better, gap, best);
        code = L::select(better, L::splat(index as f64), code);
        index += 1;
    }
    (best, code)
}

/// The two axes after one, in cyclic order.
const fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// One of three, by a number from 0 to 2.
#[inline(always)]
pub(super) fn of_three<L: Lane>(three: [L; 3], which: L) -> L {
    let last = L::select(which.lt(L::splat(1.5)), three[1], three[2]);
    L::select(which.lt(L::splat(0.5)), three[0], last)
}

/// One vector of three, by a number from 0 to 2.
#[inline(always)]
pub(super) fn vector_of_three<L: Lane>(three: [Vec3<L>; 3], which: L) -> Vec3<L> {
    let last = Vec3::select(which.lt(L::splat(1.5)), three[1], three[2]);
    Vec3::select(which.lt(L::splat(0.5)), three[0], last)
}

/// The points of an edge of each where they are nearest to each other: one contact.
#[inline(always)]
pub(super) fn contact<L: Lane>(pair: &Pair<L>, code: L, separation: L) -> ManifoldLanes<L> {
    let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
    let above_one = L::select(code.lt(L::splat(2.5)), zero, one);
    let i = L::select(code.lt(L::splat(5.5)), above_one, L::splat(2.0));
    let j = code - i * L::splat(3.0);
    let (d, e) = (vector_of_three(pair.axes[0], i), vector_of_three(pair.axes[1], j));
    let axis = d.cross(e);
    let normal = axis * (sign(axis.dot(pair.apart)) / axis.dot(axis).sqrt());
    // The edges' middles, seen from the second centre: of the first as far along the normal as it
    // reaches, of the second against it.
    let (mut on_a, mut on_b) = (Vec3::zero() - pair.apart, Vec3::zero());
    let mut corners = zero;
    let mut k = 0;
    while k < 3 {
        let (of_a, of_b) = (sign(normal.dot(pair.axes[0][k])), sign(normal.dot(pair.axes[1][k])));
        let number = L::splat(k as f64);
        let (to_a, to_b) = ((number - i).abs(), (number - j).abs());
        // Nothing along the edge itself.
        let weight_a = L::select(to_a.lt(half), zero, of_a);
        let weight_b = L::select(to_b.lt(half), zero, of_b);
        on_a = on_a + pair.axes[0][k] * (pair.half[0][k] * weight_a);
        on_b = on_b - pair.axes[1][k] * (pair.half[1][k] * weight_b);
        // Digits to the base of three, one for each axis of each box.
        corners = corners * L::splat(9.0) + (weight_a + one) * L::splat(3.0) + (weight_b + one);
        k += 1;
    }
    // The points of the edges on_a + s d and on_b + t e that are nearest to each other. Those of
    // the lines may be past the ends, where corners are near each other and no axis separates more.
    let (half_d, half_e) = (of_three(pair.half[0], i), of_three(pair.half[1], j));
    let (from_a, across) = (on_b - on_a, d.dot(e));
    let (along_d, along_e) = (d.dot(from_a), e.dot(from_a));
    let on_lines = (across * along_d - along_e) / (one - across * across);
    let s = clamp(along_d + across * clamp(on_lines, half_e), half_d);
    let t = clamp(across * s - along_e, half_e);
    let place = (on_a + d * s + on_b + e * t) * half;
    let feature = L::splat(FIRST_FEATURE) + corners * L::splat(9.0) + code;
    ManifoldLanes {
        normal,
        carried: half,
        count: one,
        places: [place; 4],
        separations: [separation; 4],
        features: [feature; 4],
    }
}

/// No further from zero than `most`.
#[inline(always)]
fn clamp<L: Lane>(number: L, most: L) -> L {
    number.max(-most).min(most)
}

/// Past the features of faces.
const FIRST_FEATURE: f64 = 65536.0;

impl<L: Lane> ManifoldLanes<L> {
    /// The least separation of its points.
    #[inline(always)]
    pub(super) fn deepest(&self) -> L {
        let mut least = L::splat(FAR);
        let mut j = 0;
        while j < self.separations.len() {
            let there = L::splat(j as f64).lt(self.count);
            least = L::select(there, least.min(self.separations[j]), least);
            j += 1;
        }
        least
    }

    /// This where the mask holds, else the other.
    #[inline(always)]
    pub(super) fn or(self, mask: L::Mask, other: Self) -> Self {
        let (mut places, mut separations, mut features) = (other.places, other.separations, other.features);
        let mut j = 0;
        while j < places.len() {
            places[j] = Vec3::select(mask, self.places[j], places[j]);
            separations[j] = L::select(mask, self.separations[j], separations[j]);
            features[j] = L::select(mask, self.features[j], features[j]);
            j += 1;
        }
        Self {
            normal: Vec3::select(mask, self.normal, other.normal),
            carried: L::select(mask, self.carried, other.carried),
            count: L::select(mask, self.count, other.count),
            places,
            separations,
            features,
        }
    }
}
