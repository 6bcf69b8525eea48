//! The drum scene: balls and blocks in a rotating drum of kinematic panels.

use tumble::Rng;

use crate::model::collider_model::ColliderModel;
use crate::model::scene_model::{BodyModel, SceneModel};
use crate::values::tuple::Tuple;

/// Inner radius of the drum and half its length \[m\].
const RADIUS: f64 = 2.5;
const HALF_LENGTH: f64 = 1.0;
/// Half the thickness of a panel \[m\].
const HALF_THICKNESS: f64 = 0.1;
/// [rad/s]
const SPIN: f64 = 1.1;
const PANELS: usize = 8;

/// Each panel is a body of its own that turns about the axis of them all: that is where its centre
/// of mass is said to be.
pub(crate) fn scene(bodies: usize, seed: u64) -> SceneModel {
    let axis = RADIUS + 0.5;
    // A half, a quarter and an eighth of a turn's sines and cosines are square roots; the half
    // angle of an eighth has these.
    let step = [(0.5 + 0.125_f64.sqrt()).sqrt(), (0.5 - 0.125_f64.sqrt()).sqrt()];
    let mut half = [1.0_f64, 0.0];
    let mut all = Vec::with_capacity(bodies + PANELS + 2);
    for index in 0..PANELS {
        let [cos, sin] = half;
        // The rotation about z takes the panel from below the axis to its place.
        let out = RADIUS + HALF_THICKNESS;
        let (along, across) = (cos * cos - sin * sin, 2.0 * sin * cos);
        let place = [out * across, axis - out * along, 0.0];
        // As wide as the sides of the regular polygon, and by what is needed outside.
        let width = (2.0_f64.sqrt() - 1.0) * (RADIUS + 2.0 * HALF_THICKNESS);
        let panel = BodyModel::cuboid([width, HALF_THICKNESS, HALF_LENGTH], place)
            .turned([0.0, 0.0, sin, cos])
            .surface(ColliderModel::rough(0.8))
            .moving([0.0; 3], [0.0, 0.0, SPIN])
            .named(format!("panel-{index}"));
        all.push(BodyModel { kinematic: true, center_of_mass: Some(Tuple([0.0, out, 0.0])), ..panel });
        half = [cos * step[0] - sin * step[1], sin * step[0] + cos * step[1]];
    }
    all.extend(contents(bodies, axis, seed));
    for (name, side) in [("back", -1.0), ("front", 1.0)] {
        let end = BodyModel::half_space(name, [0.0, 0.0, -side], [0.0, axis, side * HALF_LENGTH]);
        all.push(end.surface(ColliderModel::rough(0.0)));
    }
    SceneModel::of(1200, all)
}

/// Balls and blocks on a grid in the middle of the drum, of sizes that leave room for all.
fn contents(bodies: usize, axis: f64, seed: u64) -> impl Iterator<Item = BodyModel> {
    let mut rng = Rng::new(seed);
    // A block in the middle of the drum, wide as 2.8 m, high as 2.8 m and long as the drum less a
    // little, in cubic cells.
    let (wide, long) = (2.8, 2.0 * HALF_LENGTH - 0.1);
    let fits = |cell: f64| {
        let count = |length: f64| (length / cell).floor();
        count(wide) * count(wide) * count(long) >= bodies as f64
    };
    let cell = std::iter::successors(Some(0.4), |cell| Some(cell * 0.98)).find(|cell| fits(*cell)).unwrap_or(0.4);
    let [columns, layers] = [wide, long].map(|length| (length / cell).floor().max(1.0) as usize);
    (0..bodies).map(move |index| {
        let at = |cells: usize, place: usize| cell * (place as f64 - 0.5 * (cells as f64 - 1.0));
        let place = [
            at(columns, index % columns),
            axis + at(columns, index / columns / layers),
            at(layers, index / columns % layers),
        ];
        let mut length = |most: f64| most * (0.5 + 0.5 * rng.unit());
        let body = if index % 3 == 0 {
            BodyModel::sphere(length(0.45 * cell), place)
        } else {
            // Half the diagonal is less than half a cell.
            BodyModel::cuboid([length(0.28 * cell), length(0.28 * cell), length(0.28 * cell)], place)
        };
        body.density(1000.0).surface(ColliderModel::rough(0.4).rolling(0.002)).named(format!("body-{index}"))
    })
}
