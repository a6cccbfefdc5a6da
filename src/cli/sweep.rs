//! `patchcord sweep`
//!
//! Rows go to standard output as CSV, or to a file. A file is also a journal: a sweep that was interrupted continues
//! after the last complete row. All combinations of `--vary` are run, and the last one changes fastest.

use std::io::{self, IsTerminal as _};
use std::path::{Path, PathBuf};
use std::thread;

use clap::Args;
use indexmap::IndexMap;
use serde::Serialize;

use super::failure::Failure;
use super::files::{OutputOption, path_text, written_text};
use super::load::{LoadedPatch, PatchArguments, PatchDocument};
use super::numbers::threads;
use super::progress::ProgressBar;
use super::standard_streams::{check_input, is_dash};
use super::step_warning::{StepWarningDocument, row_step_warning_text};
use super::times::{TimeArguments, TimesDocument, run_failure};
use super::{eprint, print, print_json, standard_output_result};
use patchcord::circuit::Circuit;
use patchcord::document::{format_number, plural, unit_suffix};
use patchcord::instruments::{Measure, MeasureColumn, measures};
use patchcord::ir::Program;
use patchcord::sweep::{
    Axis, JournalError, Plan, PlanError, RowStepWarning, Sweep, SweepError, SweepSummary,
};

#[derive(Args)]
#[command(after_help = measures_text())]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    /// Vary a parameter: NAME=VALUE,VALUE,... or NAME=FIRST:LAST:COUNT or NAME=FIRST:LAST:COUNT:log. A number without a
    /// unit is in the unit that the patch declares. If given several times, all combinations are run, and the last
    /// parameter changes fastest
    #[arg(long, value_name = "NAME=VALUES")]
    vary: Vec<String>,
    /// Read parameter values from a CSV file: parameter names in the first line, then one line per run
    #[arg(long, value_name = "FILE.csv")]
    rows: Option<PathBuf>,
    /// Measure this quantity of every run (see "Measures" below). May be given several times
    #[arg(long, value_name = "MEASURE")]
    measure: Vec<String>,
    #[command(flatten)]
    times: TimeArguments,
    /// Number of threads (default: number of cores)
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, value_parser = threads)]
    threads: Option<usize>,
    /// Append the rows to this CSV file, which continues an interrupted sweep. Without this option, or with -, the rows
    /// go to standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// The option for the rows.
const ROWS_OPTION: OutputOption = OutputOption {
    option: "--out",
    content: "table",
    ending: "csv",
    drawing: "`patchcord run` with --plot FILE.svg",
};

/// The list of measures for the help text.
fn measures_text() -> String {
    let lines = measures().map(|(syntax, meaning)| format!("  {syntax}\n      {meaning}\n"));
    format!("Measures:\n{}", lines.collect::<String>())
}

/// The keys of the document in addition to those of every command on a patch.
#[derive(Serialize)]
struct Document<'a> {
    run: TimesDocument,
    sweep: SweepDocument,
    step_warning: Option<RowStepWarningDocument<'a>>,
    files: Vec<String>,
}

/// The warning about equal steps that are too long for a row. `at` has the values of the varied parameters in this row.
#[derive(Serialize)]
struct RowStepWarningDocument<'a> {
    at: IndexMap<&'a str, f64>,
    #[serde(flatten)]
    warning: StepWarningDocument<'a>,
}

/// A sweep: the varied values as texts, the columns of measures, and the counts of rows. `kept` counts the rows that
/// the file already had.
#[derive(Serialize)]
struct SweepDocument {
    vary: Vec<String>,
    columns: Vec<ColumnDocument>,
    runs: u64,
    threads: usize,
    kept: u64,
    written: u64,
    failed: u64,
    noted: u64,
    failed_checks: usize,
}

/// A column of the table.
#[derive(Serialize)]
struct ColumnDocument {
    name: String,
    unit: String,
}

/// A failed run is not an error of the command: its row has the reason, and the summary counts it.
pub(super) fn sweep(arguments: &Arguments) -> Result<(), Failure> {
    arguments.check_streams()?;
    let axes = arguments.vary.iter().map(|text| Axis::parse(text)).collect::<Result<Vec<_>, _>>();
    let axes = axes.map_err(plan_failure)?;
    let loaded = arguments.patch.load_for(|plan| arguments.times.plan(plan))?;
    let LoadedPatch { circuit, program, warnings } = loaded;
    let sweep = arguments.sweep(axes, &circuit, program)?;
    let Some(out) = arguments.file() else { return arguments.write_rows(&sweep) };
    arguments.patch.outputs(&circuit).reading("the file of --rows", &arguments.rows).prepare_append(out)?;
    let summary = arguments.append_rows(&sweep, out)?;
    if arguments.patch.json {
        let document = arguments.document(&sweep, &summary, out);
        return print_json(&PatchDocument::new(&circuit, &warnings, document));
    }
    eprint_step_warning(&sweep, &summary);
    let result = match summary.written {
        0 => format!("{} is complete: nothing to do\n", path_text(out)),
        _ => written_text([out].into_iter()),
    };
    print(&(summary_text(&summary) + &result))
}

impl Arguments {
    /// Writes the rows to standard output. Progress is not reported if the rows themselves show it on a terminal.
    ///
    /// # Errors
    /// If standard output cannot be written.
    fn write_rows(&self, sweep: &Sweep) -> Result<(), Failure> {
        let mut out = io::stdout().lock();
        let bar = (!out.is_terminal()).then(|| ProgressBar::new("sweep", "runs"));
        let mut progress = |done| bar.iter().for_each(|bar| bar.done(done, sweep.plan().runs()));
        let outcome = sweep.write(&mut out, self.threads(), &mut progress);
        drop(bar);
        report_output(sweep, outcome)
    }

    /// Appends the rows to a file, each when it is computed, and reports progress.
    ///
    /// # Errors
    /// If the file belongs to another sweep or cannot be written.
    fn append_rows(&self, sweep: &Sweep, out: &Path) -> Result<SweepSummary, Failure> {
        let bar = ProgressBar::new("sweep", "runs");
        let mut progress = |done| bar.done(done, sweep.plan().runs());
        sweep.append_to(out, self.threads(), &mut progress).map_err(journal_failure)
    }

    /// The file for the rows. None if they go to standard output.
    fn file(&self) -> Option<&PathBuf> {
        self.out.as_ref().filter(|out| !is_dash(out))
    }

    /// Checks that standard input is not read for rows, and that the output file is given if necessary and is not a
    /// picture.
    fn check_streams(&self) -> Result<(), Failure> {
        self.rows.iter().try_for_each(|rows| check_input(rows))?;
        ROWS_OPTION.check(self.out.as_deref())?;
        let message = "with --json the rows cannot go to standard output: give --out FILE";
        if self.patch.json && self.file().is_none() { Err(Failure::usage(message)) } else { Ok(()) }
    }

    /// Creates the sweep from the options.
    ///
    /// # Errors
    /// If a parameter is both set and varied, a measure is unknown, or the times of the run are wrong.
    fn sweep(&self, axes: Vec<Axis>, circuit: &Circuit, program: Program) -> Result<Sweep, Failure> {
        let rows = self.rows.iter().map(|path| Axis::read(path, &program)).collect::<Result<Vec<_>, _>>();
        // The axis of the file is the first, so it changes slowest.
        let axes = rows.map_err(plan_failure)?.into_iter().chain(axes);
        let plan = Plan::new(axes, &program).map_err(plan_failure)?;
        if let Some((name, _)) = self.patch.set.iter().find(|(set, _)| plan.names().any(|name| name == set)) {
            return Err(Failure::usage(format!("{name} is set and varied: remove --set {name}=...")));
        }
        let measures = self.measure.iter().map(|text| Measure::parse(text, program.signals()));
        let measures = measures.collect::<Result<Vec<_>, _>>();
        let measures = measures.map_err(|error| Failure::usage(error.to_string()))?;
        let settings = self.times.settings(&self.times.plan(circuit.run_plan()), circuit, &program);
        let settings =
            settings.map_err(|error| run_failure(&error, circuit, self.times.is_cause_of(&error)))?;
        Sweep::new(circuit.patch(), program, settings, plan, measures)
            .map_err(|error| self.sweep_failure(error, circuit))
    }

    /// The failure for an error of the sweep, with the option that helps.
    fn sweep_failure(&self, error: SweepError, circuit: &Circuit) -> Failure {
        match error {
            SweepError::Run(error) => run_failure(&error, circuit, self.times.is_cause_of(&error)),
            SweepError::NoMeasure => {
                Failure::usage(format!("{error}: give --measure MEASURE\n\n{}", measures_text().trim_end()))
            }
            SweepError::Phases(_) => Failure::usage(format!(
                "{error}: use voltmeter, peak, least or most, or give --for to run without phases"
            )),
            error => Failure::usage(error.to_string()),
        }
    }

    /// The JSON document of the sweep.
    fn document<'a>(&self, sweep: &'a Sweep, summary: &'a SweepSummary, out: &Path) -> Document<'a> {
        let column = |MeasureColumn { name, unit }| ColumnDocument { name, unit };
        let SweepSummary { kept, written, failed, noted, .. } = *summary;
        let step_warning = summary.step_warning.as_ref().map(|row| RowStepWarningDocument {
            at: sweep.plan().names().zip(row.values.iter().copied()).collect(),
            warning: StepWarningDocument::of(&row.warning),
        });
        Document {
            run: TimesDocument::of(sweep.settings()),
            sweep: SweepDocument {
                vary: sweep.plan().texts(),
                columns: sweep.columns().into_iter().map(column).collect(),
                runs: sweep.plan().runs(),
                threads: self.threads(),
                kept,
                written,
                failed,
                noted,
                failed_checks: summary.failed_checks.len(),
            },
            step_warning,
            files: vec![out.display().to_string()],
        }
    }

    /// The number of threads: as given, or the number of cores.
    fn threads(&self) -> usize {
        self.threads.unwrap_or_else(|| thread::available_parallelism().map_or(1, usize::from))
    }
}

/// The failure for an error of the plan. A file of rows is data; everything else is part of the command line.
fn plan_failure(error: PlanError) -> Failure {
    match error {
        PlanError::Rows(_) | PlanError::Unread { .. } => Failure::data(error.to_string()),
        PlanError::NoAxis => {
            Failure::usage("no parameter is varied: give --vary NAME=FIRST:LAST:COUNT or --rows FILE.csv")
        }
        error => Failure::usage(error.to_string()),
    }
}

/// The file of an earlier sweep with other settings, or one that cannot be written.
fn journal_failure(error: JournalError) -> Failure {
    Failure::data(error.to_string())
}

/// Reports failed runs and too long steps on standard error if the rows went to standard output. A closed pipe is not
/// an error.
fn report_output(sweep: &Sweep, outcome: io::Result<SweepSummary>) -> Result<(), Failure> {
    let written = outcome.map(|summary| {
        if summary.failed > 0 {
            eprint(summary_text(&summary).trim_end());
        }
        eprint_step_warning(sweep, &summary);
    });
    standard_output_result(written)
}

/// Prints the warning about steps that are too long to standard error, with the parameters of the row, and a warning if
/// checks failed. Prints nothing if there is none.
fn eprint_step_warning(sweep: &Sweep, summary: &SweepSummary) {
    if let Some(RowStepWarning { values, warning }) = &summary.step_warning {
        let columns = sweep.columns();
        let parameters = columns.iter().zip(values).map(|(column, value)| {
            format!("{} = {}{}", column.name, format_number(*value), unit_suffix(&column.unit))
        });
        let row = parameters.collect::<Vec<_>>().join(", ");
        eprint(row_step_warning_text(&row, warning).trim_end());
    }
    if let Some(reason) = summary.failed_checks.first() {
        let rows = plural(summary.failed_checks.len(), "row");
        eprint(&format!("warning: the steps of {rows} could not be checked: {reason}"));
    }
}

/// "2 runs: 0 failed, 0 with a note".
fn summary_text(summary: &SweepSummary) -> String {
    let existing = match summary.kept {
        0 => ":".to_owned(),
        kept => format!(", {kept} more in the file; in total"),
    };
    let SweepSummary { failed, noted, .. } = *summary;
    format!("{}{existing} {failed} failed, {noted} with a note\n", plural(summary.written, "run"))
}
