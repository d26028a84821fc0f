//! What a package installs beside the command: completions for shells, and manual pages, both made of the command line.

use crate::args::{Cli, CompletionsArgs, ManualArgs};
use crate::failure::Failure;
use crate::place;
use clap::CommandFactory;
use std::io::{self, Write};

/// Prints the script of a shell.
pub(crate) fn completions(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "rumbo", &mut script);
    Ok(io::stdout().write_all(&script)?)
}

/// Writes a page for the command and one for each subcommand.
pub(crate) fn manual(args: &ManualArgs) -> Result<(), Failure> {
    place::try_folder(&args.folder)?;
    clap_mangen::generate_to(Cli::command(), &args.folder)
        .map_err(|error| place::unwritable(&args.folder, &error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap_complete::Shell;

    #[test]
    fn every_subcommand_has_its_page_and_is_completed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_owned();
        manual(&ManualArgs {
            folder: path.clone(),
        })
        .unwrap();
        let mut script = Vec::new();
        clap_complete::generate(Shell::Fish, &mut Cli::command(), "rumbo", &mut script);
        let script = String::from_utf8(script).unwrap();
        for command in Cli::command()
            .get_subcommands()
            .filter(|one| !one.is_hide_set())
        {
            let name = command.get_name();
            let page = std::fs::read_to_string(path.join(format!("rumbo-{name}.1"))).unwrap();
            assert!(
                page.contains("Examples:") && page.contains(".SH OPTIONS"),
                "{name}"
            );
            assert!(script.contains(&format!("-a \"{name}\"")), "{name}");
        }
    }
}
