//! The blocks of joints of one kind, and where a joint is among them.

use std::ops::Range;

use tumble_math::lane::Vec3;

use crate::joints::held_impulses::RowImpulses;
use crate::math::{Real, real};
use crate::solver::joint_passes::joint_block::{BlockRotations, JointBlock};
use crate::solver::joint_passes::pass_joints::JointBlocks;
use crate::solver::mechanism::joint_rows::Anchor;

/// Blocks of joints of `R` rows, and the rotations that they lock.
#[derive(Clone)]
pub(super) struct JointSheet<const R: usize, const M: usize> {
    blocks: Vec<JointBlock<R, M>>,
    rotations: Vec<BlockRotations>,
}

impl<const R: usize, const M: usize> Default for JointSheet<R, M> {
    fn default() -> Self {
        Self { blocks: Vec::new(), rotations: Vec::new() }
    }
}

impl<const R: usize, const M: usize> JointSheet<R, M> {
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.rotations.clear();
    }

    /// How many blocks.
    pub(super) fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Begins a block.
    pub(super) fn begin_block(&mut self) {
        self.blocks.push(JointBlock::EMPTY);
        if R > 3 {
            self.rotations.push(BlockRotations::EMPTY);
        }
    }

    /// Adds a joint to the last block: its frames along the axes of its bodies, and its impulses.
    /// Returns its lane.
    pub(super) fn push(&mut self, anchors: &[Anchor; 2], impulses: &RowImpulses) -> usize {
        let Some(block) = self.blocks.last_mut() else { return 0 };
        let lane = block.count;
        block.count += 1;
        for (end, anchor) in anchors.iter().enumerate() {
            let of_block = block.anchors[end].iter_mut().zip(anchor.position);
            of_block.for_each(|(lanes, number)| lanes[lane] = real(number));
            if let Some(rotations) = self.rotations.last_mut() {
                let of_block = rotations.frames[end].iter_mut().zip(anchor.orientation);
                of_block.for_each(|(lanes, number)| lanes[lane] = real(number));
            }
        }
        block.impulses.iter_mut().zip(impulses).for_each(|(lanes, impulse)| lanes[lane] = *impulse);
        lane
    }

    /// The impulses of a joint.
    pub(super) fn impulses(&self, block: usize, lane: usize) -> RowImpulses {
        let mut impulses = RowImpulses::default();
        let of_block = &self.blocks[block].impulses;
        impulses.iter_mut().zip(of_block).for_each(|(impulse, lanes)| *impulse = lanes[lane]);
        impulses
    }

    /// What a joint has done in the step: impulse, and angular impulse about its second anchor.
    pub(super) fn done(&self, block: usize, lane: usize) -> [Vec3<Real>; 2] {
        self.blocks[block].done.each_ref().map(|[x, y, z]| Vec3::new(x[lane], y[lane], z[lane]))
    }

    pub(super) fn blocks(&mut self, range: &Range<usize>) -> JointBlocks<'_, R, M> {
        JointBlocks {
            blocks: &mut self.blocks[range.clone()],
            rotations: self.rotations.get_mut(range.clone()).unwrap_or_default(),
        }
    }
}
