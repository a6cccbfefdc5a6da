//! What the reader of a report should doubt.

use crate::data::experiment::{Experiment, Output};
use crate::effects::candidate::Candidate;
use crate::fit::estimate::over_sigma;
use crate::fit::fitted_model::Stage;
use crate::fit::validation::has_changed;
use crate::report::fit_quality::{overload_sentence, steps_sentence};
use crate::report::places::nameless_sentences;
use crate::report::ranges::extension_sentence;
use crate::report::reasons::coloured_sentence;
use crate::report::values::estimate_text;
use crate::search::inconclusive::LOUD;
use crate::search::outcome::Outcome;
use crate::search::range_extension::Beyond;
use crate::search::refinement::may_be_none;
use crate::search::verdict::Verdict;
use patchcord_analysis::instruments::number;
use patchcord_core::document::behind;

/// What is left is as large as the noise, unless that is told too large: by so much less it is not by chance.
const FAR_LESS: f64 = 0.5;

/// What the reader should doubt, a sentence each: parameters at the ends of their ranges, an overloaded amplifier, a residual that is
/// larger than the verdict says, effects that may be zero, noise that is too large or too small, integrators without a signal, a
/// solver whose error is too large, and the warnings of the experiment.
pub fn doubts(outcome: &Outcome, experiment: &Experiment) -> Vec<String> {
    let warnings = experiment.warnings.findings.iter();
    let warned = warnings.map(|own| format!("Of the experiment ({}): {}.", own.code.as_str(), own.message));
    let coarse = (!outcome.fineness.is_enough()).then(|| steps_sentence(&outcome.fineness));
    let noises = noises(outcome, experiment).into_iter().chain(louder(outcome, experiment));
    let nameless = nameless_sentences(&outcome.places);
    at_ends(outcome)
        .into_iter()
        .chain(outcome.overload.iter().map(overload_sentence))
        .chain(more_is_left(outcome))
        .chain(uncertain(outcome))
        .chain(noises)
        .chain(nameless)
        .chain(coarse)
        .chain(warned)
        .collect()
}

/// Which parameters of the patch stand at an end of their ranges: as it was, or beside what is named.
fn at_ends(outcome: &Outcome) -> Vec<String> {
    let at_end = |stage: &Stage, place: usize| {
        let (name, value) = (&stage.version.fit[place], estimate_text(stage, place));
        format!("{name} at the end of its range, {value}{}", behind(stage.unit(place)))
    };
    let is_missing = outcome.verdict.has_names() || outcome.verdict == Verdict::UnknownEffect;
    let beyond = outcome.beyond.iter().flat_map(|own| &own.places).copied().collect::<Vec<_>>();
    // What is none stands in for nothing.
    let doubted =
        outcome.base.at_end().filter(|place| is_missing || outcome.base.train.point.knobs[*place] != 0.0);
    let doubted = doubted.filter(|place| !beyond.contains(place));
    let before = doubted.map(|place| {
        let at = at_end(&outcome.base, place);
        match (is_missing, outcome.base.train.point.knobs[place] == 0.0) {
            (false, _) => format!(
                "The patch is fitted best with {at}: that value may stand in for something that is missing."
            ),
            (true, false) => format!("The patch as it was is fitted best with {at}: what seems to be missing may be a value beyond it."),
            (true, true) => format!("The patch as it was is fitted best with {at}: what seems to be missing may be the sign that it is wired in with, if that is wrong."),
        }
    });
    let beside =
        outcome.last.newly_at_end(&outcome.base).filter(|_| outcome.verdict.has_names()).map(|place| {
            let at = at_end(&outcome.last, place);
            format!("Beside what is named the patch is fitted best with {at}: nature's law may be another.")
        });
    let named = outcome.effects.iter().filter(|_| outcome.verdict.has_names());
    let own = named.flat_map(|effect| own_at_ends(outcome, effect));
    let further = outcome.beyond.as_ref().filter(|own| !says(outcome, own)).map(extension_sentence);
    before.chain(further).chain(beside).chain(own).collect()
}

/// Which effects the data may have none of, as far as their intervals tell.
fn uncertain(outcome: &Outcome) -> impl Iterator<Item = String> + '_ {
    let named = outcome.effects.iter().filter(|_| outcome.verdict.has_names());
    // What is not told at all has a line of its own.
    let is_told = |effect: &&Candidate| {
        outcome.last.brought(effect).next().is_some_and(|(_, _, known)| known.error.is_finite())
    };
    named.filter(is_told).filter(|effect| may_be_none(effect, &outcome.last)).map(|effect| {
        format!(
            "{} may have no strength at all, by its interval: it is named for what the data are explained better with it.",
            effect.named()
        )
    })
}

/// What is left beside what is named, where that is more than noise and the verdict does not say so.
fn more_is_left(outcome: &Outcome) -> Option<String> {
    let is_told = !outcome.verdict.has_names() || outcome.leaves_much();
    let is_more = outcome.last.leaves_structure() && outcome.last.train.over_noise() > 1.0;
    if is_told || !is_more {
        return None;
    }
    // What is noise of the drives, or lies between their samples, is nothing that is missing.
    let of_drives = outcome.last.not_white.get().and_then(Option::as_ref).filter(|own| own.is_of_drives());
    if let Some(own) = of_drives {
        return Some(format!("Beside what is named {}.", coloured_sentence(own)));
    }
    let [train, test] = [&outcome.last.train, &outcome.last.test].map(|fitted| number(fitted.over_noise()));
    Some(format!(
        "What is left, {train} times the noise in training and {test} on the data held back, is no noise: something smaller is missing beside what is named, or its law is another."
    ))
}

/// Whether what lies beyond ranges stands in the verdict.
fn says(outcome: &Outcome, beyond: &Beyond) -> bool {
    match outcome.verdict {
        Verdict::Ambiguous => beyond.is_rival,
        Verdict::CannotJudge => beyond.leaves_noise(),
        _ => false,
    }
}

/// The same of what an effect brought; nature knows no less than 0 of a time or a friction.
fn own_at_ends(outcome: &Outcome, effect: &Candidate) -> Vec<String> {
    let Stage { version, train, .. } = &outcome.last;
    let at_end = outcome.last.at_end().filter(|place| train.point.knobs[*place] != 0.0);
    let names: Vec<&str> = at_end.map(|place| version.fit[place].as_str()).collect();
    let brought = effect.graft.parameters.iter().filter(|own| names.contains(&own.name.as_str()));
    let doubt = brought.map(|own| {
        format!(
            "The {} of {} is found at the end of its range: these data may ask for a value beyond it.",
            own.name, effect.effect
        )
    });
    doubt.collect()
}

/// Of which outputs the experiment tells more noise than there can be.
fn noises(outcome: &Outcome, experiment: &Experiment) -> Vec<String> {
    let told = experiment.outputs.iter().enumerate().filter(|(_, output)| output.sigma.is_some());
    let left = told.map(|(place, output)| (&output.signal, over_sigma(&outcome.told().train, place)));
    let far_less = left.filter(|(_, left)| *left < FAR_LESS);
    let doubt = far_less.map(|(signal, left)| {
        format!(
            "What is left of {signal} is {} times the noise that the experiment tells: with a \"sigma\" as small as the noise these data would show more.",
            number(left)
        )
    });
    doubt.collect()
}

/// Of which outputs more is left than noise, although it looks like that, or although it does not in training.
fn louder(outcome: &Outcome, experiment: &Experiment) -> Vec<String> {
    let stage = outcome.told();
    let is_settled = outcome.verdict.has_names() || outcome.verdict == Verdict::NothingMissing;
    if !is_settled || stage.leaves_structure() {
        return Vec::new();
    }
    let of = |(place, output): (usize, &Output)| {
        let [train, test] = [&stage.train, &stage.test].map(|fitted| over_sigma(fitted, place));
        let loud = (train > LOUD).then(|| {
            format!(
                "What is left of {} is {} times its noise, although it looks like noise: there is more noise in these data than that, or something too fast for them.",
                output.signal,
                number(train)
            )
        });
        // Where nothing is missing the patch explains both, fitted to both.
        let why = match outcome.verdict {
            Verdict::NothingMissing => {
                "fitted to both, the patch explains both: what training leaves open led it astray"
            }
            _ => {
                "something has changed by then or shows there alone, or a law is another than it seems in training"
            }
        };
        let held = has_changed(stage, place).then(|| {
            format!(
                "Of {} {} times its noise is left of the data held back, and {} in training: {why}.",
                output.signal,
                number(test),
                number(train)
            )
        });
        loud.into_iter().chain(held)
    };
    experiment.outputs.iter().enumerate().flat_map(of).collect()
}
