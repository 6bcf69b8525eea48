//! Steps of Newton's method for the impulses of contacts.

use std::ops::Range;

use crate::solver::direct::contact_problem::{ContactProblem, ContactShape};
use crate::solver::direct::contact_sweep::rate;
use crate::solver::direct::dense;

#[derive(Clone, Debug, Default)]
pub(super) struct NewtonStep {
    /// The rows whose impulses change.
    free: Vec<usize>,
    matrix: Vec<f64>,
    /// The right side, and then by how much they change.
    right: Vec<f64>,
}

/// Points that carry no more, at most.
const MAX_BOUNDS: u32 = 4;

impl ContactProblem {
    /// Finds a step of Newton's method for the equations of the points that carry, of friction and
    /// of rolling resistance, as they hold or slide now.
    #[inline(always)]
    fn set_newton_step(&mut self) {
        let mut step = std::mem::take(&mut self.step);
        let NewtonStep { free, matrix, right } = &mut step;
        free.clear();
        for contact in &self.contacts {
            if self.normal(contact) > 0.0 {
                free.extend(contact.normals().filter(|row| self.impulses[*row] > 0.0));
                free.extend(contact.sliding().end..contact.first + contact.rows());
                if contact.friction[0] > 0.0 {
                    free.extend(contact.sliding());
                }
            }
        }
        free.sort_unstable();
        let m = free.len();
        matrix.clear();
        matrix.resize(m * m, 0.0);
        right.clear();
        right.resize(m, 0.0);
        for contact in &self.contacts {
            let [normals, sliding, rolling] = [contact.normals(), contact.sliding(), contact.rolling()];
            for row in normals {
                self.set_speed_equation(row, (free, matrix, right));
            }
            let [hold, slide] = contact.friction;
            let limit = if contact.slides { slide } else { hold };
            self.set_equations(contact, (sliding, |row| contact.scale(row), limit), (free, matrix, right));
            self.set_equations(contact, (rolling, |_| 1.0, contact.rolling), (free, matrix, right));
        }
        dense::solve(matrix, right);
        self.step = step;
    }

    /// Takes a part of the step, but for what pulls then.
    #[inline(always)]
    fn take_newton_step(&mut self, part: f64) {
        let step = std::mem::take(&mut self.step);
        for (change, row) in step.right.iter().zip(&step.free).filter(|(change, _)| change.is_finite()) {
            self.add(*row, part * change);
        }
        for number in 0..self.contacts.len() {
            let contact = self.contacts[number];
            for row in contact.normals() {
                self.add(row, (-self.impulses[row]).max(0.0));
            }
        }
        self.step = step;
    }

    /// That a row is to have its speed, if it is one of those that are free.
    #[inline(always)]
    fn set_speed_equation(&self, row: usize, (free, matrix, right): (&[usize], &mut [f64], &mut [f64])) {
        let Ok(place) = free.binary_search(&row) else { return };
        let m = free.len();
        right[place] = -self.speeds[row];
        for (number, column) in matrix[place * m..(place + 1) * m].iter_mut().zip(free) {
            *number = self.response(row, *column);
        }
    }

    /// That rows hold or, where a step against their velocity leads beyond `limit` times the normal
    /// impulse, that their impulses are that limit against it.
    #[inline(always)]
    fn set_equations(
        &self,
        contact: &ContactShape,
        (rows, scale, limit): (Range<usize>, impl Fn(usize) -> f64, f64),
        (free, matrix, right): (&[usize], &mut [f64], &mut [f64]),
    ) {
        let (m, count, first) = (free.len(), rows.len(), rows.start);
        let Ok(place) = free.binary_search(&first) else { return };
        let rate = rate(rows.clone(), &scale, |row| self.response(row, row));
        let scale = |k: usize| scale(first + k);
        let impulse = |k: usize| self.impulses[first + k] * scale(k);
        let step: [f64; 3] =
            std::array::from_fn(
                |k| {
                    if k < count { impulse(k) - rate * self.speeds[first + k] / scale(k) } else { 0.0 }
                },
            );
        let size = step.iter().map(|it| it * it).sum::<f64>().sqrt();
        let most = limit * self.normal(contact);
        if size <= most {
            rows.for_each(|row| self.set_speed_equation(row, (free, matrix, right)));
            return;
        }
        let along = step.map(|it| it / size);
        let part = most / size;
        for k in 0..count {
            right[place + k] = most * along[k] - impulse(k);
            let numbers = &mut matrix[(place + k) * m..(place + k + 1) * m];
            numbers.fill(0.0);
            for s in 0..count {
                // What a change of this impulse does to the step.
                let across = part * (f64::from(u8::from(s == k)) - along[k] * along[s]);
                let by_speed = across * rate / scale(s);
                let responses = &self.responses[(first + s) * self.len()..][..self.len()];
                for (number, column) in numbers.iter_mut().zip(free) {
                    *number += by_speed * responses[*column];
                }
                numbers[place + s] -= across * scale(s);
            }
            numbers[place + k] += scale(k);
            for number in contact.normals().filter_map(|row| free.binary_search(&row).ok()) {
                numbers[number] -= limit * along[k];
            }
        }
    }

    /// Takes steps as far as the first point carries no more, and on without it.
    #[inline(always)]
    pub(super) fn go_to_bounds(&mut self) {
        for _ in 0..MAX_BOUNDS {
            self.set_newton_step();
            let part = self.part_to_bound();
            self.take_newton_step(part);
            if part == 1.0 {
                return;
            }
        }
    }

    /// The part of the step at which the first point carries no more.
    fn part_to_bound(&self) -> f64 {
        let NewtonStep { free, right, .. } = &self.step;
        let is_point = |row: &usize| self.contact_of(*row).normals().contains(row);
        let parts = free.iter().zip(right).filter(|(row, change)| **change < 0.0 && is_point(row));
        parts.map(|(row, change)| self.impulses[*row] / -change).fold(1.0, f64::min)
    }

    fn contact_of(&self, row: usize) -> &ContactShape {
        let after = self.contacts.partition_point(|contact| contact.first <= row);
        &self.contacts[after - 1]
    }
}
