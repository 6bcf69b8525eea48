//! The scenes that the benches run, and the tests that are about many bodies at once.
//!
//! The same numbers on every machine and in every run: the only source of chance is [`Rng`], and
//! nothing but basic arithmetic and square roots is used.

#![cfg_attr(
    feature = "f64",
    allow(
        clippy::useless_conversion,
        reason = "Real is f64 in this build; the same line converts from f32 in the other"
    )
)]

mod arguments;
mod hills;
mod jointed;
mod on_demand;
mod piles;
mod pulling;
#[cfg(feature = "peers")]
mod rapier_joints;
mod rays;
mod scenes;
mod threads;

pub use arguments::Arguments;
pub use hills::{HillBodies, HillGround, hills};
pub use jointed::{JointKind, LINK, arm, bridge, chain, net, pendulums, ragdolls};
pub use on_demand::OnDemand;
pub use piles::{FRICTION, PileShape, compounds_in_each_other, eight_boxes, falling_balls, pyramid};
pub use pulling::{attracting_points, net_of_springs};
#[cfg(feature = "peers")]
pub use rapier_joints::{RapierJoints, RapierWorld};
pub use rays::{rays_through_boxes, scattered_boxes};
pub use scenes::{mixed_bodies, mixed_body, mixed_moving_bodies, tumbling_box, tumbling_boxes};
pub use threads::{SIZES, in_pools_of_one, label, pool, pools};
pub use tumble::Rng;
