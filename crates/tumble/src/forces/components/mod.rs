//! Forces that are components: each acts on the body that carries it, until it is removed.

pub(crate) mod angular_velocity_servo;
pub(crate) mod buoyancy;
pub(crate) mod constant_wrench;
pub(crate) mod drag;
pub(crate) mod magnus;
pub(crate) mod point_gravity;
pub(crate) mod spring_force;
pub(crate) mod spring_to_point;
pub(crate) mod thruster;

pub use crate::forces::components::angular_velocity_servo::AngularVelocityServo;
pub use crate::forces::components::buoyancy::{Buoyancy, Hull};
pub use crate::forces::components::constant_wrench::{ConstantWrench, Frame};
pub use crate::forces::components::drag::Drag;
pub use crate::forces::components::magnus::Magnus;
pub use crate::forces::components::point_gravity::PointGravity;
pub(crate) use crate::forces::components::point_gravity::attraction;
pub use crate::forces::components::spring_to_point::SpringToPoint;
pub use crate::forces::components::thruster::Thruster;
