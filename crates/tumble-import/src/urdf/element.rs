//! The XML under a robot: elements, their attributes as numbers, and the lines they stand on.

use glam::DVec3;
use roxmltree::{Document, Error, Node, ParsingOptions};

use crate::checked::finite;
use crate::error::{FieldError, FileError, Place};
use crate::terminal::one_line;

use crate::urdf::frame::{Frame, from_roll_pitch_yaw};

/// Most nodes of a document: elements, texts and comments.
const MAX_NODES: u32 = 1_000_000;

/// Most namespace declarations. The parser keeps a list of them with every element that adds one.
const MAX_NAMESPACES: usize = 100;

/// Most quotation marks between two angle brackets. The parser compares every attribute with those
/// before it.
const MAX_QUOTES: usize = 1000;

/// Namespaces of macros, by how their addresses begin.
const XACRO: [&str; 2] = ["http://www.ros.org/wiki/xacro", "http://ros.org/wiki/xacro"];

/// The document, unless it is none or made to exhaust the parser.
pub(crate) fn parse<'a>(text: &'a str, file: &str) -> Result<Document<'a>, FileError> {
    let malformed = |problem: &str| FileError::Malformed {
        file: one_line(file),
        place: Place::default(),
        problem: one_line(problem),
    };
    if text.matches("xmlns").take(MAX_NAMESPACES + 1).count() > MAX_NAMESPACES {
        return Err(malformed(&format!("more than {MAX_NAMESPACES} namespaces are declared")));
    }
    let quotes = |stretch: &str| stretch.bytes().filter(|byte| matches!(byte, b'"' | b'\'')).count();
    // Comments have no attributes; whatever is hidden in what only looks like one, the parser takes
    // for text, too.
    let tag = |stretch: &&str| !stretch.starts_with("!--");
    if let Some(stretch) = text.split('<').filter(tag).find(|stretch| quotes(stretch) > MAX_QUOTES) {
        let name: String = stretch.chars().take_while(|letter| letter.is_alphanumeric()).take(30).collect();
        return Err(malformed(&format!("element <{name}> has more than {MAX_QUOTES} quotation marks")));
    }
    let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| match &error {
        Error::NodesLimitReached => malformed(&format!("more than {MAX_NODES} elements, texts and comments")),
        Error::UnknownNamespace(prefix, _) if prefix == "xacro" => malformed(EXPAND),
        _ => malformed(&error.to_string()),
    })
}

/// What is said of a robot that is still a program.
pub(crate) const EXPAND: &str =
    "has xacro macros that are not expanded: expand them first (xacro FILE > robot.urdf) and give the result";

/// Whether macros are left. Expanded files keep the declaration of the namespace, so that alone
/// says nothing.
pub(crate) fn has_macros(document: &Document<'_>) -> bool {
    document.descendants().any(|node| {
        let macros = |namespace: &str| XACRO.iter().any(|start| namespace.starts_with(start));
        let unexpanded = |value: &str| value.contains("${") || value.contains("$(");
        // Simulators' own elements may look like a macro.
        node.tag_name().namespace().is_some_and(macros)
            || node.attributes().any(|attribute| unexpanded(attribute.value()))
    })
}

/// Where the lines of a text begin.
pub(crate) struct Lines(Vec<usize>);

impl Lines {
    pub(crate) fn of(text: &str) -> Self {
        Self(text.match_indices('\n').map(|(newline, _)| newline + 1).collect())
    }

    /// The number of the line, from 1, that has this byte.
    fn at(&self, byte: usize) -> usize {
        1 + self.0.partition_point(|start| *start <= byte)
    }
}

/// An element that knows its line.
#[derive(Clone, Copy)]
pub(crate) struct Element<'a> {
    node: Node<'a, 'a>,
    lines: &'a Lines,
}

impl<'a> Element<'a> {
    pub(crate) fn root(document: &'a Document<'a>, lines: &'a Lines) -> Self {
        Self { node: document.root_element(), lines }
    }

    pub(crate) fn name(self) -> &'a str {
        self.node.tag_name().name()
    }

    pub(crate) fn line(self) -> usize {
        self.lines.at(self.node.range().start)
    }

    pub(crate) fn children(self) -> impl Iterator<Item = Self> {
        let Self { node, lines } = self;
        node.children().filter(Node::is_element).map(move |node| Self { node, lines })
    }

    pub(crate) fn all(self, name: &'static str) -> impl Iterator<Item = Self> {
        self.children().filter(move |child| child.name() == name)
    }

    /// The child of this name, if there is one. Its problem is called by that name.
    pub(crate) fn only(self, name: &'static str) -> Result<Option<Self>, FieldError> {
        let mut found = self.all(name);
        let first = found.next();
        match found.next() {
            Some(second) => Err(second.problem(name, "is given twice")),
            None => Ok(first),
        }
    }

    /// The child of this name, which has to be there.
    pub(crate) fn needed(self, name: &'static str) -> Result<Self, FieldError> {
        self.only(name)?.ok_or_else(|| self.problem(name, "is missing"))
    }

    pub(crate) fn attribute(self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    pub(crate) fn needed_attribute(self, name: &str) -> Result<&'a str, FieldError> {
        self.attribute(name).ok_or_else(|| self.problem(name, "is missing"))
    }

    pub(crate) fn number(self, name: &str) -> Result<f64, FieldError> {
        self.parsed(name, self.needed_attribute(name)?.trim())
    }

    /// Three numbers with spaces between them; `None` without the attribute.
    pub(crate) fn triple(self, name: &str) -> Result<Option<[f64; 3]>, FieldError> {
        let Some(text) = self.attribute(name) else { return Ok(None) };
        let mut words = text.split_whitespace();
        let mut numbers = [0.0; 3];
        for number in &mut numbers {
            let word = words.next().ok_or_else(|| self.not_three(name, text))?;
            *number = self.parsed(name, word)?;
        }
        if words.next().is_some() { Err(self.not_three(name, text)) } else { Ok(Some(numbers)) }
    }

    /// The child `origin`; without it, or without one of its attributes, frames coincide.
    pub(crate) fn origin(self) -> Result<Frame, FieldError> {
        let Some(origin) = self.only("origin")? else { return Ok(Frame::IDENTITY) };
        let frame = || {
            if origin.attribute("quat_xyzw").is_some() {
                return Err(origin.problem("quat_xyzw", "is not read: give rpy"));
            }
            let position = origin.triple("xyz")?.map_or(DVec3::ZERO, DVec3::from_array);
            let orientation = origin.triple("rpy")?.map(from_roll_pitch_yaw);
            Ok(Frame { position, orientation: orientation.unwrap_or(Frame::IDENTITY.orientation) })
        };
        frame().map_err(|error: FieldError| error.inside("origin"))
    }

    pub(crate) fn problem(self, field: &str, problem: impl std::fmt::Display) -> FieldError {
        FieldError::new(field, format!("{problem}, at line {}", self.line()))
    }

    fn parsed(self, name: &str, word: &str) -> Result<f64, FieldError> {
        let number = word.parse().map_err(|_| self.problem(name, format_args!("{word:?} is not a number")))?;
        finite(name, number).map_err(|error| self.problem(name, error.problem))
    }

    fn not_three(self, name: &str, text: &str) -> FieldError {
        self.problem(name, format_args!("{text:?} is not three numbers with spaces between them"))
    }
}
