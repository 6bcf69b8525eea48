//! The motion of bodies that the second net has stopped, for the rest of the substep.
//!
//! What a spinning rod meets with its tip it meets again in every step. Left where it was stopped,
//! it would hang in the air for as long as it spins.

use glam::DVec3;
use tumble_collide::{Aabb, Course, Passage};
use tumble_math::FreeRotation;
use tumble_math::lane::{Quat, Vec3};

use crate::collision::collider::Collider;
use crate::collision::pipeline::CollisionPipeline;
use crate::collision::sweep::Surroundings;
use crate::collision::traveller::{Traveller, first_passage, nearest_turn, pose_of, state_of, wide_quat};
use crate::components::Pose;
use crate::integrators::derived::derived;
use crate::joints::axes::Axes;
use crate::math::{Real, Vec3 as WorldVec3, dvec3, quat, real, vec3};
use crate::settings::Settings;
use crate::storage::body_index::Slot;
use crate::storage::world_columns::WorldColumns;

/// How a body moves in some time.
struct Motion {
    /// Its momentum in the end [kg m/s].
    linear: DVec3,
    /// Of its centre of mass \[m\].
    way: DVec3,
    /// About its centre of mass \[rad\].
    turn: DVec3,
    orientation: Quat<f64>,
}

/// How a body goes on.
#[derive(Clone, Copy, PartialEq)]
enum Path {
    /// As what nothing touches.
    Free,
    Straight,
    /// Straight along a plane with this normal.
    Along(DVec3),
}

/// What is in the way of a body.
struct InTheWay {
    /// How much of a motion there is until it is touched.
    until: f64,
    normal: DVec3,
    other: Slot,
}

/// The rest of a substep.
#[derive(Clone, Copy)]
struct Rest {
    /// Its length \[s\].
    time: f64,
    /// [m/s^2].
    gravity: DVec3,
    /// How fast what the body stays with has carried it already [m/s].
    carried: DVec3,
}

impl CollisionPipeline {
    /// Moves the free bodies that were stopped on, one after the other, until the substep ends or
    /// they would be through something. All others are where they are at the end of the substep.
    pub(crate) fn move_on(
        &self,
        travellers: &[Traveller],
        columns: &mut WorldColumns<'_>,
        surroundings: Surroundings<'_>,
        settings: &Settings,
    ) {
        for it in travellers.iter().filter(|it| it.is_free && it.until < 1.0) {
            if it.locked_axes(columns) == Axes::NONE {
                let time = (1.0 - it.until) * f64::from(settings.substep());
                let carried = it.carried_way(travellers) / time;
                self.move_one(it, columns, surroundings, Rest { time, gravity: dvec3(settings.gravity), carried });
            }
        }
    }

    /// Moves a body as if nothing touched it; from what is in the way on, straight without turning,
    /// and at last along that.
    fn move_one(&self, it: &Traveller, columns: &mut WorldColumns<'_>, surroundings: Surroundings<'_>, mut rest: Rest) {
        let is_dynamic = |slot: Slot| self.collider_states.states[slot.index()].is_dynamic;
        let mut path = Path::Free;
        while rest.time > 0.0 {
            let Some(motion) = Motion::of(it, columns, rest, path) else { return };
            let Some(first) = self.first_in_the_way(it.slot, &motion, columns, surroundings) else {
                return motion.write(it, columns);
            };
            let until = Rest { time: rest.time * first.until, ..rest };
            let Some(shorter) = Motion::of(it, columns, until, path) else { return };
            // The shorter way is another where the body turns.
            if path != Path::Free || self.first_in_the_way(it.slot, &shorter, columns, surroundings).is_none() {
                shorter.write(it, columns);
                rest.time -= until.time;
            }
            path = match path {
                Path::Free => Path::Straight,
                // On any other way than straight on it would not keep its angular momentum.
                Path::Straight if !is_dynamic(first.other) => Path::Along(first.normal),
                Path::Straight | Path::Along(_) => return,
            };
        }
    }

    /// What the core of a body would touch first in a motion.
    fn first_in_the_way(
        &self,
        slot: Slot,
        motion: &Motion,
        columns: &WorldColumns<'_>,
        surroundings: Surroundings<'_>,
    ) -> Option<InTheWay> {
        let pose = |slot: Slot| pose_of(columns, self.body_index.place(slot));
        let (start, (collider, offset)) = (pose(slot)?, self.colliders.get(slot)?);
        let course = course((collider, *offset), &start, [motion.way, motion.turn]);
        let mut first: Option<InTheWay> = None;
        let aabb = self.aabb_of_way(slot, &start, motion.way);
        self.for_each_near((slot, &aabb), columns, surroundings, |other| {
            let (Some(end), Some((its, its_offset))) = (pose(other), self.colliders.get(other)) else { return };
            let its_course = self::course((its, *its_offset), &end, [DVec3::ZERO; 2]);
            if let Some((part, passage)) = first_passage([its, collider], &[its_course, course], Passage::find)
                && first.as_ref().is_none_or(|first| (passage.until, other) < (first.until, first.other))
                && !self.lets_pass([other, slot], part, &passage)
            {
                first = Some(InTheWay { until: passage.until, normal: passage.normal.into(), other });
            }
        });
        first
    }

    /// The box around the way of a body from a pose on.
    fn aabb_of_way(&self, slot: Slot, start: &Pose, way: DVec3) -> Aabb<Real> {
        let half = Vec3::splat(self.collider_states.states[slot.index()].motion.radius);
        let from = Vec3::<Real>::from(start.position);
        Aabb::about(from, half).union(&Aabb::about(from + Vec3::from(vec3(way)), half))
    }
}

impl Motion {
    /// Of a body with its momenta under gravity; `None` of one that is not dynamic.
    fn of(
        it: &Traveller,
        columns: &WorldColumns<'_>,
        Rest { time, gravity, carried }: Rest,
        path: Path,
    ) -> Option<Self> {
        let (constants, state) = state_of(columns, it.place)?;
        let mass = f64::from(constants.mass);
        let along = |v: DVec3| match path {
            Path::Along(normal) => v - normal * normal.dot(v),
            Path::Free | Path::Straight => v,
        };
        let (gravity, linear) = (along(gravity * f64::from(it.gravity_scale(columns))), dvec3(state.linear.into()));
        let way = along(linear / mass - carried) * time + gravity * (0.5 * time * time);
        let start = wide_quat(state.orientation);
        let (mut orientation, mut turn) = (start, DVec3::ZERO);
        if let Some(inertia) = constants.inertia.as_ref().filter(|_| path == Path::Free) {
            let rotation = FreeRotation::new(inertia.moments, inertia.inverse_moments, inertia.axes, real(time));
            orientation = wide_quat(rotation.rotate(state.orientation, state.angular));
            let expected = dvec3(derived(&constants, &state).angular.into()) * time;
            let turned = (orientation * start.conjugate()).normalize();
            turn = nearest_turn(tumble_math::to_scaled_axis(turned.into()), expected);
        }
        Some(Self { linear: linear + gravity * (mass * time), way, turn, orientation })
    }

    /// Moves a body by it.
    fn write(&self, it: &Traveller, columns: &mut WorldColumns<'_>) {
        let before = it.energy(columns);
        let row = it.place.row as usize;
        if let Some(columns) = columns.dynamic_mut(it.place) {
            let Pose { position, .. } = columns.pose[row];
            let orientation = quat(self.orientation.normalize().into());
            columns.pose[row] = Pose { position: vec3(dvec3(position) + self.way), orientation };
            columns.momentum[row].linear = vec3(self.linear);
        }
        it.book(before, columns);
    }
}

/// The course from a pose of a collider, with its body's centre of mass in the body's frame \[m\],
/// by a way \[m\] and a turn \[rad\].
fn course((collider, offset): (&Collider, WorldVec3), start: &Pose, [way, turn]: [DVec3; 2]) -> Course {
    let center = dvec3(start.position);
    Course::new(&collider.placed_at(start, offset), center.into(), way.into(), turn.into())
}
