//! `patchcord equations`

use clap::Args;

use super::failure::Failure;
use super::load::{LoadedPatch, PatchArguments, PatchDocument, heading};
use super::{print, print_json};
use patchcord::equations::{Detail, EquationListing};

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// Print an equation for every element, in volts if it has no signal (default: only signals, drives and states)
    #[arg(long)]
    all: bool,
    /// Print LaTeX: an `align` environment of the package amsmath, then the modes and tables
    #[arg(long, conflicts_with = "json")]
    latex: bool,
}

/// The text has a heading; LaTeX and JSON are for other programs.
pub(super) fn equations(arguments: &Arguments) -> Result<(), Failure> {
    let LoadedPatch { circuit, program, warnings } = arguments.patch.load()?;
    let detail = if arguments.all { Detail::Elements } else { Detail::Signals };
    let listing = EquationListing::new(&circuit, &program, detail);
    if arguments.patch.json {
        return print_json(&PatchDocument::new(&circuit, &warnings, listing.document()));
    }
    if arguments.latex {
        return print(&listing.latex());
    }
    print(&(heading(&circuit) + &listing.text()))
}
