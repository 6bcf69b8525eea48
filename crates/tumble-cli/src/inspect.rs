//! `tumble inspect`.

use std::fmt::Write as _;

use tumble_scene::{Audit, AuditedBody};

use crate::failure::Failure;
use crate::options::InspectOptions;
use crate::print;

/// Prints the mass properties and forces of every body; a failure if any body has a problem.
pub(crate) fn inspect(options: &InspectOptions) -> Result<(), Failure> {
    let audit = Audit::open(&options.scene)?;
    let text =
        if options.json { json(&audit)? } else { audit.bodies.iter().map(people).collect::<Result<String, _>>()? };
    print::notices(&audit.notices);
    print::output(&text)?;
    let bad = audit.bodies.iter().filter(|body| !body.problems.is_empty()).count();
    if bad == 0 {
        return Ok(());
    }
    Err(Failure::Input(format!("{}: {bad} of {} bodies have problems", options.scene, audit.bodies.len())))
}

fn json(audit: &Audit) -> Result<String, Failure> {
    serde_json::to_string_pretty(audit).map(|text| text + "\n").map_err(|error| unwritten(&error))
}

fn unwritten(error: &serde_json::Error) -> Failure {
    Failure::Running(format!("the audit cannot be written as JSON: {error}"))
}

/// A paragraph with as many digits as the file could have had. Forces are written as in files.
fn people(body: &AuditedBody) -> Result<String, Failure> {
    let mut text = format!("{}\n", body.name);
    let mut line = |label: &str, value: &str| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {label:<22} {value}");
    };
    if let Some(mass) = body.mass {
        line("mass [kg]", &mass.to_string());
    } else if body.problems.is_empty() {
        line("mass", "none: it is not moved by forces");
    }
    if let Some(center) = body.center_of_mass {
        line("centre of mass [m]", &numbers(&center));
    }
    for (row, label) in body.tensor.iter().flatten().zip(["tensor [kg m2]", "", ""]) {
        line(label, &numbers(row));
    }
    if let Some(principal) = body.principal {
        line("principal [kg m2]", &numbers(&principal));
    }
    if let Some(axes) = body.axes {
        line("axes x y z w", &numbers(&axes));
    }
    for force in &body.forces {
        line("force", &serde_json::to_string(force).map_err(|error| unwritten(&error))?);
    }
    for problem in &body.problems {
        line("PROBLEM", problem);
    }
    Ok(text)
}

fn numbers(numbers: &[f64]) -> String {
    numbers.iter().map(|number| format!("{number:>15.8e}")).collect::<Vec<_>>().join(" ")
}
