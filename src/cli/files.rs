//! The options of a run for files, and the files that they select: tables and pictures.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::Failure;
use super::load::PatchArguments;
use super::outputs::Outputs;
use super::pictures::{PictureArguments, Resolution, pictures};
use super::standard_streams::{check_output, check_table, is_dash, table_path};
use super::streamed_tables::StreamedTables;
use patchcord::circuit::Circuit;
use patchcord::document::escape_controls;
use patchcord::draw::plot::{self, Format, Picture, Size};
use patchcord::draw::{self, PictureSamples, TooManySamplesError};
use patchcord::solve::RunSettings;
use patchcord::trace::Trace;

#[derive(Args)]
pub(super) struct FileArguments {
    /// Write the recorded signals as CSV, in physical units; with -, to standard output in place of the readings
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw the pictures of the patch on one sheet; the ending of the file name selects SVG or PNG
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Write the table, the sheet and a file for each picture into this folder, named after the patch
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    pictures: PictureArguments,
}

impl FileArguments {
    /// Whether pictures are drawn.
    pub(super) fn draw(&self) -> bool {
        self.plot.is_some() || self.out.is_some()
    }

    /// Whether the table goes to standard output, which then has nothing else.
    pub(super) fn prints_table(&self) -> bool {
        self.csv.as_deref().is_some_and(is_dash)
    }

    /// The files to write.
    ///
    /// `--out` adds NAME.csv and NAME.svg in the folder. [`Files::plan_pictures`] adds the single pictures.
    ///
    /// # Errors
    /// If the name of a picture has an unknown ending, if an option for pictures has no effect, or if a table and a
    /// JSON document both go to standard output.
    pub(super) fn files(&self, patch: &PatchArguments, circuit: &Circuit) -> Result<Files, Failure> {
        check_table(self.csv.as_deref(), patch.json)?;
        CSV_OPTION.check(self.csv.as_deref())?;
        FOLDER_OPTION.check(self.out.as_deref())?;
        let in_folder =
            |ending| self.out.as_ref().map(|folder| folder.join(name_with_suffix(&patch.patch, ending)));
        let tables = self.csv.as_deref().map(table_path).into_iter().chain(in_folder(".csv")).collect();
        let sheets = self.plot.clone().into_iter().chain(in_folder(".svg"));
        let sheets = sheets.map(|path| picture_format(&path).map(|format| (path, format)));
        let sheets: Vec<_> = sheets.collect::<Result<_, _>>()?;
        let formats: Vec<Format> = sheets.iter().map(|(_, format)| *format).collect();
        Ok(Files {
            outputs: patch.outputs(circuit),
            folder: self.out.clone(),
            tables,
            sheets,
            singles: Vec::new(),
            resolution: self.pictures.resolution(&formats)?,
        })
    }
}

/// The name of the patch with another ending. Dots inside the name remain. A patch from standard input is named
/// "stdin".
pub(super) fn name_with_suffix(patch: &Path, ending: &str) -> OsString {
    let stem = if is_dash(patch) { OsStr::new("stdin") } else { patch.file_stem().unwrap_or_default() };
    let mut name = stem.to_owned();
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
    /// The files of single pictures, in the order of the pictures. The last ones remain unused if pictures of
    /// derivatives are omitted.
    singles: Vec<PathBuf>,
    /// The resolution of all pictures.
    resolution: Resolution,
}

impl Files {
    /// The paths of all files.
    pub(super) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.tables.iter().chain(self.sheets.iter().map(|(path, _)| path)).chain(&self.singles)
    }

    /// Checks whether the sheets have space for the pictures of a run. Adds a file for each picture if there is a
    /// folder.
    ///
    /// The files are NAME.picture-1.svg and so on in the folder. There is at most one picture of derivatives for each
    /// recorded signal.
    ///
    /// # Errors
    /// If a sheet is too large.
    pub(super) fn plan_pictures(
        &mut self,
        patch: &Path,
        circuit: &Circuit,
        settings: &RunSettings,
    ) -> Result<(), Failure> {
        let count = circuit.picture_specs(&settings.record).len();
        self.sheets.iter().try_for_each(|(_, format)| self.resolution.check(count, *format))?;
        let derivatives = if settings.sensitivities.is_empty() { 0 } else { settings.record.len() };
        if let Some(folder) = &self.folder {
            let name = |number: usize| name_with_suffix(patch, &format!(".picture-{number}.svg"));
            self.singles = (1..=count + derivatives).map(|number| folder.join(name(number))).collect();
        }
        Ok(())
    }

    /// Creates the folder, and checks before the run that all files can be written.
    ///
    /// # Errors
    /// If two files are the same, one was read, or the folder or a file cannot be written.
    pub(super) fn prepare(&self) -> Result<(), Failure> {
        self.outputs.prepare(self.folder.as_deref(), self.paths())
    }

    /// The samples of a run that the pictures need.
    ///
    /// # Errors
    /// If these are too many.
    pub(super) fn picture_samples(
        &self,
        circuit: &Circuit,
        settings: &RunSettings,
    ) -> Result<PictureSamples, TooManySamplesError> {
        let drawn = if self.sheets.is_empty() { vec![] } else { circuit.picture_specs(&settings.record) };
        draw::picture_samples(&drawn, settings, self.resolution.size, self.resolution.scale)
    }

    /// The tables and the samples of the pictures, to be written and selected while the run is recorded.
    pub(super) fn streamed_tables(&self, samples: PictureSamples) -> StreamedTables<'_> {
        StreamedTables::new(&self.outputs, &self.tables, samples.envelope())
    }

    /// Writes tables and pictures, and returns the paths of the written files. `streamed` are the tables that have been
    /// written while the run was recorded, with the samples of the pictures; `None` if the trace has the samples.
    ///
    /// # Errors
    /// If a picture cannot be drawn, or if a file cannot be written.
    pub(super) fn write(
        &self,
        trace: &Trace,
        circuit: &Circuit,
        streamed: Option<StreamedTables<'_>>,
    ) -> Result<Vec<PathBuf>, Failure> {
        let selected = match streamed {
            Some(tables) => tables.finish(trace)?,
            None => {
                self.tables.iter().try_for_each(|path| self.write_table(path, trace))?;
                None
            }
        };
        let mut written = self.tables.clone();
        if self.sheets.is_empty() {
            return Ok(written);
        }
        let pictures = pictures(circuit, selected.as_ref().unwrap_or(trace))?;
        let Resolution { size, scale, .. } = self.resolution;
        for (path, format) in &self.sheets {
            write_scaled_pictures(&self.outputs, path, &pictures, *format, (size, scale))?;
            written.push(path.clone());
        }
        for (path, picture) in self.singles.iter().zip(&pictures) {
            write_pictures(&self.outputs, path, std::slice::from_ref(picture), Format::Svg, size)?;
            written.push(path.clone());
        }
        Ok(written)
    }

    /// Writes the samples of a trace as a table.
    ///
    /// # Errors
    /// If a value is not finite, or if the file cannot be written.
    fn write_table(&self, path: &Path, trace: &Trace) -> Result<(), Failure> {
        let mut bytes = Vec::new();
        trace.write_csv(&mut bytes).map_err(|error| Failure::data(error.to_string()))?;
        self.outputs.write(path, &bytes)
    }
}

/// The picture format that the name of a file selects.
///
/// # Errors
/// A usage error if the name has no known ending, or is `-`.
pub(super) fn picture_format(path: &Path) -> Result<Format, Failure> {
    check_output(path)?;
    let advice = if has_ending(path, &["csv"]) { "; --csv of run and linearise writes a table" } else { "" };
    Format::from_path(path).map_err(|error| Failure::usage(format!("{error}{advice}")))
}

/// Endings of picture files.
const PICTURE_ENDINGS: [&str; 10] = ["svg", "png", "pdf", "jpg", "jpeg", "gif", "bmp", "webp", "tif", "tiff"];

/// Whether a file name has one of these endings, in upper or lower case.
fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|own| endings.iter().any(|ending| own.eq_ignore_ascii_case(ending)))
}

/// An option whose output is not a picture.
pub(super) struct OutputOption {
    /// The name of the option.
    pub option: &'static str,
    /// What it writes.
    pub content: &'static str,
    /// The ending of its names; empty for folders.
    pub ending: &'static str,
    /// What draws a picture instead.
    pub drawing: &'static str,
}

/// What draws a picture, for messages.
pub(super) const PLOT: &str = "--plot FILE.svg or --plot FILE.png";

/// The option `--csv`.
pub(super) const CSV_OPTION: OutputOption =
    OutputOption { option: "--csv", content: "table", ending: "csv", drawing: PLOT };

/// The option `--out` of commands that draw several pictures.
pub(super) const FOLDER_OPTION: OutputOption =
    OutputOption { option: "--out", content: "folder", ending: "", drawing: PLOT };

impl OutputOption {
    /// Checks that the file or folder of this option does not have the name of a picture.
    ///
    /// # Errors
    /// A usage error if it does.
    pub(super) fn check(&self, path: Option<&Path>) -> Result<(), Failure> {
        let Some(path) = path.filter(|path| has_ending(path, &PICTURE_ENDINGS)) else { return Ok(()) };
        let OutputOption { option, content, ending, drawing } = self;
        let [given, named] = [path_text(path), path_text(&path.with_extension(ending))];
        Err(Failure::usage(format!(
            "{given} is the name of a picture, but {option} writes a {content}: \
             use {drawing} for a picture, and {option} {named} for the {content}"
        )))
    }
}

/// The paths as texts for `--json`.
pub(super) fn path_texts<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Vec<String> {
    paths.into_iter().map(|path| path.display().to_string()).collect()
}

/// A path in a message, on one line and without control characters.
pub(super) fn path_text(path: &Path) -> String {
    escape_controls(&path.display().to_string())
}

/// A path quoted for a shell if necessary.
pub(super) fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |letter: char| letter.is_alphanumeric() || "/._-".contains(letter);
    if text.chars().all(plain) { text } else { format!("'{}'", text.replace('\'', r"'\''")) }
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
    write_scaled_pictures(outputs, path, pictures, format, (size, 1.0))
}

/// Draws pictures on one sheet and writes the file. A PNG has `scale` pixels per pixel of the size.
fn write_scaled_pictures(
    outputs: &Outputs,
    path: &Path,
    pictures: &[Picture],
    format: Format,
    (size, scale): (Size, f64),
) -> Result<(), Failure> {
    let bytes = plot::render_scaled(pictures, format, size, scale);
    outputs.write(path, &bytes.map_err(|error| Failure::data(error.to_string()))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_spaces_are_quoted() {
        let shown = [("a/b.json", "a/b.json"), ("a b.json", "'a b.json'"), ("it's.json", r"'it'\''s.json'")];
        assert!(shown.iter().all(|(path, wanted)| quoted(Path::new(path)) == *wanted));
    }
}
