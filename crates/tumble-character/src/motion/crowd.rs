//! The room that characters share where they go far in a step.

use tumble::hecs::Entity;
use tumble::math::{Real, Vec3};

use crate::motion::Motion;
use crate::surroundings::Other;
use crate::vectors::unit;

/// Shorter ways than this, in radii, are looked after by what is met on the way.
const LONG_WAY: Real = 0.25;

impl Motion<'_> {
    /// Takes back what goes over the middle between it and another that may come as far: whatever
    /// the ways of both are, they do not meet. Without room for that it stays where it was.
    pub(super) fn keep_to_own_side(&mut self) {
        let length = (self.position - self.start).length();
        if !self.around.has_several || length < LONG_WAY * self.settings.radius {
            return;
        }
        let others = self.others_within(2.0 * length);
        // Twice: out of the way of one it may have come nearer to another.
        for other in others.iter().chain(&others) {
            if let Some(back) = self.way_back(other) {
                self.shift(back, &[]);
            }
        }
        let is_over = |back: Vec3| back.length() > self.skin();
        if others.iter().filter_map(|other| self.way_back(other)).any(is_over) {
            self.position = self.start;
        }
    }

    /// The way back to its own side, if it has left it and the other may come there.
    fn way_back(&self, other: &Other) -> Option<Vec3> {
        let (own, theirs) = nearest(self.spine(self.start), other.spine);
        let towards = unit(theirs - own)?;
        let round = self.settings.radius + other.radius;
        let room = ((theirs - own).length() - round).max(0.0);
        let excess = (self.position - self.start).dot(towards) - 0.5 * room;
        let (own, theirs) = nearest(self.spine(self.position), other.spine);
        (excess > 0.0 && (theirs - own).length() < round + other.reach).then(|| towards * -excess)
    }

    fn others_within(&self, distance: Real) -> Vec<Other> {
        let half = self.height() * 0.5;
        let middle = self.start + self.up() * half;
        let size = Vec3::splat(half + distance);
        let filter = self.filter().without_fixed().without_dynamic();
        let near: Vec<Entity> = self.around.queries.in_box(middle - size, middle + size, &filter);
        near.into_iter().filter_map(|entity| self.around.other(entity)).collect()
    }

    fn spine(&self, position: Vec3) -> [Vec3; 2] {
        self.settings.spine(position, self.state.is_crouching)
    }
}

/// The points where two segments are nearest: exact where they are parallel, as most are.
fn nearest(first: [Vec3; 2], second: [Vec3; 2]) -> (Vec3, Vec3) {
    let mut own = first[0];
    let mut theirs = on_segment(second, own);
    for _ in 0..4 {
        own = on_segment(first, theirs);
        theirs = on_segment(second, own);
    }
    (own, theirs)
}

fn on_segment([from, to]: [Vec3; 2], point: Vec3) -> Vec3 {
    let way = to - from;
    let part = (point - from).dot(way) / way.length_squared().max(Real::MIN_POSITIVE);
    from + way * part.clamp(0.0, 1.0)
}
