//! From columns to tiles and back.

use tumble_math::lane::{Quat as LaneQuat, Vec3 as LaneVec3};

use crate::columns::Chunk;
use crate::math::{Quat, Vec3};
use crate::simd::Tile;
use crate::state::{Constants, Force, Moments, Rates, State};

/// Bodies in the widest tile.
const WIDEST: usize = 16;

/// The vectors of a tile of bodies.
#[inline(always)]
fn load<T: Tile>(vector: impl Fn(usize) -> Vec3) -> LaneVec3<T> {
    LaneVec3::new(
        T::from_fn(|body| vector(body).x),
        T::from_fn(|body| vector(body).y),
        T::from_fn(|body| vector(body).z),
    )
}

/// The quaternions of a tile of bodies.
#[inline(always)]
fn load_quat<T: Tile>(quat: impl Fn(usize) -> Quat) -> LaneQuat<T> {
    LaneQuat {
        x: T::from_fn(|body| quat(body).x),
        y: T::from_fn(|body| quat(body).y),
        z: T::from_fn(|body| quat(body).z),
        w: T::from_fn(|body| quat(body).w),
    }
}

/// Hands each body's vector to `set`.
#[inline(always)]
pub(crate) fn store<T: Tile>(vectors: LaneVec3<T>, mut set: impl FnMut(usize, Vec3)) {
    let (mut x, mut y) = ([0.0; WIDEST], [0.0; WIDEST]);
    vectors.x.for_each(|body, number| x[body] = number);
    vectors.y.for_each(|body, number| y[body] = number);
    vectors.z.for_each(|body, number| set(body, Vec3::new(x[body], y[body], number)));
}

impl Chunk<'_> {
    /// What does not change during a step, of the bodies from row `i`.
    #[inline(always)]
    pub(crate) fn constants<T: Tile>(&self, i: usize) -> Constants<T> {
        let rows = i..i + T::WIDTH;
        let mass = &self.mass[rows.clone()];
        let inertia = match self.inertia {
            Some(inertia) => {
                let inertia = &inertia[rows.clone()];
                let axes = match self.axes {
                    Some(axes) => {
                        let axes = &axes[rows.clone()];
                        Some(load_quat(|body| axes[body].0))
                    }
                    None => None,
                };
                Some(Moments {
                    moments: load(|body| inertia[body].moments()),
                    inverse_moments: load(|body| inertia[body].inverse_moments()),
                    axes,
                })
            }
            None => None,
        };
        let damping = match self.damping {
            Some(damping) => {
                let damping = &damping[rows];
                Some(Rates {
                    linear: T::from_fn(|body| damping[body].linear),
                    angular: T::from_fn(|body| damping[body].angular),
                })
            }
            None => None,
        };
        Constants { mass: T::from_fn(|body| mass[body].kilograms()), inertia, damping }
    }

    /// The wrenches of the bodies from row `i`.
    #[inline(always)]
    pub(crate) fn force<T: Tile>(&self, i: usize) -> Force<T> {
        let wrench = &self.wrench[i..i + T::WIDTH];
        Force { force: load(|body| wrench[body].force), torque: load(|body| wrench[body].torque) }
    }

    /// The state of the bodies from row `i`.
    #[inline(always)]
    pub(crate) fn state<T: Tile>(&self, i: usize) -> State<T> {
        let (pose, momentum) = (&self.pose[i..i + T::WIDTH], &self.momentum[i..i + T::WIDTH]);
        State {
            position: load(|body| pose[body].position),
            orientation: load_quat(|body| pose[body].orientation),
            linear: load(|body| momentum[body].linear),
            angular: load(|body| momentum[body].angular),
        }
    }

    /// Writes back the state of the bodies from row `i`.
    #[inline(always)]
    pub(crate) fn set_state<T: Tile>(&mut self, i: usize, state: &State<T>) {
        let pose = &mut self.pose[i..i + T::WIDTH];
        store(state.position, |body, position| pose[body].position = position);
        let q = state.orientation;
        let (mut x, mut y, mut z) = ([0.0; WIDEST], [0.0; WIDEST], [0.0; WIDEST]);
        q.x.for_each(|body, number| x[body] = number);
        q.y.for_each(|body, number| y[body] = number);
        q.z.for_each(|body, number| z[body] = number);
        q.w.for_each(|body, w| pose[body].orientation = Quat::from_xyzw(x[body], y[body], z[body], w));
        let momentum = &mut self.momentum[i..i + T::WIDTH];
        store(state.linear, |body, linear| momentum[body].linear = linear);
        store(state.angular, |body, angular| momentum[body].angular = angular);
    }
}
