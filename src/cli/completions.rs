//! `patchcord completions`

use clap::Args;
use clap_complete::{Shell, generate};

use super::failure::Failure;
use super::{definition, write_out};

/// Where each shell looks for the script.
const PLACES: &str = "\
Where to write the script:
  bash        ~/.local/share/bash-completion/completions/patchcord
  zsh         a file _patchcord in a folder of $fpath
  fish        ~/.config/fish/completions/patchcord.fish
  elvish      append it to ~/.config/elvish/rc.elv
  powershell  append it to the file $PROFILE";

#[derive(Args)]
#[command(after_help = PLACES)]
pub(super) struct Arguments {
    /// The shell that reads the script
    shell: Shell,
}

pub(super) fn completions(arguments: &Arguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(arguments.shell, &mut definition(), env!("CARGO_PKG_NAME"), &mut script);
    write_out(&String::from_utf8_lossy(&script))
}
