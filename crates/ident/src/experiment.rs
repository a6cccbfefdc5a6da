//! An experiment: a patch, what was measured, and what may be fitted.

use std::fmt;
use std::path::{Path, PathBuf};

use super::document::{self, Document, Hold};
use super::model::with_tables;
use super::record::Record;
use super::together::Bringing;
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, DocumentError, DocumentKind, Report, Span, text_of, tree};
use patchcord_core::patch::{EditError, Patch};
use patchcord_expr::Unit;

/// Fewer samples than this are neither trained nor tested on.
pub const LEAST_SAMPLES: usize = 10;

/// A patch and what was measured on the thing that it stands for.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// The file, as the reader wrote it.
    pub file: String,
    /// Its title; empty where it has none.
    pub title: String,
    /// The patch as it was written, found right.
    pub patch: Patch,
    /// The drives that data feed; those of the patch that are not among them stay as they are.
    pub drives: Vec<Feed>,
    /// What was measured.
    pub outputs: Vec<Output>,
    /// The names of the parameters to fit; each has a range.
    pub fit: Vec<String>,
    /// What to fit to.
    pub train: Vec<Record>,
    /// What is held back.
    pub test: Vec<Record>,
    /// The files that all of these come from.
    pub files: Vec<PathBuf>,
    /// After so many seconds runs begin anew, where the experiment asks for that.
    pub pieces: Option<f64>,
    /// What the reader should know although the experiment can be worked with.
    pub warnings: Report,
}

/// A drive of the patch that a column feeds.
#[derive(Debug, Clone)]
pub struct Feed {
    /// Its name in the patch.
    pub drive: String,
    /// The column, as the experiment names it.
    pub column: String,
    /// What it does between samples.
    pub hold: Hold,
    /// Standard deviation of the noise of the column, in `unit`, where the experiment tells it.
    pub sigma: Option<f64>,
    /// The unit of its scale, in which records hold it.
    pub unit: Unit,
    /// What a volt stands for, in this unit, with the parameters of the patch.
    pub per_volt: f64,
}

/// A signal of the patch that a column measures.
#[derive(Debug, Clone)]
pub struct Output {
    /// The name under which the patch records it.
    pub signal: String,
    /// The column, as the experiment names it.
    pub column: String,
    /// Standard deviation of the noise, in `unit`, where the experiment tells it.
    pub sigma: Option<f64>,
    /// Whether the column may be off by a constant that says nothing about the thing measured.
    pub offset: bool,
    /// The unit of the signal, in which records hold it.
    pub unit: Unit,
    /// What a volt stands for, in this unit and with its sign, with the parameters of the patch.
    pub per_volt: f64,
}

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

    /// The patch with a table of one point, zero, in place of every drive that data feed, held as the experiment says: what
    /// [`solve::feed`](patchcord_core::solve::feed) takes.
    ///
    /// # Errors
    /// None that is known: what is put in place of a drive is one.
    pub fn patch_to_feed(&self) -> Result<Patch, EditError> {
        with_tables(&self.patch, &self.drives)
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
