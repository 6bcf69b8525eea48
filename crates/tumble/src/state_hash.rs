use hecs::World;

use crate::body_order::BodyOrder;
use crate::components::{Momentum, Pose};
use crate::math::Real;

/// A hash of the state to the bit: equal hashes mean equal positions, orientations and momenta, in all likelihood.
///
/// 64-bit FNV-1a over the little-endian bytes of each body's position x y z, orientation x y z w and, where it has one, linear and
/// angular momentum x y z, body after body in order. Bodies that are gone are passed over.
///
/// ```
/// # use tumble::{BodyOrder, state_hash};
/// let world = hecs::World::new();
/// assert_eq!(state_hash(&world, &BodyOrder::of(&world)), 0xcbf2_9ce4_8422_2325);
/// ```
pub fn state_hash(world: &World, order: &BodyOrder) -> u64 {
    const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    let mut hash = OFFSET_BASIS;
    let mut add = |numbers: &[Real]| {
        for number in numbers {
            for byte in number.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(PRIME);
            }
        }
    };
    for body in order.entities().iter().filter_map(|&entity| world.entity(entity).ok()) {
        if let Some(pose) = body.get::<&Pose>() {
            add(&pose.position.to_array());
            add(&pose.orientation.to_array());
        }
        if let Some(momentum) = body.get::<&Momentum>() {
            add(&momentum.linear.to_array());
            add(&momentum.angular.to_array());
        }
    }
    hash
}
