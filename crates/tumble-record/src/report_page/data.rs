//! What the script of the page is given.

use std::io::{self, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::colors::{BODY_COLORS, FIXED_COLOR, GROUND_COLOR};
use crate::report_page::frames::MAX_EXACT;
use crate::report_page::joints::DrawnJoint;
use crate::report_page::replay::{Replay, Shown};
use crate::report_page::surfaces::{arrays, is_wide};
use crate::trajectory::glb::bodies::Color;

/// Longest name of a body that is shown \[characters\].
const LONGEST_NAME: usize = 60;

/// The object that the script reads. Arrays are base64 of little-endian numbers.
#[derive(Default, Serialize)]
struct Data<'a> {
    /// The direction up.
    up: [u8; 3],
    /// In linear light: those of bodies that move, then that of those that do not, then that of
    /// ground.
    colors: Vec<[f32; 3]>,
    surfaces: Vec<SurfaceData>,
    bodies: Vec<BodyData>,
    /// \[s\]
    times: Vec<f64>,
    /// Of each body the lowest position and how far it gets from there \[m\], where positions are
    /// parts of that in 16 bits; empty where they are in metres.
    ways: String,
    positions: String,
    rotations: String,
    joints: &'a [DrawnJoint],
}

#[derive(Serialize)]
struct SurfaceData {
    /// The lowest and the highest corner of the box around it.
    r#box: [[f32; 3]; 2],
    positions: String,
    normals: String,
    indices: String,
    corners: usize,
    /// Whether indices have 32 bits.
    wide: bool,
}

#[derive(Serialize)]
struct BodyData {
    name: String,
    surface: usize,
    color: usize,
    scale: [f32; 3],
    moves: bool,
    /// Whether it is seen only from where its y axis points.
    one_sided: bool,
}

/// Writes the data as JSON that may stand in an element of a page.
pub(crate) fn write(replay: &Replay, to: &mut impl Write) -> io::Result<()> {
    let mut data =
        Data { colors: BODY_COLORS.iter().copied().chain([FIXED_COLOR, GROUND_COLOR]).collect(), ..Data::default() };
    if let Some(up) = data.up.get_mut(replay.up()) {
        *up = 1;
    }
    if let Some(shown) = replay.parts() {
        data.fill(shown);
    }
    // Outside strings JSON has no such character, and inside one this is another way to write it:
    // no element ends here.
    to.write_all(serde_json::to_string(&data)?.replace('<', "\\u003c").as_bytes())
}

impl<'a> Data<'a> {
    fn fill(&mut self, Shown { bodies, surfaces, frames, joints }: &'a Shown) {
        for (index, surface) in bodies.geometry.surfaces.iter().enumerate() {
            let triangles = surfaces.triangles(index, surface);
            let [positions, normals, indices] = arrays(&triangles).map(|bytes| STANDARD.encode(bytes));
            let (corners, wide) = (3 * triangles.triangles.len(), is_wide(&triangles));
            let r#box = [surface.min, surface.max];
            self.surfaces.push(SurfaceData { r#box, positions, normals, indices, corners, wide });
        }
        for body in bodies.all() {
            let Some(look) = bodies.appearance.get(body.look) else { continue };
            self.bodies.push(BodyData {
                name: body.name.chars().take(LONGEST_NAME).collect(),
                surface: look.surface,
                color: match look.color {
                    Color::Bright(color) => color,
                    Color::Grey => BODY_COLORS.len(),
                    Color::Ground => BODY_COLORS.len() + 1,
                },
                scale: body.scale,
                moves: body.moves,
                one_sided: body.one_sided,
            });
        }
        self.joints = &joints.shown;
        self.times.clone_from(&frames.times);
        let count = bodies.all().len();
        if count > MAX_EXACT {
            let ways: Vec<[[f32; 3]; 2]> = (0..count).map(|body| frames.way(body)).collect();
            let places = frames.positions.chunks_exact(3).zip(ways.iter().cycle());
            self.positions =
                encoded(places.flat_map(|(place, way)| part_of_way(place, way)).flat_map(u16::to_le_bytes));
            self.ways = encoded(ways.into_iter().flatten().flatten().flat_map(f32::to_le_bytes));
        } else {
            self.positions = encoded(frames.positions.iter().flat_map(|number| number.to_le_bytes()));
        }
        self.rotations = encoded(frames.rotations.iter().flat_map(|number| number.to_le_bytes()));
    }
}

/// A place as a part of a way, in 16 bits.
fn part_of_way(place: &[f32], [low, size]: &[[f32; 3]; 2]) -> [u16; 3] {
    let mut parts = [0; 3];
    for (part, ((place, low), size)) in parts.iter_mut().zip(place.iter().zip(low).zip(size)) {
        let whole = f64::from(u16::MAX);
        *part = if *size > 0.0 { (f64::from(place - low) / f64::from(*size) * whole).round() as u16 } else { 0 };
    }
    parts
}

fn encoded(bytes: impl Iterator<Item = u8>) -> String {
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}
