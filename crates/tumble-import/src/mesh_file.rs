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

use crate::error::{FileError, Place};
use crate::gltf;
use crate::limits::MAX_MESH;
use crate::named_files::Reading;
use crate::terminal::one_line;

/// A surface as it stands in a file.
///
/// ```
/// use tumble_import::{FileError, MeshFile, Reading};
///
/// let error = MeshFile::read("missing.stl".as_ref(), &mut Reading::default()).unwrap_err();
/// assert!(matches!(error, FileError::Unreadable { .. }));
/// ```
#[derive(Debug)]
pub struct MeshFile {
    /// In the file's unit, taken for metres.
    pub mesh: TriangleMesh,
    /// What is in the file and is not read.
    pub notices: Vec<String>,
}

impl MeshFile {
    /// Reads a `.obj`, `.stl`, `.gltf` or `.glb` file.
    ///
    /// # Errors
    /// [`FileError`], whose message names the file and what is wrong in it.
    pub fn read(path: &Path, reading: &mut Reading) -> Result<Self, FileError> {
        let file = path.to_string_lossy();
        let format = MeshFormat::of_path(path).ok_or_else(|| FileError::UnknownFormat { file: one_line(&file) })?;
        let read: fn(&[u8]) -> Result<Surface, String> = match format {
            MeshFormat::Gltf => {
                let (mesh, notices) = gltf::mesh(path, reading)?;
                return Ok(Self { mesh, notices });
            }
            MeshFormat::Obj => obj::read,
            MeshFormat::Stl => stl::read,
        };
        let surface = read(&reading.file(path)?);
        let malformed = |problem: String| FileError::Malformed {
            file: one_line(&file),
            place: Place::default(),
            problem: one_line(&problem),
        };
        let Surface { positions, triangles, notices } = surface.map_err(malformed)?;
        let mesh = TriangleMesh::new(positions, triangles).map_err(|error| malformed(error.to_string()))?;
        Ok(Self { mesh, notices })
    }
}

/// How a surface is written down.
///
/// ```
/// use tumble_import::MeshFormat;
///
/// assert_eq!(MeshFormat::of_path("part.STL".as_ref()), Some(MeshFormat::Stl));
/// assert_eq!(MeshFormat::of_path("part.json".as_ref()), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// glTF 2.0, as text or binary.
    Gltf,
    /// Wavefront OBJ.
    Obj,
    /// STL, as text or binary.
    Stl,
}

impl MeshFormat {
    /// The format that a path's extension names, in either case; `None` if it names none.
    #[must_use]
    pub fn of_path(path: &Path) -> Option<Self> {
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
