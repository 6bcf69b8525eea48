//! What the rows and the matrix of a mechanism were last made of: where none of it has changed they
//! are not made again. Contacts in passes change momenta, not poses, so of the stages of a substep
//! every other one has the matrix of the one before.

use crate::simd::Four;
use crate::solver::mechanism::block_ldl::BlockLdl;
use crate::solver::mechanism::free_row::FreeRow;
use crate::solver::mechanism::joint_rows::JointRows;
use crate::solver::mechanism::mechanism_body::MechanismBody;

/// What changes within a step of what rows and matrix are made of.
#[derive(Clone, Debug, Default)]
pub(super) struct MatrixInputs {
    /// By body, translation and orientation.
    poses: Vec<[Four; 2]>,
    /// By body, inverse inertia in the world.
    inertia: Vec<[Four; 2]>,
    /// Of rows along free axes their softness, infinite where they are out of the matrix.
    laws: Vec<f64>,
    /// Of each node, where rows may depend.
    softness: Vec<f64>,
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
        let is_changed = take(&mut self.poses, bodies.iter().map(|body| [body.translation, body.orientation]));
        self.is_factored &= !is_changed;
        is_changed
    }

    /// Whether the matrix has to be set and factored.
    pub(super) fn take_laws(&mut self, bodies: &[MechanismBody], joints: &[JointRows], matrix: &BlockLdl) -> bool {
        let rows = joints.iter().flat_map(|joint| &joint.free_rows);
        let of_rows = rows.map(FreeRow::softness);
        let nodes = if matrix.may_depend() { joints.len() } else { 0 };
        let is_changed = take(&mut self.inertia, bodies.iter().map(|body| body.inverse_inertia))
            | take(&mut self.laws, of_rows)
            | take(&mut self.softness, (0..nodes).map(|node| matrix.softness(node)))
            | !self.is_factored;
        self.is_factored = true;
        is_changed
    }
}

/// Numbers, or fours of them, that are compared bit by bit.
trait Numbers: Copy {
    fn differing_bits(self, other: Self) -> u64;
}

impl Numbers for f64 {
    #[inline(always)]
    fn differing_bits(self, other: Self) -> u64 {
        self.to_bits() ^ other.to_bits()
    }
}

impl<T: Numbers, const N: usize> Numbers for [T; N] {
    #[inline(always)]
    fn differing_bits(self, other: Self) -> u64 {
        self.into_iter().zip(other).fold(0, |bits, (a, b)| bits | a.differing_bits(b))
    }
}

/// Takes items in the place of others; returns whether they differ.
fn take<T: Numbers>(old: &mut Vec<T>, new: impl Iterator<Item = T>) -> bool {
    let (mut count, mut differing) = (0, 0);
    for item in new {
        match old.get_mut(count) {
            Some(slot) => differing |= std::mem::replace(slot, item).differing_bits(item),
            None => {
                old.push(item);
                differing = 1;
            }
        }
        count += 1;
    }
    let is_shorter = count < old.len();
    old.truncate(count);
    differing != 0 || is_shorter
}
