//! The files that a command writes: options, checks before the run, writing.
//!
//! A command never overwrites its input, and never writes two outputs to the same file. Files are written to a
//! temporary name and then renamed, so a reader sees the old file or the complete new one. Pipes and devices are
//! written directly.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::{fs, io};

use clap::Args;

use super::failure::Failure;
use super::pictures::{PictureArguments, Resolution, pictures};
use patchcord::circuit::Circuit;
use patchcord::draw::plot::{self, Format, Picture, Size};
use patchcord::output::{check_folder_writable, check_writable, destination, io_reason, write_atomic};
use patchcord::solve::RunSettings;
use patchcord::trace::Trace;

#[derive(Args)]
pub(super) struct FileArguments {
    /// Write the recorded signals as CSV, in physical units
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw the pictures of the patch on one sheet; the file name selects SVG or PNG
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Write table, sheet and each picture into this folder, under the name of the patch
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

    /// The files to write.
    ///
    /// `--out` adds NAME.csv and NAME.svg in the folder. [`Files::plan_pictures`] adds the single pictures.
    ///
    /// # Errors
    /// If two files are the same, if one is the patch, if the name of a picture has an unknown ending, or if an option
    /// for pictures has no effect.
    pub(super) fn files(&self, patch: &Path) -> Result<Files, Failure> {
        let in_folder = |ending| self.out.as_ref().map(|folder| folder.join(name_with_suffix(patch, ending)));
        let tables = self.csv.clone().into_iter().chain(in_folder(".csv")).collect();
        let sheets = self.plot.clone().into_iter().chain(in_folder(".svg"));
        let sheets = sheets.map(|path| picture_format(&path).map(|format| (path, format)));
        let sheets: Vec<_> = sheets.collect::<Result<_, _>>()?;
        let formats: Vec<Format> = sheets.iter().map(|(_, format)| *format).collect();
        let resolution = self.pictures.resolution(&formats)?;
        let files = Files { folder: self.out.clone(), tables, sheets, singles: Vec::new(), resolution };
        check_distinct_from_patch(patch, files.paths())?;
        Ok(files)
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

    /// Checks whether the sheets have space for the pictures of a run. Adds a file for each picture if there is a folder.
    ///
    /// The files are NAME.picture-1.svg and so on in the folder. There is at most one picture of derivatives for each
    /// recorded signal.
    ///
    /// # Errors
    /// If a sheet is too large, or if a file would be written twice or over the patch.
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
        check_distinct_from_patch(patch, self.paths())
    }

    /// Creates the folder, and checks before the run that all files can be written.
    ///
    /// # Errors
    /// If the folder cannot be created, or if a file cannot be written.
    pub(super) fn prepare(&self) -> Result<(), Failure> {
        prepare_outputs(self.folder.as_deref(), self.paths())
    }

    /// Writes tables and pictures, and returns the paths of the written files.
    ///
    /// # Errors
    /// If a picture cannot be drawn, or if a file cannot be written.
    pub(super) fn write(&self, trace: &Trace, circuit: &Circuit) -> Result<Vec<PathBuf>, Failure> {
        for path in &self.tables {
            let mut bytes = Vec::new();
            trace.write_csv(&mut bytes).map_err(|error| Failure::data(error.to_string()))?;
            write_file(path, &bytes)?;
        }
        let mut written = self.tables.clone();
        if self.sheets.is_empty() {
            return Ok(written);
        }
        let pictures = pictures(circuit, trace)?;
        let Resolution { size, scale, .. } = self.resolution;
        for (path, format) in &self.sheets {
            write_scaled_pictures(path, &pictures, *format, (size, scale))?;
            written.push(path.clone());
        }
        for (path, picture) in self.singles.iter().zip(&pictures) {
            write_pictures(path, std::slice::from_ref(picture), Format::Svg, size)?;
            written.push(path.clone());
        }
        Ok(written)
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

/// The list of written files after an empty line; empty if there are none.
pub(super) fn written_paragraph<'a>(paths: impl Iterator<Item = &'a PathBuf>) -> String {
    let text = written_text(paths);
    if text.is_empty() { text } else { format!("\n{text}") }
}

/// "wrote FILE" for each file, one per line.
pub(super) fn written_text<'a>(paths: impl Iterator<Item = &'a PathBuf>) -> String {
    paths.map(|path| format!("wrote {}\n", path.display())).collect()
}

/// An error if two output files are the same, or one is the patch.
pub(super) fn check_distinct_from_patch<'a>(
    patch: &'a Path,
    paths: impl Iterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    check_distinct_from("the patch", patch, paths)
}

/// An error if two output files are the same, or one is the input file `read`, called `what` in the message.
///
/// Paths are compared after links and ".." are resolved.
pub(super) fn check_distinct_from<'a>(
    what: &str,
    read: &Path,
    paths: impl Iterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    let input = resolved_destination(read)?;
    match distinct_destinations(paths)?.iter().find(|(_, output)| *output == input) {
        Some((path, _)) => {
            let path = path.display();
            Err(Failure::usage(format!("{path} is {what} itself: give another name or folder to write to")))
        }
        None => Ok(()),
    }
}

/// The resolved paths of output files. An error if two are the same. Pipes and devices are omitted.
pub(super) fn distinct_destinations<'a>(
    paths: impl Iterator<Item = &'a PathBuf>,
) -> Result<Vec<(&'a PathBuf, PathBuf)>, Failure> {
    let mut taken: Vec<(&PathBuf, PathBuf)> = Vec::new();
    for path in paths.filter(|path| !is_stream(path)) {
        let destination = resolved_destination(path)?;
        if taken.iter().any(|(_, other)| *other == destination) {
            return Err(Failure::usage(format!("{} would be written twice", path.display())));
        }
        taken.push((path, destination));
    }
    Ok(taken)
}

/// Creates the folder, and checks before the work that all files can be written.
pub(super) fn prepare_outputs<'a>(
    folder: Option<&Path>,
    paths: impl Iterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    if let Some(folder) = folder {
        create_folder(folder)?;
        check_folder_writable(folder).map_err(|error| {
            Failure::data(format!("cannot write into the folder {}: {}", folder.display(), io_reason(&error)))
        })?;
    }
    for path in paths {
        check_writable(path).map_err(|error| write_failure(path, &error))?;
    }
    Ok(())
}

/// Whether the path is a pipe or a device.
fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|existing| !existing.is_file() && !existing.is_dir())
}

/// The path under which a file will exist, without links and "..".
fn resolved_destination(path: &Path) -> Result<PathBuf, Failure> {
    let no_file =
        |error| Failure::usage(format!("\"{}\" is not a file name: {}", path.display(), io_reason(&error)));
    destination(path).map_err(no_file)
}

/// Creates a folder and its parents.
pub(super) fn create_folder(folder: &Path) -> Result<(), Failure> {
    let failure = |error| {
        let why = blocking_file(folder).unwrap_or_else(|| io_reason(&error));
        Failure::data(format!("cannot create the folder {}: {why}", folder.display()))
    };
    fs::create_dir_all(folder).map_err(failure)
}

/// A message if the folder or one of its parents is a file.
///
/// The message of the file system would only be "not a directory".
fn blocking_file(folder: &Path) -> Option<String> {
    let file = folder.ancestors().find(|ancestor| ancestor.is_file())?;
    Some(if file == folder {
        "a file with this name exists".to_owned()
    } else {
        format!("{} is a file", file.display())
    })
}

/// Writes a file completely, or not at all.
pub(super) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_atomic(path, bytes).map_err(|error| write_failure(path, &error))
}

/// Draws pictures on one sheet and writes the file.
pub(super) fn write_pictures(
    path: &Path,
    pictures: &[Picture],
    format: Format,
    size: Size,
) -> Result<(), Failure> {
    write_scaled_pictures(path, pictures, format, (size, 1.0))
}

/// Draws pictures on one sheet and writes the file. A PNG has `scale` pixels per pixel of the size.
fn write_scaled_pictures(
    path: &Path,
    pictures: &[Picture],
    format: Format,
    (size, scale): (Size, f64),
) -> Result<(), Failure> {
    let bytes = plot::render_scaled(pictures, format, size, scale);
    write_file(path, &bytes.map_err(|error| Failure::data(error.to_string()))?)
}

/// The failure for a file that cannot be written.
pub(super) fn write_failure(path: &Path, error: &io::Error) -> Failure {
    Failure::data(format!("cannot write {}: {}", path.display(), io_reason(error)))
}
