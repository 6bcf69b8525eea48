//! Joints that contradict each other: what is left of their errors is shared out, and does no work.
//!
//! Two hinges of a door whose axes differ by `d` lock the door's own axis to first order, with a
//! response of `d^2` of that of other rows. Rows are raised by more than that, so that it counts as
//! dependent, and what a solution gives is weighted by `f(g)`, `g` its share in one solution: 1e-8
//! of a row with a thousandth of what rows are raised by, and all but 1e-2 of one with ten times.

use tumble_math::lane::Vec3;

use crate::joints::axis_lock::AxisLock;
use crate::solver::mechanism::free_row::FreeRow;
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_solver::MechanismSolver;

/// `f(g) = 10 g^3 - 15 g^4 + 6 g^5`, flat at both ends, by the power of `g`.
const WEIGHTS: [f64; 5] = [0.0, 0.0, 10.0, -15.0, 6.0];
/// What joints may add in a step to the energy of motion against each other, as errors of second
/// order do, where they do not contradict each other: a rod far shorter than its ends move in a
/// substep adds more.
const MAX_SHARE: f64 = 0.1;
/// What is less is rounding, and raises rows by no more than they are: of the size of the arms or
/// [rad].
pub(super) const MIN_MISFIT: f64 = 3e-7;
/// A load is the heaviest body of a mechanism, or all of more than this many together: by as much
/// as a joint's lightest body is lighter its rows are softened less, down to a part.
const MANY: f64 = 8.0;
const MIN_PART: f64 = 1e-3;
/// By how much of its trace the inertia of bodies in one line is raised.
const RAISED: f64 = 1e-8;

impl MechanismSolver {
    /// Softens the rows of joints that are not met where the substep begins, where they may
    /// contradict others: in loops all, elsewhere those of limits beside others of the same joint.
    /// A weight behind light links responds by as little as joints that contradict each other, so
    /// rows of light bodies are softened by less.
    pub(super) fn soften(&mut self) {
        let Self { joints, bodies, matrix, is_touched, .. } = self;
        self.is_softened = false;
        if !matrix.may_depend() {
            return;
        }
        let has_loops = matrix.has_loops();
        let masses = || bodies.iter().filter(|body| body.is_moved()).map(MechanismBody::mass);
        let heavy = masses().fold(masses().sum::<f64>() / MANY, f64::max);
        for (number, joint) in joints.iter().enumerate() {
            let misfit = if has_loops || joint.has_dependent_limits() { joint.misfit() } else { 0.0 };
            let is_soft = misfit > MIN_MISFIT;
            self.is_softened |= is_soft;
            let rows = (number, if has_loops { 0 } else { joint.locked });
            let part = joint.ends().map(|body| &bodies[body]).filter(|body| body.is_moved());
            let part = part.map(MechanismBody::mass).fold(heavy, f64::min) / heavy;
            matrix.soften(rows, if is_soft { misfit } else { 0.0 }, (part.max(MIN_PART), *is_touched));
        }
    }

    /// Solves for the impulses that change the rows' speeds by the right side, in its place.
    ///
    /// Where rows depend on others, what contradicts itself in the right side would become great
    /// impulses against each other. To see what speeds the solution gives, and to solve for these,
    /// leaves it out.
    pub(super) fn solve_right_side(&mut self) {
        if self.is_softened {
            self.solve_softened();
            return;
        }
        self.matrix.solve(&mut self.right);
        if self.matrix.has_dependent_rows {
            self.set_given();
            self.right.copy_from_slice(&self.response);
            self.matrix.solve(&mut self.right);
        }
    }

    /// The same where rows are raised by much: the sum of repeated solutions by [`WEIGHTS`].
    fn solve_softened(&mut self) {
        self.asked.copy_from_slice(&self.right);
        self.solved.fill([0.0; 4]);
        for (number, weight) in WEIGHTS.into_iter().enumerate() {
            if number > 0 {
                self.set_given();
                self.right.copy_from_slice(&self.response);
            }
            self.matrix.solve(&mut self.right);
            let terms = self.right.as_flattened().iter().zip(self.solved.as_flattened_mut());
            terms.for_each(|(term, sum)| *sum += weight * term);
        }
        self.right.copy_from_slice(&self.solved);
        self.set_given();
        self.note_contradiction();
    }

    /// Sets the speeds that the solution on the right side gives, where rows of free axes are
    /// springs with what these take.
    fn set_given(&mut self) {
        self.set_response();
        let Self { joints, matrix, right, response, .. } = self;
        let (impulses, response) = (right.as_flattened(), response.as_flattened_mut());
        for (number, joint) in joints.iter().enumerate() {
            let rows = matrix.place(number) + joint.locked..;
            for (place, row) in rows.zip(&joint.free_rows) {
                let is_off = row.constant.is_some();
                response[place] = if is_off { 0.0 } else { response[place] + row.gamma * impulses[place] };
            }
        }
    }

    /// Notes how much of the speeds that were asked for no impulses give, of the size of the arms.
    fn note_contradiction(&mut self) {
        let (asked, given) = (self.asked.as_flattened(), self.response.as_flattened());
        let mut most = 0.0_f64;
        for (number, joint) in self.joints.iter().enumerate() {
            let begin = self.matrix.place(number);
            most = most.max(joint.largest(|row| asked[begin + row] - given[begin + row]));
        }
        self.contradiction = most;
    }

    /// Kinetic energy of the bodies that impulses move, with the moments that they have now \[J\].
    pub(super) fn kinetic_energy(&self) -> f64 {
        let moving = self.bodies.iter().filter(|body| body.is_moved());
        moving.map(MechanismBody::kinetic_energy).sum()
    }

    /// Takes back what joints that contradict each other have added to the energy in this step,
    /// from the motion of bodies against each other: no momentum, and no joint, resists that.
    pub(super) fn take_back_gain(&mut self) {
        let gives_energy = |row: &FreeRow| !row.is_passive();
        let is_driven = self.joints.iter().flat_map(|joint| &joint.free_rows).any(gives_energy)
            || self.bodies.iter().any(|body| !body.is_moved() && body.is_moving());
        if self.gain <= 0.0 || is_driven {
            return;
        }
        let lock = self.lock_of_free();
        let rigid = self.free_bodies().map_or(Some(Rigid::AT_REST), |bodies| Rigid::of(bodies, lock));
        let Some(rigid) = rigid else { return };
        let moving = self.bodies.iter().filter(|body| body.is_moved());
        let velocities = |body: &MechanismBody| (rigid.velocity_at(body.position()), rigid.angular);
        let within: f64 = moving.map(|body| body.kinetic_energy_against(velocities(body))).sum();
        if !(self.contradicts || self.gain > MAX_SHARE * within) {
            return;
        }
        let kept = if self.gain < within { (1.0 - self.gain / within).sqrt() } else { 0.0 };
        for body in self.bodies.iter_mut().filter(|body| body.is_moved()) {
            body.keep_of_motion(kept, velocities(body));
        }
    }
}

/// A motion of the whole.
pub(super) struct Rigid {
    center: Vec3<f64>,
    linear: Vec3<f64>,
    angular: Vec3<f64>,
}

impl Rigid {
    const AT_REST: Self = {
        let zero = Vec3 { x: 0.0, y: 0.0, z: 0.0 };
        Self { center: zero, linear: zero, angular: zero }
    };

    /// The one with the momenta that bodies have together, with their own moments, along and about
    /// free axes.
    fn of(bodies: &[MechanismBody], lock: AxisLock) -> Option<Self> {
        let mass: f64 = bodies.iter().map(MechanismBody::mass).sum();
        let sum = |of_body: &dyn Fn(&MechanismBody) -> Vec3<f64>| {
            bodies.iter().fold(Vec3::zero(), |sum: Vec3<f64>, body| sum + of_body(body))
        };
        let center = sum(&|body| body.position() * body.mass()) * (1.0 / mass);
        let linear = lock.along_free((sum(&|body| body.linear()) * (1.0 / mass)).into()).into();
        let momentum = sum(&|body| (body.position() - center).cross(body.linear()) + body.angular());
        let angular = turned_by(bodies, center, momentum, lock)?;
        Some(Self { center, linear, angular })
    }

    fn velocity_at(&self, position: Vec3<f64>) -> Vec3<f64> {
        self.linear + self.angular.cross(position - self.center)
    }
}

/// Gives bodies that fly free angular momentum, as a rotation of the whole about free axes.
pub(crate) fn return_momentum(bodies: &mut [MechanismBody], momentum: Vec3<f64>, lock: AxisLock) {
    let mass: f64 = bodies.iter().map(MechanismBody::mass).sum();
    let moment = bodies.iter().fold(Vec3::zero(), |sum, body| sum + body.position() * body.mass());
    let center = moment * (1.0 / mass);
    if let Some(turn) = turned_by(bodies, center, momentum, lock) {
        bodies.iter_mut().for_each(|body| body.turn_along(turn, body.position() - center));
    }
}

/// The angular velocity that angular momentum about a point gives bodies that are one, about axes
/// that are free.
fn turned_by(bodies: &[MechanismBody], center: Vec3<f64>, momentum: Vec3<f64>, lock: AxisLock) -> Option<Vec3<f64>> {
    let mut inertia = glam::DMat3::ZERO;
    for body in bodies {
        let arm = glam::DVec3::from(body.position() - center);
        let [d, o] = body.own_inertia().map(glam::DVec3::from);
        let own = glam::DMat3::from_cols_array(&[d.x, o.z, o.y, o.z, d.y, o.x, o.y, o.x, d.z]);
        let square = glam::DMat3::from_diagonal(glam::DVec3::splat(arm.length_squared()));
        let product = glam::DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
        inertia += own + (square - product) * body.mass();
    }
    let momentum = glam::DVec3::from(momentum);
    let trace = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
    let raised = inertia + glam::DMat3::from_diagonal(glam::DVec3::splat(RAISED * trace));
    let inverse = lock.inverse_inertia(raised);
    let turn = inverse * momentum;
    let turn = turn + inverse * (momentum - inertia * turn);
    turn.is_finite().then(|| turn.into())
}
