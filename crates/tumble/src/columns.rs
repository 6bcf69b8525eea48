//! Archetypes and threads: the one place that borrows the columns of bodies and hands them out.
//!
//! hecs keeps the entities that have the same set of components together, each component in a contiguous column. The columns of
//! every archetype of moving bodies are borrowed as slices, cut into chunks of [`CHUNK`] bodies, and each chunk is handed to one
//! call of the caller's function, in parallel. A function that only uses its own chunk gives the same result for any number of threads.

use hecs::{Archetype, ArchetypeColumn, ArchetypeColumnMut, World};

use crate::components::{
    Damping, GravityScale, Inertia, InverseInertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Velocity, Work,
    Wrench,
};
use crate::force_laws::{Borrowed, ForceLaws, LawRows};

/// Bodies per chunk: with all their columns about 150 KiB, so that a chunk stays in the second-level cache from one system to the next.
const CHUNK: usize = 1024;

/// Declares `Columns`, the borrowed columns of one archetype, and `Chunk`, slices of the same rows of them.
macro_rules! columns {
    (
        written: $($written:ident: $Written:ty),+;
        read: $($read:ident: $Read:ty),+;
        written_if_present: $($maybe_written:ident: $MaybeWritten:ty),+;
        read_if_present: $($maybe_read:ident: $MaybeRead:ty),+;
    ) => {
        /// The borrowed columns of one archetype whose entities are moving bodies.
        struct Columns<'w> {
            $($written: ArchetypeColumnMut<'w, $Written>,)+
            $($read: ArchetypeColumn<'w, $Read>,)+
            $($maybe_written: Option<ArchetypeColumnMut<'w, $MaybeWritten>>,)+
            $($maybe_read: Option<ArchetypeColumn<'w, $MaybeRead>>,)+
        }

        impl<'w> Columns<'w> {
            /// `None` where the archetype's entities are not moving bodies.
            fn borrow(archetype: &'w Archetype) -> Option<Self> {
                let all = $(archetype.has::<$Written>())&&+ && $(archetype.has::<$Read>())&&+;
                if !all || archetype.is_empty() {
                    return None;
                }
                Some(Self {
                    $($written: archetype.get::<&mut $Written>()?,)+
                    $($read: archetype.get::<&$Read>()?,)+
                    $($maybe_written: archetype.get::<&mut $MaybeWritten>(),)+
                    $($maybe_read: archetype.get::<&$MaybeRead>(),)+
                })
            }

            fn chunk<'a>(&'a mut self, laws: &'a [(usize, Box<dyn LawRows + 'a>)]) -> Chunk<'a> {
                Chunk {
                    laws,
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
            /// The laws that act on these bodies, with their index among all laws.
            pub(crate) laws: &'a [(usize, Box<dyn LawRows + 'a>)],
            /// The row of the archetype that is the first row here.
            pub(crate) first_row: usize,
            $(pub(crate) $written: &'a mut [$Written],)+
            $(pub(crate) $read: &'a [$Read],)+
            $(pub(crate) $maybe_written: Option<&'a mut [$MaybeWritten]>,)+
            $(pub(crate) $maybe_read: Option<&'a [$MaybeRead]>,)+
        }

        impl<'a> Chunk<'a> {
            fn split_at(self, middle: usize) -> (Self, Self) {
                $(let $written = self.$written.split_at_mut(middle);)+
                $(let $read = self.$read.split_at(middle);)+
                $(let $maybe_written = self.$maybe_written.map(|column| column.split_at_mut(middle)).unzip();)+
                $(let $maybe_read = self.$maybe_read.map(|column| column.split_at(middle)).unzip();)+
                (
                    Self {
                        laws: self.laws,
                        first_row: self.first_row,
                        $($written: $written.0,)+
                        $($read: $read.0,)+
                        $($maybe_written: $maybe_written.0,)+
                        $($maybe_read: $maybe_read.0,)+
                    },
                    Self {
                        laws: self.laws,
                        first_row: self.first_row + middle,
                        $($written: $written.1,)+
                        $($read: $read.1,)+
                        $($maybe_written: $maybe_written.1,)+
                        $($maybe_read: $maybe_read.1,)+
                    },
                )
            }
        }
    };
}

columns! {
    written: pose: Pose, momentum: Momentum, wrench: Wrench;
    read: mass: Mass;
    written_if_present: velocity: Velocity, inverse_inertia: InverseInertia, previous_pose: PreviousPose, work: Work;
    read_if_present: inertia: Inertia, axes: PrincipalAxes, gravity_scale: GravityScale, damping: Damping;
}

impl Chunk<'_> {
    /// How many bodies.
    pub(crate) fn len(&self) -> usize {
        self.pose.len()
    }
}

/// Calls `system` once for every chunk of moving bodies, in parallel. Moving bodies have [`Pose`], [`Momentum`], [`Mass`] and
/// [`Wrench`]; the other columns of a chunk are there where its archetype has them, the laws where they act on it.
pub(crate) fn for_each_chunk(world: &mut World, laws: &ForceLaws, system: impl Fn(Chunk<'_>) + Sync) {
    let (mut columns, mut borrowed_laws) = (Vec::new(), Vec::new());
    for archetype in world.archetypes() {
        if let Some(borrowed) = Columns::borrow(archetype) {
            columns.push(borrowed);
            borrowed_laws.push(laws.borrow(archetype));
        }
    }
    let law_rows: Vec<Vec<_>> = borrowed_laws.iter().map(|laws| rows_of(laws)).collect();
    let mut chunks: Vec<Option<Chunk<'_>>> =
        columns.iter_mut().zip(&law_rows).map(|(columns, laws)| Some(columns.chunk(laws))).collect();
    run_all(&mut chunks, &system);
}

fn rows_of<'a>(laws: &'a [(usize, Box<dyn Borrowed + '_>)]) -> Vec<(usize, Box<dyn LawRows + 'a>)> {
    laws.iter().map(|(index, law)| (*index, law.rows())).collect()
}

/// Splits the archetypes among threads, and then each archetype's rows.
fn run_all(chunks: &mut [Option<Chunk<'_>>], system: &(impl Fn(Chunk<'_>) + Sync)) {
    if let [chunk] = chunks {
        if let Some(chunk) = chunk.take() {
            run(chunk, system);
        }
    } else if !chunks.is_empty() {
        let (first, second) = chunks.split_at_mut(chunks.len() / 2);
        let bodies: usize = first.iter().chain(&*second).flatten().map(Chunk::len).sum();
        if bodies <= CHUNK {
            run_all(first, system);
            run_all(second, system);
        } else {
            rayon::join(|| run_all(first, system), || run_all(second, system));
        }
    }
}

fn run(chunk: Chunk<'_>, system: &(impl Fn(Chunk<'_>) + Sync)) {
    if chunk.len() <= CHUNK {
        system(chunk);
    } else {
        // Cut at a multiple of the chunk, so that all but the last are full.
        let middle = (chunk.len() / 2).next_multiple_of(CHUNK);
        let (first, second) = chunk.split_at(middle);
        rayon::join(|| run(first, system), || run(second, system));
    }
}
