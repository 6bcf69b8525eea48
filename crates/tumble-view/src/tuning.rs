//! Settings that are changed while a scene runs, by keys and by sliders.

use std::ops::RangeInclusive;

use tumble::Settings;

use crate::convert::real;
use crate::playback::Playback;
use crate::sliders::Slider;

/// Factors of gravity and friction.
const FACTORS: [f64; 8] = [0.0, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0];
/// Where the factor is 1.
const ONE: usize = 4;
/// Sliders of substeps go up to this power of two; keys go as far as the engine does.
const MAX_POWER: i32 = 6;
/// Speeds are powers of two.
const SPEEDS: RangeInclusive<i32> = -6..=6;

/// A setting that can be changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Knob {
    Substeps,
    ContactSubsteps,
    Gravity,
    Friction,
    Speed,
}

const KNOBS: [Knob; 5] = [Knob::Substeps, Knob::ContactSubsteps, Knob::Gravity, Knob::Friction, Knob::Speed];

/// To half or twice, or to the factor before or after.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Change {
    Less,
    More,
}

/// What the user has changed of a scene's settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tuning {
    /// Of the scene.
    gravity: tumble::math::Vec3,
    /// Indices into the factors.
    gravity_factor: usize,
    friction_factor: usize,
    /// As a power of two.
    speed: i32,
    chosen: usize,
}

impl Tuning {
    pub(crate) fn of(playback: &Playback) -> Self {
        let gravity = playback.simulation.settings().gravity;
        Self { gravity, gravity_factor: ONE, friction_factor: ONE, speed: 0, chosen: 0 }
    }

    /// By what the pace of the scene is multiplied.
    pub(crate) fn speed(&self) -> f64 {
        2.0_f64.powi(self.speed)
    }

    /// Twice or half the speed, within its range.
    pub(crate) fn turn_speed(&mut self, change: Change) {
        self.speed = Knob::Speed.next(self.speed, change);
    }

    /// Goes on at the speed of another scene.
    pub(crate) fn keep_speed(&mut self, other: &Self) {
        self.speed = other.speed;
    }

    /// Chooses the setting below or above.
    pub(crate) fn choose(&mut self, change: Change) {
        self.chosen = match change {
            Change::More => (self.chosen + 1) % KNOBS.len(),
            Change::Less => (self.chosen + KNOBS.len() - 1) % KNOBS.len(),
        };
    }

    /// Changes the setting that is chosen; why not, if the engine refuses it. What is as far as it
    /// goes stays.
    pub(crate) fn turn(&mut self, playback: &mut Playback, change: Change) -> Result<(), String> {
        let knob = KNOBS[self.chosen];
        let now = self.position(knob, playback.simulation.settings());
        self.set(playback, knob, knob.next(now, change))
    }

    /// Chooses a setting by its row and moves its slider to a place from 0 to 1, or to the next
    /// stop; why not, if the engine refuses that.
    pub(crate) fn slide(&mut self, playback: &mut Playback, row: usize, place: f64) -> Result<(), String> {
        let Some(&knob) = KNOBS.get(row) else { return Ok(()) };
        self.chosen = row;
        self.set(playback, knob, knob.position_at(place))
    }

    /// A count, an index into the factors, or a power of two.
    fn position(&self, knob: Knob, settings: &Settings) -> i32 {
        match knob {
            Knob::Substeps => as_position(settings.substeps),
            Knob::ContactSubsteps => as_position(settings.contact_substeps),
            Knob::Gravity => as_position(self.gravity_factor),
            Knob::Friction => as_position(self.friction_factor),
            Knob::Speed => self.speed,
        }
    }

    fn set(&mut self, playback: &mut Playback, knob: Knob, position: i32) -> Result<(), String> {
        let (mut new, mut settings) = (*self, *playback.simulation.settings());
        if position == self.position(knob, &settings) {
            return Ok(());
        }
        match knob {
            Knob::Substeps => settings.substeps = position.unsigned_abs(),
            Knob::ContactSubsteps => settings.contact_substeps = position.unsigned_abs(),
            Knob::Gravity => {
                new.gravity_factor = position.unsigned_abs() as usize;
                settings.gravity = self.gravity * real(FACTORS[new.gravity_factor]);
            }
            Knob::Friction => new.friction_factor = position.unsigned_abs() as usize,
            Knob::Speed => {
                self.speed = position;
                return Ok(());
            }
        }
        playback.simulation.set_settings(settings).map_err(|error| error.to_string())?;
        if new.friction_factor != self.friction_factor {
            scale_friction(playback, FACTORS[new.friction_factor]);
        }
        *self = new;
        playback.settings_changed = true;
        playback.begin_books();
        Ok(())
    }

    /// The settings as they are, with the places of their sliders.
    pub(crate) fn sliders(&self, settings: &Settings) -> Vec<Slider> {
        let slider = |(row, knob): (usize, Knob)| {
            let position = self.position(knob, settings);
            let (name, value) = match knob {
                Knob::Substeps => ("substeps", position.to_string()),
                Knob::ContactSubsteps => ("contact sub.", position.to_string()),
                Knob::Gravity => ("gravity", format!("×{}", FACTORS[self.gravity_factor])),
                Knob::Friction => ("friction", format!("×{}", FACTORS[self.friction_factor])),
                Knob::Speed if position < 0 => ("speed", format!("×1/{}", 1_u32 << position.unsigned_abs())),
                Knob::Speed => ("speed", format!("×{}", 1_u32 << position.unsigned_abs())),
            };
            Slider { name, value, place: knob.place(position), is_chosen: row == self.chosen }
        };
        KNOBS.into_iter().enumerate().map(slider).collect()
    }
}

impl Knob {
    /// Whether its positions are counts, which are halved and doubled.
    fn counts(self) -> bool {
        matches!(self, Self::Substeps | Self::ContactSubsteps)
    }

    /// The stops of its slider: positions, or powers of two of counts.
    fn stops(self) -> RangeInclusive<i32> {
        match self {
            Self::Substeps | Self::ContactSubsteps => 0..=MAX_POWER,
            Self::Gravity | Self::Friction => 0..=as_position(FACTORS.len() - 1),
            Self::Speed => SPEEDS,
        }
    }

    fn next(self, now: i32, change: Change) -> i32 {
        let stops = self.stops();
        match (change, self.counts()) {
            (Change::Less, true) => (now / 2).max(1),
            (Change::More, true) => now.saturating_mul(2),
            (Change::Less, false) => (now - 1).max(*stops.start()),
            (Change::More, false) => (now + 1).min(*stops.end()),
        }
    }

    /// Where the slider is, from 0 to 1. Counts may lie between its stops, or beyond.
    fn place(self, position: i32) -> f64 {
        let stop = if self.counts() { f64::from(position).log2() } else { f64::from(position) };
        let [first, last] = [*self.stops().start(), *self.stops().end()].map(f64::from);
        ((stop - first) / (last - first)).clamp(0.0, 1.0)
    }

    /// The position of the stop that is next to a place of the slider.
    fn position_at(self, place: f64) -> i32 {
        let [first, last] = [*self.stops().start(), *self.stops().end()].map(f64::from);
        let stop = (first + place.clamp(0.0, 1.0) * (last - first)).round() as i32;
        if self.counts() { 1 << stop } else { stop }
    }
}

/// Positions are small: what is not is farther than any slider.
fn as_position(count: impl TryInto<i32>) -> i32 {
    count.try_into().unwrap_or(i32::MAX)
}

/// Multiplies the friction of all contacts from the next step on.
fn scale_friction(playback: &mut Playback, factor: f64) {
    if factor == 1.0 {
        playback.simulation.clear_contact_hook();
        return;
    }
    let factor = real(factor);
    playback.simulation.set_contact_hook(move |contact| {
        contact.static_friction *= factor;
        contact.dynamic_friction *= factor;
    });
}

#[cfg(test)]
mod tests {
    use tumble::{Velocity, math::Vec3};
    use tumble_scene::Scene;

    use super::*;
    use crate::playback::tests;

    fn open(scene: &str) -> (Playback, Tuning) {
        let playback = tests::open(scene);
        let tuning = Tuning::of(&playback);
        (playback, tuning)
    }

    fn choose(tuning: &mut Tuning, knob: Knob) {
        while KNOBS[tuning.chosen] != knob {
            tuning.choose(Change::More);
        }
    }

    #[test]
    fn settings_go_up_and_down() {
        let (mut playback, mut tuning) = open("pyramid");
        let before = *playback.simulation.settings();
        for knob in KNOBS {
            choose(&mut tuning, knob);
            let before_it = tuning.sliders(playback.simulation.settings());
            tuning.turn(&mut playback, Change::More).unwrap();
            assert_ne!(tuning.sliders(playback.simulation.settings()), before_it, "{knob:?}");
            tuning.turn(&mut playback, Change::Less).unwrap();
            assert_eq!(tuning.sliders(playback.simulation.settings()), before_it, "{knob:?}");
        }
        assert_eq!(*playback.simulation.settings(), before);
        tuning.choose(Change::More);
        tuning.choose(Change::Less);
        assert_eq!(KNOBS[tuning.chosen], Knob::Speed);
    }

    #[test]
    fn a_slider_stands_where_it_is_put() {
        let (mut playback, mut tuning) = open("pyramid");
        for (row, knob) in KNOBS.into_iter().enumerate() {
            let [first, last] = [*knob.stops().start(), *knob.stops().end()];
            for stop in knob.stops() {
                let position = if knob.counts() { 1 << stop } else { stop };
                let place = knob.place(position);
                assert_eq!(place, f64::from(stop - first) / f64::from(last - first), "{knob:?}");
                assert_eq!(knob.position_at(place), position, "{knob:?}");
                tuning.slide(&mut playback, row, place).unwrap();
                let sliders = tuning.sliders(playback.simulation.settings());
                assert_eq!((sliders[row].place, sliders[row].is_chosen), (place, true), "{knob:?}");
                assert_eq!(tuning.position(knob, playback.simulation.settings()), position, "{knob:?}");
                // A little aside it is the same stop.
                assert_eq!(knob.position_at(place + 0.4 / f64::from(last - first)), position, "{knob:?}");
            }
            // A drag past an end stays there.
            assert_eq!([-3.0, 3.0].map(|place| knob.position_at(place)), [0.0, 1.0].map(|end| knob.position_at(end)));
        }
        let settings = playback.simulation.settings();
        assert_eq!((settings.substeps, settings.contact_substeps), (64, 64));
        assert_eq!((settings.gravity, tuning.speed()), (tuning.gravity * 8.0, 64.0));
        let shown: Vec<String> = tuning.sliders(settings).into_iter().map(|slider| slider.value).collect();
        assert_eq!(shown, ["64", "64", "×8", "×8", "×64"]);
    }

    /// Counts of a scene may be any, and keys go farther than sliders.
    #[test]
    fn a_count_between_stops_is_shown_between_them() {
        let (mut playback, mut tuning) = open("pyramid");
        for (count, place) in [(1, 0.0), (3, 3.0_f64.log2() / 6.0), (64, 1.0), (512, 1.0)] {
            let settings = playback.simulation.settings().with_substeps(count);
            playback.simulation.set_settings(settings).unwrap();
            assert_eq!(tuning.sliders(&settings)[0].place, place);
        }
        choose(&mut tuning, Knob::Substeps);
        tuning.turn(&mut playback, Change::More).unwrap();
        assert_eq!(playback.simulation.settings().substeps, 1024);
        tuning.slide(&mut playback, 0, 1.0).unwrap();
        assert_eq!(playback.simulation.settings().substeps, 64);
    }

    #[test]
    fn a_refused_setting_leaves_the_slider_where_the_engine_is() {
        let (mut playback, _) = open("t-handle");
        // Eight times as much may not be.
        let settings = playback.simulation.settings().with_gravity(Vec3::new(0.0, -5e8, 0.0));
        playback.simulation.set_settings(settings).unwrap();
        let mut tuning = Tuning::of(&playback);
        let row = KNOBS.iter().position(|knob| *knob == Knob::Gravity).unwrap();
        assert!(tuning.slide(&mut playback, row, 1.0).is_err());
        let place = tuning.sliders(playback.simulation.settings())[row].place;
        assert_eq!((*playback.simulation.settings(), place), (settings, Knob::Gravity.place(as_position(ONE))));
        tuning.slide(&mut playback, row, 0.0).unwrap();
        assert_eq!(playback.simulation.settings().gravity, Vec3::ZERO);
    }

    /// Speed is none of the engine's settings, and goes on in another scene.
    #[test]
    fn speed_does_not_touch_the_engine() {
        let (mut playback, mut tuning) = open("t-handle");
        playback.simulation.step(&mut playback.world);
        let (before, start) = (playback.hash(), playback.start);
        (0..20).for_each(|_| tuning.turn_speed(Change::Less));
        assert_eq!(tuning.speed(), 1.0 / 64.0);
        let last = tuning.sliders(playback.simulation.settings()).pop().unwrap();
        assert_eq!((last.name, last.value.as_str(), last.place), ("speed", "×1/64", 0.0));
        tuning.slide(&mut playback, KNOBS.len() - 1, 0.5).unwrap();
        assert_eq!(tuning.speed(), 1.0);
        tuning.turn_speed(Change::More);
        assert_eq!((playback.hash(), playback.start), (before, start));
        let mut other = open("pyramid").1;
        other.keep_speed(&tuning);
        assert_eq!(other.speed(), 2.0);
    }

    #[test]
    fn what_the_engine_refuses_is_reported() {
        let (mut playback, mut tuning) = open("pyramid");
        choose(&mut tuning, Knob::ContactSubsteps);
        let refused = (0..40).find_map(|_| tuning.turn(&mut playback, Change::More).err());
        assert!(refused.is_some());
        let most = playback.simulation.settings().contact_substeps;
        assert!((Settings::MAX_CONTACT_SUBSTEPS / 2..=Settings::MAX_CONTACT_SUBSTEPS).contains(&most), "{most}");
        choose(&mut tuning, Knob::Gravity);
        (0..20).for_each(|_| tuning.turn(&mut playback, Change::Less).unwrap());
        assert_eq!(playback.simulation.settings().gravity, Vec3::ZERO);
        (0..20).for_each(|_| tuning.turn(&mut playback, Change::More).unwrap());
        assert_eq!(playback.simulation.settings().gravity, tuning.gravity * 8.0);
    }

    /// On a slope of less than the angle of friction a box stays, and slides without friction.
    #[test]
    fn friction_is_scaled() {
        let scene = r#"{ "gravity": [2, -9.81, 0], "dt": 0.01, "bodies": [
            { "name": "ground", "shape": { "half_space": {} }, "fixed": true, "collider": {} },
            { "name": "box", "shape": { "cuboid": { "half_extents": [0.2, 0.2, 0.2] } }, "mass": 1, "collider": {}, "position": [0, 0.2, 0] } ] }"#;
        let speed = |changes: usize| {
            let mut playback = Playback::of(Scene::from_json(scene, "slope.json").unwrap()).unwrap();
            let mut tuning = Tuning::of(&playback);
            choose(&mut tuning, Knob::Friction);
            (0..changes).for_each(|_| tuning.turn(&mut playback, Change::Less).unwrap());
            (0..100).for_each(|_| playback.step());
            let entity = playback.bodies.all[1].entity;
            f64::from(playback.world.get::<&Velocity>(entity).unwrap().linear.x)
        };
        assert!(speed(0).abs() < 1e-3, "{}", speed(0));
        // A second at 2 m/s^2.
        assert!((speed(ONE) - 2.0).abs() < 0.02, "{}", speed(ONE));
    }
}
