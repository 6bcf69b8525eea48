//! What it costs to find what is near what, for balls of a metre in a box of walls and for what is
//! a hundred times as large beside them.
//!
//! - `falling`: all fall, at 5 m/s and 60 steps a second, each ball with a way of its own besides
//!   of a fifth of a metre;
//! - `mixing`: every ball goes its own way, up to 1.5 m/s along each axis, so that neighbours do
//!   not stay neighbours;
//! - `at rest`: they tremble by a tenth of a millimetre;
//! - `from nothing`: after a reset.
//!
//! Only the search is measured, not the motion. `cargo bench --bench broad_phase -- falling`.

mod setup;

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tumble::Rng;
use tumble_benches::OnDemand;
use tumble_collide::{Aabb, BroadPhase, Proxy};
use tumble_math::lane::Vec3;

const SIZES: [usize; 5] = [1_000, 3_000, 5_000, 10_000, 30_000];
/// Half a ball's box, with half of what counts as near \[m\].
const HALF: f32 = 0.51;
const PITCH: f32 = 1.1;
/// The steps that a motion takes one way before it comes back.
const WAY: usize = 60;

#[derive(Clone, Copy)]
enum Motion {
    Falling,
    Mixing,
    AtRest,
}

/// Balls in layers, and the walls about them.
struct Pile {
    motion: Motion,
    homes: Vec<Vec3<f32>>,
    /// Where each goes besides \[m\], from -1 to 1 along each axis.
    ways: Vec<Vec3<f32>>,
    step: usize,
    proxies: Vec<Proxy<f32>>,
}

impl Pile {
    fn new(count: usize, motion: Motion) -> Self {
        let mut rng = Rng::new(7);
        let side = (count as f32).cbrt().round() as usize;
        let mut number = || (2.0 * rng.unit() - 1.0) as f32;
        let ways = (0..count).map(|_| Vec3::new(number(), number(), number())).collect();
        let home = |i: usize| [i % side, i / (side * side), i / side % side].map(|place| PITCH * place as f32);
        let homes: Vec<Vec3<f32>> = (0..count).map(home).map(|[x, y, z]| Vec3::new(x, y, z)).collect();
        let (middle, wide) = (0.5 * PITCH * side as f32, 100.0 * side as f32);
        let wall = |x: f32, y: f32, z: f32, half: [f32; 3]| {
            let center = Vec3::new(middle + x, middle + y, middle + z);
            Proxy { aabb: Some(Aabb::about(center, Vec3::new(half[0], half[1], half[2]))), moves: false }
        };
        let out = middle + 1.0;
        let mut proxies = vec![
            wall(0.0, -out, 0.0, [wide, 0.5, wide]),
            wall(-out, 0.0, 0.0, [0.5, wide, wide]),
            wall(out, 0.0, 0.0, [0.5, wide, wide]),
            wall(0.0, 0.0, -out, [wide, wide, 0.5]),
            wall(0.0, 0.0, out, [wide, wide, 0.5]),
        ];
        proxies.extend(homes.iter().map(|home| proxy(*home)));
        Self { motion, homes, ways, step: 0, proxies }
    }

    fn advance(&mut self) {
        self.step = (self.step + 1) % (2 * WAY);
        // There and back, from 0 to 1.
        let part = self.step.min(2 * WAY - self.step) as f32 / WAY as f32;
        for ((home, way), proxy) in self.homes.iter().zip(&self.ways).zip(&mut self.proxies[5..]) {
            let place = match self.motion {
                Motion::Falling => *home + Vec3::new(0.0, 5.0 * (1.0 - part), 0.0) + *way * (0.2 * part),
                Motion::Mixing => *home + *way * (1.5 * part),
                Motion::AtRest => *home + *way * (1e-4 * part),
            };
            *proxy = self::proxy(place);
        }
    }
}

fn proxy(center: Vec3<f32>) -> Proxy<f32> {
    Proxy { aabb: Some(Aabb::about(center, Vec3::splat(HALF))), moves: true }
}

fn motions(criterion: &mut Criterion) {
    for (name, motion) in [("falling", Motion::Falling), ("mixing", Motion::Mixing), ("at rest", Motion::AtRest)] {
        let mut group = criterion.benchmark_group(name);
        for size in SIZES {
            let mut pile = OnDemand::new(|| Pile::new(size, motion));
            let mut broad_phase = BroadPhase::default();
            group.throughput(Throughput::Elements(size as u64));
            group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
                let pile = pile.get();
                bencher.iter_custom(|count| {
                    let mut spent = Duration::ZERO;
                    for _ in 0..count {
                        pile.advance();
                        let begin = Instant::now();
                        black_box(broad_phase.update(&pile.proxies, |_, _| true));
                        spent += begin.elapsed();
                    }
                    spent
                });
            });
        }
    }
}

fn from_nothing(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("from nothing");
    for size in SIZES {
        let mut pile = OnDemand::new(|| Pile::new(size, Motion::AtRest));
        let mut broad_phase = BroadPhase::default();
        group.throughput(Throughput::Elements(size as u64));
        group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
            let pile = pile.get();
            bencher.iter(|| {
                broad_phase.reset();
                broad_phase.update(&pile.proxies, |_, _| true).len()
            });
        });
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = motions, from_nothing
}
criterion_main!(benches);
