//! Reading an experiment from its file or from a text, with all faults in one report.

use std::fmt;
use std::path::Path;

use crate::data::experiment::Experiment;
use crate::data::experiment_builder::ExperimentBuilder;
use crate::data::experiment_document::{ExperimentDocument, read_document};
use crate::data::file_source::{FileSource, GivenFiles};
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{
    Code, Diagnostic, DocumentError, DocumentKind, Report, Span, read_text, tree,
};

/// Why an experiment cannot be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum ExperimentError {
    /// The file of the experiment cannot be opened or read.
    File(DocumentError),
    /// The experiment, its patch or its data have errors.
    Invalid {
        /// All errors and warnings of the experiment and its data.
        experiment: Box<Report>,
        /// The report of the patch. None if the patch has no errors or cannot be read.
        patch: Option<Box<Report>>,
    },
}

impl fmt::Display for ExperimentError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ExperimentError::File(error) => error.fmt(formatter),
            ExperimentError::Invalid { experiment, patch: None } => experiment.fmt(formatter),
            ExperimentError::Invalid { experiment, patch: Some(patch) } => {
                write!(formatter, "{experiment}\n\n{patch}")
            }
        }
    }
}

impl std::error::Error for ExperimentError {}

impl Experiment {
    /// Reads an experiment with its patch and its data. Paths in the experiment are relative to its folder.
    ///
    /// # Errors
    /// If the experiment cannot be read, or if the experiment, its patch or its data have errors. The error contains
    /// all of them.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_ident::Experiment;
    ///
    /// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
    /// assert_eq!(experiment.title, "A mass on a spring, released at 50 mm");
    /// assert_eq!(experiment.fit, ["k"]);
    /// assert_eq!(experiment.outputs[0].unit.text(), "mm");
    ///
    /// // The first three quarters of the record are for training, the rest is for validation.
    /// assert!((experiment.train[0].interval - 0.02).abs() < 1e-9);
    /// assert!(experiment.train[0].len() > experiment.validation[0].len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read(path: impl AsRef<Path>) -> Result<Experiment, ExperimentError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let text = read_text(path).map_err(|error| match error {
            DocumentError::Text(experiment) => ExperimentError::Invalid { experiment, patch: None },
            error => ExperimentError::File(error),
        })?;
        Experiment::parse_in(path.parent().unwrap_or(Path::new("")), &file, &text)
    }

    /// Reads an experiment from a text. `file` is its name in reports. Paths in the experiment are relative to
    /// `folder`.
    ///
    /// # Errors
    /// If the experiment, its patch or its data have errors. The error contains all of them.
    ///
    /// # Examples
    ///
    /// The error has the position of every fault in the text:
    ///
    /// ```
    /// use patchcord_ident::Experiment;
    ///
    /// let text = r#"{"patch": "absent.json", "data": "train.csv", "outputs": {"x": "x"}}"#;
    /// let error = Experiment::parse_in(".", "trial.experiment.json", text).err().ok_or("the patch is absent")?;
    /// assert!(error.to_string().contains("absent.json"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn parse_in(folder: impl AsRef<Path>, file: &str, text: &str) -> Result<Experiment, ExperimentError> {
        Experiment::parse(FileSource::Folder(folder.as_ref()), file, text)
    }

    /// Reads an experiment from a text whose patch and data are in memory. `file` is its name in reports. The checks
    /// are those of [`Experiment::read`].
    ///
    /// # Errors
    /// If the experiment, the patch or the data have errors. The error contains all of them.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    /// use patchcord_ident::{Experiment, GivenFiles};
    ///
    /// let patch = Patch::read("../../examples/05_missing_effect/spring.json")?;
    /// let files = GivenFiles { patch: &patch, data: &[("x.csv", "t,x\n0,1\n0.1,2\n")] };
    /// let text = r#"{"patch": "spring.json", "data": "x.csv", "outputs": {"x": "x"}}"#;
    /// let error = Experiment::parse_given(&files, "trial.json", text).err().ok_or("two samples are too few")?;
    /// assert!(error.to_string().contains("x.csv has 1 sample for training, but needs 10"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn parse_given(
        files: &GivenFiles<'_>,
        file: &str,
        text: &str,
    ) -> Result<Experiment, ExperimentError> {
        Experiment::parse(FileSource::Given(files), file, text)
    }

    /// Reads an experiment from a text. `file` is its name in reports.
    fn parse(source: FileSource<'_>, file: &str, text: &str) -> Result<Experiment, ExperimentError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut findings = Findings::new();
        let document = document_of(text, &mut findings);
        let built = document.map(|document| {
            ExperimentBuilder { source, document: &document, findings: &mut findings }.build()
        });
        let (experiment, patch) = match built {
            Some(Ok(experiment)) => (Some(experiment), None),
            Some(Err(patch)) => (None, patch),
            None => (None, None),
        };
        findings.iter_mut().for_each(|finding| finding.set_reference_page("docs/gap.md"));
        let report = Report::new(file, text, findings);
        match experiment.filter(|_| !report.has_errors()) {
            Some(experiment) => Ok(Experiment { file: file.to_owned(), warnings: report, ..experiment }),
            None => Err(ExperimentError::Invalid { experiment: Box::new(report), patch }),
        }
    }
}

/// The hint for a text that looks like a data file instead of an experiment.
const DATA_FILE_HINT: &str = "name the data file as \"data\" in an experiment, a JSON file that begins with {\"patch\": \"base.json\", \"data\": \"train.csv\", ...";

/// Parses a text to an experiment document. None if the text is empty, is not JSON, or is a different kind of document.
fn document_of(text: &str, findings: &mut Findings) -> Option<ExperimentDocument> {
    if text.trim().is_empty() {
        let hint = "an experiment begins with {\"patch\": \"base.json\", \"data\": \"train.csv\", ...";
        findings.push(Diagnostic::at(Code::SYNTAX, Span::default(), "the document is empty").hint(hint));
        return None;
    }
    let is_probably_data = !text.trim_start().starts_with(['{', '[']);
    let with_hint = |finding: Diagnostic| match is_probably_data {
        true => finding.hint(DATA_FILE_HINT),
        false => finding,
    };
    let root = tree::parse(text).map_err(|finding| findings.push(with_hint(finding))).ok()?;
    if let Some(finding) = DocumentKind::Experiment.wrong_kind(&root) {
        findings.push(finding);
        return None;
    }
    read_document(&root, findings)
}
