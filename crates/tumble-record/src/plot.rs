//! Line plots as SVG.

pub(crate) mod axis;

use crate::plot::axis::Axis;
pub(crate) use crate::plot::axis::Scale;

use crate::svg::{escaped, opening, put};

const TOP: f64 = 48.0;
/// Width of a character of the legend, on average, and of what stands before it.
const CHARACTER: f64 = 7.0;
const SWATCH: f64 = 34.0;
/// Height of a row of the legend.
const ROW: f64 = 20.0;
/// Colours of the series on a light and on a dark ground, told apart by all kinds of eyes (M.
/// Okabe, K. Ito, 2002).
const COLORS: [(&str, &str); 6] = [
    ("#0072b2", "#56a8e0"),
    ("#d55e00", "#ff8a3d"),
    ("#009e73", "#2fc79b"),
    ("#b0528a", "#dd8fbe"),
    ("#b07d00", "#e6b422"),
    ("#666666", "#aaaaaa"),
];
const STYLE: &str = "text{font:13px system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif;fill:#333}\
.title{font-size:15px;font-weight:600}.ground{fill:#fff}.grid{stroke:#e4e4e4}.frame{stroke:#888;fill:none}\
.line{fill:none;stroke-width:1.8;stroke-linejoin:round;stroke-linecap:round}";
const STYLE_IN_THE_DARK: &str = "text{fill:#ddd}.ground{fill:#15181c}.grid{stroke:#2e3338}.frame{stroke:#888}";

/// Where the legend stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Legend {
    Beside,
    Below,
}

/// The size of a picture, and where its axes are.
#[derive(Clone, Copy)]
struct Layout {
    width: f64,
    /// Without a legend below.
    height: f64,
    left: f64,
    legend: Legend,
}

/// As it stands in files and on wide screens.
const WIDE: Layout = Layout { width: 760.0, height: 420.0, left: 92.0, legend: Legend::Beside };
/// For the screen of a phone.
const NARROW: Layout = Layout { width: 380.0, height: 300.0, left: 72.0, legend: Legend::Below };

impl Layout {
    fn bottom(self) -> f64 {
        self.height - 56.0
    }
}

/// How a series is drawn.
///
/// ```
/// use tumble_record::{Plot, SeriesStyle};
/// let measured = Plot::new("Falls")
///     .series("measured", SeriesStyle::Cloud, [(0.1, 0.05), (0.2, 0.19)])
///     .to_svg();
/// # assert!(measured.contains("measured"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeriesStyle {
    /// A line.
    Line,
    /// A dashed line.
    Dashed,
    /// A line with a dot at every point.
    Dots,
    /// A small dot at every point and no line.
    Cloud,
}

/// A plot of several series over common axes, written as an SVG picture that is readable on light
/// and dark grounds.
///
/// A point that is not finite, or not positive on a logarithmic axis, is left out and interrupts
/// its line. A line of very many points is thinned to what can be seen, so the picture stays small.
///
/// ```
/// use tumble_record::{Plot, Scale, SeriesStyle};
/// let falls = (0..100).map(|i| (f64::from(i) * 0.01, -4.905 * f64::from(i * i) * 1e-4));
/// let svg = Plot::new("A fall")
///     .x_axis("time [s]", Scale::Linear)
///     .y_axis("height [m]", Scale::Linear)
///     .series("brick", SeriesStyle::Line, falls)
///     .to_svg();
/// assert!(svg.starts_with("<svg") && svg.contains("height [m]"));
/// ```
#[derive(Clone, Debug)]
#[must_use]
pub struct Plot {
    title: String,
    axes: [(String, Scale); 2],
    series: Vec<Series>,
}

#[derive(Clone, Debug)]
struct Series {
    name: String,
    series_style: SeriesStyle,
    points: Vec<(f64, f64)>,
}

impl Plot {
    /// A plot without series, with linear axes.
    pub fn new(title: impl Into<String>) -> Self {
        let axis = || (String::new(), Scale::Linear);
        Self { title: title.into(), axes: [axis(), axis()], series: Vec::new() }
    }

    /// What runs from left to right, with its unit.
    pub fn x_axis(mut self, label: impl Into<String>, scale: Scale) -> Self {
        self.axes[0] = (label.into(), scale);
        self
    }

    /// What runs from bottom to top, with its unit.
    pub fn y_axis(mut self, label: impl Into<String>, scale: Scale) -> Self {
        self.axes[1] = (label.into(), scale);
        self
    }

    /// Adds a series. A series without a name is not in the legend.
    pub fn series(
        mut self,
        name: impl Into<String>,
        series_style: SeriesStyle,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        self.series.push(Series { name: name.into(), series_style, points: points.into_iter().collect() });
        self
    }

    /// The picture.
    ///
    /// Where the x axis is linear, `data-x` of the picture has the two ends of that axis in the
    /// picture, the two values there, and the upper and lower end of the other axis.
    pub fn to_svg(&self) -> String {
        self.drawn(WIDE)
    }

    /// The picture for a screen that is half as wide: the legend stands below.
    pub(crate) fn to_narrow_svg(&self) -> String {
        self.drawn(NARROW)
    }

    fn drawn(&self, layout: Layout) -> String {
        let named = self.series.iter().filter(|series| !series.name.is_empty());
        let longest = named.clone().map(|series| series.name.chars().count()).max().unwrap_or(0);
        let (beside, below) = match layout.legend {
            Legend::Beside if longest == 0 => (0.0, 0.0),
            Legend::Beside => (SWATCH + CHARACTER * longest as f64, 0.0),
            Legend::Below => (0.0, ROW * named.count() as f64),
        };
        let right = layout.width - beside.min(0.5 * layout.width) - 18.0;
        let points = || self.series.iter().flat_map(|series| &series.points);
        let x = Axis::new(self.axes[0].1, points().map(|p| p.0), layout.left, right);
        let y = Axis::new(self.axes[1].1, points().map(|p| p.1), layout.bottom(), TOP);
        let [low, high] = x.range();
        let data = (self.axes[0].1 == Scale::Linear)
            .then(|| format!("{} {right:.1} {low:e} {high:e} {TOP} {}", layout.left, layout.bottom()));
        let size = [layout.width, layout.height + below];
        let mut svg = opening(size, &self.title, [layout.left, 28.0], (&style(), data.as_deref()));
        self.draw_axes(&mut svg, &x, &y, (layout, right));
        for (i, series) in self.series.iter().enumerate() {
            series.draw(&mut svg, i % COLORS.len(), &x, &y);
        }
        let legend = match layout.legend {
            Legend::Beside => [right + 14.0, TOP + 12.0],
            Legend::Below => [layout.left, layout.height + 4.0],
        };
        self.draw_legend(&mut svg, legend);
        svg.push_str("</svg>\n");
        svg
    }

    fn draw_axes(&self, svg: &mut String, x: &Axis, y: &Axis, (layout, right): (Layout, f64)) {
        let (left, bottom) = (layout.left, layout.bottom());
        for (at, label) in x.ticks() {
            put(svg, format_args!("<path class=\"grid\" d=\"M{at:.1} {TOP}V{bottom}\"/>"));
            put(
                svg,
                format_args!("<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>\n", bottom + 19.0),
            );
        }
        for (at, label) in y.ticks() {
            put(svg, format_args!("<path class=\"grid\" d=\"M{left} {at:.1}H{right:.1}\"/>"));
            put(
                svg,
                format_args!("<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>\n", left - 8.0, at + 4.5),
            );
        }
        put(svg, format_args!("<path class=\"frame\" d=\"M{left} {TOP}V{bottom}H{right:.1}\"/>\n"));
        let [(x_label, _), (y_label, _)] = &self.axes;
        let (middle, low, half) = (0.5 * (left + right), layout.height - 14.0, 0.5 * (TOP + bottom));
        put(
            svg,
            format_args!("<text x=\"{middle:.1}\" y=\"{low}\" text-anchor=\"middle\">{}</text>\n", escaped(x_label)),
        );
        put(
            svg,
            format_args!(
                "<text transform=\"translate(19 {half}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                escaped(y_label)
            ),
        );
    }

    fn draw_legend(&self, svg: &mut String, [left, top]: [f64; 2]) {
        let named = self.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty());
        for (row, (i, series)) in named.enumerate() {
            let (y, end, color) = (top + ROW * row as f64, left + 20.0, i % COLORS.len());
            put(
                svg,
                format_args!(
                    "<path class=\"line c{color}\"{} d=\"M{left:.1} {y}H{end:.1}\"/>",
                    series.series_style.dashes()
                ),
            );
            put(
                svg,
                format_args!("<text x=\"{:.1}\" y=\"{}\">{}</text>\n", left + 27.0, y + 4.5, escaped(&series.name)),
            );
        }
    }
}

impl SeriesStyle {
    fn dashes(self) -> &'static str {
        if self == Self::Dashed { " stroke-dasharray=\"6 5\"" } else { "" }
    }
}

impl Series {
    fn draw(&self, svg: &mut String, color: usize, x: &Axis, y: &Axis) {
        let mut placed = self.points.iter().map(|p| (x.place(p.0), y.place(p.1))).peekable();
        let mut path = String::new();
        let mut dots = String::new();
        let mut pen_down = false;
        let radius = if self.series_style == SeriesStyle::Cloud { 1.8 } else { 3.4 };
        while let Some(point) = placed.next() {
            if !(point.0.is_finite() && point.1.is_finite()) {
                pen_down = false;
                continue;
            }
            // Of the points in one column of the picture, the first, the lowest, the highest and
            // the last are seen.
            let column = (2.0 * point.0).floor();
            let mut seen = [point; 4];
            // The density of a cloud is what it shows, so none of its points are left out.
            let thin = self.series_style != SeriesStyle::Cloud;
            while let Some(next) = placed.next_if(|p| thin && p.1.is_finite() && (2.0 * p.0).floor() == column) {
                seen[1] = if next.1 < seen[1].1 { next } else { seen[1] };
                seen[2] = if next.1 > seen[2].1 { next } else { seen[2] };
                seen[3] = next;
            }
            let mut last = None;
            for (px, py) in seen {
                if last.replace((px, py)) != Some((px, py)) {
                    put(&mut path, format_args!("{}{px:.2} {py:.2}", if pen_down { "L" } else { "M" }));
                    put(
                        &mut dots,
                        format_args!("<circle class=\"d{color}\" cx=\"{px:.2}\" cy=\"{py:.2}\" r=\"{radius}\"/>"),
                    );
                    pen_down = true;
                }
            }
        }
        if !path.is_empty() && self.series_style != SeriesStyle::Cloud {
            put(svg, format_args!("<path class=\"line c{color}\"{} d=\"{path}\"/>\n", self.series_style.dashes()));
        }
        if matches!(self.series_style, SeriesStyle::Dots | SeriesStyle::Cloud) {
            put(svg, format_args!("{dots}\n"));
        }
    }
}

fn style() -> String {
    let colors = |color: fn((&'static str, &'static str)) -> &'static str| {
        let rule = |(i, pair)| format!(".c{i}{{stroke:{0}}}.d{i}{{fill:{0}}}", color(pair));
        COLORS.into_iter().enumerate().map(rule).collect::<String>()
    };
    let (light, dark) = (colors(|pair| pair.0), colors(|pair| pair.1));
    format!("{STYLE}{light}@media(prefers-color-scheme:dark){{{STYLE_IN_THE_DARK}{dark}}}")
}
