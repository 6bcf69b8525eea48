//! A kinematic character controller for the rigid-body engine tumble.
//!
//! A character is a capsule on an entity of the caller's world: a kinematic body with a
//! [`Character`], which has its settings, a [`CharacterInput`] that the game writes, and a
//! [`CharacterState`] to read. [`move_characters`] before each step computes where each is to be
//! after it, and prescribes the velocity that brings it there.
//!
//! ```
//! use tumble::prelude::*;
//! use tumble_character::{
//!     Character, CharacterInput, CharacterSettings, CharacterState, move_characters,
//! };
//!
//! let mut world = hecs::World::new();
//! spawn_ground(&mut world);
//! let character = Character::new(CharacterSettings::of_height(1.8))?;
//! let hero = world.spawn(character.at(Vec3::ZERO));
//!
//! let mut simulation = Simulation::new(Settings::default())?;
//! for _frame in 0..30 {
//!     let mut input = world.get::<&mut CharacterInput>(hero)?;
//!     (input.velocity, input.jump) = (Vec3::X * 4.0, true);
//!     drop(input);
//!     simulation.advance_with(&mut world, 1.0 / 60.0, move_characters);
//! }
//! assert!(!world.get::<&CharacterState>(hero)?.is_grounded());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Units and frames
//!
//! Metres, kilograms, seconds, radians, in the world frame. The [`Pose`](tumble::Pose) of a
//! character is that of the middle of its sole; on flat ground it is on the ground.
//!
//! # Features
//!
//! - `f64`: in double precision, as in tumble.

#![cfg_attr(
    feature = "f64",
    allow(
        clippy::unnecessary_cast,
        clippy::useless_conversion,
        reason = "Real is f64 in this build, f32 in the other"
    )
)]

mod character;
mod error;
mod motion;
mod move_characters;
mod push;
mod saved;
mod settings;
mod slide;
mod state;
mod surroundings;
mod touches;
mod vectors;

pub use character::{Character, CharacterBundle};
pub use error::CharacterError;
pub use move_characters::move_characters;
pub use saved::SavedCharacters;
pub use settings::{CharacterSettings, Turning};
pub use state::{CharacterInput, CharacterState, GroundState};
pub use touches::{CharacterTouches, Touch};
