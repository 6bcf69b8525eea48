//! What can be wrong with a file, said in one line.

use std::fmt;

use crate::terminal::{one_line, printable, quoted};

/// Why a file could not be used.
///
/// `Display` is one [printable](crate::printable) line that names the file, the body (by its name
/// where that could be read, and by its index) and the field, and repeats the offending value.
///
/// ```
/// use tumble_import::gltf::Physics;
///
/// let error = Physics::from_json(r#"{ "asset": { "version": 2 } }"#, "wall.gltf").unwrap_err();
/// assert!(error.to_string().starts_with("wall.gltf: field asset.version: "));
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file is missing, is not a regular file or cannot be read.
    #[error("{}: cannot be read: {}", printable(.file), printable(.reason))]
    Unreadable {
        /// The file as the caller named it.
        file: String,
        /// The reason the system gave.
        reason: String,
    },
    /// The file is larger than [`MAX_FILE_BYTES`](crate::MAX_FILE_BYTES), or than what its format
    /// may have.
    #[error("{}: is larger than {limit} bytes, the most such a file may have", printable(.file))]
    TooLarge {
        /// The file as the caller named it.
        file: String,
        /// The limit \[bytes\].
        limit: u64,
    },
    /// The file is not UTF-8.
    #[error("{}: is not UTF-8 text (bad byte at offset {offset})", printable(.file))]
    NotText {
        /// The file as the caller named it.
        file: String,
        /// Offset of the first bad byte.
        offset: usize,
    },
    /// The file name's extension is none of the formats of meshes.
    #[error("{}: a mesh file ends in .obj, .stl, .gltf or .glb", printable(.file))]
    UnknownFormat {
        /// The file as the caller named it.
        file: String,
    },
    /// The text is not of its format: bad syntax, an unknown key, a wrong type.
    #[error("{}: {place}{}", printable(.file), printable(.problem))]
    Malformed {
        /// The file as the caller named it.
        file: String,
        /// Where in the document.
        place: Place,
        /// What is wrong, with line and column.
        problem: String,
    },
    /// The text has an impossible value.
    #[error("{}: {place}{}", printable(.file), printable(.problem))]
    Invalid {
        /// The file as the caller named it.
        file: String,
        /// Where in the document.
        place: Place,
        /// What is wrong, with the value.
        problem: String,
    },
    /// The document has more of something than one may have, all that it names included.
    #[error("{}: {place}more than {limit} {what}, the most a document may have", printable(.file))]
    TooMuch {
        /// The file as the caller named it.
        file: String,
        /// Where the limit was passed.
        place: Place,
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
    /// The file is a robot with an impossible link.
    #[error("{}: link {link:?}, field {}: {}", printable(.file), printable(.field), printable(.problem))]
    Link {
        /// The file as the caller named it.
        file: String,
        /// The link's name.
        link: String,
        /// Path of the element and its attribute inside the link, or a joint of the link's.
        field: String,
        /// What is wrong, with the value and the line.
        problem: String,
    },
}

tumble_math::debug_as_display!(FileError);

/// A place in a document: a body, or the document itself, and a field of it.
///
/// ```
/// use tumble_import::Place;
///
/// let place = Place { body: Some((3, Some("brick".into()))), field: "mass".into() };
/// assert_eq!(place.to_string(), "body \"brick\" (bodies[3]), field mass: ");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Index of the body in `bodies`, and its name where that could be read.
    pub body: Option<(usize, Option<String>)>,
    /// Path of the field inside the body, or inside the document; empty if not known.
    pub field: String,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.body {
            Some((index, Some(name))) => write!(f, "body {:?} (bodies[{index}])", quoted(name))?,
            Some((index, None)) => write!(f, "body bodies[{index}]")?,
            None if self.field.is_empty() => return Ok(()),
            None => {}
        }
        let separator = if self.body.is_some() { ", " } else { "" };
        if !self.field.is_empty() {
            write!(f, "{separator}field {}", one_line(&self.field))?;
        }
        f.write_str(": ")
    }
}

/// An impossible value of one field; body and file are added by whoever knows them.
///
/// ```
/// use tumble_import::FieldError;
///
/// let error = FieldError::new("mass", "must be positive").inside("motion");
/// assert_eq!(error.to_string(), "motion.mass: must be positive");
/// assert_eq!(
///     error.in_file("a.gltf", None).to_string(),
///     "a.gltf: field motion.mass: must be positive"
/// );
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct FieldError {
    /// Path of the field, from what has it.
    pub field: String,
    /// What is wrong, with the value.
    pub problem: String,
    /// What cannot be used for it.
    pub scope: Scope,
}

/// What an error makes unusable.
///
/// ```
/// use tumble_import::{FieldError, Scope};
///
/// assert_eq!(FieldError::new("mass", "must be positive").scope, Scope::Body);
/// assert_eq!(FieldError::exceeding("nodes", "nodes", 10).scope, Scope::Limit("nodes", 10));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// What has the field.
    Body,
    /// The whole document: a file that it names cannot be read.
    Document,
    /// The whole document, for it has more of this than one may have.
    Limit(&'static str, u64),
}

impl FieldError {
    /// More of something than a whole document may have.
    pub fn exceeding(field: impl Into<String>, what: &'static str, limit: u64) -> Self {
        let problem = format!("more than {limit} {what}, the most a document may have");
        Self { field: field.into(), problem, scope: Scope::Limit(what, limit) }
    }

    /// A problem with one field. Where it begins with the field's name, that is not said twice.
    pub fn new(field: impl Into<String>, problem: impl fmt::Display) -> Self {
        let field = field.into();
        let problem = one_line(&problem.to_string());
        let problem = without_field(&problem, &field).to_owned();
        Self { field, problem, scope: Scope::Body }
    }

    /// The same error, for which nothing of the document is to be used.
    pub(crate) fn of_document(self) -> Self {
        Self { scope: Scope::Document, ..self }
    }

    /// The same error of a node of a glTF file.
    pub(crate) fn of_node(self, index: usize, name: &str) -> Self {
        let problem = format!("node {name:?} {}", self.problem);
        Self { problem, ..self.inside(&format!("nodes[{index}]")) }
    }

    /// The same error seen from the thing that holds the field's owner. An error without a field is
    /// the owner's.
    #[must_use]
    pub fn inside(mut self, outer: &str) -> Self {
        self.field = if self.field.is_empty() { outer.to_owned() } else { format!("{outer}.{}", self.field) };
        self
    }

    /// The error of a document or one of its bodies, given by its index and its name, in a file.
    #[must_use]
    pub fn in_file(self, file: &str, body: Option<(usize, Option<String>)>) -> FileError {
        let (file, place) = (one_line(file), Place { body, field: self.field });
        match self.scope {
            Scope::Limit(what, limit) => FileError::TooMuch { file, place, what, limit },
            Scope::Body | Scope::Document => FileError::Invalid { file, place, problem: self.problem },
        }
    }
}

tumble_math::debug_as_display!(FieldError);

impl std::error::Error for FieldError {}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.problem)
    }
}

/// The engine's messages begin with the field too; once is enough.
fn without_field<'a>(problem: &'a str, field: &str) -> &'a str {
    let starts = field.match_indices('.').map(|(dot, _)| dot + 1);
    std::iter::once(0)
        .chain(starts)
        .find_map(|start| problem.strip_prefix(&field[start..])?.strip_prefix(' '))
        .unwrap_or(problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_stay_on_one_line_and_short() {
        let error = FieldError::new("mass", format!("bad\nvalue\u{1b}[31m{}", "x".repeat(10_000)));
        assert!(!error.to_string().contains(['\n', '\u{1b}']));
        assert!(error.to_string().chars().count() < 1000);
    }

    #[test]
    fn a_field_is_named_once() {
        let error = FieldError::new("shape.parts[1].radius", "parts[1].radius must be positive, it is -1");
        assert_eq!(error.to_string(), "shape.parts[1].radius: must be positive, it is -1");
        assert_eq!(FieldError::new("mass", "massive mistake").problem, "massive mistake");
    }

    #[test]
    fn a_place_without_body_names_the_field_only() {
        let place = Place { body: None, field: "dt".into() };
        assert_eq!(place.to_string(), "field dt: ");
        assert_eq!(Place::default().to_string(), "");
    }
}
