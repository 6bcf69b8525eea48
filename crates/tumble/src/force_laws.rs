//! The laws that a simulation knows, and how the step finds them.
//!
//! A law is a type of the caller's, so the step reaches it through trait objects: once per archetype and law for its column,
//! once per body and evaluation for its force.

use std::any::{TypeId, type_name};
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use hecs::{Archetype, ArchetypeColumn, Component, EntityRef};

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

    /// The law's column of an archetype, where its bodies are subject to the law.
    fn borrow<'w>(&'w self, archetype: &'w Archetype) -> Option<Box<dyn Borrowed + 'w>>;

    /// The potential energy \[J\] of one body.
    fn potential(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> f64;
}

/// A law's column, kept borrowed.
pub(crate) trait Borrowed {
    fn rows(&self) -> Box<dyn LawRows + '_>;
}

/// The law of each body of an archetype, by row.
pub(crate) trait LawRows: Sync {
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

    /// The laws that act in an archetype, with their index.
    pub(crate) fn borrow<'w>(&'w self, archetype: &'w Archetype) -> Vec<(usize, Box<dyn Borrowed + 'w>)> {
        let laws = self.sources.iter().enumerate();
        laws.filter_map(|(index, source)| Some((index, source.borrow(archetype)?))).collect()
    }

    /// The potential energy \[J\] of one body in all laws.
    pub(crate) fn potential(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> f64 {
        self.sources.iter().map(|source| source.potential(body, state)).sum()
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

    fn borrow<'w>(&'w self, archetype: &'w Archetype) -> Option<Box<dyn Borrowed + 'w>> {
        Some(Box::new(archetype.get::<&L>()?))
    }

    fn potential(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> f64 {
        body.get::<&L>().map_or(0.0, |law| law.potential(state))
    }
}

impl<L: ForceLaw + Component> Borrowed for ArchetypeColumn<'_, L> {
    fn rows(&self) -> Box<dyn LawRows + '_> {
        Box::new(Column(self))
    }
}

struct Column<'a, L>(&'a [L]);

impl<L: ForceLaw> LawRows for Column<'_, L> {
    fn wrench(&self, row: usize, state: &BodyState<'_>) -> Wrench {
        self.0[row].wrench(state)
    }

    fn depends_on_velocity(&self, row: usize) -> bool {
        self.0[row].depends_on_velocity()
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

    fn borrow<'w>(&'w self, _: &'w Archetype) -> Option<Box<dyn Borrowed + 'w>> {
        Some(Box::new(&self.0))
    }

    fn potential(&self, _: EntityRef<'_>, state: &BodyState<'_>) -> f64 {
        self.0.potential(state)
    }
}

impl<L: ForceLaw> Borrowed for &L {
    fn rows(&self) -> Box<dyn LawRows + '_> {
        Box::new(Same(*self))
    }
}

/// One law for every row.
struct Same<'a, L>(&'a L);

impl<L: ForceLaw> LawRows for Same<'_, L> {
    fn wrench(&self, _: usize, state: &BodyState<'_>) -> Wrench {
        self.0.wrench(state)
    }

    fn depends_on_velocity(&self, _: usize) -> bool {
        self.0.depends_on_velocity()
    }
}
