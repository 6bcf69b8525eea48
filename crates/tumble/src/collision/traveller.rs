//! A body on its way through a substep, as the second net follows it.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};
use tumble_collide::{ColliderShape, Course, Isometry, Passage, contact_manifold};
use tumble_math::lane::{Quat, Vec3};

use crate::collision::collider::Collider;
use crate::collision::collider_state::ColliderState;
use crate::collision::compound_parts::{narrow, wide};
use crate::components::{Momentum, Pose, Velocity};
use crate::integrators::derived::derived;
use crate::integrators::kinetic_energy::KineticEnergy;
use crate::integrators::response_range::responds_in_range;
use crate::integrators::state::{Constants, Moments, State};
use crate::joints::axes::Axes;
use crate::joints::axis_lock::AxisLock;
use crate::joints::locked_axes::LockedAxes;
use crate::math::{Real, Vec3 as WorldVec3, dquat, dvec3, quat, vec3};
use crate::range::{MAX_SPEED, within};
use crate::storage::body_index::{RowPlace, Slot};
use crate::storage::world_columns::{ArchetypeBodies, WorldColumns};

/// The cosine between the way in and the way back out, of what a contact pushes back.
const BACK: f64 = 0.8;

/// The cosine of half of a sixteenth of a radian, by which a body may turn and stand as before.
const STEADY: f64 = 0.999_512;

/// A body in a substep.
#[derive(Clone)]
pub(crate) struct Traveller {
    pub(crate) slot: Slot,
    pub(crate) place: RowPlace,
    /// Of its collider.
    pub(crate) course: Course,
    /// Where it is in the end.
    end: Pose,
    /// What it was then, with its energy \[J\], if it is dynamic.
    before: Option<f64>,
    pub(crate) is_dynamic: bool,
    /// Whether it can be put back: a dynamic body that no joint holds.
    pub(crate) is_free: bool,
    pub(crate) is_fast: bool,
    /// Whether it turns by more than half a turn in the substep.
    pub(crate) spins: bool,
    /// Up to which moment it goes, ...
    pub(crate) until: f64,
    /// ... and which of the others it stays with then.
    pub(crate) with: Option<usize>,
    /// The force of its contacts when the substep ends \[N\].
    pub(crate) pushed: DVec3,
    /// What gravity did after it was stopped and is taken back [N s].
    taken_back: DVec3,
    /// By how much it is moved off what it comes too near \[m\].
    off: DVec3,
}

impl Traveller {
    /// A body whose collider was in this state when the substep of `h` \[s\] began; whether it can
    /// be put back, and whether it is fast.
    pub(crate) fn of(
        slot: Slot,
        place: RowPlace,
        (state, collider): (&ColliderState, &Collider),
        [is_free, is_fast]: [bool; 2],
        columns: &WorldColumns<'_>,
        h: Real,
    ) -> Option<Self> {
        let end = pose_of(columns, place)?;
        let expected = expected_turn(columns, place, state, h);
        Some(Self {
            slot,
            place,
            course: course_to(&end, (state, collider), expected),
            end,
            before: energy(columns, place),
            is_dynamic: state.is_dynamic,
            is_free,
            is_fast,
            spins: expected.length() > PI,
            until: 1.0,
            with: None,
            pushed: DVec3::ZERO,
            taken_back: DVec3::ZERO,
            off: DVec3::ZERO,
        })
    }

    /// Where it is at a moment.
    pub(crate) fn at(&self, moment: f64) -> Isometry<f64> {
        let (center, turn) = self.course.center_and_turn(moment);
        let (_, whole) = self.course.center_and_turn(1.0);
        let orientation = turn * whole.conjugate() * Quat::<f64>::from(dquat(self.end.orientation)).normalize();
        Isometry { position: center, orientation }
    }

    /// Stops it at a moment, to stay with another from then on. Its angular momentum turns with it,
    /// and what contacts leave of gravity, which gives `gained` [m/s] in a substep of `h` \[s\],
    /// has done nothing since: so it has its energy. It is then moved by `off` \[m\].
    pub(crate) fn stop(
        &mut self,
        moment: f64,
        (with, off): (Option<usize>, DVec3),
        columns: &mut WorldColumns<'_>,
        (gained, h): (WorldVec3, f64),
    ) {
        let row = self.place.row as usize;
        let gained = vec3(AxisLock(self.locked_axes(columns)).along_free(dvec3(gained)));
        let scale = self.gravity_scale(columns);
        if let Some(columns) = columns.dynamic_mut(self.place) {
            let all = scale * columns.mass[row].kilograms();
            let weight = dvec3(gained) * (f64::from(all) / h);
            let left = 1.0 + weight.dot(self.pushed) / weight.length_squared();
            // Nothing where there is no weight.
            let left = if left.is_nan() { 0.0 } else { left.clamp(0.0, 1.0) };
            let left_out = crate::math::real(left * (self.until - moment)) * all;
            columns.momentum[row].linear -= gained * left_out;
            self.taken_back += dvec3(gained * left_out);
        }
        let turned_back = self.at(moment).orientation * self.at(self.until).orientation.conjugate();
        turn_momentum(columns, self.place, turned_back);
        (self.until, self.with, self.off) = (moment, with, off);
    }

    /// The axes that a free body is locked along and about.
    pub(crate) fn locked_axes(&self, columns: &WorldColumns<'_>) -> Axes {
        let locked = columns.archetype(self.place).get::<&LockedAxes>().filter(|_| self.is_free);
        locked.map_or(Axes::NONE, |column| column[self.place.row as usize].0)
    }

    /// Of a body that is free to turn as well: position, not rounded as poses are, linear momentum
    /// with what gravity would have added, and spin \[m\] [kg m/s] [kg m^2/s].
    pub(crate) fn motion(&self, travellers: &[Self], columns: &WorldColumns<'_>) -> Option<[DVec3; 3]> {
        let may_turn = self.is_free && self.locked_axes(columns) == Axes::NONE;
        let (_, state) = state_of(columns, self.place).filter(|_| may_turn)?;
        let is_stopped = self.until < 1.0;
        let position = if is_stopped { self.stays(travellers).position.into() } else { dvec3(self.end.position) };
        Some([position, dvec3(state.linear.into()) + self.taken_back, dvec3(state.angular.into())])
    }

    /// Its mass \[kg\] and its inertia tensor in the world frame [kg m^2], which is zero of a body
    /// that does not turn; if it is dynamic.
    pub(crate) fn mass_and_inertia(&self, columns: &WorldColumns<'_>) -> Option<(f64, DMat3)> {
        let (constants, state) = state_of(columns, self.place)?;
        let turned_by = |angular: DVec3| {
            let state = State { angular: vec3(angular).into(), ..state };
            dvec3(derived(&constants, &state).angular.into())
        };
        let inverse = DMat3::from_cols(turned_by(DVec3::X), turned_by(DVec3::Y), turned_by(DVec3::Z));
        let inertia = Some(inverse.inverse()).filter(DMat3::is_finite).unwrap_or(DMat3::ZERO);
        Some((f64::from(constants.mass), inertia))
    }

    /// Its kinetic energy \[J\], if it is dynamic.
    pub(crate) fn energy(&self, columns: &WorldColumns<'_>) -> Option<f64> {
        energy(columns, self.place)
    }

    /// The same at the end of the substep, before it was stopped.
    pub(crate) fn energy_before(&self) -> Option<f64> {
        self.before
    }

    /// Adds linear and angular momentum \[N s\] [kg m^2/s], and books what that did.
    pub(crate) fn add_momentum(&self, [impulse, spin]: [DVec3; 2], columns: &mut WorldColumns<'_>) {
        let before = energy(columns, self.place);
        if let Some(columns) = columns.dynamic_mut(self.place) {
            let Momentum { linear, angular } = &mut columns.momentum[self.place.row as usize];
            (*linear, *angular) = (vec3(dvec3(*linear) + impulse), vec3(dvec3(*angular) + spin));
        }
        self.book(before, columns);
    }

    /// Adds to the work of contacts what has changed its energy from this \[J\].
    pub(crate) fn book(&self, before: Option<f64>, columns: &mut WorldColumns<'_>) {
        let after = energy(columns, self.place);
        if let (Some(before), Some(after)) = (before, after)
            && let Some(columns) = columns.dynamic_mut(self.place)
            && let Some(work) = columns.work.as_deref_mut()
        {
            work[self.place.row as usize].contacts += after - before;
        }
    }

    /// Whether it is turned by more than a sixteenth of a radian from where it was to end.
    pub(crate) fn stands_otherwise(&self, columns: &WorldColumns<'_>) -> bool {
        let Some(now) = pose_of(columns, self.place).filter(|_| self.until < 1.0) else { return false };
        dquat(now.orientation).normalize().dot(dquat(self.end.orientation).normalize()).abs() < STEADY
    }

    /// How much of gravity acts on it.
    pub(crate) fn gravity_scale(&self, columns: &WorldColumns<'_>) -> Real {
        let ArchetypeBodies::Dynamic(columns) = columns.bodies(self.place) else { return 1.0 };
        columns.gravity_scale.as_deref().map_or(1.0, |scales| scales[self.place.row as usize].0)
    }

    /// How far what it stays with carries it after it was stopped \[m\].
    pub(crate) fn carried_way(&self, travellers: &[Self]) -> DVec3 {
        (self.stays(travellers).position - self.at(self.until).position).into()
    }

    /// Where it is at the end of the substep, after it was stopped.
    fn stays(&self, travellers: &[Self]) -> Isometry<f64> {
        let here = self.at(self.until);
        match self.with.map(|other| &travellers[other].course) {
            Some(course) => carried(&here, course, self.until),
            None => here,
        }
    }

    /// Writes where it was stopped, if it was, with what it touches for the rest of the substep,
    /// and books what that and blows did.
    pub(crate) fn write(&self, travellers: &[Self], columns: &mut WorldColumns<'_>) {
        if self.until < 1.0 {
            self.write_pose(travellers, columns);
        }
        self.book(self.before, columns);
    }

    fn write_pose(&self, travellers: &[Self], columns: &mut WorldColumns<'_>) {
        let (here, place) = (self.at(self.until), self.stays(travellers));
        turn_momentum(columns, self.place, place.orientation * here.orientation.conjugate());
        let row = self.place.row as usize;
        if let Some(columns) = columns.dynamic_mut(self.place) {
            let orientation = quat(place.orientation.normalize().into());
            columns.pose[row] = Pose { position: vec3((place.position + Vec3::from(self.off)).into()), orientation };
        }
    }

    /// Whether another body that met this one in the direction of a normal is past its middle in
    /// the end, in that direction or on a way that came nearer to it than `deep` \[m\].
    pub(crate) fn is_passed(&self, other: &Self, normal: Vec3<f64>, deep: f64) -> bool {
        let [start, end] = [0.0, 1.0].map(|moment| other.course.at(moment).position - self.course.at(moment).position);
        let way = end - start;
        let beyond = way.dot(end) / way.dot(way);
        let nearest = end - way * beyond;
        normal.dot(end) < 0.0 || (beyond > 0.0 && nearest.dot(nearest) < deep * deep)
    }

    /// Whether another body that met this one in the direction of a normal is in it at the end of
    /// the substep, no deeper than `deep` \[m\], and is pushed back about that way.
    pub(crate) fn holds_in_the_end(
        &self,
        collider: &Collider,
        (other, its): (&Self, &Collider),
        normal: Vec3<f64>,
        deep: f64,
    ) -> bool {
        let (mut is_held, mut is_deep) = (false, false);
        let [here, there] = [self, other].map(|it| it.course.at(1.0));
        for_each_pair([collider, its], |_, [(shape, inner), (its, its_inner)]| {
            let [at, its_at] = [here.then(inner), there.then(its_inner)].map(|at| narrow(&at));
            let manifold = contact_manifold(shape, &at, its, &its_at, 0.0);
            let pushed = Vec3::<f64>::from(dvec3(manifold.normal.into()));
            is_held = is_held || (!manifold.points().is_empty() && pushed.dot(normal) > BACK);
            is_deep = is_deep || manifold.points().iter().any(|point| f64::from(point.separation) < -deep);
        });
        is_held && !is_deep
    }
}

/// By how much a body that was in this state when a substep of `h` \[s\] began turns in it at the
/// angular velocity that it has now \[rad\].
pub(crate) fn expected_turn(columns: &WorldColumns<'_>, place: RowPlace, state: &ColliderState, h: Real) -> DVec3 {
    let spin = match state_of(columns, place) {
        Some((constants, state)) => derived(&constants, &state).angular,
        None => state.velocity.1,
    };
    dvec3((spin * h).into())
}

/// The way of a collider from this state to where its body is in the end, with as many turns as
/// are `expected` \[rad\].
pub(crate) fn course_to(end: &Pose, (state, collider): (&ColliderState, &Collider), expected: DVec3) -> Course {
    let turn = wide_quat(turned_end(end, collider)) * wide_quat(state.placement.orientation).conjugate();
    let turn = nearest_turn(tumble_math::to_scaled_axis(turn.normalize().into()), expected);
    let way = dvec3(end.position) - dvec3(state.center.into());
    let center: Vec3<f64> = dvec3(state.center.into()).into();
    Course::new(&wide(&state.placement), center, way.into(), turn.into())
}

/// The same rotation, with the whole turns that bring it nearest to one that is expected \[rad\].
pub(crate) fn nearest_turn(turn: DVec3, expected: DVec3) -> DVec3 {
    let angle = turn.length();
    let axis = if angle > 0.0 { turn / angle } else { expected.normalize_or_zero() };
    turn + axis * (((axis.dot(expected) - angle) / TAU).round() * TAU)
}

/// Turns the angular momentum of a dynamic body.
fn turn_momentum(columns: &mut WorldColumns<'_>, place: RowPlace, turn: Quat<f64>) {
    if let Some(columns) = columns.dynamic_mut(place) {
        let Momentum { angular, .. } = &mut columns.momentum[place.row as usize];
        *angular = vec3(turn.normalize().rotate(dvec3(*angular).into()).into());
    }
}

/// The kinetic energy of a dynamic body \[J\].
pub(crate) fn energy(columns: &WorldColumns<'_>, place: RowPlace) -> Option<f64> {
    let (constants, state) = state_of(columns, place)?;
    Some(KineticEnergy::of(&constants, &state).sum())
}

/// What is constant of a dynamic body, and its state.
pub(crate) fn state_of(columns: &WorldColumns<'_>, place: RowPlace) -> Option<(Constants<Real>, State<Real>)> {
    let row = place.row as usize;
    let ArchetypeBodies::Dynamic(columns) = columns.bodies(place) else { return None };
    let axes = columns.axes.as_deref().map(|axes| &axes[row]);
    let inertia = columns.inertia.as_deref().map(|inertia| Moments::new(&inertia[row], axes));
    let constants = Constants { mass: columns.mass[row].kilograms(), inertia, damping: None };
    Some((constants, State::new(&columns.pose[row], &columns.momentum[row])))
}

/// Whether a body moves as fast as bodies may, also where impulses act on it this far from its
/// centre \[m\].
pub(crate) fn moves_in_range(columns: &WorldColumns<'_>, place: RowPlace, radius: Real) -> bool {
    match state_of(columns, place) {
        Some((constants, state)) => responds_in_range(&constants, [state.linear, state.angular], radius),
        None => match columns.bodies(place) {
            ArchetypeBodies::NonDynamic(columns) => {
                let Velocity { linear, angular } = columns.velocity(place.row as usize);
                [linear, angular].into_iter().all(|it| within(it.into(), MAX_SPEED))
            }
            _ => false,
        },
    }
}

/// Where a place is at the end that goes along with a course from a moment on.
fn carried(place: &Isometry<f64>, course: &Course, from: f64) -> Isometry<f64> {
    let [(before, turned), (after, turned_on)] = [from, 1.0].map(|moment| course.center_and_turn(moment));
    let turn = turned_on * turned.conjugate();
    Isometry { position: after + turn.rotate(place.position - before), orientation: turn * place.orientation }
}

/// A shape of a collider, and where it is in that.
type Placed<'a> = (&'a ColliderShape<Real>, &'a Isometry<f64>);

/// Shows the pairs of solid parts of two colliders that push each other, with their numbers.
fn for_each_pair([first, second]: [&Collider; 2], mut visit: impl FnMut([u32; 2], [Placed<'_>; 2])) {
    let here = Isometry::at(Vec3::zero());
    first.for_each_part(&here, |part, (groups, is_sensor), shape, inner| {
        second.for_each_part(&here, |its_part, (its_groups, is_its_sensor), its, its_inner| {
            if !is_sensor && !is_its_sensor && groups.touch(its_groups) {
                visit([part, its_part], [(shape, inner), (its, its_inner)]);
            }
        });
    });
}

/// A way to find the passage of two shapes.
type FindPassage = fn([&ColliderShape<Real>; 2], [&Course; 2]) -> Option<Passage>;

/// Where the core of a solid part of the second of two colliders first touches a solid part of the
/// first, and the number of that pair.
pub(crate) fn first_passage(
    both: [&Collider; 2],
    courses: &[Course; 2],
    find_passage: FindPassage,
) -> Option<(u32, Passage)> {
    let [first, second] = both;
    let mut found: Option<(u32, Passage)> = None;
    for_each_pair(both, |[part, its_part], [(shape, inner), (its, its_inner)]| {
        let [a, b] = [courses[0].of_part(inner), courses[1].of_part(its_inner)];
        if let Some(passage) = find_passage([shape, its], [&a, &b])
            && found.is_none_or(|(_, first)| passage.until < first.until)
        {
            let [number, its_number] = [first.number_of_part(part), second.number_of_part(its_part)];
            found = Some((number.wrapping_mul(second.geometry().parts()).wrapping_add(its_number), passage));
        }
    });
    found
}

/// The pose of the body of a row, if it is one.
pub(crate) fn pose_of(columns: &WorldColumns<'_>, place: RowPlace) -> Option<Pose> {
    match columns.bodies(place) {
        ArchetypeBodies::Dynamic(columns) => Some(columns.pose[place.row as usize]),
        ArchetypeBodies::NonDynamic(columns) => Some(columns.pose[place.row as usize]),
        ArchetypeBodies::None => None,
    }
}

/// The orientation of a body's collider at the end of a substep.
pub(crate) fn turned_end(pose: &Pose, collider: &Collider) -> Quat<Real> {
    let body = Quat::<Real>::from(pose.orientation).normalize();
    collider.place().map_or(body, |inner| body * inner.orientation)
}

pub(crate) fn wide_quat(it: Quat<Real>) -> Quat<f64> {
    Quat::<f64>::from(dquat(it.into())).normalize()
}

/// The place of a slot in a list of travellers.
pub(crate) fn find(travellers: &[Traveller], slot: Slot) -> usize {
    travellers.partition_point(|it| it.slot < slot)
}
