//! What a simulation tells of its contacts.

use hecs::Entity;
use tumble_collide::MOST_POINTS;

use super::contact::{Contact as Held, HELD, RUBBED, SHAPE};
use super::touching::Contacts;
use crate::coupling::Coupling;
use crate::math::{Real, Vec3};
use crate::simulation::Simulation;

/// Two bodies that touch or are about to, as [`Simulation::contacts`](crate::Simulation::contacts) tells it: where, and with what impulses.
///
/// Impulses are those of the last substep of the contacts, of the length [`Settings::contact_substep`](crate::Settings::contact_substep): divided by it they are forces. At rest
/// these are the forces at any time; a body that hits another without bouncing may have been stopped in an earlier substep, whose impulse is not told.
///
/// ```
/// use tumble::{Collider, prelude::*};
///
/// let mut world = hecs::World::new();
/// let ground = RigidBody::new(Shape::Point).fixed().build()?.spawn_with(&mut world, (Collider::half_space(),));
/// let shape = Shape::cuboid([0.5, 0.5, 0.5]);
/// let collider = Collider::new(&shape)?;
/// let body = RigidBody::new(shape).mass(2.0).position(Vec3::Y * 0.5).build()?.spawn_with(&mut world, (collider,));
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.step_many(&mut world, 60);
/// let contacts: Vec<_> = simulation.contacts().collect();
/// assert_eq!((contacts.len(), contacts[0].points().len()), (1, 4));
/// assert_eq!(contacts[0].bodies, [ground, body]);
/// // Gravity pulls with M g, and the ground pushes back.
/// let force = contacts[0].impulse() / simulation.settings().contact_substep();
/// assert!((force.y - 2.0 * 9.81).abs() < 1e-2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Contact {
    /// The bodies, first the one that comes first in the order of [`BodyOrder`](crate::BodyOrder).
    pub bodies: [Entity; 2],
    /// Unit vector from the first body to the second, world frame.
    pub normal: Vec3,
    /// Impulse of friction on the second body \[N s\], world frame; the first has the opposite.
    pub friction: Vec3,
    points: [ContactPoint; MOST_POINTS],
    count: usize,
    touches: bool,
}

/// Where two bodies touch; see [`Contact`].
///
/// ```
/// # use tumble::{Collider, prelude::*};
/// # let mut world = hecs::World::new();
/// # RigidBody::new(Shape::Point).fixed().build()?.spawn_with(&mut world, (Collider::half_space(),));
/// # let shape = Shape::sphere(0.5);
/// # let collider = Collider::new(&shape)?;
/// // A ball a centimetre above the ground, at rest.
/// RigidBody::new(shape).mass(2.0).position(Vec3::Y * 0.51).build()?.spawn_with(&mut world, (collider,));
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.step(&mut world);
/// let contact = simulation.contacts().next().unwrap();
/// let point = contact.points()[0];
/// assert!((point.separation - 0.01).abs() < 1e-6 && point.impulse == 0.0 && !contact.touches());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ContactPoint {
    /// Where it was when the step began, or its last substep of the settings \[m\], world frame.
    pub position: Vec3,
    /// How far the surfaces were apart there then \[m\]; negative where they overlapped.
    pub separation: Real,
    /// Impulse along the normal on the second body \[N s\], never negative.
    pub impulse: Real,
}

/// What changed in a step between two bodies with colliders; see [`Simulation::contact_events`](crate::Simulation::contact_events).
///
/// ```
/// use tumble::{Collider, ContactEvent, prelude::*};
///
/// let mut world = hecs::World::new();
/// let ground = RigidBody::new(Shape::Point).fixed().build()?.spawn_with(&mut world, (Collider::half_space(),));
/// let shape = Shape::sphere(0.5);
/// let collider = Collider::new(&shape)?;
/// let ball = RigidBody::new(shape).mass(2.0).position(Vec3::Y).build()?.spawn_with(&mut world, (collider,));
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// let mut events = Vec::new();
/// for _ in 0..60 {
///     simulation.step(&mut world);
///     events.extend(simulation.contact_events());
/// }
/// assert_eq!(events, [ContactEvent::Begin([ground, ball])]);
/// world.despawn(ball)?;
/// simulation.step(&mut world);
/// assert_eq!(simulation.contact_events().collect::<Vec<_>>(), [ContactEvent::End([ground, ball])]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactEvent {
    /// They touch, and did not before the step. Both bodies, in the order of [`Contact::bodies`].
    Begin([Entity; 2]),
    /// They touched before the step, and do not any more. One of them may be gone.
    End([Entity; 2]),
}

impl ContactEvent {
    /// The bodies, in the order of [`Contact::bodies`].
    pub fn bodies(&self) -> [Entity; 2] {
        let (Self::Begin(bodies) | Self::End(bodies)) = *self;
        bodies
    }
}

impl Contact {
    /// The points, at least one and up to four.
    pub fn points(&self) -> &[ContactPoint] {
        &self.points[..self.count]
    }

    /// Whether the bodies touch, rather than being about to: something pushes, or a point is not apart. Bodies that touched still do while they are within a millimetre, so that what barely
    /// lies on another does not begin and end to touch with every step.
    pub fn touches(&self) -> bool {
        self.touches
    }

    /// The whole impulse on the second body, along the normal and of friction \[N s\]; the first has the opposite.
    pub fn impulse(&self) -> Vec3 {
        self.normal * self.points().iter().map(|point| point.impulse).sum::<Real>() + self.friction
    }
}

impl Simulation {
    /// The contacts of the last step, between bodies that touch or are about to, in the order of their bodies; see [`Contact`].
    ///
    /// They are made when they are asked for, in time and memory that go with their number; a step does nothing for it.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// # let simulation = Simulation::new(Settings::default())?;
    /// let load = |body| -> Vec3 {
    ///     let on_it = simulation.contacts().filter(|contact| contact.bodies[1] == body);
    ///     on_it.map(|contact| contact.impulse()).sum::<Vec3>() / simulation.settings().contact_substep()
    /// };
    /// # assert_eq!(load(tumble::hecs::Entity::DANGLING), Vec3::ZERO);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn contacts(&self) -> impl Iterator<Item = Contact> + '_ {
        self.touching().into_iter().flat_map(Contacts::read)
    }

    /// What began and ended to touch in the last step, in the order of the bodies; nothing where none has been taken since contacts were restored.
    ///
    /// A pair begins and ends once, whatever happens at its points, and not while it rests: see [`Contact::touches`]. What hits another, does not bounce and is pushed away
    /// within a step is not told of. A body that was despawned has ended to touch in the step after.
    ///
    /// ```
    /// # use tumble::{ContactEvent, prelude::*};
    /// # let (mut world, mut simulation) = (tumble::hecs::World::new(), Simulation::new(Settings::default())?);
    /// simulation.step(&mut world);
    /// for event in simulation.contact_events() {
    ///     match event {
    ///         ContactEvent::Begin([first, second]) => println!("{first:?} hits {second:?}"),
    ///         ContactEvent::End([first, second]) => println!("{first:?} leaves {second:?}"),
    ///     }
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn contact_events(&self) -> impl Iterator<Item = ContactEvent> + '_ {
        self.touching().into_iter().flat_map(Contacts::events)
    }

    fn touching(&self) -> Option<&Contacts> {
        let coupling: &Coupling = self.coupling.as_deref()?;
        coupling.contacts.as_ref()
    }
}

/// Surfaces this near \[m\] touch: as much as rounding leaves between bodies that stopped each other, a hundred metres from the origin.
const TOUCHING: Real = 1e-4;
/// Surfaces that touched have to be this far apart \[m\] to do so no more.
const APART: Real = 1e-3;

impl Held {
    /// Whether the bodies touch: something holds them apart, or nothing is between them. Not to be asked before the impulses are known.
    pub(super) fn touches(&self) -> bool {
        let within = if self.touched { APART } else { TOUCHING };
        (0..self.count()).any(|j| self.separation(j) <= within || self.numbers[HELD].0[j] > 0.0)
    }

    /// Both slots, the lower first.
    fn pair(&self) -> [u32; 2] {
        let [a, b] = self.slots;
        [a.min(b), a.max(b)]
    }
}

impl Contacts {
    /// The contacts of the last step, in the order of their bodies.
    pub(crate) fn read(&self) -> impl Iterator<Item = Contact> + '_ {
        let mut order: Vec<&Held> = self.contacts.iter().collect();
        // They are in this order but for the kinds of their shapes, which takes a sort that merges little time.
        order.sort_by_key(|contact| (contact.pair(), contact.part));
        order.into_iter().map(|contact| self.told(contact))
    }

    fn told(&self, held: &Held) -> Contact {
        let [x, y, z, ..] = held.numbers[SHAPE].0;
        let [u, v, w, ..] = held.numbers[RUBBED].0;
        let center = Vec3::from(self.center(held.slots[1]));
        let mut points = [ContactPoint::default(); MOST_POINTS];
        for (j, point) in points.iter_mut().enumerate().take(held.count()) {
            let place = Vec3::from(held.half_way(j));
            let (separation, impulse) = (held.separation(j), held.numbers[HELD].0[j]);
            *point = ContactPoint { position: center + place, separation, impulse };
        }
        // What the solver has for the first may be the second in order.
        let sign = if held.slots[0] < held.slots[1] { 1.0 } else { -1.0 };
        Contact {
            bodies: held.pair().map(|slot| self.names().entity(slot)),
            normal: Vec3::new(x, y, z) * sign,
            friction: Vec3::new(u, v, w) * sign,
            points,
            count: held.count(),
            touches: held.touches(),
        }
    }

    /// What began and ended to touch in the last step, in the order of the bodies.
    pub(crate) fn events(&self) -> impl Iterator<Item = ContactEvent> + '_ {
        let mut events = Vec::new();
        if let Some(before) = self.before_the_step() {
            let (before, now) = (touching_pairs(before), touching_pairs(&self.contacts));
            let without = |pairs: &[[u32; 2]], others: &[[u32; 2]]| -> Vec<[u32; 2]> {
                pairs.iter().filter(|pair| others.binary_search(pair).is_err()).copied().collect()
            };
            let named = |pair: [u32; 2]| pair.map(|slot| self.names().name(slot));
            let entities = |pair: [u32; 2]| pair.map(|slot| self.names().entity(slot));
            let begun = without(&now, &before).into_iter();
            let ended = without(&before, &now).into_iter();
            events.extend(begun.map(|pair| (named(pair), ContactEvent::Begin(entities(pair)))));
            events.extend(ended.map(|pair| (named(pair), ContactEvent::End(entities(pair)))));
            events.extend(self.past.parted.iter().map(|parted| (parted.names, ContactEvent::End(parted.entities))));
            events.sort_by_key(|(names, _)| *names);
            // Of a pair with several contacts each has parted.
            events.dedup();
        }
        events.into_iter().map(|(_, event)| event)
    }
}

/// The pairs of slots that touch, in order.
fn touching_pairs(contacts: &[Held]) -> Vec<[u32; 2]> {
    let mut pairs: Vec<_> = contacts.iter().filter(|contact| contact.touches()).map(Held::pair).collect();
    pairs.sort();
    pairs.dedup();
    pairs
}
