//! The kinetic energy of bodies that nothing but fixed bodies touches: contacts add none.

use tumble_math::lane::Vec3;

use crate::collision::contact::ContactRecord;
use crate::math::{Real, real};
use crate::solver::body_rows::{BodyMotion, ForceImpulse};
use crate::solver::solver_bodies::{SolverBodies, SolverRow};
use crate::solver::substeps::GroupContact;

/// The most energy that forces give to bodies on which nothing else acts but fixed ones.
///
/// A fixed body does no work: its contacts stop, guide and rub. Passes over several contacts that
/// oppose each other do not come to their end, and leave some of the velocity with which overlaps
/// are pushed apart; points turn with a body where the true ones would not. What that gives is
/// taken back in every substep.
#[derive(Clone, Default)]
pub(crate) struct EnergyBounds {
    bodies: Vec<Bounded>,
    /// By row, the bodies in contact with it.
    touched: Vec<Touched>,
}

#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum Touched {
    #[default]
    Nothing,
    Fixed,
    Others,
}

/// A body, and its kinetic energies \[J\].
#[derive(Clone, Copy)]
struct Bounded {
    row: SolverRow,
    /// When the substep began.
    now: f64,
    /// The most that it may be at the end of the substep, and of the step.
    substep: f64,
    step: f64,
}

/// The part of an energy that is its rounding.
const ROUNDING: f64 = 1e-6;

impl EnergyBounds {
    /// Finds the bodies that nothing but fixed ones touch, before the first substep.
    pub(crate) fn begin(&mut self, all: &[ContactRecord], contacts: &[GroupContact], bodies: &SolverBodies) {
        self.touched.clear();
        self.touched.resize(bodies.len(), Touched::Nothing);
        let first_non_dynamic = bodies.first_non_dynamic();
        let conveys = |number: u32| all[number as usize].surface_velocity != Vec3::zero();
        for contact in contacts {
            let is_fixed = is_still(bodies, contact.rows[0], first_non_dynamic) && !conveys(contact.number);
            for row in contact.rows {
                let touched = &mut self.touched[row.index()];
                *touched = if is_fixed && *touched != Touched::Others { Touched::Fixed } else { Touched::Others };
            }
        }
        self.bodies.clear();
        let rows = (0..).map(SolverRow).zip(&self.touched[..first_non_dynamic]);
        for (row, _) in rows.filter(|(row, it)| **it == Touched::Fixed && !bodies.locked.has(*row)) {
            let now = energy(bodies, row);
            self.bodies.push(Bounded { row, now, substep: now, step: now });
        }
    }

    /// To be called once forces have acted in a substep.
    pub(crate) fn after_forces(&mut self, bodies: &SolverBodies) {
        for it in &mut self.bodies {
            let given = work_of_weight(bodies, it.row).unwrap_or_else(|| energy(bodies, it.row) - it.now);
            (it.substep, it.step) = (it.now + given, it.step + given);
        }
    }

    /// Slows bodies that have more energy than a substep allows.
    pub(crate) fn bound_substep(&mut self, bodies: &mut SolverBodies) {
        self.bodies.iter_mut().for_each(|it| it.now = bounded(bodies, it.row, it.substep));
    }

    /// Slows bodies that have more energy than the step allows.
    pub(crate) fn bound_step(&mut self, bodies: &mut SolverBodies) {
        self.bodies.iter_mut().for_each(|it| it.now = bounded(bodies, it.row, it.step));
    }
}

fn is_still(bodies: &SolverBodies, row: SolverRow, first_non_dynamic: usize) -> bool {
    let BodyMotion { momentum, angular_momentum, .. } = bodies.motion[row.index()];
    row.index() >= first_non_dynamic && momentum == Vec3::zero() && angular_momentum == Vec3::zero()
}

/// Slows a body that has more than this kinetic energy \[J\]; returns what it has then.
fn bounded(bodies: &mut SolverBodies, row: SolverRow, most: f64) -> f64 {
    let energy = energy(bodies, row);
    // Of what is not finite nothing is more.
    let is_more = energy > most + ROUNDING * energy;
    if !is_more {
        return energy;
    }
    let most = most.max(0.0);
    let kept: Real = real((most / energy).sqrt());
    let motion = &mut bodies.motion[row.index()];
    (motion.momentum, motion.angular_momentum) = (motion.momentum * kept, motion.angular_momentum * kept);
    most
}

/// The energy that forces gave to a body \[J\], if there is neither torque nor damping.
fn work_of_weight(bodies: &SolverBodies, row: SolverRow) -> Option<f64> {
    let ForceImpulse { linear, angular, kept_linear, kept_angular } = bodies.force_impulse[row.index()];
    let BodyMotion { momentum, inverse_mass, .. } = bodies.motion[row.index()];
    let is_weight = angular == Vec3::zero() && [kept_linear, kept_angular] == [1.0; 2];
    let given = |linear: Vec3<f64>| linear.dot(wide(momentum) - linear * 0.5) * f64::from(inverse_mass);
    is_weight.then(|| given(wide(linear)))
}

fn wide(v: Vec3<Real>) -> Vec3<f64> {
    Vec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z))
}

/// The kinetic energy of a body \[J\].
fn energy(bodies: &SolverBodies, row: SolverRow) -> f64 {
    let row = row.index();
    let motion = &bodies.motion[row];
    let (p, inertia) = (wide(motion.momentum), &bodies.inertia[row]);
    let l = wide(bodies.pose[row].orientation.rotate_back(motion.angular_momentum));
    let inverse = wide(inertia.inverse_moments);
    0.5 * (p.dot(p) * f64::from(motion.inverse_mass)
        + l.x * l.x * inverse.x
        + l.y * l.y * inverse.y
        + l.z * l.z * inverse.z)
}
