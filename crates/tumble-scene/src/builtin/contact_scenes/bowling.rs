//! The bowling scene: a rolling ball and ten compound pins.

use crate::model::collider_model::ColliderModel;
use crate::model::scene_model::{BodyModel, PartModel, SceneModel, ShapeModel};
use crate::values::tuple::Tuple;

/// Distance between the spots of neighbouring pins: 12 inches \[m\].
const SPOTS: f64 = 0.3048;
/// Half the height of a pin, which is 15 inches \[m\], and its mass \[kg\].
const HALF_HEIGHT: f64 = 0.19;
const PIN: f64 = 1.55;
/// The ball's radius \[m\], mass \[kg\] and speed [m/s].
const RADIUS: f64 = 0.1085;
const BALL: f64 = 6.8;
const SPEED: f64 = 8.0;

/// The ball rolls along x into the side of the first pin, as bowlers want it.
pub(crate) fn scene() -> SceneModel {
    let row_apart = SPOTS * 0.75_f64.sqrt();
    let pins = (0..4).flat_map(|row: usize| (0..=row).map(move |place| (row, place)));
    let pin = |(row, place): (usize, usize)| {
        let at = [row_apart * row as f64, HALF_HEIGHT, SPOTS * (place as f64 - 0.5 * row as f64)];
        BodyModel::touching(shape(), at)
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

/// A foot, a neck and a head, from the ground to the top.
fn shape() -> ShapeModel {
    let part = |shape: ShapeModel, height: f64, density: f64| PartModel {
        shape,
        position: Some(Tuple([0.0, height - HALF_HEIGHT, 0.0])),
        orientation: None,
        mass: None,
        density: Some(density),
    };
    let parts = vec![
        part(ShapeModel::Cylinder { radius: 0.05, half_height: 0.11 }, 0.11, 700.0),
        part(ShapeModel::Cylinder { radius: 0.026, half_height: 0.055 }, 0.275, 700.0),
        part(ShapeModel::Sphere { radius: 0.033 }, 2.0 * HALF_HEIGHT - 0.033, 700.0),
    ];
    ShapeModel::Compound { parts }
}
