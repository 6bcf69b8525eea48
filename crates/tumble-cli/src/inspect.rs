//! `tumble inspect`.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use clap::builder::styling::Style;
use tumble::MeshAudit;
use tumble_import::{printable, printable_json};
use tumble_record::{PendingFile, body_drawing};
use tumble_scene::{Audit, AuditedBody, AuditedCollider, AuditedJoint, MeshOptions, MeshRepairs};

use crate::ending::check_ending;
use crate::failure::Failure;
use crate::options::InspectOptions;
use crate::print::{self, ERROR, HEADING};
use crate::replacing::{Guard, Kind};

/// Prints the mass properties and forces of every body, or of the one asked for, and its joints; a
/// failure if one of them has a problem.
pub(crate) fn inspect(options: &InspectOptions) -> Result<(), Failure> {
    let file = &options.file;
    if let Some(path) = &options.draw {
        check_ending(path, "a drawing", "svg")?;
    }
    let repairs = if options.repair { MeshRepairs::Made } else { MeshRepairs::Refused };
    let density = options.density.unwrap_or(MeshOptions::default().density);
    let mut audit = Audit::open_with(file, MeshOptions { density, repairs })?;
    let is_mesh = audit.bodies.iter().any(|body| body.mesh.is_some());
    let repairable = is_mesh || is_repairable(file);
    let unfit = [
        (options.density.is_some() && !is_mesh, "--density goes with a mesh only"),
        (options.repair && !repairable, REPAIR),
    ];
    if let Some((_, what)) = unfit.iter().find(|(unfit, _)| *unfit) {
        return Err(Failure::Input(format!("{what}, not with {file:?}")));
    }
    if let Some(name) = &options.body {
        audit.bodies.retain(|body| body.name == *name);
        audit.joints.retain(|joint| joint.between.contains(name));
        if audit.bodies.is_empty() {
            return Err(Failure::Input(format!("{file}: no body is called {name:?}")));
        }
    }
    let text = if options.json {
        json(&audit)?
    } else {
        let bodies = audit.bodies.iter().map(people);
        bodies.chain(audit.joints.iter().map(joint)).collect::<Result<String, _>>()?
    };
    if let Some(path) = &options.draw {
        Guard { inputs: audit.files.clone(), force: options.force }.check(path, Kind::Picture)?;
        draw(&audit, file, path)?;
    }
    print::notices(&audit.notices);
    if options.json {
        print::output(&text)?;
    } else {
        print::output_with(&text, heading)?;
    }
    let bad = audit.bodies.iter().filter(|body| !body.problems.is_empty()).count();
    let bad_joints = audit.joints.iter().filter(|joint| !joint.problems.is_empty()).count();
    let (bad, all, kind) = match bad {
        0 => (bad_joints, audit.joints.len(), "joints"),
        bad => (bad, audit.bodies.len(), "bodies"),
    };
    if bad == 0 {
        return Ok(());
    }
    Err(Failure::Input(format!("{file}: {bad} of {all} {kind} have problems")))
}

/// What is said of `--repair` with anything else.
pub(crate) const REPAIR: &str = "--repair goes with a mesh, or a .gltf, .glb or .urdf file";

/// Whether a file is of a kind whose inertias can be repaired.
pub(crate) fn is_repairable(file: &str) -> bool {
    let ending = Path::new(file).extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| ["gltf", "glb", "urdf"].iter().any(|known| ending.eq_ignore_ascii_case(known)))
}

/// Names of bodies and joints stand out, and problems.
fn heading(line: &str) -> Option<(usize, Style)> {
    const PROBLEM: &str = "  PROBLEM";
    match line {
        "" => None,
        line if line.starts_with(PROBLEM) => Some((PROBLEM.len(), ERROR)),
        line if !line.starts_with(' ') => Some((line.len(), HEADING)),
        _ => None,
    }
}

/// Draws the first body.
fn draw(audit: &Audit, file: &str, path: &Path) -> Result<(), Failure> {
    let body = audit.bodies.first().ok_or_else(|| Failure::Input(format!("{file}: there is no body to draw")))?;
    let mut drawing = PendingFile::create(path).map_err(|error| Failure::opening(path, &error))?;
    let written = drawing.write_all(body_drawing(body).as_bytes());
    written.and_then(|()| drawing.finish()).map_err(|error| Failure::writing(path, &error))
}

fn json(audit: &Audit) -> Result<String, Failure> {
    serde_json::to_string_pretty(audit).map(|text| printable_json(&text) + "\n").map_err(|error| unwritten(&error))
}

fn unwritten(error: &serde_json::Error) -> Failure {
    Failure::Running(format!("the audit cannot be written as JSON: {error}"))
}

/// A paragraph with as many digits as the file could have had. Forces are written as in files.
fn people(body: &AuditedBody) -> Result<String, Failure> {
    let mut text = format!("{}\n", printable(&body.name));
    let mut line = |label: &str, value: &str| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {label:<22} {}", printable(value));
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
    if let Some(volume) = body.volume {
        line("volume [m3]", &numbers(&[volume]));
    }
    for (label, count) in body.mesh.iter().flat_map(counts) {
        line(label, &count);
    }
    for force in &body.forces {
        line("force", &serde_json::to_string(force).map_err(|error| unwritten(&error))?);
    }
    if let Some(collider) = &body.collider {
        let written = |one: &AuditedCollider| serde_json::to_string(one).map_err(|error| unwritten(&error));
        line("collider", &written(&AuditedCollider { parts: Vec::new(), ..collider.clone() })?);
        for (index, part) in collider.parts.iter().enumerate() {
            line(&format!("collider part {index}"), &written(part)?);
        }
    }
    if !body.locked_axes.is_empty() {
        line("locked axes", &body.locked_axes.join(", "));
    }
    for problem in &body.problems {
        line("PROBLEM", problem);
    }
    Ok(text)
}

/// A paragraph on a joint. Limits and drives are written as in JSON.
fn joint(joint: &AuditedJoint) -> Result<String, Failure> {
    let mut text = format!("{}\n", printable(&joint.name));
    let mut line = |label: &str, value: &str| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {label:<22} {}", printable(value));
    };
    if !joint.problems.is_empty() {
        joint.problems.iter().for_each(|problem| line("PROBLEM", problem));
        return Ok(text);
    }
    line("joint", joint.kind);
    line("between", &joint.between.join(", "));
    line("free", &joint.free.join(" "));
    for limit in &joint.limits {
        line("limit", &serde_json::to_string(limit).map_err(|error| unwritten(&error))?);
    }
    for drive in &joint.drives {
        line("drive", &serde_json::to_string(drive).map_err(|error| unwritten(&error))?);
    }
    for friction in &joint.friction {
        line("friction", &serde_json::to_string(friction).map_err(|error| unwritten(&error))?);
    }
    if let Some(breaks) = &joint.breaks {
        line("breaks at", &serde_json::to_string(breaks).map_err(|error| unwritten(&error))?);
    }
    for gear in &joint.follows {
        line("follows", &serde_json::to_string(gear).map_err(|error| unwritten(&error))?);
    }
    for (label, value) in [("max effort [N] [N m]", joint.max_effort), ("max speed [m/s] [rad/s]", joint.max_speed)] {
        value.iter().for_each(|value| line(label, &value.to_string()));
    }
    if joint.contacts {
        line("contacts", "between its bodies");
    }
    Ok(text)
}

/// What was counted in a mesh. What there is none of is left out, where it would be a defect.
fn counts(mesh: &MeshAudit) -> Vec<(&'static str, String)> {
    let (low, high) = (mesh.extents.0.to_array(), mesh.extents.1.to_array());
    let mut counts = vec![
        ("vertices", mesh.vertices.to_string()),
        ("triangles", mesh.triangles.to_string()),
        ("parts", mesh.parts.to_string()),
        ("volume as wound [m3]", numbers(&[mesh.volume])),
        ("area [m2]", numbers(&[mesh.area])),
        ("from [m]", numbers(&low)),
        ("to [m]", numbers(&high)),
    ];
    let defects = [
        ("cavities", mesh.cavities.unwrap_or(0)),
        ("duplicate vertices", mesh.duplicate_vertices),
        ("near duplicates", mesh.near_duplicates),
        ("unused vertices", mesh.unused_vertices),
        ("degenerate triangles", mesh.degenerate_triangles),
        ("collinear triangles", mesh.collinear_triangles),
        ("duplicate triangles", mesh.duplicate_triangles),
        ("open edges", mesh.open_edges),
        ("edges at cracks", mesh.cracks),
        ("overfull edges", mesh.overfull_edges),
        ("reversed edges", mesh.reversed_edges),
        ("one-sided parts", mesh.one_sided_parts),
        ("flat parts", mesh.flat_parts),
        ("inside-out parts", mesh.inside_out_parts),
    ];
    counts.extend(defects.into_iter().filter(|(_, count)| *count > 0).map(|(label, count)| (label, count.to_string())));
    counts
}

fn numbers(numbers: &[f64]) -> String {
    numbers.iter().map(|number| format!("{number:>15.8e}")).collect::<Vec<_>>().join(" ")
}
