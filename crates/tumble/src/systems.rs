//! The systems of a step: what each does to a chunk of bodies, and each as a function of its own.

use hecs::World;
use tumble_math::lane::Vec3 as LaneVec3;

use crate::columns::{Chunk, for_each_chunk};
use crate::components::{InverseInertia, Momentum, Pose, PreviousPose, Velocity};
use crate::integrator::Integrator;
use crate::integrators::{MoserVeselov, RungeKutta4, Scheme, SemiImplicitEuler};
use crate::math::{Real, Vec3};
use crate::settings::Settings;
use crate::state::{Constants, Moments, Rates, State};

/// Generators and applied forces to [`Wrench`](crate::Wrench): adds to each moving body's wrench the forces of what acts on it
/// all the time, which is gravity, scaled by its [`GravityScale`](crate::GravityScale).
///
/// [`Damping`](crate::Damping) is not among them: it is a decay, which [`integrate`] treats exactly.
pub fn accumulate_forces(world: &mut World, settings: &Settings) {
    for_each_chunk(world, |mut bodies| accumulate_forces_of(&mut bodies, settings));
}

/// [`Wrench`](crate::Wrench), [`Momentum`](crate::Momentum), [`Pose`](crate::Pose) to [`Momentum`](crate::Momentum),
/// [`Pose`](crate::Pose): advances the state by `settings.dt` with the chosen [`Integrator`], in `settings.substeps` equal parts,
/// and zeroes the wrench it has consumed.
pub fn integrate(world: &mut World, settings: &Settings) {
    for_each_chunk(world, |mut bodies| integrate_bodies(&mut bodies, settings));
}

/// [`Pose`](crate::Pose), [`Momentum`](crate::Momentum), [`Mass`](crate::Mass), [`Inertia`](crate::Inertia) to [`Velocity`] and
/// [`InverseInertia`], on the moving bodies that have them: `v = P/M`, `I^-1 = R I_body^-1 R^T`, `w = I^-1 L`.
pub fn update_derived(world: &mut World) {
    for_each_chunk(world, |mut bodies| update_derived_of(&mut bodies));
}

pub(crate) fn remember_poses(bodies: &mut Chunk<'_>) {
    if let Some(previous) = bodies.previous_pose.as_deref_mut() {
        for (previous, pose) in previous.iter_mut().zip(&*bodies.pose) {
            *previous = PreviousPose(*pose);
        }
    }
}

pub(crate) fn accumulate_forces_of(bodies: &mut Chunk<'_>, settings: &Settings) {
    let gravity = settings.gravity;
    match bodies.gravity_scale {
        None => {
            for (wrench, mass) in bodies.wrench.iter_mut().zip(bodies.mass) {
                wrench.force += gravity * mass.kilograms();
            }
        }
        Some(scales) => {
            for ((wrench, mass), scale) in bodies.wrench.iter_mut().zip(bodies.mass).zip(scales) {
                wrench.force += gravity * (mass.kilograms() * scale.0);
            }
        }
    }
}

pub(crate) fn integrate_bodies(bodies: &mut Chunk<'_>, settings: &Settings) {
    match settings.integrator {
        Integrator::SemiImplicitEuler => integrate_with::<SemiImplicitEuler<Real>>(bodies, settings),
        Integrator::RungeKutta4 => integrate_with::<RungeKutta4<Real>>(bodies, settings),
        Integrator::MoserVeselov => integrate_with::<MoserVeselov<Real>>(bodies, settings),
    }
}

fn integrate_with<S: Scheme<Real>>(bodies: &mut Chunk<'_>, settings: &Settings) {
    let h = settings.substep();
    for i in 0..bodies.len() {
        let scheme = S::new(&bodies.constants(i), h);
        let mut state = bodies.state(i);
        for _ in 0..settings.substeps {
            state = scheme.advance(state);
        }
        bodies.set_state(i, state);
    }
    bodies.wrench.fill(Default::default());
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
    #[inline(always)]
    fn constants(&self, i: usize) -> Constants<Real> {
        Constants {
            mass: self.mass[i].kilograms(),
            inertia: self.inertia.map(|inertia| Moments::new(&inertia[i], self.axes.map(|axes| &axes[i]))),
            force: self.wrench[i].force.into(),
            torque: self.wrench[i].torque.into(),
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
