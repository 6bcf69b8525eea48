//! The component of a character: checked settings, and the colliders that follow from them.

use tumble::math::{Quat, Real, Vec3};
use tumble::{Collider, ColliderError, Pose, Shape, Velocity};

use crate::error::CharacterError;
use crate::settings::CharacterSettings;
use crate::state::{CharacterInput, CharacterState};
use crate::touches::CharacterTouches;
use crate::vectors::{from_y_to, sin_cos, unit};

/// A character: a capsule that walks, on an entity that is a kinematic body of tumble.
///
/// ```
/// use tumble::prelude::*;
/// use tumble_character::{Character, CharacterInput, CharacterSettings, move_characters};
///
/// let mut world = hecs::World::new();
/// spawn_ground(&mut world);
/// let character = Character::new(CharacterSettings::of_height(1.8))?;
/// let hero = world.spawn(character.at(Vec3::ZERO));
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// world.get::<&mut CharacterInput>(hero)?.velocity = Vec3::X * 3.0;
/// for _ in 0..60 {
///     move_characters(&mut world, &simulation);
///     simulation.step(&mut world);
/// }
/// let sole = world.get::<&Pose>(hero)?.position;
/// assert!((2.8..3.0).contains(&sole.x) && sole.y.abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("KinematicCharacterController", "CharacterVirtual", "CharacterBody3D"))]
#[derive(Clone, Debug)]
pub struct Character {
    settings: CharacterSettings,
    standing: Collider,
    crouching: Collider,
    base: Quat,
    pub(crate) min_up: Real,
}

/// The components that a character has: a bundle for `spawn` and `insert` of hecs.
pub type CharacterBundle = (Pose, Velocity, Collider, Character, CharacterInput, CharacterState, CharacterTouches);

impl Character {
    /// A character with these settings.
    ///
    /// # Errors
    /// [`CharacterError`] names the field that cannot be.
    pub fn new(settings: CharacterSettings) -> Result<Self, CharacterError> {
        settings.validate()?;
        let up = unit(settings.up).unwrap_or(Vec3::Y);
        let settings = CharacterSettings { up, ..settings };
        let capsule = |height| capsule(&settings, height);
        Ok(Self {
            standing: capsule(settings.height)?,
            crouching: capsule(settings.crouch_height)?,
            base: from_y_to(up),
            min_up: sin_cos(settings.max_slope).1,
            settings,
        })
    }

    /// Its components, with the middle of its sole at a position \[m\].
    #[must_use]
    pub fn at(&self, position: Vec3) -> CharacterBundle {
        let pose = Pose { position, orientation: self.base };
        let collider = self.standing.clone();
        (
            pose,
            Velocity::default(),
            collider,
            self.clone(),
            CharacterInput::default(),
            CharacterState::default(),
            CharacterTouches::default(),
        )
    }

    /// Its settings.
    #[must_use]
    pub fn settings(&self) -> &CharacterSettings {
        &self.settings
    }

    /// Goes on with other settings. A larger capsule is pushed out of what it overlaps then.
    ///
    /// # Errors
    /// [`CharacterError`], and the old settings stay.
    pub fn set_settings(&mut self, settings: CharacterSettings) -> Result<(), CharacterError> {
        *self = Self::new(settings)?;
        Ok(())
    }

    /// Takes the y axis to the way up: what an orientation begins with, before it is turned about
    /// the way up.
    #[must_use]
    pub fn base(&self) -> Quat {
        self.base
    }

    pub(crate) fn collider(&self, is_crouching: bool) -> &Collider {
        if is_crouching { &self.crouching } else { &self.standing }
    }
}

fn capsule(settings: &CharacterSettings, height: Real) -> Result<Collider, ColliderError> {
    let CharacterSettings { radius, skin, membership, filter, .. } = *settings;
    let half = f64::from(height) * 0.5 - f64::from(radius);
    let round = f64::from(radius - skin);
    let shape = if half > f64::from(radius) * 1e-3 { Shape::capsule(round, half) } else { Shape::sphere(round) };
    let collider = Collider::new(&shape)?.with_offset(Pose::at(Vec3::Y * (height * 0.5)))?;
    Ok(if (membership, filter) == (u32::MAX, u32::MAX) { collider } else { collider.with_groups(membership, filter) })
}
