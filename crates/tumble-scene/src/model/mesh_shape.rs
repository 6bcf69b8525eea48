//! Shapes of triangles in a scene: read from files beside it, or hulls of points.
//!
//! They are made once, when the scene is read, and kept in its model: a sweep makes thousands of
//! worlds of one model.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use tumble::{SolidMesh, convex_hull};
use tumble_import::checked::positive;
use tumble_import::{FieldError, MAX_MESH, MeshFile, MeshFormat, Reading, beside};
use tumble_math::MeshError;

use crate::model::scene_model::{SceneModel, ShapeModel};
use crate::values::checked::finite_triple;
use crate::values::tuple::Triple;

/// A shape's solid, or why there is none; nothing before it has been looked for.
pub(crate) type Made = Option<Result<Arc<SolidMesh>, FieldError>>;

/// Makes the solids of all shapes. Files are looked for from the directory of the scene's.
pub(crate) fn make_all(model: &mut SceneModel, scene_file: &str) {
    let directory = Path::new(scene_file).parent().unwrap_or(Path::new("")).to_owned();
    let mut maker = Maker {
        directory,
        reading: Reading::default(),
        files: HashMap::new(),
        made: HashMap::new(),
        room: MAX_MESH,
        notices: Vec::new(),
        hash: 0,
    };
    for shape in model.bodies.iter_mut().filter_map(|body| body.shape.as_mut()) {
        maker.make(shape);
    }
    (model.notices, model.meshes_hash) = (maker.notices, maker.hash);
    model.files = maker.reading.into_files();
}

/// File, bits of the scale, and whether it is to be repaired.
type Wanted = (String, u64, bool);

struct Maker {
    directory: PathBuf,
    reading: Reading,
    /// Each is read once, however it is spelled and in however many sizes it is wanted.
    files: HashMap<PathBuf, Result<Arc<MeshFile>, FieldError>>,
    /// Triangles that the solids may still have.
    room: usize,
    made: HashMap<Wanted, Result<Arc<SolidMesh>, FieldError>>,
    notices: Vec<String>,
    /// Over all coordinates and corners, so that sweeps over other files differ; 0 without
    /// a mesh.
    hash: u64,
}

impl Maker {
    fn make(&mut self, shape: &mut ShapeModel) {
        match shape {
            ShapeModel::Mesh { file, scale, repair, solid } => {
                let wanted = (file.clone(), scale.to_bits(), *repair);
                let known = self.made.get(&wanted).cloned();
                let made = known.unwrap_or_else(|| {
                    let made = self.read(file, *scale, *repair);
                    self.made.insert(wanted, made.clone());
                    made
                });
                *solid = Some(made);
            }
            ShapeModel::ConvexHull { points, solid } => *solid = Some(hull(points)),
            ShapeModel::Compound { parts } => parts.iter_mut().for_each(|part| self.make(&mut part.shape)),
            _ => {}
        }
    }

    fn read(&mut self, file: &str, scale: f64, repair: bool) -> Result<Arc<SolidMesh>, FieldError> {
        let scale = positive("scale", scale)?;
        let bad = |error: &dyn std::fmt::Display| FieldError::new("file", error);
        let path = self.directory.join(file);
        if MeshFormat::of_path(&path).is_none() {
            return Err(bad(&format_args!("{}: a mesh file ends in .obj, .stl, .gltf or .glb", path.display())));
        }
        let real = beside(&self.directory, file).map_err(|problem| bad(&problem))?;
        let known = self.files.get(&real).cloned();
        let read = known.unwrap_or_else(|| {
            let read = MeshFile::read(&real, &mut self.reading).map(Arc::new).map_err(|error| bad(&error));
            self.files.insert(real, read.clone());
            read
        })?;
        let full = || FieldError::exceeding("file", "triangles of all meshes together", MAX_MESH as u64);
        self.room = self.room.checked_sub(read.mesh.triangles().len()).ok_or_else(full)?;
        let bad = |error: MeshError| bad(&format_args!("{}: {error}{}", path.display(), mendable(&error)));
        let mesh = read.mesh.transformed(&DAffine3::from_scale(DVec3::splat(scale))).map_err(bad)?;
        let (solid, repairs) =
            if repair { mesh.repaired().map_err(bad)? } else { (mesh.solid().map_err(bad)?, Vec::new()) };
        let told = repairs.iter().map(|repair| format!("repaired: {repair}"));
        self.notices.extend(read.notices.iter().cloned().chain(told).map(|notice| format!("{file}: {notice}")));
        self.hash = hashed(self.hash, &solid);
        Ok(Arc::new(solid))
    }
}

/// A word on repairs, where they would help.
fn mendable(error: &MeshError) -> &'static str {
    match error {
        MeshError::NotSolid { defects } if defects.iter().all(|defect| !defect.is_fatal()) => {
            "; \"repair\": true mends it"
        }
        _ => "",
    }
}

fn hull(points: &[Triple]) -> Result<Arc<SolidMesh>, FieldError> {
    let vectors: Vec<DVec3> = points.iter().map(|point| finite_triple("points", point)).collect::<Result<_, _>>()?;
    let hull = convex_hull(&vectors).map_err(|error| FieldError::new("points", error))?;
    hull.solid().map(Arc::new).map_err(|error| FieldError::new("points", error))
}

/// 64-bit FNV-1a, word by word.
fn hashed(start: u64, solid: &SolidMesh) -> u64 {
    let mesh = solid.mesh();
    let coordinates = mesh.positions().iter().flat_map(DVec3::to_array).map(f64::to_bits);
    let corners = mesh.triangles().iter().flatten().map(|corner| u64::from(*corner));
    let start = if start == 0 { 0xcbf2_9ce4_8422_2325 } else { start };
    coordinates.chain(corners).fold(start, |hash, word| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3))
}
