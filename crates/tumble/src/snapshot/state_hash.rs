//! A bitwise FNV-1a hash of poses and momenta, and of what is broken.

use hecs::World;

use crate::components::{BodyId, Momentum, Pose};
use crate::math::Real;
use crate::snapshot::saved_joints::add_broken_joints;
use crate::storage::body_order::BodyOrder;

/// A hash of the state to the bit: equal hashes mean equal positions, orientations and momenta, and
/// as many broken joints, in all likelihood.
///
/// 64-bit FNV-1a over the little-endian bytes of each body's position x y z, orientation x y z w
/// and, where it has one, linear and angular momentum x y z, body after body in order; any NaN
/// counts as the same one. Bodies that are gone are passed over. Where joints between these bodies,
/// or of them with others, are [broken](crate::Breakable::is_broken), their number follows, as 64
/// bits, and in ascending order the [`BodyId`]s of those joints that have one.
///
/// ```
/// # use tumble::{BodyOrder, state_hash};
/// let world = hecs::World::new();
/// assert_eq!(state_hash(&world, &BodyOrder::of(&world)), 0xcbf2_9ce4_8422_2325);
/// ```
pub fn state_hash(world: &World, order: &BodyOrder) -> u64 {
    let mut hash = Fnv::default();
    for body in order.entities().iter().filter_map(|&entity| world.entity(entity).ok()) {
        if let Some(pose) = body.get::<&Pose>() {
            hash.add_pose(&pose);
        }
        if let Some(momentum) = body.get::<&Momentum>() {
            hash.add_momentum(&momentum);
        }
    }
    add_broken_joints(&mut hash, world, order);
    hash.value()
}

/// The number, or the one NaN for all: which sign and payload an operation gives a NaN is up to the
/// processor, and the same calculation leaves others in other vector registers.
pub(crate) fn canonical(number: Real) -> Real {
    if number.is_nan() { Real::NAN } else { number }
}

/// 64-bit FNV-1a.
pub(crate) struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    const PRIME: u64 = 0x0000_0100_0000_01b3;

    pub(crate) fn add_bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(Self::PRIME);
        }
    }

    fn add_numbers(&mut self, numbers: &[Real]) {
        for &number in numbers {
            self.add_bytes(&canonical(number).to_le_bytes());
        }
    }

    pub(crate) fn add_pose(&mut self, pose: &Pose) {
        self.add_numbers(&pose.position.to_array());
        self.add_numbers(&pose.orientation.to_array());
    }

    pub(crate) fn add_momentum(&mut self, momentum: &Momentum) {
        self.add_numbers(&momentum.linear.to_array());
        self.add_numbers(&momentum.angular.to_array());
    }

    /// Adds how many joints are broken, and which of those that have an identity, in order; nothing
    /// where none is.
    pub(crate) fn add_broken(&mut self, count: usize, ids: impl Iterator<Item = BodyId>) {
        if count > 0 {
            self.add_bytes(&(count as u64).to_le_bytes());
            ids.for_each(|id| self.add_bytes(&id.0.to_le_bytes()));
        }
    }

    pub(crate) fn value(&self) -> u64 {
        self.0
    }
}
