//! The blocks of a color, shared among the threads.

use crate::simd::{Kernel, dispatch_in_blocks};
use crate::solver::contact::solve::StageBodies;
use crate::threads;

/// Blocks of constraints of one color, of which each can be solved beside the others.
pub(crate) trait ColorBlocks: Sized + Send {
    /// How many.
    fn count(&self) -> usize;

    /// The first `middle`, and the others.
    fn parted(self, middle: usize) -> (Self, Self);
}

/// Fewer blocks are not shared among threads.
const MIN_PART: usize = 8;

/// Runs a stage on blocks and their bodies, in parts where threads share the work.
pub(crate) fn in_parts<B: ColorBlocks>(
    blocks: B,
    bodies: StageBodies<'_>,
    stage: &(impl Fn(B, StageBodies<'_>) + Sync),
) {
    let count = blocks.count();
    if count == 0 {
        return;
    }
    if count <= MIN_PART || !threads::are_shared() {
        return stage(blocks, bodies);
    }
    parts_of(count.div_ceil(rayon::current_num_threads()).max(MIN_PART), blocks, bodies, stage);
}

fn parts_of<B: ColorBlocks>(
    most: usize,
    blocks: B,
    bodies: StageBodies<'_>,
    stage: &(impl Fn(B, StageBodies<'_>) + Sync),
) {
    let count = blocks.count();
    if count <= most {
        return stage(blocks, bodies);
    }
    let ((first, second), (of_first, of_second)) = (blocks.parted(count / 2), bodies.split_at(count / 2));
    threads::join(|| parts_of(most, first, of_first, stage), || parts_of(most, second, of_second, stage));
}

/// Runs a kernel of whole blocks.
pub(crate) fn run(mut kernel: impl Kernel) {
    dispatch_in_blocks(&mut kernel);
}
