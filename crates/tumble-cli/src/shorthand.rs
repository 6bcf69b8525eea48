//! `tumble wall` for `tumble run wall`.

use std::ffi::OsString;

use clap::CommandFactory as _;

use crate::options::Options;

/// The arguments with `run` before a first one that is a built-in scene, a file, or more like a
/// built-in scene than like a command.
pub(crate) fn with_command(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut arguments: Vec<_> = arguments.collect();
    if arguments.get(1).and_then(|first| first.to_str()).is_some_and(is_scene) {
        arguments.insert(1, "run".into());
    }
    arguments
}

fn is_scene(word: &str) -> bool {
    if word.starts_with('-') {
        return false;
    }
    if word.contains(['.', '/', std::path::MAIN_SEPARATOR]) {
        return true;
    }
    let Some(scene) = tumble_scene::nearest_builtin(word) else { return false };
    let command = Options::command();
    let names = command.get_subcommands().map(clap::Command::get_name).chain(["help"]);
    let command = names.map(|name| strsim::jaro(name, word)).fold(0.0, f64::max);
    // A command of that very name comes first.
    command < 1.0 && strsim::jaro(scene, word) >= command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_and_files_are_run_without_the_word() {
        let with_command = |arguments: &[&str]| -> Vec<String> {
            let all = ["tumble"].iter().chain(arguments).map(OsString::from);
            super::with_command(all).into_iter().skip(1).map(|argument| argument.into_string().unwrap()).collect()
        };
        assert_eq!(with_command(&["wall", "--steps", "3"]), ["run", "wall", "--steps", "3"]);
        assert_eq!(with_command(&["piramid"]), ["run", "piramid"]);
        assert_eq!(with_command(&["my.json"]), ["run", "my.json"]);
        for unchanged in [
            &["run", "wall"][..],
            &["inspect", "iss"],
            &["inspct", "iss"],
            &["scene"],
            &["swep"],
            &["veiw"],
            &["help"],
            &["--help"],
            &["scenes"],
            &["nothing-like-it"],
            &[],
        ] {
            assert_eq!(with_command(unchanged), unchanged);
        }
    }
}
