//! Whether columns move, and whether the patch can hold what they hold.

use crate::data::document::{Document, Wire};
use crate::data::examine::{noise_of, wild};
use crate::data::experiment::Experiment;
use crate::data::record::Record;
use crate::statistics::descriptive::ends;
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, behind, told};
use patchcord_core::machines::REFERENCE;
use patchcord_expr::Unit;

/// The least and the largest of some samples, missing ones left out.
#[derive(Debug, Clone, Copy)]
struct Extent {
    least: f64,
    most: f64,
}

impl Extent {
    fn of<'r>(records: &'r [Record], samples: impl Fn(&'r Record) -> &'r [f64]) -> Extent {
        let [least, most] = ends(records.iter().flat_map(samples).copied());
        Extent { least, most }
    }

    fn moves(self) -> bool {
        self.most > self.least
    }

    /// The largest size.
    fn size(self) -> f64 {
        self.most.max(-self.least)
    }

    fn with(self, other: Extent) -> Extent {
        Extent { least: self.least.min(other.least), most: self.most.max(other.most) }
    }
}

/// A column of the experiment.
struct Column<'a> {
    wire: &'a Wire,
    /// What the patch calls it: a drive or a signal.
    noun: &'static str,
    per_volt: f64,
    unit: &'a Unit,
    trained: Extent,
    tested: Extent,
    /// Which share of its samples lies off the scale.
    off: f64,
}

/// A sample lies off the scale by more than so many times what the machine can hold;
const OFF: f64 = 1.05;
/// up to this share of them is let pass with a warning,
const FEW: f64 = 0.01;
/// but for those that no recorder of it can have read: so many times as much.
const ABSURD: f64 = 1000.0;
/// A column fills so much of its scale at least.
const FILLED: f64 = 1e-3;

/// Looks at every column of an experiment.
pub(crate) fn check(made: &Experiment, document: &Document, findings: &mut Findings) {
    let column = |(wire, noun), per_volt, unit, samples: &dyn for<'r> Fn(&'r Record) -> &'r [f64]| {
        let [trained, tested] = [&made.train, &made.test].map(|records| Extent::of(records, samples));
        let all = made.train.iter().chain(&made.test).flat_map(samples);
        let off = share(all, |sample| sample.abs() > OFF * REFERENCE * f64::abs(per_volt));
        Column { wire, noun, per_volt, unit, trained, tested, off }
    };
    let mut wires = document.wires();
    let drives = made.drives.iter().zip(wires.by_ref()).enumerate().map(|(index, (feed, wire))| {
        column(wire, feed.per_volt, &feed.unit, &|record| record.drives[index].as_slice())
    });
    let mut columns: Vec<Column<'_>> = drives.collect();
    let outputs = made.outputs.iter().zip(wires).enumerate().map(|(index, (output, wire))| {
        column(wire, output.per_volt, &output.unit, &|record| record.outputs[index].as_slice())
    });
    columns.extend(outputs);
    findings.extend(columns.iter().filter_map(|column| column.still().or_else(|| column.beside_scale())));
    findings.extend(unknown_noise(made, document));
    findings.extend(next_to_no_noise(made, document));
    findings.extend(wild_samples(made, document));
}

/// So many wild samples are told with their times.
const TOLD: usize = 3;

/// That samples of a column were let slip.
fn wild_samples(made: &Experiment, document: &Document) -> Vec<Diagnostic> {
    let drives = made.drives.len();
    let told = document.wires().enumerate().filter_map(|(place, (wire, _))| {
        let of = |record: &Record| {
            let samples = record.drives.get(place).unwrap_or_else(|| &record.outputs[place - drives]);
            let noise = noise_of(samples).map_or(0.0, |noise| noise.sigma);
            let (name, begin, interval) = (record.name.clone(), record.begin, record.interval);
            let found = wild(samples, noise).into_iter();
            found.map(move |sample| format!("{} s in {name}", told(begin + sample as f64 * interval)))
        };
        let all: Vec<String> = made.train.iter().chain(&made.test).flat_map(of).collect();
        let column = &wire.column;
        let more = if all.len() > TOLD { format!(", {} in all", all.len()) } else { String::new() };
        let times = all[..all.len().min(TOLD)].join(", ");
        let message =
            || format!("{} is far off what stands before and behind: at {times}{more}", column.value);
        (!all.is_empty()).then(|| Diagnostic::at(Code::WildSample, column.span, message()))
    });
    told.collect()
}

/// The noise of an output is no less than this share of its size: numbers are not told better.
const LEAST_TOLD: f64 = 1e-12;

/// That the experiment tells less noise of an output than numbers of its size can hold.
fn next_to_no_noise(made: &Experiment, document: &Document) -> Vec<Diagnostic> {
    let outputs = made.outputs.iter().zip(&document.outputs).enumerate();
    let told = outputs.filter_map(|(place, (output, wire))| {
        let sigma = output.sigma?;
        let size = Extent::of(&made.train, |record| record.outputs[place].as_slice()).size();
        let column = &wire.wire.column;
        let message = || {
            let (sigma, size, unit) = (told(sigma), told(size), behind(output.unit.text()));
            format!("the noise of {} is told as {sigma}{unit}, and it goes up to {size}{unit}", column.value)
        };
        let hint = "give the standard deviation of the noise, or leave \"sigma\" out: it is estimated then";
        (sigma < LEAST_TOLD * size)
            .then(|| Diagnostic::at(Code::BadNumber, column.span, message()).hint(hint))
    });
    told.collect()
}

/// That the experiment tells no noise of an output, and the data not either.
fn unknown_noise(made: &Experiment, document: &Document) -> Vec<Diagnostic> {
    let is_unknown = |place: usize| {
        let noise = |record: &Record| noise_of(&record.outputs[place]);
        made.outputs[place].sigma.is_none() && made.train.iter().all(|record| noise(record).is_none())
    };
    let outputs = document.outputs.iter().enumerate().filter(|(place, _)| is_unknown(*place));
    let told = outputs.map(|(_, output)| {
        let column = &output.wire.column;
        let message = format!("too few samples of {} follow one another to tell its noise by", column.value);
        let hint = "say how large it is: {\"column\": ..., \"sigma\": ...}";
        Diagnostic::at(Code::TooFewSamples, column.span, message).hint(hint)
    });
    told.collect()
}

impl Column<'_> {
    /// That it never moves, or not where it has to: a drive may rest in the test.
    fn still(&self) -> Option<Diagnostic> {
        let is_drive = self.noun == "drive";
        let warning = |message| Some(Diagnostic::at(Code::StillPart, self.wire.column.span, message));
        match [self.trained.moves(), self.tested.moves()] {
            _ if !self.trained.with(self.tested).moves() => Some(self.never_moves()),
            [false, _] if is_drive => warning(self.stands(self.trained, "train on")),
            [false, _] => {
                let message =
                    format!("{}: nothing can be fitted to it", self.stands(self.trained, "train on"));
                let own = Diagnostic::at(Code::ConstantColumn, self.wire.column.span, message);
                Some(own.hint("train on a part in which it moves, or leave it out"))
            }
            [true, false] if !is_drive => warning(self.stands(self.tested, "test on")),
            [true, _] => None,
        }
    }

    fn stands(&self, extent: Extent, part: &str) -> String {
        format!(
            "the column {} is {} throughout the part to {part}",
            self.wire.column.value,
            self.least(extent)
        )
    }

    fn least(&self, extent: Extent) -> String {
        format!("{}{}", told(extent.least), behind(self.unit.text()))
    }

    fn never_moves(&self) -> Diagnostic {
        let Wire { name, column, .. } = self.wire;
        let value = self.least(self.trained);
        let message = format!("the column {} never moves: it is {value} throughout", column.value);
        let hint = match self.noun {
            "drive" => format!(
                "name the column that was meant; if {} did stand still, leave it out and give it this value in the patch",
                name.value
            ),
            _ => "name the column that was meant, or leave it out: it tells nothing".to_owned(),
        };
        Diagnostic::at(Code::ConstantColumn, column.span, message).hint(hint)
    }

    /// That the machine cannot hold it, or that it fills next to nothing of its scale, as where its unit is another.
    fn beside_scale(&self) -> Option<Diagnostic> {
        let Wire { name, column, .. } = self.wire;
        let (most, full) = (self.trained.with(self.tested).size(), REFERENCE * self.per_volt.abs());
        let is_off = self.off > FEW || most > ABSURD * full;
        let (code, goes) = match most {
            most if most < FILLED * full => (Code::BelowScale, "is no larger than"),
            most if most <= full => return None,
            _ if is_off => (Code::OffScale, "goes up to"),
            _ => (Code::BeyondScale, "goes up to"),
        };
        let unit = behind(self.unit.text());
        let message = format!(
            "the column {} {goes} {}{unit}, and 100 V of the {} {} are {}{unit}",
            column.value,
            told(most),
            self.noun,
            name.value,
            told(full)
        );
        Some(Diagnostic::at(code, column.span, message))
    }
}

/// Which share of some samples is so; missing ones are not.
fn share<'r>(samples: impl Iterator<Item = &'r f64>, is_so: impl Fn(&f64) -> bool) -> f64 {
    let (so, others): (Vec<&f64>, Vec<&f64>) = samples.partition(|sample| is_so(sample));
    so.len() as f64 / (so.len() + others.len()).max(1) as f64
}
