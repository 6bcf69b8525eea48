//! Total energy and momentum of a world, summed in double precision in a fixed order.

use glam::DVec3;
use hecs::{Entity, EntityRef, World};

use crate::components::Wind;
use crate::components::{GravityScale, Inertia, Mass, Momentum, Pose, PrincipalAxes};
use crate::energy::body_terms::MeasuredBodies;
use crate::forces::force_context::ForceContext;
use crate::forces::force_law::BodyState;
use crate::forces::pairwise;
use crate::forces::registry;
use crate::forces::registry::KnownLaws;
use crate::integrators::state::{Constants, Moments, State};
use crate::math::{Vec3, dvec3};
use crate::settings::Settings;
use crate::solver::mechanism::joint_potential::joint_potential;
use crate::step::simulation::Simulation;
use crate::storage::body_order::BodyOrder;
use crate::threads::Effort;

/// The components of a dynamic body that the sums read.
type Measured<'a> = (
    (&'a Pose, &'a Momentum, &'a Mass),
    (Option<&'a Inertia>, Option<&'a PrincipalAxes>, Option<&'a GravityScale>, Option<&'a Wind>),
    KnownLaws<'a>,
);

/// Total momenta and energies of a system of bodies, in double precision. Only bodies with momentum
/// count.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// RigidBody::new(Shape::Point)
///     .mass(2.0)
///     .position(Vec3::Y)
///     .linear_velocity(Vec3::X * 3.0)
///     .build()?
///     .spawn(&mut world);
/// let totals = Simulation::new(Settings::default())?.totals(&world);
/// assert_eq!((totals.linear_momentum.x, totals.angular_momentum.z), (6.0, -6.0));
/// assert!((totals.energy() - (9.0 + 2.0 * 9.81)).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Totals {
    /// Kinetic energy of the centres of mass, `sum P^2/2M` \[J\].
    pub linear_kinetic: f64,
    /// Kinetic energy of rotation, `sum L.w/2` \[J\].
    pub rotational_kinetic: f64,
    /// Energy in the simulation's gravity, zero at the world's origin, `-sum M g.x` \[J\].
    pub potential: f64,
    /// Energy in force components such as [`SpringToPoint`](crate::SpringToPoint) or
    /// [`Spring`](crate::Spring) \[J\], with the parameters that they were given; a spring that is
    /// stiff for the step acts softer, and has less. `Totals::of` takes time with the square of the
    /// number of [`GravityMass`](crate::GravityMass)es.
    ///
    /// The springs of joints are among them: [drives](crate::Drives) and soft
    /// [limits](crate::Limits) with a [`Gain::Stiffness`](crate::Gain::Stiffness), but for cones. A
    /// frequency or an acceleration goes by the mass that there is in each step and has no
    /// potential.
    pub force_potential: f64,
    /// `sum P` [kg m/s].
    pub linear_momentum: DVec3,
    /// Angular momentum about the world's origin, `sum x x P + L` [kg m^2/s].
    pub angular_momentum: DVec3,
    /// The first body whose state is not finite; it is left out of the sums.
    pub non_finite: Option<Entity>,
}

impl Simulation {
    /// Sums up energy and momentum of the moving bodies, as [`Totals::of`] does with the settings
    /// of this simulation. To sum up in every step, keep a [`BodyOrder`] and call that.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// # let mut world = hecs::World::new();
    /// RigidBody::new(Shape::Point)
    ///     .mass(2.0)
    ///     .linear_velocity(Vec3::X * 3.0)
    ///     .build()?
    ///     .spawn(&mut world);
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// let before = simulation.totals(&world);
    /// simulation.step_many(&mut world, 60);
    /// let after = simulation.totals(&world);
    /// assert_eq!(after.linear_momentum.x, 6.0);
    /// assert!((after.energy() - before.energy()).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn totals(&self, world: &World) -> Totals {
        Totals::of(world, self.settings(), &BodyOrder::of(world))
    }
}

impl Totals {
    /// Sums up energy and momentum of the moving bodies in the given order: one after the other in
    /// blocks of a thousand, which are shared among threads, and then block after block. So the
    /// sums have the same bits for any number of threads and wherever the bodies lie.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// # use tumble::{BodyOrder, Totals};
    /// let mut world = hecs::World::new();
    /// RigidBody::new(Shape::Point)
    ///     .mass(2.0)
    ///     .linear_velocity(Vec3::X * 3.0)
    ///     .build()?
    ///     .spawn(&mut world);
    /// let totals = Totals::of(&world, &Settings::default(), &BodyOrder::of(&world));
    /// assert_eq!(totals.linear_kinetic, 9.0);
    /// # Ok::<(), tumble::BodyError>(())
    /// ```
    pub fn of(world: &World, settings: &Settings, order: &BodyOrder) -> Self {
        Effort::of_sums(order.len()).run(|| {
            let around = ForceContext::new(settings);
            let mut query = world.query::<Measured<'_>>();
            let bodies = query.view();
            let blocks = order.in_blocks(|block| {
                let mut sums = Sums::new(around);
                for &entity in block {
                    if let Some(measured) = bodies.get(entity) {
                        sums.add((entity, measured));
                    }
                }
                sums.totals()
            });
            let mut totals = Self::default();
            blocks.iter().for_each(|block| totals.append(block));
            totals.force_potential += pairwise::potential(world, order) + joint_potential(world);
            totals
        })
    }

    /// Of one body, without what forces between bodies and joints hold; nothing but
    /// [`non_finite`](Self::non_finite) if its state is not finite.
    ///
    /// ```
    /// # use tumble::{prelude::*, Totals};
    /// # let mut world = hecs::World::new();
    /// let wheel = RigidBody::new(Shape::cylinder(1.0, 0.1))
    ///     .mass(4.0)
    ///     .angular_velocity(Vec3::Y * 2.0)
    ///     .build()?
    ///     .spawn(&mut world);
    /// let totals = Totals::of_body(world.entity(wheel)?, &Settings::default());
    /// assert!((totals.rotational_kinetic - 4.0).abs() < 1e-6); // m r^2/4 w^2
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_body(body: EntityRef<'_>, settings: &Settings) -> Self {
        let mut sums = Sums::new(ForceContext::new(settings));
        if let Ok(measured) = body.query::<Measured<'_>>().get() {
            sums.add((body.entity(), measured));
        }
        sums.totals()
    }

    /// Kinetic and potential energy \[J\].
    pub fn energy(&self) -> f64 {
        self.linear_kinetic + self.rotational_kinetic + self.potential + self.force_potential
    }

    /// Kinetic energy, of centres of mass and of rotation \[J\].
    pub fn kinetic(&self) -> f64 {
        self.linear_kinetic + self.rotational_kinetic
    }

    /// Energy in gravity, in force components and in springs of joints \[J\].
    pub fn all_potential(&self) -> f64 {
        self.potential + self.force_potential
    }

    /// Adds the sums over bodies that come later in order.
    fn append(&mut self, later: &Self) {
        self.linear_kinetic += later.linear_kinetic;
        self.rotational_kinetic += later.rotational_kinetic;
        self.potential += later.potential;
        self.force_potential += later.force_potential;
        self.linear_momentum += later.linear_momentum;
        self.angular_momentum += later.angular_momentum;
        self.non_finite = self.non_finite.or(later.non_finite);
    }
}

/// Sums over bodies, one after the other.
struct Sums {
    around: ForceContext,
    bodies: MeasuredBodies,
    force_potential: f64,
    non_finite: Option<Entity>,
}

impl Sums {
    fn new(around: ForceContext) -> Self {
        let bodies = MeasuredBodies::new(dvec3(around.gravity));
        Self { around, bodies, force_potential: 0.0, non_finite: None }
    }

    fn add(&mut self, (entity, (moving, own, laws)): (Entity, Measured<'_>)) {
        let ((pose, momentum, mass), (inertia, axes, scale, wind)) = (moving, own);
        let state = State::new(pose, momentum);
        if !state.is_finite() {
            self.non_finite = self.non_finite.or(Some(entity));
            return;
        }
        if registry::is_any(&laws) {
            let inertia = inertia.map(|inertia| Moments::new(inertia, axes));
            let constants = Constants { mass: mass.kilograms(), inertia, damping: None };
            let context = ForceContext { wind: wind.map_or(Vec3::ZERO, |wind| wind.0), ..self.around };
            let seen = BodyState::new((0.0, 0.0), (&constants, &context), &state);
            self.force_potential += registry::potential(&laws, &seen);
        }
        self.bodies.push(moving, (inertia, axes), scale);
    }

    fn totals(self) -> Totals {
        Totals { force_potential: self.force_potential, non_finite: self.non_finite, ..self.bodies.totals() }
    }
}
