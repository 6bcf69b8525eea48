//! Bodies advanced a tile at a time: all systems of free bodies, or the integration alone.
//!
//! One kernel serves every body. Where an archetype has nothing but what a body needs, as most
//! have, another takes the usual step: what its bodies lack is known when it is compiled, and rare
//! cases are not in it. Both give the same bits.

use std::marker::PhantomData;

use tumble_math::lane::Vec3 as LaneVec3;

use crate::components::Wrenches;
use crate::forces::evaluate::{ActingLaws, TileLawForces};
use crate::forces::force_context::ForceContext;
use crate::forces::registry::Laws;
use crate::forces::tile_buffer::TileBuffer;
use crate::forces::work_account::{WorkAccount, WorkRows};
use crate::integrator::Integrator;
use crate::integrators::derived::derived;
use crate::integrators::state::{Force, State};
use crate::integrators::{
    Account, AnyWidth, ConstantForce, MoserVeselov, NoAccount, RungeKutta4, Scheme, SemiImplicitEuler,
};
use crate::settings::Settings;
use crate::simd::{Kernel, Tile, dispatch};
use crate::storage::chunk::Chunk;
use crate::storage::plain_chunk::PlainChunk;
use crate::storage::tile_io::splat;

/// How much of how many steps is done.
#[derive(Clone, Copy)]
pub(crate) enum Extent {
    /// The integration of one step.
    Integration(Wrenches),
    /// All systems of this many steps.
    Steps(u32),
}

impl Extent {
    /// Whether all systems run.
    fn is_all(self) -> bool {
        matches!(self, Self::Steps(_))
    }

    /// Whether it is one step of one substep.
    fn is_usual(self, settings: &Settings) -> bool {
        matches!(self, Self::Steps(1)) && settings.substeps == 1
    }

    fn wrenches(self) -> Wrenches {
        match self {
            Self::Integration(wrenches) => wrenches,
            Self::Steps(_) => Wrenches::Consumed,
        }
    }
}

pub(crate) fn advance(
    bodies: &mut Chunk<'_>,
    laws: Laws<'_>,
    settings: &Settings,
    extent: Extent,
    time_of_step: &dyn Fn(u32) -> f64,
) {
    match settings.integrator {
        Integrator::SemiImplicitEuler => {
            advance_with::<SemiImplicitEuler<()>>(bodies, laws, settings, extent, time_of_step);
        }
        Integrator::RungeKutta4 => advance_with::<RungeKutta4<()>>(bodies, laws, settings, extent, time_of_step),
        Integrator::MoserVeselov => advance_with::<MoserVeselov<()>>(bodies, laws, settings, extent, time_of_step),
    }
}

fn advance_with<S: AnyWidth>(
    bodies: &mut Chunk<'_>,
    laws: Laws<'_>,
    settings: &Settings,
    extent: Extent,
    time_of_step: &dyn Fn(u32) -> f64,
) {
    if laws.is_empty() {
        bodies.in_whole_tiles(|bodies| match PlainChunk::of(bodies) {
            Some(bodies) if extent.is_usual(settings) => {
                dispatch(&mut AdvancePlain { bodies, settings, scheme: PhantomData::<S> });
            }
            _ => advance_tiles::<S, _>(bodies, settings, extent, time_of_step, Lawless),
        });
    } else {
        let mut tile = TileBuffer::new(ForceContext::new(settings));
        bodies.in_whole_tiles(|bodies| {
            let acting = UnderLaws { laws, tile: &mut tile };
            advance_tiles::<S, _>(bodies, settings, extent, time_of_step, acting);
        });
    }
}

/// With an account of work, where the bodies have one.
fn advance_tiles<S: AnyWidth, A: Acting>(
    bodies: &mut Chunk<'_>,
    settings: &Settings,
    extent: Extent,
    time_of_step: &dyn Fn(u32) -> f64,
    acting: A,
) {
    let scheme = PhantomData::<S>;
    if bodies.work.is_some() {
        let books = Booked(WorkRows::new());
        dispatch(&mut Advance { bodies, settings, extent, time_of_step, acting, books, scheme });
    } else {
        dispatch(&mut Advance { bodies, settings, extent, time_of_step, acting, books: Unbooked, scheme });
    }
}

/// The laws that act on the bodies of a kernel, if any do.
trait Acting {
    const LAWS: bool;

    /// The laws, and where they see their bodies.
    fn laws(&mut self) -> Option<(Laws<'_>, &mut TileBuffer)>;
}

/// No laws act.
struct Lawless;

impl Acting for Lawless {
    const LAWS: bool = false;

    #[inline(always)]
    fn laws(&mut self) -> Option<(Laws<'_>, &mut TileBuffer)> {
        None
    }
}

/// These laws act.
struct UnderLaws<'a> {
    laws: Laws<'a>,
    tile: &'a mut TileBuffer,
}

impl Acting for UnderLaws<'_> {
    const LAWS: bool = true;

    #[inline(always)]
    fn laws(&mut self) -> Option<(Laws<'_>, &mut TileBuffer)> {
        Some((self.laws, self.tile))
    }
}

/// Whether the work on the bodies of a kernel is booked.
trait Books {
    const ARE_KEPT: bool;

    /// Where works lie on their way to the bodies.
    fn rows(&mut self) -> Option<&mut WorkRows>;
}

struct Unbooked;

impl Books for Unbooked {
    const ARE_KEPT: bool = false;

    #[inline(always)]
    fn rows(&mut self) -> Option<&mut WorkRows> {
        None
    }
}

struct Booked(WorkRows);

impl Books for Booked {
    const ARE_KEPT: bool = true;

    #[inline(always)]
    fn rows(&mut self) -> Option<&mut WorkRows> {
        Some(&mut self.0)
    }
}

/// Advances bodies, a tile at a time, and books the work on them or not.
struct Advance<'k, 'a, S, A, B> {
    bodies: &'k mut Chunk<'a>,
    settings: &'k Settings,
    extent: Extent,
    time_of_step: &'k dyn Fn(u32) -> f64,
    acting: A,
    books: B,
    scheme: PhantomData<S>,
}

impl<S: AnyWidth, A: Acting, B: Books> Kernel for Advance<'_, '_, S, A, B> {
    const IS_LARGE: bool = S::IS_LARGE;
    const IS_RARE: bool = B::ARE_KEPT;

    #[inline(always)]
    fn len(&self) -> usize {
        self.bodies.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (bodies, settings) = (&mut *self.bodies, self.settings);
        let constants = bodies.constants::<T>(i);
        let scheme = S::Of::<T>::new(&constants, T::splat(settings.substep().into()));
        let acting = match self.acting.laws() {
            Some((laws, tile)) => Some(ActingLaws::new((bodies, i), &constants, tile, laws)),
            None => None,
        };
        let mut force = bodies.force::<T>(i, self.extent.wrenches());
        let mut state = bodies.state::<T>(i);
        let gravity = bodies.gravity::<T>(i, constants.mass, splat(settings.gravity));
        let steps = match self.extent {
            Extent::Integration(_) => 1,
            Extent::Steps(steps) => {
                force.force = force.force + gravity;
                steps
            }
        };
        for step in 0..steps {
            if step + 1 == steps && self.extent.is_all() {
                bodies.set_previous_pose(i, &state);
            }
            let time = if A::LAWS { (self.time_of_step)(step) } else { 0.0 };
            let forces = (force, &acting, time);
            state = match self.books.rows() {
                Some(rows) => {
                    let mut account = WorkAccount::open((&constants, &state), (force, gravity), acting.as_ref());
                    let end = substeps(&scheme, state, forces, settings, &mut account);
                    let works = bodies.work.as_deref_mut().unwrap_or_default();
                    account.close(&constants, &end, &mut works[i..], rows);
                    end
                }
                None => substeps(&scheme, state, forces, settings, &mut NoAccount),
            };
            // The wrench is consumed, and gravity added to nothing, as a step of its own does it.
            force = Force { force: LaneVec3::zero() + gravity, torque: LaneVec3::zero() };
        }
        if self.extent.is_all() && (bodies.velocity.is_some() || bodies.inverse_inertia.is_some()) {
            bodies.set_derived(i, &derived(&constants, &state));
        }
        bodies.set_state(i, &state);
    }
}

#[inline(always)]
fn substeps<T: Tile, S: Scheme<T>>(
    scheme: &S,
    mut state: State<T>,
    (force, acting, time): (Force<T>, &Option<ActingLaws<'_, T>>, f64),
    settings: &Settings,
    account: &mut impl Account<T>,
) -> State<T> {
    for substep in 0..settings.substeps {
        state = match acting {
            Some(acting) => {
                let time = time + f64::from(substep) * f64::from(settings.substep());
                account.begin_substep(time);
                scheme.advance(state, &TileLawForces { acting, constant: force, time }, account)
            }
            None => scheme.advance(state, &ConstantForce(force), account),
        };
    }
    state
}

/// Advances plain bodies by one step of one substep, a tile at a time.
struct AdvancePlain<'k, S> {
    bodies: PlainChunk<'k>,
    settings: &'k Settings,
    scheme: PhantomData<S>,
}

impl<S: AnyWidth> Kernel for AdvancePlain<'_, S> {
    const IS_LARGE: bool = S::IS_LARGE;

    #[inline(always)]
    fn len(&self) -> usize {
        self.bodies.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let settings = self.settings;
        let mut bodies = self.bodies.as_chunk();
        let constants = bodies.constants::<T>(i);
        let scheme = S::Of::<T>::new(&constants, T::splat(settings.substep().into()));
        let (mut force, is_zero) = bodies.wrenches::<T>(i);
        force.force = force.force + bodies.gravity::<T>(i, constants.mass, splat(settings.gravity));
        match scheme.advance_shortly(bodies.state::<T>(i), force) {
            Some(state) => {
                if !is_zero {
                    bodies.clear_wrenches::<T>(i);
                }
                bodies.set_derived(i, &derived(&constants, &state));
                bodies.set_state(i, &state);
            }
            None => self.advance_rare(i, T::WIDTH),
        }
    }
}

impl<S: AnyWidth> AdvancePlain<'_, S> {
    /// The same for a tile with a body that the usual way is not for. Apart, since what is in a
    /// kernel costs registers where it is not taken either.
    #[cold]
    #[inline(never)]
    fn advance_rare(&mut self, first: usize, count: usize) {
        let mut bodies = self.bodies.as_chunk();
        let bodies = &mut bodies.rows(first..first + count);
        let (settings, extent, acting) = (self.settings, Extent::Steps(1), Lawless);
        dispatch(&mut Advance {
            bodies,
            settings,
            extent,
            time_of_step: &|_| 0.0,
            acting,
            books: Unbooked,
            scheme: self.scheme,
        });
    }
}
