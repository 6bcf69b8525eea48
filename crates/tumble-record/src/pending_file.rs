//! Files that appear whole or not at all.

use std::ffi::{OsStr, OsString};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// A file that is written beside its place and renamed into it by [`finish`](Self::finish).
///
/// Dropped before that, it leaves nothing behind and whatever stood in its place untouched. What a
/// program that was killed left of the same file, the next [`create`](Self::create) removes. The
/// target may be absent, a regular file or a link to one; anything else (a directory, a device, a
/// pipe) is refused, for a rename would replace it.
///
/// ```
/// use std::io::Write;
/// use tumble_record::PendingFile;
///
/// let path = std::env::temp_dir().join(format!("tumble-doc-{}.txt", std::process::id()));
/// let mut file = PendingFile::create(&path)?;
/// file.write_all(b"whole")?;
/// assert!(!path.exists());
/// file.finish()?;
/// assert_eq!(std::fs::read_to_string(&path)?, "whole");
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct PendingFile {
    /// `None` once finished or being dropped.
    writer: Option<BufWriter<File>>,
    beside: PathBuf,
    target: PathBuf,
}

impl PendingFile {
    /// Opens a file beside `target`, in the same directory, so that the rename cannot cross
    /// file systems.
    ///
    /// # Errors
    /// If the directory is missing or cannot be written, or `target` is something else than a
    /// regular file.
    pub fn create(target: &Path) -> io::Result<Self> {
        let target = real_target(target)?;
        let name = target.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "it names no file"))?;
        remove_leftovers(&target, name);
        // The process id keeps two programs apart, the counter two files of one program.
        for attempt in 0..1000_u32 {
            let mut hidden = OsString::from(".");
            hidden.push(name);
            hidden.push(format!(".{}-{attempt}.part", std::process::id()));
            let beside = target.with_file_name(hidden);
            match OpenOptions::new().write(true).create_new(true).open(&beside) {
                // Another program may have taken it for a leftover before it was locked.
                Ok(file) => match file.try_lock() {
                    Ok(()) if !beside.exists() => {}
                    Err(TryLockError::WouldBlock) => {}
                    Ok(()) | Err(TryLockError::Error(_)) => return Ok(Self::beside(file, beside, target)),
                },
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(io::Error::new(io::ErrorKind::AlreadyExists, "too many unfinished files beside it"))
    }

    /// As [`create`](Self::create), for a file that is readable while it grows, and that is to be
    /// found if the program is killed: `run.csv` is written as `run.partial.csv`. One that an
    /// earlier program left is replaced.
    ///
    /// # Errors
    /// As [`create`](Self::create), and if another program is writing it.
    pub fn create_partial(target: &Path) -> io::Result<Self> {
        let beside = Self::partial_path(target)?;
        let target = real_target(target)?;
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(&beside)?;
        match file.try_lock() {
            // Gone if the other program has finished it in between.
            Ok(()) if beside.exists() => {}
            Ok(()) | Err(TryLockError::WouldBlock) => {
                let problem = format!("another program is writing {}", beside.display());
                return Err(io::Error::new(io::ErrorKind::ResourceBusy, problem));
            }
            // Some file systems have no locks.
            Err(TryLockError::Error(_)) => {}
        }
        file.set_len(0)?;
        Ok(Self::beside(file, beside, target))
    }

    fn beside(file: File, beside: PathBuf, target: PathBuf) -> Self {
        Self { writer: Some(BufWriter::with_capacity(1 << 16, file)), beside, target }
    }

    /// Where [`create_partial`](Self::create_partial) writes a file until it is finished.
    ///
    /// # Errors
    /// If the file or what stands in the place beside it is something else than a regular file.
    pub fn partial_path(target: &Path) -> io::Result<PathBuf> {
        real_target(&partial(&real_target(target)?)?)
    }

    /// Writes what is buffered through to the disk, so that [`finish`](Self::finish) has only to
    /// rename. Of several files that belong together all are settled before the first is finished,
    /// and a full disk leaves none of them.
    ///
    /// # Errors
    /// If the disk is full.
    pub fn settle(&mut self) -> io::Result<()> {
        match &mut self.writer {
            Some(writer) => writer.flush().and_then(|()| writer.get_ref().sync_all()),
            None => Ok(()),
        }
    }

    /// Writes what is buffered through to the disk and renames the file into its place.
    ///
    /// # Errors
    /// If the disk is full or the rename is refused; nothing is left behind then.
    pub fn finish(mut self) -> io::Result<()> {
        let Some(writer) = self.writer.take() else { return Ok(()) };
        let renamed = writer
            .into_inner()
            .map_err(io::IntoInnerError::into_error)
            .and_then(|file| file.sync_all())
            .and_then(|()| fs::rename(&self.beside, &self.target));
        if renamed.is_err() {
            remove_quietly(&self.beside);
        }
        renamed
    }
}

impl Write for PendingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.writer {
            Some(writer) => writer.write(bytes),
            None => Err(io::Error::other("the file is finished")),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.as_mut().map_or(Ok(()), Write::flush)
    }
}

impl Seek for PendingFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.writer {
            Some(writer) => writer.seek(to),
            None => Err(io::Error::other("the file is finished")),
        }
    }
}

impl Drop for PendingFile {
    fn drop(&mut self) {
        if let Some(writer) = self.writer.take() {
            // Closed without flushing: nobody will read it.
            drop(writer.into_parts());
            remove_quietly(&self.beside);
        }
    }
}

/// `run.partial.csv` for `run.csv`, in the same directory.
fn partial(target: &Path) -> io::Result<PathBuf> {
    let stem = target.file_stem().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "it names no file"))?;
    let mut name = stem.to_owned();
    name.push(".partial");
    if let Some(ending) = target.extension() {
        name.push(".");
        name.push(ending);
    }
    Ok(target.with_file_name(name))
}

/// Removes what killed programs left of a file: its name between a dot and
/// `.<process>-<number>.part`, and locked by nobody.
fn remove_leftovers(target: &Path, name: &OsStr) {
    let directory = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let Ok(entries) = fs::read_dir(directory) else { return };
    for entry in entries.flatten().filter(|entry| is_leftover(&entry.file_name(), name)) {
        let path = entry.path();
        // Not a link, which would lead to somebody else's file.
        if entry.file_type().is_ok_and(|kind| kind.is_file())
            && let Ok(file) = OpenOptions::new().write(true).open(&path)
            && file.try_lock().is_ok()
        {
            remove_quietly(&path);
        }
    }
}

fn is_leftover(entry: &OsStr, name: &OsStr) -> bool {
    let is_number = |text: &[u8]| !text.is_empty() && text.iter().all(u8::is_ascii_digit);
    let numbers = entry
        .as_encoded_bytes()
        .strip_prefix(b".")
        .and_then(|rest| rest.strip_prefix(name.as_encoded_bytes())?.strip_prefix(b".")?.strip_suffix(b".part"));
    let mut parts = numbers.unwrap_or_default().splitn(2, |byte| *byte == b'-');
    matches!((parts.next(), parts.next()), (Some(process), Some(number)) if is_number(process) && is_number(number))
}

/// Nothing sensible can be done if even the removal fails, and nobody waits for the answer.
fn remove_quietly(path: &Path) {
    drop(fs::remove_file(path));
}

/// Follows links, so that a link keeps pointing at the new file; refuses what is not a file.
fn real_target(target: &Path) -> io::Result<PathBuf> {
    match fs::symlink_metadata(target) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(target.to_owned()),
        Err(error) => Err(error),
        Ok(_) => {
            let real = fs::canonicalize(target)?;
            let metadata = fs::metadata(&real)?;
            if metadata.is_dir() {
                Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a directory"))
            } else if !metadata.is_file() {
                Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file"))
            } else if metadata.permissions().readonly() {
                // A rename would not ask the file itself.
                Err(io::Error::new(io::ErrorKind::PermissionDenied, "it is read-only"))
            } else {
                Ok(real)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(directory: &Path) -> usize {
        fs::read_dir(directory).unwrap().count()
    }

    /// An old file there, and a new one written beside it.
    fn new_over_old(path: &Path) -> PendingFile {
        fs::write(path, "old").unwrap();
        let mut file = PendingFile::create(path).unwrap();
        file.write_all(b"new").unwrap();
        file
    }

    #[test]
    fn a_dropped_file_leaves_the_old_one() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.csv");
        drop(new_over_old(&path));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(entries(directory.path()), 1);
    }

    #[test]
    fn a_finished_file_replaces_the_old_one_and_nothing_else_stays() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.csv");
        let file = new_over_old(&path);
        let other = PendingFile::create(&path).unwrap();
        file.finish().unwrap();
        drop(other);
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(entries(directory.path()), 1);
    }

    #[test]
    fn a_partial_file_has_a_name_of_its_own_and_one_writer() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.b.csv");
        let beside = directory.path().join("a.b.partial.csv");
        fs::write(&beside, "left by one that was killed").unwrap();
        let mut file = PendingFile::create_partial(&path).unwrap();
        assert_eq!(PendingFile::partial_path(&path).unwrap(), beside);
        assert_eq!(PendingFile::create_partial(&path).unwrap_err().kind(), io::ErrorKind::ResourceBusy);
        file.write_all(b"old").unwrap();
        file.seek(SeekFrom::Start(0)).unwrap();
        file.write_all(b"new").unwrap();
        file.flush().unwrap();
        assert_eq!(fs::read_to_string(&beside).unwrap(), "new");
        file.finish().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(entries(directory.path()), 1);
        fs::create_dir(&beside).unwrap();
        assert!(PendingFile::create_partial(&path).is_err());
    }

    #[test]
    fn what_is_not_a_file_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        assert!(PendingFile::create(directory.path()).is_err());
        assert!(PendingFile::create(&directory.path().join("missing/a.csv")).is_err());
        assert!(PendingFile::create(Path::new("..")).is_err());
        let read_only = directory.path().join("read-only.csv");
        fs::write(&read_only, "kept").unwrap();
        let mut permissions = fs::metadata(&read_only).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&read_only, permissions).unwrap();
        assert!(PendingFile::create(&read_only).is_err());
    }

    /// Of a program that was killed: nobody holds the lock. What is written, what is of another
    /// file and what only looks alike stays.
    #[test]
    fn what_a_killed_program_left_is_removed_by_the_next() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.csv");
        let others = [
            ".b.csv.1-0.part",
            ".a.csv.1-0.partial",
            ".a.csv.x-0.part",
            ".a.csv.1-.part",
            ".a.csv.1.part",
            "a.csv.1-0.part",
        ];
        for name in [&others[..], &[".a.csv.1-0.part", ".a.csv.4194304-999.part"]].concat() {
            fs::write(directory.path().join(name), "left").unwrap();
        }
        let first = PendingFile::create(&path).unwrap();
        let second = PendingFile::create(&path).unwrap();
        assert!(first.beside.exists() && second.beside.exists() && first.beside != second.beside);
        assert_eq!(entries(directory.path()), others.len() + 2);
        drop((first, second));
        for name in others {
            assert!(directory.path().join(name).exists(), "{name}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let directory = tempfile::tempdir().unwrap();
        let (real, link) = (directory.path().join("real.csv"), directory.path().join("link.csv"));
        fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        let mut file = PendingFile::create(&link).unwrap();
        file.write_all(b"new").unwrap();
        file.finish().unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().file_type().is_symlink());
        assert_eq!(fs::read_to_string(&real).unwrap(), "new");
    }
}
