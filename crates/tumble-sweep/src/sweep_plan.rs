//! What a sweep is made from.

use std::num::NonZeroU64;

use tumble::Integrator;
use tumble::math::Real;
use tumble_scene::RunLength;

use crate::parameter::SweepParameter;

/// The most worlds of a sweep.
pub const MAX_WORLDS: u64 = 1_000_000_000_000;

/// What a [`Sweep`](crate::Sweep) is to be; everything but the scene may be left at its default.
///
/// ```
/// use tumble_scene::RunLength;
/// use tumble_sweep::{Sweep, SweepPlan};
///
/// let plan = SweepPlan {
///     scene: "t-handle".into(),
///     vary: vec!["bodies.0.angular_velocity.1=grid(0,5,6)".parse()?],
///     length: Some(RunLength::Steps(60)),
///     observe: vec!["max(t-handle.py)".into()],
///     ..SweepPlan::default()
/// };
/// // Each value of the grid once.
/// assert_eq!(Sweep::new(plan)?.worlds(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweepPlan {
    /// A file, or the name of a built-in scene, as for [`Scene::open`](tumble_scene::Scene::open).
    pub scene: String,
    /// How many worlds; if nothing is drawn at random, each combination of the grids once unless
    /// this says otherwise.
    pub worlds: Option<u64>,
    /// What chance begins with.
    pub seed: u64,
    /// What differs between worlds.
    pub vary: Vec<SweepParameter>,
    /// How long to run instead of as long as the scene says.
    pub length: Option<RunLength>,
    /// Step \[s\] instead of the scene's.
    pub dt: Option<Real>,
    /// Substeps instead of the scene's.
    pub substeps: Option<u32>,
    /// Integrator instead of the scene's.
    pub integrator: Option<Integrator>,
    /// The bodies whose end is of interest, by name; the first that moves if none is named.
    pub bodies: Vec<String>,
    /// What is watched in each step, as it was written.
    pub observe: Vec<String>,
    /// What ends a world before its steps are done, as it was written.
    pub until: Option<String>,
    /// Of how many steps one is in the time series, if there is one.
    pub series: Option<NonZeroU64>,
    /// Whether impossible inertias of a file of others are repaired.
    pub repair: bool,
}
