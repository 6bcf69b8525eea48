//! The files of a run: opened before the first step, so that what cannot be written is known early,
//! and renamed into place at the end.

use std::fs;
use std::io::{self, Write};
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

use tumble::PhaseTimes;
use tumble_scene::{
    Animation, Frame, PendingFile, Replay, ReportPage, Scene, Summary, TrajectoryError, TrajectoryFormat,
    TrajectoryWriter,
};

use crate::ending::trajectory_format;
use crate::failure::Failure;
use crate::history::History;
use crate::options::RunOptions;
use crate::table::systems;

/// What a run writes; dropped before [`finish`](Self::finish), it leaves nothing behind.
pub(crate) struct Outputs {
    record: Option<(PathBuf, TrajectoryWriter<PendingFile>)>,
    report: Option<Report>,
    // Last, for fields are dropped in order and only an empty directory can be removed.
    directories: NewDirectories,
}

impl Outputs {
    /// For a run of so many steps of the scene.
    pub(crate) fn open(options: &RunOptions, scene: &Scene, steps: u64) -> Result<Self, Failure> {
        let mut outputs = Self { record: None, report: None, directories: NewDirectories(Vec::new()) };
        let format = options.record.as_deref().map(trajectory_format).transpose()?;
        if let Some(directory) = &options.report {
            outputs.directories.create(directory).map_err(|error| Failure::opening(directory, &error))?;
            outputs.report = Some(Report::open(options, directory)?);
        }
        if let (Some(path), Some(format)) = (&options.record, format) {
            let opening = |error: io::Error| Failure::opening(path, &error);
            refuse_scene(options, path, "the record")?;
            refuse_scene(
                options,
                &PendingFile::partial_path(path).map_err(opening)?,
                "the record until it is finished",
            )?;
            let animation = match format {
                TrajectoryFormat::Glb => Some(Animation::of(scene, steps, options.every.map_or(1, NonZeroU64::get))?),
                TrajectoryFormat::Csv | TrajectoryFormat::Parquet => None,
            };
            let file = PendingFile::create_partial(path).map_err(opening)?;
            outputs.record = Some((path.clone(), trajectory(file, format, animation).map_err(opening)?));
        }
        Ok(outputs)
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

    /// Renames the record into its place, and with it the report where there is one to write.
    pub(crate) fn finish(mut self, findings: Option<Findings<'_>>) -> Result<(), Failure> {
        if let Some((path, writer)) = self.record.take() {
            let finished = writer.finish().and_then(PendingFile::finish);
            finished.map_err(|error| Failure::writing(&path, &error))?;
        }
        if let (Some(files), Some(findings)) = (self.report.take(), findings) {
            files.finish(&findings)?;
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
    fn open(options: &RunOptions, directory: &Path) -> Result<Self, Failure> {
        let open = |name: &str| -> Result<(PathBuf, PendingFile), Failure> {
            let path = directory.join(name);
            refuse_scene(options, &path, "the report")?;
            let file = PendingFile::create(&path).map_err(|error| Failure::opening(&path, &error))?;
            Ok((path, file))
        };
        Ok(Self {
            summary: open("summary.json")?,
            ledger: open("ledger.csv")?,
            energy: open("energy.svg")?,
            drift: open("drift.svg")?,
            page: open("report.html")?,
        })
    }

    fn finish(self, findings: &Findings<'_>) -> Result<(), Failure> {
        let Findings { summary, asked, history, replay, times } = *findings;
        let mut plots = Vec::new();
        if let Some(history) = history {
            plots = vec![history.energy_plot(), history.drift_plot()];
            write(self.ledger, |file| history.write_csv(file))?;
            for (place, plot) in [self.energy, self.drift].into_iter().zip(&plots) {
                write(place, |file| file.write_all(plot.to_svg().as_bytes()))?;
            }
        }
        if let Some(replay) = replay {
            let (phases, plots) = (&systems(times), plots.as_slice());
            write(self.page, |file| ReportPage { summary, steps_asked: asked, phases, plots, replay }.write(file))?;
        }
        write(self.summary, |file| {
            serde_json::to_writer_pretty(&mut *file, summary)?;
            file.write_all(b"\n")
        })
    }
}

/// Writes one file whole and renames it into its place.
fn write(
    (path, mut file): (PathBuf, PendingFile),
    content: impl FnOnce(&mut PendingFile) -> io::Result<()>,
) -> Result<(), Failure> {
    content(&mut file).and_then(|()| file.finish()).map_err(|error| Failure::writing(&path, &error))
}

/// What is written must not replace the scene it came from.
fn refuse_scene(options: &RunOptions, file: &Path, what: &str) -> Result<(), Failure> {
    let scene = options.scene.as_ref().and_then(|scene| fs::canonicalize(scene).ok());
    match (scene, fs::canonicalize(file)) {
        (Some(scene), Ok(same)) if scene == same => {
            Err(Failure::Input(format!("{}: is the scene itself, it cannot be {what}", file.display())))
        }
        _ => Ok(()),
    }
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
