//! Contact events: which bodies begin and end to touch, and how hard they hit each other.

use hecs::Entity;

use crate::collision::body_key::BodyKey;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_cache::ContactCache;
use crate::collision::narrow_phase::LaneKind;
use crate::collision::pipeline::CollisionPipeline;
use crate::math::{Real, Vec3};
use crate::storage::body_index::Slot;

/// The begin or end of the contact of two bodies with colliders in a step; see
/// [`Simulation::contact_events`](crate::Simulation::contact_events).
///
/// ```
/// use tumble::{ContactEvent, prelude::*};
///
/// let mut world = hecs::World::new();
/// let ground = spawn_ground(&mut world);
/// let ball = RigidBody::new(Shape::sphere(0.5))
///     .mass(2.0)
///     .position(Vec3::Y)
///     .build()?
///     .spawn(&mut world);
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// let mut events = Vec::new();
/// for _ in 0..60 {
///     simulation.step(&mut world);
///     events.extend(simulation.contact_events());
/// }
/// let [ContactEvent::Begin(bodies, impact)] = events[..] else {
///     return Err("one contact begins".into());
/// };
/// assert_eq!(bodies, [ground, ball]);
/// // It fell through half a metre, and was stopped.
/// assert!((impact.speed - (9.81 as Real).sqrt()).abs() < 0.2);
/// assert!((impact.impulse - 2.0 * impact.speed).abs() < 0.4);
/// world.despawn(ball)?;
/// simulation.step(&mut world);
/// assert_eq!(
///     simulation.contact_events().collect::<Vec<_>>(),
///     [ContactEvent::End([ground, ball])]
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("collision event", "CollisionStarted", "on_collision_enter"))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactEvent {
    /// They touch, and did not before the step. Both bodies, in the order of
    /// [`Contact::bodies`](crate::Contact::bodies), and how they came together.
    Begin([Entity; 2], Impact),
    /// They touched before the step, and do not any more. One of them may be gone.
    End([Entity; 2]),
}

impl ContactEvent {
    /// The bodies, in the order of [`Contact::bodies`](crate::Contact::bodies).
    pub fn bodies(&self) -> [Entity; 2] {
        let (Self::Begin(bodies, _) | Self::End(bodies)) = *self;
        bodies
    }
}

/// How two bodies came together when they began to touch, as [`ContactEvent::Begin`] has it.
///
/// ```
/// # use tumble::{ContactEvent, prelude::*};
/// # let simulation = Simulation::new(Settings::default())?;
/// for event in simulation.contact_events() {
///     if let ContactEvent::Begin(_, impact) = event && impact.speed > 1.0 {
///         println!("bang at {}, {} N s", impact.point, impact.impulse);
///     }
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Impact {
    /// Where, in the middle of the points that push \[m\], world frame.
    pub point: Vec3,
    /// Unit vector from the first body to the second, world frame.
    pub normal: Vec3,
    /// How fast they came together along the normal, at the fastest point \[m/s\]: with the
    /// velocities before the step, or before the substep of the settings in which they met.
    pub speed: Real,
    /// Impulse along the normal over the step in which they met \[N s\], with that of a bounce. Of
    /// a blow at the end of a step a part may come in the next.
    pub impulse: Real,
}

/// The sort key of contacts without the part.
type Pair = (LaneKind, [Slot; 2]);

impl CollisionPipeline {
    /// The events of the last step, in the order of the bodies, as long as nothing was spawned or
    /// despawned since.
    pub(crate) fn events_of_step(&self) -> impl Iterator<Item = ContactEvent> + use<> {
        let ContactCache { body_keys, ended, .. } = &self.cache;
        let mut events: Vec<([BodyKey; 2], ContactEvent)> = Vec::new();
        if let Some(before) = self.cache.before_the_step() {
            let keys = |slots: [Slot; 2]| slots.map(|slot| body_keys.key(slot));
            let entities = |slots: [Slot; 2]| slots.map(|slot| body_keys.entity(slot));
            for_each_change(touching_pairs(before), touching_pairs(&self.contacts.records), |change| {
                events.push(match change {
                    Change::Begun((_, slots), contacts) => {
                        (keys(slots), ContactEvent::Begin(entities(slots), self.impact(slots, contacts)))
                    }
                    Change::Ended((_, slots)) => (keys(slots), ContactEvent::End(entities(slots))),
                });
            });
            events.extend(ended.iter().map(|ended| (ended.body_keys, ContactEvent::End(ended.entities))));
            events.sort_by_key(|(keys, _)| *keys);
            // Of a pair with several contacts each has parted.
            events.dedup();
        }
        events.into_iter().map(|(_, event)| event)
    }

    /// How two bodies came together, by their contacts.
    fn impact(&self, slots: [Slot; 2], contacts: &[ContactRecord]) -> Impact {
        let (mut point, mut normal, mut total) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        for contact in contacts {
            // Where none pushes all count alike.
            let weights = |j: usize| contact.normal_impulses.at_points[j] + Real::MIN_POSITIVE;
            let sum: Real = (0..contact.count()).map(weights).sum();
            let middle: Vec3 = (0..contact.count()).map(|j| self.position(contact, j) * (weights(j) / sum)).sum();
            let weight = contact.impulse_of_step() + Real::MIN_POSITIVE;
            let sign = if contact.slots == slots { 1.0 } else { -1.0 };
            point += middle * weight;
            normal += Vec3::from(contact.geometry.normal) * (sign * weight);
            total += weight;
        }
        Impact {
            point: point / total,
            normal: (normal / total).normalize_or_zero(),
            speed: contacts.iter().fold(0.0, |most, contact| contact.closing_speed.max(most)),
            impulse: contacts.iter().map(ContactRecord::impulse_of_step).sum(),
        }
    }
}

/// A pair that touches, with its contacts.
type Touching<'a> = (Pair, &'a [ContactRecord]);

enum Change<'a> {
    Begun(Pair, &'a [ContactRecord]),
    Ended(Pair),
}

/// Goes along both lists, which are in order, and shows what is in one of them only.
fn for_each_change<'a>(
    before: impl Iterator<Item = Touching<'a>>,
    now: impl Iterator<Item = Touching<'a>>,
    mut change: impl FnMut(Change<'a>),
) {
    let mut before = before.map(|(pair, _)| pair).peekable();
    for (pair, contacts) in now {
        while let Some(ended) = before.next_if(|other| *other < pair) {
            change(Change::Ended(ended));
        }
        if before.next_if_eq(&pair).is_none() {
            change(Change::Begun(pair, contacts));
        }
    }
    before.for_each(|ended| change(Change::Ended(ended)));
}

/// The pairs that touch, in order. The contacts of a pair lie next to each other.
fn touching_pairs(contacts: &[ContactRecord]) -> impl Iterator<Item = Touching<'_>> {
    let pair = |contact: &ContactRecord| (contact.kind, contact.pair());
    contacts
        .chunk_by(move |a, b| pair(a) == pair(b))
        .filter(|contacts| contacts.iter().any(ContactRecord::touches))
        .map(move |contacts| (pair(&contacts[0]), contacts))
}
