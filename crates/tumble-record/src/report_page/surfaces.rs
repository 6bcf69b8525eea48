//! The triangles that go into the page.

use glam::DVec3;
use tumble::Shape;
use tumble_import::Tessellation;

use crate::trajectory::glb::bodies::Bodies;
use crate::trajectory::glb::geometry::Surface;
use crate::trajectory::glb::sample::single;

/// Position in f32, normal in four bytes.
const VERTEX_BYTES: u64 = size_of::<[f32; 3]>() as u64 + size_of::<[i8; 4]>() as u64;

/// Which surfaces are there, and which are shown as boxes because their triangles are too many.
#[derive(Debug)]
pub(crate) struct Surfaces {
    boxed: Vec<bool>,
    /// Of vertices and indices.
    pub(crate) bytes: u64,
}

impl Surfaces {
    /// As many of the surfaces as fit into this number of bytes, small ones first.
    pub(crate) fn within(bytes: u64, bodies: &Bodies) -> Self {
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

    pub(crate) fn is_boxed(&self, surface: usize) -> bool {
        self.boxed.get(surface).copied().unwrap_or(false)
    }

    /// The triangles of a surface, or of the box around it.
    pub(crate) fn triangles(&self, index: usize, surface: &Surface) -> Tessellation {
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
pub(crate) fn arrays(triangles: &Tessellation) -> [Vec<u8>; 3] {
    let positions = triangles.positions.iter().flat_map(DVec3::to_array);
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

pub(crate) fn is_wide(triangles: &Tessellation) -> bool {
    triangles.positions.len() > usize::from(u16::MAX)
}

#[cfg(test)]
mod tests {
    use hecs::World;
    use tumble::BodyOrder;

    use super::*;
    use crate::trajectory::frame::Frame;
    use tumble_scene::Scene;

    fn bodies(scene: &str) -> Bodies {
        let scene = Scene::open(scene).unwrap();
        let (appearance, mut world) = (scene.appearance().unwrap(), World::new());
        let names = scene.spawn(&mut world).unwrap();
        let order = BodyOrder::of(&world);
        Bodies::of(&Frame { step: 0, time: 0.0, world: &world, order: &order, names: &names }, &appearance)
    }

    #[test]
    fn what_does_not_fit_is_a_box_of_its_size() {
        let bodies = bodies("t-handle");
        let surface = &bodies.geometry.surfaces[0];
        let whole = Surfaces::within(size(surface), &bodies);
        assert!(!whole.is_boxed(0));
        let written: usize = arrays(&whole.triangles(0, surface)).iter().map(Vec::len).sum();
        assert_eq!(whole.bytes, written as u64);
        let boxes = Surfaces::within(size(surface) - 1, &bodies);
        assert!(boxes.is_boxed(0) && boxes.bytes == 0);
        let corners = boxes.triangles(0, surface).positions;
        let (low, high) = (surface.min.map(f64::from), surface.max.map(f64::from));
        // Corners are made of the middle and half the size, each with a rounding.
        let is_near = |a: DVec3, b: [f64; 3]| (a - DVec3::from_array(b)).length() < 1e-15;
        assert!(is_near(corners.iter().copied().fold(DVec3::MAX, DVec3::min), low));
        assert!(is_near(corners.iter().copied().fold(DVec3::MIN, DVec3::max), high));
    }

    #[test]
    fn small_surfaces_are_kept_before_large_ones() {
        let bodies = bodies("stress");
        let surfaces = &bodies.geometry.surfaces;
        let all: u64 = surfaces.iter().map(size).sum();
        let half = Surfaces::within(all / 2, &bodies);
        assert!(half.bytes <= all / 2);
        let largest_kept = (0..surfaces.len()).filter(|&at| !half.is_boxed(at)).map(|at| size(&surfaces[at])).max();
        let smallest_boxed = (0..surfaces.len()).filter(|&at| half.is_boxed(at)).map(|at| size(&surfaces[at])).min();
        assert!(largest_kept <= smallest_boxed, "{largest_kept:?} {smallest_boxed:?}");
    }
}
