//! The wiring at a point: the voltage of every output, and the value and derivatives of every signal.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, ProgramPoint, Register};

use super::handles::Handle;

/// A difference in time lasts this share of the time in which the fastest state changes by the size of the largest one.
const SHARE: f64 = 1e-5;
/// It lasts at most this share of the step of a run.
const STEP_SHARE: f64 = 1e-2;

/// A circuit at a point. Amplifiers outside loops are not limited.
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
    /// Register and value per volt, in SI, of every signal, drive and element.
    signals: BTreeMap<&'a str, (Register, f64)>,
}

impl<'a> Wired<'a> {
    /// The circuit at a point. `None` if a loop without an integrator has no single solution there.
    pub(super) fn new(
        circuit: &'a Circuit,
        program: &'a Program,
        point: ProgramPoint,
        given: BTreeMap<Register, f64>,
    ) -> Option<Self> {
        let voltages = program.unlimited_voltages_at(&point, &given)?;
        let coefficients = program.coefficient_values();
        let mut signals = BTreeMap::new();
        for signal in program.signals() {
            let per_volt = signal.per_volt.map_or(1.0, |index| coefficients[index as usize]);
            // A signal comes before an element of the same name.
            signals.entry(signal.name.as_str()).or_insert((signal.register, per_volt));
        }
        Some(Wired { circuit, program, point, given, voltages, signals })
    }

    /// The register of a signal, drive or element, and its value at 1 V in SI.
    pub(super) fn place(&self, name: &str) -> Option<(Register, f64)> {
        self.signals.get(name).copied()
    }

    /// Whether an output is that of a drive.
    pub(super) fn is_drive(&self, register: Register) -> bool {
        self.program.drive_registers().contains(&register)
    }

    /// The voltage of a register.
    pub(super) fn volts(&self, register: Register) -> f64 {
        self.voltages[register.index()]
    }

    /// The value of a quantity in SI, with this number of derivatives. `None` if the wiring has no such signal.
    pub(super) fn quantity(&self, name: &str, order: usize) -> Option<f64> {
        if order > 0 {
            return self.quantity_at(name, order, &self.point);
        }
        let (register, per_volt) = self.place(name)?;
        Some(self.volts(register) * per_volt)
    }

    /// Change of a quantity, in SI, if a state rises by 1 V. The quantity is linear in the state.
    pub(super) fn slope(&self, handle: &Handle, state: usize) -> Option<f64> {
        let mut moved = self.point.clone();
        moved.states[state] += 1.0;
        let [after, before] =
            [&moved, &self.point].map(|point| self.quantity_at(&handle.name, handle.order, point));
        Some(after? - before?).filter(|slope| slope.is_finite() && *slope != 0.0)
    }

    /// The value of a quantity at another point. A derivative is a difference along the motion of the states, forward in
    /// time: drives may begin at t = 0.
    fn quantity_at(&self, name: &str, order: usize, point: &ProgramPoint) -> Option<f64> {
        let voltages = self.program.unlimited_voltages_at(point, &self.given)?;
        let (register, per_volt) = self.place(name)?;
        let Some(lower) = order.checked_sub(1) else {
            return Some(voltages[register.index()] * per_volt);
        };
        let rates = self.rates(&voltages);
        let length = self.length(point, &rates);
        let later = |steps: f64| moved(point, &rates, steps * length);
        let [here, next, last] = [0.0, 1.0, 2.0].map(|steps| self.quantity_at(name, lower, &later(steps)));
        Some((4.0 * next? - 3.0 * here? - last?) / (2.0 * length))
    }

    /// The rates of the states in volts per problem second.
    fn rates(&self, voltages: &[f64]) -> Vec<f64> {
        self.program.state_laws().iter().map(|state| voltages[state.demand.index()]).collect()
    }

    /// The fastest rate of a state, in volts per problem second.
    pub(super) fn fastest_rate(&self) -> f64 {
        largest(&self.rates(&self.voltages))
    }

    /// Length of a difference in problem seconds.
    fn length(&self, point: &ProgramPoint, rates: &[f64]) -> f64 {
        let (size, fastest) = (largest(&point.states).max(1.0), largest(rates));
        let step = self.circuit.run_plan().step.as_ref().map_or(1.0, |step| step.value);
        let longest = STEP_SHARE * step;
        if fastest > 0.0 { longest.min(SHARE * size / fastest) } else { longest }
    }
}

/// The largest size among numbers; 0 if there are none.
fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |largest: f64, number| largest.max(number.abs()))
}

/// The point some time later, if the states move with these rates.
fn moved(point: &ProgramPoint, rates: &[f64], time: f64) -> ProgramPoint {
    let mut moved = point.clone();
    moved.time += time;
    moved.states.iter_mut().zip(rates).for_each(|(state, rate)| *state += time * rate);
    moved
}
