use std::path::Path;

use crate::failure::Failure;

/// A file is to have the ending of what is written into it.
pub(crate) fn check_ending(path: &Path, what: &str, ending: &str) -> Result<(), Failure> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending)) {
        Ok(())
    } else {
        Err(Failure::Input(format!("{}: the name of {what} ends in .{ending}", path.display())))
    }
}
