//! Where joints are on their bodies.

use tumble_math::lane::{Quat, Vec3};

use crate::joints::joint_list::ListedJoint;
use crate::math::{double, double_quat};
use crate::solver::mechanism::joint_rows::Anchor;
use crate::storage::body_index::BodyIndex;
use crate::storage::world_columns::{ArchetypeBodies, WorldColumns};

impl Anchor {
    /// At the centre of mass.
    pub(crate) const CENTER: Self =
        Self { position: Vec3 { x: 0.0, y: 0.0, z: 0.0 }, orientation: Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 } };
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
    match axes {
        Some(axes) => {
            let axes = Quat::<f64>::from(double_quat(axes.0.into())).normalize();
            Anchor { position: axes.rotate_back(position), orientation: axes.conjugate() * orientation }
        }
        None => Anchor { position, orientation },
    }
}
