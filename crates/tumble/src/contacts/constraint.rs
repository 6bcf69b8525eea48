use tumble_collide::{MOST_POINTS, Manifold};
use tumble_math::lane::{Lane, Vec3};

use super::body::{Relative, SolverBody};
use super::friction::Friction;
use super::material::Surface;
use super::row::Row;
use super::soft::Softness;
use crate::math::Real;

/// Two bodies that touch, as a small problem in a frame of its own: impulses along the normal at up to four points, and in one point in
/// their middle friction and what resists turning.
///
/// Both bodies are pushed at one point of the world with equal and opposite impulses, so that momentum and angular momentum of the two are
/// kept to rounding. With the middle `c`, the normal `n` from the first body to the second and the tangents `t1`, `t2 = n x t1`, the relative velocity along the normal at
/// the point `c + a t1 + b t2` is `n.u - a t2.r + b t1.r`, where `u` is the relative velocity at `c` and `r` the relative angular velocity.
pub(super) struct Constraint {
    /// Of both bodies.
    pub(super) slots: [usize; 2],
    pub(super) normal: Vec3<Real>,
    pub(super) tangents: [Vec3<Real>; 2],
    /// The middle from both centres of mass as they are now \[m\].
    pub(super) arms: [Vec3<Real>; 2],
    /// The same when the step began.
    first_arms: [Vec3<Real>; 2],
    /// How far the middle goes with the second body when it moves past the first, from 0 to 1.
    carried: Real,
    rows: [Row; MOST_POINTS],
    count: usize,
    /// Velocity at the second of two rows that a unit impulse at the first gives [1/kg].
    coupling: [[Real; MOST_POINTS]; MOST_POINTS],
    pub(super) friction: Friction,
    restitution: Real,
    softness: Softness,
}

/// How a pass takes overlaps.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Pass {
    /// Pushes bodies apart.
    Biased,
    /// Takes out again the velocity that this gave, and adds friction.
    Relaxing,
}

/// Weight of a point in the middle at the least, so that a middle there is.
const LEAST_WEIGHT: Real = 1e-10;

impl Constraint {
    pub(super) fn new(
        slots: [usize; 2],
        bodies: [&SolverBody; 2],
        manifold: &Manifold<Real>,
        surface: &Surface,
        (margin, softness): (Real, Softness),
    ) -> Self {
        let [first, second] = bodies;
        let normal = manifold.normal;
        let tangents = tangents(normal);
        // A point that comes into reach has no weight yet, so the middle does not jump.
        let weight = |separation: Real| (2.0 - separation / margin).max(LEAST_WEIGHT).min(1.0);
        let (mut sum, mut total) = (Vec3::zero(), 0.0);
        for point in manifold.points() {
            let weight = weight(point.separation);
            sum = sum + (point.position - first.state.position) * weight;
            total += weight;
        }
        let from_first = sum * (1.0 / total);
        let middle = first.state.position + from_first;
        let arms = [from_first, from_first + (first.state.position - second.state.position)];
        let at_rest = Row {
            a: 0.0,
            b: 0.0,
            separation: 0.0,
            mass: 0.0,
            impulse: 0.0,
            most_impulse: 0.0,
            approach: 0.0,
            feature: 0,
        };
        let mut this = Self {
            slots,
            normal,
            tangents,
            arms,
            first_arms: arms,
            carried: manifold.carried,
            rows: [at_rest; MOST_POINTS],
            count: manifold.points().len(),
            coupling: [[0.0; MOST_POINTS]; MOST_POINTS],
            friction: Friction::NONE,
            restitution: surface.restitution,
            softness,
        };
        for (row, point) in this.rows.iter_mut().zip(manifold.points()) {
            let from_middle = point.position - middle;
            let (a, b) = (tangents[0].dot(from_middle), tangents[1].dot(from_middle));
            *row = Row { a, b, separation: point.separation, feature: point.feature, ..at_rest };
        }
        this.prepare(bodies);
        this.friction = Friction::new(&this, bodies, surface);
        this
    }

    fn prepare(&mut self, bodies: [&SolverBody; 2]) {
        let [first, second] = bodies;
        let turning = |row: &Row| {
            let offset = self.tangents[0] * row.b - self.tangents[1] * row.a;
            self.arms.map(|arm| arm.cross(self.normal) + offset)
        };
        let turnings: [[Vec3<Real>; 2]; MOST_POINTS] = std::array::from_fn(|j| turning(&self.rows[j]));
        for j in 0..self.count {
            let responses = [first.response(turnings[j][0]), second.response(turnings[j][1])];
            for k in j..self.count {
                self.coupling[j][k] = first.inverse_mass
                    + second.inverse_mass
                    + turnings[k][0].dot(responses[0])
                    + turnings[k][1].dot(responses[1]);
            }
        }
        let relative = self.velocity(bodies);
        let approaches: [Real; MOST_POINTS] = std::array::from_fn(|j| self.along_normal(&self.rows[j], &relative));
        for (j, row) in self.rows.iter_mut().enumerate().take(self.count) {
            let inverse = self.coupling[j][j];
            row.mass = if inverse > 0.0 { 1.0 / inverse } else { 0.0 };
            row.approach = approaches[j];
        }
    }

    /// The rows there are.
    pub(super) fn rows(&self) -> &[Row] {
        &self.rows[..self.count]
    }

    pub(super) fn rows_mut(&mut self) -> &mut [Row] {
        &mut self.rows[..self.count]
    }

    /// Where the point of a row is from the first body's centre of mass, when the step began \[m\].
    pub(super) fn place_of(&self, row: usize) -> Vec3<Real> {
        self.first_arms[0] + self.tangents[0] * self.rows[row].a + self.tangents[1] * self.rows[row].b
    }

    /// Begins with friction as it was, in the frame that the contact has now.
    pub(super) fn hold_friction(&mut self, sliding: Vec3<Real>, turning: Vec3<Real>) {
        let along = |v: Vec3<Real>| self.tangents.map(|tangent| tangent.dot(v));
        (self.friction.sliding, self.friction.roll) = (along(sliding), along(turning));
        self.friction.twist = self.normal.dot(turning);
    }

    /// Sum of the impulses along the normal \[N s\].
    pub(super) fn normal_impulse(&self) -> Real {
        self.rows().iter().fold(0.0, |sum, row| sum + row.impulse)
    }

    /// Velocity of the second body relative to the first, at the middle.
    pub(super) fn velocity(&self, [first, second]: [&SolverBody; 2]) -> Relative {
        let of = |body: &SolverBody| Relative { linear: body.derived.linear, angular: body.derived.angular };
        relative([of(first), of(second)], self.arms)
    }

    /// How far the second body moved relative to the first since the step began.
    fn displacement(&self, [first, second]: [&SolverBody; 2]) -> Relative {
        relative([first.displacement, second.displacement], self.first_arms)
    }

    /// Both arms to one point of the world again, after the bodies have moved past each other. Impulses that are equal and opposite there keep the
    /// angular momentum.
    pub(super) fn follow(&mut self, [first, second]: [&SolverBody; 2]) {
        let apart = second.displacement.linear - first.displacement.linear;
        self.arms = [self.first_arms[0] + apart * self.carried, self.first_arms[1] - apart * (1.0 - self.carried)];
    }

    /// Along the normal at a row's point.
    fn along_normal(&self, row: &Row, motion: &Relative) -> Real {
        self.normal.dot(motion.linear) - row.a * self.tangents[1].dot(motion.angular)
            + row.b * self.tangents[0].dot(motion.angular)
    }

    /// Applies impulses of the rows, and one in the tangent plane at the middle with a twist about the normal.
    pub(super) fn push(
        &self,
        [first, second]: [&mut SolverBody; 2],
        along_normal: [Real; MOST_POINTS],
        tangential: Vec3<Real>,
        turning: Vec3<Real>,
    ) {
        let (mut sum, mut about_1, mut about_2) = (0.0, 0.0, 0.0);
        for (row, impulse) in self.rows().iter().zip(along_normal) {
            sum += impulse;
            about_1 += row.b * impulse;
            about_2 += row.a * impulse;
        }
        let linear = self.normal * sum + tangential;
        let angular = self.tangents[0] * about_1 - self.tangents[1] * about_2 + turning;
        first.push(linear * -1.0, (self.arms[0].cross(linear) + angular) * -1.0);
        second.push(linear, self.arms[1].cross(linear) + angular);
    }

    /// Applies all impulses as they are, those that the last substep ended with: where nothing changes they are what this one needs.
    pub(super) fn warm_start(&self, bodies: [&mut SolverBody; 2]) {
        let impulses = std::array::from_fn(|j| self.rows[j].impulse);
        self.push(bodies, impulses, self.friction.linear(self), self.friction.turning(self));
    }

    /// One pass over the rows, in order; in the relaxing one, friction after them.
    pub(super) fn solve(&mut self, bodies: [&mut SolverBody; 2], pass: Pass, h: Real) {
        let [first, second] = bodies;
        let motion = self.velocity([first, second]);
        let moved = self.displacement([first, second]);
        let softness = self.softness;
        let mut speeds: [Real; MOST_POINTS] = std::array::from_fn(|j| self.along_normal(&self.rows[j], &motion));
        let mut changes = [0.0; MOST_POINTS];
        for j in 0..self.count {
            let separation = self.rows[j].separation + self.along_normal(&self.rows[j], &moved);
            let row = &mut self.rows[j];
            // What is apart may come as near in a substep as it is apart.
            let (bias, mass_scale, impulse_scale) = match pass {
                _ if separation > 0.0 => (separation / h, 1.0, 0.0),
                Pass::Biased => (softness.bias(separation), softness.mass_scale, softness.impulse_scale),
                Pass::Relaxing => (0.0, 1.0, 0.0),
            };
            let wanted = row.impulse - (mass_scale * speeds[j] + bias) * row.mass - impulse_scale * row.impulse;
            let impulse = wanted.max(0.0);
            changes[j] = impulse - row.impulse;
            row.impulse = impulse;
            row.most_impulse = row.most_impulse.max(impulse);
            for k in j + 1..self.count {
                speeds[k] += self.coupling[j][k] * changes[j];
            }
        }
        self.push([first, second], changes, Vec3::zero(), Vec3::zero());
        if pass == Pass::Relaxing {
            let limit = self.normal_impulse();
            self.rub([first, second], limit);
        }
    }

    /// Notes how fast the bodies come together, before a pass pushes anything: they may have been kicked since the step began.
    pub(super) fn note_approach(&mut self, bodies: [&SolverBody; 2]) {
        if self.restitution > 0.0 {
            let motion = self.velocity(bodies);
            let speeds: [Real; MOST_POINTS] = std::array::from_fn(|j| self.along_normal(&self.rows[j], &motion));
            for (row, speed) in self.rows_mut().iter_mut().zip(speeds) {
                row.approach = row.approach.min(speed);
            }
        }
    }

    /// Friction, with what the normal impulses give it to hold by.
    fn rub(&mut self, [first, second]: [&mut SolverBody; 2], normal_impulse: Real) {
        let motion = self.velocity([first, second]);
        let mut friction = self.friction;
        let (linear, turning) = friction.solve(self, &motion, normal_impulse);
        self.friction = friction;
        self.push([first, second], [0.0; MOST_POINTS], linear, turning);
    }

    /// Makes points leave as fast as the restitution has it, where they came in faster than `threshold` \[m/s\], with the friction that the
    /// added impulse allows.
    pub(super) fn bounce(&mut self, bodies: [&mut SolverBody; 2], threshold: Real) {
        if self.restitution <= 0.0 {
            return;
        }
        let [first, second] = bodies;
        let motion = self.velocity([first, second]);
        let mut speeds: [Real; MOST_POINTS] = std::array::from_fn(|j| self.along_normal(&self.rows[j], &motion));
        let mut changes = [0.0; MOST_POINTS];
        let mut added = 0.0;
        for j in 0..self.count {
            let row = &mut self.rows[j];
            if row.approach < -threshold && row.most_impulse > 0.0 {
                let wanted = row.impulse - (speeds[j] + self.restitution * row.approach) * row.mass;
                let impulse = wanted.max(0.0);
                changes[j] = impulse - row.impulse;
                row.impulse = impulse;
                row.most_impulse = row.most_impulse.max(impulse);
                added += changes[j];
                for k in j + 1..self.count {
                    speeds[k] += self.coupling[j][k] * changes[j];
                }
            }
        }
        self.push([first, second], changes, Vec3::zero(), Vec3::zero());
        if added > 0.0 {
            let before = self.friction;
            self.friction = before.released();
            self.rub([first, second], added);
            self.friction = before;
        }
    }
}

/// The motion of the second of two bodies seen from the first, at the end of both arms.
fn relative([first, second]: [Relative; 2], arms: [Vec3<Real>; 2]) -> Relative {
    let at = |motion: &Relative, arm| motion.linear + motion.angular.cross(arm);
    Relative { linear: at(&second, arms[1]) - at(&first, arms[0]), angular: second.angular - first.angular }
}

/// Two unit vectors, each perpendicular to the other and to `n`: the first as near as it can be to the axis that `n` is farthest from.
fn tangents(n: Vec3<Real>) -> [Vec3<Real>; 2] {
    let (x, y, z) = (Lane::abs(n.x), Lane::abs(n.y), Lane::abs(n.z));
    let axis = if x <= y && x <= z {
        Vec3::new(1.0, 0.0, 0.0)
    } else if y <= z {
        Vec3::new(0.0, 1.0, 0.0)
    } else {
        Vec3::new(0.0, 0.0, 1.0)
    };
    let across = axis - n * n.dot(axis);
    let first = across * (1.0 / across.dot(across).sqrt());
    [first, n.cross(first)]
}
