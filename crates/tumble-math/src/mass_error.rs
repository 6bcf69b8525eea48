//! Why a body cannot have this mass.

use glam::DVec3;
use thiserror::Error;

use crate::inertia_error::listed;

/// Why mass properties cannot be made, with the offending number.
///
/// ```
/// use tumble_math::{MassError, MassProperties};
/// assert_eq!(
///     MassProperties::point(-1.0, [0.0, 0.0, 0.0]).unwrap_err(),
///     MassError::NotPositive { mass: -1.0 }
/// );
/// ```
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MassError {
    /// The mass is NaN or infinite.
    #[error("mass is {mass:?}, not a finite number")]
    NotFinite {
        /// The mass \[kg\].
        mass: f64,
    },
    /// The mass is zero or negative.
    #[error("mass must be positive, it is {mass:?}")]
    NotPositive {
        /// The mass \[kg\].
        mass: f64,
    },
    /// The mass is outside [`MassProperties::MASSES`](crate::MassProperties::MASSES).
    #[error("mass is {mass:?}, outside 1e-100 to 1e100 kg")]
    OutOfRange {
        /// The mass \[kg\].
        mass: f64,
    },
    /// A position is not finite or further out than
    /// [`MassProperties::REACH`](crate::MassProperties::REACH).
    #[error("position {} is not finite or beyond 1e90 m", listed(*.position))]
    Position {
        /// The position \[m\].
        position: DVec3,
    },
    /// A quaternion's length is further than 1e-3 from one.
    #[error("orientation must be a unit quaternion, its length is {length:?}")]
    Orientation {
        /// Length of the quaternion.
        length: f64,
    },
    /// There is no particle to sum over.
    #[error("a body needs at least one particle")]
    NoParticles,
    /// One particle of many is at fault.
    #[error("particle {index}: {source}")]
    Particle {
        /// Index of the particle, from 0.
        index: usize,
        /// What is wrong with it.
        source: Box<MassError>,
    },
    /// Nothing that could be a body remains once the hole is taken away.
    #[error("a hole of {hole:?} kg cannot be taken from this body of {mass:?} kg: it is too heavy or sticks out")]
    Hole {
        /// Mass of the body before \[kg\].
        mass: f64,
        /// Mass of what is taken away \[kg\].
        hole: f64,
    },
}

crate::debug_as_display!(MassError);
