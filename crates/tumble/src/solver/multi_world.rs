use hecs::World;

use crate::collision::collider::Collider;
use crate::collision::contact::{Contact, HELD, RUBBED};
use crate::collision::contact_materials::Extras;
use crate::collision::find_contacts::Contacts;
use crate::components::{Pose, Work};
use crate::forces::registry::ForceLaws;
use crate::math::Real;
use crate::settings::Settings;
use crate::solver::substeps::Pushing;
use crate::storage::world_columns::HeldColumns;

/// Contacts of several small worlds, pushed side by side: of one world alone they would leave most lanes empty.
///
/// A contact gets the same bits as alone. Its colour depends on the contacts before it that have a body in common with it, which are of its own world, and the contacts of a colour
/// do not depend on each other.
#[derive(Default)]
pub(crate) struct Packed {
    pushing: Pushing,
    /// Those of all worlds, between rows in the place of slots.
    contacts: Vec<Contact>,
    /// Where the next world's rows begin: of what impulses move and of what they do not.
    next: [usize; 2],
    /// How many contacts have been given back.
    given_back: usize,
}

/// What worlds must have in common to be packed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Likeness {
    dt: Real,
    substeps: u32,
    contact_substeps: u32,
    restitution_threshold: Real,
    extras: Extras,
}

/// Worlds of more entities fill lanes by themselves, and threads if there are many more.
const MOST_ENTITIES: u32 = 128;

impl Likeness {
    /// Of a world in which something may touch; `None` where it is better off alone.
    pub(crate) fn of(world: &World, settings: &Settings) -> Option<Self> {
        let is_booked = world.archetypes().any(|archetype| !archetype.is_empty() && archetype.has::<Work>());
        if world.len() > MOST_ENTITIES || is_booked || !crate::collision::are_in(world) {
            return None;
        }
        let mut extras = Extras::default();
        // Those that contacts know of.
        for collider in world.query::<&Collider>().with::<&Pose>().iter() {
            collider.materials().for_each(|material| extras.add(material));
        }
        let Settings { dt, substeps, contact_substeps, restitution_threshold, .. } = *settings;
        Some(Self { dt, substeps, contact_substeps, restitution_threshold, extras })
    }
}

impl Packed {
    /// Makes room for the bodies that impulses move and for those that they do not.
    pub(crate) fn begin(&mut self, touching: [usize; 2]) {
        self.pushing.reset(touching);
        self.contacts.clear();
        self.next = [0, self.pushing.group.bodies.first_unmoved()];
        self.given_back = 0;
    }

    /// Adds what touches in a world.
    pub(crate) fn add(
        &mut self,
        found: &mut Contacts,
        columns: &mut HeldColumns<'_>,
        settings: &Settings,
        laws: &ForceLaws,
        time: f64,
    ) {
        self.next = found.gather(columns, (settings, laws, time), &mut self.pushing.group, self.next);
        found.add_round(self.contacts.len(), &mut self.pushing.group.rounds);
        let Pushing { group, halvings, stacks, .. } = &mut self.pushing;
        stacks.add_halvings(found, settings, &group.bodies, halvings);
        let found = &*found;
        self.contacts
            .extend(found.contacts.iter().map(|contact| Contact { slots: found.rows_of(contact), ..contact.clone() }));
    }

    /// Pushes them all, with settings that are alike.
    pub(crate) fn push(&mut self, settings: &Settings, likeness: &Likeness) {
        self.pushing.push(&mut self.contacts, |contact| contact.slots, settings, likeness.extras);
    }

    /// Gives the contacts of the next world their impulses, in the order in which worlds were added.
    pub(crate) fn give_back(&mut self, found: &mut Contacts) {
        for (contact, pushed) in found.contacts.iter_mut().zip(&self.contacts[self.given_back..]) {
            for which in [HELD, RUBBED] {
                contact.numbers[which] = pushed.numbers[which];
            }
        }
        self.given_back += found.contacts.len();
    }

    pub(crate) fn pushing(&self) -> &Pushing {
        &self.pushing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shape;
    use crate::body::rigid_body::RigidBody;
    use crate::collision::material::Material;

    fn world(material: Material) -> World {
        let (mut world, shape) = (World::new(), Shape::sphere(0.5));
        let collider = Collider::new(&shape).and_then(|it| it.with_material(material));
        if let (Ok(body), Ok(collider)) = (RigidBody::new(shape).mass(1.0).build(), collider) {
            body.spawn_with(&mut world, (collider,));
        }
        world
    }

    #[test]
    fn alike_is_what_is_pushed_in_the_same_way() {
        let (plain, settings) = (world(Material::default()), Settings::default());
        let likeness = |world: &World, settings: Settings| Likeness::of(world, &settings);
        let common = likeness(&plain, settings);
        assert!(common.is_some());
        assert_eq!(likeness(&world(Material::new(0.1, 0.0)), settings.with_gravity(crate::math::Vec3::ZERO)), common);
        for other in [
            likeness(&plain, settings.with_dt(0.01)),
            likeness(&plain, settings.with_substeps(2)),
            likeness(&plain, settings.with_contact_substeps(8)),
            likeness(&plain, Settings { restitution_threshold: 0.1, ..settings }),
            likeness(&world(Material::new(0.5, 0.5)), settings),
            likeness(&world(Material { rolling_friction: 0.01, ..Material::default() }), settings),
            likeness(&World::new(), settings),
        ] {
            assert_ne!(other, common);
        }
        let mut booked = world(Material::default());
        let bodies: Vec<_> = booked.query::<hecs::Entity>().iter().collect();
        bodies.into_iter().for_each(|body| assert!(booked.insert_one(body, Work::default()).is_ok()));
        assert_eq!(likeness(&booked, settings), None);
        // A collider without a place touches nothing, so what it is like does not matter.
        let mut with_template = world(Material::default());
        if let Ok(bouncy) = Collider::half_space().with_material(Material::new(0.5, 1.0)) {
            with_template.spawn((bouncy,));
        }
        assert_eq!(likeness(&with_template, settings), common);
    }
}
