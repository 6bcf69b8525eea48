//! The derived quantities of one body, or of a tile of bodies.

use tumble_math::lane::{Lane, Quat, Vec3};

use crate::components::{InverseInertia, Velocity};
use crate::integrators::state::{Constants, Moments, State};
use crate::math::Real;

/// `v = P/M`, `w = I^-1 L` and `I^-1 = R I_body^-1 R^T`, all in the world frame.
#[derive(Clone, Copy)]
pub(crate) struct Derived<L> {
    pub(crate) linear: Vec3<L>,
    pub(crate) angular: Vec3<L>,
    /// `xx, yy, zz` of the inverse inertia.
    pub(crate) diagonal: Vec3<L>,
    /// `yz, zx, xy` of the inverse inertia.
    pub(crate) off_diagonal: Vec3<L>,
}

/// The derived quantities; a point mass has no inverse inertia and does not turn.
#[inline(always)]
pub(crate) fn derived<L: Lane>(constants: &Constants<L>, state: &State<L>) -> Derived<L> {
    let (d, o) = match &constants.inertia {
        Some(inertia) => inertia.inverse_in_world(state.orientation),
        None => (Vec3::zero(), Vec3::zero()),
    };
    Derived {
        linear: constants.velocity(state.linear),
        angular: symmetric_product(d, o, state.angular),
        diagonal: d,
        off_diagonal: o,
    }
}

impl<L: Lane> Moments<L> {
    /// `I^-1 = R I_body^-1 R^T` for a unit orientation: the diagonal `xx, yy, zz`, and beside it
    /// `yz, zx, xy`.
    #[inline(always)]
    pub(crate) fn inverse_in_world(&self, orientation: Quat<L>) -> (Vec3<L>, Vec3<L>) {
        // The sum of r r^T/I over the principal axes r. Two terms would do, since the three r r^T
        // add up to the unit matrix, but for a needle along the third axis all digits cancel.
        let [a, b, c] = self.world_axes(orientation);
        let m = self.inverse_moments;
        let (a_weighed, b_weighed, c_weighed) = (a * m.x, b * m.y, c * m.z);
        (
            a.scale(a_weighed) + b.scale(b_weighed) + c.scale(c_weighed),
            products(a, a_weighed) + products(b, b_weighed) + products(c, c_weighed),
        )
    }
}

impl<L: Lane> Derived<L> {
    /// `I^-1 v`, world frame.
    #[inline(always)]
    pub(crate) fn apply_inverse_inertia(&self, v: Vec3<L>) -> Vec3<L> {
        symmetric_product(self.diagonal, self.off_diagonal, v)
    }
}

/// A symmetric matrix with the diagonal `xx, yy, zz` and beside it `yz, zx, xy`, times a vector.
#[inline(always)]
pub(crate) fn symmetric_product<L: Lane>(d: Vec3<L>, o: Vec3<L>, v: Vec3<L>) -> Vec3<L> {
    Vec3::new(d.x * v.x + o.z * v.y + o.y * v.z, o.z * v.x + d.y * v.y + o.x * v.z, o.y * v.x + o.x * v.y + d.z * v.z)
}

/// `(y z', z x', x y')`.
#[inline(always)]
fn products<L: Lane>(v: Vec3<L>, w: Vec3<L>) -> Vec3<L> {
    Vec3::new(v.y * w.z, v.z * w.x, v.x * w.y)
}

impl From<Derived<Real>> for (Velocity, InverseInertia) {
    fn from(derived: Derived<Real>) -> Self {
        (
            Velocity { linear: derived.linear.into(), angular: derived.angular.into() },
            InverseInertia { diagonal: derived.diagonal.into(), off_diagonal: derived.off_diagonal.into() },
        )
    }
}
