//! Random numbers of one case of a test.

use glam::{DQuat, DVec3};
use tumble::Rng;

/// How many of a test's random cases to draw: all, or the percentage in `TUMBLE_CASES`.
#[must_use]
pub fn cases(all: u32) -> u32 {
    let percentage = std::env::var("TUMBLE_CASES").ok().and_then(|it| it.parse().ok()).unwrap_or(100_u32);
    (all * percentage.clamp(1, 1000)).div_ceil(100)
}

/// Random numbers of one case, from a stream of the test's own.
#[derive(Debug)]
pub struct Draw(Rng);

impl Draw {
    /// The numbers of a case.
    #[must_use]
    pub fn new(stream: u64, case: u64) -> Self {
        Self(Rng::stream(stream, case))
    }

    /// Uniform from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.unit()
    }

    /// Uniform in the logarithm, from `low` to `high`.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// True with this probability.
    pub fn often(&mut self, probability: f64) -> bool {
        self.0.unit() < probability
    }

    /// Uniform in a cube with edges from `-most` to `most`.
    pub fn vector(&mut self, most: f64) -> DVec3 {
        DVec3::new(self.between(-most, most), self.between(-most, most), self.between(-most, most))
    }

    /// A random rotation.
    pub fn orientation(&mut self) -> DQuat {
        let q = self.0.orientation();
        DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into()).normalize()
    }

    /// A random unit vector.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector(1.0);
            if (0.1..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }
}
