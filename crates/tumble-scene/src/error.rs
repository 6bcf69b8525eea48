//! Why a scene could not be used, said in one line.

use tumble_import::{FieldError, FileError, printable};

/// Why a scene could not be used.
///
/// `Display` is one [printable] line that names the file, the body (by its name where that could be
/// read, and by its index) and the field, and repeats the offending value.
///
/// ```
/// use tumble_scene::Scene;
///
/// let error = Scene::from_json(
///     r#"{ "bodies": [ { "name": "brick", "mass": -2 } ] }"#,
///     "wall.json",
/// )
/// .unwrap_err();
/// assert!(error.to_string().starts_with("wall.json: body \"brick\" (bodies[0]), field mass: "));
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file cannot be read, is not of its format, or has an impossible value. A scene that is
    /// built in is called a file too.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file name's extension is none of the formats.
    #[error("{}: a scene file ends in .json, .ron, .gltf, .glb or .urdf", printable(.file))]
    UnknownFormat {
        /// The file as the caller named it.
        file: String,
    },
    /// Neither a file nor a built-in scene.
    #[error(
        "no scene is called {name:?}{} built-in scenes are {known}; \
         the name of a file has an extension or a slash",
        nearest.map_or("; the".to_owned(), |nearest| format!(": did you mean {nearest:?}? The"))
    )]
    UnknownName {
        /// The name that was looked for.
        name: String,
        /// The built-in names, separated by commas.
        known: String,
        /// That of them that is most like it, if any is.
        nearest: Option<&'static str>,
    },
    /// The scene is generated, and its bodies have no fields that could vary.
    #[error("the {name} scene cannot be swept: it is generated, and has no fields to vary")]
    Generated {
        /// The scene's name.
        name: String,
    },
    /// A size or a seed was given for a scene that is not generated from it.
    #[error("--{option} goes with scenes that are generated from it, not with {name:?}")]
    NotGenerated {
        /// `"bodies"` or `"seed"`, as the programs' options are called.
        option: &'static str,
        /// The file or name.
        name: String,
    },
}

tumble_math::debug_as_display!(SceneError);

/// The error of a scene or one of its bodies, in a file.
pub(crate) fn invalid(file: &str, body: Option<(usize, Option<String>)>, error: FieldError) -> SceneError {
    error.in_file(file, body).into()
}
