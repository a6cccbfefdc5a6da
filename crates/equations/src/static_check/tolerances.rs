//! How near a wired value must be to the expected one.

use patchcord_core::ir::Register;

use super::wired::Wired;

/// Deviation of a wired value from the expected one, as a share of the sum of the sizes of their terms, up to which they
/// agree. Settings are often rounded to three digits.
const TOLERANCE: f64 = 1e-3;
/// Deviation that is never a difference, in volts or in volts by powers of machine seconds: 1e-8 of 100 V. An integrator
/// with a gain of 1 has this rate if its input deviates by as many volts.
const ROUNDING: f64 = 1e-6;
/// Multiple of the first-order error of a finite amplification that is permitted, for terms of higher order.
const AMPLIFICATION_MARGIN: f64 = 2.0;

/// The sizes of terms at a point.
pub(super) struct Tolerances<'a> {
    /// The circuit at the point.
    wired: &'a Wired<'a>,
}

impl<'a> Tolerances<'a> {
    /// The tolerances at a point.
    pub(super) fn new(wired: &'a Wired<'a>) -> Self {
        Tolerances { wired }
    }

    /// Whether a wired value agrees with an expected one. `size` is the sum of the sizes of the terms, and `error` the
    /// error of a finite amplification, both in the unit of the values: volts, or volts by powers of machine seconds.
    pub(super) fn agree([expected, wired]: [f64; 2], size: f64, error: f64) -> bool {
        let size = expected.abs().max(wired.abs()).max(size);
        (expected - wired).abs() <= TOLERANCE * size + ROUNDING + AMPLIFICATION_MARGIN * error
    }

    /// Whether the wired voltage of an element's output agrees with an expected one. `size` is the size of the terms
    /// that the equations have for it, in volts. A small sum of large inputs has few digits, so the inputs count too.
    pub(super) fn output_agrees(&self, element: usize, expected: f64, size: f64) -> bool {
        let register = self.wired.program.element_outputs()[element].register;
        let size = size.max(self.input_size(element, 0));
        Self::agree([expected, self.wired.volts(register)], size, self.wired.amplification_error(register))
    }

    /// The terms of an element's output with this number of derivatives: its inputs, each times its gain, in volts by
    /// powers of machine seconds. Empty if its jacks have no gains, or for a state itself.
    pub(super) fn inputs(&self, element: usize, order: usize) -> Vec<f64> {
        let (wired, outputs) = (self.wired, self.wired.program.element_outputs());
        let is_state = wired.state_at(outputs[element].register).is_some();
        if !wired.circuit.element(element).kind.has_gains() || (is_state && order == 0) {
            return Vec::new();
        }
        // The rate of an integrator is the sum of its inputs.
        let order = if is_state { order - 1 } else { order };
        let cords = wired.circuit.cords(element).into_iter().filter(|(_, cord)| cord.input == 0);
        let terms = cords.map(|(from, cord)| cord.gain * self.machine_rate(outputs[from].register, order));
        terms.collect()
    }

    /// The sum of the sizes of the terms of an element's output, as [`Tolerances::inputs`].
    pub(super) fn input_size(&self, element: usize, order: usize) -> f64 {
        self.inputs(element, order).iter().map(|term| term.abs()).sum()
    }

    /// A derivative of an output in volts by powers of machine seconds. NaN if there is none.
    fn machine_rate(&self, register: Register, order: usize) -> f64 {
        let derivative = self.wired.derivative(register, order).unwrap_or(f64::NAN);
        in_machine_time(derivative, order, self.wired)
    }
}

/// A derivative by powers of machine seconds, from one by powers of problem seconds.
pub(super) fn in_machine_time(derivative: f64, order: usize, wired: &Wired<'_>) -> f64 {
    (0..order).fold(derivative, |derivative, _| derivative / wired.program.time_scale())
}
