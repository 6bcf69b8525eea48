//! Settings that are changed while a scene runs.

use tumble::Settings;

use crate::convert::real;
use crate::playback::Playback;
use crate::readout::Row;

/// Factors of gravity and friction.
const FACTORS: [f64; 8] = [0.0, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0];
/// Where the factor is 1.
const ONE: usize = 4;

/// A setting that can be changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Knob {
    Substeps,
    ContactSubsteps,
    Gravity,
    Friction,
}

const KNOBS: [Knob; 4] = [Knob::Substeps, Knob::ContactSubsteps, Knob::Gravity, Knob::Friction];

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
    chosen: usize,
}

impl Tuning {
    pub(crate) fn of(playback: &Playback) -> Self {
        let gravity = playback.simulation.settings().gravity;
        Self { gravity, gravity_factor: ONE, friction_factor: ONE, chosen: 0 }
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
        let (mut new, mut settings) = (*self, *playback.simulation.settings());
        match KNOBS[self.chosen] {
            Knob::Substeps => settings.substeps = count(settings.substeps, change),
            Knob::ContactSubsteps => settings.contact_substeps = count(settings.contact_substeps, change),
            Knob::Gravity => {
                new.gravity_factor = factor(self.gravity_factor, change);
                settings.gravity = self.gravity * real(FACTORS[new.gravity_factor]);
            }
            Knob::Friction => new.friction_factor = factor(self.friction_factor, change),
        }
        playback.simulation.set_settings(settings).map_err(|error| error.to_string())?;
        if new.friction_factor != self.friction_factor {
            scale_friction(playback, FACTORS[new.friction_factor]);
        }
        *self = new;
        playback.begin_books();
        Ok(())
    }

    /// The settings and their values, of which the chosen one has a mark.
    pub(crate) fn rows(&self, settings: &Settings) -> Vec<Row> {
        let row = |(index, knob): (usize, Knob)| {
            let (name, value) = match knob {
                Knob::Substeps => ("substeps", settings.substeps.to_string()),
                Knob::ContactSubsteps => ("contact sub.", settings.contact_substeps.to_string()),
                Knob::Gravity => ("gravity", format!("×{}", FACTORS[self.gravity_factor])),
                Knob::Friction => ("friction", format!("×{}", FACTORS[self.friction_factor])),
            };
            let mark = if index == self.chosen { "<-  ->" } else { "" };
            (name.to_owned(), format!("{value:<8}{mark}"))
        };
        KNOBS.into_iter().enumerate().map(row).collect()
    }
}

fn count(now: u32, change: Change) -> u32 {
    match change {
        Change::Less => (now / 2).max(1),
        Change::More => now.saturating_mul(2),
    }
}

fn factor(now: usize, change: Change) -> usize {
    match change {
        Change::Less => now.saturating_sub(1),
        Change::More => (now + 1).min(FACTORS.len() - 1),
    }
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
            let rows = tuning.rows(playback.simulation.settings());
            tuning.turn(&mut playback, Change::More).unwrap();
            assert_ne!(tuning.rows(playback.simulation.settings()), rows, "{knob:?}");
            tuning.turn(&mut playback, Change::Less).unwrap();
            assert_eq!(tuning.rows(playback.simulation.settings()), rows, "{knob:?}");
        }
        assert_eq!(*playback.simulation.settings(), before);
        tuning.choose(Change::More);
        tuning.choose(Change::Less);
        assert_eq!(KNOBS[tuning.chosen], Knob::Friction);
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
