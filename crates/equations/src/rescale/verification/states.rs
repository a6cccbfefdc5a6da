//! Compares the laws of both patches at random states, delayed voltages, samples and modes.
//!
//! Modes need not be possible in a run: the laws must agree in all of them.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use patchcord_core::circuit::EvaluationStep;
use patchcord_core::ir::{Delay, Program, ProgramPoint};
use patchcord_core::machines::REFERENCE;

use super::conditions::Conditions;
use super::{CANCELLED, Pair, name, require_equal};
use crate::operating_point::Numbers;
use crate::rescale::measured::Measured;

/// Number of random states at which the laws are compared.
const STATES: usize = 24;
/// Number of random states that are tried at most. A loop without an integrator has no single solution at some.
const MAX_TRIALS: usize = 4 * STATES;
/// The seed of the random states.
const SEED: u64 = 54;
/// The largest voltages of a random state in both patches. Small ones are near small thresholds.
const VOLTS: [f64; 3] = [40.0, 4.0, 0.4];
/// The voltage from which an amplifier in a loop may be at its limit.
const LIMIT: f64 = 99.9;

/// For each part of the old program, the index of the same part in the new one. The new patch can have further pots.
pub(super) struct Matches {
    pub states: Vec<usize>,
    pub delays: Vec<usize>,
    pub sampled: Vec<usize>,
    pub modes: Vec<usize>,
    /// The outputs of the elements.
    pub outputs: Vec<usize>,
}

impl Matches {
    /// The parts of both programs.
    ///
    /// # Errors
    /// The message if the new program lacks a part.
    pub(super) fn new(pair: &Pair<'_>) -> Result<Self, String> {
        let programs = [&pair.old.program, &pair.new.program];
        let states = programs.map(|own| keys(own, own.state_laws().iter().map(|law| law.element)));
        let delays = programs.map(|own| keys(own, own.delays().iter().map(|delay| delay.element)));
        let sampled = programs.map(|own| keys(own, own.sampled_values().iter().map(|value| value.element)));
        let modes = programs.map(|own| keys(own, own.modes().iter().map(|mode| mode.element)));
        let outputs = programs.map(|own| keys(own, 0..own.element_outputs().len()));
        Ok(Matches {
            states: matching(&states)?,
            delays: matching(&delays)?,
            sampled: matching(&sampled)?,
            modes: matching(&modes)?,
            outputs: matching(&outputs)?,
        })
    }
}

/// A part of a program: the name of its element, and the number of parts of the same sort that the element has before it.
type Key<'p> = (&'p str, usize);

/// The keys of parts with these elements.
fn keys(program: &Program, elements: impl Iterator<Item = usize>) -> Vec<Key<'_>> {
    let mut counts: HashMap<usize, usize> = HashMap::new();
    let key = |element: usize| {
        let count = counts.entry(element).or_insert(0);
        *count += 1;
        (program.element_outputs()[element].name.as_str(), *count - 1)
    };
    elements.map(key).collect()
}

/// The index in the new list of each part of the old list.
///
/// # Errors
/// The message if a part is missing.
fn matching([old, new]: &[Vec<Key<'_>>; 2]) -> Result<Vec<usize>, String> {
    let positions: HashMap<Key<'_>, usize> =
        new.iter().enumerate().map(|(position, key)| (*key, position)).collect();
    let position = |key: &Key<'_>| {
        positions.get(key).copied().ok_or_else(|| format!("{} is not the element that it was", key.0))
    };
    old.iter().map(position).collect()
}

/// Compares the laws at random states. Returns the number of states.
///
/// # Errors
/// The message that names an output that differs.
pub(super) fn compare_states(pair: &Pair<'_>, matches: &Matches) -> Result<usize, String> {
    compare_delays(pair, matches)?;
    let mut numbers = Numbers::new(SEED);
    let mut conditions = Conditions::new(pair, matches)?;
    let mut compared = 0;
    for trial in 0..MAX_TRIALS {
        let [old, new] = points(pair, matches, trial, &mut numbers);
        let values = [voltages(pair.old, &old), voltages(pair.new, &new)];
        let [Some(old), Some(new)] = values else { continue };
        compare_voltages(pair, matches, [&old, &new])?;
        compare_rates(pair, matches, [&old, &new])?;
        compare_samples(pair, matches, [&old, &new])?;
        conditions.add([&old, &new]);
        compared += 1;
        if compared == STATES {
            break;
        }
    }
    conditions.compare(pair)?;
    Ok(compared)
}

/// The voltages at a point. `None` if a loop without an integrator has no single solution there, or reaches its limits.
fn voltages(measured: &Measured, point: &ProgramPoint) -> Option<Vec<f64>> {
    let voltages = measured.program.unlimited_voltages_at(point, &BTreeMap::new())?;
    (!is_loop_limited(measured, &voltages)).then_some(voltages)
}

/// A random point of both patches at the same state of the problem.
fn points(pair: &Pair<'_>, matches: &Matches, trial: usize, numbers: &mut Numbers) -> [ProgramPoint; 2] {
    let program = &pair.old.program;
    let (mut old, mut new) = (program.initial_point(), pair.new.program.initial_point());
    let end = pair.old.trace.time.iter().copied().fold(0.0, f64::max);
    old.time = end * numbers.share().abs();
    new.time = old.time;
    let largest = VOLTS[trial % VOLTS.len()];
    let mut volts = |element: usize| {
        let factor = pair.factors[element];
        let volts = largest * numbers.share() / factor.max(1.0);
        (volts, volts * factor)
    };
    for (index, law) in program.state_laws().iter().enumerate() {
        (old.states[index], new.states[matches.states[index]]) = volts(law.element);
    }
    for (index, delay) in program.delays().iter().enumerate() {
        (old.delayed[index], new.delayed[matches.delays[index]]) = volts(delay.element);
    }
    for (index, sampled) in program.sampled_values().iter().enumerate() {
        (old.sampled[index], new.sampled[matches.sampled[index]]) = volts(sampled.element);
    }
    // Every second point has the modes of the initial condition. In the others, each mode takes all its values in turn.
    for (index, mode) in program.modes().iter().enumerate().filter(|_| trial % 2 == 1) {
        let values = mode.names.values;
        if !(mode.is_drive || values.is_empty()) {
            let (value, _) = values[(trial / 2 + index) % values.len()];
            (old.modes[index], new.modes[matches.modes[index]]) = (value, value);
        }
    }
    [old, new]
}

/// Compares the voltages of all outputs.
///
/// # Errors
/// The message that names an output that differs.
fn compare_voltages(pair: &Pair<'_>, matches: &Matches, [old, new]: [&[f64]; 2]) -> Result<(), String> {
    let others = pair.new.program.element_outputs();
    for (element, output) in pair.old.program.element_outputs().iter().enumerate() {
        let (factor, other) = (pair.factors[element], &others[matches.outputs[element]]);
        let values = [factor * old[output.register.index()], new[other.register.index()]];
        require_equal(|| format!("{} is", output.name), "V", values, CANCELLED * factor.max(1.0))?;
    }
    Ok(())
}

/// Compares the derivatives of all states, in volts per problem second, and their limits.
///
/// # Errors
/// The message that names an output that differs.
fn compare_rates(pair: &Pair<'_>, matches: &Matches, [old, new]: [&[f64]; 2]) -> Result<(), String> {
    let Pair { old: before, new: after, factors } = pair;
    for (law, position) in before.program.state_laws().iter().zip(&matches.states) {
        let (factor, other) = (factors[law.element], &after.program.state_laws()[*position]);
        let permitted = CANCELLED * factor.max(1.0);
        let gains = before.circuit.cords(law.element).into_iter().map(|(_, cord)| cord.gain);
        let rate = gains.sum::<f64>().max(1.0) * before.program.time_scale();
        let values = [factor * old[law.demand.index()], new[other.demand.index()]];
        let what = || format!("the derivative of {} is", name(pair, law.element));
        require_equal(what, "V/s", values, permitted * rate)?;
        for (own, other) in law.limits.iter().zip(&other.limits) {
            let limit = old[own.index()];
            // The limits of the machine stay.
            if limit.abs() < REFERENCE {
                let values = [(factor * limit).clamp(-REFERENCE, REFERENCE), new[other.index()]];
                let what = || format!("a limit of {} is", name(pair, law.element));
                require_equal(what, "V", values, permitted)?;
            }
        }
    }
    Ok(())
}

/// Compares what becomes of samples.
///
/// # Errors
/// The message that names an element that differs.
fn compare_samples(pair: &Pair<'_>, matches: &Matches, [old, new]: [&[f64]; 2]) -> Result<(), String> {
    let others = pair.new.program.sampled_values();
    for (own, position) in pair.old.program.sampled_values().iter().zip(&matches.sampled) {
        let factor = pair.factors[own.element];
        let values = [factor * old[own.next.index()], new[others[*position].next.index()]];
        let what = || format!("the sample of {} is", name(pair, own.element));
        require_equal(what, "V", values, CANCELLED * factor.max(1.0))?;
    }
    Ok(())
}

/// Compares the delays of all delay lines in problem seconds.
///
/// # Errors
/// The message that names a delay line that differs.
fn compare_delays(pair: &Pair<'_>, matches: &Matches) -> Result<(), String> {
    let [old, new] = [&pair.old.program, &pair.new.program].map(delays);
    for ((line, position), wanted) in pair.old.program.delays().iter().zip(&matches.delays).zip(old) {
        let what = || format!("the delay of {} is", name(pair, line.element));
        require_equal(what, "s", [wanted, new[*position]], 0.0)?;
    }
    Ok(())
}

/// The delays of all delay lines in problem seconds.
fn delays(program: &Program) -> Vec<f64> {
    let coefficients = program.coefficient_values();
    let seconds = |delay: &Delay| coefficients[delay.time as usize] * delay.problem_seconds;
    program.delays().iter().map(seconds).collect()
}

/// Whether an amplifier in a loop without an integrator is near its limit. The loop then has another solution.
fn is_loop_limited(measured: &Measured, voltages: &[f64]) -> bool {
    let outputs = measured.program.element_outputs();
    let loops =
        measured.circuit.evaluation_order().iter().filter(|step| matches!(step, EvaluationStep::Loop { .. }));
    let members: BTreeSet<usize> = loops.flat_map(EvaluationStep::members).copied().collect();
    members.iter().any(|member| voltages[outputs[*member].register.index()].abs() >= LIMIT)
}
