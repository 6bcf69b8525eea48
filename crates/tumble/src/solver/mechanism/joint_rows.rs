//! The rows of a joint: along what it pushes, and how far it is from being met.

use tumble_math::lane::{Quat, Vec3};

use crate::joints::axes::Axes;
use crate::math::Real;
use crate::solver::mechanism::block_ldl::MAX_ROWS;
use crate::solver::mechanism::mechanism_body::MechanismBody;

/// The frame of a joint on one of its bodies: origin \[m\] from the centre of mass and orientation,
/// along the axes that the body's orientation goes by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anchor {
    pub(crate) position: Vec3<f64>,
    pub(crate) orientation: Quat<f64>,
}

/// A joint between two bodies of a mechanism, as a node of its matrix.
#[derive(Clone, Debug)]
pub(crate) struct JointRows {
    /// Among those of the mechanism.
    pub(crate) bodies: [usize; 2],
    pub(crate) anchors: [Anchor; 2],
    free: Axes,
    /// Along what each row pushes, and about what it turns besides; world frame.
    pub(crate) linear: [Vec3<f64>; MAX_ROWS],
    pub(crate) angular: [Vec3<f64>; MAX_ROWS],
    pub(crate) count: usize,
    /// From each centre of mass to the point where both bodies are pushed \[m\].
    pub(crate) arms: [Vec3<f64>; 2],
    /// From the second body's anchor to that point \[m\].
    pub(crate) from_anchor: Vec3<f64>,
    /// By row: how far it is from being met, \[m\] or roughly \[rad\], where rows were set.
    pub(crate) errors: [f64; MAX_ROWS],
    /// By row: error at the start of the step that rounding of the state explains.
    rounding: [f64; MAX_ROWS],
    /// By row: error that is left for the steps after this substep.
    pub(crate) wanted: [f64; MAX_ROWS],
}

/// A joint as it stands: what rows and errors are made of.
struct Stance {
    /// From each centre of mass to its anchor \[m\].
    anchor_arms: [Vec3<f64>; 2],
    /// From the first anchor to the second \[m\].
    gap: Vec3<f64>,
    orientations: [Quat<f64>; 2],
    axes: [[Vec3<f64>; 3]; 2],
}

/// Speeds at which errors are taken out that a joint begins with [m/s] [rad/s].
const CORRECTION_SPEED: f64 = 3.0;
const CORRECTION_ANGULAR_SPEED: f64 = 10.0;
/// Roundings of the state within which a joint is met.
const ROUNDINGS: f64 = 4.0;

impl JointRows {
    pub(crate) fn new(bodies: [usize; 2], anchors: [Anchor; 2], free: Axes) -> Self {
        let zero = Vec3::zero();
        Self {
            bodies,
            anchors,
            free,
            linear: [zero; MAX_ROWS],
            angular: [zero; MAX_ROWS],
            count: 6 - free.count() as usize,
            arms: [zero; 2],
            from_anchor: zero,
            errors: [0.0; MAX_ROWS],
            rounding: [0.0; MAX_ROWS],
            wanted: [0.0; MAX_ROWS],
        }
    }

    fn stance(&self, bodies: &[MechanismBody]) -> Stance {
        let [a, b] = self.bodies.map(|body| &bodies[body]);
        let arms = [a.orientation.rotate(self.anchors[0].position), b.orientation.rotate(self.anchors[1].position)];
        let gap = (b.center - a.center) + (b.translation - a.translation) + (arms[1] - arms[0]);
        if self.is_ball() {
            let none = [Vec3::zero(); 3];
            return Stance { anchor_arms: arms, gap, orientations: [a.orientation, b.orientation], axes: [none; 2] };
        }
        self.turned_stance(bodies, arms, gap)
    }

    /// Whether its rows do not depend on how its frames are turned.
    fn is_ball(&self) -> bool {
        self.free == Axes::ANGULAR
    }

    fn turned_stance(&self, bodies: &[MechanismBody], anchor_arms: [Vec3<f64>; 2], gap: Vec3<f64>) -> Stance {
        let [a, b] = self.bodies.map(|body| &bodies[body]);
        let orientations = [a.orientation * self.anchors[0].orientation, b.orientation * self.anchors[1].orientation];
        Stance { anchor_arms, gap, orientations, axes: orientations.map(Quat::axes) }
    }

    /// How many rows push along a line; they are the first.
    pub(crate) fn linear_count(&self) -> usize {
        (0..3).filter(|axis| !self.free.has(*axis)).count()
    }

    /// Sets the rows, and their errors, to where the bodies are.
    pub(crate) fn update(&mut self, bodies: &[MechanismBody]) {
        let stance = self.stance(bodies);
        let [a, b] = stance.axes;
        let zero = Vec3::zero();
        let mut row = 0;
        let mut locked_gap = zero;
        for axis in (0..3).filter(|axis| !self.free.has(*axis)) {
            let along = linear_axis(self.free, axis, &a);
            (self.linear[row], self.angular[row]) = (along, zero);
            locked_gap = locked_gap + along * along.dot(stance.gap);
            row += 1;
        }
        let half = locked_gap * 0.5;
        self.arms = [stance.anchor_arms[0] + stance.gap - half, stance.anchor_arms[1] - half];
        self.from_anchor = half * -1.0;
        self.linear[row..self.count].fill(zero);
        match self.rotations() {
            Rotations::Locked => self.angular[row..row + 3].copy_from_slice(&a),
            Rotations::About(k) => {
                (self.angular[row], self.angular[row + 1]) = (a[(k + 1) % 3], a[(k + 2) % 3]);
            }
            Rotations::AboutBoth(i, j) => self.angular[row] = b[j].cross(a[i]),
            Rotations::Free => {}
        }
        self.errors = self.errors_of(&stance);
    }

    /// The errors where the bodies are.
    pub(crate) fn errors(&self, bodies: &[MechanismBody]) -> [f64; MAX_ROWS] {
        self.errors_of(&self.stance(bodies))
    }

    fn errors_of(&self, stance: &Stance) -> [f64; MAX_ROWS] {
        let mut errors = [0.0; MAX_ROWS];
        let [a, b] = &stance.axes;
        let mut row = 0;
        for axis in (0..3).filter(|axis| !self.free.has(*axis)) {
            errors[row] = stance.gap.dot(linear_axis(self.free, axis, a));
            row += 1;
        }
        match self.rotations() {
            Rotations::Locked => {
                let q = stance.orientations[0].conjugate() * stance.orientations[1];
                let twice = if q.w < 0.0 { -2.0 } else { 2.0 };
                errors[row..row + 3].copy_from_slice(&[q.x * twice, q.y * twice, q.z * twice]);
            }
            Rotations::About(k) => {
                let bent = a[k].cross(b[k]);
                errors[row] = bent.dot(a[(k + 1) % 3]);
                errors[row + 1] = bent.dot(a[(k + 2) % 3]);
            }
            Rotations::AboutBoth(i, j) => errors[row] = a[i].dot(b[j]),
            Rotations::Free => {}
        }
        for (error, rounding) in errors.iter_mut().zip(&self.rounding) {
            *error -= rounding;
        }
        errors
    }

    /// Notes which of the errors there are at the start of a step are rounding of the state.
    pub(crate) fn begin_step(&mut self, bodies: &[MechanismBody]) {
        self.rounding = [0.0; MAX_ROWS];
        let errors = self.errors(bodies);
        let [a, b] = self.bodies.map(|body| &bodies[body]);
        let most = [a.center, b.center, self.anchors[0].position, self.anchors[1].position].map(length);
        let of_state = ROUNDINGS * f64::from(Real::EPSILON);
        let tolerances = [of_state * most.into_iter().sum::<f64>(), of_state];
        let linear = self.linear_count();
        for (row, error) in errors.into_iter().enumerate() {
            if error.abs() <= tolerances[usize::from(row >= linear)] {
                self.rounding[row] = error;
            }
        }
    }

    /// Sets what is left of the errors after a substep of `h` \[s\].
    pub(crate) fn plan_correction(&mut self, h: f64) {
        let linear = self.linear_count();
        for (row, (wanted, error)) in self.wanted.iter_mut().zip(&self.errors).enumerate() {
            let most = h * if row < linear { CORRECTION_SPEED } else { CORRECTION_ANGULAR_SPEED };
            *wanted = error - error.clamp(-most, most);
        }
    }

    /// How fast each error grows by the velocities of the bodies.
    pub(crate) fn speeds(&self, bodies: &[MechanismBody]) -> [f64; MAX_ROWS] {
        self.speeds_at(self.bodies.map(|body| [bodies[body].linear_velocity(), bodies[body].angular_velocity()]))
    }

    /// The same by linear and angular velocities of both bodies.
    pub(crate) fn speeds_at(&self, [a, b]: [[Vec3<f64>; 2]; 2]) -> [f64; MAX_ROWS] {
        let apart = (b[0] + b[1].cross(self.arms[1])) - (a[0] + a[1].cross(self.arms[0]));
        let turn = b[1] - a[1];
        let mut speeds = [0.0; MAX_ROWS];
        for (row, speed) in speeds.iter_mut().enumerate().take(self.count) {
            *speed = self.linear[row].dot(apart) + self.angular[row].dot(turn);
        }
        speeds
    }

    /// The impulse and the angular impulse on the second body of impulses along the rows.
    pub(crate) fn impulse(&self, along: &[f64]) -> [Vec3<f64>; 2] {
        let mut sum = [Vec3::zero(); 2];
        for (row, amount) in along.iter().enumerate() {
            sum[0] = sum[0] + self.linear[row] * *amount;
            sum[1] = sum[1] + self.angular[row] * *amount;
        }
        sum
    }

    /// Where the second frame is against the first, along the axes of the first, and how fast it
    /// moves: translation \[m\], rotation vector \[rad\].
    pub(crate) fn values_and_speeds(&self, bodies: &[MechanismBody]) -> [[f64; 6]; 2] {
        let Stance { gap, anchor_arms, .. } = self.stance(bodies);
        let Stance { orientations, axes: [axes, _], .. } = self.turned_stance(bodies, anchor_arms, gap);
        let q = orientations[0].conjugate() * orientations[1];
        let turn = tumble_math::to_scaled_axis(q.into());
        let [a, b] = self.bodies.map(|body| &bodies[body]);
        let (turn_a, turn_b) = (a.angular_velocity(), b.angular_velocity());
        let apart = (b.linear_velocity() + turn_b.cross(anchor_arms[1]))
            - (a.linear_velocity() + turn_a.cross(anchor_arms[0] + gap));
        let turning = turn_b - turn_a;
        let along = |v: Vec3<f64>| axes.map(|axis| axis.dot(v));
        let ([x, y, z], [u, v, w], [p, q, r]) = (along(gap), along(apart), along(turning));
        [[x, y, z, turn.x, turn.y, turn.z], [u, v, w, p, q, r]]
    }

    fn rotations(&self) -> Rotations {
        let free = |axis: usize| self.free.has(3 + axis);
        match (0..3).filter(|axis| free(*axis)).count() {
            0 => Rotations::Locked,
            1 => Rotations::About(if free(0) {
                0
            } else if free(1) {
                1
            } else {
                2
            }),
            2 => {
                let [i, j] = if !free(0) {
                    [1, 2]
                } else if !free(1) {
                    [0, 2]
                } else {
                    [0, 1]
                };
                Rotations::AboutBoth(i, j)
            }
            _ => Rotations::Free,
        }
    }
}

/// Which rotations a joint leaves free.
enum Rotations {
    Locked,
    About(usize),
    /// About an axis of the first frame, and another of the second.
    AboutBoth(usize, usize),
    Free,
}

/// Along which a translation is locked: where all are, those of the world do as well.
fn linear_axis(free: Axes, axis: usize, of_first: &[Vec3<f64>; 3]) -> Vec3<f64> {
    if free.has(0) || free.has(1) || free.has(2) {
        return of_first[axis];
    }
    let mut unit = [0.0; 3];
    unit[axis] = 1.0;
    let [x, y, z] = unit;
    Vec3::new(x, y, z)
}

pub(crate) fn length(v: Vec3<f64>) -> f64 {
    v.dot(v).sqrt()
}
