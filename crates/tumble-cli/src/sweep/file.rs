//! The file of a sweep: an identity, the names of the columns, and a row for each world, in order.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use tumble_import::printable;

use crate::sweep::identity::SweepIdentity;
use crate::sweep::run_status::RunStatus;

/// What the first line of every file begins with; readers of CSV take it for a comment.
const BEFORE_IDENTITY: &str = "# tumble sweep ";

/// No line is longer \[bytes\]; a file without line breaks is not read to its end.
const LONGEST_LINE: u64 = 16 << 20;

/// Why a sweep's file cannot be used. `Display` is one line that names the file.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SweepFileError {
    /// The system refuses.
    #[error("{path}: {error}", path = shown(.path))]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// It is something else.
    #[error("{path}: is not the file of a sweep: {}", printable(.problem), path = shown(.path))]
    NotASweep {
        /// The file.
        path: PathBuf,
        /// Why not.
        problem: String,
    },
    /// It is the file of another sweep; what it has stays.
    #[error("{path}: is the file of another sweep: {}", printable(.difference), path = shown(.path))]
    Another {
        /// The file.
        path: PathBuf,
        /// What differs.
        difference: String,
    },
    /// A row before the last one is not what it must be.
    #[error("{path}: line {line} is damaged: {}", printable(.problem), path = shown(.path))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is wrong.
        problem: String,
    },
    /// Another program is writing to it.
    #[error("{path}: another tumble is writing to it", path = shown(.path))]
    Busy {
        /// The file.
        path: PathBuf,
    },
}

fn shown(path: &Path) -> String {
    printable(&path.to_string_lossy())
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
#[derive(Debug)]
pub(crate) struct SweepReader {
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
    pub(crate) fn open(path: &Path) -> Result<Self, SweepFileError> {
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
    pub(crate) fn identity(&self) -> &SweepIdentity {
        &self.identity
    }

    /// The names of the columns, which the second line has.
    pub(crate) fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The worlds that a finished file has.
    pub(crate) fn worlds(&self) -> Range<u64> {
        self.worlds.clone()
    }

    /// The world whose row comes next, or would.
    pub(crate) fn next_world(&self) -> u64 {
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

    /// Takes the lock that a [`SweepFile`] has, and keeps it until the reader is dropped.
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
    pub(crate) fn next_row(&mut self) -> Result<Option<&[u8]>, SweepFileError> {
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
                _ => field.parse::<f64>().is_ok(),
            };
            if !sound {
                return Some(format!("{field:?} is not what {column} can be"));
            }
        }
        None
    }
}

/// A sweep's file that rows are appended to.
///
/// Opened again after the program was killed, it goes on where it ended: whole rows stay, a row
/// that was not written to its end is cut off. A file of another sweep is refused and stays as it
/// is.
#[derive(Debug)]
pub(crate) struct SweepFile {
    path: PathBuf,
    file: File,
    next: u64,
}

impl SweepFile {
    /// Opens or makes the file of the worlds that the identity has.
    ///
    /// # Errors
    /// [`SweepFileError`]; a file that was there is unchanged then.
    pub(crate) fn open(path: &Path, identity: &SweepIdentity, columns: &[String]) -> Result<Self, SweepFileError> {
        let io = || SweepFileError::io(path);
        let header = sweep_header(identity, columns).map_err(io())?;
        refuse_irregular(path)?;
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(io())?;
        lock(path, &file)?;
        let mut begun = Vec::new();
        Read::by_ref(&mut file).take(header.len() as u64).read_to_end(&mut begun).map_err(io())?;
        let (whole, next) = if begun.len() < header.len() && header.as_bytes().starts_with(&begun) {
            (0, identity.range().start)
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

    /// The first world that had no row when the file was opened.
    pub(crate) fn first_missing_world(&self) -> u64 {
        self.next
    }

    /// Appends rows, each with its end, and hands them to the system at once.
    ///
    /// # Errors
    /// [`SweepFileError`] where the disk is full, say; the rows before stay.
    pub(crate) fn append(&mut self, rows: &[u8]) -> Result<(), SweepFileError> {
        self.file.write_all(rows).map_err(SweepFileError::io(&self.path))
    }

    /// Waits until all is on the disk.
    ///
    /// # Errors
    /// [`SweepFileError`] where the disk refuses.
    pub(crate) fn finish(self) -> Result<(), SweepFileError> {
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

/// One program at a time has a sweep's file, until it closes it.
pub(crate) fn lock(path: &Path, file: &File) -> Result<(), SweepFileError> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(SweepFileError::Busy { path: path.to_owned() }),
        // A file system without locks is no reason not to write.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}

/// Bytes of whole lines, and the next world.
fn finished_rows(
    path: &Path,
    file: &File,
    identity: &SweepIdentity,
    columns: &[String],
) -> Result<(u64, u64), SweepFileError> {
    let mut reader = SweepReader::new(path, file.try_clone().map_err(SweepFileError::io(path))?)?;
    reader.refuse_another(identity)?;
    if reader.columns() != columns {
        let difference = "its columns have other names".to_owned();
        return Err(SweepFileError::Another { path: path.to_owned(), difference });
    }
    while reader.next_row()?.is_some() {}
    Ok((reader.whole, reader.next))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::{Sweep, SweepPlan};

    const ROWS: &str =
        "0,0.5,ok,10,0.1,-9.8,0123456789abcdef\n1,1e-7,impossible,,,,\n2,-0.5,ok,10,0.1,1.0,fedcba9876543210\n";

    fn columns() -> Vec<String> {
        ["world", "gravity.1", "outcome", "steps_taken", "time", "energy", "hash"].map(str::to_owned).to_vec()
    }

    fn identity() -> SweepIdentity {
        let plan = SweepPlan { scene: "iss".into(), worlds: Some(3), ..SweepPlan::default() };
        SweepIdentity::new(&Sweep::new(plan).unwrap(), None)
    }

    /// What going on with a file of these contents says, or the next world; what is refused is not
    /// changed.
    fn go_on(contents: &[u8]) -> Result<u64, String> {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("sweep.csv");
        std::fs::write(&path, contents).unwrap();
        let next = SweepFile::open(&path, &identity(), &columns()).map(|file| file.first_missing_world());
        if next.is_err() {
            assert_eq!(std::fs::read(&path).unwrap(), contents);
        }
        next.map_err(|error| error.to_string())
    }

    fn file(rows: &str) -> String {
        sweep_header(&identity(), &columns()).unwrap() + rows
    }

    #[test]
    fn sound_rows_stay_and_a_torn_one_is_cut_off() {
        assert_eq!(go_on(file(ROWS).as_bytes()), Ok(3));
        assert_eq!(go_on(&file(ROWS).as_bytes()[..file(ROWS).len() - 1]), Ok(2));
    }

    #[test]
    fn a_damaged_row_is_refused_by_its_line() {
        for (sound, damaged, line) in [
            ("abcdef\n", "abcdef\r\n", 3),
            (",ok,10,0.1,-9.8", ",okay,10,0.1,-9.8", 3),
            ("0.5,ok", "0.5x,ok", 3),
            ("0,0.5", "0,", 3),
            ("ok,10,0.1,-9.8", "ok,1.5,0.1,-9.8", 3),
            ("-9.8", "", 3),
            ("-9.8", "-9,8", 3),
            ("abcdef", "abcde", 3),
            ("abcdef", "abcdeg", 3),
            ("impossible,", "impossible,10", 4),
            ("impossible", "ok", 4),
            ("2,-0.5", "3,-0.5", 5),
        ] {
            let rows = ROWS.replacen(sound, damaged, 1);
            assert_ne!(rows, ROWS, "{sound}");
            let message = go_on(file(&rows).as_bytes()).unwrap_err();
            assert!(message.contains(&format!("line {line} is damaged")), "{damaged:?}: {message}");
        }
    }

    #[test]
    fn a_row_without_an_end_is_no_torn_one() {
        let mut contents = file("").into_bytes();
        contents.resize(contents.len() + (LONGEST_LINE as usize) + 1, b'0');
        assert!(go_on(&contents).unwrap_err().contains("line 3 is damaged"));
    }

    #[test]
    fn a_header_is_compared_to_the_byte() {
        let whole = file(ROWS);
        let (first, rest) = whole.split_once('\n').unwrap();
        for contents in
            [format!("{first}\r\n{rest}"), format!("{first} \n{rest}"), whole.replacen("world,", "\"world\",", 1)]
        {
            assert_ne!(contents, whole);
            assert!(go_on(contents.as_bytes()).unwrap_err().contains("first two lines"), "{contents}");
        }
    }
}
