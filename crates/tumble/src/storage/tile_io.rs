//! From columns to tiles and back.

use tumble_math::lane::{Lane, Quat, Vec3};

use crate::components::{GravityScale, Inertia, Momentum, Pose, PrincipalAxes, Wrenches};
use crate::integrators::derived::Derived;
use crate::integrators::state::{Constants, DampingRates, Force, Moments, State};
use crate::simd::Tile;
use crate::storage::chunk::Chunk;

impl Chunk<'_> {
    /// Mass, inertia and damping of the bodies from row `i`.
    #[inline(always)]
    pub(crate) fn constants<T: Tile>(&self, i: usize) -> Constants<T> {
        let [mass] = T::load(&self.mass[i..]);
        let inertia = load_moments(self.inertia, self.axes, i);
        let damping = match self.damping {
            Some(damping) => {
                let [linear, angular] = T::load(&damping[i..]);
                Some(DampingRates { linear, angular })
            }
            None => None,
        };
        Constants { mass, inertia, damping }
    }

    /// The wind around the bodies from row `i`, where they have one.
    #[inline(always)]
    pub(crate) fn wind<T: Tile>(&self, i: usize) -> Option<Vec3<T>> {
        match self.wind {
            Some(wind) => {
                let [x, y, z] = T::load(&wind[i..]);
                Some(Vec3::new(x, y, z))
            }
            None => None,
        }
    }

    /// The force of gravity on the bodies from row `i`, with their masses, in a field [m/s^2].
    #[inline(always)]
    pub(crate) fn gravity<T: Tile>(&self, i: usize, mass: T, field: Vec3<T>) -> Vec3<T> {
        field * (mass * load_scale(self.gravity_scale, i))
    }

    /// The wrenches of the bodies from row `i`. Where they are zero already nothing is written:
    /// memory that is not written need not be brought back.
    #[inline(always)]
    pub(crate) fn force<T: Tile>(&mut self, i: usize, wrenches: Wrenches) -> Force<T> {
        let (force, is_zero) = self.wrenches(i);
        if wrenches == Wrenches::Consumed && !is_zero {
            self.clear_wrenches::<T>(i);
        }
        force
    }

    /// The wrenches of the bodies from row `i`, and whether all of them are zero.
    #[inline(always)]
    pub(crate) fn wrenches<T: Tile>(&self, i: usize) -> (Force<T>, bool) {
        let numbers = T::load(&self.wrench[i..]);
        let [x, y, z, a, b, c] = numbers;
        (Force { force: Vec3::new(x, y, z), torque: Vec3::new(a, b, c) }, T::are_zero(numbers))
    }

    /// Sets the wrenches of the bodies from row `i` to zero.
    #[inline(always)]
    pub(crate) fn clear_wrenches<T: Tile>(&mut self, i: usize) {
        T::store([T::splat(0.0); 6], &mut self.wrench[i..]);
    }

    /// The state of the bodies from row `i`.
    #[inline(always)]
    pub(crate) fn state<T: Tile>(&self, i: usize) -> State<T> {
        load_state(self.pose, self.momentum, i)
    }

    /// Writes back the state of the bodies from row `i`.
    #[inline(always)]
    pub(crate) fn set_state<T: Tile>(&mut self, i: usize, state: &State<T>) {
        let (q, x, p, l) = (state.orientation, state.position, state.linear, state.angular);
        T::store([q.x, q.y, q.z, q.w, x.x, x.y, x.z], &mut self.pose[i..]);
        T::store([p.x, p.y, p.z, l.x, l.y, l.z], &mut self.momentum[i..]);
    }

    /// Writes the poses of the bodies from row `i` as the previous ones, where those are kept.
    #[inline(always)]
    pub(crate) fn set_previous_pose<T: Tile>(&mut self, i: usize, state: &State<T>) {
        if let Some(previous) = self.previous_pose.as_deref_mut() {
            let (q, x) = (state.orientation, state.position);
            T::store([q.x, q.y, q.z, q.w, x.x, x.y, x.z], &mut previous[i..]);
        }
    }

    /// Writes the derived quantities of the bodies from row `i` to the columns that there are.
    #[inline(always)]
    pub(crate) fn set_derived<T: Tile>(&mut self, i: usize, derived: &Derived<T>) {
        if let Some(column) = self.velocity.as_deref_mut() {
            let (v, w) = (derived.linear, derived.angular);
            T::store([v.x, v.y, v.z, w.x, w.y, w.z], &mut column[i..]);
        }
        if let Some(column) = self.inverse_inertia.as_deref_mut() {
            let (d, o) = (derived.diagonal, derived.off_diagonal);
            T::store([d.x, d.y, d.z, o.x, o.y, o.z], &mut column[i..]);
        }
    }
}

/// Moments of inertia of the bodies from row `i`, if they have some, and axes where these are not
/// the body's.
#[inline(always)]
pub(crate) fn load_moments<T: Tile>(
    inertia: Option<&[Inertia]>,
    axes: Option<&[PrincipalAxes]>,
    i: usize,
) -> Option<Moments<T>> {
    match inertia {
        Some(inertia) => {
            let [a, b, c, inverse_a, inverse_b, inverse_c] = T::load(&inertia[i..]);
            let axes = match axes {
                Some(axes) => {
                    let [x, y, z, w] = T::load(&axes[i..]);
                    Some(Quat { x, y, z, w })
                }
                None => None,
            };
            let inverse_moments = Vec3::new(inverse_a, inverse_b, inverse_c);
            Some(Moments { moments: Vec3::new(a, b, c), inverse_moments, axes })
        }
        None => None,
    }
}

/// The state of the bodies from row `i`.
#[inline(always)]
pub(crate) fn load_state<T: Tile>(pose: &[Pose], momentum: &[Momentum], i: usize) -> State<T> {
    let [qx, qy, qz, qw, x, y, z] = T::load(&pose[i..]);
    let [px, py, pz, lx, ly, lz] = T::load(&momentum[i..]);
    State {
        position: Vec3::new(x, y, z),
        orientation: Quat { x: qx, y: qy, z: qz, w: qw },
        linear: Vec3::new(px, py, pz),
        angular: Vec3::new(lx, ly, lz),
    }
}

/// How gravity is scaled for the bodies from row `i`.
#[inline(always)]
pub(crate) fn load_scale<T: Tile>(scales: Option<&[GravityScale]>, i: usize) -> T {
    match scales {
        Some(scales) => {
            let [scale] = T::load(&scales[i..]);
            scale
        }
        None => T::splat(1.0),
    }
}

/// The same vector for every body.
#[inline(always)]
pub(crate) fn splat<L: Lane>(vector: crate::math::Vec3) -> Vec3<L> {
    Vec3::new(L::splat(vector.x.into()), L::splat(vector.y.into()), L::splat(vector.z.into()))
}
