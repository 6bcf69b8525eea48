//! Out of what a character overlaps.

use tumble::math::{Real, Vec3};

use crate::motion::{Hit, Motion, REACH};
use crate::slide::Plane;
use crate::surroundings::Body;

/// How many bodies it is pushed out of in a step.
const MAX_PUSHES: usize = 8;
/// How deep it may be in a loose body until it goes out of its way, in skins: less is left to the
/// contact of both.
const WEDGED: Real = 0.5;

impl Motion<'_> {
    /// Whether its collider overlaps what a cast has met, and does not only touch it.
    pub(super) fn is_inside(&self, hit: &Hit) -> bool {
        hit.distance <= 0.0 && self.depth(hit) > -0.1 * self.skin()
    }

    /// Pushes it out of what it overlaps, as far as it may go in a step. What it cannot get out of
    /// does not stop it for the rest of the step, but holds it from going further in. Returns
    /// whether it could do anything.
    pub(super) fn push_out(&mut self) -> bool {
        let (up, skin) = (self.up(), self.skin());
        let mut left = self.settings.max_push_out_speed * self.around.dt;
        let mut has_changed = false;
        if !self.has_been_pushed_out {
            self.has_been_pushed_out = true;
            for _ in 0..MAX_PUSHES {
                let Some(hit) = self.cast(self.position, -up * (0.01 * skin)) else { return true };
                if !self.is_inside(&hit) {
                    return true;
                }
                let is_dynamic = matches!(self.around.body(hit.entity), Body::Dynamic(_));
                let gives_way = is_dynamic && self.depth(&hit) < WEDGED * skin;
                let moved = if gives_way { 0.0 } else { self.leave(&hit, left) };
                left -= moved;
                has_changed |= moved > 0.0;
                if self.depth(&hit) > -0.5 * skin {
                    self.hold(&hit, is_dynamic);
                    has_changed = true;
                }
            }
        }
        // Whatever else there is does not stop it.
        for _ in 0..MAX_PUSHES {
            let Some(hit) = self.cast(self.position, -up * (0.01 * skin)).filter(|hit| self.is_inside(hit)) else {
                break;
            };
            self.hold(&hit, false);
            has_changed = true;
        }
        has_changed
    }

    /// Goes along the normal of what it overlaps until it is the skin away, or as far along what is
    /// in the way of that. Returns how far it has gone.
    fn leave(&mut self, hit: &Hit, most: Real) -> Real {
        let share = if self.around.is_character(hit.entity) { 0.5 } else { 1.0 };
        let wanted = ((self.depth(hit) + self.skin()) * share).max(0.0);
        self.ignored.push(hit.entity);
        let (first, stop) = self.go_out(hit.normal, wanted.min(most));
        let mut gone = first;
        let missing = wanted - first;
        let mut is_stopped = stop.is_some();
        if let Some(stop) = stop
            && missing > 0.0
        {
            let along = hit.normal - stop * hit.normal.dot(stop);
            let rate = along.dot(hit.normal);
            if rate > 0.05 {
                let length = along.length();
                let wanted = (missing * length / rate).min(most - first);
                let (second, stop) = self.go_out(along / length, wanted);
                (gone, is_stopped) = (first + second, stop.is_some());
            }
        }
        self.ignored.pop();
        self.state.is_crushed |= is_stopped && gone < 0.5 * wanted.min(most);
        gone
    }

    /// Goes a way of unit length as far as there is room: how far, and the normal of what stops it.
    fn go_out(&mut self, direction: Vec3, length: Real) -> (Real, Option<Vec3>) {
        let hit = self.cast(self.position, direction * (length + REACH * self.skin()));
        let hit = hit.filter(|hit| hit.distance > 0.0 || hit.normal.dot(direction) < -0.1);
        let free = match &hit {
            Some(hit) if hit.distance > 0.0 => self.free_way(hit, direction, length),
            Some(_) => 0.0,
            None => length,
        };
        self.position += direction * free;
        (free, hit.filter(|_| free < length).map(|hit| hit.normal))
    }

    fn hold(&mut self, hit: &Hit, is_dynamic: bool) {
        self.touch(hit);
        let speed = if is_dynamic { 0.0 } else { self.velocity_of(hit).dot(hit.normal) };
        self.held_by.push(Plane { normal: hit.normal, speed });
        self.ignored.push(hit.entity);
    }
}
