//! What a change of momentum is compared to.

use hecs::World;
use tumble::math::dvec3;
use tumble::{BodyOrder, Momentum, Pose};

/// Sums over bodies of the magnitudes of their momenta.
///
/// For one body that is the magnitude of the total. Momenta of many cancel in the total, to nothing
/// for planets about their common centre of mass, and what is left is no measure of how well it is
/// kept.
///
/// ```
/// use tumble::prelude::*;
/// use tumble_record::MomentumScale;
///
/// let mut world = hecs::World::new();
/// for side in [-1.0, 1.0] {
///     let body = RigidBody::new(Shape::sphere(0.5))
///         .mass(2.0)
///         .position(Vec3::Y * side)
///         .linear_velocity(Vec3::X * side);
///     body.build()?.spawn(&mut world);
/// }
/// // Two of 2 kg with 1 m/s in opposite directions, 1 m from the origin.
/// assert_eq!(
///     MomentumScale::of(&world, &tumble::BodyOrder::of(&world)),
///     MomentumScale { linear: 4.0, angular: 4.0 }
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MomentumScale {
    /// `sum |P|` [kg m/s].
    pub linear: f64,
    /// `sum |x x P + L|`, about the world's origin [kg m^2/s].
    pub angular: f64,
}

impl MomentumScale {
    /// Of the bodies that have a momentum, in their order.
    pub fn of(world: &World, order: &BodyOrder) -> Self {
        let states = world.view::<(&Pose, &Momentum)>();
        order.entities().iter().filter_map(|&entity| states.get(entity)).fold(
            Self::default(),
            |sum, (pose, momentum)| {
                let (linear, angular) = (dvec3(momentum.linear), dvec3(momentum.angular));
                let about_origin = dvec3(pose.position).cross(linear) + angular;
                Self { linear: sum.linear + linear.length(), angular: sum.angular + about_origin.length() }
            },
        )
    }
}
