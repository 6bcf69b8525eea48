//! Forces that are components: each acts on the body that carries it, until it is removed.

mod angular_velocity_servo;
mod buoyancy;
mod constant_wrench;
mod drag;
mod magnus;
mod point_gravity;
pub(crate) mod spring_force;
mod spring_to_point;
mod thruster;

pub use angular_velocity_servo::AngularVelocityServo;
pub use buoyancy::{Buoyancy, Hull};
pub use constant_wrench::{ConstantWrench, Frame};
pub use drag::{Drag, Wind};
pub use magnus::Magnus;
pub use point_gravity::PointGravity;
pub(crate) use point_gravity::attraction;
pub use spring_to_point::SpringToPoint;
pub use thruster::Thruster;
