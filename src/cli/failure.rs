//! Why a command ended without doing its work, and with which exit code.

use std::process::ExitCode;

use serde_json::{Value, json};

use super::{errors_in_colour, say_json, tell};
use patchcord::patch::{PatchError, Report};

/// What is told, and whose fault it is.
pub(super) struct Failure {
    cause: Cause,
    json: bool,
}

enum Cause {
    /// The command line is wrong.
    Usage(String),
    /// The patch or the data is wrong.
    Data(String),
    /// The patch is wrong, in these places.
    Report(Box<Report>),
}

impl Failure {
    pub fn usage(message: impl Into<String>) -> Self {
        Failure { cause: Cause::Usage(message.into()), json: false }
    }

    pub fn data(message: impl Into<String>) -> Self {
        Failure { cause: Cause::Data(message.into()), json: false }
    }

    /// The same failure, told as a JSON document too.
    pub fn told_as_json(self, json: bool) -> Self {
        Failure { json, ..self }
    }

    /// Tells the failure and gives the exit code.
    pub fn tell(self) -> ExitCode {
        match &self.cause {
            Cause::Usage(message) | Cause::Data(message) => tell(&format!("error: {message}")),
            Cause::Report(report) => tell_report(report),
        }
        if self.json {
            // Standard output failing as well leaves nobody to tell.
            let _ = say_json(&self.document());
        }
        ExitCode::from(self.code())
    }

    fn code(&self) -> u8 {
        match &self.cause {
            Cause::Usage(_) => 2,
            Cause::Data(_) => 1,
            // A finding without a place in the file comes from the command line.
            Cause::Report(report) => {
                if report.findings.iter().all(|finding| finding.span.is_none()) {
                    2
                } else {
                    1
                }
            }
        }
    }

    fn document(&self) -> Value {
        match &self.cause {
            Cause::Usage(message) | Cause::Data(message) => json!({"ok": false, "error": message}),
            Cause::Report(report) => {
                json!({"ok": false, "patch": report.file, "diagnostics": report.to_json()})
            }
        }
    }
}

/// Prints the findings and how many there are.
pub(super) fn tell_report(report: &Report) {
    if report.findings.is_empty() {
        return;
    }
    tell(&report.render(errors_in_colour()));
    let count = |number: usize, noun: &str| match number {
        0 => None,
        1 => Some(format!("1 {noun}")),
        many => Some(format!("{many} {noun}s")),
    };
    let counts = [count(report.errors(), "error"), count(report.warnings(), "warning")];
    let counts: Vec<_> = counts.into_iter().flatten().collect();
    tell(&format!("\n{}: {}", report.file, counts.join(", ")));
}

impl From<Box<Report>> for Failure {
    fn from(report: Box<Report>) -> Self {
        Failure { cause: Cause::Report(report), json: false }
    }
}

impl From<PatchError> for Failure {
    fn from(error: PatchError) -> Self {
        match error {
            PatchError::Text(report) => report.into(),
            error => Failure::data(error.to_string()),
        }
    }
}

impl From<patchcord::solve::RunError> for Failure {
    fn from(error: patchcord::solve::RunError) -> Self {
        Failure::data(error.to_string())
    }
}
