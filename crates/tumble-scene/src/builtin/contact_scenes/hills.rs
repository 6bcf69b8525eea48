//! The hills scene: balls, boxes and capsules dropped on a height field with a raised rim.

use tumble::Rng;

use crate::model::collider_model::ColliderModel;
use crate::model::scene_model::{BodyModel, Row, Rows, SceneModel, ShapeModel};
use crate::values::tuple::Tuple;

/// Columns and rows of heights, and their distance \[m\].
const CROSSINGS: usize = 49;
const SPACING: f64 = 0.25;
/// How high hills are above the valleys between them \[m\].
const HEIGHT: f64 = 0.9;
/// How far apart they are, in cells.
const PERIOD: usize = 12;
/// How high the rim is, all around \[m\].
const RIM: f64 = 1.5;
/// Distance of bodies at the start \[m\], and how many there are along a side of a layer.
const PITCH: f64 = 0.9;
const SIDE: usize = 11;

/// Balls, boxes and pills fall on hills with hollows between them, in a bowl.
pub(crate) fn scene(bodies: usize, seed: u64) -> SceneModel {
    let mut rng = Rng::new(seed);
    let body = |index: usize| {
        let mut around = |middle: f64, width: f64| middle + width * (2.0 * rng.unit() - 1.0);
        let across = |cell: usize| PITCH * (cell as f64 - 0.5 * (SIDE as f64 - 1.0));
        let place = [
            around(across(index % SIDE), 0.2),
            HEIGHT + 1.0 + PITCH * (index / (SIDE * SIDE)) as f64,
            around(across(index / SIDE % SIDE), 0.2),
        ];
        let body = match index % 3 {
            0 => BodyModel::sphere(around(0.16, 0.06), place),
            1 => BodyModel::cuboid([around(0.15, 0.05), around(0.15, 0.05), around(0.15, 0.05)], place),
            _ => {
                let shape = ShapeModel::Capsule { radius: around(0.1, 0.03), half_height: around(0.15, 0.05) };
                BodyModel::touching(shape, place)
            }
        };
        let surface = ColliderModel::rough(0.5).rolling(0.005);
        body.density(800.0).surface(surface).named(format!("body-{index}"))
    };
    let mut all: Vec<_> = (0..bodies).map(body).collect();
    all.push(ground());
    SceneModel::of(900, all)
}

fn ground() -> BodyModel {
    let height = |column: usize, row: usize| HEIGHT * wave(column) * wave(row) + RIM * rim(column).max(rim(row));
    let row = |row: usize| Row((0..CROSSINGS).map(|column| height(column, row)).collect());
    let heights = Rows((0..CROSSINGS).map(row).collect());
    let shape = ShapeModel::HeightField { heights, spacing: Tuple([SPACING; 2]) };
    let body = BodyModel::touching(shape, [0.0; 3]);
    BodyModel { fixed: true, ..body }.surface(ColliderModel::rough(0.6)).named("ground")
}

/// 1 at the ends, and 0 from the first hollow to the last.
fn rim(cell: usize) -> f64 {
    let from_end = cell.min(CROSSINGS - 1 - cell) as f64 / (PERIOD / 2) as f64;
    (1.0 - from_end).max(0.0)
}

/// From 1 to 0 and back, smoothly: parabolas, so that no sine is needed.
fn wave(cell: usize) -> f64 {
    let phase = (cell % PERIOD) as f64 / PERIOD as f64;
    let from_top = phase.min(1.0 - phase) * 2.0;
    if from_top < 0.5 { 1.0 - 2.0 * from_top * from_top } else { 2.0 * (1.0 - from_top) * (1.0 - from_top) }
}
