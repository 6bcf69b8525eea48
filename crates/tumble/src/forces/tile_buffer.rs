//! Tiles of bodies in memory, as laws are given them: the caller's laws are reached by calls that
//! vector registers do not survive.

use std::marker::PhantomData;

use tumble_math::lane::{Quat, Vec3 as LaneVec3};

use crate::components::Wrench;
use crate::forces::force_context::ForceContext;
use crate::forces::force_law::BodyState;
use crate::forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
use crate::integrators::state::{Constants, Force, Moments, State};
use crate::math::{Quat as GlamQuat, Real, Vec3};
use crate::simd::{Kernel, MAX_BODIES, Tile, dispatch};

/// One number of each body.
type Row = [Real; MAX_BODIES];

/// The state of a tile of bodies at one stage, as laws read it, and the sum of their wrenches. One
/// for a chunk, refilled for every tile.
#[repr(align(64))]
pub(crate) struct TileBuffer {
    mass: Row,
    wind: [Row; 3],
    /// Principal moments and their inverses.
    inertia: [Row; 6],
    axes: [Row; 4],
    /// Offset of the stage, position, orientation, linear and angular velocity.
    stage: [Row; 14],
    /// Sums of forces and torques.
    forces: [Row; 6],
    turns: bool,
    has_axes: bool,
    width: usize,
    /// How many bodies are there; the others only fill up the tile.
    bodies: usize,
    /// The first body's row among the laws' rows.
    row: usize,
    /// Time at the start of the substep \[s\].
    time: f64,
    /// All but the wind, which is each body's own.
    context: ForceContext,
}

impl TileBuffer {
    pub(crate) fn new(context: ForceContext) -> Self {
        const ROW: Row = [0.0; MAX_BODIES];
        Self {
            mass: ROW,
            wind: [ROW; 3],
            inertia: [ROW; 6],
            axes: [ROW; 4],
            stage: [ROW; 14],
            forces: [ROW; 6],
            turns: false,
            has_axes: false,
            width: 0,
            bodies: 0,
            row: 0,
            time: 0.0,
            context,
        }
    }

    /// Copies the constants of a step, of bodies whose first is that of a row among
    /// the laws' rows.
    #[inline(always)]
    pub(crate) fn set_constants<T: Tile>(
        &mut self,
        constants: &Constants<T>,
        wind: Option<LaneVec3<T>>,
        row: usize,
        bodies: usize,
    ) {
        (self.width, self.bodies, self.row) = (T::WIDTH, T::WIDTH.min(bodies), row);
        T::store([constants.mass], &mut self.mass);
        if let Some(wind) = wind {
            store(&mut self.wind, [wind.x, wind.y, wind.z]);
        }
        self.turns = constants.inertia.is_some();
        if let Some(inertia) = &constants.inertia {
            let (m, i) = (inertia.moments, inertia.inverse_moments);
            store(&mut self.inertia, [m.x, m.y, m.z, i.x, i.y, i.z]);
            self.has_axes = inertia.axes.is_some();
            if let Some(axes) = inertia.axes {
                store(&mut self.axes, [axes.x, axes.y, axes.z, axes.w]);
            }
        }
    }

    /// Copies a state that the bodies reach `offset` \[s\] after `time` \[s\], the start of a
    /// substep.
    #[inline(always)]
    pub(crate) fn set_stage<T: Tile>(&mut self, time: f64, offset: T, constants: &Constants<T>, state: &State<T>) {
        let q = state.orientation.normalize();
        let (x, v) = (state.position, constants.velocity(state.linear));
        let w = constants.angular_velocity(&State { orientation: q, ..*state });
        self.time = time;
        store(&mut self.stage, [offset, x.x, x.y, x.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z]);
    }

    /// Forgets the laws' forces and torques.
    #[inline(always)]
    pub(crate) fn clear_forces<T: Tile>(&mut self) {
        store(&mut self.forces, [T::splat(0.0); 6]);
    }

    /// The sums of the laws' forces and torques.
    #[inline(always)]
    pub(crate) fn sum<T: Tile>(&self) -> Force<T> {
        let [x, y, z, a, b, c] = load(&self.forces, 0);
        Force { force: LaneVec3::new(x, y, z), torque: LaneVec3::new(a, b, c) }
    }

    #[inline(always)]
    fn constants<T: Tile>(&self, i: usize) -> Constants<T> {
        let mut inertia = None;
        if self.turns {
            let [a, b, c, inverse_a, inverse_b, inverse_c] = load(&self.inertia, i);
            let mut axes = None;
            if self.has_axes {
                let [x, y, z, w] = load(&self.axes, i);
                axes = Some(Quat { x, y, z, w });
            }
            let inverse_moments = LaneVec3::new(inverse_a, inverse_b, inverse_c);
            inertia = Some(Moments { moments: LaneVec3::new(a, b, c), inverse_moments, axes });
        }
        let [mass] = T::load(&self.mass[i..]);
        Constants { mass, inertia, damping: None }
    }

    /// Some of the bodies, from the `i`-th on.
    #[inline(always)]
    fn lanes<T: Tile>(&self, i: usize) -> SimdBody<T> {
        let [offset, x, y, z, qx, qy, qz, qw, vx, vy, vz, wx, wy, wz] = load(&self.stage, i);
        let [wind_x, wind_y, wind_z] = load(&self.wind, i);
        let constants = self.constants::<T>(i);
        let context = &self.context;
        SimdBody {
            time: self.time,
            offset,
            position: LaneVec3::new(x, y, z),
            orientation: Quat { x: qx, y: qy, z: qz, w: qw },
            linear_velocity: LaneVec3::new(vx, vy, vz),
            angular_velocity: LaneVec3::new(wx, wy, wz),
            mass: constants.mass,
            wind: LaneVec3::new(wind_x, wind_y, wind_z),
            gravity: crate::storage::tile_io::splat(context.gravity),
            constants,
            kick: T::splat(context.kick.into()),
            substep: T::splat(context.substep.into()),
        }
    }

    /// Adds a law's wrench on each body that is there; `wrench` is given its row and its state.
    pub(crate) fn add_one_by_one(&mut self, wrench: impl Fn(usize, &BodyState<'_>) -> Wrench) {
        for i in 0..self.bodies {
            let constants = self.constants::<Real>(i);
            let n = &self.stage;
            let vector = |at: usize| Vec3::new(n[at][i], n[at + 1][i], n[at + 2][i]);
            let wind = Vec3::new(self.wind[0][i], self.wind[1][i], self.wind[2][i]);
            let context = ForceContext { wind, ..self.context };
            let orientation = GlamQuat::from_xyzw(n[4][i], n[5][i], n[6][i], n[7][i]);
            let state = BodyState::of_velocities(
                (self.time, n[0][i]),
                (&constants, &context),
                (vector(1), orientation),
                (vector(8), vector(11)),
            );
            let sum = wrench(self.row + i, &state);
            let numbers = [sum.force, sum.torque].map(|vector| vector.to_array());
            for (row, number) in self.forces.iter_mut().zip(numbers.into_iter().flatten()) {
                row[i] += number;
            }
        }
    }

    /// Adds the wrenches of a law that is written for tiles; `law` is that of a row.
    pub(crate) fn add_in_lanes<'l, const N: usize, L: SimdForceLaw<N>>(&mut self, law: impl Fn(usize) -> &'l L) {
        let mut numbers = [[0.0; MAX_BODIES]; N];
        // A tile is of one body at least.
        let last = self.bodies - 1;
        for i in 0..self.width {
            let of_one = law(self.row + i.min(last)).numbers();
            for (row, number) in numbers.iter_mut().zip(of_one) {
                row[i] = number;
            }
        }
        dispatch(&mut LaneEvaluation::<N, L> { tile: self, numbers: &numbers, law: PhantomData });
    }
}

/// Evaluates a law on the bodies of a tile, as many at a time as the machine has lanes.
struct LaneEvaluation<'k, const N: usize, L> {
    tile: &'k mut TileBuffer,
    numbers: &'k [Row; N],
    law: PhantomData<fn() -> L>,
}

impl<const N: usize, L: SimdForceLaw<N>> Kernel for LaneEvaluation<'_, N, L> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.tile.width
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let SimdWrench { force: f, torque: t } = L::wrench(load(self.numbers, i), &self.tile.lanes::<T>(i));
        let [x, y, z, a, b, c] = load::<T, 6>(&self.tile.forces, i);
        let sums = [x + f.x, y + f.y, z + f.z, a + t.x, b + t.y, c + t.z];
        let mut k = 0;
        while k < 6 {
            T::store([sums[k]], &mut self.tile.forces[k][i..]);
            k += 1;
        }
    }
}

#[inline(always)]
fn load<T: Tile, const N: usize>(rows: &[Row; N], i: usize) -> [T; N] {
    let mut numbers = [T::splat(0.0); N];
    let mut k = 0;
    while k < N {
        [numbers[k]] = T::load(&rows[k][i..]);
        k += 1;
    }
    numbers
}

#[inline(always)]
fn store<T: Tile, const N: usize>(rows: &mut [Row; N], numbers: [T; N]) {
    let mut k = 0;
    while k < N {
        T::store([numbers[k]], &mut rows[k]);
        k += 1;
    }
}
