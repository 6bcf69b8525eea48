//! Text and panels in front of the picture.

use std::cell::RefCell;
use std::collections::HashSet;

use macroquad::color::Color;
use macroquad::shapes::draw_rectangle;
use macroquad::text::{Font, TextParams, draw_text_ex, load_ttf_font_from_bytes};
use macroquad::window::screen_dpi_scale;
use tumble::glam::DVec2;

use crate::glyphs::{FONT, written};
use crate::layers::{LAYERS, Layer, Layers};
use crate::readout::Row;
use crate::sliders::{Panel, Slider};
use crate::timing::{FRAMES, FrameTime, FrameTimes, PARTS};

/// From one letter to the next, in sizes of the font.
const ADVANCE: f32 = 0.6;
const SIZE: f32 = 14.0;
const LABEL: f32 = 13.0;
const TITLE: f32 = 20.0;
/// From one letter of a panel to the next.
pub(crate) const LETTER: f32 = ADVANCE * SIZE;
pub(crate) const LINE: f32 = 18.0;
const MARGIN: f32 = 14.0;
pub(crate) const PADDING: f32 = 10.0;
/// Letters of a row's name and of the longest name that is shown.
const NAME: usize = 14;
const LONGEST: usize = 48;

const BRIGHT: [f32; 4] = [0.93, 0.95, 0.97, 1.0];
const PLAIN: [f32; 4] = [0.78, 0.81, 0.86, 1.0];
const DIM: [f32; 4] = [0.50, 0.54, 0.61, 1.0];
const GROOVE: [f32; 4] = [0.3, 0.33, 0.38, 1.0];
const PANEL: [f32; 4] = [0.03, 0.04, 0.06, 0.62];

/// Keys that are not those of layers.
pub(crate) const KEYS: [(&str, &str); 15] = [
    ("space", "pause"),
    (". ,", "step, step back"),
    ("+ -", "faster, slower"),
    ("R Q", "restart, quit"),
    ("PgDn PgUp", "next scene, before"),
    ("click Tab", "pick a body"),
    ("Shift drag", "grab and throw"),
    ("O", "shoot a ball"),
    ("arrows", "change settings"),
    ("P, drag", "settings by sliders"),
    ("C", "camera: follow, stay"),
    ("drag", "turn"),
    ("right drag", "shift"),
    ("wheel", "nearer, farther"),
    ("0 1 2 3", "views"),
];

/// Of the legend, with a blank one between the layers and the other keys.
const ROWS: usize = LAYERS.len() + 1 + KEYS.len();
/// Of the legend.
const LEGEND_WIDTH: f32 = 2.0 * PADDING + 31.0 * LETTER;
/// Where what is not at an edge begins.
const BESIDE: f32 = 2.0 * MARGIN + LEGEND_WIDTH;
/// A frame in the graph is so wide, and a millisecond so high, up to the most that are seen.
const BAR: f32 = 2.0;
const MILLISECOND: f32 = 2.4;
const MAX_MILLISECONDS: f32 = 40.0;
const ALARM: [f32; 4] = [1.0, 0.62, 0.50, 1.0];
/// Lines of a notice, and letters of each.
const NOTICE_LINES: usize = 4;
const NOTICE_LETTERS: usize = 60;
/// Where the legend begins, below the title and the time.
const LEGEND_TOP: f32 = MARGIN + 56.0;

/// Text at a place in the picture, and its colour.
pub(crate) type Label = (DVec2, String, [f32; 3]);

/// All that is written in a picture.
#[derive(Clone, Debug, Default)]
pub(crate) struct Overlay {
    pub(crate) title: String,
    pub(crate) status: String,
    pub(crate) layers: Layers,
    pub(crate) ledger: Vec<Row>,
    pub(crate) settings: Vec<Slider>,
    pub(crate) body: Vec<Row>,
    pub(crate) labels: Vec<Label>,
    /// What went wrong.
    pub(crate) notice: Option<String>,
    pub(crate) times: FrameTimes,
}

impl Overlay {
    /// Where the sliders are in a picture of this size in points, if they are shown.
    pub(crate) fn panel(&self, size: DVec2) -> Option<Panel> {
        let below = if self.ledger.is_empty() { 0.0 } else { Pen::height(self.ledger.len()) + MARGIN };
        let panel = Panel::new(size.x as f32 - MARGIN, MARGIN + below, self.settings.len());
        (panel.rows > 0).then_some(panel)
    }
}

/// Writes with the window's font.
#[derive(Debug)]
pub(crate) struct Writer {
    font: Font,
    /// Letters that are there, and the pixels per point for which they are.
    prepared: RefCell<(f32, HashSet<char>)>,
}

impl Writer {
    pub(crate) fn new() -> Result<Self, String> {
        let font = load_ttf_font_from_bytes(FONT).map_err(|error| format!("the font cannot be used: {error}"))?;
        Ok(Self { font, prepared: RefCell::default() })
    }

    /// Makes all letters in all sizes. A letter that comes when others have been written in the
    /// same picture may take the place of theirs.
    fn prepare(&self, overlay: &Overlay, pixels_per_point: f32) {
        let (scale, there) = &mut *self.prepared.borrow_mut();
        let all = pixels_per_point * screen_dpi_scale();
        if std::mem::replace(scale, all) != all {
            there.clear();
        }
        let names = overlay.labels.iter().map(|label| &label.1).chain(overlay.body.iter().map(|row| &row.0));
        let names = names.chain(overlay.ledger.iter().map(|row| &row.0)).chain([&overlay.title]);
        let names = names.chain(&overlay.notice);
        let mut letters: String = (' '..='~').chain("²³µ·×−…ω□".chars()).collect();
        names.for_each(|name| letters.push_str(&written(name)));
        let letters: Vec<char> = letters.chars().filter(|&letter| there.insert(letter)).collect();
        if !letters.is_empty() {
            for size in [LABEL, SIZE, TITLE] {
                let asked = (size * pixels_per_point).round() * screen_dpi_scale();
                self.font.populate_font_cache(&letters, asked.ceil() as u16);
            }
        }
    }

    /// Draws onto a picture of this size in points, of this many pixels each.
    pub(crate) fn draw(&self, overlay: &Overlay, size: DVec2, pixels_per_point: f32) {
        self.prepare(overlay, pixels_per_point);
        let pen = Pen { font: &self.font, pixels_per_point };
        for (at, text, color) in apart(&overlay.labels) {
            let [red, green, blue] = *color;
            pen.text(at.x as f32, at.y as f32, LABEL, [red, green, blue, 0.95], text);
        }
        // Who asks for nothing wants nothing.
        if overlay.layers != Layers::default() {
            pen.text(MARGIN, MARGIN + 16.0, TITLE, BRIGHT, &shortened(&overlay.title));
            pen.text(MARGIN, MARGIN + 38.0, SIZE, PLAIN, &overlay.status);
        }
        if overlay.layers.has(Layer::Legend) {
            pen.legend(overlay.layers, LEGEND_TOP, size.y as f32);
        }
        let [right, bottom] = [size.x, size.y].map(|edge| edge as f32 - MARGIN);
        pen.table(&overlay.ledger, right, MARGIN);
        if let Some(panel) = overlay.panel(size) {
            pen.sliders(&overlay.settings, &panel);
        }
        if overlay.layers.has(Layer::Times) && overlay.times.frames().len() > 0 {
            let left = if overlay.layers.has(Layer::Legend) { BESIDE } else { MARGIN };
            pen.times(&overlay.times, left, bottom);
        }
        if let Some(notice) = &overlay.notice {
            pen.notice(notice);
        }
        pen.table(&overlay.body, right, bottom - Pen::height(overlay.body.len()));
    }
}

struct Pen<'a> {
    font: &'a Font,
    pixels_per_point: f32,
}

impl Pen<'_> {
    fn text(&self, x: f32, y: f32, size: f32, color: [f32; 4], text: &str) {
        let params = TextParams {
            font: Some(self.font),
            font_size: (size * self.pixels_per_point).round() as u16,
            font_scale: 1.0 / self.pixels_per_point,
            color: Color::from(color),
            ..TextParams::default()
        };
        draw_text_ex(written(text), x, y, params);
    }

    /// Of a panel with this many rows.
    fn height(rows: usize) -> f32 {
        2.0 * PADDING + LINE * rows as f32
    }

    fn panel(&self, x: f32, y: f32, width: f32, height: f32) {
        draw_rectangle(x, y, width, height, Color::from(PANEL));
    }

    /// The layers with their keys and colours, and the other keys below, or beside where there is
    /// no room.
    fn legend(&self, layers: Layers, top: f32, bottom: f32) {
        let has_room = top + Self::height(ROWS) + MARGIN <= bottom;
        let rows = if has_room { ROWS } else { LAYERS.len() };
        self.panel(MARGIN, top, LEGEND_WIDTH, Self::height(rows));
        let (x, mut y) = (MARGIN + PADDING, top + PADDING + 14.0);
        for info in &LAYERS {
            let on = layers.has(info.layer);
            let [red, green, blue] = info.color;
            let color = if on { [red, green, blue, 1.0] } else { DIM };
            self.text(x, y, SIZE, if on { BRIGHT } else { DIM }, &info.letter.to_string());
            draw_rectangle(x + 18.0, y - 6.0, 12.0, 3.0, Color::from(if on { color } else { GROOVE }));
            self.text(x + 38.0, y, SIZE, if on { color } else { DIM }, info.title);
            y += LINE;
        }
        if has_room {
            self.keys(x, y + LINE);
        } else {
            self.panel(BESIDE, top, LEGEND_WIDTH, Self::height(KEYS.len()));
            self.keys(BESIDE + PADDING, top + PADDING + 14.0);
        }
    }

    fn keys(&self, x: f32, mut y: f32) {
        for (key, what) in KEYS {
            self.text(x, y, SIZE, PLAIN, key);
            self.text(x + 11.0 * LETTER, y, SIZE, DIM, what);
            y += LINE;
        }
    }

    /// The graph of the last frames, with the means of its parts beside.
    fn times(&self, times: &FrameTimes, left: f32, bottom: f32) {
        let (graph, high) = (FRAMES as f32 * BAR, MAX_MILLISECONDS * MILLISECOND);
        let figures = 19.0 * LETTER;
        let height = Self::height(PARTS.len() + 1).max(high + 2.0 * PADDING);
        let top = bottom - height;
        self.panel(left, top, graph + figures + 3.0 * PADDING, height);
        let floor = bottom - PADDING;
        for (index, frame) in times.frames().enumerate() {
            let x = left + PADDING + index as f32 * BAR;
            for ([from, to], (_, color)) in stacked(frame).into_iter().zip(PARTS) {
                let [red, green, blue] = color;
                draw_rectangle(x, floor - to, BAR, to - from, Color::from([red, green, blue, 0.9]));
            }
        }
        // A sixtieth of a second.
        draw_rectangle(left + PADDING, floor - MILLISECOND * 1000.0 / 60.0, graph, 1.0, Color::from(BRIGHT));
        let (x, mut y) = (left + graph + 2.0 * PADDING, top + PADDING + 14.0);
        let mean = times.mean();
        let all = [("frame", [0.93, 0.95, 0.97], mean.iter().sum::<f32>())];
        for (name, [red, green, blue], value) in
            all.into_iter().chain(PARTS.iter().zip(mean).map(|((name, color), value)| (*name, *color, value)))
        {
            self.text(x, y, SIZE, [red, green, blue, 1.0], &format!("{name:<9}{value:7.2} ms"));
            y += LINE;
        }
    }

    /// What went wrong, between the panels.
    fn notice(&self, text: &str) {
        let lines = in_lines(text);
        let widest = lines.iter().map(|line| line.chars().count()).max().unwrap_or(0);
        let width = 2.0 * PADDING + widest as f32 * LETTER;
        self.panel(BESIDE, MARGIN, width, Self::height(lines.len()));
        for (index, line) in lines.iter().enumerate() {
            self.text(BESIDE + PADDING, MARGIN + PADDING + 14.0 + LINE * index as f32, SIZE, ALARM, line);
        }
    }

    /// Settings with a slider each; of the chosen one, the keys that change it.
    fn sliders(&self, sliders: &[Slider], panel: &Panel) {
        self.panel(panel.left, panel.top, Panel::WIDTH, panel.height());
        let [left, right] = panel.track();
        for (row, slider) in sliders.iter().enumerate() {
            let (top, thumb) = (panel.row(row), panel.across(slider.place));
            let [name, value] = if slider.is_chosen { [BRIGHT; 2] } else { [DIM, PLAIN] };
            let text = |letters: f32, color: [f32; 4], text: &str| {
                self.text(panel.column(letters), top + 14.0, SIZE, color, text);
            };
            text(0.0, name, slider.name);
            text(35.0, value, &slider.value);
            if slider.is_chosen {
                text(14.0, BRIGHT, "<-");
                text(32.0, BRIGHT, "->");
            }
            let middle = top + 9.0;
            draw_rectangle(left, middle - 1.5, right - left, 3.0, Color::from(GROOVE));
            draw_rectangle(left, middle - 1.5, thumb - left, 3.0, Color::from(DIM));
            draw_rectangle(thumb - 3.5, middle - 6.0, 7.0, 12.0, Color::from(value));
        }
    }

    /// Rows in a panel at the right edge.
    fn table(&self, rows: &[Row], right: f32, top: f32) {
        if rows.is_empty() {
            return;
        }
        let letters = |(name, figure): &Row| {
            if figure.is_empty() { shortened(name).chars().count() } else { NAME + figure.trim_end().chars().count() }
        };
        let widest = rows.iter().map(letters).max().unwrap_or(0).max(30);
        let width = 2.0 * PADDING + widest as f32 * LETTER;
        let left = right - width;
        self.panel(left, top, width, Self::height(rows.len()));
        let (x, mut y) = (left + PADDING, top + PADDING + 14.0);
        for (name, figure) in rows {
            let color = if figure.is_empty() { BRIGHT } else { DIM };
            self.text(x, y, SIZE, color, &shortened(name));
            self.text(x + NAME as f32 * LETTER, y, SIZE, PLAIN, figure.trim_end());
            y += LINE;
        }
    }
}

/// Where the parts of a frame begin and end above the floor of the graph; what is higher than it is
/// cut off.
fn stacked(frame: &FrameTime) -> [[f32; 2]; PARTS.len()] {
    let mut sum = 0.0_f32;
    frame.map(|part| {
        let from = sum.min(MAX_MILLISECONDS);
        sum += part;
        [from, sum.min(MAX_MILLISECONDS)].map(|edge| edge * MILLISECOND)
    })
}

/// A text in a few lines; what is longer ends with dots.
fn in_lines(text: &str) -> Vec<String> {
    let letters: Vec<char> = text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    let mut lines: Vec<String> =
        letters.chunks(NOTICE_LETTERS).take(NOTICE_LINES).map(|line| line.iter().collect()).collect();
    if letters.len() > NOTICE_LINES * NOTICE_LETTERS
        && let Some(last) = lines.last_mut()
    {
        last.push('…');
    }
    lines
}

/// Labels that do not cover one that comes before them.
fn apart(labels: &[Label]) -> Vec<&Label> {
    let mut kept: Vec<&Label> = Vec::new();
    let width = |label: &Label| f64::from(LABEL * ADVANCE) * label.1.chars().count() as f64;
    let covers = |a: &Label, b: &Label| {
        let by = (a.0 - b.0).abs();
        by.y < f64::from(LABEL) && by.x < if a.0.x < b.0.x { width(a) } else { width(b) }
    };
    for label in labels {
        if !kept.iter().any(|other| covers(label, other)) {
            kept.push(label);
        }
    }
    kept
}

/// Names come from files and may be of any length.
fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_labels_that_cover_each_other_the_first_is_kept() {
        let label = |x: f64, y: f64, text: &str| (DVec2::new(x, y), text.to_owned(), [1.0; 3]);
        let labels =
            [label(0.0, 0.0, "venus"), label(20.0, 5.0, "sun"), label(50.0, 5.0, "earth"), label(0.0, 20.0, "mars")];
        let kept: Vec<&str> = apart(&labels).into_iter().map(|(_, text, _)| text.as_str()).collect();
        assert_eq!(kept, ["venus", "earth", "mars"]);
    }

    /// As high as the window at the start, and as the pictures of `docs/window.md`.
    #[test]
    fn there_is_room_for_all_keys() {
        assert!(LEGEND_TOP + Pen::height(ROWS) + MARGIN <= 720.0);
        assert!(LEGEND_TOP + Pen::height(LAYERS.len().max(KEYS.len())) + MARGIN <= 540.0);
    }

    #[test]
    fn parts_of_a_frame_stand_on_each_other() {
        let parts = stacked(&[1.0, 0.0, 2.0, 100.0, 5.0, 1.0]);
        let at = |milliseconds: f32| milliseconds * MILLISECOND;
        let top = at(MAX_MILLISECONDS);
        assert_eq!(parts[..3], [[0.0, at(1.0)], [at(1.0), at(1.0)], [at(1.0), at(3.0)]]);
        assert_eq!(parts[3..], [[at(3.0), top], [top, top], [top, top]]);
    }

    #[test]
    fn a_long_notice_is_cut_off() {
        assert_eq!(in_lines("a\nb"), ["a b"]);
        let lines = in_lines(&"é".repeat(1000));
        assert_eq!((lines.len(), lines[0].chars().count()), (NOTICE_LINES, NOTICE_LETTERS));
        assert!(lines[NOTICE_LINES - 1].ends_with('…'));
    }

    #[test]
    fn long_names_are_shortened() {
        assert_eq!(shortened("raft"), "raft");
        assert_eq!(shortened(&"é".repeat(100)).chars().count(), LONGEST + 1);
    }
}
