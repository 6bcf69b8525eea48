use crate::bounds::Bounds;
use crate::scalar::Scalar;

/// Finds which of many boxes meet, by going through them in the order of where they begin along x.
///
/// ```
/// use tumble_collide::{Bounds, BroadPhase};
/// use tumble_math::lane::Vec3;
///
/// let unit = |x: f64| Some(Bounds::about(Vec3::new(x, 0.0, 0.0), Vec3::splat(0.5)));
/// let mut pairs = Vec::new();
/// BroadPhase::default().pairs([unit(3.2), unit(0.0), unit(2.5), unit(0.9), None], |_, _| true, &mut pairs);
/// assert_eq!(pairs, [(0, 2), (1, 3)]);
/// ```
#[derive(Clone, Debug)]
pub struct BroadPhase<R> {
    boxes: Vec<(Bounds<R>, u32)>,
}

impl<R> Default for BroadPhase<R> {
    fn default() -> Self {
        Self { boxes: Vec::new() }
    }
}

impl<R: Scalar> BroadPhase<R> {
    /// Fills `pairs` with the indices of those boxes that meet, the lower first, in order. What has no box meets nothing, and pairs that are
    /// not `wanted` are left out.
    pub fn pairs(
        &mut self,
        boxes: impl IntoIterator<Item = Option<Bounds<R>>>,
        wanted: impl Fn(u32, u32) -> bool,
        pairs: &mut Vec<(u32, u32)>,
    ) {
        self.boxes.clear();
        self.boxes.extend(boxes.into_iter().zip(0..).filter_map(|(bounds, index)| Some((bounds?, index))));
        // Only what is finite can be put in order.
        self.boxes.retain(|(bounds, _)| bounds.low.x <= bounds.high.x);
        self.boxes.sort_unstable_by(|(a, i), (b, j)| {
            a.low.x.partial_cmp(&b.low.x).unwrap_or(std::cmp::Ordering::Equal).then(i.cmp(j))
        });
        pairs.clear();
        for (place, (bounds, index)) in self.boxes.iter().enumerate() {
            for (other, other_index) in &self.boxes[place + 1..] {
                if other.low.x > bounds.high.x {
                    break;
                }
                let pair = (*index.min(other_index), *index.max(other_index));
                if bounds.meets(other) && wanted(pair.0, pair.1) {
                    pairs.push(pair);
                }
            }
        }
        pairs.sort_unstable();
    }
}
