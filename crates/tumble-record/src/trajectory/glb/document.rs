//! The JSON of the file. What changes while a run goes on stands first, in fields of fixed width.

use std::io::{self, Seek, SeekFrom, Write};

use serde::Serialize;
use serde_json::{Value, json};

use crate::colors::{BODY_COLORS, FIXED_COLOR, GROUND_COLOR};
use crate::trajectory::glb::Animation;
use crate::trajectory::glb::bodies::{Bodies, Color, DrawnBody, Look};
use crate::trajectory::glb::geometry::Surface;
use crate::trajectory::glb::layout::Layout;

/// What the document begins with, up to the accessors of times and tracks.
const BEGINNING: &str = r#"{"accessors":["#;

/// Where the accessors of times and tracks begin in the file.
pub(crate) const ACCESSORS_AT: u64 = Layout::DOCUMENT_AT + BEGINNING.len() as u64;

/// Values of the specification.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The views of the buffer, by their index.
const VERTICES: u32 = 0;
const INDICES: u32 = 1;
const TIMES: u32 = 2;
const TRACKS: u32 = 3;

/// Writes the document to its place, with no frames, and spaces up to a multiple of four; its
/// length with these.
pub(crate) fn write(
    writer: &mut (impl Write + Seek),
    animation: &Animation,
    bodies: &Bodies,
    layout: &Layout,
) -> io::Result<u64> {
    writer.seek(SeekFrom::Start(Layout::DOCUMENT_AT))?;
    if bodies.len() == 0 {
        writer.write_all(b"{")?;
    } else {
        writer.write_all(BEGINNING.as_bytes())?;
        writer.write_all(&track_accessors(layout, 0, layout.first_time))?;
        for (index, accessor) in bodies.geometry.surfaces.iter().flat_map(surface_accessors).enumerate() {
            writer.write_all(if index == 0 && layout.moving == 0 { b"" } else { b"," })?;
            serde_json::to_writer(&mut *writer, &accessor)?;
        }
        writer.write_all(b"],")?;
        write_meshes(writer, &bodies.appearance, layout)?;
        list(writer, "nodes", bodies.all().iter().map(Node::of))?;
        writer.write_all(b",")?;
        if layout.moving > 0 {
            writer.write_all(br#""animations":[{"name":"motion","#)?;
            list(
                writer,
                "channels",
                bodies.all().iter().enumerate().filter(|(_, body)| body.moves).enumerate().flat_map(channels),
            )?;
            writer.write_all(b",")?;
            list(writer, "samplers", (0..2 * layout.moving).map(sampler))?;
            writer.write_all(b"}],")?;
        }
    }
    // The specification has no empty lists.
    let nodes: Option<Vec<u64>> = (bodies.len() > 0).then(|| (0..bodies.len()).collect());
    let scene = serde_json::to_string(&Scene { name: &animation.scene, nodes })?;
    write!(writer, r#""asset":{},"scene":0,"scenes":[{scene}]}}"#, asset(animation))?;
    let length = writer.stream_position()? - Layout::DOCUMENT_AT;
    let padded = length.next_multiple_of(4);
    writer.write_all(&b"   "[..(padded - length) as usize])?;
    Ok(padded)
}

/// The accessors of times and tracks, with the number of frames. The same length whatever the
/// numbers.
pub(crate) fn track_accessors(layout: &Layout, frames: u64, last_time: f32) -> Vec<u8> {
    let mut text = Vec::new();
    if layout.moving == 0 {
        return text;
    }
    let [first, last] = [layout.first_time, last_time].map(|time| zmij::Buffer::new().format(time).to_owned());
    // Sixteen characters hold every number in single precision, and ten every number of frames that
    // fits.
    let times = format!(
        r#"{{"bufferView":{TIMES},"componentType":{FLOAT},"count":{frames:>10},"type":"SCALAR","min":[{first}],"max":[{last:>16}]}}"#
    );
    text.extend_from_slice(times.as_bytes());
    for body in 0..layout.moving {
        let [translations, rotations] = layout.track(body);
        for (offset, kind) in [(translations, "VEC3"), (rotations, "VEC4")] {
            let track = format!(
                r#",{{"bufferView":{TRACKS},"byteOffset":{offset},"componentType":{FLOAT},"count":{frames:>10},"type":"{kind}"}}"#
            );
            text.extend_from_slice(track.as_bytes());
        }
    }
    text
}

fn asset(animation: &Animation) -> Value {
    json!({
        "version": "2.0",
        "generator": concat!("tumble ", env!("CARGO_PKG_VERSION")),
        "extras": { "scene": animation.scene, "dt": animation.dt, "every": animation.every },
    })
}

#[derive(Serialize)]
struct Scene<'a> {
    name: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    nodes: Option<Vec<u64>>,
}

#[derive(Serialize)]
struct Node<'a> {
    name: &'a str,
    mesh: usize,
    translation: [f32; 3],
    rotation: [f32; 4],
    scale: [f32; 3],
}

impl<'a> Node<'a> {
    fn of(body: &'a DrawnBody) -> Self {
        let (translation, rotation) = (body.sample.translation, body.sample.rotation);
        Self { name: &body.name, mesh: body.look, translation, rotation, scale: body.scale }
    }
}

/// Of the moving body with this number, which is that node.
fn channels((number, (node, _)): (usize, (usize, &DrawnBody))) -> [Value; 2] {
    let channel = |sampler: usize, path: &str| json!({ "sampler": sampler, "target": { "node": node, "path": path } });
    [channel(2 * number, "translation"), channel(2 * number + 1, "rotation")]
}

/// The accessor before the first track is that of the times.
fn sampler(track: u64) -> Value {
    json!({ "input": 0, "output": track + 1 })
}

/// Positions, normals and indices.
fn surface_accessors(surface: &Surface) -> [Value; 3] {
    let indices = if surface.is_small() { UNSIGNED_SHORT } else { UNSIGNED_INT };
    [
        json!({
            "bufferView": VERTICES, "byteOffset": surface.vertices_at, "componentType": FLOAT, "count": surface.vertices,
            "type": "VEC3", "min": surface.min, "max": surface.max,
        }),
        json!({
            "bufferView": VERTICES, "byteOffset": surface.normals_at(), "componentType": FLOAT, "count": surface.vertices,
            "type": "VEC3",
        }),
        json!({
            "bufferView": INDICES, "byteOffset": surface.indices_at, "componentType": indices, "count": surface.corners,
            "type": "SCALAR",
        }),
    ]
}

/// Meshes, a surface in a colour each, with their materials, and where all numbers lie.
fn write_meshes(writer: &mut impl Write, appearance: &[Look], layout: &Layout) -> io::Result<()> {
    let mut colors: Vec<Color> = Vec::new();
    let surfaces_from = if layout.moving > 0 { 1 + 2 * layout.moving as usize } else { 0 };
    let meshes = appearance.iter().map(|look| {
        let material = colors.iter().position(|color| *color == look.color).unwrap_or_else(|| {
            colors.push(look.color);
            colors.len() - 1
        });
        let positions = surfaces_from + 3 * look.surface;
        let attributes = json!({ "POSITION": positions, "NORMAL": positions + 1 });
        json!({ "primitives": [{ "attributes": attributes, "indices": positions + 2, "material": material }] })
    });
    list(writer, "meshes", meshes)?;
    writer.write_all(b",")?;
    list(writer, "materials", colors.into_iter().map(material))?;
    writer.write_all(b",")?;
    let mut views = vec![
        json!({ "buffer": 0, "byteLength": layout.vertex_bytes, "byteStride": 12, "target": ARRAY_BUFFER }),
        json!({
            "buffer": 0, "byteOffset": layout.vertex_bytes, "byteLength": layout.index_bytes, "target": ELEMENT_ARRAY_BUFFER,
        }),
    ];
    if layout.moving > 0 {
        views.push(json!({ "buffer": 0, "byteOffset": layout.times(), "byteLength": layout.time_bytes() }));
        views.push(json!({ "buffer": 0, "byteOffset": layout.tracks(), "byteLength": layout.track_bytes() }));
    }
    list(writer, "bufferViews", views.into_iter())?;
    writer.write_all(b",")?;
    list(writer, "buffers", std::iter::once(json!({ "byteLength": layout.buffer_bytes() })))?;
    writer.write_all(b",")
}

fn material(color: Color) -> Value {
    let [red, green, blue] = match color {
        Color::Grey => FIXED_COLOR,
        Color::Ground => GROUND_COLOR,
        Color::Bright(index) => BODY_COLORS.get(index).copied().unwrap_or(FIXED_COLOR),
    };
    json!({
        "pbrMetallicRoughness": { "baseColorFactor": [red, green, blue, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.6 },
    })
}

/// A list under its name, without holding it.
fn list(writer: &mut impl Write, name: &str, items: impl Iterator<Item = impl Serialize>) -> io::Result<()> {
    write!(writer, r#""{name}":["#)?;
    for (index, item) in items.enumerate() {
        writer.write_all(if index == 0 { b"" } else { b"," })?;
        serde_json::to_writer(&mut *writer, &item)?;
    }
    writer.write_all(b"]")
}
