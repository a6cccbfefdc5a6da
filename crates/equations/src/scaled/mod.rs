//! Scales a problem: from equations to a patch whose amplifiers use their range.
//!
//! [`scale_problem`] plans the circuit, finds the range of every quantity, chooses scales, builds the patch and runs it.
//! If an amplifier then peaks below 50 V or above 95 V, the scales change and the patch is built again. The last patch
//! runs with its own settings; if the step is too long, all is repeated with a shorter one. At the end, the ranges of the
//! parameters are narrowed to those in which all settings are valid.

mod error;
mod maxima;
mod measured;
mod narrowing;
mod run_step;
mod scaled_equation;
mod table;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::{Patch, Problem};

use crate::findings::codes;
use crate::graph::Plan;
use crate::peaks::{Ranges, ranges};
use crate::plan::plan;
pub use crate::synthesis::ScaleOptions;
use crate::synthesis::{GainStep, Scales, Synthesis, choose_scales, improved_scales, synthesise};
pub use error::ScaleError;
use maxima::checked_maxima;
use measured::measured_peaks;
pub use narrowing::NarrowedRange;
use narrowing::with_narrowed_ranges;
use run_step::RunStep;
use table::Tables;
pub use table::{OutputPeak, ScaledQuantity};

/// The largest number of runs of the patch.
const MAX_RUNS: usize = 8;

/// A problem as a scaled patch, with the tables that explain it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ScaledProblem {
    /// The patch.
    pub patch: Patch,
    /// The scaling table: a row for each quantity of the problem.
    pub quantities: Vec<ScaledQuantity>,
    /// The peaks of all outputs in a run of the patch.
    pub peaks: Vec<OutputPeak>,
    /// The gain rule in numbers for each input of an integrator, a summer and a pot.
    pub steps: Vec<String>,
    /// Machine seconds per problem second.
    pub time_scale: f64,
    /// The number of runs that the scaling took with the step of the patch.
    pub runs: usize,
    /// The parameters whose ranges are narrower in the patch than in the problem, in the order of the patch. Outside of
    /// them a pot would be above 1 or negative, for example.
    pub narrowed_ranges: Vec<NarrowedRange>,
    /// Warnings about what the patch has otherwise than the problem states: scales for larger maxima, and a shorter step.
    /// The positions are those of the text of the problem.
    pub deviations: Vec<Diagnostic>,
}

/// Turns a problem into a patch with scales, gains and pots.
///
/// The patch is run, and its scales change until the peaks are between 50 and 95 V. Scales that the problem states are
/// kept. The scales hold for the present values of the parameters, so the ranges in the patch can be narrower than in
/// the problem. If the step of the problem is too long for the patch, the patch has a shorter one.
///
/// # Errors
/// If the problem has a fault, if the machine has no circuit for one of its equations, if an amplifier overloads whatever
/// its scale, if a quantity exceeds a maximum that is to be kept, or if the patch cannot be run.
pub fn scale_problem(problem: &Problem, options: &ScaleOptions) -> Result<ScaledProblem, ScaleError> {
    let circuit = &Circuit::new(&problem.patch).map_err(ScaleError::Problem)?;
    let in_problem = |findings| ScaleError::of_problem(problem, findings);
    let plan = &plan(problem, circuit).map_err(in_problem)?;
    let ranges = &ranges(plan, problem, circuit).map_err(|finding| in_problem(vec![finding]))?;
    let mut deviations = checked_maxima(plan, problem, ranges, options).map_err(in_problem)?;
    let sources = Sources { plan, problem, circuit, ranges, options };
    let mut step = RunStep::default();
    let Last { scales, synthesis, volts, runs } = loop {
        if let Some(last) = last_run(&sources, &mut step)? {
            break last;
        }
    };
    let tables = Tables { plan, problem, circuit, scales: &scales, synthesis: &synthesis, volts: &volts };
    let overloads = overloads(&tables, step.overloads());
    if !overloads.is_empty() {
        return Err(in_problem(overloads));
    }
    deviations.extend(step.warning(problem));
    scaled_problem(&tables, runs, deviations)
}

/// What the scales are chosen from.
struct Sources<'a> {
    plan: &'a Plan,
    problem: &'a Problem,
    circuit: &'a Circuit,
    ranges: &'a Ranges,
    options: &'a ScaleOptions,
}

/// The patch whose scales cannot be improved.
struct Last {
    /// Its scales.
    scales: Scales,
    /// The patch.
    synthesis: Synthesis,
    /// The peak of each of its outputs in volts.
    volts: Vec<f64>,
    /// The number of runs that the scales took.
    runs: usize,
}

/// Runs the patch of a problem and improves its scales, until there is nothing to improve. The first and the last patch
/// are also run with their own settings. `None` if the step was too long: it is shorter then.
///
/// # Errors
/// If there is no patch, or it cannot be run.
fn last_run(sources: &Sources<'_>, step: &mut RunStep) -> Result<Option<Last>, ScaleError> {
    let Sources { plan, problem, circuit, ranges, options } = *sources;
    let mut scales = choose_scales(plan, problem, circuit, ranges, options);
    for runs in 1.. {
        let synthesis = synthesise(plan, problem, circuit, ranges, &scales, options);
        let mut synthesis = synthesis.map_err(|findings| ScaleError::of_problem(problem, findings))?;
        synthesis.patch = step.applied(synthesis.patch)?;
        // The first scales fit the solution without voltages, so the first run shows whether the step is too long.
        if runs == 1 && step.shorten(&synthesis.patch)? {
            return Ok(None);
        }
        let names: Vec<&str> = synthesis.outputs.iter().map(|(_, name)| name.as_str()).collect();
        let volts = match measured_peaks(&synthesis.patch, &names) {
            Err(error) if step.shorten_after(&error, &synthesis.patch) => return Ok(None),
            volts => volts?,
        };
        let by_node: Vec<_> =
            synthesis.outputs.iter().map(|(id, _)| *id).zip(volts.iter().copied()).collect();
        let better = improved_scales(plan, problem, circuit, ranges, options, &scales, &by_node);
        let is_last = better == scales || runs == MAX_RUNS;
        if is_last {
            let is_shortened = runs > 1 && step.shorten(&synthesis.patch)?;
            return Ok((!is_shortened).then_some(Last { scales, synthesis, volts, runs }));
        }
        scales = better;
    }
    Ok(None)
}

/// A fault for each output that exceeds the reference voltage, whatever its scale, and for each other amplifier that
/// overloads. `overloaded` are the amplifiers that overload when the patch runs with its own settings.
fn overloads(tables: &Tables<'_>, overloaded: &[String]) -> Vec<Diagnostic> {
    let peaks = tables.peaks();
    let is_output = |element: &&String| peaks.iter().any(|peak| peak.output == **element);
    let others: Vec<Diagnostic> =
        overloaded.iter().filter(|element| !is_output(element)).map(|element| overload(element)).collect();
    let over = peaks.into_iter().filter(|peak| peak.volts > REFERENCE || overloaded.contains(&peak.output));
    let fault = |OutputPeak { output, quantity, volts, .. }: OutputPeak| {
        let message = format!("{quantity} has no scale: {output} would need {volts:.0} V");
        let hint =
            format!("write the equation of {quantity} in another form, or give {quantity} a \"maximum\"");
        match tables.problem.quantities.get(&quantity) {
            Some(declared) => Diagnostic::at(codes::NO_CIRCUIT, declared.span, message).hint(hint),
            None => Diagnostic::without_span(codes::NO_CIRCUIT, message).hint(hint),
        }
    };
    over.map(fault).chain(others).collect()
}

/// The fault of an amplifier that is no output of a quantity.
fn overload(element: &str) -> Diagnostic {
    let message = format!("{element} overloads in the run of the patch");
    let hint = "give the quantities a larger \"maximum\", or write the equations in another form";
    Diagnostic::without_span(codes::NO_CIRCUIT, message).hint(hint)
}

/// The result of the last run.
///
/// # Errors
/// If the patch cannot be wired.
fn scaled_problem(
    tables: &Tables<'_>,
    runs: usize,
    deviations: Vec<Diagnostic>,
) -> Result<ScaledProblem, ScaleError> {
    let (patch, narrowed_ranges) = with_narrowed_ranges(&tables.synthesis.patch)?;
    let steps = tables.synthesis.steps.iter().map(GainStep::text).collect();
    let (quantities, peaks, time_scale) = (tables.quantities(), tables.peaks(), tables.scales.time_scale);
    Ok(ScaledProblem { patch, quantities, peaks, steps, time_scale, runs, narrowed_ranges, deviations })
}

#[cfg(test)]
mod tests;
