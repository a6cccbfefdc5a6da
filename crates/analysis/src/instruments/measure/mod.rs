//! Measures: what an instrument reads off a run as one or a few numbers, asked for by a short text.

mod read;
mod table;

use super::Criterion;
use patchcord_core::document::suggestion;
use patchcord_core::ir::Probe;
use patchcord_core::trace::Trace;
use patchcord_expr::{Dimension, Unit};
use table::{Entry, Signals, TABLE, UnitOf};

/// An instrument connected to the signals that it reads.
///
/// Asked for by `NAME`, `NAME:SIGNAL` or `NAME:SIGNAL,OPTION=VALUE`: "peak:v_o",
/// "critical_velocity:threshold=0.5e-3". Of a trace of several runs the last is read.
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    entry: &'static Entry,
    /// Names and units of its signals.
    signals: Vec<(String, String)>,
    /// The values of the entry's options.
    options: Vec<Option<f64>>,
    /// What was asked for behind the name.
    asked: String,
}

/// A column that a measure fills.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Text of its unit; empty where it holds names.
    pub unit: String,
}

/// What a measure reads into a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A finite number, in the unit of the column.
    Number(f64),
    /// The name of an element, or "none".
    Name(String),
    /// Nothing, because there is nothing to read: the time of an overload that did not happen.
    Empty,
}

/// Why there is no such measure.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// No instrument has this name.
    #[error("there is no measure \"{name}\"; {hint}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// What may have been meant.
        hint: String,
    },
    /// A signal does not exist.
    #[error("{measure} reads the signal \"{signal}\", which the patch does not have; {hint}")]
    UnknownSignal {
        /// The measure.
        measure: &'static str,
        /// The signal.
        signal: String,
        /// What may have been meant.
        hint: String,
    },
    /// It was not told which signals to read, or too many.
    #[error("{measure} reads {wanted}: write {measure}{example}")]
    Signals {
        /// The measure.
        measure: &'static str,
        /// How many it reads, in words.
        wanted: &'static str,
        /// How to write them.
        example: &'static str,
    },
    /// It has no such option.
    #[error("{measure} has no option \"{option}\"; {hint}")]
    UnknownOption {
        /// The measure.
        measure: &'static str,
        /// The option.
        option: String,
        /// Those that it has.
        hint: String,
    },
    /// An option is not a number above 0.
    #[error("\"{option}\" of {measure} must be a number above 0, not \"{value}\"")]
    BadOption {
        /// The measure.
        measure: &'static str,
        /// The option.
        option: &'static str,
        /// What was given.
        value: String,
    },
    /// Two signals that are compared are not in the same unit.
    #[error("{measure} compares {first} and {second}, which are not in the same unit")]
    Units {
        /// The measure.
        measure: &'static str,
        /// One signal with its unit.
        first: String,
        /// The other.
        second: String,
    },
    /// A signal is not what it is read as.
    #[error("{measure} reads {signal} as a {wanted}, which it is not")]
    Quantity {
        /// The measure.
        measure: &'static str,
        /// The signal with its unit.
        signal: String,
        /// What it would have to be.
        wanted: &'static str,
    },
    /// The usual threshold is a velocity, and the signals are none.
    #[error("{measure} needs a threshold for signals in {unit}: write threshold=VALUE behind them")]
    NoThreshold {
        /// The measure.
        measure: &'static str,
        /// The unit.
        unit: String,
    },
}

/// Every measure: how it is written, and what it reads.
pub fn measures() -> impl Iterator<Item = (String, &'static str)> {
    TABLE.iter().map(|entry| (entry.written(), entry.meaning))
}

impl Measure {
    /// Reads what is asked for, of a program with these signals.
    ///
    /// # Errors
    /// When there is no such measure, signal or option.
    pub fn parse(text: &str, signals: &[Probe]) -> Result<Measure, MeasureError> {
        let (name, asked) = text.trim().split_once(':').unwrap_or((text.trim(), ""));
        let entry = TABLE.iter().find(|entry| entry.name == name).ok_or_else(|| {
            let known: Vec<_> = TABLE.iter().map(|entry| entry.name).collect();
            let hint = suggestion(name, &known).unwrap_or_default();
            MeasureError::Unknown { name: name.to_owned(), hint }
        })?;
        let words = || asked.split(',').map(str::trim).filter(|word| !word.is_empty());
        let options = words().filter_map(|word| word.split_once('='));
        let named: Vec<&str> = words().filter(|word| !word.contains('=')).collect();
        let measure = Measure {
            entry,
            signals: entry.connected(&named, signals)?,
            options: entry.set(options)?,
            asked: words().collect::<Vec<_>>().join(","),
        };
        measure.checked()
    }

    fn checked(mut self) -> Result<Self, MeasureError> {
        let measure = self.entry.name;
        let [(first, unit), (second, other)] = self.signals.as_slice() else { return Ok(self) };
        match self.entry.signals {
            Signals::VelocityAndForce(_) => {
                is_in(measure, first, unit, "velocity", Dimension::LENGTH.over(Dimension::TIME))?;
                is_in(measure, second, other, "force", Dimension::FORCE)?;
            }
            _ if unit != other => {
                let told = |name: &str, unit: &str| format!("{name} in {unit}");
                return Err(MeasureError::Units {
                    measure,
                    first: told(first, unit),
                    second: told(second, other),
                });
            }
            _ => (),
        }
        if self.options[0].is_none() {
            let usual = Criterion::usual(unit).map(|usual| usual.threshold);
            let unit = unit.clone();
            self.options[0] = Some(usual.ok_or(MeasureError::NoThreshold { measure, unit })?);
        }
        Ok(self)
    }

    /// What it was asked for as, without blanks.
    pub fn text(&self) -> String {
        let colon = if self.asked.is_empty() { "" } else { ":" };
        format!("{}{colon}{}", self.entry.name, self.asked)
    }

    /// The columns that it fills.
    pub fn columns(&self) -> Vec<Column> {
        let colon = if self.asked.is_empty() { "" } else { ":" };
        let columns = self.entry.columns.iter().map(|(suffix, unit)| Column {
            name: format!("{}{suffix}{colon}{}", self.entry.name, self.asked),
            unit: match unit {
                UnitOf::Signal => self.signals[0].1.clone(),
                UnitOf::Text(text) => (*text).to_owned(),
            },
        });
        columns.collect()
    }

    /// The signals that a run has to record for it.
    pub fn signals(&self) -> impl Iterator<Item = &str> {
        self.signals.iter().map(|(name, _)| name.as_str())
    }

    /// Whether it reads the samples, of which no two may stand at one instant.
    pub(crate) fn is_sampled(&self) -> bool {
        self.entry.is_sampled
    }

    /// What it reads off a run, a cell a column, or why it reads nothing.
    pub fn read(&self, trace: &Trace) -> Vec<Result<Cell, String>> {
        let cells = (self.entry.read)(&read::Run::last(trace, self));
        let finite = |cell: Cell| match cell {
            Cell::Number(number) if !number.is_finite() => Err(format!("it comes to {number}")),
            cell => Ok(cell),
        };
        cells.into_iter().map(|cell| cell.and_then(finite)).collect()
    }

    /// The value of an option of the entry, in its order.
    fn option(&self, index: usize) -> Option<f64> {
        self.options[index]
    }
}

/// That a signal is what a measure reads.
fn is_in(
    measure: &'static str,
    signal: &str,
    unit: &str,
    wanted: &'static str,
    dimension: Dimension,
) -> Result<(), MeasureError> {
    match Unit::parse(unit) {
        Ok(parsed) if parsed.dimension() == dimension => Ok(()),
        _ => Err(MeasureError::Quantity { measure, signal: format!("{signal} in {unit}"), wanted }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::circuit::Circuit;
    use patchcord_core::ir::Program;
    use patchcord_core::patch::Patch;

    fn parse(text: &str) -> Result<Measure, MeasureError> {
        let patch = Patch::read("../../patches/thesis/fig-8-16.json".as_ref()).unwrap();
        Measure::parse(text, Program::new(&Circuit::new(&patch, &[]).unwrap()).unwrap().signals())
    }

    fn columns(text: &str) -> Vec<(String, String)> {
        parse(text).unwrap().columns().into_iter().map(|column| (column.name, column.unit)).collect()
    }

    fn told(name: &str, unit: &str) -> (String, String) {
        (name.to_owned(), unit.to_owned())
    }

    #[test]
    fn columns_are_named_by_what_is_asked_for() {
        assert_eq!(columns("peak:v_o"), [told("peak:v_o", "m/s")]);
        assert_eq!(columns(" frequency: x_error, last=0.5 "), [told("frequency:x_error,last=0.5", "Hz")]);
        let [rising, falling] =
            ["critical_velocity_rising", "critical_velocity_falling"].map(|name| told(name, "m/s"));
        assert_eq!(columns("critical_velocity"), [rising, falling]);
        assert_eq!(columns("profile:standstill=1e-5")[4], told("profile_5:standstill=1e-5", "m/s"));
        assert_eq!(
            columns("friction_loop"),
            [told("friction_loop_area", "W"), told("friction_loop_work", "J")]
        );
        assert_eq!(columns("overload"), [told("overload", ""), told("overload_time", "s")]);
    }

    #[test]
    fn what_cannot_be_measured_is_told_with_what_could() {
        let cases = [
            ("peek:v_o", "there is no measure \"peek\"; did you mean \"peak\"?"),
            ("", "there is no measure \"\"; known here: voltmeter, "),
            ("peak", "peak reads one signal: write peak:SIGNAL"),
            ("overload:v_o", "overload reads no signal: write overload"),
            ("peak:v_o,v_i", "peak reads one signal: write peak:SIGNAL"),
            ("peak:v_p", "peak reads the signal \"v_p\", which the patch does not have; did you mean \"v_"),
            ("peak:v_o,last=2", "peak has no option \"last\"; it has none"),
            ("amplitude:v_o,lst=2", "amplitude has no option \"lst\"; did you mean \"last\"?"),
            ("amplitude:v_o,last=-2", "\"last\" of amplitude must be a number above 0, not \"-2\""),
            ("critical_velocity:v_i", "critical_velocity reads two signals, the commanded"),
            (
                "friction_loop:v_o",
                "friction_loop reads two signals, a velocity and a force: write friction_loop:v_o,",
            ),
            (
                "friction_loop:x_error,spring_force",
                "friction_loop reads x_error in m as a velocity, which it is not",
            ),
            ("friction_loop:v_o,v_i", "friction_loop reads v_i in m/s as a force, which it is not"),
            ("profile:standstill=0", "\"standstill\" of profile must be a number above 0"),
            ("critical_velocity:v_i,x_error", "critical_velocity compares v_i in m/s and x_error in m"),
            ("critical_velocity:x_error,x_error", "critical_velocity needs a threshold for signals in m"),
        ];
        for (text, expected) in cases {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.starts_with(expected) && !error.ends_with(':'), "{text}: {error}");
        }
    }
}
