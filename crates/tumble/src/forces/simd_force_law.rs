//! Forces whose equation is written once for a whole tile of bodies.

use tumble_math::lane::{Lane, Quat, Vec3};

use crate::forces::force_context::ForceContext;
use crate::forces::force_law::BodyState;
use crate::integrators::state::Constants;
use crate::math::Real;

/// A force law that is computed for many bodies at once: sixteen numbers to an instruction where
/// the machine has AVX-512.
///
/// The force components of this crate, such as [`Drag`](crate::Drag), are such laws, and one of the
/// caller's own is their equal: it is evaluated at the same stages, and the ledger gives it an
/// account. It is a component of the bodies it acts on, made known by
/// [`Simulation::add_simd_law`](crate::Simulation::add_simd_law), or acts on all
/// ([`add_global_simd_law`](crate::Simulation::add_global_simd_law)). Where a law needs a table, a
/// loop that ends at a different time for each body, or `sin`, [`ForceLaw`](crate::ForceLaw) is the
/// easier one.
///
/// `N` is how many numbers of the component the equation takes. [`wrench`](Self::wrench) must be
/// `#[inline(always)]`, and may use arithmetic, square roots and [`Lane::select`], but no closure:
/// what is not inlined is compiled without the vector instructions. A number that the equation
/// divides by zero in one body does no harm to the others.
///
/// ```
/// use tumble::lane::{Lane, Vec3 as LaneVec3};
/// use tumble::prelude::*;
/// use tumble::{SimdBody, SimdForceLaw, SimdWrench};
///
/// /// Pulls towards the axis x = z = 0.
/// #[derive(Clone, Copy)]
/// struct Trough {
///     stiffness: Real,
/// }
///
/// impl SimdForceLaw<1> for Trough {
///     fn numbers(&self) -> [Real; 1] {
///         [self.stiffness]
///     }
///
///     #[inline(always)]
///     fn wrench<L: Lane>([stiffness]: [L; 1], body: &SimdBody<L>) -> SimdWrench<L> {
///         let from_axis = LaneVec3::new(body.position.x, L::splat(0.0), body.position.z);
///         SimdWrench::force(from_axis * -stiffness)
///     }
///
///     fn depends_on_velocity(&self) -> bool {
///         false
///     }
/// }
///
/// let mut world = hecs::World::new();
/// let body = RigidBody::new(Shape::Point).mass(1.0).position(Vec3::X).build()?.spawn(&mut world);
/// world.insert_one(body, Trough { stiffness: 4.0 })?;
/// let mut simulation =
///     Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(0.01))?;
/// simulation.add_simd_law::<Trough, 1>();
/// for _ in 0..314 {
///     simulation.step(&mut world); // one period is pi seconds
/// }
/// assert!((world.get::<&Pose>(body)?.position - Vec3::X).length() < 1e-2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait SimdForceLaw<const N: usize>: Send + Sync + 'static {
    /// The numbers of one body's law that [`wrench`](Self::wrench) reads.
    fn numbers(&self) -> [Real; N];

    /// The wrench on each body, from each body's numbers.
    fn wrench<L: Lane>(numbers: [L; N], body: &SimdBody<L>) -> SimdWrench<L>;

    /// Whether the force depends on velocity; `false` saves an evaluation.
    fn depends_on_velocity(&self) -> bool {
        true
    }

    /// Potential energy \[J\] of a conservative law, zero for others. Only sums of energy ask for
    /// it.
    fn potential(&self, state: &BodyState<'_>) -> f64 {
        let _ = state;
        0.0
    }
}

/// Forces \[N\] and torques about the centre of mass [N m] on bodies side by side, world frame.
///
/// ```
/// use tumble::{SimdWrench, lane::Vec3};
///
/// let (force, arm) = (Vec3::new(0.0, 10.0, 0.0), Vec3::new(0.5, 0.0, 0.0));
/// assert_eq!(SimdWrench::force_at(force, arm).torque.z, 5.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SimdWrench<L> {
    /// Force \[N\].
    pub force: Vec3<L>,
    /// Torque about the centre of mass [N m].
    pub torque: Vec3<L>,
}

impl<L: Lane> SimdWrench<L> {
    /// A force \[N\] through the centre of mass.
    #[inline(always)]
    pub fn force(force: Vec3<L>) -> Self {
        Self { force, torque: Vec3::zero() }
    }

    /// A torque [N m].
    #[inline(always)]
    pub fn torque(torque: Vec3<L>) -> Self {
        Self { force: Vec3::zero(), torque }
    }

    /// A force \[N\] that acts at a point; `arm` leads there from the centre of mass \[m\], both in
    /// the world frame.
    #[inline(always)]
    pub fn force_at(force: Vec3<L>, arm: Vec3<L>) -> Self {
        Self { force, torque: arm.cross(force) }
    }
}

/// What a [`SimdForceLaw`] sees of bodies side by side, at one stage of an integrator.
///
/// ```
/// use tumble::lane::Lane;
/// use tumble::{SimdBody, SimdWrench};
///
/// /// Resistance in proportion to the velocity through the medium.
/// #[inline(always)]
/// fn viscous<L: Lane>(coefficient: L, body: &SimdBody<L>) -> SimdWrench<L> {
///     SimdWrench::force((body.wind - body.linear_velocity) * coefficient)
/// }
/// ```
#[derive(Clone, Copy)]
pub struct SimdBody<L> {
    /// Simulated time at the start of the substep \[s\].
    pub time: f64,
    /// Time from there to the stage \[s\].
    pub offset: L,
    /// Centre of mass \[m\], world frame.
    pub position: Vec3<L>,
    /// Unit quaternion, body frame to world.
    pub orientation: Quat<L>,
    /// Velocity of the centre of mass [m/s], world frame.
    pub linear_velocity: Vec3<L>,
    /// Angular velocity [rad/s], world frame.
    pub angular_velocity: Vec3<L>,
    /// Mass \[kg\].
    pub mass: L,
    /// Velocity of the medium [m/s], world frame: the body's [`Wind`](crate::Wind).
    pub wind: Vec3<L>,
    /// The simulation's gravity [m/s^2], world frame, whatever the body's
    /// [`GravityScale`](crate::GravityScale).
    pub gravity: Vec3<L>,
    pub(crate) constants: Constants<L>,
    /// The time over which a kick applies the force of one evaluation \[s\], and the substep \[s\];
    /// see [`ForceContext`].
    pub(crate) kick: L,
    pub(crate) substep: L,
}

impl<L: Lane> SimdBody<L> {
    /// `I^-1 v`, in the world frame: the change of angular velocity by an angular impulse `v`; zero
    /// for a point mass.
    #[inline(always)]
    pub fn apply_inverse_inertia(&self, v: Vec3<L>) -> Vec3<L> {
        match &self.constants.inertia {
            Some(inertia) => inertia.angular_velocity(self.orientation, v),
            None => Vec3::zero(),
        }
    }

    /// `I v`, in the world frame; zero for a point mass.
    #[inline(always)]
    pub fn apply_inertia(&self, v: Vec3<L>) -> Vec3<L> {
        match &self.constants.inertia {
            Some(inertia) => {
                let [a, b, c] = inertia.world_axes(self.orientation);
                let m = inertia.moments;
                a * (a.dot(v) * m.x) + b * (b.dot(v) * m.y) + c * (c.dot(v) * m.z)
            }
            None => Vec3::zero(),
        }
    }

    /// The most by which an impulse of one newton second at a point can change the velocity there,
    /// along the impulse [1/kg]; the point \[m\] is given from the centre of mass along the body's
    /// axes. It does not depend on attitude.
    #[inline(always)]
    pub fn most_inverse_mass_at(&self, point_body: Vec3<L>) -> L {
        self.constants.most_inverse_mass_at(point_body)
    }

    /// Velocity [m/s] of the body's material at `arm` \[m\] from the centre of mass, world frame.
    #[inline(always)]
    pub fn velocity_at(&self, arm: Vec3<L>) -> Vec3<L> {
        self.linear_velocity + self.angular_velocity.cross(arm)
    }

    /// The stiffness [N/m] with which a spring acts so that it oscillates at its true frequency, as
    /// long as that is below 0.45 a substep, and at most at that frequency however stiff it is.
    /// `inverse_mass` [1/kg] is what it moves. Under `RungeKutta4` it is what was given.
    ///
    /// The inverse mass should be one that does not change as bodies turn, or the spring has no
    /// energy to keep: take [`most_inverse_mass_at`](Self::most_inverse_mass_at).
    ///
    /// Splitting methods turn the frequency `w` into one with `4 sin^2(w' h/2) = w^2 h^2`, which
    /// has no solution past `w h = 2`: the spring explodes. With `4/h^2 sin^2(w h/2)` for the
    /// squared frequency `k/m` the discrete one is right (P. Deuflhard, ZAMP 30, 1979, for linear
    /// oscillators).
    #[inline(always)]
    pub fn stable_stiffness(&self, stiffness: L, inverse_mass: L) -> L {
        let filtered = crate::forces::stable_spring::stable_stiffness(
            stiffness,
            inverse_mass,
            self.substep,
            L::splat(crate::forces::stable_spring::MAX_ANGLE),
        );
        L::select(L::splat(0.0).lt(self.kick), filtered, stiffness)
    }

    /// What a spring with a damper pulls with \[N\], so that neither explodes: elongation \[m\]
    /// times [`stable_stiffness`](Self::stable_stiffness) and speed of elongation [m/s] times a
    /// damping \[N s/m\] that never takes away more than there is. `inverse_mass` as there. Under
    /// `RungeKutta4` both are what was given.
    #[inline(always)]
    pub fn stable_pull(&self, [stiffness, damping]: [L; 2], [elongation, speed]: [L; 2], inverse_mass: L) -> L {
        self.damped_pull(self.stable_stiffness(stiffness, inverse_mass) * elongation, [damping, speed], inverse_mass)
    }

    /// An elastic pull \[N\] with a damper that takes away no more than there is.
    #[inline(always)]
    pub(crate) fn damped_pull(&self, elastic: L, [damping, speed]: [L; 2], inverse_mass: L) -> L {
        let in_halves =
            elastic + crate::forces::stable_spring::stable_damping(damping, inverse_mass, self.kick) * speed;
        // A kick over a whole step leaves less room: there the damping is implicit, and the elastic
        // force divided with it.
        let one = L::splat(1.0);
        let in_one = (elastic + damping * speed) / (one + damping * inverse_mass * self.kick);
        L::select(self.kick.lt(self.substep), in_halves, in_one)
    }

    /// For each axis of the body a moment of inertia that a resistance along it meets at the least
    /// [kg m^2]: the moment itself where the axes are principal ones, else the smallest; zero for a
    /// point mass, which has nothing to turn.
    #[inline(always)]
    pub(crate) fn least_inertia(&self) -> Vec3<L> {
        match &self.constants.inertia {
            Some(inertia) => {
                let m = inertia.moments;
                match inertia.axes {
                    Some(_) => Vec3::splat(m.x.min(m.y).min(m.z)),
                    None => m,
                }
            }
            None => Vec3::zero(),
        }
    }

    /// The time \[s\] in which a force has to do its work so that it is done when the step ends,
    /// without going too far.
    #[inline(always)]
    pub fn response_time(&self) -> L {
        L::select(L::splat(0.0).lt(self.kick), self.kick, self.substep)
    }
}

impl SimdBody<Real> {
    /// One body.
    pub(crate) fn of(state: &BodyState<'_>) -> Self {
        let ForceContext { wind, gravity, kick, substep } = *state.context();
        Self {
            time: state.start(),
            offset: state.offset(),
            position: state.position.into(),
            orientation: state.orientation.into(),
            linear_velocity: state.linear_velocity.into(),
            angular_velocity: state.angular_velocity.into(),
            mass: state.mass,
            wind: wind.into(),
            gravity: gravity.into(),
            constants: *state.constants(),
            kick,
            substep,
        }
    }
}
