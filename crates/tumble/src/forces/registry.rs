//! The laws that a simulation knows, and how the step finds them.
//!
//! A law may be a type of the caller's, so the step reaches it through trait objects: once per
//! archetype and law for its column, once per tile and evaluation for its forces.

use std::any::{TypeId, type_name};
use std::fmt;
use std::marker::PhantomData;
use std::sync::{Arc, OnceLock};

use hecs::{Archetype, Component, EntityRef};

use crate::components::Wrench;
use crate::components::work::FORCE_KINDS;
use crate::forces::components::{
    AngularVelocityServo, Buoyancy, ConstantWrench, Drag, Magnus, PointGravity, SpringToPoint, Thruster,
};
use crate::forces::force_law::{BodyState, ForceLaw};
use crate::forces::pairwise::{GravityMass, Spring};
use crate::forces::simd_force_law::{SimdBody, SimdForceLaw};
use crate::forces::tile_buffer::TileBuffer;
use crate::math::Real;
use crate::storage::type_marks::TypeMarks;

/// The laws of a simulation: the force components, which every simulation knows, and those that
/// were added, in their order.
///
/// ```
/// # use tumble::prelude::*;
/// # use tumble::ForceLaws;
/// /// Pulls everything to the west.
/// struct Current;
///
/// impl ForceLaw for Current {
///     fn wrench(&self, _state: &BodyState<'_>) -> Wrench {
///         Wrench { force: Vec3::NEG_X, torque: Vec3::ZERO }
///     }
/// }
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.add_global_law(Current);
/// assert_eq!(simulation.laws().names().count(), 1);
/// assert!(ForceLaws::COMPONENTS.contains(&"Drag"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Default)]
pub struct ForceLaws {
    added: Vec<Arc<dyn LawSource>>,
}

/// Declares the laws that are known without being added, each evaluated in lanes.
macro_rules! known {
    ($($law:ident: $Law:ident, $numbers:literal);+ $(;)?) => {
        static KNOWN: &[&dyn LawSource] = &[$(&OfComponent::<InLanes<$Law, $numbers>>(PhantomData)),+];

        const KNOWN_NAMES: &[&str] = &[$(stringify!($Law)),+];

        /// The force components of a body, but for those between bodies.
        pub(crate) type KnownLaws<'a> = ($(Option<&'a $Law>,)+);

        /// Whether there is one.
        pub(crate) fn is_any(($($law,)+): &KnownLaws<'_>) -> bool {
            $($law.is_some())||+
        }

        /// The potential energy \[J\] of one body in them.
        pub(crate) fn potential(($($law,)+): &KnownLaws<'_>, state: &BodyState<'_>) -> f64 {
            let mut sum = 0.0;
            $(sum += $law.map_or(0.0, |law| SimdForceLaw::<$numbers>::potential(law, state));)+
            sum
        }
    };
}

known! {
    drag: Drag, 6;
    magnus: Magnus, 1;
    thruster: Thruster, 6;
    constant_wrench: ConstantWrench, 7;
    spring_to_point: SpringToPoint, 9;
    point_gravity: PointGravity, 5;
    buoyancy: Buoyancy, 9;
    servo: AngularVelocityServo, 5;
}

/// Index of [`Spring`](crate::Spring) in [`FORCE_KINDS`].
pub(crate) const SPRING: usize = KNOWN_NAMES.len();
/// Index of [`GravityMass`](crate::GravityMass) in [`FORCE_KINDS`].
pub(crate) const GRAVITY_MASS: usize = SPRING + 1;

// The accounts of works are named in the order of the laws.
const _: () = {
    assert!(FORCE_KINDS.len() == GRAVITY_MASS + 1);
    let mut i = 0;
    while i < SPRING {
        assert!(is_same(FORCE_KINDS[i], KNOWN_NAMES[i]));
        i += 1;
    }
    assert!(is_same(FORCE_KINDS[SPRING], "Spring") && is_same(FORCE_KINDS[GRAVITY_MASS], "GravityMass"));
};

const fn is_same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

/// One law that can act on the bodies of an archetype.
trait LawSource: Send + Sync {
    fn name(&self) -> &'static str;

    /// The component that the law is; none of one that acts everywhere.
    fn component(&self) -> Option<TypeId>;

    /// Whether the bodies of an archetype are subject to the law.
    fn acts_on(&self, archetype: &Archetype) -> bool;

    /// Calls `then` with the law of each body of an archetype that [it acts on](Self::acts_on).
    fn with_rows(&self, archetype: &Archetype, then: &mut dyn FnMut(&dyn LawRows));

    /// The potential energy \[J\] of one body.
    fn potential(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> f64;

    /// Its wrench on one body; zero where it does not act.
    fn wrench(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> Wrench;
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
    /// Adds the wrench on each body of a tile.
    fn add_forces(&self, tile: &mut TileBuffer);
    fn wrench(&self, row: usize, state: &BodyState<'_>) -> Wrench;
    /// Sets to one the marks of those bodies, from a row on, whose law depends on velocity.
    fn mark_velocity_dependent(&self, row: usize, marks: &mut [Real]);
}

impl ForceLaws {
    /// The kinds of force components, which act on the bodies that carry them without being added.
    pub const COMPONENTS: [&'static str; FORCE_KINDS.len()] = FORCE_KINDS;

    /// Adds the law that is a component of some bodies; once, however often it is called.
    pub fn add<L: ForceLaw + Component>(&mut self) {
        self.add_component::<OneByOne<L>>();
    }

    /// Adds the law that is a component of some bodies and written for many at once; once, however
    /// often it is called.
    pub fn add_simd_law<L: SimdForceLaw<N> + Component, const N: usize>(&mut self) {
        self.add_component::<InLanes<L, N>>();
    }

    fn add_component<E: Evaluation>(&mut self)
    where
        E::Law: Component,
    {
        let law = OfComponent::<E>(PhantomData);
        let is_known = |source: &dyn LawSource| source.component() == law.component();
        if !KNOWN.iter().any(|source| is_known(*source)) && !self.added.iter().any(|source| is_known(&**source)) {
            self.added.push(Arc::new(law));
        }
    }

    /// Adds a law that acts on every moving body.
    pub fn add_global<L: ForceLaw>(&mut self, law: L) {
        self.added.push(Arc::new(Everywhere::<OneByOne<L>>(law)));
    }

    /// Adds a law that acts on every moving body and is written for many at once.
    pub fn add_global_simd_law<L: SimdForceLaw<N>, const N: usize>(&mut self, law: L) {
        self.added.push(Arc::new(Everywhere::<InLanes<L, N>>(law)));
    }

    /// The type names of the laws that were added, in order.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.added.iter().map(|source| source.name())
    }

    /// Whether none was added.
    pub(crate) fn is_empty(&self) -> bool {
        self.added.is_empty()
    }

    /// The types of the force components, those between bodies included.
    pub(crate) fn component_types() -> impl Iterator<Item = TypeId> {
        let between_bodies = [TypeId::of::<Spring>(), TypeId::of::<GravityMass>()];
        KNOWN.iter().filter_map(|source| source.component()).chain(between_bodies)
    }

    /// Whether a law may act on the bodies of an archetype.
    pub(crate) fn may_act_on(&self, archetype: &Archetype) -> bool {
        !self.is_empty() || may_have_forces(archetype)
    }

    /// The laws, with their indices: the index of an account is that of the law.
    fn sources(&self) -> impl DoubleEndedIterator<Item = (usize, &dyn LawSource)> {
        let added = self.added.iter().enumerate().map(|(i, source)| (Self::COMPONENTS.len() + i, &**source));
        KNOWN.iter().enumerate().map(|(i, source)| (i, *source)).chain(added)
    }

    /// Calls `then` with the laws that act in an archetype, in order.
    pub(crate) fn with_rows(&self, archetype: &Archetype, then: &mut dyn FnMut(Laws<'_>)) {
        let mut acting = self.sources().rev().filter(|(_, source)| source.acts_on(archetype));
        with_rows_before(&mut acting, archetype, Laws { first: None, rows: archetype.len() as usize }, then);
    }

    /// The potential energy \[J\] of one body in the laws that were added.
    pub(crate) fn potential(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> f64 {
        self.added.iter().map(|source| source.potential(body, state)).sum()
    }

    /// The wrenches of a body's force components, but for those between bodies.
    pub(crate) fn wrenches_of_components(body: EntityRef<'_>, state: &BodyState<'_>) -> impl Iterator<Item = Wrench> {
        KNOWN.iter().map(move |source| source.wrench(body, state))
    }

    /// The wrenches of the laws that were added on a body.
    pub(crate) fn wrenches_of_added(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> impl Iterator<Item = Wrench> {
        self.added.iter().map(move |source| source.wrench(body, state))
    }
}

/// Whether an archetype may have force components, those between bodies included; seldom says so of
/// one that has none.
pub(crate) fn may_have_forces(archetype: &Archetype) -> bool {
    static FORCES: OnceLock<TypeMarks> = OnceLock::new();
    let forces = FORCES.get_or_init(|| TypeMarks::of(ForceLaws::component_types().map(|id| (id, 1))));
    forces.on(archetype) != 0
}

/// Puts the laws of `sources`, which come last first, before those that are there: one call deeper
/// for each, which keeps its column borrowed.
fn with_rows_before<'s>(
    sources: &mut dyn Iterator<Item = (usize, &'s dyn LawSource)>,
    archetype: &Archetype,
    laws: Laws<'_>,
    then: &mut dyn FnMut(Laws<'_>),
) {
    let Some((index, source)) = sources.next() else { return then(laws) };
    source.with_rows(archetype, &mut |rows| {
        let link = Link { index, rows, next: laws };
        with_rows_before(sources, archetype, Laws { first: Some(&link), rows: laws.rows }, then);
    });
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

/// How a kind of law is evaluated.
trait Evaluation: 'static {
    type Law: Send + Sync + 'static;

    /// Adds the wrenches on a tile; `law` is that of a row.
    fn add_forces<'l>(law: impl Fn(usize) -> &'l Self::Law, tile: &mut TileBuffer);
    fn wrench(law: &Self::Law, state: &BodyState<'_>) -> Wrench;
    fn depends_on_velocity(law: &Self::Law) -> bool;
    fn potential(law: &Self::Law, state: &BodyState<'_>) -> f64;
}

/// Body after body.
struct OneByOne<L>(PhantomData<L>);

impl<L: ForceLaw> Evaluation for OneByOne<L> {
    type Law = L;

    fn add_forces<'l>(law: impl Fn(usize) -> &'l L, tile: &mut TileBuffer) {
        tile.add_one_by_one(|row, state| law(row).wrench(state));
    }

    fn wrench(law: &L, state: &BodyState<'_>) -> Wrench {
        law.wrench(state)
    }

    fn depends_on_velocity(law: &L) -> bool {
        law.depends_on_velocity()
    }

    fn potential(law: &L, state: &BodyState<'_>) -> f64 {
        law.potential(state)
    }
}

/// Many bodies at once.
struct InLanes<L, const N: usize>(PhantomData<L>);

impl<L: SimdForceLaw<N>, const N: usize> Evaluation for InLanes<L, N> {
    type Law = L;

    fn add_forces<'l>(law: impl Fn(usize) -> &'l L, tile: &mut TileBuffer) {
        tile.add_in_lanes(law);
    }

    fn wrench(law: &L, state: &BodyState<'_>) -> Wrench {
        let wrench = L::wrench(law.numbers(), &SimdBody::of(state));
        Wrench { force: wrench.force.into(), torque: wrench.torque.into() }
    }

    fn depends_on_velocity(law: &L) -> bool {
        law.depends_on_velocity()
    }

    fn potential(law: &L, state: &BodyState<'_>) -> f64 {
        law.potential(state)
    }
}

/// A law that is a component.
struct OfComponent<E>(PhantomData<fn() -> E>);

impl<E: Evaluation<Law: Component>> LawSource for OfComponent<E> {
    fn component(&self) -> Option<TypeId> {
        Some(TypeId::of::<E::Law>())
    }

    fn name(&self) -> &'static str {
        short_name::<E::Law>()
    }

    fn acts_on(&self, archetype: &Archetype) -> bool {
        archetype.has::<E::Law>()
    }

    fn with_rows(&self, archetype: &Archetype, then: &mut dyn FnMut(&dyn LawRows)) {
        if let Some(column) = archetype.get::<&E::Law>() {
            then(&RowsOfLaw::<E>::Each(&column));
        }
    }

    fn potential(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> f64 {
        body.get::<&E::Law>().map_or(0.0, |law| E::potential(&law, state))
    }

    fn wrench(&self, body: EntityRef<'_>, state: &BodyState<'_>) -> Wrench {
        body.get::<&E::Law>().map_or(Wrench::default(), |law| E::wrench(&law, state))
    }
}

/// A law that acts on every moving body.
struct Everywhere<E: Evaluation>(E::Law);

impl<E: Evaluation> LawSource for Everywhere<E> {
    fn component(&self) -> Option<TypeId> {
        None
    }

    fn name(&self) -> &'static str {
        short_name::<E::Law>()
    }

    fn acts_on(&self, _: &Archetype) -> bool {
        true
    }

    fn with_rows(&self, _: &Archetype, then: &mut dyn FnMut(&dyn LawRows)) {
        then(&RowsOfLaw::<E>::Same(&self.0));
    }

    fn potential(&self, _: EntityRef<'_>, state: &BodyState<'_>) -> f64 {
        E::potential(&self.0, state)
    }

    fn wrench(&self, _: EntityRef<'_>, state: &BodyState<'_>) -> Wrench {
        E::wrench(&self.0, state)
    }
}

/// The law of each row.
enum RowsOfLaw<'a, E: Evaluation> {
    Each(&'a [E::Law]),
    Same(&'a E::Law),
}

impl<E: Evaluation> RowsOfLaw<'_, E> {
    fn law(&self, row: usize) -> &E::Law {
        match self {
            Self::Each(laws) => &laws[row],
            Self::Same(law) => law,
        }
    }
}

impl<E: Evaluation> LawRows for RowsOfLaw<'_, E> {
    fn add_forces(&self, tile: &mut TileBuffer) {
        E::add_forces(|row| self.law(row), tile);
    }

    fn wrench(&self, row: usize, state: &BodyState<'_>) -> Wrench {
        E::wrench(self.law(row), state)
    }

    fn mark_velocity_dependent(&self, row: usize, marks: &mut [Real]) {
        let rows = match self {
            Self::Each(laws) => laws.len().saturating_sub(row),
            Self::Same(_) => marks.len(),
        };
        for (i, mark) in marks.iter_mut().enumerate().take(rows) {
            if E::depends_on_velocity(self.law(row + i)) {
                *mark = 1.0;
            }
        }
    }
}
