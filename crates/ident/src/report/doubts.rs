//! Doubts about a result that the reader of a report should know.
//!
//! A doubt does not change the verdict. It names a property of the fit or of the data that can make the verdict
//! wrong, and says what else would explain the data. Each doubt is a complete sentence with a full stop.

use crate::data::experiment::{Experiment, MeasuredOutput};
use crate::effects::candidate::Candidate;
use crate::fit::estimate::normalised_output_rms;
use crate::fit::fitted_model::FittedModel;
use crate::fit::validation::is_validation_worse;
use crate::report::effect_sites::unscaled_integrator_sentences;
use crate::report::fit_quality::{overload_sentence, steps_sentence};
use crate::report::labels::candidate_label;
use crate::report::ranges::extension_sentence;
use crate::report::reasons::coloured_sentence;
use crate::report::values::{estimate_with_unit_text, format_pure_number, residual_texts};
use crate::search::inconclusive::MAX_NOISE_RATIO;
use crate::search::outcome::Outcome;
use crate::search::range_extension::RangeExtension;
use crate::search::refinement::can_be_zero;
use crate::search::verdict::Verdict;

/// Residual rms over the specified noise below which that noise is too large. So low a value does not occur by
/// chance.
const MIN_NOISE_RATIO: f64 = 0.5;

/// The doubts about an outcome, a sentence each.
///
/// They come in this order:
///
/// * parameters at the ends of their ranges
/// * an overloaded amplifier
/// * a residual that the verdict does not mention
/// * effects that may have zero strength
/// * noise levels that are too large or too small
/// * integrators without a signal
/// * a solver error that is too large
/// * warnings of the experiment
pub fn doubts(outcome: &Outcome, experiment: &Experiment) -> Vec<String> {
    let warnings = experiment.warnings.findings.iter();
    let warnings = warnings.map(|finding| {
        format!("Warning of the experiment ({}): {}.", finding.code.as_str(), finding.message)
    });
    let refinement = &outcome.step_refinement;
    let coarse_steps = (!refinement.is_sufficient()).then(|| steps_sentence(refinement));
    let noise = excessive_noise(outcome, experiment).into_iter().chain(loud_residuals(outcome, experiment));
    let unscaled = unscaled_integrator_sentences(&outcome.effect_sites);
    parameters_at_ends(outcome)
        .into_iter()
        .chain(outcome.overload.iter().map(overload_sentence))
        .chain(unmentioned_residual(outcome))
        .chain(uncertain_effects(outcome))
        .chain(noise)
        .chain(unscaled)
        .chain(coarse_steps)
        .chain(warnings)
        .collect()
}

/// Parameters at the ends of their ranges: of the original patch, of the patch with wider ranges, of the patch with
/// the named effects, and of these effects.
///
/// The sentence depends on the verdict. If an effect is missing, a value beyond the range may explain the data without
/// it. Otherwise the value may hide an effect. Parameters that a range extension reports are left out here.
fn parameters_at_ends(outcome: &Outcome) -> Vec<String> {
    let at_end = |model: &FittedModel, index: usize| {
        let (name, value) = (&model.variant.fit[index], estimate_with_unit_text(model, index));
        format!("{name} at the end of its range, {value}")
    };
    let is_missing = outcome.verdict.has_names() || outcome.verdict == Verdict::UnknownEffect;
    let outside =
        outcome.range_extension.iter().flat_map(|extension| &extension.outside).copied().collect::<Vec<_>>();
    // A value of zero cannot compensate for a missing effect.
    let doubted = outcome
        .base
        .indices_at_range_end()
        .filter(|index| is_missing || outcome.base.train.estimate.parameters[*index] != 0.0);
    let doubted = doubted.filter(|index| !outside.contains(index));
    let original = doubted.map(|index| {
        let at_end = at_end(&outcome.base, index);
        match (is_missing, outcome.base.train.estimate.parameters[index] == 0.0) {
            (false, _) => format!(
                "The best fit of the patch has {at_end}: this value may compensate for a missing effect."
            ),
            (true, false) => format!(
                "The best fit of the original patch has {at_end}: a value beyond the range may explain the data without a missing effect."
            ),
            (true, true) => format!(
                "The best fit of the original patch has {at_end}: a wrong sign in the patch may explain the data without a missing effect."
            ),
        }
    });
    let with_effects = outcome
        .final_model
        .indices_newly_at_range_end(&outcome.base)
        .filter(|_| outcome.verdict.has_names())
        .map(|index| {
            let at_end = at_end(&outcome.final_model, index);
            format!("With the named effects, the best fit has {at_end}: the real law may be different.")
        });
    let named = outcome.effects.iter().filter(|_| outcome.verdict.has_names());
    let of_effects = named.flat_map(|effect| effect_at_ends(outcome, effect));
    let extension = outcome.range_extension.as_ref().filter(|extension| !is_in_verdict(outcome, extension));
    original.chain(extension.map(extension_sentence)).chain(with_effects).chain(of_effects).collect()
}

/// Named effects whose intervals include zero strength.
///
/// Such an effect has passed the comparison of the fits, so its name stays in the verdict.
fn uncertain_effects(outcome: &Outcome) -> impl Iterator<Item = String> + '_ {
    let named = outcome.effects.iter().filter(|_| outcome.verdict.has_names());
    // An effect without any interval is reported with the undetermined parameters.
    let is_determined = |effect: &&Candidate| {
        outcome
            .final_model
            .effect_parameters(effect)
            .next()
            .is_some_and(|(_, _, uncertainty)| uncertainty.error.is_finite())
    };
    named.filter(is_determined).filter(|effect| can_be_zero(effect, &outcome.final_model)).map(|effect| {
        format!(
            "The interval of {} includes zero strength: it is named because the fit is better with it.",
            candidate_label(effect)
        )
    })
}

/// A coloured residual of the patch with the named effects, if the verdict does not mention it.
///
/// None if the residual looks like noise, does not exceed the noise, or is part of the verdict sentence. A residual
/// that the noise of the drives explains gets its own sentence.
fn unmentioned_residual(outcome: &Outcome) -> Option<String> {
    let model = &outcome.final_model;
    let is_mentioned = !outcome.verdict.has_names() || outcome.has_substantial_residual();
    let exceeds_noise = model.residuals_are_coloured() && model.train.normalised_rms() > 1.0;
    if is_mentioned || !exceeds_noise {
        return None;
    }
    // Noise of the drives, and their values between samples, are no missing effects.
    let from_drives =
        model.coloured_residual.get().and_then(Option::as_ref).filter(|residual| residual.is_from_drives());
    if let Some(residual) = from_drives {
        return Some(format!("With the named effects, {}.", coloured_sentence(residual)));
    }
    let [train, validation] = residual_texts(model);
    Some(format!(
        "The residual is {train} times the noise in the training data and {validation} in the validation data, and is not noise: a smaller effect is missing as well, or the law of a named effect is different."
    ))
}

/// Whether the verdict sentence mentions the values outside their ranges.
fn is_in_verdict(outcome: &Outcome, extension: &RangeExtension) -> bool {
    match outcome.verdict {
        Verdict::Ambiguous => extension.is_rival,
        Verdict::CannotJudge => extension.has_white_residual(),
        _ => false,
    }
}

/// Parameters of an effect at the ends of their ranges. Values of zero are left out, since a time or a friction
/// cannot be negative.
fn effect_at_ends(outcome: &Outcome, effect: &Candidate) -> Vec<String> {
    let FittedModel { variant, train, .. } = &outcome.final_model;
    let at_end =
        outcome.final_model.indices_at_range_end().filter(|index| train.estimate.parameters[*index] != 0.0);
    let names: Vec<&str> = at_end.map(|index| variant.fit[index].as_str()).collect();
    let parameters =
        effect.graft.parameters.iter().filter(|parameter| names.contains(&parameter.name.as_str()));
    let sentences = parameters.map(|parameter| {
        format!(
            "The {} of {} is at the end of its range: the data may require a value beyond it.",
            parameter.name, effect.effect
        )
    });
    sentences.collect()
}

/// Outputs whose specified noise is larger than the residual.
///
/// Only outputs whose "sigma" is in the experiment are examined. Estimated noise cannot be too large in this way.
fn excessive_noise(outcome: &Outcome, experiment: &Experiment) -> Vec<String> {
    let specified = experiment.outputs.iter().enumerate().filter(|(_, output)| output.sigma.is_some());
    let residuals = specified.map(|(index, output)| {
        (&output.signal, normalised_output_rms(&outcome.reported_model().train, index))
    });
    let too_small = residuals.filter(|(_, rms)| *rms < MIN_NOISE_RATIO);
    let sentences = too_small.map(|(signal, rms)| {
        format!(
            "The residual of {signal} is {} times the noise that the experiment specifies: with a \"sigma\" as small as the real noise, smaller effects are detectable.",
            format_pure_number(rms)
        )
    });
    sentences.collect()
}

/// Outputs whose residual exceeds the noise although it looks like noise, or exceeds it only in the validation data.
///
/// An output is loud above [`MAX_NOISE_RATIO`] times its noise. If only the validation data are explained worse, the
/// system may have changed between the records.
fn loud_residuals(outcome: &Outcome, experiment: &Experiment) -> Vec<String> {
    let model = outcome.reported_model();
    let is_conclusive = outcome.verdict.has_names() || outcome.verdict == Verdict::NothingMissing;
    if !is_conclusive || outcome.agrees_within_noise || model.residuals_are_coloured() {
        return Vec::new();
    }
    let sentences = |(index, output): (usize, &MeasuredOutput)| {
        let [train, validation] =
            [&model.train, &model.validation].map(|fitted| normalised_output_rms(fitted, index));
        let loud = (train > MAX_NOISE_RATIO).then(|| {
            format!(
                "The residual of {} is {} times its noise, although it looks like noise: the data have more noise than specified, or a disturbance that is faster than the sampling.",
                output.signal,
                format_pure_number(train)
            )
        });
        // With this verdict, a fit to both parts explains both.
        let why = match outcome.verdict {
            Verdict::NothingMissing => {
                "a fit to both parts explains both, so that the training data alone do not determine the patch"
            }
            _ => {
                "the system has changed, an effect acts only there, or a law differs from the one fitted in training"
            }
        };
        let changed = is_validation_worse(model, index).then(|| {
            format!(
                "The residual of {} is {} times its noise in the validation data and {} times in the training data: {why}.",
                output.signal,
                format_pure_number(validation),
                format_pure_number(train)
            )
        });
        loud.into_iter().chain(changed)
    };
    experiment.outputs.iter().enumerate().flat_map(sentences).collect()
}
