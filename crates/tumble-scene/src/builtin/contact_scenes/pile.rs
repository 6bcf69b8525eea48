//! The pile scene: randomly oriented bodies of mixed shapes dropped on one heap.

use tumble::Rng;

use crate::model::collider_model::ColliderModel;
use crate::model::scene_model::{BodyModel, SceneModel, ShapeModel};

/// Distance between the places of a layer, and between layers \[m\]; no body is longer.
const PITCH: f64 = 1.0;
/// Places along a side of a layer.
const SIDE: usize = 5;

/// Layers above each other, turned at random, fall on one heap.
pub(crate) fn scene(bodies: usize, seed: u64) -> SceneModel {
    let mut rng = Rng::new(seed);
    let body = |index: usize| {
        let across = |cell: usize| PITCH * (cell as f64 - 0.5 * (SIDE as f64 - 1.0));
        let layer = index / (SIDE * SIDE);
        let place = [across(index % SIDE), 0.8 + PITCH * layer as f64, across(index / SIDE % SIDE)];
        let mut length = |low: f64, high: f64| low + (high - low) * rng.unit();
        let body = match index % 7 {
            0 => BodyModel::sphere(length(0.15, 0.35), place),
            1 => BodyModel::cuboid([length(0.1, 0.25), length(0.1, 0.25), length(0.1, 0.25)], place),
            2 => BodyModel::cuboid([length(0.35, 0.45), length(0.05, 0.08), length(0.1, 0.15)], place),
            3 => BodyModel::touching(
                ShapeModel::Cylinder { radius: length(0.1, 0.25), half_height: length(0.08, 0.25) },
                place,
            ),
            4 => BodyModel::touching(
                ShapeModel::Capsule { radius: length(0.08, 0.15), half_height: length(0.1, 0.25) },
                place,
            ),
            5 => BodyModel::touching(
                ShapeModel::Cone { radius: length(0.15, 0.25), half_height: length(0.15, 0.25) },
                place,
            ),
            _ => {
                let half = length(0.12, 0.28);
                BodyModel::cuboid([half; 3], place)
            }
        };
        // Uniform enough: a point of a ball in four dimensions, far from its middle.
        let turn = loop {
            let turn: [f64; 4] = std::array::from_fn(|_| 2.0 * rng.unit() - 1.0);
            let square: f64 = turn.iter().map(|part| part * part).sum();
            if (0.01..=1.0).contains(&square) {
                break turn;
            }
        };
        let surface = ColliderModel::rough(0.5).rolling(0.02);
        body.density(800.0).turned(turn).surface(surface).named(format!("body-{index}"))
    };
    let mut all: Vec<_> = (0..bodies).map(body).collect();
    all.push(BodyModel::ground());
    SceneModel::of(900, all)
}
