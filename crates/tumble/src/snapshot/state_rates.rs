//! The equations of motion of all bodies, for ODE solvers that are not ours.

use hecs::World;
use tumble_math::lane::Vec3 as LaneVec3;

use crate::forces::body_forces::BodyForces;
use crate::forces::pairwise::between_bodies::forces_between_bodies;
use crate::forces::registry::ForceLaws;
use crate::integrators::derivative;
use crate::integrators::state::{State, moving_body};
use crate::math::{Quat, Real, Vec3};
use crate::settings::Settings;
use crate::snapshot::state_arrays::{Numbers, STATE_SIZE, StateArrayError, check_length};
use crate::step::simulation::Simulation;
use crate::storage::body_order::BodyOrder;

/// The rate of change of a state array: `dx/dt = P/M`, `dq/dt = 1/2 [0, w] q`, `dP/dt = F`,
/// `dL/dt = tau`.
///
/// Takes the state from `array`, and from the world only what is constant: masses, wrenches,
/// damping, force components, springs, and bodies that the order does not list. The forces are what
/// a step with these settings would apply, those between bodies included, but for contacts and for
/// force laws that were added to a simulation: [`Simulation::derivative_to_array`] has the laws.
/// Springs are as stiff as they were given, since an outside solver has no step that they would be
/// too stiff for. The world does not change.
///
/// ```
/// # use tumble::{BodyOrder, STATE_SIZE, derivative_to_array, prelude::*};
/// # let mut world = hecs::World::new();
/// RigidBody::new(Shape::Point).mass(2.0).build()?.spawn(&mut world);
/// let mut state = [0.0; STATE_SIZE];
/// (state[3], state[7]) = (1.0, 6.0); // w of the orientation, x of the linear momentum
/// let mut rates = [0.0; STATE_SIZE];
/// derivative_to_array(
///     &world,
///     &Settings::default(),
///     &BodyOrder::moving(&world),
///     &state,
///     &mut rates,
/// )?;
/// assert_eq!((rates[0], rates[8]), (3.0, -19.62)); // velocity along x, weight along y
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`StateArrayError`] where an array has another length, or a listed entity is not a moving body.
pub fn derivative_to_array(
    world: &World,
    settings: &Settings,
    order: &BodyOrder,
    array: &[Real],
    rates: &mut [Real],
) -> Result<(), StateArrayError> {
    rates_of(world, settings, &ForceLaws::default(), 0.0, order, array, rates)
}

impl Simulation {
    /// [`derivative_to_array`](crate::derivative_to_array()) with this simulation's settings and
    /// with the force laws that were added to it, at a time \[s\].
    ///
    /// ```
    /// # use tumble::{BodyOrder, STATE_SIZE, prelude::*};
    /// /// Pushes harder and harder.
    /// struct Ramp;
    /// impl ForceLaw for Ramp {
    ///     fn wrench(&self, state: &BodyState<'_>) -> Wrench {
    ///         Wrench { force: Vec3::X * state.time as Real, torque: Vec3::ZERO }
    ///     }
    /// }
    /// # let mut world = hecs::World::new();
    /// # RigidBody::new(Shape::Point).mass(2.0).build()?.spawn(&mut world);
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.add_global_law(Ramp);
    /// let (mut state, mut rates) = ([0.0; STATE_SIZE], [0.0; STATE_SIZE]);
    /// state[3] = 1.0; // w of the orientation
    /// simulation.derivative_to_array(
    ///     &world,
    ///     3.0,
    ///     &BodyOrder::moving(&world),
    ///     &state,
    ///     &mut rates,
    /// )?;
    /// assert_eq!(rates[7], 3.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`derivative_to_array`](crate::derivative_to_array()).
    pub fn derivative_to_array(
        &self,
        world: &World,
        time: f64,
        order: &BodyOrder,
        array: &[Real],
        rates: &mut [Real],
    ) -> Result<(), StateArrayError> {
        rates_of(world, self.settings(), self.laws(), time, order, array, rates)
    }
}

fn rates_of(
    world: &World,
    settings: &Settings,
    laws: &ForceLaws,
    time: f64,
    order: &BodyOrder,
    array: &[Real],
    rates: &mut [Real],
) -> Result<(), StateArrayError> {
    check_length(array, order)?;
    check_length(rates, order)?;
    let states: Vec<State<Real>> = array.chunks_exact(STATE_SIZE).map(state_of).collect();
    let pulls = forces_between_bodies(world, order.entities(), &states);
    let bodies = order.entities().iter().zip(states.iter().zip(rates.chunks_exact_mut(STATE_SIZE)));
    for (index, (&entity, (state, rates))) in bodies.enumerate() {
        let not_moving = || StateArrayError::NotMoving(entity);
        let body = world.entity(entity).map_err(|_| not_moving())?;
        let (constants, _) = moving_body(body).ok_or_else(not_moving)?;
        let mut forces = BodyForces::of(body, settings, (laws, time), (&constants, state));
        if let Some(pull) = pulls.get(index) {
            forces.add_between_bodies(pull);
        }
        let rate = derivative(&constants, forces.undamped().into(), state);
        let linear = rate.force.force + LaneVec3::from(forces.damping.force);
        let angular = rate.force.torque + LaneVec3::from(forces.damping.torque);
        Numbers(rates).write(
            Vec3::from(rate.position).to_array(),
            rate.orientation.into(),
            Vec3::from(linear).to_array(),
            Vec3::from(angular).to_array(),
        );
    }
    Ok(())
}

fn state_of(numbers: &[Real]) -> State<Real> {
    let vector = |from: usize| LaneVec3::new(numbers[from], numbers[from + 1], numbers[from + 2]);
    State {
        position: vector(0),
        orientation: Quat::from_xyzw(numbers[4], numbers[5], numbers[6], numbers[3]).into(),
        linear: vector(7),
        angular: vector(10),
    }
}
