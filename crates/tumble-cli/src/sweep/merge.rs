//! `tumble merge`.

use std::fs;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use tumble_record::PendingFile;

use crate::sweep::file::{SweepFileError, SweepReader};
use crate::sweep::identity::SweepIdentity;
use crate::sweep::shard::Shard;

use crate::ending::check_ending;
use crate::failure::Failure;
use crate::interrupt;
use crate::sweep::options::MergeOptions;
use crate::sweep::plot::SweepPlot;

/// Writes the file that the whole sweep would have written on one machine.
pub(crate) fn merge(options: &MergeOptions) -> Result<(), Failure> {
    let out = &options.out;
    check_ending(out, "a sweep's file", "csv")?;
    interrupt::watch()?;
    let Shards { identity, columns, files } = in_order(&options.shards)?;
    for (_, path) in &files {
        if fs::canonicalize(path).ok() == fs::canonicalize(out).ok() {
            return Err(Failure::Input(format!("{}: is a shard itself, it cannot be the whole", out.display())));
        }
    }
    let plot = SweepPlot::open(&options.plot, &columns, options.shards.clone())?;
    let mut replaced = claim(out, &identity)?;
    let mut file = PendingFile::create(out).map_err(|error| Failure::opening(out, &error))?;
    let header = crate::sweep::file::sweep_header(&identity, &columns);
    let mut written = header.and_then(|header| file.write_all(header.as_bytes()));
    for (_, path) in &files {
        let mut reader = SweepReader::open(path)?;
        while let (Ok(()), Some(row)) = (&written, reader.next_row()?) {
            if interrupt::asked() {
                return Err(Failure::Interrupted);
            }
            written = file.write_all(row);
        }
        let worlds = reader.worlds();
        if written.is_ok() && reader.next_world() < worlds.end {
            let (has, all) = (reader.next_world() - worlds.start, worlds.end - worlds.start);
            let problem = format!("{}: has {has} of its {all} worlds, its sweep is not finished", path.display());
            return Err(Failure::Input(problem));
        }
    }
    if replaced.is_none() {
        // A sweep may have begun it in the meantime.
        replaced = claim(out, &identity)?;
    }
    written.and_then(|()| file.finish()).map_err(|error| Failure::writing(out, &error))?;
    drop(replaced);
    match plot {
        Some(plot) => plot.draw(out, &format!("{} shards", files.len())),
        None => Ok(()),
    }
}

/// Takes the lock that a sweep takes, if there is a file to replace; only one of the same sweep may
/// be.
fn claim(out: &Path, identity: &SweepIdentity) -> Result<Option<SweepReader>, Failure> {
    match fs::symlink_metadata(out) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(SweepFileError::Io { path: out.to_owned(), error }.into()),
        Ok(_) => {}
    }
    let there = SweepReader::open(out)?;
    there.refuse_another(identity)?;
    there.lock()?;
    Ok(Some(there))
}

/// All shards of one sweep by their number, with what they have in common.
struct Shards {
    identity: SweepIdentity,
    columns: Vec<String>,
    files: Vec<(Shard, PathBuf)>,
}

fn in_order(paths: &[PathBuf]) -> Result<Shards, Failure> {
    let mut common: Option<(SweepIdentity, Vec<String>)> = None;
    let mut files = Vec::with_capacity(paths.len());
    for path in paths {
        // Closed again, for there may be more shards than files can be open.
        let reader = SweepReader::open(path)?;
        let (identity, columns) = (reader.identity().whole(), reader.columns().to_owned());
        let Some(shard) = reader.identity().shard() else {
            return Err(Failure::Input(format!("{}: is a whole sweep already, not a shard", path.display())));
        };
        files.push((shard, path.clone()));
        match &common {
            Some((of_first, columns_of_first)) => {
                let columns_differ = (columns != *columns_of_first).then(|| "columns: have other names".to_owned());
                if let Some(difference) = identity.difference(of_first).or(columns_differ) {
                    let first = paths.first().map_or(Path::new(""), PathBuf::as_path).display();
                    return Err(Failure::Input(format!(
                        "{}: is of another sweep than {first}: {difference}",
                        path.display()
                    )));
                }
            }
            None => common = Some((identity, columns)),
        }
    }
    files.sort();
    check_complete(&files)?;
    let (identity, columns) = common.ok_or_else(|| Failure::Input("there is no shard".to_owned()))?;
    Ok(Shards { identity, columns, files })
}

fn check_complete(shards: &[(Shard, PathBuf)]) -> Result<(), Failure> {
    let count = shards.first().map_or(0, |(shard, _)| shard.count());
    let mut expected = 1;
    for (shard, path) in shards {
        let problem = if shard.count() != count {
            format!("is shard {shard}, and others are of {count}")
        } else if shard.index() < expected {
            format!("is shard {shard}, which is there twice")
        } else if shard.index() > expected {
            return Err(Failure::Input(format!("shard {expected}/{count} is missing")));
        } else {
            expected += 1;
            continue;
        };
        return Err(Failure::Input(format!("{}: {problem}", path.display())));
    }
    if expected <= count { Err(Failure::Input(format!("shard {expected}/{count} is missing"))) } else { Ok(()) }
}
