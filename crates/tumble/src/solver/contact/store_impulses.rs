//! Write-back of solved impulses from constraint blocks to the contact records.

use crate::collision::contact::ContactRecord;
use crate::collision::contact_rows::WorldFriction;
use crate::simd::{BLOCK, Kernel, Octet, Tile, store_rows};
use crate::solver::contact::contact_frame::ContactFrame;
use crate::solver::contact::friction::FrictionImpulse;
use crate::solver::contact::solve::Blocks;

/// Gives the impulses of blocks back to the contacts.
pub(crate) struct StoreImpulses<'a, const P: usize, const C: usize> {
    pub(crate) blocks: Blocks<'a, P, C>,
    pub(crate) contacts: &'a mut [ContactRecord],
}

impl<const P: usize, const C: usize> Kernel for StoreImpulses<'_, P, C> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.blocks.blocks.len() * BLOCK
    }

    #[inline(always)]
    fn is_empty(&self, i: usize) -> bool {
        self.blocks.blocks[i / BLOCK].count <= i % BLOCK
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (index, lane) = (i / BLOCK, i % BLOCK);
        let block = &self.blocks.blocks[index];
        let frame = ContactFrame::<T>::load(block, lane);
        let friction = FrictionImpulse::load(&block.friction, self.blocks.rolling.get(index), lane);
        let mut frictions = [WorldFriction::ZERO; BLOCK];
        let (linear, angular, zero) = (friction.linear(&frame), friction.angular(&frame), T::splat(0.0));
        store_rows(WorldFriction { linear, angular, margin: zero, halvings: zero }, &mut frictions);
        let mut l = 0;
        while l < T::WIDTH && lane + l < block.count {
            let contact = &mut self.contacts[block.contacts[lane + l] as usize];
            let WorldFriction { linear, angular, .. } = frictions[l];
            (contact.friction.linear, contact.friction.angular) = (linear, angular);
            contact.total_impulse = block.start.total_impulse[lane + l];
            let is_impact = block.start.is_impact[lane + l] > 0.0;
            contact.normal_impulses.steady = if is_impact { 0.0 } else { block.start.steady[lane + l] };
            let mut j = 0;
            while j < P {
                contact.normal_impulses.at_points[j] = block.points[j].impulse[lane + l];
                j += 1;
            }
            l += 1;
        }
    }
}
