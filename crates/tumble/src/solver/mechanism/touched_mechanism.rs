//! Mechanisms that contacts act on: solutions for their joints, with those of their direct contacts
//! and between those of others.

use tumble_math::lane::Vec3;

use crate::simd::Four;
use crate::solver::direct::direct_contact::Push;
use crate::solver::direct::direct_contacts::{ContactStage, DirectContacts};
use crate::solver::mechanism::body_passes::save;
use crate::solver::mechanism::fours::{row_of, vector};
use crate::solver::mechanism::free_row::Phase;
use crate::solver::mechanism::mechanism_body::SavedBody;
use crate::solver::mechanism::mechanism_solver::{Half, MechanismSolver};

impl MechanismSolver {
    /// Finds the impulses that meet the joints and the direct contacts at the end of a substep of
    /// `h` \[s\], where others move the bodies: to first order if contacts push.
    pub(crate) fn solve_once(&mut self, h: f64, contacts: &mut DirectContacts, stage: ContactStage) {
        let half = Half { phase: Phase::Positions, h, before: 1.0 };
        self.begin_half(half);
        self.factor();
        self.plan_corrections(h);
        contacts.solve(self, half, stage);
        if contacts.push_nothing() {
            self.meet_positions_ahead(h);
        } else {
            self.bend.fill([0.0; 4]);
            self.take_solution();
        }
        self.find_free_speeds();
        self.note_springs();
        self.note_impulses(true);
        self.take_loads(h);
    }

    /// Goes on from the solution on the right side to that with which the joints are met where
    /// others will have moved the bodies, as if there were no contacts.
    fn meet_positions_ahead(&mut self, h: f64) {
        self.impulses.fill([0.0; 4]);
        self.saved.resize(self.bodies.len(), SavedBody::default());
        save(&self.bodies, &mut self.saved);
        self.meet_positions(h);
        for (body, saved) in self.bodies.iter_mut().zip(&self.saved) {
            (body.translation, body.orientation) = (saved.translation, saved.orientation);
        }
    }

    /// Takes back what [`solve_once`](Self::solve_once) has found along free axes, of which the
    /// laws say what acts there in all of a substep.
    pub(crate) fn take_back(&mut self) {
        let Self { joints, matrix, impulses, right, .. } = self;
        let impulses = impulses.as_flattened_mut();
        for (number, joint) in joints.iter_mut().enumerate() {
            let begin = matrix.place(number);
            impulses[begin..begin + joint.locked].fill(0.0);
            impulses[begin + joint.locked..begin + joint.count].iter_mut().for_each(|impulse| *impulse *= -1.0);
            joint.free_rows.iter_mut().for_each(|row| row.pushed = 0.0);
        }
        right.copy_from_slice(&self.impulses);
        self.push();
        self.note_impulses(false);
    }

    /// Forgets what was not finite.
    pub(crate) fn forget_impulses(&mut self) {
        self.impulses.fill([0.0; 4]);
        self.done.fill([[0.0; 4]; 2]);
        self.joints.iter_mut().flat_map(|joint| &mut joint.free_rows).for_each(|row| row.pushed = 0.0);
    }

    /// Takes out the velocities against the joints, where others have moved the bodies for `h`
    /// \[s\], and has direct contacts stop or, at the end of a step, bounce.
    pub(crate) fn solve_velocities_once(&mut self, h: f64, contacts: &mut DirectContacts, stage: ContactStage) {
        let half = Half { phase: Phase::Velocities, h, before: 1.0 };
        self.begin_half(half);
        self.factor();
        contacts.solve(self, half, stage);
        self.take_solution();
        self.note_impulses(false);
    }

    /// The velocities of a body once the impulses on the right side act, of which the response is
    /// set.
    pub(crate) fn velocities_to_be(&self, body: usize) -> [Vec3<f64>; 2] {
        let [linear, angular] = self.response_of(body);
        let of_body = &self.bodies[body];
        [of_body.linear_velocity() + linear, of_body.angular_velocity() + angular]
    }

    /// The impulses on the right side.
    pub(crate) fn right_side(&self) -> &[Four] {
        &self.right
    }

    pub(crate) fn set_right_side_to(&mut self, impulses: &[Four]) {
        self.right.copy_from_slice(impulses);
    }

    /// The velocities that the response gives a body.
    pub(crate) fn response_of(&self, body: usize) -> [Vec3<f64>; 2] {
        self.velocities[body].map(|v| vector(&v))
    }

    /// Sets how these impulses change velocities, with the joints as they are in the matrix; those
    /// on bodies beside the mechanism change nothing. The right side is lost.
    pub(crate) fn respond(&mut self, pushes: &[Push]) {
        let Self { joints, bodies, matrix, right, pushed, .. } = self;
        for Push { body, linear, torque } in pushes {
            let (Some(of_body), Some(sum)) = (bodies.get(*body), pushed.get_mut(*body)) else { continue };
            let by = of_body.response_to([*linear, *torque]);
            *sum = [sum[0] + by[0], sum[1] + by[1]];
        }
        right.fill([0.0; 4]);
        let numbers = right.as_flattened_mut();
        for (number, joint) in joints.iter().enumerate() {
            if joint.ends().any(|body| pushes.iter().any(|push| push.body == body)) {
                let speeds = joint.speeds_by(|body| pushed[body]);
                let numbers = &mut numbers[matrix.place(number)..][..joint.count];
                for (row, (number, speed)) in numbers.iter_mut().zip(speeds.as_flattened()).enumerate() {
                    *number = if joint.is_off(row) { 0.0 } else { -speed };
                }
            }
        }
        self.solve_right_side();
        self.set_response();
        for (of_body, pushed) in self.velocities.iter_mut().zip(&mut self.pushed) {
            *of_body = [0, 1].map(|i| row_of(vector(&of_body[i]) + pushed[i], 0.0));
            *pushed = [Vec3::zero(); 2];
        }
    }
}
