//! The file of the time series of all worlds of a sweep.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use tumble_record::COLUMNS;

use crate::file_error::{SweepFileError, lock, shown};
use crate::identity::SweepIdentity;
use crate::row::Row;

/// What the first line begins with; readers of CSV take it for a comment.
const BEFORE_IDENTITY: &str = "# tumble series ";

/// Why a file of time series cannot be used. `Display` is a sentence that names the file.
///
/// ```
/// use tumble_sweep::{SeriesFile, SeriesFileError, Sweep, SweepIdentity, SweepPlan};
///
/// let plan = SweepPlan { scene: "t-handle".into(), worlds: Some(3), ..SweepPlan::default() };
/// let identity = SweepIdentity::new(&Sweep::new(plan)?, None);
/// let error = SeriesFile::open("no/series.csv".as_ref(), &identity, 0).unwrap_err();
/// assert!(matches!(error, SeriesFileError::Open { .. }));
/// assert!(error.to_string().starts_with("no/series.csv: cannot be written: "));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum SeriesFileError {
    /// The system does not let it be opened.
    #[error("{path}: cannot be written: {error}", path = shown(.path))]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// It is not that of the sweep, or is damaged; it stays as it is.
    #[error("{path}: {problem}", path = shown(.path))]
    Refused {
        /// The file.
        path: PathBuf,
        /// Why.
        problem: String,
    },
    /// Another program is writing to it.
    #[error(transparent)]
    Busy(SweepFileError),
    /// The system refuses what is appended.
    #[error("{path}: writing failed: {error}", path = shown(.path))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

tumble_math::debug_as_display!(SeriesFileError);

/// The file of the time series, in the order of the worlds.
///
/// It goes with the [`SweepFile`](crate::SweepFile) of the same sweep: the lines of a world are
/// appended before its row.
///
/// ```
/// use tumble_sweep::{SeriesFile, Sweep, SweepFile, SweepIdentity, SweepPlan};
///
/// let plan = SweepPlan {
///     scene: "t-handle".into(),
///     worlds: Some(2),
///     length: Some(tumble_scene::RunLength::Steps(30)),
///     series: std::num::NonZeroU64::new(10),
///     ..SweepPlan::default()
/// };
/// let sweep = Sweep::new(plan)?;
/// let identity = SweepIdentity::new(&sweep, None);
/// let folder = tempfile::tempdir()?;
/// let mut rows =
///     SweepFile::open(&folder.path().join("sweep.csv"), &identity, &sweep.columns())?;
/// let path = folder.path().join("series.csv");
/// let mut series = SeriesFile::open(&path, &identity, rows.first_missing_world())?;
/// for world in rows.first_missing_world()..identity.range().end {
///     let row = sweep.row(world, &|| false).expect("nothing stops it");
///     series.append(&row)?;
///     rows.append(&row)?;
/// }
/// series.finish()?;
/// rows.finish()?;
/// // Two lines of the head, and steps 0, 10, 20 and 30 of both worlds.
/// assert_eq!(std::fs::read_to_string(&path)?.lines().count(), 2 + 2 * 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SeriesFile {
    path: PathBuf,
    file: File,
}

impl SeriesFile {
    /// Makes the file, or goes on with it at a world; what is there of that and later worlds is cut
    /// off.
    ///
    /// # Errors
    /// [`SeriesFileError`]; a file that was there is unchanged then.
    pub fn open(path: &Path, identity: &SweepIdentity, world: u64) -> Result<Self, SeriesFileError> {
        let worlds = identity.range().start..world;
        let opening = |error: io::Error| SeriesFileError::Open { path: path.to_owned(), error };
        let head = head(identity).map_err(opening)?;
        let there = path.metadata().ok();
        let refused =
            |problem: &str| Err(SeriesFileError::Refused { path: path.to_owned(), problem: problem.to_owned() });
        if there.as_ref().is_some_and(|there| !there.is_file()) {
            return refused("is not a regular file");
        }
        if there.is_none() && !worlds.is_empty() {
            return refused("is not there, and the sweep has worlds already whose series it had");
        }
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(opening)?;
        lock(path, &file).map_err(SeriesFileError::Busy)?;
        let begins = worlds.is_empty();
        let kept = match begun(&file, &head, worlds).map_err(opening)? {
            Begun::Whole(kept) => kept,
            Begun::Damaged(problem) => return refused(&problem),
            Begun::Another if begins && is_ours(&file).map_err(opening)? => 0,
            Begun::Another => return refused("is there already and is not the series of this sweep"),
        };
        file.set_len(kept).map_err(opening)?;
        file.seek(SeekFrom::End(0)).map_err(opening)?;
        if kept == 0 {
            file.write_all(head.as_bytes()).map_err(opening)?;
        }
        Ok(Self { path: path.to_owned(), file })
    }

    /// Appends the lines of a world, before its row is written.
    ///
    /// # Errors
    /// [`SeriesFileError::Write`] where the disk is full, say.
    pub fn append(&mut self, row: &Row) -> Result<(), SeriesFileError> {
        self.file.write_all(row.series.as_bytes()).map_err(writing(&self.path))
    }

    /// Waits until all is on the disk.
    ///
    /// # Errors
    /// [`SeriesFileError::Write`] where the disk refuses.
    pub fn finish(self) -> Result<(), SeriesFileError> {
        self.file.sync_all().map_err(writing(&self.path))
    }
}

fn writing(path: &Path) -> impl FnOnce(io::Error) -> SeriesFileError {
    |error| SeriesFileError::Write { path: path.to_owned(), error }
}

/// The two lines that the file begins with.
fn head(identity: &SweepIdentity) -> io::Result<String> {
    Ok(format!("{BEFORE_IDENTITY}{}\nworld,{}\n", serde_json::to_string(identity)?, COLUMNS.join(",")))
}

/// What a file has of the series of a sweep.
enum Begun {
    /// Bytes of the head and of all lines of the worlds.
    Whole(u64),
    /// Why lines of these worlds are not as they were written.
    Damaged(String),
    /// The head is another.
    Another,
}

/// Reads up to the lines of the last of these worlds, each of which has one at least.
fn begun(mut file: &File, head: &str, worlds: Range<u64>) -> io::Result<Begun> {
    file.rewind()?;
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let (mut kept, mut line) = (0, Vec::new());
    for expected in head.split_inclusive('\n') {
        line.clear();
        reader.read_until(b'\n', &mut line)?;
        if line != expected.as_bytes() {
            return Ok(Begun::Another);
        }
        kept += line.len() as u64;
    }
    let (mut next, mut number) = (worlds.start, 3);
    loop {
        line.clear();
        reader.read_until(b'\n', &mut line)?;
        let world = line.split(|byte| *byte == b',').next().and_then(|world| std::str::from_utf8(world).ok());
        let world = world.and_then(|world| world.parse::<u64>().ok());
        let is_whole = line.ends_with(b"\n");
        match world {
            Some(world) if is_whole && world < worlds.end && (world == next || world + 1 == next) => {
                next = world + 1;
                kept += line.len() as u64;
                number += 1;
            }
            // What follows the last of them is cut off, whole or not.
            _ if next == worlds.end => return Ok(Begun::Whole(kept)),
            _ => return Ok(Begun::Damaged(format!("line {number} is damaged: it is not that of world {next}"))),
        }
    }
}

/// Whether it is the series of any sweep, or was cut off before it was known to be.
fn is_ours(mut file: &File) -> io::Result<bool> {
    file.rewind()?;
    let mut begun = Vec::new();
    file.take(BEFORE_IDENTITY.len() as u64).read_to_end(&mut begun)?;
    Ok(BEFORE_IDENTITY.as_bytes().starts_with(&begun))
}
