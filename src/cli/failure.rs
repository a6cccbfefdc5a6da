//! Failures of a command: their messages, JSON documents and exit codes.
//!
//! Exit code 2 means that the command line must be changed, 1 that the patch or the data must be changed. Text goes to
//! standard error. With `--json`, a document follows on standard output: `ok` is false, and `error` has the message or
//! `diagnostics` the list of findings. Further keys depend on the command, such as `code` of a run error.

use std::process::ExitCode;

use serde_json::{Map, Value, json};

use super::{eprint, eprint_coloured, errors_in_colour, print_json};
use patchcord::document::{DocumentError, Report, Severity};
use patchcord::ident::ExperimentError;
use patchcord::ident::effects::EffectError;
use patchcord::ident::fit::model::ModelError;
use patchcord::solve::RunError;

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
    /// The patch is wrong. The report has the places.
    Report(Box<Report>),
    /// Several documents are wrong. The first field is the JSON key for the file of the first report.
    Several(&'static str, Vec<Report>),
}

impl Failure {
    /// A failure that is printed as text only.
    fn new(cause: Cause) -> Self {
        Failure { cause, json: false, details: Map::new() }
    }

    /// An error in the command line, with exit code 2.
    pub fn usage(message: impl Into<String>) -> Self {
        Failure::new(Cause::Usage(message.into()))
    }

    /// An error in the command line whose message was already printed. The JSON document is still printed.
    pub fn already_printed(message: impl Into<String>) -> Self {
        Failure::new(Cause::AlreadyPrinted(message.into())).with_json_output(true)
    }

    /// An error in the patch or the data, with exit code 1.
    pub fn data(message: impl Into<String>) -> Self {
        Failure::new(Cause::Data(message.into()))
    }

    /// Sets whether the failure is also printed as a JSON document.
    pub fn with_json_output(self, json: bool) -> Self {
        Failure { json, ..self }
    }

    /// Adds a key to the JSON document.
    pub fn with_detail(mut self, key: &str, value: Value) -> Self {
        self.details.insert(key.to_owned(), value);
        self
    }

    /// Prints the failure and returns the exit code.
    pub fn report(self) -> ExitCode {
        match &self.cause {
            Cause::Usage(message) | Cause::Data(message) => eprint(&format!("error: {message}")),
            Cause::Report(report) => eprint_report(report),
            Cause::Several(_, reports) => reports.iter().for_each(eprint_report),
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
            Cause::Data(_) | Cause::Several(..) => 1,
            Cause::Report(report) if concerns_command_line(report) => 2,
            Cause::Report(_) => 1,
        }
    }

    /// The JSON document.
    fn document(&self) -> Value {
        let mut document = match &self.cause {
            Cause::Usage(message) | Cause::AlreadyPrinted(message) | Cause::Data(message) => {
                json!({"ok": false, "error": message})
            }
            Cause::Report(report) => {
                json!({"ok": false, "patch": report.file, "diagnostics": report.to_json()})
            }
            Cause::Several(first, reports) => {
                let findings = reports.iter().map(Report::to_json);
                let findings: Value =
                    findings.flat_map(|list| list.as_array().cloned().unwrap_or_default()).collect();
                let file = reports.first().map(|report| report.file.as_str());
                json!({"ok": false, *first: file, "diagnostics": findings})
            }
        };
        if let Value::Object(entries) = &mut document {
            entries.extend(self.details.clone());
        }
        document
    }
}

/// Whether all errors of a report concern the command line. These have no place in the file.
fn concerns_command_line(report: &Report) -> bool {
    let mut errors = report.findings.iter().filter(|finding| finding.code.severity() == Severity::Error);
    errors.all(|finding| finding.span.is_none())
}

/// Prints the findings of a report and their number.
pub(super) fn eprint_report(report: &Report) {
    if report.findings.is_empty() {
        return;
    }
    eprint_coloured(&report.render(errors_in_colour()));
    eprint(&format!("\n{}: {}", report.file, counts_text(report)));
}

/// The number of errors and warnings: "1 error, 2 warnings".
fn counts_text(report: &Report) -> String {
    let counts = [(report.error_count(), "error"), (report.warning_count(), "warning")];
    let texts =
        counts.iter().filter(|(number, _)| *number > 0).map(|(number, noun)| plural(*number as u64, noun));
    texts.collect::<Vec<_>>().join(", ")
}

/// A number with its noun: "1 step", "2 steps".
pub(super) fn plural(number: u64, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

impl From<Box<Report>> for Failure {
    fn from(report: Box<Report>) -> Self {
        Failure::new(Cause::Report(report))
    }
}

impl From<DocumentError> for Failure {
    fn from(error: DocumentError) -> Self {
        match error {
            DocumentError::Text(report) => report.into(),
            error => Failure::data(error.to_string()),
        }
    }
}

impl From<ExperimentError> for Failure {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::File(error) => error.into(),
            ExperimentError::Invalid { experiment, patch } => {
                let reports = [Some(experiment), patch].into_iter().flatten().map(|report| *report);
                Failure::new(Cause::Several("experiment", reports.collect()))
            }
        }
    }
}

impl From<EffectError> for Failure {
    fn from(error: EffectError) -> Self {
        match error {
            EffectError::Invalid(reports) => Failure::new(Cause::Several("effect", reports)),
            error => Failure::data(error.to_string()),
        }
    }
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        Failure::data(error.to_string())
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        Failure::data(error.to_string()).with_detail("code", error.code().into())
    }
}
