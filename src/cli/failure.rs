//! Why a command ended without doing its work, and with which exit code.

use std::process::ExitCode;

use serde_json::{Map, Value, json};

use super::{errors_in_colour, say_json, tell, tell_coloured};
use patchcord::document::{DocumentError, Report, Severity};
use patchcord::ident::ExperimentError;
use patchcord::ident::effects::EffectError;
use patchcord::ident::fit::model::ModelError;
use patchcord::solve::RunError;

/// What is told, and whose fault it is.
pub(super) struct Failure {
    cause: Cause,
    json: bool,
    /// What the JSON document says beyond the message.
    details: Map<String, Value>,
}

enum Cause {
    /// The command line is wrong.
    Usage(String),
    /// The command line is wrong, which has been told at length.
    Told(String),
    /// The patch or the data is wrong.
    Data(String),
    /// The patch is wrong, in these places.
    Report(Box<Report>),
    /// Several documents are wrong: an experiment and its patch or data, effects. What the first is, and the reports.
    Several(&'static str, Vec<Report>),
}

impl Failure {
    fn new(cause: Cause) -> Self {
        Failure { cause, json: false, details: Map::new() }
    }

    pub fn usage(message: impl Into<String>) -> Self {
        Failure::new(Cause::Usage(message.into()))
    }

    /// A wrong command line that needs no more telling, but a JSON document and the exit code.
    pub fn told(message: impl Into<String>) -> Self {
        Failure::new(Cause::Told(message.into())).told_as_json(true)
    }

    pub fn data(message: impl Into<String>) -> Self {
        Failure::new(Cause::Data(message.into()))
    }

    /// The same failure, told as a JSON document too.
    pub fn told_as_json(self, json: bool) -> Self {
        Failure { json, ..self }
    }

    /// The same failure; its JSON document says this as well.
    pub fn with(mut self, key: &str, value: Value) -> Self {
        self.details.insert(key.to_owned(), value);
        self
    }

    /// Tells the failure and gives the exit code.
    pub fn tell(self) -> ExitCode {
        match &self.cause {
            Cause::Usage(message) | Cause::Data(message) => tell(&format!("error: {message}")),
            Cause::Report(report) => tell_report(report),
            Cause::Several(_, reports) => reports.iter().for_each(tell_report),
            Cause::Told(_) => (),
        }
        if self.json {
            // Standard output failing as well leaves nobody to tell.
            let _ = say_json(&self.document());
        }
        ExitCode::from(self.code())
    }

    fn code(&self) -> u8 {
        match &self.cause {
            Cause::Usage(_) | Cause::Told(_) => 2,
            Cause::Data(_) | Cause::Several(..) => 1,
            Cause::Report(report) if is_of_the_command_line(report) => 2,
            Cause::Report(_) => 1,
        }
    }

    fn document(&self) -> Value {
        let mut document = match &self.cause {
            Cause::Usage(message) | Cause::Told(message) | Cause::Data(message) => {
                json!({"ok": false, "error": message})
            }
            Cause::Report(report) => {
                json!({"ok": false, "patch": report.file, "diagnostics": report.to_json()})
            }
            Cause::Several(first, reports) => {
                let findings = reports.iter().map(Report::to_json);
                let findings: Value =
                    findings.flat_map(|told| told.as_array().cloned().unwrap_or_default()).collect();
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

/// An error without a place in the file comes from the command line.
fn is_of_the_command_line(report: &Report) -> bool {
    let mut errors = report.findings.iter().filter(|finding| finding.code.severity() == Severity::Error);
    errors.all(|finding| finding.span.is_none())
}

/// Prints the findings and how many there are.
pub(super) fn tell_report(report: &Report) {
    if report.findings.is_empty() {
        return;
    }
    tell_coloured(&report.render(errors_in_colour()));
    tell(&format!("\n{}: {}", report.file, counted(report)));
}

/// How many errors and warnings there are, those of which there are any.
fn counted(report: &Report) -> String {
    let counts = [(report.errors(), "error"), (report.warnings(), "warning")];
    let told =
        counts.iter().filter(|(number, _)| *number > 0).map(|(number, noun)| plural(*number as u64, noun));
    told.collect::<Vec<_>>().join(", ")
}

/// "1 step", "2 steps".
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
            ExperimentError::Wrong { experiment, patch } => {
                let reports = [Some(experiment), patch].into_iter().flatten().map(|report| *report);
                Failure::new(Cause::Several("experiment", reports.collect()))
            }
        }
    }
}

impl From<EffectError> for Failure {
    fn from(error: EffectError) -> Self {
        match error {
            EffectError::Wrong(reports) => Failure::new(Cause::Several("effect", reports)),
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
        Failure::data(error.to_string()).with("code", error.code().into())
    }
}
