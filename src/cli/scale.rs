//! `patchcord scale`
//!
//! The scaling table comes first, then the peaks of the outputs, the files and the warnings of the machine's inventory.
//! Without `--out` nothing is written, so that a student can compare scales before there is a patch.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::failure::{Failure, eprint_report};
use super::files::{path_text, path_texts, quoted};
use super::load::title_of;
use super::numbers::positive_in;
use super::outputs::Outputs;
use super::rescale::{Request, is_patch, rescale};
use super::standard_streams::check_input;
use super::table::Table;
use super::{print, print_json};
use patchcord::document::{DiagnosticDocument, plural, read_text, unit_suffix};
use patchcord::equations::{
    NarrowedRange, OutputPeak, ScaleError, ScaleOptions, ScaledDrive, ScaledProblem, ScaledQuantity, codes,
    scale_problem,
};
use patchcord::expr::{Equation, format_significant};
use patchcord::machines::{self, MachineModel};
use patchcord::patch::Problem;

#[derive(Args)]
pub(super) struct Arguments {
    /// Problem file (JSON) with parameters, quantities and equations; docs/problem-format.md describes it. Or a patch,
    /// which is rescaled until its outputs peak between 50 and 95 V, with the same names
    problem: PathBuf,
    /// Write the patch to this file
    #[arg(long, value_name = "PATCH.json")]
    out: Option<PathBuf>,
    /// Make the patch for this machine, with its gains, such as solartron-1451; `patchcord machines` lists them
    #[arg(long, value_name = "NAME", value_parser = machine)]
    machine: Option<&'static MachineModel>,
    /// Machine seconds per problem second (default: 1 if all gains are then usable, otherwise a round number with which
    /// the fastest oscillation has about 1 Hz). For a patch: new machine seconds per present one; only the time scale
    /// then changes
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, value_parser = positive_in("1"))]
    time: Option<f64>,
    /// Represent each stated maximum by 100 V, also if its peak is below 50 V
    #[arg(long)]
    keep_maxima: bool,
    /// Also print the gain rule in numbers for every input: coefficient * input scale / output scale = gain * pot
    #[arg(long)]
    steps: bool,
    /// Print one JSON document on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

/// Parses the name of a machine.
fn machine(name: &str) -> Result<&'static MachineModel, String> {
    machines::find(name).ok_or_else(|| {
        let names: Vec<&str> = machines::ALL.iter().map(|machine| machine.name).collect();
        format!("no such machine; the machines are {}", names.join(" and "))
    })
}

/// The scales are chosen before anything is written, so a problem without a circuit leaves no file.
pub(super) fn scale(arguments: &Arguments) -> Result<(), Failure> {
    check_input(&arguments.problem)?;
    let text = read_text(&arguments.problem)?;
    if is_patch(&text) {
        return rescale(&arguments.rescaling(&text, &arguments.refused()));
    }
    let folder = arguments.problem.parent().unwrap_or(Path::new(""));
    let problem = Problem::parse_in(folder, &arguments.problem.display().to_string(), &text)
        .map_err(Failure::problem)?;
    let outputs = Outputs::default().reading("the problem", [&arguments.problem]);
    outputs.prepare(None, &arguments.out)?;
    let scaled = scale_problem(&problem, &arguments.options()).map_err(failure)?;
    if let Some(file) = &arguments.out {
        outputs.write(file, scaled.patch.text().as_bytes())?;
    }
    if arguments.json {
        eprint_report(&scaled.warnings);
        return print_json(&Document::new(&problem, &scaled, arguments.out.as_ref()));
    }
    print(&arguments.text(&problem, &scaled))?;
    eprint_report(&scaled.warnings);
    Ok(())
}

impl Arguments {
    /// The options of the scaling.
    fn options(&self) -> ScaleOptions {
        let machine = self.machine.unwrap_or(ScaleOptions::default().machine);
        ScaleOptions { machine, time_scale: self.time, keeps_maxima: self.keep_maxima }
    }

    /// The options that a patch does not have.
    fn refused(&self) -> Vec<&'static str> {
        let given = [("--machine", self.machine.is_some()), ("--keep-maxima", self.keep_maxima)];
        given.into_iter().filter(|(_, is_given)| *is_given).map(|(option, _)| option).collect()
    }

    /// The options for a patch with this text. The gain rule is always printed for a patch.
    fn rescaling<'a>(&'a self, text: &'a str, refused: &'a [&'a str]) -> Request<'a> {
        Request {
            file: &self.problem,
            text,
            out: self.out.as_ref(),
            time: self.time,
            json: self.json,
            refused,
        }
    }

    /// The printed result.
    fn text(&self, problem: &Problem, scaled: &ScaledProblem) -> String {
        let mut text = format!("{}\n\n", title_of(&problem.patch).trim());
        text += &scaling_table(scaled);
        text += &format!("\n{}", equation_lines(&scaled.quantities, scaled.time_scale));
        text += &format!("\n{}", peak_lines(&scaled.peaks));
        for range in &scaled.narrowed_ranges {
            text += &format!("{}\n", range.text());
        }
        if self.steps {
            let lines: String = scaled.steps.iter().map(|step| format!("  {step}\n")).collect();
            text += &format!("\ngain rule: coefficient * input scale / output scale = gain * pot\n{lines}");
        }
        text += &unstated_lines(problem);
        text += &match &self.out {
            Some(file) => {
                format!("\nwrote {}\n\nThen:\n{}", path_text(file), self.next_commands(file, scaled))
            }
            None => "\n--out PATCH.json writes the patch\n".to_owned(),
        };
        text
    }

    /// The commands that continue with the written patch. A patch with more parts than its machine has cannot be checked
    /// or run, so the problem is scaled again.
    fn next_commands(&self, file: &Path, scaled: &ScaledProblem) -> String {
        let file = quoted(file);
        match scaled.warnings.findings.iter().any(|finding| finding.code == codes::MISSING_PARTS) {
            true => {
                let problem = quoted(&self.problem);
                format!("  patchcord scale {problem} --machine unlimited --out {file}\n")
            }
            false => format!("  patchcord check {file}\n  patchcord run {file}\n"),
        }
    }
}

/// The failure for a problem that cannot be scaled.
fn failure(error: ScaleError) -> Failure {
    match error {
        ScaleError::Problem(report) => Failure::problem(report),
        other => Failure::data(other.to_string()),
    }
}

/// Significant digits of values in the tables.
const DIGITS: usize = 4;

/// The scaling table: a row for each quantity and each drive. If the problem states no maximum, the column of the
/// expected ones is left out.
fn scaling_table(scaled: &ScaledProblem) -> String {
    let number = |value: f64| format_significant(value, DIGITS);
    let row = |name: &str, expected: Option<f64>, [maximum, per_volt, peak]: [f64; 3], unit: &str| {
        let expected = expected.map_or(String::new(), number);
        let scale = number(per_volt) + &unit_suffix(unit);
        [name.to_owned(), expected, number(maximum), unit.to_owned(), scale, format!("{peak:.1}")]
    };
    let mut table = Table::new(["quantity", "expected", "maximum", "unit", "1 V is", "peak in V"]);
    for ScaledQuantity { name, unit, expected_maximum, maximum, per_volt, peak, .. } in &scaled.quantities {
        table.row(row(name, *expected_maximum, [*maximum, *per_volt, *peak], unit));
    }
    for ScaledDrive { name, unit, maximum, per_volt, peak, .. } in &scaled.drives {
        table.row(row(name, None, [*maximum, *per_volt, *peak], unit));
    }
    if scaled.quantities.iter().all(|quantity| quantity.expected_maximum.is_none()) {
        table.drop_column(1);
    }
    table.text()
}

/// The scaled equations. The heading distinguishes `[x]'`, a derivative, from `[x']`, a voltage.
fn equation_lines(quantities: &[ScaledQuantity], time_scale: f64) -> String {
    let factor = format_significant(time_scale, DIGITS);
    let time = match time_scale == 1.0 {
        true => "V/s".to_owned(),
        false => format!("V per machine second, with {factor} of them per problem second"),
    };
    let mut text = format!("scaled equations; [x] is the voltage of x, and [x]' its derivative in {time}:\n");
    for quantity in quantities {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {}", quantity.scaled_equation);
    }
    text
}

/// Which outputs use the range of their amplifiers, and why the others do not.
fn peak_lines(peaks: &[OutputPeak]) -> String {
    let good = peaks.iter().filter(|peak| peak.is_good()).count();
    let mut text = format!("{} of {} peak between 50 and 95 V\n", good, plural(peaks.len(), "output"));
    for peak in peaks.iter().filter(|peak| !peak.is_good()) {
        let reason = peak.reason.map_or(String::new(), |reason| format!(": {reason}"));
        text += &format!("  {} ({}) peaks at {:.1} V{reason}\n", peak.output, peak.quantity, peak.volts);
    }
    text
}

/// A line for each equation of the problem that the patch does not state, because it applies a table. So a reader knows
/// that `patchcord check` does not compare it.
fn unstated_lines(problem: &Problem) -> String {
    let equations = problem.patch.equations.iter().map(|placed| &placed.value);
    let unstated = equations.filter(|equation| problem.applies_table(equation));
    let line = |equation: &Equation| {
        format!(
            "the patch does not state {}: equations of a patch have no tables, so `patchcord check` does not \
             compare it\n",
            equation.text()
        )
    };
    let lines: String = unstated.map(line).collect();
    if lines.is_empty() { lines } else { format!("\n{lines}") }
}

/// The result as JSON.
#[derive(Serialize)]
struct Document<'a> {
    ok: bool,
    problem: &'a str,
    title: &'a str,
    diagnostics: Vec<DiagnosticDocument>,
    time_scale: f64,
    quantities: &'a [ScaledQuantity],
    drives: &'a [ScaledDrive],
    peaks: &'a [OutputPeak],
    narrowed_ranges: &'a [NarrowedRange],
    steps: &'a [String],
    patch: &'a serde_json::Value,
    files: Vec<String>,
}

impl<'a> Document<'a> {
    /// The document of a scaled problem.
    fn new(problem: &'a Problem, scaled: &'a ScaledProblem, out: Option<&PathBuf>) -> Self {
        Document {
            ok: true,
            problem: problem.patch.file(),
            title: &problem.patch.title,
            diagnostics: scaled.warnings.documents(),
            time_scale: scaled.time_scale,
            quantities: &scaled.quantities,
            drives: &scaled.drives,
            peaks: &scaled.peaks,
            narrowed_ranges: &scaled.narrowed_ranges,
            steps: &scaled.steps,
            patch: scaled.patch.value(),
            files: path_texts(out),
        }
    }
}
