//! The states of characters, kept beside a snapshot.

use tumble::hecs::World;
use tumble::{BodyId, update_derived};

use crate::character::Character;
use crate::state::{CharacterInput, CharacterState};

/// What a [`Snapshot`](tumble::Snapshot) does not hold of characters: states and inputs, by
/// [`BodyId`]. Those without one are left out.
///
/// ```
/// use tumble::prelude::*;
/// use tumble_character::{Character, CharacterSettings, SavedCharacters, move_characters};
///
/// let mut world = hecs::World::new();
/// spawn_ground(&mut world);
/// let hero = Character::new(CharacterSettings::of_height(1.8))?.at(Vec3::Y * 3.0);
/// let hero = world.spawn(hero);
/// world.insert_one(hero, BodyId(1))?;
/// let mut simulation = Simulation::new(Settings::default())?;
/// let mut run = |world: &mut hecs::World, simulation: &mut Simulation| {
///     for _ in 0..30 {
///         move_characters(world, simulation);
///         simulation.step(world);
///     }
///     *world.get::<&Pose>(hero).unwrap()
/// };
/// run(&mut world, &mut simulation);
/// let (snapshot, saved) = (simulation.snapshot(&world)?, SavedCharacters::capture(&world));
/// let first = run(&mut world, &mut simulation);
/// simulation.restore(&snapshot, &mut world)?;
/// saved.restore(&mut world);
/// assert_eq!(run(&mut world, &mut simulation), first);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SavedCharacters {
    /// In the order of the ids.
    states: Vec<(BodyId, CharacterState, CharacterInput)>,
}

impl SavedCharacters {
    /// Those of a world.
    #[must_use]
    pub fn capture(world: &World) -> Self {
        let mut query = world.query::<(&BodyId, &CharacterState, &CharacterInput)>();
        let mut states: Vec<_> = query.iter().map(|(id, state, input)| (*id, *state, *input)).collect();
        states.sort_unstable_by_key(|(id, ..)| *id);
        Self { states }
    }

    /// Puts them back, with the colliders that go with them, after the bodies have been put back:
    /// what is derived from their momenta is [updated](tumble::update_derived). Characters that
    /// were not there are left as they are.
    pub fn restore(&self, world: &mut World) {
        for (id, character, state, input, collider) in
            world.query_mut::<(&BodyId, &Character, &mut CharacterState, &mut CharacterInput, &mut tumble::Collider)>()
        {
            let Ok(found) = self.states.binary_search_by_key(id, |(id, ..)| *id) else { continue };
            let (_, saved_state, saved_input) = self.states[found];
            (*state, *input) = (saved_state, saved_input);
            *collider = character.collider(state.is_crouching).clone();
        }
        update_derived(world);
    }
}
