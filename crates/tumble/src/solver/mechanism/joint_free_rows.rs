//! Rows of a joint along its free axes: what acts there, and which part of its law applies.

use tumble_math::lane::{Quat, Vec3};

use crate::joints::axes::Axes;
use crate::joints::drives::Drive;
use crate::joints::joint_options::JointOptions;
use crate::solver::mechanism::block_kernels::MAX_ROWS;
use crate::solver::mechanism::fours::vector;
use crate::solver::mechanism::free_axis::{Direction, FreeAxis, free_axes, the_short_way, twist};
use crate::solver::mechanism::free_row::{FreeRow, Phase};
use crate::solver::mechanism::joint_rows::{IDENTITY, JointRows, OfRows, correction_speed};
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_matrix::turning;
use crate::solver::mechanism::rotations::Rotations;

/// Whether there is a rope or a rod among the rows of a joint.
pub(super) fn has_distance(free_rows: &[FreeRow]) -> bool {
    free_rows.iter().any(|row| row.axis == FreeAxis::Distance)
}

impl JointRows {
    /// Takes over what acts along its free axes, which are as many as when it was made, in a step
    /// of which this time \[s\] is the middle.
    pub(crate) fn take_options(&mut self, options: &JointOptions, time: f64) {
        let place = |axis: usize| {
            let drives = options.drives.iter().filter(move |drive| drive.axes.has(axis));
            drives.clone().find_map(|drive| drive.target(time).0).unwrap_or(0.0)
        };
        let is_ball = self.free.contains(Axes::ANGULAR);
        let of_reference = if is_ball { [place(3), place(4), place(5)] } else { [0.0; 3] };
        let [x, y, z] = of_reference;
        let goes_somewhere = |drive: &&Drive| drive.position.is_some() && (3..6).any(|axis| drive.axes.has(axis));
        self.reference = options
            .drives
            .iter()
            .find(goes_somewhere)
            .map(|_| tumble_math::rotate_exactly(IDENTITY, Vec3::new(x, y, z), 1.0));
        for (row, axis) in self.free_rows.iter_mut().zip(free_axes(options, self.free)) {
            row.reset(axis);
            let (number, origin) = match axis {
                FreeAxis::Translation(axis) => (axis, 0.0),
                FreeAxis::Rotation(axis) => (3 + axis, of_reference[axis]),
                FreeAxis::Twist => {
                    options.limits.axes[3].into_iter().for_each(|limit| row.add_limit(limit));
                    continue;
                }
                FreeAxis::Distance => {
                    options.limits.distance.into_iter().for_each(|limit| row.add_limit(limit));
                    continue;
                }
                FreeAxis::Cone(_) => {
                    let gain = options.limits.cone.map(|cone| cone.gain).unwrap_or_default();
                    row.add_bounds([-f64::INFINITY, 0.0], gain);
                    continue;
                }
            };
            if !(is_ball && number >= 3) {
                options.limits.axes[number].into_iter().for_each(|limit| row.add_limit(limit));
            }
            row.add_friction(options.friction.max[number].into());
            for drive in options.drives.iter().filter(|drive| drive.axes.has(number)) {
                let (position, velocity) = drive.target(time);
                row.add_drive(drive, position.map(|position| position - origin), velocity);
            }
        }
    }

    /// Prepares the rows of free axes for a phase; see [`FreeRow::prepare`].
    pub(crate) fn prepare(&mut self, bodies: &[MechanismBody], phase: Phase, time: (f64, f64), is_first: bool) {
        if self.free_rows.is_empty() {
            return;
        }
        let speeds = is_first.then(|| self.speeds(bodies));
        let speeds = speeds.as_ref().map(|speeds| speeds.as_flattened());
        for (row, it) in (self.locked..).zip(&mut self.free_rows) {
            it.prepare(phase, time, speeds.map(|speeds| speeds[row]));
        }
        self.update_slip(phase);
        self.update_bounds();
    }

    /// Takes the speeds of rows of free axes out of those of all.
    pub(super) fn take_free_speeds(&mut self, speeds: &OfRows) {
        let speeds = speeds.as_flattened();
        (self.locked..).zip(&mut self.free_rows).for_each(|(row, it)| it.speed = speeds[row]);
    }

    /// Corrects the modes of rows of free axes by a solution: what it adds to the speeds that the
    /// right side was set by, and its impulses. Returns whether any has changed.
    pub(crate) fn settle(&mut self, (phase, h): (Phase, f64), (response, impulses): (&[f64], &[f64])) -> bool {
        if self.free_rows.is_empty() {
            return false;
        }
        let mut is_changed = false;
        for (row, it) in (self.locked..).zip(&mut self.free_rows) {
            is_changed |= it.settle(phase, h, it.speed + response[row], impulses[row]);
        }
        is_changed |= self.update_slip(phase);
        if is_changed {
            self.update_bounds();
        }
        if is_changed && phase == Phase::Positions {
            self.plan_correction(h);
        }
        is_changed
    }

    /// Holds free axes at bounds that the bodies have gone past; returns whether there are any.
    pub(crate) fn meet_bounds(&mut self, bodies: &[MechanismBody], h: f64) -> bool {
        if !self.free_rows.iter().any(FreeRow::is_bounded) {
            return false;
        }
        let mut is_any = false;
        if let (Rotations::About(axis), [FreeRow { axis: FreeAxis::Rotation(about), .. }]) =
            (self.rotations, &self.free_rows[..])
            && axis == *about
        {
            let [first, second] = self.orientations(bodies);
            is_any = self.free_rows[0].meet_bound(twist(the_short_way(first.conjugate() * second), axis));
        } else {
            let stance = self.stance(bodies);
            let Self { free_rows, free, reference, .. } = self;
            for it in free_rows {
                is_any |= it.meet_bound(it.axis.direction(&stance, *free, *reference).value);
            }
        }
        if is_any {
            self.update_slip(Phase::Positions);
            self.update_bounds();
            self.plan_correction(h);
        }
        is_any
    }

    /// Sets what is left of the errors of rows of free axes after a substep of `h` \[s\].
    pub(super) fn plan_free_correction(&mut self, h: f64) {
        let (all_wanted, errors) = (self.wanted.as_flattened_mut(), self.errors.as_flattened());
        for (row, it) in (self.locked..).zip(&mut self.free_rows) {
            // A bound may be reached as fast as the bodies are.
            let most = h * correction_speed(it.axis.is_linear());
            let error = if it.is_at_bound() { errors[row] } else { 0.0 };
            let past = it.past_bound(error);
            it.is_corrected = past > 0.0;
            all_wanted[row] = (past - most).max(0.0).copysign(error);
        }
    }

    /// Sets where a hinge stands of which the second frame is turned like this against the first.
    pub(super) fn set_hinge_value(&mut self, turned: Quat<f64>) {
        self.free_rows.iter_mut().for_each(|row| row.value = twist(the_short_way(turned), 0));
        self.update_bounds();
    }

    /// Pushes the bodies by what acts along free axes at any speed.
    pub(crate) fn push_constants(&mut self, bodies: &mut [MechanismBody]) {
        let Self { free_rows, locked, linear, angular, arms, bodies: ends, .. } = self;
        for (row, it) in (*locked..).zip(free_rows) {
            let most = it.constant.unwrap_or(0.0);
            let amount = most - std::mem::replace(&mut it.pushed, most);
            if amount != 0.0 {
                for (end, sign) in [-amount, amount].into_iter().enumerate() {
                    bodies[ends[end]].push(linear[row] * sign, vector(&arms[end]), vector(&angular[row]) * sign);
                }
            }
        }
    }

    /// Has friction slip where a twist, a cone or a distance is at its bound, which is nearly the
    /// same row, and where a loop is to be closed: what one holds would contradict the other.
    /// Returns whether the matrix changes.
    fn update_slip(&mut self, phase: Phase) -> bool {
        let is_beside_bound = self.free_rows.iter().any(|row| row.axis.is_of_limit() && row.is_at_bound());
        let slips = is_beside_bound || self.friction_yields;
        let rows = self.free_rows.iter_mut();
        rows.fold(false, |is_changed, row| row.set_slip(slips, phase) | is_changed)
    }

    /// Sets the errors of rows that are at a bound, as their modes have changed.
    fn update_bounds(&mut self) {
        for (row, it) in (self.locked..).zip(&self.free_rows) {
            self.errors.as_flattened_mut()[row] = if it.is_at_bound() { it.error_at_bound(it.value) } else { 0.0 };
        }
    }

    /// By row: the speed that it gets by an impulse of one along it, other joints apart.
    pub(crate) fn own_responses(&self, bodies: &[MechanismBody]) -> [f64; MAX_ROWS] {
        let mut responses = [0.0; MAX_ROWS];
        for (row, response) in responses.iter_mut().enumerate().take(self.count) {
            for (body, arm) in self.bodies.iter().zip(self.arms()) {
                let body = &bodies[*body];
                let [torque, turned] = turning(body, arm, self.linear[row], vector(&self.angular[row]));
                let linear = body.inverse_mass() * self.linear[row].dot(self.linear[row]);
                *response += linear + torque.dot(turned);
            }
        }
        responses
    }

    /// By how much the distance of a row at a bound is more than the row can bring it to \[m\].
    pub(super) fn missed_distance(&self, row: usize, it: &FreeRow, bodies: &[MechanismBody]) -> f64 {
        let Direction { value, linear, .. } = self.direction(it.axis, bodies);
        it.missed_distance(value, linear.dot(self.linear[row]) * value, self.wanted.as_flattened()[row])
    }

    /// Whether a row is of a free axis along which no impulse depends on the speed.
    pub(crate) fn is_off(&self, row: usize) -> bool {
        self.off_rows().any(|off| off == row)
    }

    /// Those rows.
    pub(super) fn off_rows(&self) -> impl Iterator<Item = usize> + '_ {
        (self.locked..).zip(&self.free_rows).filter(|(_, law)| law.constant.is_some()).map(|(row, _)| row)
    }

    /// Whether a twist, a cone or a distance acts beside another free axis, on which it may depend.
    pub(crate) fn has_dependent_limits(&self) -> bool {
        let acting = || self.free_rows.iter().filter(|row| row.constant.is_none());
        acting().any(|row| row.axis.is_of_limit()) && acting().nth(1).is_some()
    }
}
