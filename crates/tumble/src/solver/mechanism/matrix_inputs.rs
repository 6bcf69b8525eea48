//! What the rows and the matrix of a mechanism were last made of: where none of it has changed they
//! are not made again. Contacts in passes change momenta, not poses, so of the stages of a substep
//! every other one has the matrix of the one before.

use crate::simd::Four;
use crate::solver::mechanism::block_ldl::BlockLdl;
use crate::solver::mechanism::joint_rows::JointRows;
use crate::solver::mechanism::mechanism_body::MechanismBody;

/// What changes within a step of what rows and matrix are made of.
#[derive(Clone, Debug, Default)]
pub(super) struct MatrixInputs {
    /// By body, translation and orientation.
    poses: Vec<[Four; 2]>,
    /// By body, inverse inertia in the world.
    inertia: Vec<[Four; 2]>,
    /// Of rows along free axes, their softness, and whether they are out of the matrix; then the
    /// softness of each node.
    laws: Vec<(f64, bool)>,
    /// Whether the matrix is of these rows.
    is_factored: bool,
}

impl MatrixInputs {
    /// Has rows and matrix made again in any case.
    pub(super) fn forget(&mut self) {
        self.poses.clear();
        self.is_factored = false;
    }

    /// Whether rows have to be set, as bodies are elsewhere than when they were.
    pub(super) fn take_poses(&mut self, bodies: &[MechanismBody]) -> bool {
        let poses = bodies.iter().map(|body| [body.translation, body.orientation]);
        let is_changed = replace(&mut self.poses, poses);
        self.is_factored &= !is_changed;
        is_changed
    }

    /// Whether the matrix has to be set and factored.
    pub(super) fn take_laws(&mut self, bodies: &[MechanismBody], joints: &[JointRows], matrix: &BlockLdl) -> bool {
        let of_rows = joints.iter().flat_map(|joint| &joint.free_rows).map(|row| (row.gamma, row.constant.is_some()));
        let of_nodes = (0..joints.len()).map(|node| (matrix.softness(node), false));
        let is_changed = [
            replace(&mut self.inertia, bodies.iter().map(|body| body.inverse_inertia)),
            replace(&mut self.laws, of_rows.chain(of_nodes)),
            !self.is_factored,
        ];
        self.is_factored = true;
        is_changed.contains(&true)
    }
}

/// Puts items in the place of others; returns whether they differ.
fn replace<T: PartialEq + Copy>(old: &mut Vec<T>, new: impl Iterator<Item = T>) -> bool {
    let mut count = 0;
    let mut is_changed = false;
    for item in new {
        match old.get_mut(count) {
            Some(slot) if *slot == item => {}
            Some(slot) => {
                *slot = item;
                is_changed = true;
            }
            None => {
                old.push(item);
                is_changed = true;
            }
        }
        count += 1;
    }
    is_changed |= count != old.len();
    old.truncate(count);
    is_changed
}
