//! Whether the steps of a run are short enough for what turns or swings fastest in it.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::{self, Display};

use hecs::{Entity, World};
use tumble::math::Real;
use tumble::{BodyId, Drives, Gain, Joint, Mass, Momentum, Settings, Spring, SpringToPoint, Velocity};
use tumble_scene::{BodyNames, TIME_STEPS};

/// Beyond a quarter of a turn in a step, states and contacts do not show which way a body turned.
const MAX_TURN: f64 = FRAC_PI_2;
/// Up to here a spring has its own frequency; docs/forces.md has the error beyond.
const MAX_OSCILLATIONS: f64 = 0.45;
/// A drive that swings by more radians in a substep is damped by it; see docs/joints.md.
const MAX_OF_DRIVE: f64 = 2.0;

/// What a step is too long for, of all things the one for which it is longest.
#[derive(Debug, PartialEq)]
pub(crate) struct TooLong {
    what: String,
    /// How many times too long it is, with the parts that it is divided into.
    times: f64,
    /// Those parts.
    parts: u32,
    dt: f64,
}

impl TooLong {
    /// In the world's present state.
    #[allow(clippy::useless_conversion, reason = "dt is f64 already in one of the two builds")]
    pub(crate) fn of(world: &World, settings: &Settings, names: &BodyNames) -> Option<Self> {
        let dt = f64::from(settings.dt);
        let name = |entity: Entity| world.get::<&BodyId>(entity).map(|id| names.of(id.0).into_owned());
        let longest = [turning(world, settings), swinging(world, settings), driven(world, settings)];
        let longest = longest.into_iter().flatten().max_by(|a, b| a.times.total_cmp(&b.times))?;
        let body = name(longest.body).unwrap_or_else(|_| "a body".to_owned());
        let what = match longest.kind {
            Kind::Turn => format!("body {body:?} turns by {}", angle(longest.amount)),
            Kind::Spring => format!("the spring at body {body:?} swings {} times", short(longest.amount)),
            Kind::Drive => format!("the drive at body {body:?} swings {} times", short(longest.amount / TAU)),
        };
        Some(Self { what, times: longest.times, parts: longest.parts, dt })
    }
}

impl Display for TooLong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, times, parts, dt } = self;
        let part = if *parts == 1 { "a step".to_owned() } else { format!("one of the {parts} parts of a step") };
        write!(f, "{what} in {part} of {} s, which is too long for it", short(dt / f64::from(*parts)))?;
        let (step, substeps) = (dt / times, (times * f64::from(*parts)).ceil());
        let step = TIME_STEPS.contains(&step).then(|| format!("--dt {}", written(step)));
        let substeps = (substeps <= f64::from(Settings::MAX_SUBSTEPS)).then(|| format!("--substeps {substeps}"));
        match [step, substeps].into_iter().flatten().collect::<Vec<_>>().as_slice() {
            [] => Ok(()),
            would_do => write!(f, ": {} would do", would_do.join(" or ")),
        }
    }
}

/// A kind of motion, with how far it goes in a part of a step.
struct Longest {
    kind: Kind,
    body: Entity,
    amount: f64,
    times: f64,
    parts: u32,
}

#[derive(Clone, Copy)]
enum Kind {
    Turn,
    Spring,
    Drive,
}

/// The one that goes farthest, if that is farther than `most`.
fn farthest((kind, most, parts): (Kind, f64, u32), all: impl Iterator<Item = (Entity, f64)>) -> Option<Longest> {
    let (body, amount) = all.filter(|(_, amount)| *amount > most).max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Longest { kind, body, amount, times: amount / most, parts })
}

#[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
fn part(settings: &Settings, parts: u32) -> f64 {
    f64::from(settings.dt) / f64::from(parts)
}

#[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
fn turning(world: &World, settings: &Settings) -> Option<Longest> {
    let parts = settings.substeps;
    let h = part(settings, parts);
    let mut bodies = world.query::<(Entity, &Velocity)>().with::<&Momentum>();
    let turns = bodies.iter().map(|(body, velocity)| (body, f64::from(velocity.angular.length()) * h));
    farthest((Kind::Turn, MAX_TURN, parts), turns)
}

#[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
fn swinging(world: &World, settings: &Settings) -> Option<Longest> {
    let parts = settings.substeps;
    let h = part(settings, parts);
    let inverse_mass = |body: Entity| {
        let moves = world.get::<&Momentum>(body).is_ok();
        world.get::<&Mass>(body).ok().filter(|_| moves).map_or(0.0, |mass| 1.0 / f64::from(mass.kilograms()))
    };
    let oscillations = |stiffness: Real, inverse: f64| (f64::from(stiffness) * inverse).sqrt() / TAU * h;
    let mut between = world.query::<&Spring>();
    let between = between.iter().map(|spring| {
        let inverse = spring.bodies.map(inverse_mass);
        let lighter = if inverse[1] > inverse[0] { spring.bodies[1] } else { spring.bodies[0] };
        (lighter, oscillations(spring.stiffness, inverse[0] + inverse[1]))
    });
    let mut to_points = world.query::<(Entity, &SpringToPoint)>();
    let to_points = to_points.iter().map(|(body, spring)| (body, oscillations(spring.stiffness, inverse_mass(body))));
    farthest((Kind::Spring, MAX_OSCILLATIONS, parts), between.chain(to_points))
}

/// Drives of a frequency of their own; that of a stiffness depends on the whole mechanism.
#[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
fn driven(world: &World, settings: &Settings) -> Option<Longest> {
    let parts = settings.substeps.max(settings.contact_substeps);
    let h = part(settings, parts);
    let radians = |gain: Gain| match gain {
        Gain::Frequency { hertz, .. } => TAU * f64::from(hertz) * h,
        Gain::Acceleration { stiffness, .. } => f64::from(stiffness).sqrt() * h,
        Gain::Rigid | Gain::Stiffness { .. } => 0.0,
    };
    let mut joints = world.query::<(&Joint, &Drives)>();
    let drives = joints.iter().filter_map(|(joint, drives)| {
        let fastest = drives.0.iter().map(|drive| radians(drive.gain)).max_by(f64::total_cmp)?;
        Some((joint.bodies[1], fastest))
    });
    farthest((Kind::Drive, MAX_OF_DRIVE, parts), drives)
}

fn angle(radians: f64) -> String {
    let turns = radians / TAU;
    if turns < 1.0 { format!("{:.0} degrees", 360.0 * turns) } else { format!("{} turns", short(turns)) }
}

/// Three digits.
fn short(number: f64) -> String {
    if (1e-3..1e4).contains(&number) {
        let digits = (2.0 - number.log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{number:.digits$}")
    } else {
        format!("{number:.2e}")
    }
}

/// A step no longer than this one, with two digits: 1/240 rather than 0.0041.
fn written(step: f64) -> String {
    let rate = (1.0 / step).max(1.0);
    let unit = 10_f64.powi((rate.log10().floor() as i32 - 1).max(0));
    let rate = (rate / unit).ceil() * unit;
    if step >= 1.0 { format!("{}", step.floor()) } else { format!("1/{rate}") }
}

#[cfg(test)]
mod tests {
    use tumble_scene::Scene;

    use super::*;

    fn warning(scene: Scene) -> Option<String> {
        let (settings, mut world) = (scene.settings, World::new());
        let names = scene.spawn(&mut world).unwrap();
        TooLong::of(&world, &settings, &names).map(|too_long| too_long.to_string())
    }

    fn of_text(text: &str) -> Option<String> {
        warning(Scene::from_json(text, "scene.json").unwrap())
    }

    #[test]
    fn built_in_scenes_have_steps_that_are_short_enough() {
        for name in tumble_scene::builtin_names() {
            assert_eq!(warning(Scene::open(name).unwrap()), None, "{name}");
        }
    }

    /// The rates by hand: 100 rad/s over 0.1 s are 10 rad, 1.59 turns, of which a quarter is
    /// 1/6.37; a spring of 1e4 N/m at 1 kg swings 15.9 times a second; 100 Hz over 1/240 s are
    /// 0.417 swings where 1/pi = 0.318 are allowed.
    #[test]
    fn what_is_too_fast_is_named_with_a_step_that_would_do() {
        let ball = r#""shape": { "sphere": { "radius": 1 } }, "mass": 1"#;
        let text =
            format!(r#"{{ "dt": 0.1, "bodies": [ {{ "name": "top", {ball}, "angular_velocity": [0, 100, 0] }} ] }}"#);
        let said = "body \"top\" turns by 1.59 turns in a step of 0.100 s, which is too long for it: --dt 1/64 or --substeps 7 would do";
        assert_eq!(of_text(&text).as_deref(), Some(said));
        let slow = text.replace("100", "15.7");
        assert_eq!(of_text(&slow), None);
        let spring = r#""forces": [ { "spring_to_point": { "anchor": [0, 0, 0], "stiffness": 1e4 } } ]"#;
        let text = format!(r#"{{ "dt": 0.1, "bodies": [ {{ "name": "bob", {ball}, {spring} }} ] }}"#);
        let said = of_text(&text).unwrap();
        assert!(said.starts_with("the spring at body \"bob\" swings 1.59 times in a step of 0.100 s"), "{said}");
        assert!(said.ends_with("--dt 1/36 or --substeps 4 would do"), "{said}");
        assert_eq!(of_text(&text.replace("0.1,", "0.01,")), None);
        let drive = r#""drives": [ { "axes": ["angular_x"], "position": 0, "frequency": 100 } ]"#;
        let text = format!(
            r#"{{ "bodies": [ {{ "name": "post", "fixed": true }}, {{ "name": "arm", {ball} }} ],
                "joints": [ {{ "between": ["post", "arm"], "hinge": {{ "at": [0, 0, 0], "axis": [0, 1, 0] }}, {drive} }} ] }}"#
        );
        let said = of_text(&text).unwrap();
        assert!(
            said.starts_with("the drive at body \"arm\" swings 0.417 times in one of the 4 parts of a step"),
            "{said}"
        );
        assert!(said.ends_with("--dt 1/79 or --substeps 6 would do"), "{said}");
    }

    /// The step that is proposed is one that is not warned of.
    #[test]
    fn a_proposed_step_is_never_longer_than_needed() {
        for step in [1e-9, 3.3e-7, 1.0 / 241.0, 0.019, 0.1, 0.9, 1.0, 2.5, 700.0] {
            let proposed = tumble_scene::parse_seconds(&written(step)).unwrap();
            assert!(proposed <= step && proposed > 0.5 * step, "{step}: {proposed}");
        }
    }
}
