//! The files of all shards of a sweep to the file of the whole.

use std::fs;
use std::io::{ErrorKind, Write as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use tumble_record::PendingFile;

use crate::file_error::SweepFileError;
use crate::identity::SweepIdentity;
use crate::merge_error::MergeError;
use crate::reader::{SweepReader, sweep_header};
use crate::shard::Shard;

/// All shards of one sweep, to be written as the file that the whole sweep would have written on
/// one machine.
///
/// ```
/// use tumble_sweep::{Merge, Shard, Sweep, SweepFile, SweepIdentity, SweepPlan};
///
/// let plan = SweepPlan { scene: "t-handle".into(), worlds: Some(3), ..SweepPlan::default() };
/// let sweep = Sweep::new(plan)?;
/// let folder = tempfile::tempdir()?;
/// let mut paths = Vec::new();
/// for shard in ["1/2", "2/2"] {
///     let identity = SweepIdentity::new(&sweep, Some(shard.parse::<Shard>()?));
///     paths.push(folder.path().join(shard.replace('/', "-of-")));
///     let mut file = SweepFile::open(&paths[paths.len() - 1], &identity, &sweep.columns())?;
///     for world in file.first_missing_world()..identity.range().end {
///         file.append(&sweep.row(world, &|| false).expect("nothing stops it"))?;
///     }
/// }
/// let whole = folder.path().join("whole.csv");
/// assert!(Merge::open(&whole, &paths)?.write(&|| false)?.is_continue());
/// // Two lines of the head, and a row for each world.
/// assert_eq!(std::fs::read_to_string(&whole)?.lines().count(), 2 + 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Merge {
    out: PathBuf,
    identity: SweepIdentity,
    columns: Vec<String>,
    /// By their number.
    files: Vec<(Shard, PathBuf)>,
}

impl Merge {
    /// Reads what the files of the shards, in any order, say that they are. Nothing is written yet.
    ///
    /// # Errors
    /// [`MergeError`] if they are not all shards of one sweep, or `out` is one of them.
    pub fn open(out: &Path, shards: &[PathBuf]) -> Result<Self, MergeError> {
        let mut common: Option<(SweepIdentity, Vec<String>)> = None;
        let mut files = Vec::with_capacity(shards.len());
        for path in shards {
            // Closed again, for there may be more shards than files can be open.
            let reader = SweepReader::open(path)?;
            let (identity, columns) = (reader.identity().whole(), reader.columns().to_owned());
            let shard = reader.identity().shard().ok_or_else(|| MergeError::Whole { path: path.clone() })?;
            files.push((shard, path.clone()));
            match &common {
                Some((of_first, columns_of_first)) => {
                    let columns_differ = (columns != *columns_of_first).then(|| "columns: have other names".to_owned());
                    if let Some(difference) = identity.difference(of_first).or(columns_differ) {
                        let first = shards.first().cloned().unwrap_or_default();
                        return Err(MergeError::Another { path: path.clone(), first, difference });
                    }
                }
                None => common = Some((identity, columns)),
            }
        }
        files.sort();
        check_complete(&files)?;
        let (identity, columns) = common.ok_or(MergeError::NoShards)?;
        if shards.iter().any(|path| fs::canonicalize(path).ok() == fs::canonicalize(out).ok()) {
            return Err(MergeError::IsShard { path: out.to_owned() });
        }
        Ok(Self { out: out.to_owned(), identity, columns, files })
    }

    /// The names of the columns, which all shards have.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Writes the file, which appears whole or not at all; breaks if `stop` said so before its end.
    /// It is asked before each row.
    ///
    /// # Errors
    /// [`MergeError`] if a shard is damaged or not finished, or the file cannot be written. A file
    /// that was there is unchanged then, and is replaced only if it is of the same sweep.
    pub fn write(self, stop: &(dyn Fn() -> bool + Sync)) -> Result<ControlFlow<()>, MergeError> {
        let out = &self.out;
        let mut replaced = claim(out, &self.identity)?;
        let mut file = PendingFile::create(out).map_err(|error| MergeError::Open { path: out.clone(), error })?;
        let header = sweep_header(&self.identity, &self.columns);
        let mut written = header.and_then(|header| file.write_all(header.as_bytes()));
        for (_, path) in &self.files {
            let mut reader = SweepReader::open(path)?;
            while let (Ok(()), Some(row)) = (&written, reader.next_row()?) {
                if stop() {
                    return Ok(ControlFlow::Break(()));
                }
                written = file.write_all(row);
            }
            let worlds = reader.worlds();
            if written.is_ok() && reader.next_world() < worlds.end {
                let (has, all) = (reader.next_world() - worlds.start, worlds.end - worlds.start);
                return Err(MergeError::Unfinished { path: path.clone(), has, all });
            }
        }
        if replaced.is_none() {
            // A sweep may have begun it in the meantime.
            replaced = claim(out, &self.identity)?;
        }
        written.and_then(|()| file.finish()).map_err(|error| MergeError::Write { path: out.clone(), error })?;
        drop(replaced);
        Ok(ControlFlow::Continue(()))
    }
}

/// Takes the lock that a sweep takes, if there is a file to replace; only one of the same sweep may
/// be.
fn claim(out: &Path, identity: &SweepIdentity) -> Result<Option<SweepReader>, SweepFileError> {
    match fs::symlink_metadata(out) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(SweepFileError::Io { path: out.to_owned(), error }),
        Ok(_) => {}
    }
    let there = SweepReader::open(out)?;
    there.refuse_another(identity)?;
    there.lock()?;
    Ok(Some(there))
}

fn check_complete(shards: &[(Shard, PathBuf)]) -> Result<(), MergeError> {
    let count = shards.first().map_or(0, |(shard, _)| shard.count());
    let mut expected = 1;
    for (shard, path) in shards {
        if shard.count() != count {
            return Err(MergeError::OtherCount { path: path.clone(), shard: *shard, count });
        } else if shard.index() < expected {
            return Err(MergeError::Twice { path: path.clone(), shard: *shard });
        } else if shard.index() > expected {
            return Err(MergeError::Missing { index: expected, count });
        }
        expected += 1;
    }
    if expected <= count { Err(MergeError::Missing { index: expected, count }) } else { Ok(()) }
}
