//! The dominoes scene: a line of pieces along alternating half circles, with the first one tipping.

use crate::model::collider_model::ColliderModel;
use crate::model::scene_model::{BodyModel, SceneModel};

/// Half the thickness, the height and the width of a piece \[m\].
const HALF: [f64; 3] = [0.05, 0.5, 0.25];
/// From one to the next \[m\].
const APART: f64 = 0.5;
/// Radius of the two half circles \[m\].
const RADIUS: f64 = 4.0;
/// With which the first begins to fall [rad/s].
const PUSH: f64 = 1.2;

/// Along two half circles, one to the left and one to the right, and so on if there are more.
pub(crate) fn scene(bodies: usize) -> SceneModel {
    // Half the angle between two has this tangent, so that chords are of the same length; no sine
    // is needed.
    let tangent = 0.5 * APART / (RADIUS * RADIUS - 0.25 * APART * APART).sqrt();
    let in_half_circle = (std::f64::consts::FRAC_PI_2 * RADIUS / (0.5 * APART)).round().max(1.0) as usize;
    let mut pieces = Vec::with_capacity(bodies + 1);
    // Where the next one stands; and its heading, as the rotation about y by half its angle: cosine
    // and sine.
    let (mut place, mut heading) = ([0.0_f64, 0.0], [1.0_f64, 0.0]);
    for index in 0..bodies {
        let ahead = [heading[0] * heading[0] - heading[1] * heading[1], -2.0 * heading[0] * heading[1]];
        let mut piece = BodyModel::cuboid(HALF, [place[0], HALF[1], place[1]])
            .density(600.0)
            .surface(ColliderModel::rough(0.4))
            .turned([0.0, heading[1], 0.0, heading[0]])
            .named(format!("piece-{index}"));
        if index == 0 {
            // About the lower edge, which does not move.
            let by = PUSH * HALF[1];
            piece = piece.moving([by * ahead[0], 0.0, by * ahead[1]], [PUSH * ahead[1], 0.0, -PUSH * ahead[0]]);
        }
        pieces.push(piece);
        place = [place[0] + APART * ahead[0], place[1] + APART * ahead[1]];
        let side = if (index / in_half_circle).is_multiple_of(2) { tangent } else { -tangent };
        let turned = [heading[0] - side * heading[1], heading[1] + side * heading[0]];
        let length = (turned[0] * turned[0] + turned[1] * turned[1]).sqrt();
        heading = turned.map(|part| part / length);
    }
    pieces.push(BodyModel::ground());
    SceneModel::of(900, pieces)
}
