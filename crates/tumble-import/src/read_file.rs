//! A file's text, with a reason for every file that has none.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use crate::error::FileError;
use crate::limits::MAX_FILE_BYTES;
use crate::terminal::one_line;

/// Reads a regular UTF-8 file of at most [`MAX_FILE_BYTES`].
///
/// # Errors
/// [`FileError`] if it cannot be read, is too large or is not text.
///
/// ```
/// assert!(tumble_import::read_text("missing.json".as_ref()).is_err());
/// ```
pub fn read_text(path: &Path) -> Result<String, FileError> {
    read_limited(path, MAX_FILE_BYTES)
}

/// Reads a regular UTF-8 file of at most `limit` bytes.
pub(crate) fn read_limited(path: &Path, limit: u64) -> Result<String, FileError> {
    let not_text = |offset| FileError::NotText { file: one_line(&path.to_string_lossy()), offset };
    String::from_utf8(read_bytes(path, limit)?).map_err(|error| not_text(error.utf8_error().valid_up_to()))
}

/// Reads a regular file of at most `limit` bytes.
///
/// # Errors
/// [`FileError`] if it cannot be read or is too large.
///
/// ```
/// assert!(tumble_import::read_bytes("missing.glb".as_ref(), 1 << 20).is_err());
/// ```
pub fn read_bytes(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let file = one_line(&path.to_string_lossy());
    let unreadable = |reason: String| FileError::Unreadable { file: file.clone(), reason };
    // Asked before opening, for opening a pipe waits for its other end.
    let metadata = fs::metadata(path).map_err(|error| unreadable(error.to_string()))?;
    if metadata.is_dir() {
        return Err(unreadable("it is a directory".to_owned()));
    }
    if !metadata.is_file() {
        return Err(unreadable("it is not a regular file".to_owned()));
    }
    let mut bytes = Vec::new();
    // One byte more than allowed tells a file that grew from one that just fits.
    File::open(path)
        .and_then(|opened| opened.take(limit + 1).read_to_end(&mut bytes))
        .map_err(|error| unreadable(error.to_string()))?;
    if bytes.len() as u64 > limit {
        return Err(FileError::TooLarge { file, limit });
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_may_be_as_large_as_the_limit_and_no_larger() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("scene.json");
        fs::write(&path, "12345").unwrap();
        assert_eq!(read_limited(&path, 5).unwrap(), "12345");
        let error = read_limited(&path, 4).unwrap_err();
        assert!(matches!(error, FileError::TooLarge { limit: 4, .. }), "{error}");
    }

    #[test]
    fn what_is_not_text_says_where() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("scene.json");
        fs::write(&path, b"{ \"\xff\" }").unwrap();
        assert!(matches!(read_text(&path), Err(FileError::NotText { offset: 3, .. })));
    }

    #[test]
    fn what_is_not_a_file_says_so() {
        let directory = tempfile::tempdir().unwrap();
        let error = read_text(directory.path()).unwrap_err();
        assert!(error.to_string().ends_with("cannot be read: it is a directory"), "{error}");
        let error = read_text(&directory.path().join("missing.json")).unwrap_err();
        assert!(matches!(error, FileError::Unreadable { .. }), "{error}");
    }
}
