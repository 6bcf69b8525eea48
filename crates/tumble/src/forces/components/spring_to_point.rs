//! A damped spring from a point of the body to a fixed point in the world.

use tumble_math::lane::{Lane, Vec3 as LaneVec3};

use crate::forces::components::spring_force::Direction;
use crate::forces::force_law::BodyState;
use crate::forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
use crate::forces::spring_potential::{End, Hooke, pull};
use crate::forces::stable_spring::MAX_ANGLE;
use crate::math::{Real, Vec3, dvec3};

/// A spring with a damper from a point of the body to a point of the world.
///
/// Along the line between them, at the distance `l`, it pulls with `k (l - l0) + c dl/dt`; its
/// energy is `k (l - l0)^2/2`. With a rest length of zero it pulls towards the anchor from every
/// side.
///
/// Under `MoserVeselov` and `SemiImplicitEuler` it never explodes, however stiff. At the centre of
/// mass it has its true frequency up to 0.45 a substep, and elsewhere no higher one than it should:
/// see [`SimdBody::stable_stiffness`]. Under `RungeKutta4` the angular frequency times the substep
/// must stay below 2.8. Between two bodies there is [`Spring`](crate::Spring).
///
/// It reckons with the whole mass of the body: on one that other springs hold as well, all of them
/// together must not be stiffer than one may be at its stiffest.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// // 1 kg on 4 N/m: half a period is pi/2 seconds.
/// let bob = RigidBody::new(Shape::Point).mass(1.0).position(Vec3::X).build()?.spawn(&mut world);
/// world.insert_one(bob, SpringToPoint { stiffness: 4.0, ..SpringToPoint::default() })?;
/// Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(0.01))?
///     .step_many(&mut world, 157);
/// assert!((world.get::<&Pose>(bob)?.position.x + 1.0).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("mouse joint", "grab", "drag"))]
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct SpringToPoint {
    /// The point of the world \[m\].
    pub anchor: Vec3,
    /// The point of the body \[m\], from the centre of mass along the body's axes.
    pub attachment: Vec3,
    /// Length at which it does not pull \[m\].
    pub rest_length: Real,
    /// Force over elongation [N/m].
    pub stiffness: Real,
    /// Force over speed of elongation [N s/m].
    pub damping: Real,
}

impl SimdForceLaw<9> for SpringToPoint {
    fn numbers(&self) -> [Real; 9] {
        let (a, b) = (self.anchor, self.attachment);
        [a.x, a.y, a.z, b.x, b.y, b.z, self.rest_length, self.stiffness, self.damping]
    }

    #[inline(always)]
    fn wrench<L: Lane>(
        [ax, ay, az, bx, by, bz, rest, stiffness, damping]: [L; 9],
        body: &SimdBody<L>,
    ) -> SimdWrench<L> {
        let attachment = LaneVec3::new(bx, by, bz);
        let arm = body.orientation.rotate(attachment);
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let moving = one / body.mass;
        let turning = (body.most_inverse_mass_at(attachment) - moving).max(zero);
        let anchored = End { arm: LaneVec3::zero(), inverse_masses: [zero; 2] };
        // Relative to the anchor first: both may be far from the origin.
        let difference = body.position - LaneVec3::new(ax, ay, az);
        let ends = [anchored, End { arm, inverse_masses: [moving, turning] }];
        let hooke = Hooke { stiffness, rest_length: rest, h: body.substep };
        let given = Direction::of(difference + arm);
        let soft = pull(hooke, difference, ends, L::splat(MAX_ANGLE));
        // `RungeKutta4` has no kicks, and takes the spring as it was given.
        let kicks = zero.lt(body.kick);
        let choose = |soft, given| LaneVec3::select(kicks, soft, given);
        let (unit, arm) = (choose(soft.direction, given.unit), choose(soft.arms[1], arm));
        let elastic = L::select(kicks, soft.tension, stiffness * (given.length - rest));
        let damping = damping + L::select(kicks, soft.damping / body.kick, zero);
        let speed = unit.dot(body.velocity_at(arm));
        let tension = body.damped_pull(elastic, [damping, speed], moving + turning);
        let mut wrench = SimdWrench::force_at(unit * (zero - tension), arm);
        wrench.force = wrench.force - choose(soft.drawing, LaneVec3::zero());
        wrench.torque = wrench.torque + choose(soft.drawing_torques[1], LaneVec3::zero());
        wrench
    }

    fn depends_on_velocity(&self) -> bool {
        self.damping != 0.0
    }

    fn potential(&self, state: &BodyState<'_>) -> f64 {
        let length = (dvec3(state.point_to_world(self.attachment)) - dvec3(self.anchor)).length();
        0.5 * f64::from(self.stiffness) * (length - f64::from(self.rest_length)).powi(2)
    }
}
