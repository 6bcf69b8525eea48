//! The bounds of a row along a free axis: how far it is past them, and how it gets there.

use crate::solver::mechanism::free_axis::wrapped;
use crate::solver::mechanism::free_row::{FreeRow, Mode, Phase};

impl FreeRow {
    /// Whether there is a bound.
    pub(crate) fn is_bounded(&self) -> bool {
        self.bounds[0].is_finite() || self.bounds[1].is_finite()
    }

    /// Whether both bounds are the same, and it has a value.
    pub(super) fn is_held(&self) -> bool {
        self.bounds[0] == self.bounds[1] && !self.value.is_nan()
    }

    pub(crate) fn is_at_bound(&self) -> bool {
        matches!(self.mode, Mode::AtLower | Mode::AtUpper)
    }

    /// How far it is past a bound; negative within.
    pub(crate) fn past(&self, value: f64, upper: bool) -> f64 {
        let [lower_bound, upper_bound] = self.bounds;
        let apart = if upper { value - upper_bound } else { lower_bound - value };
        let is_turn = !self.axis.is_linear() && !self.axis.is_cone();
        if is_turn && lower_bound.is_finite() && upper_bound.is_finite() {
            // From the middle of the range, the shorter way round.
            let middle = 0.5 * (lower_bound + upper_bound);
            let from_middle = wrapped(value - middle);
            let half = 0.5 * (upper_bound - lower_bound);
            return if upper { from_middle - half } else { -from_middle - half };
        }
        apart
    }

    /// The error of a row that is at a bound.
    pub(crate) fn error_at_bound(&self, value: f64) -> f64 {
        if self.mode == Mode::AtUpper { self.past(value, true) } else { -self.past(value, false) }
    }

    /// How far an error is past the bound that the row is at; what has but one place is past it on
    /// either side.
    pub(crate) fn past_bound(&self, error: f64) -> f64 {
        match self.mode {
            _ if self.is_held() => error.abs(),
            Mode::AtLower => -error,
            _ => error,
        }
    }

    /// The error of a distance at a bound, of which this is the part along the row and `wanted` is
    /// to be left: by how much that part is too long if what is across it stays.
    pub(crate) fn error_of_distance(&self, distance: f64, along: f64, wanted: f64) -> f64 {
        let (goal, square_across) = self.goal_and_square_across(distance, along, wanted);
        along - (goal * goal - square_across).max(0.0).sqrt() + wanted
    }

    /// By how much a distance is too long even where its part along the row is zero.
    pub(crate) fn missed_distance(&self, distance: f64, along: f64, wanted: f64) -> f64 {
        let (goal, square_across) = self.goal_and_square_across(distance, along, wanted);
        (square_across.max(0.0).sqrt() - goal.abs()).max(0.0)
    }

    /// What a distance is to be \[m\], and the square of its part across the row.
    fn goal_and_square_across(&self, distance: f64, along: f64, wanted: f64) -> (f64, f64) {
        (distance - self.error_at_bound(distance) + wanted, distance * distance - along * along)
    }

    /// Goes to a bound that bodies have gone past, to this value; returns whether they have.
    pub(crate) fn meet_bound(&mut self, value: f64) -> bool {
        if self.is_at_bound() || self.value.is_nan() {
            // What had no value was not within.
            return false;
        }
        // An angle that jumped did not go there.
        let most = if self.axis.is_linear() { f64::INFINITY } else { 0.5 };
        let is_past = |upper: bool| {
            let past = self.past(value, upper);
            past > 0.0 && past < most
        };
        self.mode = if is_past(false) {
            Mode::AtLower
        } else if is_past(true) {
            Mode::AtUpper
        } else {
            return false;
        };
        self.set_law(Phase::Positions);
        true
    }
}
