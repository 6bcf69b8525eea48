//! Lines and letters in the world, collected for one picture.

use tumble::DebugDraw;
use tumble::glam::DVec3;
use tumble::math::Vec3;

use crate::convert::dvec3;

/// Width of what is drawn for the engine \[points\].
const WIDTH: f32 = 2.0;

/// A line whose colour may change along it. Colours are red, green, blue as displays take them, and
/// opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    /// \[m\]
    pub(crate) from: DVec3,
    pub(crate) to: DVec3,
    pub(crate) from_color: [f32; 4],
    pub(crate) to_color: [f32; 4],
    /// \[points\]
    pub(crate) width: f32,
}

/// A few letters at a place in the world.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Label {
    /// \[m\]
    pub(crate) at: DVec3,
    pub(crate) text: String,
    pub(crate) color: [f32; 3],
}

/// What the engine's [`DebugView`](tumble::DebugView) draws.
#[derive(Debug, Default)]
pub(crate) struct Marks {
    pub(crate) lines: Vec<Line>,
    pub(crate) labels: Vec<Label>,
}

impl DebugDraw for Marks {
    fn line(&mut self, from: Vec3, to: Vec3, color: [f32; 3]) {
        let color = opaque(color);
        self.lines.push(Line { from: dvec3(from), to: dvec3(to), from_color: color, to_color: color, width: WIDTH });
    }

    fn text(&mut self, at: Vec3, text: &str, color: [f32; 3]) {
        self.labels.push(Label { at: dvec3(at), text: text.to_owned(), color });
    }
}

pub(crate) fn opaque([red, green, blue]: [f32; 3]) -> [f32; 4] {
    [red, green, blue, 1.0]
}

/// A colour in linear light as displays take it.
pub(crate) fn encoded(linear: [f32; 3]) -> [f32; 3] {
    linear.map(|part| part.max(0.0).powf(1.0 / 2.2))
}
