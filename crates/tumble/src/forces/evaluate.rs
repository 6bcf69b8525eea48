//! The forces on bodies where force laws act: on one of them, and on a tile.

use std::cell::{RefCell, RefMut};

use crate::components::Wrench;
use crate::forces::force_context::ForceContext;
use crate::forces::force_law::BodyState;
use crate::forces::registry::Laws;
use crate::forces::tile_buffer::TileBuffer;
use crate::integrators::Forces;
use crate::integrators::state::{Constants, Force, State};
use crate::math::Real;
use crate::simd::{MAX_BODIES, Tile};
use crate::storage::chunk::Chunk;

/// All that pushes one body during a substep.
pub(crate) struct LawForces<'a> {
    pub(crate) constants: &'a Constants<Real>,
    pub(crate) context: &'a ForceContext,
    /// Gravity and what the caller applied, constant over the step.
    pub(crate) wrench: Wrench,
    pub(crate) laws: Laws<'a>,
    /// The body's row among the laws' rows.
    pub(crate) row: usize,
    /// Time at the start of the substep \[s\].
    pub(crate) time: f64,
}

impl LawForces<'_> {
    fn seen_by_laws(&self, offset: Real, state: &State<Real>) -> BodyState<'_> {
        BodyState::new((self.time, offset), (self.constants, self.context), state)
    }
}

impl Forces<Real> for LawForces<'_> {
    const VARY: bool = true;

    fn constant(&self) -> Force<Real> {
        self.wrench.into()
    }

    fn varying(&self, offset: Real, state: &State<Real>) -> Force<Real> {
        let mut sum = Wrench::default();
        if !self.laws.is_empty() {
            let body_state = self.seen_by_laws(offset, state);
            for (_, law) in self.laws {
                sum.add(law.wrench(self.row, &body_state));
            }
        }
        sum.into()
    }

    fn depends_on_velocity(&self) -> Option<bool> {
        let mut depends = [0.0];
        self.laws.into_iter().for_each(|(_, law)| law.mark_velocity_dependent(self.row, &mut depends));
        (depends[0] > 0.0).then_some(true)
    }
}

/// The laws that act on a tile of bodies, and their inputs.
pub(crate) struct ActingLaws<'a, T: Tile> {
    constants: Constants<T>,
    tile: RefCell<&'a mut TileBuffer>,
    laws: Laws<'a>,
    /// Which bodies some law on them depends on velocity; `None` for none.
    depends_on_velocity: Option<T::Mask>,
}

impl<'a, T: Tile> ActingLaws<'a, T> {
    /// Of the bodies from row `i` of a chunk, under these laws.
    #[inline(always)]
    pub(crate) fn new(
        (bodies, i): (&Chunk<'_>, usize),
        constants: &Constants<T>,
        tile: &'a mut TileBuffer,
        laws: Laws<'a>,
    ) -> Self {
        let row = bodies.first_row + i;
        let mut depend: [Real; MAX_BODIES] = [0.0; MAX_BODIES];
        for (_, law) in laws {
            law.mark_velocity_dependent(row, &mut depend[..T::WIDTH]);
        }
        let [depend] = T::load(&depend);
        let mask = T::splat(0.0).lt(depend);
        tile.set_constants(constants, bodies.wind::<T>(i), row, laws.bodies_from(row));
        Self {
            constants: *constants,
            tile: RefCell::new(tile),
            laws,
            depends_on_velocity: if T::any(mask) { Some(mask) } else { None },
        }
    }

    pub(crate) fn laws(&self) -> Laws<'a> {
        self.laws
    }

    /// What laws see of the bodies at a state, `offset` \[s\] after `time` \[s\], the start of a
    /// substep; no force is on them yet.
    #[inline(always)]
    pub(crate) fn seen_by_laws(&self, time: f64, offset: T, state: &State<T>) -> RefMut<'_, &'a mut TileBuffer> {
        let mut tile = self.tile.borrow_mut();
        tile.set_stage(time, offset, &self.constants, state);
        tile.clear_forces::<T>();
        tile
    }
}

/// All that pushes a tile of bodies during a substep.
pub(crate) struct TileLawForces<'f, 'a, T: Tile> {
    pub(crate) acting: &'f ActingLaws<'a, T>,
    /// Gravity and what the caller applied, constant over the step.
    pub(crate) constant: Force<T>,
    /// Time at the start of the substep \[s\].
    pub(crate) time: f64,
}

impl<T: Tile> Forces<T> for TileLawForces<'_, '_, T> {
    const VARY: bool = true;

    #[inline(always)]
    fn constant(&self) -> Force<T> {
        self.constant
    }

    #[inline(always)]
    fn varying(&self, offset: T, state: &State<T>) -> Force<T> {
        let mut tile = self.acting.seen_by_laws(self.time, offset, state);
        for (_, law) in self.acting.laws {
            law.add_forces(&mut tile);
        }
        tile.sum()
    }

    #[inline(always)]
    fn depends_on_velocity(&self) -> Option<T::Mask> {
        self.acting.depends_on_velocity
    }
}
