//! The state of all bodies as one flat array, for ODE solvers that are not ours.
//!
//! Thirteen numbers a body, in the order of the course notes that the names come from (D. Baraff,
//! "Rigid body simulation", part I, section 5), of the bodies of [`BodyOrder::moving`]: position x
//! y z, orientation w x y z, linear momentum x y z, angular momentum x y z; body after body.

use hecs::{Entity, World};

use crate::components::{InverseInertia, Momentum, Pose, Velocity};
use crate::integrators::derived::derived;
use crate::integrators::state::moving_body;
use crate::math::{Quat, Real, Vec3};
use crate::storage::body_order::BodyOrder;

/// Numbers that the state of one body takes: 3 + 4 + 3 + 3.
pub const STATE_SIZE: usize = 13;

/// A state array that does not fit the bodies.
///
/// ```
/// # use tumble::{BodyOrder, STATE_SIZE, StateArrayError, state_to_array};
/// let world = hecs::World::new();
/// let error =
///     state_to_array(&world, &BodyOrder::moving(&world), &mut [0.0; STATE_SIZE]).unwrap_err();
/// assert_eq!(error, StateArrayError::Length { found: 13, bodies: 0, expected: 0 });
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StateArrayError {
    /// The array's length is not [`STATE_SIZE`] times the number of bodies.
    #[error("an array of {found} numbers is not the state of {bodies} bodies, which takes {expected}")]
    Length {
        /// Length of the array.
        found: usize,
        /// How many bodies the order lists.
        bodies: usize,
        /// The length it should have.
        expected: usize,
    },
    /// An entity that the order lists is gone or lacks a component of a moving body.
    #[error("entity {0:?} is not a moving body: it needs Pose, Momentum and Mass")]
    NotMoving(Entity),
}

tumble_math::debug_as_display!(StateArrayError);

/// One body's 13 numbers.
pub(crate) struct Numbers<'a>(pub(crate) &'a mut [Real]);

impl Numbers<'_> {
    pub(crate) fn write(&mut self, position: [Real; 3], orientation: Quat, linear: [Real; 3], angular: [Real; 3]) {
        self.0[0..3].copy_from_slice(&position);
        self.0[3..7].copy_from_slice(&[orientation.w, orientation.x, orientation.y, orientation.z]);
        self.0[7..10].copy_from_slice(&linear);
        self.0[10..13].copy_from_slice(&angular);
    }
}

pub(crate) fn check_length(array: &[Real], order: &BodyOrder) -> Result<(), StateArrayError> {
    let expected = order.len() * STATE_SIZE;
    if array.len() == expected {
        Ok(())
    } else {
        Err(StateArrayError::Length { found: array.len(), bodies: order.len(), expected })
    }
}

/// Copies the bodies' state into the array, in the given order.
///
/// ```
/// # use tumble::{BodyOrder, STATE_SIZE, state_to_array, prelude::*};
/// # let mut world = hecs::World::new();
/// RigidBody::new(Shape::Point).mass(2.0).position(Vec3::X * 3.0).build()?.spawn(&mut world);
/// let order = BodyOrder::moving(&world);
/// let mut array = vec![0.0; order.len() * STATE_SIZE];
/// state_to_array(&world, &order, &mut array)?;
/// assert_eq!(array[..7], [3.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]); // x y z, and w x y z
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`StateArrayError`] where the array has another length, or a listed entity is not a moving body;
/// the array is then partly written.
pub fn state_to_array(world: &World, order: &BodyOrder, array: &mut [Real]) -> Result<(), StateArrayError> {
    check_length(array, order)?;
    for (&entity, numbers) in order.entities().iter().zip(array.chunks_exact_mut(STATE_SIZE)) {
        let mut query = world.query_one::<(&Pose, &Momentum)>(entity);
        let (pose, momentum) = query.get().map_err(|_| StateArrayError::NotMoving(entity))?;
        Numbers(numbers).write(
            pose.position.to_array(),
            pose.orientation,
            momentum.linear.to_array(),
            momentum.angular.to_array(),
        );
    }
    Ok(())
}

/// Copies the array into the bodies' state. Orientations are normalised; one that is zero or not
/// finite is taken as it is.
///
/// [`Velocity`](crate::Velocity) and [`InverseInertia`](crate::InverseInertia) are not touched: run
/// [`update_derived`](crate::update_derived) if they are needed.
///
/// ```
/// # use tumble::{BodyOrder, STATE_SIZE, array_to_state, prelude::*};
/// # let mut world = hecs::World::new();
/// let body = RigidBody::new(Shape::Point).mass(2.0).build()?.spawn(&mut world);
/// let mut array = [0.0; STATE_SIZE];
/// (array[0], array[3]) = (5.0, 1.0); // x of the position, w of the orientation
/// let order = BodyOrder::moving(&world);
/// array_to_state(&mut world, &order, &array)?;
/// assert_eq!(world.get::<&Pose>(body)?.position, Vec3::X * 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`StateArrayError`], and the world is unchanged.
pub fn array_to_state(world: &mut World, order: &BodyOrder, array: &[Real]) -> Result<(), StateArrayError> {
    check_length(array, order)?;
    if let Some(&entity) = order.entities().iter().find(|&&entity| !world.satisfies::<(&Pose, &Momentum)>(entity)) {
        return Err(StateArrayError::NotMoving(entity));
    }
    for (&entity, numbers) in order.entities().iter().zip(array.chunks_exact(STATE_SIZE)) {
        if let Ok((pose, momentum)) = world.query_one_mut::<(&mut Pose, &mut Momentum)>(entity) {
            let orientation = Quat::from_xyzw(numbers[4], numbers[5], numbers[6], numbers[3]);
            pose.position = Vec3::from_slice(&numbers[0..3]);
            let length = orientation.length();
            pose.orientation = if length.is_normal() { orientation / length } else { orientation };
            momentum.linear = Vec3::from_slice(&numbers[7..10]);
            momentum.angular = Vec3::from_slice(&numbers[10..13]);
        }
    }
    Ok(())
}

/// [`array_to_state`], and the derived quantities with it: [`Velocity`] and [`InverseInertia`] of
/// the bodies that have them are those of the new state.
///
/// ```
/// # use tumble::{BodyOrder, STATE_SIZE, array_to_derived_state, prelude::*};
/// # let mut world = hecs::World::new();
/// let body = RigidBody::new(Shape::Point).mass(2.0).build()?.spawn(&mut world);
/// let mut array = [0.0; STATE_SIZE];
/// (array[3], array[7]) = (1.0, 6.0); // w of the orientation, x of the linear momentum
/// let order = BodyOrder::moving(&world);
/// array_to_derived_state(&mut world, &order, &array)?;
/// assert_eq!(world.get::<&Velocity>(body)?.linear, Vec3::X * 3.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`array_to_state`].
pub fn array_to_derived_state(world: &mut World, order: &BodyOrder, array: &[Real]) -> Result<(), StateArrayError> {
    array_to_state(world, order, array)?;
    for &entity in order.entities() {
        let body = world.entity(entity).map_err(|_| StateArrayError::NotMoving(entity))?;
        let (constants, state) = moving_body(body).ok_or(StateArrayError::NotMoving(entity))?;
        let (velocity, inverse): (Velocity, InverseInertia) = derived(&constants, &state).into();
        if let Some(mut of_body) = body.get::<&mut Velocity>() {
            *of_body = velocity;
        }
        if let Some(mut of_body) = body.get::<&mut InverseInertia>() {
            *of_body = inverse;
        }
    }
    Ok(())
}
