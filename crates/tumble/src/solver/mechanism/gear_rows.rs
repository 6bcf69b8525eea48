//! The row of a gear: a joint's free axis, and one of another, move by a ratio.

use std::f64::consts::TAU;

use tumble_math::lane::Vec3;

use crate::joints::joint_list::ListedGear;
use crate::solver::mechanism::free_axis::{FreeAxis, wrapped};
use crate::solver::mechanism::joint_rows::JointRows;
use crate::solver::mechanism::mechanism_body::MechanismBody;

/// A gear between two joints of a mechanism: one row that acts on the bodies of both.
#[derive(Clone, Debug)]
pub(crate) struct GearRows {
    /// Where each joint stands; they have no rows of their own here.
    pub(crate) joints: [JointRows; 2],
    axes: [FreeAxis; 2],
    /// By joint, how much the row's error changes with its value.
    factors: [f64; 2],
    offset: f64,
    /// By joint, the middle of the range in which its angle is, where it cannot go round.
    middles: [Option<f64>; 2],
    /// By what the error may be off, as angles go round.
    period: f64,
    /// The error at the start of the step that is left.
    start: f64,
    /// By joint, the directions in which its second body is pushed, times its factor.
    pub(crate) linear: [Vec3<f64>; 2],
    pub(crate) angular: [Vec3<f64>; 2],
}

/// The largest denominator of a ratio of teeth.
const MAX_TEETH: u32 = 64;

impl GearRows {
    pub(crate) fn new(joints: [JointRows; 2], gear: &ListedGear) -> Self {
        let zero = Vec3::zero();
        let mut it = Self {
            joints,
            axes: gear
                .axes
                .map(|axis| if axis < 3 { FreeAxis::Translation(axis) } else { FreeAxis::Rotation(axis - 3) }),
            factors: [0.0; 2],
            offset: 0.0,
            middles: [None; 2],
            period: f64::INFINITY,
            start: 0.0,
            linear: [zero; 2],
            angular: [zero; 2],
        };
        it.take_numbers(gear);
        it
    }

    /// Whether its second value, and so its error, is a translation.
    pub(crate) fn is_linear(&self) -> bool {
        self.axes[1].is_linear()
    }

    /// Takes over ratio, offset and ranges.
    pub(crate) fn take_numbers(&mut self, gear: &ListedGear) {
        self.factors = [-gear.ratio, 1.0];
        self.offset = gear.offset;
        self.middles = gear.middles;
        let goes_round = [0, 1].map(|end| !self.axes[end].is_linear() && gear.middles[end].is_none());
        self.period = match goes_round {
            [false, false] => f64::INFINITY,
            [false, true] => TAU,
            [true, false] => TAU * gear.ratio.abs(),
            [true, true] => {
                let whole = |teeth: &u32| {
                    let product = gear.ratio * f64::from(*teeth);
                    (product - product.round()).abs() <= 1e-6 * product.abs()
                };
                (1..=MAX_TEETH).find(whole).map_or(0.0, |teeth| TAU / f64::from(teeth))
            }
        };
    }

    /// Sets the directions to where the bodies are.
    pub(crate) fn update(&mut self, bodies: &[MechanismBody]) {
        for end in 0..2 {
            let joint = &mut self.joints[end];
            joint.update(bodies);
            let direction = joint.direction(self.axes[end], bodies);
            self.linear[end] = direction.linear * self.factors[end];
            self.angular[end] = direction.angular * self.factors[end];
        }
    }

    /// How far the values are from the ratio, by as little as angles that go round allow.
    fn error(&self, bodies: &[MechanismBody]) -> f64 {
        let mut error = -self.offset;
        for end in 0..2 {
            let value = self.joints[end].direction(self.axes[end], bodies).value;
            let value = self.middles[end].map_or(value, |middle| middle + wrapped(value - middle));
            error += self.factors[end] * value;
        }
        if self.period > 0.0 && self.period.is_finite() {
            error -= self.period * (error / self.period).round();
        }
        error
    }

    /// The same less the error that is left from the start of the step.
    pub(crate) fn error_since_start(&self, bodies: &[MechanismBody]) -> f64 {
        let error = self.error(bodies) - self.start;
        if self.period > 0.0 {
            return error;
        }
        // Either angle may have gone past half a turn.
        let turns = [-TAU, 0.0, TAU];
        let by_turns = |first: f64| turns.map(|second| error + first * self.factors[0] + second);
        let all = turns.into_iter().flat_map(by_turns);
        all.fold(error, |least, other| if other.abs() < least.abs() { other } else { least })
    }

    /// Leaves the error there is where it says nothing of where the joints should be.
    pub(crate) fn begin_step(&mut self, bodies: &[MechanismBody]) {
        self.joints.iter_mut().for_each(|joint| joint.begin_step(bodies));
        self.start = if self.period == 0.0 { self.error(bodies) } else { 0.0 };
    }

    /// The speed of its error, by the linear and angular velocities of bodies.
    pub(crate) fn speed(&self, velocities: impl Fn(usize) -> [Vec3<f64>; 2]) -> f64 {
        let mut speed = 0.0;
        for (end, joint) in self.joints.iter().enumerate() {
            let [apart, turn] = joint.relative_velocity(&velocities);
            speed += self.linear[end].dot(apart) + self.angular[end].dot(turn);
        }
        speed
    }

    /// Calls for each of the four ends with its body, its arm, and the impulse and angular impulse
    /// of an amount along the row.
    pub(crate) fn for_each_end(&self, amount: f64, mut then: impl FnMut(usize, Vec3<f64>, Vec3<f64>, Vec3<f64>)) {
        for (end, joint) in self.joints.iter().enumerate() {
            let (linear, angular) = (self.linear[end] * amount, self.angular[end] * amount);
            then(joint.bodies[0], joint.arm(0), linear * -1.0, angular * -1.0);
            then(joint.bodies[1], joint.arm(1), linear, angular);
        }
    }
}
