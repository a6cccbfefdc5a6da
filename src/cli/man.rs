//! `patchcord man`

use std::io;
use std::path::{Path, PathBuf};

use clap::{Args, Command};
use clap_mangen::Man;

use super::failure::Failure;
use super::files::path_text;
use super::outputs::Outputs;
use super::{definition, print, write_out};
use patchcord::document::suggestion;

#[derive(Args)]
pub(super) struct Arguments {
    /// Print the page of this command (default: the page of patchcord)
    command: Option<String>,
    /// Write every page into this folder, such as ~/.local/share/man/man1
    #[arg(long, value_name = "DIR", conflicts_with = "command")]
    out: Option<PathBuf>,
}

pub(super) fn man(arguments: &Arguments) -> Result<(), Failure> {
    // The built-in "help" command adds nothing to the pages.
    let mut patchcord = definition().disable_help_subcommand(true);
    patchcord.build();
    match (&arguments.out, &arguments.command) {
        (Some(folder), _) => write_pages(&patchcord, folder),
        (None, Some(name)) => write_out(&text(page(find(&patchcord, name)?))?),
        (None, None) => write_out(&text(page(&patchcord))?),
    }
}

/// The command with this name.
fn find<'a>(patchcord: &'a Command, name: &str) -> Result<&'a Command, Failure> {
    patchcord.find_subcommand(name).ok_or_else(|| {
        let known: Vec<_> = patchcord.get_subcommands().map(Command::get_name).collect();
        let hint = suggestion(name, &known).unwrap_or_default();
        Failure::usage(format!("there is no command \"{name}\"; {hint}"))
    })
}

fn page(command: &Command) -> Man {
    let source = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
    Man::new(command.clone().override_usage(synopsis(command))).source(source).manual("patchcord manual")
}

/// The command with its options and their values, for the synopsis.
fn synopsis(command: &Command) -> String {
    let name = command.get_bin_name().unwrap_or_else(|| command.get_name());
    let (positional, options): (Vec<_>, Vec<_>) =
        command.get_arguments().partition(|argument| argument.is_positional());
    let options = options.iter().map(|option| format!("[{option}]"));
    let positional = positional.iter().map(ToString::to_string);
    let subcommand = command.has_subcommands().then(|| "<COMMAND>".to_owned());
    let words: Vec<_> =
        [name.to_owned()].into_iter().chain(options).chain(positional).chain(subcommand).collect();
    words.join(" ")
}

/// The text of a page in roff.
fn text(page: Man) -> Result<String, Failure> {
    let mut bytes = Vec::new();
    page.render(&mut bytes).map_err(|error: io::Error| Failure::data(error.to_string()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Writes every page into a folder.
fn write_pages(patchcord: &Command, folder: &Path) -> Result<(), Failure> {
    let named_page = |command: &Command| -> Result<(PathBuf, String), Failure> {
        let page = page(command);
        Ok((folder.join(page.get_filename()), text(page)?))
    };
    let commands = std::iter::once(patchcord).chain(patchcord.get_subcommands());
    let pages = commands.map(named_page).collect::<Result<Vec<_>, _>>()?;
    let outputs = Outputs::default();
    outputs.prepare(Some(folder), pages.iter().map(|(path, _)| path))?;
    for (path, text) in &pages {
        outputs.write(path, text.as_bytes())?;
        print(&format!("wrote {}\n", path_text(path)))?;
    }
    Ok(())
}
