//! Deduplicated surface meshes of a binary glTF file, with their vertex and index buffers.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, Write};

use glam::DVec3;
use tumble::Shape;
use tumble_import::{Appearance, Tessellation};

use crate::trajectory::glb::sample::single;

const VERTEX: u64 = size_of::<[f32; 3]>() as u64;

/// The different surfaces among bodies. Balls, blocks, cylinders and cones of all sizes are
/// stretched from one of each.
///
/// ```
/// use tumble::{Shape, glam::DVec3};
/// use tumble_import::Appearance;
/// use tumble_record::SurfaceSet;
///
/// let mut surfaces = SurfaceSet::default();
/// assert_eq!(surfaces.insert(&Appearance::Shape(Shape::sphere(2.0))), (0, DVec3::splat(2.0)));
/// assert_eq!(surfaces.insert(&Appearance::Shape(Shape::sphere(3.0))), (0, DVec3::splat(3.0)));
/// assert_eq!(surfaces.tessellations().count(), 1);
/// ```
#[derive(Debug, Default)]
pub struct SurfaceSet {
    pub(crate) surfaces: Vec<Surface>,
    /// By the bits of the volume or the number of triangles, for equal ones have the same.
    alike: HashMap<u64, Vec<usize>>,
}

/// A surface, made again whenever it is written, for there may be many.
#[derive(Debug)]
pub(crate) struct Surface {
    appearance: Appearance,
    pub(crate) vertices: u64,
    pub(crate) corners: u64,
    /// The box around it \[m\].
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
    /// From the beginning of all vertices and of all indices \[bytes\].
    pub(crate) vertices_at: u64,
    pub(crate) indices_at: u64,
}

impl Surface {
    /// Where the normals are, from the beginning of all vertices \[bytes\].
    pub(crate) fn normals_at(&self) -> u64 {
        self.vertices_at + self.vertices * VERTEX
    }

    /// Whether indices have 16 bits, of which the largest number is not to be an index, or 32.
    pub(crate) fn is_small(&self) -> bool {
        self.vertices <= u64::from(u16::MAX)
    }

    /// Its triangles.
    pub(crate) fn tessellation(&self) -> Tessellation {
        Tessellation::of_appearance(&self.appearance)
    }

    fn index_bytes(&self) -> u64 {
        if self.is_small() { (self.corners * 2).next_multiple_of(4) } else { self.corners * 4 }
    }
}

impl SurfaceSet {
    /// The triangles of all surfaces, each made when it is asked for.
    pub fn tessellations(&self) -> impl Iterator<Item = Tessellation> {
        self.surfaces.iter().map(Surface::tessellation)
    }

    /// The index of the surface of a body, and the factors to stretch it by.
    pub fn insert(&mut self, appearance: &Appearance) -> (usize, DVec3) {
        let (appearance, factors) = match appearance {
            Appearance::Shape(shape) => {
                let (shape, factors) = unstretched(shape);
                (Appearance::Shape(shape), factors)
            }
            unstretched => (unstretched.clone(), DVec3::ONE),
        };
        let key = match &appearance {
            Appearance::Shape(shape) => shape.volume().map_or_else(|| of_its_text(shape), f64::to_bits),
            Appearance::Mesh(mesh) => mesh.triangles().len() as u64,
            Appearance::HeightField(heights) => heights.triangles().triangles().len() as u64,
            Appearance::HalfSpace => 0,
        };
        let same = self.alike.entry(key).or_default();
        let known = same
            .iter()
            .copied()
            .find(|&index| self.surfaces.get(index).is_some_and(|known| known.appearance == appearance));
        let index = known.unwrap_or_else(|| {
            let index = self.surfaces.len();
            same.push(index);
            let (vertices_at, indices_at) = self.surfaces.last().map_or((0, 0), |last| {
                (last.normals_at() + last.vertices * VERTEX, last.indices_at + last.index_bytes())
            });
            self.surfaces.push(measured(appearance, vertices_at, indices_at));
            index
        });
        (index, factors)
    }

    pub(crate) fn vertex_bytes(&self) -> u64 {
        self.surfaces.last().map_or(0, |last| last.normals_at() + last.vertices * VERTEX)
    }

    pub(crate) fn index_bytes(&self) -> u64 {
        self.surfaces.last().map_or(0, |last| last.indices_at + last.index_bytes())
    }

    /// Writes all vertices and then all indices.
    pub(crate) fn write(&self, writer: &mut impl Write) -> io::Result<()> {
        for surface in &self.surfaces {
            let triangles = surface.tessellation();
            for vector in triangles.positions.iter().chain(&triangles.normals) {
                for number in vector.to_array() {
                    writer.write_all(&single(number).to_le_bytes())?;
                }
            }
        }
        for surface in &self.surfaces {
            let indices = surface.tessellation().triangles.into_iter().flatten();
            if surface.is_small() {
                for index in indices {
                    writer.write_all(&(index as u16).to_le_bytes())?;
                }
                writer.write_all(if surface.corners.is_multiple_of(2) { &[] } else { &[0, 0] })?;
            } else {
                for index in indices {
                    writer.write_all(&index.to_le_bytes())?;
                }
            }
        }
        Ok(())
    }
}

/// A number that equal shapes have in common, for those without a volume.
fn of_its_text(shape: &Shape) -> u64 {
    let mut hasher = DefaultHasher::new();
    format!("{shape:?}").hash(&mut hasher);
    hasher.finish()
}

fn measured(appearance: Appearance, vertices_at: u64, indices_at: u64) -> Surface {
    let triangles = Tessellation::of_appearance(&appearance);
    let positions = || triangles.positions.iter().map(|position| position.to_array().map(single));
    let each = |a: [f32; 3], b: [f32; 3], of: fn(f32, f32) -> f32| std::array::from_fn(|axis| of(a[axis], b[axis]));
    Surface {
        vertices: triangles.positions.len() as u64,
        corners: 3 * triangles.triangles.len() as u64,
        min: positions().reduce(|a, b| each(a, b, f32::min)).unwrap_or_default(),
        max: positions().reduce(|a, b| each(a, b, f32::max)).unwrap_or_default(),
        vertices_at,
        indices_at,
        appearance,
    }
}

/// The shape of unit size, and the factors that make the shape of it.
fn unstretched(shape: &Shape) -> (Shape, DVec3) {
    match *shape {
        Shape::Sphere { radius } | Shape::HollowSphere { radius } => (Shape::sphere(1.0), DVec3::splat(radius)),
        Shape::Ellipsoid { radii } => (Shape::sphere(1.0), radii),
        Shape::Cuboid { half_extents } => (Shape::cuboid(DVec3::ONE), half_extents),
        Shape::Cylinder { radius, half_height } => (Shape::cylinder(1.0, 1.0), DVec3::new(radius, half_height, radius)),
        Shape::Cone { radius, half_height } => (Shape::cone(1.0, 1.0), DVec3::new(radius, half_height, radius)),
        _ => (shape.clone(), DVec3::ONE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_is_there_once_and_stretched_to_its_size() {
        let mut surfaces = SurfaceSet::default();
        let mut inserted = |shape| surfaces.insert(&Appearance::Shape(shape));
        assert_eq!(inserted(Shape::sphere(2.0)), (0, DVec3::splat(2.0)));
        assert_eq!(inserted(Shape::ellipsoid([1.0, 2.0, 3.0])), (0, DVec3::new(1.0, 2.0, 3.0)));
        assert_eq!(inserted(Shape::hollow_sphere(0.5)), (0, DVec3::splat(0.5)));
        assert_eq!(inserted(Shape::capsule(1.0, 2.0)), (1, DVec3::ONE));
        assert_eq!(inserted(Shape::capsule(1.0, 2.5)), (2, DVec3::ONE));
        assert_eq!(inserted(Shape::capsule(1.0, 2.0)), (1, DVec3::ONE));
        assert_eq!(inserted(Shape::Point), (3, DVec3::ONE));
        let mut bytes = Vec::new();
        surfaces.write(&mut bytes).unwrap();
        assert_eq!(bytes.len() as u64, surfaces.vertex_bytes() + surfaces.index_bytes());
    }

    /// What is stretched here is the surface of the shape itself.
    #[test]
    fn stretching_gives_the_shape() {
        let shapes = [
            Shape::sphere(2.0),
            Shape::ellipsoid([0.1, 2.0, 3.0]),
            Shape::cuboid([1.0, 2.0, 3.0]),
            Shape::cylinder(0.3, 2.0),
            Shape::cone(0.3, 2.0),
        ];
        for shape in shapes {
            let (unit, factors) = unstretched(&shape);
            let (stretched, direct) = (Tessellation::of(&unit).stretched(factors), Tessellation::of(&shape));
            assert_eq!(stretched.triangles, direct.triangles);
            let vectors = |surface: &Tessellation| [surface.positions.clone(), surface.normals.clone()].concat();
            // A few roundings of lengths up to 3.
            for (a, b) in vectors(&stretched).into_iter().zip(vectors(&direct)) {
                assert!((a - b).length() < 4e-15, "{shape:?}: {a} {b}");
            }
        }
    }
}
