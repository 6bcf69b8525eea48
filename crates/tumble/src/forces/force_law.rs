//! Forces that depend on the state of a body or on time, as the caller writes them.

use tumble_math::lane::Vec3 as LaneVec3;

use crate::components::Wrench;
use crate::forces::force_context::ForceContext;
use crate::integrators::state::{Constants, State};
use crate::math::{Quat, Real, Vec3, rotated};

/// A force on a body that depends on its state, or on time.
///
/// A law is a component of the bodies it acts on, made known by
/// [`Simulation::add_law`](crate::Simulation::add_law), or it acts on every moving body
/// ([`Simulation::add_global_law`](crate::Simulation::add_global_law)). Every integrator evaluates
/// it at every stage, with the time and the state of that stage:
///
/// | integrator | evaluations a substep | order under laws |
/// |---|---|---|
/// | `SemiImplicitEuler` | 1, at the start | 1 |
/// | `RungeKutta4` | 4 | 4 |
/// | `MoserVeselov` | 2, at start and end; 3 of what [depends on velocity][velocity] | 2 |
///
/// [velocity]: Self::depends_on_velocity
///
/// One that is to run at the speed of the engine's own forces, many bodies at a time, is a
/// [`SimdForceLaw`](crate::SimdForceLaw).
///
/// A body's laws are evaluated together, and bodies next to each other too: one that depends on
/// velocity has the others evaluated once more as well.
///
/// A law must not depend on anything but its own data and the state it is given, and should keep to
/// basic arithmetic if the bits are to be the same on every machine.
///
/// ```
/// use tumble::prelude::*;
/// use tumble::{BodyState, ForceLaw};
///
/// /// Pulls towards the origin.
/// struct Tether {
///     stiffness: Real,
/// }
///
/// impl ForceLaw for Tether {
///     fn wrench(&self, state: &BodyState<'_>) -> Wrench {
///         Wrench { force: state.position * -self.stiffness, torque: Vec3::ZERO }
///     }
///     fn depends_on_velocity(&self) -> bool {
///         false
///     }
///     fn potential(&self, state: &BodyState<'_>) -> f64 {
///         0.5 * f64::from(self.stiffness * state.position.length_squared())
///     }
/// }
///
/// let mut world = hecs::World::new();
/// let body = RigidBody::new(Shape::Point).mass(1.0).position(Vec3::X).build()?.spawn(&mut world);
/// world.insert_one(body, Tether { stiffness: 4.0 })?;
/// let mut simulation =
///     Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(0.01))?;
/// simulation.add_law::<Tether>();
/// for _ in 0..314 {
///     simulation.step(&mut world); // one period is pi seconds
/// }
/// assert!((world.get::<&Pose>(body)?.position - Vec3::X).length() < 1e-2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait ForceLaw: Send + Sync + 'static {
    /// Force \[N\] and torque about the centre of mass [N m], both in the world frame.
    /// [`BodyState::wrench_from_body_frame`] makes one from forces given in the body's frame.
    fn wrench(&self, state: &BodyState<'_>) -> Wrench;

    /// Whether the force depends on velocity or momentum; `false` saves an evaluation.
    fn depends_on_velocity(&self) -> bool {
        true
    }

    /// Potential energy \[J\] of a conservative law, zero for others. Only the ledger asks for it.
    fn potential(&self, state: &BodyState<'_>) -> f64 {
        let _ = state;
        0.0
    }
}

/// What a law sees of a body at one stage of an integrator.
///
/// ```
/// # use tumble::prelude::*;
/// /// A sail at the bow, pushed by the wind that blows relative to it.
/// struct Sail;
///
/// impl ForceLaw for Sail {
///     fn wrench(&self, state: &BodyState<'_>) -> Wrench {
///         let bow = state.point_to_world(Vec3::Z * 2.0);
///         state.force_at((state.wind() - state.velocity_at(bow)) * 5.0, bow)
///     }
/// }
/// ```
#[derive(Clone, Copy)]
pub struct BodyState<'a> {
    /// Simulated time of the stage \[s\].
    pub time: f64,
    /// Centre of mass \[m\], world frame.
    pub position: Vec3,
    /// Unit quaternion, body frame to world.
    pub orientation: Quat,
    /// Velocity of the centre of mass [m/s], world frame.
    pub linear_velocity: Vec3,
    /// Angular velocity [rad/s], world frame.
    pub angular_velocity: Vec3,
    /// Mass \[kg\].
    pub mass: Real,
    start: f64,
    offset: Real,
    constants: &'a Constants<Real>,
    context: &'a ForceContext,
}

impl<'a> BodyState<'a> {
    /// Of a state that the body reaches `when.1` \[s\] after `when.0` \[s\], the start of a
    /// substep.
    pub(crate) fn new(when: (f64, Real), about: (&'a Constants<Real>, &'a ForceContext), state: &State<Real>) -> Self {
        let orientation = state.orientation.normalize();
        let angular_velocity = about.0.angular_velocity(&State { orientation, ..*state });
        let velocities = (about.0.velocity(state.linear).into(), angular_velocity.into());
        Self::of_velocities(when, about, (state.position.into(), orientation.into()), velocities)
    }

    /// Of a position, an orientation of unit length, and velocities.
    pub(crate) fn of_velocities(
        (start, offset): (f64, Real),
        (constants, context): (&'a Constants<Real>, &'a ForceContext),
        (position, orientation): (Vec3, Quat),
        (linear_velocity, angular_velocity): (Vec3, Vec3),
    ) -> Self {
        let mass = constants.mass;
        let time = start + f64::from(offset);
        Self { time, start, offset, position, orientation, linear_velocity, angular_velocity, mass, constants, context }
    }

    /// Time at the start of the substep \[s\].
    pub(crate) fn start(&self) -> f64 {
        self.start
    }

    /// Time from there to the stage \[s\].
    pub(crate) fn offset(&self) -> Real {
        self.offset
    }

    pub(crate) fn constants(&self) -> &'a Constants<Real> {
        self.constants
    }

    pub(crate) fn context(&self) -> &'a ForceContext {
        self.context
    }

    /// Velocity of the medium [m/s], world frame: the body's [`Wind`](crate::Wind), or zero.
    pub fn wind(&self) -> Vec3 {
        self.context.wind
    }

    /// The simulation's gravity [m/s^2], world frame, whatever the body's
    /// [`GravityScale`](crate::GravityScale).
    pub fn gravity(&self) -> Vec3 {
        self.context.gravity
    }

    /// World coordinates \[m\] of a point given relative to the centre of mass along the body's
    /// axes.
    pub fn point_to_world(&self, point_body: Vec3) -> Vec3 {
        self.position + rotated(self.orientation, point_body)
    }

    /// A direction of the body's frame in the world frame.
    pub fn to_world(&self, vector_body: Vec3) -> Vec3 {
        rotated(self.orientation, vector_body)
    }

    /// A direction of the world frame in the body's frame.
    pub fn to_body(&self, vector_world: Vec3) -> Vec3 {
        rotated(self.orientation.conjugate(), vector_world)
    }

    /// The wrench of a force \[N\] through the centre of mass and a torque [N m], both given in the
    /// body's frame.
    pub fn wrench_from_body_frame(&self, force_body: Vec3, torque_body: Vec3) -> Wrench {
        Wrench { force: self.to_world(force_body), torque: self.to_world(torque_body) }
    }

    /// The wrench of a force \[N\] that acts at a point \[m\], both in the world frame.
    pub fn force_at(&self, force: Vec3, point: Vec3) -> Wrench {
        Wrench { force, torque: (point - self.position).cross(force) }
    }

    /// Velocity [m/s] of the body's material at a point of the world.
    pub fn velocity_at(&self, point: Vec3) -> Vec3 {
        self.linear_velocity + self.angular_velocity.cross(point - self.position)
    }

    /// The inertia tensor times a vector, `R I R^T v`, in the world frame; zero for a point mass.
    pub fn apply_inertia(&self, vector: Vec3) -> Vec3 {
        let Some(inertia) = self.constants.inertia else { return Vec3::ZERO };
        let [a, b, c] = inertia.world_axes(self.orientation.into());
        let (m, v) = (inertia.moments, LaneVec3::from(vector));
        (a * (a.dot(v) * m.x) + b * (b.dot(v) * m.y) + c * (c.dot(v) * m.z)).into()
    }
}
