//! The systems of a step: what each does to a chunk of bodies, and each as a function of its own.

use std::marker::PhantomData;

use hecs::World;
use tumble_math::lane::Vec3 as LaneVec3;

use crate::columns::{Chunk, for_each_chunk};
use crate::components::{PreviousPose, Work, Wrench};
use crate::derived::derived;
use crate::force_laws::ForceLaws;
use crate::integrator::Integrator;
use crate::integrators::{AnyWidth, ConstantForce, MoserVeselov, NoAccount, RungeKutta4, Scheme, SemiImplicitEuler};
use crate::law_forces::{LawForces, TileLawForces, WorkAccount, depend_on_velocity};
use crate::math::{Real, Vec3};
use crate::settings::Settings;
use crate::simd::{Kernel, Tile, dispatch};
use crate::state::{Force, State};
use crate::tile::splat;
use crate::totals::KineticEnergy;

/// Generators and applied forces to [`Wrench`](crate::Wrench): adds to each moving body's wrench the forces of what acts on it
/// all the time, which is gravity, scaled by its [`GravityScale`](crate::GravityScale).
///
/// [`Damping`](crate::Damping) is not among them: it is a decay, which [`integrate`] treats exactly.
pub fn accumulate_forces(world: &mut World, settings: &Settings) {
    for_each_chunk(world, &ForceLaws::default(), |bodies| accumulate_forces_of(bodies, settings));
}

/// [`Wrench`], [`Momentum`](crate::Momentum), [`Pose`](crate::Pose) to the same: advances the state by `settings.dt` with the chosen [`Integrator`], in
/// `settings.substeps` equal parts, and zeroes the wrench it has consumed.
pub fn integrate(world: &mut World, settings: &Settings) {
    integrate_under_laws(world, settings, &ForceLaws::default(), 0.0);
}

/// [`integrate`] under force laws, which are evaluated at every stage; `time` \[s\] is the simulated time at the start of the step.
pub fn integrate_under_laws(world: &mut World, settings: &Settings, laws: &ForceLaws, time: f64) {
    for_each_chunk(world, laws, |bodies| integrate_bodies(bodies, settings, time));
}

/// [`Pose`](crate::Pose), [`Momentum`](crate::Momentum), [`Mass`](crate::Mass), [`Inertia`](crate::Inertia) to
/// [`Velocity`](crate::Velocity) and [`InverseInertia`](crate::InverseInertia), on the moving bodies that have them: `v = P/M`, `I^-1 = R I_body^-1 R^T`, `w = I^-1 L`.
pub fn update_derived(world: &mut World) {
    for_each_chunk(world, &ForceLaws::default(), update_derived_of);
}

pub(crate) fn remember_poses(bodies: &mut Chunk<'_>) {
    if let Some(previous) = bodies.previous_pose.as_deref_mut() {
        for (previous, pose) in previous.iter_mut().zip(&*bodies.pose) {
            *previous = PreviousPose(*pose);
        }
    }
}

pub(crate) fn accumulate_forces_of(bodies: &mut Chunk<'_>, settings: &Settings) {
    crate::scope::scope!("tumble::accumulate_forces");
    for i in 0..bodies.len() {
        bodies.wrench[i].force += bodies.gravity_on(i, settings);
    }
}

impl Chunk<'_> {
    /// The force of gravity on a body \[N\].
    fn gravity_on(&self, i: usize, settings: &Settings) -> Vec3 {
        self.gravity(i, self.mass[i].kilograms(), splat(settings.gravity)).into()
    }
}

/// All systems of some steps, of bodies whose forces are the same at every stage: the bodies stay in registers from the first system of the first step
/// to the last of the last.
pub(crate) fn step_under_constant_forces(bodies: &mut Chunk<'_>, settings: &Settings, steps: u32) {
    crate::scope::scope!("tumble::step_chunk");
    advance(bodies, settings, Extent::Steps(steps));
}

pub(crate) fn integrate_bodies(bodies: &mut Chunk<'_>, settings: &Settings, time: f64) {
    crate::scope::scope!("tumble::integrate");
    if bodies.have_constant_forces() {
        return advance(bodies, settings, Extent::Integration);
    }
    match settings.integrator {
        Integrator::SemiImplicitEuler => integrate_under_laws_of::<SemiImplicitEuler<()>>(bodies, settings, time),
        Integrator::RungeKutta4 => integrate_under_laws_of::<RungeKutta4<()>>(bodies, settings, time),
        Integrator::MoserVeselov => integrate_under_laws_of::<MoserVeselov<()>>(bodies, settings, time),
    }
}

fn integrate_under_laws_of<S: AnyWidth>(bodies: &mut Chunk<'_>, settings: &Settings, time: f64) {
    if bodies.work.is_some() {
        integrate_with_account::<S::Of<Real>>(bodies, settings, time);
        bodies.wrench.fill(Wrench::default());
    } else {
        bodies.in_whole_tiles(|bodies| dispatch(&mut UnderLaws { bodies, settings, time, scheme: PhantomData::<S> }));
    }
}

/// Integrates bodies on which force laws act, a tile at a time.
struct UnderLaws<'k, 'a, S> {
    bodies: &'k mut Chunk<'a>,
    settings: &'k Settings,
    time: f64,
    scheme: PhantomData<S>,
}

impl<S: AnyWidth> Kernel for UnderLaws<'_, '_, S> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.bodies.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (bodies, h) = (&mut *self.bodies, self.settings.substep());
        let constants = bodies.constants::<T>(i);
        let of_bodies = bodies.constants_of_each::<T>(i);
        let scheme = S::Of::<T>::new(&constants, T::splat(h.into()));
        let (laws, row) = (bodies.laws, bodies.first_row + i);
        let mut forces = TileLawForces {
            constants: &constants,
            of_bodies: &of_bodies[..T::WIDTH.min(laws.bodies_from(row))],
            constant: bodies.take_force::<T>(i),
            laws,
            row,
            time: self.time,
            depends_on_velocity: depend_on_velocity::<T>(laws, row),
        };
        let mut state = bodies.state::<T>(i);
        for substep in 0..self.settings.substeps {
            forces.time = self.time + f64::from(substep) * f64::from(h);
            state = scheme.advance(state, &forces, &mut NoAccount);
        }
        bodies.set_state(i, &state);
    }
}

/// How much of how many steps is done.
#[derive(Clone, Copy)]
enum Extent {
    /// The integration of one step, under the wrenches as they are.
    Integration,
    /// All systems of so many steps.
    Steps(u32),
}

fn advance(bodies: &mut Chunk<'_>, settings: &Settings, extent: Extent) {
    match settings.integrator {
        Integrator::SemiImplicitEuler => advance_with::<SemiImplicitEuler<()>>(bodies, settings, extent),
        Integrator::RungeKutta4 => advance_with::<RungeKutta4<()>>(bodies, settings, extent),
        Integrator::MoserVeselov => advance_with::<MoserVeselov<()>>(bodies, settings, extent),
    }
}

fn advance_with<S: AnyWidth>(bodies: &mut Chunk<'_>, settings: &Settings, extent: Extent) {
    bodies.in_whole_tiles(|bodies| {
        dispatch(&mut UnderConstantForces { bodies, settings, extent, scheme: PhantomData::<S> });
    });
}

/// Advances bodies whose forces are the same at every stage, a tile at a time.
struct UnderConstantForces<'k, 'a, S> {
    bodies: &'k mut Chunk<'a>,
    settings: &'k Settings,
    extent: Extent,
    scheme: PhantomData<S>,
}

impl<S: AnyWidth> Kernel for UnderConstantForces<'_, '_, S> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.bodies.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (bodies, settings) = (&mut *self.bodies, self.settings);
        let constants = bodies.constants::<T>(i);
        let scheme = S::Of::<T>::new(&constants, T::splat(settings.substep().into()));
        let mut force = bodies.take_force::<T>(i);
        let mut state = bodies.state::<T>(i);
        match self.extent {
            Extent::Integration => state = substeps(&scheme, state, force, settings),
            Extent::Steps(steps) => {
                let gravity = bodies.gravity::<T>(i, constants.mass, splat(settings.gravity));
                force.force = force.force + gravity;
                for step in 1..=steps {
                    if step == steps {
                        bodies.set_previous_pose(i, &state);
                    }
                    state = substeps(&scheme, state, force, settings);
                    // The wrench is consumed, and gravity added to nothing, as a step of its own does it.
                    force = Force { force: LaneVec3::zero() + gravity, torque: LaneVec3::zero() };
                }
                if bodies.velocity.is_some() || bodies.inverse_inertia.is_some() {
                    bodies.set_derived(i, &derived(&constants, &state));
                }
            }
        }
        bodies.set_state(i, &state);
    }
}

#[inline(always)]
fn substeps<T: Tile, S: Scheme<T>>(scheme: &S, mut state: State<T>, force: Force<T>, settings: &Settings) -> State<T> {
    for _ in 0..settings.substeps {
        state = scheme.advance(state, &ConstantForce(force), &mut NoAccount);
    }
    state
}

fn integrate_with_account<S: Scheme<Real>>(bodies: &mut Chunk<'_>, settings: &Settings, time: f64) {
    let h = settings.substep();
    for i in 0..bodies.len() {
        let constants = bodies.constants::<Real>(i);
        let scheme = S::new(&constants, h);
        let gravity = bodies.gravity_on(i, settings);
        let (start, laws, row) = (bodies.state::<Real>(i), bodies.laws, bodies.first_row + i);
        let mut work = Work::default();
        let mut state = start;
        for substep in 0..settings.substeps {
            let time = time + f64::from(substep) * f64::from(h);
            let forces = LawForces { constants: &constants, wrench: bodies.wrench[i], laws, row, time };
            let mut account = WorkAccount { work: &mut work, forces: &forces, gravity };
            state = scheme.advance(state, &forces, &mut account);
        }
        bodies.set_state(i, &state);
        if let Some(column) = bodies.work.as_deref_mut() {
            let change = KineticEnergy::of(&constants, &state).sum() - KineticEnergy::of(&constants, &start).sum();
            work.integrator = change - work.total();
            column[i] += work;
        }
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
