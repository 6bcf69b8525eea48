//! The triangles that go into the page.

use glam::DVec3;
use tumble::Shape;

use crate::tessellation::Tessellation;
use crate::trajectory::{Bodies, Surface, single};

/// Position in f32, normal in four bytes.
const VERTEX_BYTES: u64 = size_of::<[f32; 3]>() as u64 + size_of::<[i8; 4]>() as u64;

/// Which surfaces are there, and which are shown as boxes because their triangles are too many.
#[derive(Debug)]
pub(super) struct Surfaces {
    boxed: Vec<bool>,
    /// Of vertices and indices.
    pub(super) bytes: u64,
}

impl Surfaces {
    /// As many of the surfaces as fit into so many bytes, small ones first.
    pub(super) fn within(bytes: u64, bodies: &Bodies) -> Self {
        let surfaces = &bodies.geometry.surfaces;
        let mut by_size: Vec<(u64, usize)> = surfaces.iter().map(size).zip(0..).collect();
        by_size.sort_unstable();
        let mut result = Self { boxed: vec![false; surfaces.len()], bytes: 0 };
        for (size, index) in by_size {
            if result.bytes + size <= bytes {
                result.bytes += size;
            } else if let Some(boxed) = result.boxed.get_mut(index) {
                *boxed = true;
            }
        }
        result
    }

    pub(super) fn is_boxed(&self, surface: usize) -> bool {
        self.boxed.get(surface).copied().unwrap_or(false)
    }

    /// The triangles of a surface, or of the box around it.
    pub(super) fn triangles(&self, index: usize, surface: &Surface) -> Tessellation {
        if self.is_boxed(index) { box_around(surface) } else { surface.tessellation() }
    }
}

fn size(surface: &Surface) -> u64 {
    surface.vertices * VERTEX_BYTES + surface.corners * if surface.is_small() { 2 } else { 4 }
}

fn box_around(surface: &Surface) -> Tessellation {
    let [low, high] = [surface.min, surface.max].map(|corner| DVec3::from_array(corner.map(f64::from)));
    let mut triangles = Tessellation::of(&Shape::cuboid(0.5 * (high - low)));
    for position in &mut triangles.positions {
        *position += 0.5 * (low + high);
    }
    triangles
}

/// Positions, normals and indices as the page has them. Indices have 16 bits where that is enough.
pub(super) fn arrays(triangles: &Tessellation) -> [Vec<u8>; 3] {
    let positions = triangles.positions.iter().flat_map(|position| position.to_array());
    let positions = positions.flat_map(|number| single(number).to_le_bytes()).collect::<Vec<u8>>();
    let part = |number: f64| (number * f64::from(i8::MAX)).round() as i8;
    let normals = triangles.normals.iter().flat_map(|normal| [part(normal.x), part(normal.y), part(normal.z), 0]);
    let normals = normals.map(i8::cast_unsigned).collect::<Vec<u8>>();
    let corners = triangles.triangles.iter().flatten();
    let indices: Vec<u8> = if is_wide(triangles) {
        corners.flat_map(|index| index.to_le_bytes()).collect()
    } else {
        corners.flat_map(|&index| (index as u16).to_le_bytes()).collect()
    };
    [positions, normals, indices]
}

pub(super) fn is_wide(triangles: &Tessellation) -> bool {
    triangles.positions.len() > usize::from(u16::MAX)
}
