//! The table of measures: names, signals, options, columns.

use super::read::{self, Run};
use super::{Cell, MeasureError};
use patchcord_core::document::suggestion;
use patchcord_core::ir::Probe;

/// A row of the table.
#[derive(Debug)]
pub(super) struct Entry {
    pub name: &'static str,
    /// What it reads, in a line.
    pub meaning: &'static str,
    pub signals: Signals,
    options: &'static [&'static str],
    /// Whether it reads the samples, of which no two may stand at one instant.
    pub is_sampled: bool,
    /// What the name of each column has behind that of the measure, and its unit.
    pub columns: &'static [(&'static str, UnitOf)],
    pub read: fn(&Run<'_>) -> Vec<Result<Cell, String>>,
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// The unit of a column.
#[derive(Debug, Clone, Copy)]
pub(super) enum UnitOf {
    /// That of the first signal.
    Signal,
    Text(&'static str),
}

/// The signals that a measure reads.
#[derive(Debug)]
pub(super) enum Signals {
    /// None.
    None,
    /// One, which has to be named.
    One,
    /// A velocity: this one, where no other is named.
    Velocity(&'static [&'static str; 1]),
    /// The commanded and the actual velocity, in one unit: these, where no others are named. The first option is a threshold in that unit.
    Velocities(&'static [&'static str; 2]),
    /// A velocity and a force, likewise.
    VelocityAndForce(&'static [&'static str; 2]),
}

impl Signals {
    /// Those that are read where no others are named.
    fn usual(&self) -> &'static [&'static str] {
        match self {
            Signals::None | Signals::One => &[],
            Signals::Velocity(name) => *name,
            Signals::Velocities(names) | Signals::VelocityAndForce(names) => *names,
        }
    }

    /// How many there are.
    fn count(&self) -> usize {
        match self {
            Signals::None => 0,
            Signals::One | Signals::Velocity(_) => 1,
            Signals::Velocities(_) | Signals::VelocityAndForce(_) => 2,
        }
    }

    /// What they are, in words, and how they are written.
    fn told(&self) -> (&'static str, &'static str) {
        match self {
            Signals::None => ("no signal", ""),
            Signals::One | Signals::Velocity(_) => ("one signal", ":SIGNAL"),
            Signals::Velocities(_) => ("two signals, the commanded and the actual velocity", ":v_i,v_o"),
            Signals::VelocityAndForce(_) => ("two signals, a velocity and a force", ":v_o,spring_force"),
        }
    }
}

const SIGNAL: &[(&str, UnitOf)] = &[("", UnitOf::Signal)];
const BOTH_WAYS: &[(&str, UnitOf)] = &[("_rising", UnitOf::Signal), ("_falling", UnitOf::Signal)];
const POINTS: &[(&str, UnitOf)] = &[
    ("_1", UnitOf::Signal),
    ("_2", UnitOf::Signal),
    ("_3", UnitOf::Signal),
    ("_4", UnitOf::Signal),
    ("_5", UnitOf::Signal),
];

pub(super) const TABLE: &[Entry] = &[
    Entry {
        name: "voltmeter",
        meaning: "the value at the end of the run",
        signals: Signals::One,
        options: &[],
        is_sampled: false,
        columns: SIGNAL,
        read: read::voltmeter,
    },
    Entry {
        name: "peak",
        meaning: "the largest value without sign",
        signals: Signals::One,
        options: &[],
        is_sampled: false,
        columns: SIGNAL,
        read: read::peak,
    },
    Entry {
        name: "least",
        meaning: "the least value",
        signals: Signals::One,
        options: &[],
        is_sampled: false,
        columns: SIGNAL,
        read: read::least,
    },
    Entry {
        name: "most",
        meaning: "the largest value",
        signals: Signals::One,
        options: &[],
        is_sampled: false,
        columns: SIGNAL,
        read: read::most,
    },
    Entry {
        name: "amplitude",
        meaning: "half of the swing of an oscillation, over the last half of the run or its last so many seconds",
        signals: Signals::One,
        options: &["last"],
        is_sampled: true,
        columns: SIGNAL,
        read: read::amplitude,
    },
    Entry {
        name: "frequency",
        meaning: "whole cycles of an oscillation over their time, read like its amplitude",
        signals: Signals::One,
        options: &["last"],
        is_sampled: true,
        columns: &[("", UnitOf::Text("Hz"))],
        read: read::frequency,
    },
    Entry {
        name: "critical_velocity",
        meaning: "the command at which oscillation ends while it rises, and begins while it falls: swings above a \
                  threshold (0.25 mm/s) within a window (0.04 s)",
        signals: Signals::Velocities(&["v_i", "v_o"]),
        options: &["threshold", "window"],
        is_sampled: true,
        columns: BOTH_WAYS,
        read: read::critical_velocity,
    },
    Entry {
        name: "critical_velocity_range",
        meaning: "from where to where each critical velocity moves with half and double of threshold and window, and with \
                  what a ramp overruns in a cycle; how many of these four readings could not be had",
        signals: Signals::Velocities(&["v_i", "v_o"]),
        options: &["threshold", "window"],
        is_sampled: true,
        columns: &[
            ("_rising_least", UnitOf::Signal),
            ("_rising_most", UnitOf::Signal),
            ("_rising_unread", UnitOf::Text("1")),
            ("_falling_least", UnitOf::Signal),
            ("_falling_most", UnitOf::Signal),
            ("_falling_unread", UnitOf::Text("1")),
        ],
        read: read::critical_velocity_range,
    },
    Entry {
        name: "first_oscillation",
        meaning: "the command at which oscillation first appears while it rises, and while it falls: points 2 and 5 of the velocity \
                  profile of that way; one slip, and what rings behind it, is none",
        signals: Signals::Velocities(&["v_i", "v_o"]),
        options: &["threshold", "window", "standstill"],
        is_sampled: true,
        columns: BOTH_WAYS,
        read: read::first_oscillation,
    },
    Entry {
        name: "profile",
        meaning: "the commands at points 1 to 5 of the velocity profile: it breaks away, oscillation begins, stick-slip \
                  begins and ends, oscillation ends; a velocity up to standstill (half of the threshold) is none",
        signals: Signals::Velocities(&["v_i", "v_o"]),
        options: &["threshold", "window", "standstill"],
        is_sampled: true,
        columns: POINTS,
        read: read::profile,
    },
    Entry {
        name: "profile_falling",
        meaning: "the commands at points 1 to 5 on the way back: it comes to rest, oscillation ends, stick-slip ends and begins, \
                  oscillation begins",
        signals: Signals::Velocities(&["v_i", "v_o"]),
        options: &["threshold", "window", "standstill"],
        is_sampled: true,
        columns: POINTS,
        read: read::profile_falling,
    },
    Entry {
        name: "friction_loop",
        meaning: "area of the loop of force against velocity (positive clockwise) and work of the force in a cycle, the \
                  mean of the whole cycles above a threshold (0.25 mm/s) in the last half of the run or its last so many seconds",
        signals: Signals::VelocityAndForce(&["v_o", "spring_force"]),
        options: &["threshold", "last"],
        is_sampled: true,
        columns: &[("_area", UnitOf::Text("W")), ("_work", UnitOf::Text("J"))],
        read: read::friction_loop,
    },
    Entry {
        name: "stick_end",
        meaning: "when a velocity first passes a threshold (a millionth of its largest value): sliding begins",
        signals: Signals::Velocity(&["v_o"]),
        options: &["threshold"],
        is_sampled: true,
        columns: &[("", UnitOf::Text("s"))],
        read: read::stick_end,
    },
    Entry {
        name: "overload",
        meaning: "the amplifier whose overload lamp lights first, and when",
        signals: Signals::None,
        options: &[],
        is_sampled: false,
        columns: &[("", UnitOf::Text("")), ("_time", UnitOf::Text("s"))],
        read: read::overload,
    },
];

impl Entry {
    /// How it is asked for.
    pub fn written(&self) -> String {
        let signals = match &self.signals {
            Signals::One => "SIGNAL".to_owned(),
            signals => match signals.usual() {
                [] => String::new(),
                names => format!("[{}]", names.join(",")),
            },
        };
        let options = self.options.iter().map(|option| format!("[{option}=N]"));
        let all: Vec<_> = [signals].into_iter().chain(options).filter(|part| !part.is_empty()).collect();
        let colon = if all.is_empty() { "" } else { ":" };
        format!("{}{colon}{}", self.name, all.join(","))
    }

    /// Names and units of the signals that it is to read.
    pub fn connected(&self, named: &[&str], known: &[Probe]) -> Result<Vec<(String, String)>, MeasureError> {
        let names = if named.is_empty() { self.signals.usual() } else { named };
        if names.len() != self.signals.count() {
            let (wanted, example) = self.signals.told();
            return Err(MeasureError::Signals { measure: self.name, wanted, example });
        }
        names.iter().map(|name| self.find(name, known)).collect()
    }

    fn find(&self, name: &str, known: &[Probe]) -> Result<(String, String), MeasureError> {
        let found = known.iter().find(|probe| probe.name == name);
        found.map(|probe| (probe.name.clone(), probe.unit.clone())).ok_or_else(|| {
            let names: Vec<_> = known.iter().map(|probe| probe.name.as_str()).collect();
            let hint = suggestion(name, &names).unwrap_or_default();
            MeasureError::UnknownSignal { measure: self.name, signal: name.to_owned(), hint }
        })
    }

    /// The values of its options.
    pub fn set<'a>(
        &self,
        given: impl Iterator<Item = (&'a str, &'a str)>,
    ) -> Result<Vec<Option<f64>>, MeasureError> {
        let measure = self.name;
        let mut values = vec![None; self.options.len()];
        for (name, value) in given.map(|(name, value)| (name.trim(), value.trim())) {
            let index = self.options.iter().position(|option| *option == name).ok_or_else(|| {
                let hint = suggestion(name, self.options).unwrap_or_else(|| "it has none".to_owned());
                MeasureError::UnknownOption { measure, option: name.to_owned(), hint }
            })?;
            let number = value.parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite());
            let value = value.to_owned();
            let bad = MeasureError::BadOption { measure, option: self.options[index], value };
            values[index] = Some(number.ok_or(bad)?);
        }
        Ok(values)
    }
}
