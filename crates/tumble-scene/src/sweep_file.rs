//! The file of a sweep: an identity, the names of the columns, and a row for each world, in order.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::sweep_identity::SweepIdentity;

/// What the first line of every file begins with; readers of CSV take it for a comment.
const BEFORE_IDENTITY: &str = "# tumble sweep ";

/// No line is longer \[bytes\]; a file without line breaks is not read to its end.
const LONGEST_LINE: u64 = 16 << 20;

/// Why a sweep's file cannot be used. `Display` is one line that names the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepFileError {
    /// The system refuses.
    #[error("{path}: {error}", path = .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// It is something else.
    #[error("{path}: is not the file of a sweep: {problem}", path = .path.display())]
    NotASweep {
        /// The file.
        path: PathBuf,
        /// Why not.
        problem: String,
    },
    /// It is the file of another sweep; what it has stays.
    #[error("{path}: is the file of another sweep: {difference}", path = .path.display())]
    Another {
        /// The file.
        path: PathBuf,
        /// What differs.
        difference: String,
    },
    /// A row before the last one is not what it must be.
    #[error("{path}: line {line} is damaged: {problem}", path = .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is wrong.
        problem: String,
    },
    /// Another program is writing to it.
    #[error("{path}: another tumble is writing to it", path = .path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
}

impl SweepFileError {
    fn io(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        |error| Self::Io { path, error }
    }
}

/// The two lines that a file begins with.
///
/// # Errors
/// Where the identity or the columns cannot be written, which is a bug.
pub fn sweep_header(identity: &SweepIdentity, columns: &[String]) -> io::Result<String> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    csv.write_record(columns)?;
    let columns = csv.into_inner().map_err(csv::IntoInnerError::into_error)?;
    let columns = String::from_utf8(columns).map_err(io::Error::other)?;
    Ok(format!("{BEFORE_IDENTITY}{}\n{columns}", serde_json::to_string(identity)?))
}

/// Reads a sweep's file row after row in bounded memory, and checks each row's place.
///
/// ```
/// use tumble_scene::{Sweep, SweepFile, SweepIdentity, SweepPlan, SweepReader};
///
/// let plan = SweepPlan { scene: "iss".into(), worlds: Some(2), ..SweepPlan::default() };
/// let identity = SweepIdentity::new(&Sweep::new(plan)?, None);
/// let path = std::env::temp_dir().join(format!("tumble-doc-sweep-{}.csv", std::process::id()));
/// let mut file = SweepFile::open(&path, &identity, &["world".into(), "outcome".into()], 0..2)?;
/// file.append(b"0,ok\n1,o")?; // killed in the middle of a row
/// drop(file);
///
/// let mut reader = SweepReader::open(&path)?;
/// assert_eq!(reader.next_row()?, Some(&b"0,ok\n"[..]));
/// assert_eq!(reader.next_row()?, None);
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SweepReader {
    path: PathBuf,
    reader: BufReader<File>,
    identity: SweepIdentity,
    columns: Vec<String>,
    worlds: Range<u64>,
    next: u64,
    /// Bytes of whole lines so far.
    whole: u64,
    line: Vec<u8>,
}

impl SweepReader {
    /// Opens a file and reads its first two lines.
    ///
    /// # Errors
    /// [`SweepFileError`] where it cannot be read or is no sweep's.
    pub fn open(path: &Path) -> Result<Self, SweepFileError> {
        refuse_irregular(path)?;
        Self::new(path, File::open(path).map_err(SweepFileError::io(path))?)
    }

    fn new(path: &Path, file: File) -> Result<Self, SweepFileError> {
        let not_a_sweep = |problem: String| SweepFileError::NotASweep { path: path.to_owned(), problem };
        let mut reader = BufReader::with_capacity(1 << 16, file);
        let mut head = Vec::new();
        for _ in 0..2 {
            let limit = LONGEST_LINE;
            Read::by_ref(&mut reader).take(limit).read_until(b'\n', &mut head).map_err(SweepFileError::io(path))?;
        }
        let head = String::from_utf8(head).map_err(|_| not_a_sweep("it is not text".to_owned()))?;
        let mut lines = head.split_inclusive('\n');
        let (first, columns) = (lines.next().unwrap_or(""), lines.next().unwrap_or(""));
        let identity = first
            .strip_prefix(BEFORE_IDENTITY)
            .ok_or_else(|| not_a_sweep(format!("it does not begin with {BEFORE_IDENTITY:?}")))?;
        let identity: SweepIdentity = serde_json::from_str(identity).map_err(|error| not_a_sweep(error.to_string()))?;
        identity.check().map_err(not_a_sweep)?;
        let titles = csv::ReaderBuilder::new().has_headers(false).from_reader(columns.as_bytes()).into_records().next();
        let columns = match titles {
            Some(Ok(titles)) if columns.ends_with('\n') => titles.iter().map(str::to_owned).collect(),
            _ => return Err(not_a_sweep("its second line is not whole".to_owned())),
        };
        let worlds = identity.shard().map_or(0..identity.worlds(), |shard| shard.range(identity.worlds()));
        Ok(Self {
            path: path.to_owned(),
            reader,
            columns,
            next: worlds.start,
            worlds,
            identity,
            whole: head.len() as u64,
            line: Vec::new(),
        })
    }

    /// What the rows depend on.
    pub fn identity(&self) -> &SweepIdentity {
        &self.identity
    }

    /// The names of the columns, which the second line has.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The worlds that a finished file has.
    pub fn worlds(&self) -> Range<u64> {
        self.worlds.clone()
    }

    /// The world whose row comes next, or would.
    pub fn next_world(&self) -> u64 {
        self.next
    }

    /// The next row, with its end; `None` after the last whole one.
    ///
    /// # Errors
    /// [`SweepFileError`] where it cannot be read, or is not the row of the next world.
    pub fn next_row(&mut self) -> Result<Option<&[u8]>, SweepFileError> {
        self.line.clear();
        let limited = Read::by_ref(&mut self.reader).take(LONGEST_LINE).read_until(b'\n', &mut self.line);
        limited.map_err(SweepFileError::io(&self.path))?;
        if self.line.last() != Some(&b'\n') {
            return Ok(None);
        }
        if let Some(problem) = self.problem() {
            let line = self.next - self.worlds.start + 3;
            return Err(SweepFileError::Damaged { path: self.path.clone(), line, problem });
        }
        self.next += 1;
        self.whole += self.line.len() as u64;
        Ok(Some(&self.line))
    }

    /// Rows have numbers and words only, so a comma always parts two fields.
    fn problem(&self) -> Option<String> {
        let commas = |line: &[u8]| line.iter().filter(|byte| **byte == b',').count();
        let fields = self.columns.len();
        let world = self.line.split(|byte| *byte == b',').next().unwrap_or_default();
        if self.next >= self.worlds.end {
            Some(format!("there are only {} worlds", self.worlds.end - self.worlds.start))
        } else if world != self.next.to_string().as_bytes() {
            Some(format!("it is not that of world {}", self.next))
        } else if commas(&self.line) + 1 != fields {
            Some(format!("it has not {fields} fields"))
        } else {
            None
        }
    }
}

/// A sweep's file that rows are appended to.
///
/// Opened again after the program was killed, it goes on where it ended: whole rows stay, a row that was not written to its end is cut
/// off. A file of another sweep is refused and stays as it is.
#[derive(Debug)]
pub struct SweepFile {
    path: PathBuf,
    file: File,
    next: u64,
}

impl SweepFile {
    /// Opens or makes the file of these worlds.
    ///
    /// # Errors
    /// [`SweepFileError`]; a file that was there is unchanged then.
    pub fn open(
        path: &Path,
        identity: &SweepIdentity,
        columns: &[String],
        worlds: Range<u64>,
    ) -> Result<Self, SweepFileError> {
        let io = || SweepFileError::io(path);
        let header = sweep_header(identity, columns).map_err(io())?;
        refuse_irregular(path)?;
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(io())?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => return Err(SweepFileError::Busy { path: path.to_owned() }),
            // A file system without locks is no reason not to write.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        let mut begun = Vec::new();
        Read::by_ref(&mut file).take(header.len() as u64).read_to_end(&mut begun).map_err(io())?;
        let (whole, next) = if begun.len() < header.len() && header.as_bytes().starts_with(&begun) {
            (0, worlds.start)
        } else {
            file.rewind().map_err(io())?;
            finished_rows(path, &file, identity, columns)?
        };
        file.set_len(whole).map_err(io())?;
        file.seek(SeekFrom::End(0)).map_err(io())?;
        if whole == 0 {
            file.write_all(header.as_bytes()).map_err(io())?;
        }
        Ok(Self { path: path.to_owned(), file, next })
    }

    /// The first world that has no row yet.
    pub fn next_world(&self) -> u64 {
        self.next
    }

    /// Appends rows, each with its end, and hands them to the system at once.
    ///
    /// # Errors
    /// [`SweepFileError`] where the disk is full, say; the rows before stay.
    pub fn append(&mut self, rows: &[u8]) -> Result<(), SweepFileError> {
        self.file.write_all(rows).map_err(SweepFileError::io(&self.path))
    }

    /// Waits until all is on the disk.
    ///
    /// # Errors
    /// [`SweepFileError`] where the disk refuses.
    pub fn finish(self) -> Result<(), SweepFileError> {
        self.file.sync_all().map_err(SweepFileError::io(&self.path))
    }
}

/// Asked before opening, for reading a pipe waits for its other end.
fn refuse_irregular(path: &Path) -> Result<(), SweepFileError> {
    if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        let problem = "it is not a regular file".to_owned();
        return Err(SweepFileError::NotASweep { path: path.to_owned(), problem });
    }
    Ok(())
}

/// Bytes of whole lines, and the next world.
fn finished_rows(
    path: &Path,
    file: &File,
    identity: &SweepIdentity,
    columns: &[String],
) -> Result<(u64, u64), SweepFileError> {
    let mut reader = SweepReader::new(path, file.try_clone().map_err(SweepFileError::io(path))?)?;
    if let Some(difference) = reader.identity().difference(identity) {
        return Err(SweepFileError::Another { path: path.to_owned(), difference });
    }
    if reader.columns() != columns {
        let difference = "its columns have other names".to_owned();
        return Err(SweepFileError::Another { path: path.to_owned(), difference });
    }
    while reader.next_row()?.is_some() {}
    Ok((reader.whole, reader.next))
}
