//! Forces: laws of the caller, force components, and forces between pairs of bodies.

pub(crate) mod body_forces;
pub(crate) mod components;
pub(crate) mod evaluate;
pub(crate) mod force_context;
pub(crate) mod force_law;
pub(crate) mod pairwise;
pub(crate) mod registry;
pub(crate) mod simd_force_law;
pub(crate) mod spring_potential;
pub(crate) mod stable_spring;
pub(crate) mod tile_buffer;
pub(crate) mod under_laws;
pub(crate) mod work_account;

pub use crate::forces::body_forces::BodyForces;
pub use crate::forces::components::{
    AngularVelocityServo, Buoyancy, ConstantWrench, Drag, Frame, Hull, Magnus, PointGravity, SpringToPoint, Thruster,
};
pub use crate::forces::force_law::{BodyState, ForceLaw};
pub use crate::forces::pairwise::{GravityMass, Spring};
pub use crate::forces::registry::ForceLaws;
pub use crate::forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
