//! Cars and trucks for the rigid-body engine tumble: on ray-cast wheels with a slip curve, or on
//! wheels that are bodies on joints.
//!
//! A [`VehiclePlan`] has size and mass. It spawns a chassis with a [`Vehicle`], a [`VehicleInput`]
//! and a [`VehicleState`]; [`drive_vehicles`] before each step turns the input into forces and
//! writes what the wheels do. [`VehiclePlan::spawn_on_joints`] makes the same of joints, for
//! [`drive_jointed_vehicles`].
//!
//! ```
//! use tumble::prelude::*;
//! use tumble_vehicle::{VehicleInput, VehiclePlan, drive_vehicles};
//!
//! let mut world = tumble::hecs::World::new();
//! spawn_ground(&mut world);
//! let car = VehiclePlan::car(4.5, 1500.0).spawn(&mut world, Pose::default())?;
//! world.get::<&mut VehicleInput>(car)?.throttle = 0.5;
//!
//! let mut simulation = Simulation::new(Settings::default())?;
//! for _ in 0..60 {
//!     drive_vehicles(&mut world, &simulation);
//!     simulation.step(&mut world);
//! }
//! assert!(world.get::<&Velocity>(car)?.linear.z > 2.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The frame of a chassis has x to the left, y up and z ahead. Forces are computed in double
//! precision in either build. Equations, settings and what is promised are in `docs/vehicles.md` of
//! the repository.
//!
//! # Features
//!
//! - `f64`: bodies in double precision, as in `tumble`.

#![cfg_attr(
    feature = "f64",
    allow(
        clippy::unnecessary_cast,
        clippy::useless_conversion,
        reason = "Real is f64 in this build; the same line converts from f32 in the other"
    )
)]

mod drive_torque;
mod drive_vehicles;
mod error;
mod jointed;
mod light_bodies;
mod plan;
mod precision;
mod probe;
mod rigid;
mod settings;
mod slip_curve;
mod solve;
mod state;
mod vehicle;
mod wheel_step;

pub use drive_vehicles::drive_vehicles;
pub use error::{MAX_WHEELS, VehicleError};
pub use jointed::{JointedVehicle, JointedWheel, drive_jointed_vehicles};
pub use plan::{DrivenWheels, VehiclePlan};
pub use settings::{AntiRollBar, Motor, Probe, Suspension, Tyre, VehicleSettings, Wheel};
pub use state::{VehicleInput, VehicleState, WheelContact, WheelState};
pub use vehicle::{Vehicle, wheel_poses};
