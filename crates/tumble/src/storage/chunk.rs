//! Archetypes and threads: borrows the columns of bodies and hands them out.
//!
//! hecs keeps the entities that have the same set of components together, each component in a
//! contiguous column. The columns of every archetype of moving bodies are borrowed as slices, cut
//! into chunks of some hundred bodies, and each chunk is handed to one call of the caller's
//! function, in parallel. A function that only uses its own chunk gives the same result for any
//! number of threads.

use std::ops::Range;
use std::slice::{from_mut, from_ref};

use hecs::{Archetype, ArchetypeColumn, ArchetypeColumnMut, World};

use crate::components::{
    Damping, GravityScale, Inertia, InverseInertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Velocity, Wind,
    Work, Wrench,
};
use crate::simd::{MAX_BODIES, WIDEST, narrowest_for, widest};
use crate::threads;
use crate::threads::Effort;

/// Up to this many bodies are visited one by one: borrowing a dozen columns takes longer than a
/// query.
const FEW: u32 = 2;

/// Fewer bodies are not shared among threads: a step of 512 takes six microseconds, and handing
/// half of them over saves less than it costs even while the other thread is awake.
pub(crate) const MIN_CHUNK: usize = 512;

/// More bodies than these would not stay in the second-level cache from one system to the next,
/// with all their columns.
const MAX_CHUNK: usize = 2048;

/// Declares `Columns`, the borrowed columns of one archetype, and `Chunk`, slices of the same rows
/// of them.
macro_rules! columns {
    (
        written: $($written:ident: $Written:ty),+;
        read: $($read:ident: $Read:ty),+;
        written_if_present: $($maybe_written:ident: $MaybeWritten:ty),+;
        read_if_present: $($maybe_read:ident: $MaybeRead:ty),+;
    ) => {
        /// The borrowed columns of one archetype whose entities are moving bodies.
        pub(crate) struct Columns<'w> {
            $(pub(crate) $written: ArchetypeColumnMut<'w, $Written>,)+
            $(pub(crate) $read: ArchetypeColumn<'w, $Read>,)+
            $(pub(crate) $maybe_written: Option<ArchetypeColumnMut<'w, $MaybeWritten>>,)+
            $(pub(crate) $maybe_read: Option<ArchetypeColumn<'w, $MaybeRead>>,)+
        }

        impl<'w> Columns<'w> {
            /// `None` where the archetype's entities are not moving bodies.
            pub(crate) fn borrow(archetype: &'w Archetype) -> Option<Self> {
                if archetype.is_empty() {
                    return None;
                }
                Some(Self {
                    $($written: archetype.get::<&mut $Written>()?,)+
                    $($read: archetype.get::<&$Read>()?,)+
                    $($maybe_written: archetype.get::<&mut $MaybeWritten>(),)+
                    $($maybe_read: archetype.get::<&$MaybeRead>(),)+
                })
            }

            /// All rows.
            pub(crate) fn chunk(&mut self) -> Chunk<'_> {
                Chunk {
                    first_row: 0,
                    $($written: &mut self.$written,)+
                    $($read: &self.$read,)+
                    $($maybe_written: self.$maybe_written.as_deref_mut(),)+
                    $($maybe_read: self.$maybe_read.as_deref(),)+
                }
            }
        }

        /// Some of the bodies of one archetype: the same rows of each of their columns.
        pub(crate) struct Chunk<'a> {
            /// The row of the archetype that is the first row here.
            pub(crate) first_row: usize,
            $(pub(crate) $written: &'a mut [$Written],)+
            $(pub(crate) $read: &'a [$Read],)+
            $(pub(crate) $maybe_written: Option<&'a mut [$MaybeWritten]>,)+
            $(pub(crate) $maybe_read: Option<&'a [$MaybeRead]>,)+
        }

        /// One body's components.
        type Row<'a> = (
            $(&'a mut $Written,)+
            $(&'a $Read,)+
            $(Option<&'a mut $MaybeWritten>,)+
            $(Option<&'a $MaybeRead>,)+
        );

        impl<'a> Chunk<'a> {
            /// A chunk of one body.
            fn of_row(($($written,)+ $($read,)+ $($maybe_written,)+ $($maybe_read,)+): Row<'a>) -> Self {
                Self {
                    first_row: 0,
                    $($written: from_mut($written),)+
                    $($read: from_ref($read),)+
                    $($maybe_written: $maybe_written.map(from_mut),)+
                    $($maybe_read: $maybe_read.map(from_ref),)+
                }
            }

            pub(crate) fn split_at(self, middle: usize) -> (Self, Self) {
                $(let $written = self.$written.split_at_mut(middle);)+
                $(let $read = self.$read.split_at(middle);)+
                $(let $maybe_written = self.$maybe_written.map(|column| column.split_at_mut(middle)).unzip();)+
                $(let $maybe_read = self.$maybe_read.map(|column| column.split_at(middle)).unzip();)+
                (
                    Self {
                        first_row: self.first_row,
                        $($written: $written.0,)+
                        $($read: $read.0,)+
                        $($maybe_written: $maybe_written.0,)+
                        $($maybe_read: $maybe_read.0,)+
                    },
                    Self {
                        first_row: self.first_row + middle,
                        $($written: $written.1,)+
                        $($read: $read.1,)+
                        $($maybe_written: $maybe_written.1,)+
                        $($maybe_read: $maybe_read.1,)+
                    },
                )
            }

            /// Some of the rows.
            pub(crate) fn rows(&mut self, rows: Range<usize>) -> Chunk<'_> {
                Chunk {
                    first_row: self.first_row + rows.start,
                    $($written: &mut self.$written[rows.clone()],)+
                    $($read: &self.$read[rows.clone()],)+
                    $($maybe_written: self.$maybe_written.as_deref_mut().map(|column| &mut column[rows.clone()]),)+
                    $($maybe_read: self.$maybe_read.map(|column| &column[rows.clone()]),)+
                }
            }
        }

        /// Copies of some rows of a chunk, and of the last of them as often as it takes to fill `W`
        /// rows.
        struct Padded<const W: usize> {
            $($written: [$Written; W],)+
            $($read: [$Read; W],)+
            $($maybe_written: Option<[$MaybeWritten; W]>,)+
            $($maybe_read: Option<[$MaybeRead; W]>,)+
        }

        impl<const W: usize> Padded<W> {
            fn of(chunk: &Chunk<'_>, rows: &[usize]) -> Self {
                Self {
                    $($written: padded(chunk.$written, rows),)+
                    $($read: padded(chunk.$read, rows),)+
                    $($maybe_written: chunk.$maybe_written.as_deref().map(|column| padded(column, rows)),)+
                    $($maybe_read: chunk.$maybe_read.map(|column| padded(column, rows)),)+
                }
            }

            fn chunk(&mut self, first_row: usize) -> Chunk<'_> {
                Chunk {
                    first_row,
                    $($written: &mut self.$written,)+
                    $($read: &self.$read,)+
                    $($maybe_written: self.$maybe_written.as_mut().map(|column| &mut column[..]),)+
                    $($maybe_read: self.$maybe_read.as_ref().map(|column| &column[..]),)+
                }
            }

            fn write_back(&self, chunk: &mut Chunk<'_>, rows: &[usize]) {
                $(rows.iter().zip(&self.$written).for_each(|(row, copy)| chunk.$written[*row] = *copy);)+
                $(
                    if let (Some(column), Some(copies)) = (chunk.$maybe_written.as_deref_mut(), &self.$maybe_written) {
                        rows.iter().zip(copies).for_each(|(row, copy)| column[*row] = *copy);
                    }
                )+
            }
        }
    };
}

columns! {
    written: pose: Pose, momentum: Momentum, wrench: Wrench;
    read: mass: Mass;
    written_if_present: velocity: Velocity, inverse_inertia: InverseInertia, previous_pose: PreviousPose, work: Work;
    read_if_present: inertia: Inertia, axes: PrincipalAxes, gravity_scale: GravityScale, damping: Damping,
        wind: Wind;
}

/// Which rows a system can be given side by side.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum RowOrder {
    /// Neighbours in the archetype, from its first row on.
    OfArchetype,
    Any,
}

impl Chunk<'_> {
    /// How many bodies.
    pub(crate) fn len(&self) -> usize {
        self.pose.len()
    }

    /// Runs `tiles` on a multiple of the widest tile's bodies, and on the rest, brought to the
    /// width of a tile with copies that are thrown away.
    pub(crate) fn in_whole_tiles(&mut self, mut tiles: impl FnMut(&mut Chunk<'_>)) {
        let left = self.len() % widest();
        let whole = self.len() - left;
        let width = narrowest_for(left);
        if left == 0 || width == left {
            return tiles(self);
        }
        if whole > 0 {
            tiles(&mut self.rows(0..whole));
        }
        let mut last = self.rows(whole..whole + left);
        let rows: [usize; WIDEST] = std::array::from_fn(|i| i);
        let rows = &rows[..left.min(WIDEST)];
        match width {
            2 => in_padded_tile::<2>(&mut last, rows, tiles),
            4 => in_padded_tile::<4>(&mut last, rows, tiles),
            8 => in_padded_tile::<8>(&mut last, rows, tiles),
            _ => in_padded_tile::<WIDEST>(&mut last, rows, tiles),
        }
    }

    /// Calls `system` with the bodies of the rows that `is_included`, each of them once: runs of
    /// neighbouring rows, and in any [order](RowOrder) copies of single rows side by side.
    pub(crate) fn for_included(
        &mut self,
        order: RowOrder,
        is_included: impl Fn(usize) -> bool,
        mut system: impl FnMut(&mut Chunk<'_>),
    ) {
        let (mut single, mut singles) = ([0; WIDEST], 0);
        let mut next = 0;
        while let Some(begin) = (next..self.len()).find(|row| is_included(*row)) {
            next = (begin..self.len()).find(|row| !is_included(*row)).unwrap_or(self.len());
            if order == RowOrder::OfArchetype || next - begin >= WIDEST {
                system(&mut self.rows(begin..next));
                continue;
            }
            for row in begin..next {
                (single[singles], singles) = (row, singles + 1);
                if singles == WIDEST {
                    in_padded_tile::<WIDEST>(self, &single, &mut system);
                    singles = 0;
                }
            }
        }
        if singles > 0 {
            in_padded_tile::<WIDEST>(self, &single[..singles], system);
        }
    }
}

fn in_padded_tile<const W: usize>(chunk: &mut Chunk<'_>, rows: &[usize], mut tiles: impl FnMut(&mut Chunk<'_>)) {
    let mut padded = Padded::<W>::of(chunk, rows);
    tiles(&mut padded.chunk(chunk.first_row));
    padded.write_back(chunk, rows);
}

/// The rows, and the last of them as often as it takes.
fn padded<T: Copy, const W: usize>(column: &[T], rows: &[usize]) -> [T; W] {
    std::array::from_fn(|i| column[rows[i.min(rows.len() - 1)]])
}

/// Calls `system` once for every chunk of moving bodies, in parallel. Moving bodies have [`Pose`],
/// [`Momentum`], [`Mass`] and [`Wrench`]; the other columns of a chunk are there where its
/// archetype has them.
pub(crate) fn for_each_chunk(world: &mut World, system: impl Fn(&mut Chunk<'_>) + Sync) {
    if has_few_bodies(world) {
        return for_each_body(world, system);
    }
    let effort = Effort::of_bodies(world.len());
    for_each_columns(world, effort, &|_, mut columns| for_each_part(columns.chunk(), &system));
}

/// Whether bodies are sooner gone through one by one.
pub(crate) fn has_few_bodies(world: &World) -> bool {
    (1..=FEW).contains(&world.len())
}

/// Calls `system` once for every moving body, as a chunk of one.
pub(crate) fn for_each_body(world: &mut World, system: impl Fn(&mut Chunk<'_>)) {
    world.query_mut::<Row<'_>>().into_iter().for_each(|row| system(&mut Chunk::of_row(row)));
}

/// Calls `then` once for every archetype of moving bodies, with its columns, in parallel where the
/// effort is worth it.
pub(crate) fn for_each_columns(world: &World, effort: Effort, then: &(impl Fn(&Archetype, Columns<'_>) + Sync)) {
    effort.run(|| for_each_columns_of(world, 0..world.archetypes().len(), then));
}

/// Splits the archetypes among threads. Columns are borrowed where they are used, so nothing needs
/// memory but the stack.
fn for_each_columns_of(world: &World, archetypes: Range<usize>, then: &(impl Fn(&Archetype, Columns<'_>) + Sync)) {
    let these = || world.archetypes().skip(archetypes.start).take(archetypes.len());
    let entities: usize = these().map(|archetype| archetype.len() as usize).sum();
    if archetypes.len() > 1 && entities > MIN_CHUNK {
        let middle = archetypes.start + archetypes.len() / 2;
        threads::join(
            || for_each_columns_of(world, archetypes.start..middle, then),
            || for_each_columns_of(world, middle..archetypes.end, then),
        );
        return;
    }
    for archetype in these() {
        if let Some(columns) = Columns::borrow(archetype) {
            then(archetype, columns);
        }
    }
}

/// Cuts the bodies into chunks and calls `system` once for each, in parallel. There are eight of a
/// few thousand bodies, so that threads that begin late or are slow do less, and more of more.
pub(crate) fn for_each_part(chunk: Chunk<'_>, system: &(impl Fn(&mut Chunk<'_>) + Sync)) {
    let size = (chunk.len() / 8).next_multiple_of(MAX_BODIES).clamp(MIN_CHUNK, MAX_CHUNK);
    for_each_part_of(size, chunk, system);
}

fn for_each_part_of(size: usize, mut chunk: Chunk<'_>, system: &(impl Fn(&mut Chunk<'_>) + Sync)) {
    if chunk.len() <= size {
        system(&mut chunk);
    } else {
        // Cut at a multiple of the size, so that all but the last are full.
        let middle = (chunk.len() / 2).next_multiple_of(size);
        let (first, second) = chunk.split_at(middle);
        threads::join(|| for_each_part_of(size, first, system), || for_each_part_of(size, second, system));
    }
}
