//! The numbers of a solver body as rows of eight.

use tumble_math::lane::{Quat, Vec3};

use crate::simd::octet;

octet! {
    /// The motion of a body. A non-dynamic body has its velocities in place of momenta, and an
    /// inverse mass of one.
    pub(crate) struct BodyMotion<T> {
        /// Of its centre of mass [kg m/s].
        pub(crate) momentum: Vec3<T>,
        /// About its centre of mass, world frame [kg m^2/s].
        pub(crate) angular_momentum: Vec3<T>,
        /// [1/kg].
        pub(crate) inverse_mass: T,
        pub(crate) _unused: T,
    }
}

octet! {
    /// The impulses with which the last substep ended, summed over the contacts of a body, or over
    /// its joints in passes: with them the next begins.
    pub(crate) struct WarmStartImpulse<T> {
        /// \[N s\].
        pub(crate) linear: Vec3<T>,
        /// [N m s].
        pub(crate) angular: Vec3<T>,
        /// Of joints, the sum of impulse times arm [N m s].
        pub(crate) pull: T,
        pub(crate) _unused: T,
    }
}

octet! {
    /// Inverse inertia in the world [1/(kg m^2)]; the unit matrix for non-dynamic bodies.
    pub(crate) struct WorldInverseInertia<T> {
        /// `xx yy zz`.
        pub(crate) diagonal: Vec3<T>,
        /// `yz zx xy`.
        pub(crate) off_diagonal: Vec3<T>,
        pub(crate) _unused: [T; 2],
    }
}

octet! {
    /// The impulse of forces and the decay by damping in a substep.
    pub(crate) struct ForceImpulse<T> {
        /// \[N s\].
        pub(crate) linear: Vec3<T>,
        /// [N m s].
        pub(crate) angular: Vec3<T>,
        /// The factor of damping on the momentum, from 0 to 1.
        pub(crate) kept_linear: T,
        /// The factor of damping on the angular momentum.
        pub(crate) kept_angular: T,
    }
}

octet! {
    /// Inertia about the principal axes.
    pub(crate) struct PrincipalMoments<T> {
        /// [kg m^2].
        pub(crate) moments: Vec3<T>,
        pub(crate) inverse_moments: Vec3<T>,
        /// One of what turns, else zero.
        pub(crate) turns: T,
        /// Square of half the angle \[rad\] that it may turn in a step before its contacts turn
        /// with it.
        pub(crate) turn_tolerance: T,
    }
}

octet! {
    /// Where a body is.
    pub(crate) struct BodyPose<T> {
        /// Its centre of mass when the step began \[m\].
        pub(crate) center: Vec3<T>,
        /// That of the principal frame now.
        pub(crate) orientation: Quat<T>,
        pub(crate) _unused: T,
    }
}

octet! {
    /// How a body has moved since the step began.
    pub(crate) struct DeltaPose<T> {
        /// Of the centre of mass \[m\].
        pub(crate) translation: Vec3<T>,
        pub(crate) rotation: Quat<T>,
        /// One where the rotation is or was more than is left out of account, else zero.
        pub(crate) has_turned: T,
    }
}
