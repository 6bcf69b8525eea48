//! The surface of a body as polygons in the picture, the furthest first.

use std::collections::HashMap;
use std::fmt::Write as _;

use glam::DVec3;
use tumble::{Shape, TriangleMesh};
use tumble_import::{Appearance, Tessellation};

use crate::body_drawing::camera::Camera;

/// Most triangles that are drawn; more of them are a megabyte that no eye tells apart.
const MAX_TRIANGLES: usize = 20_000;
/// Most parts of a compound whose surfaces are put together; each may have a thousand triangles.
const MAX_PARTS: usize = 400;
/// Cells along the longest side of the box, to begin with, in which vertices are taken for one.
const FINEST: f64 = 128.0;
/// Shades of the surface, from dark to light.
pub(crate) const SHADES: usize = 12;
/// Where the light comes from: right, up, towards the viewer.
const LIGHT: DVec3 = DVec3::new(-0.35, 0.72, 0.6);

/// Triangles to be drawn.
#[derive(Default)]
pub(crate) struct Surface {
    pub(crate) positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// How it was made smaller, if it was.
    pub(crate) remark: Option<String>,
}

impl Surface {
    pub(crate) fn of(appearance: &Appearance) -> Self {
        let whole = match appearance {
            Appearance::Mesh(mesh) => Self::of_mesh(mesh),
            Appearance::HeightField(heights) => Self::of_mesh(heights.triangles()),
            Appearance::HalfSpace => {
                let Tessellation { positions, triangles, .. } = Tessellation::of_appearance(appearance);
                Self { positions, triangles, remark: Some("a square of infinite ground".to_owned()) }
            }
            Appearance::Shape(shape) if leaves(shape, 0) > MAX_PARTS => {
                return Self { remark: Some(format!("more than {MAX_PARTS} parts, not drawn")), ..Self::default() };
            }
            Appearance::Shape(shape) => {
                let Tessellation { positions, triangles, .. } = Tessellation::of(shape);
                Self { positions, triangles, remark: None }
            }
        };
        whole.coarse()
    }

    fn of_mesh(mesh: &TriangleMesh) -> Self {
        Self { positions: mesh.positions().to_vec(), triangles: mesh.triangles().to_vec(), remark: None }
    }

    /// With few enough triangles: vertices in one cell of a grid are taken for one, and triangles
    /// that vanish so are left out.
    fn coarse(self) -> Self {
        let all = self.triangles.len();
        let (mut cells, mut coarse) = (FINEST, None);
        while coarse.as_ref().unwrap_or(&self).triangles.len() > MAX_TRIANGLES && cells >= 1.0 {
            coarse = Some(self.clustered(cells));
            cells *= 0.7;
        }
        let Some(mut coarse) = coarse else { return self };
        let left = coarse.triangles.len();
        coarse.remark = Some(format!("drawn with {left} of {all} triangles"));
        coarse
    }

    fn clustered(&self, cells: f64) -> Self {
        let (low, high) = extents(&self.positions);
        let size = (high - low).max_element().max(f64::MIN_POSITIVE);
        let mut numbers: HashMap<[i64; 3], u32> = HashMap::new();
        let mut positions = Vec::new();
        let mut number_of = |position: &DVec3| {
            let cell = ((*position - low) / size * cells).to_array().map(|x| x.floor() as i64);
            *numbers.entry(cell).or_insert_with(|| {
                positions.push(*position);
                positions.len() as u32 - 1
            })
        };
        let new: Vec<u32> = self.positions.iter().map(&mut number_of).collect();
        let moved = self.triangles.iter().map(|corners| corners.map(|c| new.get(c as usize).copied().unwrap_or(0)));
        let mut seen = std::collections::HashSet::new();
        let kept = moved.filter(|[a, b, c]| a != b && b != c && c != a).filter(|corners| {
            let mut sorted = *corners;
            sorted.sort_unstable();
            seen.insert(sorted)
        });
        let triangles = kept.collect();
        Self { positions, triangles, remark: None }
    }

    /// The triangles that show their backs and those that show their fronts, as SVG, the furthest
    /// first.
    pub(crate) fn draw(&self, camera: &Camera) -> [String; 2] {
        let light = LIGHT.normalize();
        let mut faces: Vec<(f64, bool, usize, [DVec3; 3])> = Vec::with_capacity(self.triangles.len());
        let point = |index: u32| self.positions.get(index as usize).copied().unwrap_or_default();
        for corners in &self.triangles {
            let [a, b, c] = corners.map(point);
            let normal = camera.turn((b - a).cross(c - a)).normalize_or_zero();
            let front = normal.z >= 0.0;
            let facing = if front { normal } else { -normal };
            let brightness = 0.5 + 0.5 * facing.dot(light);
            let shade = (brightness * SHADES as f64).clamp(0.0, SHADES as f64 - 1.0) as usize;
            let placed = [a, b, c].map(|corner| camera.place(corner));
            faces.push((placed.iter().map(|corner| corner.z).sum(), front, shade, placed));
        }
        faces.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut drawn = [String::new(), String::new()];
        for (_, front, shade, [a, b, c]) in faces {
            // Writing to a string cannot fail.
            let _ = writeln!(
                drawn[usize::from(front)],
                "<path class=\"s{shade}\" d=\"M{:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}Z\"/>",
                a.x,
                a.y,
                b.x,
                b.y,
                c.x,
                c.y
            );
        }
        drawn
    }
}

/// Lowest and highest coordinates.
fn extents(points: &[DVec3]) -> (DVec3, DVec3) {
    points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), point| (low.min(*point), high.max(*point)))
}

/// How many shapes a shape is made of.
fn leaves(shape: &Shape, depth: usize) -> usize {
    match shape {
        Shape::Compound(parts) if depth < Shape::MAX_DEPTH => {
            parts.iter().map(|part| leaves(&part.shape, depth + 1)).fold(0, usize::saturating_add)
        }
        _ => 1,
    }
}
