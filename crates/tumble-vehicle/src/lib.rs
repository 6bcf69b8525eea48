//! Cars and trucks for the rigid-body engine tumble.
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
pub use error::VehicleError;
pub use jointed::{JointedVehicle, JointedWheel, drive_jointed_vehicles};
pub use plan::{DrivenWheels, VehiclePlan};
pub use settings::{AntiRollBar, MAX_WHEELS, Motor, Probe, Suspension, Tyre, VehicleSettings, Wheel};
pub use state::{VehicleInput, VehicleState, WheelContact, WheelState};
pub use vehicle::{Vehicle, wheel_poses};
