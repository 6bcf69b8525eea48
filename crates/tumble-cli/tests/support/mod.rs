//! Running the program as a user does.
#![allow(dead_code, reason = "each test file uses some of it")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Far more than anything takes that is waited for; only a hang reaches it.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// A directory that is gone after the test, with the program started in it.
pub(crate) struct Place {
    directory: tempfile::TempDir,
}

impl Place {
    pub(crate) fn new() -> Self {
        Self { directory: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        fs::write(self.path(name), contents).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Names of everything in the directory, hidden files too.
    pub(crate) fn entries(&self) -> Vec<String> {
        entries(self.directory.path())
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tumble"));
        command.args(arguments).current_dir(self.directory.path()).stdin(Stdio::null());
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs what must succeed.
    pub(crate) fn succeed(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs what must be refused with no file made and none lost; what is said, which has `wanted`
    /// in it.
    pub(crate) fn refused(&self, arguments: &[&str], wanted: &str) -> String {
        let before = self.entries();
        let output = self.run(arguments);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(wanted), "{wanted:?} is not in {message}");
        assert_eq!(self.entries(), before, "{arguments:?}");
        message
    }

    /// Runs with a limit on the size of files, which stands in for a disk that is full: a failure
    /// that names the file and leaves nothing.
    ///
    /// Ignoring SIGXFSZ turns the signal into an error of the write, as on a full disk. Units of
    /// 512 or 1024 bytes.
    #[cfg(unix)]
    pub(crate) fn fills_the_disk(&self, units: u32, arguments: &str, wanted: &str) {
        let program = env!("CARGO_BIN_EXE_tumble");
        let script = format!("trap '' XFSZ; ulimit -f {units}; exec '{program}' {arguments}");
        let mut shell = Command::new("sh");
        shell.args(["-c", &script]).current_dir(self.directory.path()).stdin(Stdio::null());
        let output = shell.output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(stderr(&output).contains(wanted), "{}", stderr(&output));
        assert!(self.entries().is_empty(), "{:?}", self.entries());
    }

    /// The hash in the report of a run.
    pub(crate) fn hash(&self, arguments: &[&str]) -> String {
        let output = self.succeed(arguments);
        let line = output.lines().find(|line| line.starts_with("state hash")).unwrap();
        line.split_whitespace().last().unwrap().to_owned()
    }

    /// The summary that a run wrote into `report`.
    pub(crate) fn summary(&self) -> serde_json::Value {
        serde_json::from_str(&self.read("report/summary.json")).unwrap()
    }

    /// The record of that name, without its first line.
    pub(crate) fn record(&self, name: &str) -> Vec<csv::StringRecord> {
        csv::Reader::from_path(self.path(name)).unwrap().records().map(Result::unwrap).collect()
    }
}

fn entries(directory: &Path) -> Vec<String> {
    let names = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Waits until it is so.
pub(crate) fn wait_for(what: &str, is_so: impl Fn() -> bool) {
    let started = Instant::now();
    while !is_so() {
        assert!(started.elapsed() < PATIENCE, "{what}: it did not come to that");
        std::thread::sleep(Duration::from_millis(2));
    }
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
