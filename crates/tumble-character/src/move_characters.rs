//! The system that moves all characters of a world.

use rayon::prelude::*;
use tumble::hecs::{Entity, World};
use tumble::math::Vec3;
use tumble::{BodyId, Collider, Pose, Simulation, Velocity};

use crate::character::Character;
use crate::motion::{Motion, Outcome};
use crate::state::{CharacterInput, CharacterState};
use crate::surroundings::Surroundings;
use crate::touches::CharacterTouches;

/// Fewer are computed where the caller is.
const MIN_SHARED: usize = 128;
/// Characters that one thread computes at a time.
const PART: usize = 16;

/// A character as it is before the step.
struct Before<'a> {
    entity: Entity,
    id: Option<BodyId>,
    character: &'a Character,
    state: CharacterState,
    input: CharacterInput,
    position: Vec3,
}

/// Gives each character the velocity that brings it to where it is to be after the next step:
/// called before each [`Simulation::step`], or in the closure of
/// [`advance_with`](Simulation::advance_with).
///
/// Characters are computed in parallel, each against the world as it is before any of them moves,
/// and what they do to others is applied in the order of [`BodyOrder`](tumble::BodyOrder): the same
/// bits whatever the threads and the order of spawning.
///
/// It reads [`Character`] and [`CharacterInput`], and writes the [`Velocity`] and the [`Collider`]
/// of characters, [`CharacterState`] and [`CharacterTouches`]; to dynamic bodies that are pushed
/// or stood on it adds [`Momentum`](tumble::Momentum) and a [`Wrench`](tumble::Wrench).
///
/// ```
/// use tumble::prelude::*;
/// use tumble_character::{Character, CharacterSettings, CharacterState, move_characters};
///
/// let mut world = hecs::World::new();
/// spawn_ground(&mut world);
/// let hero = Character::new(CharacterSettings::of_height(1.8))?.at(Vec3::Y * 0.5);
/// let hero = world.spawn(hero);
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// for _frame in 0..60 {
///     simulation.advance_with(&mut world, 1.0 / 60.0, move_characters);
/// }
/// assert!(world.get::<&CharacterState>(hero)?.is_grounded());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn move_characters(world: &mut World, simulation: &Simulation) {
    for (entity, outcome) in outcomes(world, simulation) {
        apply(world, entity, outcome);
    }
}

/// What becomes of the characters, in order.
fn outcomes(world: &World, simulation: &Simulation) -> Vec<(Entity, Outcome)> {
    let mut query = world.query::<(Entity, Option<&BodyId>, &Character, &CharacterState, &CharacterInput, &Pose)>();
    let mut before: Vec<_> = query
        .iter()
        .filter(|(.., pose)| pose.position.is_finite())
        .map(|(entity, id, character, state, input, pose)| Before {
            entity,
            id: id.copied(),
            character,
            state: *state,
            input: *input,
            position: pose.position,
        })
        .collect();
    if before.is_empty() {
        return Vec::new();
    }
    before.sort_unstable_by_key(|it| (it.id.is_none(), it.id, it.entity.id()));
    let settings = simulation.settings();
    let around = Surroundings::new(world, simulation.queries(world), settings.gravity, settings.dt);
    let plan = |it: &Before<'_>| {
        let who = (it.character, it.state, it.input);
        (it.entity, Motion::new(&around, it.entity, who, it.position).plan())
    };
    if before.len() < MIN_SHARED {
        before.iter().map(plan).collect()
    } else {
        before.par_iter().with_min_len(PART).map(plan).collect()
    }
}

fn apply(world: &World, entity: Entity, outcome: Outcome) {
    let Ok(found) = world.entity(entity) else { return };
    if let Some(mut velocity) = found.get::<&mut Velocity>() {
        *velocity = outcome.velocity;
    }
    if let Some(mut state) = found.get::<&mut CharacterState>() {
        *state = outcome.state;
    }
    if let Some(mut touches) = found.get::<&mut CharacterTouches>() {
        *touches = outcome.touches;
    }
    if let Some(new) = outcome.collider
        && let Some(mut collider) = found.get::<&mut Collider>()
    {
        *collider = new;
    }
    outcome.pushes.iter().for_each(|push| push.apply(world));
    outcome.weight.iter().for_each(|weight| weight.apply(world));
}
