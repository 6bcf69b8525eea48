use crate::collider_model::ColliderModel;
use crate::model::{BodyModel, SceneModel};

/// Distance between the spots of neighbouring pins: 12 inches \[m\].
const SPOTS: f64 = 0.3048;
/// Half the size of a block that stands for a pin \[m\], and its mass \[kg\].
const HALF: [f64; 3] = [0.045, 0.19, 0.045];
const PIN: f64 = 1.55;
/// The ball's radius \[m\], mass \[kg\] and speed [m/s].
const RADIUS: f64 = 0.1085;
const BALL: f64 = 6.8;
const SPEED: f64 = 8.0;

/// The ball rolls along x into the side of the first pin, as bowlers want it.
pub(super) fn scene() -> SceneModel {
    let row_apart = SPOTS * 0.75_f64.sqrt();
    let pins = (0..4).flat_map(|row: usize| (0..=row).map(move |place| (row, place)));
    let pin = |(row, place): (usize, usize)| {
        let at = [row_apart * row as f64, HALF[1], SPOTS * (place as f64 - 0.5 * row as f64)];
        BodyModel::cuboid(HALF, at)
            .mass(PIN)
            .surface(ColliderModel::rough(0.35).bouncing(0.5))
            .named(format!("pin-{}", row * (row + 1) / 2 + place + 1))
    };
    let ball = BodyModel::sphere(RADIUS, [-2.5, RADIUS, 0.045])
        .mass(BALL)
        .surface(ColliderModel::rough(0.15).bouncing(0.3))
        .moving([SPEED, 0.0, 0.0], [0.0, 0.0, -SPEED / RADIUS])
        .named("ball");
    SceneModel {
        dt: Some(1.0 / 120.0),
        ..SceneModel::of(480, pins.map(pin).chain([ball, BodyModel::ground()]).collect())
    }
}
