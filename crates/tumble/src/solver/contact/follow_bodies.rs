//! Contacts follow their bodies in a stage of its own, where no pass goes over them.

use crate::math::Real;
use crate::simd::block_lanes::put_vector;
use crate::simd::{BLOCK, Kernel, Tile};
use crate::solver::contact::solve::{Blocks, StageBodies};
use crate::solver::contact::update_geometry::follow;

/// Updates the geometry of contacts whose bodies moved for `h` \[s\], and notes the lags.
pub(crate) struct Follow<'a, const P: usize, const C: usize> {
    pub(crate) blocks: Blocks<'a, P, C>,
    pub(crate) bodies: StageBodies<'a>,
    pub(crate) h: Real,
}

impl<const P: usize, const C: usize> Kernel for Follow<'_, P, C> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.blocks.lags.len() * BLOCK
    }

    #[inline(always)]
    fn is_empty(&self, i: usize) -> bool {
        self.bodies.motion.is_empty(i / BLOCK, i % BLOCK)
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (index, lane) = (i / BLOCK, i % BLOCK);
        let (bodies, inv_inertia) = self.bodies.load::<T>(index, lane, self.blocks.locks);
        let delta_pose = self.bodies.delta_poses(index, lane);
        let h = T::splat(self.h.into());
        let Blocks { blocks, rolling, axes, lags, .. } = &mut self.blocks;
        let others = (rolling.get_mut(index), None, axes.get(index));
        let lag = follow(&mut blocks[index], others, (lane, h), &delta_pose, (&bodies, &inv_inertia));
        put_vector(lag, &mut lags[index], lane);
    }
}
