//! Gears, racks and mimics: what ties the motion of two joints together.

use hecs::Entity;

use crate::joints::axes::Axes;
use crate::math::Real;

/// Ties a free axis of one joint to one of another, as a pair of wheels, a rack and pinion or a
/// robot's mimic joint does: `second = offset + ratio * first`. It is a component of an entity of
/// its own.
///
/// Values are those of [`JointLoad::values`](crate::JointLoad::values). The ratio of two rotations
/// that go round and round has to be a fraction with a denominator of at most 64, as the numbers
/// of teeth make it; any other is kept as a speed, and its position within the step only. A
/// rotation with a limit of less than a turn does not go round, and may have any ratio: its angle
/// is that within the limit. While one of the joints does not act, neither does the gear: a joint
/// acts if one of its bodies at least is dynamic.
///
/// ```
/// use tumble::{Gear, Joint, prelude::*};
///
/// let mut world = tumble::hecs::World::new();
/// let plate = RigidBody::new(Shape::Point).fixed().build()?.spawn(&mut world);
/// let wheel = |at: Real, radius: Real, world: &mut tumble::hecs::World| {
///     let body = RigidBody::new(Shape::cylinder(radius, 0.02)).mass(1.0).position(Vec3::X * at);
///     let body = body.angular_velocity(Vec3::Y * at).build()?.spawn(world);
///     let hinge = Joint::hinge(plate, body).at(world, Vec3::X * at, Vec3::Y)?;
///     Ok::<_, Box<dyn std::error::Error>>((body, world.spawn((hinge,))))
/// };
/// let (large, first) = wheel(0.0, 0.2, &mut world)?;
/// let (small, second) = wheel(0.3, 0.1, &mut world)?;
/// // Forty teeth and twenty: the small wheel turns twice as fast, the other way.
/// world.spawn((Gear::new(first, second, -2.0),));
///
/// Simulation::new(Settings::default())?.step_many(&mut world, 60);
/// let [slow, fast] = [large, small].map(|it| world.get::<&Velocity>(it).map(|it| it.angular.y));
/// assert!((fast? + 2.0 * slow?).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// The entities of two [`Joint`](crate::Joint)s.
    pub joints: [Entity; 2],
    /// One free axis of each; none stands for the first that is free, rotations before
    /// translations. Where all three rotations are free, none of them has an angle of its own, and
    /// a gear of them does nothing.
    pub axes: [Axes; 2],
    /// How much the second value changes with the first: a number, [m/rad] or [rad/m].
    pub ratio: Real,
    /// The second value where the first is zero \[m\] \[rad\].
    pub offset: Real,
}

impl Gear {
    /// Between the free axes of two joints that have one each.
    pub const fn new(first: Entity, second: Entity, ratio: Real) -> Self {
        Self { joints: [first, second], axes: [Axes::NONE; 2], ratio, offset: 0.0 }
    }

    /// The index of the axis of one of its joints, which has these free, if there is one.
    pub(crate) fn axis(&self, end: usize, free: Axes) -> Option<usize> {
        let axes = self.axes[end];
        let is_ball = free.contains(Axes::ANGULAR);
        let can_be_geared = |axis: usize| free.has(axis) && (axis < 3 || !is_ball);
        let is_meant = |axis: &usize| can_be_geared(*axis) && (axes == Axes::NONE || axes.has(*axis));
        [3, 4, 5, 0, 1, 2].into_iter().find(is_meant)
    }

    /// Whether its numbers can be reckoned with.
    pub(crate) fn is_in_range(&self) -> bool {
        self.ratio.is_finite() && self.offset.is_finite() && self.ratio != 0.0
    }
}
