//! A constant force and torque, given in the world frame or the body frame.

use tumble_math::lane::{Lane, Vec3 as LaneVec3};

use crate::forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
use crate::math::{Real, Vec3};

/// Which axes a vector is given along.
///
/// ```
/// # use tumble::prelude::*;
/// // A motor that pushes along the body's own y axis, wherever that points.
/// let motor =
///     ConstantWrench { force: Vec3::Y * 50.0, frame: Frame::Body, ..ConstantWrench::default() };
/// # assert_ne!(motor.frame, Frame::default());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Frame {
    /// The world's.
    #[default]
    World,
    /// The body's: the vector turns with it.
    Body,
}

impl Frame {
    /// As a number of a law: 1 for the body's.
    pub(crate) fn number(self) -> Real {
        match self {
            Self::World => 0.0,
            Self::Body => 1.0,
        }
    }
}

/// A force and a torque that act until this component is removed; a [`Wrench`](crate::Wrench) acts
/// in one step only.
///
/// In the world frame it is a constant force: `x = x0 + v0 t + F t^2/2M`. In the body frame it
/// turns with the body. It has no potential.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// let sled = RigidBody::new(Shape::cuboid([0.4, 0.1, 0.2]))
///     .mass(5.0)
///     .gravity_scale(0.0)
///     .build()?
///     .spawn(&mut world);
/// world
///     .insert_one(sled, ConstantWrench { force: Vec3::X * 10.0, ..ConstantWrench::default() })?;
/// Simulation::new(Settings::default())?.step_many(&mut world, 60); // a second
/// assert!((world.get::<&Velocity>(sled)?.linear.x - 2.0).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("ConstantForce", "constant force"))]
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ConstantWrench {
    /// Force through the centre of mass \[N\].
    pub force: Vec3,
    /// Torque about the centre of mass [N m].
    pub torque: Vec3,
    /// Which axes both are given along.
    pub frame: Frame,
}

impl SimdForceLaw<7> for ConstantWrench {
    fn numbers(&self) -> [Real; 7] {
        let (f, t) = (self.force, self.torque);
        [f.x, f.y, f.z, t.x, t.y, t.z, self.frame.number()]
    }

    #[inline(always)]
    fn wrench<L: Lane>([fx, fy, fz, tx, ty, tz, frame]: [L; 7], body: &SimdBody<L>) -> SimdWrench<L> {
        SimdWrench {
            force: to_world(frame, LaneVec3::new(fx, fy, fz), body),
            torque: to_world(frame, LaneVec3::new(tx, ty, tz), body),
        }
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }
}

/// A vector given along the axes of a [`Frame`], in the world frame.
#[inline(always)]
pub(crate) fn to_world<L: Lane>(frame: L, vector: LaneVec3<L>, body: &SimdBody<L>) -> LaneVec3<L> {
    let is_body = L::splat(0.5).lt(frame);
    LaneVec3::select(is_body, body.orientation.rotate(vector), vector)
}
