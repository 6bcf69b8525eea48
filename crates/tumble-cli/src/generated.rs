//! What is made from the definition of the command line: completions for shells, pages for `man`.

use clap::{Command, CommandFactory as _};
use clap_complete::Shell;

use crate::failure::Failure;
use crate::options::Options;
use crate::print;

/// Writes the script by which a shell completes the words after `tumble`.
pub(crate) fn completions(shell: Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Options::command(), "tumble", &mut script);
    print::own(&script)
}

/// Writes the page of the program, or of one of its commands.
pub(crate) fn man(of: Option<&str>) -> Result<(), Failure> {
    let mut program = Options::command();
    program.build();
    let command = match of {
        None => program,
        Some(name) => subcommand(&program, name)?,
    };
    let mut page = Vec::new();
    let rendered = clap_mangen::Man::new(command).render(&mut page);
    rendered.map_err(|error| Failure::Running(format!("the page cannot be made: {error}")))?;
    print::own(&page)
}

fn subcommand(program: &Command, name: &str) -> Result<Command, Failure> {
    let found = program.find_subcommand(name).cloned();
    found.ok_or_else(|| {
        let names: Vec<_> = program.get_subcommands().map(Command::get_name).filter(|name| *name != "help").collect();
        Failure::Input(format!("there is no command {name:?}; there are {}", names.join(", ")))
    })
}
