//! The static check of the trade: every output and every derivative at test values, expected and wired.
//!
//! The test values are those of the integrators. The stated equations give the values of all quantities there. An output
//! whose signal is among them is expected at this value, and an integrator at the derivative that the equations give.
//! The expected value of any other output follows from the expected values at its inputs by its own law. So a wrong gain
//! shows at the first named output, or at the first derivative, after it. That row is the place to look at.
//!
//! A value that depends on an overloaded amplifier is not compared: the equations do not have its limit.

mod agenda;
mod causes;
mod expected;
mod handles;
mod random;
mod row;
mod rows;
mod solution;
pub(crate) mod stated;
mod test_point;
mod tolerances;
mod wired;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;

use crate::fixes::Fix;
use handles::{Handle, handles};
pub use row::{RowQuantity, RowSource, StaticRow};
use solution::Solution;
pub use test_point::{TestError, TestValues, test_unit};
use wired::Wired;

/// A static check: what the outputs and derivatives of a circuit should be at test values, and what they are.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticCheck {
    /// The test values. Empty for the initial condition.
    pub values: Vec<TestValue>,
    /// The outputs of amplifiers, the other outputs, and the derivatives, each in the order of signal flow.
    pub rows: Vec<StaticRow>,
    /// Whether the patch states equations. Otherwise the rows have no expected values.
    pub has_equations: bool,
    /// Whether the test values are random. If a row is overloaded then, no random values without an overload were found.
    pub is_random: bool,
}

/// A test value.
#[derive(Debug, Clone, PartialEq)]
pub struct TestValue {
    /// The quantity, such as x or x'; an integrator if no signal represents it.
    pub name: String,
    /// The value in the unit.
    pub value: f64,
    /// The unit.
    pub unit: String,
}

impl StaticCheck {
    /// The rows whose expected and wired values differ.
    pub fn differences(&self) -> impl Iterator<Item = &StaticRow> {
        self.rows.iter().filter(|row| row.differs)
    }

    /// The first of these rows in the order of signal flow: the place to look at. An output that only follows from its
    /// inputs comes after the others.
    pub fn first_difference(&self) -> Option<&StaticRow> {
        self.differences().min_by_key(|row| (row.source == RowSource::Inputs, row.place))
    }

    /// The most likely correction of the first difference, as a command. `fixes` are the single changes after which the
    /// wiring solves its equations, as from [`equation_fixes`](crate::equation_fixes), the likeliest first. Only those
    /// count after which it solves the equation of this row, or else an equation of the quantities in it. `None` if
    /// nothing differs.
    pub fn likely_correction(&self, fixes: &[Fix]) -> Option<String> {
        let row = self.first_difference()?;
        let corrects = |equation: &usize| fixes.iter().find(|fix| fix.solves.contains(equation));
        Some(match row.equations.iter().find_map(corrects) {
            Some(fix) => fix.description.clone(),
            None => {
                let output = if row.order == 0 { "gains" } else { "inputs" };
                format!("examine the {output} of {} and the wiring in front of it", row.element)
            }
        })
    }
}

/// Compares every output and every derivative of a circuit with its stated equations, at test values.
///
/// # Errors
/// If a test value is not that of a quantity that can be set, or if the voltages cannot be computed there.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::Patch;
/// use patchcord_equations::{TestValues, static_check};
///
/// // The equation needs a gain of 2 V/s per volt. The wiring has 0.2 V/s per volt.
/// let text = r#"{"patchcord": 1, "equations": ["x' = -2 x"],
///   "scales": {"length": {"per_volt": 1, "unit": "1"}},
///   "elements": {"P1": {"kind": "pot", "in": "A1", "setting": 0.2},
///                "A1": {"kind": "integrator", "in": {"x1": ["P1"]}, "initial": 50}},
///   "signals": {"x": {"at": "A1", "scale": "length"}}}"#;
/// let circuit = Circuit::new(&Patch::parse("decay.json", text)?)?;
/// let values = TestValues::Given(vec![("x".to_owned(), 10.0)]);
/// let check = static_check(&circuit, &Program::new(&circuit)?, &values)?;
/// let place = check.first_difference().expect("0.2 is not 2");
/// assert_eq!((place.element.as_str(), place.order), ("A1", 1));
/// assert!((place.expected.unwrap_or_default() + 20.0).abs() < 1e-6);
/// assert!((place.wired + 2.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn static_check(
    circuit: &Circuit,
    program: &Program,
    values: &TestValues,
) -> Result<StaticCheck, TestError> {
    let handles = handles(circuit, program);
    let wired = match values {
        TestValues::Initial => test_point::initial(circuit, program),
        TestValues::Given(values) => test_point::given(circuit, program, &handles, values),
        TestValues::Random(seed) => random::random(circuit, program, *seed),
    }?;
    let has_equations = !circuit.equations().is_empty();
    let is_initial = *values == TestValues::Initial;
    let solution = has_equations.then(|| Solution::new(&wired, &handles, is_initial));
    let rows = rows::rows(&wired, solution.as_ref());
    let is_random = matches!(values, TestValues::Random(_));
    Ok(StaticCheck { values: listed(&wired, &handles, values), rows, has_equations, is_random })
}

/// The test values with their units. Of random values, those of all states and drives.
fn listed(wired: &Wired<'_>, handles: &[Vec<Handle>], values: &TestValues) -> Vec<TestValue> {
    let in_unit = |name: String, value: f64| {
        let unit = test_unit(wired.circuit, &name)?;
        Some(TestValue { value: unit.out_of_si(value), unit: unit.text().to_owned(), name })
    };
    match values {
        TestValues::Initial => Vec::new(),
        TestValues::Given(values) => {
            values.iter().filter_map(|(name, value)| in_unit(name.clone(), *value)).collect()
        }
        TestValues::Random(_) => {
            let outputs = wired.program.element_outputs();
            let states = wired.program.state_laws().iter().zip(handles).map(|(state, of_state)| {
                let volts = || Handle { name: outputs[state.element].name.clone(), order: 0 };
                of_state.first().cloned().unwrap_or_else(volts)
            });
            let drives = outputs.iter().filter(|output| wired.given.contains_key(&output.register));
            let drives = drives.map(|output| Handle { name: output.name.clone(), order: 0 });
            let known = states.chain(drives);
            known.filter_map(|of| in_unit(of.text(), wired.quantity(&of.name, of.order)?)).collect()
        }
    }
}

#[cfg(test)]
mod tests;
