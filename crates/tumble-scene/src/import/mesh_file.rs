//! Files of triangles: Wavefront OBJ, STL, and glTF, which `gltf/mod.rs` reads.
//!
//! The readers of the first two are our own. What is wanted of either format is a page of code, and
//! the crates there are fall short where it matters: `tobj` makes triangles of polylines, overflows
//! on texture indices that count back too far and names no lines; `stl_io` takes a binary file for
//! text if its header begins with `solid`, ends silently at the first of several solids, and splits
//! a file into words, forty times its size.

pub(crate) mod obj;
pub(crate) mod stl;

use std::path::Path;

use glam::DVec3;
use tumble_math::TriangleMesh;

use crate::error::{Place, SceneError, one_line};
use crate::import::gltf;
use crate::import::named_files::Reading;
use crate::limits::MAX_MESH;

/// A surface as it stands in a file.
#[derive(Debug)]
pub(crate) struct MeshFile {
    /// In the file's unit, taken for metres.
    pub(crate) mesh: TriangleMesh,
    /// What is in the file and is not read.
    pub(crate) notices: Vec<String>,
}

/// How a surface is written down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MeshFormat {
    Gltf,
    Obj,
    Stl,
}

impl MeshFormat {
    /// The format that a path's extension names, in either case; `None` if it names none.
    pub(crate) fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "glb" | "gltf" => Some(Self::Gltf),
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            _ => None,
        }
    }
}

/// Vertices and triangles while they are read, and what is not.
#[derive(Default)]
pub(crate) struct Surface {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    notices: Vec<String>,
}

impl Surface {
    fn add_vertex(&mut self, position: DVec3) -> Result<(), String> {
        check_count("vertices", self.positions.len())?;
        self.positions.push(position);
        Ok(())
    }

    fn add_triangle(&mut self, corners: [u32; 3]) -> Result<(), String> {
        check_count("triangles", self.triangles.len())?;
        self.triangles.push(corners);
        Ok(())
    }
}

fn check_count(what: &str, count: usize) -> Result<(), String> {
    if count < MAX_MESH { Ok(()) } else { Err(format!("more than {MAX_MESH} {what}")) }
}

/// Three coordinates of words, the first of which may be missing or bad.
fn position<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<DVec3, String> {
    let mut coordinates = [0.0_f64; 3];
    for coordinate in &mut coordinates {
        let word = words.next().ok_or("a vertex has three coordinates")?;
        *coordinate = word.parse().map_err(|_| format!("{word:?} is not a number"))?;
        if !coordinate.is_finite() {
            return Err(format!("{word} is not a finite number"));
        }
    }
    Ok(DVec3::from_array(coordinates))
}

/// Reads a `.obj`, `.stl`, `.gltf` or `.glb` file.
pub(crate) fn load(path: &Path, reading: &mut Reading) -> Result<MeshFile, SceneError> {
    let file = path.to_string_lossy();
    let format = MeshFormat::of_path(path).ok_or_else(|| SceneError::UnknownFormat { file: one_line(&file) })?;
    let read: fn(&[u8]) -> Result<Surface, String> = match format {
        MeshFormat::Gltf => return gltf::mesh(path, reading),
        MeshFormat::Obj => obj::read,
        MeshFormat::Stl => stl::read,
    };
    let surface = read(&reading.file(path)?);
    let malformed = |problem: String| SceneError::Malformed {
        file: one_line(&file),
        place: Place::default(),
        problem: one_line(&problem),
    };
    let Surface { positions, triangles, notices } = surface.map_err(malformed)?;
    let mesh = TriangleMesh::new(positions, triangles).map_err(|error| malformed(error.to_string()))?;
    Ok(MeshFile { mesh, notices })
}
