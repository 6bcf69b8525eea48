//! The file of a sweep as it is written, and gone on with after a program was killed.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::file_error::{SweepFileError, lock};
use crate::identity::SweepIdentity;
use crate::reader::{SweepReader, refuse_irregular, sweep_header};
use crate::row::Row;

/// A sweep's file that rows are appended to.
///
/// Opened again after the program was killed, it goes on where it ended: whole rows stay, a row
/// that was not written to its end is cut off. A file of another sweep is refused and stays as it
/// is.
///
/// ```
/// use std::ops::ControlFlow;
/// use tumble::batch::for_each_world;
/// use tumble_sweep::{Sweep, SweepFile, SweepIdentity, SweepPlan};
///
/// let plan = SweepPlan {
///     scene: "t-handle".into(),
///     vary: vec!["bodies.0.angular_velocity.1=normal(5,1)".parse()?],
///     worlds: Some(8),
///     length: Some(tumble_scene::RunLength::Steps(60)),
///     ..SweepPlan::default()
/// };
/// let sweep = Sweep::new(plan)?;
/// let identity = SweepIdentity::new(&sweep, None);
/// let folder = tempfile::tempdir()?;
/// let mut file =
///     SweepFile::open(&folder.path().join("sweep.csv"), &identity, &sweep.columns())?;
/// let stopped = for_each_world(
///     file.first_missing_world()..identity.range().end,
///     |world| sweep.row(world, &|| false),
///     |_, row| match row.map(|row| file.append(&row)) {
///         Some(Ok(())) => ControlFlow::Continue(()),
///         failed => ControlFlow::Break(failed),
///     },
/// );
/// assert!(stopped.is_continue());
/// file.finish()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SweepFile {
    path: PathBuf,
    file: File,
    next: u64,
}

impl SweepFile {
    /// Opens or makes the file of the worlds that the identity has.
    ///
    /// # Errors
    /// [`SweepFileError`]; a file that was there is unchanged then.
    pub fn open(path: &Path, identity: &SweepIdentity, columns: &[String]) -> Result<Self, SweepFileError> {
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
    #[must_use]
    pub fn first_missing_world(&self) -> u64 {
        self.next
    }

    /// Appends a row and hands it to the system at once, so that it is safe if the program is
    /// killed. It is to be that of the next world.
    ///
    /// # Errors
    /// [`SweepFileError`] where the disk is full, say; the rows before stay.
    pub fn append(&mut self, row: &Row) -> Result<(), SweepFileError> {
        self.file.write_all(row.text.as_bytes()).map_err(SweepFileError::io(&self.path))
    }

    /// Waits until all is on the disk.
    ///
    /// # Errors
    /// [`SweepFileError`] where the disk refuses.
    pub fn finish(self) -> Result<(), SweepFileError> {
        self.file.sync_all().map_err(SweepFileError::io(&self.path))
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
    Ok((reader.whole(), reader.next_world()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reader::LONGEST_LINE;
    use crate::sweep::Sweep;
    use crate::sweep_plan::SweepPlan;

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
