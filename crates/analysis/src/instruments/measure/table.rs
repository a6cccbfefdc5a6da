//! The table of measures: name, signals, options, columns and function of each one.
//!
//! A new measure needs one row here and one function in `read`. The parser in `measure`, the help text and the columns
//! of a sweep follow from the row. Options are positive numbers, and their order is that of `Measure::option`. Those of
//! [`TIMES`] are in seconds, all others in the unit of the first signal.

use super::read::{self, LastRun};
use super::{MeasureError, MeasureValue};
use patchcord_core::document::{TypedNumber, TypedNumberError, suggestion};
use patchcord_core::ir::SignalInfo;
use patchcord_expr::Unit;

/// Options whose values are times in seconds.
const TIMES: [&str; 2] = ["last", "window"];

/// One row of the table.
#[derive(Debug)]
pub(super) struct MeasureDefinition {
    /// The name by which it is requested.
    pub name: &'static str,
    /// What it reads, in one line, for help texts.
    pub meaning: &'static str,
    /// The signals that it reads, with their defaults.
    pub inputs: MeasureInputs,
    /// Names of the options. Each one takes a positive number.
    options: &'static [&'static str],
    /// Whether it uses the samples. Then no two samples may have the same time.
    pub is_sampled: bool,
    /// For each column: the suffix that is appended to the measure's name, and the unit.
    pub columns: &'static [(&'static str, ColumnUnit)],
    /// Reads the last run: one value per column, or why a column has none.
    pub read: fn(&LastRun<'_>) -> Vec<Result<MeasureValue, String>>,
}

impl PartialEq for MeasureDefinition {
    /// Two rows are equal if their names are. Function pointers cannot be compared reliably.
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// The unit of a column.
#[derive(Debug, Clone, Copy)]
pub(super) enum ColumnUnit {
    /// The unit of the first signal.
    Signal,
    /// A fixed unit; empty for a column of names.
    Fixed(&'static str),
}

impl ColumnUnit {
    /// Whether the column has names instead of numbers.
    pub(super) fn is_of_names(&self) -> bool {
        matches!(self, ColumnUnit::Fixed(""))
    }
}

/// The signals that a measure reads.
#[derive(Debug)]
pub(super) enum MeasureInputs {
    /// No signal.
    NoSignal,
    /// One signal, which must be given.
    OneSignal,
    /// A velocity. The field is the default.
    Velocity(&'static [&'static str; 1]),
    /// The commanded and the actual velocity, in the same unit. The field holds the defaults. The first option of
    /// such a measure is a threshold in that unit.
    Velocities(&'static [&'static str; 2]),
    /// A velocity and a force. The field holds the defaults. The first option is a threshold in the unit of the
    /// velocity.
    VelocityAndForce(&'static [&'static str; 2]),
}

impl MeasureInputs {
    /// The default signals.
    fn defaults(&self) -> &'static [&'static str] {
        match self {
            MeasureInputs::NoSignal | MeasureInputs::OneSignal => &[],
            MeasureInputs::Velocity(name) => *name,
            MeasureInputs::Velocities(names) | MeasureInputs::VelocityAndForce(names) => *names,
        }
    }

    /// The number of signals.
    fn count(&self) -> usize {
        match self {
            MeasureInputs::NoSignal => 0,
            MeasureInputs::OneSignal | MeasureInputs::Velocity(_) => 1,
            MeasureInputs::Velocities(_) | MeasureInputs::VelocityAndForce(_) => 2,
        }
    }

    /// Number and kind of the signals in words, and an example from the colon on.
    /// The error for a wrong number of signals quotes both.
    fn description(&self) -> (&'static str, &'static str) {
        match self {
            MeasureInputs::NoSignal => ("no signal", ""),
            MeasureInputs::OneSignal | MeasureInputs::Velocity(_) => ("one signal", ":SIGNAL"),
            MeasureInputs::Velocities(_) => {
                ("two signals, the commanded and the actual velocity", ":v_i,v_o")
            }
            MeasureInputs::VelocityAndForce(_) => {
                ("two signals, a velocity and a force", ":v_o,spring_force")
            }
        }
    }
}

/// One column in the unit of the signal.
/// The suffix is empty, so the column has the name of the request.
const SIGNAL: &[(&str, ColumnUnit)] = &[("", ColumnUnit::Signal)];
/// A column for the rising and one for the falling ramp.
const BOTH_RAMPS: &[(&str, ColumnUnit)] =
    &[("_rising", ColumnUnit::Signal), ("_falling", ColumnUnit::Signal)];
/// A column for each point of a velocity profile.
const POINTS: &[(&str, ColumnUnit)] = &[
    ("_1", ColumnUnit::Signal),
    ("_2", ColumnUnit::Signal),
    ("_3", ColumnUnit::Signal),
    ("_4", ColumnUnit::Signal),
    ("_5", ColumnUnit::Signal),
];

/// Every measure, in the order of the help text.
pub(super) const TABLE: &[MeasureDefinition] = &[
    MeasureDefinition {
        name: "voltmeter",
        meaning: "the value at the end of the run",
        inputs: MeasureInputs::OneSignal,
        options: &[],
        is_sampled: false,
        columns: SIGNAL,
        read: read::voltmeter,
    },
    MeasureDefinition {
        name: "peak",
        meaning: "the largest absolute value",
        inputs: MeasureInputs::OneSignal,
        options: &[],
        is_sampled: false,
        columns: SIGNAL,
        read: read::peak,
    },
    MeasureDefinition {
        name: "least",
        meaning: "the smallest value",
        inputs: MeasureInputs::OneSignal,
        options: &[],
        is_sampled: false,
        columns: SIGNAL,
        read: read::least,
    },
    MeasureDefinition {
        name: "most",
        meaning: "the largest value",
        inputs: MeasureInputs::OneSignal,
        options: &[],
        is_sampled: false,
        columns: SIGNAL,
        read: read::most,
    },
    MeasureDefinition {
        name: "amplitude",
        meaning: "half the peak-to-peak value of an oscillation, over the last half of the run or the last N seconds",
        inputs: MeasureInputs::OneSignal,
        options: &["last"],
        is_sampled: true,
        columns: SIGNAL,
        read: read::amplitude,
    },
    MeasureDefinition {
        name: "frequency",
        meaning: "number of whole cycles of an oscillation divided by their duration, over the same time as amplitude",
        inputs: MeasureInputs::OneSignal,
        options: &["last"],
        is_sampled: true,
        columns: &[("", ColumnUnit::Fixed("Hz"))],
        read: read::frequency,
    },
    MeasureDefinition {
        name: "critical_velocity",
        meaning: "the command at which oscillation ends while the command rises, and begins while it falls; the \
                  velocity oscillates if it swings by more than threshold (0.25 mm/s) within window (0.04 s)",
        inputs: MeasureInputs::Velocities(&["v_i", "v_o"]),
        options: &["threshold", "window"],
        is_sampled: true,
        columns: BOTH_RAMPS,
        read: read::critical_velocity,
    },
    MeasureDefinition {
        name: "critical_velocity_range",
        meaning: "the interval of each critical velocity: readings with half and twice the threshold and the window, \
                  and the overrun of the ramp in one cycle; also how many of these four readings failed",
        inputs: MeasureInputs::Velocities(&["v_i", "v_o"]),
        options: &["threshold", "window"],
        is_sampled: true,
        columns: &[
            ("_rising_least", ColumnUnit::Signal),
            ("_rising_most", ColumnUnit::Signal),
            ("_rising_unread", ColumnUnit::Fixed("1")),
            ("_falling_least", ColumnUnit::Signal),
            ("_falling_most", ColumnUnit::Signal),
            ("_falling_unread", ColumnUnit::Fixed("1")),
        ],
        read: read::critical_velocity_range,
    },
    MeasureDefinition {
        name: "first_oscillation",
        meaning: "the command at which oscillation first appears during the rising and the falling ramp (points 2 \
                  and 5 of the velocity profiles); a single slip and its ringing do not count",
        inputs: MeasureInputs::Velocities(&["v_i", "v_o"]),
        options: &["threshold", "window", "standstill"],
        is_sampled: true,
        columns: BOTH_RAMPS,
        read: read::first_oscillation,
    },
    MeasureDefinition {
        name: "profile",
        meaning: "the commands at points 1 to 5 of the velocity profile: breaking away, start of oscillation, start \
                  and end of stick-slip, end of oscillation; velocities up to standstill (half the threshold) count \
                  as 0",
        inputs: MeasureInputs::Velocities(&["v_i", "v_o"]),
        options: &["threshold", "window", "standstill"],
        is_sampled: true,
        columns: POINTS,
        read: read::profile,
    },
    MeasureDefinition {
        name: "profile_falling",
        meaning: "the commands at points 1 to 5 of the falling ramp: coming to rest, end of oscillation, end and \
                  start of stick-slip, start of oscillation",
        inputs: MeasureInputs::Velocities(&["v_i", "v_o"]),
        options: &["threshold", "window", "standstill"],
        is_sampled: true,
        columns: POINTS,
        read: read::profile_falling,
    },
    MeasureDefinition {
        name: "friction_loop",
        meaning: "area of the loop of force against velocity (positive if clockwise) and work of the force per cycle: \
                  means over the whole cycles above threshold (0.25 mm/s) in the last half of the run or the last N \
                  seconds",
        inputs: MeasureInputs::VelocityAndForce(&["v_o", "spring_force"]),
        options: &["threshold", "last"],
        is_sampled: true,
        columns: &[("_area", ColumnUnit::Fixed("W")), ("_work", ColumnUnit::Fixed("J"))],
        read: read::friction_loop,
    },
    MeasureDefinition {
        name: "stick_end",
        meaning: "the time at which a velocity first exceeds a threshold (default: a millionth of its largest value)",
        inputs: MeasureInputs::Velocity(&["v_o"]),
        options: &["threshold"],
        is_sampled: true,
        columns: &[("", ColumnUnit::Fixed("s"))],
        read: read::stick_end,
    },
    MeasureDefinition {
        name: "overload",
        meaning: "the amplifier that is overloaded first, and the time",
        inputs: MeasureInputs::NoSignal,
        options: &[],
        is_sampled: false,
        columns: &[("", ColumnUnit::Fixed("")), ("_time", ColumnUnit::Fixed("s"))],
        read: read::overload,
    },
];

impl MeasureDefinition {
    /// The syntax for help texts, such as "amplitude:SIGNAL,[last=N]".
    pub(super) fn syntax(&self) -> String {
        let signals = match &self.inputs {
            MeasureInputs::OneSignal => "SIGNAL".to_owned(),
            inputs => match inputs.defaults() {
                [] => String::new(),
                names => format!("[{}]", names.join(",")),
            },
        };
        let options = self.options.iter().map(|option| format!("[{option}=N]"));
        let all: Vec<_> = [signals].into_iter().chain(options).filter(|part| !part.is_empty()).collect();
        let colon = if all.is_empty() { "" } else { ":" };
        format!("{}{colon}{}", self.name, all.join(","))
    }

    /// Names and units of the requested signals, or of the default ones.
    ///
    /// # Errors
    /// If the number of signals is wrong, or a signal is unknown.
    pub(super) fn connect(
        &self,
        named: &[&str],
        known: &[SignalInfo],
    ) -> Result<Vec<(String, String)>, MeasureError> {
        let names = if named.is_empty() { self.inputs.defaults() } else { named };
        if names.len() != self.inputs.count() {
            let (wanted, example) = self.inputs.description();
            return Err(MeasureError::WrongSignals { measure: self.name, wanted, example });
        }
        names.iter().map(|name| self.find(name, known)).collect()
    }

    /// Name and unit of a signal; an error with a similar name if it is unknown.
    fn find(&self, name: &str, known: &[SignalInfo]) -> Result<(String, String), MeasureError> {
        let found = known.iter().find(|signal| signal.name == name);
        found.map(|signal| (signal.name.clone(), signal.unit.clone())).ok_or_else(|| {
            let names: Vec<_> = known.iter().map(|signal| signal.name.as_str()).collect();
            let hint = suggestion(name, &names).unwrap_or_default();
            MeasureError::UnknownSignal { measure: self.name, signal: name.to_owned(), hint }
        })
    }

    /// The values of the options, in the order of the definition. None if an option is not given. `signals` are the
    /// names and units of the signals that are read.
    ///
    /// # Errors
    /// If an option is unknown, or a value is not a positive finite number in the unit of the option.
    pub(super) fn parse_options<'a>(
        &self,
        given: impl IntoIterator<Item = (&'a str, &'a str)>,
        signals: &[(String, String)],
    ) -> Result<Vec<Option<f64>>, MeasureError> {
        let measure = self.name;
        let mut values = vec![None; self.options.len()];
        for (name, value) in given.into_iter().map(|(name, value)| (name.trim(), value.trim())) {
            let index = self.options.iter().position(|option| *option == name).ok_or_else(|| {
                let hint = suggestion(name, self.options).unwrap_or_else(|| "it has none".to_owned());
                MeasureError::UnknownOption { measure, option: name.to_owned(), hint }
            })?;
            let option = self.options[index];
            let number = number_in(option_unit(option, signals), value);
            let number = number.map_err(|reason| {
                let reason = Box::new(reason);
                MeasureError::OptionValue { measure, option, reason }
            })?;
            if number <= 0.0 {
                return Err(MeasureError::BadOption { measure, option, value: value.to_owned() });
            }
            values[index] = Some(number);
        }
        Ok(values)
    }
}

/// The unit of an option: seconds for a time, otherwise that of the first signal.
fn option_unit<'a>(option: &str, signals: &'a [(String, String)]) -> &'a str {
    match signals.first() {
        Some((_, unit)) if !TIMES.contains(&option) => unit.as_str(),
        _ => "s",
    }
}

/// A number in a unit, alone or with a unit of the same dimension. If the unit cannot be parsed, the number must be
/// alone.
fn number_in(unit: &str, text: &str) -> Result<f64, TypedNumberError> {
    let typed = TypedNumber::parse(text)?;
    match (Unit::parse(unit), &typed.unit) {
        (Ok(expected), _) => typed.in_unit(&expected),
        (Err(_), None) => Ok(typed.number),
        (Err(_), Some(found)) => Err(TypedNumberError::WrongUnit {
            text: text.to_owned(),
            found: found.text().to_owned(),
            expected: unit.to_owned(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_never_ignored() {
        assert_eq!(number_in("mm", "0.5"), Ok(0.5));
        assert_eq!(number_in("mm", "1 um"), Ok(0.001));
        assert_eq!(number_in("rpm", "2 1/s"), Ok(120.0));
        assert!(number_in("deg/s", "2 1/s").is_err());
        let unknown = "furlong";
        assert_eq!(number_in(unknown, "0.5"), Ok(0.5));
        let error = number_in(unknown, "1mm").unwrap_err();
        assert_eq!(error.to_string(), "\"1mm\" is in mm, but furlong is expected");
    }
}
