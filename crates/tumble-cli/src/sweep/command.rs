//! `tumble sweep`.

use std::collections::BTreeSet;
use std::fs;
use std::ops::{ControlFlow, Range};
use std::path::Path;
use std::time::{Duration, Instant};

use tumble::for_each_world;
use tumble_import::printable;
use tumble_sweep::{Row, RunStatus, SeriesFile, Sweep, SweepFile, SweepIdentity};

use crate::ending::check_ending;
use crate::failure::Failure;
use crate::inspect::{REPAIR, is_repairable};
use crate::progress::Progress;
use crate::run::{check_simd, pool};
use crate::sweep::options::SweepOptions;
use crate::sweep::plot::SweepPlot;
use crate::{interrupt, print};

/// Runs the worlds of a sweep and writes a row for each.
pub(crate) fn sweep(options: &SweepOptions) -> Result<(), Failure> {
    check_ending(&options.out, "a sweep's file", "csv")?;
    if let Some(series) = &options.series {
        check_ending(series, "a time series", "csv")?;
    }
    if options.repair && !is_repairable(&options.scene) {
        return Err(Failure::Input(format!("{REPAIR}, not with {:?}", options.scene)));
    }
    refuse_twice(&options.body)?;
    check_simd()?;
    let sweep = Sweep::new(options.plan())?;
    let columns = sweep.columns();
    let pool = pool(&options.stepping)?;
    interrupt::watch()?;
    let plot = SweepPlot::open(&options.plot, &columns, sweep.files().to_vec())?;
    let identity = SweepIdentity::new(&sweep, options.shard);
    let files = Files::open(options, &identity, &columns)?;
    let begun_at = files.rows.first_missing_world();
    let mut report = Report { worlds: identity.range(), begun_at, ..Report::default() };
    let done = pool.install(|| run(&sweep, files, &mut report, options.quiet))?;
    if done.is_continue()
        && let Some(plot) = plot
    {
        plot.draw(&options.out, &options.scene)?;
    }
    if !options.quiet {
        print::output(&report.text(&sweep, &options.out, done.is_break()))?;
    }
    if done.is_break() { Err(Failure::Interrupted) } else { Ok(()) }
}

/// What a sweep writes.
struct Files {
    rows: SweepFile,
    series: Option<SeriesFile>,
}

impl Files {
    /// Opens or makes the files; one that was made and cannot be written does not stay.
    fn open(options: &SweepOptions, identity: &SweepIdentity, columns: &[String]) -> Result<Self, Failure> {
        let path = &options.out;
        let was_there = fs::symlink_metadata(path).is_ok();
        let forget = |failure: Failure| {
            if !was_there {
                // If even that fails, the first failure is the one to tell.
                drop(fs::remove_file(path));
            }
            failure
        };
        // What another program has made in the meantime is not ours to remove.
        let rows = SweepFile::open(path, identity, columns).map_err(|error| match Failure::from(error) {
            failure @ Failure::Running(_) => forget(failure),
            failure => failure,
        })?;
        let series = options.series.as_ref().map(|series| Self::open_series(series, path, identity, &rows));
        let series = series.transpose().map_err(forget)?;
        Ok(Self { rows, series })
    }

    fn open_series(path: &Path, out: &Path, identity: &SweepIdentity, rows: &SweepFile) -> Result<SeriesFile, Failure> {
        if fs::canonicalize(path).is_ok_and(|path| fs::canonicalize(out).is_ok_and(|out| out == path)) {
            return Err(Failure::Input(format!("{}: is --out already", path.display())));
        }
        Ok(SeriesFile::open(path, identity, rows.first_missing_world())?)
    }

    fn append(&mut self, row: &Row) -> Result<(), Failure> {
        if let Some(series) = &mut self.series {
            series.append(row)?;
        }
        // Not kept back: what is finished is safe if the program is killed.
        self.rows.append(row).map_err(|error| Failure::Running(error.to_string()))
    }

    fn finish(self) -> Result<(), Failure> {
        self.series.map_or(Ok(()), SeriesFile::finish)?;
        self.rows.finish().map_err(|error| Failure::Running(error.to_string()))
    }
}

fn refuse_twice(bodies: &[String]) -> Result<(), Failure> {
    let mut seen = BTreeSet::new();
    match bodies.iter().find(|body| !seen.insert(*body)) {
        Some(body) => Err(Failure::Input(format!("--body {body:?}: is named twice"))),
        None => Ok(()),
    }
}

/// Runs what is not in the file yet; breaks if the user did not want to wait for the end.
fn run(sweep: &Sweep, mut files: Files, report: &mut Report, quiet: bool) -> Result<ControlFlow<()>, Failure> {
    let begun = Instant::now();
    let Range { start, end } = report.worlds;
    let progress = Progress::start_worlds(report.begun_at - start, end - start, quiet);
    let stopped = for_each_world(
        report.begun_at..end,
        |world| if interrupt::asked() { None } else { sweep.row(world, &interrupt::asked) },
        |index, row| {
            let Some(row) = row else { return ControlFlow::Break(None) };
            if let Err(failure) = files.append(&row) {
                return ControlFlow::Break(Some(failure));
            }
            report.count(row.outcome);
            progress.at(index + 1 - start);
            ControlFlow::Continue(())
        },
    );
    drop(progress);
    report.time = begun.elapsed();
    files.finish()?;
    match stopped {
        ControlFlow::Continue(()) => Ok(ControlFlow::Continue(())),
        ControlFlow::Break(None) => Ok(ControlFlow::Break(())),
        ControlFlow::Break(Some(failure)) => Err(failure),
    }
}

/// What a sweep did, for people.
#[derive(Default)]
struct Report {
    worlds: Range<u64>,
    begun_at: u64,
    ok: u64,
    impossible: u64,
    not_finite: u64,
    time: Duration,
}

impl Report {
    fn count(&mut self, outcome: RunStatus) {
        match outcome {
            RunStatus::Ok => self.ok += 1,
            RunStatus::Impossible => self.impossible += 1,
            RunStatus::NotFinite => self.not_finite += 1,
        }
    }

    fn text(&self, sweep: &Sweep, out: &Path, is_interrupted: bool) -> String {
        let run = self.ok + self.impossible + self.not_finite;
        let (asked, before) = (self.worlds.end - self.worlds.start, self.begun_at - self.worlds.start);
        let mut lines = vec![("worlds", format!("{} of {asked}", before + run))];
        if asked != sweep.worlds() {
            lines.push(("  of the whole sweep", format!("{}", sweep.worlds())));
        }
        if before > 0 {
            lines.push(("  finished before", before.to_string()));
        }
        if self.impossible > 0 {
            lines.push(("  impossible", self.impossible.to_string()));
        }
        if self.not_finite > 0 {
            lines.push(("  not finite", self.not_finite.to_string()));
        }
        let seconds = self.time.as_secs_f64();
        lines.push(("wall time", format!("{seconds:.6} s")));
        if run > 0 {
            lines.push(("worlds per second", format!("{:.4e}", run as f64 / seconds.max(f64::MIN_POSITIVE))));
        }
        lines.push(("written to", printable(&out.to_string_lossy())));
        if is_interrupted {
            lines.push(("interrupted", "the same command goes on".to_owned()));
        }
        lines.iter().map(|(label, value)| format!("{label:<22} {value}\n")).collect()
    }
}
