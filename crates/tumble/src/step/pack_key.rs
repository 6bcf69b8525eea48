//! Which worlds can be stepped together, their contacts in one solve.

use hecs::World;

use crate::collision::collider::Collider;
use crate::collision::contact_materials::Extras;
use crate::components::{Pose, Work};
use crate::math::Real;
use crate::settings::Settings;
use crate::solver::substeps::impact_speed;

/// Equal for worlds that can be packed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PackKey {
    dt: Real,
    substeps: u32,
    contact_substeps: u32,
    restitution_threshold: Real,
    impact_speed: Real,
    pub(crate) extras: Extras,
}

/// Worlds of more entities fill lanes by themselves, and threads if there are many more.
const MAX_ENTITIES: u32 = 128;

impl PackKey {
    /// Of a world in which something may touch; `None` where it is better off alone.
    pub(crate) fn of(world: &World, settings: &Settings) -> Option<Self> {
        let is_booked = world.archetypes().any(|archetype| !archetype.is_empty() && archetype.has::<Work>());
        if world.len() > MAX_ENTITIES || is_booked || !crate::collision::are_in(world) || crate::joints::are_in(world) {
            return None;
        }
        let mut extras = Extras::default();
        // Those that contacts know of.
        for collider in world.query::<&Collider>().with::<&Pose>().iter() {
            collider.materials().for_each(|material| extras.add(material));
        }
        let Settings { dt, substeps, contact_substeps, restitution_threshold, .. } = *settings;
        let impact_speed = impact_speed(settings);
        Some(Self { dt, substeps, contact_substeps, restitution_threshold, impact_speed, extras })
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
    fn alike_is_what_is_solved_in_the_same_way() {
        let (plain, settings) = (world(Material::default()), Settings::default());
        let pack_key = |world: &World, settings: Settings| PackKey::of(world, &settings);
        let common = pack_key(&plain, settings);
        assert!(common.is_some());
        assert_eq!(pack_key(&world(Material::new(0.1, 0.0)), settings.with_gravity(crate::math::Vec3::ZERO)), common);
        for other in [
            pack_key(&plain, settings.with_dt(0.01)),
            pack_key(&plain, settings.with_substeps(2)),
            pack_key(&plain, settings.with_contact_substeps(8)),
            pack_key(&plain, Settings { restitution_threshold: 0.1, ..settings }),
            pack_key(&plain, settings.with_gravity(crate::math::Vec3::Y * -100.0)),
            pack_key(&world(Material::new(0.5, 0.5)), settings),
            pack_key(&world(Material { rolling_resistance: 0.01, ..Material::default() }), settings),
            pack_key(&World::new(), settings),
        ] {
            assert_ne!(other, common);
        }
        let mut booked = world(Material::default());
        let bodies: Vec<_> = booked.query::<hecs::Entity>().iter().collect();
        bodies.into_iter().for_each(|body| assert!(booked.insert_one(body, Work::default()).is_ok()));
        assert_eq!(pack_key(&booked, settings), None);
        // A collider without a place touches nothing, so what it is like does not matter.
        let mut with_template = world(Material::default());
        if let Ok(bouncy) = Collider::half_space().with_material(Material::new(0.5, 1.0)) {
            with_template.spawn((bouncy,));
        }
        assert_eq!(pack_key(&with_template, settings), common);
    }
}
