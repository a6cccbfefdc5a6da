//! Measures: an instrument reads one or a few numbers off a run and is requested by a short text.
//!
//! `table` lists the measures with their names, signals, options and columns. `read` holds the function of each one.
//! Sweeps use measures to fill the columns of their CSV file.

mod read;
mod table;

use super::Criterion;
use patchcord_core::document::{TypedNumberError, suggestion};
use patchcord_core::ir::SignalInfo;
use patchcord_core::trace::Trace;
use patchcord_expr::{Dimension, Unit};
use table::{ColumnUnit, MeasureDefinition, MeasureInputs, TABLE};

/// An instrument connected to the signals that it reads.
///
/// It is requested by `NAME`, `NAME:SIGNAL` or `NAME:SIGNAL,OPTION=VALUE`. [`measures`] lists the names, signals and
/// options. A value without a unit is in seconds or in the unit of the first signal. If a trace has several runs, the
/// measure reads the last one.
///
/// # Examples
///
/// One request of each family, and the columns that it fills:
///
/// ```
/// use patchcord_analysis::instruments::Measure;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::Patch;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let patch = Patch::read("../../patches/thesis/fig-8-16.json")?;
/// let program = Program::new(&Circuit::new(&patch)?)?;
/// let columns = |request: &str| -> Result<Vec<String>, Box<dyn std::error::Error>> {
///     let columns = Measure::parse(request, program.signals())?.columns();
///     Ok(columns.into_iter().map(|column| format!("{} in {}", column.name, column.unit)).collect())
/// };
///
/// // Values of one signal: voltmeter, peak, least, most
/// assert_eq!(columns("peak:x_error")?, ["peak:x_error in m"]);
/// // A sustained oscillation: amplitude, frequency
/// assert_eq!(columns("frequency:v_o,last=0.5")?, ["frequency:v_o,last=0.5 in Hz"]);
/// // Critical velocities: critical_velocity, critical_velocity_range, first_oscillation
/// let both = ["critical_velocity_rising:threshold=5e-4 in m/s", "critical_velocity_falling:threshold=5e-4 in m/s"];
/// assert_eq!(columns("critical_velocity:threshold=5e-4")?, both);
/// // The five points of a velocity profile: profile, profile_falling
/// assert_eq!(columns("profile")?[0], "profile_1 in m/s");
/// // The loop of force against velocity
/// assert_eq!(columns("friction_loop:v_o,spring_force")?[1], "friction_loop_work:v_o,spring_force in J");
/// // Times: stick_end, overload
/// assert_eq!(columns("stick_end")?, ["stick_end in s"]);
/// assert_eq!(columns("overload")?, ["overload in ", "overload_time in s"]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    /// The row of the table of measures.
    definition: &'static MeasureDefinition,
    /// Names and units of the signals, in the order of the definition.
    signals: Vec<(String, String)>,
    /// The values of the options, in the order of the definition. None if an option is not given.
    options: Vec<Option<f64>>,
    /// The text after the colon, without blanks.
    arguments: String,
}

/// A column that a measure fills.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasureColumn {
    /// The name in the header, such as "peak:v_o".
    pub name: String,
    /// The unit as text; empty for a column of names.
    pub unit: String,
}

/// What a column may contain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ColumnContent {
    /// A number. A cell without one has a reason.
    Number,
    /// A number, or nothing if nothing happened.
    OptionalNumber,
    /// The name of an element, or "none".
    Name,
}

/// The value of a measure in one column.
#[derive(Debug, Clone, PartialEq)]
pub enum MeasureValue {
    /// A finite number, in the unit of the column.
    Number(f64),
    /// The name of an element, or "none".
    Name(String),
    /// No value, such as the time of an overload that did not happen.
    Empty,
}

/// Why a measure cannot be connected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// There is no measure with this name.
    #[error("there is no measure \"{name}\"; {hint}")]
    Unknown {
        /// The requested name.
        name: String,
        /// A similar name, or all names.
        hint: String,
    },
    /// The patch has no signal with this name.
    #[error("{measure} needs the signal \"{signal}\", which the patch does not have; {hint}")]
    UnknownSignal {
        /// Name of the measure.
        measure: &'static str,
        /// The requested signal.
        signal: String,
        /// A similar name, or all names.
        hint: String,
    },
    /// The number of signals is wrong.
    #[error("{measure} reads {wanted}: write {measure}{example}")]
    WrongSignals {
        /// Name of the measure.
        measure: &'static str,
        /// Number and kind of its signals, in words.
        wanted: &'static str,
        /// How to specify them, from the colon on.
        example: &'static str,
    },
    /// The measure has no option with this name.
    #[error("{measure} has no option \"{option}\"; {hint}")]
    UnknownOption {
        /// Name of the measure.
        measure: &'static str,
        /// The requested option.
        option: String,
        /// A similar option, or all options.
        hint: String,
    },
    /// The value of an option is not a number in the unit of the option.
    #[error("the value of \"{option}\" of {measure}: {reason}")]
    OptionValue {
        /// Name of the measure.
        measure: &'static str,
        /// Name of the option.
        option: &'static str,
        /// What is wrong with the value.
        reason: Box<TypedNumberError>,
    },
    /// The value of an option is not a positive number.
    #[error("\"{option}\" of {measure} must be a positive number, got \"{value}\"")]
    BadOption {
        /// Name of the measure.
        measure: &'static str,
        /// Name of the option.
        option: &'static str,
        /// The text that was given.
        value: String,
    },
    /// The two signals of the measure have different units.
    #[error("{measure} compares {first} and {second}: they must have the same unit")]
    UnequalUnits {
        /// Name of the measure.
        measure: &'static str,
        /// The first signal with its unit.
        first: String,
        /// The second signal with its unit.
        second: String,
    },
    /// A signal has the wrong dimension.
    #[error("{measure} needs a {wanted}, but {signal} is none")]
    WrongDimension {
        /// Name of the measure.
        measure: &'static str,
        /// The signal with its unit.
        signal: String,
        /// The quantity that is needed, such as "velocity".
        wanted: &'static str,
    },
    /// The signals are not velocities, so there is no default threshold.
    #[error("{measure} has no default threshold for signals in {unit}: add threshold=VALUE")]
    NoThreshold {
        /// Name of the measure.
        measure: &'static str,
        /// The unit of the signals.
        unit: String,
    },
}

/// The syntax and the meaning of every measure.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::measures;
///
/// let (syntax, meaning) = measures().next().unwrap_or_default();
/// assert_eq!((syntax.as_str(), meaning), ("voltmeter:SIGNAL", "the value at the end of the run"));
/// ```
pub fn measures() -> impl Iterator<Item = (String, &'static str)> {
    TABLE.iter().map(|definition| (definition.syntax(), definition.meaning))
}

impl Measure {
    /// Parses a request such as "peak:v_o" for a program with these signals.
    ///
    /// # Errors
    /// If there is no such measure, signal or option, or the signals or the option values are unsuitable.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_analysis::instruments::{Measure, MeasureValue};
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{RunSettings, run};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// // dx/dt = -x, from x = 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("Decay").element("A1", decay).run(1.0, 1e-3).record(["A1"]).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let trace = run(&program, &RunSettings::of(&circuit)?)?;
    ///
    /// let measure = Measure::parse("peak: A1", program.signals())?;
    /// assert_eq!((measure.text(), measure.columns()[0].name.as_str()), ("peak:A1".to_owned(), "peak:A1"));
    /// assert_eq!(measure.read(&trace), [Ok(MeasureValue::Number(50.0))]);
    /// let error = Measure::parse("peek:A1", program.signals()).unwrap_err();
    /// assert_eq!(error.to_string(), "there is no measure \"peek\"; did you mean \"peak\"?");
    /// # Ok(())
    /// # }
    /// ```
    pub fn parse(text: &str, signals: &[SignalInfo]) -> Result<Measure, MeasureError> {
        let (name, arguments) = text.trim().split_once(':').unwrap_or((text.trim(), ""));
        let definition = TABLE.iter().find(|definition| definition.name == name).ok_or_else(|| {
            let known: Vec<_> = TABLE.iter().map(|definition| definition.name).collect();
            let hint = suggestion(name, &known).unwrap_or_default();
            MeasureError::Unknown { name: name.to_owned(), hint }
        })?;
        let words = || arguments.split(',').map(str::trim).filter(|word| !word.is_empty());
        let options = words().filter_map(|word| word.split_once('='));
        let named: Vec<&str> = words().filter(|word| !word.contains('=')).collect();
        let signals = definition.connect(&named, signals)?;
        let measure = Measure {
            definition,
            options: definition.parse_options(options, &signals)?,
            signals,
            arguments: words().collect::<Vec<_>>().join(","),
        };
        measure.with_checked_units()
    }

    /// Checks the units of two signals and sets the default threshold.
    fn with_checked_units(mut self) -> Result<Self, MeasureError> {
        let measure = self.definition.name;
        let [(first, unit), (second, other)] = self.signals.as_slice() else { return Ok(self) };
        match self.definition.inputs {
            MeasureInputs::VelocityAndForce(_) => {
                check_dimension(measure, first, unit, "velocity", Dimension::LENGTH.over(Dimension::TIME))?;
                check_dimension(measure, second, other, "force", Dimension::FORCE)?;
            }
            _ if unit != other => {
                let signal = |name: &str, unit: &str| format!("{name} in {unit}");
                return Err(MeasureError::UnequalUnits {
                    measure,
                    first: signal(first, unit),
                    second: signal(second, other),
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

    /// The request in its normal form, without blanks.
    pub fn text(&self) -> String {
        self.text_with_suffix("")
    }

    /// The request with a suffix after the name of the measure.
    fn text_with_suffix(&self, suffix: &str) -> String {
        let colon = if self.arguments.is_empty() { "" } else { ":" };
        format!("{}{suffix}{colon}{}", self.definition.name, self.arguments)
    }

    /// The columns that the measure fills.
    pub fn columns(&self) -> Vec<MeasureColumn> {
        let columns = self.definition.columns.iter().map(|(suffix, unit)| MeasureColumn {
            name: self.text_with_suffix(suffix),
            unit: match unit {
                ColumnUnit::Signal => self.signals[0].1.clone(),
                ColumnUnit::Fixed(text) => (*text).to_owned(),
            },
        });
        columns.collect()
    }

    /// What each column may contain, in the order of [`Measure::columns`].
    pub(crate) fn contents(&self) -> impl Iterator<Item = ColumnContent> {
        let columns = self.definition.columns;
        // A number next to a name belongs to it: "none" has no number.
        let has_names = columns.iter().any(|(_, unit)| unit.is_of_names());
        columns.iter().map(move |(_, unit)| match has_names {
            true if unit.is_of_names() => ColumnContent::Name,
            true => ColumnContent::OptionalNumber,
            false => ColumnContent::Number,
        })
    }

    /// The names of the signals that a run must record for this measure.
    pub fn signals(&self) -> impl Iterator<Item = &str> {
        self.signals.iter().map(|(name, _)| name.as_str())
    }

    /// Whether the measure uses the samples. Then no two samples may have the same time.
    pub(crate) fn is_sampled(&self) -> bool {
        self.definition.is_sampled
    }

    /// Reads the last run of a trace: one value per column, or why a column has none.
    pub fn read(&self, trace: &Trace) -> Vec<Result<MeasureValue, String>> {
        let values = (self.definition.read)(&read::LastRun::new(trace, self));
        let finite = |value: MeasureValue| match value {
            MeasureValue::Number(number) if !number.is_finite() => Err(format!("the value is {number}")),
            value => Ok(value),
        };
        values.into_iter().map(|value| value.and_then(finite)).collect()
    }

    /// The value of the option with this index in the definition.
    fn option(&self, index: usize) -> Option<f64> {
        self.options[index]
    }
}

/// An error unless `unit` has the given dimension.
fn check_dimension(
    measure: &'static str,
    signal: &str,
    unit: &str,
    wanted: &'static str,
    dimension: Dimension,
) -> Result<(), MeasureError> {
    match Unit::parse(unit) {
        Ok(parsed) if parsed.dimension() == dimension => Ok(()),
        _ => Err(MeasureError::WrongDimension { measure, signal: format!("{signal} in {unit}"), wanted }),
    }
}

#[cfg(test)]
mod tests;
