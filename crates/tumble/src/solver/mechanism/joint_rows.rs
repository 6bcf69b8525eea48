//! The rows of a joint: along what it pushes, and how far it is from being met.

use tumble_math::lane::{Lane, Quat, Vec3};

use crate::joints::axes::Axes;
use crate::joints::joint_options::JointOptions;
use crate::simd::Four;
use crate::solver::mechanism::block_kernels::{MAX_ROWS, fours};
use crate::solver::mechanism::fours::{quaternion, row_of, vector};
use crate::solver::mechanism::free_axis::{Direction, FreeAxis, free_axes};
use crate::solver::mechanism::free_row::FreeRow;
use crate::solver::mechanism::gear_rows::GearRows;
use crate::solver::mechanism::joint_free_rows::has_distance;
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::rotations::{MIN_SINE, Rotations};

/// The frame of a joint on one of its bodies: origin \[m\] from the centre of mass and orientation,
/// along the axes that the body's orientation goes by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anchor {
    pub(crate) position: Four,
    pub(crate) orientation: Four,
}

impl Anchor {
    pub(crate) fn orientation(&self) -> Quat<f64> {
        quaternion(&self.orientation)
    }

    /// Whether it is at the centre of mass.
    pub(super) fn is_center(&self) -> bool {
        let position = vector(&self.position);
        position.dot(position) == 0.0
    }
}

/// A number for each row of a joint, zero beyond them.
pub(crate) type OfRows = [Four; fours(MAX_ROWS)];

/// A joint between two bodies of a mechanism, as a node of its matrix.
#[derive(Clone, Debug)]
#[repr(C)]
pub(crate) struct JointRows {
    /// Among those of the mechanism.
    pub(crate) bodies: [usize; 2],
    pub(crate) anchors: [Anchor; 2],
    /// From the first centre of mass to the second when the step began; and the sum of the radii of
    /// gyration of the bodies, or what errors of points held at their centres are compared with
    /// \[m\].
    pub(super) between: Four,
    /// From each centre of mass to the point where both bodies are pushed, and how long that is
    /// \[m\].
    pub(super) arms: [Four; 2],
    /// From the second body's anchor to that point \[m\].
    pub(super) from_anchor: Four,
    /// By row: how far it is from being met, \[m\] or roughly \[rad\], where rows were set.
    pub(crate) errors: OfRows,
    /// By row: error that is left for the steps after this substep.
    pub(crate) wanted: OfRows,
    /// Along what each row pushes, and about what it turns besides; world frame. Those of locked
    /// axes come first.
    pub(super) angular: [Four; MAX_ROWS],
    pub(crate) linear: [Vec3<f64>; MAX_ROWS],
    pub(super) free: Axes,
    /// Whether all translations are locked: then these are its first rows, along the axes of the
    /// world, and no other has a linear part.
    is_pinned: bool,
    pub(crate) count: usize,
    /// How many are of locked axes, and how many of these of translations.
    pub(crate) locked: usize,
    linear_count: usize,
    pub(crate) rotations: Rotations,
    /// Those of free axes.
    pub(crate) free_rows: Vec<FreeRow>,
    /// Whether its friction gives way, as joints of its loop are not met.
    pub(super) friction_yields: bool,
    /// The rotation that values of three free rotations are taken against.
    pub(super) reference: Option<Quat<f64>>,
    /// What it is in the place of a joint: its one row acts on four bodies.
    pub(crate) gear: Option<Box<GearRows>>,
}

/// A joint as it stands: what rows and errors are made of.
pub(crate) struct Stance {
    /// From each centre of mass to its anchor \[m\].
    pub(super) anchor_arms: [Vec3<f64>; 2],
    /// From the first anchor to the second \[m\].
    pub(crate) gap: Vec3<f64>,
    pub(crate) orientations: [Quat<f64>; 2],
    pub(crate) axes: [[Vec3<f64>; 3]; 2],
}

/// The speed at which errors are taken out that a joint begins with [m/s] [rad/s].
pub(crate) fn correction_speed(is_linear: bool) -> f64 {
    if is_linear { 3.0 } else { 10.0 }
}

pub(super) const IDENTITY: Quat<f64> = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };

impl JointRows {
    pub(crate) fn new(bodies: [usize; 2], anchors: [Anchor; 2], free: Axes, options: Option<&JointOptions>) -> Self {
        let zero = Vec3::zero();
        let locked = 6 - free.count() as usize;
        let free_rows: Vec<_> = options.into_iter().flat_map(|it| free_axes(it, free)).map(FreeRow::new).collect();
        let mut linear = [zero; MAX_ROWS];
        let is_pinned = !(free.has(0) || free.has(1) || free.has(2) || has_distance(&free_rows));
        if is_pinned {
            (0..3).for_each(|axis| linear[axis] = linear_axis(free, axis, &[zero; 3]));
        }
        Self {
            bodies,
            anchors,
            free,
            is_pinned,
            linear,
            angular: [[0.0; 4]; MAX_ROWS],
            between: [0.0; 4],
            arms: [[0.0; 4]; 2],
            from_anchor: [0.0; 4],
            errors: OfRows::default(),
            wanted: OfRows::default(),
            count: locked + free_rows.len(),
            locked,
            linear_count: (0..3).filter(|axis| !free.has(*axis)).count(),
            rotations: Rotations::of(free),
            free_rows,
            friction_yields: false,
            reference: None,
            gear: None,
        }
    }

    /// A gear between two joints.
    pub(crate) fn of_gear(gear: GearRows) -> Self {
        let [first, _] = &gear.joints;
        let it = Self::new(first.bodies, first.anchors, Axes::LINEAR | Axes::ANGULAR_Y | Axes::ANGULAR_Z, None);
        Self { gear: Some(Box::new(gear)), ..it }
    }

    /// The bodies that it acts on: of a gear four, of which some may be the same.
    pub(crate) fn ends(&self) -> impl Iterator<Item = usize> + '_ {
        let more = self.gear.iter().flat_map(|gear| gear.joints[1].bodies);
        self.bodies.into_iter().chain(more)
    }

    /// From each centre of mass to its anchor, and from the first anchor to the second.
    #[inline(always)]
    fn arms_and_gap(&self, bodies: &[MechanismBody]) -> ([Vec3<f64>; 2], Vec3<f64>) {
        let (a, b) = (&bodies[self.bodies[0]], &bodies[self.bodies[1]]);
        let anchors = [vector(&self.anchors[0].position), vector(&self.anchors[1].position)];
        let between = (vector(&self.between), [a.translation(), b.translation()]);
        arms_and_gap([a.orientation(), b.orientation()], anchors, between)
    }

    /// How its frames are turned.
    #[inline(always)]
    pub(super) fn orientations(&self, bodies: &[MechanismBody]) -> [Quat<f64>; 2] {
        let (a, b) = (&bodies[self.bodies[0]], &bodies[self.bodies[1]]);
        let [first, second] = [0, 1].map(|end| quaternion(&self.anchors[end].orientation));
        [a.orientation() * first, b.orientation() * second]
    }

    /// Whether it locks all translations, and nothing acts along its free axes.
    pub(crate) fn is_rigid_pin(&self) -> bool {
        self.is_pinned && self.free_rows.is_empty()
    }

    /// Whether all its translations are locked.
    #[inline(always)]
    pub(crate) fn is_pinned(&self) -> bool {
        self.is_pinned
    }

    pub(super) fn stance(&self, bodies: &[MechanismBody]) -> Stance {
        let (anchor_arms, gap) = self.arms_and_gap(bodies);
        let orientations = self.orientations(bodies);
        Stance { anchor_arms, gap, orientations, axes: orientations.map(Quat::axes) }
    }

    /// How many rows push along a line; they are the first.
    pub(crate) fn linear_count(&self) -> usize {
        self.linear_count
    }

    /// Sets the rows, and their errors, to where the bodies are.
    pub(crate) fn update(&mut self, bodies: &[MechanismBody]) {
        if let Some(gear) = &mut self.gear {
            gear.update(bodies);
            self.errors = self.errors(bodies);
            return;
        }
        if self.is_rigid_pin() {
            let (anchor_arms, gap) = self.arms_and_gap(bodies);
            self.set_arms(anchor_arms, gap, gap * 0.5);
            if self.locked > 3 {
                let [first, second] = self.orientations(bodies);
                self.set_rotations([first, second], 3);
            }
            self.errors = self.pinned_errors(bodies, gap);
            return;
        }
        let stance = self.stance(bodies);
        let [a, _] = stance.axes;
        let zero = Vec3::zero();
        let mut row = 0;
        let mut locked_gap = zero;
        for axis in (0..3).filter(|axis| !self.free.has(*axis)) {
            let along = linear_axis(self.free, axis, &a);
            (self.linear[row], self.angular[row]) = (along, [0.0; 4]);
            locked_gap = locked_gap + along * along.dot(stance.gap);
            row += 1;
        }
        self.set_arms(stance.anchor_arms, stance.gap, locked_gap * 0.5);
        self.linear[row..self.locked].fill(zero);
        self.set_rotations(stance.orientations, row);
        let Self { free_rows, linear, angular, locked, free, reference, .. } = self;
        for (row, it) in (*locked..).zip(free_rows) {
            let direction = it.axis.direction(&stance, *free, *reference);
            (linear[row], angular[row]) = (direction.linear, row_of(direction.angular, 0.0));
            it.value = direction.value;
        }
        self.errors = self.errors_of(&stance);
    }

    /// Sets about what rows of locked rotations turn, from a row on.
    #[inline(always)]
    fn set_rotations(&mut self, [first, second]: [Quat<f64>; 2], row: usize) {
        let a = first.axes();
        match self.rotations {
            Rotations::Locked | Rotations::About(_) => {
                let axes = self.rotations.locked_axes(a).into_iter().take(self.rotations.locked());
                self.angular[row..].iter_mut().zip(axes).for_each(|(about, axis)| *about = row_of(axis, 0.0));
            }
            Rotations::AboutBoth(i, j) => {
                let across = second.axes()[j].cross(a[i]);
                let sine = length(across);
                // Where both axes are the same, about any other.
                let is_none = sine < MIN_SINE;
                let about = if is_none { a[3 - i - j] } else { across * (2.0 / (sine * (1.0 + sine))) };
                self.angular[row] = row_of(about, 0.0);
            }
            Rotations::Free => {}
        }
    }

    /// Has both bodies pushed at a point that is half the locked gap from the second anchor.
    #[inline(always)]
    fn set_arms(&mut self, anchor_arms: [Vec3<f64>; 2], gap: Vec3<f64>, half: Vec3<f64>) {
        let [first, second, from_anchor] = pushed_at(anchor_arms, gap, half);
        self.arms = [first, second].map(|arm| row_of(arm, length(arm)));
        self.from_anchor = row_of(from_anchor, 0.0);
    }

    /// From a centre of mass to the point where both bodies are pushed \[m\].
    #[inline(always)]
    pub(crate) fn arm(&self, end: usize) -> Vec3<f64> {
        vector(&self.arms[end])
    }

    /// From both centres of mass.
    pub(crate) fn arms(&self) -> [Vec3<f64>; 2] {
        [self.arm(0), self.arm(1)]
    }

    /// The errors where the bodies are.
    #[inline(always)]
    pub(crate) fn errors(&self, bodies: &[MechanismBody]) -> OfRows {
        if self.is_rigid_pin() {
            return self.pinned_errors(bodies, self.arms_and_gap(bodies).1);
        }
        self.other_errors(bodies)
    }

    /// The same of a pinned joint along whose free axes nothing acts, where this is its gap.
    #[inline(always)]
    fn pinned_errors(&self, bodies: &[MechanismBody], gap: Vec3<f64>) -> OfRows {
        let mut errors = OfRows::default();
        errors[0] = row_of(gap, 0.0);
        if self.locked > 3 {
            let [first, second] = self.orientations(bodies);
            let rotations = self.rotations.errors(first.conjugate() * second);
            let of_rotations = &mut errors.as_flattened_mut()[3..self.locked];
            of_rotations.iter_mut().zip(rotations).for_each(|(error, rotation)| *error = rotation);
        }
        errors
    }

    /// The same of other joints and gears.
    fn other_errors(&self, bodies: &[MechanismBody]) -> OfRows {
        if let Some(gear) = &self.gear {
            let mut errors = OfRows::default();
            errors[0][0] = gear.error_since_start(bodies);
            return errors;
        }
        self.errors_of(&self.stance(bodies))
    }

    fn errors_of(&self, stance: &Stance) -> OfRows {
        let mut of_rows = OfRows::default();
        let (errors, wanted) = (of_rows.as_flattened_mut(), self.wanted.as_flattened());
        let mut row = 0;
        for axis in (0..3).filter(|axis| !self.free.has(*axis)) {
            errors[row] = stance.gap.dot(linear_axis(self.free, axis, &stance.axes[0]));
            row += 1;
        }
        let rotations = self.rotations.errors(stance.orientations[0].conjugate() * stance.orientations[1]);
        errors[row..self.locked].iter_mut().zip(rotations).for_each(|(error, rotation)| *error = rotation);
        for (row, it) in (self.locked..).zip(&self.free_rows).filter(|(_, it)| it.is_at_bound()) {
            let Direction { value, linear, angular } = it.axis.direction(stance, self.free, self.reference);
            if it.axis == FreeAxis::Distance {
                errors[row] = it.error_of_distance(value, linear.dot(self.linear[row]) * value, wanted[row]);
                continue;
            }
            let along = linear.dot(self.linear[row]) + angular.dot(vector(&self.angular[row]));
            // Where the way back has turned, more along the row does not lead there.
            let leads_back = along > 0.5 && !value.is_nan();
            errors[row] = if leads_back { it.error_at_bound(value) } else { wanted[row] };
        }
        of_rows
    }

    /// Whether it has a torque on a body that does not turn.
    pub(super) fn resists_turning(&self, bodies: &[MechanismBody]) -> bool {
        let locks = self.locked > self.linear_count;
        let is_off = |(body, anchor): (usize, &Anchor)| {
            let body = &bodies[body];
            body.is_moved() && !body.turns() && (locks || !anchor.is_center())
        };
        self.bodies.into_iter().zip(&self.anchors).any(is_off)
    }

    /// To be called before the first substep of a step.
    pub(crate) fn begin_step(&mut self, bodies: &[MechanismBody]) {
        self.wanted = OfRows::default();
        let [a, b] = self.bodies.map(|body| &bodies[body]);
        self.between = row_of(b.center - a.center, a.radius_of_gyration() + b.radius_of_gyration());
        if let Some(gear) = &mut self.gear {
            gear.begin_step(bodies);
            self.between[3] = gear.joints.iter().map(JointRows::gyration).sum();
        }
    }

    /// Whether its bodies are points that are held at their centres, so that its arms are its gap.
    pub(super) fn is_of_points(&self) -> bool {
        self.gyration() == 0.0 && self.linear_count > 0 && self.anchors.iter().all(Anchor::is_center)
    }

    /// The sum of the radii of gyration of its bodies, or what errors of points held at their
    /// centres are compared with \[m\].
    fn gyration(&self) -> f64 {
        self.between[3]
    }

    /// Has errors compared with this size at least \[m\].
    pub(super) fn set_gyration(&mut self, size: f64) {
        self.between[3] = size;
    }

    /// What errors are compared with: lengths of its arms, or where these are short of its bodies
    /// \[m\].
    pub(crate) fn size(&self) -> f64 {
        (self.arms[0][3] + self.arms[1][3]).max(self.gyration())
    }

    /// The largest of numbers by row, of those that are locked or at a bound; of the size of the
    /// arms where they are lengths.
    pub(crate) fn largest(&self, of_row: impl Fn(usize) -> f64) -> f64 {
        let (linear, size) = (self.linear_count, self.size());
        let of_locked =
            (0..self.locked).map(|row| (row, self.gear.as_ref().map_or(row < linear, |gear| gear.is_linear())));
        let at_bounds = (self.locked..).zip(&self.free_rows).filter(|(_, it)| it.is_at_bound());
        let rows = of_locked.chain(at_bounds.map(|(row, it)| (row, it.axis.is_linear())));
        rows.map(|(row, is_linear)| of_row(row).abs() / if is_linear { size } else { 1.0 }).fold(0.0, f64::max)
    }

    /// The largest error of these rows where they were set, by which what they lock would differ if
    /// it were met. A bound that is to be reached has none, nor has a gear: its rows stay the same.
    pub(crate) fn misfit(&self) -> f64 {
        self.largest(|row| match row.checked_sub(self.locked).map(|row| &self.free_rows[row]) {
            Some(law) => law.past_bound(self.errors.as_flattened()[row]).max(0.0),
            None if self.gear.is_some() => 0.0,
            None => self.errors.as_flattened()[row],
        })
    }

    /// Sets what is left of the errors after a substep of `h` \[s\].
    pub(crate) fn plan_correction(&mut self, h: f64) {
        let linear = self.linear_count;
        let (all_wanted, errors) = (self.wanted.as_flattened_mut(), self.errors.as_flattened());
        for (row, (wanted, error)) in all_wanted.iter_mut().zip(errors).enumerate().take(self.locked) {
            let is_linear = self.gear.as_ref().map_or(row < linear, |gear| gear.is_linear());
            let most = h * correction_speed(is_linear);
            *wanted = left_of_error(*error, most);
        }
        self.plan_free_correction(h);
    }

    /// How fast each error grows by the velocities of the bodies.
    pub(crate) fn speeds(&self, bodies: &[MechanismBody]) -> OfRows {
        self.speeds_by(|body| [bodies[body].linear_velocity(), bodies[body].angular_velocity()])
    }

    /// How fast each error grows by linear and angular velocities of bodies.
    #[inline]
    pub(crate) fn speeds_by(&self, velocities: impl Fn(usize) -> [Vec3<f64>; 2]) -> OfRows {
        let mut speeds = OfRows::default();
        if let Some(gear) = &self.gear {
            speeds[0][0] = gear.speed(velocities);
            return speeds;
        }
        let [apart, turn] = self.relative_velocity(velocities);
        let mut first = 0;
        if self.is_pinned {
            speeds[0] = row_of(apart, 0.0);
            first = 3;
        }
        let numbers = &mut speeds.as_flattened_mut()[first..self.count];
        let directions = self.linear[first..].iter().zip(&self.angular[first..]);
        for (speed, (linear, angular)) in numbers.iter_mut().zip(directions) {
            *speed = linear.dot(apart) + vector(angular).dot(turn);
        }
        speeds
    }

    /// Of the second body against the first where they are pushed, linear and angular.
    #[inline]
    pub(crate) fn relative_velocity(&self, velocities: impl Fn(usize) -> [Vec3<f64>; 2]) -> [Vec3<f64>; 2] {
        let [first, second] = self.bodies;
        velocity_apart([velocities(first), velocities(second)], self.arms())
    }

    /// The impulse and the angular impulse on the second body of impulses along the rows.
    #[inline(always)]
    pub(crate) fn impulse(&self, along: &[f64]) -> [Vec3<f64>; 2] {
        let mut sum = [Vec3::zero(); 2];
        if let (true, &[x, y, z, ..]) = (self.is_pinned, along) {
            sum[0] = Vec3::new(x, y, z);
            let rows = self.angular.iter().zip(along).skip(3);
            rows.for_each(|(angular, amount)| sum[1] = sum[1] + vector(angular) * *amount);
            return sum;
        }
        for (row, amount) in along.iter().enumerate() {
            sum[0] = sum[0] + self.linear[row] * *amount;
            sum[1] = sum[1] + vector(&self.angular[row]) * *amount;
        }
        sum
    }
}

/// From each centre of mass to its anchor, and from the first anchor to the second: with what was
/// between the centres when the step began, and how far they have gone since.
#[inline(always)]
pub(crate) fn arms_and_gap<L: Lane>(
    orientations: [Quat<L>; 2],
    anchors: [Vec3<L>; 2],
    (between, translations): (Vec3<L>, [Vec3<L>; 2]),
) -> ([Vec3<L>; 2], Vec3<L>) {
    let (first, second) = (orientations[0].rotate(anchors[0]), orientations[1].rotate(anchors[1]));
    ([first, second], between + (translations[1] - translations[0]) + (second - first))
}

/// Of second bodies against first ones where they are pushed, linear and angular, by the linear and
/// angular velocities of both and the arms.
#[inline(always)]
pub(super) fn velocity_apart<L: Lane>([a, b]: [[Vec3<L>; 2]; 2], arms: [Vec3<L>; 2]) -> [Vec3<L>; 2] {
    [(b[0] + b[1].cross(arms[1])) - (a[0] + a[1].cross(arms[0])), b[1] - a[1]]
}

/// What is left of an error of which no more than this is taken out.
#[inline(always)]
pub(super) fn left_of_error<L: Lane>(error: L, most: L) -> L {
    error - error.max(-most).min(most)
}

/// From the centres of mass, and from the second anchor, to the point where both bodies are pushed,
/// half the locked gap before the second anchor.
#[inline(always)]
pub(crate) fn pushed_at<L: Lane>([first, second]: [Vec3<L>; 2], gap: Vec3<L>, half: Vec3<L>) -> [Vec3<L>; 3] {
    [first + gap - half, second - half, half * L::splat(-1.0)]
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
