//! Scales a problem: from equations to a patch whose amplifiers use their range.
//!
//! [`scale_problem`] plans the circuit, finds the range of every quantity, chooses scales, builds the patch and runs it.
//! If an amplifier then peaks below 50 V or above 95 V, the scales change and the patch is built again. At the end, the
//! ranges of the parameters are narrowed to those in which all settings are valid.

mod error;
mod measured;
mod narrowing;
mod scaled_equation;
mod table;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::{Patch, Problem};

use crate::findings::codes;
use crate::peaks::ranges;
use crate::plan::plan;
pub use crate::synthesis::ScaleOptions;
use crate::synthesis::{GainStep, choose_scales, improved_scales, synthesise};
pub use error::ScaleError;
use measured::measured_peaks;
pub(crate) use measured::output_peaks;
pub use narrowing::NarrowedRange;
use narrowing::with_narrowed_ranges;
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
    /// The number of runs that the scaling took.
    pub runs: usize,
    /// The parameters whose ranges are narrower in the patch than in the problem, in the order of the patch. Outside of
    /// them a pot would be above 1 or negative, for example.
    pub narrowed_ranges: Vec<NarrowedRange>,
}

/// Turns a problem into a patch with scales, gains and pots.
///
/// The patch is run, and its scales change until the peaks are between 50 and 95 V. Scales that the problem states are
/// kept. The scales hold for the present values of the parameters, so the ranges in the patch can be narrower than in
/// the problem.
///
/// # Errors
/// If the problem has a fault, if the machine has no circuit for one of its equations, if an amplifier overloads whatever
/// its scale, or if the patch cannot be run.
pub fn scale_problem(problem: &Problem, options: &ScaleOptions) -> Result<ScaledProblem, ScaleError> {
    let circuit = Circuit::new(&problem.patch).map_err(ScaleError::Problem)?;
    let in_problem = |findings| ScaleError::of_problem(problem, findings);
    let plan = plan(problem, &circuit).map_err(in_problem)?;
    let ranges = ranges(&plan, problem, &circuit).map_err(|finding| in_problem(vec![finding]))?;
    let mut scales = choose_scales(&plan, problem, &circuit, &ranges, options);
    let mut runs = 0;
    loop {
        let synthesis =
            synthesise(&plan, problem, &circuit, &ranges, &scales, options).map_err(in_problem)?;
        let names: Vec<&str> = synthesis.outputs.iter().map(|(_, name)| name.as_str()).collect();
        let volts = measured_peaks(&synthesis.patch, &names)?;
        runs += 1;
        let by_node: Vec<_> =
            synthesis.outputs.iter().map(|(id, _)| *id).zip(volts.iter().copied()).collect();
        let better = improved_scales(&plan, problem, &circuit, &ranges, options, &scales, &by_node);
        if better == scales || runs == MAX_RUNS {
            let tables = Tables {
                plan: &plan,
                problem,
                circuit: &circuit,
                scales: &scales,
                synthesis: &synthesis,
                volts: &volts,
            };
            let overloads = overloads(&tables);
            return if overloads.is_empty() {
                scaled_problem(&tables, runs)
            } else {
                Err(in_problem(overloads))
            };
        }
        scales = better;
    }
}

/// A fault for each output that exceeds the reference voltage, whatever its scale.
fn overloads(tables: &Tables<'_>) -> Vec<Diagnostic> {
    let over = tables.peaks().into_iter().filter(|peak| peak.volts > REFERENCE);
    let fault = |OutputPeak { output, quantity, volts, .. }: OutputPeak| {
        let message = format!("{quantity} has no scale: {output} would need {volts:.0} V");
        let hint =
            format!("write the equation of {quantity} in another form, or give {quantity} a \"maximum\"");
        match tables.problem.quantities.get(&quantity) {
            Some(declared) => Diagnostic::at(codes::NO_CIRCUIT, declared.span, message).hint(hint),
            None => Diagnostic::without_span(codes::NO_CIRCUIT, message).hint(hint),
        }
    };
    over.map(fault).collect()
}

/// The result of the last run.
///
/// # Errors
/// If the patch cannot be wired.
fn scaled_problem(tables: &Tables<'_>, runs: usize) -> Result<ScaledProblem, ScaleError> {
    let (patch, narrowed_ranges) = with_narrowed_ranges(&tables.synthesis.patch)?;
    let steps = tables.synthesis.steps.iter().map(GainStep::text).collect();
    let (quantities, peaks, time_scale) = (tables.quantities(), tables.peaks(), tables.scales.time_scale);
    Ok(ScaledProblem { patch, quantities, peaks, steps, time_scale, runs, narrowed_ranges })
}

#[cfg(test)]
mod tests;
