//! Face contacts of two boxes: the incident face clipped against the reference face.

use tumble_math::lane::{Lane, Vec3};

use super::Pair;
use super::edges::{of_three, vector_of_three};
use super::reduction::{Candidate, choose};
use crate::lanes::{FAR, ManifoldLanes, sign};

/// A face of one box, and the face of the other that looks against it, in the plane of the first:
/// along its edges u and v, and above it.
struct Facing<L> {
    /// Half the lengths of the reference face.
    half: [L; 2],
    /// The middle of the incident face, and the ways from there to the middles of two of its edges.
    middle: Vec3<L>,
    p: Vec3<L>,
    q: Vec3<L>,
}

/// Candidates: where edges of the incident face begin within the reference face, where they leave
/// it, and corners of it under the incident face.
const CANDIDATES: usize = 12;
/// Nearer to zero than this \[m\] an edge does not go along an axis.
const MIN_WAY: f64 = 1e-12;
/// By how much a face is wider when it is asked whether a corner of the other is within it: one
/// that lies on its edge is, however that is rounded, or boxes that are stacked flush would lose
/// corners.
const WIDER: f64 = 1.0 + 4e-6;

/// The contact of the face with a code from 0 to 5 with the other box.
#[inline(always)]
pub(super) fn contact<L: Lane>(pair: &Pair<L>, code: L, margin: L) -> ManifoldLanes<L> {
    let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
    let first = code.lt(L::splat(2.5));
    let i = L::select(first, code, code - L::splat(3.0));
    let ([a, b], [h, k]) = (&pair.axes, &pair.half);
    let (reference, incident) = (choose_axes(first, a, b), choose_axes(first, b, a));
    let (of_reference, of_incident) = (choose_halves(first, h, k), choose_halves(first, k, h));
    let from_reference = Vec3::select(first, pair.apart, Vec3::zero() - pair.apart);

    let outward = vector_of_three(reference, i);
    let side = sign(outward.dot(from_reference));
    let n = outward * side;
    let (u, v) = (vector_of_three(turned(reference), i), vector_of_three(turned(turned(reference)), i));
    let width = of_three(turned(of_reference), i);
    let depth = of_three(turned(turned(of_reference)), i);

    let along = [n.dot(incident[0]), n.dot(incident[1]), n.dot(incident[2])];
    let j = largest(along);
    let facing = -sign(of_three(along, j));
    let middle = from_reference + vector_of_three(incident, j) * (of_three(of_incident, j) * facing)
        - n * of_three(of_reference, i);
    let p = vector_of_three(turned(incident), j) * of_three(turned(of_incident), j);
    let q = vector_of_three(turned(turned(incident)), j) * of_three(turned(turned(of_incident)), j);

    let in_plane = Facing {
        half: [width, depth],
        middle: Vec3::new(u.dot(middle), v.dot(middle), n.dot(middle)),
        p: Vec3::new(u.dot(p), v.dot(p), n.dot(p)),
        q: Vec3::new(u.dot(q), v.dot(q), n.dot(q)),
    };
    let chosen = choose(in_plane.candidates(margin), margin, in_plane.size(), in_plane.shared_middle());

    // Which faces meet: of which box, which axis, which side.
    let which = L::select(first, zero, one) + i * L::splat(2.0) + L::select(side.lt(zero), L::splat(6.0), zero);
    let faces = (which * L::splat(6.0) + j * L::splat(2.0) + L::select(facing.lt(zero), one, zero)) * L::splat(64.0);
    // The reference face's middle, from the second centre.
    let face = n * of_three(of_reference, i) - Vec3::select(first, pair.apart, Vec3::zero());
    let mut places = [face; 4];
    let mut features = [faces; 4];
    let mut separations = [zero; 4];
    let (mut carried, mut count) = (zero, zero);
    let mut index = 0;
    while index < 4 {
        let point = &chosen[index];
        places[index] = face + u * point.at.x + v * point.at.y + n * (point.at.z * half);
        separations[index] = point.at.z;
        features[index] = faces + point.feature;
        let there = point.at.z.lt(L::splat(FAR * 0.5));
        count = count + L::select(there, one, zero);
        carried = carried + L::select(there, point.carried, zero);
        index += 1;
    }
    let carried = carried / count.max(one);
    ManifoldLanes {
        normal: n * L::select(first, one, -one),
        carried: L::select(first, carried, one - carried),
        count,
        places,
        separations,
        features,
    }
}

impl<L: Lane> Facing<L> {
    /// Square of half the diagonal of the smaller face.
    #[inline(always)]
    fn size(&self) -> L {
        let reference = self.half[0] * self.half[0] + self.half[1] * self.half[1];
        reference.min(self.p.dot(self.p) + self.q.dot(self.q))
    }

    /// The middle of what the bounds of both faces along u and v have in common.
    #[inline(always)]
    fn shared_middle(&self) -> [L; 2] {
        [
            middle_of_shared(self.middle.x, self.p.x.abs() + self.q.x.abs(), self.half[0]),
            middle_of_shared(self.middle.y, self.p.y.abs() + self.q.y.abs(), self.half[1]),
        ]
    }

    /// All corners of what is left of the incident face when it is cut to the reference face. Those
    /// that are further than the margin, or are none, are far away.
    #[inline(always)]
    fn candidates(&self, margin: L) -> [Candidate<L>; CANDIDATES] {
        let mut candidates = [Candidate::nowhere(); CANDIDATES];
        let two = L::splat(2.0);
        let (p, q, none) = (self.p, self.q, Vec3::zero());
        let mut edge = 0;
        while edge < 4 {
            // Around the face: from each corner along the edge to the next.
            let (from, way) = match edge {
                0 => (none - p - q, p * two),
                1 => (p - q, q * two),
                2 => (p + q, none - p * two),
                _ => (q - p, none - q * two),
            };
            let [begin, end] = self.cut(self.middle + from, way, edge);
            candidates[edge] = begin.within(margin, edge);
            candidates[4 + edge] = end.within(margin, 4 + edge);
            edge += 1;
        }
        let mut corner = 0;
        while corner < 4 {
            candidates[8 + corner] = self.under(corner).within(margin, 8 + corner);
            corner += 1;
        }
        candidates
    }

    /// Where an edge of the incident face begins within the reference face, and where it leaves it
    /// before its end.
    #[inline(always)]
    fn cut(&self, from: Vec3<L>, way: Vec3<L>, edge: usize) -> [Candidate<L>; 2] {
        let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
        let [enter_u, leave_u] = slab(from.x, way.x, self.half[0]);
        let [enter_v, leave_v] = slab(from.y, way.y, self.half[1]);
        // Sides of the reference face: which axis, and whether the edge goes along it or against
        // it.
        let (side_u, side_v) =
            (L::select(way.x.lt(zero), one, zero), L::select(way.y.lt(zero), L::splat(3.0), L::splat(2.0)));
        let enter = enter_u.max(enter_v);
        let leave = leave_u.min(leave_v);
        let enters_by = L::select(enter_u.lt(enter_v), side_v, side_u);
        let leaves_by = L::select(leave_v.lt(leave_u), side_v, side_u);
        let inside = enter.max(zero).lt(leave.min(one));
        let number = L::splat(edge as f64);
        let beside_u = from.x.abs() - self.half[0] * L::splat(WIDER);
        let beside_v = from.y.abs() - self.half[1] * L::splat(WIDER);
        let from_corner = beside_u.max(beside_v).lt(zero);
        let crossing = from + way * enter.max(zero);
        let height = L::select(inside, crossing.z, L::splat(FAR));
        let begin = Candidate {
            at: Vec3::select(from_corner, from, Vec3::new(crossing.x, crossing.y, height)),
            carried: L::select(from_corner, one, half),
            index: zero,
            feature: L::select(from_corner, number, L::splat(8.0) + number * L::splat(4.0) + enters_by),
        };
        let end = from + way * leave;
        let leaves = L::select(leave.lt(one), end.z, L::splat(FAR));
        let end = Candidate {
            at: Vec3::new(end.x, end.y, L::select(inside, leaves, L::splat(FAR))),
            carried: half,
            index: zero,
            feature: L::splat(24.0) + number * L::splat(4.0) + leaves_by,
        };
        [begin, end]
    }

    /// A corner of the reference face, where the incident face is above or below it.
    #[inline(always)]
    fn under(&self, corner: usize) -> Candidate<L> {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let (p, q) = (self.p, self.q);
        let x = if corner.is_multiple_of(2) { -self.half[0] } else { self.half[0] };
        let y = if corner < 2 { -self.half[1] } else { self.half[1] };
        let (to_x, to_y) = (x - self.middle.x, y - self.middle.y);
        // The incident face looks at this one, so it is never seen from its edge.
        let inverse = one / (p.x * q.y - p.y * q.x);
        let (a, b) = ((to_x * q.y - to_y * q.x) * inverse, (p.x * to_y - p.y * to_x) * inverse);
        let height = self.middle.z + a * p.z + b * q.z;
        let within = a.abs().max(b.abs()).lt(L::splat(WIDER));
        let height = L::select(within, height, L::splat(FAR));
        Candidate { at: Vec3::new(x, y, height), carried: zero, feature: L::splat(40.0 + corner as f64), index: zero }
    }
}

/// The middle of what two intervals have in common: about `at`, and about zero.
#[inline(always)]
fn middle_of_shared<L: Lane>(at: L, reach: L, width: L) -> L {
    ((at - reach).max(-width) + (at + reach).min(width)) * L::splat(0.5)
}

/// When what is at `from` and goes `way` in a unit of time is within `half` of zero: from when to
/// when.
#[inline(always)]
fn slab<L: Lane>(from: L, way: L, half: L) -> [L; 2] {
    let far = L::splat(FAR);
    let inverse = L::splat(1.0) / way;
    let (a, b) = ((-half - from) * inverse, (half - from) * inverse);
    let stays = way.abs().lt(L::splat(MIN_WAY));
    let inside = L::select(half.lt(from.abs()), far, -far);
    [L::select(stays, inside, a.min(b)), L::select(stays, far, a.max(b))]
}

/// Which of three is largest without its sign: the incident face is the one that looks most against
/// the normal.
#[inline(always)]
fn largest<L: Lane>([a, b, c]: [L; 3]) -> L {
    let second = L::select(a.abs().lt(b.abs()), L::splat(1.0), L::splat(0.0));
    L::select(a.abs().max(b.abs()).lt(c.abs()), L::splat(2.0), second)
}

/// The second, the third and the first of three.
#[inline(always)]
fn turned<T: Copy>([a, b, c]: [T; 3]) -> [T; 3] {
    [b, c, a]
}

#[inline(always)]
fn choose_axes<L: Lane>(mask: L::Mask, a: &[Vec3<L>; 3], b: &[Vec3<L>; 3]) -> [Vec3<L>; 3] {
    [Vec3::select(mask, a[0], b[0]), Vec3::select(mask, a[1], b[1]), Vec3::select(mask, a[2], b[2])]
}

#[inline(always)]
fn choose_halves<L: Lane>(mask: L::Mask, a: &[L; 3], b: &[L; 3]) -> [L; 3] {
    [L::select(mask, a[0], b[0]), L::select(mask, a[1], b[1]), L::select(mask, a[2], b[2])]
}
