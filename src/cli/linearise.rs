//! `patchcord linearise`

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::files::{CSV_OPTION, path_texts, picture_format, write_pictures, written_text};
use super::instant::{InstantOption, OperatingPoint, instant};
use super::linear_document::LinearDocument;
use super::linear_report::{self, Analysis};
use super::load::{PatchArguments, PatchDocument, heading};
use super::numbers::number_in;
use super::outputs::Outputs;
use super::standard_streams::{check_table, is_dash, table_path};
use super::{print, print_json};
use patchcord::circuit::Circuit;
use patchcord::draw::bode;
use patchcord::draw::plot::{Format, Size};
use patchcord::instruments::parameter_line;
use patchcord::ir::StateSpace;
use patchcord::linear::{
    FrequencyBand, FrequencyResponse, LinearError, Root, TransferFunction, check_size, roots,
};

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// Run for this many problem seconds and linearise there (default: at initial condition)
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value = "0", hide_default_value = true, value_parser = instant)]
    at: f64,
    /// Compute the frequency response from this drive, or from this signal or element that depends on a drive
    #[arg(long, value_name = "DRIVE|SIGNAL", requires = "to")]
    from: Option<String>,
    /// Compute the frequency response to this signal, drive or element
    #[arg(long, value_name = "SIGNAL", requires = "from")]
    to: Option<String>,
    /// The drive on which --from and --to depend (default: --from itself, or the only drive)
    #[arg(long, value_name = "DRIVE", requires = "from")]
    by: Option<String>,
    /// Frequency band of the response, in Hz (default: whole decades from at most a tenth of the slowest root or
    /// delay to at least ten times the fastest; 0.01:100 without roots and delays)
    #[arg(long, value_name = "LOW:HIGH", requires = "from", allow_hyphen_values = true, value_parser = band)]
    hz: Option<FrequencyBand>,
    /// Draw the response as a Bode plot into this file; the ending of its name selects SVG or PNG
    #[arg(long, value_name = "FILE.svg|png", requires = "from")]
    plot: Option<PathBuf>,
    /// Write the response as CSV; with -, to standard output in place of the report
    #[arg(long, value_name = "FILE", requires = "from")]
    csv: Option<PathBuf>,
}

/// Parses LOW:HIGH.
fn band(text: &str) -> Result<FrequencyBand, String> {
    let (low, high) = text.split_once(':').ok_or("write LOW:HIGH, such as 0.1:100")?;
    let band = FrequencyBand { low: number_in("Hz", low)?, high: number_in("Hz", high)? };
    band.check().map_err(|error| error.to_string())?;
    Ok(band)
}

/// The option that selects the operating point.
const AT: InstantOption = InstantOption { command: "linearise", option: "--at" };

/// Size of each of the two pictures of a Bode plot, in pixels.
const PANEL: Size = Size { width: 900, height: 400 };

/// The keys of the document in addition to those of every command on a patch.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    analysis: LinearDocument<'a>,
    files: Vec<String>,
}

/// Files are checked before the machine is run up to the operating point, which can take time. If standard output has
/// the table, no report follows.
pub(super) fn linearise(arguments: &Arguments) -> Result<(), Failure> {
    check_table(arguments.csv.as_deref(), arguments.patch.json)?;
    CSV_OPTION.check(arguments.csv.as_deref())?;
    let format = arguments.plot.as_deref().map(picture_format).transpose()?;
    let files = arguments.files();
    let loaded = arguments.patch.load()?;
    let outputs = arguments.patch.outputs(&loaded.circuit);
    outputs.prepare(None, &files)?;
    check_size(&loaded.program).map_err(|error| linear_failure(&error))?;
    let OperatingPoint { machine, description } = AT.machine(&loaded, arguments.at)?;
    let model = machine.state_space();
    let analysis = arguments.analysis(&model, description)?;
    if let Some(response) = &analysis.response {
        arguments.write(&outputs, response, &analysis, &loaded.circuit, format)?;
    }
    if arguments.patch.json {
        let analysis = LinearDocument::of(&analysis);
        let document = Document { analysis, files: path_texts(&files) };
        return print_json(&PatchDocument::new(&loaded.circuit, &loaded.warnings, document));
    }
    if arguments.csv.as_deref().is_some_and(is_dash) {
        return Ok(());
    }
    print(&(heading(&loaded.circuit) + &linear_report::text(&analysis)))?;
    print(&written_text(files.iter()))
}

impl Arguments {
    /// The files to write.
    fn files(&self) -> Vec<PathBuf> {
        self.csv.as_deref().map(table_path).into_iter().chain(self.plot.clone()).collect()
    }

    /// Roots and frequency response. A delay in a loop is no error: only the roots are missing.
    fn analysis<'m>(&self, model: &'m StateSpace, instant: String) -> Result<Analysis<'m>, Failure> {
        let roots = match roots(model) {
            Err(error) if !matches!(error, LinearError::DelayInLoop(_)) => {
                return Err(linear_failure(&error));
            }
            roots => roots,
        };
        let known = roots.as_deref().unwrap_or_default();
        let response = self.response(model, known).map_err(|error| linear_failure(&error))?;
        Ok(Analysis { model, instant, roots, response })
    }

    /// The frequency response; None if it is not requested.
    ///
    /// The default band is around the roots.
    fn response(&self, model: &StateSpace, roots: &[Root]) -> Result<Option<FrequencyResponse>, LinearError> {
        let Some((from, to)) = self.from.as_ref().zip(self.to.as_ref()) else { return Ok(None) };
        let transfer = match self.by.as_deref().or_else(|| only_drive(model, from)) {
            Some(drive) => TransferFunction::between(model, drive, from, to)?,
            None => TransferFunction::new(model, from, to)?,
        };
        let band = self.hz.unwrap_or_else(|| FrequencyBand::around(roots, model));
        transfer.response(band).map(Some)
    }

    /// Writes the CSV table and the Bode plot.
    fn write(
        &self,
        outputs: &Outputs,
        response: &FrequencyResponse,
        analysis: &Analysis<'_>,
        circuit: &Circuit,
        format: Option<Format>,
    ) -> Result<(), Failure> {
        if let Some(path) = self.csv.as_deref().map(table_path) {
            let mut table = Vec::new();
            response.write_csv(&mut table).map_err(|error| Failure::data(error.to_string()))?;
            outputs.write(&path, &table)?;
        }
        if let Some((path, format)) = self.plot.as_ref().zip(format) {
            let line = parameter_line(circuit);
            let instant = &analysis.instant;
            let note = if line.is_empty() { instant.clone() } else { format!("{line}; {instant}") };
            let pictures = bode(response, analysis.roots.as_deref().unwrap_or_default(), Some(&note));
            write_pictures(outputs, path, &pictures, format, PANEL)?;
        }
        Ok(())
    }
}

/// The drive on which everything depends, if there is only one. None if `from` is a drive itself. Several drives
/// count as one if their columns of the matrix are equal.
fn only_drive<'m>(model: &'m StateSpace, from: &str) -> Option<&'m str> {
    let first = model.inputs.first().filter(|_| model.inputs.iter().all(|port| port.name != from))?;
    let inner = model.states.len() + model.delays.len();
    model
        .matrix
        .iter()
        .all(|row| row[inner..].iter().all(|slope| *slope == row[inner]))
        .then_some(&first.name)
}

/// The failure for an error of the analysis. Names and frequencies are part of the command line.
fn linear_failure(error: &LinearError) -> Failure {
    match error {
        LinearError::TooLarge { .. }
        | LinearError::NoDerivative { .. }
        | LinearError::DerivativeTooLarge { .. }
        | LinearError::NoEigenvalues { .. }
        | LinearError::NoInfluence { .. } => Failure::data(error.to_string()),
        LinearError::NotADrive { .. } => {
            Failure::usage(format!("{error}; between two signals, --by specifies their common drive"))
        }
        _ => Failure::usage(error.to_string()),
    }
}
