//! The rows of a static check: every output and every derivative, expected and wired.

use patchcord_core::elements::{Family, OutputStage};
use patchcord_core::ir::{Register, SignalInfo};

use super::solution::{Origin, Solution};
use super::test_point::test_unit;
use super::wired::Wired;
use crate::notation::primed;

/// Deviation of a wired voltage from the expected one, as a share of the larger one or of the sum of the inputs, up to
/// which they agree. Settings are often rounded to three digits.
const TOLERANCE: f64 = 1e-3;
/// Deviation in volts, or in volts per machine second, that is never a difference.
const ROUNDING: f64 = 1e-6;
/// Demanded output above which an amplifier is overloaded, in volts.
const OVERLOAD: f64 = 100.0 * (1.0 + 1e-6);

/// A row of a static check: the output of an element, or the derivative of an integrator or a lag.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticRow {
    /// Name of the element.
    pub element: String,
    /// Its kind, such as "summer".
    pub kind: &'static str,
    /// Its note in the patch; empty if it has none.
    pub note: String,
    /// Number of derivatives: 0 for an output in volts, 1 for a derivative in volts per machine second.
    pub order: usize,
    /// The quantity that the row represents. `None` if there is no signal for it.
    pub quantity: Option<RowQuantity>,
    /// The expected value in volts, or in volts per machine second. `None` if the patch states no equations, or if a
    /// brake, a stop or a reset holds the output.
    pub expected: Option<f64>,
    /// The value in the wiring, without the limit of the amplifier.
    pub wired: f64,
    /// Where the expected value comes from.
    pub source: RowSource,
    /// Whether the two values differ.
    pub differs: bool,
    /// Whether the output demands more than 100 V.
    pub is_overloaded: bool,
    /// Place in the order of signal flow. Derivatives come after all outputs.
    pub place: usize,
}

/// The quantity of a row.
#[derive(Debug, Clone, PartialEq)]
pub struct RowQuantity {
    /// Its name, such as x or x'.
    pub name: String,
    /// Its unit, such as mm/s. Derivatives are by problem time.
    pub unit: String,
    /// The expected value in this unit. `None` if there is no expected voltage.
    pub expected: Option<f64>,
    /// The value in the wiring in this unit.
    pub wired: f64,
}

/// Where an expected value comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RowSource {
    /// It is a test value or an initial value.
    TestValue,
    /// The stated equations give it.
    Equations,
    /// The law of the element gives it from the expected values at its inputs.
    Inputs,
    /// There is none, because a brake, a stop or a reset holds the output.
    Held,
    /// There is none, because the patch states no equations.
    NoEquations,
}

/// All rows: outputs of amplifiers, other outputs, derivatives. Each part is in the order of signal flow. `wired` is the
/// circuit at the test values. `solution` has the values of the equations there; `None` if there are no equations.
pub(super) fn rows(wired: &Wired<'_>, solution: Option<&Solution<'_>>) -> Vec<StaticRow> {
    let expected = solution.and_then(|solution| expected_voltages(wired, solution));
    let table = Table { wired, solution, expected };
    let elements = elements(wired);
    let outputs = elements.iter().flat_map(|(place, element)| table.outputs(*element, *place));
    let mut rows: Vec<StaticRow> = outputs.collect();
    let states = wired.program.state_laws().len();
    rows.extend((0..states).map(|state| table.derivative(state, elements.len() + state)));
    if !rows.iter().any(|row| row.differs) {
        rows.extend(table.other_derivatives(elements.len() + states));
    }
    rows
}

/// The elements without drives and references, each after its place in the order of signal flow. Amplifiers come first.
fn elements(wired: &Wired<'_>) -> Vec<(usize, usize)> {
    let kind = |element: usize| wired.circuit.element(element).kind;
    let steps = wired.circuit.evaluation_order().iter();
    let computing = steps
        .flat_map(|step| step.members().iter().copied())
        .filter(|element| kind(*element).family == Family::Computing);
    let mut elements: Vec<(usize, usize)> = computing.enumerate().collect();
    elements.sort_by_key(|(_, element)| kind(*element).output == OutputStage::Passive);
    elements
}

/// The voltages of all registers that follow from the equations: named outputs have their values in the equations, and
/// the others follow from their inputs. `None` if a loop has no single solution.
fn expected_voltages(wired: &Wired<'_>, solution: &Solution<'_>) -> Option<Vec<f64>> {
    let (mut point, mut given) = (wired.point.clone(), wired.given.clone());
    for (state, handle) in solution.handles.iter().enumerate() {
        let Some(handle) = handle else { continue };
        let stated = solution.quantity(&handle.name, handle.order);
        if let (Some((value, Origin::Equations)), Some(own), Some(slope)) =
            (stated, wired.quantity(&handle.name, handle.order), wired.slope(handle, state))
        {
            point.states[state] += (value - own) / slope;
        }
    }
    for signal in wired.program.signals().iter().filter(|signal| signal.is_named) {
        if let Some(determined) = determined(wired, solution, signal)
            && !is_state(wired, signal.register)
        {
            given.entry(signal.register).or_insert(determined.volts);
        }
    }
    wired.program.unlimited_voltages_at(&point, &given)
}

/// Whether a register is the output of an element with a state.
fn is_state(wired: &Wired<'_>, register: Register) -> bool {
    let outputs = wired.program.element_outputs();
    wired.program.state_laws().iter().any(|state| outputs[state.element].register == register)
}

/// A signal whose value the equations determine.
struct Determined {
    /// Its value in SI.
    value: f64,
    /// The voltage that represents it.
    volts: f64,
}

/// The value of a signal if the equations determine it. A scale of 0 represents nothing.
fn determined(wired: &Wired<'_>, solution: &Solution<'_>, signal: &SignalInfo) -> Option<Determined> {
    let (_, per_volt) = wired.place(&signal.name)?;
    match solution.quantity(&signal.name, 0)? {
        (value, Origin::Equations) if per_volt != 0.0 => Some(Determined { value, volts: value / per_volt }),
        _ => None,
    }
}

/// Makes rows.
struct Table<'a> {
    wired: &'a Wired<'a>,
    solution: Option<&'a Solution<'a>>,
    /// The expected voltages of all registers.
    expected: Option<Vec<f64>>,
}

impl Table<'_> {
    /// The rows of an element's output: one for each signal there that the equations determine, otherwise one.
    fn outputs(&self, element: usize, place: usize) -> Vec<StaticRow> {
        let register = self.wired.program.element_outputs()[element].register;
        let signals = self.wired.program.signals().iter();
        let signals: Vec<&SignalInfo> =
            signals.filter(|signal| signal.is_named && signal.register == register).collect();
        let determined = signals.iter().filter_map(|signal| {
            let found = determined(self.wired, self.solution?, signal)?;
            Some(self.determined_output(element, place, signal, &found))
        });
        let rows: Vec<StaticRow> = determined.collect();
        if rows.is_empty() { vec![self.other_output(element, place, signals.first().copied())] } else { rows }
    }

    /// The row of an output whose signal the equations determine.
    fn determined_output(
        &self,
        element: usize,
        place: usize,
        signal: &SignalInfo,
        found: &Determined,
    ) -> StaticRow {
        let mut row = self.row(element, place);
        row.expected = Some(found.volts);
        row.source = RowSource::Equations;
        row.quantity = self.quantity(&signal.name, 0, Some(found.value));
        self.with_difference(row, self.input_size(element))
    }

    /// The row of another output.
    fn other_output(&self, element: usize, place: usize, signal: Option<&SignalInfo>) -> StaticRow {
        let mut row = self.row(element, place);
        let register = self.wired.program.element_outputs()[element].register;
        row.expected = self.expected.as_ref().map(|expected| expected[register.index()]);
        row.source = self.output_source(register, signal);
        row.quantity = signal.and_then(|signal| {
            let (_, per_volt) = self.wired.place(&signal.name)?;
            self.quantity(&signal.name, 0, row.expected.map(|volts| volts * per_volt))
        });
        let inputs = if is_state(self.wired, register) { 0.0 } else { self.input_size(element) };
        self.with_difference(row, inputs)
    }

    /// Where the expected voltage of an output comes from whose signal the equations do not determine.
    fn output_source(&self, register: Register, signal: Option<&SignalInfo>) -> RowSource {
        let Some(solution) = self.solution else { return RowSource::NoEquations };
        let origin = signal.and_then(|signal| solution.quantity(&signal.name, 0));
        let is_test_value = is_state(self.wired, register) || matches!(origin, Some((_, Origin::Test)));
        if is_test_value { RowSource::TestValue } else { RowSource::Inputs }
    }

    /// The row of the derivative of a state.
    fn derivative(&self, state: usize, place: usize) -> StaticRow {
        let law = &self.wired.program.state_laws()[state];
        let mut row = self.row(law.element, place);
        row.order = 1;
        row.is_overloaded = false;
        row.wired = self.machine_rate(self.wired.volts(law.demand));
        let inputs = self.expected.as_ref().map(|expected| self.machine_rate(expected[law.demand.index()]));
        if self.solution.is_none() {
            row.source = RowSource::NoEquations;
        } else if self.is_held(law.element) {
            row.source = RowSource::Held;
        } else if let Some((volts, quantity)) = self.stated_rate(state, row.wired) {
            (row.expected, row.quantity, row.source) = (Some(volts), quantity, RowSource::Equations);
        } else {
            (row.expected, row.source) = (inputs, RowSource::Inputs);
        }
        let inputs = self.input_size(law.element);
        self.with_difference(row, inputs)
    }

    /// The derivative of a state in volts per machine second that the equations give, with its quantity. `wired` is that
    /// of the wiring.
    fn stated_rate(&self, state: usize, wired: f64) -> Option<(f64, Option<RowQuantity>)> {
        let solution = self.solution?;
        let handle = solution.handles[state].as_ref()?;
        let order = handle.order + 1;
        let (value, origin) = solution.quantity(&handle.name, order)?;
        let own = self.wired.quantity(&handle.name, order)?;
        let slope = self.wired.slope(handle, state)?;
        let rate = wired + self.machine_rate((value - own) / slope);
        (origin == Origin::Equations).then(|| (rate, self.quantity(&handle.name, order, Some(value))))
    }

    /// The derivatives in the equations that no integrator has as its rate, if they differ from those of the wiring.
    fn other_derivatives(&self, place: usize) -> Vec<StaticRow> {
        let Some(solution) = self.solution else { return Vec::new() };
        let derivatives = solution.stated_derivatives().into_iter();
        let rows = derivatives.filter_map(|(name, order)| self.other_derivative(&name, order, place));
        rows.filter(|row| row.differs).collect()
    }

    /// The row of a derivative of a signal.
    fn other_derivative(&self, name: &str, order: usize, place: usize) -> Option<StaticRow> {
        let (register, per_volt) = self.wired.place(name).filter(|(_, per_volt)| *per_volt != 0.0)?;
        let outputs = self.wired.program.element_outputs();
        let element = outputs.iter().position(|output| output.register == register)?;
        let (value, _) = self.solution?.quantity(name, order)?;
        let own = self.wired.quantity(name, order).filter(|own| own.is_finite())?;
        let in_volts = |value: f64| (0..order).fold(value / per_volt, |volts, _| self.machine_rate(volts));
        let mut row = self.row(element, place);
        (row.order, row.is_overloaded) = (order, false);
        (row.wired, row.expected, row.source) = (in_volts(own), Some(in_volts(value)), RowSource::Equations);
        row.quantity = self.quantity(name, order, Some(value));
        let fastest = self.machine_rate(self.wired.fastest_rate());
        Some(self.with_difference(row, fastest.powi(order as i32)))
    }

    /// A row with the voltages of the wiring, and nothing else yet.
    fn row(&self, element: usize, place: usize) -> StaticRow {
        let entry = self.wired.circuit.element(element);
        let elements = &self.wired.circuit.patch().elements;
        let register = self.wired.program.element_outputs()[element].register;
        StaticRow {
            element: entry.name.clone(),
            kind: entry.kind.name,
            note: elements.get(&entry.name).map(|element| element.note.clone()).unwrap_or_default(),
            order: 0,
            quantity: None,
            expected: None,
            wired: self.wired.volts(register),
            source: RowSource::NoEquations,
            differs: false,
            is_overloaded: self.is_overloaded(element),
            place,
        }
    }

    /// The quantity of a row with its unit. `expected` is in SI.
    fn quantity(&self, name: &str, order: usize, expected: Option<f64>) -> Option<RowQuantity> {
        let name_with_primes = primed(name, order);
        let unit = test_unit(self.wired.circuit, &name_with_primes)?;
        let wired = unit.out_of_si(self.wired.quantity(name, order)?);
        let expected = expected.map(|value| unit.out_of_si(value));
        Some(RowQuantity { name: name_with_primes, unit: unit.text().to_owned(), expected, wired })
    }

    /// The row, marked if its values differ. `inputs` is the size of what the element adds up: a small sum of large
    /// inputs has few digits.
    fn with_difference(&self, mut row: StaticRow, inputs: f64) -> StaticRow {
        let size = row.expected.unwrap_or_default().abs().max(row.wired.abs()).max(inputs);
        let differs = |expected: f64| {
            let is_near = (expected - row.wired).abs() <= TOLERANCE * size + ROUNDING;
            !is_near
        };
        row.differs = row.expected.is_some_and(differs);
        row
    }

    /// A rate in volts per machine second, from one in volts per problem second.
    fn machine_rate(&self, rate: f64) -> f64 {
        rate / self.wired.program.time_scale()
    }

    /// The sum of the sizes of an element's inputs, each times its gain, in volts. 0 if its jacks have no gains.
    fn input_size(&self, element: usize) -> f64 {
        if !self.wired.circuit.element(element).kind.has_gains() {
            return 0.0;
        }
        let outputs = self.wired.program.element_outputs();
        let cords = self.wired.circuit.cords(element).into_iter().filter(|(_, cord)| cord.input == 0);
        cords.map(|(from, cord)| (cord.gain * self.wired.volts(outputs[from].register)).abs()).sum()
    }

    /// Whether an element demands more than 100 V: by its lamp, or by its state.
    fn is_overloaded(&self, element: usize) -> bool {
        let program = self.wired.program;
        let mut lamps = program.lamps().iter().filter(|lamp| lamp.element == element);
        let mut states = program.state_laws().iter().zip(&self.wired.point.states);
        lamps.any(|lamp| self.wired.volts(lamp.demand).abs() > OVERLOAD)
            || states.any(|(law, volts)| law.element == element && volts.abs() > OVERLOAD)
    }

    /// Whether a brake, a stop or a reset holds the output of an element.
    fn is_held(&self, element: usize) -> bool {
        let modes = self.wired.program.modes().iter().zip(&self.wired.point.modes);
        let mut own = modes.filter(|(mode, _)| mode.element == element);
        own.any(|(mode, value)| match mode.names.mode {
            "brake" => *value == 0.0,
            "contact" => value.abs() > 1.5,
            "reset" => *value != 0.0,
            _ => false,
        })
    }
}
