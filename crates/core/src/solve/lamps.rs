//! Overload lamps: which lamps lit, when, how far their amplifiers were driven, and which earlier overload is the
//! cause.
//!
//! The lamp of an amplifier lights if its demanded output exceeds ±100 V within a step. The lamp of an integrator
//! lights if the integrator is held at ±100 V and its input drives it further. Lamps stay lit until the next initial
//! condition. The cause of an overload is the earliest lit amplifier from which a chain of cords leads to it.
//!
//! The output that an integrator would reach without its limit is known if the integrator reacts on itself only through
//! elements without memory, or not at all. Otherwise the limit changes the voltages in the feedback, and the history
//! has how the integrator was driven against its limit instead.

use std::cell::LazyCell;
use std::collections::HashMap;

use super::buffers::StepStart;
use super::cord_chains::{causes, feedback_through};
use super::limit_drive::DriveRecord;
use super::state::{Solver, SolverState};
use crate::ir::{LAMP_THRESHOLD, Program, Register, SourceSlopes, TangentBase};
use crate::machines::REFERENCE;
use crate::trace::{Demand, LimitDrive, Overload};

/// Number of bisections of a step after which the bracket of 2^-50 steps is smaller than the rounding of the time.
const BISECTION_COUNT: usize = 50;

/// Largest exponent of the growth of an overdrive over one step. It prevents an overflow with positive feedback.
const MAX_GROWTH_EXPONENT: f64 = 50.0;

/// The overload lamps, and how far integrators are driven beyond their limits.
#[derive(Debug, Clone)]
pub(super) struct Lamps {
    /// Whether lamps can light. If not, overloads are neither detected nor listed.
    pub is_on: bool,
    /// The lamp of every element, in the order of `Program::elements`; `None` if it is off.
    pub lit: Vec<Option<LitLamp>>,
    /// How far each integrator would be beyond ±100 V if it had no limit, in volts, in the order of `Program::states`;
    /// 0 if it is not held there. The demand of the integrator is 100 V more.
    pub overdrive: Vec<f64>,
    /// How each integrator is driven against its limits, in the order of `Program::states`.
    drives: Vec<DriveRecord>,
    /// Buffers for the feedback of an integrator to itself.
    feedback: FeedbackBuffers,
}

/// Buffers for the slopes of all voltages by the output of one integrator.
#[derive(Debug, Clone)]
struct FeedbackBuffers {
    /// Slopes of the states: 1 or -1 for the integrator, and 0 for all others.
    states: Vec<f64>,
    /// Slopes of all other sources, which are 0.
    zeros: Vec<f64>,
    /// Slopes of the voltages.
    slopes: Vec<f64>,
}

impl FeedbackBuffers {
    /// Buffers of the sizes that a program needs.
    fn new(program: &Program) -> Self {
        let lowered = &program.lowered;
        let sources = lowered.coefficients.len().max(lowered.delays.len()).max(lowered.sampled.len());
        FeedbackBuffers {
            states: vec![0.0; lowered.states.len()],
            zeros: vec![0.0; sources],
            slopes: vec![0.0; lowered.body.len()],
        }
    }

    /// The slope of an integrator's demanded rate by its own output, in 1/s; negative with feedback that limits the
    /// output. `inward` is 1 at the lower limit and -1 at the upper one.
    ///
    /// The slope is taken inward. In this direction an inverter in the feedback follows, although it is at its own
    /// limit.
    fn own_slope(&mut self, program: &Program, voltages: &[f64], integrator: usize, inward: f64) -> f64 {
        let lowered = &program.lowered;
        self.states.fill(0.0);
        self.states[integrator] = inward;
        let from = SourceSlopes {
            coefficients: &self.zeros[..lowered.coefficients.len()],
            states: &self.states,
            time: 0.0,
            delayed: &self.zeros[..lowered.delays.len()],
            sampled: &self.zeros[..lowered.sampled.len()],
        };
        let base = TangentBase { values: voltages, guide: voltages };
        program.differentiate(0..lowered.body.len(), base, &from, &mut self.slopes);
        self.slopes[lowered.states[integrator].demand.index()] / inward
    }
}

/// A lamp that is lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LitLamp {
    /// Index of the element in `Program::elements`.
    pub element: usize,
    /// The problem time at which the lamp lit, in seconds.
    pub time: f64,
    /// The largest demanded output since then, in volts without sign.
    pub peak: f64,
}

impl Lamps {
    /// The lamps of a program, able to light and all off.
    pub(super) fn new(program: &Program) -> Self {
        Lamps {
            is_on: true,
            lit: vec![None; program.lowered.elements.len()],
            overdrive: vec![0.0; program.lowered.states.len()],
            drives: vec![DriveRecord::default(); program.lowered.states.len()],
            feedback: FeedbackBuffers::new(program),
        }
    }

    /// Turns all lamps off for a new initial condition.
    pub(super) fn reset(&mut self) {
        self.lit.fill(None);
        self.overdrive.fill(0.0);
        self.drives.fill(DriveRecord::default());
    }

    /// Whether any lamp is lit.
    pub(super) fn is_any_lit(&self) -> bool {
        self.lit.iter().any(Option::is_some)
    }

    /// The overloads in the order in which the lamps lit, each with the name of the overloaded element that caused it.
    pub(super) fn history(&self, program: &Program) -> Vec<Overload> {
        let lit = self.lit_in_order();
        if lit.is_empty() {
            return Vec::new();
        }
        let elements: Vec<usize> = lit.iter().map(|lamp| lamp.element).collect();
        let name = |element: usize| program.name(element).to_owned();
        let causes = causes(&program.lowered.readers, &elements).into_iter();
        let caused_by = causes.map(|cause| cause.map(|cause| name(elements[cause])));
        let demands = self.demands(program, &lit);
        let lit = lit.iter().zip(demands).zip(caused_by);
        lit.map(|((lamp, demand), caused_by)| {
            let element = name(lamp.element);
            Overload { element, time: lamp.time, demand, caused_by }
        })
        .collect()
    }

    /// The lamps that are lit, in the order in which they lit.
    fn lit_in_order(&self) -> Vec<LitLamp> {
        let mut lit: Vec<LitLamp> = self.lit.iter().flatten().copied().collect();
        lit.sort_by(|a, b| a.time.total_cmp(&b.time));
        lit
    }

    /// The demand of each of these lamps: its peak, or how its integrator was driven if the peak is not known. The
    /// feedback of the elements is found only if a lamp needs it.
    fn demands(&self, program: &Program, lit: &[LitLamp]) -> Vec<Demand> {
        let states = states_by_element(program);
        let feedback =
            LazyCell::new(|| feedback_through(&program.lowered.readers, elements_with_memory(program)));
        let limit_drive = |lamp: &LitLamp| {
            let state = *states.get(&lamp.element)?;
            self.limit_drive(state, lamp, |element| feedback[element])
        };
        let demand = |lamp: &LitLamp| limit_drive(lamp).map_or(Demand::Peak(lamp.peak), Demand::Driven);
        lit.iter().map(demand).collect()
    }

    /// How the integrator of a lit lamp, given by the index of its state, was driven against its limit. `None` if the
    /// lamp's peak is the output that the amplifier would reach without the limit. `has_feedback` is whether an element
    /// reacts on itself through another one with memory.
    fn limit_drive(
        &self,
        state: usize,
        lamp: &LitLamp,
        has_feedback: impl Fn(usize) -> bool,
    ) -> Option<LimitDrive> {
        // An output that exceeded its limit within one step has no larger peak. Positive feedback can exceed all
        // numbers.
        let is_known = lamp.peak > LAMP_THRESHOLD && lamp.peak.is_finite() && !has_feedback(lamp.element);
        (!is_known).then(|| self.drives[state].limit_drive())
    }

    /// Lights the lamps of amplifiers whose demand exceeded ±100 V within the last step or at its end, and raises the
    /// peaks of those that are lit.
    pub(super) fn check_amplifiers(&mut self, solver: &mut Solver<'_>) {
        let program = solver.setup.program;
        for lamp in &program.lowered.lamps {
            let peak = self.lit[lamp.element].map_or(LAMP_THRESHOLD, |lit| lit.peak);
            let at_end = (solver.state.time, solver.state.voltages[lamp.demand.index()]);
            let extrema = solver.extrema_outside(lamp.demand, [-peak, peak]).into_iter().flatten();
            let (time, demand) =
                extrema.fold(
                    at_end,
                    |largest, extremum| if extremum.1.abs() > largest.1.abs() { extremum } else { largest },
                );
            if demand.abs() > peak {
                let time = match self.lit[lamp.element] {
                    Some(lit) => lit.time,
                    None => time_lit(solver, lamp.demand, time),
                };
                light(&mut self.lit[lamp.element], lamp.element, time, demand.abs());
            }
        }
    }

    /// Lights the lamps of integrators that were held at ±100 V at the beginning of the last step and driven further.
    /// The drive changes linearly over a step, and only its outward part counts. With the limit, feedback sees 100 V
    /// instead of 100 V + overdrive. So the slope of the rate by the output is added: d overdrive / dt = drive + slope
    /// x overdrive.
    pub(super) fn check_integrators(&mut self, program: &Program, state: &SolverState, start: &StepStart) {
        let length = state.time - start.time;
        for (index, integrator) in program.lowered.states.iter().enumerate() {
            let volts_before = start.states[index];
            let [begin, end] =
                [&start.voltages, &state.voltages].map(|voltages| voltages[integrator.demand.index()]);
            let drive = [begin, end].map(|drive| drive * volts_before.signum());
            let outward = mean_above_zero(drive);
            // Too long a step can throw an output to its limit and back.
            if volts_before.abs() < REFERENCE && state.states[index].abs() >= REFERENCE {
                light(&mut self.lit[integrator.element], integrator.element, state.time, REFERENCE);
                self.drives[index].reach(state.states[index], state.states[index] - volts_before, length);
            }
            if volts_before.abs() < REFERENCE || outward == 0.0 {
                self.overdrive[index] = 0.0;
                self.drives[index].release();
                continue;
            }
            self.drives[index].drive(volts_before, drive[0].max(drive[1]), length);
            let slope = self.feedback.own_slope(program, &state.voltages, index, -volts_before.signum());
            let overdrive = &mut self.overdrive[index];
            *overdrive = driven(*overdrive, outward, slope, length);
            let demand = REFERENCE + *overdrive;
            if demand > LAMP_THRESHOLD {
                light(&mut self.lit[integrator.element], integrator.element, start.time, demand);
            }
            // The next step begins at the limit without an overdrive if the drive now points inward.
            if drive[1] <= 0.0 {
                self.overdrive[index] = 0.0;
                self.drives[index].release();
            }
        }
    }
}

/// The index in `Program::states` of every integrator, by the index of its element.
fn states_by_element(program: &Program) -> HashMap<usize, usize> {
    let states = program.lowered.states.iter().enumerate();
    states.map(|(index, state)| (state.element, index)).collect()
}

/// The elements with memory: integrators, lags, delay lines, and elements with a sampled value.
fn elements_with_memory(program: &Program) -> impl Iterator<Item = usize> {
    let lowered = &program.lowered;
    let states = lowered.states.iter().map(|state| state.element);
    let delays = lowered.delays.iter().map(|delay| delay.element);
    states.chain(delays).chain(lowered.sampled.iter().map(|sampled| sampled.element))
}

/// The mean of the positive part of a quantity that changes linearly between two values.
fn mean_above_zero([begin, end]: [f64; 2]) -> f64 {
    let positive = begin.max(0.0) + end.max(0.0);
    if begin * end >= 0.0 { 0.5 * positive } else { 0.5 * positive * positive / (begin - end).abs() }
}

/// The overdrive after a time in seconds, by d overdrive / dt = drive + slope x overdrive.
fn driven(overdrive: f64, drive: f64, slope: f64, time: f64) -> f64 {
    let growth = (slope * time).min(MAX_GROWTH_EXPONENT);
    let mean = if growth.abs() < f64::EPSILON { 1.0 } else { libm::expm1(growth) / growth };
    overdrive * libm::exp(growth) + drive * time * mean
}

/// The problem time at which a demand exceeded ±100 V, by bisection on the curve of the states between the beginning of
/// the last step and `time`. It is the beginning if the demand jumped there.
fn time_lit(solver: &mut Solver<'_>, demand: Register, time: f64) -> f64 {
    let (mut before, mut after) = (solver.buffers.last.time, time);
    if before >= after || solver.buffers.last.voltages[demand.index()].abs() > LAMP_THRESHOLD {
        return before;
    }
    for _ in 0..BISECTION_COUNT {
        let middle = 0.5 * (before + after);
        solver.interpolate(middle);
        let is_lit = solver.buffers.voltages[demand.index()].abs() > LAMP_THRESHOLD;
        *(if is_lit { &mut after } else { &mut before }) = middle;
    }
    after
}

/// Lights a lamp at a problem time, or raises its peak if it is lit already. `demand` is in volts without sign.
fn light(lamp: &mut Option<LitLamp>, element: usize, time: f64, demand: f64) {
    let lit = lamp.get_or_insert(LitLamp { element, time, peak: demand });
    lit.peak = lit.peak.max(demand);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_outward_part_of_the_drive_counts() {
        assert_eq!(mean_above_zero([2.0, 4.0]), 3.0);
        assert_eq!(mean_above_zero([-2.0, -4.0]), 0.0);
        // A triangle with a height of 3 over 3/4 of the step.
        assert_eq!(mean_above_zero([3.0, -1.0]), 1.125);
        assert_eq!(mean_above_zero([-1.0, 3.0]), 1.125);
    }

    #[test]
    fn the_overdrive_settles_where_feedback_cancels_the_drive() {
        assert_eq!(driven(0.0, 4.0, 0.0, 0.5), 2.0);
        // 4 (1 - exp(-t)), in one step and in many.
        let once = driven(0.0, 4.0, -1.0, 2.0);
        let often = (0..100).fold(0.0, |overdrive, _| driven(overdrive, 4.0, -1.0, 0.02));
        assert!(
            (once - 4.0 * (1.0 - (-2.0f64).exp())).abs() < 1e-14 && (once - often).abs() < 1e-13,
            "{once} {often}"
        );
        assert!(driven(1.0, 4.0, 1e9, 1e9).is_finite());
    }
}
