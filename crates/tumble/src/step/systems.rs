//! The systems of a step: what each does to a chunk of bodies, and each as a function of its own.

use hecs::World;

use crate::clock::Clock;
use crate::components::Wrenches;
use crate::components::{PreviousPose, Wrench};
use crate::forces::registry::{ForceLaws, Laws};
use crate::forces::under_laws::for_each_chunk_under;
use crate::integrators::derived::derived;
use crate::integrators::kinematic;
use crate::math::{Real, Vec3};
use crate::settings::Settings;
use crate::simd::{Kernel, Tile, dispatch};
use crate::solver::constrained_bodies::ConstrainedBodies;
use crate::step::advance::{Extent, advance};
use crate::step::interacting::{InteractingWorld, KinematicBodies, integrate_interacting};
use crate::step::interactions::Interactions;
use crate::step::phase_times::PhaseTimes;
use crate::step::population::Population;
use crate::storage::body_index::Slot;
use crate::storage::chunk::{Chunk, RowOrder, for_each_chunk};
use crate::storage::tile_io::splat;

/// Adds to each moving body's [`Wrench`] the force that is the same at every stage of a step:
/// gravity [m/s^2], scaled by its [`GravityScale`](crate::GravityScale).
///
/// Force components that depend on the state, such as [`Drag`](crate::Drag), are evaluated in
/// [`integrate`], as laws are; so is [`Damping`](crate::Damping), a decay that is treated exactly.
///
/// ```
/// # use tumble::{accumulate_forces, prelude::*};
/// # let mut world = hecs::World::new();
/// let body = RigidBody::new(Shape::Point).mass(2.0).build()?.spawn(&mut world);
/// accumulate_forces(&mut world, Vec3::NEG_Y * 9.81);
/// assert_eq!(world.get::<&Wrench>(body)?.force, Vec3::Y * -19.62);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn accumulate_forces(world: &mut World, gravity: Vec3) {
    for_each_chunk(world, |bodies| accumulate_forces_of(bodies, gravity));
}

/// Advances [`Momentum`](crate::Momentum) and [`Pose`](crate::Pose) of the moving bodies by
/// `settings.dt`, and sets the [`Wrench`] that it has consumed to zero.
///
/// It takes the chosen [`Integrator`](crate::Integrator) through `settings.substeps` equal parts,
/// under the wrench, the force components and the forces between bodies. Gravity is not in it, but
/// in what
/// [`accumulate_forces`] adds; `settings.gravity` is that of [`Buoyancy`](crate::Buoyancy) and of
/// accounts. Bodies that touch are pushed apart, but in each call as if they had
/// not touched before: for piles take a [`Simulation`](crate::Simulation), which keeps what held
/// them.
///
/// ```
/// # use tumble::{integrate, prelude::*};
/// # let mut world = hecs::World::new();
/// let body = RigidBody::new(Shape::Point).mass(2.0).build()?.spawn(&mut world);
/// world.get::<&mut Wrench>(body)?.add_force(Vec3::X * 4.0);
/// integrate(&mut world, &Settings::default().with_dt(0.5));
/// assert_eq!(world.get::<&Momentum>(body)?.linear, Vec3::X * 2.0);
/// assert_eq!(world.get::<&Wrench>(body)?.force, Vec3::ZERO);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn integrate(world: &mut World, settings: &Settings) {
    integrate_under_laws(world, settings, &ForceLaws::default(), 0.0);
}

/// [`integrate`] under force laws, which are evaluated at every stage; `time` \[s\] is the
/// simulated time at the start of the step.
///
/// ```
/// # use tumble::{ForceLaws, integrate_under_laws, prelude::*};
/// /// Grows by a newton a second.
/// struct Thrust;
///
/// impl ForceLaw for Thrust {
///     fn wrench(&self, state: &BodyState<'_>) -> Wrench {
///         Wrench { force: Vec3::X * state.time as Real, torque: Vec3::ZERO }
///     }
/// }
///
/// # let mut world = hecs::World::new();
/// let body = RigidBody::new(Shape::Point).mass(1.0).build()?.spawn(&mut world);
/// let mut laws = ForceLaws::default();
/// laws.add_global(Thrust);
/// integrate_under_laws(&mut world, &Settings::default().with_dt(0.5), &laws, 10.0);
/// // The integral of t from 10 to 10.5.
/// assert!((world.get::<&Momentum>(body)?.linear.x - 5.125).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn integrate_under_laws(world: &mut World, settings: &Settings, laws: &ForceLaws, time: f64) {
    let population = Population::of(world, laws);
    if population.interacts() {
        let mut interactions = Interactions::default();
        interactions.update(world);
        interactions.begin_step();
        let interacting = InteractingWorld::of_known(world, settings, laws, &mut interactions, Clock::at(time));
        integrate_interacting(&mut [interacting], None, 0, KinematicBodies::Stay, &mut PhaseTimes::start(None));
    } else {
        for_each_chunk_under(world, (laws, population.are_under_laws()), |bodies, laws| {
            integrate_bodies(bodies, laws, settings, time, Wrenches::Consumed);
        });
    }
}

/// Derives [`Velocity`](crate::Velocity) and [`InverseInertia`](crate::InverseInertia) of the
/// moving bodies that have them from their state: `v = P/M`, `I^-1 = R I_body^-1 R^T`,
/// `w = I^-1 L`.
///
/// ```
/// # use tumble::{update_derived, prelude::*};
/// # let mut world = hecs::World::new();
/// let body = RigidBody::new(Shape::Point).mass(2.0).build()?.spawn(&mut world);
/// world.get::<&mut Momentum>(body)?.apply_impulse(Vec3::X * 4.0);
/// update_derived(&mut world);
/// assert_eq!(world.get::<&Velocity>(body)?.linear, Vec3::X * 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn update_derived(world: &mut World) {
    for_each_chunk(world, update_derived_of);
}

/// Copies the [`Pose`](crate::Pose) of the moving bodies to their
/// [`PreviousPose`](crate::PreviousPose), where they have one.
///
/// ```
/// # use tumble::{remember_poses, prelude::*};
/// # let mut world = hecs::World::new();
/// let body = RigidBody::new(Shape::Point)
///     .mass(2.0)
///     .build()?
///     .spawn_with(&mut world, (PreviousPose::default(),));
/// world.get::<&mut Pose>(body)?.position = Vec3::X;
/// remember_poses(&mut world);
/// assert_eq!(world.get::<&PreviousPose>(body)?.0.position, Vec3::X);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn remember_poses(world: &mut World) {
    for_each_chunk(world, remember_poses_of);
}

/// Moves the kinematic bodies, those with a [`Velocity`](crate::Velocity) and no
/// [`Momentum`](crate::Momentum), by a step of `dt` \[s\], and sets their
/// [`PreviousPose`](crate::PreviousPose), where they have one.
///
/// ```
/// # use tumble::{move_kinematic_bodies, prelude::*};
/// # let mut world = hecs::World::new();
/// let lift = RigidBody::new(Shape::Point)
///     .linear_velocity(Vec3::Y)
///     .kinematic()
///     .build()?
///     .spawn(&mut world);
/// move_kinematic_bodies(&mut world, 0.5);
/// assert_eq!(world.get::<&Pose>(lift)?.position, Vec3::Y * 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn move_kinematic_bodies(world: &mut World, dt: Real) {
    kinematic::move_kinematic_bodies(world, dt, 1);
}

pub(crate) fn remember_poses_of(bodies: &mut Chunk<'_>) {
    if let Some(previous) = bodies.previous_pose.as_deref_mut() {
        for (previous, pose) in previous.iter_mut().zip(&*bodies.pose) {
            *previous = PreviousPose(*pose);
        }
    }
}

pub(crate) fn accumulate_forces_of(bodies: &mut Chunk<'_>, gravity: Vec3) {
    accumulate_forces_where(bodies, gravity, |_| true);
}

/// The same for the bodies of some rows.
pub(crate) fn accumulate_forces_where(bodies: &mut Chunk<'_>, gravity: Vec3, acts: impl Fn(usize) -> bool) {
    crate::scope::scope!("tumble::accumulate_forces");
    (0..bodies.len()).filter(|i| acts(*i)).for_each(|i| bodies.accumulate_gravity(i, gravity));
}

impl Chunk<'_> {
    /// Adds gravity to the wrench of a body.
    pub(crate) fn accumulate_gravity(&mut self, i: usize, gravity: Vec3) {
        self.wrench[i].force += self.gravity_on(i, gravity);
    }

    /// The force of gravity on a body \[N\].
    pub(crate) fn gravity_on(&self, i: usize, gravity: Vec3) -> Vec3 {
        self.gravity(i, self.mass[i].kilograms(), splat(gravity)).into()
    }
}

/// All systems of some steps, of bodies that nothing couples: the bodies stay in registers from
/// the first system of the first step to the last of the last. `time_of_step` is the simulated
/// time \[s\] at the start of each.
pub(crate) fn step_chunk(
    bodies: &mut Chunk<'_>,
    laws: Laws<'_>,
    settings: &Settings,
    steps: u32,
    time_of_step: &dyn Fn(u32) -> f64,
) {
    crate::scope::scope!("tumble::step_chunk");
    advance(bodies, laws, settings, Extent::Steps(steps), time_of_step);
}

/// The integration of one step under the wrenches as they are; `time` \[s\] is that at its start.
pub(crate) fn integrate_bodies(
    bodies: &mut Chunk<'_>,
    laws: Laws<'_>,
    settings: &Settings,
    time: f64,
    wrenches: Wrenches,
) {
    crate::scope::scope!("tumble::integrate");
    advance(bodies, laws, settings, Extent::Integration(wrenches), &|_| time);
}

/// [`integrate_bodies`] for those of a chunk that no constraint acts on, with the wrenches of all;
/// `constrained` gives the slots of its archetype.
pub(crate) fn integrate_unconstrained(
    bodies: &mut Chunk<'_>,
    laws: Laws<'_>,
    settings: &Settings,
    (time, wrenches): (f64, Wrenches),
    constrained: Option<(&ConstrainedBodies, &[Slot])>,
) {
    let Some((constrained, slots)) = constrained.filter(|(_, slots)| !slots.is_empty()) else {
        return integrate_bodies(bodies, laws, settings, time, wrenches);
    };
    let slots = &slots[bodies.first_row..][..bodies.len()];
    let is_unconstrained = |row: usize| !constrained.contains(slots[row]) && !constrained.sleepers.has(slots[row]);
    let rows = if laws.is_empty() { RowOrder::Any } else { RowOrder::OfArchetype };
    bodies.for_included(rows, is_unconstrained, |bodies| integrate_bodies(bodies, laws, settings, time, wrenches));
    if wrenches == Wrenches::Consumed {
        // What is added to a sleeping body, after it could wake it, waits for the next step.
        let awake = bodies.wrench.iter_mut().zip(slots).filter(|(_, slot)| !constrained.sleepers.has(**slot));
        awake.for_each(|(wrench, _)| *wrench = Wrench::default());
    }
}

pub(crate) fn update_derived_of(bodies: &mut Chunk<'_>) {
    crate::scope::scope!("tumble::update_derived");
    if bodies.velocity.is_some() || bodies.inverse_inertia.is_some() {
        bodies.in_whole_tiles(|bodies| dispatch(&mut Derive { bodies }));
    }
}

/// Computes velocities and world-frame inverse inertias, a tile at a time.
struct Derive<'k, 'a> {
    bodies: &'k mut Chunk<'a>,
}

impl Kernel for Derive<'_, '_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.bodies.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let derived = derived(&self.bodies.constants::<T>(i), &self.bodies.state::<T>(i));
        self.bodies.set_derived(i, &derived);
    }
}
