//! Scenes that are found by name.

pub(crate) mod contact_scenes;
pub(crate) mod stress;

use crate::alike;
use crate::builtin::contact_scenes::CONTACT_SCENES;
use crate::error::SceneError;
use crate::model::parse::{Format, parse};
use crate::model::scene_model::SceneModel;

/// Name of the generated scene; see [`Scene::stress`](crate::Scene::stress).
pub(crate) const STRESS: &str = "stress";

/// Scenes, each with the source of its figures in the file.
const FILES: [(&str, &str); 23] = [
    ("arm", include_str!("../../scenes/arm.json")),
    ("clockwork", include_str!("../../scenes/clockwork.json")),
    ("crane", include_str!("../../scenes/crane.json")),
    ("drake-cylinder", include_str!("../../scenes/drake-cylinder.json")),
    ("firing-range", include_str!("../../scenes/firing-range.json")),
    ("foucault", include_str!("../../scenes/foucault.json")),
    ("gimbals", include_str!("../../scenes/gimbals.json")),
    ("heavy-chain", include_str!("../../scenes/heavy-chain.json")),
    ("iss", include_str!("../../scenes/iss.json")),
    ("mujoco-box", include_str!("../../scenes/mujoco-box.json")),
    ("raft", include_str!("../../scenes/raft.json")),
    ("ragdoll", include_str!("../../scenes/ragdoll.json")),
    ("ragdolls", include_str!("../../scenes/ragdolls.json")),
    ("robot", include_str!("../../scenes/robot.json")),
    ("rope-bridge", include_str!("../../scenes/rope-bridge.json")),
    ("satellite", include_str!("../../scenes/satellite.json")),
    ("skater", include_str!("../../scenes/skater.json")),
    ("solar-system", include_str!("../../scenes/solar-system.json")),
    ("t-handle", include_str!("../../scenes/t-handle.json")),
    ("van-zon-top", include_str!("../../scenes/van-zon-top.json")),
    ("walker", include_str!("../../scenes/walker.json")),
    ("weighted-sphere", include_str!("../../scenes/weighted-sphere.json")),
    ("windy-day", include_str!("../../scenes/windy-day.json")),
];

/// Names of the built-in scenes, in alphabetical order; `stress` among them.
///
/// ```
/// assert!(tumble_scene::builtin_names().any(|name| name == "t-handle"));
/// ```
pub fn builtin_names() -> impl Iterator<Item = &'static str> {
    let made = CONTACT_SCENES.iter().map(|scene| scene.name).chain([STRESS]);
    let mut names: Vec<_> = FILES.iter().map(|(name, _)| *name).chain(made).collect();
    names.sort_unstable();
    names.into_iter()
}

/// Names of the built-in scenes in alphabetical order, each with what it shows in a sentence.
///
/// ```
/// let (_, about) = tumble_scene::builtin_scenes().find(|(name, _)| *name == "bowling").unwrap();
/// assert_eq!(about, "A ball into the pocket of ten pins.");
/// ```
pub fn builtin_scenes() -> impl Iterator<Item = (&'static str, String)> {
    builtin_names().map(|name| (name, about(name)))
}

/// The built-in scene with the name most like this one, itself if it is one, and `None` if none is
/// like it.
///
/// ```
/// assert_eq!(tumble_scene::nearest_builtin("piramid"), Some("pyramid"));
/// ```
pub fn nearest_builtin(name: &str) -> Option<&'static str> {
    alike::nearest(name, builtin_names())
}

/// The first sentence of a description, up to a colon.
fn about(name: &str) -> String {
    let of_file = || text(name).and_then(|text| parse(text, Format::Json, name).ok()?.description);
    let made = contact_scenes::named(name).map(|scene| scene.description.to_owned());
    let description = made.or_else(of_file).unwrap_or_else(|| stress::ABOUT.to_owned());
    let first = description.split(". ").next().unwrap_or_default();
    // A ratio has a space before its colon too.
    let end = first.match_indices(": ").find(|(at, _)| !first[..*at].ends_with(' ')).map_or(first.len(), |(at, _)| at);
    let first = &first[..end];
    format!("{}.", first.trim_end_matches('.'))
}

/// The scene of that name, if it is one that lists its bodies.
pub(crate) fn model(name: &str) -> Option<Result<SceneModel, SceneError>> {
    let made = || contact_scenes::named(name).map(|scene| Ok(scene.model(None, None)));
    text(name).map(|text| parse(text, Format::Json, name)).or_else(made)
}

/// The text of the file of that name, which is JSON.
pub(crate) fn text(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_a_scene_with_a_source_and_its_own_name() {
        for (name, text) in FILES {
            let model = parse(text, Format::Json, name).unwrap();
            assert_eq!(model.name.as_deref(), Some(name));
            assert!(model.source.is_some_and(|source| source.len() > 20), "{name}");
            assert!(model.description.is_some_and(|description| !description.is_empty()), "{name}");
        }
    }

    #[test]
    fn the_names_are_sorted_and_complete() {
        let names: Vec<_> = builtin_names().collect();
        let known = "arm bowling clockwork cradle crane dominoes drake-cylinder drum firing-range foucault gimbals heavy-chain \
                     hills iss mujoco-box pile pyramid raft ragdoll ragdolls robot rope-bridge satellite skater solar-system spheres \
                     stress t-handle van-zon-top walker wall weighted-sphere windy-day";
        assert_eq!(names.join(" "), known);
    }
}
