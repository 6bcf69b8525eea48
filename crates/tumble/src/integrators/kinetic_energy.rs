//! Linear and rotational kinetic energy of one body in double precision.

use crate::integrators::state::{Constants, State};
use crate::math::{Real, double, double_quat};

/// Kinetic energy of one body \[J\], in double precision.
#[derive(Clone, Copy)]
pub(crate) struct KineticEnergy {
    /// `P^2/2M`.
    pub(crate) linear: f64,
    /// `L.w/2`.
    pub(crate) rotational: f64,
}

impl KineticEnergy {
    pub(crate) fn of(constants: &Constants<Real>, state: &State<Real>) -> Self {
        let rotational = constants.inertia.map_or(0.0, |inertia| {
            let orientation = double_quat(state.orientation);
            let frame = inertia.axes.map_or(orientation, |axes| orientation * double_quat(axes)).normalize();
            let principal = frame.inverse() * double(state.angular);
            0.5 * (principal * principal / double(inertia.moments)).element_sum()
        });
        Self { linear: double(state.linear).length_squared() / (2.0 * f64::from(constants.mass)), rotational }
    }

    pub(crate) fn sum(self) -> f64 {
        self.linear + self.rotational
    }
}
