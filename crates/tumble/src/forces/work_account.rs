//! Accounts of the work that is done on a tile of bodies, in double precision.

use tumble_math::lane::{Lane, Vec3};

use crate::components::Work;
use crate::components::work::FORCE_KINDS;
use crate::forces::evaluate::ActingLaws;
use crate::integrators::kinetic_energy::KineticEnergy;
use crate::integrators::state::{Constants, Force, State};
use crate::integrators::{Account, Mean};
use crate::simd::{MAX_BODIES, Tile, widen_vec};

/// Where works lie between a tile and its bodies; made once for a chunk.
pub(crate) struct WorkRows([[f64; MAX_BODIES]; 4]);

impl WorkRows {
    pub(crate) fn new() -> Self {
        Self([[0.0; MAX_BODIES]; 4])
    }
}

/// Adds up the work done on each body of a tile in one step. Nothing is summed over bodies, so
/// neither threads nor the width of tiles change a bit of it.
pub(crate) struct WorkAccount<'f, 'a, T: Tile> {
    acting: Option<&'f ActingLaws<'a, T>>,
    /// Gravity \[N\], and the rest of the constant forces.
    weight: Vec3<T::Double>,
    pushes: Force<T::Double>,
    /// Time at the start of the substep \[s\].
    time: f64,
    /// Kinetic energy at the start of the step \[J\].
    kinetic: T::Double,
    gravity: T::Double,
    applied: T::Double,
    damping: T::Double,
    laws: [T::Double; Work::LAW_ENTRIES],
}

impl<'f, 'a, T: Tile> WorkAccount<'f, 'a, T> {
    /// At the start of a step under a constant force, with `gravity` in it, and under laws, where
    /// they act.
    #[inline(always)]
    pub(crate) fn open(
        (constants, state): (&Constants<T>, &State<T>),
        (force, gravity): (Force<T>, Vec3<T>),
        acting: Option<&'f ActingLaws<'a, T>>,
    ) -> Self {
        let (none, weight) = (T::Double::splat(0.0), widen_vec(gravity));
        Self {
            acting,
            weight,
            pushes: Force { force: widen_vec(force.force) - weight, torque: widen_vec(force.torque) },
            time: 0.0,
            kinetic: KineticEnergy::of(constants, state).sum(),
            gravity: none,
            applied: none,
            damping: none,
            laws: [none; Work::LAW_ENTRIES],
        }
    }

    /// Adds the works of a step that ends in a state, and what is left to the integrator, to those
    /// of each body.
    #[inline(always)]
    pub(crate) fn close(self, constants: &Constants<T>, end: &State<T>, works: &mut [Work], rows: &mut WorkRows) {
        let works = &mut works[..T::WIDTH];
        let mut total = self.gravity + self.applied + self.damping;
        if let Some(acting) = self.acting {
            let [mut of_components, mut of_added] = [T::Double::splat(0.0); 2];
            let mut entry = 0;
            while entry < Work::LAW_ENTRIES {
                if entry < FORCE_KINDS.len() {
                    of_components = of_components + self.laws[entry];
                } else {
                    of_added = of_added + self.laws[entry];
                }
                entry += 1;
            }
            total = total + (of_components + of_added);
            let mut booked = Work::LAW_ENTRIES;
            for (law, _) in acting.laws() {
                let entry = entry_of(law);
                if entry != booked {
                    T::store_doubles(self.laws[entry], &mut rows.0[0]);
                    for (work, of_law) in works.iter_mut().zip(&rows.0[0]) {
                        *work.of_law_mut(entry) += of_law;
                    }
                }
                booked = entry;
            }
        }
        let change = KineticEnergy::of(constants, end).sum() - self.kinetic;
        let [gravity, applied, damping, integrator] = &mut rows.0;
        T::store_doubles(self.gravity, gravity);
        T::store_doubles(self.applied, applied);
        T::store_doubles(self.damping, damping);
        T::store_doubles(change - total, integrator);
        for (i, work) in works.iter_mut().enumerate() {
            work.gravity += gravity[i];
            work.applied += applied[i];
            work.damping += damping[i];
            work.integrator += integrator[i];
        }
    }
}

/// The entry of a law by its index among all; those past the last share it.
fn entry_of(law: usize) -> usize {
    law.min(Work::LAW_ENTRIES - 1)
}

/// What moves a body along with a force, in a time of this weight: its way \[m\] and its turn
/// \[rad\].
#[inline(always)]
fn moved<T: Tile>(mean: &Mean<T>, weight: (T, T)) -> (Vec3<T::Double>, Vec3<T::Double>) {
    (widen_vec(mean.linear) * weight.0.widen(), widen_vec(mean.angular) * weight.1.widen())
}

impl<T: Tile> Account<T> for WorkAccount<'_, '_, T> {
    const KEPT: bool = true;

    #[inline(always)]
    fn begin_substep(&mut self, time: f64) {
        self.time = time;
    }

    #[inline(always)]
    fn constant_impulse(&mut self, weight: (T, T), mean: &Mean<T>) {
        let (way, turn) = moved(mean, weight);
        self.gravity = self.gravity + self.weight.dot(way);
        self.applied = self.applied + (self.pushes.force.dot(way) + self.pushes.torque.dot(turn));
    }

    #[inline(always)]
    fn varying_impulse(&mut self, offset: T, at: &State<T>, weight: (T, T), mean: &Mean<T>) {
        if let Some(acting) = self.acting {
            let (way, turn) = moved(mean, weight);
            let mut tile = acting.seen_by_laws(self.time, offset, at);
            for (index, law) in acting.laws() {
                tile.clear_forces::<T>();
                law.add_forces(&mut tile);
                let Force { force, torque } = tile.sum::<T>();
                let entry = entry_of(index);
                self.laws[entry] = self.laws[entry] + (widen_vec(force).dot(way) + widen_vec(torque).dot(turn));
            }
        }
    }

    #[inline(always)]
    fn damping(&mut self, linear: Vec3<T>, angular: Vec3<T>, mean: &Mean<T>) {
        let lost = widen_vec(linear).dot(widen_vec(mean.linear)) + widen_vec(angular).dot(widen_vec(mean.angular));
        self.damping = self.damping + lost;
    }
}
