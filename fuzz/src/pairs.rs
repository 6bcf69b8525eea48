//! Two shapes of bytes, which meet: in bounded work, with numbers for an answer.

use std::sync::Arc;

use tumble_collide::{Compound, ConvexHull, ColliderShape, Mesh, Isometry, contact_manifolds, work_done};
use tumble_math::lane::{Quat, Vec3};

/// Of a pair of convex shapes, as `pair_tests.rs` in `tumble-collide` has them.
const MAX_REACHED: usize = 4096;
const MAX_COMPARED: usize = (1 << 18) + (1 << 13);

/// Reads numbers as long as there are bytes, and zeros after that.
pub(crate) struct Bytes<'a>(pub(crate) std::slice::Iter<'a, u8>);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }

    /// From -1 to 1, with one sixteenth of them on some grid.
    pub(crate) fn part(&mut self) -> f64 {
        let [high, low] = [self.byte(), self.byte()];
        let low = if high % 16 == 0 { 0 } else { low };
        f64::from(i16::from_be_bytes([high, low])) / 32_768.0
    }

    /// From a millimetre to a hundred metres \[m\].
    fn length(&mut self) -> f64 {
        10.0_f64.powf(-0.5 + 2.5 * self.part())
    }

    pub(crate) fn vector(&mut self, scale: f64) -> Vec3<f64> {
        Vec3::new(self.part() * scale, self.part() * scale, self.part() * scale)
    }

    pub(crate) fn orientation(&mut self) -> Quat<f64> {
        let [x, y, z, w] = [self.part(), self.part(), self.part(), self.part()];
        let turned = Quat { x, y, z, w };
        if turned.length_squared() > 1e-4 { turned.normalize() } else { Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 } }
    }

    fn points(&mut self) -> Vec<Vec3<f64>> {
        let (count, size) = (4 + usize::from(self.byte() % 28), self.length());
        (0..count).map(|_| self.vector(size)).collect()
    }

    pub(crate) fn shape(&mut self, depth: u32) -> Option<ColliderShape<f64>> {
        let kind = self.byte() % if depth == 0 { 11 } else { 9 };
        let [a, b, c] = [self.length(), self.length(), self.length()];
        Some(match kind {
            0 => ColliderShape::Sphere { radius: a },
            1 => ColliderShape::Cuboid { half_extents: Vec3::new(a, b, c) },
            2 => ColliderShape::Capsule { radius: a, half_height: b },
            3 => ColliderShape::Cylinder { radius: a, half_height: b },
            4 => ColliderShape::Cone { radius: a, half_height: b },
            5 => ColliderShape::Frustum { radius_bottom: a, radius_top: b, half_height: c },
            6 => ColliderShape::TaperedCapsule { radius_bottom: a, radius_top: b, half_height: c },
            7 => ColliderShape::Ellipsoid { radii: Vec3::new(a, b, c) },
            8 => ColliderShape::Hull(Arc::new(ConvexHull::new(&self.points()).ok()?)),
            9 => {
                let points = self.points();
                let corner = |byte: u8| u32::from(byte) % points.len() as u32;
                let triangles: Vec<[u32; 3]> = (0..1 + self.byte() % 16)
                    .map(|_| [corner(self.byte()), corner(self.byte()), corner(self.byte())])
                    .collect();
                ColliderShape::Mesh(Arc::new(Mesh::new(&points, &triangles).ok()?))
            }
            _ => {
                let count = 1 + self.byte() % 4;
                let parts: Option<Vec<_>> = (0..count)
                    .map(|_| {
                        let placement = Isometry { position: self.vector(a), orientation: self.orientation() };
                        Some((placement, self.shape(depth + 1)?))
                    })
                    .collect();
                ColliderShape::Compound(Arc::new(Compound::new(parts?)))
            }
        })
    }
}

/// How many convex shapes a shape is.
fn parts(shape: &ColliderShape<f64>) -> usize {
    match shape {
        ColliderShape::Mesh(mesh) => mesh.triangles().len(),
        ColliderShape::Compound(compound) => compound.parts().iter().map(|(_, part)| parts(part)).sum(),
        _ => 1,
    }
}

/// Has two shapes of these bytes meet.
pub fn meet(bytes: &[u8]) {
    let mut bytes = Bytes(bytes.iter());
    let (Some(first), Some(second)) = (bytes.shape(0), bytes.shape(0)) else { return };
    let orientation = bytes.orientation();
    let reach = first.reach().unwrap_or(1.0) + second.reach().unwrap_or(1.0);
    let position = bytes.vector(reach);
    let margin = 0.02 * bytes.part().abs();
    let here = Isometry::at(Vec3::zero());
    let _ = work_done();
    contact_manifolds(&first, &here, &second, &Isometry { position, orientation }, margin, &mut |part, manifold| {
        let numbers = [manifold.normal.x, manifold.normal.y, manifold.normal.z];
        assert!(numbers.iter().all(|number| number.is_finite()), "part {part}: {manifold:?}");
        for point in manifold.points() {
            assert!(point.separation.is_finite() && point.separation <= 2.0 * margin + 1e-9 * reach, "{point:?}");
        }
    });
    let [reached, compared, multiplied] = work_done();
    let pairs = parts(&first) * parts(&second);
    assert!(reached <= pairs * MAX_REACHED, "{reached} points reached of {pairs} pairs");
    assert!(compared <= pairs * MAX_COMPARED, "{compared} faces and sides compared of {pairs} pairs");
    // A hull here has at most 31 corners and 58 faces, each gone through for a point that is
    // reached.
    assert!(multiplied <= pairs * MAX_REACHED * 128, "{multiplied} products of {pairs} pairs");
}
