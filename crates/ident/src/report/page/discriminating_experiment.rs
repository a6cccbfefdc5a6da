//! The section on the experiment that distinguishes two effects.
//!
//! The page describes the drive and the expected difference. The samples of drive and predictions are in the file
//! `separate.csv`, next to the page.

use crate::report::discriminating_experiment::experiment_sentence;
use crate::report::labels::effect_label;
use crate::search::outcome::Outcome;
use maud::{Markup, html};

/// The experiment as text, with a link to its table. Empty if there is none.
pub(super) fn section(outcome: &Outcome) -> Markup {
    let Some(experiment) = &outcome.discriminating_experiment else { return Markup::default() };
    let [one, other] = experiment.effects.each_ref().map(effect_label);
    html! {
        section {
            h2 { "An experiment to distinguish them" }
            p {
                (one) " or " (other) ": " (experiment_sentence(experiment)) ". Both patches start at rest. \
                The difference is what remains when one of them is fitted to the prediction of the other. "
                a href="separate.csv" { "separate.csv" } " has the drive and both predictions."
            }
            "\n"
        }
        "\n"
    }
}
