//! The equations of motion of all bodies, for ODE solvers that are not ours.

use std::collections::HashMap;

use glam::DVec3;
use hecs::{Entity, World};
use tumble_math::lane::Vec3 as LaneVec3;

use crate::components::{Damping, GravityScale, Mass, Momentum, Pose, Velocity, Wrench};
use crate::forces::force_context::ForceContext;
use crate::forces::force_law::BodyState;
use crate::forces::pairwise;
use crate::forces::pairwise::{GravityMass, Spring};
use crate::forces::registry::ForceLaws;
use crate::integrators::derivative;
use crate::integrators::state::{Constants, Force, State, moving_body};
use crate::math::{Quat, Real, Vec3, double, double_quat, dquat, dvec3, vec3};
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
/// derivative_to_array(&world, &Settings::default(), &BodyOrder::moving(&world), &state, &mut rates)?;
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
    /// simulation.derivative_to_array(&world, 3.0, &BodyOrder::moving(&world), &state, &mut rates)?;
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
    let pulls = BetweenBodies::of(world, order, &states);
    let bodies = order.entities().iter().zip(states.iter().zip(rates.chunks_exact_mut(STATE_SIZE)));
    for (index, (&entity, (state, rates))) in bodies.enumerate() {
        let (constants, mut force, damping) =
            forced(world, settings, (laws, time), entity, state).ok_or(StateArrayError::NotMoving(entity))?;
        if let Some((linear, angular)) = pulls.get(index) {
            force.force = force.force + LaneVec3::from(vec3(*linear));
            force.torque = force.torque + LaneVec3::from(vec3(*angular));
        }
        let rate = derivative(&constants, force, state);
        let linear = rate.force.force + state.linear * -damping.linear;
        let angular = rate.force.torque + state.angular * -damping.angular;
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

/// One body's constants, the force that a step would apply in a state but for those between bodies,
/// and the rates of damping.
fn forced(
    world: &World,
    settings: &Settings,
    (laws, time): (&ForceLaws, f64),
    entity: Entity,
    state: &State<Real>,
) -> Option<(Constants<Real>, Force<Real>, Damping)> {
    let body = world.entity(entity).ok()?;
    let (constants, _) = moving_body(body)?;
    let mut wrench = body.get::<&Wrench>().map_or(Wrench::default(), |wrench| *wrench);
    let scale = body.get::<&GravityScale>().map_or(1.0, |scale| scale.0);
    wrench.force += settings.gravity * (constants.mass * scale);
    let context = ForceContext { kick: 0.0, ..ForceContext::of_body(body, settings) };
    let seen = BodyState::new((time, 0.0), (&constants, &context), state);
    wrench.add(ForceLaws::wrench_of_components(body, &seen));
    wrench.add(laws.wrench_of_added(body, &seen));
    let damping = body.get::<&Damping>().map_or(Damping::default(), |damping| *damping);
    Some((constants, wrench.into(), damping))
}

/// A body as forces between bodies see it, in double precision.
struct End {
    position: DVec3,
    orientation: glam::DQuat,
    linear_velocity: DVec3,
    angular_velocity: DVec3,
    /// Its place in the order.
    index: Option<usize>,
}

/// Forces \[N\] and torques [N m] on the bodies of an order by the springs and the gravity between
/// bodies; empty where there are none.
type Pulls = Vec<(DVec3, DVec3)>;

struct BetweenBodies<'a> {
    world: &'a World,
    states: &'a [State<Real>],
    places: HashMap<Entity, usize>,
}

impl<'a> BetweenBodies<'a> {
    fn of(world: &'a World, order: &BodyOrder, states: &'a [State<Real>]) -> Pulls {
        if !pairwise::are_in(world) {
            return Pulls::new();
        }
        let places = order.entities().iter().enumerate().map(|(index, entity)| (*entity, index)).collect();
        let bodies = Self { world, states, places };
        let mut pulls = vec![(DVec3::ZERO, DVec3::ZERO); states.len()];
        for spring in world.query::<&Spring>().iter() {
            bodies.add_spring(spring, &mut pulls);
        }
        bodies.add_gravity(&mut pulls);
        pulls
    }

    /// A body in the state of the array, or in that of the world where the order does not list it.
    fn end(&self, entity: Entity) -> Option<End> {
        let body = self.world.entity(entity).ok()?;
        let index = self.places.get(&entity).copied();
        if let Some(state) = index.and_then(|index| self.states.get(index)) {
            let (constants, _) = moving_body(body)?;
            let upright = State { orientation: state.orientation.normalize(), ..*state };
            return Some(End {
                position: double(state.position),
                orientation: double_quat(upright.orientation),
                linear_velocity: double(constants.velocity(state.linear)),
                angular_velocity: double(constants.angular_velocity(&upright)),
                index,
            });
        }
        let pose = *body.get::<&Pose>()?;
        let velocity = body.get::<&Velocity>().map_or(Velocity::default(), |velocity| *velocity);
        Some(End {
            position: dvec3(pose.position),
            orientation: dquat(pose.orientation).normalize(),
            linear_velocity: dvec3(velocity.linear),
            angular_velocity: dvec3(velocity.angular),
            index,
        })
    }

    fn add_spring(&self, spring: &Spring, pulls: &mut Pulls) {
        let [a, b] = spring.bodies.map(|entity| self.end(entity));
        let (Some(a), Some(b)) = (a, b) else { return };
        if spring.bodies[0] == spring.bodies[1] {
            return;
        }
        let arms = [a.orientation * dvec3(spring.attachments[0]), b.orientation * dvec3(spring.attachments[1])];
        let between = (b.position - a.position) + (arms[1] - arms[0]);
        let (length, direction) = (between.length(), between.normalize_or_zero());
        let velocity = |end: &End, arm: DVec3| end.linear_velocity + end.angular_velocity.cross(arm);
        let speed = direction.dot(velocity(&b, arms[1]) - velocity(&a, arms[0]));
        let elastic = f64::from(spring.stiffness) * (length - f64::from(spring.rest_length));
        let on_a = direction * (elastic + f64::from(spring.damping) * speed);
        for (end, arm, force) in [(a, arms[0], on_a), (b, arms[1], -on_a)] {
            if let Some((linear, angular)) = end.index.and_then(|index| pulls.get_mut(index)) {
                *linear += force;
                *angular += arm.cross(force);
            }
        }
    }

    /// `F_i = M_i sum mu_j r/(r^2 + e_i^2 + e_j^2)^(3/2)`.
    fn add_gravity(&self, pulls: &mut Pulls) {
        let mut query = self.world.query::<(Entity, &GravityMass, Option<&Mass>, Option<&Momentum>)>();
        let all: Vec<(End, GravityMass, f64)> = query
            .iter()
            .filter_map(|(entity, gravity, mass, momentum)| {
                let mass = mass.filter(|_| momentum.is_some()).map_or(0.0, |mass| f64::from(mass.kilograms()));
                Some((self.end(entity)?, *gravity, mass))
            })
            .collect();
        for (i, (end, gravity, mass)) in all.iter().enumerate() {
            let Some((linear, _)) = end.index.and_then(|index| pulls.get_mut(index)) else { continue };
            for (_, (other, by, _)) in all.iter().enumerate().filter(|(j, _)| *j != i) {
                let r = other.position - end.position;
                let softening = f64::from(gravity.softening).powi(2) + f64::from(by.softening).powi(2);
                let square = r.length_squared() + softening;
                if square > 0.0 {
                    *linear += r * (mass * f64::from(by.mu) / (square * square.sqrt()));
                }
            }
        }
    }
}
