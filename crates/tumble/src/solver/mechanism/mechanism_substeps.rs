//! Mechanisms that nothing touches: their substeps, halved where bodies turn too fast for them.

use tumble_math::lane::Vec3;

use crate::solver::mechanism::free_row::Phase;
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_solver::{Half, MechanismSolver};

/// The error beyond which a substep is solved again in two halves, of the size of the arms or
/// \[rad\].
pub(super) const MAX_ERROR: f64 = 1e-6;
/// How often a substep is halved, at most.
const MAX_HALVINGS: u32 = 6;
/// The same after the last halving, beyond which joints contradict each other: the rest of the step
/// has no halves.
const MAX_ERROR_OF_SHORTEST: f64 = 1e-4;

impl MechanismSolver {
    /// Advances the bodies by substeps of `h` \[s\]. Returns whether all numbers stayed finite.
    pub(crate) fn advance(&mut self, substeps: u32, h: f64) -> bool {
        self.begin();
        self.is_stuck = false;
        self.update_rows();
        // What was done to velocities since the last step is no load.
        self.solve_velocities(Half { phase: Phase::Begin, h, before: 0.5 });
        for _ in 0..substeps {
            self.advance_once(h, 0);
        }
        self.return_dropped_momentum();
        self.bodies.iter().all(MechanismBody::is_finite)
    }

    /// Advances the bodies by a substep of `h` \[s\], that was halved this many times for an error
    /// that was left.
    fn advance_once(&mut self, h: f64, halvings: u32) {
        let half = |phase| Half { phase, h, before: 0.5 };
        self.saved.clear();
        self.saved.extend(self.bodies.iter().map(MechanismBody::saved));
        self.bodies.iter_mut().for_each(|body| body.kick(halvings));
        let left = self.solve_positions(half(Phase::Positions));
        let is_met = left <= MAX_ERROR;
        if !is_met && halvings < MAX_HALVINGS && !self.is_stuck {
            self.bodies.iter_mut().zip(&self.saved).for_each(|(body, saved)| body.restore(saved));
            self.bend.fill([0.0; 4]);
            self.update_rows();
            self.factor();
            self.advance_once(0.5 * h, halvings + 1);
            self.advance_once(0.5 * h, halvings + 1);
            return;
        }
        self.is_stuck |= left > MAX_ERROR_OF_SHORTEST && halvings == MAX_HALVINGS;
        self.note_impulses(true);
        self.bodies.iter_mut().for_each(|body| body.kick(halvings));
        self.take_loads(h);
        self.update_rows();
        self.solve_velocities(half(Phase::Velocities));
    }

    /// Gives bodies their own moments. What flies free gets back the angular momentum that raised
    /// moments have made or dropped, as a rotation of the whole, which no joint resists.
    fn return_dropped_momentum(&mut self) {
        let bodies = &mut self.bodies;
        bodies.iter_mut().for_each(MechanismBody::take_own_moments);
        let dropped = bodies.iter().fold(Vec3::zero(), |sum: Vec3<f64>, body| sum + body.dropped);
        if dropped.dot(dropped) == 0.0 || bodies.iter().any(|body| body.inverse_mass == 0.0) {
            return;
        }
        let mass: f64 = bodies.iter().map(MechanismBody::mass).sum();
        let moment = bodies.iter().fold(Vec3::zero(), |sum, body| sum + body.position() * body.mass());
        let center = moment * (1.0 / mass);
        let mut inertia = glam::DMat3::ZERO;
        for body in &*bodies {
            let arm = glam::DVec3::from(body.position() - center);
            let [diagonal, off_diagonal] = body.own_inertia().map(glam::DVec3::from);
            let (d, o) = (diagonal, off_diagonal);
            let own = glam::DMat3::from_cols_array(&[d.x, o.z, o.y, o.z, d.y, o.x, o.y, o.x, d.z]);
            let square = glam::DMat3::from_diagonal(glam::DVec3::splat(arm.length_squared()));
            let product = glam::DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
            inertia += own + (square - product) * body.mass();
        }
        let turn = inertia.inverse() * glam::DVec3::from(dropped);
        if turn.is_finite() {
            bodies.iter_mut().for_each(|body| body.turn_along(turn.into(), body.position() - center));
        }
    }
}
