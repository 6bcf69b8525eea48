//! Sensors: which bodies are in which, what came and what left.

use glam::DVec3;
use hecs::Entity;
use rayon::prelude::*;
use tumble_collide::{ColliderShape, Course, Isometry, Meeting};
use tumble_math::lane::{Lane, Vec3};

use crate::collision::collider_state::ColliderState;
use crate::collision::compound_parts::wide;
use crate::collision::pipeline::{Colliders, CollisionPipeline};
use crate::collision::traveller::{course_to, expected_turn, pose_of};
use crate::components::Pose;
use crate::event_log::EventLog;
use crate::math::Real;
use crate::storage::body_index::Slot;
use crate::storage::world_columns::WorldColumns;
use crate::threads::InParts;

/// A body that comes into a [sensor](crate::Collider::sensor), or leaves it; see
/// [`Simulation::sensor_events`](crate::Simulation::sensor_events).
///
/// ```
/// # use tumble::{SensorEvent, prelude::*};
/// # let simulation = Simulation::new(Settings::default())?;
/// let is_in = |event: &SensorEvent| event.begins;
/// let arrived: Vec<_> =
///     simulation.sensor_events().filter(is_in).map(|event| event.body).collect();
/// # assert!(arrived.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("trigger event", "on_trigger_enter"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SensorEvent {
    /// The body that has the sensor.
    pub sensor: Entity,
    /// Of a compound collider, which of its parts the sensor is; otherwise zero.
    pub part: u32,
    /// The body that is sensed. Either may be gone where it leaves.
    pub body: Entity,
    /// Whether it comes in.
    pub begins: bool,
}

/// A body in a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sensed {
    /// Of the sensor and of what is in it.
    slots: [Slot; 2],
    part: u32,
    entities: [Entity; 2],
}

/// What is in which sensor, kept from step to step.
#[derive(Clone, Default)]
pub(crate) struct Sensors {
    /// In the order of slots, and of the parts.
    inside: Vec<Sensed>,
    /// Those of which a body is gone since.
    gone: Vec<Sensed>,
    /// Of the steps of the last call.
    pub(crate) events: EventLog<SensorEvent>,
    /// Whether `inside` is what was there when bodies were put elsewhere, so that it is found out
    /// without events.
    is_unknown: bool,
    /// Memory that every substep overwrites.
    found: Vec<Vec<Finding>>,
}

/// What a part of a sensor does in a substep with a body near it.
#[derive(Clone, Copy)]
struct Finding {
    slots: [Slot; 2],
    part: u32,
    /// Whether the body is in it at the beginning, at any time, and at the end.
    is_in: [bool; 3],
}

/// Pairs that one thread tests at a time.
const PART: usize = 16;
/// Bodies nearer than this part of their size touch, where they pass through.
const TOUCHING: f64 = 1e-6;

impl SensorEvent {
    fn of(sensed: &Sensed, begins: bool) -> Self {
        let [sensor, body] = sensed.entities;
        Self { sensor, part: sensed.part, body, begins }
    }
}

impl Sensed {
    fn key(&self) -> ([Slot; 2], u32) {
        (self.slots, self.part)
    }
}

impl Sensors {
    /// What is inside, as the events with which it came in.
    pub(crate) fn inside(&self) -> impl Iterator<Item = SensorEvent> + '_ {
        self.inside.iter().map(|sensed| SensorEvent::of(sensed, true))
    }

    /// Whether there is nothing to tell of any more.
    pub(crate) fn are_over(&self) -> bool {
        self.inside.is_empty() && self.gone.is_empty()
    }

    /// Forgets what is inside: the next substep finds it out without events.
    pub(crate) fn forget(&mut self) {
        self.inside.clear();
        self.gone.clear();
        self.events.clear();
        self.is_unknown = true;
    }

    /// Gives bodies the slots that they have now: `slots` are these by slot before.
    pub(crate) fn renumber(&mut self, slots: &[Slot]) {
        let Self { inside, gone, .. } = self;
        inside.retain_mut(|sensed| {
            let now = sensed.slots.map(|slot| slots.get(slot.index()).copied().unwrap_or(Slot::NONE));
            let stays = !now.contains(&Slot::NONE);
            if !stays {
                gone.push(*sensed);
            }
            sensed.slots = now;
            stays
        });
        inside.sort_unstable_by_key(Sensed::key);
    }

    /// All that is inside leaves: there are no sensors any more.
    pub(crate) fn end_all(&mut self) {
        let Self { inside, gone, events, is_unknown, .. } = self;
        *is_unknown = false;
        events.extend(gone.drain(..).chain(inside.drain(..)).map(|sensed| SensorEvent::of(&sensed, false)));
    }

    /// Takes over what was found in a substep.
    fn update(&mut self, entity: impl Fn(Slot) -> Entity) {
        let Self { inside, gone, events, is_unknown, found } = self;
        events.extend(gone.drain(..).map(|sensed| SensorEvent::of(&sensed, false)));
        let is_unknown = std::mem::take(is_unknown);
        let mut now = Vec::with_capacity(inside.len());
        let mut before = inside.iter().peekable();
        let mut all: Vec<Finding> = found.iter_mut().flat_map(|found| found.drain(..)).collect();
        all.sort_unstable_by_key(|finding| (finding.slots, finding.part));
        for Finding { slots, part, is_in: [at_start, at_any_time, at_end] } in all {
            let sensed = Sensed { slots, part, entities: slots.map(&entity) };
            while let Some(left) = before.next_if(|other| other.key() < sensed.key()) {
                events.push(SensorEvent::of(left, false));
            }
            let was_in = before.next_if(|other| other.key() == sensed.key()).is_some() || (is_unknown && at_start);
            match (was_in, at_end) {
                (false, true) => events.push(SensorEvent::of(&sensed, true)),
                (true, false) => events.push(SensorEvent::of(&sensed, false)),
                (false, false) if at_any_time => {
                    events.extend([true, false].map(|begins| SensorEvent::of(&sensed, begins)));
                }
                _ => {}
            }
            if at_end {
                now.push(sensed);
            }
        }
        events.extend(before.map(|left| SensorEvent::of(left, false)));
        *inside = now;
    }
}

/// A sensor and a body near it, in a substep.
struct Encounter<'a> {
    slots: [Slot; 2],
    colliders: &'a Colliders,
    /// Where both bodies' colliders are at the beginning, and at the end.
    placements: [[Isometry<f64>; 2]; 2],
    courses: [Course; 2],
}

impl CollisionPipeline {
    /// Finds out what is in sensors at the end of a substep of `h` \[s\], and what has come through
    /// them.
    pub(crate) fn update_sensors(&mut self, columns: &WorldColumns<'_>, h: Real) {
        let Self { sensors, near, collider_states, colliders, body_index, cache, .. } = self;
        let pairs = &near.sensed;
        if pairs.is_empty() && sensors.are_over() {
            sensors.is_unknown = false;
            return;
        }
        let states = &collider_states.states;
        let end = |slot: Slot| -> Option<(Pose, DVec3)> {
            let place = body_index.place(slot);
            Some((pose_of(columns, place)?, expected_turn(columns, place, &states[slot.index()], h)))
        };
        // Columns are not shared between threads.
        let ends: Vec<_> = pairs.iter().map(|slots| slots.map(end)).collect();
        let parts = pairs.len().div_ceil(PART);
        sensors.found.resize_with(parts.max(sensors.found.len()), Vec::new);
        let chunks = pairs.par_chunks(PART).zip(ends.par_chunks(PART)).zip(&mut sensors.found);
        chunks.by_at_least(1).for_each(|((pairs, ends), found)| {
            found.clear();
            for (slots, ends) in pairs.iter().zip(ends) {
                if let [Some(first), Some(second)] = *ends
                    && let Some(encounter) = Encounter::of(*slots, [first, second], states, colliders)
                {
                    encounter.find(found);
                }
            }
        });
        sensors.found[parts..].iter_mut().for_each(Vec::clear);
        sensors.update(|slot| cache.body_keys.entity(slot));
    }
}

impl<'a> Encounter<'a> {
    /// With the poses at the end, and by how much the bodies turned about \[rad\]; `None` where
    /// either is nowhere.
    fn of(
        slots: [Slot; 2],
        ends: [(Pose, DVec3); 2],
        states: &[ColliderState],
        colliders: &'a Colliders,
    ) -> Option<Self> {
        let [Some(first), Some(second)] = slots.map(|slot| colliders.get(slot)) else { return None };
        let colliders_of_both = [first, second];
        let both = [0, 1].map(|which: usize| {
            let state = &states[slots[which].index()];
            let (collider, offset) = colliders_of_both[which];
            let (pose, expected) = &ends[which];
            let start = wide(&state.placement);
            ([start, collider.placed_at(pose, *offset)], course_to(pose, (state, collider), *expected))
        });
        let is_somewhere = both.iter().all(|([start, end], _)| {
            [start, end]
                .into_iter()
                .all(|at| (at.position.dot(at.position) + at.orientation.length_squared()).is_finite())
        });
        let [([a, b], first), ([c, d], second)] = both;
        is_somewhere.then_some(Self { slots, colliders, placements: [[a, c], [b, d]], courses: [first, second] })
    }

    /// Adds what each part of the sensor finds.
    fn find(&self, found: &mut Vec<Finding>) {
        let [Some((sensor, _)), Some((body, _))] = self.slots.map(|slot| self.colliders.get(slot)) else { return };
        let here = Isometry::at(Vec3::zero());
        sensor.for_each_part(&here, |part, (groups, is_sensor), shape, inner| {
            let mut is_in = [false; 3];
            body.for_each_part(&here, |_, (others, is_other_sensor), other, other_inner| {
                if is_sensor && !is_other_sensor && groups.touch(others) {
                    let one = self.is_in([shape, other], [inner, other_inner]);
                    (0..3).for_each(|when| is_in[when] |= one[when]);
                }
            });
            if is_in != [false; 3] {
                found.push(Finding { slots: self.slots, part, is_in });
            }
        });
    }

    /// Whether two parts overlap at the beginning, at any time, and at the end.
    fn is_in(&self, shapes: [&ColliderShape<Real>; 2], inner: [&Isometry<f64>; 2]) -> [bool; 3] {
        let [first, second] = shapes;
        let [at_start, at_end] = self
            .placements
            .each_ref()
            .map(|[a, b]| first.overlap(&a.then(inner[0]), second, &b.then(inner[1])).is_some());
        let passes = || {
            let [a, b] = [0, 1].map(|which: usize| self.courses[which].of_part(inner[which]));
            let reach = |shape: &ColliderShape<Real>| shape.reach().map_or(0.0, f64::from);
            let tolerance = TOUCHING * Lane::min(reach(first), reach(second)).max(f64::MIN_POSITIVE);
            Meeting::find(shapes, [&a, &b], tolerance, 0.0).is_some_and(|met| met.is_hit)
        };
        [at_start, at_start || at_end || passes(), at_end]
    }
}
