//! The wall scene: a brick wall in running bond, hit by a heavy ball.

use crate::model::collider_model::ColliderModel;
use crate::model::scene_model::{BodyModel, SceneModel};

/// Half the size of a brick, along the wall, up, and through it \[m\].
const HALF: [f64; 3] = [0.2, 0.1, 0.1];
/// Radius of the ball \[m\], and where it strikes, as a part of the wall's height.
const RADIUS: f64 = 0.4;
const STRIKE: f64 = 0.6;
/// \[m/s\], and when \[s\].
const SPEED: f64 = 15.0;
const AFTER: f64 = 0.5;

/// Layers of bricks, every other one shifted by half a brick and with half bricks at its ends; the
/// ball flies long enough for the wall to be seen standing first.
pub(crate) fn scene(bodies: usize) -> SceneModel {
    // As many layers as bricks in one: twice as wide as high.
    let columns = (1..).find(|columns| columns * columns + columns / 2 >= bodies).unwrap_or(1);
    let mut all: Vec<_> = (0..).flat_map(|layer| course(layer, columns)).take(bodies).collect();
    let height = STRIKE * 2.0 * HALF[1] * columns as f64;
    // Up and down again in the time.
    let start = [0.0, height.max(RADIUS), -SPEED * AFTER - RADIUS - HALF[2]];
    let ball = BodyModel::sphere(RADIUS, start)
        .density(2450.0)
        .surface(ColliderModel::rough(0.5).rolling(0.01))
        .moving([0.0, 0.5 * 9.81 * AFTER, SPEED], [0.0; 3])
        .named("ball");
    all.extend([ball, BodyModel::ground()]);
    SceneModel::of(300, all)
}

fn course(layer: usize, columns: usize) -> impl Iterator<Item = BodyModel> {
    let is_shifted = !layer.is_multiple_of(2);
    (0..columns + usize::from(is_shifted)).map(move |column| {
        let is_half = is_shifted && (column == 0 || column == columns);
        // From the middle of the wall, in bricks.
        let shift = match (is_shifted, column) {
            (false, _) => 0.5,
            (true, 0) => 0.25,
            (true, column) if column == columns => -0.25,
            (true, _) => 0.0,
        };
        let along = 2.0 * HALF[0] * (column as f64 + shift - 0.5 * columns as f64);
        let half = if is_half { [0.5 * HALF[0], HALF[1], HALF[2]] } else { HALF };
        BodyModel::cuboid(half, [along, HALF[1] * (2.0 * layer as f64 + 1.0), 0.0])
            .density(1800.0)
            .surface(ColliderModel::rough(0.6))
            .named(format!("brick-{layer}-{column}"))
    })
}
