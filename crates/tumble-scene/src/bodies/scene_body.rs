//! A body of a scene with its forces.

use glam::DVec3;
use hecs::{Entity, EntityBuilder, World};
use tumble::{Axes, Body, Collider, LockedAxes};
use tumble_import::{Appearance, ImportedBody, ImportedCollider};

use crate::bodies::force::Force;

/// A checked body, what it looks like, and its checked forces.
#[derive(Clone, Debug)]
pub(crate) struct SceneBody {
    pub(crate) body: Body,
    pub(crate) appearance: Appearance,
    pub(crate) forces: Vec<Force>,
    /// For each spring among the forces, in order, the index of the body it leads to.
    pub(crate) springs_to: Vec<usize>,
    /// What it touches others with.
    pub(crate) collider: Option<Collider>,
    pub(crate) locked_axes: Axes,
    /// What a glTF file says of its colliders and triggers.
    pub(crate) pieces: Vec<ImportedCollider>,
}

impl From<ImportedBody> for SceneBody {
    /// A body on which nothing acts but gravity.
    fn from(ImportedBody { body, appearance, collider, pieces }: ImportedBody) -> Self {
        let (forces, springs_to, locked_axes) = (Vec::new(), Vec::new(), Axes::NONE);
        Self { body, appearance, forces, springs_to, collider, locked_axes, pieces }
    }
}

impl SceneBody {
    /// Spawns bodies and then the springs between them, which find bodies by their index among
    /// them, and gives the entities of the bodies.
    pub(crate) fn spawn_all<'a>(bodies: impl IntoIterator<Item = &'a Self>, world: &mut World) -> Vec<Entity> {
        let spawned: Vec<(Entity, &Self)> = bodies.into_iter().map(|body| (body.spawn(world), body)).collect();
        for (entity, body) in &spawned {
            let springs = body.forces.iter().filter(|force| matches!(force, Force::Spring { .. }));
            for (spring, to) in springs.zip(&body.springs_to) {
                let Some((other_entity, other)) = spawned.get(*to) else { continue };
                if let Some(spring) = spring.spring([*entity, *other_entity], [body.center(), other.center()]) {
                    world.spawn((spring,));
                }
            }
        }
        spawned.into_iter().map(|(entity, _)| entity).collect()
    }

    fn spawn(&self, world: &mut World) -> Entity {
        if self.forces.is_empty() && self.collider.is_none() && self.locked_axes == Axes::NONE {
            return self.body.spawn(world);
        }
        let mut entity = EntityBuilder::new();
        self.body.insert_into(&mut entity);
        Force::insert_all(&self.forces, self.center(), &mut entity);
        for collider in self.collider.iter().cloned() {
            entity.add(collider);
        }
        if self.locked_axes != Axes::NONE {
            entity.add(LockedAxes(self.locked_axes));
        }
        world.spawn(entity.build())
    }

    /// The centre of mass in the body's frame \[m\]; the frame's origin of a body that forces do
    /// not move, which has no other.
    fn center(&self) -> DVec3 {
        self.body.properties().map_or(DVec3::ZERO, tumble::MassProperties::center_of_mass)
    }
}
