//! Bringing a document, its patch and its data together.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::data::document::{Clock, Document, DriveWire, Held, Hold, OutputWire, Source, Wire};
use crate::data::drive_timing::{Going, RECORD_START, begun_anew, goings};
use crate::data::experiment::{Experiment, Feed, Output};
use crate::data::fittable::to_fit;
use crate::data::measured::{Measured, Wanted, plural};
use crate::data::parts::{Cutting, Part, Use, apart, in_both};
use crate::data::record::{LEAST_SAMPLES, Record};
use crate::data::subject::{Subject, Target};
use crate::data::{measured, motion};
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, Placed, Report, any_error, suggestion, told};
use patchcord_core::patch::Patch;
use patchcord_expr::Unit;

/// An experiment's document that is being held against patch and data.
pub(crate) struct Bringing<'a> {
    pub folder: &'a Path,
    pub document: &'a Document,
    pub findings: &'a mut Findings,
}

/// A record's file as it was read.
struct Read<'a> {
    /// Without links and detours, so that one file is known by whatever name.
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

    /// When the first and the last sample were taken and what lies between two, in the unit of its times.
    fn times(&self) -> [f64; 3] {
        let Measured { begin, interval, .. } = self.measured;
        [begin, begin + self.measured.duration(), interval].map(|seconds| seconds / self.seconds)
    }

    /// Whether both are the same samples.
    fn is_same(&self, other: &Read<'_>) -> bool {
        self.path == other.path && self.source.reads_as(other.source)
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
    /// Document, patch and data as one; of a wrong patch its report. Findings may have made it useless.
    pub fn together(mut self) -> Result<Experiment, Option<Box<Report>>> {
        let document = self.document;
        let subject = match &document.patch {
            Some(named) => Subject::read(self.folder, named, self.findings),
            None => Err(None),
        };
        self.check_twice();
        let found = subject.as_ref().ok();
        let drives: Vec<_> = document.drives.iter().map(|drive| self.feed(drive, found)).collect();
        let outputs: Vec<_> = document.outputs.iter().map(|output| self.output(output, found)).collect();
        // Data are looked at even where the patch is wrong.
        let ([train, test], seconds) = self.records(&drives, &outputs);
        let pieces = document.pieces.as_ref().zip(seconds).map(|(pieces, seconds)| pieces.value * seconds);
        self.check_pieces(pieces, &train, &test);
        let subject = subject?;
        self.check_fed(subject.patch(), [&train, &test]);
        self.check_clock(subject.patch());
        let fit =
            to_fit(subject.patch(), &|name| document.feeds(name), document.fit.as_deref(), self.findings);
        self.check_fitted(&fit);
        let made = Experiment {
            file: String::new(),
            title: document.title.clone(),
            patch: subject.patch().clone(),
            drives: drives.into_iter().flatten().collect(),
            outputs: outputs.into_iter().flatten().collect(),
            fit,
            train,
            test,
            files: self.paths(),
            pieces,
            warnings: Report::new("", "", Vec::new()),
        };
        if !any_error(self.findings) {
            motion::check(&made, document, self.findings);
        }
        if !any_error(self.findings) {
            self.check_still(&made.patch);
        }
        Ok(made)
    }

    /// Tells of outputs that the data feed, as they follow these whatever the patch does, and of columns that stand for two things.
    fn check_twice(&mut self) {
        let document = self.document;
        let wires: Vec<&Wire> = document.wires().map(|(wire, _)| wire).collect();
        let shared = wires.iter().enumerate().filter_map(|(place, wire)| {
            let is_other = |own: &&&Wire| own.name.value != wire.name.value;
            let first =
                wires[..place].iter().filter(is_other).find(|own| own.column.value == wire.column.value)?;
            let (column, first, name) = (&wire.column, &first.name.value, &wire.name.value);
            let message = format!("column {} stands for {first} and for {name}", column.value);
            Some(Diagnostic::at(Code::SharedColumn, column.span, message))
        });
        self.findings.extend(shared);
        let is_fed = |output: &&OutputWire| document.feeds(&output.wire.name.value);
        let found = document.outputs.iter().filter(is_fed).map(|output| {
            let Placed { value: name, span } = &output.wire.name;
            let message = format!("{name} is fed from the data: as an output it tells nothing of the patch");
            Diagnostic::at(Code::DuplicateName, *span, message).hint("take it out of the outputs")
        });
        self.findings.extend(found);
    }

    /// What is trained on, and what is tested on; and how many seconds the unit of their times has, where it is one.
    fn records(
        &mut self,
        drives: &[Option<Feed>],
        outputs: &[Option<Output>],
    ) -> ([Vec<Record>; 2], Option<f64>) {
        let document = self.document;
        let of_drives = drives.iter().map(|feed| feed.as_ref().map(|feed| &feed.unit));
        let of_outputs = outputs.iter().map(|output| output.as_ref().map(|output| &output.unit));
        let wanted = wanted(document, of_drives.chain(of_outputs));
        let trained = self.files(&document.data, &wanted);
        let tested = match &document.test {
            Held::Records(sources) => self.files(sources, &wanted),
            _ => Vec::new(),
        };
        let holds: Vec<Hold> = document.drives.iter().map(|drive| drive.hold).collect();
        self.check_ranges(&trained, &tested);
        let taken = self.parts(&trained, &tested);
        let records = [Use::Train, Use::Test].map(|used| {
            let of_use = taken.iter().filter(|taken| taken.part.used == used);
            of_use.map(|taken| Record::cut(&taken.read.measured, taken.part.places.clone(), &holds)).collect()
        });
        (records, self.seconds(trained.iter().chain(&tested)))
    }

    /// How many seconds the unit of the times of files has; pieces of files whose units differ are refused.
    fn seconds<'r>(&mut self, mut reads: impl Iterator<Item = &'r Read<'r>>) -> Option<f64> {
        let first = reads.next()?;
        let other = reads.find(|read| read.seconds != first.seconds);
        if let Some((pieces, other)) = self.document.pieces.as_ref().zip(other) {
            let [unit, others] = [first, other].map(|read| told(read.seconds));
            let message = format!(
                "\"pieces\" are told in the unit of the times, which is {unit} s in {} and {others} s in {}",
                first.measured.name, other.measured.name
            );
            let finding = Diagnostic::at(Code::UnitMismatch, pieces.span, message);
            self.findings.push(finding.hint("write the times of all files in one unit"));
            return None;
        }
        Some(first.seconds)
    }

    /// Tells of ranges that go on where the data have ended.
    fn check_ranges(&mut self, trained: &[Read<'_>], tested: &[Read<'_>]) {
        let test = match &self.document.test {
            Held::Part(range) => Some(range),
            _ => None,
        };
        // Of several records the shorter ones may end before.
        let of_all = self.document.train.iter().chain(test).map(|range| (range, trained));
        let of_one = trained
            .iter()
            .chain(tested)
            .filter_map(|read| Some((read.source.range.as_ref()?, std::slice::from_ref(read))));
        let found = of_all.chain(of_one).filter_map(|(range, reads)| beyond(range, reads));
        self.findings.extend(found.collect::<Vec<_>>());
    }

    /// A piece needs as many samples as a record does, and no record is cut into pieces that are longer than it.
    fn check_pieces(&mut self, pieces: Option<f64>, train: &[Record], test: &[Record]) {
        let Some((asked, seconds)) = self.document.pieces.as_ref().zip(pieces) else { return };
        let longest = train.iter().chain(test).map(Record::duration).fold(0.0, f64::max);
        if longest > 0.0 && seconds > longest {
            let message = format!(
                "pieces of {} s cut no record: none lasts longer than {} s",
                told(seconds),
                told(longest)
            );
            self.findings
                .push(Diagnostic::at(Code::BeyondData, asked.span, message).hint("leave \"pieces\" out"));
        }
        let least = |record: &Record| record.interval * LEAST_SAMPLES as f64;
        if let Some(record) = train.iter().chain(test).find(|record| seconds < least(record)) {
            let message = format!("a piece of {} has fewer than {LEAST_SAMPLES} samples", record.name);
            let hint = format!("they are taken every {} s", told(record.interval));
            self.findings.push(Diagnostic::at(Code::TooFewSamples, asked.span, message).hint(hint));
        }
    }

    /// Tells of drives that move as the patch has them, which begin with every record; where one begins later than they do, they
    /// would be wrong.
    fn check_fed(&mut self, patch: &Patch, records: [&[Record]; 2]) {
        let document = self.document;
        let own: Vec<&str> = begun_anew(patch, |name| document.feeds(name)).collect();
        // A drive that the patch has not is one by a wrong name.
        let is_told = document.drives.iter().all(|drive| patch.drives.contains_key(&drive.wire.name.value));
        let Some(named) = document.patch.as_ref().filter(|_| !own.is_empty() && is_told) else { return };
        let own = own.join(", ");
        let later = records.into_iter().flatten().find(|record| record.since > 0.0);
        let later = match document.pieces {
            Some(_) => Some("a piece".to_owned()),
            None => later.map(|record| format!("what {} has from {} s on", record.name, told(record.begin))),
        };
        let (code, does) = match later {
            Some(later) => {
                let wrong = format!("begins anew with every record, which would be wrong for {later}");
                (Code::DriveBeginsAnew, wrong)
            }
            None => (Code::UnfedDrives, "goes on as it is written".to_owned()),
        };
        let message = format!("no column feeds {own} of the patch: what moves there {does}");
        self.findings.push(Diagnostic::at(code, named.span, message));
    }

    /// Tells where the patch has the start of a record in another unit than a search sets it in.
    fn check_clock(&mut self, patch: &Patch) {
        let start = patch.parameters.get(RECORD_START).filter(|start| start.unit.text() != "s");
        let Some((named, start)) = self.document.patch.as_ref().zip(start) else { return };
        let message =
            format!("a search sets {RECORD_START} in s, and the patch has it in {}", start.unit.text());
        let finding = Diagnostic::at(Code::UnitMismatch, named.span, message);
        self.findings.push(finding.hint("give it the unit \"s\" in the patch"));
    }

    /// Tells where nothing drives the patch although it has drives.
    fn check_still(&mut self, patch: &Patch) {
        let document = self.document;
        let stand = goings(patch).all(|(_, going)| going == Going::Constant);
        let is_still = document.drives.is_empty() && !patch.drives.is_empty() && stand;
        let Some(named) = document.patch.as_ref().filter(|_| is_still) else { return };
        let drives: Vec<&str> = patch.drives.keys().map(String::as_str).collect();
        let message = format!("no column feeds {} of the patch: nothing moves there", drives.join(", "));
        self.findings.push(Diagnostic::at(Code::UnfedDrives, named.span, message));
    }

    /// Tells where nothing is fitted, and the experiment does not say so.
    fn check_fitted(&mut self, fit: &[String]) {
        let named = self.document.patch.as_ref().filter(|_| self.document.fit.is_none() && fit.is_empty());
        let message = "nothing is fitted: no parameter of the patch has a range, or none that it reads";
        self.findings.extend(named.map(|named| Diagnostic::at(Code::NothingToFit, named.span, message)));
    }

    fn feed(&mut self, drive: &DriveWire, subject: Option<&Subject>) -> Option<Feed> {
        let target = subject?.drive(&drive.wire, self.findings)?;
        let Target { name, unit, per_volt } = target;
        let sigma = drive.sigma.map(|sigma| of_unit(sigma, &drive.wire, &unit));
        let column = drive.wire.column.value.clone();
        Some(Feed { drive: name, column, hold: drive.hold, sigma, unit, per_volt })
    }

    fn output(&mut self, output: &OutputWire, subject: Option<&Subject>) -> Option<Output> {
        let Target { name, unit, per_volt } = subject?.signal(&output.wire, self.findings)?;
        let sigma = output.sigma.map(|sigma| of_unit(sigma, &output.wire, &unit));
        let column = output.wire.column.value.clone();
        Some(Output { signal: name, column, sigma, offset: output.offset, unit, per_volt })
    }

    /// The files of all records.
    fn paths(&self) -> Vec<PathBuf> {
        let tested = match &self.document.test {
            Held::Records(sources) => sources.as_slice(),
            _ => &[],
        };
        let sources = self.document.data.iter().chain(tested);
        sources.map(|source| self.folder.join(&source.file.value)).collect()
    }

    /// Reads the files of records.
    fn files(&mut self, sources: &'a [Source], wanted: &[Wanted<'_>]) -> Vec<Read<'a>> {
        let mut files = Vec::new();
        let Some(clock) = &self.document.clock else { return files };
        for source in sources {
            self.check_renamed(source, clock);
            let read = measured::read(self.folder, source, clock, wanted, self.findings);
            let path = self.folder.join(&source.file.value);
            let path = fs::canonicalize(&path).unwrap_or(path);
            files.extend(read.map(|(measured, seconds)| Read { path, source, measured, seconds }));
        }
        files
    }

    /// Refuses other names for columns that the experiment does not read.
    fn check_renamed(&mut self, source: &Source, clock: &Clock) {
        let known: Vec<_> = clock
            .column()
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
        [trained, tested].into_iter().for_each(|reads| self.check_once(reads));
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

    /// Tells of samples that a list has twice: they would count as more data than there are.
    fn check_once(&mut self, reads: &[Read<'_>]) {
        for (place, own) in reads.iter().enumerate() {
            let whole = own.cutting().whole();
            let others = reads[..place].iter().filter(|other| other.is_same(own));
            let shared = others.map(|other| in_both(&other.cutting().whole(), &whole)).max().unwrap_or(0);
            // Where one range ends and the next begins, they share a sample.
            if shared > 1 {
                let message = format!("{shared} samples of {} are listed twice", own.measured.name);
                let finding = Diagnostic::at(Code::SharedSamples, own.cutting().span, message);
                self.findings
                    .push(finding.hint("list them once: twice they count as more data than there are"));
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

/// A deviation told in the unit of a column, or in this unit where the experiment tells none.
fn of_unit(sigma: f64, wire: &Wire, unit: &Unit) -> f64 {
    let told_in = wire.unit.as_ref().map_or(unit, |told| &told.value);
    unit.out_of_si(told_in.to_si(sigma))
}

/// That a range goes on where the data of all these files have ended, by more than a sample; one that holds none of them is told
/// elsewhere.
fn beyond(range: &Placed<(f64, f64)>, reads: &[Read<'_>]) -> Option<Diagnostic> {
    let longest = reads.iter().max_by(|a, b| a.measured.duration().total_cmp(&b.measured.duration()))?;
    let (from, to) = range.value;
    let holds = |read: &Read<'_>| {
        let [begin, end, every] = read.times();
        from >= begin - every && to <= end + every
    };
    let [begin, end, _] = longest.times();
    let is_beside = from > end || to < begin;
    let message = || {
        let [from, to, begin, end] = [from, to, begin, end].map(told);
        format!("the range goes from {from} to {to}, and {} from {begin} to {end}", longest.measured.name)
    };
    (!is_beside && !reads.iter().any(holds)).then(|| Diagnostic::at(Code::BeyondData, range.span, message()))
}

/// What every column of the experiment is needed for.
fn wanted<'d>(document: &'d Document, targets: impl Iterator<Item = Option<&'d Unit>>) -> Vec<Wanted<'d>> {
    let sigmas = document
        .drives
        .iter()
        .map(|drive| drive.sigma.is_some())
        .chain(document.outputs.iter().map(|output| output.sigma.is_some()));
    let wanted = document.wires().zip(targets).zip(sigmas);
    wanted
        .map(|(((wire, noun), target), has_sigma)| Wanted {
            column: &wire.column,
            noun,
            name: &wire.name.value,
            unit: wire.unit.as_ref(),
            target,
            has_sigma,
        })
        .collect()
}
