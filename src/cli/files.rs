//! The files that a run writes.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::{fs, io};

use clap::Args;
use serde_json::Value;

use super::failure::Failure;
use patchcord::circuit::Circuit;
use patchcord::draw;
use patchcord::draw::plot::{self, Format, Picture, Size};
use patchcord::instruments::parameter_line;
use patchcord::output::{check_folder_takes_files, check_writable, destination, refusal, write_whole};
use patchcord::trace::Trace;

#[derive(Args)]
pub(super) struct FileArguments {
    /// Write what was recorded as CSV, in physical units
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw the patch's pictures on one sheet; SVG or PNG by the name of the file
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Write table and pictures into this folder, under the patch's name
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl FileArguments {
    /// Whether pictures are drawn.
    pub fn draw(&self) -> bool {
        self.plot.is_some() || self.out.is_some()
    }

    /// The files to write; files that would be written twice, or over the patch, are refused.
    pub fn files(&self, patch: &Path) -> Result<Files, Failure> {
        let in_folder = |ending| self.out.as_ref().map(|folder| folder.join(named_like(patch, ending)));
        let tables = self.csv.clone().into_iter().chain(in_folder(".csv")).collect();
        let sheets = self.plot.clone().into_iter().chain(in_folder(".svg"));
        let sheets: Result<Vec<_>, _> =
            sheets.map(|path| Format::from_path(&path).map(|format| (path, format))).collect();
        let sheets = sheets.map_err(|error| Failure::usage(error.to_string()))?;
        let files = Files { folder: self.out.clone(), tables, sheets };
        check_apart(patch, files.paths())?;
        Ok(files)
    }
}

/// The patch's name with another ending; dots within the name stay.
pub(super) fn named_like(patch: &Path, ending: &str) -> OsString {
    let mut name = patch.file_stem().unwrap_or_default().to_owned();
    name.push(ending);
    name
}

pub(super) struct Files {
    folder: Option<PathBuf>,
    tables: Vec<PathBuf>,
    sheets: Vec<(PathBuf, Format)>,
}

impl Files {
    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.tables.iter().chain(self.sheets.iter().map(|(path, _)| path))
    }

    /// Makes the folder, and tells before the run what cannot be written to.
    pub fn prepare(&self) -> Result<(), Failure> {
        prepare(self.folder.as_deref(), self.paths())
    }

    pub fn write(&self, trace: &Trace, circuit: &Circuit) -> Result<(), Failure> {
        for path in &self.tables {
            let mut bytes = Vec::new();
            trace.write_csv(&mut bytes).map_err(|error| Failure::data(error.to_string()))?;
            put(path, &bytes)?;
        }
        if self.sheets.is_empty() {
            return Ok(());
        }
        let pictures = pictures(circuit, trace)?;
        for (path, format) in &self.sheets {
            let bytes = plot::render(&pictures, *format, Size::default());
            put(path, &bytes.map_err(|error| Failure::data(error.to_string()))?)?;
        }
        Ok(())
    }

    pub fn json(&self) -> Value {
        self.paths().map(|path| path.display().to_string()).collect()
    }

    pub fn told(&self) -> String {
        let told = written(self.paths());
        if told.is_empty() { told } else { format!("\n{told}") }
    }
}

/// Which files were written, a line each.
pub(super) fn written<'a>(paths: impl Iterator<Item = &'a PathBuf>) -> String {
    paths.map(|path| format!("wrote {}\n", path.display())).collect()
}

/// Refuses files that would be written twice, or over the patch.
pub(super) fn check_apart<'a>(
    patch: &'a Path,
    paths: impl Iterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    check_not("the patch", patch, paths)
}

/// Refuses files that would be written twice, or over a file that is read.
pub(super) fn check_not<'a>(
    what: &str,
    read: &Path,
    paths: impl Iterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    let own = place(read)?;
    match places(paths)?.iter().find(|(_, place)| *place == own) {
        Some((path, _)) => {
            let path = path.display();
            Err(Failure::usage(format!("{path} is {what} itself: give another name or folder to write to")))
        }
        None => Ok(()),
    }
}

/// Where files would be written; refuses those that would be written twice.
pub(super) fn places<'a>(
    paths: impl Iterator<Item = &'a PathBuf>,
) -> Result<Vec<(&'a PathBuf, PathBuf)>, Failure> {
    let mut taken: Vec<(&PathBuf, PathBuf)> = Vec::new();
    for path in paths.filter(|path| !is_stream(path)) {
        let place = place(path)?;
        if taken.iter().any(|(_, other)| *other == place) {
            return Err(Failure::usage(format!("{} would be written twice", path.display())));
        }
        taken.push((path, place));
    }
    Ok(taken)
}

/// Makes the folder, and tells before the work what cannot be written to.
pub(super) fn prepare<'a>(
    folder: Option<&Path>,
    paths: impl Iterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    if let Some(folder) = folder {
        make_folder(folder)?;
        check_folder_takes_files(folder).map_err(|error| {
            Failure::data(format!("cannot write into the folder {}: {}", folder.display(), refusal(&error)))
        })?;
    }
    for path in paths {
        check_writable(path).map_err(|error| unwritable(path, &error))?;
    }
    Ok(())
}

/// Whether something stands there that takes what is written one after the other.
fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

fn place(path: &Path) -> Result<PathBuf, Failure> {
    let no_file = |error| Failure::usage(format!("\"{}\" is no file: {}", path.display(), refusal(&error)));
    destination(path).map_err(no_file)
}

/// Makes a folder, and those that it lies in.
pub(super) fn make_folder(folder: &Path) -> Result<(), Failure> {
    let unmade = |error| {
        let why = in_the_way(folder).unwrap_or_else(|| refusal(&error));
        Failure::data(format!("cannot make the folder {}: {why}", folder.display()))
    };
    fs::create_dir_all(folder).map_err(unmade)
}

/// What stands where a folder is wanted, or one that it lies in, and is none.
fn in_the_way(folder: &Path) -> Option<String> {
    let there = folder.ancestors().find(|place| place.is_file())?;
    Some(if there == folder {
        "a file of that name is in the way".to_owned()
    } else {
        format!("{} is a file", there.display())
    })
}

/// Writes a file whole, or tells that it could not be.
pub(super) fn put(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_whole(path, bytes).map_err(|error| unwritable(path, &error))
}

/// That a file could not be written.
pub(super) fn unwritable(path: &Path, error: &io::Error) -> Failure {
    Failure::data(format!("cannot write {}: {}", path.display(), refusal(error)))
}

/// The patch's pictures; where it asks for none, every recorded signal against time. Then those of derivatives.
fn pictures(circuit: &Circuit, trace: &Trace) -> Result<Vec<Picture>, Failure> {
    let signals = trace.tracks.iter().filter(|track| track.derivative.is_none());
    let specs = circuit.picture_specs(signals.map(|track| track.name.as_str()));
    let note = parameter_line(circuit);
    let drawn = specs.iter().map(|spec| draw::picture(trace, spec, Some(note.clone())));
    let drawn = drawn.collect::<Result<Vec<_>, _>>().and_then(|mut pictures| {
        pictures.extend(draw::sensitivity_pictures(trace, Some(&note))?);
        Ok(pictures)
    });
    drawn.map_err(|error| Failure::data(error.to_string()))
}
