//! The index that a simulation keeps for its queries.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use hecs::World;

use crate::queries::query_index::QueryIndex;
use crate::queries::world_queries::Queries;

/// An index that is brought up to date by whoever asks; a copy of it has none yet.
#[derive(Default)]
pub(crate) struct QueryCache(Mutex<Arc<QueryIndex>>);

impl Clone for QueryCache {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl fmt::Debug for QueryCache {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("QueryCache").finish_non_exhaustive()
    }
}

impl QueryCache {
    /// Asks about a world as it is now.
    pub(crate) fn of<'a>(&self, world: &'a World) -> Queries<'a> {
        // Who panicked here has left an index that is compared with the world like any other.
        let mut index = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let changes = index.find_changes(world);
        if !changes.are_none() {
            // Of one that is still in use, about this world or another, a copy is changed.
            Arc::make_mut(&mut index).apply(world, &changes);
        }
        Queries::shared(Arc::clone(&index))
    }
}
