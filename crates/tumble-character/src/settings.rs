//! The settings of a character, with their units, defaults and limits.

use tumble::math::{Real, Vec3};

use crate::error::CharacterError;

/// What a character is and can do.
///
/// [`of_height`](Self::of_height) scales all lengths, mass and strength from a height; each field
/// may be changed then. [`Character::new`](crate::Character::new) checks them.
///
/// ```
/// use tumble_character::CharacterSettings;
///
/// let mut settings = CharacterSettings::of_height(1.8);
/// settings.jump_height = 1.2;
/// settings.step_height = 0.25;
/// assert_eq!(settings.validate(), Ok(()));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CharacterSettings {
    /// Half of the width of the space that the character takes \[m\]: a sixth of the height.
    pub radius: Real,
    /// From sole to crown \[m\]; at least twice the radius.
    pub height: Real,
    /// The same while it crouches \[m\]: 0.6 of the height.
    pub crouch_height: Real,
    /// How far its collider keeps away from everything \[m\]: a twentieth of the radius. The
    /// collider is smaller by this than the space of `radius` and `height`.
    #[doc(alias("padding", "offset", "safe_margin"))]
    pub skin: Real,
    /// The way up, a unit vector: y.
    pub up: Vec3,
    /// The steepest ground that it stands and walks on \[rad\]: 50 degrees.
    #[doc(alias = "floor_max_angle")]
    pub max_slope: Real,
    /// The highest step that it takes without a jump \[m\]: a fifth of the height.
    #[doc(alias("step_offset", "autostep"))]
    pub step_height: Real,
    /// How far below its sole the ground may fall away within a step for it to stay on it \[m\]: a
    /// fifth of the height.
    #[doc(alias("floor_snap_length", "snap_to_ground"))]
    pub snap_distance: Real,
    /// How fast it changes its velocity on the ground \[m/s²\]: 40.
    pub acceleration: Real,
    /// The same where it is to become slower \[m/s²\]: 60.
    pub deceleration: Real,
    /// The same in the air, across the way up \[m/s²\]: 10. Without a wanted velocity it flies on.
    #[doc(alias = "air_control")]
    pub air_acceleration: Real,
    /// How high a jump lifts the sole above flat ground at rest \[m\]: 0.6 of the height.
    pub jump_height: Real,
    /// How long after it has left the ground it can still jump \[s\]: 0.1.
    pub coyote_time: Real,
    /// How long a jump is kept that was asked for too early \[s\]: 0.1.
    pub jump_buffer: Real,
    /// How many times the gravity of the simulation acts on it: 1.
    pub gravity_scale: Real,
    /// The fastest that it falls \[m/s\]: 60.
    pub max_fall_speed: Real,
    /// What it weighs \[kg\]: 80 at a height of 1.8 m, in the cube of the height.
    pub mass: Real,
    /// The most force by which it pushes dynamic bodies \[N\]: 6 for each kilogram of its mass.
    pub push_strength: Real,
    /// The fastest that it is pushed out of what it overlaps \[m/s\]: five heights a second.
    pub max_push_out_speed: Real,
    /// Groups that its collider is in, as [`Collider::with_groups`] has them: all.
    ///
    /// [`Collider::with_groups`]: tumble::Collider::with_groups
    pub membership: u32,
    /// Groups that its collider touches: all.
    pub filter: u32,
    /// Whether it turns with what it stands on.
    pub turning: Turning,
}

/// Whether a character turns about the up axis with what it stands on.
///
/// ```
/// use tumble_character::{CharacterSettings, Turning};
///
/// // The camera of a shooter does not turn with the lift.
/// let mut settings = CharacterSettings::of_height(1.8);
/// assert_eq!(settings.turning, Turning::WithGround);
/// settings.turning = Turning::Never;
/// # assert!(tumble_character::Character::new(settings).is_ok());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Turning {
    /// Its orientation turns as the ground does.
    #[default]
    WithGround,
    /// Only the place of its sole turns with the ground.
    Never,
}

impl Default for CharacterSettings {
    fn default() -> Self {
        Self::of_height(1.8)
    }
}

impl CharacterSettings {
    /// The defaults of a character of a height \[m\].
    ///
    /// ```
    /// use tumble_character::{Character, CharacterSettings};
    ///
    /// for height in [0.05, 1.8, 20.0] {
    ///     assert!(Character::new(CharacterSettings::of_height(height)).is_ok());
    /// }
    /// ```
    #[must_use]
    pub fn of_height(height: Real) -> Self {
        let radius = height / 6.0;
        let relative = height / 1.8;
        let mass = 80.0 * relative * relative * relative;
        Self {
            radius,
            height,
            crouch_height: height * 0.6,
            skin: radius / 20.0,
            up: Vec3::Y,
            max_slope: 0.872_664_6,
            step_height: height / 5.0,
            snap_distance: height / 5.0,
            acceleration: 40.0,
            deceleration: 60.0,
            air_acceleration: 10.0,
            jump_height: height * 0.6,
            coyote_time: 0.1,
            jump_buffer: 0.1,
            gravity_scale: 1.0,
            max_fall_speed: 60.0,
            mass,
            push_strength: mass * 6.0,
            max_push_out_speed: height * 5.0,
            membership: u32::MAX,
            filter: u32::MAX,
            turning: Turning::WithGround,
        }
    }

    /// Whether there is such a character.
    ///
    /// # Errors
    /// [`CharacterError`] names the first field that cannot be.
    pub fn validate(&self) -> Result<(), CharacterError> {
        let fail = |field, wanted, value: Real| Err(CharacterError::Setting { field, wanted, value: value.into() });
        let lengths = 1e-3..=1e4;
        if !lengths.contains(&self.radius) {
            return fail("radius", "from 0.001 to 10000 m", self.radius);
        }
        if !(self.height >= 2.0 * self.radius && lengths.contains(&self.height)) {
            return fail("height", "at least twice the radius and at most 10000 m", self.height);
        }
        if !(self.crouch_height >= 2.0 * self.radius && self.crouch_height <= self.height) {
            return fail("crouch_height", "from twice the radius to the height", self.crouch_height);
        }
        if !(self.skin >= self.radius * 1e-3 && self.skin <= self.radius * 0.5) {
            return fail("skin", "from a thousandth of the radius to half of it", self.skin);
        }
        if !(0.999..=1.001).contains(&self.up.length()) {
            return fail("up", "a unit vector", self.up.length());
        }
        if !(0.0..=1.5).contains(&self.max_slope) {
            return fail("max_slope", "from 0 to 1.5 rad", self.max_slope);
        }
        for (field, value) in [("step_height", self.step_height), ("snap_distance", self.snap_distance)] {
            if !(0.0..=self.height).contains(&value) {
                return fail(field, "from 0 to the height", value);
            }
        }
        for (field, value) in self.numbers() {
            if !(0.0..=1e9).contains(&value) {
                return fail(field, "from 0 to 1e9", value);
            }
        }
        if !(-1e3..=1e3).contains(&self.gravity_scale) {
            return fail("gravity_scale", "from -1000 to 1000", self.gravity_scale);
        }
        Ok(())
    }

    /// The height of the space that it takes \[m\].
    pub(crate) fn height_now(&self, is_crouching: bool) -> Real {
        if is_crouching { self.crouch_height } else { self.height }
    }

    /// The ends of the middle line of its capsule, with its sole at a position.
    pub(crate) fn spine(&self, position: Vec3, is_crouching: bool) -> [Vec3; 2] {
        let heights = [self.radius, self.height_now(is_crouching) - self.radius];
        heights.map(|height| position + self.up * height)
    }

    /// What may be any number that is not negative.
    fn numbers(&self) -> [(&'static str, Real); 10] {
        [
            ("acceleration", self.acceleration),
            ("deceleration", self.deceleration),
            ("air_acceleration", self.air_acceleration),
            ("jump_height", self.jump_height),
            ("coyote_time", self.coyote_time),
            ("jump_buffer", self.jump_buffer),
            ("max_fall_speed", self.max_fall_speed),
            ("mass", self.mass),
            ("push_strength", self.push_strength),
            ("max_push_out_speed", self.max_push_out_speed),
        ]
    }
}
