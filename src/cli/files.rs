//! The options of a run for files, and the files that they select: tables and pictures.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::Failure;
use super::load::PatchArguments;
use super::outputs::Outputs;
use patchcord::circuit::Circuit;
use patchcord::document::escape_controls;
use patchcord::draw;
use patchcord::draw::plot::{self, Format, Picture, Size};
use patchcord::instruments::parameter_line;
use patchcord::trace::Trace;

#[derive(Args)]
pub(super) struct FileArguments {
    /// Write the recorded signals as CSV, in physical units
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw the pictures of the patch on one sheet; the file name selects SVG or PNG
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Write table and pictures into this folder, under the name of the patch
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl FileArguments {
    /// Whether pictures are drawn.
    pub(super) fn draw(&self) -> bool {
        self.plot.is_some() || self.out.is_some()
    }

    /// The files to write.
    ///
    /// `--out` adds NAME.csv and NAME.svg in the folder.
    ///
    /// # Errors
    /// If the name of a picture has an unknown ending.
    pub(super) fn files(&self, patch: &PatchArguments, circuit: &Circuit) -> Result<Files, Failure> {
        let in_folder =
            |ending| self.out.as_ref().map(|folder| folder.join(name_with_suffix(&patch.patch, ending)));
        let tables = self.csv.clone().into_iter().chain(in_folder(".csv")).collect();
        let sheets = self.plot.clone().into_iter().chain(in_folder(".svg"));
        let sheets = sheets.map(|path| picture_format(&path).map(|format| (path, format)));
        Ok(Files {
            outputs: patch.outputs(circuit),
            folder: self.out.clone(),
            tables,
            sheets: sheets.collect::<Result<_, _>>()?,
        })
    }
}

/// The name of the patch with another ending. Dots inside the name remain.
pub(super) fn name_with_suffix(patch: &Path, ending: &str) -> OsString {
    let mut name = patch.file_stem().unwrap_or_default().to_owned();
    name.push(ending);
    name
}

/// The output files of a run.
pub(super) struct Files {
    /// Writes the files.
    outputs: Outputs,
    /// The folder to create.
    folder: Option<PathBuf>,
    /// The CSV tables.
    tables: Vec<PathBuf>,
    /// The sheets of pictures with their formats.
    sheets: Vec<(PathBuf, Format)>,
}

impl Files {
    /// The paths of all files.
    pub(super) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.tables.iter().chain(self.sheets.iter().map(|(path, _)| path))
    }

    /// Creates the folder, and checks before the run that all files can be written and that the pictures fit on a
    /// sheet. `recorded` is the number of recorded signals.
    ///
    /// # Errors
    /// If there are too many pictures, two files are the same, one was read, or the folder or a file cannot be written.
    pub(super) fn prepare(&self, circuit: &Circuit, recorded: usize) -> Result<(), Failure> {
        if !self.sheets.is_empty() {
            // Without pictures in the patch, every recorded signal gets one.
            let pictures = Some(circuit.patch().pictures.len()).filter(|count| *count > 0);
            plot::check_sheet(pictures.unwrap_or(recorded), Size::default())
                .map_err(|error| Failure::data(error.to_string()))?;
        }
        self.outputs.prepare(self.folder.as_deref(), self.paths())
    }

    /// Writes tables and pictures.
    ///
    /// # Errors
    /// If a picture cannot be drawn, or if a file cannot be written.
    pub(super) fn write(&self, trace: &Trace, circuit: &Circuit) -> Result<(), Failure> {
        for path in &self.tables {
            let mut bytes = Vec::new();
            trace.write_csv(&mut bytes).map_err(|error| Failure::data(error.to_string()))?;
            self.outputs.write(path, &bytes)?;
        }
        if self.sheets.is_empty() {
            return Ok(());
        }
        let pictures = pictures(circuit, trace)?;
        for (path, format) in &self.sheets {
            write_pictures(&self.outputs, path, &pictures, *format, Size::default())?;
        }
        Ok(())
    }
}

/// The picture format that the name of a file selects.
///
/// # Errors
/// A usage error if the name has no known ending.
pub(super) fn picture_format(path: &Path) -> Result<Format, Failure> {
    Format::from_path(path).map_err(|error| Failure::usage(error.to_string()))
}

/// The paths as texts for `--json`.
pub(super) fn path_texts<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Vec<String> {
    paths.into_iter().map(|path| path.display().to_string()).collect()
}

/// A path in a message, on one line and without control characters.
pub(super) fn path_text(path: &Path) -> String {
    escape_controls(&path.display().to_string())
}

/// The list of written files after an empty line; empty if there are none.
pub(super) fn written_paragraph<'a>(paths: impl Iterator<Item = &'a PathBuf>) -> String {
    let text = written_text(paths);
    if text.is_empty() { text } else { format!("\n{text}") }
}

/// "wrote FILE" for each file, one per line.
pub(super) fn written_text<'a>(paths: impl Iterator<Item = &'a PathBuf>) -> String {
    paths.map(|path| format!("wrote {}\n", path_text(path))).collect()
}

/// Draws pictures on one sheet and writes the file.
pub(super) fn write_pictures(
    outputs: &Outputs,
    path: &Path,
    pictures: &[Picture],
    format: Format,
    size: Size,
) -> Result<(), Failure> {
    let bytes = plot::render(pictures, format, size).map_err(|error| Failure::data(error.to_string()))?;
    outputs.write(path, &bytes)
}

/// The pictures of the patch, or every recorded signal against time if it has none. Pictures of derivatives follow.
///
/// The note of each picture has the parameters.
fn pictures(circuit: &Circuit, trace: &Trace) -> Result<Vec<Picture>, Failure> {
    let signals = trace.tracks.iter().filter(|track| track.derivative.is_none());
    let specs = circuit.picture_specs(signals.map(|track| track.name.as_str()));
    let note = parameter_line(circuit);
    let drawn = specs.iter().map(|spec| draw::picture(trace, spec, Some(&note)));
    let drawn = drawn.collect::<Result<Vec<_>, _>>().and_then(|mut pictures| {
        pictures.extend(draw::sensitivity_pictures(trace, Some(&note))?);
        Ok(pictures)
    });
    drawn.map_err(|error| Failure::data(error.to_string()))
}
