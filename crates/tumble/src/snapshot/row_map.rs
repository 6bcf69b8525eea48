//! Matching of snapshot rows with world rows: in place where possible, by identity otherwise.

use std::ops::Range;

use hecs::{Archetype, Entity, World};

use crate::components::BodyKind;
use crate::components::{BodyId, Pose};
use crate::snapshot::error::SnapshotError;
use crate::snapshot::{Segment, Snapshot, equal_from_the_start};

/// Which rows of a snapshot belong to which rows of a world, and what belongs to none.
///
/// Most rows are where they were: an archetype's bodies are compared with those that it had at
/// capture, row by row, and equal rows make a run that is copied as a whole. hecs fills the row of
/// a body that left with the archetype's last one: when few bodies came or went, few rows differ,
/// and only those are sorted and looked for by identity.
#[derive(Clone, Debug, Default)]
pub(crate) struct Matching {
    /// By archetype.
    runs: Vec<Run>,
    /// Rows of the snapshot whose body is not where it was.
    lost: Vec<(BodyId, usize)>,
    /// Bodies of the world that are not where the snapshot has them. At the end, those that it does
    /// not have.
    strangers: Vec<Stranger>,
}

/// Rows that follow one another both in an archetype and in a snapshot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// The archetype's place among those of the world.
    pub(crate) archetype: usize,
    /// The first row in the archetype.
    first: usize,
    /// The first row in the snapshot.
    pub(crate) row: usize,
    len: usize,
}

impl Run {
    /// The rows in the archetype.
    pub(crate) fn there(&self) -> Range<usize> {
        self.first..self.first + self.len
    }

    /// The rows in the snapshot.
    pub(crate) fn here(&self) -> Range<usize> {
        self.row..self.row + self.len
    }
}

/// A body of the world by where it is.
#[derive(Clone, Copy, Debug)]
struct Stranger {
    id: BodyId,
    kind: BodyKind,
    archetype: usize,
    row: usize,
}

impl Matching {
    /// The runs of the last [`find`](Self::find), archetype by archetype.
    pub(crate) fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Bytes of memory that its buffers hold.
    pub(crate) fn memory(&self) -> usize {
        self.runs.capacity() * size_of::<Run>()
            + self.lost.capacity() * size_of::<(BodyId, usize)>()
            + self.strangers.capacity() * size_of::<Stranger>()
    }

    /// Matches every row of the snapshot with one of the world.
    pub(crate) fn find(&mut self, snapshot: &Snapshot, world: &World) -> Result<(), SnapshotError> {
        self.runs.clear();
        self.lost.clear();
        self.strangers.clear();
        self.match_in_place(snapshot, world);
        if self.lost.is_empty() && self.strangers.is_empty() {
            return Ok(());
        }
        self.lost.sort_unstable();
        self.strangers.sort_unstable_by_key(|stranger| stranger.id);
        if let Some(pair) = self.strangers.windows(2).find(|pair| pair[0].id == pair[1].id) {
            return Err(SnapshotError::Duplicate { id: pair[0].id });
        }
        self.match_by_id(snapshot)?;
        self.refuse_doubles(snapshot)?;
        self.runs.sort_unstable_by_key(|run| (run.archetype, run.first));
        Ok(())
    }

    /// Matches bodies that are in the row where they were at capture, or as far from it as their
    /// whole archetype is.
    fn match_in_place(&mut self, snapshot: &Snapshot, world: &World) {
        let mut segments = snapshot.segments.as_slice();
        for (index, archetype) in world.archetypes().enumerate() {
            let segment = match segments {
                [segment, rest @ ..] if segment.archetype == index => {
                    segments = rest;
                    Some(*segment)
                }
                _ => None,
            };
            self.match_archetype(snapshot, segment, index, archetype);
        }
        for segment in segments {
            self.lose(snapshot, segment.start..segment.start + segment.len);
        }
    }

    fn match_archetype(&mut self, snapshot: &Snapshot, segment: Option<Segment>, archetype: usize, column: &Archetype) {
        let Segment { start, len, .. } = segment.unwrap_or(Segment { archetype, start: 0, len: 0 });
        let kind = BodyKind::of(column);
        let (Some(kind), Some(ids)) = (kind, column.get::<&BodyId>()) else {
            return self.lose(snapshot, start..start + len);
        };
        // In another world the same place among archetypes may be that of another kind of bodies.
        let comparable = if len > 0 && snapshot.kind(start) == kind { len.min(ids.len()) } else { 0 };
        let recorded = &snapshot.ids[start..start + comparable];
        let mut row = 0;
        while row < comparable {
            let same = equal_from_the_start(&recorded[row..], &ids[row..]);
            if same > 0 {
                self.runs.push(Run { archetype, first: row, row: start + row, len: same });
                row += same;
            } else {
                self.lost.push((recorded[row], start + row));
                self.strangers.push(Stranger { id: ids[row], kind, archetype, row });
                row += 1;
            }
        }
        self.lose(snapshot, start + comparable..start + len);
        let rest = ids.iter().enumerate().skip(comparable);
        self.strangers.extend(rest.map(|(row, &id)| Stranger { id, kind, archetype, row }));
    }

    fn lose(&mut self, snapshot: &Snapshot, rows: Range<usize>) {
        self.lost.extend(rows.map(|row| (snapshot.ids[row], row)));
    }

    /// Matches what is left by identity, both sides being in its order. Strangers that the snapshot
    /// does not have remain.
    fn match_by_id(&mut self, snapshot: &Snapshot) -> Result<(), SnapshotError> {
        let (mut lost, mut missing, mut changed) = (self.lost.iter().peekable(), Vec::new(), None);
        let runs = &mut self.runs;
        self.strangers.retain(|stranger| {
            while let Some((id, _)) = lost.next_if(|(id, _)| *id < stranger.id) {
                missing.push(*id);
            }
            let Some(&(id, row)) = lost.next_if(|(id, _)| *id == stranger.id) else { return true };
            let was = snapshot.kind(row);
            if was != stranger.kind {
                changed = changed.take().or(Some(SnapshotError::Changed { id, was, is: stranger.kind }));
            }
            runs.push(Run { archetype: stranger.archetype, first: stranger.row, row, len: 1 });
            false
        });
        missing.extend(lost.map(|(id, _)| *id));
        match changed {
            Some(error) => Err(error),
            None if missing.is_empty() => Ok(()),
            None => Err(SnapshotError::Missing { ids: missing }),
        }
    }

    /// A body that is left over although the snapshot has its identity is the second with it.
    fn refuse_doubles(&self, snapshot: &Snapshot) -> Result<(), SnapshotError> {
        let is_left = |id: &&BodyId| self.strangers.binary_search_by_key(*id, |stranger| stranger.id).is_ok();
        let double = if self.strangers.is_empty() { None } else { snapshot.ids.iter().filter(is_left).min() };
        double.map_or(Ok(()), |&id| Err(SnapshotError::Duplicate { id }))
    }

    /// The bodies that the snapshot of the last [`find`](Self::find) does not have, by identity.
    pub(crate) fn newcomers(&self, world: &World) -> Vec<Entity> {
        if self.strangers.is_empty() {
            return Vec::new();
        }
        let mut bodies = world.query::<(Entity, &BodyId)>().with::<&Pose>();
        let place = |id: &BodyId| self.strangers.binary_search_by_key(id, |stranger| stranger.id).ok();
        let mut found: Vec<_> = bodies.iter().filter_map(|(entity, id)| Some((place(id)?, entity))).collect();
        found.sort_unstable_by_key(|(place, _)| *place);
        found.into_iter().map(|(_, entity)| entity).collect()
    }
}
