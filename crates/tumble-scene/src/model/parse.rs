//! Text to model, with the place of whatever is wrong.

use std::borrow::Cow;

use serde::de::DeserializeSeed;
use serde_path_to_error::Segment;
use tumble_import::{FileError, Place, one_line};

use crate::error::SceneError;
use crate::model::error_context::NameOfBody;
use crate::model::json_comments::without_comments;
use crate::model::mesh_shape;
use crate::model::scene_model::SceneModel;
use crate::model::shape_advice::advised;

/// How a scene is written down.
///
/// ```
/// use tumble_scene::Format;
///
/// assert_eq!(Format::of_path("a/b.RON".as_ref()), Some(Format::Ron));
/// assert_eq!(Format::of_path("a/b.txt".as_ref()), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// JavaScript Object Notation.
    Json,
    /// Rusty Object Notation. Optional fields need no `Some`; lists of numbers take either bracket.
    Ron,
}

impl Format {
    /// The format that a path's extension names, in either case; `None` if it names none.
    #[must_use]
    pub fn of_path(path: &std::path::Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        if extension.eq_ignore_ascii_case("json") {
            Some(Self::Json)
        } else if extension.eq_ignore_ascii_case("ron") {
            Some(Self::Ron)
        } else {
            None
        }
    }
}

/// This much of a bad word is shown to either side of the place \[characters\].
const LONGEST_WORD: usize = 30;

/// Nesting is limited by both parsers to 128 levels, so a hostile file cannot overflow the stack.
pub(crate) fn parse(text: &str, format: Format, file: &str) -> Result<SceneModel, SceneError> {
    // Editors on Windows put a byte-order mark in front.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let text = &*match format {
        Format::Json => without_comments(text).map_err(|line| unclosed(file, line))?,
        Format::Ron => Cow::Borrowed(text),
    };
    let mut model = match format {
        Format::Json => parse_json(text),
        Format::Ron => parse_ron(text),
    }
    .map_err(|(path, problem)| {
        let segments: Vec<&Segment> = path.iter().collect();
        let problem = one_line(&advised(&segments, &problem, format).unwrap_or(problem));
        FileError::Malformed { file: one_line(file), place: place(&path, text, format), problem }
    })?;
    mesh_shape::make_all(&mut model, file);
    Ok(model)
}

fn unclosed(file: &str, line: usize) -> FileError {
    let problem = format!("the comment that begins in line {line} does not end");
    FileError::Malformed { file: one_line(file), place: Place { body: None, field: String::new() }, problem }
}

type Located = (serde_path_to_error::Path, String);

fn parse_json(text: &str) -> Result<SceneModel, Located> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let mut track = serde_path_to_error::Track::new();
    let model: Result<SceneModel, _> =
        serde::Deserialize::deserialize(serde_path_to_error::Deserializer::new(&mut deserializer, &mut track));
    model.and_then(|model| deserializer.end().map(|()| model)).map_err(|error| {
        // Errors of syntax, unlike those of types, do not repeat the value. Columns are bytes here.
        let line = text.lines().nth(error.line().saturating_sub(1)).filter(|_| error.is_syntax());
        let at = line.map(|line| line.char_indices().filter(|(byte, _)| byte + 1 < error.column()).count());
        let near = at.map(|at| near(text, error.line(), at)).unwrap_or_default();
        (track.path(), format!("{error}{near}"))
    })
}

fn parse_ron(text: &str) -> Result<SceneModel, Located> {
    let spanned = |error: ron::error::SpannedError| {
        let at = error.span.start;
        let near = near(text, at.line, at.col.saturating_sub(1));
        // RON's own words for this are advice to programmers.
        let deep = matches!(error.code, ron::Error::ExceededRecursionLimit);
        let problem = if deep { "nested too deeply".to_owned() } else { error.code.to_string() };
        format!("{problem} at line {} column {}{near}", at.line, at.col)
    };
    let mut track = serde_path_to_error::Track::new();
    let mut deserializer = match ron::de::Deserializer::from_str_with_options(text, &ron_options()) {
        Ok(deserializer) => deserializer,
        Err(error) => return Err((track.path(), spanned(error))),
    };
    let model: Result<SceneModel, _> =
        serde::Deserialize::deserialize(serde_path_to_error::Deserializer::new(&mut deserializer, &mut track));
    model
        .and_then(|model| deserializer.end().map(|()| model))
        .map_err(|error| (track.path(), spanned(deserializer.span_error(error))))
}

/// The word at a place of the text, or the next one: line from 1, character of the line from 0.
fn near(text: &str, line: usize, character: usize) -> String {
    let Some(line) = text.lines().nth(line.saturating_sub(1)) else { return String::new() };
    let characters: Vec<char> = line.chars().take(character.saturating_add(2 * LONGEST_WORD)).collect();
    let inside = |character: &&char| !(character.is_whitespace() || ",:[](){}".contains(**character));
    let spaces = characters.iter().skip(character).take_while(|character| character.is_whitespace()).count();
    let at = character.saturating_add(spaces).min(characters.len());
    let before = characters[..at].iter().rev().take_while(inside).take(LONGEST_WORD).count();
    let after = characters[at..].iter().take_while(inside).take(LONGEST_WORD).count();
    let word: String = characters[at - before..at + after].iter().collect();
    if word.is_empty() { word } else { format!(", near {word}") }
}

fn ron_options() -> ron::Options {
    ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
}

/// The place that a path of the deserialiser means, with the name of the body if it can be read.
fn place(path: &serde_path_to_error::Path, text: &str, format: Format) -> Place {
    let segments: Vec<&Segment> = path.iter().collect();
    match segments.as_slice() {
        [Segment::Map { key }, Segment::Seq { index }, field @ ..] if key == "bodies" => {
            Place { body: Some((*index, body_name(text, format, *index))), field: join(field) }
        }
        field => Place { body: None, field: join(field) },
    }
}

fn join(segments: &[&Segment]) -> String {
    let mut path = String::new();
    for segment in segments {
        match segment {
            Segment::Unknown => continue,
            Segment::Seq { .. } => {}
            _ if path.is_empty() => {}
            _ => path.push('.'),
        }
        path.push_str(&segment.to_string());
    }
    path
}

/// Reads past everything but names, up to the mistake; the body's name usually stands before it.
fn body_name(text: &str, format: Format, index: usize) -> Option<String> {
    let mut name = None;
    let seed = NameOfBody { index, name: &mut name };
    // A failure is expected: the text is known to be bad. What was read until then counts.
    match format {
        Format::Json => drop(seed.deserialize(&mut serde_json::Deserializer::from_str(text))),
        Format::Ron => {
            if let Ok(mut deserializer) = ron::de::Deserializer::from_str_with_options(text, &ron_options()) {
                drop(seed.deserialize(&mut deserializer));
            }
        }
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str, format: Format) -> String {
        parse(text, format, "scene").unwrap_err().to_string()
    }

    #[test]
    fn errors_of_syntax_show_the_word_and_keep_the_name() {
        let text = "{ \"bodies\": [ {},\n { \"name\": \"gr\u{fc}n\", \"mass\": NaN } ] }";
        assert_eq!(
            message(text, Format::Json),
            "scene: body \"gr\u{fc}n\" (bodies[1]), field mass: expected value at line 2 column 29, near NaN"
        );
        let text = "( bodies: [ (), ( name: \"b\", mass: \"x\" ) ] )";
        assert_eq!(
            message(text, Format::Ron),
            "scene: body \"b\" (bodies[1]), field mass: Expected float at line 1 column 35, near \"x\""
        );
        assert!(message(r#"{ "dt": 1e999 }"#, Format::Json).ends_with(", near 1e999"));
    }

    #[test]
    fn comments_are_skipped_and_keep_the_lines() {
        let text = "{ // what\n \"dt\": 0.5, /* how\nlong */ \"bodies\": [ { \"name\": \"a//b\" } ] }";
        let model = parse(text, Format::Json, "scene").unwrap();
        assert_eq!((model.dt, model.bodies[0].name.as_deref()), (Some(0.5), Some("a//b")));
        let text = "{ // gr\u{fc}n\n/* two\n lines */ \"bodies\": [ { \"name\": \"b\", /* half */ \"mass\": true } ] }";
        assert_eq!(
            message(text, Format::Json),
            "scene: body \"b\" (bodies[0]), field mass: invalid type: boolean `true`, expected f64 at line 3 column 60"
        );
        assert_eq!(message("{\n/* no end }", Format::Json), "scene: the comment that begins in line 2 does not end");
    }

    #[test]
    fn a_name_after_the_mistake_is_found_if_the_text_goes_on() {
        let text = r#"{ "bodies": [ { "mass": "heavy", "name": "late" } ] }"#;
        assert!(message(text, Format::Json).starts_with("scene: body \"late\" (bodies[0]), field mass: "));
    }

    #[test]
    fn nesting_is_refused_and_does_not_overflow() {
        let part = r#"{"mass":1,"shape":{"compound":{"parts":["#;
        let json = format!(r#"{{"bodies":[{}"#, part.repeat(10_000));
        assert!(message(&json, Format::Json).contains("recursion limit exceeded"));
        let ron = format!("(bodies:[(shape:compound(parts:[{}", "(mass:1,shape:compound(parts:[".repeat(10_000));
        assert!(message(&ron, Format::Ron).contains("nested too deeply"));
        // An unknown key is passed over by both parsers before they complain.
        assert!(parse(&format!("{{\"x\":{}", "[".repeat(100_000)), Format::Json, "").is_err());
        assert!(parse(&format!("(x:{}", "[".repeat(100_000)), Format::Ron, "").is_err());
    }

    #[test]
    fn both_formats_mean_the_same() {
        let json = r#"{ "dt": 0.5, "bodies": [ { "name": "a", "shape": { "cuboid": { "half_extents": [1, 2, 3] } }, "mass": 2,
                     "inertia": { "tensor": [[1,0,0],[0,1,0],[0,0,1]] }, "forces": [ { "gravity_scale": 0.5 } ] } ] }"#;
        let ron = r#"( dt: 0.5, bodies: [ ( name: "a", shape: cuboid(half_extents: (1, 2, 3.0)), mass: Some(2),
                     inertia: (tensor: ((1,0,0),[0,1,0],(0,0,1))), forces: [ gravity_scale(0.5) ] ) ] )"#;
        let (json, ron) = (parse(json, Format::Json, "").unwrap(), parse(ron, Format::Ron, "").unwrap());
        assert_eq!(format!("{json:?}"), format!("{ron:?}"));
    }

    #[test]
    fn a_byte_order_mark_is_passed_over() {
        assert!(parse("\u{feff}{}", Format::Json, "").is_ok());
    }
}
