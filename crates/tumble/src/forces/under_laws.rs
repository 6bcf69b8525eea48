//! Chunks of bodies with the laws that act on them.

use hecs::World;

use crate::forces::registry::{ForceLaws, Laws};
use crate::storage::chunk::{Chunk, for_each_body, for_each_columns, for_each_part, has_few_bodies};
use crate::storage::world_columns::WorldColumns;
use crate::threads::Effort;

/// Calls `system` once for every chunk of moving bodies, with the laws that act on them, in
/// parallel. Whether any may is given.
pub(crate) fn for_each_chunk_under(
    world: &mut World,
    (laws, are_under_laws): (&ForceLaws, bool),
    system: impl Fn(&mut Chunk<'_>, Laws<'_>) + Sync,
) {
    if has_few_bodies(world) && !are_under_laws {
        return for_each_body(world, |body| system(body, Laws::default()));
    }
    let effort =
        if are_under_laws { Effort::of_bodies_under_laws(world.len()) } else { Effort::of_bodies(world.len()) };
    for_each_columns(world, effort, &|archetype, mut columns| {
        laws.with_rows(archetype, &mut |laws| {
            for_each_part(columns.chunk(), &|bodies: &mut Chunk<'_>| system(bodies, laws));
        });
    });
}

impl ForceLaws {
    /// Borrows the columns of all bodies of a world, for steps under these laws.
    pub(crate) fn columns_of<'w>(&self, world: &'w World) -> WorldColumns<'w> {
        WorldColumns::of(world, |archetype| self.may_act_on(archetype))
    }

    /// Calls `system` once for every chunk of moving bodies, with the index of their archetype and
    /// the laws that act on them, in parallel.
    pub(crate) fn for_each_chunk_of(
        &self,
        columns: &mut WorldColumns<'_>,
        system: impl Fn(usize, &mut Chunk<'_>, Laws<'_>) + Sync,
    ) {
        self.for_each_archetype_of(columns, |archetype, chunk, laws| {
            for_each_part(chunk, &|bodies: &mut Chunk<'_>| system(archetype, bodies, laws));
        });
    }

    /// Calls `then` with the moving bodies of each archetype, its index, and the laws that act on
    /// them, one archetype after the other.
    pub(crate) fn for_each_archetype_of(
        &self,
        columns: &mut WorldColumns<'_>,
        mut then: impl FnMut(usize, Chunk<'_>, Laws<'_>),
    ) {
        columns.for_each_archetype(|index, (archetype, may_have_laws), columns| {
            if may_have_laws {
                self.with_rows(archetype, &mut |laws| then(index, columns.chunk(), laws));
            } else {
                then(index, columns.chunk(), Laws::default());
            }
        });
    }
}
