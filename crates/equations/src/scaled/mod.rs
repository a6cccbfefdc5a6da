//! Scales a problem: from equations to a patch whose amplifiers use their range.
//!
//! [`scale_problem`] plans the circuit and finds the range of every quantity. `attempt` chooses scales, builds the patch
//! and runs it, and `measured` reads the voltages. If an amplifier peaks below 50 V or above 95 V, the scales change and
//! the patch is built again. The last patch runs with its own settings; if `run_step` finds that the step is too long, all
//! is repeated with a shorter one. `overload` has the faults of amplifiers that overload with every scale, and `maxima`
//! those of stated maxima. `built_patch` turns faults of the patch into faults of the problem. `table` and
//! `scaled_equation` explain the scales. At the end, `narrowing` narrows the ranges of the parameters to those in which all
//! settings are valid, and `inventory` compares the parts with those of the machine.

mod attempt;
mod built_patch;
mod error;
mod inventory;
mod maxima;
mod measured;
mod narrowing;
mod overload;
mod products;
mod run_step;
mod scaled_equation;
mod table;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Diagnostic, Report};
use patchcord_core::patch::{Patch, Problem};

use crate::peaks::ranges;
use crate::plan::plan;
use crate::synthesis::GainStep;
pub use crate::synthesis::ScaleOptions;
use attempt::{Basis, Last, last_attempt};
use built_patch::BuiltPatch;
pub use error::ScaleError;
use maxima::checked_maxima;
pub(crate) use measured::output_peaks;
pub use narrowing::NarrowedRange;
use narrowing::with_narrowed_ranges;
pub use table::{OutputPeak, ScaledDrive, ScaledQuantity};

/// A problem as a scaled patch, with the tables that explain it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ScaledProblem {
    /// The patch.
    pub patch: Patch,
    /// The scaling table: a row for each quantity of the problem.
    pub quantities: Vec<ScaledQuantity>,
    /// The drives that the circuit uses, with their scales.
    pub drives: Vec<ScaledDrive>,
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
    /// The warnings about the problem, about what the patch has otherwise than the problem states, and about the patch: all
    /// at positions in the problem.
    pub warnings: Report,
}

/// Turns a problem into a patch with scales, gains and pots.
///
/// The patch is run, and its scales change until the peaks are between 50 and 95 V. Scales that the problem prescribes
/// are kept. The scales hold for the present values of the parameters, so the ranges in the patch can be narrower than in
/// the problem. A patch for a machine with too few parts has a warning.
///
/// # Errors
/// If the problem has a fault, if the machine has no circuit for one of its equations, if an amplifier overloads with
/// every scale, or with the scale that the problem prescribes, or if the patch cannot be run.
pub fn scale_problem(problem: &Problem, options: &ScaleOptions) -> Result<ScaledProblem, ScaleError> {
    let circuit = Circuit::new(&problem.patch).map_err(ScaleError::Problem)?;
    let in_problem = |faults| ScaleError::of_problem(problem, &circuit, faults);
    let refuse = |faults: Vec<Diagnostic>| if faults.is_empty() { Ok(()) } else { Err(in_problem(faults)) };
    let plan = plan(problem, &circuit).map_err(in_problem)?;
    let ranges = ranges(&plan, problem, &circuit).map_err(|fault| in_problem(vec![fault]))?;
    refuse(overload::prescribed_faults(&plan, problem, &ranges))?;
    let about_maxima = checked_maxima(&plan, problem, &ranges, options).map_err(in_problem)?;
    let basis = Basis { plan: &plan, problem, circuit: &circuit, ranges: &ranges, options };
    let last = last_attempt(&basis)?;
    let built = BuiltPatch::new(&basis, &last.attempt.synthesis);
    refuse(overload::faults(&last.attempt, &built))?;
    scaled_problem(&built, &last, about_maxima)
}

/// The result of the last attempt, whose patch is `built`.
///
/// # Errors
/// If the patch cannot be wired.
fn scaled_problem(
    built: &BuiltPatch<'_>,
    last: &Last,
    about_maxima: Vec<Diagnostic>,
) -> Result<ScaledProblem, ScaleError> {
    let (basis, attempt) = (&built.basis, &last.attempt);
    let narrowed = with_narrowed_ranges(built.patch).map_err(|error| built.fault_of_problem(error));
    let (patch, narrowed_ranges) = narrowed?;
    let about_problem = basis.circuit.warnings().findings.into_iter();
    let about_patch = inventory::warnings(&BuiltPatch { patch: &patch, ..*built })?;
    let findings = about_problem.chain(about_maxima).chain(last.step_warning.clone()).chain(about_patch);
    let source = &basis.problem.patch;
    Ok(ScaledProblem {
        quantities: table::quantities(basis, attempt),
        drives: table::drives(basis, attempt),
        peaks: table::peaks(attempt),
        steps: attempt.synthesis.steps.iter().map(GainStep::text).collect(),
        time_scale: attempt.scales.time_scale,
        runs: last.runs,
        narrowed_ranges,
        warnings: Report::new(source.file(), source.text(), findings.collect()),
        patch,
    })
}

#[cfg(test)]
mod tests;
