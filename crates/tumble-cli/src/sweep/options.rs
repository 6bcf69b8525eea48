//! The command line of sweeps.

use std::num::NonZeroU64;
use std::path::PathBuf;

use clap::Args;
use tumble_scene::RunLength;
use tumble_sweep::{MAX_WORLDS, Shard, SweepParameter, SweepPlan};

use crate::options::{StepOptions, count_up_to, every};

#[derive(Debug, Args)]
pub(crate) struct SweepOptions {
    /// A file (.json, .ron, .gltf, .glb, .urdf), or the name of a built-in scene
    #[arg(value_name = "SCENE")]
    pub(crate) scene: String,
    /// The .csv file to write, or to go on with: one row for each world
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// A numeric field and its values: FIELD=LO..HI, normal(MEAN,SD) or choice(A,B,..) at random,
    /// grid(LO,HI,N) or list(A,B,..) in order; may be given again
    ///
    /// FIELD,FIELD=VALUES gives several fields one value, and FIELD*2 twice of it.
    ///
    /// FIELD is the path in the file: gravity.1, dt, bodies.0.mass,
    /// bodies.brick.angular_velocity.2, joints.elbow.drives.0.stiffness, …
    #[arg(long, value_name = "FIELD=VALUES", value_parser = str::parse::<SweepParameter>)]
    pub(crate) vary: Vec<SweepParameter>,
    /// Worlds [default: all combinations, where there are only grids and lists]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = worlds)]
    pub(crate) worlds: Option<u64>,
    /// What chance begins with
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 0)]
    pub(crate) seed: u64,
    /// A body whose end is written, by name; may be given again [default: the first that moves]
    #[arg(long, value_name = "NAME")]
    pub(crate) body: Vec<String>,
    /// A column of what is seen in all steps: max(BODY.COLUMN), min(BODY.COLUMN), first_contact or
    /// first_contact(BODY); may be given again
    #[arg(long, value_name = "WHAT")]
    pub(crate) observe: Vec<String>,
    /// End a world where this is so: BODY.COLUMN<NUMBER, BODY.COLUMN>NUMBER, first_contact or
    /// first_contact(BODY)
    #[arg(long, value_name = "CONDITION")]
    pub(crate) until: Option<String>,
    /// Write the states of the bodies on the way into this .csv file, world after world
    #[arg(long, value_name = "FILE")]
    pub(crate) series: Option<PathBuf>,
    /// Every K-th step is in the series [default: 1]
    #[arg(long, value_name = "K", allow_negative_numbers = true, requires = "series", value_parser = every)]
    pub(crate) every: Option<NonZeroU64>,
    /// Take the nearest possible inertia for bodies of a .gltf, .glb or .urdf file whose own is
    /// impossible
    #[arg(long)]
    pub(crate) repair: bool,
    /// Only the I-th of N parts of the worlds
    #[arg(long, value_name = "I/N", value_parser = str::parse::<Shard>)]
    pub(crate) shard: Option<Shard>,
    #[command(flatten)]
    pub(crate) stepping: StepOptions,
    #[command(flatten)]
    pub(crate) plot: PlotOptions,
    /// Print nothing unless something goes wrong
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct MergeOptions {
    /// The .csv file to write
    #[arg(value_name = "OUT")]
    pub(crate) out: PathBuf,
    /// The files of all shards, in any order
    #[arg(value_name = "SHARD", required = true)]
    pub(crate) shards: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) plot: PlotOptions,
}

/// The picture of a sweep.
#[derive(Debug, Default, Args)]
pub(crate) struct PlotOptions {
    /// Draw one column against another into an .svg file
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
    /// Replace a plot's file that this program did not write
    #[arg(long, requires = "plot")]
    pub(crate) force: bool,
    /// The column from left to right [default: the first field that varies]
    #[arg(long, value_name = "COLUMN", requires = "plot")]
    pub(crate) x: Option<String>,
    /// The column from bottom to top [default: energy_drift]
    #[arg(long, value_name = "COLUMN", requires = "plot")]
    pub(crate) y: Option<String>,
}

impl SweepOptions {
    /// What of it the results depend on.
    pub(crate) fn plan(&self) -> SweepPlan {
        let length = self.stepping.steps.map(RunLength::Steps).or(self.stepping.duration.map(RunLength::Duration));
        SweepPlan {
            scene: self.scene.clone(),
            worlds: self.worlds,
            seed: self.seed,
            vary: self.vary.clone(),
            length,
            dt: self.stepping.dt,
            substeps: self.stepping.substeps,
            integrator: self.stepping.integrator,
            bodies: self.body.clone(),
            observe: self.observe.clone(),
            until: self.until.clone(),
            series: self.series.as_ref().map(|_| self.every.unwrap_or(NonZeroU64::MIN)),
            repair: self.repair,
        }
    }
}

fn worlds(text: &str) -> Result<u64, String> {
    count_up_to(text, MAX_WORLDS)
}
