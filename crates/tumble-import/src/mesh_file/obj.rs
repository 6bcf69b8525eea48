//! Wavefront OBJ: vertices and faces.
//!
//! Faces with more than three corners are cut into a fan from their first. A flat face that is not
//! convex is then covered more than once in places, once with each sign: volume and moments are
//! those of the face, only its picture is not.

use std::collections::BTreeMap;

use crate::mesh_file::{Surface, position};

/// Statements that say nothing of the surface and are nothing to speak of.
const SILENT: [&str; 5] = ["vt", "vn", "o", "g", "s"];

/// Statements that are reported as ignored; what is none of these either is reported as one kind.
const TOLD: [&str; 10] = ["mtllib", "usemtl", "p", "l", "vp", "curv", "curv2", "surf", "cstype", "usemap"];

/// The surface, or what is wrong and in which line.
pub(crate) fn read(bytes: &[u8]) -> Result<Surface, String> {
    // Names and comments may be in any encoding.
    let text = String::from_utf8_lossy(bytes);
    let mut reader = Reader::default();
    // Editors on Windows put a byte-order mark in front.
    let mut lines = text.strip_prefix('\u{feff}').unwrap_or(&text).lines().enumerate();
    let mut long = String::new();
    while let Some((number, line)) = lines.next() {
        let comment = line.trim_start().starts_with('#');
        let statement = if line.ends_with('\\') && !comment {
            long.clear();
            continued(line, &mut lines, &mut long);
            long.as_str()
        } else {
            line
        };
        reader.statement(statement, number + 1).map_err(|problem| format!("{problem}, at line {}", number + 1))?;
    }
    reader.finish()
}

/// A line that goes on in the next ones.
fn continued<'a>(line: &'a str, lines: &mut impl Iterator<Item = (usize, &'a str)>, long: &mut String) {
    let mut line = line;
    while let Some(begun) = line.strip_suffix('\\') {
        long.push_str(begun);
        long.push(' ');
        line = lines.next().map_or("", |(_, line)| line);
    }
    long.push_str(line);
}

#[derive(Default)]
struct Reader {
    surface: Surface,
    /// Largest index of a vertex, from 0, and the line that has it: vertices may stand after the
    /// faces.
    largest: Option<(u32, usize)>,
    left_out: BTreeMap<&'static str, usize>,
}

impl Reader {
    fn statement(&mut self, statement: &str, line: usize) -> Result<(), String> {
        let mut words = statement.split_whitespace().take_while(|word| !word.starts_with('#'));
        let Some(keyword) = words.next() else { return Ok(()) };
        match keyword {
            // A weight or a colour may stand behind the coordinates.
            "v" => self.surface.add_vertex(position(words)?),
            "f" | "fo" => self.face(words, line),
            _ if SILENT.contains(&keyword) => Ok(()),
            _ => {
                let told = TOLD.into_iter().find(|told| *told == keyword).unwrap_or("other");
                *self.left_out.entry(told).or_default() += 1;
                Ok(())
            }
        }
    }

    fn face<'a>(&mut self, mut words: impl Iterator<Item = &'a str>, line: usize) -> Result<(), String> {
        let mut next = || words.next().map(|word| self.surface.index(word)).transpose();
        let (Some(first), Some(mut second)) = (next()?, next()?) else {
            return Err("a face has three corners at least".into());
        };
        let mut largest = first.max(second);
        let mut triangles = 0;
        for word in words {
            let third = self.surface.index(word)?;
            self.surface.add_triangle([first, second, third])?;
            (second, largest, triangles) = (third, largest.max(third), triangles + 1);
        }
        if triangles == 0 {
            return Err("a face has three corners at least".into());
        }
        if self.largest.is_none_or(|(known, _)| known < largest) {
            self.largest = Some((largest, line));
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Surface, String> {
        let vertices = self.surface.positions.len();
        if let Some((largest, line)) = self.largest.filter(|(largest, _)| *largest as usize >= vertices) {
            let named = u64::from(largest) + 1;
            return Err(format!("a face names vertex {named}, but there are only {vertices}, at line {line}"));
        }
        if !self.left_out.is_empty() {
            let each: Vec<String> =
                self.left_out.iter().map(|(keyword, count)| format!("{keyword} ({count})")).collect();
            self.surface.notices.push(format!("statements not read: {}", each.join(", ")));
        }
        Ok(self.surface)
    }
}

impl Surface {
    /// The vertex of a face's corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, from 0. Numbers count from
    /// 1, negative ones back from the last vertex.
    fn index(&self, corner: &str) -> Result<u32, String> {
        let word = corner.split('/').next().unwrap_or_default();
        let number: i64 = word.parse().map_err(|_| format!("{corner:?} is no corner of a face"))?;
        let index = if number < 0 {
            i64::try_from(self.positions.len()).ok().map(|count| count + number)
        } else {
            Some(number - 1)
        };
        let index = index.and_then(|index| u32::try_from(index).ok());
        index.ok_or_else(|| format!("a face names vertex {number}, after {} vertices", self.positions.len()))
    }
}
