//! Exceptions. Their classes are in `tumble/_errors.py`, one for both precisions.

use pyo3::prelude::*;
use tumble::SnapshotError;
use tumble_import::FileError;
use tumble_scene::SceneError;
use tumble_sweep::{SweepError, SweepFileError};

/// What is raised in Python.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A scene cannot be used.
    Scene(Box<SceneError>),
    /// A world of a batch cannot be made.
    World { world: usize, error: Box<SceneError> },
    /// An argument has an impossible value.
    Argument { field: String, problem: String },
    /// An argument is of another type.
    Type { field: String, problem: String },
    /// A snapshot cannot be taken or restored.
    Snapshot(Box<SnapshotError>),
    /// A body, or a sum over all, is not finite any more.
    NotFinite,
    /// A snapshot is of another scene: it has no body of this index.
    Foreign(u64),
    /// The file of a sweep cannot be used.
    SweepFile(Box<SweepFileError>),
}

impl Failure {
    pub(crate) fn argument(field: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Argument { field: field.into(), problem: problem.into() }
    }

    pub(crate) fn type_of(field: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Type { field: field.into(), problem: problem.into() }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<SnapshotError> for Failure {
    fn from(error: SnapshotError) -> Self {
        Self::Snapshot(Box::new(error))
    }
}

impl From<SweepFileError> for Failure {
    fn from(error: SweepFileError) -> Self {
        Self::SweepFile(Box::new(error))
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Scene(error) => error.into(),
            SweepError::Field { field, problem } => Self::argument(format!("vary[{field:?}]"), problem),
            SweepError::Body(name) => Self::argument("bodies", format!("the scene has no {name:?}")),
            SweepError::Observation { option, text, problem } => Self::argument(option, format!("{text:?} {problem}")),
            SweepError::Worlds(problem) => Self::argument("worlds", problem),
            other => Self::argument("sweep", other.to_string()),
        }
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        Python::attach(|py| raised(py, &failure).unwrap_or_else(|error| error))
    }
}

/// The exception of a failure; an error is that of making it.
fn raised(py: Python<'_>, failure: &Failure) -> PyResult<PyErr> {
    let module = py.import("tumble._errors")?;
    let exception = match failure {
        Failure::Scene(error) => {
            let (file, body, field) = place(error);
            module.getattr("SceneError")?.call1((error.to_string(), file, body, field))?
        }
        Failure::World { world, error } => {
            let (file, body, field) = place(error);
            module.getattr("SceneError")?.call1((format!("world {world}: {error}"), file, body, field))?
        }
        Failure::Argument { field, problem } => {
            module.getattr("ArgumentError")?.call1((format!("{field}: {problem}"), field))?
        }
        Failure::Type { field, problem } => {
            module.getattr("ArgumentTypeError")?.call1((format!("{field}: {problem}"), field))?
        }
        Failure::SweepFile(error) => match error.as_ref() {
            SweepFileError::Io { path, error } => {
                let (number, text) = (error.raw_os_error(), error.to_string());
                py.import("builtins")?.getattr("OSError")?.call1((number, text, path.as_path()))?
            }
            other => module.getattr("SweepFileError")?.call1((other.to_string(),))?,
        },
        Failure::NotFinite => {
            let text = "the state of a body, or a sum over all bodies, is not finite";
            module.getattr("TumbleError")?.call1((text,))?
        }
        Failure::Foreign(body) => {
            let text = format!("the snapshot is of another scene: it has no body of index {body}");
            module.getattr("SnapshotError")?.call1((text,))?
        }
        Failure::Snapshot(error) => module.getattr("SnapshotError")?.call1((error.to_string(),))?,
    };
    Ok(PyErr::from_value(exception))
}

type Place = (Option<String>, Option<String>, Option<String>);

/// File, body and field that an error names.
fn place(error: &SceneError) -> Place {
    match error {
        SceneError::File(error) => place_in_file(error),
        SceneError::UnknownFormat { file } => (Some(file.clone()), None, None),
        SceneError::UnknownName { name, .. }
        | SceneError::Generated { name }
        | SceneError::NotGenerated { name, .. } => (Some(name.clone()), None, None),
        _ => (None, None, None),
    }
}

fn place_in_file(error: &FileError) -> Place {
    match error {
        FileError::Malformed { file, place, .. }
        | FileError::Invalid { file, place, .. }
        | FileError::TooMuch { file, place, .. } => {
            let body = place.body.as_ref().map(|(index, name)| name.clone().unwrap_or(format!("bodies[{index}]")));
            (Some(file.clone()), body, Some(place.field.clone()).filter(|field| !field.is_empty()))
        }
        FileError::Link { file, link, field, .. } => (Some(file.clone()), Some(link.clone()), Some(field.clone())),
        FileError::Unreadable { file, .. }
        | FileError::TooLarge { file, .. }
        | FileError::NotText { file, .. }
        | FileError::UnknownFormat { file } => (Some(file.clone()), None, None),
        _ => (None, None, None),
    }
}
