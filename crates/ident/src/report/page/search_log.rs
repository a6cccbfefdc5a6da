//! The way of the search, change by change.

use crate::report::page::sheet::table;
use crate::report::search_log::action_text;
use crate::search::outcome::Outcome;
use patchcord_analysis::instruments::number;
use patchcord_draw::html::escaped;

/// Nothing where there is no more to it than one effect.
pub(super) fn section(outcome: &Outcome) -> String {
    if !outcome.has_a_way() {
        return String::new();
    }
    let last = outcome.way.len() - 1;
    let rows = outcome.way.iter().enumerate().map(|(place, change)| {
        let [train, test] = change.left.map(number);
        let stands = escaped(&change.effects.join(", "));
        (place == last, vec![escaped(&action_text(&change.did)), stands, train, test])
    });
    let headings = ["what was done", "what stands beside the patch then", "training", "held back"];
    format!(
        "<section>\n<h2>The way</h2>\n<p>What was taken, looked at again beside the others, replaced or dropped, and the gap that each left, in noise. \
         The rounds below are those of what stands in the end.</p>\n{}</section>\n",
        table(&headings, rows)
    )
}
