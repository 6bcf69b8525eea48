//! Checks of output file extensions, and the trajectory format that an extension selects.

use std::path::Path;

use tumble_record::TrajectoryFormat;

use crate::failure::Failure;

/// A file is to have the ending of what is written into it.
pub(crate) fn check_ending(path: &Path, what: &str, ending: &str) -> Result<(), Failure> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending)) {
        Ok(())
    } else {
        Err(Failure::Input(format!("{}: the name of {what} ends in .{ending}", path.display())))
    }
}

/// The format of a record, by the ending of its name.
pub(crate) fn trajectory_format(path: &Path) -> Result<TrajectoryFormat, Failure> {
    match TrajectoryFormat::of_path(path) {
        Some(TrajectoryFormat::Parquet) if !cfg!(feature = "parquet") => Err(Failure::Input(format!(
            "{}: this program was built without Parquet, build it with --features parquet",
            path.display()
        ))),
        Some(format) => Ok(format),
        None => {
            let endings = TrajectoryFormat::ALL.map(|format| format!(".{}", format.ending())).join(", ");
            Err(Failure::Input(format!("{}: the name of a record ends in one of {endings}", path.display())))
        }
    }
}
