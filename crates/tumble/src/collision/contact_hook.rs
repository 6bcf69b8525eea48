//! The caller's hook that sees contacts before they are solved, and may change or refuse them.

use std::fmt;
use std::sync::Arc;

use hecs::Entity;
use rayon::prelude::*;
use tumble_collide::Passage;
use tumble_math::lane::Vec3 as LaneVec3;

use crate::collision::contact::ContactRecord;
use crate::collision::material::{MAX_SURFACE_SPEED, Surface};
use crate::collision::pipeline::{CollisionPipeline, PART};
use crate::math::{Real, Vec3, vec3};
use crate::storage::body_index::Slot;
use crate::threads::InParts;

/// A contact before it is solved, as a
/// [contact hook](crate::Simulation::set_contact_hook) gets it: of two bodies that touch, or may in
/// the next step.
///
/// What it says of the bodies is for reading; friction, restitution and the other numbers of the
/// surfaces may be changed. A number that is negative or not finite leaves what was there.
///
/// ```
/// use tumble::{ContactProposal, prelude::*};
///
/// // A platform that is solid from above, and open from below.
/// let mut world = hecs::World::new();
/// let platform = RigidBody::new(Shape::cuboid([2.0, 0.1, 2.0])).fixed().build()?;
/// let platform = platform.spawn(&mut world);
/// let ball = |height: f64, speed: f64| {
///     let [height, speed] = [height, speed].map(|it| it as Real);
///     let body = RigidBody::new(Shape::sphere(0.2)).mass(1.0).position(Vec3::Y * height);
///     body.linear_velocity(Vec3::Y * speed).build()
/// };
/// let jumper = ball(-1.0, 7.0)?.spawn(&mut world);
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.set_contact_hook(move |contact: &mut ContactProposal| {
///     let Some(up) = contact.normal_from(platform) else { return };
///     // What it holds stays held; anything else has to come down on it.
///     if !contact.touched && (up.y < 0.7 || contact.closing_speed == 0.0) {
///         contact.refuse();
///     }
/// });
/// simulation.step_many(&mut world, 180);
/// // It flew up through the platform, and lies on it now.
/// assert!((world.get::<&Pose>(jumper)?.position.y - 0.3).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("collision hook", "one-way platform", "PhysicsHooks"))]
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ContactProposal {
    /// The bodies, first the one that comes first in the order of [`BodyOrder`](crate::BodyOrder).
    pub bodies: [Entity; 2],
    /// Unit vector from the first body to the second, world frame.
    pub normal: Vec3,
    /// Whether the bodies touched after the last step, as
    /// [`Contact::touches`](crate::Contact::touches) has it.
    pub touched: bool,
    /// How fast they come together along the normal \[m/s\]; of bodies that touch, how fast they
    /// did when they began to.
    pub closing_speed: Real,
    /// Coefficient of friction while nothing slides.
    pub static_friction: Real,
    /// Coefficient of friction of what slides.
    pub dynamic_friction: Real,
    /// Speed after a bounce over speed before it, from 0 to 1.
    pub restitution: Real,
    /// Resistance to rolling as a length \[m\].
    pub rolling_resistance: Real,
    /// The velocity of the second body relative to the first at which nothing slides \[m/s\], world
    /// frame: see [`Material::surface_velocity`](crate::Material::surface_velocity).
    pub surface_velocity: Vec3,
    least_separation: Real,
    point: Vec3,
    is_refused: bool,
}

impl ContactProposal {
    /// Has the two bodies pass through each other here, for the time that a step looks ahead. It is
    /// proposed again in the next.
    pub fn refuse(&mut self) {
        self.is_refused = true;
    }

    /// The unit vector from a body to the other, if it is one of the two.
    #[must_use]
    pub fn normal_from(&self, body: Entity) -> Option<Vec3> {
        let sign = [1.0, -1.0][self.bodies.iter().position(|it| *it == body)?];
        Some(self.normal * sign)
    }

    /// The other of the two bodies, if the one given is one of them.
    #[must_use]
    pub fn other(&self, body: Entity) -> Option<Entity> {
        let place = self.bodies.iter().position(|it| *it == body)?;
        Some(self.bodies[1 - place])
    }

    /// How far the surfaces are apart at the deepest point \[m\]; negative where they overlap.
    #[must_use]
    pub fn least_separation(&self) -> Real {
        self.least_separation
    }

    /// The deepest point, half-way between the surfaces \[m\], world frame.
    #[must_use]
    pub fn point(&self) -> Vec3 {
        self.point
    }

    /// Its numbers of the surfaces, where they can be; else those of `before`.
    fn surface(&self, before: &Surface) -> Surface {
        let checked =
            |value: Real, most: Real, before: Real| if (0.0..=most).contains(&value) { value } else { before };
        let dynamic_friction = checked(self.dynamic_friction, Real::MAX, before.dynamic_friction);
        Surface {
            static_friction: checked(self.static_friction, Real::MAX, before.static_friction).max(dynamic_friction),
            dynamic_friction,
            restitution: checked(self.restitution, 1.0, before.restitution),
            rolling_resistance: checked(self.rolling_resistance, Real::MAX, before.rolling_resistance),
        }
    }
}

/// What is called with every contact.
#[derive(Clone)]
pub(crate) struct ContactHook(Arc<dyn Fn(&mut ContactProposal) + Send + Sync>);

impl fmt::Debug for ContactHook {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ContactHook")
    }
}

impl ContactHook {
    pub(crate) fn new(hook: impl Fn(&mut ContactProposal) + Send + Sync + 'static) -> Self {
        Self(Arc::new(hook))
    }
}

impl CollisionPipeline {
    /// Shows the contacts of a substep to the hook, and drops those that it refuses.
    pub(crate) fn propose_contacts(&mut self) {
        self.refused.clear();
        let Some(hook) = self.hook.clone() else { return };
        let mut records = std::mem::take(&mut self.contacts.records);
        records.par_chunks_mut(PART).by_at_least(1).for_each(|contacts| {
            for contact in contacts {
                let mut proposal = self.proposal(contact);
                (hook.0)(&mut proposal);
                if proposal.is_refused {
                    contact.geometry.count = 0.0;
                } else {
                    take_over(&proposal, contact);
                }
            }
        });
        let refused = records.iter().filter(|contact| contact.count() == 0);
        self.refused.extend(refused.map(ContactRecord::pair));
        if !self.refused.is_empty() {
            records.retain(|contact| contact.count() > 0);
            // A pair of which some contacts hold is no pair that passes.
            let mut held: Vec<[Slot; 2]> = records.iter().map(ContactRecord::pair).collect();
            held.sort_unstable();
            self.refused.retain(|pair| held.binary_search(pair).is_err());
            self.refused.sort_unstable();
        }
        self.contacts.records = records;
    }

    /// Whether the hook lets two bodies pass that would be stopped on their ways.
    pub(crate) fn lets_pass(&self, slots: [Slot; 2], part: u32, passage: &Passage) -> bool {
        let Some(hook) = &self.hook else { return false };
        let [a, b] = slots;
        if self.refused.binary_search(&[a.min(b), a.max(b)]).is_ok() {
            return true;
        }
        let mut contact = ContactRecord { slots, part, ..ContactRecord::NONE };
        contact.geometry.normal = LaneVec3::from(vec3(passage.normal.into()));
        contact.geometry.count = 1.0;
        contact.set_surface(&self.colliders.materials.between(slots, part));
        let center = self.collider_states.states[b.index()].center;
        contact.points[0].positions[0] = LaneVec3::from(vec3(passage.point.into())) - center;
        contact.normal_impulses.gap_share = 0.5;
        contact.closing_speed =
            contact.closing_speed_of(slots.map(|slot| &self.collider_states.states[slot.index()]), self.ahead);
        let mut proposal = self.proposal(&contact);
        (hook.0)(&mut proposal);
        proposal.is_refused
    }

    fn proposal(&self, contact: &ContactRecord) -> ContactProposal {
        // What the solver has for the first may be the second in order.
        let sign = if contact.slots[0] < contact.slots[1] { 1.0 } else { -1.0 };
        let deepest = (0..contact.count()).min_by(|i, j| contact.separation(*i).total_cmp(&contact.separation(*j)));
        let deepest = deepest.unwrap_or(0);
        ContactProposal {
            bodies: contact.pair().map(|slot| self.cache.body_keys.entity(slot)),
            normal: Vec3::from(contact.geometry.normal) * sign,
            touched: contact.touched,
            closing_speed: contact.closing_speed,
            static_friction: contact.normal_impulses.static_friction,
            dynamic_friction: contact.normal_impulses.dynamic_friction,
            restitution: contact.geometry.restitution,
            rolling_resistance: contact.geometry.rolling_resistance,
            surface_velocity: Vec3::from(contact.surface_velocity) * sign,
            least_separation: contact.separation(deepest),
            point: self.position(contact, deepest),
            is_refused: false,
        }
    }
}

/// Gives a contact the numbers that the hook left.
fn take_over(proposal: &ContactProposal, contact: &mut ContactRecord) {
    let before = Surface {
        static_friction: contact.normal_impulses.static_friction,
        dynamic_friction: contact.normal_impulses.dynamic_friction,
        restitution: contact.geometry.restitution,
        rolling_resistance: contact.geometry.rolling_resistance,
    };
    contact.set_surface(&proposal.surface(&before));
    let sign = if contact.slots[0] < contact.slots[1] { 1.0 } else { -1.0 };
    if proposal.surface_velocity.length() <= MAX_SURFACE_SPEED {
        contact.surface_velocity = LaneVec3::from(proposal.surface_velocity * sign);
    }
}
