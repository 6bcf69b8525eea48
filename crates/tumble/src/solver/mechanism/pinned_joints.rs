//! Four joints of one kind side by side.

use tumble_math::lane::{Quat, Vec3};

use crate::integrators::derived::symmetric_product;
use crate::simd::{Four, FourLane};
use crate::solver::mechanism::block_kernels::fours;
use crate::solver::mechanism::block_ldl::BlockLdl;
use crate::solver::mechanism::fours::{
    by_place, four_of, is_new, of_each, quaternion, quaternions, rows, rows_of, vectors,
};
use crate::solver::mechanism::joint_rows::{
    JointRows, arms_and_gap, correction_speed, left_of_error, pushed_at, velocity_apart,
};
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::pinned_kind::PinnedKind;

/// Four joints, or fewer with the last of them several times.
pub(super) struct PinnedJoints<'a, T> {
    joints: [&'a JointRows; 4],
    numbers: [usize; 4],
    kind: PinnedKind,
    zero: T,
}

/// The row of a hinge's axis.
const FREE_ROW: usize = 5;

/// Impulses of four joints along their rows, side by side, as three along the axes of the world
/// and those about axes.
type Along<T> = (Vec3<T>, [T; 3]);

impl<'a, T: FourLane> PinnedJoints<'a, T> {
    /// From a joint on, of this kind.
    #[inline(always)]
    pub(super) fn of(joints: &'a [JointRows], first: usize, kind: PinnedKind) -> Self {
        let numbers = four_of(first, joints.len());
        Self { joints: of_each!(numbers, number => &joints[number]), numbers, kind, zero: T::splat(0.0) }
    }

    #[inline(always)]
    pub(super) fn joints(&self) -> [&'a JointRows; 4] {
        self.joints
    }

    /// Of the joints among all.
    #[inline(always)]
    pub(super) fn numbers(&self) -> [usize; 4] {
        self.numbers
    }

    /// How many fours the rows of a joint take.
    #[inline(always)]
    fn width(&self) -> usize {
        fours(3 + self.kind.turning_rows())
    }

    #[inline(always)]
    pub(super) fn bodies<'b>(&self, bodies: &'b [MechanismBody], end: usize) -> [&'b MechanismBody; 4] {
        of_each!(self.joints, joint => &bodies[joint.bodies[end]])
    }

    #[inline(always)]
    fn arms(&self, end: usize) -> (Vec3<T>, T) {
        vectors(of_each!(self.joints, joint => &joint.arms[end]))
    }

    /// About what the first, second or third of the rows turn that turn bodies about an axis.
    #[inline(always)]
    fn axis(&self, rotation: usize) -> Vec3<T> {
        axes_of(self.joints, rotation)
    }

    /// By four of rows and by joint: how fast the errors grow by the velocities of the bodies.
    #[inline(always)]
    pub(super) fn speeds(&self, bodies: &[MechanismBody]) -> [[T; 4]; 2] {
        self.speeds_by([velocities::<T>(self.bodies(bodies, 0)), velocities::<T>(self.bodies(bodies, 1))])
    }

    /// The same by linear and angular velocities of bodies.
    #[inline(always)]
    pub(super) fn speeds_of(&self, velocities: &[[Four; 2]]) -> [[T; 4]; 2] {
        let of_both = [
            [self.given(velocities, 0, 0), self.given(velocities, 0, 1)],
            [self.given(velocities, 1, 0), self.given(velocities, 1, 1)],
        ];
        self.speeds_by(of_both)
    }

    /// Linear or angular velocities of the bodies at an end.
    #[inline(always)]
    fn given(&self, velocities: &[[Four; 2]], end: usize, which: usize) -> Vec3<T> {
        vectors(of_each!(self.joints, joint => &velocities[joint.bodies[end]][which])).0
    }

    /// The same by those of the first and the second bodies.
    #[inline(always)]
    fn speeds_by(&self, of_both: [[Vec3<T>; 2]; 2]) -> [[T; 4]; 2] {
        let [apart, turn] = velocity_apart(of_both, [self.arms(0).0, self.arms(1).0]);
        let mut about = [self.zero; 3];
        by_place!(rotation of 3 {
            if rotation < self.kind.turning_rows() {
                about[rotation] = self.axis(rotation).dot(turn);
            }
        });
        self.rows(apart, about)
    }

    /// Takes the speeds of free rows of joints, from one on, out of these of all rows.
    #[inline(always)]
    pub(super) fn take_free_speeds(joints: &mut [JointRows], first: usize, [_, speeds]: [[T; 4]; 2]) {
        let numbers = four_of(first, joints.len());
        by_place!(k of 4 {
            let mut of_joint = [0.0; 4];
            speeds[k].store(&mut of_joint);
            let row = joints[numbers[k]].free_rows.first_mut();
            row.into_iter().for_each(|row| row.speed = of_joint[FREE_ROW - 4]);
        });
    }

    /// Sets the right sides of what these speeds are to become: what bends the paths, and what
    /// takes the errors out at a rate [1/s].
    #[inline(always)]
    pub(super) fn set_right_side(
        &self,
        speeds: [[T; 4]; 2],
        matrix: &BlockLdl,
        right: &mut [Four],
        (bend, rate): (&[Four], f64),
    ) {
        by_place!(k of 4 {
            let (joint, begin) = (self.joints[k], matrix.start(self.numbers[k]));
            let of_joint = |w: usize| (&bend[begin + w], &joint.errors[w], &joint.wanted[w]);
            right_side(speeds[0][k], of_joint(0), rate).store(&mut right[begin]);
            if self.width() > 1 {
                right_side(speeds[1][k], of_joint(1), rate).store(&mut right[begin + 1]);
            }
        });
    }

    /// Sets the right sides of what is left of the errors of locked axes.
    #[inline(always)]
    pub(super) fn set_remaining(&self, left: [[T; 4]; 2], matrix: &BlockLdl, right: &mut [Four], rate: f64) {
        let (rate, mut scaled) = (T::splat(rate), left);
        by_place!(k of 4 {
            scaled[0][k] = left[0][k] * rate;
            scaled[1][k] = left[1][k] * rate;
        });
        self.store_rows(scaled, matrix, right);
    }

    /// Sets numbers of the rows of all joints, by four of rows and by joint.
    #[inline(always)]
    pub(super) fn store_rows(&self, rows: [[T; 4]; 2], matrix: &BlockLdl, all: &mut [Four]) {
        by_place!(k of 4 {
            let begin = matrix.start(self.numbers[k]);
            rows[0][k].store(&mut all[begin]);
            if self.width() > 1 {
                rows[1][k].store(&mut all[begin + 1]);
            }
        });
    }

    /// By four of rows and by joint: what is left of the errors of locked axes; and the largest of
    /// each joint, of the size of its arms or \[rad\].
    #[inline(always)]
    pub(super) fn errors_left(&self, bodies: &[MechanismBody]) -> ([[T; 4]; 2], T) {
        let (_, gap, [first, second]) = self.stand(bodies);
        let about = self.kind.rotations.errors(first.conjugate() * second);
        let (wanted, first) = vectors::<T>(of_each!(self.joints, joint => &joint.wanted[0]));
        let left = gap - wanted;
        let (_, gyration) = vectors::<T>(of_each!(self.joints, joint => &joint.between));
        let size = (self.arms(0).1 + self.arms(1).1).max(gyration);
        let mut largest = left.x.abs().max(left.y.abs()).max(left.z.abs()) / size;
        let mut about_left = [self.zero; 3];
        if self.kind.rotations.locked() > 0 {
            let (Vec3 { x, y, .. }, _) = vectors::<T>(of_each!(self.joints, joint => &joint.wanted[1]));
            let wanted = [first, x, y];
            by_place!(rotation of 3 {
                if rotation < self.kind.rotations.locked() {
                    about_left[rotation] = about[rotation] - wanted[rotation];
                    largest = about_left[rotation].abs().max(largest);
                }
            });
        }
        (self.rows(left, about_left), largest)
    }

    /// Sets the rows of four joints, and their errors, to where the bodies are.
    #[inline(always)]
    pub(super) fn update(joints: &mut [JointRows], first: usize, kind: PinnedKind, bodies: &[MechanismBody]) {
        let four = PinnedJoints::<T>::of(joints, first, kind);
        let (numbers, zero) = (four.numbers, four.zero);
        let (anchor_arms, gap, [first, second]) = four.stand(bodies);
        let [a, b, from_anchor] = pushed_at(anchor_arms, gap, gap * T::splat(0.5));
        let arms = [rows_of(a, a.dot(a).sqrt()), rows_of(b, b.dot(b).sqrt())];
        let from_anchor = rows_of(from_anchor, zero);
        let turned = first.conjugate() * second;
        let errors = four.rows(gap, kind.rotations.errors(turned));
        let width = four.width();
        let [x, y, z] = kind.rotations.locked_axes(first.axes());
        let axes = [rows_of(x, zero), rows_of(y, zero), rows_of(z, zero)];
        by_place!(k of 4 {
            let joint = &mut joints[numbers[k]];
            arms[0][k].store(&mut joint.arms[0]);
            arms[1][k].store(&mut joint.arms[1]);
            from_anchor[k].store(&mut joint.from_anchor);
            errors[0][k].store(&mut joint.errors[0]);
            if width > 1 {
                errors[1][k].store(&mut joint.errors[1]);
            }
            by_place!(rotation of 3 {
                if rotation < kind.turning_rows() {
                    axes[rotation][k].store(&mut joint.angular[3 + rotation]);
                }
            });
        });
        if kind.has_free_row {
            let turned = rows(turned);
            by_place!(k of 4 {
                let mut of_joint = [0.0; 4];
                turned[k].store(&mut of_joint);
                joints[numbers[k]].set_hinge_value(quaternion(&of_joint));
            });
        }
    }

    /// Of each joint, along its rows, out of those of all rows.
    #[inline(always)]
    pub(super) fn impulses(&self, matrix: &BlockLdl, impulses: &[Four]) -> Along<T> {
        let begins = of_each!(self.numbers, number => matrix.start(number));
        let (linear, first) = vectors::<T>(of_each!(begins, begin => &impulses[begin]));
        if self.kind.turning_rows() == 0 {
            return (linear, [self.zero; 3]);
        }
        let (Vec3 { x, y, .. }, _) = vectors::<T>(of_each!(begins, begin => &impulses[begin + 1]));
        (linear, [first, x, y])
    }

    /// The angular impulses on the second bodies.
    #[inline(always)]
    fn angular(&self, about: [T; 3]) -> Vec3<T> {
        let mut sum = Vec3::splat(self.zero);
        by_place!(rotation of 3 {
            if rotation < self.kind.turning_rows() {
                let of_row = self.axis(rotation) * about[rotation];
                sum = if rotation == 0 { of_row } else { sum + of_row };
            }
        });
        sum
    }

    /// Pushes the bodies by these impulses.
    #[inline(always)]
    pub(super) fn push(&self, bodies: &mut [MechanismBody], (linear, about): Along<T>) {
        let torques = [self.arms(0).0.cross(linear), self.arms(1).0.cross(linear)];
        let torques = [rows_of(torques[0], self.zero), rows_of(torques[1], self.zero)];
        let linear = rows_of(linear, self.zero);
        let angular = rows_of(self.angular(about), self.zero);
        by_place!(k of 4 {
            if is_new(self.numbers, k) {
                let [a, b] = self.joints[k].bodies;
                let first = &mut bodies[a];
                if first.is_moved() {
                    (T::load(&first.linear) - linear[k]).store(&mut first.linear);
                    let turned = T::load(&first.angular) - torques[0][k];
                    let turned = if self.kind.turning_rows() > 0 { turned - angular[k] } else { turned };
                    turned.store(&mut first.angular);
                }
                let second = &mut bodies[b];
                if second.is_moved() {
                    (T::load(&second.linear) + linear[k]).store(&mut second.linear);
                    let turned = T::load(&second.angular) + torques[1][k];
                    let turned = if self.kind.turning_rows() > 0 { turned + angular[k] } else { turned };
                    turned.store(&mut second.angular);
                }
            }
        });
    }

    /// Adds what these impulses are to the bodies, linear and angular, to those of all bodies.
    #[inline(always)]
    pub(super) fn add_impulses(&self, (linear, about): Along<T>, impulses: &mut [[Four; 2]]) {
        let angular = self.angular(about);
        let turns = self.kind.turning_rows() > 0;
        let torques = [self.arms(0).0.cross(linear), self.arms(1).0.cross(linear)];
        let torques = if turns { [torques[0] + angular, torques[1] + angular] } else { torques };
        let torques = [rows_of(torques[0], self.zero), rows_of(torques[1], self.zero)];
        let linear = rows_of(linear, self.zero);
        by_place!(k of 4 {
            if is_new(self.numbers, k) {
                let [a, b] = self.joints[k].bodies;
                let [of_first, turning] = &mut impulses[a];
                (T::load(of_first) - linear[k]).store(of_first);
                (T::load(turning) - torques[0][k]).store(turning);
                let [of_second, turning] = &mut impulses[b];
                (T::load(of_second) + linear[k]).store(of_second);
                (T::load(turning) + torques[1][k]).store(turning);
            }
        });
    }

    /// Adds these impulses, and the angular ones about the anchors, to what joints have done.
    #[inline(always)]
    pub(super) fn note(&self, (linear, about): Along<T>, done: &mut [[Four; 2]]) {
        let (from_anchor, _) = vectors::<T>(of_each!(self.joints, joint => &joint.from_anchor));
        let moments = rows_of(from_anchor.cross(linear), self.zero);
        let linear = rows_of(linear, self.zero);
        let angular = rows_of(self.angular(about), self.zero);
        by_place!(k of 4 {
            if is_new(self.numbers, k) {
                let [of_joint, turning] = &mut done[self.numbers[k]];
                (T::load(of_joint) + linear[k]).store(of_joint);
                let sum = T::load(turning);
                let sum = if self.kind.turning_rows() > 0 { sum + angular[k] } else { sum };
                (sum + moments[k]).store(turning);
            }
        });
    }

    /// Adds these impulses times the arms to the pulls at the bodies.
    #[inline(always)]
    pub(super) fn pull(&self, (linear, _): Along<T>, pulls: &mut [f64]) {
        let strength = linear.dot(linear).sqrt();
        let mut by_arms = [[0.0; 4]; 2];
        (strength * self.arms(0).1).store(&mut by_arms[0]);
        (strength * self.arms(1).1).store(&mut by_arms[1]);
        by_place!(k of 4 {
            if is_new(self.numbers, k) {
                let [a, b] = self.joints[k].bodies;
                pulls[a] += by_arms[0][k];
                pulls[b] += by_arms[1][k];
            }
        });
    }

    /// From each centre of mass to its anchor, from the first anchor to the second, and how the
    /// frames are turned.
    #[inline(always)]
    fn stand(&self, bodies: &[MechanismBody]) -> ([Vec3<T>; 2], Vec3<T>, [Quat<T>; 2]) {
        let [(at_a, turned_a, anchor_a, frame_a), (at_b, turned_b, anchor_b, frame_b)] =
            [self.end(bodies, 0), self.end(bodies, 1)];
        let (between, _) = vectors::<T>(of_each!(self.joints, joint => &joint.between));
        let (arms, gap) = arms_and_gap([turned_a, turned_b], [anchor_a, anchor_b], (between, [at_a, at_b]));
        (arms, gap, [turned_a * frame_a, turned_b * frame_b])
    }

    /// Translation and orientation of the bodies at an end, and of the frames on them.
    #[inline(always)]
    fn end(&self, bodies: &[MechanismBody], end: usize) -> (Vec3<T>, Quat<T>, Vec3<T>, Quat<T>) {
        let (translation, _) = vectors::<T>(of_each!(self.joints, joint => &bodies[joint.bodies[end]].translation));
        let orientation = quaternions::<T>(of_each!(self.joints, joint => &bodies[joint.bodies[end]].orientation));
        let (anchor, _) = vectors::<T>(of_each!(self.joints, joint => &joint.anchors[end].position));
        let frame = quaternions::<T>(of_each!(self.joints, joint => &joint.anchors[end].orientation));
        (translation, orientation, anchor, frame)
    }

    /// By four of rows and by joint, what vectors and numbers about axes are by row.
    #[inline(always)]
    fn rows(&self, linear: Vec3<T>, [first, second, third]: [T; 3]) -> [[T; 4]; 2] {
        let rows = rows_of(linear, first);
        [rows, if self.kind.turning_rows() > 1 { T::transpose([second, third, self.zero, self.zero]) } else { rows }]
    }
}

/// About what the first, second or third of the turning rows of joints turn.
#[inline(always)]
pub(super) fn axes_of<T: FourLane>(joints: [&JointRows; 4], rotation: usize) -> Vec3<T> {
    vectors(of_each!(joints, joint => &joint.angular[3 + rotation])).0
}

/// Sets what is left of the errors of a joint's locked axes after a substep of `h` \[s\].
#[inline(always)]
pub(super) fn plan_pinned<T: FourLane>(joint: &mut JointRows, kind: PinnedKind, h: f64) {
    let [linear, angular] = [true, false].map(|is_linear| h * correction_speed(is_linear));
    let limits = [[linear, linear, linear, angular], [angular; 4]];
    for (w, limit) in limits.iter().enumerate().take(fours(3 + kind.rotations.locked())) {
        let (error, most) = (T::load(&joint.errors[w]), T::load(limit));
        left_of_error(error, most).store(&mut joint.wanted[w]);
    }
}

/// What speeds are to change by, with the bend, the errors, and what is left of these, of the same
/// rows.
#[inline(always)]
fn right_side<T: FourLane>(speed: T, (bend, error, wanted): (&Four, &Four, &Four), rate: f64) -> T {
    if rate == 0.0 {
        return T::splat(0.0) - speed;
    }
    T::load(bend) - (speed + (T::load(error) - T::load(wanted)) * T::splat(rate))
}

/// Linear and angular velocities of bodies.
#[inline(always)]
fn velocities<T: FourLane>(bodies: [&MechanismBody; 4]) -> [Vec3<T>; 2] {
    let (linear, inverse_mass) = vectors::<T>(of_each!(bodies, body => &body.linear));
    let (angular, _) = vectors::<T>(of_each!(bodies, body => &body.angular));
    let (diagonal, _) = vectors::<T>(of_each!(bodies, body => &body.inverse_inertia[0]));
    let (off_diagonal, _) = vectors::<T>(of_each!(bodies, body => &body.inverse_inertia[1]));
    let moves = T::splat(0.0).lt(inverse_mass);
    [
        Vec3::select(moves, linear * inverse_mass, linear),
        Vec3::select(moves, symmetric_product(diagonal, off_diagonal, angular), angular),
    ]
}
