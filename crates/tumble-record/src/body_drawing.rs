//! A picture of a body: its surface, its centre of mass, its principal axes and the ellipsoid of
//! the same mass and moments.

pub(crate) mod camera;
pub(crate) mod surface;

use glam::{DQuat, DVec3};

use tumble::equivalent_ellipsoid;
use tumble_scene::{AuditedBody, Up};

use crate::svg::{escaped, opening, put};

use crate::body_drawing::camera::Camera;
use crate::body_drawing::surface::{SHADES, Surface};

const WIDTH: f64 = 800.0;
const HEIGHT: f64 = 560.0;
/// The part of the picture that the body has.
const ACROSS: [f64; 2] = [56.0, 520.0];
const DOWN: [f64; 2] = [84.0, HEIGHT - 92.0];
/// Where the figures stand, and how many characters fit there.
const FIGURES: f64 = 568.0;
const COLUMN: usize = 31;
const LINE: f64 = 19.0;
/// By how much axes reach further than the furthest point of the surface along them.
const BEYOND: f64 = 1.18;
/// Points of an ellipse.
const AROUND: usize = 72;
/// Labels at the ends of axes are kept so far apart.
const APART: f64 = 17.0;
/// Coordinates below this part of the body's size are shown as zero.
const NOTHING: f64 = 1e-12;
/// Longest title \[characters\], and most problems that are listed.
const TITLE: usize = 72;
const MAX_PROBLEMS: usize = 4;

/// Light and dark colours of the surface's darkest and lightest shade.
const DARKEST: [[f64; 3]; 2] = [[62.0, 92.0, 122.0], [38.0, 58.0, 80.0]];
const LIGHTEST: [[f64; 3]; 2] = [[214.0, 228.0, 240.0], [128.0, 164.0, 196.0]];
/// Light and dark colours of the three axes, told apart by all kinds of eyes (M. Okabe, K. Ito,
/// 2002).
const AXES: [(&str, &str); 3] = [("#c64a00", "#ff8a3d"), ("#007a58", "#2fc79b"), ("#0066a6", "#6cb8ee")];
const STYLE: &str = "text{font:13px system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif;fill:#333}\
.title{font-size:16px;font-weight:600}.small{font-size:12px}.head{font-weight:600}.ground{fill:#fff}.bar{stroke:#333;fill:none;stroke-width:1.5}\
.end{font-weight:700;paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}.halo{stroke:#fff;stroke-width:5;stroke-linecap:round;opacity:.7}\
.axis{stroke-width:2.4;stroke-linecap:round;fill:none}.frame{stroke:#777;fill:none;stroke-width:1.2}\
.ellipsoid{fill:#b07d00;fill-opacity:.16;stroke:#8a6100;stroke-width:1.6}.ring{fill:none;stroke:#8a6100;stroke-width:.9;stroke-dasharray:4 3}\
.center{fill:#fff;stroke:#222;stroke-width:1.4}.quarter{fill:#222}";
const STYLE_IN_THE_DARK: &str = "text{fill:#ddd}.ground{fill:#15181c}.bar{stroke:#ddd}.end,.halo{stroke:#15181c}.frame{stroke:#999}\
.ellipsoid{fill:#e6b422;stroke:#e6b422}.ring{stroke:#e6b422}.center{fill:#15181c;stroke:#eee}.quarter{fill:#eee}";

/// A picture of a body as SVG, readable on light and dark grounds: its surface, half transparent,
/// with the centre of mass, the principal axes and the homogeneous ellipsoid of the same mass and
/// moments, whose semi-axes are `sqrt(5/2 (I_j + I_k - I_i) / m)`. Of a body with problems only the
/// surface is drawn, if there is one, and the problems are listed.
///
/// ```
/// let audit = tumble_scene::Audit::open("t-handle")?;
/// assert!(tumble_record::body_drawing(&audit.bodies[0]).starts_with("<svg"));
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[must_use]
pub fn body_drawing(body: &AuditedBody) -> String {
    let surface = body.appearance.as_ref().map(|(appearance, _)| Surface::of(appearance)).unwrap_or_default();
    let up = body.appearance.as_ref().map_or(Up::Y, |(_, up)| *up);
    Portrait::new(body, surface, up).to_svg()
}

/// What is drawn, in units that keep squares of lengths far from overflow.
struct Portrait<'a> {
    body: &'a AuditedBody,
    surface: Surface,
    matter: Option<Matter>,
    /// A unit of the picture's lengths \[m\].
    unit: f64,
    camera: Camera,
}

/// Where the mass is.
#[derive(Clone, Copy)]
struct Matter {
    center: DVec3,
    /// Columns: the principal axes.
    axes: [DVec3; 3],
    /// Of the ellipsoid.
    semi_axes: DVec3,
    /// How far each axis is drawn, against its direction and along it.
    reach: [[f64; 2]; 3],
}

impl<'a> Portrait<'a> {
    fn new(body: &'a AuditedBody, mut surface: Surface, up: Up) -> Self {
        let mut matter = Matter::of(body);
        let largest =
            |points: &mut dyn Iterator<Item = DVec3>| points.map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let ends = matter.iter().flat_map(|matter| [matter.center, matter.semi_axes]);
        let unit = largest(&mut surface.positions.iter().copied().chain(ends));
        let unit = if unit > 0.0 && unit.is_finite() { unit } else { 1.0 };
        for position in &mut surface.positions {
            *position /= unit;
        }
        if let Some(matter) = &mut matter {
            matter.center /= unit;
            matter.semi_axes /= unit;
            matter.reach_beyond(&surface.positions);
        }
        let ends = matter.iter().flat_map(Matter::outline);
        let camera = Camera::for_points(surface.positions.iter().copied().chain(ends), up, ACROSS, DOWN);
        Self { body, surface, matter, unit, camera }
    }

    fn to_svg(&self) -> String {
        let name: String = self.body.name.chars().take(TITLE).collect();
        let mut svg = opening([WIDTH, HEIGHT], &name, [28.0, 36.0], (&style(), None));
        let [backs, fronts] = self.surface.draw(&self.camera);
        put(&mut svg, format_args!("<g opacity=\".6\">\n{backs}</g>\n"));
        if let Some(matter) = &self.matter {
            self.draw_ellipsoid(&mut svg, matter);
        }
        // One transparency for all of them: where they lie over one another, only the nearest
        // shows.
        put(&mut svg, format_args!("<g opacity=\".6\">\n{fronts}</g>\n"));
        if let Some(matter) = &self.matter {
            self.draw_axes(&mut svg, matter);
        }
        self.draw_bar(&mut svg);
        self.draw_frame(&mut svg);
        self.draw_figures(&mut svg);
        svg.push_str("</svg>\n");
        svg
    }

    /// The outline, and the sections through two axes each.
    fn draw_ellipsoid(&self, svg: &mut String, matter: &Matter) {
        let [a, b, c] = matter.semi_axes_as_vectors();
        // The shadow of an ellipsoid is the image of a circle under the symmetric square root's
        // like: rows of the semi-axes, projected.
        let seen = [a, b, c].map(|axis| self.camera.turn(axis) * self.camera.scale());
        let (xx, xy, yy) =
            seen.iter().fold((0.0, 0.0, 0.0), |(xx, xy, yy), v| (xx + v.x * v.x, xy + v.x * v.y, yy + v.y * v.y));
        let center = self.camera.place(matter.center);
        let (l, root) = (xx.sqrt(), |x: f64| x.max(0.0).sqrt());
        if l > 0.0 {
            let below = xy / l;
            let depth = root(yy - below * below);
            let points =
                turns().map(|(sine, cosine)| (center.x + l * cosine, center.y - below * cosine - depth * sine));
            put(svg, format_args!("<path class=\"ellipsoid\" d=\"{}\"/>\n", closed(points)));
        }
        for (u, v) in [(a, b), (b, c), (c, a)] {
            let points = turns().map(|(sine, cosine)| {
                let point = self.camera.place(matter.center + u * cosine + v * sine);
                (point.x, point.y)
            });
            put(svg, format_args!("<path class=\"ring\" d=\"{}\"/>\n", closed(points)));
        }
    }

    fn draw_axes(&self, svg: &mut String, matter: &Matter) {
        let center = self.camera.place(matter.center);
        let mut labels: Vec<(DVec3, usize)> = Vec::with_capacity(3);
        for (i, end) in matter.ends().into_iter().enumerate() {
            let [from, to] = end.map(|end| self.camera.place(end));
            let d = format!("M{:.1} {:.1}L{:.1} {:.1}", from.x, from.y, to.x, to.y);
            put(svg, format_args!("<path class=\"halo\" d=\"{d}\"/><path class=\"axis a{i}\" d=\"{d}\"/>\n"));
            // Beyond the end that points to the right, away from the centre.
            let (tip, other) = if to.x >= from.x { (to, from) } else { (from, to) };
            let along = (tip - other).truncate().normalize_or(glam::DVec2::Y);
            labels.push((tip + (along * 13.0).extend(0.0), i));
        }
        for index in 0..labels.len() {
            let (settled, rest) = labels.split_at_mut(index);
            let Some((place, i)) = rest.first_mut() else { continue };
            while settled.iter().any(|(other, _)| (other.truncate() - place.truncate()).length() < APART) {
                place.y += 4.0;
            }
            put(
                svg,
                format_args!(
                    "<text class=\"end e{i}\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n",
                    place.x,
                    place.y + 4.5,
                    *i + 1
                ),
            );
        }
        // A circle with two quarters filled, as drawings of machines mark a centre of mass.
        let (x, y) = (center.x, center.y);
        put(
            svg,
            format_args!(
                "<circle class=\"center\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\"/>\
                 <path class=\"quarter\" d=\"M{x:.1} {y:.1}v-6a6 6 0 0 1 6 6zM{x:.1} {y:.1}v6a6 6 0 0 1 -6 -6z\"/>\n"
            ),
        );
    }

    fn draw_bar(&self, svg: &mut String) {
        // Not over a quarter of the width, and a number that is read at once.
        let longest = 0.25 * (ACROSS[1] - ACROSS[0]) / self.camera.scale() * self.unit;
        let length = round_below(longest);
        let pixels = length / self.unit * self.camera.scale();
        if !(pixels.is_finite() && pixels > 1.0) {
            return;
        }
        let (y, end) = (HEIGHT - 34.0, 28.0 + pixels);
        put(
            svg,
            format_args!(
                "<path class=\"bar\" d=\"M28 {0:.1}v8M28 {1:.1}H{end:.1}M{end:.1} {0:.1}v8\"/>\
                 <text class=\"small\" x=\"{2:.1}\" y=\"{3:.1}\">{4} m</text>\n",
                y - 4.0,
                y,
                end + 8.0,
                y + 4.0,
                tumble_import::shortest(length)
            ),
        );
    }

    /// The axes of the body's own frame, in the corner.
    fn draw_frame(&self, svg: &mut String) {
        let (x, y) = (ACROSS[1] - 26.0, HEIGHT - 44.0);
        for (axis, name) in [(DVec3::X, "x"), (DVec3::Y, "y"), (DVec3::Z, "z")] {
            let seen = self.camera.turn(axis);
            let end = |length: f64| (x + length * seen.x, y - length * seen.y);
            let ((tip_x, tip_y), (label_x, label_y)) = (end(26.0), end(37.0));
            put(svg, format_args!("<path class=\"frame\" d=\"M{x} {y}L{tip_x:.1} {tip_y:.1}\"/>"));
            put(
                svg,
                format_args!(
                    "<text class=\"small\" x=\"{label_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{name}</text>\n",
                    label_y + 4.0
                ),
            );
        }
    }

    fn draw_figures(&self, svg: &mut String) {
        let mut figures = Figures { svg, y: DOWN[0] };
        let body = self.body;
        if let Some(mass) = body.mass {
            figures.entry("mass", &[format!("{} kg", figure(mass))]);
        }
        if let Some(volume) = body.volume {
            figures.entry("volume", &[format!("{} m\u{b3}", figure(volume))]);
        }
        if let Some(center) = body.center_of_mass {
            // What is left of sums that cancel is no figure.
            let [x, y, z] = center.map(|x| figure(if x.abs() < NOTHING * self.unit { 0.0 } else { x }));
            figures.entry("centre of mass", &wrapped(&format!("{x}, {y}, {z} m")));
        }
        if let Some(principal) = body.principal {
            figures.entry("principal moments", &[]);
            for (i, moment) in principal.into_iter().enumerate() {
                figures.swatch(&format!("axis a{i}"), &format!("{}: {} kg m\u{b2}", i + 1, figure(moment)));
            }
        }
        if self.matter.is_some_and(|matter| matter.semi_axes.max_element() > 0.0) {
            figures.y += 8.0;
            figures.swatch("ellipsoid", "ellipsoid with this mass");
            figures.line("and these moments", 34.0);
        }
        if let Some(remark) = &self.surface.remark {
            figures.entry("surface", &wrapped(remark));
        }
        for problem in body.problems.iter().take(MAX_PROBLEMS) {
            figures.entry("problem", &wrapped(problem));
        }
    }
}

impl Matter {
    fn of(body: &AuditedBody) -> Option<Self> {
        let (mass, center, principal) = (body.mass?, body.center_of_mass?, body.principal?);
        let [x, y, z, w] = body.axes?;
        let rotation = DQuat::from_xyzw(x, y, z, w);
        Some(Self {
            center: DVec3::from_array(center),
            axes: [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| rotation * axis),
            semi_axes: equivalent_ellipsoid(mass, DVec3::from_array(principal)),
            reach: [[0.0; 2]; 3],
        })
    }

    fn reach_beyond(&mut self, points: &[DVec3]) {
        let reach: [[f64; 2]; 3] = std::array::from_fn(|i| {
            [-1.0, 1.0].map(|side| {
                let along = |point: &DVec3| (*point - self.center).dot(self.axes[i]) * side;
                points.iter().map(along).fold(self.semi_axes[i], f64::max)
            })
        });
        // An axis across a thin body is drawn long enough to be seen.
        let furthest = reach.iter().flatten().copied().fold(0.0, f64::max);
        self.reach = reach.map(|sides| sides.map(|side| BEYOND * side.max(0.4 * furthest)));
    }

    fn semi_axes_as_vectors(&self) -> [DVec3; 3] {
        std::array::from_fn(|i| self.axes[i] * self.semi_axes[i])
    }

    fn ends(&self) -> [[DVec3; 2]; 3] {
        std::array::from_fn(|i| {
            let [back, forth] = self.reach[i];
            [self.center - self.axes[i] * back, self.center + self.axes[i] * forth]
        })
    }

    /// What has to be in the picture.
    fn outline(&self) -> impl Iterator<Item = DVec3> {
        self.ends().into_iter().flatten()
    }
}

/// Lines of text under one another.
struct Figures<'a> {
    svg: &'a mut String,
    y: f64,
}

impl Figures<'_> {
    fn entry(&mut self, head: &str, lines: &[String]) {
        self.y += 8.0;
        put(self.svg, format_args!("<text class=\"head\" x=\"{FIGURES}\" y=\"{:.1}\">{head}</text>\n", self.y));
        self.y += LINE;
        for line in lines {
            self.line(line, 0.0);
        }
    }

    fn swatch(&mut self, class: &str, text: &str) {
        let y = self.y - 4.5;
        if class == "ellipsoid" {
            put(
                self.svg,
                format_args!("<ellipse class=\"{class}\" cx=\"{}\" cy=\"{y:.1}\" rx=\"12\" ry=\"6\"/>", FIGURES + 12.0),
            );
        } else {
            put(self.svg, format_args!("<path class=\"{class}\" d=\"M{FIGURES} {y:.1}h24\"/>"));
        }
        self.line(text, 34.0);
    }

    fn line(&mut self, text: &str, indent: f64) {
        put(self.svg, format_args!("<text x=\"{}\" y=\"{:.1}\">{}</text>\n", FIGURES + indent, self.y, escaped(text)));
        self.y += LINE;
    }
}

/// Words in lines that fit beside the body; at most four of them.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let word: String = word.chars().take(COLUMN).collect();
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(&word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= COLUMN => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines.truncate(4);
    lines
}

/// Sines and cosines around a circle.
fn turns() -> impl Iterator<Item = (f64, f64)> {
    (0..AROUND).map(|step| libm::sincos(std::f64::consts::TAU * step as f64 / AROUND as f64))
}

fn closed(points: impl Iterator<Item = (f64, f64)>) -> String {
    let mut path = String::new();
    for (x, y) in points {
        let pen = if path.is_empty() { "M" } else { "L" };
        put(&mut path, format_args!("{pen}{x:.1} {y:.1}"));
    }
    path + "Z"
}

/// 1, 2 or 5 times a power of ten.
fn round_below(length: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(length)));
    [5.0, 2.0].into_iter().map(|times| times * power).find(|round| *round <= length).unwrap_or(power)
}

/// A number with four digits that count.
fn figure(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&magnitude) {
        let digits = (3.0 - libm::floor(libm::log10(magnitude))).max(0.0) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.3e}")
    }
}

fn style() -> String {
    let shades = |dark: usize| {
        let shade = |i: usize| {
            let part = i as f64 / (SHADES - 1) as f64;
            let channel = |c: usize| (DARKEST[dark][c] + part * (LIGHTEST[dark][c] - DARKEST[dark][c])) as u8;
            let [r, g, b] = std::array::from_fn(channel);
            format!(
                ".s{i}{{fill:#{r:02x}{g:02x}{b:02x};stroke:#{r:02x}{g:02x}{b:02x};stroke-width:.7;stroke-linejoin:round}}"
            )
        };
        (0..SHADES).map(shade).collect::<String>()
    };
    let axes = |color: fn((&'static str, &'static str)) -> &'static str| {
        let rule = |(i, pair)| format!(".a{i}{{stroke:{0}}}.e{i}{{fill:{0}}}", color(pair));
        AXES.into_iter().enumerate().map(rule).collect::<String>()
    };
    let (light, dark) = (shades(0) + &axes(|pair| pair.0), shades(1) + &axes(|pair| pair.1));
    format!("{STYLE}{light}@media(prefers-color-scheme:dark){{{STYLE_IN_THE_DARK}{dark}}}")
}
