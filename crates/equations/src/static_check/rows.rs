//! The rows of a static check: every output and every derivative, expected and wired.

use patchcord_core::elements::{Family, OutputStage};
use patchcord_core::ir::{Register, SignalInfo};

use super::causes::Causes;
use super::expected::{Determined, Expected, determined};
use super::handles::Handle;
use super::row::{RowQuantity, RowSource, StaticRow};
use super::solution::{Origin, Solution};
use super::test_point::test_unit;
use super::tolerances::{Tolerances, in_machine_time};
use super::wired::Wired;
use crate::notation::primed;
use crate::operating_point::OVERLOAD;

/// All rows: outputs of amplifiers, other outputs, derivatives. Each part is in the order of signal flow. `wired` is the
/// circuit at the test values. `solution` has the values of the equations there; `None` if there are no equations.
pub(super) fn rows(wired: &Wired<'_>, solution: Option<&Solution<'_>>) -> Vec<StaticRow> {
    let tolerances = Tolerances::new(wired);
    let deepest = solution.map_or(0, deepest_derivative);
    let expected = solution.map(|solution| Expected::new(wired, solution, &tolerances));
    let overloads = Causes::overloads(wired, deepest);
    let limits = Causes::limits(wired, &tolerances, deepest);
    let table = Table { wired, solution, expected, tolerances, overloads, limits };
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

/// The largest number of derivatives of a quantity in a row.
fn deepest_derivative(solution: &Solution<'_>) -> usize {
    let rates = solution.handles.iter().flatten().map(|handle| handle.order + 1);
    let stated = solution.stated_derivatives().into_iter().map(|(_, order)| order);
    rates.chain(stated).max().unwrap_or(0)
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

/// Makes rows.
struct Table<'a> {
    wired: &'a Wired<'a>,
    solution: Option<&'a Solution<'a>>,
    /// The expected voltages. `None` if there are no equations.
    expected: Option<Expected>,
    tolerances: Tolerances<'a>,
    /// The overloaded amplifiers. Rows that depend on them are not compared.
    overloads: Causes,
    /// The elements outside their range. A difference that depends on them says nothing.
    limits: Causes,
}

/// A derivative that the equations give.
struct StatedRate {
    /// Its value in volts per machine second.
    rate: f64,
    /// The size of the terms of its equation, in volts per machine second.
    size: f64,
    /// The quantity with its value.
    quantity: Option<RowQuantity>,
    /// The stated equations behind it.
    equations: Vec<usize>,
}

impl Table<'_> {
    /// The rows of an element's output: one for each signal there that the equations determine, otherwise one.
    fn outputs(&self, element: usize, place: usize) -> Vec<StaticRow> {
        let register = self.register(element);
        let signals = self.wired.program.signals().iter();
        let signals: Vec<&SignalInfo> =
            signals.filter(|signal| signal.is_named && signal.register == register).collect();
        let determined = signals.iter().filter_map(|signal| {
            let solution = self.solution?;
            let found = determined(self.wired, solution, signal)?;
            let mut row = self.determined_output(element, place, signal, &found);
            row.equations = solution.equations_behind(&signal.name, 0);
            Some(row)
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
        row.differs = !self.tolerances.output_agrees(element, found.volts, found.size);
        self.judged(row, &[(self.register(element), 0)])
    }

    /// The row of another output.
    fn other_output(&self, element: usize, place: usize, signal: Option<&SignalInfo>) -> StaticRow {
        let mut row = self.row(element, place);
        let register = self.register(element);
        row.expected = self.expected_volts(register);
        row.source = self.output_source(register, signal);
        row.quantity = signal.and_then(|signal| {
            let (_, per_volt) = self.wired.place(&signal.name)?;
            self.quantity(&signal.name, 0, row.expected.map(|volts| volts * per_volt))
        });
        if let Some(handle) = self.handle_at(register) {
            row.equations = self.equations_behind(handle, 0);
        }
        let disagrees = |expected: f64| !self.tolerances.output_agrees(element, expected, 0.0);
        row.differs = self.inputs_differ(register) && row.expected.is_some_and(disagrees);
        self.judged(row, &[(register, 0)])
    }

    /// Where the expected voltage of an output comes from whose signal the equations do not determine.
    fn output_source(&self, register: Register, signal: Option<&SignalInfo>) -> RowSource {
        let Some(solution) = self.solution else { return RowSource::NoEquations };
        let known = signal.and_then(|signal| solution.quantity(&signal.name, 0));
        let is_test_value = known.is_some_and(|known| known.origin == Origin::Test);
        let is_state = self.wired.state_at(register).is_some();
        if is_state || is_test_value { RowSource::TestValue } else { RowSource::Inputs }
    }

    /// The row of the derivative of a state.
    fn derivative(&self, state: usize, place: usize) -> StaticRow {
        let law = &self.wired.program.state_laws()[state];
        let mut row = self.row(law.element, place);
        row.order = 1;
        row.is_overloaded = false;
        row.wired = self.machine_rate(self.wired.volts(law.demand));
        if self.solution.is_none() {
            row.source = RowSource::NoEquations;
            return row;
        }
        if self.is_held(law.element) {
            row.source = RowSource::Held;
            return row;
        }
        let error = self.machine_rate(self.wired.amplification_error(law.demand));
        let inputs = self.tolerances.input_size(law.element, 1);
        if let Some(stated) = self.stated_rate(state, row.wired) {
            let StatedRate { rate, size, quantity, equations } = stated;
            (row.expected, row.quantity, row.source) = (Some(rate), quantity, RowSource::Equations);
            row.equations = equations;
            row.differs = !Tolerances::agree([rate, row.wired], size.max(inputs), error);
        } else {
            row.expected = self.expected_volts(law.demand).map(|rate| self.machine_rate(rate));
            row.source = RowSource::Inputs;
            let disagrees = |expected: f64| !Tolerances::agree([expected, row.wired], inputs, error);
            row.differs = self.inputs_differ(law.demand) && row.expected.is_some_and(disagrees);
        }
        let quantity = self.handle(state).and_then(|handle| self.quantity_place(handle, 1));
        let dependences: Vec<_> = std::iter::once((law.demand, 0)).chain(quantity).collect();
        self.judged(row, &dependences)
    }

    /// The derivative of a state that the equations give. `wired` is that of the wiring in volts per machine second.
    fn stated_rate(&self, state: usize, wired: f64) -> Option<StatedRate> {
        let (solution, handle) = (self.solution?, self.handle(state)?);
        let order = handle.order + 1;
        let known = solution.quantity(&handle.name, order)?;
        let own = self.wired.quantity(&handle.name, order)?;
        let slope = self.wired.slope(handle, state)?;
        (known.origin == Origin::Equations).then(|| StatedRate {
            rate: wired + self.machine_rate((known.value - own) / slope),
            size: self.machine_rate(known.size / slope.abs()),
            quantity: self.quantity(&handle.name, order, Some(known.value)),
            equations: self.equations_behind(handle, 1),
        })
    }

    /// The derivatives in the equations that no integrator has as its rate, if they differ from those of the wiring.
    fn other_derivatives(&self, place: usize) -> Vec<StaticRow> {
        let Some(solution) = self.solution else { return Vec::new() };
        let derivatives = solution.stated_derivatives().into_iter();
        let rows = derivatives.filter_map(|(name, order)| {
            let handle = Handle { name, order };
            self.other_derivative(solution, &handle, place)
        });
        rows.filter(|row| row.differs).collect()
    }

    /// The row of a derivative of a signal.
    fn other_derivative(
        &self,
        solution: &Solution<'_>,
        derivative: &Handle,
        place: usize,
    ) -> Option<StaticRow> {
        let Handle { name, order } = derivative;
        let (register, per_volt) = self.wired.place(name).filter(|(_, per_volt)| *per_volt != 0.0)?;
        let element = self.wired.element_at(register)?;
        let known = solution.quantity(name, *order)?;
        let own = self.wired.quantity(name, *order).filter(|own| own.is_finite())?;
        let in_volts = |value: f64| in_machine_time(value / per_volt, *order, self.wired);
        let mut row = self.row(element, place);
        (row.order, row.is_overloaded) = (*order, false);
        let expected = in_volts(known.value);
        (row.wired, row.expected, row.source) = (in_volts(own), Some(expected), RowSource::Equations);
        row.quantity = self.quantity(name, *order, Some(known.value));
        row.equations = self.equations_behind(derivative, 0);
        let size = in_volts(known.size).abs().max(self.tolerances.input_size(element, *order));
        // The error of the output is known. That of its derivative has about the same share in it.
        let share = self.wired.amplification_error(register) / self.wired.volts(register).abs();
        let error = if share > 0.0 { share * size } else { 0.0 };
        row.differs = !Tolerances::agree([expected, row.wired], size, error);
        Some(self.judged(row, &[(register, *order)]))
    }

    /// A row with the voltages of the wiring, and nothing else yet.
    fn row(&self, element: usize, place: usize) -> StaticRow {
        let entry = self.wired.circuit.element(element);
        let elements = &self.wired.circuit.patch().elements;
        StaticRow {
            element: entry.name.clone(),
            kind: entry.kind.name,
            note: elements.get(&entry.name).map(|element| element.note.clone()).unwrap_or_default(),
            order: 0,
            quantity: None,
            expected: None,
            wired: self.wired.volts(self.register(element)),
            source: RowSource::NoEquations,
            differs: false,
            not_compared: None,
            equations: Vec::new(),
            is_overloaded: self.is_overloaded(element),
            place,
        }
    }

    /// The row, without a difference if it cannot be compared. `dependences` are the registers on which it depends, each
    /// with a number of derivatives.
    fn judged(&self, mut row: StaticRow, dependences: &[(Register, usize)]) -> StaticRow {
        let behind = |causes: &Causes| {
            let mut clauses = dependences.iter().filter_map(|(at, order)| causes.behind(*at, *order));
            clauses.next().map(str::to_owned)
        };
        if row.expected.is_some() {
            let limit = if row.differs { behind(&self.limits) } else { None };
            row.not_compared = behind(&self.overloads).or(limit);
        }
        row.differs &= row.not_compared.is_none();
        row
    }

    /// The quantity of a row with its unit. `expected` is in SI.
    fn quantity(&self, name: &str, order: usize, expected: Option<f64>) -> Option<RowQuantity> {
        let name_with_primes = primed(name, order);
        let unit = test_unit(self.wired.circuit, &name_with_primes)?;
        let wired = unit.out_of_si(self.wired.quantity(name, order)?);
        let expected = expected.map(|value| unit.out_of_si(value));
        Some(RowQuantity { name: name_with_primes, unit: unit.text().to_owned(), expected, wired })
    }

    /// The output of an element.
    fn register(&self, element: usize) -> Register {
        self.wired.program.element_outputs()[element].register
    }

    /// The quantity by which the equations know a state.
    fn handle(&self, state: usize) -> Option<&Handle> {
        self.solution?.handles[state].as_ref()
    }

    /// The quantity by which the equations know the state at an output.
    fn handle_at(&self, register: Register) -> Option<&Handle> {
        self.handle(self.wired.state_at(register)?)
    }

    /// The register of a quantity with further derivatives, and the number of its derivatives.
    fn quantity_place(&self, handle: &Handle, further: usize) -> Option<(Register, usize)> {
        let (register, _) = self.wired.place(&handle.name)?;
        Some((register, handle.order + further))
    }

    /// The stated equations behind a quantity with further derivatives.
    fn equations_behind(&self, handle: &Handle, further: usize) -> Vec<usize> {
        let solution = self.solution;
        solution
            .map(|solution| solution.equations_behind(&handle.name, handle.order + further))
            .unwrap_or_default()
    }

    /// The expected voltage of a register.
    fn expected_volts(&self, register: Register) -> Option<f64> {
        let voltages = self.expected.as_ref()?.voltages.as_ref()?;
        Some(voltages[register.index()])
    }

    /// Whether an output in front of a register differs from the equations.
    fn inputs_differ(&self, register: Register) -> bool {
        self.expected.as_ref().is_some_and(|expected| expected.differs(register))
    }

    /// A rate in volts per machine second, from one in volts per problem second.
    fn machine_rate(&self, rate: f64) -> f64 {
        in_machine_time(rate, 1, self.wired)
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
