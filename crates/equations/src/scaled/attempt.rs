//! Scales, and a run of the patch that has them.

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::patch::Problem;

use super::built_patch::BuiltPatch;
use super::error::ScaleError;
use super::measured::{Measured, measured};
use super::run_step::RunStep;
use crate::graph::{NodeId, Plan};
use crate::peaks::Ranges;
use crate::synthesis::{ScaleOptions, Scales, Synthesis, choose_scales, improved_scales, synthesise};

/// The largest number of runs of the patch.
const MAX_RUNS: usize = 8;

/// What scales are chosen for.
#[derive(Clone, Copy)]
pub(super) struct Basis<'a> {
    /// The plan of the problem.
    pub plan: &'a Plan,
    /// The problem.
    pub problem: &'a Problem,
    /// The circuit of the problem.
    pub circuit: &'a Circuit,
    /// The solution without scales.
    pub ranges: &'a Ranges,
    /// The options.
    pub options: &'a ScaleOptions,
}

/// Scales with a run of their patch.
pub(super) struct Attempt {
    /// The scales.
    pub scales: Scales,
    /// The patch.
    pub synthesis: Synthesis,
    /// The voltages in the run.
    pub measured: Measured,
}

impl Attempt {
    /// Makes the patch with these scales, and runs it. `None` if its run stops because the step is too long: it is shorter
    /// then.
    ///
    /// # Errors
    /// If there is no circuit with these scales, or if the patch cannot be run.
    fn new(basis: &Basis<'_>, scales: Scales, step: &mut RunStep) -> Result<Option<Self>, ScaleError> {
        let Basis { plan, problem, circuit, ranges, options } = *basis;
        let mut synthesis = synthesise(plan, problem, circuit, ranges, &scales, options)
            .map_err(|findings| ScaleError::of_problem(problem, circuit, findings))?;
        synthesis.patch = step.applied(synthesis.patch)?;
        let names: Vec<&str> = synthesis.outputs.iter().map(|(_, name)| name.as_str()).collect();
        match measured(&synthesis.patch, &names) {
            Ok(measured) => Ok(Some(Attempt { scales, synthesis, measured })),
            Err(error) if step.shorten_after(&error, &synthesis.patch) => Ok(None),
            Err(error) => Err(BuiltPatch::new(basis, &synthesis).fault_of_problem(error)),
        }
    }

    /// Runs the patch with its own settings. Returns whether its step is too long: it is shorter then.
    ///
    /// # Errors
    /// If the patch cannot be run.
    fn has_long_step(&self, basis: &Basis<'_>, step: &mut RunStep) -> Result<bool, ScaleError> {
        let is_shorter = step.shorten(&self.synthesis.patch);
        is_shorter.map_err(|error| BuiltPatch::new(basis, &self.synthesis).fault_of_problem(error))
    }

    /// Whether an amplifier overloads.
    pub(super) fn has_overload(&self) -> bool {
        !self.measured.overloads.is_empty()
    }

    /// The scales that the run suggests.
    fn improved_scales(&self, basis: &Basis<'_>) -> Scales {
        let Basis { plan, problem, circuit, ranges, options } = *basis;
        let outputs = self.synthesis.outputs.iter().zip(&self.measured.volts);
        let by_node: Vec<(NodeId, f64)> = outputs.map(|((id, _), volts)| (*id, *volts)).collect();
        improved_scales(plan, problem, circuit, ranges, options, &self.scales, &by_node)
    }

    /// The name of the quantity or expression of which an element has the value, and the value of one volt in SI units. If
    /// several nodes have it, a quantity comes first. `None` if it has the value of none.
    pub(super) fn quantity_of(&self, element: &str, plan: &Plan) -> Option<(String, f64)> {
        let nodes = self.synthesis.outputs.iter().filter(|(_, name)| name == element).map(|(id, _)| *id);
        let nodes: Vec<NodeId> = nodes.collect();
        let name = |id: NodeId| plan.quantities.iter().find(|quantity| quantity.node == id);
        let quantity = nodes.iter().find_map(|id| Some((name(*id)?.name.clone(), *id)));
        let first = || Some((self.synthesis.names.get(nodes.first()?.0 as usize)?.clone(), *nodes.first()?));
        let (name, id) = quantity.or_else(first)?;
        Some((name, *self.scales.per_volt.get(id.0 as usize)?))
    }
}

/// The last attempt, whose scales cannot be improved.
pub(super) struct Last {
    /// The attempt.
    pub attempt: Attempt,
    /// The number of runs with the step of the patch.
    pub runs: usize,
    /// The warning that the patch has a shorter step than the problem.
    pub step_warning: Option<Diagnostic>,
}

/// The last of several attempts, with a step that is short enough.
///
/// # Errors
/// If there is no circuit with the scales of an attempt, or if its patch cannot be run.
pub(super) fn last_attempt(basis: &Basis<'_>) -> Result<Last, ScaleError> {
    let mut step = RunStep::default();
    loop {
        if let Some((attempt, runs)) = attempt_with_step(basis, &mut step)? {
            return Ok(Last { attempt, runs, step_warning: step.warning(basis.problem) });
        }
    }
}

/// The last of several attempts, each with the scales that the run before suggests, and the number of runs. The attempts
/// end if a run suggests nothing else. If the last run has an overload, the result is the last attempt without one, if
/// there is one. `None` if the step was too long: it is shorter then.
///
/// # Errors
/// If there is no circuit with the scales of an attempt, or if its patch cannot be run.
fn attempt_with_step(basis: &Basis<'_>, step: &mut RunStep) -> Result<Option<(Attempt, usize)>, ScaleError> {
    let Basis { plan, problem, circuit, ranges, options } = *basis;
    let mut scales = choose_scales(plan, problem, circuit, ranges, options);
    let mut without_overload = None;
    let mut runs = 0;
    loop {
        let Some(attempt) = Attempt::new(basis, scales, step)? else { return Ok(None) };
        runs += 1;
        let better = attempt.improved_scales(basis);
        if runs == MAX_RUNS || better.has_values_of(&attempt.scales) {
            let usable = if attempt.has_overload() { without_overload } else { None };
            let last = usable.unwrap_or(attempt);
            return Ok((!last.has_long_step(basis, step)?).then_some((last, runs)));
        }
        if !attempt.has_overload() {
            without_overload = Some(attempt);
        } else if runs == 1 && attempt.has_long_step(basis, step)? {
            // The scales fit the solution without voltages, so a first overload can come from the step.
            return Ok(None);
        }
        scales = better;
    }
}
