//! A scene with fields that differ from world to world.

use std::path::PathBuf;

use tumble::Rng;
use tumble_import::{FieldError, InertiaRepairs};
use tumble_scene::{FieldPath, RunOverrides, SceneError, SceneTemplate, VariedScene, VariedWorld};

use crate::distribution::Distribution;
use crate::error::SweepError;
use crate::observation::{Observable, Until};
use crate::parameter::SweepParameter;
use crate::sweep_plan::{MAX_WORLDS, SweepPlan};

/// A scene with fields that differ from world to world: at random, or over the values of a grid.
///
/// A field is named by its path in the file: `gravity.1`, `dt`, `bodies.0.mass`,
/// `bodies.brick.angular_velocity.2`, `bodies.0.shape.cuboid.half_extents.0`; bodies and joints go
/// by index or name, and `bodies[0]` is understood too. The value of a field in a world depends on
/// the seed, the place of the field among those that are varied, and the index of the world, and on
/// nothing else. Several grids make all combinations, the last one changing fastest; past the last
/// combination they start over.
///
/// ```
/// use tumble_sweep::{RunStatus, Sweep, SweepPlan};
///
/// let plan = SweepPlan {
///     scene: "t-handle".into(),
///     vary: vec!["bodies.0.angular_velocity.1=list(0,5)".parse()?],
///     ..SweepPlan::default()
/// };
/// let sweep = Sweep::new(plan)?;
/// let columns = sweep.columns();
/// assert_eq!(columns[..3], ["world", "bodies.0.angular_velocity.1", "outcome"]);
/// let row = sweep.row(1, &|| false).expect("nothing stops it");
/// assert_eq!(row.outcome, RunStatus::Ok);
/// assert!(row.text.starts_with("1,5.0,ok,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sweep {
    plan: SweepPlan,
    worlds: u64,
    scene: VariedScene,
    scene_hash: u64,
    /// Of each draw, in the order of the fields that it changes.
    varied: Vec<Varied>,
    reported: Vec<usize>,
    reported_names: Vec<String>,
    observables: Vec<Observable>,
    until: Option<Until>,
    files: Vec<PathBuf>,
}

#[derive(Clone, Debug)]
struct Varied {
    distribution: Distribution,
    /// Of a grid: for how many worlds the value stays.
    stride: u64,
    /// By what the value is multiplied in each of its fields.
    factors: Vec<f64>,
}

impl Varied {
    fn values(&self, drawn: f64) -> impl Iterator<Item = f64> {
        self.factors.iter().map(move |factor| drawn * factor)
    }
}

impl Sweep {
    /// Reads the scene, finds the fields, and tries a world with all values at their low ends (or
    /// means) and one with all at their high ends.
    ///
    /// # Errors
    /// [`SweepError`] names what cannot be: the scene, a field, a body, what is to be watched, the
    /// number of worlds.
    pub fn new(plan: SweepPlan) -> Result<Self, SweepError> {
        let SweepPlan { length, dt, substeps, integrator, .. } = plan;
        let repairs = if plan.repair { InertiaRepairs::Made } else { InertiaRepairs::Refused };
        let overrides = RunOverrides { length, dt, substeps, integrator };
        let scene = SceneTemplate::open_with(&plan.scene, overrides, repairs)?;
        let (fields, varied) = find_fields(&plan, &scene)?;
        let names = scene.body_names();
        let reported = reported(&plan.bodies, &names, scene.first_dynamic().unwrap_or(0))?;
        let worlds = worlds(&plan, &varied)?;
        let (observables, until) = watched(&plan, &names)?;
        let reported_names = reported.iter().filter_map(|&i| names.get(i).cloned()).collect();
        let (scene_hash, files) = (scene.hash(), scene.files().to_vec());
        let scene = scene.varied(fields);
        let sweep =
            Self { plan, worlds, scene, scene_hash, varied, reported, reported_names, observables, until, files };
        let ends = |pick: fn(&[f64]) -> Option<&f64>| -> Vec<f64> {
            let ends = sweep.varied.iter().filter_map(|varied| Some((varied, *pick(&varied.distribution.samples())?)));
            ends.flat_map(|(varied, end)| varied.values(end)).collect()
        };
        sweep.build(&ends(<[f64]>::first))?;
        sweep.build(&ends(<[f64]>::last))?;
        Ok(sweep)
    }

    /// What the sweep was made from.
    #[must_use]
    pub fn plan(&self) -> &SweepPlan {
        &self.plan
    }

    /// How many worlds there are.
    #[must_use]
    pub fn worlds(&self) -> u64 {
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

    /// What is watched in each step.
    pub(crate) fn observables(&self) -> &[Observable] {
        &self.observables
    }

    /// What ends a world before its steps are done.
    pub(crate) fn until(&self) -> Option<Until> {
        self.until
    }

    /// The files that the scene was read from: its own and those of meshes.
    #[must_use]
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The values that the varied fields have in a world.
    pub(crate) fn draw(&self, world: u64) -> Vec<f64> {
        let values = self.varied.iter().enumerate().flat_map(|(place, varied)| {
            let seed_of_field = Rng::stream(self.plan.seed, place as u64).next_u64();
            let step = world / varied.stride % varied.distribution.steps();
            varied.values(varied.distribution.draw(Rng::stream(seed_of_field, world), step))
        });
        values.collect()
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
    for SweepParameter { fields: together, distribution } in &plan.vary {
        let mut factors = Vec::with_capacity(together.len());
        for (field, factor) in together {
            let path = find_field(plan, scene, (field, *factor), distribution)?;
            if fields.iter().any(|other| other.same_place(&path)) {
                return Err(FieldError::new(field.as_str(), "is varied twice").into());
            }
            fields.push(path);
            factors.push(*factor);
        }
        found.push(Varied { distribution: distribution.clone(), stride: 1, factors });
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

/// A field that can have the values.
fn find_field(
    plan: &SweepPlan,
    scene: &SceneTemplate,
    (field, factor): (&str, f64),
    distribution: &Distribution,
) -> Result<FieldPath, SweepError> {
    let refuse = |problem: &str| Err(FieldError::new(field, problem).into());
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
    if path.is_count() && !(distribution.is_whole() && factor.fract() == 0.0) {
        return refuse("takes whole numbers: a grid of them, as in grid(1,8,8), or a list, as in list(1,4,16)");
    }
    // Tried on a copy, so that a wrong path is known to be one before any world is made.
    scene.check(&path)?;
    Ok(path)
}

fn worlds(plan: &SweepPlan, varied: &[Varied]) -> Result<u64, SweepError> {
    let only_grids = !varied.is_empty() && varied.iter().all(|varied| varied.distribution.is_stepped());
    match plan.worlds {
        Some(0) => Err(SweepError::Worlds("0: a sweep has one world at least".to_owned())),
        Some(worlds) if worlds > MAX_WORLDS => Err(SweepError::Worlds(format!("{worlds} is more than {MAX_WORLDS}"))),
        Some(worlds) => Ok(worlds),
        None if only_grids => Ok(varied.iter().map(|varied| varied.distribution.steps()).product()),
        None => Err(SweepError::Worlds("N is missing: only grids and lists know how many worlds they make".to_owned())),
    }
}

fn watched(plan: &SweepPlan, names: &[String]) -> Result<(Vec<Observable>, Option<Until>), SweepError> {
    let refused = |option, text: &str, problem| SweepError::Observation { option, text: text.to_owned(), problem };
    let observable =
        |text: &String| Observable::parse(text, names).map_err(|problem| refused("observe", text, problem));
    let until = |text: &String| Until::parse(text, names).map_err(|problem| refused("until", text, problem));
    Ok((plan.observe.iter().map(observable).collect::<Result<_, _>>()?, plan.until.as_ref().map(until).transpose()?))
}

fn reported(wanted: &[String], names: &[String], usual: usize) -> Result<Vec<usize>, SweepError> {
    if wanted.is_empty() {
        return Ok(if names.is_empty() { Vec::new() } else { vec![usual] });
    }
    let find = |name: &String| names.iter().position(|known| known == name);
    wanted.iter().map(|name| find(name).ok_or_else(|| SweepError::Body(name.clone()))).collect()
}
