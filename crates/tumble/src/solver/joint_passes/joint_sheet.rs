//! The blocks of joints of one kind, and where a joint is among them.

use std::ops::Range;

use rayon::prelude::*;
use tumble_math::lane::Vec3;

use crate::joints::held_impulses::RowImpulses;
use crate::math::{Real, real};
use crate::simd::BLOCK;
use crate::solver::joint_passes::joint_block::{BlockRotations, JointBlock};
use crate::solver::joint_passes::pass_joints::JointBlocks;
use crate::solver::joint_passes::pass_stages::PassedJoint;
use crate::threads::InParts;

/// Blocks of joints of `R` rows, and the rotations that they lock.
#[derive(Clone)]
pub(super) struct JointSheet<const R: usize, const M: usize> {
    blocks: Vec<JointBlock<R, M>>,
    rotations: Vec<BlockRotations>,
    /// By block, the numbers of its joints.
    numbers: Vec<[u32; BLOCK]>,
}

/// Blocks that one thread fills at a time.
const PART: usize = 64;

impl<const R: usize, const M: usize> Default for JointSheet<R, M> {
    fn default() -> Self {
        Self { blocks: Vec::new(), rotations: Vec::new(), numbers: Vec::new() }
    }
}

impl<const R: usize, const M: usize> JointSheet<R, M> {
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.rotations.clear();
        self.numbers.clear();
    }

    /// How many blocks.
    pub(super) fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Adds a block of these joints, each in the next lane.
    pub(super) fn push(&mut self, joints: &[u32]) {
        self.blocks.push(JointBlock { count: joints.len(), ..JointBlock::EMPTY });
        if R > 3 {
            self.rotations.push(BlockRotations::EMPTY);
        }
        let mut numbers = [0; BLOCK];
        numbers[..joints.len()].copy_from_slice(joints);
        self.numbers.push(numbers);
    }

    /// Begins a step: with the frames of joints along the axes of their bodies, their impulses, and
    /// nothing done.
    pub(super) fn fill(&mut self, joints: &[PassedJoint]) {
        let Self { blocks, rotations, numbers } = self;
        let parts = blocks.par_chunks_mut(PART).zip(numbers.par_chunks(PART));
        parts.by_at_least(1).for_each(|(blocks, numbers)| {
            blocks.iter_mut().zip(numbers).for_each(|(block, numbers)| block.fill(numbers, joints));
        });
        // There is one for each block, or none.
        for ((rotations, block), numbers) in rotations.iter_mut().zip(&*blocks).zip(&*numbers) {
            for (lane, number) in numbers[..block.count].iter().enumerate() {
                for (frame, anchor) in rotations.frames.iter_mut().zip(&joints[*number as usize].anchors) {
                    frame.iter_mut().zip(anchor.orientation).for_each(|(lanes, it)| lanes[lane] = real(it));
                }
            }
        }
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
