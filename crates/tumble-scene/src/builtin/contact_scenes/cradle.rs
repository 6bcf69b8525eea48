//! The Newton's cradle scene: five balls, each suspended on two stiff springs.

use crate::model::collider_model::ColliderModel;
use crate::model::force_model::ForceModel;
use crate::model::scene_model::{BodyModel, SceneModel};
use crate::values::tuple::Tuple;

/// \[m\], \[kg\]
const RADIUS: f64 = 0.1;
const MASS: f64 = 1.0;
/// Between neighbours at rest \[m\].
const GAP: f64 = 0.002;
/// Below the bars from which the balls hang, and half the distance between the two wires of one
/// \[m\].
const DEPTH: f64 = 1.0;
const APART: f64 = 0.4;
/// Of a wire [N/m]; with two of them a ball is stretched down by a third of a millimetre.
const STIFFNESS: f64 = 2e4;

/// The bars from which the balls hang, on either side.
const BARS: [(&str, f64); 2] = [("back", -1.0), ("front", 1.0)];

/// Five balls, each on two wires that are stiff springs; the first is drawn up by an angle whose
/// sine is 0.6.
pub(crate) fn scene() -> SceneModel {
    let wire = |bar: &str, x: f64| ForceModel::Spring {
        to: bar.to_owned(),
        attachment: None,
        attachment_to: Some(Tuple([x, 0.0, 0.0])),
        rest_length: Some((DEPTH * DEPTH + APART * APART).sqrt()),
        stiffness: STIFFNESS,
        damping: 0.0,
    };
    let ball = |index: usize| {
        let x = (2.0 * RADIUS + GAP) * (index as f64 - 2.0);
        let place = if index == 0 { [x - 0.6 * DEPTH, DEPTH - 0.8 * DEPTH, 0.0] } else { [x, 0.0, 0.0] };
        BodyModel::sphere(RADIUS, place)
            .mass(MASS)
            .surface(ColliderModel::rough(0.0).bouncing(1.0))
            .pulled(BARS.map(|(bar, _)| wire(bar, x)).to_vec())
            .named(format!("ball-{index}"))
    };
    let bar = |(name, side): (&str, f64)| {
        let bar = BodyModel::cuboid([0.6, 0.015, 0.015], [0.0, DEPTH, side * APART]).named(name);
        BodyModel { fixed: true, ..bar }
    };
    SceneModel {
        dt: Some(1.0 / 1920.0),
        contact_substeps: Some(1),
        restitution_threshold: Some(0.0),
        ..SceneModel::of(1920 * 8, (0..5).map(ball).chain(BARS.map(bar)).collect())
    }
}
