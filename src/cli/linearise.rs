//! `patchcord linearise`

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::failure::Failure;
use super::files::{check_apart, prepare, put, written};
use super::instant::{InstantOption, Reached, instant};
use super::linear_report::{self, Analysis};
use super::load::{PatchArguments, document};
use super::{say, say_json};
use patchcord::circuit::Circuit;
use patchcord::draw::bode;
use patchcord::draw::plot::{self, Format, Size};
use patchcord::instruments::parameter_line;
use patchcord::ir::StateSpace;
use patchcord::linear::{Band, LinearError, Response, Root, Transfer, roots};

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// Run for so many problem seconds first, and linearise there (without it: in initial condition)
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value = "0", hide_default_value = true, value_parser = instant)]
    at: f64,
    /// Frequency response from this drive, or from this signal or element that a drive moves
    #[arg(long, value_name = "DRIVE|SIGNAL", requires = "to")]
    from: Option<String>,
    /// ... to this signal, drive or element
    #[arg(long, value_name = "SIGNAL", requires = "from")]
    to: Option<String>,
    /// The drive that moves both (without it: --from itself, or the only drive there is)
    #[arg(long, value_name = "DRIVE", requires = "from")]
    by: Option<String>,
    /// The frequencies of the response, in Hz (without it: whole decades, from at least a tenth of the slowest root or
    /// delay to ten times the fastest; without these 0.01:100)
    #[arg(long, value_name = "LOW:HIGH", requires = "from", allow_hyphen_values = true, value_parser = band)]
    hz: Option<Band>,
    /// Draw the response as a Bode plot; SVG or PNG by the name of the file
    #[arg(long, value_name = "FILE.svg|png", requires = "from")]
    plot: Option<PathBuf>,
    /// Write the response as CSV
    #[arg(long, value_name = "FILE", requires = "from")]
    csv: Option<PathBuf>,
}

fn band(text: &str) -> Result<Band, String> {
    let (low, high) = text.split_once(':').ok_or("write LOW:HIGH, such as 0.1:100")?;
    let number = |text: &str| text.trim().parse().map_err(|_| format!("\"{text}\" is not a number of Hz"));
    let band = Band { low: number(low)?, high: number(high)? };
    band.check().map_err(|error| error.to_string())?;
    Ok(band)
}

/// The option that chooses where is linearised.
const AT: InstantOption = InstantOption("--at");

/// Two pictures one below the other, each of this size.
const PANEL: Size = Size { width: 900, height: 400 };

pub(super) fn linearise(arguments: &Arguments) -> Result<(), Failure> {
    carry_out(arguments).map_err(|failure| failure.told_as_json(arguments.patch.json))
}

fn carry_out(arguments: &Arguments) -> Result<(), Failure> {
    let format = arguments.format()?;
    check_apart(&arguments.patch.patch, arguments.files())?;
    let loaded = arguments.patch.load()?;
    let Reached { machine, told } = AT.machine(&loaded, arguments.at)?;
    let model = machine.state_space();
    let analysis = arguments.analysis(&model, told)?;
    prepare(None, arguments.files())?;
    if let Some(response) = &analysis.response {
        arguments.write(response, &analysis, &loaded.circuit, format)?;
    }
    if arguments.patch.json {
        let mut more = linear_report::json(&analysis);
        more["files"] = arguments.files().map(|path| path.display().to_string()).collect::<Value>();
        return say_json(&document(&loaded.circuit, more));
    }
    let title = &loaded.circuit.patch().title;
    say(&format!("{title}\n{}\n\n{}", parameter_line(&loaded.circuit), linear_report::told(&analysis)))?;
    say(&written(arguments.files()))
}

impl Arguments {
    fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.csv.iter().chain(&self.plot)
    }

    /// The format of the plot.
    fn format(&self) -> Result<Option<Format>, Failure> {
        let format = self.plot.as_ref().map(|path| Format::from_path(path)).transpose();
        format.map_err(|error| Failure::usage(error.to_string()))
    }

    fn analysis<'m>(&self, model: &'m StateSpace, instant: String) -> Result<Analysis<'m>, Failure> {
        let roots = match roots(model) {
            Err(error) if !matches!(error, LinearError::DelayInLoop(_)) => return Err(refused(&error)),
            roots => roots,
        };
        let known = roots.as_deref().unwrap_or_default();
        let response = self.response(model, known).map_err(|error| refused(&error))?;
        Ok(Analysis { model, instant, roots, response })
    }

    fn response(&self, model: &StateSpace, roots: &[Root]) -> Result<Option<Response>, LinearError> {
        let Some((from, to)) = self.from.as_ref().zip(self.to.as_ref()) else { return Ok(None) };
        let transfer = match self.by.as_deref().or_else(|| only_drive(model, from)) {
            Some(drive) => Transfer::between(model, drive, from, to)?,
            None => Transfer::new(model, from, to)?,
        };
        let band = self.hz.unwrap_or_else(|| Band::around(roots, model));
        transfer.over(band).map(Some)
    }

    fn write(
        &self,
        response: &Response,
        analysis: &Analysis<'_>,
        circuit: &Circuit,
        format: Option<Format>,
    ) -> Result<(), Failure> {
        if let Some(path) = &self.csv {
            let mut table = Vec::new();
            response.write_csv(&mut table).map_err(|error| Failure::data(error.to_string()))?;
            put(path, &table)?;
        }
        if let Some((path, format)) = self.plot.as_ref().zip(format) {
            let line = parameter_line(circuit);
            let instant = &analysis.instant;
            let note = if line.is_empty() { instant.clone() } else { format!("{line}; {instant}") };
            let pictures = bode(response, analysis.roots.as_deref().unwrap_or_default(), Some(note));
            let bytes = plot::render(&pictures, format, PANEL);
            put(path, &bytes.map_err(|error| Failure::data(error.to_string()))?)?;
        }
        Ok(())
    }
}

/// The drive that moves what is no drive itself, where there is no other: all drives of the model are one, under several
/// names, or do the same.
fn only_drive<'m>(model: &'m StateSpace, from: &str) -> Option<&'m str> {
    let first = model.inputs.first().filter(|_| model.inputs.iter().all(|port| port.name != from))?;
    let drives = model.matrix.columns(model.states.len() + model.delays.len(), model.inputs.len());
    drives.column_iter().all(|column| column == drives.column(0)).then_some(&first.name)
}

/// What the error says: names and frequencies come from the command line.
fn refused(error: &LinearError) -> Failure {
    match error {
        LinearError::NoDerivative { .. }
        | LinearError::NoEigenvalues { .. }
        | LinearError::NotMoved { .. } => Failure::data(error.to_string()),
        LinearError::NotADrive { .. } => {
            Failure::usage(format!("{error}; between two signals, --by names the drive that moves them"))
        }
        _ => Failure::usage(error.to_string()),
    }
}
