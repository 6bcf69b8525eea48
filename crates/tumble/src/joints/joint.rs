//! A joint between two bodies.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};

use crate::components::Pose;
use crate::joints::axes::Axes;
use crate::joints::joint_error::JointError;
use crate::math::{Vec3, dquat, dvec3, quat};
use crate::range::{MAX_DISTANCE_OF_CONTACTS, is_rotation, within};

/// A joint: it locks some of the axes along and about which one body can move against another. It
/// is a component of an entity of its own, so a body can have any number.
///
/// Both bodies have a frame; the joint keeps the origins together along the axes of translation
/// that are not [`free`](Self::free), and the axes aligned but for the rotations that are. Either
/// body may be fixed or kinematic. While a body is not in the world, or both are the same, the
/// joint does nothing. All joints that hang together are solved at once, so it does not matter how
/// many there are in a row or how unequal the masses are.
///
/// ```
/// use tumble::{Joint, prelude::*};
///
/// let mut world = tumble::hecs::World::new();
/// let beam = RigidBody::new(Shape::Point).fixed().build()?.spawn(&mut world);
/// let rod = RigidBody::new(Shape::cuboid([0.5, 0.02, 0.02])).mass(1.0).position(Vec3::X * 0.5);
/// let rod = rod.build()?.spawn(&mut world);
/// world.spawn((Joint::hinge(beam, rod).at(&world, Vec3::ZERO, Vec3::Z)?,));
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// for _ in 0..600 {
///     simulation.step(&mut world);
///     // It swings, and its centre stays half a metre from the hinge.
///     assert!((world.get::<&Pose>(rod)?.position.length() - 0.5).abs() < 1e-5);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("constraint", "fixed joint", "revolute joint", "prismatic joint", "spherical joint", "distance joint"))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// What it connects.
    pub bodies: [Entity; 2],
    /// The frame of each: origin \[m\] from the centre of mass and orientation, both along the
    /// body's axes.
    pub frames: [Pose; 2],
    /// The axes that are not locked.
    pub free: Axes,
    /// Whether the colliders of its two bodies touch each other.
    pub contacts_enabled: bool,
}

impl Joint {
    /// A joint that leaves these axes free, from centre of mass to centre of mass.
    #[doc(alias("generic joint", "six degrees of freedom"))]
    pub fn free_along(a: Entity, b: Entity, free: Axes) -> Self {
        Self { bodies: [a, b], frames: [Pose::default(); 2], free, contacts_enabled: false }
    }

    /// A ball and socket: three free rotations.
    #[doc(alias("spherical joint", "point-to-point", "ball and socket"))]
    pub fn ball(a: Entity, b: Entity) -> Self {
        Self::free_along(a, b, Axes::ANGULAR)
    }

    /// A hinge: free rotation about x of the frames.
    #[doc(alias("revolute joint", "door"))]
    pub fn hinge(a: Entity, b: Entity) -> Self {
        Self::free_along(a, b, Axes::ANGULAR_X)
    }

    /// A slider: free translation along x of the first frame.
    #[doc(alias("prismatic joint", "piston"))]
    pub fn slider(a: Entity, b: Entity) -> Self {
        Self::free_along(a, b, Axes::LINEAR_X)
    }

    /// A cylinder in a sleeve: free translation along x, and rotation about it.
    #[doc(alias = "cylindrical joint")]
    pub fn cylinder(a: Entity, b: Entity) -> Self {
        Self::free_along(a, b, Axes::LINEAR_X | Axes::ANGULAR_X)
    }

    /// A universal joint: free rotation about x of the first frame and y of the second, which stay
    /// at right angles.
    #[doc(alias = "cardan joint")]
    pub fn universal(a: Entity, b: Entity) -> Self {
        Self::free_along(a, b, Axes::ANGULAR_X | Axes::ANGULAR_Y)
    }

    /// A plate on a plane: free translation along y and z of the first frame, and rotation about x,
    /// the normal.
    pub fn planar(a: Entity, b: Entity) -> Self {
        Self::free_along(a, b, Axes::LINEAR_Y | Axes::LINEAR_Z | Axes::ANGULAR_X)
    }

    /// A weld: no free axis.
    #[doc(alias("fixed joint", "weld joint", "lock"))]
    pub fn fixed(a: Entity, b: Entity) -> Self {
        Self::free_along(a, b, Axes::NONE)
    }

    /// All axes free, for [`Limits`](crate::Limits), [`Drives`](crate::Drives) and friction: a
    /// rope, a rod, a bungee.
    #[doc(alias("distance joint", "rope joint"))]
    pub fn free(a: Entity, b: Entity) -> Self {
        Self::free_along(a, b, Axes::LINEAR | Axes::ANGULAR)
    }

    /// The same with both frames at a point of the world \[m\], x along an axis, where the bodies
    /// are now.
    ///
    /// # Errors
    /// [`JointError`] where an end is not a body of this world, both are the same, or point or axis
    /// are not finite or the axis is zero.
    pub fn at(self, world: &World, point: Vec3, axis: Vec3) -> Result<Self, JointError> {
        let [a, b] = self.bodies;
        // A sum of squares may overflow.
        let most = axis.abs().max_element();
        let scaled = axis / most;
        if !(most > 0.0 && scaled.is_finite()) {
            return Err(JointError::Axis(a, b));
        }
        let direction = dvec3(scaled).normalize();
        // Half a turn about any axis across; glam would make it of the sine of the platform.
        let is_opposite = direction.x <= -1.0 + 2.0 * f64::EPSILON;
        let half_turn = DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0);
        let orientation = if is_opposite { half_turn } else { DQuat::from_rotation_arc(DVec3::X, direction) };
        self.with_frames_at(world, point, orientation)
    }

    /// The same with both frames at a point of the world \[m\], along the axes of the world, where
    /// the bodies are now.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn at_point(self, world: &World, point: Vec3) -> Result<Self, JointError> {
        self.with_frames_at(world, point, DQuat::IDENTITY)
    }

    fn with_frames_at(self, world: &World, point: Vec3, orientation: DQuat) -> Result<Self, JointError> {
        let [a, b] = self.bodies;
        if a == b {
            return Err(JointError::SameBody(a));
        }
        let [first, second] = [pose_of(world, a)?, pose_of(world, b)?];
        // What is not a number is within nothing.
        if !within(point.into(), MAX_DISTANCE_OF_CONTACTS) {
            return Err(JointError::Point(a, b));
        }
        let frame = |body: Pose| Pose {
            position: body.inverse_transform_point(point),
            orientation: quat((dquat(body.orientation).conjugate() * orientation).normalize()),
        };
        Ok(Self { frames: [frame(first), frame(second)], ..self })
    }

    /// The same with another frame of each body: origin \[m\] from the centre of mass and
    /// orientation, both along the body's axes.
    #[must_use]
    pub fn with_frames(self, a: Pose, b: Pose) -> Self {
        Self { frames: [a, b], ..self }
    }

    /// The same with contacts between its two bodies, which it otherwise leaves out.
    #[must_use]
    pub fn with_contacts(self) -> Self {
        Self { contacts_enabled: true, ..self }
    }

    /// Whether its frames are of numbers that can be reckoned with.
    pub(crate) fn is_in_range(&self) -> bool {
        self.frames.iter().all(|frame| {
            within(frame.position.into(), MAX_DISTANCE_OF_CONTACTS) && is_rotation(frame.orientation.into())
        })
    }
}

fn pose_of(world: &World, body: Entity) -> Result<Pose, JointError> {
    world.get::<&Pose>(body).map(|pose| *pose).map_err(|_| JointError::NoBody(body))
}
