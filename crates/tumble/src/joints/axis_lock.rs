//! What locked axes leave of momentum and rotation: how a body answers about the free ones.
//!
//! What holds the locked axes pulls along and about them only, so momentum along free axes is what
//! impulses make of it. With the free rotations as columns of `E`, `w = E (E^T I E)^-1 E^T L`, and
//! the angular momentum about the locked axes is that of `w`.

use glam::{DMat3, DQuat, DVec3};
use tumble_math::lane::{Quat, Vec3};

use crate::integrators::derived::Derived;
use crate::integrators::state::{Constants, State};
use crate::joints::axes::Axes;
use crate::math::{Real, double, double_quat, vec3};
use crate::storage::body_index::Slot;

/// The axes that a body is locked along and about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisLock(pub(crate) Axes);

/// The angle \[rad\] that is turned at a time about two free axes at most, and in how many parts of
/// a substep at most.
const MAX_ANGLE: f64 = 0.05;
const MAX_PARTS: u32 = 64;
/// How often the angular velocity in the middle of a part is found again: each time what is missing
/// is less by half of the angle.
const REPETITIONS: u32 = 4;

/// A body whose axes are locked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LockedSlot {
    pub(crate) slot: Slot,
    pub(crate) lock: AxisLock,
    /// Whether a joint of the world is between it and another: then they may hang together.
    pub(crate) has_joint: bool,
}

/// Where a body has turned to.
pub(crate) struct Turned {
    pub(crate) orientation: DQuat,
    /// [kg m^2/s].
    pub(crate) angular_momentum: DVec3,
    /// Its response to torques, world frame [1/(kg m^2)].
    pub(crate) inverse_inertia: DMat3,
}

impl AxisLock {
    /// One where translation is locked, else zero.
    pub(crate) fn translations(self) -> DVec3 {
        let locked = |axis| f64::from(u8::from(self.0.has(axis)));
        DVec3::new(locked(0), locked(1), locked(2))
    }

    /// What this leaves of motions of a whole of which another body is locked like that: it turns
    /// about an axis only if all can, and can go across it.
    pub(crate) fn with_whole(self, other: Self) -> Self {
        let mut axes = self.0.with(other.0);
        for axis in 0..3 {
            if other.0.has((axis + 1) % 3) || other.0.has((axis + 2) % 3) {
                axes = axes.with(Axes::EACH[3 + axis]);
            }
        }
        Self(axes)
    }

    /// Of a vector, what is along axes with free translation.
    pub(crate) fn along_free(self, vector: DVec3) -> DVec3 {
        vector - vector * self.translations()
    }

    /// Whether any rotation is locked.
    pub(crate) fn locks_rotation(self) -> bool {
        (3..6).any(|axis| self.0.has(axis))
    }

    /// How it answers to torques with this inertia in the world.
    pub(crate) fn inverse_inertia(self, inertia: DMat3) -> DMat3 {
        let is_free = |axis: usize| !self.0.has(3 + axis);
        let mut free = inertia;
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            if !(is_free(i) && is_free(j)) {
                free.col_mut(j)[i] = if i == j { inertia.col(i)[i] } else { 0.0 };
            }
        }
        let mut inverse = free.inverse();
        for axis in (0..3).filter(|axis| !is_free(*axis)) {
            inverse.col_mut(axis)[axis] = 0.0;
        }
        inverse
    }

    /// The angular momentum that it has with its angular velocity, of which free axes have theirs.
    pub(crate) fn settled(self, inertia: DMat3, angular_momentum: DVec3) -> DVec3 {
        inertia * (self.inverse_inertia(inertia) * angular_momentum)
    }

    /// A state without the momenta that the body cannot have.
    pub(crate) fn held(self, constants: &Constants<Real>, state: &State<Real>) -> State<Real> {
        let linear = vec3(self.along_free(double(state.linear))).into();
        let angular = match self.inertia_of(constants, state) {
            Some(inertia) => vec3(self.settled(inertia, double(state.angular))).into(),
            None => state.angular,
        };
        State { linear, angular, ..*state }
    }

    /// How a body moves and answers to torques with what it is locked along and about.
    pub(crate) fn locked(self, constants: &Constants<Real>, state: &State<Real>, free: Derived<Real>) -> Derived<Real> {
        let linear = vec3(self.along_free(double(free.linear))).into();
        let Some(inertia) = self.inertia_of(constants, state) else { return Derived { linear, ..free } };
        let inverse = self.inverse_inertia(inertia);
        let angular = vec3(inverse * double(state.angular)).into();
        let [diagonal, off_diagonal] = symmetric(inverse).map(Vec3::from);
        Derived { linear, angular, diagonal, off_diagonal }
    }

    /// Inertia in the world of a body that turns, if rotations are locked.
    fn inertia_of(self, constants: &Constants<Real>, state: &State<Real>) -> Option<DMat3> {
        let moments = constants.inertia.as_ref().filter(|_| self.locks_rotation())?;
        let orientation = state.orientation.normalize();
        let principal = moments.axes.map_or(orientation, |axes| orientation * axes);
        Some(world_inertia(double(moments.moments), double_quat(principal)))
    }

    /// The part of a rotation that is about free axes, where that is at most one.
    pub(crate) fn free_part(self, rotation: DQuat) -> DQuat {
        let is_free = [0, 1, 2].map(|axis| !self.0.has(3 + axis));
        if is_free.iter().filter(|is_free| **is_free).count() > 1 {
            return rotation;
        }
        let [x, y, z] = is_free.map(|is_free| f64::from(u8::from(is_free)));
        let free = DQuat::from_xyzw(rotation.x * x, rotation.y * y, rotation.z * z, rotation.w);
        if free.xyz() == DVec3::ZERO { DQuat::IDENTITY } else { free.normalize() }
    }

    /// Turns a body with these principal moments for `h` \[s\], its principal frame at an
    /// orientation: by the angular velocity in the middle, so it is the same backwards.
    pub(crate) fn turn(self, moments: DVec3, from: DQuat, angular_momentum: DVec3, h: f64) -> Turned {
        let spin = |orientation: DQuat| self.inverse_inertia(world_inertia(moments, orientation)) * angular_momentum;
        let begun = spin(from);
        let fastest = (angular_momentum.dot(begun) / moments.min_element()).sqrt();
        let is_steady = (3..6).filter(|axis| !self.0.has(*axis)).count() < 2;
        let parts = if is_steady { 1 } else { ((fastest * h / MAX_ANGLE).ceil() as u32).clamp(1, MAX_PARTS) };
        let part = h / f64::from(parts);
        let mut orientation = from;
        for _ in 0..parts {
            let mut angular_velocity = spin(orientation);
            for _ in 0..if is_steady { 0 } else { REPETITIONS } {
                angular_velocity = spin(turned(orientation, angular_velocity, 0.5 * part));
            }
            orientation = turned(orientation, angular_velocity, part);
        }
        let inertia = world_inertia(moments, orientation);
        let inverse_inertia = self.inverse_inertia(inertia);
        let angular_momentum = inertia * (inverse_inertia * angular_momentum);
        Turned { orientation, angular_momentum, inverse_inertia }
    }
}

/// Inertia in the world of a body whose principal frame has an orientation.
pub(crate) fn world_inertia(moments: DVec3, orientation: DQuat) -> DMat3 {
    let axes = DMat3::from_quat(orientation);
    axes * DMat3::from_diagonal(moments) * axes.transpose()
}

fn turned(orientation: DQuat, angular_velocity: DVec3, h: f64) -> DQuat {
    let orientation: Quat<f64> = orientation.into();
    tumble_math::rotate_exactly(orientation, angular_velocity.into(), h).into()
}

/// The diagonal `xx yy zz` of a symmetric matrix, and `yz zx xy`.
pub(crate) fn symmetric(matrix: DMat3) -> [crate::math::Vec3; 2] {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    [vec3(DVec3::new(x.x, y.y, z.z)), vec3(DVec3::new(y.z, z.x, x.y))]
}
