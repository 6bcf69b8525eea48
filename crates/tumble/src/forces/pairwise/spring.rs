//! A damped spring between points of two bodies.

use hecs::Entity;

use crate::math::{Real, Vec3};

/// A spring with a damper between points of two bodies. It is a component of an entity of its own,
/// so a body can have any number.
///
/// Along the line between the points, at the distance `l`, it pulls both with
/// `k (l - l0) + c dl/dt`; its energy is `k (l - l0)^2/2`. Either body may be one that does not
/// move. While a body is not in the world, or both are the same, the spring does nothing.
///
/// It is made to keep energy within bounds however stiff it is, wherever it is attached and however
/// many hang together: of a thousand random pairs, rings and nets none had more than twice the
/// energy of its start; `docs/forces.md` has the range that was drawn from. Between two centres of
/// mass it has its true frequency up to 0.45 a substep, and stiffer springs that one;
/// [`SimdBody::stable_stiffness`](crate::SimdBody::stable_stiffness) says how. Where several
/// springs hold a body each counts on its share of the mass alone: what all of them do at once is
/// stable then, and a stiff net softer than it should be, with a third of an oscillation a substep
/// at the most. At the rim of a body it turns that by at most a radian a substep in small swings;
/// where a long pull would turn it by more than 0.7, it acts at a shorter arm, and damps from 0.55
/// on. Damping takes no more than the velocity there is.
///
/// They do not know of a [`SpringToPoint`](crate::SpringToPoint) on the same body; to tie a body to
/// a place in a stiff net, spring it to a fixed body.
///
/// A spring with a rest length that is pressed through its own middle turns about at once: the path
/// after that depends on the step.
///
/// ```
/// use tumble::Spring;
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// // Balls that go through each other.
/// let ball = RigidBody::new(Shape::sphere(0.1)).mass(2.0).without_collider();
/// let ball = |x: Real| ball.clone().position(Vec3::X * x).build();
/// let (left, right) = (ball(-1.0)?.spawn(&mut world), ball(1.0)?.spawn(&mut world));
/// // A reduced mass of 1 kg: they swing apart and together once in pi seconds.
/// world.spawn((Spring::between(left, right).with_rest_length(1.0).with_stiffness(4.0),));
///
/// let mut simulation =
///     Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(0.01))?;
/// for _ in 0..157 {
///     simulation.step(&mut world);
/// }
/// assert!(world.get::<&Pose>(left)?.position.x.abs() < 1e-2); // half a period
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("spring joint", "bungee"))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// What it connects.
    pub bodies: [Entity; 2],
    /// A point of each \[m\], from the centre of mass along the body's axes.
    pub attachments: [Vec3; 2],
    /// Length at which it does not pull \[m\].
    pub rest_length: Real,
    /// Force over elongation [N/m].
    pub stiffness: Real,
    /// Force over speed of elongation [N s/m].
    pub damping: Real,
}

impl Spring {
    /// From centre of mass to centre of mass, with neither length nor strength yet.
    pub fn between(a: Entity, b: Entity) -> Self {
        Self { bodies: [a, b], attachments: [Vec3::ZERO; 2], rest_length: 0.0, stiffness: 0.0, damping: 0.0 }
    }

    /// The same between other points \[m\], from each centre of mass along the body's axes.
    #[must_use]
    pub fn attached_at(self, a: Vec3, b: Vec3) -> Self {
        Self { attachments: [a, b], ..self }
    }

    /// The same with a length at which it does not pull \[m\].
    #[must_use]
    pub fn with_rest_length(self, rest_length: Real) -> Self {
        Self { rest_length, ..self }
    }

    /// The same with a stiffness [N/m].
    #[must_use]
    pub fn with_stiffness(self, stiffness: Real) -> Self {
        Self { stiffness, ..self }
    }

    /// The same with a damping [N s/m].
    #[must_use]
    pub fn with_damping(self, damping: Real) -> Self {
        Self { damping, ..self }
    }
}
