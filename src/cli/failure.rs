//! Failures of a command: their messages, JSON documents and exit codes.
//!
//! Exit code 2 means that the command line must be changed, 1 that the patch or the data must be changed or that output
//! cannot be written, 3 that a run had an overload and the command line forbids it. Text goes to standard error. With
//! `--json`, a document follows on standard output: `ok` is false, and `error` has the message or `diagnostics` the
//! list of findings. Further keys depend on the command, such as `code` of a run error.
//!
//! The dispatcher in `mod.rs` decides whether a failure is also printed as JSON. Commands only return it.

use std::io::ErrorKind;
use std::path::Path;
use std::process::ExitCode;

use serde::Serialize;
use serde_json::{Map, Value};

use super::{eprint, eprint_coloured, errors_in_colour, print_json};
use patchcord::document::{DiagnosticDocument, DocumentError, Report, Severity, escape_controls, plural};
use patchcord::ident::ExperimentError;
use patchcord::ident::effects::EffectError;
use patchcord::ident::fit::model::ModelError;
use patchcord::solve::RunError;
use patchcord::thesis::replay::ReplayError;

/// A failed command.
pub(super) struct Failure {
    /// What failed.
    cause: Cause,
    /// Whether the failure is also printed as a JSON document.
    json: bool,
    /// Further keys of the JSON document.
    details: Map<String, Value>,
}

/// The kind of failure, which decides the exit code and the form of the document.
enum Cause {
    /// The command line is wrong.
    Usage(String),
    /// The command line is wrong, and the message was already printed.
    AlreadyPrinted(String),
    /// The patch or the data are wrong.
    Data(String),
    /// The patch is wrong. The report has the positions. An error without a position concerns the command line.
    Patch(Box<Report>),
    /// A problem is wrong, or it has no circuit. The command line is right.
    Problem(Box<Report>),
    /// An experiment is wrong, or its patch. The first report is that of the first wrong document.
    Experiment(Vec<Report>),
    /// Effects are wrong.
    Effects(Vec<Report>),
    /// A run had an overload, and the command line forbids it.
    Overload(String),
}

/// The JSON document of a failure. It has either `error` or `diagnostics`.
#[derive(Serialize)]
struct FailureDocument<'a> {
    ok: bool,
    #[serde(flatten)]
    cause: CauseDocument<'a>,
    #[serde(flatten)]
    details: &'a Map<String, Value>,
}

/// What failed: a message, or the file of the first report and the findings of all reports.
#[derive(Serialize)]
#[serde(untagged)]
enum CauseDocument<'a> {
    Message { error: &'a str },
    Patch { patch: &'a str, diagnostics: Vec<DiagnosticDocument> },
    Problem { problem: &'a str, diagnostics: Vec<DiagnosticDocument> },
    Experiment { experiment: Option<&'a str>, diagnostics: Vec<DiagnosticDocument> },
    Effects { effect: Option<&'a str>, diagnostics: Vec<DiagnosticDocument> },
}

impl Failure {
    /// A failure that is printed as text only.
    fn new(cause: Cause) -> Self {
        Failure { cause, json: false, details: Map::new() }
    }

    /// An error in the command line, with exit code 2.
    pub(super) fn usage(message: impl Into<String>) -> Self {
        Failure::new(Cause::Usage(message.into()))
    }

    /// An error in the command line whose message was already printed. A JSON document is still printed.
    pub(super) fn already_printed(message: impl Into<String>) -> Self {
        Failure::new(Cause::AlreadyPrinted(message.into()))
    }

    /// An error in the patch or the data, with exit code 1.
    pub(super) fn data(message: impl Into<String>) -> Self {
        Failure::new(Cause::Data(message.into()))
    }

    /// An error in a problem, with exit code 1 also if it has no position in the problem.
    pub(super) fn problem(report: Box<Report>) -> Self {
        Failure::new(Cause::Problem(report))
    }

    /// An overload in a run that must have none, with exit code 3.
    pub(super) fn overload(message: impl Into<String>) -> Self {
        Failure::new(Cause::Overload(message.into()))
    }

    /// Sets whether the failure is also printed as a JSON document.
    pub(super) fn with_json_output(self, json: bool) -> Self {
        Failure { json, ..self }
    }

    /// Adds a key to the JSON document.
    pub(super) fn with_detail(mut self, key: &str, value: Value) -> Self {
        self.details.insert(key.to_owned(), value);
        self
    }

    /// Adds all keys of a document to the JSON document of the failure, except its `ok`.
    ///
    /// # Errors
    /// If the document cannot be formatted.
    pub(super) fn with_document(mut self, document: &impl Serialize) -> Result<Self, Self> {
        match serde_json::to_value(document) {
            Ok(Value::Object(keys)) => self.details.extend(keys.into_iter().filter(|(key, _)| key != "ok")),
            Ok(_) => (),
            Err(error) => return Err(Failure::data(error.to_string())),
        }
        Ok(self)
    }

    /// Prints the failure and returns the exit code.
    pub(super) fn report(self) -> ExitCode {
        match &self.cause {
            Cause::Usage(message) | Cause::Data(message) | Cause::Overload(message) => {
                eprint(&format!("error: {message}"));
            }
            Cause::Patch(report) | Cause::Problem(report) => eprint_report(report),
            Cause::Experiment(reports) | Cause::Effects(reports) => reports.iter().for_each(eprint_report),
            Cause::AlreadyPrinted(_) => (),
        }
        if self.json {
            // If standard output fails too, there is no place for a message.
            let _ = print_json(&self.document());
        }
        ExitCode::from(self.code())
    }

    /// The exit code.
    fn code(&self) -> u8 {
        match &self.cause {
            Cause::Usage(_) | Cause::AlreadyPrinted(_) => 2,
            Cause::Data(_) | Cause::Problem(_) | Cause::Experiment(_) | Cause::Effects(_) => 1,
            Cause::Overload(_) => 3,
            Cause::Patch(report) if concerns_command_line(report) => 2,
            Cause::Patch(_) => 1,
        }
    }

    /// The JSON document.
    fn document(&self) -> FailureDocument<'_> {
        let cause = match &self.cause {
            Cause::Usage(error)
            | Cause::AlreadyPrinted(error)
            | Cause::Data(error)
            | Cause::Overload(error) => CauseDocument::Message { error },
            Cause::Patch(report) => {
                CauseDocument::Patch { patch: &report.file, diagnostics: report.documents() }
            }
            Cause::Problem(report) => {
                CauseDocument::Problem { problem: &report.file, diagnostics: report.documents() }
            }
            Cause::Experiment(reports) => {
                CauseDocument::Experiment { experiment: first_file(reports), diagnostics: findings(reports) }
            }
            Cause::Effects(reports) => {
                CauseDocument::Effects { effect: first_file(reports), diagnostics: findings(reports) }
            }
        };
        FailureDocument { ok: false, cause, details: &self.details }
    }
}

/// The file of the first report; None if there is none.
fn first_file(reports: &[Report]) -> Option<&str> {
    reports.first().map(|report| report.file.as_str())
}

/// The findings of all reports, as JSON objects.
fn findings(reports: &[Report]) -> Vec<DiagnosticDocument> {
    reports.iter().flat_map(Report::documents).collect()
}

/// Whether all errors of a report concern the command line. These have no position in the file.
fn concerns_command_line(report: &Report) -> bool {
    let mut errors = report.findings.iter().filter(|finding| finding.code.severity() == Severity::Error);
    errors.all(|finding| finding.span.is_none())
}

/// Prints the findings of a report. If there are errors, their number follows. A command that succeeds with warnings
/// prints its own summary.
pub(super) fn eprint_report(report: &Report) {
    if report.findings.is_empty() {
        return;
    }
    eprint_coloured(&report.render(errors_in_colour()));
    if report.has_errors() {
        eprint(&format!("\n{}: {}", escape_controls(&report.file), counts_text(report)));
    }
}

/// The number of errors and warnings: "1 error, 2 warnings".
fn counts_text(report: &Report) -> String {
    let counts = [(report.error_count(), "error"), (report.warning_count(), "warning")];
    let texts =
        counts.iter().filter(|(number, _)| *number > 0).map(|(number, noun)| plural(*number as u64, noun));
    texts.collect::<Vec<_>>().join(", ")
}

impl From<Box<Report>> for Failure {
    fn from(report: Box<Report>) -> Self {
        Failure::new(Cause::Patch(report))
    }
}

impl From<DocumentError> for Failure {
    fn from(error: DocumentError) -> Self {
        match error {
            DocumentError::Text(report) => report.into(),
            error => Failure::data(format!("{error}{}", missing_ending_hint(&error))),
        }
    }
}

/// The hint about a file with the ending .json, if the named file does not exist and that file does. Otherwise empty.
fn missing_ending_hint(error: &DocumentError) -> String {
    let DocumentError::File { file, source, .. } = error else { return String::new() };
    let with_ending = format!("{file}.json");
    let is_meant = source.kind() == ErrorKind::NotFound && Path::new(&with_ending).is_file();
    if is_meant { format!("; did you mean {with_ending}?") } else { String::new() }
}

impl From<ExperimentError> for Failure {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::File(error) => error.into(),
            ExperimentError::Invalid { experiment, patch } => {
                let reports = [Some(experiment), patch].into_iter().flatten().map(|report| *report);
                Failure::new(Cause::Experiment(reports.collect()))
            }
            error => Failure::data(error.to_string()),
        }
    }
}

impl From<EffectError> for Failure {
    fn from(error: EffectError) -> Self {
        match error {
            EffectError::Invalid(reports) => Failure::new(Cause::Effects(reports)),
            error => Failure::data(error.to_string()),
        }
    }
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        Failure::data(error.to_string())
    }
}

impl From<ReplayError> for Failure {
    fn from(error: ReplayError) -> Self {
        Failure::data(error.to_string())
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        Failure::data(error.to_string()).with_detail("code", error.code().into())
    }
}
