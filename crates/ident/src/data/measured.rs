//! A file of measured data: its columns in the units of the patch, its rows at even times.

use std::ops::Range;
use std::path::Path;

use crate::data::document::{Clock, Source};
use crate::statistics::descriptive::median;
use patchcord_core::document::csv_rows::{Asked, Fault, Rows};
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, Placed, Span, csv_rows, told};
use patchcord_core::patch::{no_unit, order_hint};
use patchcord_expr::Unit;

/// A column that is read, as the experiment and the patch have it.
pub(crate) struct Wanted<'a> {
    pub column: &'a Placed<String>,
    /// What the patch has there: a drive or a signal.
    pub noun: &'static str,
    pub name: &'a str,
    /// The unit that the experiment tells.
    pub unit: Option<&'a Placed<Unit>>,
    /// The unit that is needed; `None` where the patch is wrong.
    pub target: Option<&'a Unit>,
    /// Whether the experiment tells a noise in the unit of the column.
    pub has_sigma: bool,
}

/// What a file holds.
#[derive(Debug)]
pub(crate) struct Measured {
    pub name: String,
    /// Seconds.
    pub begin: f64,
    pub interval: f64,
    /// The largest deviation from even times, in intervals.
    pub jitter: f64,
    /// At which of the even times each row stands.
    pub places: Vec<usize>,
    /// The numbers of every column asked for, row by row.
    pub columns: Vec<Vec<f64>>,
}

impl Measured {
    /// When a sample of the even times was taken, in seconds.
    pub fn time(&self, place: usize) -> f64 {
        self.begin + place as f64 * self.interval
    }

    /// Seconds from the first of the even times to the last.
    pub fn duration(&self) -> f64 {
        self.interval * self.len().saturating_sub(1) as f64
    }

    /// The number of even times.
    pub fn len(&self) -> usize {
        self.places.last().map_or(0, |last| last + 1)
    }

    /// The even times from one instant to another, both counted in.
    pub fn within(&self, (from, to): (f64, f64)) -> Range<usize> {
        // Times written with few digits are not to miss the end of a range.
        let slack = MOST_JITTER * self.interval;
        let place = |time: f64| ((time - self.begin) / self.interval).clamp(-1.0, self.len() as f64);
        let first = place(from - slack).ceil().max(0.0) as usize;
        let end = (place(to + slack).floor() + 1.0).max(0.0) as usize;
        first..end.min(self.len()).max(first)
    }

    /// The rows at a stretch of the even times.
    pub fn rows_in(&self, places: &Range<usize>) -> Range<usize> {
        let before = |limit: usize| self.places.partition_point(|place| *place < limit);
        before(places.start)..before(places.end)
    }
}

/// A sample may be taken so far off its even time, in intervals: as far as times are rounded that are written with few digits.
const MOST_JITTER: f64 = 0.05;

/// The even times of a record are no more than so many times its rows.
const MOST_SPARSE: usize = 4;

/// Reads a file.
pub(crate) fn read(
    folder: &Path,
    source: &Source,
    clock: &Clock,
    wanted: &[Wanted<'_>],
    findings: &mut Findings,
) -> Option<(Measured, f64)> {
    Reading { path: &folder.join(&source.file.value), source, clock, wanted }.carried_out(findings)
}

/// A file that is being read.
struct Reading<'a> {
    path: &'a Path,
    source: &'a Source,
    clock: &'a Clock,
    wanted: &'a [Wanted<'a>],
}

impl Reading<'_> {
    /// What the file holds, and the seconds of the unit in which its times are told.
    fn carried_out(&self, findings: &mut Findings) -> Option<(Measured, f64)> {
        let mut rows = match csv_rows::read(self.path, &self.asked()) {
            Ok(rows) => rows,
            Err(faults) => {
                self.check_times(findings);
                findings.extend(faults.into_iter().map(|fault| self.told(Code::BadData, fault)));
                return None;
            }
        };
        if rows.lines.len() < 2 {
            let message =
                format!("{} holds {} of data", self.path.display(), plural(rows.lines.len(), "line"));
            findings.push(Diagnostic::at(Code::TooFewSamples, self.source.file.span, message));
            return None;
        }
        let seconds = self.seconds(&rows, findings);
        let is_right = self.convert(&mut rows, findings);
        let grid = self.grid(&rows, seconds?).map_err(|finding| findings.push(finding)).ok()?;
        findings.extend(self.gaps(&grid, &rows.lines, seconds?));
        rows.columns.drain(..self.clock_columns());
        let measured = Measured {
            name: self.name(),
            begin: grid.begin,
            interval: grid.interval,
            jitter: grid.jitter,
            places: grid.places,
            columns: rows.columns,
        };
        is_right.then_some((measured, seconds?))
    }

    /// Tells what is wrong with the times of a file whose other columns may be what cannot be read.
    fn check_times(&self, findings: &mut Findings) {
        let Ok(times) = csv_rows::read(self.path, &self.asked()[..self.clock_columns()]) else { return };
        let Some(seconds) = self.seconds(&times, findings) else { return };
        findings.extend(self.grid(&times, seconds).err());
    }

    /// The file, and the names that its columns have for others.
    fn name(&self) -> String {
        let others: Vec<_> = self.source.columns.iter().map(|(_, here)| here.value.as_str()).collect();
        let file = &self.source.file.value;
        if others.is_empty() { file.clone() } else { format!("{file} ({})", others.join(", ")) }
    }

    fn clock_columns(&self) -> usize {
        usize::from(self.clock.column().is_some())
    }

    /// The columns to read: first that of the times, if there is one.
    fn asked(&self) -> Vec<Asked<'_>> {
        let wanted = self.wanted.iter().map(|wanted| wanted.column.value.as_str());
        let columns = self.clock.column().into_iter().chain(wanted);
        columns.map(|column| Asked::Named(self.source.here(column))).collect()
    }

    /// Where the experiment asks for one of the columns that are read.
    fn span(&self, column: usize) -> Span {
        let wanted = column.checked_sub(self.clock_columns()).and_then(|place| self.wanted.get(place));
        let asked = match (wanted, self.clock) {
            (Some(wanted), _) => Some(wanted.column),
            (None, Clock::Column { name, .. }) => Some(name),
            (None, _) => None,
        };
        let column = asked.map_or(self.clock.column(), |asked| Some(asked.value.as_str()));
        let renamed = column.and_then(|column| self.source.renamed(column));
        renamed.or(asked).map_or(self.source.file.span, |name| name.span)
    }

    fn told(&self, code: Code, fault: Fault) -> Diagnostic {
        let span = fault.column.map_or(self.source.file.span, |column| self.span(column));
        let is_unnamed = matches!(self.clock, Clock::Usual) && fault.column == Some(0);
        let more = if is_unnamed { "; \"time\": \"...\" tells which column has the times" } else { "" };
        Diagnostic::at(code, span, fault.message).hint(fault.hint + more)
    }

    /// The unit that a comment of the file tells for a column; `None` where it cannot be read.
    fn commented(&self, rows: &Rows, column: usize, findings: &mut Findings) -> Option<Option<Unit>> {
        let Some(comment) = &rows.units[column] else { return Some(None) };
        let unit = Unit::parse(&comment.text).ok().filter(|_| !comment.text.trim().is_empty());
        if unit.is_none() {
            let fault = no_unit(&rows.names[column], comment, self.path, column);
            findings.push(self.told(Code::UnknownUnit, fault));
        }
        unit.map(Some)
    }

    /// The unit of a column: that of the file or that of the experiment, which must not differ.
    fn unit(
        &self,
        rows: &Rows,
        column: usize,
        told: Option<&Placed<Unit>>,
        findings: &mut Findings,
    ) -> Option<Option<Unit>> {
        let commented = self.commented(rows, column, findings)?;
        let (Some(in_file), Some(told)) = (&commented, told) else {
            return Some(commented.or_else(|| told.map(|unit| unit.value.clone())));
        };
        if !is_same(in_file, &told.value) {
            let message = format!(
                "{} tells {in_file} as the unit of the column {}, and the experiment {}",
                self.path.display(),
                rows.names[column],
                told.value
            );
            let hint = "correct the one that is wrong, or take it away";
            findings.push(Diagnostic::at(Code::UnitMismatch, told.span, message).hint(hint));
            return None;
        }
        Some(commented)
    }

    /// The seconds of the unit of the times.
    fn seconds(&self, rows: &Rows, findings: &mut Findings) -> Option<f64> {
        match self.clock {
            Clock::Even { unit, .. } => Some(*unit),
            _ => {
                let told = match self.clock {
                    Clock::Column { unit, .. } => unit.as_ref(),
                    _ => None,
                };
                let unit = self.unit(rows, 0, told, findings)?;
                let second = Unit::parse("s").ok()?;
                let unit = unit.unwrap_or_else(|| second.clone());
                let is_time = unit.dimension() == second.dimension();
                if !is_time {
                    let message = format!(
                        "the column {} of {} is in {unit}, and times are needed",
                        rows.names[0],
                        self.path.display()
                    );
                    let hint = "name the column of the times as \"time\"";
                    findings.push(Diagnostic::at(Code::UnitMismatch, self.span(0), message).hint(hint));
                }
                is_time.then(|| unit.factor())
            }
        }
    }

    /// Puts every column into the unit of the patch; whether that can be done.
    fn convert(&self, rows: &mut Rows, findings: &mut Findings) -> bool {
        let reported = findings.len();
        for (place, wanted) in self.wanted.iter().enumerate() {
            let column = self.clock_columns() + place;
            let Some(Some(unit)) = self.unit(rows, column, wanted.unit, findings) else { continue };
            let Some(target) = wanted.target else { continue };
            if unit.dimension() != target.dimension() {
                findings.push(self.other_unit(rows, column, wanted, &unit, target));
            } else if !is_same(&unit, target) {
                if wanted.has_sigma && wanted.unit.is_none() {
                    findings.push(self.whose_sigma(wanted, &unit, target));
                }
                rows.columns[column]
                    .iter_mut()
                    .for_each(|number| *number = target.out_of_si(unit.to_si(*number)));
                findings.extend(self.too_large(rows, column, target));
            }
        }
        findings.len() == reported
    }

    /// That a number is too large once it is in the unit of the patch.
    fn too_large(&self, rows: &Rows, column: usize, target: &Unit) -> Option<Diagnostic> {
        let row = rows.columns[column].iter().position(|number| !number.is_finite())?;
        let message = format!(
            "line {} of {} is too large to hold in {target}, in the column {}",
            rows.lines[row],
            self.path.display(),
            rows.names[column]
        );
        Some(Diagnostic::at(Code::NotFinite, self.span(column), message))
    }

    fn other_unit(
        &self,
        rows: &Rows,
        column: usize,
        wanted: &Wanted<'_>,
        unit: &Unit,
        target: &Unit,
    ) -> Diagnostic {
        let message = format!(
            "the column {} of {} is in {unit}, and the {} {} of the patch in {target}",
            rows.names[column],
            self.path.display(),
            wanted.noun,
            wanted.name
        );
        let span = wanted.unit.map_or_else(|| self.span(column), |unit| unit.span);
        let hint = format!("name another column, or another {}", wanted.noun);
        Diagnostic::at(Code::UnitMismatch, span, message).hint(hint)
    }

    /// The file has another unit than the patch, and nobody says in which of them the noise is told.
    fn whose_sigma(&self, wanted: &Wanted<'_>, unit: &Unit, target: &Unit) -> Diagnostic {
        let message = format!(
            "the \"sigma\" of {} may be in {unit}, as {} tells its column, or in {target}, as the patch has it",
            wanted.name,
            self.path.display()
        );
        let hint = format!("write \"unit\": \"{unit}\" beside \"sigma\", and \"sigma\" in this unit");
        Diagnostic::at(Code::UnitMismatch, wanted.column.span, message).hint(hint)
    }

    /// The even times on which the rows stand.
    fn grid(&self, rows: &Rows, seconds: f64) -> Result<Grid, Diagnostic> {
        match self.clock {
            Clock::Even { seconds, .. } => Ok(Grid {
                begin: 0.0,
                interval: *seconds,
                jitter: 0.0,
                places: (0..rows.lines.len()).collect(),
            }),
            _ => {
                self.check_order(rows)?;
                let times: Vec<f64> = rows.columns[0].iter().map(|time| time * seconds).collect();
                Grid::of(&times).ok_or_else(|| self.uneven(&times, &rows.lines))
            }
        }
    }

    fn check_order(&self, rows: &Rows) -> Result<(), Diagnostic> {
        let times = &rows.columns[0];
        let Some(row) = (1..times.len()).find(|row| times[*row] <= times[row - 1]) else { return Ok(()) };
        let (before, time) = (told(times[row - 1]), told(times[row]));
        let what = if times[row] == times[row - 1] {
            format!("stands still at {time}")
        } else {
            format!("goes back from {before} to {time}")
        };
        let message = format!(
            "line {} of {}: time {what}, in the column {}",
            rows.lines[row],
            self.path.display(),
            rows.names[0]
        );
        let sort = "sort the rows by time, and keep one of those that share it";
        let hint = order_hint(rows).unwrap_or(sort);
        Err(Diagnostic::at(Code::BadData, self.source.file.span, message).hint(hint))
    }

    fn uneven(&self, times: &[f64], lines: &[usize]) -> Diagnostic {
        let intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let by_length = |a: &usize, b: &usize| intervals[*a].total_cmp(&intervals[*b]);
        let [least, most] = [(0..intervals.len()).min_by(by_length), (0..intervals.len()).max_by(by_length)]
            .map(|row| {
                let row = row.unwrap_or_default();
                format!("{} s (in front of line {})", told(intervals[row]), lines[row + 1])
            });
        let message = format!(
            "the samples of {} are not evenly spaced: {least} to {most}, mostly {} s",
            self.path.display(),
            told(median(&intervals))
        );
        Diagnostic::at(Code::UnevenSampling, self.source.file.span, message)
    }

    /// Tells the rows that are missing where the file is of interest.
    fn gaps(&self, grid: &Grid, lines: &[usize], seconds: f64) -> Option<Diagnostic> {
        let gap = |row: &usize| grid.places[*row] - grid.places[row - 1] - 1;
        // What lies round a gap is all of interest, or the gap is of none.
        let is_within = |row: &usize| {
            let time = |place: f64| (grid.begin + place * grid.interval) / seconds;
            let [from, to] = [grid.places[row - 1] as f64 + 0.5, grid.places[*row] as f64 - 0.5].map(time);
            self.source.range.as_ref().is_none_or(|range| range.value.0 < from && to < range.value.1)
        };
        let gaps: Vec<usize> = (1..grid.places.len()).filter(|row| gap(row) > 0 && is_within(row)).collect();
        let missing: usize = gaps.iter().map(gap).sum();
        let widest = *gaps.iter().max_by_key(|row| (gap(row), usize::MAX - **row))?;
        let message = || {
            format!(
                "{} missing in {}, in {}; most of them ({}) in front of line {}: drives go on there from what stands before",
                if missing == 1 { "1 row is".to_owned() } else { format!("{missing} rows are") },
                self.path.display(),
                plural(gaps.len(), "place"),
                gap(&widest),
                lines[widest]
            )
        };
        let finding = Diagnostic::at(Code::SamplingGap, self.source.file.span, message());
        Some(if gap(&widest) < HOLE { finding } else { finding.hint(AS_RECORDS) })
    }
}

/// Through so many rows that are missing no drive is believed to go as it is made up.
const HOLE: usize = 10;
const AS_RECORDS: &str = "list what lies before and behind as two records of this file, each with its \"range\": what drives do in between is made up otherwise, and may look like a force";

/// "1 row", "2 rows".
pub(crate) fn plural(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

fn is_same(unit: &Unit, other: &Unit) -> bool {
    unit.dimension() == other.dimension() && unit.factor() == other.factor()
}

/// Even times, and at which of them the rows of a file stand.
struct Grid {
    begin: f64,
    interval: f64,
    jitter: f64,
    places: Vec<usize>,
}

impl Grid {
    /// The even times that rising times stand on, some left out; `None` where there are none.
    fn of(times: &[f64]) -> Option<Grid> {
        let intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let middle = median(&intervals);
        let (usual, count) = intervals
            .iter()
            .filter(|interval| (**interval / middle).round() == 1.0)
            .fold((0.0, 0.0), |(sum, count), interval| (sum + interval, count + 1.0));
        let usual = usual / count;
        let mut places = vec![0];
        for interval in &intervals {
            let steps = (interval / usual).round();
            if !(1.0..=times.len() as f64 * MOST_SPARSE as f64).contains(&steps) {
                return None;
            }
            places.push(places[places.len() - 1] + steps as usize);
        }
        let (begin, last) = (*times.first()?, *places.last()?);
        if last > MOST_SPARSE * times.len() {
            return None;
        }
        let interval = (times.last()? - begin) / last as f64;
        let off = |(time, place): (&f64, &usize)| ((time - begin) / interval - *place as f64).abs();
        let jitter = times.iter().zip(&places).map(off).fold(0.0, f64::max);
        (jitter <= MOST_JITTER).then_some(Grid { begin, interval, jitter, places })
    }
}
