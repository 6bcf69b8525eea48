//! Promise: once a motion has been gone through, going through it again allocates nothing, whether
//! all move or a few, and whatever has no end.
//!
//! Why: an allocation in a game's frame is a hitch. There is one test in this file, because the
//! whole process is counted.

use alloc_tracker::{Allocator, Session};
use tumble_collide::{Aabb, BroadPhase, Proxy};
use tumble_math::lane::Vec3;

#[global_allocator]
static ALLOCATOR: Allocator<std::alloc::System> = Allocator::system();

const COUNT: u32 = 2000;

/// Places at a step: one in this number wanders, there and back.
fn place(proxies: &mut [Proxy<f32>], step: u32, every: u32) {
    let part = step.min(60 - step) as f32 / 30.0;
    for (i, proxy) in (0..).zip(proxies.iter_mut()).filter(|(i, _)| i % every == 0 && *i < COUNT) {
        let home = [i % 13, i / 13 % 13, i / 169].map(|place| 1.05 * place as f32);
        let way = [i * 7 % 11, i * 5 % 13, i * 3 % 7].map(|way| way as f32 - 5.0);
        let at = |axis: usize| home[axis] + 0.3 * part * way[axis];
        proxy.aabb = Some(Aabb::about(Vec3::new(at(0), at(1), at(2)), Vec3::splat(0.5)));
    }
}

#[test]
fn the_second_time_allocates_nothing() {
    let session = Session::new();
    let mut proxies = vec![Proxy { aabb: None, moves: true }; COUNT as usize];
    place(&mut proxies, 0, 1);
    let wall = Aabb::about(Vec3::zero(), Vec3::splat(3.0));
    proxies.extend([Proxy { aabb: None, moves: false }, Proxy { aabb: Some(wall), moves: false }]);
    for every in [1, 40] {
        // Every round begins as the first did, so it is the same.
        let mut broad_phase = BroadPhase::default();
        let mut round = || {
            broad_phase.reset();
            let steps = 0..60;
            steps
                .map(|step| {
                    place(&mut proxies, step, every);
                    broad_phase.update(&proxies, |_, _| true).len()
                })
                .sum::<usize>()
        };
        let first = round();
        let operation = session.operation(format!("every {every}"));
        let again = {
            let _span = operation.measure_process();
            round()
        };
        assert!(first == again && first > 60 * COUNT as usize, "{first} and {again} pairs");
        assert_eq!(operation.total_bytes_allocated(), 0, "every {every}");
    }

    // The counting counts.
    let operation = session.operation("a box");
    {
        let _span = operation.measure_process();
        drop(std::hint::black_box(Box::new(1)));
    }
    assert!(operation.total_bytes_allocated() > 0);
}
