//! Mechanisms that nothing touches: their substeps, halved where bodies turn too fast for them.

use tumble_math::lane::Vec3;

use crate::solver::mechanism::body_passes::{kick, save};
use crate::solver::mechanism::free_row::Phase;
use crate::solver::mechanism::mechanism_body::{MechanismBody, SavedBody};
use crate::solver::mechanism::mechanism_misfit::{MIN_MISFIT, return_momentum};
use crate::solver::mechanism::mechanism_solver::{Half, MechanismSolver};

/// The error beyond which a substep is solved again in two halves, of the size of the arms or
/// \[rad\].
pub(super) const MAX_ERROR: f64 = 1e-6;
/// How often a substep is halved, at most.
const MAX_HALVINGS: u32 = 6;
/// The same after the last halving, beyond which joints contradict each other: the rest of the step
/// has no halves.
const MAX_ERROR_OF_SHORTEST: f64 = 1e-4;
/// What is left of a smaller one by the last halving, at most, if shorter substeps help.
const FALL: f64 = 0.5;

impl MechanismSolver {
    /// Advances the bodies by substeps of `h` \[s\]. Returns whether all numbers stayed finite.
    pub(crate) fn advance(&mut self, substeps: u32, h: f64) -> bool {
        self.begin();
        self.is_stuck = false;
        (self.contradicts, self.gain) = (false, 0.0);
        self.update_rows();
        // What was done to velocities since the last step is no load.
        self.solve_velocities(Half { phase: Phase::Begin, h, before: 0.5 });
        for _ in 0..substeps {
            self.advance_once(h, 0, f64::INFINITY);
        }
        self.return_dropped_momentum();
        self.take_back_gain();
        self.bodies.iter().all(MechanismBody::is_finite)
    }

    /// Advances the bodies by a substep of `h` \[s\], that was halved this many times for an error
    /// that was left, the last time for this one.
    fn advance_once(&mut self, h: f64, halvings: u32, before: f64) {
        let half = |phase| Half { phase, h, before: 0.5 };
        self.saved.resize(self.bodies.len(), SavedBody::default());
        save(&self.bodies, &mut self.saved);
        kick(&mut self.bodies, halvings);
        let is_counted = self.matrix.may_depend() || self.has_distances || halvings > 0;
        let energy = if is_counted { self.kinetic_energy() } else { 0.0 };
        let left = self.solve_positions(half(Phase::Positions));
        self.parts += 1;
        let is_met = left <= MAX_ERROR.max(2.0 * self.misfit);
        if !is_met && halvings < MAX_HALVINGS && !self.is_stuck {
            self.bodies.iter_mut().zip(&self.saved).for_each(|(body, saved)| body.restore(saved));
            self.bend.fill([0.0; 4]);
            self.update_rows();
            self.factor();
            self.advance_once(0.5 * h, halvings + 1, left);
            self.advance_once(0.5 * h, halvings + 1, left);
            return;
        }
        let most = if left > FALL * before { MAX_ERROR } else { MAX_ERROR_OF_SHORTEST };
        self.is_stuck |= left > most && halvings == MAX_HALVINGS;
        // Rounding of poses, once a step, is met by the end of a substep: that is no misfit.
        let is_misfit = self.is_softened && left > MIN_MISFIT;
        self.contradicts |= !is_met || halvings > 0 || is_misfit;
        self.gain += if is_counted { self.kinetic_energy() - energy } else { 0.0 };
        self.note_impulses(true);
        kick(&mut self.bodies, halvings);
        self.take_loads(h);
        self.update_rows();
        let energy = if is_counted { self.kinetic_energy() } else { 0.0 };
        self.solve_velocities(half(Phase::Velocities));
        self.gain += if is_counted { self.kinetic_energy() - energy } else { 0.0 };
    }

    /// Gives bodies their own moments. What flies free gets back the angular momentum that raised
    /// moments have made or dropped, as a rotation of the whole, which no joint resists.
    fn return_dropped_momentum(&mut self) {
        self.bodies.iter_mut().for_each(MechanismBody::take_own_moments);
        let dropped = self.bodies.iter().fold(Vec3::zero(), |sum: Vec3<f64>, body| sum + body.dropped());
        if dropped.dot(dropped) == 0.0 {
            return;
        }
        let lock = self.lock_of_free();
        let Some(bodies) = self.free_bodies() else { return };
        return_momentum(bodies, dropped, lock);
    }
}
