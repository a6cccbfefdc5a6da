//! Reading an experiment from its file or from a text.

use std::fmt;
use std::path::Path;

use crate::data::document;
use crate::data::document::Document;
use crate::data::experiment::Experiment;
use crate::data::experiment_builder::Bringing;
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, DocumentError, DocumentKind, Report, Span, text_of, tree};

/// Why an experiment cannot be worked with.
#[derive(Debug)]
pub enum ExperimentError {
    /// The file system refused the experiment's own file.
    File(DocumentError),
    /// It is wrong, or its patch or its data are.
    Wrong {
        /// What is wrong with it, all at once.
        experiment: Box<Report>,
        /// What is wrong with its patch.
        patch: Option<Box<Report>>,
    },
}

impl fmt::Display for ExperimentError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ExperimentError::File(error) => error.fmt(formatter),
            ExperimentError::Wrong { experiment, patch: None } => experiment.fmt(formatter),
            ExperimentError::Wrong { experiment, patch: Some(patch) } => {
                write!(formatter, "{experiment}\n\n{patch}")
            }
        }
    }
}

impl std::error::Error for ExperimentError {}

impl Experiment {
    /// Reads an experiment with its patch and its data; files are looked for from its folder.
    ///
    /// # Errors
    /// Everything that is wrong with it, its patch and its data, all at once.
    pub fn read(path: &Path) -> Result<Experiment, ExperimentError> {
        let file = path.display().to_string();
        let text = text_of(path).map_err(|error| match error {
            DocumentError::Text(experiment) => ExperimentError::Wrong { experiment, patch: None },
            error => ExperimentError::File(error),
        })?;
        Experiment::parse_in(path.parent().unwrap_or(Path::new("")), &file, &text)
    }

    /// Reads an experiment from a text; `file` is the name that reports give it, and files are looked for from `folder`.
    ///
    /// # Errors
    /// Those of [`Experiment::read`].
    pub fn parse_in(folder: &Path, file: &str, text: &str) -> Result<Experiment, ExperimentError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut findings = Findings::new();
        let read = document_of(text, &mut findings);
        let found =
            read.map(|document| Bringing { folder, document: &document, findings: &mut findings }.together());
        let (made, patch) = match found {
            Some(Ok(made)) => (Some(made), None),
            Some(Err(patch)) => (None, patch),
            None => (None, None),
        };
        findings.iter_mut().for_each(|finding| finding.point_to("docs/gap.md"));
        let report = Report::new(file, text, findings);
        match made.filter(|_| !report.has_errors()) {
            Some(made) => Ok(Experiment { file: file.to_owned(), warnings: report, ..made }),
            None => Err(ExperimentError::Wrong { experiment: Box::new(report), patch }),
        }
    }
}

/// What to do where data stand in place of an experiment.
const DATA_ALONE: &str = "name data as \"data\" of an experiment, a JSON file that begins with {\"patch\": \"base.json\", \"data\": \"train.csv\", ...";

fn document_of(text: &str, findings: &mut Findings) -> Option<Document> {
    if text.trim().is_empty() {
        let hint = "an experiment begins with {\"patch\": \"base.json\", \"data\": \"train.csv\", ...";
        findings.push(Diagnostic::at(Code::Syntax, Span::default(), "the document is empty").hint(hint));
        return None;
    }
    let looks_like_data = !text.trim_start().starts_with(['{', '[']);
    let told = |finding: Diagnostic| match looks_like_data {
        true => finding.hint(DATA_ALONE),
        false => finding,
    };
    let root = tree::parse(text).map_err(|finding| findings.push(told(finding))).ok()?;
    if let Some(finding) = DocumentKind::Experiment.instead(&root) {
        findings.push(finding);
        return None;
    }
    document::document(&root, findings)
}
