//! Reasons why data are inconclusive, as sentences with advice, and why a patch cannot be fitted at all.
//!
//! Each sentence names the output or drive concerned, gives the numbers on which the decision is based, and ends with
//! advice. The sentences have no full stop, because they follow "inconclusive: " in the verdict.

use crate::fit::coloured_residual::{ColouredResidual, ResidualSource};
use crate::fit::step_size::StepRefinement;
use crate::report::ranges::extension_text;
use crate::report::values::format_pure_number;
use crate::residuals::divergence::Divergence;
use crate::residuals::misspecification::{Misspecification, Respecification};
use crate::residuals::residual_analysis::{DRIVE_NOISE_RATIO, SlowNoise};
use crate::search::inconclusive::Inconclusive;
use crate::search::range_extension::RangeExtension;
use patchcord_core::document::plural;

/// Advice for a fit that diverges.
const DIVERGENCE_ADVICE: &str = "check the signs in the loops of the patch, or write \"pieces\" in the experiment if the real system is unstable";

/// The sentence if a patch can be run from none of the starts of a fit. `patch` is its file.
pub fn no_run_sentence(patch: &str) -> String {
    format!(
        "{patch} cannot be run with the data from any of the starting points: check its scales \
         and the ranges of the fitted parameters, or divide the records with \"pieces\" in the experiment"
    )
}

/// Why the data are inconclusive. `extension` is the fit with wider ranges, if there is one.
///
/// Example: "the outputs do not move beyond the noise". The verdict sentence puts "inconclusive: " in front.
pub fn inconclusive_sentence(reason: &Inconclusive, extension: Option<&RangeExtension>) -> String {
    match reason {
        Inconclusive::TooFewSamples => "there are no more samples than fitted numbers".to_owned(),
        Inconclusive::NoMotion => "the outputs do not move beyond the noise".to_owned(),
        Inconclusive::LoudResidual(output, rms) => format!(
            "the residual of {output} is {} times its noise, although it looks like noise: the data have outliers, more noise than specified, or a disturbance that is faster than the sampling",
            format_pure_number(*rms)
        ),
        Inconclusive::ColouredResidual(residual) => coloured_sentence(residual),
        Inconclusive::SlowSensorNoise(noise) => slow_noise_sentence(noise),
        Inconclusive::ValidationMismatch(rms) => format!(
            "the fit to the training data does not explain the validation data, which leave {} times the noise: the system has changed, or an effect acts only there",
            format_pure_number(*rms)
        ),
        Inconclusive::NoSites => {
            "no effect fits the patch: its integrators must give signals with scales".to_owned()
        }
        Inconclusive::NothingDetectable => {
            "none of the effects that were tried would be detectable in these data".to_owned()
        }
        Inconclusive::RangeExtension => format!(
            "the patch alone explains the data with {}: widen the range if this value is plausible; otherwise an effect is missing",
            extension.map(extension_text).unwrap_or_default()
        ),
        Inconclusive::Misspecification(misspecification) => misspecification_sentence(misspecification),
        Inconclusive::Divergence(divergence) => divergence_sentence(divergence),
        Inconclusive::NoiseAboveMotion => {
            "the patch agrees with the data within the declared noise, but so does a constant: the outputs do not move beyond the noise"
                .to_owned()
        }
        Inconclusive::SolverError(refinement) => solver_error_sentence(refinement),
    }
}

/// Why a residual is coloured although nothing is missing.
///
/// Four sources are distinguished: noise of drives, a fit that diverges, the values of drives between samples, and slow
/// noise of the output itself.
pub fn coloured_sentence(residual: &ColouredResidual) -> String {
    let (output, rms) = (&residual.output, format_pure_number(residual.normalised_rms));
    match &residual.source {
        ResidualSource::DriveNoise(drives, mean_rms) => format!(
            "the residual of {output}, {rms} times its noise, does not exceed what noise of {} can cause, {} times: measure these drives better, or specify their \"sigma\" (0 for a drive that is set and not measured)",
            drives.join(", "),
            format_pure_number((1.0 + DRIVE_NOISE_RATIO * mean_rms * mean_rms).sqrt())
        ),
        ResidualSource::Divergence(drives) => format!(
            "the fit diverges: the residual of {output}, {rms} times its noise, exceeds the motion of the output, and noise of {} would grow as far: {DIVERGENCE_ADVICE}",
            drives.join(", ")
        ),
        ResidualSource::Intersample(drives, smooth_rms) => format!(
            "the residual of {output}, {rms} times its noise, is caused by straight lines between the samples of {}; with smooth curves it is {} times: write \"hold\": \"smooth\" if the drive is smooth, or sample faster",
            drives.join(", "),
            format_pure_number(*smooth_rms)
        ),
        ResidualSource::OutputNoise => format!(
            "the residual of {output} does not exceed its noise, {rms} times, but is not white: the noise is slow, or smaller than its \"sigma\""
        ),
    }
}

/// How large the error of the solver is, and what to check.
pub fn solver_error_sentence(refinement: &StepRefinement) -> String {
    format!(
        "the error of the solver is {} times the noise, rms, with {} from sample to sample: check the unit of \"time\", which is s if none is specified, and what sets the speed of the patch, or sample faster",
        format_pure_number(refinement.error),
        plural(refinement.steps as usize, "step")
    )
}

/// Why a residual is slow noise of a sensor.
pub fn slow_noise_sentence(noise: &SlowNoise) -> String {
    format!(
        "the residual of {} is better explained by slow noise of its sensor, with a correlation time of about {} s, than by a force at any junction",
        noise.output,
        format_pure_number(noise.correlation_time)
    )
}

/// Which specification is wrong, the residual with and without the correction, and where to look.
pub fn misspecification_sentence(misspecification: &Misspecification) -> String {
    let Misspecification { respecification, normalised_rms } = misspecification;
    let ([before, after], correction) =
        (normalised_rms.map(format_pure_number), correction_text(respecification));
    let advice = correction_advice(respecification);
    format!("with {correction} the patch leaves {after} times the noise instead of {before}: {advice}")
}

/// The change of the data that makes the patch fit, for example "the sign of x reversed".
///
/// Factors are 1000, because confused units usually are: mm and m, ms and s, N and kN.
fn correction_text(correction: &Respecification) -> String {
    match correction {
        Respecification::SignFlip(names) => format!("the sign of {} reversed", names.join(", ")),
        Respecification::UnitScaleDown(names) => format!("{} divided by 1000", names.join(", ")),
        Respecification::UnitScaleUp(names) => format!("{} multiplied by 1000", names.join(", ")),
        Respecification::TimeScaleDown => "all times divided by 1000".to_owned(),
        Respecification::TimeScaleUp => "all times multiplied by 1000".to_owned(),
    }
}

/// Where to look for a wrong specification.
fn correction_advice(correction: &Respecification) -> &'static str {
    match correction {
        Respecification::SignFlip(_) => "check the signs of signals, columns and drives",
        Respecification::UnitScaleDown(_) | Respecification::UnitScaleUp(_) => {
            "check the units of parameters, columns and drives; without \"unit\" a column has the unit of its signal or drive"
        }
        Respecification::TimeScaleDown | Respecification::TimeScaleUp => {
            "check the unit of \"time\", which is s if none is specified, and what sets the speed of the patch: jacks of integrators and units of parameters"
        }
    }
}

/// How far a fit diverges from the data, and what to do about it.
pub fn divergence_sentence(divergence: &Divergence) -> String {
    let Divergence { output, normalised_rms, normalised_motion, growth } = divergence;
    let [residual, motion, growth] =
        [normalised_rms, normalised_motion, growth].map(|value| format_pure_number(*value));
    format!(
        "the fit diverges: it leaves {residual} times the noise of {output}, which moves by {motion}, and a change of the initial voltages grows more than {growth} times: {DIVERGENCE_ADVICE}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_has_the_error_of_the_solver_and_its_steps() {
        let reason = Inconclusive::SolverError(StepRefinement { steps: 64, error: 50.0, limit: 20.0 });
        let sentence = inconclusive_sentence(&reason, None);
        let beginning =
            "the error of the solver is 50 times the noise, rms, with 64 steps from sample to sample: ";
        assert!(sentence.starts_with(beginning), "{sentence}");
    }
}
