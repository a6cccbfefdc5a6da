//! Overload lamps: which ones lit, when, how far the amplifier was driven, and which overload caused it.
//!
//! The lamp of an amplifier lights if its demand exceeds ±100 V within a step. The lamp of an integrator lights if the
//! integrator is held at ±100 V and driven further. Lamps stay lit until the next initial condition.

use super::buffers::StepStart;
use super::state::{Solver, SolverState};
use crate::ir::{LAMP_LEVEL, Program, Register};
use crate::machines::REFERENCE;
use crate::trace::Overload;

/// The number of bisections after which the rest of a step is smaller than the rounding of its time.
const BISECTIONS: usize = 50;

/// The overload lamps, and how far integrators are driven beyond their limits.
#[derive(Debug, Clone)]
pub(super) struct Lamps {
    /// Whether lamps can light.
    pub is_on: bool,
    /// The lamp of every element, in the order of the program; `None` if it is off.
    pub lit: Vec<Option<Lit>>,
    /// The voltage in volts by which each integrator was driven further while it was held at ±100 V, in the order of
    /// `Program::states`.
    pub overdrive: Vec<f64>,
}

/// A lamp that is lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lit {
    /// Index of the element.
    pub element: usize,
    /// The problem time at which the lamp lit, in seconds.
    pub time: f64,
    /// The largest demand since then, in volts without sign.
    pub peak: f64,
}

impl Lamps {
    /// The lamps of a program, on duty and all off.
    pub fn new(program: &Program) -> Self {
        Lamps {
            is_on: true,
            lit: vec![None; program.elements.len()],
            overdrive: vec![0.0; program.states.len()],
        }
    }

    /// Turns all lamps off for a new initial condition.
    pub fn reset(&mut self) {
        self.lit.fill(None);
        self.overdrive.fill(0.0);
    }

    /// Whether any lamp is lit.
    pub fn is_any_lit(&self) -> bool {
        self.lit.iter().any(Option::is_some)
    }

    /// The overloads in the order in which the lamps lit, each with the overload that caused it.
    pub fn history(&self, program: &Program) -> Vec<Overload> {
        let mut lit: Vec<Lit> = self.lit.iter().flatten().copied().collect();
        lit.sort_by(|a, b| a.time.total_cmp(&b.time));
        let elements: Vec<usize> = lit.iter().map(|lamp| lamp.element).collect();
        let overloads = lit.iter().zip(causes(&program.readers, &elements)).map(|(lamp, cause)| Overload {
            element: program.name(lamp.element).to_owned(),
            time: lamp.time,
            peak: lamp.peak,
            caused_by: cause.map(|cause| program.name(elements[cause]).to_owned()),
        });
        overloads.collect()
    }

    /// Lights the lamps of amplifiers whose demand exceeded ±100 V within the last step or at its end.
    pub fn watch_amplifiers(&mut self, solver: &mut Solver<'_>) {
        let program = solver.setup.program;
        for lamp in &program.lamps {
            let peak = self.lit[lamp.element].map_or(LAMP_LEVEL, |lit| lit.peak);
            let now = (solver.state.time, solver.state.voltages[lamp.demand.index()]);
            let extrema = solver.extrema_beyond(lamp.demand, [-peak, peak]).into_iter().flatten();
            let (time, demand) = extrema
                .fold(now, |most, extremum| if extremum.1.abs() > most.1.abs() { extremum } else { most });
            if demand.abs() > peak {
                let time = match self.lit[lamp.element] {
                    Some(lit) => lit.time,
                    None => time_lit(solver, lamp.demand, time),
                };
                light(&mut self.lit[lamp.element], lamp.element, time, demand.abs());
            }
        }
    }

    /// Lights the lamps of integrators that were held at ±100 V over the last step and driven further. The drive is the
    /// mean of both ends, because a hold within one step ends when the drive turns. The overdrive of a lag decays with
    /// its time constant.
    pub fn watch_integrators(&mut self, program: &Program, state: &SolverState, start: &StepStart) {
        let length = state.time - start.time;
        for (index, own) in program.states.iter().enumerate() {
            let last = start.states[index];
            let [begin, end] = [&start.voltages, &state.voltages].map(|at| at[own.demand.index()]);
            let outward = 0.5 * (begin + end) * last.signum();
            let held = last.abs() >= REFERENCE && outward > 0.0;
            let time = own.lag.map_or(f64::INFINITY, |lag| state.time_constant(lag));
            let overdrive = &mut self.overdrive[index];
            let decay = 1.0 / (1.0 + length / time);
            *overdrive = if held { (*overdrive + length * outward) * decay } else { 0.0 };
            let demand = REFERENCE + *overdrive;
            if demand > LAMP_LEVEL {
                light(&mut self.lit[own.element], own.element, start.time, demand);
            }
        }
    }
}

/// The problem time at which a demand exceeded ±100 V, between the beginning of the last step and `time`, by the curve
/// of the states. It is the beginning if the demand jumped there.
fn time_lit(solver: &mut Solver<'_>, demand: Register, time: f64) -> f64 {
    let (mut before, mut after) = (solver.buffers.last.time, time);
    if before >= after || solver.buffers.last.voltages[demand.index()].abs() > LAMP_LEVEL {
        return before;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (before + after);
        solver.interpolate(middle);
        let is_lit = solver.buffers.voltages[demand.index()].abs() > LAMP_LEVEL;
        *(if is_lit { &mut after } else { &mut before }) = middle;
    }
    after
}

/// Lights a lamp, or raises the peak of one that is lit.
fn light(lamp: &mut Option<Lit>, element: usize, time: f64, demand: f64) {
    let lit = lamp.get_or_insert(Lit { element, time, peak: demand });
    lit.peak = lit.peak.max(demand);
}

/// For each lamp, in the order in which they lit: the first earlier lamp from which a chain of cords leads to it.
fn causes(readers: &[Vec<usize>], lit: &[usize]) -> Vec<Option<usize>> {
    let mut first = vec![None; readers.len()];
    for (lamp, element) in lit.iter().enumerate() {
        mark_downstream(readers, *element, lamp, &mut first);
    }
    let before_itself = |(lamp, element): (usize, &usize)| first[*element].filter(|cause| *cause < lamp);
    lit.iter().enumerate().map(before_itself).collect()
}

/// Marks all elements downstream of a lamp's amplifier. An element that an earlier lamp has marked ends the search
/// there, because everything behind it is marked, too.
fn mark_downstream(readers: &[Vec<usize>], from: usize, lamp: usize, first: &mut [Option<usize>]) {
    let mut open = vec![from];
    while let Some(element) = open.pop() {
        for reader in &readers[element] {
            if first[*reader].is_none() {
                first[*reader] = Some(lamp);
                open.push(*reader);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cause_is_the_earliest_lamp_upstream() {
        // 0 drives 1 drives 2, and 3 drives 2.
        let readers = [vec![1], vec![2], vec![], vec![2]];
        assert_eq!(causes(&readers, &[0, 1, 2, 3]), [None, Some(0), Some(0), None]);
        assert_eq!(causes(&readers, &[3, 1, 0, 2]), [None, None, None, Some(0)]);
        assert_eq!(causes(&readers, &[2, 1, 0]), [None, None, None]);
    }

    #[test]
    fn in_a_ring_the_first_lamp_causes_the_others() {
        let ring = [vec![1], vec![2], vec![0]];
        assert_eq!(causes(&ring, &[1, 0, 2]), [None, Some(0), Some(0)]);
    }

    #[test]
    fn a_long_chain_of_lamps_is_marked_once() {
        let length = 200_000;
        let readers: Vec<_> =
            (0..length).map(|at| if at + 1 < length { vec![at + 1] } else { vec![] }).collect();
        let lit: Vec<_> = (0..length).rev().collect();
        assert!(causes(&readers, &lit).iter().all(Option::is_none));
    }
}
