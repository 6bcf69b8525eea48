//! The laws that a simulation knows, and how the step finds them.
//!
//! A law is a type of the caller's, so the step reaches it through trait objects: once per archetype and law for its column,
//! once per body and evaluation for its force.

use std::any::{TypeId, type_name};
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use hecs::{Archetype, Component, EntityRef};

use crate::components::Wrench;
use crate::force_law::{BodyState, ForceLaw};

/// The laws of a simulation, in the order they were added.
#[derive(Clone, Default)]
pub struct ForceLaws {
    sources: Vec<Arc<dyn Source>>,
}

/// One law that can act on the bodies of an archetype.
trait Source: Send + Sync {
    fn name(&self) -> &'static str;

    /// The component that the law is; none of one that acts everywhere.
    fn component(&self) -> Option<TypeId>;

    /// Whether the bodies of an archetype are subject to the law.
    fn acts_on(&self, archetype: &Archetype) -> bool;

    /// Calls `then` with the law of each body of an archetype that [it acts on](Self::acts_on).
    fn with_rows(&self, archetype: &Archetype, then: &mut dyn FnMut(&dyn LawRows));

    /// The potential energy \[J\] of one body.
    fn potential(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> f64;
}

/// Laws that act on the bodies of one archetype: a list whose links lie on the stack of the step.
#[derive(Clone, Copy, Default)]
pub(crate) struct Laws<'a> {
    first: Option<&'a Link<'a>>,
    /// Rows of the archetype.
    rows: usize,
}

struct Link<'a> {
    index: usize,
    rows: &'a dyn LawRows,
    next: Laws<'a>,
}

impl<'a> Laws<'a> {
    pub(crate) fn is_empty(self) -> bool {
        self.first.is_none()
    }

    /// How many bodies there are from a row on.
    pub(crate) fn bodies_from(self, row: usize) -> usize {
        self.rows.saturating_sub(row)
    }
}

impl<'a> Iterator for Laws<'a> {
    /// A law's index among all laws, and the law of each body.
    type Item = (usize, &'a dyn LawRows);

    fn next(&mut self) -> Option<Self::Item> {
        let link = self.first?;
        *self = link.next;
        Some((link.index, link.rows))
    }
}

/// The law of each body of an archetype, by row.
pub(crate) trait LawRows: Sync {
    /// Adds to each body's wrench; the first body's is the law of the row, the next one's that of the next row, and so on to the last row.
    fn add_wrenches(&self, row: usize, states: &[BodyState<'_>], wrenches: &mut [Wrench]);
    fn wrench(&self, row: usize, state: &BodyState<'_>) -> Wrench;
    fn depends_on_velocity(&self, row: usize) -> bool;
}

impl ForceLaws {
    /// Adds the law that is a component of some bodies; once, however often it is called.
    pub fn add<L: ForceLaw + Component>(&mut self) {
        if self.sources.iter().all(|source| source.component() != Some(TypeId::of::<L>())) {
            self.sources.push(Arc::new(ComponentLaw::<L>(PhantomData)));
        }
    }

    /// Adds a law that acts on every moving body.
    pub fn add_everywhere<L: ForceLaw>(&mut self, law: L) {
        self.sources.push(Arc::new(EverywhereLaw(law)));
    }

    /// The laws' type names, in order.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.sources.iter().map(|source| source.name())
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.sources.is_empty()
    }

    /// Calls `then` with the laws that act in an archetype, in order.
    pub(crate) fn with_rows(&self, archetype: &Archetype, then: &mut dyn FnMut(Laws<'_>)) {
        with_rows_before(&self.sources, archetype, Laws { first: None, rows: archetype.len() as usize }, then);
    }

    /// The potential energy \[J\] of one body in all laws.
    pub(crate) fn potential(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> f64 {
        self.sources.iter().map(|source| source.potential(body, state)).sum()
    }
}

/// Puts the laws of `sources` before those that are there: one call deeper for each, which keeps its column borrowed.
fn with_rows_before(
    sources: &[Arc<dyn Source>],
    archetype: &Archetype,
    laws: Laws<'_>,
    then: &mut dyn FnMut(Laws<'_>),
) {
    let Some((source, before)) = sources.split_last() else { return then(laws) };
    if source.acts_on(archetype) {
        source.with_rows(archetype, &mut |rows| {
            let link = Link { index: before.len(), rows, next: laws };
            with_rows_before(before, archetype, Laws { first: Some(&link), rows: laws.rows }, then);
        });
    } else {
        with_rows_before(before, archetype, laws, then);
    }
}

impl fmt::Debug for ForceLaws {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.names()).finish()
    }
}

/// The type's name without its path.
fn short_name<L>() -> &'static str {
    let name = type_name::<L>();
    let end = name.find('<').unwrap_or(name.len());
    let start = name[..end].rfind("::").map_or(0, |colons| colons + 2);
    &name[start..]
}

struct ComponentLaw<L>(PhantomData<fn() -> L>);

impl<L: ForceLaw + Component> Source for ComponentLaw<L> {
    fn component(&self) -> Option<TypeId> {
        Some(TypeId::of::<L>())
    }

    fn name(&self) -> &'static str {
        short_name::<L>()
    }

    fn acts_on(&self, archetype: &Archetype) -> bool {
        archetype.has::<L>()
    }

    fn with_rows(&self, archetype: &Archetype, then: &mut dyn FnMut(&dyn LawRows)) {
        if let Some(column) = archetype.get::<&L>() {
            then(&Column(&column));
        }
    }

    fn potential(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> f64 {
        body.get::<&L>().map_or(0.0, |law| law.potential(state))
    }
}

struct Column<'a, L>(&'a [L]);

impl<L: ForceLaw> LawRows for Column<'_, L> {
    fn add_wrenches(&self, row: usize, states: &[BodyState<'_>], wrenches: &mut [Wrench]) {
        for ((law, state), wrench) in self.0[row..].iter().zip(states).zip(wrenches) {
            wrench.add(law.wrench(state));
        }
    }

    fn wrench(&self, row: usize, state: &BodyState<'_>) -> Wrench {
        self.0[row].wrench(state)
    }

    fn depends_on_velocity(&self, row: usize) -> bool {
        self.0.get(row).is_some_and(ForceLaw::depends_on_velocity)
    }
}

struct EverywhereLaw<L>(L);

impl<L: ForceLaw> Source for EverywhereLaw<L> {
    fn component(&self) -> Option<TypeId> {
        None
    }

    fn name(&self) -> &'static str {
        short_name::<L>()
    }

    fn acts_on(&self, _: &Archetype) -> bool {
        true
    }

    fn with_rows(&self, _: &Archetype, then: &mut dyn FnMut(&dyn LawRows)) {
        then(&Same(&self.0));
    }

    fn potential(&self, _: EntityRef<'_>, state: &BodyState<'_>) -> f64 {
        self.0.potential(state)
    }
}

/// One law for every row.
struct Same<'a, L>(&'a L);

impl<L: ForceLaw> LawRows for Same<'_, L> {
    fn add_wrenches(&self, _: usize, states: &[BodyState<'_>], wrenches: &mut [Wrench]) {
        for (state, wrench) in states.iter().zip(wrenches) {
            wrench.add(self.0.wrench(state));
        }
    }

    fn wrench(&self, _: usize, state: &BodyState<'_>) -> Wrench {
        self.0.wrench(state)
    }

    fn depends_on_velocity(&self, _: usize) -> bool {
        self.0.depends_on_velocity()
    }
}
