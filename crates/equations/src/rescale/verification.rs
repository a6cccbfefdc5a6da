//! Checks that a rescaled patch computes the same as the old one.
//!
//! At random voltages of the integrators, every voltage and every derivative must be the old one times its factor. The
//! runs of both patches are compared too, and the stated equations. A motion that amplifies deviations amplifies the
//! rounding of the numbers in the document, so only the beginning of such a run agrees.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use patchcord_core::circuit::EvaluationStep;
use patchcord_core::ir::{Program, ProgramPoint, Register};

use super::decision::Decided;
use super::measured::Measured;
use crate::compare::{Agreement, compare_equations};
use crate::operating_point::Numbers;

/// Number of random states.
const STATES: usize = 20;
/// The seed of the random states.
const SEED: u64 = 54;
/// The largest voltage of a random state in both patches.
const VOLTS: f64 = 40.0;
/// Largest difference of a voltage, as a share of it.
const TOLERANCE: f64 = 1e-9;
/// Largest difference of a voltage that is a small difference of large ones, in volts. A derivative may differ by this
/// times the gains of its integrator.
const CANCELLED: f64 = 1e-8;
/// The voltage from which an amplifier in a loop may be at its limit.
const LIMIT: f64 = 99.9;
/// The share of the run that must agree even if a motion amplifies deviations.
const LEAST_SHARE: f64 = 0.1;
/// Largest difference of a voltage in this share of the run, as a share of the peak.
const AMPLIFIED: f64 = 1e-6;

/// Compares a rescaled patch with the old one. Returns the problem time up to which their runs agree. `None` if the old
/// run overloads, so that it cannot be compared.
///
/// # Errors
/// The message that says what differs.
pub(super) fn verify(old: &Measured, new: &Measured, decided: &Decided<'_>) -> Result<Option<f64>, String> {
    let names = (0..decided.wiring.len()).map(|element| decided.wiring.name(element).to_owned());
    let factors = (0..decided.wiring.len()).map(|element| decided.factor(element, 0).unwrap_or(1.0));
    let factors: HashMap<String, f64> = names.zip(factors).collect();
    let pair = Pair { old, new, factors: &factors };
    pair.compare_states()?;
    pair.compare_equations()?;
    if old.overloads.is_empty() { pair.compare_runs().map(Some) } else { Ok(None) }
}

/// Two patches that should compute the same.
struct Pair<'p> {
    old: &'p Measured,
    new: &'p Measured,
    /// The factor of each output, by its name.
    factors: &'p HashMap<String, f64>,
}

impl Pair<'_> {
    /// The factor of an output. 1 for pots that the old patch does not have.
    fn factor(&self, name: &str) -> f64 {
        self.factors.get(name).copied().unwrap_or(1.0)
    }

    /// Compares all voltages and derivatives at random states.
    ///
    /// # Errors
    /// The message that names an output that differs.
    fn compare_states(&self) -> Result<(), String> {
        let mut numbers = Numbers::new(SEED);
        for _ in 0..STATES {
            let [old, new] = self.points(&mut numbers);
            let voltages = |measured: &Measured, point: &ProgramPoint| {
                measured.program.unlimited_voltages_at(point, &BTreeMap::new())
            };
            let (Some(old), Some(new)) = (voltages(self.old, &old), voltages(self.new, &new)) else {
                continue;
            };
            if is_loop_limited(self.old, &old) || is_loop_limited(self.new, &new) {
                continue;
            }
            self.compare_voltages(&old, &new)?;
            self.compare_rates(&old, &new)?;
        }
        Ok(())
    }

    /// A random point of both patches at the same state of the problem.
    fn points(&self, numbers: &mut Numbers) -> [ProgramPoint; 2] {
        let (mut old, mut new) = (self.old.program.initial_point(), self.new.program.initial_point());
        let end = self.old.trace.time.last().copied().unwrap_or(0.0);
        old.time = end * numbers.share().abs();
        new.time = old.time;
        let positions = state_positions(&self.new.program);
        for (index, name) in self.old.program.states().into_iter().enumerate() {
            let factor = self.factor(name);
            let volts = VOLTS * numbers.share() / factor.max(1.0);
            old.states[index] = volts;
            if let Some(position) = positions.get(name) {
                new.states[*position] = volts * factor;
            }
        }
        let outputs = self.old.program.element_outputs();
        for (index, delay) in self.old.program.delays().iter().enumerate() {
            let factor = self.factor(&outputs[delay.element].name);
            let volts = VOLTS * numbers.share() / factor.max(1.0);
            old.delayed[index] = volts;
            new.delayed[index] = volts * factor;
        }
        [old, new]
    }

    /// Compares the voltages of all outputs.
    ///
    /// # Errors
    /// The message that names an output that differs.
    fn compare_voltages(&self, old: &[f64], new: &[f64]) -> Result<(), String> {
        let registers = registers(&self.new.program);
        for output in self.old.program.element_outputs() {
            let Some(register) = registers.get(output.name.as_str()) else { continue };
            let factor = self.factor(&output.name);
            let (wanted, found) = (factor * old[output.register.index()], new[register.index()]);
            if is_different(wanted, found, CANCELLED * factor.max(1.0)) {
                return Err(format!("{} is {found} V in place of {wanted} V", output.name));
            }
        }
        Ok(())
    }

    /// Compares the derivatives of all states, in volts per problem second.
    ///
    /// # Errors
    /// The message that names an output whose derivative differs.
    fn compare_rates(&self, old: &[f64], new: &[f64]) -> Result<(), String> {
        let positions = state_positions(&self.new.program);
        let laws = self.old.program.state_laws();
        for (law, name) in laws.iter().zip(self.old.program.states()) {
            let Some(position) = positions.get(name) else { continue };
            let other = &self.new.program.state_laws()[*position];
            let factor = self.factor(name);
            let (wanted, found) = (factor * old[law.demand.index()], new[other.demand.index()]);
            let gains = self.old.circuit.cords(law.element).into_iter().map(|(_, cord)| cord.gain);
            let rate = gains.sum::<f64>().max(1.0) * self.old.program.time_scale();
            if is_different(wanted, found, CANCELLED * factor.max(1.0) * rate) {
                return Err(format!("the derivative of {name} is {found} V/s in place of {wanted} V/s"));
            }
        }
        Ok(())
    }

    /// Compares how the stated equations agree with the wiring.
    ///
    /// # Errors
    /// The message with an equation that the old wiring solves and the new one does not.
    fn compare_equations(&self) -> Result<(), String> {
        let compared = |measured: &Measured| compare_equations(&measured.circuit, &measured.program);
        let rank = |agreement: &Agreement| match agreement {
            Agreement::Different { .. } => 0,
            Agreement::SolvedAt(_) => 1,
            _ => 2,
        };
        for (old, new) in compared(self.old).iter().zip(&compared(self.new)) {
            if rank(&new.agreement) < rank(&old.agreement) {
                let text = self.old.circuit.equations()[old.index].value.text();
                return Err(format!("its wiring does not solve {text}"));
            }
        }
        Ok(())
    }

    /// Compares the records of both runs. Returns the time up to which they agree.
    ///
    /// # Errors
    /// The message that names an output, if the beginning of the run differs by more than amplified rounding.
    fn compare_runs(&self) -> Result<f64, String> {
        let time = &self.old.trace.time;
        let count = time.len().min(self.new.trace.len());
        if let Some((sample, output)) = self.first_difference(count, AMPLIFIED)
            && (sample as f64) < LEAST_SHARE * count as f64
        {
            return Err(format!("{output} differs from t = {} s on", time[sample]));
        }
        let agreeing = self.first_difference(count, TOLERANCE).map_or(count, |(sample, _)| sample);
        Ok(agreeing.checked_sub(1).map_or(0.0, |last| time[last]))
    }

    /// The first of the samples at which an output differs by more than a share of its peak, and the output.
    fn first_difference(&self, count: usize, share: f64) -> Option<(usize, &str)> {
        let tolerance = self.old.circuit.run_plan().tolerance.as_ref().map_or(0.0, |placed| placed.value);
        let mut first = None;
        let mut end = count;
        for track in &self.old.trace.tracks {
            let Some(other) = self.new.trace.track(&track.name) else { continue };
            let factor = self.factor(&track.name);
            let peak = track.volts.iter().fold(0.0, |peak: f64, volts| peak.max(volts.abs()));
            // The errors of steps that adapt are within the tolerance of the run, in units of 100 V.
            let permitted = share * peak.max(CANCELLED) + 100.0 * tolerance * factor.recip().max(1.0);
            let differs =
                |sample: usize| (other.volts[sample] / factor - track.volts[sample]).abs() > permitted;
            // A jump can be just before a sample in one run and just after it in the other.
            let lasts = |sample: &usize| differs(*sample) && (sample + 1 >= count || differs(sample + 1));
            if let Some(sample) = (0..end).find(lasts) {
                (first, end) = (Some((sample, track.name.as_str())), sample);
            }
        }
        first
    }
}

/// Whether two voltages differ by more than rounding.
fn is_different(wanted: f64, found: f64, cancelled: f64) -> bool {
    let permitted = TOLERANCE * wanted.abs().max(found.abs()) + cancelled;
    // A voltage that is not a number in both patches does not count.
    (wanted - found).abs() > permitted || wanted.is_nan() != found.is_nan()
}

/// Whether an amplifier in a loop without an integrator is near its limit. The loop then has another solution.
fn is_loop_limited(measured: &Measured, voltages: &[f64]) -> bool {
    let outputs = measured.program.element_outputs();
    let loops =
        measured.circuit.evaluation_order().iter().filter(|step| matches!(step, EvaluationStep::Loop { .. }));
    let members: BTreeSet<usize> = loops.flat_map(EvaluationStep::members).copied().collect();
    members.iter().any(|member| voltages[outputs[*member].register.index()].abs() >= LIMIT)
}

/// The index of each state by its name.
fn state_positions(program: &Program) -> HashMap<&str, usize> {
    program.states().into_iter().enumerate().map(|(index, name)| (name, index)).collect()
}

/// The register of each output by its name.
fn registers(program: &Program) -> HashMap<&str, Register> {
    program.element_outputs().iter().map(|output| (output.name.as_str(), output.register)).collect()
}

#[cfg(test)]
mod tests {
    use patchcord_core::patch::Patch;

    use super::super::decision::Decision;
    use super::super::error::RescaleError;
    use super::super::values::Values;
    use super::super::wiring::Wiring;
    use super::*;

    /// A decay with this setting of its pot, this initial voltage and this value of one volt.
    fn decay(setting: f64, initial: f64, per_volt: f64) -> Measured {
        let text = format!(
            r#"{{"patchcord": 1, "scales": {{"length": {{"per_volt": {per_volt}, "unit": "mm"}}}},
            "elements": {{"P1": {{"kind": "pot", "in": "A1", "setting": {setting}}},
                "A1": {{"kind": "integrator", "in": {{"x1": ["P1"]}}, "initial": {initial}}}}},
            "signals": {{"x": {{"at": "A1", "scale": "length"}}}},
            "equations": ["x' = -0.5 x"], "run": {{"for": 2, "step": 0.01}}}}"#
        );
        let patch = Patch::parse("decay.json", &text).unwrap_or_else(|report| panic!("{report}"));
        Measured::new(&patch, RescaleError::Patch).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Compares two patches, in the second of which all voltages should be `factor` times as large.
    fn compared(old: &Measured, new: &Measured, factor: f64) -> Result<Option<f64>, String> {
        let (wiring, values) = (Wiring::new(&old.circuit), Values::of(&old.circuit));
        let mut decision = Decision::none(&wiring);
        for element in (0..wiring.len()).filter(|element| !wiring.is_reference(*element)) {
            decision.factors[element] = factor;
        }
        verify(old, new, &Decided { wiring: &wiring, old: &values, decision: &decision })
    }

    #[test]
    fn equal_patches_agree_in_the_whole_run() {
        assert_eq!(compared(&decay(0.5, 20.0, 1.0), &decay(0.5, 80.0, 0.25), 4.0), Ok(Some(2.0)));
    }

    #[test]
    fn a_patch_with_another_motion_is_rejected() {
        let old = decay(0.5, 20.0, 1.0);
        let message = compared(&old, &decay(0.4, 20.0, 1.0), 1.0).unwrap_err();
        assert!(message.starts_with("P1 is "), "{message}");
        // The motion is right, but the initial value is that of another scale.
        let message = compared(&old, &decay(0.5, 20.0, 0.25), 4.0).unwrap_err();
        assert!(message.ends_with(" differs from t = 0 s on"), "{message}");
    }
}
