//! Where the flat pieces of two shapes lie over one another, seen along the normal: the points of a
//! contact.

use tumble_math::lane::Vec3;

use crate::feature::{Corner, Feature, MAX_CORNERS};
use crate::manifold::{ContactPoint, Manifold, Points};
use crate::manifold_reduction::{Cut, at_most_extent, keep_nearest, pressed, reduce};
use crate::scalar::Scalar;

/// Two pieces along the normal between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceClipping<R> {
    /// Unit vector from the first shape to the second.
    pub(crate) normal: Vec3<R>,
    /// Of the shapes along it \[m\].
    pub(crate) separation: R,
    /// Thickness of the layers around both \[m\].
    pub(crate) layers: [R; 2],
    /// Points further apart than this are left out \[m\].
    pub(crate) margin: R,
}

/// The most points that two polygons can have in common, each with as many corners as there can be.
const MAX: usize = 2 * MAX_CORNERS;
/// A face seen at a smaller cosine is an edge.
const EDGE_ON: f64 = 0.05;
/// Edges at a smaller sine of the angle between them are parallel, and touch along their length.
const PARALLEL: f64 = 0.01;
/// A point found here is as near as any if it is within this part of the margin, or of the points'
/// extent, of the least separation there is.
pub(crate) const AS_NEAR: f64 = 0.005;
/// A point no further than this \[m\] beyond a side is on it: between two faces there is no gap.
pub(crate) const ON_THE_SIDE: f64 = 1e-9;
/// What belongs to the piece that cuts has this bit.
const CUTTING: u32 = 1 << 14;
const ID: u32 = CUTTING - 1;
/// An end of what two edges have in common has this bit,
const END: u32 = 1 << 30;
/// and what is left of the first this one.
const OF_FIRST: u32 = 1 << 31;

/// A point that both have, on the inner surface of the piece that was cut, and its height above the
/// one that cuts.
#[derive(Clone, Copy)]
struct Shared<R> {
    at: Vec3<R>,
    height: R,
    feature: u32,
    /// How far it goes with the piece that was cut.
    carried: R,
}

/// A corner of what is left of a polygon, and which edge goes on from it.
#[derive(Clone, Copy)]
struct Left<R> {
    at: Vec3<R>,
    edge: u32,
}

/// Up to `M` of something.
pub(crate) struct List<T, const M: usize> {
    items: [T; M],
    len: usize,
}

impl<T: Copy, const M: usize> List<T, M> {
    fn of(nothing: T) -> Self {
        Self { items: [nothing; M], len: 0 }
    }

    pub(crate) fn push(&mut self, item: T) {
        if let Some(slot) = self.items.get_mut(self.len) {
            *slot = item;
            self.len += 1;
        }
    }

    pub(crate) fn items(&self) -> &[T] {
        self.items.get(..self.len).unwrap_or_default()
    }
}

impl<R: Scalar> FaceClipping<R> {
    /// The points that both pieces have in common and, where none of them is as near as the shapes
    /// are, the given one, halfway between the surfaces. What reaches furthest along the normal may
    /// be beside both pieces, by which it is up to `lead` less than how far they are apart. The
    /// middles are those of the shapes.
    pub(crate) fn manifold(
        &self,
        first: &Feature<R>,
        second: &Feature<R>,
        nearest: Vec3<R>,
        lead: R,
        middles: [Vec3<R>; 2],
    ) -> Manifold<R> {
        self.manifold_of::<MAX_CORNERS, MAX_CORNERS, MAX>(first, second, nearest, lead, middles)
    }

    /// The same of pieces with fewer corners, which have up to `M` points in common.
    pub(crate) fn manifold_of<const N: usize, const K: usize, const M: usize>(
        &self,
        first: &Feature<R, N>,
        second: &Feature<R, K>,
        nearest: Vec3<R>,
        lead: R,
        middles: [Vec3<R>; 2],
    ) -> Manifold<R> {
        let (mut candidates, carried) = self.shared::<N, K, M>(first, second);
        let small = at_most_extent(self.margin, candidates.items());
        let near = self.separation + lead + small * R::splat(AS_NEAR) + pressed(self.separation, self.margin);
        if !candidates.items().iter().any(|point| point.separation <= near) && self.separation <= self.margin {
            candidates.push(ContactPoint { position: nearest, separation: self.separation, feature: u32::MAX });
        }
        let candidates = candidates.items();
        let mut points = match candidates {
            [] => Points::none(),
            [first, ..] => {
                let cut = if first.feature & OF_FIRST == 0 { Cut::Second } else { Cut::First };
                reduce(candidates, cut, self.normal, self.margin, &middles)
            }
        };
        keep_nearest(&mut points, candidates, near, self.normal);
        Manifold::new(self.normal, carried, points)
    }

    /// The points that both pieces have in common, up to `M`, and how far they go with the second.
    pub(crate) fn shared<const N: usize, const K: usize, const M: usize>(
        &self,
        first: &Feature<R, N>,
        second: &Feature<R, K>,
    ) -> (List<ContactPoint<R>, M>, R) {
        let nothing = ContactPoint { position: Vec3::zero(), separation: R::splat(0.0), feature: 0 };
        let mut found = List::of(nothing);
        let (one, half) = (R::splat(1.0), R::splat(0.5));
        let is_face =
            |corners: usize, normal: Vec3<R>| corners > 2 && self.normal.dot(normal).abs() > R::splat(EDGE_ON);
        let [layer_1, layer_2] = self.layers;
        let mut carried = (R::splat(0.0), R::splat(0.0));
        let mut take = |shared: &Shared<R>, cut_is_first: bool, cut_layer: R, cutting_layer: R, outwards: Vec3<R>| {
            let separation = shared.height - (layer_1 + layer_2);
            if separation <= self.margin {
                let down = (shared.height + cut_layer - cutting_layer) * half;
                found.push(ContactPoint {
                    position: shared.at - outwards * down,
                    separation,
                    feature: if cut_is_first { shared.feature | OF_FIRST } else { shared.feature },
                });
                let with_second = if cut_is_first { one - shared.carried } else { shared.carried };
                carried = (carried.0 + with_second, carried.1 + one);
            }
        };
        if is_face(first.corners().len(), first.normal) {
            cut::<R, K, N, M>(second, first, self.normal, &mut |shared| {
                take(shared, false, layer_2, layer_1, self.normal);
            });
        } else if is_face(second.corners().len(), second.normal) {
            cut::<R, N, K, M>(first, second, self.normal * -one, &mut |shared| {
                take(shared, true, layer_1, layer_2, self.normal * -one);
            });
        } else if let ([a, b], [c, d]) = (first.corners(), second.corners()) {
            for shared in self.along([*a, *b], [*c, *d]).items() {
                take(shared, false, layer_2, layer_1, self.normal);
            }
        }
        let (sum, count) = carried;
        (found, if count > R::splat(0.0) { sum / count } else { half })
    }

    /// Whether two edges, seen along the normal, are parallel.
    pub(crate) fn are_parallel(&self, first: Vec3<R>, second: Vec3<R>) -> bool {
        let (e, f) = (self.flat(first), self.flat(second));
        let (whole, other, across) = (e.dot(e), f.dot(f), e.cross(f));
        let zero = R::splat(0.0);
        across.dot(across) <= whole * other * R::splat(PARALLEL * PARALLEL) && whole > zero && other > zero
    }

    /// A vector without what is along the normal.
    fn flat(&self, v: Vec3<R>) -> Vec3<R> {
        v - self.normal * self.normal.dot(v)
    }

    /// The ends of what two parallel edges have in common, on the second.
    fn along(&self, [a, b]: [Corner<R>; 2], [c, d]: [Corner<R>; 2]) -> List<Shared<R>, 2> {
        let (zero, one, n) = (R::splat(0.0), R::splat(1.0), self.normal);
        let mut found = List::of(Shared { at: Vec3::zero(), height: zero, feature: 0, carried: R::splat(0.5) });
        if !self.are_parallel(b.at - a.at, d.at - c.at) {
            return found;
        }
        let e = self.flat(b.at - a.at);
        let whole = e.dot(e);
        // Places along the first, from 0 to 1, of the second's ends.
        let place = |corner: Corner<R>| e.dot(corner.at - a.at) / whole;
        let (from, to) = (place(c), place(d));
        let clamp = |t: R| t.max(zero).min(one);
        let (low, high) = (clamp(from.min(to)), clamp(from.max(to)));
        let rounded = self.layers[0] > zero && self.layers[1] > zero;
        for (end, t) in [low, high].into_iter().enumerate() {
            let on_second = ((t - from) / (to - from)).max(zero).min(one);
            let (p, q) = (a.at + (b.at - a.at) * t, c.at + (d.at - c.at) * on_second);
            let apart = q - p;
            let along = n.dot(apart);
            // Round ones are apart by their distance, even where one is not quite above the other.
            let height = if rounded && along > zero { apart.dot(apart).sqrt() } else { along };
            let middle = q - self.flat(apart) * R::splat(0.5);
            found.push(Shared { at: middle, height, feature: end as u32 | END, carried: R::splat(0.5) });
            if low >= high {
                break;
            }
        }
        found
    }
}

/// Whether a point found in an overlay is a corner of the second piece over the first, a face.
pub(crate) fn is_corner_of_second(feature: u32) -> bool {
    feature & (OF_FIRST | END | CUTTING << 15 | CUTTING) == 0
}

/// What is as near as any of these points.
pub(crate) fn as_near<R: Scalar>(candidates: &[ContactPoint<R>], margin: R) -> R {
    let least = candidates.iter().fold(margin, |least, point| least.min(point.separation));
    least + at_most_extent(margin, candidates) * R::splat(AS_NEAR) + pressed(least, margin)
}

/// Finds what is left of a piece inside the sides of a face, seen along `outwards`, which looks out
/// of the face. Heights are along it above the face.
fn cut<R: Scalar, const N: usize, const K: usize, const M: usize>(
    piece: &Feature<R, N>,
    face: &Feature<R, K>,
    outwards: Vec3<R>,
    found: &mut impl FnMut(&Shared<R>),
) {
    let (zero, half, one) = (R::splat(0.0), R::splat(0.5), R::splat(1.0));
    let Some(on_face) = face.corners().first() else { return };
    let steep = one / face.normal.dot(outwards);
    let height = |at: Vec3<R>| face.normal.dot(at - on_face.at) * steep;
    let mut share = |at: Vec3<R>, [before, after]: [u32; 2]| {
        let of_piece = |edge: u32| if edge & CUTTING == 0 { half } else { zero };
        let carried = of_piece(before) + of_piece(after);
        found(&Shared { at, height: height(at), feature: before << 15 | after, carried });
    };
    match piece.corners() {
        [] => {}
        [only] => {
            if sides(face, outwards)
                .all(|(_, out, from)| out.dot(only.at - from) <= out.dot(out).sqrt() * R::splat(ON_THE_SIDE))
            {
                share(only.at, [only.id & ID; 2]);
            }
        }
        [from, to] => cut_line([*from, *to], face, outwards, &mut share),
        corners => {
            let nothing = Left { at: Vec3::zero(), edge: 0 };
            let (mut polygon, mut cut): (&mut List<_, M>, &mut List<_, M>) =
                (&mut List::of(nothing), &mut List::of(nothing));
            corners.iter().for_each(|corner| polygon.push(Left { at: corner.at, edge: corner.id & ID }));
            for (id, out, from) in sides(face, outwards) {
                if clip(polygon, cut, CUTTING | id, |at| out.dot(at - from)) {
                    std::mem::swap(&mut polygon, &mut cut);
                }
            }
            let left = polygon.items();
            for (index, corner) in left.iter().enumerate() {
                let before = left[if index == 0 { left.len() - 1 } else { index - 1 }];
                share(corner.at, [before.edge, corner.edge]);
            }
        }
    }
}

/// Of each side of a face: the number of its first corner, a vector out of the face across it, and
/// that corner.
fn sides<R: Scalar, const K: usize>(
    face: &Feature<R, K>,
    outwards: Vec3<R>,
) -> impl Iterator<Item = (u32, Vec3<R>, Vec3<R>)> {
    let corners = face.corners();
    // Along a vector that looks against the face's normal its corners run the other way.
    let towards = if face.normal.dot(outwards) < R::splat(0.0) { outwards * -R::splat(1.0) } else { outwards };
    corners.iter().enumerate().map(move |(index, corner)| {
        let next = corners[(index + 1) % corners.len()];
        (corner.id & ID, (next.at - corner.at).cross(towards), corner.at)
    })
}

/// What is left of a line.
fn cut_line<R: Scalar, const K: usize>(
    [a, b]: [Corner<R>; 2],
    face: &Feature<R, K>,
    outwards: Vec3<R>,
    share: &mut impl FnMut(Vec3<R>, [u32; 2]),
) {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let (mut from, mut to) = ((zero, a.id & ID), (one, b.id & ID));
    for (id, out, corner) in sides(face, outwards) {
        let (at_a, at_b) = (out.dot(a.at - corner), out.dot(b.at - corner));
        if at_a > zero && at_b > zero {
            return;
        }
        if at_a > zero || at_b > zero {
            let t = at_a / (at_a - at_b);
            if at_a > zero && t > from.0 {
                from = (t, CUTTING | id);
            } else if at_b > zero && t < to.0 {
                to = (t, CUTTING | id);
            }
        }
    }
    if from.0 <= to.0 {
        for ((t, id), end) in [(from, a.id), (to, b.id)] {
            share(a.at + (b.at - a.at) * t, [end & ID, id]);
        }
    }
}

/// Whether any of a polygon is where `beyond` is positive; then `left` is what of it is not. The
/// side that cuts is called `edge`.
fn clip<R: Scalar, const M: usize>(
    polygon: &List<Left<R>, M>,
    left: &mut List<Left<R>, M>,
    edge: u32,
    beyond: impl Fn(Vec3<R>) -> R,
) -> bool {
    let (zero, corners) = (R::splat(0.0), polygon.items());
    let mut heights = [zero; M];
    heights.iter_mut().zip(corners).for_each(|(height, corner)| *height = beyond(corner.at));
    let heights = &heights[..corners.len()];
    if heights.iter().all(|height| *height <= zero) {
        return false;
    }
    left.len = 0;
    if !heights.iter().any(|height| *height <= zero) {
        return true;
    }
    let mut last = corners.len() - 1;
    for (index, corner) in corners.iter().enumerate() {
        let (before, from, to) = (corners[last], heights[last], heights[index]);
        if (from <= zero) != (to <= zero) {
            let at = before.at + (corner.at - before.at) * (from / (from - to));
            // Going out, it goes on along what cuts; coming in, along the edge it was on.
            left.push(Left { at, edge: if from <= zero { edge } else { before.edge } });
        }
        if to <= zero {
            left.push(*corner);
        }
        last = index;
    }
    true
}
