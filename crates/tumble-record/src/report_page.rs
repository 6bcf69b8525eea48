//! The report of a run as one page that needs nothing else: figures, plots and a replay.

pub(crate) mod choice;
pub(crate) mod data;
pub(crate) mod figures;
pub(crate) mod frames;
pub(crate) mod joints;
pub(crate) mod replay;
pub(crate) mod surfaces;
pub(crate) mod tables;

use std::io::{self, Write};
use std::time::Duration;

use crate::kept::Kept;
use crate::plot::Plot;
use crate::summary::Summary;
use crate::svg::escaped;

pub(crate) use crate::report_page::replay::Replay;

const PAGE: &str = include_str!("report_page/page.html");
const STYLE: &str = include_str!("report_page/page.css");
/// In the order in which they build on each other.
const SCRIPTS: [&str; 6] = [
    include_str!("report_page/script/states.js"),
    include_str!("report_page/script/view.js"),
    include_str!("report_page/script/shadow.js"),
    include_str!("report_page/script/drawing.js"),
    include_str!("report_page/script/time.js"),
    include_str!("report_page/script/controls.js"),
];

/// Notices that are listed; of more there is only the number.
const MAX_NOTICES: usize = 100;
/// Longest text from a scene that is shown as it is \[characters\].
const LONGEST_TEXT: usize = 600;

/// What a run did, as a page for a browser: HTML, style, script and data in one file that loads
/// nothing from elsewhere.
///
/// ```
/// use std::time::Duration;
/// use tumble_record::{Conserved, Frame, Kept, Plot, Replay, ReportPage, Summary};
/// use tumble_scene::Scene;
///
/// let scene = Scene::open("mujoco-box")?;
/// let mut replay = Replay::of(&scene)?;
/// let mut world = hecs::World::new();
/// let names = scene.spawn(&mut world)?;
/// let order = tumble::BodyOrder::of(&world);
/// replay.record(&Frame { step: 0, time: 0.0, world: &world, order: &order, names: &names });
/// # let zero = Conserved { initial: 0.0, r#final: 0.0, max_relative_drift: 0.0 };
/// # let zeros = Conserved { initial: [0.0; 3], r#final: [0.0; 3], max_relative_drift: 0.0 };
/// # let summary = Summary {
/// #     bodies: 1, worlds: 1, steps: 0, dt: 0.01, substeps: 1, integrator: "moser-veselov".into(),
/// #     precision: "f32".into(), threads: 1, simd: "scalar".into(), wall_seconds: 0.0,
/// #     step_seconds: 0.0, body_steps_per_second: 0.0, energy: zero, linear_momentum: zeros,
/// #     angular_momentum: zeros, state_hash: "0".into(),
/// # };
/// let page = ReportPage {
///     summary: &summary,
///     kept: Kept { energy: true, momentum: true },
///     steps_asked: 0,
///     phases: &[("integrate", Duration::ZERO)],
///     plots: &[Plot::new("Energy")],
///     replay: &replay,
/// };
/// let mut html = Vec::new();
/// page.write(&mut html)?;
/// assert!(html.starts_with(b"<!DOCTYPE html>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ReportPage<'a> {
    /// The figures.
    pub summary: &'a Summary,
    /// Of which of them a drift is an error, and is stated.
    pub kept: Kept,
    /// Steps that were asked for; more than were done if the run was interrupted.
    pub steps_asked: u64,
    /// Where the time of the steps went, over all threads.
    pub phases: &'a [(&'a str, Duration)],
    /// Pictures of the ledger.
    pub plots: &'a [Plot],
    /// What the bodies did.
    pub replay: &'a Replay,
}

impl ReportPage<'_> {
    /// Writes the page.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn write(&self, to: &mut impl Write) -> io::Result<()> {
        // The template is cut before anything is put in, so what a scene says is never taken for a
        // slot.
        let mut pieces = PAGE.split("<!--slot:");
        to.write_all(pieces.next().unwrap_or_default().as_bytes())?;
        for piece in pieces {
            let (slot, rest) = piece.split_once("-->").unwrap_or((piece, ""));
            self.write_slot(slot, to)?;
            to.write_all(rest.as_bytes())?;
        }
        Ok(())
    }

    fn write_slot(&self, slot: &str, to: &mut impl Write) -> io::Result<()> {
        let text = match slot {
            "style" => STYLE.to_owned(),
            "script" => SCRIPTS.join("\n"),
            "title" => escaped(&shortened(self.replay.title())),
            "about" => self.about(),
            "comment" => self.comment(),
            "thinned" => self.thinned(),
            "summary" => tables::summary(self.summary, self.steps_asked),
            "conserved" => tables::conserved(self.summary, self.kept),
            "plots" => self.plots.iter().map(inline_plot).collect(),
            "timing" => tables::timing(self.summary, self.phases),
            "notices" => self.notices(),
            "data" => return data::write(self.replay, to),
            _ => String::new(),
        };
        to.write_all(text.as_bytes())
    }

    fn about(&self) -> String {
        let description = self.replay.description().map(|text| format!("<p>{}</p>\n", escaped(&shortened(text))));
        let summary = self.summary;
        let bodies = if summary.bodies == 1 { "body" } else { "bodies" };
        let mut line = format!("{} {bodies}, {} steps", figures::count(summary.bodies), figures::count(summary.steps));
        if summary.steps < self.steps_asked {
            line.push_str(&format!(" (interrupted, of {})", figures::count(self.steps_asked)));
        }
        format!(
            "{}<p>{line}, {}, {}</p>",
            description.unwrap_or_default(),
            escaped(&summary.integrator),
            summary.precision
        )
    }

    /// What the replay does not show, in the file for those who read it as text. All of it is ours:
    /// a comment has no escapes.
    fn comment(&self) -> String {
        format!("<!-- A report of tumble, complete in this file. {} -->", self.replay.left_out().join(" "))
    }

    fn thinned(&self) -> String {
        format!("<p class=\"thinned\">{}</p>", self.replay.left_out().join(" "))
    }

    fn notices(&self) -> String {
        let notices = self.replay.notices();
        if notices.is_empty() {
            return String::new();
        }
        let item = |text: &String| format!("<li>{}</li>\n", escaped(&shortened(text)));
        let mut items: String = notices.iter().take(MAX_NOTICES).map(item).collect();
        if notices.len() > MAX_NOTICES {
            items.push_str(&format!("<li>and {} more</li>\n", notices.len() - MAX_NOTICES));
        }
        format!("<section>\n<h2>Notes on the scene</h2>\n<ul class=\"notes\">\n{items}</ul>\n</section>\n")
    }
}

/// A plot as a part of the page, in which SVG needs no name of its own; once for wide screens and
/// once for narrow ones.
fn inline_plot(plot: &Plot) -> String {
    let inline = |svg: String| svg.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    let [wide, narrow] = [plot.to_svg(), plot.to_narrow_svg()].map(inline);
    format!("<div class=\"plot wide\">{wide}</div>\n<div class=\"plot narrow\">{narrow}</div>\n")
}

/// Text of a scene, which may be of any length.
fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST_TEXT) {
        Some((end, _)) => format!("{} …", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}
