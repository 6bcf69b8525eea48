//! The file of a sweep as it is read: an identity, the names of the columns, and a row for each
//! world, in order.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::file_error::{SweepFileError, lock};
use crate::identity::SweepIdentity;
use crate::run_status::RunStatus;

/// What the first line of every file begins with; readers of CSV take it for a comment.
const BEFORE_IDENTITY: &str = "# tumble sweep ";

/// No line is longer \[bytes\]; a file without line breaks is not read to its end.
pub(crate) const LONGEST_LINE: u64 = 16 << 20;

/// The two lines that a file begins with.
///
/// # Errors
/// Where the identity or the columns cannot be written, which is a bug.
pub(crate) fn sweep_header(identity: &SweepIdentity, columns: &[String]) -> io::Result<String> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    csv.write_record(columns)?;
    let columns = csv.into_inner().map_err(csv::IntoInnerError::into_error)?;
    let columns = String::from_utf8(columns).map_err(io::Error::other)?;
    Ok(format!("{BEFORE_IDENTITY}{}\n{columns}", serde_json::to_string(identity)?))
}

/// Reads a sweep's file row after row in bounded memory, and checks each row's place and form.
///
/// A row is refused unless it is that of the next world, and each field is what its column has: a
/// number, a known outcome, 16 hexadecimal digits, or nothing where the outcome says so. What is
/// not seen is a change that leaves a field well-formed, such as another digit in a number.
///
/// ```
/// # use tumble_sweep::{Sweep, SweepFile, SweepIdentity, SweepPlan};
/// use tumble_sweep::SweepReader;
///
/// # let plan = SweepPlan { scene: "t-handle".into(), worlds: Some(3), ..SweepPlan::default() };
/// # let sweep = Sweep::new(plan)?;
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("sweep.csv");
/// # let mut file =
/// #     SweepFile::open(&path, &SweepIdentity::new(&sweep, None), &sweep.columns())?;
/// # file.append(&sweep.row(0, &|| false).expect("nothing stops it"))?;
/// # drop(file);
/// // The file of a sweep of three worlds that was ended after the first.
/// let mut reader = SweepReader::open(&path)?;
/// assert_eq!((reader.columns()[0].as_str(), reader.worlds()), ("world", 0..3));
/// while let Some(row) = reader.next_row()? {
///     assert!(row.starts_with(b"0,ok,") && row.ends_with(b"\n"));
/// }
/// assert_eq!(reader.next_world(), 1);
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

    /// Of a file that is open at its beginning.
    ///
    /// # Errors
    /// As of [`open`](Self::open).
    pub(crate) fn new(path: &Path, file: File) -> Result<Self, SweepFileError> {
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
            Some(Ok(titles)) if columns.ends_with('\n') => titles.iter().map(str::to_owned).collect::<Vec<_>>(),
            _ => return Err(not_a_sweep("its second line is not whole".to_owned())),
        };
        // To the byte, because what a merge or another machine writes is compared so.
        if sweep_header(&identity, &columns).map_err(SweepFileError::io(path))? != head {
            return Err(not_a_sweep("its first two lines are not as this program writes them".to_owned()));
        }
        let worlds = identity.range();
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
    #[must_use]
    pub fn identity(&self) -> &SweepIdentity {
        &self.identity
    }

    /// The names of the columns, which the second line has.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The worlds that a finished file has.
    #[must_use]
    pub fn worlds(&self) -> Range<u64> {
        self.worlds.clone()
    }

    /// The world whose row comes next, or would.
    #[must_use]
    pub fn next_world(&self) -> u64 {
        self.next
    }

    /// Refuses the file of another sweep, or of another part of the same.
    ///
    /// # Errors
    /// [`SweepFileError::Another`], which says what differs.
    pub(crate) fn refuse_another(&self, identity: &SweepIdentity) -> Result<(), SweepFileError> {
        match self.identity.difference(identity) {
            Some(difference) => Err(SweepFileError::Another { path: self.path.clone(), difference }),
            None => Ok(()),
        }
    }

    /// Bytes of the whole lines that were read.
    pub(crate) fn whole(&self) -> u64 {
        self.whole
    }

    /// Takes the lock that a [`SweepFile`](crate::SweepFile) has, and keeps it until the reader is
    /// dropped.
    ///
    /// # Errors
    /// [`SweepFileError::Busy`] where a program is writing to the file.
    pub(crate) fn lock(&self) -> Result<(), SweepFileError> {
        lock(&self.path, self.reader.get_ref())
    }

    /// The next row, with its end; `None` after the last whole one.
    ///
    /// # Errors
    /// [`SweepFileError`] where it cannot be read, or is not the row of the next world.
    pub fn next_row(&mut self) -> Result<Option<&[u8]>, SweepFileError> {
        self.line.clear();
        let limited = Read::by_ref(&mut self.reader).take(LONGEST_LINE).read_until(b'\n', &mut self.line);
        limited.map_err(SweepFileError::io(&self.path))?;
        let torn = self.line.last() != Some(&b'\n');
        // Only the end of the file cuts a row short of the limit.
        if torn && (self.line.len() as u64) < LONGEST_LINE {
            return Ok(None);
        }
        let endless = torn.then(|| format!("it has no end within {LONGEST_LINE} bytes"));
        if let Some(problem) = endless.or_else(|| self.problem()) {
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
            self.malformed()
        }
    }

    /// The first field that is not what its column has.
    fn malformed(&self) -> Option<String> {
        let Some(row) = std::str::from_utf8(&self.line).ok().and_then(|row| row.strip_suffix('\n')) else {
            return Some("it is not text".to_owned());
        };
        // Nothing is known yet of what follows the outcome.
        let mut finished = None;
        for (column, field) in self.columns.iter().zip(row.split(',')) {
            let sound = match (column.as_str(), finished) {
                ("outcome", _) => {
                    let outcome = RunStatus::named(field);
                    finished = Some(outcome == Some(RunStatus::Ok));
                    outcome.is_some()
                }
                (_, Some(false)) => field.is_empty(),
                ("steps_taken" | "world", _) => field.parse::<u64>().is_ok(),
                ("hash", _) => field.len() == 16 && field.bytes().all(|byte| byte.is_ascii_hexdigit()),
                // Empty where nothing touched.
                (column, _) if is_contact(column) && field.is_empty() => true,
                _ => field.parse::<f64>().is_ok(),
            };
            if !sound {
                return Some(format!("{field:?} is not what {column} can be"));
            }
        }
        None
    }
}

/// Whether a column has times of first contacts.
fn is_contact(column: &str) -> bool {
    let name = column.trim_start_matches('"').strip_prefix("first_contact");
    name.is_some_and(|of| of.is_empty() || of.starts_with('('))
}

/// Asked before opening, for reading a pipe waits for its other end.
pub(crate) fn refuse_irregular(path: &Path) -> Result<(), SweepFileError> {
    if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        let problem = "it is not a regular file".to_owned();
        return Err(SweepFileError::NotASweep { path: path.to_owned(), problem });
    }
    Ok(())
}
