//! Reference motions from `data/tops`, `data/peers` and `data/published`, and how to read them.

mod json;
mod pinned;
mod tumbler;

pub use json::{double_quat, number, parse, quaternion, real_quat, real_vec3, vector};
pub use pinned::{Pinned, PinnedGravity, PinnedRun};
pub use tumbler::{PeerRow, Tumbler, Tumbling};
