//! Random shapes of all kinds, from a centimetre to a hundred metres and of aspects to 1:500.

#![allow(clippy::unwrap_used, reason = "a test without what it tests is to fail")]
#![allow(dead_code, reason = "each test uses a part of it")]

use std::sync::Arc;

use tumble_collide::{ColliderShape, Compound, ConvexHull, HeightField, Isometry, Mesh};
use tumble_math::lane::{Quat, Vec3};

pub(crate) type Vector = Vec3<f64>;

/// Random numbers of one case: SplitMix64.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(case: u64) -> Self {
        Self(case.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }

    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub(crate) fn often(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    pub(crate) fn vector(&mut self, most: f64) -> Vector {
        Vec3::new(self.between(-most, most), self.between(-most, most), self.between(-most, most))
    }

    pub(crate) fn direction(&mut self) -> Vector {
        loop {
            let v = self.vector(1.0);
            let length = length(v);
            if (0.1..1.0).contains(&length) {
                return v * (1.0 / length);
            }
        }
    }

    pub(crate) fn rotation(&mut self) -> Quat<f64> {
        if self.often(0.2) {
            // Faces along the axes are what games are made of.
            let half = std::f64::consts::FRAC_1_SQRT_2;
            let w = [1.0, half][self.below(2)];
            return Quat { x: 0.0, y: (1.0 - w * w).sqrt(), z: 0.0, w }.normalize();
        }
        loop {
            let [x, y, z, w] = [0; 4].map(|_| self.between(-1.0, 1.0));
            let quat = Quat { x, y, z, w };
            if (0.01..1.0).contains(&quat.length_squared()) {
                return quat.normalize();
            }
        }
    }

    pub(crate) fn placement(&mut self, most: f64) -> Isometry<f64> {
        Isometry { position: self.vector(most), orientation: self.rotation() }
    }
}

pub(crate) fn length(v: Vector) -> f64 {
    v.dot(v).sqrt()
}

/// The kinds of solid shapes that are no compounds.
pub(crate) const SOLID: [&str; 9] =
    ["sphere", "cuboid", "capsule", "cylinder", "cone", "frustum", "tapered", "ellipsoid", "hull"];

/// A solid shape of a kind, and the longest of its lengths \[m\].
pub(crate) fn solid(kind: &str, random: &mut Random) -> (ColliderShape<f64>, f64) {
    let size = random.log_between(0.01, 100.0);
    let thin = size / random.log_between(1.0, 500.0);
    let middle = random.log_between(thin, size * 1.000_001);
    let mut lengths = [size, middle, thin];
    lengths.rotate_left(random.below(3));
    let [a, b, c] = lengths;
    let shape = match kind {
        "sphere" => ColliderShape::Sphere { radius: size },
        "cuboid" => ColliderShape::Cuboid { half_extents: Vec3::new(a, b, c) },
        "capsule" => ColliderShape::Capsule { radius: a, half_height: b },
        "cylinder" => ColliderShape::Cylinder { radius: a, half_height: b },
        "cone" => ColliderShape::Cone { radius: a, half_height: b },
        "frustum" => ColliderShape::Frustum { radius_bottom: a, radius_top: b, half_height: c },
        "tapered" => ColliderShape::TaperedCapsule { radius_bottom: a, radius_top: b, half_height: c },
        "ellipsoid" => ColliderShape::Ellipsoid { radii: Vec3::new(a, b, c) },
        _ => loop {
            let count = 4 + random.below(40);
            let points: Vec<_> = (0..count).map(|_| random.vector(1.0).scale(Vec3::new(a, b, c))).collect();
            if let Ok(hull) = ConvexHull::new(&points) {
                break ColliderShape::Hull(Arc::new(hull));
            }
        },
    };
    (shape, size)
}

/// The triangles of an open surface: heights over a grid, and the same as a mesh.
pub(crate) fn hills(random: &mut Random) -> (ColliderShape<f64>, ColliderShape<f64>, f64) {
    let (columns, rows) = (2 + random.below(12), 2 + random.below(12));
    let size = random.log_between(0.01, 100.0);
    let spacing = [size, size * random.between(0.3, 3.0)];
    let flat = if random.often(0.2) { 0.0 } else { random.between(0.0, 2.0) };
    let heights: Vec<_> = (0..columns * rows).map(|_| random.between(0.0, size * flat)).collect();
    let field = HeightField::new(&heights, columns, spacing).unwrap();
    let wide = columns as u32;
    let mut triangles = Vec::new();
    for row in 0..rows as u32 - 1 {
        for column in 0..wide - 1 {
            let here = row * wide + column;
            triangles.extend([[here, here + wide, here + wide + 1], [here, here + wide + 1, here + 1]]);
        }
    }
    let mesh = Mesh::new(field.points(), &triangles).unwrap();
    let reach = size * (columns + 3 * rows) as f64;
    (ColliderShape::HeightField(Arc::new(field)), ColliderShape::Mesh(Arc::new(mesh)), reach)
}

/// Several solid shapes at random places.
pub(crate) fn compound(random: &mut Random) -> (ColliderShape<f64>, f64) {
    let (first, size) = solid(SOLID[random.below(SOLID.len())], random);
    let mut parts = vec![(random.placement(size), first)];
    for _ in 0..random.below(5) {
        let (part, other) = solid(SOLID[random.below(SOLID.len())], random);
        parts.push((random.placement(size.max(other)), part));
    }
    let shape = Compound::new(parts);
    let reach = shape.reach().unwrap();
    (ColliderShape::Compound(Arc::new(shape)), reach)
}
