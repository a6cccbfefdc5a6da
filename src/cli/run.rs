//! `patchcord run`
//!
//! The text output has the title, the parameters, the table of readings, the phases, the overloads, the amplifiers with
//! low peaks, and the files. The last line is a summary. With `--verbose` the work of the solver is added. An overload
//! fails the command only with `--fail-on-overload`, after everything is written and printed. If a run stops with an
//! error, the samples before the error are still written to the files, and the overloads before it are printed. Without
//! pictures, and if a long run has pictures that do not need every sample, the table is written during the run, so that
//! the memory of the run does not grow with its rows.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use serde::Serialize;

use super::doubts::eprint_doubts;
use super::failure::Failure;
use super::files::{FileArguments, Files, path_texts, written_paragraph};
use super::load::{LoadedPatch, PatchArguments, PatchDocument, heading};
use super::low_peaks::{LowPeakDocument, low_peaks_text};
use super::numbers::repetitions;
use super::overloads::{OverloadDocument, overload_advice, overload_failure};
use super::phases::{PhaseDocument, phase_prefix, phases_text};
use super::pictures::advice_on_samples;
use super::readings::{ReadingDocument, SensitivityDocument, readings_text};
use super::recording::record;
use super::run_report::{overloads_text, summary_text, work_text};
use super::start_warnings::report_start_warnings;
use super::step_warning::{StepWarningDocument, step_warning_text};
use super::streamed_tables::StreamedTables;
use super::times::{
    TimeArguments, TimesDocument, failure_with_code, from_command_line, message_with_advice, position_text,
    run_failure,
};
use super::{errors_in_colour, output_in_colour, print, print_coloured, print_json};
use patchcord::circuit::Circuit;
use patchcord::document::{json_value, suggestion};
use patchcord::draw::TooManySamplesError;
use patchcord::ir::Program;
use patchcord::patch::RunPlan;
use patchcord::solve::{BLOCK_SAMPLES, RunError, RunSettings, StoppedRunError};
use patchcord::trace::{Repetition, Trace, WorkCounters, rounded_time};

#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    patch: PatchArguments,
    #[command(flatten)]
    times: TimeArguments,
    /// Run this many times, each time from initial condition (repetitive operation)
    #[arg(long, value_name = "TIMES", allow_negative_numbers = true, value_parser = repetitions)]
    repeat: Option<u32>,
    /// Switch to hold at the first overload
    #[arg(long)]
    hold_on_overload: bool,
    /// End with exit code 3 if there is an overload. Files and results are written first
    #[arg(long)]
    fail_on_overload: bool,
    /// Record these signals, drives or elements instead of those that the patch specifies
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = name)]
    record: Vec<String>,
    /// Also record the derivatives of all recorded signals with respect to these parameters, and print the largest
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = name)]
    sensitivity: Vec<String>,
    /// Also print the work of the solver: steps, switchings, kinks and evaluations
    #[arg(long)]
    verbose: bool,
    #[command(flatten)]
    files: FileArguments,
}

/// Parses a name in a list.
fn name(text: &str) -> Result<String, String> {
    let name = text.trim();
    if name.is_empty() { Err("a name is missing".to_owned()) } else { Ok(name.to_owned()) }
}

/// Files are checked before the run, and appear under their names after it. The JSON document is printed last.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let loaded = arguments.patch.load_for(|plan| arguments.times.plan(plan))?;
    let LoadedPatch { circuit, program, mut warnings } = loaded;
    report_start_warnings(&circuit, &program, &mut warnings);
    let mut files = arguments.files.files(&arguments.patch, &circuit)?;
    let mut settings = arguments.settings(&circuit, &program)?;
    files.plan_pictures(&arguments.patch.patch, &circuit, &settings)?;
    let picture_samples = files.picture_samples(&circuit, &settings);
    let picture_samples = picture_samples.map_err(|error| arguments.picture_failure(error))?;
    settings.block_samples = picture_samples.block_samples();
    files.prepare()?;
    let mut streamed = settings.block_samples.map(|_| files.streamed_tables(picture_samples));
    let begin = Instant::now();
    let trace = match record("run", &program, &settings, streamed.as_mut()) {
        Ok(trace) => trace,
        Err(stopped) => return Err(arguments.stopped_failure(*stopped, streamed, &files, &circuit)),
    };
    let elapsed = begin.elapsed();
    let samples = streamed.as_ref().map_or(trace.len(), StreamedTables::samples);
    let written = files.write(&trace, &circuit, streamed)?;
    let failure = overload_failure(&trace).filter(|_| arguments.fail_on_overload);
    if arguments.patch.json {
        let document = Document::new(&circuit, &settings, &trace, (samples, &written));
        let document = PatchDocument::new(&circuit, &warnings, document);
        return match failure {
            None => print_json(&document),
            Some(failure) => Err(failure.with_document(&document)?),
        };
    }
    arguments.print_results((&circuit, &program), &settings, &trace, (&written, elapsed))?;
    failure.map_or(Ok(()), Err)
}

impl Arguments {
    /// Prints the results of a run. `written` are the files, and `elapsed` is the time that the run took. Without a
    /// picture the text says how to get one. If standard output has the table, only the reasons to doubt it are
    /// printed.
    fn print_results(
        &self,
        (circuit, program): (&Circuit, &Program),
        settings: &RunSettings,
        trace: &Trace,
        (written, elapsed): (&[PathBuf], Duration),
    ) -> Result<(), Failure> {
        let advice = overload_advice(trace, (circuit, program), &self.patch.patch);
        if self.files.prints_table() {
            eprint_doubts(trace, &(overloads_text(trace, errors_in_colour()) + &advice));
            return Ok(());
        }
        print(&(heading(circuit) + &readings_text(trace) + &phases_text(trace)))?;
        let work = if self.verbose { work_text(trace) } else { String::new() };
        let work = self.times.step_text(settings) + &work;
        let overloads = overloads_text(trace, output_in_colour());
        let warning = trace.step_warning.as_ref().map(step_warning_text).unwrap_or_default();
        let low_peaks = low_peaks_text(circuit, trace);
        let hint = if self.files.draw() { "" } else { NO_PICTURE };
        if [&*work, &*overloads, &*warning, &*low_peaks, hint].iter().any(|text| !text.is_empty()) {
            print(&format!("\n{work}"))?;
            print_coloured(&overloads)?;
            print(&format!("{advice}{warning}{low_peaks}{hint}"))?;
        }
        print(&(written_paragraph(written.iter()) + &summary_text(trace, elapsed)))
    }

    /// The run settings from the patch and the options.
    ///
    /// Options take precedence over the patch. Signals and curves of pictures are added if pictures are drawn. The trace
    /// does not keep the samples.
    fn settings(&self, circuit: &Circuit, program: &Program) -> Result<RunSettings, Failure> {
        let plan = self.plan(circuit.run_plan())?;
        let settings = self.times.settings(&plan, circuit, program);
        let mut settings = settings.map_err(|error| self.failure(&error, circuit))?;
        if !self.record.is_empty() {
            settings.record = self.recorded(circuit)?;
        }
        settings.sensitivities = self.parameters(circuit)?;
        if self.files.draw() {
            settings.curves = circuit.drawn_curves();
        }
        settings.checks_steps = true;
        settings.finds_amplifier_peaks = true;
        settings.block_samples = Some(BLOCK_SAMPLES);
        settings.check().map_err(|error| self.failure(&error, circuit))?;
        Ok(settings)
    }

    /// The run plan of the patch with the changes by the options.
    ///
    /// Repetition of phases cannot be specified by an option, because the phases of the patch say what is repeated.
    fn plan(&self, patch: &RunPlan) -> Result<RunPlan, Failure> {
        let mut plan = self.times.plan(patch);
        if self.repeat.is_some() && !plan.phases.is_empty() {
            let message = "--repeat cannot repeat a run with phases: write {\"repeat\": times, \"phases\": [...]} in \
                           the patch, or give --for as well to run without phases";
            return Err(Failure::usage(message));
        }
        plan.repeat = self.repeat.map(|times| from_command_line(f64::from(times))).or(plan.repeat);
        plan.hold_on_overload |= self.hold_on_overload;
        Ok(plan)
    }

    /// The failure for an error of the run.
    fn failure(&self, error: &RunError, circuit: &Circuit) -> Failure {
        run_failure(error, circuit, self.is_cause_of(error))
    }

    /// The failure of a run with more samples than its pictures permit.
    fn picture_failure(&self, error: TooManySamplesError) -> Failure {
        let message = format!("{error}: {}", advice_on_samples(error.reason));
        // The same options and the same code as without pictures.
        let error = RunError::TooManyNumbers { numbers: error.samples, max: error.max };
        failure_with_code(message, &error, self.is_cause_of(&error))
    }

    /// Whether options, and not the patch, cause an error.
    ///
    /// If an option causes the error, the exit code is 2; if the patch does, it is 1.
    fn is_cause_of(&self, error: &RunError) -> bool {
        let is_cause = match error {
            RunError::TooManySteps { .. } => self.repeat.is_some(),
            RunError::TooManyNumbers { .. } => {
                self.repeat.is_some() || !self.record.is_empty() || !self.sensitivity.is_empty()
            }
            RunError::NoDerivative { .. } => true,
            _ => false,
        };
        is_cause || self.times.is_cause_of(error)
    }

    /// Prints the overloads before the error, writes the samples before it to the files and returns the failure.
    ///
    /// The failure has the keys `code` and `sweeps`, and `recorded_until` in seconds and `files` if files were written.
    fn stopped_failure(
        &self,
        stopped: StoppedRunError,
        streamed: Option<StreamedTables<'_>>,
        files: &Files,
        circuit: &Circuit,
    ) -> Failure {
        let last = streamed.as_ref().map_or(stopped.trace.time.last().copied(), StreamedTables::last_time);
        let Some(last) = last.map(rounded_time) else { return self.failure(&stopped.error, circuit) };
        eprint_doubts(&stopped.trace, &overloads_text(&stopped.trace, errors_in_colour()));
        let (phase, position) = (phase_prefix(&stopped.trace), position_text(&stopped.error, circuit));
        let failure = |more: &str| {
            let message = format!("{phase}{}{position}{more}", message_with_advice(&stopped.error));
            let failure = Failure::data(message).with_detail("code", stopped.error.code().into());
            failure.with_detail("sweeps", json_value(&RepetitionDocument::all(&stopped.trace)))
        };
        if files.paths().next().is_none() {
            return failure("");
        }
        match files.write(&stopped.trace, circuit, streamed) {
            Err(unwritten) => {
                unwritten.report();
                failure("")
            }
            Ok(written) => failure(&format!("\nthe files contain the run up to t = {last} s"))
                .with_detail("recorded_until", last.into())
                .with_detail("files", path_texts(&written).into()),
        }
    }

    /// The signals of `--record`, and those of the pictures if they are drawn.
    fn recorded(&self, circuit: &Circuit) -> Result<Vec<String>, Failure> {
        let found = |name: &String| {
            circuit.recorded_name(name).map(str::to_owned).ok_or_else(|| unknown_signal(name, circuit))
        };
        let mut record = self.record.iter().map(found).collect::<Result<Vec<_>, _>>()?;
        if self.files.draw() {
            record.extend(circuit.drawn_signals());
        }
        Ok(unique(record))
    }

    /// The parameters of `--sensitivity`, and those of the pictures if they are drawn.
    ///
    /// Sensitivities that the patch specifies are added only if all signals of the patch are recorded or pictures are
    /// drawn.
    fn parameters(&self, circuit: &Circuit) -> Result<Vec<String>, Failure> {
        let known: Vec<&str> = circuit.parameters().map(|(name, ..)| name).collect();
        match self.sensitivity.iter().find(|name| !known.contains(&name.as_str())) {
            None => {
                let shown = if self.record.is_empty() || self.files.draw() {
                    circuit.sensitivity_parameters()
                } else {
                    vec![]
                };
                Ok(unique(self.sensitivity.iter().cloned().chain(shown).collect()))
            }
            Some(name) => {
                let hint = suggestion(name, &known).unwrap_or_else(|| "it has none".to_owned());
                Err(Failure::usage(format!("the patch has no parameter {name}; {hint}")))
            }
        }
    }
}

/// The names without repetitions, in the order of their first occurrence.
fn unique(mut names: Vec<String>) -> Vec<String> {
    let mut seen = std::collections::HashSet::new();
    names.retain(|name| seen.insert(name.clone()));
    names
}

/// The failure for an unknown signal.
fn unknown_signal(name: &str, circuit: &Circuit) -> Failure {
    let known: Vec<&str> = circuit.signals().iter().map(|signal| signal.name.as_str()).collect();
    let hint = suggestion(name, &known).unwrap_or_else(|| "name a drive or an element".to_owned());
    Failure::usage(format!("the patch has no signal {name}; {hint}"))
}

/// The line of a run without a picture.
const NO_PICTURE: &str = "no picture: add --plot FILE.svg or --plot FILE.png to draw the curves\n";

/// The keys of the document in addition to those of every command on a patch.
#[derive(Serialize)]
struct Document<'a> {
    run: SettingsDocument,
    samples: usize,
    readings: Vec<ReadingDocument>,
    sensitivities: Vec<SensitivityDocument>,
    #[serde(rename = "sweeps")]
    repetitions: Vec<RepetitionDocument<'a>>,
    phases: Vec<PhaseDocument<'a>>,
    step_warning: Option<StepWarningDocument<'a>>,
    low_peaks: Vec<LowPeakDocument<'a>>,
    files: Vec<String>,
}

/// The settings of the run. `repeat` is the number of runs from initial condition.
#[derive(Serialize)]
struct SettingsDocument {
    #[serde(flatten)]
    times: TimesDocument,
    repeat: usize,
    hold_on_overload: bool,
}

/// One run of repetitive operation: its end in seconds, the work of the solver, and its overloads.
#[derive(Serialize)]
struct RepetitionDocument<'a> {
    end: f64,
    steps: u64,
    #[serde(rename = "switchings")]
    changes: u64,
    #[serde(rename = "kinks")]
    crossings: u64,
    rejections: u64,
    evaluations: u64,
    held: bool,
    overloads: Vec<OverloadDocument<'a>>,
}

impl<'a> Document<'a> {
    /// The document of a run with this number of samples. `written` are the files.
    fn new(
        circuit: &Circuit,
        settings: &RunSettings,
        trace: &'a Trace,
        (samples, written): (usize, &[PathBuf]),
    ) -> Self {
        Document {
            run: SettingsDocument {
                times: TimesDocument::of(settings),
                repeat: trace.repetitions.len(),
                hold_on_overload: settings.hold_on_overload,
            },
            samples,
            readings: ReadingDocument::all(trace),
            sensitivities: SensitivityDocument::all(trace),
            repetitions: RepetitionDocument::all(trace),
            phases: PhaseDocument::all(trace),
            step_warning: trace.step_warning.as_ref().map(StepWarningDocument::of),
            low_peaks: LowPeakDocument::all(circuit, trace),
            files: path_texts(written),
        }
    }
}

impl<'a> RepetitionDocument<'a> {
    /// The documents of all runs of a trace, in the order of time.
    fn all(trace: &'a Trace) -> Vec<Self> {
        trace.repetitions.iter().map(RepetitionDocument::of).collect()
    }

    fn of(repetition: &'a Repetition) -> Self {
        let WorkCounters { steps, changes, crossings, rejections, evaluations } = repetition.work;
        RepetitionDocument {
            end: repetition.end,
            steps,
            changes,
            crossings,
            rejections,
            evaluations,
            held: repetition.is_held,
            overloads: OverloadDocument::all(&repetition.overloads),
        }
    }
}
