//! Makes the worlds of a batch, which may differ in numbers of the scene.

use hecs::World;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use tumble::Trial;
use tumble_scene::{FieldPath, VariedScene};

use crate::arrays::doubles;
use crate::error::Failure;
use crate::joints;
use crate::scene::Scene;
use crate::settings::{Overrides, refused};
use crate::state::Layout;
use crate::threads::pool;

/// What worlds are made of.
pub(crate) struct Maker {
    pub(crate) overrides: Overrides,
    pub(crate) varied: Option<Varied>,
}

/// A scene in which fields differ from world to world.
pub(crate) struct Varied {
    scene: VariedScene,
    fields: Vec<String>,
    /// Of each world the values of all fields.
    pub(crate) values: Vec<f64>,
}

impl Varied {
    pub(crate) fn read(
        scene: &Scene,
        vary: &Bound<'_, PyDict>,
        worlds: usize,
        overrides: &Overrides,
    ) -> PyResult<Self> {
        let template = scene.template()?;
        if template.body_names() != scene.names {
            let problem = format!("{} has changed since the scene was read", scene.scene.origin);
            return Err(Failure::argument("scene", problem).into());
        }
        let mut found: Vec<FieldPath> = Vec::new();
        let mut columns = Vec::new();
        for (path, value) in vary {
            let path: String = path.extract().map_err(|_| Failure::type_of("vary", "keys are paths of fields"))?;
            let name = format!("vary[{path:?}]");
            let field = template.field(&path).map_err(|error| Failure::argument(name.as_str(), error.problem))?;
            template.check(&field).map_err(|error| Failure::argument(name.as_str(), error.problem))?;
            if overrides.sets(&path) {
                return Err(Failure::argument(name, "the same is given for all worlds").into());
            }
            if found.iter().any(|other| other.same_place(&field)) {
                return Err(Failure::argument(name, "is there twice").into());
            }
            columns.push(doubles(&value, &name, &[worlds])?);
            found.push(field);
        }
        let row = |world: usize| columns.iter().filter_map(move |column| column.get(world).copied());
        let values = (0..worlds).flat_map(row).collect();
        let fields = found.iter().map(|field| field.text().to_owned()).collect();
        Ok(Self { scene: template.varied(found), fields, values })
    }

    /// Takes other values for the chosen worlds.
    pub(crate) fn change(&self, vary: &Bound<'_, PyDict>, chosen: &[usize]) -> PyResult<Vec<f64>> {
        let (mut values, width) = (self.values.clone(), self.fields.len());
        for (path, value) in vary {
            let path: String = path.extract().map_err(|_| Failure::type_of("vary", "keys are paths of fields"))?;
            let name = format!("vary[{path:?}]");
            let known = self.fields.iter().position(|field| *field == path);
            let known = known
                .ok_or_else(|| Failure::argument(name.as_str(), format!("varies {} only", self.fields.join(", "))))?;
            for (&world, value) in chosen.iter().zip(doubles(&value, &name, &[chosen.len()])?) {
                if let Some(place) = values.get_mut(world * width + known) {
                    *place = value;
                }
            }
        }
        Ok(values)
    }
}

impl Maker {
    fn make(&self, scene: &Scene, values: &[f64], world: usize) -> Result<Trial, Failure> {
        let mut trial = match &self.varied {
            None => {
                let mut world = World::new();
                scene.scene.clone().spawn(&mut world)?;
                Trial::new(scene.scene.settings, world).map_err(refused)?
            }
            Some(Varied { scene, fields, .. }) => {
                let begin = world * fields.len();
                let values = values.get(begin..begin + fields.len()).unwrap_or_default();
                let made = scene.build(values).map_err(|error| Failure::World { world, error: Box::new(error) });
                made?.trial
            }
        };
        let settings = self.overrides.apply(*trial.simulation.settings())?;
        trial.simulation.set_settings(settings).map_err(refused)?;
        let joints = Layout::of(&trial.world, &[], &[]).joints;
        joints::watch(&mut trial.world, &joints);
        Ok(trial)
    }

    /// Makes the chosen worlds, or none of them.
    pub(crate) fn make_all(
        &self,
        py: Python<'_>,
        scene: &Scene,
        values: &[f64],
        chosen: &[usize],
    ) -> PyResult<Vec<Trial>> {
        let pool = pool()?;
        let made: Vec<_> =
            py.detach(|| pool.install(|| chosen.par_iter().map(|&world| self.make(scene, values, world)).collect()));
        // One after the other: the first world that is impossible is named.
        Ok(made.into_iter().collect::<Result<_, Failure>>()?)
    }

    /// Of each world what it was made with.
    pub(crate) fn values(&self) -> &[f64] {
        self.varied.as_ref().map_or(&[], |varied| &varied.values)
    }
}
