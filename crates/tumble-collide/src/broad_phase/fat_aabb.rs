//! The boxes that are larger than what is in them, so that it does not leave them at each step.

use tumble_math::lane::Vec3;

use super::Proxy;
use crate::aabb::Aabb;
use crate::scalar::Scalar;

/// By how much a box is larger to every side, as a part of its mean extent ...
const MARGIN: f64 = 0.125;
/// ... but not by more than this \[m\]. With twice as much a pile of balls of a metre has a quarter
/// more pairs to look at, and is searched in a tenth less time.
const MAX_MARGIN: f64 = 0.025;
/// Where it moves it is larger by the way it makes in this number of steps: without, the search
/// takes half as long again while such a pile falls and comes to rest; with more steps there are
/// more pairs and hardly a gain ...
const STEPS_AHEAD: f64 = 4.0;
/// ... but not by more than this part of its mean extent: what jumps does not go on jumping.
const MAX_AHEAD: f64 = 0.5;

#[derive(Clone, Debug, Default)]
pub(super) struct FatAabbs<R> {
    boxes: Vec<Aabb<R>>,
    /// Where each was when it got its box, and at which step that was.
    since: Vec<(Vec3<R>, u32)>,
    now: u32,
}

impl<R: Scalar> FatAabbs<R> {
    pub(super) fn boxes(&self) -> &[Aabb<R>] {
        &self.boxes
    }

    /// One step later.
    pub(super) fn advance(&mut self) {
        self.now = self.now.wrapping_add(1);
    }

    /// Boxes of objects of which nothing is known. What does not move gets no larger one.
    pub(super) fn begin(&mut self, proxies: &[Proxy<R>]) {
        self.boxes.clear();
        self.since.clear();
        for proxy in proxies {
            let aabb = finite(proxy);
            let margin = if proxy.moves { margin(&aabb) } else { R::splat(0.0) };
            self.boxes.push(grown(&aabb, Vec3::splat(margin), Vec3::splat(margin)));
            self.since.push((aabb.center(), self.now));
        }
    }

    /// Adds those that are no longer in their boxes.
    pub(super) fn find_left(&self, proxies: &[Proxy<R>], left: &mut Vec<u32>) {
        for (object, (proxy, fat_aabb)) in (0..).zip(proxies.iter().zip(&self.boxes)) {
            let Some(aabb) = &proxy.aabb else { continue };
            // What is not finite is in no box, and has an empty one.
            if !fat_aabb.holds(aabb) && (fat_aabb.is_finite() || aabb.is_finite()) {
                left.push(object);
            }
        }
    }

    /// Gives an object a box about where it is now, and where it is going.
    pub(super) fn renew(&mut self, object: u32, proxy: &Proxy<R>) {
        let aabb = finite(proxy);
        let center = aabb.center();
        let (before, step) = std::mem::replace(&mut self.since[object as usize], (center, self.now));
        let margin = margin(&aabb);
        let most = mean_extent(&aabb) * R::splat(MAX_AHEAD);
        let steps = f64::from(self.now.wrapping_sub(step).max(1));
        let way = (center - before) * R::splat(STEPS_AHEAD / steps);
        // No way, where that is not a number: the larger of it and nothing is nothing.
        let ahead = |way: R| (margin + way.max(R::splat(0.0)).min(most), margin + (-way).max(R::splat(0.0)).min(most));
        let (x, y, z) = (ahead(way.x), ahead(way.y), ahead(way.z));
        self.boxes[object as usize] = grown(&aabb, Vec3::new(x.1, y.1, z.1), Vec3::new(x.0, y.0, z.0));
    }
}

/// The box of an object; an empty one if it is not finite.
fn finite<R: Scalar>(proxy: &Proxy<R>) -> Aabb<R> {
    proxy.aabb.filter(Aabb::is_finite).unwrap_or_else(Aabb::empty)
}

fn mean_extent<R: Scalar>(aabb: &Aabb<R>) -> R {
    let extent = aabb.high - aabb.low;
    (extent.x + extent.y + extent.z) * R::splat(1.0 / 3.0)
}

fn margin<R: Scalar>(aabb: &Aabb<R>) -> R {
    (mean_extent(aabb) * R::splat(MARGIN)).min(R::splat(MAX_MARGIN)).max(R::splat(0.0))
}

fn grown<R: Scalar>(aabb: &Aabb<R>, below: Vec3<R>, above: Vec3<R>) -> Aabb<R> {
    Aabb { low: aabb.low - below, high: aabb.high + above }
}
