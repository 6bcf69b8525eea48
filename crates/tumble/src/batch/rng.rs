//! A seeded SplitMix64 generator with independent streams for scene setup.

use crate::math::{Quat, Real, Vec3};

/// A generator of pseudorandom numbers: the same ones for the same seed, everywhere and for ever.
///
/// For scenes that are set up at random. SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, "Fast
/// splittable pseudorandom number generators", OOPSLA 2014): a mixed counter, so that any number of
/// independent sequences can be had without making those before.
///
/// ```
/// use tumble::Rng;
///
/// // World 7 of a batch gets the same numbers whatever the other worlds do.
/// let (mut once, mut again) = (Rng::stream(42, 7), Rng::stream(42, 7));
/// assert_eq!(once.next_u64(), again.next_u64());
/// assert!((-1.0..=1.0).contains(&once.range(-1.0, 1.0)));
/// ```
#[derive(Clone, Debug)]
pub struct Rng(u64);

impl Rng {
    /// The sequence that belongs to a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Sequence `index` of those that belong to a seed; no two of them begin at the same place.
    pub fn stream(seed: u64, index: u64) -> Self {
        // Both steps are one-to-one in the index.
        Self(Self(Self(seed).next_u64() ^ index).next_u64())
    }

    /// 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1): one of 2^53 equally likely numbers.
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From `low` to `high`: one of 2^24 equally likely numbers, which every precision of the build
    /// can hold; their distance must be finite.
    pub fn range(&mut self, low: Real, high: Real) -> Real {
        let unit = (self.next_u64() >> 40) as Real / (1_u32 << 24) as Real;
        low + (high - low) * unit
    }

    /// Each component from `low` to `high`.
    pub fn vector(&mut self, low: Real, high: Real) -> Vec3 {
        let (x, y, z) = (self.range(low, high), self.range(low, high), self.range(low, high));
        Vec3::new(x, y, z)
    }

    /// A unit quaternion, every orientation equally likely.
    pub fn orientation(&mut self) -> Quat {
        loop {
            let (v, w) = (self.vector(-1.0, 1.0), self.range(-1.0, 1.0));
            let squared = v.x * v.x + v.y * v.y + v.z * v.z + w * w;
            if (0.01..=1.0).contains(&squared) {
                let scale = 1.0 / squared.sqrt();
                return Quat::from_xyzw(v.x * scale, v.y * scale, v.z * scale, w * scale);
            }
        }
    }
}
