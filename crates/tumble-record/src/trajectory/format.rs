//! Trajectory file formats and their extensions.

use std::path::Path;

/// The formats of a record, each with an ending of its own.
///
/// ```
/// use std::path::Path;
/// use tumble_record::TrajectoryFormat;
///
/// assert_eq!(TrajectoryFormat::of_path(Path::new("run.GLB")), Some(TrajectoryFormat::Glb));
/// assert_eq!(TrajectoryFormat::of_path(Path::new("run.txt")), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrajectoryFormat {
    /// `.csv`, comma-separated values.
    Csv,
    /// `.parquet`, Apache Parquet; written with the cargo feature `parquet` only.
    Parquet,
    /// `.glb`, binary glTF.
    Glb,
}

impl TrajectoryFormat {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Csv, Self::Parquet, Self::Glb];

    /// The format of a file with this name, by its ending, in either case.
    #[must_use]
    pub fn of_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?;
        Self::ALL.into_iter().find(|format| ending.eq_ignore_ascii_case(format.ending()))
    }

    /// The ending without the dot.
    #[must_use]
    pub fn ending(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Glb => "glb",
        }
    }
}
