//! An order in which what is near in space is near in the list: eights, then eights of eights, and
//! so on, in boxes that are small.
//!
//! The list is cut in two across the longest side of where its centres are, again and again, always
//! at a multiple of the highest power of eight that there is. With the order of a curve through
//! space (Morton's) in its place, eights reach round its corners, and looking for all pairs of a
//! pile of 5000 balls took two thirds longer.

use std::cmp::Ordering;

use tumble_math::lane::Vec3;

use super::aabb8::LANES;
use crate::aabb::Aabb;
use crate::scalar::Scalar;

/// No object: what is in the lanes that are left over.
pub(crate) const NONE: u32 = u32::MAX;

/// An object on its way to a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item<R> {
    /// How large it is among the others.
    class: i32,
    center: Vec3<R>,
    object: u32,
}

/// Fills `leaves` with the objects; where a leaf is not full, with [`NONE`].
pub(super) fn arrange<R: Scalar>(
    objects: impl Iterator<Item = u32>,
    boxes: &[Aabb<R>],
    items: &mut Vec<Item<R>>,
    leaves: &mut Vec<[u32; LANES]>,
) {
    items.clear();
    items.extend(objects.map(|object| {
        let aabb = &boxes[object as usize];
        let center = if aabb.is_finite() { aabb.center() } else { Vec3::zero() };
        Item { class: magnitude(aabb), center, object }
    }));
    classify(items);
    leaves.clear();
    for class in items.chunk_by_mut(|a, b| a.class == b.class) {
        arrange_leaves(class, leaves.len());
        leaves.extend(class.chunks(LANES).map(|leaf| {
            let mut objects = [NONE; LANES];
            objects.iter_mut().zip(leaf).for_each(|(object, item)| *object = item.object);
            objects
        }));
    }
}

/// The exponent of two of how far it reaches, 0 for what has no extent.
fn magnitude<R: Scalar>(aabb: &Aabb<R>) -> i32 {
    let extent: Vec3<R> = aabb.high - aabb.low;
    let most: f64 = extent.x.max(extent.y).max(extent.z).into();
    if most > 0.0 { (most.to_bits() >> 52 & 0x7ff) as i32 } else { 0 }
}

/// Puts those that are much larger than most in eights of their own, by powers of eight: one of
/// them among small ones makes their box as large as itself.
fn classify<R: Scalar>(items: &mut [Item<R>]) {
    let magnitudes = || items.iter().map(|item| item.class).filter(|class| *class > 0);
    let count = magnitudes().count().max(1) as i64;
    let usual = (magnitudes().map(i64::from).sum::<i64>() / count) as i32;
    let mut several = false;
    for item in &mut *items {
        item.class = ((item.class - usual + 1) / 3).max(0);
        several |= item.class > 0;
    }
    if several {
        items.sort_unstable_by_key(|item| (item.class, item.object));
    }
}

/// Arranges the items that are to be in the leaves from `first` on.
fn arrange_leaves<R: Scalar>(items: &mut [Item<R>], first: usize) {
    let leaves = items.len().div_ceil(LANES);
    if leaves <= 1 {
        items.sort_unstable_by_key(|item| item.object);
        return;
    }
    let middle = cut(first, first + leaves);
    let place = (middle - first) * LANES;
    let ordered = |a: R, b: R| a.partial_cmp(&b).unwrap_or(Ordering::Equal);
    let by_object = |a: &Item<R>, b: &Item<R>| a.object.cmp(&b.object);
    match longest_side(items) {
        0 => items.select_nth_unstable_by(place, |a, b| ordered(a.center.x, b.center.x).then_with(|| by_object(a, b))),
        1 => items.select_nth_unstable_by(place, |a, b| ordered(a.center.y, b.center.y).then_with(|| by_object(a, b))),
        _ => items.select_nth_unstable_by(place, |a, b| ordered(a.center.z, b.center.z).then_with(|| by_object(a, b))),
    };
    let (before, after) = items.split_at_mut(place);
    arrange_leaves(before, first);
    arrange_leaves(after, middle);
}

/// Between `first` and `end`, neither included, the multiple of the highest power of eight that is
/// nearest to the middle.
fn cut(first: usize, end: usize) -> usize {
    let mut step = 1;
    while (first / (LANES * step) + 1) * (LANES * step) < end {
        step *= LANES;
    }
    let least = (first / step + 1) * step;
    let most = (end - 1) / step * step;
    let middle = (first + (end - first) / 2 + step / 2) / step * step;
    middle.clamp(least, most)
}

/// The axis along which the centres are spread most.
fn longest_side<R: Scalar>(items: &[Item<R>]) -> usize {
    let mut spread: Aabb<R> = Aabb::empty();
    for Item { center, .. } in items {
        spread.low = Vec3::new(spread.low.x.min(center.x), spread.low.y.min(center.y), spread.low.z.min(center.z));
        spread.high = Vec3::new(spread.high.x.max(center.x), spread.high.y.max(center.y), spread.high.z.max(center.z));
    }
    let side = spread.high - spread.low;
    if side.x >= side.y && side.x >= side.z {
        0
    } else if side.y >= side.z {
        1
    } else {
        2
    }
}
