//! Contacts and contact events of a simulation.

use hecs::Entity;
use tumble_collide::MAX_MANIFOLD_POINTS;

use crate::collision::contact::ContactRecord;
use crate::collision::contact_events::ContactEvent;
use crate::collision::pipeline::CollisionPipeline;
use crate::math::{Real, Vec3};
use crate::step::interactions::Interactions;
use crate::step::simulation::Simulation;

/// Two bodies that touch or are about to, as [`Simulation::contacts`](crate::Simulation::contacts)
/// tells it: where, and with what impulses.
///
/// Impulses are those of the last substep of the contacts, of the length
/// [`Settings::contact_substep`](crate::Settings::contact_substep): divided by it they are forces.
/// At rest these are the forces at any time; a body that hits another without bouncing may have
/// been stopped in an earlier substep, whose impulse is not reported.
///
/// ```
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// let ground = spawn_ground(&mut world);
/// let body = RigidBody::new(Shape::cuboid([0.5, 0.5, 0.5]))
///     .mass(2.0)
///     .position(Vec3::Y * 0.5)
///     .build()?
///     .spawn(&mut world);
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
    points: [ContactPoint; MAX_MANIFOLD_POINTS],
    count: usize,
    touches: bool,
}

/// Where two bodies touch; see [`Contact`].
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// # spawn_ground(&mut world);
/// // A ball half a centimetre above the ground, at rest.
/// RigidBody::new(Shape::sphere(0.5))
///     .mass(2.0)
///     .position(Vec3::Y * 0.505)
///     .build()?
///     .spawn(&mut world);
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.step(&mut world);
/// let contact = simulation.contacts().next().unwrap();
/// let point = contact.points()[0];
/// assert!((point.separation - 0.005).abs() < 1e-6 && point.impulse == 0.0 && !contact.touches());
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

impl Contact {
    /// The points, at least one and up to four.
    pub fn points(&self) -> &[ContactPoint] {
        &self.points[..self.count]
    }

    /// Whether the bodies touch, rather than being about to: something pushes, or a point is not
    /// apart. Bodies that touched still do while they are within a millimetre, so that what barely
    /// lies on another does not begin and end to touch with every step.
    pub fn touches(&self) -> bool {
        self.touches
    }

    /// The whole impulse on the second body, along the normal and of friction \[N s\]; the first
    /// has the opposite.
    pub fn impulse(&self) -> Vec3 {
        self.normal * self.points().iter().map(|point| point.impulse).sum::<Real>() + self.friction
    }
}

impl Simulation {
    /// The contacts of the last step, between bodies that touch or are about to, in the order of
    /// their bodies; see [`Contact`].
    ///
    /// They are made when they are asked for, in time and memory that go with their number; a step
    /// does nothing for it.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// # let simulation = Simulation::new(Settings::default())?;
    /// let load = |body| -> Vec3 {
    ///     let on_it = simulation.contacts().filter(|contact| contact.bodies[1] == body);
    ///     on_it.map(|contact| contact.impulse()).sum::<Vec3>()
    ///         / simulation.settings().contact_substep()
    /// };
    /// # assert_eq!(load(tumble::hecs::Entity::DANGLING), Vec3::ZERO);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn contacts(&self) -> impl Iterator<Item = Contact> + '_ {
        self.collision().into_iter().flat_map(CollisionPipeline::report)
    }

    /// The contact events of the steps of the last call of [`step`](Self::step),
    /// [`step_many`](Self::step_many), [`advance`](Self::advance) or
    /// [`advance_with`](Self::advance_with): every event once, in the order of the steps, and
    /// within a step in the order of the bodies. A frame without a step has none, nor has a
    /// simulation that was restored and has taken no step since. Within the closure of
    /// [`advance_with`](Self::advance_with) they are those of the last step. In the course of a
    /// step that is taken [phase by phase](Self::begin_step) there are none.
    ///
    /// A pair begins and ends once, whatever happens at its points, and not while it rests: see
    /// [`Contact::touches`](crate::Contact::touches). What hits another begins to touch it in that
    /// step, however far it is away at the end; but what flies out of reach in a
    /// [substep of the settings](crate::Settings::substeps) before the last has no event. A body
    /// that was despawned has ended to touch in the step after.
    ///
    /// Those of a single step are put together when they are asked for. Of several, those of all
    /// but the last are kept, fifty-six bytes each, until the next call.
    ///
    /// ```
    /// # use tumble::{ContactEvent, prelude::*};
    /// # let mut world = tumble::hecs::World::new();
    /// # let mut simulation = Simulation::new(Settings::default())?;
    /// # let frame_seconds = 0.02;
    /// simulation.advance(&mut world, frame_seconds);
    /// for event in simulation.contact_events() {
    ///     match event {
    ///         ContactEvent::Begin([first, second], impact) => {
    ///             println!("{first:?} hits {second:?} at {} m/s", impact.speed);
    ///         }
    ///         ContactEvent::End([first, second]) => println!("{first:?} leaves {second:?}"),
    ///     }
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn contact_events(&self) -> impl Iterator<Item = ContactEvent> + '_ {
        let collision = self.collision().filter(|_| self.has_stepped);
        let of_call = collision.into_iter().flat_map(|it| it.cache.events.iter().copied().chain(it.events_of_step()));
        self.events.iter().copied().chain(of_call)
    }

    /// Forgets the events of the last call.
    pub(crate) fn forget_events(&mut self) {
        self.forget_earlier_events();
        let Some(interactions) = &mut self.interactions else { return };
        interactions.mechanisms.list.events.clear();
        if let Some(collision) = &mut interactions.collision {
            collision.sensors.events.clear();
        }
    }

    /// Forgets the events of the steps before the last.
    pub(crate) fn forget_earlier_events(&mut self) {
        self.events.clear();
        self.joint_events.clear();
        self.sensor_events.clear();
        let Some(interactions) = &mut self.interactions else { return };
        interactions.mechanisms.list.events.forget_earlier();
        if let Some(collision) = &mut interactions.collision {
            collision.cache.events.clear();
            collision.sensors.events.forget_earlier();
        }
    }

    /// How many pairs of bodies that are near each other were left out of the last step, or of its
    /// last substep: usually none.
    ///
    /// A body that is near more than 64 others is in a crowd. Between two in a crowd a pair counts
    /// if it is one of the 64 of either that overlap deepest or are nearest, by the boxes around
    /// them; of equal ones those with the body that comes first in the order of
    /// [`BodyOrder`](crate::BodyOrder). So what is large may touch any number of small ones, and
    /// infinite ground all there is.
    ///
    /// Between two bodies the 1024 contacts of their parts that are deepest count; pairs of parts
    /// beyond that are in the number.
    ///
    /// ```
    /// use tumble::prelude::*;
    ///
    /// let mut world = hecs::World::new();
    /// let shape = Shape::sphere(0.5);
    /// for _ in 0..200 {
    ///     RigidBody::new(shape.clone()).mass(1.0).build()?.spawn(&mut world);
    /// }
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.step(&mut world);
    /// assert!(simulation.contacts().count() <= 200 * 64);
    /// assert_eq!(simulation.contacts().count() + simulation.pairs_left_out(), 200 * 199 / 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pairs_left_out(&self) -> usize {
        self.collision().map_or(0, |collision| collision.near.limit.left_out)
    }

    pub(crate) fn collision(&self) -> Option<&CollisionPipeline> {
        let interactions: &Interactions = self.interactions.as_deref()?;
        interactions.collision.as_ref()
    }
}

impl CollisionPipeline {
    /// The contacts of the last step, in the order of their bodies.
    pub(crate) fn report(&self) -> impl Iterator<Item = Contact> + '_ {
        let mut order: Vec<&ContactRecord> = self.contacts.records.iter().chain(&self.sleepers.contacts).collect();
        // They are in this order but for the kinds of their shapes, which takes a sort that merges
        // little time.
        order.sort_by_key(|contact| (contact.pair(), contact.part));
        order.into_iter().map(|contact| self.report_one(contact))
    }

    /// Where the surfaces of a contact meet at a point \[m\], world frame.
    pub(crate) fn position(&self, contact: &ContactRecord, j: usize) -> Vec3 {
        Vec3::from(self.center(contact.slots[1])) + Vec3::from(contact.half_way(j))
    }

    fn report_one(&self, contact: &ContactRecord) -> Contact {
        let mut points = [ContactPoint::default(); MAX_MANIFOLD_POINTS];
        for (j, point) in points.iter_mut().enumerate().take(contact.count()) {
            let (separation, impulse) = (contact.separation(j), contact.normal_impulses.at_points[j]);
            *point = ContactPoint { position: self.position(contact, j), separation, impulse };
        }
        // What the solver has for the first may be the second in order.
        let sign = if contact.slots[0] < contact.slots[1] { 1.0 } else { -1.0 };
        Contact {
            bodies: contact.pair().map(|slot| self.cache.body_keys.entity(slot)),
            normal: Vec3::from(contact.geometry.normal) * sign,
            friction: Vec3::from(contact.friction.linear) * sign,
            points,
            count: contact.count(),
            touches: contact.touches(),
        }
    }
}
