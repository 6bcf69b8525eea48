//! What an output may take the place of: nothing, or what this program wrote before.

use std::fs::{self, File};
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use tumble_record::{COLUMNS, TrajectoryFormat};

use crate::failure::Failure;

/// What an output is, by which a file that stands in its place is known for one of ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Record(TrajectoryFormat),
    /// A record until it is finished: what a killed run left may be torn.
    Partial(TrajectoryFormat),
    Summary,
    Ledger,
    Picture,
    Page,
}

/// Files that are not to be lost.
#[derive(Clone, Debug)]
pub(crate) struct Guard {
    /// What was read: never replaced.
    pub(crate) inputs: Vec<PathBuf>,
    /// Whether what is not ours may be.
    pub(crate) force: bool,
}

impl Guard {
    /// Refuses a path at which there is an input of this run, or a file that this program did not
    /// write.
    pub(crate) fn check(&self, path: &Path, kind: Kind) -> Result<(), Failure> {
        // What is no file, or cannot be asked, is refused when it is opened.
        let Ok(true) = fs::metadata(path).map(|there| there.is_file()) else { return Ok(()) };
        let shown = path.display();
        if let Some(input) = self.inputs.iter().position(|input| is_same(input, path)) {
            let which = if input == 0 { "the scene itself" } else { "a file of the scene" };
            return Err(Failure::Input(format!("{shown}: is {which}, it cannot be {}", kind.name())));
        }
        if self.force || is_ours(path, kind) {
            return Ok(());
        }
        let name = kind.name();
        Err(Failure::Input(format!("{shown}: is there already and is not {name} of this program; --force replaces it")))
    }
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Record(_) => "the record",
            Self::Partial(_) => "the record until it is finished",
            Self::Summary | Self::Ledger | Self::Page => "the report",
            Self::Picture => "the picture",
        }
    }
}

/// By where the names lead and, where the system tells, by what they are names of.
fn is_same(a: &Path, b: &Path) -> bool {
    let same_place = matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b);
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        let id = |path: &Path| fs::metadata(path).ok().map(|file| (file.dev(), file.ino()));
        same_place || id(a).is_some_and(|id_of_a| id(b) == Some(id_of_a))
    }
    #[cfg(not(unix))]
    same_place
}

/// As much of a text as its kind is known by \[bytes\].
const HEAD: u64 = 1 << 14;

/// Longest description of a record that is looked into \[bytes\].
const MAX_JSON: u64 = 256 << 20;

/// Whether a file is one that this program writes. An empty one is nobody's.
fn is_ours(path: &Path, kind: Kind) -> bool {
    let Ok(mut file) = File::open(path) else { return false };
    let mut head = Vec::new();
    if file.by_ref().take(HEAD).read_to_end(&mut head).is_err() {
        return false;
    }
    let has = |part: &str| head.windows(part.len()).any(|window| window == part.as_bytes());
    let columns = || COLUMNS.join(",") + "\n";
    head.is_empty()
        || match kind {
            Kind::Record(TrajectoryFormat::Csv) => head.starts_with(columns().as_bytes()),
            // It may have been killed within its first line, or before its description was whole.
            Kind::Partial(TrajectoryFormat::Csv) => {
                let columns = columns();
                head.starts_with(columns.as_bytes()) || columns.as_bytes().starts_with(&head)
            }
            Kind::Partial(TrajectoryFormat::Glb) => head.starts_with(b"glTF"),
            Kind::Partial(TrajectoryFormat::Parquet) => head.starts_with(b"PAR1"),
            Kind::Record(TrajectoryFormat::Glb) => head.starts_with(b"glTF") && is_our_animation(file),
            Kind::Record(TrajectoryFormat::Parquet) => head.starts_with(b"PAR1") && is_our_table(file),
            Kind::Ledger => head.starts_with(b"step,time,linear_kinetic,rotational_kinetic,"),
            Kind::Picture => {
                head.starts_with(b"<svg ") && has("role=\"img\">\n<title>") && has("<rect class=\"ground\"")
            }
            Kind::Page => has("<!-- A report of tumble, complete in this file."),
            Kind::Summary => is_our_summary(path),
        }
}

fn is_our_animation(mut file: File) -> bool {
    #[derive(serde::Deserialize)]
    struct Document {
        asset: Asset,
    }
    #[derive(serde::Deserialize)]
    struct Asset {
        generator: String,
    }
    let mut header = [0; 20];
    if file.seek(SeekFrom::Start(0)).is_err() || file.read_exact(&mut header).is_err() {
        return false;
    }
    let [.., a, b, c, d, _, _, _, _] = header;
    let length = u64::from(u32::from_le_bytes([a, b, c, d])).min(MAX_JSON);
    let document: Result<Document, _> = serde_json::from_reader(std::io::BufReader::new(file.take(length)));
    document.is_ok_and(|document| document.asset.generator.starts_with("tumble "))
}

/// The description of a table is at its end, before its length and the magic number.
fn is_our_table(mut file: File) -> bool {
    let mut read_back = |bytes: u64| -> Option<Vec<u8>> {
        let end = file.seek(SeekFrom::End(0)).ok()?;
        file.seek(SeekFrom::Start(end.checked_sub(bytes)?)).ok()?;
        let mut read = Vec::new();
        file.by_ref().take(bytes).read_to_end(&mut read).ok()?;
        Some(read)
    };
    let Some([a, b, c, d, b'P', b'A', b'R', b'1']) =
        read_back(8).as_deref().map(|end| <[u8; 8]>::try_from(end).unwrap_or_default())
    else {
        return false;
    };
    let length = u64::from(u32::from_le_bytes([a, b, c, d])).min(MAX_JSON);
    let description = read_back(length.saturating_add(8)).unwrap_or_default();
    description.windows(7).any(|window| window == b"tumble ")
}

fn is_our_summary(path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return false };
    let parsed = serde_json::from_reader(std::io::BufReader::new(file.take(HEAD)));
    let Ok(serde_json::Value::Object(summary)) = parsed else { return false };
    ["bodies", "state_hash", "body_steps_per_second"].iter().all(|key| summary.contains_key(*key))
}
