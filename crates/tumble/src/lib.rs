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
//! # Modules
//!
//! [`prelude`] has what most programs need. Everything is in the module of its subject: [`body`],
//! [`components`], [`collision`], [`forces`], [`joints`], [`queries`], [`mod@step`], [`energy`],
//! [`snapshot`], [`batch`], [`debug_draw`], [`shapes`], [`math`] and [`rotation`].
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
//! - `mint`: conversions of [`math::Vec3`], [`math::Quat`] and the others from and to the types of
//!   `mint`, which other versions of glam and other libraries convert from and to.
//! - `tracing`: in debug builds a warning through the crate `tracing`, once per kind, of a
//!   [`Velocity`] that is written and not read, a body without a [`Collider`] where others have
//!   one, a mesh on a mesh, and a half-space with [`Momentum`]. A release build has none.

// On docs.rs items say which feature they need.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    feature = "f64",
    allow(
        clippy::useless_conversion,
        reason = "Real is f64 in this build; the same line converts from f32 in the other"
    )
)]

pub mod batch;
pub mod body;
mod clock;
pub mod collision;
pub mod components;
pub mod debug_draw;
pub mod energy;
mod event_log;
pub mod forces;
mod integrator;
mod integrators;
mod joint_solver;
pub mod joints;
pub mod lane;
pub mod math;
pub mod queries;
mod range;
pub mod rotation;
mod scope;
mod settings;
mod simd;
pub mod snapshot;
mod solver;
pub mod step;
mod storage;
mod threads;

#[doc(inline)]
pub use batch::Batch;
pub use batch::trial::Trial;
pub use body::body_error::BodyError;
pub use body::bundle::Body;
pub use body::rigid_body::RigidBody;
pub use body::set_velocity::{VelocityError, set_angular_velocity, set_linear_velocity, set_velocity};
pub use body::spawn_bodies::spawn_bodies;
pub use body::spawn_ground::spawn_ground;
pub use collision::collider::Collider;
pub use collision::collider_error::ColliderError;
pub use collision::contact_events::{ContactEvent, Impact};
pub use collision::material::Material;
pub use collision::sensors::SensorEvent;
#[doc(inline)]
pub use components::{
    BodyId, CenterOfMass, Damping, GravityScale, Inertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Velocity,
    Wind, Wrench,
};
#[doc(inline)]
pub use debug_draw::DebugView;
pub use energy::ledger::Ledger;
pub use forces::components::{
    AngularVelocityServo, Buoyancy, ConstantWrench, Drag, Frame, Hull, Magnus, PointGravity, SpringToPoint, Thruster,
};
pub use forces::force_law::{BodyState, ForceLaw};
pub use forces::pairwise::{GravityMass, Spring};
pub use integrator::Integrator;
pub use joint_solver::JointSolver;
pub use joints::axes::Axes;
pub use joints::breakable::Breakable;
pub use joints::drives::{Drive, Drives};
pub use joints::friction::JointFriction;
pub use joints::gear::Gear;
pub use joints::joint::Joint;
pub use joints::joint_error::JointError;
pub use joints::joint_event::JointEvent;
pub use joints::joint_load::JointLoad;
pub use joints::limits::{Limit, Limits};
pub use joints::locked_axes::LockedAxes;
pub use joints::oscillation::Oscillation;
pub use queries::hits::RayHit;
pub use queries::query_filter::QueryFilter;
pub use queries::ray::Ray;
pub use queries::world_queries::Queries;
pub use settings::{Settings, SettingsError, Sleep};
#[doc(inline)]
pub use snapshot::Snapshot;
pub use snapshot::error::SnapshotError;
pub use snapshot::rollback::{Rollback, RollbackError};
pub use step::simulation::Simulation;
#[doc(inline)]
pub use step::step;

// At the root too, but shown in their modules alone.
#[doc(hidden)]
pub use batch::{Rng, for_each_world};
#[doc(hidden)]
pub use body::{ChangeMassError, WeldError, change_mass_properties, weld};
#[doc(hidden)]
pub use collision::{CombineRule, ContactProposal};
#[doc(hidden)]
pub use components::{BodyKind, InertiaComponentError, InverseInertia, PropertyError, Work};
#[doc(hidden)]
pub use debug_draw::DebugDraw;
#[doc(hidden)]
pub use energy::{LedgerEntry, Totals};
#[doc(hidden)]
pub use forces::{BodyForces, ForceLaws, SimdBody, SimdForceLaw, SimdWrench};
#[doc(hidden)]
pub use joints::{Cone, Gain, IgnoreContacts};
#[doc(hidden)]
pub use queries::{PartHit, PointHit, QueryIndex, ShapeHit};
#[doc(hidden)]
pub use snapshot::{
    BodyOrder, ContactDefect, STATE_SIZE, StateArrayError, array_to_derived_state, array_to_state, derivative_to_array,
    state_hash, state_to_array,
};
#[doc(hidden)]
pub use step::{
    BodySlices, Contact, ContactPoint, LengthMismatch, PhaseTimes, Step, StepHooks, StepPhase, accumulate_forces,
    integrate, integrate_under_laws, move_kinematic_bodies, remember_poses, update_derived,
};

pub use clock::Clock;
pub use integrator::UnknownIntegrator;
pub use joint_solver::UnknownJointSolver;
pub use simd::simd_name;
pub use {glam, hecs};

#[doc(hidden)]
pub use shapes::{
    HeightFieldError, HullError, InertiaError, InertiaTensor, MeshAudit, MeshDefect, MeshError, MeshRepair,
    PrincipalInertia, SolidMesh, TriangleMesh, convex_hull, equivalent_ellipsoid,
};
pub use tumble_math::{Amount, MassProperties, Part, Shape};

/// Shapes, their mass properties, and meshes: what of `tumble-math` bodies are made of.
pub mod shapes {
    pub use tumble_collide::HeightFieldError;
    pub use tumble_math::{
        Amount, HullError, InertiaError, InertiaTensor, MassError, MassProperties, MeshAudit, MeshDefect, MeshError,
        MeshRepair, Part, PrincipalInertia, Shape, ShapeError, SolidMesh, TriangleMesh, convex_hull,
        equivalent_ellipsoid,
    };
}

/// The types that most programs need: `use tumble::prelude::*;`.
pub mod prelude {
    pub use crate::math::{Mat3, Quat, Real, Vec3};
    pub use crate::{
        Amount, AngularVelocityServo, Axes, Body, BodyError, BodyId, BodyState, Breakable, Buoyancy, CenterOfMass,
        Collider, CombineRule, Cone, ConstantWrench, ContactEvent, Damping, DebugView, Drag, Drive, Drives, ForceLaw,
        Frame, Gain, Gear, GravityMass, GravityScale, Hull, IgnoreContacts, Inertia, Integrator, Joint, JointEvent,
        JointFriction, JointLoad, JointSolver, Ledger, Limit, Limits, LockedAxes, Magnus, Mass, Material, Momentum,
        Part, PointGravity, Pose, PreviousPose, PrincipalAxes, Queries, QueryFilter, Ray, RayHit, RigidBody,
        SensorEvent, Settings, Shape, Simulation, Sleep, Snapshot, Spring, SpringToPoint, Thruster, Totals, Velocity,
        Wind, Wrench, set_angular_velocity, set_linear_velocity, set_velocity, spawn_bodies, spawn_ground,
    };
}
