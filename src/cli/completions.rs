//! `patchcord completions`

use clap::Args;
use clap_complete::{Shell, generate};

use super::failure::Failure;
use super::{definition, write_out};

#[derive(Args)]
pub(super) struct Arguments {
    /// The shell
    shell: Shell,
}

pub(super) fn completions(arguments: &Arguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(arguments.shell, &mut definition(), env!("CARGO_PKG_NAME"), &mut script);
    write_out(&String::from_utf8_lossy(&script))
}
