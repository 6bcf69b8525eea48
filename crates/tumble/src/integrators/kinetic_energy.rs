//! Linear and rotational kinetic energy of bodies in double precision.

use tumble_math::lane::{Lane, Quat, Vec3};

use crate::integrators::state::{Constants, State};
use crate::simd::{Widen, widen_quat, widen_vec};

/// Kinetic energy of one body, or of each of a tile \[J\], in double precision.
#[derive(Clone, Copy)]
pub(crate) struct KineticEnergy<D> {
    /// `P^2/2M`.
    pub(crate) linear: D,
    /// `L.w/2`.
    pub(crate) rotational: D,
}

impl<D: Lane> KineticEnergy<D> {
    #[inline(always)]
    pub(crate) fn of<T: Widen<Double = D>>(constants: &Constants<T>, state: &State<T>) -> Self {
        let rotational = match &constants.inertia {
            Some(inertia) => {
                let orientation = widen_quat(state.orientation);
                let frame = match inertia.axes {
                    Some(axes) => orientation * widen_quat(axes),
                    None => orientation,
                };
                Self::of_rotation(inertia.moments, frame, state.angular)
            }
            None => D::splat(0.0),
        };
        Self { linear: Self::of_motion(constants.mass, state.linear), rotational }
    }

    /// `P^2/2M`.
    #[inline(always)]
    pub(crate) fn of_motion<T: Widen<Double = D>>(mass: T, linear_momentum: Vec3<T>) -> D {
        let momentum = widen_vec(linear_momentum);
        momentum.dot(momentum) / (D::splat(2.0) * mass.widen())
    }

    /// `L.w/2`, from the moments about the axes of a frame, which need not be of unit length.
    #[inline(always)]
    pub(crate) fn of_rotation<T: Widen<Double = D>>(moments: Vec3<T>, frame: Quat<D>, angular_momentum: Vec3<T>) -> D {
        let (principal, m) = (frame.normalize().rotate_back(widen_vec(angular_momentum)), widen_vec(moments));
        let square = principal.scale(principal);
        D::splat(0.5) * (square.x / m.x + square.y / m.y + square.z / m.z)
    }

    #[inline(always)]
    pub(crate) fn sum(self) -> D {
        self.linear + self.rotational
    }
}
