//! The systems of a step: what each does to a chunk of bodies, and each as a function of its own.

use hecs::World;

use crate::columns::{Chunk, for_each_chunk};
use crate::components::{PreviousPose, Work, Wrench};
use crate::derived::derived;
use crate::force_laws::ForceLaws;
use crate::integrator::Integrator;
use crate::integrators::{ConstantForce, MoserVeselov, NoAccount, RungeKutta4, Scheme, SemiImplicitEuler};
use crate::law_forces::{LawForces, WorkAccount};
use crate::math::{Real, Vec3};
use crate::settings::Settings;
use crate::simd::{Kernel, Tile, dispatch};
use crate::tile::store;
use crate::totals::KineticEnergy;

/// Generators and applied forces to [`Wrench`](crate::Wrench): adds to each moving body's wrench the forces of what acts on it
/// all the time, which is gravity, scaled by its [`GravityScale`](crate::GravityScale).
///
/// [`Damping`](crate::Damping) is not among them: it is a decay, which [`integrate`] treats exactly.
pub fn accumulate_forces(world: &mut World, settings: &Settings) {
    for_each_chunk(world, &ForceLaws::default(), |mut bodies| accumulate_forces_of(&mut bodies, settings));
}

/// [`Wrench`], [`Momentum`](crate::Momentum), [`Pose`](crate::Pose) to the same: advances the state by `settings.dt` with the chosen [`Integrator`], in
/// `settings.substeps` equal parts, and zeroes the wrench it has consumed.
pub fn integrate(world: &mut World, settings: &Settings) {
    integrate_under_laws(world, settings, &ForceLaws::default(), 0.0);
}

/// [`integrate`] under force laws, which are evaluated at every stage; `time` \[s\] is the simulated time at the start of the step.
pub fn integrate_under_laws(world: &mut World, settings: &Settings, laws: &ForceLaws, time: f64) {
    for_each_chunk(world, laws, |mut bodies| integrate_bodies(&mut bodies, settings, time));
}

/// [`Pose`](crate::Pose), [`Momentum`](crate::Momentum), [`Mass`](crate::Mass), [`Inertia`](crate::Inertia) to
/// [`Velocity`](crate::Velocity) and [`InverseInertia`](crate::InverseInertia), on the moving bodies that have them: `v = P/M`, `I^-1 = R I_body^-1 R^T`, `w = I^-1 L`.
pub fn update_derived(world: &mut World) {
    for_each_chunk(world, &ForceLaws::default(), |mut bodies| update_derived_of(&mut bodies));
}

pub(crate) fn remember_poses(bodies: &mut Chunk<'_>) {
    if let Some(previous) = bodies.previous_pose.as_deref_mut() {
        for (previous, pose) in previous.iter_mut().zip(&*bodies.pose) {
            *previous = PreviousPose(*pose);
        }
    }
}

pub(crate) fn accumulate_forces_of(bodies: &mut Chunk<'_>, settings: &Settings) {
    for i in 0..bodies.len() {
        bodies.wrench[i].force += bodies.gravity(i, settings);
    }
}

impl Chunk<'_> {
    /// The force of gravity on a body \[N\].
    #[inline(always)]
    fn gravity(&self, i: usize, settings: &Settings) -> Vec3 {
        let scale = self.gravity_scale.map_or(1.0, |scales| scales[i].0);
        settings.gravity * (self.mass[i].kilograms() * scale)
    }
}

pub(crate) fn integrate_bodies(bodies: &mut Chunk<'_>, settings: &Settings, time: f64) {
    if bodies.laws.is_empty() && bodies.work.is_none() {
        dispatch(UnderConstantForces { bodies, settings });
    } else {
        match settings.integrator {
            Integrator::SemiImplicitEuler => {
                integrate_under_varying_forces::<SemiImplicitEuler<Real>>(bodies, settings, time);
            }
            Integrator::RungeKutta4 => integrate_under_varying_forces::<RungeKutta4<Real>>(bodies, settings, time),
            Integrator::MoserVeselov => integrate_under_varying_forces::<MoserVeselov<Real>>(bodies, settings, time),
        }
    }
    bodies.wrench.fill(Wrench::default());
}

/// Integrates bodies whose forces are the same at every stage: a tile at a time, all substeps of it.
struct UnderConstantForces<'k, 'a> {
    bodies: &'k mut Chunk<'a>,
    settings: &'k Settings,
}

impl Kernel for UnderConstantForces<'_, '_> {
    #[inline(always)]
    fn run<T: Tile>(self) {
        match self.settings.integrator {
            Integrator::SemiImplicitEuler => self.run_with::<T, SemiImplicitEuler<T>, SemiImplicitEuler<Real>>(),
            Integrator::RungeKutta4 => self.run_with::<T, RungeKutta4<T>, RungeKutta4<Real>>(),
            Integrator::MoserVeselov => self.run_with::<T, MoserVeselov<T>, MoserVeselov<Real>>(),
        }
    }
}

impl UnderConstantForces<'_, '_> {
    /// Whole tiles, and one by one what is left of the chunk.
    #[inline(always)]
    fn run_with<T: Tile, S: Scheme<T>, One: Scheme<Real>>(self) {
        let whole = self.bodies.len() - self.bodies.len() % T::WIDTH;
        let mut i = 0;
        while i < whole {
            advance_tile::<T, S>(self.bodies, i, self.settings);
            i += T::WIDTH;
        }
        while i < self.bodies.len() {
            advance_tile::<Real, One>(self.bodies, i, self.settings);
            i += 1;
        }
    }
}

#[inline(always)]
fn advance_tile<T: Tile, S: Scheme<T>>(bodies: &mut Chunk<'_>, i: usize, settings: &Settings) {
    let scheme = S::new(&bodies.constants::<T>(i), T::splat(settings.substep().into()));
    let forces = ConstantForce(bodies.force::<T>(i));
    let mut state = bodies.state::<T>(i);
    for _ in 0..settings.substeps {
        state = scheme.advance(state, &forces, &mut NoAccount);
    }
    bodies.set_state(i, &state);
}

fn integrate_under_varying_forces<S: Scheme<Real>>(bodies: &mut Chunk<'_>, settings: &Settings, time: f64) {
    let h = settings.substep();
    for i in 0..bodies.len() {
        let constants = bodies.constants::<Real>(i);
        let scheme = S::new(&constants, h);
        let gravity = bodies.gravity(i, settings);
        let (start, laws, row) = (bodies.state::<Real>(i), bodies.laws, bodies.first_row + i);
        let mut work = Work::default();
        let mut state = start;
        for substep in 0..settings.substeps {
            let time = time + f64::from(substep) * f64::from(h);
            let forces = LawForces { constants: &constants, wrench: bodies.wrench[i], laws, row, time };
            state = if bodies.work.is_some() {
                let mut account = WorkAccount { work: &mut work, forces: &forces, gravity };
                scheme.advance(state, &forces, &mut account)
            } else {
                scheme.advance(state, &forces, &mut NoAccount)
            };
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
    if bodies.velocity.is_some() || bodies.inverse_inertia.is_some() {
        dispatch(Derive { bodies });
    }
}

/// Computes velocities and world-frame inverse inertias, a tile at a time.
struct Derive<'k, 'a> {
    bodies: &'k mut Chunk<'a>,
}

impl Kernel for Derive<'_, '_> {
    #[inline(always)]
    fn run<T: Tile>(self) {
        let whole = self.bodies.len() - self.bodies.len() % T::WIDTH;
        let mut i = 0;
        while i < whole {
            derive_tile::<T>(self.bodies, i);
            i += T::WIDTH;
        }
        while i < self.bodies.len() {
            derive_tile::<Real>(self.bodies, i);
            i += 1;
        }
    }
}

#[inline(always)]
fn derive_tile<T: Tile>(bodies: &mut Chunk<'_>, i: usize) {
    let derived = derived(&bodies.constants::<T>(i), &bodies.state::<T>(i));
    if let Some(column) = bodies.velocity.as_deref_mut() {
        let column = &mut column[i..i + T::WIDTH];
        store(derived.linear, |body, x| column[body].linear = x);
        store(derived.angular, |body, x| column[body].angular = x);
    }
    if let Some(column) = bodies.inverse_inertia.as_deref_mut() {
        let column = &mut column[i..i + T::WIDTH];
        store(derived.diagonal, |body, x| column[body].diagonal = x);
        store(derived.off_diagonal, |body, x| column[body].off_diagonal = x);
    }
}
