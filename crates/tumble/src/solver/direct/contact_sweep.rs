//! Sweeps from contact to contact.

use std::ops::Range;

use crate::solver::direct::contact_problem::{ContactProblem, ContactShape};
use crate::solver::direct::direct_contact::MAX_CONTACT_ROWS;

/// How often a sweep goes through the rows of a contact, at most, and until they change by this
/// part of what they did first.
const MAX_LOCAL: u32 = 8;
const LOCAL_TOLERANCE: f64 = 0.1;

/// The rows of one contact by themselves, from zero on.
struct OwnRows {
    shape: ContactShape,
    responses: [[f64; MAX_CONTACT_ROWS]; MAX_CONTACT_ROWS],
    speeds: [f64; MAX_CONTACT_ROWS],
    impulses: [f64; MAX_CONTACT_ROWS],
    may_push: [bool; MAX_CONTACT_ROWS],
}

impl ContactProblem {
    /// Goes through all contacts once, and through each until its own rows agree; returns the
    /// greatest change of a speed.
    #[inline(always)]
    pub(super) fn sweep(&mut self) -> f64 {
        let mut most = 0.0_f64;
        for number in 0..self.contacts.len() {
            let mut own = self.own_rows(number);
            let before = own.impulses;
            most = most.max(own.solve());
            let first = self.contacts[number].first;
            let rows = first..first + own.shape.rows();
            self.contacts[number].slides = own.shape.slides;
            self.speeds[rows.clone()].copy_from_slice(&own.speeds[..rows.len()]);
            for (row, (impulse, before)) in rows.clone().zip(own.impulses.iter().zip(before)) {
                let change = impulse - before;
                if change != 0.0 {
                    self.impulses[row] = *impulse;
                    self.spread(row, change, 0..rows.start);
                    self.spread(row, change, rows.end..self.len());
                }
            }
        }
        most
    }

    #[inline(always)]
    fn own_rows(&self, number: usize) -> OwnRows {
        let shape = self.contacts[number];
        let rows = shape.first..shape.first + shape.rows();
        let mut own = OwnRows {
            shape: ContactShape { first: 0, ..shape },
            responses: [[0.0; MAX_CONTACT_ROWS]; MAX_CONTACT_ROWS],
            speeds: [0.0; MAX_CONTACT_ROWS],
            impulses: [0.0; MAX_CONTACT_ROWS],
            may_push: [true; MAX_CONTACT_ROWS],
        };
        let (n, count) = (self.len(), rows.len());
        own.speeds[..count].copy_from_slice(&self.speeds[rows.clone()]);
        own.impulses[..count].copy_from_slice(&self.impulses[rows.clone()]);
        own.may_push[..count].copy_from_slice(&self.may_push[rows.clone()]);
        for (responses, row) in own.responses.iter_mut().zip(rows.clone()) {
            responses[..count].copy_from_slice(&self.responses[row * n..(row + 1) * n][rows.clone()]);
        }
        own
    }
}

impl OwnRows {
    /// Goes through the rows until they agree; returns the greatest change of a speed at first.
    #[inline(always)]
    fn solve(&mut self) -> f64 {
        let mut first = 0.0;
        for round in 0..MAX_LOCAL {
            let change = self.go_through();
            first = if round == 0 { change } else { first };
            if change <= LOCAL_TOLERANCE * first {
                break;
            }
        }
        first
    }

    /// Goes through the rows once; returns the greatest change of a speed.
    #[inline(always)]
    fn go_through(&mut self) -> f64 {
        let (shape, mut most) = (self.shape, 0.0_f64);
        for row in shape.normals() {
            let response = self.responses[row][row];
            let wanted = self.impulses[row] - self.speeds[row] / response;
            let pushes = response > 0.0 && self.may_push[row] && wanted > 0.0;
            most = most.max(self.set(row, if pushes { wanted } else { 0.0 }));
        }
        let normal: f64 = self.impulses[..shape.points].iter().sum();
        if shape.rolling > 0.0 {
            most = most.max(self.limit_rolling(shape.rolling * normal));
        }
        most.max(self.limit_friction(normal))
    }

    /// Sets an impulse; returns the change of its own speed, as a linear one.
    #[inline(always)]
    fn set(&mut self, row: usize, impulse: f64) -> f64 {
        let change = impulse - self.impulses[row];
        let responses = self.responses[row];
        if change != 0.0 {
            self.impulses[row] += change;
            for (speed, response) in self.speeds.iter_mut().zip(responses) {
                *speed += response * change;
            }
        }
        (change * responses[row]).abs() * self.shape.length(row)
    }

    /// Sets the impulses of some rows; returns the greatest change of a speed.
    #[inline(always)]
    fn set_all(&mut self, rows: Range<usize>, impulses: [f64; 3]) -> f64 {
        let mut most = 0.0_f64;
        for (row, impulse) in rows.zip(impulses) {
            most = most.max(self.set(row, impulse));
        }
        most
    }

    /// Takes out as much of the rolling as a limit allows; returns the greatest change of a speed.
    #[inline(always)]
    fn limit_rolling(&mut self, limit: f64) -> f64 {
        let rows = self.shape.rolling();
        let wanted = self.limited(rows.clone(), |_| 1.0, limit);
        self.set_all(rows, wanted)
    }

    /// Takes out as much of sliding and twisting as friction allows for a normal impulse; returns
    /// the greatest change of a speed.
    #[inline(always)]
    fn limit_friction(&mut self, normal: f64) -> f64 {
        let (shape, rows) = (self.shape, self.shape.sliding());
        let [hold, slide] = shape.friction.map(|friction| friction * normal);
        let wanted = if normal > 0.0 {
            let (held, size) = self.held();
            self.shape.slides = size > if shape.slides { slide } else { hold };
            if self.shape.slides { self.limited(rows.clone(), |row| shape.scale(row), slide) } else { held }
        } else {
            self.shape.slides = false;
            [0.0; 3]
        };
        self.set_all(rows, wanted)
    }

    /// The impulses with which nothing slides or twists, and how large they are together.
    #[inline(always)]
    fn held(&self) -> ([f64; 3], f64) {
        let (shape, rows) = (self.shape, self.shape.sliding());
        let mut held = [0.0; 3];
        let speeds = &self.speeds[rows.clone()];
        for ((held, impulse), inverse) in held.iter_mut().zip(&self.impulses[rows.clone()]).zip(&shape.inverse) {
            let change: f64 = inverse.iter().zip(speeds).map(|(inverse, speed)| inverse * speed).sum();
            *held = impulse - change;
        }
        (held, size(rows, |row| shape.scale(row), &held))
    }

    /// The impulses to which a step against the velocity of up to three rows leads, within a limit
    /// for all of them.
    #[inline(always)]
    fn limited(&self, rows: Range<usize>, scale: impl Fn(usize) -> f64, limit: f64) -> [f64; 3] {
        let rate = rate(rows.clone(), &scale, |row| self.responses[row][row]);
        let mut wanted = [0.0; 3];
        for (wanted, row) in wanted.iter_mut().zip(rows.clone()) {
            let scale = scale(row);
            *wanted = self.impulses[row] - rate * self.speeds[row] / (scale * scale);
        }
        let size = size(rows, scale, &wanted);
        let part = if size > limit { limit / size } else { 1.0 };
        wanted.map(|wanted| wanted * part)
    }
}

/// How far impulses of up to three rows go against a speed of one, in impulses that count alike,
/// by what each does to the speed of its own row.
#[inline(always)]
pub(super) fn rate(rows: Range<usize>, scale: impl Fn(usize) -> f64, response: impl Fn(usize) -> f64) -> f64 {
    let trace: f64 = rows.map(|row| response(row) * (1.0 / scale(row)).powi(2)).sum();
    if trace > 0.0 { 1.0 / trace } else { 0.0 }
}

/// How large impulses of some rows are together.
#[inline(always)]
fn size(rows: Range<usize>, scale: impl Fn(usize) -> f64, impulses: &[f64; 3]) -> f64 {
    rows.zip(impulses).map(|(row, impulse)| (impulse * scale(row)).powi(2)).sum::<f64>().sqrt()
}
