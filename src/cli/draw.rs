//! `patchcord draw`

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::failure::Failure;
use super::files::{check_apart, named_like, prepare, put, written};
use super::instant::{InstantOption, instant};
use super::load::{Loaded, PatchArguments, document};
use super::{say, say_json};
use patchcord::draw::plot::{Drawing, Format, Theme, render_drawing};
use patchcord::draw::schematic::{Board, Schematic, Standing};
use patchcord::instruments::parameter_line;
use patchcord::solve::Machine;

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// Draw into this file; SVG or PNG by its name
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Draw into this folder, as SVG under the patch's name
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the voltages at the outputs: those of the problem check, or after so many seconds of the run
    #[arg(long, value_name = "SECONDS", num_args = 0..=1, default_missing_value = "0", allow_negative_numbers = true, value_parser = instant)]
    values: Option<f64>,
    /// Draw the patch panel of the machine with its cords instead
    #[arg(long, conflicts_with = "values")]
    board: bool,
    /// Draw what is inside of macros in its place, not as boxes
    #[arg(long, conflicts_with = "board")]
    open: bool,
    /// Light lines on a dark page
    #[arg(long)]
    dark: bool,
}

/// The option that chooses when voltages are read.
const VALUES: InstantOption = InstantOption("--values");

pub(super) fn draw(arguments: &Arguments) -> Result<(), Failure> {
    carry_out(arguments).map_err(|failure| failure.told_as_json(arguments.patch.json))
}

fn carry_out(arguments: &Arguments) -> Result<(), Failure> {
    let files = arguments.files()?;
    let loaded = arguments.patch.load()?;
    let (drawing, data) = arguments.drawn(&loaded)?;
    prepare(arguments.out.as_deref(), files.iter().map(|(path, _)| path))?;
    let theme = if arguments.dark { Theme::Dark } else { Theme::Light };
    for (path, format) in &files {
        let bytes = render_drawing(&drawing, *format, theme);
        put(path, &bytes.map_err(|error| arguments.refused(&error))?)?;
    }
    if arguments.patch.json {
        return say_json(&drawing_document(&loaded, data, &files));
    }
    say(&written(files.iter().map(|(path, _)| path)))
}

impl Arguments {
    /// The files to draw into, with their formats.
    fn files(&self) -> Result<Vec<(PathBuf, Format)>, Failure> {
        let patch = &self.patch.patch;
        let ending = if self.board { ".board.svg" } else { ".schematic.svg" };
        let in_folder = self.out.as_ref().map(|folder| folder.join(named_like(patch, ending)));
        let files: Vec<PathBuf> = self.plot.iter().cloned().chain(in_folder).collect();
        if files.is_empty() && !self.patch.json {
            return Err(Failure::usage(
                "nothing to draw into: give --plot FILE.svg, --plot FILE.png or --out DIR",
            ));
        }
        let formats: Result<Vec<_>, _> = files.iter().map(|path| Format::from_path(path)).collect();
        let formats = formats.map_err(|error| Failure::usage(error.to_string()))?;
        check_apart(patch, files.iter())?;
        Ok(files.into_iter().zip(formats).collect())
    }

    /// The drawing, and its data under their name.
    fn drawn(&self, loaded: &Loaded) -> Result<(Drawing, (&'static str, Value)), Failure> {
        if self.board {
            let board = Board::new(&loaded.circuit, &parameter_line(&loaded.circuit));
            let board = board.map_err(|error| self.refused(&error))?;
            return Ok((board.drawing(), ("board", board.to_json())));
        }
        let schematic = self.schematic(loaded)?;
        Ok((schematic.drawing(), ("schematic", schematic.to_json())))
    }

    fn schematic(&self, loaded: &Loaded) -> Result<Schematic, Failure> {
        let read = self.values.map(|seconds| VALUES.machine(loaded, seconds)).transpose()?;
        let (machine, instant) = read.map(|read| (read.machine, format!("voltages {}", read.told))).unzip();
        let standing = |name: &str| {
            let machine: &Machine<'_> = machine.as_ref()?;
            Some(Standing { volts: machine.voltage(name).ok()?, position: machine.position(name) })
        };
        let schematic = if self.open { Schematic::opened } else { Schematic::new };
        let (note, instant) = (parameter_line(&loaded.circuit), instant.unwrap_or_default());
        schematic(&loaded.circuit, &note, &instant, &standing).map_err(|error| self.refused(&error))
    }

    /// What cannot be drawn, and what may help.
    fn refused(&self, error: &dyn std::error::Error) -> Failure {
        let advice = match self {
            Arguments { board: true, .. } => "the schematic, without --board, may have room",
            Arguments { open: true, .. } => "without --open, macros are drawn as boxes",
            _ => "put parts of the patch into macros, which are drawn as boxes, or draw a part of it",
        };
        Failure::data(format!("{error}; {advice}"))
    }
}

fn drawing_document(loaded: &Loaded, (name, data): (&str, Value), files: &[(PathBuf, Format)]) -> Value {
    let paths: Value = files.iter().map(|(path, _)| path.display().to_string()).collect();
    document(&loaded.circuit, json!({ name: data, "files": paths }))
}
