//! What a character has touched in a step.

use tumble::hecs::Entity;
use tumble::math::Vec3;

/// A body that a character has come up against.
///
/// ```
/// use tumble::prelude::*;
/// use tumble_character::*;
///
/// let mut world = hecs::World::new();
/// let ground = spawn_ground(&mut world);
/// let hero = world.spawn(Character::new(CharacterSettings::of_height(1.8))?.at(Vec3::ZERO));
/// let mut simulation = Simulation::new(Settings::default())?;
/// move_characters(&mut world, &simulation);
/// simulation.step(&mut world);
/// let touches = *world.get::<&CharacterTouches>(hero)?;
/// assert!(touches.iter().all(|touch| touch.entity == ground && touch.normal.y > 0.99));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Touch {
    /// The body.
    pub entity: Entity,
    /// Where \[m\], world frame.
    pub point: Vec3,
    /// From the body to the character; unit vector, world frame.
    pub normal: Vec3,
}

/// The bodies that a character has touched in the last step, each once, ground included: a
/// component that [`move_characters`](crate::move_characters()) writes.
///
/// ```
/// use tumble::prelude::*;
/// use tumble_character::*;
///
/// let mut world = hecs::World::new();
/// let ground = spawn_ground(&mut world);
/// let hero = world.spawn(Character::new(CharacterSettings::of_height(1.8))?.at(Vec3::ZERO));
/// let mut simulation = Simulation::new(Settings::default())?;
/// move_characters(&mut world, &simulation);
/// simulation.step(&mut world);
/// assert!(world.get::<&CharacterTouches>(hero)?.contains(ground));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CharacterTouches {
    touches: [Option<Touch>; Self::MAX],
}

impl CharacterTouches {
    /// The most that are remembered; more are left out.
    pub const MAX: usize = 8;

    /// The touches, in the order in which they came.
    pub fn iter(&self) -> impl Iterator<Item = &Touch> {
        self.touches.iter().flatten()
    }

    /// Whether a body is among them.
    #[must_use]
    pub fn contains(&self, entity: Entity) -> bool {
        self.iter().any(|touch| touch.entity == entity)
    }

    pub(crate) fn add(&mut self, touch: Touch) {
        if !self.contains(touch.entity)
            && let Some(free) = self.touches.iter_mut().find(|it| it.is_none())
        {
            *free = Some(touch);
        }
    }
}
