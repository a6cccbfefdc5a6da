//! An experiment: a patch, what was measured, and what may be fitted.

use std::collections::HashSet;
use std::fmt;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::document::{self, Document, DriveWire, Held, Hold, OutputWire, Source};
use super::fittable::to_fit;
use super::measured::{self, Measured, Wanted, plural};
use super::motion;
use super::parts::{Cutting, Part, Use, apart};
use super::record::Record;
use super::subject::{Subject, Target};
use crate::patch::fields::Findings;
use crate::patch::{
    Code, Diagnostic, Edit, EditError, Patch, PatchError, Report, Span, Unit, any_error, suggestion, text_of,
    told, tree,
};

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
    File(PatchError),
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
            PatchError::Text(experiment) => ExperimentError::Wrong { experiment, patch: None },
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
        findings.iter_mut().for_each(point_to_the_page);
        let report = Report::new(file, text, findings);
        match made.filter(|_| !report.has_errors()) {
            Some(made) => Ok(Experiment { file: file.to_owned(), warnings: report, ..made }),
            None => Err(ExperimentError::Wrong { experiment: Box::new(report), patch }),
        }
    }

    /// The patch with a table of one point, zero, in place of every drive that data feed.
    ///
    /// # Errors
    /// None that is known: what is put in place of a drive is one.
    pub fn patch_to_feed(&self) -> Result<Patch, EditError> {
        let table = |feed: &Feed| {
            let scale = self.patch.drives.get(&feed.drive).and_then(|drive| drive.scale.as_ref());
            let scale = scale.map(|scale| scale.value.as_str());
            Edit {
                path: vec!["drives".to_owned(), feed.drive.clone()],
                value: json!({"kind": "table", "scale": scale, "points": [[0, 0]]}),
            }
        };
        let edits: Vec<_> = self.drives.iter().map(table).collect();
        self.patch.edited(self.patch.file(), &edits)
    }
}

/// The codes of documents advise to read about patches.
fn point_to_the_page(finding: &mut Diagnostic) {
    if matches!(finding.code, Code::WrongType | Code::MissingKey) {
        finding.hint.get_or_insert_with(|| "docs/gap.md shows what stands under each key".to_owned());
    }
}

fn document_of(text: &str, findings: &mut Findings) -> Option<Document> {
    if text.trim().is_empty() {
        let hint = "an experiment begins with {\"patch\": \"base.json\", \"data\": \"train.csv\", ...";
        findings.push(Diagnostic::at(Code::Syntax, Span::default(), "the document is empty").hint(hint));
        return None;
    }
    let root = tree::parse(text).map_err(|finding| findings.push(finding)).ok()?;
    document::document(&root, findings)
}

/// An experiment's document that is being held against patch and data.
struct Bringing<'a> {
    folder: &'a Path,
    document: &'a Document,
    findings: &'a mut Findings,
}

/// A record's file as it was read.
struct Read<'a> {
    path: PathBuf,
    source: &'a Source,
    measured: Measured,
    seconds: f64,
}

impl Read<'_> {
    fn cutting(&self) -> Cutting<'_> {
        Cutting {
            measured: &self.measured,
            seconds: self.seconds,
            range: self.source.range.as_ref(),
            span: self.source.file.span,
        }
    }

    /// Whether both are the same samples.
    fn is_same(&self, other: &Read<'_>) -> bool {
        self.path == other.path && self.measured.name == other.measured.name
    }
}

/// A part of a file.
struct Taken<'r> {
    read: &'r Read<'r>,
    part: Part,
}

impl Taken<'_> {
    /// How many samples were taken in it.
    fn samples(&self) -> usize {
        self.read.measured.rows_in(&self.part.places).len()
    }
}

impl<'a> Bringing<'a> {
    /// Document, patch and data as one; a wrong patch's report.
    fn together(mut self) -> Result<Experiment, Option<Box<Report>>> {
        let document = self.document;
        let subject = match &document.patch {
            Some(named) => Subject::read(self.folder, named, self.findings),
            None => Err(None),
        };
        let drives: Vec<_> =
            document.drives.iter().map(|drive| self.feed(drive, subject.as_ref().ok())).collect();
        let outputs: Vec<_> =
            document.outputs.iter().map(|output| self.output(output, subject.as_ref().ok())).collect();
        let targets: Vec<_> = drives
            .iter()
            .map(|feed| feed.as_ref().map(|feed| &feed.unit))
            .chain(outputs.iter().map(|output| output.as_ref().map(|output| &output.unit)))
            .collect();
        let wanted = wanted(document, &targets);
        let trained = self.files(&document.data, &wanted);
        let tested = match &document.test {
            Held::Records(sources) => self.files(sources, &wanted),
            _ => Vec::new(),
        };
        let subject = subject?;
        let fed = |name: &str| document.drives.iter().any(|drive| drive.wire.name.value == name);
        let fit = to_fit(subject.patch(), &fed, document.fit.as_deref(), self.findings);
        let holds: Vec<Hold> = document.drives.iter().map(|drive| drive.hold).collect();
        let taken = self.parts(&trained, &tested);
        let records = |used: Use| {
            let of_use = taken.iter().filter(|taken| taken.part.used == used);
            of_use.map(|taken| Record::cut(&taken.read.measured, taken.part.places.clone(), &holds)).collect()
        };
        let (train, test): (Vec<_>, Vec<_>) = (records(Use::Train), records(Use::Test));
        let made = Experiment {
            file: String::new(),
            title: document.title.clone(),
            patch: subject.patch().clone(),
            drives: drives.into_iter().flatten().collect(),
            outputs: outputs.into_iter().flatten().collect(),
            fit,
            train,
            test,
            warnings: Report::new("", "", Vec::new()),
        };
        if !any_error(self.findings) {
            motion::check(&made, document, self.findings);
        }
        Ok(made)
    }

    fn feed(&mut self, drive: &DriveWire, subject: Option<&Subject>) -> Option<Feed> {
        let target = subject?.drive(&drive.wire, self.findings)?;
        let Target { name, unit, per_volt } = target;
        Some(Feed { drive: name, column: drive.wire.column.value.clone(), hold: drive.hold, unit, per_volt })
    }

    fn output(&mut self, output: &OutputWire, subject: Option<&Subject>) -> Option<Output> {
        let Target { name, unit, per_volt } = subject?.signal(&output.wire, self.findings)?;
        let told_in = output.wire.unit.as_ref().map_or(&unit, |told| &told.value);
        let sigma = output.sigma.map(|sigma| unit.out_of_si(told_in.to_si(sigma)));
        let column = output.wire.column.value.clone();
        Some(Output { signal: name, column, sigma, offset: output.offset, unit, per_volt })
    }

    /// Reads the files of records.
    fn files(&mut self, sources: &'a [Source], wanted: &[Wanted<'_>]) -> Vec<Read<'a>> {
        let mut files = Vec::new();
        for source in sources {
            self.check_renamed(source);
            let read = measured::read(self.folder, source, &self.document.clock, wanted, self.findings);
            let path = self.folder.join(&source.file.value);
            files.extend(read.map(|(measured, seconds)| Read { path, source, measured, seconds }));
        }
        files
    }

    /// Refuses other names for columns that the experiment does not read.
    fn check_renamed(&mut self, source: &Source) {
        let clock = self.document.clock.column();
        let known: Vec<_> = clock
            .into_iter()
            .chain(self.document.wires().map(|(wire, _)| wire.column.value.as_str()))
            .collect();
        for (elsewhere, here) in
            source.columns.iter().filter(|(elsewhere, _)| !known.contains(&elsewhere.as_str()))
        {
            let message =
                format!("the experiment reads no column {elsewhere} that could be called otherwise");
            let hint = suggestion(elsewhere, &known);
            self.findings.push(Diagnostic::at(Code::UnknownName, here.span, message).maybe_hint(hint));
        }
    }

    /// The parts of all files, with enough samples each.
    fn parts<'r>(&mut self, trained: &'r [Read<'r>], tested: &'r [Read<'r>]) -> Vec<Taken<'r>> {
        let document = self.document;
        let of_file = |read: &'r Read<'r>| {
            let parts = read.cutting().parts(document.train.as_ref(), &document.test);
            parts.into_iter().map(move |part| Taken { read, part })
        };
        let entire = |read: &'r Read<'r>| Taken { read, part: read.cutting().entire(Use::Test) };
        let mut taken: Vec<_> = trained.iter().flat_map(of_file).chain(tested.iter().map(entire)).collect();
        self.keep_apart(&mut taken);
        let mut told = HashSet::new();
        for taken in taken.iter().filter(|taken| taken.samples() < LEAST_SAMPLES) {
            // Where both parts of a record are too short, that is told once.
            if told.insert(taken.part.span) {
                self.findings.push(self.too_few(taken));
            }
        }
        taken
    }

    /// Nothing is tested on that is trained on.
    fn keep_apart(&mut self, taken: &mut [Taken<'_>]) {
        let trained: Vec<_> = taken
            .iter()
            .filter(|taken| taken.part.used == Use::Train)
            .map(|taken| (taken.read, taken.part.places.clone()))
            .collect();
        for tested in taken.iter_mut().filter(|taken| taken.part.used == Use::Test) {
            for (read, places) in trained.iter().filter(|(read, _)| read.is_same(tested.read)) {
                let shared = apart(places, &mut tested.part.places);
                if shared > 0 {
                    let message =
                        format!("{shared} samples of {} are both trained and tested on", read.measured.name);
                    self.findings.push(Diagnostic::at(Code::SharedSamples, tested.part.span, message));
                }
            }
        }
    }

    fn too_few(&self, taken: &Taken<'_>) -> Diagnostic {
        let (measured, part, seconds) = (&taken.read.measured, &taken.part, taken.read.seconds);
        let (verb, more) = match (part.used, &self.document.test) {
            (Use::Test, Held::Rest) => {
                ("test", "; end \"train\" earlier, or give \"test\" a file of its own")
            }
            (Use::Test, _) => ("test", ""),
            (Use::Train, _) => ("train", ""),
        };
        let [from, to] =
            [0, measured.len().saturating_sub(1)].map(|place| told(measured.time(place) / seconds));
        let message = format!(
            "{} has {} to {verb} on, and {LEAST_SAMPLES} are needed",
            measured.name,
            plural(taken.samples(), "sample")
        );
        let hint =
            format!("the file has {} of them, at times from {from} to {to}{more}", measured.places.len());
        Diagnostic::at(Code::TooFewSamples, part.span, message).hint(hint)
    }
}

/// What every column of the experiment is needed for.
fn wanted<'d>(document: &'d Document, targets: &[Option<&'d Unit>]) -> Vec<Wanted<'d>> {
    let sigmas = document
        .drives
        .iter()
        .map(|_| false)
        .chain(document.outputs.iter().map(|output| output.sigma.is_some()));
    let wanted = document.wires().zip(targets).zip(sigmas);
    wanted
        .map(|(((wire, noun), target), has_sigma)| Wanted {
            column: &wire.column,
            noun,
            name: &wire.name.value,
            unit: wire.unit.as_ref(),
            target: *target,
            has_sigma,
        })
        .collect()
}
