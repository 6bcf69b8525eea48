//! The impulses of contacts that answer to each other: none pulls, friction stays within its limit
//! and is against what slides.
//!
//! With the speeds `w = A f + q` of all rows and impulses `f`, a point has `f >= 0`, `w >= 0` and
//! one of them zero. Sweeps go from contact to contact. Between them a step of Newton's method
//! takes the equations of what carries and slides together (P. Alart, A. Curnier, "A mixed
//! formulation for frictional contact problems prone to Newton like solution methods", 1991), and
//! is kept where it brings the speeds nearer.

use std::ops::Range;

use crate::simd::{FourKernel, FourLane, dispatch_fours};
use crate::solver::direct::dense;
use crate::solver::direct::newton_step::NewtonStep;

/// The rows of one contact in a problem: points along the normal first, then two along the
/// tangents, one about the normal if it resists twisting, and two about the tangents if it resists
/// rolling.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ContactShape {
    pub(crate) first: usize,
    pub(crate) points: usize,
    /// Coefficients of friction: what it takes to begin to slide, and what sliding meets.
    pub(crate) friction: [f64; 2],
    /// At which friction acts against a twist, zero where it does not \[m\].
    pub(crate) radius: f64,
    /// Of rolling resistance, zero where there is none \[m\].
    pub(crate) rolling: f64,
    /// Whether it slides.
    pub(crate) slides: bool,
    /// Of the responses of the rows of friction, once a problem is solved.
    pub(crate) inverse: [[f64; 3]; 3],
}

/// Speeds and impulses of the rows of contacts.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactProblem {
    pub(crate) contacts: Vec<ContactShape>,
    /// Row by row: the speed of a row that an impulse of one along another gives.
    pub(crate) responses: Vec<f64>,
    /// The speed of each row with these impulses, less the one that it is to have.
    pub(crate) speeds: Vec<f64>,
    pub(crate) impulses: Vec<f64>,
    /// Whether a point may push in this solution.
    pub(crate) may_push: Vec<bool>,
    /// The speed by which a row gives way under an impulse of one along it; and by contact, by
    /// which all its points do under one along any of them.
    softness: Vec<f64>,
    softness_together: Vec<f64>,
    /// Slower than this is at rest \[m/s\].
    pub(crate) rest: f64,
    /// Impulses before a step, and those from which a sweep changed least.
    before: Vec<f64>,
    best: Vec<f64>,
    /// By contact, whether it slid before a step.
    slid_before: Vec<bool>,
    /// The speeds without impulses.
    start: Vec<f64>,
    pub(super) step: NewtonStep,
}

/// Steps of Newton's method, at most; sweeps before the first, and before another, at most.
const MAX_ROUNDS: u32 = 10;
const FIRST_SWEEPS: u32 = 2;
const MAX_SWEEPS: u32 = 8;
const LAST_SWEEPS: u32 = 8;
/// After this many steps a coarser solution does, by this factor.
const FEW_ROUNDS: u32 = 2;
const COARSE: f64 = 100.0;
/// What a step leaves of the change of a sweep, at most, if it is kept.
const KEPT: f64 = 0.9;
/// What a sweep changes of speeds where impulses are found, of the greatest that there were.
const TOLERANCE: f64 = 1e-9;

/// By how much contacts give way under a load, over what free fall does in a substep to as much
/// mass as that of all bodies: redundant ones share it.
const SOFTNESS: f64 = 1e-4;

impl ContactShape {
    /// How many rows it has.
    pub(crate) fn rows(&self) -> usize {
        self.points + self.friction_rows() + if self.rolling > 0.0 { 2 } else { 0 }
    }

    /// How many of friction against sliding and twisting.
    fn friction_rows(&self) -> usize {
        if self.radius > 0.0 { 3 } else { 2 }
    }

    pub(super) fn normals(&self) -> Range<usize> {
        self.first..self.first + self.points
    }

    /// The rows of friction.
    pub(super) fn sliding(&self) -> Range<usize> {
        let begin = self.first + self.points;
        begin..begin + self.friction_rows()
    }

    /// The rows of rolling resistance.
    pub(super) fn rolling(&self) -> Range<usize> {
        let begin = self.sliding().end;
        begin..self.first + self.rows()
    }

    /// The length with which the speed of a row is a linear one: one for rows that push along a
    /// line \[m\].
    pub(super) fn length(&self, row: usize) -> f64 {
        match row - self.first {
            row if row < self.points + 2 => 1.0,
            row if row < self.points + self.friction_rows() => self.radius,
            _ => self.rolling,
        }
    }

    /// What impulses along a row count as beside those along a line [1/m].
    pub(crate) fn scale(&self, row: usize) -> f64 {
        1.0 / self.length(row)
    }
}

/// Lets loops over numbers use the instruction set in force.
struct Solve<'a> {
    problem: &'a mut ContactProblem,
}

impl FourKernel for Solve<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        self.problem.solve_here();
    }
}

impl ContactProblem {
    /// Of contacts with impulses, where nothing is known yet of speeds.
    pub(crate) fn resize(&mut self) {
        let n = self.contacts.last().map_or(0, |contact| contact.first + contact.rows());
        self.responses.clear();
        self.responses.resize(n * n, 0.0);
        self.speeds.clear();
        self.speeds.resize(n, 0.0);
        self.impulses.clear();
        self.impulses.resize(n, 0.0);
        self.may_push.clear();
        self.may_push.resize(n, true);
        self.softness.clear();
        self.softness.resize(n, 0.0);
        self.softness_together.clear();
        self.softness_together.resize(self.contacts.len(), 0.0);
    }

    pub(crate) fn len(&self) -> usize {
        self.speeds.len()
    }

    /// Makes contacts compliant, of bodies with this mass \[kg\] together. Where positions are met
    /// the compliance is about the impulses that are set.
    ///
    /// A point that joints hold responds to a push at least as a free body of that mass would, and
    /// all points of a contact together as one of that mass times their number. What parts after
    /// the motion does not: what pushed it is taken back, so that an overlap between a contact and
    /// a joint gives no energy.
    pub(crate) fn soften(&mut self, mass: f64, is_of_positions: bool) {
        let n = self.len();
        for (contact, softness_together) in self.contacts.iter().zip(&mut self.softness_together) {
            let parts = !is_of_positions && contact.normals().all(|row| self.speeds[row] >= 0.0);
            for row in 0..contact.rows() {
                let at = contact.first + row;
                let held = 1.0 / mass - self.responses[at * n + at];
                let held = if row < contact.points && !parts { held.max(0.0) } else { 0.0 };
                let softness = SOFTNESS / mass * contact.scale(at).powi(2) + held;
                self.responses[at * n + at] += softness;
                self.softness[at] = softness;
                if row < contact.points && is_of_positions {
                    self.speeds[at] += softness * self.impulses[at];
                }
            }
            let (normals, points) = (contact.normals(), contact.points as f64);
            let of_row = |row: usize| self.responses[row * n..][normals.clone()].iter().sum::<f64>();
            let together = normals.clone().map(of_row).sum::<f64>() / (points * points);
            let held = 1.0 / (mass * points) - together;
            if held > 0.0 && !parts {
                *softness_together = held;
                let push: f64 = self.impulses[normals.clone()].iter().sum();
                for row in normals.clone() {
                    self.responses[row * n..][normals.clone()].iter_mut().for_each(|response| *response += held);
                    if is_of_positions {
                        self.speeds[row] += held * push;
                    }
                }
            }
        }
    }

    /// By how fast a point of a contact gives way under impulses, row by row of the contact.
    pub(crate) fn speed_given(&self, number: usize, point: usize, impulses: impl Fn(usize) -> f64) -> f64 {
        let ContactShape { first, points, .. } = self.contacts[number];
        let all: f64 = (0..points).map(&impulses).sum();
        self.softness[first + point] * impulses(point) + self.softness_together[number] * all
    }

    /// Finds the impulses, and the speeds with them.
    pub(crate) fn solve(&mut self) {
        dispatch_fours(Solve { problem: self });
    }

    #[inline(always)]
    fn solve_here(&mut self) {
        let greatest = self.speeds.iter().fold(0.0_f64, |most, speed| most.max(speed.abs()));
        if greatest == 0.0 {
            return;
        }
        let tolerance = (TOLERANCE * greatest).max(self.rest);
        self.set_start();
        self.invert_friction();
        let (mut sweeps, mut least) = (FIRST_SWEEPS, f64::INFINITY);
        for round in 0..MAX_ROUNDS {
            let mut left = f64::INFINITY;
            for _ in 0..sweeps {
                left = self.sweep();
            }
            if left <= if round < FEW_ROUNDS { tolerance } else { COARSE * tolerance } {
                return;
            }
            self.before.clone_from(&self.impulses);
            if left < least {
                least = left;
                self.best.clone_from(&self.impulses);
            }
            self.slid_before.clear();
            self.slid_before.extend(self.contacts.iter().map(|contact| contact.slides));
            let value = self.value();
            self.go_to_bounds();
            let has_fallen = self.value() < value;
            let after = self.sweep();
            if after <= tolerance {
                return;
            }
            if after < KEPT * left || has_fallen {
                sweeps = 1;
            } else {
                sweeps = (2 * sweeps).min(MAX_SWEEPS);
                self.go_back(|it| &it.before);
                let contacts = self.contacts.iter_mut().zip(&self.slid_before);
                contacts.for_each(|(contact, slides)| contact.slides = *slides);
            }
        }
        self.go_back(|it| &it.best);
        for _ in 0..LAST_SWEEPS {
            if self.sweep() <= tolerance {
                return;
            }
        }
    }

    /// Notes the speeds without impulses.
    #[inline(always)]
    fn set_start(&mut self) {
        let n = self.len();
        let Self { start, speeds, impulses, responses, .. } = self;
        start.clone_from(speeds);
        for (impulse, responses) in
            impulses.iter().zip(responses.chunks_exact(n)).filter(|(impulse, _)| **impulse != 0.0)
        {
            start.iter_mut().zip(responses).for_each(|(speed, response)| *speed -= response * impulse);
        }
    }

    /// What the impulses do to the energy \[J\].
    #[inline(always)]
    fn value(&self) -> f64 {
        let speeds = self.speeds.iter().zip(&self.start).map(|(now, start)| now + start);
        0.5 * self.impulses.iter().zip(speeds).map(|(impulse, speed)| impulse * speed).sum::<f64>()
    }

    /// Takes impulses that there were.
    #[inline(always)]
    fn go_back(&mut self, to: impl Fn(&Self) -> &[f64]) {
        for row in 0..self.len() {
            let change = to(self)[row] - self.impulses[row];
            self.add(row, change);
        }
    }

    /// Adds to an impulse.
    #[inline(always)]
    pub(super) fn add(&mut self, row: usize, change: f64) {
        if change != 0.0 {
            self.impulses[row] += change;
            self.spread(row, change, 0..self.len());
        }
    }

    /// Lets the speeds of some rows follow a change of an impulse.
    #[inline(always)]
    pub(super) fn spread(&mut self, row: usize, change: f64, others: Range<usize>) {
        let n = self.len();
        // Responses are symmetric.
        let responses = &self.responses[row * n..(row + 1) * n][others.clone()];
        for (speed, response) in self.speeds[others].iter_mut().zip(responses) {
            *speed += response * change;
        }
    }

    #[inline(always)]
    pub(super) fn response(&self, row: usize, other: usize) -> f64 {
        self.responses[row * self.len() + other]
    }

    /// The sum of the normal impulses of a contact.
    pub(super) fn normal(&self, contact: &ContactShape) -> f64 {
        self.impulses[contact.normals()].iter().sum()
    }

    /// Sets the inverses of the responses of friction in each contact.
    #[inline(always)]
    fn invert_friction(&mut self) {
        for number in 0..self.contacts.len() {
            let contact = self.contacts[number];
            let (rows, n) = (contact.sliding(), contact.friction_rows());
            let mut inverse = [[0.0; 3]; 3];
            for k in 0..n {
                let mut matrix = [0.0; 9];
                let mut right = [0.0; 3];
                right[k] = 1.0;
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    matrix[i * n + j] = self.response(rows.start + i, rows.start + j);
                }
                dense::solve(&mut matrix[..n * n], &mut right[..n]);
                (0..n).for_each(|i| inverse[i][k] = right[i]);
            }
            self.contacts[number].inverse = inverse;
        }
    }
}
