//! Test values: which states and drives they set, and the machine at these values.

use std::collections::BTreeMap;
use std::fmt;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::suggestion;
use patchcord_core::ir::{Program, ProgramPoint, Register};
use patchcord_core::solve::RunError;
use patchcord_expr::{Unit, split_primes};

use super::handles::{Handle, timed_states};
use super::stated::aliases;
use super::wired::Wired;
use crate::compare::names_time;
use crate::operating_point::{has_switches, initial_point, settled_point};

/// The values at which a static check is made.
#[derive(Debug, Clone, PartialEq)]
pub enum TestValues {
    /// The initial condition.
    Initial,
    /// Values in SI by name: of signals, of their derivatives, of integrators and lags in volts, and of drives. All others
    /// are as in the initial condition.
    Given(Vec<(String, f64)>),
    /// Random values of all integrators, lags and drives, by a seed. They are scaled down, toward 0 and then toward the
    /// initial condition, until no amplifier exceeds 80 V, or at least none is overloaded. If all sets of values within
    /// 0.1 V of both still overload an amplifier, [`StaticRow::is_overloaded`](crate::StaticRow) marks it.
    /// If the equations contain the time, drives and ramps keep their values at t = 0.
    Random(u64),
}

/// Why test values cannot be set.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum TestError {
    /// The patch has no quantity of this name.
    Unknown {
        /// The name.
        name: String,
        /// What is probably meant.
        hint: Option<String>,
    },
    /// The quantity follows from others.
    Follows {
        /// The name.
        name: String,
        /// Names that can be set.
        settable: Vec<String>,
    },
    /// Two values set the same output.
    Twice {
        /// The first name.
        first: String,
        /// The second name.
        second: String,
    },
    /// The quantity keeps its value at t = 0: it is a drive, or it is a linear function of time in the wiring.
    Fixed {
        /// Its name.
        name: String,
        /// The reason, as a clause.
        reason: &'static str,
    },
    /// The voltages cannot be computed; the text says why.
    NoVoltages(String),
}

impl fmt::Display for TestError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TestError::Unknown { name, hint } => {
                write!(out, "there is no quantity {name}")?;
                hint.iter().try_for_each(|hint| write!(out, "; {hint}"))
            }
            TestError::Follows { name, settable } => {
                write!(out, "{name} follows from the outputs of integrators and cannot be set")?;
                if settable.is_empty() { Ok(()) } else { write!(out, "; set {}", settable.join(", ")) }
            }
            TestError::Twice { first, second } => {
                write!(out, "{first} and {second} set the same output; give one of them")
            }
            TestError::Fixed { name, reason } => {
                write!(out, "{name} keeps its value at t = 0, because {reason}")
            }
            TestError::NoVoltages(reason) => write!(out, "no voltages at these values: {reason}"),
        }
    }
}

impl std::error::Error for TestError {}

/// The unit of a quantity with its derivatives, such as mm/s for x' or V for an integrator. `None` if the patch has no
/// signal, drive or element of this name.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::Patch;
/// use patchcord_equations::test_unit;
///
/// let circuit = Circuit::new(&Patch::read("../../patches/lessons/mass-and-spring.json")?)?;
/// let unit = |name: &str| test_unit(&circuit, name).map(|unit| unit.text().to_owned());
/// assert_eq!(unit("x").as_deref(), Some("mm"));
/// assert_eq!(unit("x'").as_deref(), Some("mm/s"));
/// assert_eq!(unit("A1").as_deref(), Some("V"));
/// assert_eq!(unit("y"), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn test_unit(circuit: &Circuit, name: &str) -> Option<Unit> {
    let (base, order) = split_primes(name);
    let point = circuit.signals().iter().find(|point| point.name == base)?;
    let unit = match point.scale {
        Some(scale) => circuit.derived_unit(scale).clone(),
        None => Unit::parse("V").ok()?,
    };
    Some((0..order).fold(unit, |unit, _| unit.per_second()))
}

/// What a test value sets.
#[derive(Debug, Clone, PartialEq)]
enum Target {
    /// The output of a drive.
    Drive(Register),
    /// A state, by its index, through a quantity that is a constant times it.
    State(usize, Handle),
}

/// The machine at its initial condition.
///
/// # Errors
/// If it cannot be set to the initial condition.
pub(super) fn initial<'a>(circuit: &'a Circuit, program: &'a Program) -> Result<Wired<'a>, TestError> {
    let point = initial_point(program).map_err(no_voltages)?;
    Wired::new(circuit, program, point, BTreeMap::new()).ok_or_else(no_solution)
}

/// The machine at given values.
///
/// # Errors
/// If a name is not that of a quantity that can be set, or if the voltages cannot be computed.
pub(super) fn given<'a>(
    circuit: &'a Circuit,
    program: &'a Program,
    handles: &[Vec<Handle>],
    values: &[(String, f64)],
) -> Result<Wired<'a>, TestError> {
    let mut wired = initial(circuit, program)?;
    let is_timed = timed_states(circuit, program);
    let mut targets: Vec<(&str, f64, Target)> = Vec::new();
    for (name, value) in values {
        let target = target(&wired, handles, name)?;
        if matches!(target, Target::State(index, _) if is_timed[index]) {
            return Err(TestError::Fixed { name: name.clone(), reason: TIMED });
        }
        if let Some((first, ..)) = targets.iter().find(|(_, _, other)| sets_same(other, &target)) {
            return Err(TestError::Twice { first: (*first).to_owned(), second: name.clone() });
        }
        targets.push((name, *value, target));
    }
    // A state can be known by a quantity that contains drives, so drives come first.
    targets.sort_by_key(|(_, _, target)| matches!(target, Target::State(..)));
    for (name, value, target) in targets {
        wired = with_value(wired, name, value, &target)?;
    }
    let settled = settled_point(program, &wired.point.states).map_err(no_voltages)?;
    moved_to(&wired, settled, wired.given.clone())
}

/// Whether two targets are the same output.
fn sets_same(one: &Target, other: &Target) -> bool {
    match (one, other) {
        (Target::Drive(one), Target::Drive(other)) => one == other,
        (Target::State(one, _), Target::State(other, _)) => one == other,
        _ => false,
    }
}

/// What a name sets.
///
/// # Errors
/// If there is no such quantity, or if it cannot be set.
fn target(wired: &Wired<'_>, handles: &[Vec<Handle>], name: &str) -> Result<Target, TestError> {
    let (base, order) = split_primes(name);
    let Some((register, _)) = wired.place(base) else {
        let known: Vec<String> = settable(wired, handles);
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        return Err(TestError::Unknown { name: name.to_owned(), hint: suggestion(name, &known) });
    };
    if order == 0 && wired.is_drive(register) {
        let fixed = |reason| Err(TestError::Fixed { name: name.to_owned(), reason });
        return fixed_reason(wired).map_or(Ok(Target::Drive(register)), fixed);
    }
    let outputs = wired.program.element_outputs();
    let mut states = wired.program.state_laws().iter();
    let direct = states.position(|state| order == 0 && outputs[state.element].register == register);
    let own = Handle { name: base.to_owned(), order };
    let found = direct.map(|index| Target::State(index, own.clone()));
    let found = found.or_else(|| by_handle(handles, &own));
    let found = found.or_else(|| alias(wired.circuit, &own).and_then(|alias| by_handle(handles, &alias)));
    let follows = || TestError::Follows { name: name.to_owned(), settable: settable(wired, handles) };
    found.ok_or_else(follows)
}

/// The state that a quantity determines.
fn by_handle(handles: &[Vec<Handle>], handle: &Handle) -> Option<Target> {
    let index = handles.iter().position(|of_state| of_state.contains(handle))?;
    Some(Target::State(index, handle.clone()))
}

/// The name that an equation gives to a derivative, such as v for x'.
fn alias(circuit: &Circuit, of: &Handle) -> Option<Handle> {
    let mut named = aliases(circuit).into_iter();
    let alias = named.find(|alias| alias.of == of.name && alias.order <= of.order)?;
    Some(Handle { name: alias.name.to_owned(), order: of.order - alias.order })
}

/// Why test values do not set quantities that follow the time.
const TIMED: &str = "the equations contain the time t";

/// Why test values do not set drives. `None` if they do.
pub(super) fn fixed_reason(wired: &Wired<'_>) -> Option<&'static str> {
    if names_time(wired.circuit) {
        return Some(TIMED);
    }
    has_switches(wired.program).then_some("the patch has elements that switch")
}

/// The names that test values can have: one for every state, and the drives.
fn settable(wired: &Wired<'_>, handles: &[Vec<Handle>]) -> Vec<String> {
    let outputs = wired.program.element_outputs();
    let states = wired.program.state_laws().iter().zip(handles);
    let free = states.zip(timed_states(wired.circuit, wired.program)).filter(|(_, is_timed)| !is_timed);
    let states = free.map(|((state, of_state), _)| {
        of_state.first().map_or_else(|| outputs[state.element].name.clone(), Handle::text)
    });
    let drives = wired.circuit.patch().drives.keys().cloned();
    states.chain(drives.filter(|_| fixed_reason(wired).is_none())).collect()
}

/// The machine after one more value is set, before modes settle.
///
/// # Errors
/// If the voltages cannot be computed.
fn with_value<'a>(wired: Wired<'a>, name: &str, value: f64, target: &Target) -> Result<Wired<'a>, TestError> {
    let none = || TestError::NoVoltages(format!("{name} does not determine a voltage"));
    let (mut point, mut given) = (wired.point.clone(), wired.given.clone());
    match target {
        Target::Drive(register) => {
            let (_, per_volt) =
                wired.place(name).filter(|(_, per_volt)| *per_volt != 0.0).ok_or_else(none)?;
            given.insert(*register, value / per_volt);
        }
        Target::State(index, handle) => {
            let present = wired.quantity(&handle.name, handle.order).ok_or_else(none)?;
            let slope = wired.slope(handle, *index).ok_or_else(none)?;
            point.states[*index] += (value - present) / slope;
        }
    }
    moved_to(&wired, point, given)
}

/// A circuit at another point.
///
/// # Errors
/// If a loop without an integrator has no single solution there.
fn moved_to<'a>(
    wired: &Wired<'a>,
    point: ProgramPoint,
    given: BTreeMap<Register, f64>,
) -> Result<Wired<'a>, TestError> {
    wired.at(point, given).ok_or_else(no_solution)
}

/// The error if a loop has no single solution.
fn no_solution() -> TestError {
    TestError::NoVoltages("a loop without an integrator does not have exactly one solution".to_owned())
}

/// The error of a machine.
fn no_voltages(error: RunError) -> TestError {
    TestError::NoVoltages(error.to_string())
}
