//! Sweeps: a scene with fields that differ from world to world, run and written to a file.

pub(crate) mod command;
pub(crate) mod distribution;
pub(crate) mod error;
pub(crate) mod file;
pub(crate) mod identity;
pub(crate) mod merge;
pub(crate) mod options;
pub(crate) mod parameter;
pub(crate) mod plot;
pub(crate) mod row;
pub(crate) mod run_status;
pub(crate) mod shard;

use std::path::PathBuf;

use tumble::math::Real;
use tumble::{Integrator, Rng};
use tumble_import::FieldError;
use tumble_scene::{FieldPath, RunLength, RunOverrides, SceneError, SceneTemplate, VariedScene, VariedWorld};

use crate::sweep::distribution::Distribution;
use crate::sweep::error::SweepError;
use crate::sweep::parameter::SweepParameter;

/// The most worlds of a sweep.
pub(crate) const MAX_WORLDS: u64 = 1_000_000_000_000;

/// What a [`Sweep`] is to be; everything but the scene may be left at its default.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct SweepPlan {
    /// A file, or the name of a built-in scene, as for [`Scene::open`](tumble_scene::Scene::open).
    pub(crate) scene: String,
    /// How many worlds; if nothing is drawn at random, each combination of the grids once unless
    /// this says otherwise.
    pub(crate) worlds: Option<u64>,
    /// What chance begins with.
    pub(crate) seed: u64,
    /// What differs between worlds.
    pub(crate) vary: Vec<SweepParameter>,
    /// How long to run instead of as long as the scene says.
    pub(crate) length: Option<RunLength>,
    /// Step \[s\] instead of the scene's.
    pub(crate) dt: Option<Real>,
    /// Substeps instead of the scene's.
    pub(crate) substeps: Option<u32>,
    /// Integrator instead of the scene's.
    pub(crate) integrator: Option<Integrator>,
    /// The bodies whose end is of interest, by name; the first one if none is named.
    pub(crate) bodies: Vec<String>,
}

/// A scene with fields that differ from world to world: at random, or over the values of a grid.
///
/// A field is named by its path in the file: `gravity.1`, `dt`, `bodies.0.mass`,
/// `bodies.brick.angular_velocity.2`, `bodies.0.shape.cuboid.half_extents.0`; bodies and joints go
/// by index or name, and `bodies[0]` is understood too. The value of a field in a world depends on
/// the seed, the place of the field among those that are varied, and the index of the world, and on
/// nothing else. Several grids make all combinations, the last one changing fastest; past the last
/// combination they start over.
#[derive(Clone, Debug)]
pub(crate) struct Sweep {
    plan: SweepPlan,
    worlds: u64,
    scene: VariedScene,
    scene_hash: u64,
    /// Of each field of the scene that varies.
    varied: Vec<Varied>,
    reported: Vec<usize>,
    reported_names: Vec<String>,
    files: Vec<PathBuf>,
}

#[derive(Clone, Debug)]
struct Varied {
    distribution: Distribution,
    /// Of a grid: for how many worlds the value stays.
    stride: u64,
}

impl Sweep {
    /// Reads the scene, finds the fields, and tries a world with all values at their low ends (or
    /// means) and one with all at their high ends.
    pub(crate) fn new(plan: SweepPlan) -> Result<Self, SweepError> {
        let SweepPlan { length, dt, substeps, integrator, .. } = plan;
        let scene = SceneTemplate::open(&plan.scene, RunOverrides { length, dt, substeps, integrator })?;
        let (fields, varied) = find_fields(&plan, &scene)?;
        let names = scene.body_names();
        let reported = reported(&plan.bodies, &names)?;
        let worlds = worlds(&plan, &varied)?;
        let reported_names = reported.iter().filter_map(|&i| names.get(i).cloned()).collect();
        let (scene_hash, files) = (scene.hash(), scene.files().to_vec());
        let scene = scene.varied(fields);
        let sweep = Self { plan, worlds, scene, scene_hash, varied, reported, reported_names, files };
        let ends = |pick: fn(&[f64]) -> Option<&f64>| -> Vec<f64> {
            sweep.varied.iter().filter_map(|varied| pick(&varied.distribution.samples()).copied()).collect()
        };
        sweep.build(&ends(<[f64]>::first))?;
        sweep.build(&ends(<[f64]>::last))?;
        Ok(sweep)
    }

    /// What the sweep was made from.
    pub(crate) fn plan(&self) -> &SweepPlan {
        &self.plan
    }

    /// How many worlds there are.
    pub(crate) fn worlds(&self) -> u64 {
        self.worlds
    }

    /// A hash of the scene's text, by which two sweeps are distinguished.
    pub(crate) fn scene_hash(&self) -> u64 {
        self.scene_hash
    }

    /// The paths of the varied fields, in the order of [`draw`](Self::draw).
    pub(crate) fn fields(&self) -> impl Iterator<Item = &str> {
        self.scene.fields().iter().map(FieldPath::text)
    }

    /// The bodies whose end is of interest, by their [`BodyId`](tumble::BodyId).
    pub(crate) fn reported(&self) -> &[usize] {
        &self.reported
    }

    /// Their names.
    pub(crate) fn reported_names(&self) -> &[String] {
        &self.reported_names
    }

    /// The files that the scene was read from: its own and those of meshes.
    pub(crate) fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The values that the varied fields have in a world.
    pub(crate) fn draw(&self, world: u64) -> Vec<f64> {
        let value = |(place, varied): (usize, &Varied)| {
            let seed_of_field = Rng::stream(self.plan.seed, place as u64).next_u64();
            let step = world / varied.stride % varied.distribution.steps();
            varied.distribution.draw(Rng::stream(seed_of_field, world), step)
        };
        self.varied.iter().enumerate().map(value).collect()
    }

    /// Makes the world in which the varied fields have these values.
    pub(crate) fn build(&self, values: &[f64]) -> Result<VariedWorld, SceneError> {
        self.scene.build(values)
    }
}

/// The fields, and what each is drawn from.
fn find_fields(plan: &SweepPlan, scene: &SceneTemplate) -> Result<(Vec<FieldPath>, Vec<Varied>), SweepError> {
    let mut fields: Vec<FieldPath> = Vec::with_capacity(plan.vary.len());
    let mut found: Vec<Varied> = Vec::with_capacity(plan.vary.len());
    for SweepParameter { field, distribution } in &plan.vary {
        let refuse = |problem: &str| Err(FieldError::new(field.as_str(), problem).into());
        let path = scene.field(field)?;
        if let Err(problem) = distribution.check() {
            return refuse(&problem);
        }
        let set_already = match path.scene_field() {
            Some("dt") => plan.dt.is_some(),
            Some("substeps") => plan.substeps.is_some(),
            Some("steps") => plan.length.is_some(),
            _ => false,
        };
        if set_already {
            return refuse("an option sets it already");
        }
        if fields.iter().any(|other| other.same_place(&path)) {
            return refuse("is varied twice");
        }
        if path.is_count() && !distribution.is_whole() {
            return refuse("takes whole numbers: a grid of them, as in grid(1,8,8)");
        }
        // Tried on a copy, so that a wrong path is known to be one before any world is made.
        scene.check(&path)?;
        fields.push(path);
        found.push(Varied { distribution: *distribution, stride: 1 });
    }
    let mut stride = 1;
    for varied in found.iter_mut().rev() {
        varied.stride = stride;
        stride = match stride.checked_mul(varied.distribution.steps()) {
            Some(product) if product <= MAX_WORLDS => product,
            _ => return Err(SweepError::Worlds(format!("the grids have more than {MAX_WORLDS} combinations"))),
        };
    }
    Ok((fields, found))
}

fn worlds(plan: &SweepPlan, varied: &[Varied]) -> Result<u64, SweepError> {
    let only_grids =
        !varied.is_empty() && varied.iter().all(|varied| matches!(varied.distribution, Distribution::Grid { .. }));
    match plan.worlds {
        Some(0) => Err(SweepError::Worlds("0: a sweep has one world at least".to_owned())),
        Some(worlds) if worlds > MAX_WORLDS => Err(SweepError::Worlds(format!("{worlds} is more than {MAX_WORLDS}"))),
        Some(worlds) => Ok(worlds),
        None if only_grids => Ok(varied.iter().map(|varied| varied.distribution.steps()).product()),
        None => Err(SweepError::Worlds("N is missing: only grids know how many worlds they make".to_owned())),
    }
}

fn reported(wanted: &[String], names: &[String]) -> Result<Vec<usize>, SweepError> {
    if wanted.is_empty() {
        return Ok(if names.is_empty() { Vec::new() } else { vec![0] });
    }
    let find = |name: &String| names.iter().position(|known| known == name);
    wanted.iter().map(|name| find(name).ok_or_else(|| SweepError::Body(name.clone()))).collect()
}
