//! Time series of a sweep: where the reported bodies are on the way, in one file for all worlds.

use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use tumble::{BodyOrder, Pose, Trial, Velocity};
use tumble_record::{COLUMNS, csv_cell, state_numbers};

use crate::failure::Failure;
use crate::sweep::Sweep;
use crate::sweep::file::lock;
use crate::sweep::identity::SweepIdentity;

/// What the first line begins with; readers of CSV take it for a comment.
const BEFORE_IDENTITY: &str = "# tumble series ";

/// The states of the reported bodies of one world, as lines of the file.
pub(crate) struct Series {
    every: u64,
    /// World and names, as they stand in the file.
    world: u64,
    bodies: Vec<(usize, String)>,
    last: Option<u64>,
    text: String,
}

impl Series {
    /// That of a world, if the sweep has any; begins with the state at the start.
    pub(crate) fn start(sweep: &Sweep, world: u64, trial: &Trial, order: &BodyOrder) -> Option<Self> {
        let every = sweep.plan().series?.get();
        let names = sweep.reported_names().iter().map(|name| quoted(&csv_cell(name)));
        let bodies = sweep.reported().iter().copied().zip(names).collect();
        let mut series = Self { every, world, bodies, last: None, text: String::new() };
        series.write(trial, order);
        Some(series)
    }

    /// Sees a step that was just done.
    pub(crate) fn see(&mut self, trial: &Trial, order: &BodyOrder) {
        if trial.simulation.steps().is_multiple_of(self.every) {
            self.write(trial, order);
        }
    }

    /// The lines, with the last state whichever step it is of.
    pub(crate) fn finish(mut self, trial: &Trial, order: &BodyOrder) -> String {
        if self.last != Some(trial.simulation.steps()) {
            self.write(trial, order);
        }
        self.text
    }

    /// The line of a world that no body can have, which is empty but for the world.
    pub(crate) fn of_impossible(world: u64) -> String {
        format!("{world}{}\n", ",".repeat(COLUMNS.len()))
    }

    fn write(&mut self, trial: &Trial, order: &BodyOrder) {
        let (step, time) = (trial.simulation.steps(), trial.simulation.time());
        self.last = Some(step);
        for (body, name) in &self.bodies {
            let entity = order.entities().get(*body).and_then(|entity| trial.world.entity(*entity).ok());
            let Some((entity, pose)) = entity.and_then(|entity| Some((entity, *entity.get::<&Pose>()?))) else {
                continue;
            };
            // Writing to a string cannot fail.
            let _ = write!(self.text, "{},{step},{time:?},{name}", self.world);
            for number in state_numbers(&pose, entity.get::<&Velocity>().as_deref()) {
                let _ = write!(self.text, ",{number:?}");
            }
            self.text.push('\n');
        }
    }
}

/// The file of the time series, in the order of the worlds.
pub(crate) struct SeriesFile {
    path: PathBuf,
    file: File,
}

impl SeriesFile {
    /// Makes the file, or goes on with it at a world; what is there of that and later worlds is cut
    /// off.
    pub(crate) fn open(path: &Path, identity: &SweepIdentity, world: u64) -> Result<Self, Failure> {
        let worlds = identity.range().start..world;
        let opening = |error: io::Error| Failure::opening(path, &error);
        let head = head(identity).map_err(opening)?;
        let there = path.metadata().ok();
        let refused = |problem: &str| Err(Failure::Input(format!("{}: {problem}", path.display())));
        if there.as_ref().is_some_and(|there| !there.is_file()) {
            return refused("is not a regular file");
        }
        if there.is_none() && !worlds.is_empty() {
            return refused("is not there, and the sweep has worlds already whose series it had");
        }
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(opening)?;
        lock(path, &file)?;
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
    pub(crate) fn append(&mut self, lines: &str) -> Result<(), Failure> {
        self.file.write_all(lines.as_bytes()).map_err(|error| Failure::writing(&self.path, &error))
    }

    /// Waits until all is on the disk.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        self.file.sync_all().map_err(|error| Failure::writing(&self.path, &error))
    }
}

/// As a field of CSV.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\r', '\n']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
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
