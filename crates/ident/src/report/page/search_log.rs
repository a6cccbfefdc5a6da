//! The section with the log of the search.
//!
//! It is shown only if the log has more than the fit of the patch and one change, for example if effects were replaced
//! or dropped. Otherwise the sections of the rounds have the same information.

use crate::report::labels::effect_labels;
use crate::report::page::html_parts::table;
use crate::report::search_log::action_text;
use crate::report::values::format_pure_number;
use crate::search::outcome::Outcome;
use maud::{Markup, html};

/// The table of all actions. Empty if the rounds alone describe the search.
pub(super) fn section(outcome: &Outcome) -> Markup {
    if !outcome.has_detailed_log() {
        return Markup::default();
    }
    let last = outcome.search_log.len() - 1;
    let rows = outcome.search_log.iter().enumerate().map(|(index, entry)| {
        let [train, validation] = entry.residual_rms.map(format_pure_number);
        let effects = effect_labels(&entry.effects).join(", ");
        (index == last, vec![action_text(&entry.action), effects, train, validation])
    });
    let headings = ["action", "effects in the patch", "training", "validation"];
    html! {
        section {
            h2 { "Steps of the search" }
            p {
                "Every change of the effects in the patch, and the residual after it, as a multiple of the noise. \
                The rounds below are those of the final effects."
            }
            "\n"
            (table(&headings, rows))
        }
        "\n"
    }
}
