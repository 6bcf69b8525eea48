//! The pyramid scene: square layers of boxes, each one box narrower than the layer below.

use crate::model::scene_model::{BodyModel, SceneModel};

/// Distance between the middles of neighbours \[m\].
const PITCH: f64 = 1.1;

/// Layers of boxes, each one box shorter on either side than that below; what is too few for a
/// whole pyramid is missing at its top.
pub(crate) fn scene(bodies: usize) -> SceneModel {
    let whole = |base: usize| base * (base + 1) * (2 * base + 1) / 6;
    let base = (1..).find(|base| whole(*base) >= bodies).unwrap_or(1);
    let place = move |layer: usize| {
        let side = base - layer;
        let across = move |cell: usize| PITCH * (cell as f64 - 0.5 * (side as f64 - 1.0));
        (0..side * side).map(move |cell| [across(cell / side), 0.5 + layer as f64, across(cell % side)])
    };
    let boxes = (0..base).flat_map(place).take(bodies).enumerate();
    let boxes = boxes.map(|(index, place)| BodyModel::cuboid([0.5; 3], place).mass(1.0).named(format!("box-{index}")));
    SceneModel::of(600, boxes.chain([BodyModel::ground()]).collect())
}
