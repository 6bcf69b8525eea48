//! A scene with fields that differ from world to world.

pub(crate) mod distribution;
pub(crate) mod field_path;
pub(crate) mod force_path;
pub(crate) mod run_status;
pub(crate) mod shard;
pub(crate) mod sweep_error;
pub(crate) mod sweep_file;
pub(crate) mod sweep_identity;
pub(crate) mod sweep_parameter;

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::PathBuf;

use hecs::World;
use tumble::math::Real;
use tumble::{Integrator, Rng, Settings, SettingsError, Trial};
use tumble_import::{FieldError, one_line, read_text};

use crate::bodies::scene_body::SceneBody;
use crate::error::{SceneError, invalid};
use crate::limits::steps_of_duration;
use crate::scene::convert::forces::Others;
use crate::scene::model::{BodyModel, SceneModel};
use crate::scene::parse::{Format, parse};
use crate::scene::{Scene, builtin, contact_scenes, convert, is_path, settings, unknown};
use crate::sweep::distribution::Distribution;
use crate::sweep::field_path::FieldPath;
use crate::sweep::sweep_error::SweepError;
use crate::sweep::sweep_parameter::SweepParameter;

/// The most worlds of a sweep.
pub const MAX_WORLDS: u64 = 1_000_000_000_000;

/// How long a world is run.
///
/// ```
/// use tumble_scene::{RunLength, Sweep, SweepPlan};
///
/// let length = Some(RunLength::Steps(50));
/// let sweep = Sweep::new(SweepPlan { scene: "t-handle".into(), worlds: Some(1), length, ..SweepPlan::default() })?;
/// assert_eq!(sweep.build(&[])?.steps, 50);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RunLength {
    /// Number of steps.
    Steps(u64),
    /// So much simulated time \[s\], rounded to whole steps of the world's own length.
    Duration(f64),
}

/// What a [`Sweep`] is to be; everything but the scene may be left at its default.
///
/// ```
/// use tumble_scene::{Sweep, SweepPlan};
///
/// let plan = SweepPlan { scene: "t-handle".into(), vary: vec!["gravity.1=grid(-10,0,3)".parse()?], ..SweepPlan::default() };
/// assert_eq!(Sweep::new(plan)?.worlds(), 3); // each value of the grid once
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweepPlan {
    /// A file, or the name of a built-in scene, as for [`Scene::open`].
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
    /// The bodies whose end is of interest, by name; the first one if none is named.
    pub bodies: Vec<String>,
}

/// A scene with fields that differ from world to world: at random, or over the values of a grid.
///
/// A field is named by its path in the file: `gravity.1`, `dt`, `bodies.0.mass`,
/// `bodies.brick.angular_velocity.2`, `bodies.0.shape.cuboid.half_extents.0`; bodies go by index or
/// name, and `bodies[0]` is understood too. The value of a field in a world depends on the seed,
/// the place of the field among those that are varied, and the index of the world, and on nothing
/// else. Several grids make all combinations, the last one changing fastest; past the last
/// combination they start over.
///
/// ```
/// use tumble_scene::{Sweep, SweepPlan};
///
/// let vary = vec!["bodies.0.angular_velocity.1=0..5".parse()?, "gravity.1=grid(-10,0,3)".parse()?];
/// let plan = SweepPlan { scene: "t-handle".into(), worlds: Some(100), seed: 7, vary, ..SweepPlan::default() };
/// let sweep = Sweep::new(plan)?;
/// let drawn = sweep.draw(4);
/// assert_eq!(drawn[1], -5.0);
/// let mut world = sweep.build(&drawn)?;
/// world.trial.step_many(10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sweep {
    plan: SweepPlan,
    worlds: u64,
    scene_hash: u64,
    /// The scene without its bodies.
    head: SceneModel,
    bodies: Vec<SceneBody>,
    /// The bodies in which something varies, and those with a spring whose length that changes.
    varied_bodies: BTreeMap<usize, BodyModel>,
    /// The other bodies to which springs of those lead.
    neighbours: BTreeMap<usize, BodyModel>,
    /// Indices of all bodies, where there are springs.
    by_name: HashMap<String, usize>,
    varied: Vec<Varied>,
    reported: Vec<usize>,
    reported_names: Vec<String>,
    files: Vec<PathBuf>,
}

#[derive(Clone, Debug)]
struct Varied {
    field: FieldPath,
    distribution: Distribution,
    /// Of a grid: for how many worlds the value stays.
    stride: u64,
}

/// A world of a sweep at its start.
///
/// ```
/// use tumble_scene::{Sweep, SweepPlan};
///
/// let sweep = Sweep::new(SweepPlan { scene: "t-handle".into(), worlds: Some(1), ..SweepPlan::default() })?;
/// let mut world = sweep.build(&sweep.draw(0))?;
/// world.trial.step_many(10);
/// assert!(world.steps > 10); // as many as the scene says
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SweepWorld {
    /// The world and its simulation.
    pub trial: Trial,
    /// How many steps it is to be run.
    pub steps: u64,
}

impl Sweep {
    /// Reads the scene, finds the fields, and tries a world with all values at their low ends (or
    /// means) and one with all at their high ends.
    ///
    /// # Errors
    /// [`SweepError`], whose message names the field.
    pub fn new(plan: SweepPlan) -> Result<Self, SweepError> {
        let (mut model, text_hash) = scene_model(&plan.scene)?;
        apply(&plan, &mut model);
        let scene = Scene::from_model(&model, &plan.scene)?;
        let varied = find_fields(&plan, &model)?;
        let names: Vec<String> = model.bodies.iter().enumerate().map(|(i, body)| convert::name(body, i)).collect();
        let reported = reported(&plan.bodies, &names)?;
        let by_name = convert::indices(&model.bodies);
        let (varied_bodies, neighbours) = varied_bodies(&varied, &model.bodies, &by_name);
        let head = SceneModel {
            gravity: model.gravity,
            dt: model.dt,
            steps: model.steps,
            substeps: model.substeps,
            integrator: model.integrator.clone(),
            contact_substeps: model.contact_substeps,
            restitution_threshold: model.restitution_threshold,
            ..SceneModel::default()
        };
        let worlds = worlds(&plan, &varied)?;
        let bodies = scene.into_bodies();
        let reported_names = reported.iter().filter_map(|&i| names.get(i).cloned()).collect();
        let scene_hash = text_hash ^ model.meshes_hash;
        let own_file = is_path(&plan.scene).then(|| PathBuf::from(&plan.scene));
        let files = own_file.into_iter().chain(model.files).collect();
        let sweep = Self {
            plan,
            worlds,
            scene_hash,
            head,
            bodies,
            varied_bodies,
            neighbours,
            by_name,
            varied,
            reported,
            reported_names,
            files,
        };
        let ends = |pick: fn(&[f64]) -> Option<&f64>| -> Vec<f64> {
            sweep.varied.iter().filter_map(|varied| pick(&varied.distribution.samples()).copied()).collect()
        };
        sweep.build(&ends(<[f64]>::first))?;
        sweep.build(&ends(<[f64]>::last))?;
        Ok(sweep)
    }

    /// What the sweep was made from.
    pub fn plan(&self) -> &SweepPlan {
        &self.plan
    }

    /// How many worlds there are.
    pub fn worlds(&self) -> u64 {
        self.worlds
    }

    /// A hash of the scene's text, by which two sweeps are told apart.
    pub(crate) fn scene_hash(&self) -> u64 {
        self.scene_hash
    }

    /// The paths of the varied fields, in the order of [`draw`](Self::draw).
    pub fn fields(&self) -> impl Iterator<Item = &str> {
        self.varied.iter().map(|varied| varied.field.text())
    }

    /// The bodies whose end is of interest, by their [`BodyId`](tumble::BodyId).
    pub fn reported(&self) -> &[usize] {
        &self.reported
    }

    /// Their names.
    pub fn reported_names(&self) -> &[String] {
        &self.reported_names
    }

    /// The files that the scene was read from: its own and those of meshes.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The values that the varied fields have in a world.
    pub fn draw(&self, world: u64) -> Vec<f64> {
        let value = |(place, varied): (usize, &Varied)| {
            let seed_of_field = Rng::stream(self.plan.seed, place as u64).next_u64();
            let step = world / varied.stride % varied.distribution.steps();
            varied.distribution.draw(Rng::stream(seed_of_field, world), step)
        };
        self.varied.iter().enumerate().map(value).collect()
    }

    /// Makes the world in which the varied fields have these values.
    ///
    /// # Errors
    /// [`SceneError`] where no body, or no simulation, can have them.
    pub fn build(&self, values: &[f64]) -> Result<SweepWorld, SceneError> {
        let file = &self.plan.scene;
        let mut head = self.head.clone();
        let mut varied_bodies = self.varied_bodies.clone();
        for (varied, &value) in self.varied.iter().zip(values) {
            let set = match varied.field.body().and_then(|index| varied_bodies.get_mut(&index)) {
                Some(body) => varied.field.set_in_body(body, value),
                None => varied.field.set_in_scene(&mut head, value),
            };
            set.map_err(|error| invalid(file, None, error))?;
        }
        let (settings, steps) = settings(&head).map_err(|error| invalid(file, None, error))?;
        let steps = self.steps(&settings, steps).map_err(|error| invalid(file, None, error))?;
        let find = |index: usize| varied_bodies.get(&index).or_else(|| self.neighbours.get(&index));
        let others = Others { by_name: &self.by_name, model: &find };
        let mut remade = BTreeMap::new();
        for (&index, model) in &varied_bodies {
            let body = convert::body(model, index, others);
            remade.insert(index, body.map_err(|problems| impossible(file, index, model, problems))?);
        }
        let mut world = World::new();
        let bodies = self.bodies.iter().enumerate().map(|(index, body)| remade.get(&index).unwrap_or(body));
        SceneBody::spawn_all(bodies, &mut world);
        let refused = |error: SettingsError| invalid(file, None, FieldError::new(error.field(), error));
        let trial = Trial::new(settings, world).map_err(refused)?;
        Ok(SweepWorld { trial, steps })
    }

    fn steps(&self, settings: &Settings, of_scene: u64) -> Result<u64, FieldError> {
        match self.plan.length {
            Some(RunLength::Duration(seconds)) => {
                steps_of_duration(seconds, settings.dt).map_err(|problem| FieldError::new("dt", problem))
            }
            Some(RunLength::Steps(_)) | None => Ok(of_scene),
        }
    }
}

/// Models of the bodies to be made for every world, and of those that are reported then.
fn varied_bodies(
    varied: &[Varied],
    bodies: &[BodyModel],
    by_name: &HashMap<String, usize>,
) -> (BTreeMap<usize, BodyModel>, BTreeMap<usize, BodyModel>) {
    let varied: BTreeSet<usize> = varied.iter().filter_map(|varied| varied.field.body()).collect();
    let is_remade = |(index, body): &(usize, &BodyModel)| {
        varied.contains(index) || convert::springs_by_distance(body, by_name).any(|to| varied.contains(&to))
    };
    let remade: BTreeMap<_, _> =
        bodies.iter().enumerate().filter(is_remade).map(|(index, body)| (index, body.clone())).collect();
    let leads_to = remade.values().flat_map(|body| convert::springs_by_distance(body, by_name));
    let seen = leads_to.filter(|to| !remade.contains_key(to));
    let neighbours = seen.filter_map(|to| Some((to, bodies.get(to)?.clone()))).collect();
    (remade, neighbours)
}

fn impossible(file: &str, index: usize, model: &BodyModel, problems: Vec<FieldError>) -> SceneError {
    let first = problems.into_iter().next();
    let place = Some((index, Some(convert::name(model, index))));
    invalid(file, place, first.unwrap_or_else(|| FieldError::new("body", "is impossible")))
}

/// The scene, and a hash of its text; of one that is made, of what it is made of.
fn scene_model(name: &str) -> Result<(SceneModel, u64), SweepError> {
    let parsed = |text: &str, format| Ok((parse(text, format, name)?, fnv1a(text)));
    if is_path(name) {
        let path = std::path::Path::new(name);
        let format = Format::of_path(path).ok_or_else(|| SceneError::UnknownFormat { file: one_line(name) })?;
        return parsed(&read_text(path).map_err(SceneError::from)?, format);
    }
    if name == builtin::STRESS {
        return Err(SweepError::Stress);
    }
    match (builtin::text(name), contact_scenes::named(name)) {
        (Some(text), _) => parsed(text, Format::Json),
        (None, Some(scene)) => {
            let model = scene.model(None, None);
            let hash = fnv1a(&format!("{model:?}"));
            Ok((model, hash))
        }
        (None, None) => Err(unknown(name).into()),
    }
}

/// What the plan says instead of the scene.
#[allow(clippy::useless_conversion, reason = "dt is f64 already in one of the two builds")]
fn apply(plan: &SweepPlan, model: &mut SceneModel) {
    model.dt = plan.dt.map(f64::from).or(model.dt);
    model.substeps = plan.substeps.or(model.substeps);
    if let Some(integrator) = plan.integrator {
        model.integrator = Some(integrator.name().to_owned());
    }
    if let Some(RunLength::Steps(steps)) = plan.length {
        model.steps = Some(steps);
    }
}

fn find_fields(plan: &SweepPlan, model: &SceneModel) -> Result<Vec<Varied>, SweepError> {
    let mut found: Vec<Varied> = Vec::with_capacity(plan.vary.len());
    for SweepParameter { field, distribution } in &plan.vary {
        let refuse = |problem: &str| Err(FieldError::new(field.as_str(), problem).into());
        let path = FieldPath::new(field, model)?;
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
        if found.iter().any(|other| other.field.same_place(&path)) {
            return refuse("is varied twice");
        }
        if path.is_count() && !distribution.is_whole() {
            return refuse("takes whole numbers: a grid of them, as in grid(1,8,8)");
        }
        // Tried on a copy, so that a wrong path is known to be one before any world is made.
        match path.body().and_then(|index| model.bodies.get(index)) {
            Some(body) => path.set_in_body(&mut body.clone(), 0.0)?,
            None => path.set_in_scene(&mut SceneModel { bodies: Vec::new(), ..model.clone() }, 0.0)?,
        }
        found.push(Varied { field: path, distribution: *distribution, stride: 1 });
    }
    let mut stride = 1;
    for varied in found.iter_mut().rev() {
        varied.stride = stride;
        stride = match stride.checked_mul(varied.distribution.steps()) {
            Some(product) if product <= MAX_WORLDS => product,
            _ => return Err(SweepError::Worlds(format!("the grids have more than {MAX_WORLDS} combinations"))),
        };
    }
    Ok(found)
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

/// 64-bit FNV-1a of a text.
fn fnv1a(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}
