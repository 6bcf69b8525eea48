//! The systems of a step: what each does to a chunk of bodies, and each as a function of its own.

use hecs::World;
use tumble_math::lane::Vec3 as LaneVec3;

use crate::columns::{Chunk, for_each_chunk};
use crate::components::{InverseInertia, Momentum, Pose, PreviousPose, Velocity, Work, Wrench};
use crate::force_laws::ForceLaws;
use crate::integrator::Integrator;
use crate::integrators::{ConstantForce, MoserVeselov, NoAccount, RungeKutta4, Scheme, SemiImplicitEuler};
use crate::law_forces::{LawForces, WorkAccount, kinetic_energy};
use crate::math::{Real, Vec3};
use crate::settings::Settings;
use crate::state::{Constants, Moments, Rates, State};

/// Generators and applied forces to [`Wrench`](crate::Wrench): adds to each moving body's wrench the forces of what acts on it
/// all the time, which is gravity, scaled by its [`GravityScale`](crate::GravityScale).
///
/// [`Damping`](crate::Damping) is not among them: it is a decay, which [`integrate`] treats exactly.
pub fn accumulate_forces(world: &mut World, settings: &Settings) {
    for_each_chunk(world, &ForceLaws::default(), |mut bodies| accumulate_forces_of(&mut bodies, settings));
}

/// [`Wrench`], [`Momentum`], [`Pose`] to [`Momentum`], [`Pose`]: advances the state by `settings.dt` with the chosen [`Integrator`], in
/// `settings.substeps` equal parts, and zeroes the wrench it has consumed.
pub fn integrate(world: &mut World, settings: &Settings) {
    integrate_under_laws(world, settings, &ForceLaws::default(), 0.0);
}

/// [`integrate`] under force laws, which are evaluated at every stage; `time` \[s\] is the simulated time at the start of the step.
pub fn integrate_under_laws(world: &mut World, settings: &Settings, laws: &ForceLaws, time: f64) {
    for_each_chunk(world, laws, |mut bodies| integrate_bodies(&mut bodies, settings, time));
}

/// [`Pose`](crate::Pose), [`Momentum`](crate::Momentum), [`Mass`](crate::Mass), [`Inertia`](crate::Inertia) to [`Velocity`] and
/// [`InverseInertia`], on the moving bodies that have them: `v = P/M`, `I^-1 = R I_body^-1 R^T`, `w = I^-1 L`.
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

pub(crate) fn integrate_bodies(bodies: &mut Chunk<'_>, settings: &Settings, time: f64) {
    match settings.integrator {
        Integrator::SemiImplicitEuler => integrate_with::<SemiImplicitEuler<Real>>(bodies, settings, time),
        Integrator::RungeKutta4 => integrate_with::<RungeKutta4<Real>>(bodies, settings, time),
        Integrator::MoserVeselov => integrate_with::<MoserVeselov<Real>>(bodies, settings, time),
    }
}

fn integrate_with<S: Scheme<Real>>(bodies: &mut Chunk<'_>, settings: &Settings, time: f64) {
    if bodies.laws.is_empty() && bodies.work.is_none() {
        integrate_under_constant_forces::<S>(bodies, settings);
    } else {
        integrate_under_varying_forces::<S>(bodies, settings, time);
    }
    bodies.wrench.fill(Wrench::default());
}

fn integrate_under_constant_forces<S: Scheme<Real>>(bodies: &mut Chunk<'_>, settings: &Settings) {
    let h = settings.substep();
    for i in 0..bodies.len() {
        let scheme = S::new(&bodies.constants(i), h);
        let forces = ConstantForce(bodies.wrench[i].into());
        let mut state = bodies.state(i);
        for _ in 0..settings.substeps {
            state = scheme.advance(state, &forces, &mut NoAccount);
        }
        bodies.set_state(i, state);
    }
}

fn integrate_under_varying_forces<S: Scheme<Real>>(bodies: &mut Chunk<'_>, settings: &Settings, time: f64) {
    let h = settings.substep();
    for i in 0..bodies.len() {
        let constants = bodies.constants(i);
        let scheme = S::new(&constants, h);
        let gravity = bodies.gravity(i, settings);
        let (start, laws, row) = (bodies.state(i), bodies.laws, bodies.first_row + i);
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
        bodies.set_state(i, state);
        if let Some(column) = bodies.work.as_deref_mut() {
            let change = kinetic_energy(&constants, &state) - kinetic_energy(&constants, &start);
            work.integrator = change - work.total();
            column[i] += work;
        }
    }
}

pub(crate) fn update_derived_of(bodies: &mut Chunk<'_>) {
    if bodies.velocity.is_none() && bodies.inverse_inertia.is_none() {
        return;
    }
    for i in 0..bodies.len() {
        let (velocity, inverse_inertia) = derived(&bodies.constants(i), &bodies.state(i));
        if let Some(column) = bodies.velocity.as_deref_mut() {
            column[i] = velocity;
        }
        if let Some(column) = bodies.inverse_inertia.as_deref_mut() {
            column[i] = inverse_inertia;
        }
    }
}

/// `v = P/M`, `I^-1 = R I_body^-1 R^T` and `w = I^-1 L` of one body.
#[inline(always)]
pub(crate) fn derived(constants: &Constants<Real>, state: &State<Real>) -> (Velocity, InverseInertia) {
    let inverse_inertia = constants.inertia.map_or(InverseInertia::default(), |inertia| world_inverse(&inertia, state));
    let linear = constants.velocity(state.linear).into();
    (Velocity { linear, angular: inverse_inertia * Vec3::from(state.angular) }, inverse_inertia)
}

/// `R diag(1/I) R^T`: the sum over the principal axes `r` in the world of `r r^T/I`.
#[inline(always)]
fn world_inverse(inertia: &Moments<Real>, state: &State<Real>) -> InverseInertia {
    let [a, b, c] = inertia.world_axes(state.orientation);
    let m = inertia.inverse_moments;
    let sum = |p: LaneVec3<Real>, q: LaneVec3<Real>, r: LaneVec3<Real>| p * m.x + q * m.y + r * m.z;
    let other = |v: LaneVec3<Real>| LaneVec3::new(v.y * v.z, v.z * v.x, v.x * v.y);
    InverseInertia {
        diagonal: sum(a.scale(a), b.scale(b), c.scale(c)).into(),
        off_diagonal: sum(other(a), other(b), other(c)).into(),
    }
}

impl Chunk<'_> {
    /// The force of gravity on a body \[N\].
    #[inline(always)]
    fn gravity(&self, i: usize, settings: &Settings) -> Vec3 {
        let scale = self.gravity_scale.map_or(1.0, |scales| scales[i].0);
        settings.gravity * (self.mass[i].kilograms() * scale)
    }

    #[inline(always)]
    fn constants(&self, i: usize) -> Constants<Real> {
        Constants {
            mass: self.mass[i].kilograms(),
            inertia: self.inertia.map(|inertia| Moments::new(&inertia[i], self.axes.map(|axes| &axes[i]))),
            damping: self.damping.map(|damping| Rates { linear: damping[i].linear, angular: damping[i].angular }),
        }
    }

    #[inline(always)]
    fn state(&self, i: usize) -> State<Real> {
        State::new(&self.pose[i], &self.momentum[i])
    }

    #[inline(always)]
    fn set_state(&mut self, i: usize, state: State<Real>) {
        self.pose[i] = Pose { position: state.position.into(), orientation: state.orientation.into() };
        self.momentum[i] = Momentum { linear: state.linear.into(), angular: state.angular.into() };
    }
}
