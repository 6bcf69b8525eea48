//! The files of a run: opened before the first step, so that what cannot be written is known early,
//! and renamed into place at the end.

use std::io::Write;
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};
use std::{fs, io};

use tumble::PhaseTimes;
use tumble_record::{
    Animation, Drift, Frame, Kept, PendingFile, Replay, ReportPage, Summary, TrajectoryError, TrajectoryFormat,
    TrajectoryWriter,
};
use tumble_scene::Scene;

use crate::ending::trajectory_format;
use crate::failure::Failure;
use crate::history::History;
use crate::options::RunOptions;
use crate::replacing::{Guard, Kind};
use crate::table::systems;

/// What a run writes; dropped before [`finish`](Self::finish), it leaves nothing behind.
pub(crate) struct Outputs {
    record: Option<(PathBuf, TrajectoryWriter<PendingFile>)>,
    report: Option<Report>,
    // Last, for fields are dropped in order and only an empty directory can be removed.
    directories: NewDirectories,
}

impl Outputs {
    /// For a run of this many steps of the scene.
    pub(crate) fn open(options: &RunOptions, scene: &Scene, steps: u64) -> Result<Self, Failure> {
        let mut outputs = Self { record: None, report: None, directories: NewDirectories(Vec::new()) };
        let format = options.record.as_deref().map(trajectory_format).transpose()?;
        let guard = Guard { inputs: scene.files.clone(), force: options.force };
        if let Some(directory) = &options.report {
            outputs.directories.create(directory).map_err(|error| Failure::opening(directory, &error))?;
            outputs.report = Some(Report::open(&guard, directory)?);
        }
        if let (Some(path), Some(format)) = (&options.record, format) {
            let opening = |error: io::Error| Failure::opening(path, &error);
            guard.check(path, Kind::Record(format))?;
            guard.check(&PendingFile::partial_path(path).map_err(opening)?, Kind::Partial(format))?;
            outputs.refuse_twice(path)?;
            let animation = match format {
                TrajectoryFormat::Glb => Some(Animation::of(scene, steps, options.every.map_or(1, NonZeroU64::get))?),
                TrajectoryFormat::Csv | TrajectoryFormat::Parquet => None,
            };
            let file = PendingFile::create_partial(path).map_err(opening)?;
            outputs.record = Some((path.clone(), trajectory(file, format, animation).map_err(opening)?));
        }
        Ok(outputs)
    }

    /// A record is not to take the place of a file of the report.
    fn refuse_twice(&self, record: &Path) -> Result<(), Failure> {
        let real = |path: &Path| Some(fs::canonicalize(path.parent()?).ok()?.join(path.file_name()?));
        let here = |path: &Path| {
            if path.parent() == Some(Path::new("")) { Path::new(".").join(path) } else { path.to_owned() }
        };
        let mut files = self.report.iter().flat_map(Report::paths);
        match files.find(|path| real(&here(path)) == real(&here(record))) {
            Some(path) => {
                Err(Failure::Input(format!("{}: is a file of the report, it cannot be the record", path.display())))
            }
            None => Ok(()),
        }
    }

    /// Writes one state of every body, if the run is recorded.
    pub(crate) fn record(&mut self, frame: &Frame<'_>) -> Result<(), Failure> {
        match &mut self.record {
            Some((path, writer)) => {
                writer.record(frame).map_err(|error| match &error {
                    TrajectoryError::Io(io) => Failure::writing(path, io),
                    // Found with the state before the first step.
                    _ => Failure::Input(format!("{}: {error}", path.display())),
                })
            }
            None => Ok(()),
        }
    }

    /// Makes the record readable up to here, if it is time for that.
    pub(crate) fn keep_pace(&mut self) -> Result<(), Failure> {
        match &mut self.record {
            Some((path, writer)) => writer.keep_pace().map_err(|error| Failure::writing(path, &error)),
            None => Ok(()),
        }
    }

    /// Renames the record into its place, and with it the report where there is one to write. All
    /// are on the disk before the first is renamed: a disk that is full leaves none.
    pub(crate) fn finish(mut self, findings: Option<Findings<'_>>) -> Result<(), Failure> {
        let mut whole = Vec::new();
        if let Some((path, writer)) = self.record.take() {
            let file = writer.finish().map_err(|error| Failure::writing(&path, &error))?;
            whole.push((path, file));
        }
        let reported = match (self.report.take(), findings) {
            (Some(files), Some(findings)) => {
                whole.extend(files.write(&findings)?);
                true
            }
            _ => false,
        };
        for (path, file) in &mut whole {
            file.settle().map_err(|error| Failure::writing(path, &error))?;
        }
        for (path, file) in whole {
            file.finish().map_err(|error| Failure::writing(&path, &error))?;
        }
        if reported {
            self.directories.0.clear();
        }
        Ok(())
    }
}

/// The writer of a format. Parquet is one where the feature is, for `trajectory_format` has looked.
fn trajectory(
    file: PendingFile,
    format: TrajectoryFormat,
    animation: Option<Animation>,
) -> io::Result<TrajectoryWriter<PendingFile>> {
    match (format, animation) {
        (_, Some(animation)) => Ok(TrajectoryWriter::glb(file, animation)),
        #[cfg(feature = "parquet")]
        (TrajectoryFormat::Parquet, None) => TrajectoryWriter::parquet(file),
        _ => TrajectoryWriter::csv(file),
    }
}

/// What there is to report of a run.
pub(crate) struct Findings<'a> {
    pub(crate) summary: &'a Summary,
    pub(crate) drift: &'a Drift,
    pub(crate) kept: Kept,
    /// Steps that were asked for.
    pub(crate) asked: u64,
    pub(crate) history: Option<&'a History>,
    pub(crate) replay: Option<&'a Replay>,
    pub(crate) times: &'a PhaseTimes,
}

/// The files of `--report`, each a path and what is being written beside it.
struct Report {
    summary: (PathBuf, PendingFile),
    ledger: (PathBuf, PendingFile),
    energy: (PathBuf, PendingFile),
    drift: (PathBuf, PendingFile),
    page: (PathBuf, PendingFile),
}

impl Report {
    fn open(guard: &Guard, directory: &Path) -> Result<Self, Failure> {
        let open = |name: &str, kind: Kind| -> Result<(PathBuf, PendingFile), Failure> {
            let path = directory.join(name);
            guard.check(&path, kind)?;
            let file = PendingFile::create(&path).map_err(|error| Failure::opening(&path, &error))?;
            Ok((path, file))
        };
        Ok(Self {
            summary: open("summary.json", Kind::Summary)?,
            ledger: open("ledger.csv", Kind::Ledger)?,
            energy: open("energy.svg", Kind::Picture)?,
            drift: open("drift.svg", Kind::Picture)?,
            page: open("report.html", Kind::Page)?,
        })
    }

    fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        [&self.summary, &self.ledger, &self.energy, &self.drift, &self.page].into_iter().map(|(path, _)| path)
    }

    /// Writes what there is to write; the files that are whole then, and are still to be renamed.
    fn write(self, findings: &Findings<'_>) -> Result<Vec<(PathBuf, PendingFile)>, Failure> {
        let Findings { summary, drift, kept, asked, history, replay, times } = *findings;
        let (mut plots, mut whole) = (Vec::new(), Vec::new());
        if let Some(history) = history {
            plots = vec![history.energy_plot(), history.drift_plot(drift.energy_scale())];
            whole.push(write(self.ledger, |file| history.write_csv(file))?);
            for (place, plot) in [self.energy, self.drift].into_iter().zip(&plots) {
                whole.push(write(place, |file| file.write_all(plot.to_svg().as_bytes()))?);
            }
        }
        if let Some(replay) = replay {
            let (phases, plots) = (&systems(times), plots.as_slice());
            let page = ReportPage { summary, kept, steps_asked: asked, phases, plots, replay };
            whole.push(write(self.page, |file| page.write(file))?);
        }
        whole.push(write(self.summary, |file| {
            serde_json::to_writer_pretty(&mut *file, summary)?;
            file.write_all(b"\n")
        })?);
        Ok(whole)
    }
}

/// Writes one file whole.
fn write(
    (path, mut file): (PathBuf, PendingFile),
    content: impl FnOnce(&mut PendingFile) -> io::Result<()>,
) -> Result<(PathBuf, PendingFile), Failure> {
    content(&mut file).map_err(|error| Failure::writing(&path, &error))?;
    Ok((path, file))
}

/// Directories that did not exist before, outermost first; removed again if they stay empty.
struct NewDirectories(Vec<PathBuf>);

impl NewDirectories {
    fn create(&mut self, directory: &Path) -> io::Result<()> {
        let missing = directory.ancestors().take_while(|path| !path.as_os_str().is_empty() && !path.exists());
        let mut missing: Vec<PathBuf> = missing.map(Path::to_owned).collect();
        missing.reverse();
        for path in missing {
            fs::create_dir(&path)?;
            self.0.push(path);
        }
        // Also says so if something else than a directory stands there.
        fs::create_dir_all(directory)
    }
}

impl Drop for NewDirectories {
    fn drop(&mut self) {
        for path in self.0.iter().rev() {
            // Someone else may have put a file there; then it stays.
            drop(fs::remove_dir(path));
        }
    }
}
