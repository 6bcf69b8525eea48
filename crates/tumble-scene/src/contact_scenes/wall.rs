use crate::collider_model::ColliderModel;
use crate::model::{BodyModel, SceneModel};

/// Half the size of a brick, along the wall, up, and through it \[m\].
const HALF: [f64; 3] = [0.2, 0.1, 0.1];
/// Height of a layer over width of the wall, about.
const SLENDER: f64 = 0.5;
/// Where the ball strikes, as a part of the wall's height.
const STRIKE: f64 = 0.6;
/// \[m/s\], and when \[s\].
const SPEED: f64 = 16.0;
const AFTER: f64 = 1.0;

/// Layers of bricks, every other one shifted by half a brick; the ball flies so long that the wall is first seen to stand.
pub(super) fn scene(bodies: usize) -> SceneModel {
    // Of as many layers as the wall is to have for its width, the next that has all bricks.
    let layers = (1..).find(|layers| columns(*layers) * layers >= bodies).unwrap_or(1);
    let columns = columns(layers);
    let brick = |index: usize| {
        let (layer, column) = (index / columns, index % columns);
        let shift = if layer % 2 == 0 { -0.25 } else { 0.25 };
        let along = 2.0 * HALF[0] * (column as f64 - 0.5 * (columns as f64 - 1.0) + shift);
        let place = [along, HALF[1] * (2.0 * layer as f64 + 1.0), 0.0];
        BodyModel::cuboid(HALF, place)
            .density(1800.0)
            .surface(ColliderModel::rough(0.6))
            .named(format!("brick-{layer}-{column}"))
    };
    let height = STRIKE * 2.0 * HALF[1] * layers as f64;
    let radius = 0.4;
    // Up and down again in the time.
    let start = [0.0, height.max(radius), -SPEED * AFTER - radius - HALF[2]];
    let ball = BodyModel::sphere(radius, start)
        .density(2450.0)
        .surface(ColliderModel::rough(0.5).rolling(0.01))
        .moving([0.0, 0.5 * 9.81 * AFTER, SPEED], [0.0; 3])
        .named("ball");
    SceneModel::of(300, (0..bodies).map(brick).chain([ball, BodyModel::ground()]).collect())
}

fn columns(layers: usize) -> usize {
    ((layers as f64 * HALF[1] / (HALF[0] * SLENDER)) as usize).max(1)
}
