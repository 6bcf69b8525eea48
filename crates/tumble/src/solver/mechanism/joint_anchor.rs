//! Where joints are on their bodies.

use tumble_math::lane::Quat;

use crate::joints::joint_list::ListedJoint;
use crate::math::{double, double_quat};
use crate::solver::mechanism::fours::{row, row_of};
use crate::solver::mechanism::joint_rows::Anchor;
use crate::storage::body_index::BodyIndex;
use crate::storage::world_columns::{ArchetypeBodies, WorldColumns};

impl Anchor {
    /// At the centre of mass.
    pub(crate) const CENTER: Self = Self { position: [0.0; 4], orientation: [0.0, 0.0, 0.0, 1.0] };
}

/// The frame of a joint at one end, along the axes that its row's orientation goes by.
pub(crate) fn anchor(joint: &ListedJoint, end: usize, body_index: &BodyIndex, columns: &WorldColumns<'_>) -> Anchor {
    let frame = &joint.joint.frames[end];
    let place = body_index.place(joint.slots[end]);
    let position = double(frame.position.into()).into();
    let orientation = Quat::<f64>::from(double_quat(frame.orientation.into())).normalize();
    let axes = match columns.bodies(place) {
        ArchetypeBodies::Dynamic(moving) => moving.axes.as_deref().map(|axes| axes[place.row as usize]),
        _ => None,
    };
    let (position, orientation) = match axes {
        Some(axes) => {
            let axes = Quat::<f64>::from(double_quat(axes.0.into())).normalize();
            (axes.rotate_back(position), axes.conjugate() * orientation)
        }
        None => (position, orientation),
    };
    Anchor { position: row_of(position, 0.0), orientation: row(orientation) }
}
