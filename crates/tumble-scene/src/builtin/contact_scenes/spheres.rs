//! The spheres scene: jittered layers of balls dropped between four half-space walls.

use crate::model::scene_model::{BodyModel, SceneModel};

/// Places along a side of a layer, and the distance between them \[m\].
const SIDE: usize = 18;
const PITCH: f64 = 1.1;
/// How far a ball may be from its place, either way \[m\].
const JITTER: f64 = 0.04;
/// Half the width of the box \[m\].
const HALF_WIDTH: f64 = 10.0;

/// Layers of balls that are not quite above each other, over a box of a floor and four walls.
pub(crate) fn scene(bodies: usize, seed: u64) -> SceneModel {
    // Knuth's generator for MMIX, of which others who measure with this scene take the upper bits.
    let mut state = seed.wrapping_add(7);
    let mut jitter = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        JITTER * (2.0 * (state >> 33) as f64 / 2_147_483_648.0 - 1.0)
    };
    let ball = |index: usize| {
        let across = |cell: usize| PITCH * (cell as f64 - 0.5 * (SIDE as f64 - 1.0));
        let layer = index / (SIDE * SIDE);
        let (x, y, z) = (jitter(), jitter(), jitter());
        let place = [across(index % SIDE) + x, 1.0 + PITCH * layer as f64 + y, across(index / SIDE % SIDE) + z];
        BodyModel::sphere(0.5, place).mass(1.0).named(format!("ball-{index}"))
    };
    let walls = [
        ("west", [1.0, 0.0, 0.0], [-HALF_WIDTH, 0.0, 0.0]),
        ("east", [-1.0, 0.0, 0.0], [HALF_WIDTH, 0.0, 0.0]),
        ("north", [0.0, 0.0, 1.0], [0.0, 0.0, -HALF_WIDTH]),
        ("south", [0.0, 0.0, -1.0], [0.0, 0.0, HALF_WIDTH]),
    ];
    let walls = walls.into_iter().map(|(name, normal, place)| BodyModel::half_space(name, normal, place));
    let balls: Vec<_> = (0..bodies).map(ball).collect();
    SceneModel::of(600, balls.into_iter().chain([BodyModel::ground()]).chain(walls).collect())
}
