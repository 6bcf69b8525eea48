use tumble_math::lane::{Lane, Vec3 as LaneVec3};

use crate::lane_law::{LaneBody, LaneLaw, LaneWrench};
use crate::math::{Real, Vec3};

/// Which axes a vector is given along.
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
    pub(super) fn number(self) -> Real {
        match self {
            Self::World => 0.0,
            Self::Body => 1.0,
        }
    }
}

/// A force and a torque that act until this component is removed; a [`Wrench`](crate::Wrench) acts in one step only.
///
/// In the world frame it is a constant force: `x = x0 + v0 t + F t^2/2M`. In the body frame it turns with the body. It has no potential.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ConstantWrench {
    /// Force through the centre of mass \[N\].
    pub force: Vec3,
    /// Torque about the centre of mass [N m].
    pub torque: Vec3,
    /// Which axes both are given along.
    pub frame: Frame,
}

impl LaneLaw<7> for ConstantWrench {
    fn numbers(&self) -> [Real; 7] {
        let (f, t) = (self.force, self.torque);
        [f.x, f.y, f.z, t.x, t.y, t.z, self.frame.number()]
    }

    #[inline(always)]
    fn wrench<L: Lane>([fx, fy, fz, tx, ty, tz, frame]: [L; 7], body: &LaneBody<L>) -> LaneWrench<L> {
        LaneWrench {
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
pub(super) fn to_world<L: Lane>(frame: L, vector: LaneVec3<L>, body: &LaneBody<L>) -> LaneVec3<L> {
    let is_body = L::splat(0.5).lt(frame);
    LaneVec3::select(is_body, body.orientation.rotate(vector), vector)
}
