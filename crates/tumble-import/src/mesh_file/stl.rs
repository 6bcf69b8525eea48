//! STL, binary and as text: triangles without shared vertices.

use glam::DVec3;

use crate::mesh_file::{Surface, position};

/// Bytes of the header of a binary file, which may say anything, and of the count behind it.
const HEADER: usize = 80;
const COUNT: usize = 4;
/// Bytes of a triangle: a normal and three corners in single precision, and two bytes that mean
/// nothing.
const TRIANGLE: usize = 50;

/// The surface, or what is wrong and in which line.
///
/// A file that is as long as its count says is binary, whatever its header begins with; programs
/// write `solid` there too.
pub(crate) fn read(bytes: &[u8]) -> Result<Surface, String> {
    let begins = bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let counted = bytes.get(HEADER..HEADER + COUNT).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let expected = counted.map(|count| HEADER as u64 + COUNT as u64 + u64::from(count) * TRIANGLE as u64);
    let length = bytes.len() as u64;
    match (counted, expected) {
        (Some(_), Some(expected)) if expected == length => binary(bytes, 0),
        _ if begins => text(&String::from_utf8_lossy(bytes)),
        (Some(_), Some(expected)) if expected < length => {
            binary(bytes.get(..expected as usize).unwrap_or(bytes), length - expected)
        }
        (Some(count), Some(expected)) => Err(format!(
            "the file says that it has {count} triangles, which take {expected} bytes, but it has {length}"
        )),
        _ => Err(format!(
            "neither text that begins with \"solid\" nor long enough for the header of a binary file: {length} bytes"
        )),
    }
}

fn binary(bytes: &[u8], superfluous: u64) -> Result<Surface, String> {
    let mut surface = Surface::default();
    for triangle in bytes.get(HEADER + COUNT..).unwrap_or_default().chunks_exact(TRIANGLE) {
        let mut numbers = triangle.as_chunks::<4>().0.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes)));
        let mut vector = || DVec3::from_array(std::array::from_fn(|_| numbers.next().unwrap_or_default()));
        let [_normal, a, b, c] = std::array::from_fn(|_| vector());
        add(&mut surface, [a, b, c])?;
    }
    if superfluous > 0 {
        surface.notices.push(format!("{superfluous} bytes behind the last triangle not read"));
    }
    Ok(surface)
}

/// Facet by facet, all solids of a file as one. Of each facet only the corners count.
fn text(text: &str) -> Result<Surface, String> {
    let mut surface = Surface::default();
    let mut corners: Vec<DVec3> = Vec::with_capacity(4);
    let mut solids = 0_usize;
    for (number, line) in text.lines().enumerate() {
        let located = |problem: String| format!("{problem}, at line {}", number + 1);
        let mut words = line.split_whitespace();
        let Some(keyword) = words.next() else { continue };
        match keyword.to_ascii_lowercase().as_str() {
            "vertex" if corners.len() == 3 => return Err(located("a facet has three corners".into())),
            "vertex" => corners.push(position(words).map_err(located)?),
            "endloop" => {
                let [a, b, c] = corners[..] else {
                    return Err(located(format!("a facet has three corners, this one {}", corners.len())));
                };
                add(&mut surface, [a, b, c]).map_err(located)?;
                corners.clear();
            }
            "solid" if corners.is_empty() => solids += 1,
            "facet" | "outer" | "endfacet" | "endsolid" if corners.is_empty() => {}
            _ => return Err(located(format!("{keyword:?} does not belong there"))),
        }
    }
    if !corners.is_empty() {
        return Err("the file ends in the middle of a facet".into());
    }
    if solids > 1 {
        surface.notices.push(format!("{solids} solids read as one body"));
    }
    Ok(surface)
}

fn add(surface: &mut Surface, corners: [DVec3; 3]) -> Result<(), String> {
    // Counts are limited far below 32 bits.
    let first = surface.positions.len() as u32;
    for corner in corners {
        surface.add_vertex(corner)?;
    }
    surface.add_triangle([first, first + 1, first + 2])
}
