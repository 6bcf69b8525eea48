//! debug
mod shared;
use shared::Stage;
use tumble::prelude::*;
#[test]
fn dbg() {
    let mut stage = Stage::with_ground(120);
    let height = 0.18;
    stage.block(Vec3::new(51.0, height * 0.5, 0.0), Vec3::new(50.0, height * 0.5, 3.0));
    let hero = stage.hero(Vec3::new(0.72, 0.0, 0.0));
    stage.steer(hero, Vec3::X * 0.5);
    for s in stage.play(hero, 0.2) { println!("{:?} {:?} v {:?} n {:?}", s.position, s.state.ground, s.state.velocity, s.state.ground_normal); }
}
