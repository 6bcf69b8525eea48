//! What a scene is stepped with, as arguments of Python.

use pyo3::prelude::*;
use tumble::math::Vec3;
use tumble::{Integrator, Settings, SettingsError};

use crate::arrays::{finite, real, shape_of};
use crate::error::Failure;

/// What goes in the place of what a scene says.
#[derive(Clone, Copy, Default)]
pub(crate) struct Overrides {
    dt: Option<f64>,
    substeps: Option<u32>,
    contact_substeps: Option<u32>,
    gravity: Option<Vec3>,
    integrator: Option<Integrator>,
    sleep: Option<bool>,
}

/// Arguments of Python for [`Overrides`].
pub(crate) struct Options<'py> {
    pub(crate) dt: Option<f64>,
    pub(crate) substeps: Option<i64>,
    pub(crate) contact_substeps: Option<i64>,
    pub(crate) gravity: Option<Bound<'py, PyAny>>,
    pub(crate) integrator: Option<String>,
    pub(crate) sleep: Option<bool>,
}

impl Overrides {
    pub(crate) fn read(options: &Options<'_>) -> PyResult<Self> {
        let counted = |field, value: Option<i64>| value.map(|value| count(field, value)).transpose();
        let mut overrides = Self {
            dt: options.dt,
            substeps: counted("substeps", options.substeps)?,
            contact_substeps: counted("contact_substeps", options.contact_substeps)?,
            sleep: options.sleep,
            ..Self::default()
        };
        if let Some(gravity) = &options.gravity {
            let numbers = finite(gravity, "gravity", &[3])?;
            if shape_of(gravity, "gravity")? != [3] {
                return Err(Failure::argument("gravity", "a vector of three numbers is needed").into());
            }
            overrides.gravity = Some(<[_; 3]>::try_from(numbers).map(Vec3::from).unwrap_or_default());
        }
        if let Some(integrator) = &options.integrator {
            let parsed = integrator.parse::<Integrator>();
            overrides.integrator = Some(parsed.map_err(|error| Failure::argument("integrator", error.to_string()))?);
        }
        Ok(overrides)
    }

    /// Whether the field at a path of a scene is overridden.
    pub(crate) fn sets(&self, field: &str) -> bool {
        match field.split(['.', '[']).next().unwrap_or_default() {
            "dt" => self.dt.is_some(),
            "substeps" => self.substeps.is_some(),
            "contact_substeps" => self.contact_substeps.is_some(),
            "gravity" => self.gravity.is_some(),
            "sleep" => self.sleep.is_some(),
            _ => false,
        }
    }

    /// The settings of a scene with them.
    pub(crate) fn apply(&self, mut settings: Settings) -> Result<Settings, Failure> {
        if let Some(dt) = self.dt {
            let dt = tumble_scene::time_step(dt);
            settings = settings.with_dt(dt.map_err(|problem| Failure::argument("dt", problem))?);
        }
        settings.substeps = self.substeps.unwrap_or(settings.substeps);
        settings.contact_substeps = self.contact_substeps.unwrap_or(settings.contact_substeps);
        settings.gravity = self.gravity.unwrap_or(settings.gravity);
        settings.integrator = self.integrator.unwrap_or(settings.integrator);
        if let Some(sleeps) = self.sleep {
            settings = settings.with_sleep(sleeps.then(|| settings.sleep.unwrap_or_default()));
        }
        settings.validate().map_err(refused)?;
        Ok(settings)
    }
}

pub(crate) fn refused(error: SettingsError) -> Failure {
    let (field, text) = (error.field(), error.to_string());
    let problem = text.strip_prefix(&format!("{field} ")).unwrap_or(&text);
    Failure::argument(field, problem)
}

/// A number of steps or parts.
pub(crate) fn count(field: &str, value: i64) -> PyResult<u32> {
    let count = u32::try_from(value);
    Ok(count.map_err(|_| Failure::argument(field, format!("{value} is not between 0 and {}", u32::MAX)))?)
}

/// A length or a time that may be infinite.
pub(crate) fn not_negative(field: &str, value: f64) -> PyResult<tumble::math::Real> {
    if value >= 0.0 {
        Ok(real(value))
    } else {
        Err(Failure::argument(field, format!("{value} is negative or no number")).into())
    }
}
