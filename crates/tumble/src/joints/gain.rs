//! How hard a drive or a limit of a joint pulls.

use crate::math::Real;

/// How hard a [`Drive`](crate::Drive) or a [`Limit`](crate::Limit) of a joint pulls.
///
/// ```
/// use tumble::{Drive, Gain, prelude::*};
///
/// let servo = Drive::position(tumble::Axes::ANGULAR_X, 1.0).with_frequency(4.0, 1.0);
/// assert_eq!(servo.gain, Gain::Frequency { hertz: 4.0, damping_ratio: 1.0 });
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Gain {
    /// As hard as it takes.
    #[default]
    Rigid,
    /// A spring and a damper.
    Stiffness {
        /// [N/m] [N m/rad]
        stiffness: Real,
        /// [N s/m] [N m s/rad]
        damping: Real,
    },
    /// A spring and a damper that swing what hangs on the joint, as it stands when the step begins,
    /// at this frequency; with a limit of a distance, a twist or a cone, its two bodies alone.
    Frequency {
        /// \[Hz\]
        hertz: Real,
        /// 1 is critical damping.
        damping_ratio: Real,
    },
    /// A spring and a damper for each kilogram, or kg m^2, of what hangs on the joint.
    Acceleration {
        /// [1/s^2]
        stiffness: Real,
        /// [1/s]
        damping: Real,
    },
}

impl Gain {
    /// Whether its numbers are finite and not negative.
    pub(crate) fn is_in_range(&self) -> bool {
        let [a, b] = match *self {
            Self::Rigid => [0.0; 2],
            Self::Stiffness { stiffness, damping } | Self::Acceleration { stiffness, damping } => [stiffness, damping],
            Self::Frequency { hertz, damping_ratio } => [hertz, damping_ratio],
        };
        [a, b].iter().all(|number| number.is_finite() && *number >= 0.0)
    }
}
