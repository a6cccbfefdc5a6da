//! The wiring at a point: the voltage of every output, and the value and derivatives of every signal.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{MAX_DERIVATIVE, Program, ProgramPoint, Register};

use super::handles::Handle;

/// Distances in volts by which all states move, for the slopes of quantities. The first one is taken at which all loops
/// have a solution.
const DISTANCES: [f64; 2] = [1.0, 1e-3];

/// A circuit at a point. Amplifiers outside loops are not limited.
///
/// Derivatives are exact up to rounding, because they follow from Taylor series of the program's operations.
pub(super) struct Wired<'a> {
    /// The circuit.
    pub circuit: &'a Circuit,
    /// Its program.
    pub program: &'a Program,
    /// The point.
    pub point: ProgramPoint,
    /// The voltages of drives that the test sets.
    pub given: BTreeMap<Register, f64>,
    /// The values of all registers at the point.
    pub voltages: Vec<f64>,
    /// The names of the outputs.
    places: Rc<Places<'a>>,
    /// The derivatives of all registers by problem time, in volts. They are computed when they are first needed.
    derivatives: OnceCell<Vec<Vec<f64>>>,
    /// By how much every voltage would differ with infinite amplification, in volts; computed when it is first needed.
    errors: OnceCell<Vec<f64>>,
    /// The machine with all states nearer to 0. It is evaluated when it is first needed.
    moved: OnceCell<Option<Moved>>,
}

/// A machine whose states have moved a little.
struct Moved {
    /// The voltages of the states.
    states: Vec<f64>,
    /// The derivatives of all registers by problem time, in volts, from order 0.
    derivatives: Vec<Vec<f64>>,
}

/// The names of the outputs of a program.
struct Places<'a> {
    /// Register and value per volt, in SI, of every signal, drive and element.
    signals: BTreeMap<&'a str, (Register, f64)>,
    /// The element at every output.
    elements: BTreeMap<Register, usize>,
}

impl<'a> Places<'a> {
    /// The outputs of a program.
    fn new(program: &'a Program) -> Self {
        let coefficients = program.coefficient_values();
        let mut signals = BTreeMap::new();
        for signal in program.signals() {
            let per_volt = signal.per_volt.map_or(1.0, |index| coefficients[index as usize]);
            // A signal comes before an element of the same name.
            signals.entry(signal.name.as_str()).or_insert((signal.register, per_volt));
        }
        let outputs = program.element_outputs().iter().enumerate();
        Places { signals, elements: outputs.map(|(element, output)| (output.register, element)).collect() }
    }
}

impl<'a> Wired<'a> {
    /// The circuit at a point. `None` if a loop without an integrator has no single solution there.
    pub(super) fn new(
        circuit: &'a Circuit,
        program: &'a Program,
        point: ProgramPoint,
        given: BTreeMap<Register, f64>,
    ) -> Option<Self> {
        Self::at_places(circuit, program, &Rc::new(Places::new(program)), (point, given))
    }

    /// The same circuit at another point. `None` if a loop without an integrator has no single solution there.
    pub(super) fn at(&self, point: ProgramPoint, given: BTreeMap<Register, f64>) -> Option<Self> {
        Self::at_places(self.circuit, self.program, &self.places, (point, given))
    }

    /// The circuit at a point with given voltages of drives. `None` if a loop has no single solution there.
    fn at_places(
        circuit: &'a Circuit,
        program: &'a Program,
        places: &Rc<Places<'a>>,
        (point, given): (ProgramPoint, BTreeMap<Register, f64>),
    ) -> Option<Self> {
        let voltages = program.unlimited_voltages_at(&point, &given)?;
        let places = Rc::clone(places);
        let (derivatives, errors, moved) = (OnceCell::new(), OnceCell::new(), OnceCell::new());
        Some(Wired { circuit, program, point, given, voltages, places, derivatives, errors, moved })
    }

    /// The register of a signal, drive or element, and its value at 1 V in SI.
    pub(super) fn place(&self, name: &str) -> Option<(Register, f64)> {
        self.places.signals.get(name).copied()
    }

    /// The element whose output has a register.
    pub(super) fn element_at(&self, register: Register) -> Option<usize> {
        self.places.elements.get(&register).copied()
    }

    /// Whether an output is that of a drive.
    pub(super) fn is_drive(&self, register: Register) -> bool {
        self.program.drive_registers().contains(&register)
    }

    /// The index of the state whose output has a register.
    pub(super) fn state_at(&self, register: Register) -> Option<usize> {
        let outputs = self.program.element_outputs();
        self.program.state_laws().iter().position(|state| outputs[state.element].register == register)
    }

    /// The voltage of a register.
    pub(super) fn volts(&self, register: Register) -> f64 {
        self.voltages[register.index()]
    }

    /// A derivative of the voltage of a register by problem time; the voltage itself for order 0. `None` if the order is
    /// above [`MAX_DERIVATIVE`].
    pub(super) fn derivative(&self, register: Register, order: usize) -> Option<f64> {
        if order == 0 {
            return Some(self.volts(register));
        }
        let derivatives = self.derivatives.get_or_init(|| {
            self.program.derivatives_at(&self.point, &self.given, &self.voltages, MAX_DERIVATIVE)
        });
        Some(derivatives.get(order)?[register.index()])
    }

    /// The value of a quantity in SI, with this number of derivatives. `None` if the wiring has no such signal, or if
    /// there are too many derivatives.
    pub(super) fn quantity(&self, name: &str, order: usize) -> Option<f64> {
        let (register, per_volt) = self.place(name)?;
        Some(self.derivative(register, order)? * per_volt)
    }

    /// Size of the error in the voltage of a register because open amplifiers have a finite amplification.
    pub(super) fn amplification_error(&self, register: Register) -> f64 {
        let errors = self
            .errors
            .get_or_init(|| self.program.amplification_errors_at(&self.point, &self.given, &self.voltages));
        let error = errors[register.index()].abs();
        if error.is_nan() { f64::INFINITY } else { error }
    }

    /// Change of a quantity, in SI, if the state that it determines rises by 1 V. The quantity is linear in this state
    /// and depends on no other one, so all states move at once. `None` if loops have no solution there.
    pub(super) fn slope(&self, handle: &Handle, state: usize) -> Option<f64> {
        let moved = self.moved.get_or_init(|| self.with_smaller_states()).as_ref()?;
        let (register, per_volt) = self.place(&handle.name)?;
        let after = moved.derivatives.get(handle.order)?[register.index()];
        let before = self.derivative(register, handle.order)?;
        let slope = per_volt * (after - before) / (moved.states[state] - self.point.states[state]);
        Some(slope).filter(|slope| slope.is_finite() && *slope != 0.0)
    }

    /// The machine with all states nearer to 0.
    fn with_smaller_states(&self) -> Option<Moved> {
        DISTANCES.iter().find_map(|distance| {
            let mut point = self.point.clone();
            let toward_0 = |volts: &mut f64| *volts += if *volts > 0.0 { -distance } else { *distance };
            point.states.iter_mut().for_each(toward_0);
            let voltages = self.program.unlimited_voltages_at(&point, &self.given)?;
            let derivatives = self.program.derivatives_at(&point, &self.given, &voltages, MAX_DERIVATIVE);
            Some(Moved { states: point.states, derivatives })
        })
    }
}
