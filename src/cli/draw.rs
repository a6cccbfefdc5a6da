//! `patchcord draw`

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use serde_json::Value;

use super::failure::Failure;
use super::files::{FOLDER_OPTION, name_with_suffix, path_texts, picture_format, written_text};
use super::instant::{InstantOption, instant};
use super::load::{LoadedPatch, PatchArguments, PatchDocument};
use super::progress::ProgressBar;
use super::{print, print_json};
use patchcord::circuit::Circuit;
use patchcord::draw::plot::{Drawing, Format, Theme, render_drawing};
use patchcord::draw::schematic::{Board, DrawError, ElementState, Schematic};
use patchcord::instruments::parameter_line;
use patchcord::solve::Machine;

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// Draw into this file; the ending of its name selects SVG or PNG
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Draw an SVG file into this folder, named after the patch
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Show the voltages at the outputs: at initial condition, or after this many seconds of the run
    #[arg(long, value_name = "SECONDS", num_args = 0..=1, default_missing_value = "0", allow_negative_numbers = true, value_parser = instant)]
    values: Option<f64>,
    /// Draw the patch panel of the machine with its cords instead of the schematic
    #[arg(long, conflicts_with = "values")]
    board: bool,
    /// Draw the elements of each macro instead of a box
    #[arg(long, conflicts_with = "board")]
    open: bool,
    /// Draw light lines on a dark background
    #[arg(long)]
    dark: bool,
}

/// The option that selects the time of the voltages.
const VALUES: InstantOption = InstantOption { command: "draw", option: "--values" };

/// The keys of the document in addition to those of every command on a patch.
#[derive(Serialize)]
struct Document {
    #[serde(flatten)]
    content: DrawingContent,
    files: Vec<String>,
}

/// The positions of everything that is drawn. The key is `schematic` or `board`.
#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum DrawingContent {
    Schematic(Value),
    Board(Value),
}

/// The patch panel, with a progress bar: to route hundreds of cords takes minutes. A schematic takes a second.
fn board(circuit: &Circuit) -> Result<Board, DrawError> {
    let bar = ProgressBar::new("draw", "cords");
    Board::with_progress(circuit, &parameter_line(circuit), &mut |done, all| {
        bar.done(done as u64, all as u64)
    })
}

/// The drawing is the same for all files.
pub(super) fn draw(arguments: &Arguments) -> Result<(), Failure> {
    let files = arguments.files()?;
    let loaded = arguments.patch.load()?;
    let outputs = arguments.patch.outputs(&loaded.circuit);
    outputs.prepare(arguments.out.as_deref(), files.iter().map(|(path, _)| path))?;
    let (drawing, content) = arguments.drawing(&loaded)?;
    let theme = if arguments.dark { Theme::Dark } else { Theme::Light };
    for (path, format) in &files {
        let bytes = render_drawing(&drawing, *format, theme);
        outputs.write(path, &bytes.map_err(|error| arguments.failure(&error))?)?;
    }
    if arguments.patch.json {
        let document = Document { content, files: path_texts(files.iter().map(|(path, _)| path)) };
        return print_json(&PatchDocument::new(&loaded.circuit, &loaded.warnings, document));
    }
    print(&written_text(files.iter().map(|(path, _)| path)))
}

impl Arguments {
    /// The files to write, with their formats.
    fn files(&self) -> Result<Vec<(PathBuf, Format)>, Failure> {
        FOLDER_OPTION.check(self.out.as_deref())?;
        let patch = &self.patch.patch;
        let ending = if self.board { ".board.svg" } else { ".schematic.svg" };
        let in_folder = self.out.as_ref().map(|folder| folder.join(name_with_suffix(patch, ending)));
        let files: Vec<PathBuf> = self.plot.iter().cloned().chain(in_folder).collect();
        if files.is_empty() && !self.patch.json {
            return Err(Failure::usage("no output file: give --plot FILE.svg, --plot FILE.png or --out DIR"));
        }
        let formats = files.iter().map(|path| picture_format(path)).collect::<Result<Vec<_>, _>>()?;
        Ok(files.into_iter().zip(formats).collect())
    }

    /// The drawing, and its content for `--json`.
    fn drawing(&self, loaded: &LoadedPatch) -> Result<(Drawing, DrawingContent), Failure> {
        if self.board {
            let board = board(&loaded.circuit).map_err(|error| self.failure(&error))?;
            return Ok((board.drawing(), DrawingContent::Board(board.to_json())));
        }
        let schematic = self.schematic(loaded)?;
        Ok((schematic.drawing(), DrawingContent::Schematic(schematic.to_json())))
    }

    /// The schematic, with voltages if requested.
    fn schematic(&self, loaded: &LoadedPatch) -> Result<Schematic, Failure> {
        let point = self.values.map(|seconds| VALUES.machine(loaded, seconds)).transpose()?;
        let (machine, instant) =
            point.map(|point| (point.machine, format!("voltages {}", point.description))).unzip();
        let state = |name: &str| {
            let machine: &Machine<'_> = machine.as_ref()?;
            Some(ElementState { volts: machine.voltage(name).ok()?, position: machine.position(name) })
        };
        let schematic = if self.open { Schematic::expanded } else { Schematic::new };
        let (note, instant) = (parameter_line(&loaded.circuit), instant.unwrap_or_default());
        schematic(&loaded.circuit, &note, &instant, &state).map_err(|error| self.failure(&error))
    }

    /// The failure for a drawing that is too large, with advice.
    fn failure(&self, error: &dyn std::error::Error) -> Failure {
        let advice = match self {
            Arguments { board: true, .. } => "the schematic, without --board, may fit",
            Arguments { open: true, .. } => "without --open, macros are drawn as boxes",
            _ => "put parts of the patch into macros, which are drawn as boxes, or draw only a part of it",
        };
        Failure::data(format!("{error}; {advice}"))
    }
}
