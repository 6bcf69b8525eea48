//! The files that a document is made of: its own, and those that it names.

use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use crate::error::{FileError, Place};
use crate::limits::MAX_FILE_BYTES;
use crate::read_file::read_bytes;

/// Most bytes of all the files that one document names, each counted once: four of the largest
/// \[bytes\].
pub(crate) const MAX_BYTES: u64 = 4 * MAX_FILE_BYTES;

/// Reads files, as long as there is room for them.
///
/// ```
/// use tumble_import::Reading;
///
/// let mut reading = Reading::default();
/// assert!(reading.file("missing.obj".as_ref()).is_err());
/// assert!(reading.into_files().is_empty());
/// ```
#[derive(Debug)]
pub struct Reading {
    room: u64,
    /// What has been read, by its place on the disk.
    files: Vec<PathBuf>,
    /// Kept, for many may name them.
    buffers: HashMap<PathBuf, Arc<Vec<u8>>>,
}

impl Default for Reading {
    fn default() -> Self {
        Self { room: MAX_BYTES, files: Vec::new(), buffers: HashMap::new() }
    }
}

impl Reading {
    /// Reads a file once more each time it is asked for.
    ///
    /// # Errors
    /// [`FileError`] if it cannot be read, or there is no room for it.
    pub fn file(&mut self, path: &Path) -> Result<Vec<u8>, FileError> {
        let most = self.room.min(MAX_FILE_BYTES);
        let bytes = read_bytes(path, most).map_err(|error| match error {
            FileError::TooLarge { file, .. } if most < MAX_FILE_BYTES => FileError::TooMuch {
                file,
                place: Place::default(),
                what: "bytes in all files that are named",
                limit: MAX_BYTES,
            },
            error => error,
        })?;
        self.room = self.room.saturating_sub(bytes.len() as u64);
        self.files.push(path.to_owned());
        Ok(bytes)
    }

    /// A file that is kept: named a thousand times, it is read once.
    pub(crate) fn buffer(&mut self, path: &Path) -> Result<Arc<Vec<u8>>, FileError> {
        if let Some(known) = self.buffers.get(path) {
            return Ok(known.clone());
        }
        let bytes = Arc::new(self.file(path)?);
        self.buffers.insert(path.to_owned(), bytes.clone());
        Ok(bytes)
    }

    /// Whether a file is kept already.
    pub(crate) fn has(&self, path: &Path) -> bool {
        self.buffers.contains_key(path)
    }

    /// What has been read so far, each as often as it was.
    #[must_use]
    pub fn into_files(self) -> Vec<PathBuf> {
        self.files
    }

    /// How much has been read \[bytes\].
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> u64 {
        MAX_BYTES - self.room
    }
}

/// The place on the disk of a file that a document names: below the document's own directory, where
/// links lead too.
///
/// A document of somebody else is not to read what lies elsewhere, nor is an archive or a clone
/// with links in it.
///
/// # Errors
/// A sentence with the name.
///
/// ```
/// assert!(tumble_import::beside(".".as_ref(), "../secret.obj").is_err());
/// ```
pub fn beside(directory: &Path, name: &str) -> Result<PathBuf, String> {
    let path = Path::new(name);
    let below = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !below || name.contains("://") {
        return Err(format!("{name:?} is not a path below the file's own directory"));
    }
    let here = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
    let joined = here.join(path);
    let unreadable = |error: std::io::Error| format!("{}: cannot be read: {error}", joined.display());
    let (real, root) = (joined.canonicalize().map_err(unreadable)?, here.canonicalize().map_err(unreadable)?);
    if real.starts_with(root) {
        Ok(real)
    } else {
        Err(format!("{name:?} is a link that leads out of the file's own directory"))
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn only_what_lies_below_is_named() {
        let place = tempfile::tempdir().unwrap();
        let root = place.path().join("scene");
        fs::create_dir_all(root.join("below/deep")).unwrap();
        fs::write(place.path().join("secret.obj"), "v").unwrap();
        fs::write(root.join("below/a b.obj"), "v").unwrap();
        assert!(beside(&root, "below/a b.obj").is_ok() && beside(&root, "./below/./a b.obj").is_ok());
        let absolute = root.join("below/a b.obj");
        for bad in
            ["../secret.obj", "below/../../secret.obj", "/etc/hostname", "below/../below/a b.obj", "file:///x", ""]
        {
            let refused = beside(&root, bad);
            assert!(bad.is_empty() || refused.is_err_and(|why| why.contains("not a path below")), "{bad}");
        }
        assert!(beside(&root, &absolute.to_string_lossy()).is_err());
        assert!(beside(&root, "missing.obj").unwrap_err().contains("cannot be read"));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_below_and_no_farther() {
        use std::os::unix::fs::symlink;
        let place = tempfile::tempdir().unwrap();
        let root = place.path().join("scene");
        fs::create_dir_all(root.join("below")).unwrap();
        fs::write(place.path().join("secret.obj"), "v").unwrap();
        fs::write(root.join("part.obj"), "v").unwrap();
        symlink("../part.obj", root.join("below/near.obj")).unwrap();
        symlink("../../secret.obj", root.join("below/far.obj")).unwrap();
        symlink("..", root.join("up")).unwrap();
        symlink("far.obj", root.join("below/twice.obj")).unwrap();
        assert!(beside(&root, "below/near.obj").is_ok());
        for far in ["below/far.obj", "up/secret.obj", "below/twice.obj"] {
            assert!(beside(&root, far).unwrap_err().contains("leads out of"), "{far}");
        }
        // The directory itself may be reached by a link.
        symlink("scene", place.path().join("linked")).unwrap();
        assert!(beside(&place.path().join("linked"), "part.obj").is_ok());
    }

    #[test]
    fn a_buffer_is_read_once_and_there_is_an_end() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("a.bin");
        fs::write(&path, [7; 1000]).unwrap();
        let mut reading = Reading::default();
        for _ in 0..100 {
            assert_eq!(reading.buffer(&path).unwrap().len(), 1000);
        }
        assert_eq!(reading.bytes(), 1000);
        reading.room = 999;
        assert!(matches!(reading.file(&path), Err(FileError::TooMuch { limit: MAX_BYTES, .. })));
    }
}
