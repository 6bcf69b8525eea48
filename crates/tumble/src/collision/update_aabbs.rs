//! Where bodies with colliders are, as contacts are found with.

use tumble_collide::{ColliderShape, Isometry, Proxy};
use tumble_math::lane::{Quat, Vec3};

use crate::collision::aabb_tiles::{CenteredShape, update_in_tiles};
use crate::collision::collider::Collider;
use crate::collision::collider_state::{Activity, ColliderState, ColliderStates, Motion};
use crate::collision::narrow_phase::{LaneKind, ShapeLanesPart};
use crate::collision::near_pairs::SensorRole;
use crate::collision::pipeline::CollisionPipeline;
use crate::components::{GravityScale, Momentum, Pose, Velocity};
use crate::integrators::response_range::responds_in_range;
use crate::integrators::state::{Constants, Moments};
use crate::math::{Real, Vec3 as WorldVec3};
use crate::range::{MAX_DISTANCE_OF_CONTACTS, MAX_SPEED, within};
use crate::simd::{BLOCK, Tile};
use crate::storage::chunk::MIN_CHUNK;
use crate::storage::world_columns::{PoseView, WorldColumns};
use crate::threads;

impl CollisionPipeline {
    /// Reads where all bodies with colliders are, how far from there they may go in an interval,
    /// and how they go on in the one that the solver looks ahead.
    pub(crate) fn update_aabbs(&mut self, columns: &WorldColumns<'_>, intervals: Intervals) {
        let Self {
            body_index,
            collider_states: ColliderStates { states, activity, proxies, sensed_proxies, lanes },
            colliders,
            sleepers,
            are_states_known,
            ..
        } = self;
        let count = body_index.len();
        let keeps = *are_states_known && states.len() == count && !sleepers.asleep.is_empty();
        if !keeps {
            lanes.reset(count);
            states.clear();
            states.resize(count, ColliderState::NOWHERE);
            activity.clear();
            activity.resize(count, Activity::NotDynamic);
            proxies.clear();
            proxies.resize(count, ColliderState::no_proxy());
            sensed_proxies.clear();
            sensed_proxies.resize(colliders.sensors.len(), ColliderState::no_proxy());
        }
        *are_states_known = true;
        for (archetype, bodies) in columns.pose_views() {
            let mut row = 0;
            // Slots go by another order than rows, mostly the same.
            for run in body_index.slots_in(archetype).chunk_by(|a, b| b.0 == a.0 + 1) {
                let slots = run[0].index()..run[0].index() + run.len();
                let update = AabbUpdate {
                    colliders: &colliders.list[slots.clone()],
                    shapes: &colliders.centered[slots.clone()],
                    states: &mut states[slots.clone()],
                    activity: &mut activity[slots.clone()],
                    proxies: &mut proxies[slots.clone()],
                    sensed_proxies: sensed_proxies.get_mut(slots.clone()).unwrap_or_default(),
                    lanes: lanes.part(slots.clone()),
                    sensors: colliders.sensors.get(slots.clone()).unwrap_or_default(),
                    asleep: sleepers.asleep.part(slots),
                };
                update.run(bodies.rows(row..row + run.len()), intervals);
                row += run.len();
            }
        }
    }
}

/// What bodies are looked for over.
#[derive(Clone, Copy)]
pub(crate) struct Intervals {
    /// A substep of the settings \[s\].
    pub(crate) interval: Real,
    /// How far the solver looks ahead \[s\].
    pub(crate) ahead: Real,
    /// How far gravity takes what is at rest in that time \[m\].
    pub(crate) drop: WorldVec3,
}

/// The update of neighbouring slots.
pub(crate) struct AabbUpdate<'a> {
    colliders: &'a [Option<(Collider, WorldVec3)>],
    pub(crate) shapes: &'a [CenteredShape],
    pub(crate) states: &'a mut [ColliderState],
    pub(crate) activity: &'a mut [Activity],
    pub(crate) proxies: &'a mut [Proxy<Real>],
    /// Empty where there are no sensors.
    sensed_proxies: &'a mut [Proxy<Real>],
    pub(crate) lanes: ShapeLanesPart<'a>,
    /// Empty where there are none.
    sensors: &'a [SensorRole],
    /// Empty where none sleeps.
    asleep: &'a [bool],
}

impl AabbUpdate<'_> {
    /// Runs in parallel.
    fn run(mut self, bodies: PoseView<'_>, intervals: Intervals) {
        if self.states.len() <= MIN_CHUNK {
            return match bodies.dynamic {
                Some(dynamic) if self.sensors.is_empty() && self.asleep.is_empty() => {
                    update_in_tiles(&mut self, bodies, dynamic, intervals);
                }
                _ => (0..self.states.len()).for_each(|i| self.update(i, bodies, intervals)),
            };
        }
        let middle = (self.states.len() / 2).next_multiple_of(BLOCK);
        let (colliders, other_colliders) = self.colliders.split_at(middle);
        let (shapes, other_shapes) = self.shapes.split_at(middle);
        let (states, other_states) = self.states.split_at_mut(middle);
        let (activity, other_activity) = self.activity.split_at_mut(middle);
        let (proxies, other_proxies) = self.proxies.split_at_mut(middle);
        let (sensed_proxies, other_sensed_proxies) =
            self.sensed_proxies.split_at_mut(middle.min(self.sensed_proxies.len()));
        let (lanes, other_lanes) = self.lanes.split_at(middle);
        let (sensors, other_sensors) = self.sensors.split_at(middle.min(self.sensors.len()));
        let (asleep, other_asleep) = self.asleep.split_at(middle.min(self.asleep.len()));
        let others = AabbUpdate {
            colliders: other_colliders,
            shapes: other_shapes,
            states: other_states,
            activity: other_activity,
            proxies: other_proxies,
            sensed_proxies: other_sensed_proxies,
            lanes: other_lanes,
            sensors: other_sensors,
            asleep: other_asleep,
        };
        let these = AabbUpdate { colliders, shapes, states, activity, proxies, sensed_proxies, lanes, sensors, asleep };
        threads::join(
            || these.run(bodies.rows(0..middle), intervals),
            || others.run(bodies.rows(middle..bodies.pose.len()), intervals),
        );
    }

    fn is_asleep(&self, i: usize) -> bool {
        self.asleep.get(i).is_some_and(|it| *it)
    }

    /// Updates one body.
    pub(crate) fn update(
        &mut self,
        i: usize,
        bodies: PoseView<'_>,
        Intervals { interval, ahead: ahead_of, drop }: Intervals,
    ) {
        let is_asleep = self.is_asleep(i);
        if is_asleep && self.activity[i] == Activity::Asleep {
            // It is where it was.
            return;
        }
        let Some((collider, offset)) = &self.colliders[i] else { return };
        let center = Vec3::from(bodies.pose[i].position);
        let orientation = Quat::from(bodies.pose[i].orientation).normalize();
        let position = if *offset == WorldVec3::ZERO { center } else { center - orientation.rotate((*offset).into()) };
        let mut placement = collider.placement(Isometry { position, orientation });
        let velocity = bodies.velocity.map_or(Velocity::default(), |velocities| velocities[i]);
        let geometry = collider.geometry();
        let place = is_somewhere(&bodies.pose[i], [placement.position, center]);
        let from_center = placement.position - center;
        let radius = geometry.reach().unwrap_or(0.0) + from_center.dot(from_center).sqrt();
        let ccd_thickness = geometry.ccd_thickness();
        let is_dynamic = bodies.dynamic.is_some() && !is_asleep;
        let margin = if bodies.dynamic.is_some() { margin_of(ccd_thickness) } else { 0.0 };
        let mut motion = Motion { radius, ..Motion::NONE };
        let (linear, in_range) = match bodies.dynamic {
            Some((momenta, masses, inertia)) => {
                let (mass, Momentum { linear, angular }) = (masses[i].kilograms(), momenta[i]);
                let inertia = inertia.map(|inertia| Moments::new(&inertia[i], bodies.axes.map(|axes| &axes[i])));
                if let Some(inertia) = &inertia {
                    motion.turn = turning(inertia, (orientation, angular.into()), ahead_of, (margin, radius));
                }
                let constants = Constants { mass, inertia, damping: None };
                (linear / mass, place && responds_in_range(&constants, [linear.into(), angular.into()], radius))
            }
            None => {
                motion.turn = Vec3::from(velocity.angular) * ahead_of;
                let all = [velocity.linear, velocity.angular].into_iter().all(|it| within(it.into(), MAX_SPEED));
                (velocity.linear, place && all)
            }
        };
        motion.way = Vec3::from(linear) * ahead_of;
        motion.axis_turn = axis_turn(collider, *offset, &placement, &motion);
        let fallen = Vec3::from(drop) * if is_dynamic { scale_of(bodies.gravity_scale, i) } else { 0.0 };
        motion.drop = drop_of(fallen, ccd_thickness);
        let fall = motion.drop.dot(motion.drop).sqrt();
        if !in_range {
            // It is nowhere then, and touches nothing that it could spoil.
            placement.position = Vec3::splat(Real::NAN);
        }
        let kind = LaneKind::of(geometry);
        let way = linear.length() * interval;
        let reach = margin + ahead(way) + fall;
        self.lanes.set(i, geometry, &placement, center, (reach, margin));
        let (velocity, half_thickness) = ((velocity.linear.into(), velocity.angular.into()), ccd_thickness);
        let is_fixed = bodies.dynamic.is_none() && bodies.velocity.is_none();
        let awake =
            ColliderState { placement, center, kind, is_dynamic, is_fixed, half_thickness, ..ColliderState::NOWHERE };
        self.states[i] = ColliderState { reach, margin, velocity, motion, ..awake };
        self.activity[i] = match (is_dynamic, is_asleep) {
            (true, _) => Activity::Awake,
            (false, true) => Activity::Asleep,
            (false, false) => Activity::NotDynamic,
        };
        let senses = self.sensors.get(i).is_some_and(|role| role.has_sensor);
        self.proxies[i] = self.states[i].proxy(geometry, is_dynamic || is_asleep || senses);
        self.set_sensed_proxy(i, way, &motion);
    }

    /// Has sensors look all of the way \[m\] ahead, at what turns, and at what does not move.
    fn set_sensed_proxy(&mut self, i: usize, way: Real, motion: &Motion) {
        if let Some(sensed) = self.sensed_proxies.get_mut(i) {
            let (proxy, more) = (self.proxies[i], sensed_ahead(way, motion));
            *sensed = Proxy { aabb: proxy.aabb.map(|aabb| aabb.grown(more)), ..proxy };
        }
    }
}

/// The margin of a dynamic body as a share of half its thickness, ...
const MARGIN_SHARE: Real = 0.02;
/// ... but no more than this \[m\]; two dynamic bodies have the sum of theirs.
const MAX_MARGIN: Real = 0.01;

/// A body with half a thickness of less than this many falls in a step is so thin that gravity
/// alone may take it through the ground, or so deep into it that it shows.
const THIN: Real = 5.0;
/// A body whose furthest points turn by less than this part of its margin does not turn, for
/// speculative contacts.
const TURNED: Real = 0.25;

/// A centre of mass is on an axis that is nearer than this part of the radius.
const OFF_AXIS: Real = 1e-5;

/// By which angle the axis of a collider at this place turns \[rad\], if that goes through the
/// centre of mass, which is at `offset` \[m\] in the body's frame.
fn axis_turn(
    collider: &Collider,
    offset: WorldVec3,
    placement: &Isometry<Real>,
    &Motion { turn, radius, .. }: &Motion,
) -> Option<Real> {
    let geometry = collider.geometry();
    // Balls are as tiles have them.
    if matches!(geometry, ColliderShape::Sphere { .. }) || !geometry.is_axially_symmetric() {
        return None;
    }
    // In the body's frame, which knows the distance wherever the body is.
    let up = Vec3::new(0.0, 1.0, 0.0);
    let (inner, own_axis) = collider.place().map_or((Vec3::zero(), up), |at| (at.position, at.orientation.rotate(up)));
    let off_center = inner - Vec3::from(offset);
    let off_axis = off_center - own_axis * own_axis.dot(off_center);
    let [_, axis, _] = placement.orientation.axes();
    let turn = axis.cross(turn);
    let is_through = off_axis.dot(off_axis) <= (OFF_AXIS * radius) * (OFF_AXIS * radius);
    is_through.then(|| turn.dot(turn).sqrt())
}

/// Whether a body stands and is where contacts can be found.
fn is_somewhere(pose: &Pose, places: [Vec3<Real>; 2]) -> bool {
    let turned = (0.25..=4.0).contains(&pose.orientation.length_squared());
    turned && places.into_iter().all(|at| within(at, MAX_DISTANCE_OF_CONTACTS))
}

fn scale_of(scales: Option<&[GravityScale]>, i: usize) -> Real {
    scales.map_or(1.0, |scales| scales[i].0)
}

/// How much further a shape that goes a `way` \[m\] in a step looks for others \[m\].
fn ahead(way: Real) -> Real {
    if way.is_finite() { way } else { 0.0 }
}

/// How much further than for contacts a body is looked for by sensors \[m\].
fn sensed_ahead(way: Real, motion: &Motion) -> Real {
    let turn = motion.turn.dot(motion.turn).sqrt() * motion.radius;
    let more = way + turn;
    if more.is_finite() { more } else { 0.0 }
}

/// The margin of a dynamic body \[m\].
#[inline(always)]
pub(crate) fn margin_of<T: Tile>(half_thickness: T) -> T {
    (T::splat(MARGIN_SHARE.into()) * half_thickness).min(T::splat(MAX_MARGIN.into()))
}

/// How far gravity takes a body, if that is not little beside its thickness \[m\].
#[inline(always)]
pub(crate) fn drop_of<T: Tile>(fallen: Vec3<T>, half_thickness: T) -> Vec3<T> {
    let is_thin = half_thickness.lt(T::splat(THIN.into()) * fallen.dot(fallen).sqrt());
    Vec3::select(is_thin, fallen, Vec3::zero())
}

/// The angle by which a body with a margin and a radius \[m\] turns in an interval \[rad\], if that
/// may be more than is negligible.
#[inline(always)]
pub(crate) fn turning<T: Tile>(
    inertia: &Moments<T>,
    (orientation, momentum): (Quat<T>, Vec3<T>),
    interval: T,
    (margin, radius): (T, T),
) -> Vec3<T> {
    let Vec3 { x, y, z } = inertia.inverse_moments;
    let most = x.max(y).max(z) * momentum.dot(momentum).sqrt() * interval;
    let turns = (T::splat(TURNED.into()) * margin / radius).lt(most);
    if !T::any(turns) {
        return Vec3::zero();
    }
    Vec3::select(turns, inertia.angular_velocity(orientation, momentum) * interval, Vec3::zero())
}
