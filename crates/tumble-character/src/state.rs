//! What a character is to do, and how it stands.

use tumble::hecs::Entity;
use tumble::math::{Real, Vec3};

/// What a character is to do in the next steps: a component that the game writes.
///
/// ```
/// use tumble::prelude::*;
/// use tumble_character::*;
///
/// let mut world = hecs::World::new();
/// let ground = spawn_ground(&mut world);
/// let hero = world.spawn(Character::new(CharacterSettings::of_height(1.8))?.at(Vec3::ZERO));
/// let mut simulation = Simulation::new(Settings::default())?;
/// world.get::<&mut CharacterInput>(hero)?.velocity = Vec3::X * 2.0;
/// for _ in 0..60 {
///     move_characters(&mut world, &simulation);
///     simulation.step(&mut world);
/// }
/// assert!(world.get::<&Pose>(hero)?.position.x > 1.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CharacterInput {
    /// The velocity that it is to have relative to the ground, and in the air to the world \[m/s\];
    /// what of it is along the up axis does not count.
    pub velocity: Vec3,
    /// Whether the button of jumps is down. It jumps once each time that it goes down.
    pub jump: bool,
    /// Whether it is to crouch. It stands up when it no longer is to, as soon as there is room.
    pub crouch: bool,
}

/// What carries a character.
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
/// assert_eq!(world.get::<&CharacterState>(hero)?.ground, GroundState::OnGround);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("EGroundState", "grounded", "is_on_floor"))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GroundState {
    /// Ground that it can walk on, or two walls that it is wedged between.
    OnGround,
    /// Ground that is too steep: it slides down.
    OnSteep,
    /// Nothing.
    #[default]
    InAir,
}

/// How a character stands and moves: a component that
/// [`move_characters`](crate::move_characters()) writes.
///
/// With pose and velocity it is all that a character knows from step to step; who goes back to an
/// earlier step puts it back, see [`SavedCharacters`](crate::SavedCharacters). All vectors are in
/// the world frame.
///
/// ```
/// use tumble::prelude::*;
/// use tumble_character::*;
///
/// let mut world = hecs::World::new();
/// let ground = spawn_ground(&mut world);
/// let hero = world.spawn(Character::new(CharacterSettings::of_height(1.8))?.at(Vec3::ZERO));
/// let mut simulation = Simulation::new(Settings::default())?;
/// world.get::<&mut CharacterInput>(hero)?.crouch = true;
/// for _ in 0..2 {
///     move_characters(&mut world, &simulation);
///     simulation.step(&mut world);
/// }
/// let state = *world.get::<&CharacterState>(hero)?;
/// assert!(state.is_crouching && state.ground_entity == Some(ground));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CharacterState {
    /// What carries it.
    pub ground: GroundState,
    /// The body that it stands or slides on.
    pub ground_entity: Option<Entity>,
    /// The normal of what it stands or slides on; the up axis where it walks over an edge, and in
    /// the air the last one.
    pub ground_normal: Vec3,
    /// Where it touches that \[m\].
    pub ground_point: Vec3,
    /// The velocity of the ground at that point \[m/s\]; in the air zero.
    pub ground_velocity: Vec3,
    /// How fast what it stands on turns about the up axis \[rad/s\].
    pub yaw_rate: Real,
    /// Its own velocity \[m/s\]: on the ground along the ground and relative to it, else in the
    /// world.
    pub velocity: Vec3,
    /// The force by which it presses on what it stands on \[N\]: no more than its weight.
    pub load: Real,
    /// Whether it crouches, because it is to or because there is no room.
    pub is_crouching: bool,
    /// Whether something that moves, and something else, leave it no room.
    pub is_crushed: bool,
    /// For how long it has not stood on ground \[s\].
    pub air_time: Real,
    /// For how long a jump that was asked for is still kept \[s\].
    pub jump_wish: Real,
    /// Whether it has jumped since it stood on ground.
    pub has_jumped: bool,
    /// Whether the button of jumps was down in the last step.
    pub was_jump_down: bool,
    /// In how many steps its footing may be found by a ray alone.
    pub sure_for: u8,
}

impl Default for CharacterState {
    fn default() -> Self {
        Self {
            ground: GroundState::InAir,
            ground_entity: None,
            ground_normal: Vec3::Y,
            ground_point: Vec3::ZERO,
            ground_velocity: Vec3::ZERO,
            yaw_rate: 0.0,
            velocity: Vec3::ZERO,
            load: 0.0,
            is_crouching: false,
            is_crushed: false,
            air_time: 0.0,
            jump_wish: 0.0,
            has_jumped: true,
            was_jump_down: false,
            sure_for: 0,
        }
    }
}

impl CharacterState {
    /// Whether it stands on ground that it can walk on.
    #[must_use]
    pub fn is_grounded(&self) -> bool {
        self.ground == GroundState::OnGround
    }

    /// Its velocity in the world \[m/s\], ground included.
    #[must_use]
    pub fn world_velocity(&self) -> Vec3 {
        self.velocity + self.ground_velocity
    }
}
