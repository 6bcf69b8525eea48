//! The settings of a scene.

use tumble::{Settings, Sleep};
use tumble_import::FieldError;
use tumble_import::checked::{finite, real, real_vector};

use crate::limits::{step_count, time_step};
use crate::model::scene_model::SceneModel;
use crate::scene::DEFAULT_STEPS;
use crate::values::checked::finite_triple;

/// Settings and number of steps.
pub(crate) fn settings(model: &SceneModel) -> Result<(Settings, u64), FieldError> {
    let mut settings = Settings::default();
    if let Some(gravity) = &model.gravity {
        settings = settings.with_gravity(real_vector(finite_triple("gravity", gravity)?));
    }
    if let Some(dt) = model.dt {
        settings = settings.with_dt(time_step(dt).map_err(|problem| FieldError::new("dt", problem))?);
    }
    if let Some(substeps) = model.substeps {
        settings = settings.with_substeps(substeps);
    }
    if let Some(integrator) = &model.integrator {
        let integrator = integrator.parse().map_err(|error| FieldError::new("integrator", error))?;
        settings = settings.with_integrator(integrator);
    }
    if let Some(substeps) = model.contact_substeps {
        settings = settings.with_contact_substeps(substeps);
    }
    if let Some(speed) = model.restitution_threshold {
        let speed = finite("restitution_threshold", speed)?;
        settings = settings.with_restitution_threshold(real(speed));
    }
    if let Some(solver) = &model.joint_solver {
        let solver = solver.parse().map_err(|error| FieldError::new("joint_solver", error))?;
        settings = settings.with_joint_solver(solver);
    }
    if let Some(sleep) = &model.sleep {
        let Sleep { speed, time } = Sleep::default();
        let number = |name, value: Option<f64>, otherwise| value.map_or(Ok(otherwise), |it| finite(name, it).map(real));
        let (speed, time) = (number("sleep.speed", sleep.speed, speed)?, number("sleep.time", sleep.time, time)?);
        settings = settings.with_sleep(Sleep { speed, time });
    }
    settings.validate().map_err(|error| FieldError::new(error.field(), error))?;
    let steps = step_count(model.steps.unwrap_or(DEFAULT_STEPS));
    Ok((settings, steps.map_err(|problem| FieldError::new("steps", problem))?))
}
