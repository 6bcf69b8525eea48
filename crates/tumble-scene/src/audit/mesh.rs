//! What `tumble inspect` finds in a file of triangles.

use std::path::Path;
use std::sync::Arc;

use tumble::Amount;
use tumble_import::checked::positive;
use tumble_import::{Appearance, MeshFile, MeshFormat, Reading, one_line};
use tumble_math::{MeshAudit, MeshError, SolidMesh, TriangleMesh};

use crate::audit::{Audit, AuditedBody, Up};
use crate::error::SceneError;

/// How a mesh is inspected.
///
/// ```
/// let options = tumble_scene::MeshOptions { density: 7850.0, ..Default::default() };
/// assert_eq!(options.repairs, tumble_scene::MeshRepairs::Refused);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOptions {
    /// Density of the matter inside [kg/m^3].
    pub density: f64,
    /// What is done about defects that leave no doubt what was meant.
    pub repairs: MeshRepairs,
}

impl Default for MeshOptions {
    fn default() -> Self {
        Self { density: 1.0, repairs: MeshRepairs::Refused }
    }
}

/// What is done about defects that leave no doubt what was meant.
///
/// ```
/// use tumble_scene::{MeshOptions, MeshRepairs};
/// let options = MeshOptions { repairs: MeshRepairs::Made, ..MeshOptions::default() };
/// # assert_eq!(options.density, 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshRepairs {
    /// They are problems, and the mesh has no mass properties.
    Refused,
    /// They are mended, and a notice says how.
    Made,
}

/// Audits a mesh file. The one body is called like the file.
pub(crate) fn of_file(path: &Path, format: MeshFormat, options: MeshOptions) -> Result<Audit, SceneError> {
    let mut reading = Reading::default();
    let MeshFile { mesh, mut notices } = MeshFile::read(path, &mut reading)?;
    let name = path.file_stem().map_or_else(|| "mesh".to_owned(), |stem| one_line(&stem.to_string_lossy()));
    let body = audited(name, mesh, format, options, &mut notices);
    Ok(Audit { bodies: vec![body], joints: Vec::new(), notices, files: reading.into_files() })
}

fn audited(
    name: String,
    mesh: TriangleMesh,
    format: MeshFormat,
    options: MeshOptions,
    notices: &mut Vec<String>,
) -> AuditedBody {
    let audit = mesh.audit();
    let mut body =
        match solid(&mesh, &audit, options.repairs, notices).and_then(|solid| with_mass(&name, &solid, options)) {
            Ok(body) => body,
            Err(problems) => AuditedBody { problems, ..AuditedBody::impossible(name, &[]) },
        };
    body.mesh = Some(audit);
    // What drawing programs have up, and what machines are built on.
    let up = if format == MeshFormat::Stl { Up::Z } else { Up::Y };
    body.appearance = Some((Appearance::Mesh(Arc::new(mesh)), up));
    body
}

/// The solid, or every reason why there is none.
fn solid(
    mesh: &TriangleMesh,
    audit: &MeshAudit,
    repairs: MeshRepairs,
    notices: &mut Vec<String>,
) -> Result<SolidMesh, Vec<String>> {
    let solid = match repairs {
        MeshRepairs::Refused => mesh.solid().map(|solid| (solid, Vec::new())),
        MeshRepairs::Made => mesh.repaired(),
    };
    let (solid, done) = solid.map_err(|error| problems(&error, audit))?;
    notices.extend(done.iter().map(|repair| format!("repaired: {repair}")));
    Ok(solid)
}

fn problems(error: &MeshError, audit: &MeshAudit) -> Vec<String> {
    let MeshError::NotSolid { .. } = error else { return vec![format!("mesh: {error}")] };
    let serious = audit.problems().into_iter().filter(|defect| !defect.is_harmless());
    serious
        .map(|defect| {
            let how = if defect.repair().is_some() { "can be repaired" } else { "cannot be repaired" };
            format!("mesh: {defect} ({how})")
        })
        .collect()
}

fn with_mass(name: &str, solid: &SolidMesh, options: MeshOptions) -> Result<AuditedBody, Vec<String>> {
    let problem = |field: &str, problem: &dyn std::fmt::Display| vec![format!("{field}: {problem}")];
    let density = positive("density", options.density).map_err(|error| vec![error.to_string()])?;
    let properties = solid.mass_properties(Amount::Density(density)).map_err(|error| problem("density", &error))?;
    // Thinner than rounding, it cannot be told from a plate or a wire.
    properties.inertia().map_err(|error| problem("mesh", &error))?;
    Ok(AuditedBody { volume: Some(solid.volume()), ..AuditedBody::of_properties(name.to_owned(), &properties) })
}
