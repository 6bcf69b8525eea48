//! The tables of the page.

use std::time::Duration;

use crate::kept::Kept;
use crate::report_page::figures::{count, figure, rounded};
use crate::summary::{Conserved, Summary};
use crate::svg::escaped;

/// The figures of the summary, in two columns.
pub(crate) fn summary(summary: &Summary, steps_asked: u64) -> String {
    let steps = if summary.steps < steps_asked {
        format!("{} (interrupted, of {})", count(summary.steps), count(steps_asked))
    } else {
        count(summary.steps)
    };
    // By way of text, for 0.01 in single precision is to be read as 0.01.
    let dt: f64 = summary.dt.to_string().parse().unwrap_or_default();
    let parts = if summary.substeps == 1 { String::new() } else { format!(" in {} parts", summary.substeps) };
    let run = [
        ("bodies", count(summary.bodies)),
        ("steps", steps),
        ("time step", format!("{} s{parts}", figure(dt))),
        ("simulated time", format!("{} s", figure(dt * summary.steps as f64))),
        ("integrator", escaped(&summary.integrator)),
        ("precision", escaped(&summary.precision)),
    ];
    let machine = [
        ("wall time", format!("{} s", figure(rounded(summary.wall_seconds)))),
        ("stepping", format!("{} s", figure(rounded(summary.step_seconds)))),
        ("body-steps per second", figure(rounded(summary.body_steps_per_second))),
        ("threads", count(summary.threads)),
        ("instruction set", escaped(&summary.simd)),
        ("state hash", escaped(&summary.state_hash)),
    ];
    list(&run) + &list(&machine)
}

fn list(rows: &[(&str, String)]) -> String {
    let rows: String = rows
        .iter()
        .map(|(label, value)| format!("<tr><th scope=\"row\">{label}</th><td>{value}</td></tr>\n"))
        .collect();
    format!("<table>\n{rows}</table>\n")
}

const DRIFT: &str = "The drift is the largest departure from the start, relative to the scale of the quantity, as in the plot. \
                     Nothing changes what has one, so it is an error.";

/// Energy and momenta at both ends of the run, with the drifts of those that nothing changes.
pub(crate) fn conserved(summary: &Summary, kept: Kept) -> String {
    let energy = &summary.energy;
    let mut rows = row("energy [J]", energy.initial, energy.r#final, kept.energy.then_some(energy.max_relative_drift));
    rows += &vector("momentum [kg m/s]", &summary.linear_momentum, kept.momentum);
    rows += &vector("angular momentum [kg m²/s]", &summary.angular_momentum, kept.momentum);
    let (heading, said) = match (kept.energy, kept.momentum) {
        (true, true) => ("largest drift", DRIFT.to_owned()),
        (true, false) => {
            ("largest drift", format!("{DRIFT} Momentum has none: something pushes or holds bodies from outside."))
        }
        (false, true) => {
            ("largest drift", format!("{DRIFT} Energy has none: something gives or takes it, as contacts do."))
        }
        (false, false) => (
            "",
            "Nothing here is kept: contacts or forces change the energy, and something outside the momentum."
                .to_owned(),
        ),
    };
    format!(
        "<table>\n<thead><tr><th></th><th>start</th><th>end</th><th>{heading}</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n\
         <p class=\"small\">{said}</p>\n"
    )
}

/// The drift is that of the vector, so it stands in the first row only.
fn vector(label: &str, vector: &Conserved<[f64; 3]>, is_kept: bool) -> String {
    let ends = ["x", "y", "z"].iter().zip(vector.initial.into_iter().zip(vector.r#final));
    ends.map(|(axis, (start, end))| {
        let drift = (is_kept && *axis == "x").then_some(vector.max_relative_drift);
        row(&format!("{label} {axis}"), start, end, drift)
    })
    .collect()
}

fn row(label: &str, start: f64, end: f64, drift: Option<f64>) -> String {
    let drift =
        drift.map_or_else(String::new, |drift| if drift == 0.0 { "0".to_owned() } else { figure(rounded(drift)) });
    format!(
        "<tr><th scope=\"row\">{label}</th><td>{}</td><td>{}</td><td>{drift}</td></tr>\n",
        figure(start),
        figure(end)
    )
}

/// Where the time of the steps went.
pub(crate) fn timing(summary: &Summary, phases: &[(&str, Duration)]) -> String {
    let all: Duration = phases.iter().map(|(_, time)| *time).sum();
    let rows: String = phases
        .iter()
        .map(|(phase, time)| {
            // No time at all has no shares.
            let share = 100.0 * time.as_secs_f64() / all.as_secs_f64().max(f64::MIN_POSITIVE);
            format!(
                "<tr><th scope=\"row\">{phase}</th><td>{} s</td><td>{share:.0} %</td>\
                 <td class=\"share\"><span class=\"bar\" style=\"width:{share:.1}%\"></span></td></tr>\n",
                figure(rounded(time.as_secs_f64())),
                phase = escaped(phase),
            )
        })
        .collect();
    let [stepping, wall] = [summary.step_seconds, summary.wall_seconds].map(|time| figure(rounded(time)));
    format!(
        "<table class=\"timing\">\n<thead><tr><th>phase</th><th>time</th><th>share</th><th></th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n\
         <p class=\"small\">{stepping} s inside the steps, of {wall} s with recording and measuring.</p>\n"
    )
}
