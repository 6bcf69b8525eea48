//! ECS-based batch simulation of rigid bodies in the caller's own [`hecs::World`].
//!
//! Bodies are entities; mass, inertia, pose and momentum are separate components. [`RigidBody`]
//! makes them, and [`Simulation`] steps them: three systems in parallel, [`accumulate_forces`],
//! [`integrate`] and [`update_derived`], which can also be called one by one.
//!
//! ```
//! use tumble::prelude::*;
//!
//! let mut world = hecs::World::new();
//! let top = RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3]))
//!     .mass(1.0)
//!     .angular_velocity(Vec3::new(1.0, 2.0, 3.0))
//!     .build()?
//!     .spawn(&mut world);
//!
//! let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO))?;
//! let before = *world.get::<&Momentum>(top)?;
//! for _ in 0..600 {
//!     simulation.step(&mut world);
//! }
//! // Angular momentum is the state: nothing acts, so not a bit of it changes.
//! assert_eq!(*world.get::<&Momentum>(top)?, before);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Components
//!
//! They are written
//!
//! - when the body is spawned: [`Mass`], [`Inertia`], [`PrincipalAxes`], [`CenterOfMass`],
//!   [`BodyId`].
//! - by the step, the state: [`Pose`], [`Momentum`].
//! - by the step, derived from it: [`Velocity`], [`InverseInertia`], [`PreviousPose`], and [`Work`]
//!   where a [`Ledger`] wants it.
//! - by you, for one step, which sets it to zero: [`Wrench`].
//! - by you, until it is removed: [`GravityScale`], [`Damping`], [`LockedAxes`]; forces:
//!   [`ConstantWrench`], [`Thruster`], [`Drag`], [`Wind`], [`Magnus`], [`SpringToPoint`],
//!   [`PointGravity`], [`Buoyancy`], [`AngularVelocityServo`], [`GravityMass`]; laws of your own:
//!   [`ForceLaw`], [`SimdForceLaw`]; what others touch: [`Collider`], with a [`Material`].
//! - by you, on an entity of its own: [`Spring`]; [`Joint`], with [`Limits`], [`Drives`],
//!   [`JointFriction`]; [`Gear`].
//! - by the step, on a joint's entity: [`JointLoad`], [`Breakable`].
//!
//! A body needs [`Pose`], [`Momentum`], [`Mass`] and [`Wrench`] to be moved by forces. One without
//! [`Momentum`] is kinematic if it has a [`Velocity`], and moves as that says; else it is fixed.
//! All other components may be there or not.
//!
//! A [`Joint`] locks axes along and about which two bodies can move against each other;
//! [`Simulation::joint_events`] tells which broke.
//!
//! Bodies with a [`Collider`] touch each other: a [`Simulation`] keeps their contacts from step to
//! step, and tells of them in [`contacts`](Simulation::contacts) and
//! [`contact_events`](Simulation::contact_events). Those without pass through everything.
//!
//! # Units and frames
//!
//! Metres, kilograms, seconds, radians. Vectors are in the world frame unless it says otherwise;
//! orientations take body coordinates to world coordinates. A [`Pose`] is that of the centre of
//! mass. No axis is special but for the default of [`Settings::gravity`], down y.
//!
//! # The same bits
//!
//! The arithmetic of a step is the same on every machine: no fused multiply-add, no platform
//! mathematics library, and no body's result depends on the number of threads, on rows in memory,
//! or on bodies that no force connects it with.
//!
//! # Features
//!
//! - `f64`: simulates in double precision; [`math::Real`] and [`math::Vec3`] are what the build
//!   simulates in.
//! - `serde`: a [`Snapshot`] in any format of serde.
//! - `profiling`: scopes for puffin, tracy or tracing, through the crate `profiling`.

// On docs.rs items say which feature they need.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    feature = "f64",
    allow(
        clippy::useless_conversion,
        reason = "Real is f64 in this build; the same line converts from f32 in the other"
    )
)]

mod batch;
mod body;
mod clock;
mod collision;
mod components;
mod debug_draw;
mod energy;
mod event_log;
mod forces;
mod integrator;
mod integrators;
mod joints;
pub mod lane;
pub mod math;
mod queries;
mod range;
pub mod rotation;
mod scope;
mod settings;
mod simd;
mod snapshot;
mod solver;
mod step;
mod storage;
mod threads;

pub use batch::Batch;
pub use batch::rng::Rng;
pub use batch::run_worlds::for_each_world;
pub use batch::trial::Trial;
pub use body::body_error::BodyError;
pub use body::bundle::Body;
pub use body::change_mass::{ChangeMassError, change_mass_properties};
pub use body::rigid_body::RigidBody;
pub use body::set_velocity::{VelocityError, set_angular_velocity, set_linear_velocity, set_velocity};
pub use body::spawn_bodies::spawn_bodies;
pub use body::spawn_ground::spawn_ground;
pub use body::weld::{WeldError, weld};
pub use clock::Clock;
pub use collision::collider::Collider;
pub use collision::collider_error::ColliderError;
pub use collision::contact_events::{ContactEvent, Impact};
pub use collision::contact_hook::ContactProposal;
pub use collision::material::{CombineRule, Material};
pub use collision::sensors::SensorEvent;
pub use components::property_error::PropertyError;
pub use components::{
    BodyId, BodyKind, CenterOfMass, Damping, GravityScale, Inertia, InertiaComponentError, InverseInertia, Mass,
    Momentum, Pose, PreviousPose, PrincipalAxes, Velocity, Wind, Work, Wrench,
};
pub use debug_draw::{DebugDraw, DebugView};
pub use energy::ledger::{Ledger, LedgerEntry};
pub use energy::totals::Totals;
pub use forces::body_forces::BodyForces;
pub use forces::components::{
    AngularVelocityServo, Buoyancy, ConstantWrench, Drag, Frame, Hull, Magnus, PointGravity, SpringToPoint, Thruster,
};
pub use forces::force_law::{BodyState, ForceLaw};
pub use forces::pairwise::{GravityMass, Spring};
pub use forces::registry::ForceLaws;
pub use forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
pub use integrator::{Integrator, UnknownIntegrator};
pub use joints::axes::Axes;
pub use joints::breakable::Breakable;
pub use joints::drives::{Drive, Drives};
pub use joints::friction::JointFriction;
pub use joints::gain::Gain;
pub use joints::gear::Gear;
pub use joints::ignore_contacts::IgnoreContacts;
pub use joints::joint::Joint;
pub use joints::joint_error::JointError;
pub use joints::joint_event::JointEvent;
pub use joints::joint_load::JointLoad;
pub use joints::limits::{Cone, Limit, Limits};
pub use joints::locked_axes::LockedAxes;
pub use settings::{Settings, SettingsError};
pub use simd::simd_name;
pub use snapshot::Snapshot;
pub use snapshot::error::{ContactDefect, SnapshotError};
pub use snapshot::rollback::{Rollback, RollbackError};
pub use snapshot::state_arrays::{STATE_SIZE, StateArrayError, array_to_derived_state, array_to_state, state_to_array};
pub use snapshot::state_hash::state_hash;
pub use snapshot::state_rates::derivative_to_array;
pub use step::body_slices::{BodySlices, LengthMismatch};
pub use step::contact_report::{Contact, ContactPoint};
pub use step::phase_times::PhaseTimes;
pub use step::phased_step::{Step, StepPhase};
pub use step::simulation::{Simulation, StepHooks};
pub use step::step;
pub use step::systems::{
    accumulate_forces, integrate, integrate_under_laws, move_kinematic_bodies, remember_poses, update_derived,
};
pub use storage::body_order::BodyOrder;

pub use queries::hits::{PartHit, PointHit, RayHit, ShapeHit};
pub use queries::query_filter::QueryFilter;
pub use queries::query_index::QueryIndex;
pub use queries::ray::Ray;
pub use queries::world_queries::Queries;

pub use {glam, hecs};

pub use tumble_collide::HeightFieldError;

pub use tumble_math::{
    Amount, HullError, InertiaError, InertiaTensor, MassProperties, MeshAudit, MeshDefect, MeshError, MeshRepair, Part,
    PrincipalInertia, Shape, SolidMesh, TriangleMesh, convex_hull, equivalent_ellipsoid,
};

/// The types that most programs need: `use tumble::prelude::*;`.
pub mod prelude {
    pub use crate::math::{Mat3, Quat, Real, Vec3};
    pub use crate::{
        AngularVelocityServo, Axes, Body, BodyId, BodyState, Breakable, Buoyancy, CenterOfMass, Collider,
        ConstantWrench, ContactEvent, Damping, DebugView, Drag, Drive, Drives, ForceLaw, Frame, Gear, GravityMass,
        GravityScale, Hull, Inertia, Integrator, Joint, JointEvent, JointFriction, JointLoad, Ledger, Limit, Limits,
        LockedAxes, Magnus, Mass, Material, Momentum, PointGravity, Pose, PreviousPose, PrincipalAxes, QueryFilter,
        Ray, RigidBody, SensorEvent, Settings, Shape, Simulation, Snapshot, Spring, SpringToPoint, Thruster, Velocity,
        Wind, Wrench, set_angular_velocity, set_linear_velocity, set_velocity, spawn_bodies, spawn_ground,
    };
}
